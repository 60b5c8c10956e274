//! Remedies against hunting, blocking and cold plugs: each is a few changed values of the model, and each is tried in a run.
//!
//! **Method** every remedy is run from the steady state with the set point of one controller pushed by 15 % after
//! a minute; what hunts, oscillates or is blocked at the end of the run decides. Gains: half of the critical
//! one (6 dB), and divided by the relative gain of their loop, which for feeders at one shared resistance is about
//! `1 + R_shared/R_own`. Speed cap: the speeds of the pumps that hold a blocked feeder back are lowered in
//! proportion until it delivers half of what it means to. Pressure limit: the same pumps hold the pressure differences
//! that they have then, which stay what they are where valves close. Flushing: `flush.rs`. **Sources** specification 4.3.

use super::{Stability, analyse, flush};
use crate::build::build;
use crate::error::RunError;
use crate::model::{DriverSpec, Model, Place};
use crate::model_file::{InitialState, Interpolation};
use crate::simulation::Simulation;
use crate::steady;
use anergy_control::controllers::ControllerParams;
use anergy_core::clock::Time;
use anergy_core::recorder::Event;
use anergy_network::elements::ElementParams;
use anergy_network::elements::pump::{PumpMode, PumpParams};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Share of the critical gain that is safe.
const SAFE: f64 = 0.5;
const PUSH: f64 = 0.15;
const PUSHED_AT_S: f64 = 60.0;
/// Shortest run after the push, s, and periods that it covers.
const AFTER_S: f64 = 900.0;
const PERIODS: f64 = 80.0;
/// Longest step of a run that is to show hunting, s.
const STEP_S: f64 = 0.1;
const STAGGERED_S: f64 = 1.0;
/// Share of the requested flow that frees a feeder, and a little more.
const FREE: f64 = 0.5;
const REACHED: f64 = 1.02;

/// What a run showed at its end.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Outcome {
    /// Pumps that hunt or oscillate.
    pub swinging: BTreeSet<String>,
    /// Stations that are blocked.
    pub blocked: BTreeSet<String>,
    /// Stations that took heat and got cold water when a feeder started, and how long, s.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub cold_s: BTreeMap<String, f64>,
}

impl Outcome {
    /// Notes what begins and what ends.
    pub(super) fn hear(&mut self, event: Event) {
        let set = match event.kind.as_str() {
            "hunting" | "oscillating" | "hunting_ended" | "oscillating_ended" => &mut self.swinging,
            "blocked" | "unblocked" => &mut self.blocked,
            _ => return,
        };
        let begins = matches!(event.kind.as_str(), "hunting" | "oscillating" | "blocked");
        if begins {
            set.insert(event.component)
        } else {
            set.remove(&event.component)
        };
    }
}

/// A remedy and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Advice {
    /// `lower_gain`, `gain_scheduling`, `dead_band`, `staggered_sampling`, `speed_cap`, `dp_limit`, `flush`, `fed_flush`.
    pub remedy: &'static str,
    /// The values to write into the model file.
    pub changes: Vec<String>,
    /// What hunts and is blocked with it; `None` where it could not be run.
    pub outcome: Option<Outcome>,
    /// Whether what it is for is gone.
    pub helps: bool,
    /// One sentence.
    pub verdict: String,
}

/// Tries the remedies that fit what was found; the first entry of the pair is the run without any.
///
/// # Errors
/// When the model itself cannot be run.
pub fn advise(model: &Model, found: &Stability) -> Result<(Outcome, Vec<Advice>), RunError> {
    let horizon_s = horizon_s(found);
    let mut before = run(model, horizon_s)?;
    let mut advice = Vec::new();
    if !before.swinging.is_empty() || found.controllers.iter().any(|c| !c.stable) {
        for (remedy, changed) in hunting_remedies(model, found) {
            advice.push(tried(remedy, changed, horizon_s, &before, |o| &o.swinging));
        }
    }
    for feeder in &found.feeders {
        if (feeder.blocked || feeder.held_back)
            && let Some(capped) = speed_cap(model, &feeder.id)
        {
            let limited = dp_limit(model, &capped.0, &opponents(found, &feeder.id));
            for (remedy, changed) in [("speed_cap", Some(capped)), ("dp_limit", limited)] {
                advice.push(tried(remedy, changed, horizon_s, &before, |o| &o.blocked));
            }
        }
    }
    if let Some((cold_s, flushes)) = flush::advise(model)? {
        before.cold_s = cold_s;
        advice.extend(flushes);
    }
    Ok((before, advice))
}

