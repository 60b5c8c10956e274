//! `anergy solve`: the steady state.

use super::run::read_model;
use crate::failure::Failure;
use crate::output::line;
use crate::tables;
use anergy_simulation::build::build;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use std::path::Path;

/// Solves a model file.
pub fn solve(path: &Path, json: Option<&Path>) -> Result<(), Failure> {
    let (text, model) = read_model(path)?;
    let plan = build(&model).map_err(|problems| Failure::Model {
        problems,
        file: path.display().to_string(),
        text,
    })?;
    // The plan has what is solved: a large model need not stand beside it.
    let density_kg_m3 = model.medium.density_kg_m3;
    drop(model);
    let mut simulation = Simulation::new(plan)?;
    let report = steady::settle(&mut simulation)?;
    let steady = steady::table(&simulation, report);
    drop(simulation);
    let table = || serde_json::to_string_pretty(&steady).map_err(|e| Failure::File(e.to_string()));
    match json {
        Some(json) if json == Path::new("-") => line!("{}", table()?),
        Some(json) => {
            std::fs::write(json, table()? + "\n")
                .map_err(|error| Failure::file("cannot write", json, &error))?;
            tables::print_steady(density_kg_m3, &steady);
        }
        None => tables::print_steady(density_kg_m3, &steady),
    }
    Ok(())
}
