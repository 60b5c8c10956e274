//! Heat meters count what passed in a step.

use super::Simulation;

impl Simulation {
    /// Heat meters read the means of the step that has passed and integrate them; `dt_s` of zero only
    /// reads.
    pub(super) fn read_meters(&mut self, dt_s: f64) {
        let network = &self.state.network;
        let medium = &self.plan.network.medium;
        for (meter, reading) in self.plan.meters.iter().zip(&mut self.state.meters) {
            let m = network.m_flow_kg_s[meter.edge];
            let (own_k, other_k) =
                (network.t_edge_k[meter.edge], self.transport.mean_k(meter.other_node));
            let difference_k = if meter.in_supply { own_k - other_k } else { other_k - own_k };
            reading.q_flow_w =
                if m == 0.0 { 0.0 } else { m * medium.heat_capacity_j_kg_k * difference_k };
            reading.heat_j += reading.q_flow_w * dt_s;
            reading.volume_m3 += m / medium.density_kg_m3 * dt_s;
        }
    }
}
