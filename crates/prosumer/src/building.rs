//! Rooms: networks of walls and air, what warms and cools them, what people want of them.

pub mod comfort;
pub mod emitter;
pub mod envelope;
pub mod house;
pub mod rc;
pub mod zone;
