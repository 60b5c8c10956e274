//! Edges during a step: what leaves them as a function of what enters, and their content afterwards.

use super::{NONE, Relation, Transport, volume_shares};
use crate::effectiveness::inlet_conductance_w_k;
use crate::graph::Network;
use crate::state::NetworkState;
use crate::two_port::{EdgeThermal, Exchanger};
use anergy_core::port::Outlet;

impl Transport {
    /// What leaves an edge as a function of what enters; `None` for `dt_s` is the steady state.
    pub(super) fn edge_relation(
        &self,
        network: &Network,
        state: &NetworkState,
        i: usize,
        dt_s: Option<f64>,
    ) -> Relation {
        let m = state.m_flow_kg_s[i];
        if m == 0.0 {
            return Relation::PASS;
        }
        let edge = &network.edges[i];
        let cp = network.medium.heat_capacity_j_kg_k;
        match edge.element.thermal() {
            EdgeThermal::Pass => match self.port_of_edge[i] {
                NONE => {
                    let q_w = edge.element.heat_to_water_w(m, &state.edge_state(network, i));
                    Relation { constant_k: q_w / (m.abs() * cp), ..Relation::PASS }
                }
                port => match state.requests[port as usize].outlet {
                    Outlet::Temperature(t_k) => Relation::constant(t_k),
                    Outlet::Ends { a_k, b_k } => {
                        Relation::constant(if m < 0.0 { a_k } else { b_k })
                    }
                    Outlet::Exchange { w_k, other_k } => {
                        let (constant_k, of_inlet) =
                            Outlet::of_exchange(w_k, other_k, m.abs() * cp);
                        Relation { constant_k, of_inlet, ..Relation::PASS }
                    }
                    Outlet::Stirred { t_k, heat_w, heat_capacity_j_k, dt_s } => {
                        let capacity = m.abs() * cp;
                        let (constant_k, of_inlet) =
                            Outlet::of_stirred(t_k, heat_w, heat_capacity_j_k, dt_s, capacity);
                        Relation { constant_k, of_inlet, ..Relation::PASS }
                    }
                    Outlet::Linear { constant_k, of_inlet } => {
                        Relation { constant_k, of_inlet, ..Relation::PASS }
                    }
                    Outlet::HeatFlow(q_w) | Outlet::Warmed { wanted_w: q_w, .. } => {
                        Relation { constant_k: q_w / (m.abs() * cp), ..Relation::PASS }
                    }
                    Outlet::Cooled { wanted_w, coldest_k } => {
                        let constant_k = -wanted_w / (m.abs() * cp);
                        Relation { constant_k, coldest_k, ..Relation::PASS }
                    }
                },
            },
            EdgeThermal::PlugFlow(pipe) => match dt_s {
                Some(dt_s) => self.pipe_relation(state, i, &pipe, m, dt_s),
                None => self.steady_pipe(network, state, i, &pipe, m),
            },
            EdgeThermal::Exchanger(exchanger) => {
                let (kept, _) = match dt_s {
                    Some(dt_s) => volume_shares(m.abs() * dt_s, exchanger.volume_kg),
                    None => (0.0, 0.0),
                };
                let share = self.conductance_w_k(network, state, i, &exchanger) / (m.abs() * cp);
                let mut relation = Relation { of_inlet: 1.0 - share, ..Relation::PASS };
                if edge.partner.is_some() {
                    relation.of_partner = share;
                } else {
                    relation.constant_k = share * self.secondary_inlet_k(network, state, i);
                }
                relation.through_volume(state.t_edge_k[i], kept)
            }
        }
    }

