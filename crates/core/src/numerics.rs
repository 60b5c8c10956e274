//! Numerical building blocks.

mod elimination;
pub mod interpolate;
pub mod regularize;
pub mod sparse;