fn horizon_s(found: &Stability) -> f64 {
    let longest = found.controllers.iter().filter_map(|c| c.critical_period_s).fold(0.0, f64::max);
    PUSHED_AT_S + AFTER_S.max(PERIODS * longest)
}

/// Runs a remedy.
fn tried(
    remedy: &'static str,
    changed: Option<(Model, Vec<String>)>,
    horizon_s: f64,
    before: &Outcome,
    of: fn(&Outcome) -> &BTreeSet<String>,
) -> Advice {
    let Some((model, changes)) = changed else {
        let verdict = "does not apply to this model".to_owned();
        return Advice { remedy, changes: Vec::new(), outcome: None, helps: false, verdict };
    };
    let stable = analyse(&model).map(|found| found.controllers.iter().all(|c| c.stable));
    match run(&model, horizon_s) {
        Ok(outcome) => {
            let left = of(&outcome);
            let helps = left.is_empty();
            let names: Vec<&str> = left.iter().map(String::as_str).collect();
            let verdict = match (helps, stable) {
                (true, Ok(false)) => "quiet in the run, but a mode still grows slowly".to_owned(),
                (true, _) => "helps".to_owned(),
                (false, _) if left.len() < of(before).len() => {
                    format!("helps in part: {} left", names.join(", "))
                }
                (false, _) => format!("does not help: {} as before", names.join(", ")),
            };
            Advice { remedy, changes, outcome: Some(outcome), helps, verdict }
        }
        Err(error) => {
            let verdict = format!("cannot be run: {error}");
            Advice { remedy, changes, outcome: None, helps: false, verdict }
        }
    }
}

/// What hunts and is blocked at the end of a run from the steady state with a push.
fn run(model: &Model, horizon_s: f64) -> Result<Outcome, RunError> {
    let mut model = model.clone();
    model.run.initial = InitialState::Steady;
    let step = Time::from_s(STEP_S).unwrap_or(Time::ZERO);
    push(&mut model);
    let mut simulation = Simulation::new(build(&model)?)?;
    let end = Time::from_s(horizon_s).unwrap_or(Time::ZERO);
    let mut outcome = Outcome::default();
    simulation.advance_to(end, step.min(simulation.plan().step()))?;
    simulation.take_events().for_each(|event| outcome.hear(event));
    Ok(outcome)
}

/// The set point of the first controller that nothing drives is pushed; all other schedules are as at t = 0.
fn push(model: &mut Model) {
    let driven = |signal: &str| model.drivers.iter().any(|driver| driver.signal == signal);
    let free = model.controllers.iter().find_map(|c| match &c.params {
        ControllerParams::Pi(pi) => {
            let signal = format!("{}.set_point", c.id);
            (!driven(&signal)).then_some((signal, pi.set_point))
        }
        _ => None,
    });
    let first = |driver: &DriverSpec| driver.values.first().copied();
    let (signal, value) = match free {
        Some(free) => free,
        None => {
            let driver = model.drivers.iter().find(|driver| driver.signal.ends_with(".set_point"));
            let Some((driver, value)) = driver.and_then(|d| Some((d, first(d)?))) else { return };
            (driver.signal.to_string(), value)
        }
    };
    model.drivers.retain(|driver| driver.signal != signal);
    model.drivers.push(DriverSpec {
        signal: signal.into(),
        unit: None,
        interpolation: Interpolation::Hold,
        times_s: [0.0, PUSHED_AT_S].into(),
        values: [value, value * (1.0 + PUSH)].into(),
        source: "push".into(),
        place: Place::default(),
    });
}

type Changed = Option<(Model, Vec<String>)>;

/// The model with each PI controller of a group that grows changed by `change`, which says what it did.
fn change_pi(
    model: &Model,
    found: &Stability,
    mut change: impl FnMut(
        usize,
        &super::LoopMargin,
        &mut anergy_control::controllers::pi::PiParams,
    ) -> Option<String>,
) -> Changed {
    let mut changed = model.clone();
    let mut changes = Vec::new();
    for (i, controller) in changed.controllers.iter_mut().enumerate() {
        let margin = found.controllers.get(i).filter(|margin| !margin.stable);
        if let (ControllerParams::Pi(pi), Some(margin)) = (&mut controller.params, margin)
            && let Some(said) = change(i, margin, pi)
        {
            changes.push(format!("{}: {said}", controller.id));
        }
    }
    (!changes.is_empty()).then_some((changed, changes))
}