    /// Heat conductance between the inlet temperatures of the two streams of an exchanger edge, W/K.
    pub(super) fn conductance_w_k(
        &self,
        network: &Network,
        state: &NetworkState,
        i: usize,
        exchanger: &Exchanger,
    ) -> f64 {
        let edge = &network.edges[i];
        let cp = network.medium.heat_capacity_j_kg_k;
        let m1 = state.m_flow_kg_s[i];
        if let Some(partner) = edge.partner {
            let m2 = state.m_flow_kg_s[partner.index()];
            let as_nominal = (m1 < 0.0) == (m2 < 0.0);
            if edge.leads_partner {
                return inlet_conductance_w_k(exchanger, m1, m2, cp, as_nominal);
            }
            return match network.edges[partner.index()].element.thermal() {
                EdgeThermal::Exchanger(lead) => {
                    inlet_conductance_w_k(&lead, m2, m1, cp, as_nominal)
                }
                _ => 0.0,
            };
        }
        match self.port_of_edge[i] {
            NONE => 0.0,
            // The station keeps its exchanger in counter-flow in both modes.
            port => {
                let m2 = state.requests[port as usize].m_flow_kg_s;
                inlet_conductance_w_k(exchanger, m1, m2, cp, true)
            }
        }
    }

    /// Temperature at which the unit sends its water into the exchanger of edge i, K.
    pub(super) fn secondary_inlet_k(
        &self,
        network: &Network,
        state: &NetworkState,
        i: usize,
    ) -> f64 {
        let port = self.port_of_edge[i];
        if port == NONE {
            return state.t_edge_k[i];
        }
        let request = &state.requests[port as usize];
        let t_k = state.t_secondary_k[port as usize];
        let capacity = request.m_flow_kg_s.abs() * network.medium.heat_capacity_j_kg_k;
        let rise_k = |q_w: f64| if capacity > 0.0 { q_w / capacity } else { 0.0 };
        match request.outlet {
            Outlet::Temperature(t_k) | Outlet::Ends { b_k: t_k, .. } => t_k,
            Outlet::Linear { constant_k, of_inlet } => constant_k + of_inlet * t_k,
            Outlet::Exchange { w_k, other_k } => {
                let (constant_k, of_inlet) = Outlet::of_exchange(w_k, other_k, capacity);
                constant_k + of_inlet * t_k
            }
            Outlet::Stirred { t_k: content_k, heat_w, heat_capacity_j_k, dt_s } => {
                let (constant_k, of_inlet) =
                    Outlet::of_stirred(content_k, heat_w, heat_capacity_j_k, dt_s, capacity);
                constant_k + of_inlet * t_k
            }
            Outlet::HeatFlow(q_w) => t_k + rise_k(q_w),
            Outlet::Warmed { wanted_w, hottest_k } => {
                (t_k + rise_k(wanted_w)).min(hottest_k.max(t_k))
            }
            Outlet::Cooled { wanted_w, coldest_k } => {
                (t_k + rise_k(-wanted_w)).max(coldest_k.min(t_k))
            }
        }
    }

