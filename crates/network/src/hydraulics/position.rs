//! Where the actuator of a free edge has to be: the position whose law has a flow and a difference.

use super::prescribed::{FLOW_KG_S, PRESSURE_PA, RELATIVE};
use crate::graph::{Network, Quantity};
use crate::state::NetworkState;
use crate::two_port::{Characteristic, EdgeState};
use anergy_core::linear::Linear;

/// Where the law of an edge passes through a flow and a pressure difference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    At(f64),
    Below,
    Above,
    /// Nowhere: water flows against the pressure difference, and the edge cannot drive it.
    Driven,
}

pub(super) fn limits(network: &Network, edge: usize) -> (f64, f64) {
    network.edges[edge].element.actuator().map_or((0.0, 0.0), |a| (a.min, a.max))
}

pub(super) fn own_law(network: &Network, edge: usize, m: f64, state: EdgeState) -> Option<Linear> {
    match network.edges[edge].characteristic(m, &state) {
        Characteristic::PressureLoss(law) => Some(law),
        _ => None,
    }
}

/// The present value of a quantity.
pub(super) fn present(network: &Network, state: &NetworkState, quantity: Quantity) -> f64 {
    match quantity {
        Quantity::MassFlow(edge) => state.m_flow_kg_s[edge.index()],
        Quantity::PressureDifference(edge) => state.dp_pa(network, edge.index()),
        Quantity::Pressure(node) => state.p_pa[node.index()],
    }
}

pub(super) fn tolerance(quantity: Quantity, target: f64) -> f64 {
    match quantity {
        Quantity::MassFlow(_) => FLOW_KG_S + RELATIVE * target.abs(),
        _ => PRESSURE_PA + RELATIVE * target.abs(),
    }
}

/// The loss of an edge at a position and a flow, Pa; infinite for a tightly closed one.
pub(super) fn loss_at(
    network: &Network,
    state: &NetworkState,
    edge: usize,
    m: f64,
    position: f64,
) -> f64 {
    let at = EdgeState { position, ..state.edge_state(network, edge) };
    own_law(network, edge, m, at).map_or(f64::INFINITY.copysign(m), |law| law.value)
}

/// Sign of the change of head by position (head = minus loss); at rest for the flow that would begin.
pub(super) fn head_by_position(
    network: &Network,
    state: &NetworkState,
    edge: usize,
    dp: f64,
) -> f64 {
    let (min, max) = limits(network, edge);
    let present = state.m_flow_kg_s[edge];
    let m = if present.abs() > FLOW_KG_S { present } else { FLOW_KG_S.copysign(dp) };
    let loss = |position: f64| loss_at(network, state, edge, m, position);
    (loss(min) - loss(max)).signum()
}

/// The position with the present flow and the pressure difference `dp`: bisection with secants.
pub(super) fn place(network: &Network, state: &NetworkState, edge: usize, dp: f64) -> Place {
    let (min, max) = limits(network, edge);
    let m = state.m_flow_kg_s[edge];
    let miss = |position: f64| loss_at(network, state, edge, m, position) - dp;
    let allowed = PRESSURE_PA + RELATIVE * dp.abs();
    let (mut low, mut high) = (min, max);
    let (mut low_miss, mut high_miss) = (miss(low), miss(high));
    if low_miss.abs() <= allowed && high_miss.abs() <= allowed {
        // Nothing flows and nothing drives: any position will do.
        return Place::At(state.position[edge].clamp(min, max));
    }
    if high_miss.abs() <= allowed {
        return Place::At(max);
    }
    if low_miss.abs() <= allowed {
        return Place::At(min);
    }
    if dp * m < 0.0 && loss_at(network, state, edge, m, max) * m >= 0.0 {
        return Place::Driven;
    }
    if low_miss.signum() == high_miss.signum() {
        return if high_miss.abs() < low_miss.abs() { Place::Above } else { Place::Below };
    }
    for i in 0..200 {
        let secant = low - low_miss * (high - low) / (high_miss - low_miss);
        let inside = secant > low && secant < high && i % 3 != 2;
        let middle = if inside { secant } else { 0.5 * (low + high) };
        let middle_miss = miss(middle);
        if middle_miss == 0.0 || high - low < 1e-15 * max {
            return Place::At(middle);
        }
        if middle_miss.signum() == low_miss.signum() {
            (low, low_miss) = (middle, middle_miss);
        } else {
            (high, high_miss) = (middle, middle_miss);
        }
    }
    Place::At(if low_miss.abs() < high_miss.abs() { low } else { high })
}
