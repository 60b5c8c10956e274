//! Numerical building blocks.

pub mod interpolate;
pub mod regularize;
pub mod sparse;
