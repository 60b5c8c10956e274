//! How much memory a state takes.

use crate::state::{LawWater, NetworkState, Prescribed, Regulated};
use anergy_core::port::{PortFlow, PortRequest};

impl NetworkState {
    /// Memory that it takes beside itself, in bytes.
    pub fn heap_bytes(&self) -> usize {
        let floats = [
            &self.m_flow_kg_s,
            &self.p_pa,
            // Twice: an actuator has two lags.
            &self.position,
            &self.position,
            &self.given_p_pa,
            &self.given_m_flow_kg_s,
            &self.given_t_k,
            &self.surroundings_k,
            &self.exchange_kg_s,
            &self.density_kg_m3,
            &self.t_node_k,
            &self.t_edge_k,
            &self.q_flow_w,
            &self.q_loss_w,
            &self.friction_k,
            &self.t_secondary_k,
            &self.soil_k,
            &self.soil_ground_k,
            &self.q_ground_w,
        ];
        floats.iter().map(|values| values.capacity() * size_of::<f64>()).sum::<usize>()
            + self.inertia.heap_bytes()
            + self.law_water.capacity() * size_of::<LawWater>()
            + self.prescribed.capacity() * size_of::<Prescribed>()
            + self.regulated.capacity() * size_of::<Regulated>()
            + self.requests.capacity() * size_of::<PortRequest>()
            + self.port_flows.capacity() * size_of::<PortFlow>()
            + self.parcels.heap_bytes()
            + self.cells.heap_bytes()
    }
}
