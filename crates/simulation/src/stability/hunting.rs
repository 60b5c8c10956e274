//! Which loops will hunt: modes of the closed loops of controllers, sensors, actuators and network, and the gains
//! at which the first of them stops decaying. What lies between outputs and measured values: `answers.rs`.

use super::answers::{Answers, Link, answers, is_set_point};
use super::chains::Seen;
use super::in_pieces;
use super::law::Law;
use super::loops::{Between, Loops};
use super::modes::Found;
use super::periodic::{PeriodicLoops, Ticks};
use super::water::Late;
use crate::channels::Source;
use crate::error::RunError;
use crate::gains::reach;
use crate::plan::{Plan, PlannedController};
use crate::simulation::Simulation;
use crate::state::State;
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
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
    /// loop is open; 0 where it grows at any gain, because of its sign or its pairing.
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

/// A controller with its law, where its loop is closed.
struct Closed {
    controller: usize,
    law: Law,
}

/// Analyses the loops of a simulation that rests in its steady state.
///
/// # Errors
/// When the network cannot be linearised.
pub fn hunting(simulation: &mut Simulation) -> Result<Hunting, RunError> {
    let plan = simulation.plan().clone();
    let plan = &*plan;
    let state = simulation.state();
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
    drop_without_follower(plan, &mut closed, &mut hunting);
    let controllers: Vec<usize> = closed.iter().map(|c| c.controller).collect();
    let answers = match answers(simulation, &controllers)? {
        Ok(answers) => answers,
        Err(reason) => {
            let margins = &mut hunting.controllers;
            controllers.iter().for_each(|&i| margins[i].open = Some(reason));
            return Ok(hunting);
        }
    };
    for group in groups(plan, &closed, &answers) {
        judge(plan, simulation.state(), &closed, &group, &answers, &mut hunting);
    }
    hunting.modes.sort_by(|a, b| b.growth_per_s.total_cmp(&a.growth_per_s));
    Ok(hunting)
}

/// A controller whose only outputs are set points of controllers with open loops has one too.
fn drop_without_follower(plan: &Plan, closed: &mut Vec<Closed>, hunting: &mut Hunting) {
    loop {
        let acts = |c: &Closed| {
            plan.controllers[c.controller].acts_on.iter().any(|signal| {
                is_set_point(plan, *signal)
                    .is_none_or(|(held, _)| closed.iter().any(|other| other.controller == held))
            })
        };
        let Some(idle) = closed.iter().position(|c| !acts(c)) else { return };
        let reason = "the controller whose set point it moves has an open loop";
        hunting.controllers[closed.remove(idle).controller].open = Some(reason);
    }
}

/// Places of each closed controller's measured values and outputs.
fn places(plan: &Plan, closed: &[Closed]) -> Vec<(std::ops::Range<usize>, std::ops::Range<usize>)> {
    let (mut seen, mut out) = (0, 0);
    let mut places = Vec::new();
    for c in closed {
        let planned = &plan.controllers[c.controller];
        let (n_in, n_out) = (planned.measures.len(), planned.acts_on.len());
        places.push((seen..seen + n_in, out..out + n_out));
        seen += n_in;
        out += n_out;
    }
    places
}

