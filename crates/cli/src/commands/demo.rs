//! `anergy demo`: the three-house pump-blocking study, embedded in the program.

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

/// Runs the study.
pub fn demo(out: &Path) -> Result<(), Failure> {
    let file = "examples/three-houses/model.toml";
    let model = Model::from_toml(MODEL, Path::new(".")).map_err(|problems| Failure::Model {
        problems,
        file: file.into(),
        text: MODEL.into(),
    })?;
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
