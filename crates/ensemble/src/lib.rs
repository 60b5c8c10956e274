//! Many variants of one model: what varies, which members that gives, how they run on all cores, what is kept.
//!
//! [`definition::Definition`] is the file of variations, [`members::Members`] its members as points of the unit cube,
//! [`ensemble::Ensemble`] a definition that fits a model: it runs members in threads, and gives the same numbers
//! whatever runs them. [`store::Store`] keeps them in a folder from which a killed ensemble goes on.

pub mod definition;
pub mod ensemble;
pub mod lock;
pub mod member;
pub mod members;
pub mod spread;
pub mod store;
mod target;