/// Closed loops that act on each other.
fn groups(plan: &Plan, closed: &[Closed], answers: &Answers) -> Vec<Vec<usize>> {
    let places = places(plan, closed);
    let gains = &answers.gains;
    let linked = |i: usize, j: usize| {
        answers.links.iter().any(|link| [(i, j), (j, i)].contains(&(link.from, link.to)))
    };
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
            if a != b && (linked(i, j) || coupled(i, j)) {
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

/// A group of closed controllers with what it takes to analyse it.
struct Group<'a> {
    planned: Vec<&'a PlannedController>,
    laws: Vec<Law>,
    between: Between,
}

impl<'a> Group<'a> {
    fn new(
        plan: &'a Plan,
        state: &State,
        closed: &[Closed],
        members: &[usize],
        answers: &Answers,
    ) -> Self {
        let places = places(plan, closed);
        let rows: Vec<usize> = members.iter().flat_map(|&i| places[i].0.clone()).collect();
        let columns: Vec<usize> = members.iter().flat_map(|&i| places[i].1.clone()).collect();
        let place = |all: &[usize], one: usize| all.iter().position(|i| *i == one);
        let slow = answers.slow.iter().filter_map(|(i, j, response)| {
            Some((place(&rows, *i)?, place(&columns, *j)?, response.clone()))
        });
        let planned: Vec<&PlannedController> =
            members.iter().map(|&i| &plan.controllers[closed[i].controller]).collect();
        let sensor = |source: &Source| match source {
            Source::Sensor(i) => {
                let sensor = &plan.sensors[*i].sensor;
                Seen { lag_s: sensor.time_constant_s(), dead_s: sensor.dead_time_s() }
            }
            _ => Seen { lag_s: 0.0, dead_s: 0.0 },
        };
        let lag = |signal: &SignalId| reach(plan, state, *signal).map_or(0.0, |reach| reach.lag_s);
        let part = |gains: &DMatrix<f64>| {
            DMatrix::from_fn(rows.len(), columns.len(), |i, j| gains[(rows[i], columns[j])])
        };
        let late = answers.late.iter().map(|late| Late { gains: part(&late.gains), ..*late });
        let links = answers.links.iter().filter_map(|link| {
            let member = |one: usize| place(members, one);
            let (from, to) = (member(link.from)?, member(link.to)?);
            Some(Link { output: place(&columns, link.output)?, from, to, ..*link })
        });
        let between = Between {
            gains: part(&answers.gains),
            late: late.filter(|late| late.gains.amax() > 0.0).collect(),
            slow: slow.collect(),
            seen: planned.iter().flat_map(|c| &c.measures).map(sensor).collect(),
            lags_s: planned.iter().flat_map(|c| &c.acts_on).map(lag).collect(),
            links: links.collect(),
        };
        let laws = members.iter().map(|&i| closed[i].law.clone()).collect();
        Self { planned, laws, between }
    }

    /// The loops, where all controllers update together; the interval is 0 where they are continuous.
    fn together(&self) -> Loops {
        let interval = self.planned.iter().map(|c| c.interval).max().unwrap_or(Time::ZERO);
        Loops::new(self.laws.clone(), self.between.clone(), interval.as_s())
    }

    /// Whether they do.
    fn is_together(&self) -> bool {
        let timing = |c: &PlannedController| (c.interval, c.controller.timing().offset_s.to_bits());
        self.planned.iter().all(|c| timing(c) == timing(self.planned[0]))
    }

    /// What the loops do, or why that is not known; with the loops as if they updated together.
    fn analyse(&self, plan: &Plan, state: &State) -> Result<(Found, Loops), &'static str> {
        let together = self.together();
        if self.is_together() {
            return Ok((super::modes::analyse(&together), together));
        }
        if !self.between.late.is_empty() {
            return Err(
                "its group updates at different times, which is not analysed for water with inertia",
            );
        }
        let many = "its group updates at too many different times to be analysed";
        if !self.between.slow.is_empty() {
            return Err(many);
        }
        // What is continuous updates at every step of a run.
        let every = |c: &PlannedController| {
            if c.interval > Time::ZERO { c.interval.0 } else { plan.step.0 }
        };
        let first = |c: &PlannedController| {
            Time::from_s(c.controller.timing().offset_s).unwrap_or(Time::ZERO).0
        };
        let all = self.planned.iter().flat_map(|c| [every(c), first(c)]);
        let tick = all.fold(0, super::periodic::gcd);
        let of_step = |c: &&PlannedController| {
            let interval_s = if c.interval > Time::ZERO { c.interval } else { plan.step }.as_s();
            Law::of(plan, state, c, interval_s)
        };
        let loops = PeriodicLoops {
            laws: self.planned.iter().map(of_step).collect(),
            ticks: self
                .planned
                .iter()
                .map(|c| Ticks { every: every(c) / tick, first: first(c) / tick })
                .collect(),
            gains: self.between.gains.clone(),
            seen: self.between.seen.clone(),
            actuator_lags_s: self.between.lags_s.clone(),
            links: self.between.links.clone(),
            tick_s: Time(tick).as_s(),
        };
        Ok((loops.analyse().ok_or(many)?, together))
    }
}

/// Analyses one group.
fn judge(
    plan: &Plan,
    state: &State,
    closed: &[Closed],
    group: &[usize],
    answers: &Answers,
    hunting: &mut Hunting,
) {
    // With different timing, shapes are those of the loops as if they updated together.
    let (found, whole) = match Group::new(plan, state, closed, group, answers).analyse(plan, state)
    {
        Ok(found) => found,
        Err(reason) => {
            for &i in group {
                hunting.controllers[closed[i].controller].open = Some(reason);
            }
            return;
        }
    };
    let name = |i: usize| plan.controllers[closed[group[i]].controller].name.clone();
    let shapes = in_pieces(group.len(), found.roots.len(), |k| whole.shape(found.roots[k].s));
    for (root, (shares, phases)) in found.roots.iter().zip(shapes) {
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
    let limits_alone = in_pieces(group.len(), group.len(), |i| {
        let alone = Group::new(plan, state, closed, &[group[i]], answers).analyse(plan, state);
        alone.ok().and_then(|(alone, _)| alone.limit)
    });
    for ((i, &k), limit) in group.iter().enumerate().zip(limits_alone) {
        let margin = &mut hunting.controllers[closed[k].controller];
        margin.group.clone_from(&names);
        margin.stable = found.growing == 0;
        // Without the sign of a gain that is none.
        margin.critical_gain = found.limit.map(|limit| margin.gain * limit.factor + 0.0);
        margin.critical_period_s = found
            .limit
            .filter(|limit| limit.omega_rad_s > 0.0)
            .map(|limit| TAU / limit.omega_rad_s);
        margin.relative_gain = relative.as_ref().map(|relative| relative[i]);
        margin.critical_gain_alone = limit.map(|limit| margin.gain * limit.factor);
    }
}
