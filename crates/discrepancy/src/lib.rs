//! Where simulation and measurement disagree, which physical effect is missing, and what adding it brings.
//!
//! [`explain::explain`] compares a model with a table of measurements: it fits every effect of the catalogue beside
//! all that is uncertain anyway, weighs the evidence, and says what it found, or that it found nothing.

pub mod addition;
pub mod catalogue;
pub mod data;
pub mod error;
pub mod experiment;
pub mod explain;
pub mod fit;
pub mod gap;
pub mod sanity;
pub mod sensors;
pub mod show;
pub mod split;
pub mod trial;
pub mod unknown;
