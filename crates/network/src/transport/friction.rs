//! Friction: the hydraulic power that an edge takes from the water warms it.
//!
//! **Equation** `dT = max(dp, 0)/(rho cp)` between inlet and outlet, dp being the pressure loss in the
//! sense of the flow without its hydrostatic part and what accelerates the water: the heat is `m dp/rho`. 1 bar warms water by 0.024 K. What
//! a pump or source adds (dp < 0) warms nothing there; it is the friction elsewhere.
//!
//! **Assumptions** the heat appears at the outlet of the edge: the content of a pipe is colder than it would
//! be, by half of dT on average. A unit on the edge gives its temperature to the water before it.
//!
//! **Numerics** no division by a flow; off unless asked for. In a circuit the heat of friction is the work of
//! its pumps to the accuracy of the hydraulics.
//!
//! **Sources** specification 5.2 and 13.

use super::Transport;
use crate::graph::Network;
use crate::state::NetworkState;

impl NetworkState {
    /// From now on friction warms the water.
    pub fn count_friction(&mut self) {
        self.friction_k = vec![0.0; self.m_flow_kg_s.len()];
    }

    /// Rise of temperature by the friction in an edge, K.
    #[inline]
    pub(crate) fn friction_rise_k(&self, edge: usize) -> f64 {
        self.friction_k.get(edge).copied().unwrap_or(0.0)
    }
}

impl Transport {
    /// Warms what leaves the edges by the friction of the present flows.
    pub(super) fn add_friction(&mut self, network: &Network, state: &mut NetworkState) {
        let medium = &network.medium;
        let mut heat_w = 0.0;
        for i in 0..state.friction_k.len() {
            let m = state.m_flow_kg_s[i];
            let loss_pa =
                m.signum() * (state.driving_pa(network, i) - state.accelerating_pa(network, i));
            let rise_k = match m == 0.0 {
                true => 0.0,
                false => loss_pa.max(0.0) / (medium.density_kg_m3 * medium.heat_capacity_j_kg_k),
            };
            state.friction_k[i] = rise_k;
            self.relation[i].constant_k += rise_k;
            heat_w += m.abs() * medium.heat_capacity_j_kg_k * rise_k;
        }
        state.q_friction_w = heat_w;
    }

    /// Heat that the flow brought into an edge and left there in the last step, W: that of what entered
    /// less that of what left, without friction.
    pub fn brought_w(&self, network: &Network, state: &NetworkState, edge: usize) -> f64 {
        let m = state.m_flow_kg_s[edge];
        if m == 0.0 {
            return 0.0;
        }
        let t_in_k = self.t_mean_k[network.edges[edge].upstream(m).index()];
        let t_out_k = self.outlet_k(network, state, edge) - state.friction_rise_k(edge);
        m.abs() * network.medium.heat_capacity_j_kg_k * (t_in_k - t_out_k)
    }
}
