//! A whole run into a recorder.

use crate::automatic_step::Step;
use crate::balance;
use crate::error::RunError;
use crate::model_file::StepEntry;
use crate::simulation::Simulation;
use anergy_core::clock::Time;
use anergy_core::recorder::{Recorder, RunHeader};
use serde_json::Value;

/// What a run is told besides its model; `None` takes the model's `[run]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RunOptions {
    /// End of the run.
    pub until: Option<Time>,
    /// Largest time step, or an automatic one.
    pub step: Option<StepEntry>,
    /// Time between recorded rows.
    pub record: Option<Time>,
}

/// What a run was.
#[derive(Debug, Clone, PartialEq)]
pub struct RunReport {
    /// Whether it was stopped before its end.
    pub interrupted: bool,
    /// Key results, balances, statistics.
    pub summary: Value,
}

/// Runs a simulation from its present time to its end; `keep_going` is asked after every recorded row
/// with the simulated time and the end, and stops the run by answering false.
///
/// # Errors
/// What made it stop; the rows until then have been recorded and the recorder is finished.
pub fn run(
    simulation: &mut Simulation,
    options: RunOptions,
    mut recorder: Box<dyn Recorder + '_>,
    keep_going: &mut dyn FnMut(Time, Time) -> bool,
) -> Result<RunReport, RunError> {
    let plan = simulation.plan().clone();
    let until = options.until.unwrap_or(plan.until);
    let step = plan.step_of(options.step);
    let record = options.record.unwrap_or(plan.record);
    recorder.start(&header(&plan, until, step, record), plan.channels())?;
    let mut row = vec![0.0; plan.channels().len()];
    let mut interrupted = false;
    let mut write = |simulation: &mut Simulation, recorder: &mut dyn Recorder| {
        simulation.fill_row(&mut row);
        recorder.row(simulation.time(), &row)?;
        for event in simulation.take_events() {
            recorder.event(&event)?;
        }
        Ok::<(), RunError>(())
    };
    for event in simulation.unit_remarks() {
        recorder.event(&event)?;
    }
    for event in simulation.coarse_steps(step) {
        recorder.event(&event)?;
    }
    write(simulation, recorder.as_mut())?;
    let mut failure = None;
    while simulation.time() < until {
        let target = until.min(simulation.time().next_multiple(record));
        if let Err(error) = simulation.advance_to(target, step) {
            failure = Some(error);
            break;
        }
        write(simulation, recorder.as_mut())?;
        if !keep_going(simulation.time(), until) {
            interrupted = simulation.time() < until;
            break;
        }
    }
    let mut summary = balance::summary(simulation, interrupted || failure.is_some());
    if let Some(error) = &failure {
        summary["error"] = Value::from(error.to_string());
    }
    recorder.finish(&summary)?;
    match failure {
        Some(error) => Err(error),
        None => Ok(RunReport { interrupted, summary }),
    }
}

fn header(plan: &crate::plan::Plan, until: Time, step: Step, record: Time) -> RunHeader {
    let setting = |name: &str, value: String| (name.to_owned(), value);
    let origin = plan.origin_rad.into_iter().flat_map(|[latitude, longitude]| {
        let deg = |rad: f64| rad.to_degrees().to_string();
        [setting("latitude_deg", deg(latitude)), setting("longitude_deg", deg(longitude))]
    });
    let seeds: Vec<String> =
        plan.seeds.iter().map(|(name, seed)| format!("{name} {seed}")).collect();
    let seeds = (!seeds.is_empty()).then(|| setting("random_seeds", seeds.join(", ")));
    RunHeader {
        model_name: plan.model_name.clone(),
        model_text: plan.model_text.to_string(),
        start_unix_ns: plan.start_unix_ns,
        settings: [
            setting("program", format!("anergy {}", env!("CARGO_PKG_VERSION"))),
            setting("until", until.to_string()),
            setting("step", step.to_string()),
            setting("record", record.to_string()),
            setting("density_kg_m3", plan.network.medium.density_kg_m3.to_string()),
            setting("heat_capacity_j_kg_k", plan.network.medium.heat_capacity_j_kg_k.to_string()),
        ]
        .into_iter()
        .chain(origin)
        .chain(seeds)
        .collect(),
        map: plan.map(),
    }
}
