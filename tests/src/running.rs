//! What tests do with a model: make a run of it, advance it, look at a channel.

#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;

/// A run of a model, files from the root of the workspace.
///
/// # Panics
/// With the problems of the model.
pub fn simulation(text: &str) -> Simulation {
    let model = Model::from_toml(text, &crate::workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)));
    let plan = build(&model).unwrap_or_else(|problems| panic!("{}", problems.render(text)));
    Simulation::new(plan).unwrap()
}

/// Goes on for so many seconds.
///
/// # Panics
/// Where the run does.
pub fn advance(simulation: &mut Simulation, seconds: f64, step_s: f64) {
    let end = simulation.time() + Time::from_s(seconds).unwrap();
    simulation.advance_to(end, Time::from_s(step_s).unwrap()).unwrap();
}

/// The value of a channel.
///
/// # Panics
/// Where there is none of this name.
pub fn get(simulation: &Simulation, channel: &str) -> f64 {
    simulation.get(simulation.channel(channel).unwrap_or_else(|error| panic!("{channel}: {error}")))
}
