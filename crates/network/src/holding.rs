//! Pressure holding by a membrane expansion vessel.
//!
//! **Equation** the gas is isothermal, `(p + p_atm) V_gas = const`, from the start of a run, where the
//! vessel of volume V has `V_gas = V (p_precharge + p_atm)/(p_start + p_atm)`. It loses what the water of
//! the circuit has expanded since, `sum m_i (1/rho(T_i) - 1/rho(T_i at the start))`, and what sources have
//! brought into the circuit, `m/rho`.
//!
//! **Assumptions** the flow of expanding water into the vessel is neglected in the hydraulics (some 1e-4
//! of the circuit per kelvin); everything else has the constant density of the model. Water that comes
//! back from the vessel has the temperature of its node. **Validity** below the precharge pressure the
//! vessel is empty: the gas law goes on, the event `vessel_empty` says so. The gas keeps at least
//! `LEAST_GAS` of the volume.
//!
//! **Sources** `kell1975` (density of water).

use crate::graph::Network;
use crate::state::NetworkState;
use crate::two_port::EdgeThermal;
use anergy_core::ids::{EdgeId, NodeId};
use serde::{Deserialize, Serialize};

/// Pressure of the atmosphere, Pa: pressures of a model are above it.
pub const ATMOSPHERE_PA: f64 = 101_325.0;
/// Smallest share of a vessel that its gas takes: a full vessel has a finite pressure.
const LEAST_GAS: f64 = 0.01;

/// A vessel and the circuit that it serves.
#[derive(Debug, Clone, PartialEq)]
pub struct Vessel {
    /// Where it is connected.
    pub node: NodeId,
    /// All nodes of the circuit.
    pub nodes: Vec<NodeId>,
    /// All edges of the circuit.
    pub edges: Vec<EdgeId>,
    /// Volume of the vessel, m3.
    pub volume_m3: f64,
    /// Gas at the start of a run, m3.
    pub gas_at_start_m3: f64,
    /// Pressure at the start of a run, Pa above the atmosphere.
    pub p_at_start_pa: f64,
}

/// What a vessel remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct VesselState {
    /// Volume of the water of the circuit at the start, m3.
    pub water_at_start_m3: f64,
    /// Water that sources have brought since, kg.
    pub entered_kg: f64,
    /// Gas in the vessel, m3.
    pub gas_m3: f64,
}

impl Vessel {
    /// A vessel of `volume_m3` at a node, its gas at `precharge_pa` when it holds no water and at
    /// `p_at_start_pa` at the start of a run (both above the atmosphere).
    pub fn new(
        network: &Network,
        node: NodeId,
        volume_m3: f64,
        precharge_pa: f64,
        p_at_start_pa: f64,
    ) -> Self {
        let circuits = network.circuits().into_iter();
        let nodes = circuits.into_iter().find(|nodes| nodes.contains(&node)).unwrap_or_default();
        let mut inside = vec![false; network.nodes.len()];
        nodes.iter().for_each(|node| inside[node.index()] = true);
        let edges = network.edges.iter().enumerate();
        let edges = edges.filter(|(_, edge)| inside[edge.from.index()]);
        Self {
            node,
            edges: edges.map(|(i, _)| EdgeId::from_index(i)).collect(),
            nodes,
            volume_m3,
            gas_at_start_m3: volume_m3 * (precharge_pa + ATMOSPHERE_PA)
                / (p_at_start_pa + ATMOSPHERE_PA),
            p_at_start_pa,
        }
    }

    /// Volume of the water of the circuit at its temperatures, m3.
    pub fn water_m3(&self, network: &Network, state: &NetworkState) -> f64 {
        let specific = |t_k: f64| 1.0 / network.medium.density_at_kg_m3(t_k);
        let mut volume_m3 = 0.0;
        for node in self.nodes.iter().map(|node| node.index()) {
            let water_kg = network.nodes[node].water_kg(network.medium.density_kg_m3);
            volume_m3 += water_kg * specific(state.t_node_k[node]);
        }
        for edge in self.edges.iter().map(|edge| edge.index()) {
            volume_m3 += match network.edges[edge].element.thermal() {
                EdgeThermal::Pass => 0.0,
                EdgeThermal::PlugFlow(pipe) => state.sum_over_water(edge, &pipe, specific),
                EdgeThermal::Exchanger(x) => {
                    (x.volume_kg - x.wall_kg) * specific(state.t_edge_k[edge])
                }
            };
        }
        volume_m3
    }

    /// The vessel at the start of a run.
    pub fn at_start(&self, network: &Network, state: &NetworkState) -> VesselState {
        VesselState {
            water_at_start_m3: self.water_m3(network, state),
            entered_kg: 0.0,
            gas_m3: self.gas_at_start_m3,
        }
    }

    /// Takes up what has expanded, and what has entered during the last `dt_s`; returns the pressure at
    /// the vessel, Pa above the atmosphere.
    pub fn take_up(
        &self,
        network: &Network,
        state: &NetworkState,
        memory: &mut VesselState,
        dt_s: f64,
    ) -> f64 {
        memory.entered_kg -= state.exchange_kg_s[self.node.index()] * dt_s;
        let expanded_m3 = self.water_m3(network, state) - memory.water_at_start_m3;
        let entered_m3 = memory.entered_kg / network.medium.density_kg_m3;
        let least_m3 = LEAST_GAS * self.volume_m3;
        memory.gas_m3 = (self.gas_at_start_m3 - expanded_m3 - entered_m3).max(least_m3);
        let start_pa = self.p_at_start_pa + ATMOSPHERE_PA;
        start_pa * self.gas_at_start_m3 / memory.gas_m3 - ATMOSPHERE_PA
    }
}