    /// Moves the content of the edges, their volumes and the secondary volumes; books the heat.
    pub(super) fn advance_edges(&mut self, network: &Network, state: &mut NetworkState, dt_s: f64) {
        let cp = network.medium.heat_capacity_j_kg_k;
        for (i, edge) in network.edges.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            let t_in_k = self.t_mean_k[edge.upstream(m).index()];
            let t_out_k = if m == 0.0 { t_in_k } else { self.outlet_k(network, state, i) };
            match edge.element.thermal() {
                EdgeThermal::Pass => {
                    let given_k = t_out_k - state.friction_rise_k(i);
                    if m != 0.0 {
                        state.t_edge_k[i] = t_out_k;
                        state.q_flow_w[i] = m.abs() * cp * (given_k - t_in_k);
                    }
                    self.direct_port(state, i, t_in_k, given_k);
                }
                EdgeThermal::PlugFlow(pipe) => {
                    let lost = self.advance_pipe(state, i, &pipe, t_in_k, dt_s);
                    state.q_loss_w[i] = lost * cp / dt_s;
                }
                EdgeThermal::Exchanger(exchanger) => {
                    let q_w = self.exchanged_w(network, state, i, &exchanger, t_in_k);
                    state.q_flow_w[i] = q_w;
                    if m != 0.0 {
                        let (_, end) = volume_shares(m.abs() * dt_s, exchanger.volume_kg);
                        let into_k = t_in_k + q_w / (m.abs() * cp);
                        state.t_edge_k[i] = into_k + (state.t_edge_k[i] - into_k) * end;
                    }
                    self.secondary(network, state, i, &exchanger, q_w, dt_s);
                }
            }
        }
    }

    /// Heat into the water of an exchanger edge, W.
    pub(super) fn exchanged_w(
        &self,
        network: &Network,
        state: &NetworkState,
        i: usize,
        exchanger: &Exchanger,
        t_in_k: f64,
    ) -> f64 {
        let other_k = match network.edges[i].partner {
            Some(partner) => {
                let other = partner.index();
                let m_other = state.m_flow_kg_s[other];
                self.t_mean_k[network.edges[other].upstream(m_other).index()]
            }
            None => self.secondary_inlet_k(network, state, i),
        };
        self.conductance_w_k(network, state, i, exchanger) * (other_k - t_in_k)
    }

    /// What the unit on an edge in the grid water got.
    pub(super) fn direct_port(
        &self,
        state: &mut NetworkState,
        i: usize,
        t_in_k: f64,
        t_out_k: f64,
    ) {
        if self.port_of_edge[i] != NONE {
            let flow = &mut state.port_flows[self.port_of_edge[i] as usize];
            flow.m_flow_kg_s = state.m_flow_kg_s[i];
            (flow.t_in_k, flow.t_out_k) = (t_in_k, t_out_k);
        }
    }

    /// The unit's side of an exchanger: its water gives `q_w` and passes the secondary volume.
    pub(super) fn secondary(
        &self,
        network: &Network,
        state: &mut NetworkState,
        i: usize,
        exchanger: &Exchanger,
        q_w: f64,
        dt_s: f64,
    ) {
        if self.port_of_edge[i] == NONE {
            return;
        }
        let port = self.port_of_edge[i] as usize;
        let m = state.requests[port].m_flow_kg_s;
        let sent_k = self.secondary_inlet_k(network, state, i);
        let before_k = state.t_secondary_k[port];
        let mut arriving_k = before_k;
        if m != 0.0 {
            let into_k = sent_k - q_w / (m.abs() * network.medium.heat_capacity_j_kg_k);
            let (kept, end) = volume_shares(m.abs() * dt_s, exchanger.volume_kg);
            state.t_secondary_k[port] = into_k + (before_k - into_k) * end;
            arriving_k = kept * before_k + (1.0 - kept) * into_k;
        }
        let flow = &mut state.port_flows[port];
        flow.m_flow_kg_s = m;
        (flow.t_in_k, flow.t_out_k) = (arriving_k, sent_k);
    }

    pub(super) fn settle_edge(&mut self, network: &Network, state: &mut NetworkState, i: usize) {
        let edge = &network.edges[i];
        let cp = network.medium.heat_capacity_j_kg_k;
        let m = state.m_flow_kg_s[i];
        let t_in_k = self.t_mean_k[edge.upstream(m).index()];
        let t_out_k = if m == 0.0 { t_in_k } else { self.outlet_k(network, state, i) };
        // Without friction, which warms at the outlet.
        let given_k = if m == 0.0 { t_in_k } else { t_out_k - state.friction_rise_k(i) };
        (state.q_flow_w[i], state.q_loss_w[i]) = (0.0, 0.0);
        match edge.element.thermal() {
            EdgeThermal::Pass => {
                state.q_flow_w[i] = m.abs() * cp * (given_k - t_in_k);
                state.t_edge_k[i] = t_out_k;
                self.direct_port(state, i, t_in_k, given_k);
            }
            EdgeThermal::PlugFlow(pipe) => {
                self.settle_pipe(network, state, i, &pipe, t_in_k);
                state.q_loss_w[i] = m.abs() * cp * (t_in_k - given_k) + state.q_flow_w[i];
            }
            EdgeThermal::Exchanger(exchanger) => {
                let q_w = self.exchanged_w(network, state, i, &exchanger, t_in_k);
                state.q_flow_w[i] = q_w;
                if m != 0.0 {
                    state.t_edge_k[i] = given_k;
                }
                // A very long step settles the secondary volume.
                self.secondary(network, state, i, &exchanger, q_w, 1e12);
            }
        }
    }
}
