//! Errors and events of a simulation in the names of the model.

use crate::error::RunError;
use crate::plan::Plan;
use crate::state::State;
use anergy_core::clock::Time;
use anergy_core::recorder::{Event, Severity};
use anergy_network::graph::Quantity;
use anergy_network::hydraulics::HydraulicError;
use anergy_network::state::Hold;

/// A prescription, or another target, as the user reads it: what was wanted, what it is, where the actuator is.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Unreached {
    /// The prescription, controller or pump.
    pub id: String,
    /// What is prescribed.
    pub quantity: String,
    /// The given value, SI.
    pub wanted: f64,
    /// The nearest that can be reached, SI.
    pub reached: f64,
    /// The free actuator.
    pub free: String,
    /// The limit at which it is.
    pub position: f64,
}

impl Unreached {
    pub(crate) fn new(plan: &Plan, state: &State, k: usize) -> Self {
        let prescription = &plan.network.prescriptions[k];
        let network = &state.network;
        let edge = |id: anergy_core::ids::EdgeId| plan.edge_names[id.index()].as_str();
        let (quantity, reached) = match prescription.quantity {
            Quantity::MassFlow(id) => {
                (format!("{}.m_flow_kg_s", edge(id)), network.m_flow_kg_s[id.index()])
            }
            Quantity::PressureDifference(id) => {
                (format!("{}.dp_pa", edge(id)), network.dp_pa(&plan.network, id.index()))
            }
            Quantity::Pressure(id) => {
                (format!("{}.p_pa", plan.node_names[id.index()]), network.p_pa[id.index()])
            }
        };
        let free = prescription.free;
        let command = plan.network.edges[free.index()].element.actuator();
        Self {
            id: plan.prescriptions[k].name.clone(),
            quantity,
            wanted: network.prescribed[k].value,
            reached,
            free: format!("{}.{}", edge(free), command.map_or("position", |a| a.position)),
            position: network.position[free.index()],
        }
    }
}

impl std::fmt::Display for Unreached {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { quantity, wanted, reached, free, position, .. } = self;
        write!(
            f,
            "{quantity} = {wanted:.6} is not reached: {free} is at its limit {position}, which gives \
             {reached:.6}"
        )
    }
}

pub(super) fn prescribed_event(plan: &Plan, state: &State, k: usize) -> Event {
    let held = state.network.prescribed[k].hold == Hold::Held;
    reach_event(state.time, held, Unreached::new(plan, state, k))
}

/// A target is held again or no more.
pub(super) fn reach_event(time: Time, held: bool, unreached: Unreached) -> Event {
    Event {
        time,
        severity: if held { Severity::Info } else { Severity::Warning },
        kind: if held { "reached" } else { "unreached" }.into(),
        message: if held {
            format!("{} = {:.6} is held again", unreached.quantity, unreached.wanted)
        } else {
            unreached.to_string()
        },
        component: unreached.id,
    }
}

/// What a station delivers when its flag changes.
#[derive(Clone, Copy)]
pub(super) struct Delivery {
    pub flow_kg_s: f64,
    pub wanted_kg_s: f64,
    /// The pump or source that holds it back most.
    pub held_back_by: Option<anergy_core::ids::EdgeId>,
}

pub(super) fn blocked_event(
    plan: &Plan,
    station: usize,
    time: Time,
    blocked: bool,
    delivery: Delivery,
) -> Event {
    let component = plan.station_names[station].clone();
    let density = plan.network.medium.density_kg_m3;
    let l_min = |m: f64| anergy_core::units::l_min(m, density);
    let verb = if blocked { "is blocked: it delivers" } else { "is free again: it delivers" };
    let by = delivery.held_back_by.map_or(String::new(), |edge| {
        format!("; most of all held back by {}", plan.edge_names[edge.index()])
    });
    Event {
        time,
        severity: if blocked { Severity::Warning } else { Severity::Info },
        kind: if blocked { "blocked" } else { "unblocked" }.into(),
        message: format!(
            "{component} {verb} {:.2} of {:.2} l/min wanted{by}",
            l_min(delivery.flow_kg_s),
            l_min(delivery.wanted_kg_s)
        ),
        component,
    }
}

pub(crate) fn named(plan: &Plan, time: Time, error: &HydraulicError) -> RunError {
    let time = time.to_string();
    let node_name = |id: anergy_core::ids::NodeId| plan.node_names[id.index()].to_string();
    let edge_name = |id: anergy_core::ids::EdgeId| plan.edge_names[id.index()].to_string();
    match *error {
        HydraulicError::NotConverged {
            iterations,
            edge,
            residual_pa,
            node,
            mass_residual_kg_s,
        } => RunError::NotConverged {
            time,
            iterations,
            edge: edge_name(edge),
            residual_pa,
            node: node_name(node),
            mass_residual_kg_s,
        },
        HydraulicError::Unbalanced { node, m_flow_kg_s } => {
            RunError::Unbalanced { time, node: node_name(node), m_flow_kg_s }
        }
        HydraulicError::Absurd { edge, dp_pa, m_flow_kg_s } => {
            RunError::Absurd { time, edge: edge_name(edge), dp_pa, m_flow_kg_s }
        }
        HydraulicError::NoEffect { edge } => RunError::Prescribed {
            time,
            free: edge_name(edge),
            problem: "its actuator has no effect on what is prescribed for it; it is cut off, or another \
                      prescription determines it already",
        },
        HydraulicError::Undetermined { edge } => RunError::Prescribed {
            time,
            free: edge_name(edge),
            problem: "nothing determines the pressures beside it, all flows around that part are given; \
                      prescribe a pressure there, or leave one actuator at its own command",
        },
        HydraulicError::Undecided { edge } => RunError::Prescribed {
            time,
            free: edge_name(edge),
            problem: "no position was found for what is prescribed; other prescriptions may work against \
                      it",
        },
        HydraulicError::Hunting { edge, miss } => {
            RunError::Hunting { time, valve: edge_name(edge), miss }
        }
        HydraulicError::NotFinite { edge } => {
            RunError::NotFinite { time, component: format!("edge \"{}\"", edge_name(edge)) }
        }
        HydraulicError::Factor(source) => RunError::Singular { time, source },
    }
}
