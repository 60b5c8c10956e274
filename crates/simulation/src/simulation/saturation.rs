//! What holds a target and cannot: pumps at full speed or driven by others, controllers at their limits.
//!
//! A pump with a mode other than `speed` holds its set flow or head within its curve; a controller drives
//! its measured value to its set point within the limits of its actuator. Where either misses its target by
//! more than 1 % although it is at its limit, for more than 60 s, a run raises the event `unreached`, and
//! `reached` when it holds it again; `solve` lists them. **Sources** specification 5.2, feature F-009.

use super::Simulation;
use super::words::{Unreached, reach_event};
use crate::channels;
use crate::plan::{Plan, Target};
use crate::state::State;
use anergy_core::clock::Time;
use anergy_network::elements::Element;
use serde::{Deserialize, Serialize};

/// A target counts as reached within this share of it.
const REACHED: f64 = 0.01;
/// Targets below this are zero: a pump that is off, the zero of a measured value.
const ZERO: f64 = 1e-9;
/// It must have been missed this long before it is said, s.
const AFTER_S: f64 = 60.0;

/// What is remembered of a target.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Missed {
    /// For how long it has been missed, s.
    pub for_s: f64,
    /// Whether that was said.
    pub said: bool,
}

impl Simulation {
    /// Raises and clears what is missed for long.
    pub(super) fn watch_targets(&mut self, end: Time, dt_s: f64) {
        for i in 0..self.plan.targets.len() {
            let missed = missed(&self.plan, &self.state, self.plan.targets[i]);
            let memory = &mut self.state.missed[i];
            memory.for_s = if missed { memory.for_s + dt_s } else { 0.0 };
            let said = missed && (memory.said || memory.for_s > AFTER_S);
            if said != memory.said {
                memory.said = said;
                let unreached = unreached(&self.plan, &self.state, self.plan.targets[i]);
                self.events.push(reach_event(end, !said, unreached));
            }
        }
    }
}

/// The targets that are missed now.
pub(crate) fn missed_now(plan: &Plan, state: &State) -> Vec<Unreached> {
    let targets = plan.targets.iter().filter(|target| missed(plan, state, **target));
    targets.map(|target| unreached(plan, state, *target)).collect()
}

/// Set value and present value of what a pump holds by its mode.
fn pump_target(plan: &Plan, state: &State, edge: usize) -> (f64, f64) {
    let network = &state.network;
    let flow =
        matches!(&plan.network.edges[edge].element, Element::Pump(pump) if pump.holds_flow());
    let present =
        if flow { network.m_flow_kg_s[edge] } else { -network.dp_pa(&plan.network, edge) };
    (network.position[edge], present)
}

fn missed(plan: &Plan, state: &State, target: Target) -> bool {
    match target {
        Target::Pump(edge) => {
            let (wanted, present) = pump_target(plan, state, edge);
            wanted > ZERO && (wanted - present).abs() > REACHED * wanted
        }
        Target::Controller(i) => {
            let controller = &plan.controllers[i];
            let wanted = state.signals[controller.set_points.start];
            if controller.controller.is_off(&state.signals[controller.set_points.clone()]) {
                return false;
            }
            let error = wanted - channels::value(plan, state, controller.measures[0]);
            let (min, max) = controller.controller.output_limits(0, controller.limits[0]);
            let output = state.signals[controller.acts_on[0].index()];
            let push = error * controller.controller.gain().signum();
            let at_limit = (output >= max && push > 0.0) || (output <= min && push < 0.0);
            let size = (wanted - controller.zero).abs().max(ZERO);
            at_limit && error.abs() > REACHED * size
        }
    }
}

fn unreached(plan: &Plan, state: &State, target: Target) -> Unreached {
    match target {
        Target::Pump(edge) => {
            let (wanted, reached) = pump_target(plan, state, edge);
            let id = &plan.edge_names[edge];
            let word = plan.network.edges[edge].element.actuator().map_or("", |a| a.position);
            Unreached {
                id: id.to_string(),
                quantity: format!("{id}.{word}"),
                wanted,
                reached,
                free: format!("{id}.speed"),
                position: channels::value(plan, state, channels::Source::PumpSpeed(edge)),
            }
        }
        Target::Controller(i) => {
            let controller = &plan.controllers[i];
            Unreached {
                id: controller.name.clone(),
                quantity: controller.measured_names[0].clone(),
                wanted: state.signals[controller.set_points.start],
                reached: channels::value(plan, state, controller.measures[0]),
                free: plan.signals.spec(controller.acts_on[0]).name.to_string(),
                position: state.signals[controller.acts_on[0].index()],
            }
        }
    }
}
