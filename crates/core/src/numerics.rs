//! Numerical building blocks.

pub mod dense;
mod elimination;
pub mod interpolate;
mod minimum_degree;
pub mod quadrature;
pub mod regularize;
pub mod sparse;
pub mod symmetric;