fn hunting_remedies(model: &Model, found: &Stability) -> Vec<(&'static str, Changed)> {
    let n = found.controllers.len().max(1);
    let lower = change_pi(model, found, |_, margin, pi| {
        let critical = margin.critical_gain?;
        pi.gain = SAFE * critical;
        Some(format!("gain = {:.4}  # critical {critical:.4}", pi.gain))
    });
    let scheduled = change_pi(model, found, |_, margin, pi| {
        let relative = margin.relative_gain?;
        pi.gain /= relative.max(1.0);
        Some(format!("gain = {:.4}  # divided by the relative gain {relative:.2}", pi.gain))
    });
    let dead_band = change_pi(model, found, |_, _, pi| {
        pi.dead_band = 0.1 * pi.set_point.abs();
        Some(format!("dead_band = {:.6}  # a tenth of the set point", pi.dead_band))
    });
    #[allow(clippy::cast_precision_loss)]
    let staggered = change_pi(model, found, |i, _, pi| {
        pi.interval_s = STAGGERED_S;
        pi.offset_s = STAGGERED_S * i as f64 / n as f64;
        Some(format!("interval_s = {STAGGERED_S}, offset_s = {:.3}", pi.offset_s))
    });
    vec![
        ("lower_gain", lower),
        ("gain_scheduling", scheduled),
        ("dead_band", dead_band),
        ("staggered_sampling", staggered),
    ]
}

/// The pumps that hold a feeder back.
fn opponents(found: &Stability, feeder: &str) -> Vec<String> {
    let own = found.feeders.iter().find(|f| f.id == feeder);
    let all = own.into_iter().flat_map(|own| &own.opponents);
    all.filter(|o| o.quantity == "speed" && o.weight_pa > 0.0).map(|o| o.id.clone()).collect()
}

/// Pumps that hold the pressure differences they have with capped speeds; `None` where a controller drives one of them.
fn dp_limit(model: &Model, capped: &Model, pumps: &[String]) -> Changed {
    let steady = steady::solve(capped).ok()?;
    let mut changed = model.clone();
    let mut changes = Vec::new();
    for id in pumps {
        let signal = format!("{id}.speed");
        if model.controllers.iter().any(|c| c.acts_on.contains(&signal)) {
            return None;
        }
        let head_pa = -steady.edge(id)?.dp_pa;
        let edge = changed.edges.iter_mut().find(|edge| edge.id == id.as_str())?;
        let ElementParams::Pump(pump) = &mut edge.params else { continue };
        (pump.mode, pump.head_pa) = (PumpMode::Head, Some(head_pa.max(0.0)));
        // What commands a speed says nothing any more.
        let PumpParams { speed, initial_speed, speed_min, .. } = PumpParams::default();
        (pump.speed, pump.initial_speed, pump.speed_min) = (speed, initial_speed, speed_min);
        changed.drivers.retain(|driver| driver.signal != signal);
        changes.push(format!("{id}: mode = \"head\", head_pa = {head_pa:.0}, no speed"));
    }
    (!changes.is_empty()).then_some((changed, changes))
}

/// Lower speeds of the pumps that hold a feeder back.
fn speed_cap(model: &Model, feeder: &str) -> Changed {
    let with = |factor: f64| -> Changed {
        let found = analyse(model).ok()?;
        let mut changed = model.clone();
        let mut changes = Vec::new();
        for opponent in opponents(&found, feeder) {
            let other = found.feeders.iter().find(|f| f.id == opponent)?;
            let cap = factor * other.speed;
            let edge = changed.edges.iter_mut().find(|edge| edge.id == opponent.as_str())?;
            let ElementParams::Pump(pump) = &mut edge.params else { continue };
            pump.speed_max = cap;
            pump.speed = pump.speed.min(cap);
            pump.initial_speed = pump.initial_speed.min(cap);
            let signal = format!("{opponent}.speed");
            for driver in changed.drivers.iter_mut().filter(|driver| driver.signal == signal) {
                driver.values = driver.values.iter().map(|value| value.min(cap)).collect();
            }
            changes.push(format!("{opponent}: speed_max = {cap:.4}"));
        }
        (!changes.is_empty()).then_some((changed, changes))
    };
    let free = |factor: f64| {
        let (changed, _) = with(factor)?;
        let found = analyse(&changed).ok()?;
        let own = found.feeders.iter().find(|f| f.id == feeder)?;
        let wanted = own.requested_m_flow_kg_s?;
        Some(own.m_flow_kg_s >= FREE * REACHED * wanted)
    };
    let (mut low, mut high) = (0.3, 1.0);
    if !free(low)? {
        return None;
    }
    while high - low > 1e-3 {
        let middle = 0.5 * (low + high);
        if free(middle)? { low = middle } else { high = middle }
    }
    with(low)
}
