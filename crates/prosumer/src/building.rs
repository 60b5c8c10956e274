//! Rooms: networks of walls and air, what warms and cools them, what people want of them.

pub mod rc;
pub mod zone;
