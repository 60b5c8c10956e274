//! Sums up a step.

use super::{Extreme, FLOWING_KG_S, Passed, StationSums, Sums};
use crate::plan::Plan;
use crate::state::State;
use anergy_network::interface::{Station, StationState};
use anergy_network::state::NetworkState;
use anergy_network::transport::Transport;

/// Books the electricity of each pump and returns their power, W.
pub(crate) fn book_pumps(plan: &Plan, state: &mut State, dt_s: f64) -> f64 {
    let mut total_w = 0.0;
    for (pump, booked_j) in plan.pumps.iter().zip(&mut state.kpis.pumps_j) {
        let electric_w = plan.electric_w(&state.network, *pump);
        total_w += electric_w;
        *booked_j += electric_w * dt_s;
    }
    total_w
}

/// Books everything else of a step.
pub(crate) fn book(plan: &Plan, state: &mut State, transport: &Transport, dt_s: f64) {
    let places = &plan.kpi_places;
    let (network, sums) = (&state.network, &mut state.kpis);
    let (mut heat_w, mut cold_w) = (0.0, 0.0);
    for (i, station) in plan.stations.iter().enumerate() {
        let booked = &mut sums.stations[i];
        let q_w = network.q_flow_w[station.edge.index()];
        booked.given_j += q_w.max(0.0) * dt_s;
        booked.taken_j += (-q_w).max(0.0) * dt_s;
        if !places.balances[i] {
            heat_w += (-q_w).max(0.0);
            cold_w += q_w.max(0.0);
        }
        book_water(plan, network, transport, station, booked, dt_s);
        book_request(network, station, &state.stations[i], booked, dt_s);
        if let Some((hot, cold)) = places.between[i] {
            booked.dp_pa.see(network.p_pa[hot] - network.p_pa[cold]);
        }
    }
    sums.demand_heat_j += heat_w * dt_s;
    sums.demand_cold_j += cold_w * dt_s;
    sums.coincident_j += f64::min(heat_w, cold_w) * dt_s;
    book_nodes(network, sums);
    for (node, ranges) in places.ranged.iter().zip(&mut sums.nodes) {
        ranges.t_k.see(network.t_node_k[*node]);
        ranges.p_pa.see(network.p_pa[*node]);
    }
    let ground_k = state.signals[plan.ground.index()];
    sums.mixing_j += ground_k * transport.mixing_w_k(&plan.network, network) * dt_s;
    let cp = plan.network.medium.heat_capacity_j_kg_k;
    for (i, unit) in plan.units.iter().enumerate() {
        let booked = &mut sums.units[i];
        booked.electric_j += state.unit_exchange[i].electric_w * dt_s;
        let ports = if places.booked[i] { unit.slots.clone() } else { 0..0 };
        for port in &state.unit_ports[ports] {
            let q_w = port.m_flow_kg_s.abs() * cp * (port.t_out_k - port.t_in_k);
            booked.given_j += q_w.max(0.0) * dt_s;
            booked.taken_j += (-q_w).max(0.0) * dt_s;
        }
        if let Some(unmet) = places.unmet[i] {
            booked.unmet_j += state.unit_outputs[unmet] * dt_s;
        }
    }
}

/// The water that passed a station.
fn book_water(
    plan: &Plan,
    network: &NetworkState,
    transport: &Transport,
    station: &Station,
    booked: &mut StationSums,
    dt_s: f64,
) {
    let m = station.m_flow_kg_s(network);
    if m == 0.0 {
        return;
    }
    let edge = station.edge.index();
    let t_in_k = transport.mean_k(plan.network.edges[edge].upstream(m).index());
    let capacity_w_k = m.abs() * plan.network.medium.heat_capacity_j_kg_k;
    let t_out_k = t_in_k + network.q_flow_w[edge] / capacity_w_k;
    let passed: &mut Passed = if m > 0.0 { &mut booked.fed_in } else { &mut booked.extracted };
    passed.kg += m.abs() * dt_s;
    passed.kg_k += m.abs() * dt_s * t_out_k;
    if m.abs() >= FLOWING_KG_S {
        passed.flowing_s += dt_s;
        passed.k_s += t_out_k * dt_s;
        passed.arriving_k.see(t_in_k);
    }
}

/// What was asked of a station and what came: a flow that is meant to be is asked for while its pump turns.
fn book_request(
    network: &NetworkState,
    station: &Station,
    memory: &StationState,
    booked: &mut StationSums,
    dt_s: f64,
) {
    let Some((pump, wanted_kg_s, direction)) = station.delivery(memory) else { return };
    if network.position[pump.index()] > 0.0 || memory.demand.m_flow_kg_s() != 0.0 {
        booked.requested_kg += wanted_kg_s * dt_s;
        booked.delivered_kg += (direction * station.m_flow_kg_s(network)).max(0.0) * dt_s;
    }
}

/// The coldest and the hottest node.
fn book_nodes(network: &NetworkState, sums: &mut Sums) {
    let temperatures = || network.t_node_k.iter();
    let coldest_k = temperatures().fold(f64::INFINITY, |least, t_k| least.min(*t_k));
    let hottest_k = temperatures().fold(f64::NEG_INFINITY, |most, t_k| most.max(*t_k));
    let place = |t_k: f64| {
        let node = temperatures().position(|other| *other == t_k)?;
        Some(Extreme { node, t_k })
    };
    if sums.coldest.is_none_or(|known| coldest_k < known.t_k) {
        sums.coldest = place(coldest_k);
    }
    if sums.hottest.is_none_or(|known| hottest_k > known.t_k) {
        sums.hottest = place(hottest_k);
    }
}
