//! `anergy demo`: the three-house pump-blocking study, and a pipe with a hidden effect, embedded in the program.

use super::explain::{Case, find_in};
use super::run::{finished, print_files, run_into};
use crate::failure::Failure;
use crate::output::line;
use crate::tables;
use anergy_simulation::model::Model;
use anergy_simulation::run::RunOptions;
use std::path::Path;

const MODEL: &str = include_str!("../../../../examples/three-houses/model.toml");
/// Just before the pump of SF2 is slowed down, and the end of the run.
const BEFORE_AND_AFTER_S: [f64; 2] = [2220.0, 3600.0];

const HIDDEN: [&str; 3] = [
    include_str!("../../../../examples/hidden-effect/model.toml"),
    include_str!("../../../../examples/hidden-effect/data.csv"),
    include_str!("../../../../examples/hidden-effect/sensors.toml"),
];

/// What can be shown besides the study.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub enum Show {
    /// A pipe with a hidden effect, found and added (half a minute)
    Explain,
}

/// Shows the study, or something else.
pub fn demo(show: Option<Show>, out: Option<&Path>) -> Result<(), Failure> {
    match show {
        None => study(out.unwrap_or(Path::new("results/demo"))),
        Some(Show::Explain) => explained(out.unwrap_or(Path::new("results/demo-explain"))),
    }
}

fn model(text: &str, file: &str) -> Result<Model, Failure> {
    Model::from_toml(text, Path::new(".")).map_err(|problems| Failure::Model {
        problems,
        file: file.into(),
        text: text.into(),
    })
}

fn explained(out: &Path) -> Result<(), Failure> {
    let [text, data, sensors] = HIDDEN;
    let file = "examples/hidden-effect/model.toml";
    line!("A pipe between two meters: hot water arrives later than the model says. Why?\n");
    let case = Case { text, file, stem: "model", data, sensors, split: None };
    find_in(model(text, file)?, &case, out)
}

/// Runs the study.
fn study(out: &Path) -> Result<(), Failure> {
    let file = "examples/three-houses/model.toml";
    let model = model(MODEL, file)?;
    line!("{}: the far feeder SF1 is held back by the near feeder SF2,", model.name);
    line!("until the pump of SF2 is slowed down from 100 % to 85 % at 2230 s.\n");
    let recording = run_into(&model, MODEL, file, RunOptions::default(), out)?;
    tables::print_stations_at(&recording, &BEFORE_AND_AFTER_S, model.medium.density_kg_m3);
    line!("");
    tables::print_events(&recording.events);
    line!("");
    tables::print_key_results(&recording.summary);
    print_files(out);
    finished()
}
