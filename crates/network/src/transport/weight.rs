//! Buoyancy: what the water in each edge weighs at its temperature.
//!
//! **Equation** `rho_e = rho(T_e)` with the mean temperature of the content of a pipe, of the mixed volume
//! of an exchanger, of the water passing elsewhere; the gravity term of the hydraulics is
//! `rho_e g (z_b - z_a)`.
//!
//! **Assumptions** the density of the model stays everywhere else (Boussinesq). The hydraulics of a step
//! see the densities at its start.
//!
//! **Numerics** in the steady state the densities go half of the way in each round: with a given heat the
//! buoyancy is inverse to the flow, and without that a laminar loop would swing for ever. Slower than
//! [`REST_KG_S`] water is at rest there, so that a loop starts in the sense of what is heated and cooled,
//! and not in that of a rounding error.
//!
//! **Sources** `kell1975`.

use super::Transport;
use super::plug_flow::mean_decay;
use crate::graph::Network;
use crate::state::NetworkState;
use crate::two_port::EdgeThermal;

/// Water this slow counts as standing in the steady state, kg/s.
const REST_KG_S: f64 = 1e-6;
/// Share of the way to the densities of the new temperatures in each round of the steady state.
const SETTLING: f64 = 0.5;
/// A density that changes by less than this share stays.
const KEPT: f64 = 1e-12;

impl NetworkState {
    /// From now on the water weighs what it does at its temperature.
    pub fn follow_densities(&mut self, network: &Network) {
        let all = 0..network.edges.len();
        self.density_kg_m3 =
            all.map(|i| network.medium.density_at_kg_m3(self.content_k(network, i))).collect();
        self.hydraulics_valid = false;
    }

    /// Mean temperature of the water in an edge, K.
    pub(super) fn content_k(&self, network: &Network, i: usize) -> f64 {
        match network.edges[i].element.thermal() {
            EdgeThermal::PlugFlow(_) => self.pipe_mean_k(i).unwrap_or(self.t_edge_k[i]),
            EdgeThermal::Pass | EdgeThermal::Exchanger(_) => self.t_edge_k[i],
        }
    }

    /// Changes what the water of an edge weighs.
    fn weigh_edge(&mut self, i: usize, density_kg_m3: f64) {
        let before = self.density_kg_m3[i];
        if (density_kg_m3 - before).abs() > KEPT * before {
            self.density_kg_m3[i] = density_kg_m3;
            self.hydraulics_valid = false;
        }
    }
}

impl Transport {
    /// The water weighs what it does at the temperatures of the end of a step.
    pub(super) fn weigh(&self, network: &Network, state: &mut NetworkState) {
        for i in 0..state.density_kg_m3.len() {
            let t_k = state.content_k(network, i);
            state.weigh_edge(i, network.medium.density_at_kg_m3(t_k));
        }
    }

    /// The same in the steady state, half of the way.
    pub(super) fn weigh_settled(&self, network: &Network, state: &mut NetworkState) {
        for i in 0..state.density_kg_m3.len() {
            if let Some(t_k) = self.settled_k(network, state, i) {
                let before = state.density_kg_m3[i];
                let change = network.medium.density_at_kg_m3(t_k) - before;
                state.weigh_edge(i, before + SETTLING * change);
            }
        }
    }

    /// Mean temperature of the water in an edge in the steady state, K; `None` for water at rest that
    /// nothing warms or cools.
    pub(super) fn settled_k(
        &self,
        network: &Network,
        state: &NetworkState,
        i: usize,
    ) -> Option<f64> {
        let edge = &network.edges[i];
        let m = state.m_flow_kg_s[i];
        let standing = m.abs() <= REST_KG_S;
        match edge.element.thermal() {
            EdgeThermal::Pass => (!standing).then_some(state.t_edge_k[i]),
            EdgeThermal::PlugFlow(pipe) => {
                let around_k = state.surroundings_k[i];
                if standing {
                    return pipe.loss_time_constant_s.is_finite().then_some(around_k);
                }
                let t_in_k = self.t_mean_k[edge.upstream(m).index()];
                Some(around_k + (t_in_k - around_k) * mean_decay(pipe.steady_ntu(m)))
            }
            EdgeThermal::Exchanger(_) if !standing => Some(state.t_edge_k[i]),
            EdgeThermal::Exchanger(_) => self.other_stream_k(network, state, i),
        }
    }

    /// Temperature at which the other stream of an exchanger enters, where it flows, K.
    fn other_stream_k(&self, network: &Network, state: &NetworkState, i: usize) -> Option<f64> {
        if let Some(partner) = network.edges[i].partner {
            let other = partner.index();
            let m = state.m_flow_kg_s[other];
            let inlet = network.edges[other].upstream(m);
            return (m.abs() > REST_KG_S).then(|| self.t_mean_k[inlet.index()]);
        }
        let port = self.port_of_edge[i] as usize;
        let request = state.requests.get(port)?;
        (request.m_flow_kg_s != 0.0).then(|| self.secondary_inlet_k(network, state, i))
    }
}
