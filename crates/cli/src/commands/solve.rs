//! `anergy solve`: the steady state.

use super::run::read_model;
use crate::failure::Failure;
use crate::output::line;
use crate::tables;
use anergy_simulation::error::RunError;
use anergy_simulation::steady;
use std::path::Path;

/// Solves a model file.
pub fn solve(path: &Path, json: Option<&Path>) -> Result<(), Failure> {
    let (text, model) = read_model(path)?;
    let steady = steady::solve(&model).map_err(|error| match error {
        RunError::Model(problems) => {
            Failure::Model { problems, file: path.display().to_string(), text }
        }
        other => Failure::Run(other),
    })?;
    let table = || serde_json::to_string_pretty(&steady).map_err(|e| Failure::File(e.to_string()));
    match json {
        Some(json) if json == Path::new("-") => line!("{}", table()?),
        Some(json) => {
            std::fs::write(json, table()? + "\n")
                .map_err(|error| Failure::file("cannot write", json, &error))?;
            tables::print_steady(&model, &steady);
        }
        None => tables::print_steady(&model, &steady),
    }
    Ok(())
}
