//! Vocabulary and numerics of anergy: no component, no input or output.
//!
//! Everything that the other crates agree on lives here: typed indices, the medium, the sign
//! convention of ports, the signal table, the clock, the recorder seam, unit conversion, the
//! component registry and the numerical building blocks.

pub mod clock;
pub mod cores;
pub mod effectiveness;
pub mod error;
pub mod ids;
pub mod linear;
pub mod local_plane;
pub mod medium;
pub mod numerics;
pub mod port;
pub mod recorder;
pub mod registry;
pub mod signal;
pub mod solar;
pub mod testing;
pub mod units;
