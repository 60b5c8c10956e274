//! One member: its run, and what is kept of it.

use anergy_core::clock::Time;
use anergy_core::error::RecordError;
use anergy_core::recorder::{Channel, Event, Recorder, RunHeader};
use anergy_recording::selection::glob;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use anergy_simulation::plan::Plan;
use anergy_simulation::run::{self, RunOptions};
use anergy_simulation::simulation::Simulation;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Recorded rows of chosen channels.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Series {
    /// Times of the rows, s since the start.
    pub time_s: Vec<f64>,
    /// A column per channel, in the order in which they were chosen.
    pub columns: Vec<Vec<f64>>,
}

/// What is kept of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Kept {
    /// Indicators by name.
    pub kpis: Map<String, Value>,
    /// Chosen channels; nothing where none were chosen.
    pub series: Series,
}

/// What became of a member.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Its number, from 0.
    pub member: usize,
    /// What varied, one value per variation, as written in the definition.
    pub values: Vec<Value>,
    /// What is kept, or why the run failed.
    pub result: Result<Kept, String>,
}

/// Indicators and channels that are wanted.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Wanted {
    /// Names, in which `*` is any text.
    pub kpis: Vec<String>,
    /// Names.
    pub channels: Vec<String>,
}

/// Runs a model with changes; `None` when it was stopped.
pub(crate) fn run(
    base: &Model,
    changes: &[Change],
    options: RunOptions,
    wanted: &Wanted,
    keep_going: &mut dyn FnMut() -> bool,
) -> Option<Result<Kept, String>> {
    guarded(|| kept(plan(base, changes)?, options, wanted, keep_going)).transpose()
}

/// Whether there is a model with these changes.
///
/// # Errors
/// Why not.
pub(crate) fn check(base: &Model, changes: &[Change]) -> Result<(), String> {
    guarded(|| plan(base, changes).map(|_| ()))
}

/// A defect of the program in one member does not take the others along.
fn guarded<T>(member: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(member)).unwrap_or_else(|panic| {
        let said = panic.downcast_ref::<String>().map(String::as_str);
        let said = said.or(panic.downcast_ref::<&str>().copied()).unwrap_or("without a message");
        Err(format!("the program failed: {said}"))
    })
}

fn plan(base: &Model, changes: &[Change]) -> Result<Arc<Plan>, String> {
    let model = base.with(changes).map_err(|error| error.to_string())?;
    build(&model).map_err(|problems| problems.to_string())
}

fn kept(
    plan: Arc<Plan>,
    options: RunOptions,
    wanted: &Wanted,
    keep_going: &mut dyn FnMut() -> bool,
) -> Result<Option<Kept>, String> {
    let mut simulation = Simulation::new(plan).map_err(|error| error.to_string())?;
    let mut rows = Rows { wanted: &wanted.channels, chosen: Vec::new(), series: Series::default() };
    let recorder = Box::new(&mut rows);
    let report = run::run(&mut simulation, options, recorder, &mut |_, _| keep_going());
    let report = report.map_err(|error| error.to_string())?;
    if report.interrupted {
        return Ok(None);
    }
    let kpis = indicators(&report.summary["kpis"], &wanted.kpis);
    Ok(Some(Kept { kpis, series: rows.series }))
}

/// Indicators of the grid, then of sites, stations and units: `component.quantity_unit` and number.
pub(crate) fn indicators(told: &Value, patterns: &[String]) -> Map<String, Value> {
    let mut found = Map::new();
    let mut add = |component: &str, numbers: &Value| {
        for (name, value) in numbers.as_object().into_iter().flatten() {
            let name = format!("{component}.{name}");
            if value.is_number() && patterns.iter().any(|pattern| glob(pattern, &name)) {
                found.insert(name, value.clone());
            }
        }
    };
    add("network", &told["network"]);
    for group in ["sites", "stations", "units"] {
        for (component, numbers) in told[group].as_object().into_iter().flatten() {
            add(component, numbers);
        }
    }
    found
}

/// Keeps the rows of chosen channels.
struct Rows<'a> {
    wanted: &'a [String],
    chosen: Vec<usize>,
    series: Series,
}

impl Recorder for &mut Rows<'_> {
    fn start(&mut self, _: &RunHeader, channels: &[Channel]) -> Result<(), RecordError> {
        let place = |name: &String| channels.iter().position(|channel| channel.name == *name);
        self.chosen = self.wanted.iter().filter_map(place).collect();
        self.series.columns = vec![Vec::new(); self.chosen.len()];
        Ok(())
    }

    fn row(&mut self, time: Time, values: &[f64]) -> Result<(), RecordError> {
        if self.chosen.is_empty() {
            return Ok(());
        }
        self.series.time_s.push(time.as_s());
        for (column, channel) in self.series.columns.iter_mut().zip(&self.chosen) {
            column.push(values[*channel]);
        }
        Ok(())
    }

    fn event(&mut self, _: &Event) -> Result<(), RecordError> {
        Ok(())
    }

    fn finish(self: Box<Self>, _: &Value) -> Result<(), RecordError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_defect_of_the_program_is_a_failed_member() {
        let found: Result<(), String> = guarded(|| panic!("index 3 of 2"));
        assert_eq!(found, Err("the program failed: index 3 of 2".to_owned()));
        assert_eq!(guarded(|| Ok(1)), Ok(1));
    }
}
