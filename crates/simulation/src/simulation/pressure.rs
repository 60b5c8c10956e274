//! Pressure holding: expansion vessels follow their circuits, pressures are watched.

use super::Simulation;
use crate::plan::{Limit, Plan, PressureWatch};
use crate::state::State;
use anergy_core::clock::Time;
use anergy_core::recorder::{Event, Severity};
use serde::Serialize;

/// A pressure must be back inside its limit by this to be reported anew, Pa.
const HYSTERESIS_PA: f64 = 5e3;

/// A pressure beyond a limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Crossing {
    /// `pressure_low`, `pressure_high` or `vessel_empty`.
    pub kind: &'static str,
    /// The node.
    pub node: String,
    /// Its pressure above the atmosphere, Pa.
    pub p_pa: f64,
    /// The limit, Pa.
    pub limit_pa: f64,
}

impl std::fmt::Display for Crossing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { node, kind, .. } = self;
        let (p_bar, limit_bar) = (self.p_pa / 1e5, self.limit_pa / 1e5);
        match *kind {
            "vessel_empty" => write!(
                f,
                "the expansion vessel at {node} is empty: {p_bar:.3} bar, precharge {limit_bar:.3} bar"
            ),
            _ => {
                let side = if self.p_pa < self.limit_pa { "below" } else { "above" };
                write!(f, "{node} has {p_bar:.3} bar, {side} its limit of {limit_bar:.3} bar")
            }
        }
    }
}

impl PressureWatch {
    /// The node that is farthest on the side of the limit, and how far it is beyond, Pa.
    fn worst(&self, p_pa: &[f64]) -> (usize, f64) {
        let beyond = |node: usize| match self.limit {
            Limit::Low | Limit::VesselEmpty => self.limit_pa - p_pa[node],
            Limit::High => p_pa[node] - self.limit_pa,
        };
        let mut worst = (0, f64::NEG_INFINITY);
        for &node in &self.nodes {
            let beyond_pa = beyond(node);
            if beyond_pa > worst.1 {
                worst = (node, beyond_pa);
            }
        }
        worst
    }

    fn crossing(&self, plan: &Plan, state: &State, node: usize) -> Crossing {
        Crossing {
            kind: match self.limit {
                Limit::Low => "pressure_low",
                Limit::High => "pressure_high",
                Limit::VesselEmpty => "vessel_empty",
            },
            node: plan.node_names[node].to_string(),
            p_pa: state.network.p_pa[node],
            limit_pa: self.limit_pa,
        }
    }
}

/// All limits that are crossed now, each at its worst node.
pub(crate) fn crossings(plan: &Plan, state: &State) -> Vec<Crossing> {
    let watches = plan.pressure_watches.iter();
    watches
        .map(|watch| (watch, watch.worst(&state.network.p_pa)))
        .filter(|(_, (_, beyond_pa))| *beyond_pa > 0.0)
        .map(|(watch, (node, _))| watch.crossing(plan, state, node))
        .collect()
}

impl Simulation {
    /// Vessels hold the pressure of the start.
    pub(super) fn fill_vessels(&mut self) {
        let network = &mut self.state.network;
        for (vessel, memory) in self.plan.vessels.iter().zip(&mut self.state.vessels) {
            *memory = vessel.at_start(&self.plan.network, network);
            let node = vessel.node.index();
            network.set_boundary(node, vessel.p_at_start_pa, 0.0, network.t_node_k[node]);
        }
    }

    /// Vessels take up what has expanded and entered; the next step has their pressures.
    pub(super) fn hold_pressures(&mut self, dt_s: f64) {
        let network = &mut self.state.network;
        for (vessel, memory) in self.plan.vessels.iter().zip(&mut self.state.vessels) {
            let p_pa = vessel.take_up(&self.plan.network, network, memory, dt_s);
            let node = vessel.node.index();
            network.set_boundary(node, p_pa, 0.0, network.t_node_k[node]);
        }
    }

    /// Pressures beyond a limit raise an event, and clear it well inside.
    pub(super) fn watch_pressures(&mut self, time: Time) {
        for (i, watch) in self.plan.pressure_watches.iter().enumerate() {
            let (node, beyond_pa) = watch.worst(&self.state.network.p_pa);
            let crossed = self.state.crossed[i];
            if (!crossed && beyond_pa > 0.0) || (crossed && beyond_pa < -HYSTERESIS_PA) {
                self.state.crossed[i] = !crossed;
                let crossing = watch.crossing(&self.plan, &self.state, node);
                self.events.push(event(&crossing, time, crossed));
            }
        }
    }
}

fn event(crossing: &Crossing, time: Time, cleared: bool) -> Event {
    let Crossing { kind, node, p_pa, limit_pa } = crossing;
    Event {
        time,
        severity: if cleared { Severity::Info } else { Severity::Warning },
        component: node.clone(),
        kind: if cleared { format!("{kind}_cleared") } else { (*kind).to_owned() },
        message: if cleared {
            let (p_bar, limit_bar) = (p_pa / 1e5, limit_pa / 1e5);
            format!("{node} has {p_bar:.3} bar, inside its limit of {limit_bar:.3} bar again")
        } else {
            crossing.to_string()
        },
    }
}
