//! Where simulation and measurement disagree, which physical effect is missing, and what adding it brings.
//!
//! [`explain::explain`] compares a model with a table of measurements: it finds where they differ, fits the effects of the
//! catalogue that could explain it beside all that is uncertain anyway, weighs the evidence, and says what it found, or that
//! it found nothing.

pub mod addition;
pub mod beginning;
#[cfg(test)]
mod bench;
pub mod catalogue;
pub mod data;
pub mod elpd;
pub mod error;
pub mod experiment;
pub mod explain;
pub mod find;
pub mod fit;
pub mod gap;
mod grid;
mod inputs;
pub mod likelihood;
pub mod next;
pub mod noise;
pub mod profile;
mod response;
pub mod sanity;
pub mod screen;
mod search;
pub mod sensors;
pub mod show;
pub mod significance;
pub mod split;
pub mod trial;
pub mod uncertainty;
pub mod unknown;
