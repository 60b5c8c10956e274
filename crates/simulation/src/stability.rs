//! Who blocks whom, which loops will hunt, and how far it is to the limit: without simulating.
//!
//! The operating point is the steady state of the model; [`hunting`] takes the loops there apart, [`blocking`] the
//! feeders.

pub mod blocking;
mod chain;
mod law;
mod loops;
mod modes;
mod secant;

use crate::build::build;
use crate::channels::Source;
use crate::error::RunError;
use crate::gains::{Gains, measured, reach};
use crate::model::Model;
use crate::plan::{Plan, PlannedController};
use crate::simulation::Simulation;
use crate::state::State;
use crate::steady::settle;
use anergy_network::hydraulics::linearize::Valves;
use law::Law;
use loops::{Loops, Seen};
use nalgebra::DMatrix;
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Loops whose gains over each other are smaller than this, relative to their own, are apart.
const COUPLED: f64 = 1e-9;

/// A mode in which controllers and network swing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mode {
    /// Period, s.
    pub period_s: f64,
    /// Growth of its amplitude, 1/s; negative decays.
    pub growth_per_s: f64,
    /// Damping ratio; negative grows.
    pub damping: f64,
    /// Share of each controller that takes part; all together 1.
    pub participation: BTreeMap<String, f64>,
    /// Phase of the output of each controller against the one that takes part most, degrees.
    pub phase_deg: BTreeMap<String, f64>,
    /// Modes that are equal to this one, itself included.
    pub multiplicity: usize,
}

/// How far a controller is from the limit of its group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoopMargin {
    /// Name of the controller.
    pub id: String,
    /// Its gain, actuator unit per SI unit of what it measures.
    pub gain: f64,
    /// Its gain when all gains of its group are scaled to the limit; `None` without a limit, or when its
    /// loop is open.
    pub critical_gain: Option<f64>,
    /// Period at that limit, s.
    pub critical_period_s: Option<f64>,
    /// Its gain at the limit of its own loop, all other controllers of the group switched off.
    pub critical_gain_alone: Option<f64>,
    /// Controllers of its group: those that it acts on, and that act on it.
    pub group: Vec<String>,
    /// Gain with all other loops of the group open over that with them closed and perfect; near 1 a loop
    /// hardly sees the others, negative it turns round when they close.
    pub relative_gain: Option<f64>,
    /// Whether no mode of its group grows.
    pub stable: bool,
    /// Why it is not judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open: Option<&'static str>,
}

/// What the loops of a model will do.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Hunting {
    /// Oscillating modes, the fastest growing first.
    pub modes: Vec<Mode>,
    /// The controllers, in the order of the model.
    pub controllers: Vec<LoopMargin>,
}

/// Who blocks whom and which loops will hunt.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Stability {
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
    let Hunting { modes, controllers } = hunting(&simulation)?;
    Ok(Stability { modes, controllers })
}

/// A controller with its law, where its loop is closed.
struct Closed {
    controller: usize,
    law: Law,
}

/// Analyses the loops of a simulation that rests in its steady state.
///
/// # Errors
/// When the network cannot be linearised.
pub fn hunting(simulation: &Simulation) -> Result<Hunting, RunError> {
    let (plan, state) = (&**simulation.plan(), simulation.state());
    let mut hunting = Hunting::default();
    let mut closed = Vec::new();
    for (controller, planned) in plan.controllers.iter().enumerate() {
        let law = Law::of(plan, state, planned, planned.interval.as_s());
        let open = if law.held.iter().all(|held| *held) {
            Some("its output is at a limit")
        } else if law.is_idle() {
            Some("its output does not follow what it measures")
        } else {
            None
        };
        hunting.controllers.push(LoopMargin {
            id: planned.name.clone(),
            gain: planned.controller.gain(),
            critical_gain: None,
            critical_period_s: None,
            critical_gain_alone: None,
            group: Vec::new(),
            relative_gain: None,
            stable: true,
            open,
        });
        if open.is_none() {
            closed.push(Closed { controller, law });
        }
    }
    let gains = gains(simulation, &closed)?;
    for group in groups(plan, &closed, &gains) {
        judge(plan, state, &closed, &group, &gains, &mut hunting);
    }
    hunting.modes.sort_by(|a, b| b.growth_per_s.total_cmp(&a.growth_per_s));
    Ok(hunting)
}

/// Gains of the measured values (rows) over the outputs of closed loops.
fn gains(simulation: &Simulation, closed: &[Closed]) -> Result<DMatrix<f64>, RunError> {
    let (plan, state) = (&**simulation.plan(), simulation.state());
    let sources: Vec<Source> = closed
        .iter()
        .flat_map(|c| &plan.controllers[c.controller].measures)
        .map(|source| measured(plan, *source).0)
        .collect();
    let outputs: Vec<_> = closed
        .iter()
        .flat_map(|c| plan.controllers[c.controller].acts_on.iter().copied())
        .collect();
    let mut matrix = DMatrix::zeros(sources.len(), outputs.len());
    let mut network = Gains::new(plan, state, Valves::Stay)
        .map_err(|error| crate::simulation::named(plan, state.time, &error))?;
    for (j, signal) in outputs.iter().enumerate() {
        let Some(reach) = reach(plan, state, *signal) else { continue };
        for (i, gain) in network.column(plan, state, &reach, &sources).into_iter().enumerate() {
            matrix[(i, j)] = gain.unwrap_or(0.0);
        }
    }
    Ok(matrix)
}

