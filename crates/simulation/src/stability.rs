//! Who blocks whom, which loops will hunt, and how far it is to the limit: without simulating.
//!
//! The operating point is the steady state of the model; [`hunting`] takes the loops there apart, [`blocking`] the
//! feeders, [`advise`] tries remedies.

pub mod advise;
mod answers;
pub mod blocking;
mod chain;
mod chains;
mod count;
mod elimination;
mod flush;
pub mod hunting;
mod lanes;
mod law;
mod limit;
mod loops;
mod modes;
mod periodic;
mod response;
mod secant;
mod water;

use crate::build::build;
use crate::error::RunError;
use crate::model::Model;
use crate::simulation::Simulation;
use crate::steady::settle;
use anergy_core::cores::on_all_cores;
use blocking::FeederMargin;
use hunting::Hunting;
pub use hunting::{LoopMargin, Mode};
use serde::Serialize;

/// Loops from which on the analysis of a group is worth the start of threads.
const MANY_LOOPS: usize = 8;

/// What `work` gives for 0, 1, ... `count - 1`, in this order: on all cores where there are many loops.
fn in_pieces<T: Send>(loops: usize, count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    if loops < MANY_LOOPS {
        return (0..count).map(work).collect();
    }
    on_all_cores(count, work)
}

/// Who blocks whom and which loops will hunt.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Stability {
    /// The feeders, in the order of the model.
    pub feeders: Vec<FeederMargin>,
    /// Oscillating modes, the fastest growing first.
    pub modes: Vec<Mode>,
    /// The controllers, in the order of the model.
    pub controllers: Vec<LoopMargin>,
}

/// Analyses a model at its steady state.
///
/// # Errors
/// What is wrong with the model, or why it has no steady state.
pub fn analyse(model: &Model) -> Result<Stability, RunError> {
    let mut simulation = Simulation::new(build(model)?)?;
    settle(&mut simulation)?;
    let feeders = blocking::blocking(&simulation)?;
    let Hunting { modes, controllers } = hunting::hunting(&mut simulation)?;
    Ok(Stability { feeders, modes, controllers })
}