fn inputs(planned: &PlannedController) -> usize {
    planned.measures.len()
}

/// Places of each closed controller's measured values and outputs.
fn places(plan: &Plan, closed: &[Closed]) -> Vec<(std::ops::Range<usize>, std::ops::Range<usize>)> {
    let (mut seen, mut out) = (0, 0);
    let mut places = Vec::new();
    for c in closed {
        let planned = &plan.controllers[c.controller];
        let (n_in, n_out) = (inputs(planned), planned.acts_on.len());
        places.push((seen..seen + n_in, out..out + n_out));
        seen += n_in;
        out += n_out;
    }
    places
}

/// Closed loops that act on each other.
fn groups(plan: &Plan, closed: &[Closed], gains: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let places = places(plan, closed);
    let strength = |i: usize, j: usize| {
        let block = gains
            .view((places[i].0.start, places[j].1.start), (places[i].0.len(), places[j].1.len()));
        block.amax()
    };
    let coupled = |i: usize, j: usize| {
        let both = strength(i, j) * strength(j, i);
        both > COUPLED * strength(i, i) * strength(j, j)
    };
    let mut group_of: Vec<usize> = (0..closed.len()).collect();
    for i in 0..closed.len() {
        for j in 0..i {
            let (a, b) = (group_of[i], group_of[j]);
            if a != b && coupled(i, j) {
                group_of.iter_mut().filter(|group| **group == a).for_each(|group| *group = b);
            }
        }
    }
    let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, group) in group_of.into_iter().enumerate() {
        groups.entry(group).or_default().push(i);
    }
    groups.into_values().collect()
}

/// The loops of some closed controllers.
fn loops(
    plan: &Plan,
    state: &State,
    closed: &[Closed],
    group: &[usize],
    gains: &DMatrix<f64>,
) -> Loops {
    let places = places(plan, closed);
    let rows: Vec<usize> = group.iter().flat_map(|&i| places[i].0.clone()).collect();
    let columns: Vec<usize> = group.iter().flat_map(|&i| places[i].1.clone()).collect();
    let own = DMatrix::from_fn(rows.len(), columns.len(), |i, j| gains[(rows[i], columns[j])]);
    let planned = || group.iter().map(|&i| &plan.controllers[closed[i].controller]);
    let seen: Vec<Seen> = planned()
        .flat_map(|planned| &planned.measures)
        .map(|source| match source {
            Source::Sensor(i) => {
                let sensor = &plan.sensors[*i].sensor;
                Seen { lag_s: sensor.time_constant_s(), dead_s: sensor.dead_time_s() }
            }
            _ => Seen { lag_s: 0.0, dead_s: 0.0 },
        })
        .collect();
    let lags: Vec<f64> = planned()
        .flat_map(|planned| &planned.acts_on)
        .map(|signal| reach(plan, state, *signal).map_or(0.0, |reach| reach.lag_s))
        .collect();
    let interval_s = planned().map(|planned| planned.interval.as_s()).fold(0.0, f64::max);
    let laws = group.iter().map(|&i| closed[i].law.clone()).collect();
    Loops::new(laws, own, &seen, &lags, interval_s)
}

/// Analyses one group.
fn judge(
    plan: &Plan,
    state: &State,
    closed: &[Closed],
    group: &[usize],
    gains: &DMatrix<f64>,
    hunting: &mut Hunting,
) {
    let whole = loops(plan, state, closed, group, gains);
    let found = modes::analyse(&whole);
    let name = |i: usize| plan.controllers[closed[group[i]].controller].name.clone();
    for root in &found.roots {
        let (shares, phases) = whole.shape(root.s);
        hunting.modes.push(Mode {
            period_s: TAU / root.s.im,
            growth_per_s: root.s.re,
            damping: -root.s.re / root.s.norm(),
            participation: shares.iter().enumerate().map(|(i, share)| (name(i), *share)).collect(),
            phase_deg: phases
                .iter()
                .enumerate()
                .map(|(k, phase)| (name(whole.owner[k]), phase.to_degrees()))
                .collect(),
            multiplicity: root.times,
        });
    }
    let names: Vec<String> = (0..group.len()).map(name).collect();
    let relative = whole.relative_gains();
    for (i, &k) in group.iter().enumerate() {
        let margin = &mut hunting.controllers[closed[k].controller];
        margin.group.clone_from(&names);
        margin.stable = found.growing == 0;
        margin.critical_gain = found.limit.map(|limit| margin.gain * limit.factor);
        margin.critical_period_s = found.limit.map(|limit| TAU / limit.omega_rad_s);
        margin.relative_gain = relative.as_ref().map(|relative| relative[i]);
        let alone = modes::analyse(&loops(plan, state, closed, &[k], gains));
        margin.critical_gain_alone = alone.limit.map(|limit| margin.gain * limit.factor);
    }
}
