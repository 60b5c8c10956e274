//! Everything of a network that changes during a run: plain data, cloned by a snapshot.

use crate::graph::{Edge, Network, NodeKind, Regulator};
use crate::inertia::Inertia;
use crate::soil::SoilRings;
use crate::transport::cells::Cells;
use crate::transport::parcels::Parcels;
use crate::two_port::{EdgeState, EdgeThermal};
use anergy_core::port::{PortFlow, PortRequest};
use serde::{Deserialize, Serialize};

/// Pressures, flows, temperatures and actuator positions of a network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NetworkState {
    /// Mass flow of each edge, kg/s.
    pub m_flow_kg_s: Vec<f64>,
    /// Pressure of each node, Pa (gauge).
    pub p_pa: Vec<f64>,
    /// Actuator position of each edge.
    pub position: Vec<f64>,
    /// First lag of each actuator (the second is its position).
    actuator_lag: Vec<f64>,
    /// Given pressure of fixed nodes, Pa.
    pub given_p_pa: Vec<f64>,
    /// Given flow into source nodes, kg/s.
    pub given_m_flow_kg_s: Vec<f64>,
    /// Temperature of water entering at boundaries and sources, K.
    pub given_t_k: Vec<f64>,
    /// Temperature around each edge, K.
    pub surroundings_k: Vec<f64>,
    /// Temperature around nodes, K.
    pub ambient_k: f64,
    /// Flow that fixed nodes and sources bring into the network, kg/s.
    pub exchange_kg_s: Vec<f64>,
    /// Density at which the water of each edge weighs on the pressures, kg/m3, where buoyancy counts;
    /// empty where all water weighs the same.
    pub density_kg_m3: Vec<f64>,
    /// What the water of each edge is in the laws of pressure, where it follows the temperature; empty where
    /// all water is as the medium.
    pub law_water: Vec<LawWater>,
    /// What the inertia of the water remembers, where it counts.
    pub(crate) inertia: Inertia,
    /// Value and state of each prescription of the network.
    pub prescribed: Vec<Prescribed>,
    /// Each self-acting valve of the network.
    pub regulated: Vec<Regulated>,
    /// Whether flows and pressures belong to the present positions and boundary values.
    pub(crate) hydraulics_valid: bool,
    /// Temperature of each node, K.
    pub t_node_k: Vec<f64>,
    /// Temperature of the mixed volume of each edge that has one (of the water passing, where not), K.
    pub t_edge_k: Vec<f64>,
    /// Heat taken up by the water of each edge from units or the other stream, W (mean of the step).
    pub q_flow_w: Vec<f64>,
    /// Heat lost by each edge to its surroundings, W (mean of the step).
    pub q_loss_w: Vec<f64>,
    /// Heat lost by all nodes, W (mean of the step).
    pub q_loss_nodes_w: f64,
    /// Rise of temperature by the friction in each edge, K; empty where friction warms nothing.
    pub friction_k: Vec<f64>,
    /// Heat of friction in all edges, W (mean of the step).
    pub q_friction_w: f64,
    /// Enthalpy flow into the network through boundaries and sources, W (mean of the step).
    pub boundary_w: f64,
    /// Temperature of the secondary volume of each port behind an exchanger, K.
    pub t_secondary_k: Vec<f64>,
    /// What each port's unit wants.
    pub requests: Vec<PortRequest>,
    /// What each port's unit got in the last step.
    pub port_flows: Vec<PortFlow>,
    /// Content of the pipes whose water exchanges nothing on its way.
    pub parcels: Parcels,
    /// Content of the other pipes.
    pub cells: Cells,
    /// Temperature of the rings of soil of all pipes that have some, innermost first, K.
    pub(crate) soil_k: Vec<f64>,
    /// Temperature of the ground beyond the rings of each such pipe, K.
    pub(crate) soil_ground_k: Vec<f64>,
    /// Heat from the rings of each such pipe to the ground, W (mean of the step).
    pub q_ground_w: Vec<f64>,
}

/// Properties of the water in an edge.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LawWater {
    /// Density, kg/m3.
    pub density_kg_m3: f64,
    /// Dynamic viscosity, Pa s.
    pub viscosity_pa_s: f64,
}

/// A self-acting valve during a step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Regulated {
    /// Set value, Pa.
    pub set_pa: f64,
    /// Opening at the start of the step.
    pub(crate) from: f64,
    /// Share of the way to where it wants to be that it goes in the step; 1 is the steady state.
    pub(crate) share: f64,
}

/// A prescription at the moment.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Prescribed {
    /// The given value, SI.
    pub value: f64,
    /// Whether it is reached, or where its actuator ends.
    pub hold: Hold,
}

/// Whether a free actuator reaches what is prescribed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Hold {
    /// The value is held.
    #[default]
    Held,
    /// The actuator is at its lower limit, which is still too much.
    AtMin,
    /// The actuator is at its upper limit, which is not enough.
    AtMax,
}

impl NetworkState {
    /// Everything at rest and at one temperature; pressures at zero.
    pub fn new(network: &Network, initial_k: f64) -> Self {
        let (nodes, edges, ports) = (network.nodes.len(), network.edges.len(), network.ports.len());
        let initial_position =
            |edge: &Edge| edge.element.actuator().map_or(0.0, |actuator| actuator.initial_position);
        let mut position: Vec<f64> = network.edges.iter().map(initial_position).collect();
        for regulator in &network.regulators {
            // Without pressure the spring opens it.
            position[regulator.edge.index()] = 1.0;
        }
        Self {
            m_flow_kg_s: network.edges.iter().map(Edge::start_m_flow_kg_s).collect(),
            p_pa: vec![0.0; nodes],
            actuator_lag: position.clone(),
            position,
            given_p_pa: vec![0.0; nodes],
            given_m_flow_kg_s: vec![0.0; nodes],
            given_t_k: vec![initial_k; nodes],
            surroundings_k: vec![initial_k; edges],
            ambient_k: initial_k,
            exchange_kg_s: vec![0.0; nodes],
            density_kg_m3: Vec::new(),
            law_water: Vec::new(),
            inertia: Inertia::default(),
            prescribed: vec![Prescribed::default(); network.prescriptions.len()],
            regulated: network
                .regulators
                .iter()
                .map(|r| Regulated { set_pa: r.regulation.set_pa, from: 1.0, share: 1.0 })
                .collect(),
            hydraulics_valid: false,
            t_node_k: vec![initial_k; nodes],
            t_edge_k: vec![initial_k; edges],
            q_flow_w: vec![0.0; edges],
            q_loss_w: vec![0.0; edges],
            q_loss_nodes_w: 0.0,
            friction_k: Vec::new(),
            q_friction_w: 0.0,
            boundary_w: 0.0,
            t_secondary_k: vec![initial_k; ports],
            requests: vec![PortRequest::default(); ports],
            port_flows: vec![
                PortFlow { m_flow_kg_s: 0.0, t_in_k: initial_k, t_out_k: initial_k };
                ports
            ],
            parcels: Parcels::new(network, initial_k),
            cells: Cells::new(network, initial_k),
            soil_k: vec![initial_k; network.soil.iter().map(SoilRings::count).sum()],
            soil_ground_k: vec![initial_k; network.soil.len()],
            q_ground_w: vec![0.0; network.soil.len()],
        }
    }

    /// What an element is told about its edge.
    #[inline]
    pub fn edge_state(&self, network: &Network, edge: usize) -> EdgeState {
        let medium = &network.medium;
        let (density_kg_m3, viscosity_pa_s) = match self.law_water.get(edge) {
            Some(water) => (water.density_kg_m3, water.viscosity_pa_s),
            None => (medium.density_kg_m3, medium.viscosity_pa_s),
        };
        EdgeState { position: self.position[edge], density_kg_m3, viscosity_pa_s }
    }

    /// Moves the actuator of an edge towards what `command` asks for at the last flow, over `dt_s`: two
    /// equal first-order lags with `T = t_rise sqrt(sqrt 2 - 1)/5`, exact for a constant command. Infinite
    /// `dt_s` settles it.
    pub fn advance_actuator(&mut self, network: &Network, edge: usize, command: f64, dt_s: f64) {
        let element = &network.edges[edge].element;
        let Some(actuator) = element.actuator() else {
            return;
        };
        let target = element.target_at_flow(command, self.m_flow_kg_s[edge]);
        let (x1, x2) = (self.actuator_lag[edge], self.position[edge]);
        let kept =
            if element.follows_flow() && target > 0.0 { FOLLOWED * actuator.max } else { 0.0 };
        if (x1 - target).abs() <= kept && (x2 - target).abs() <= kept {
            return;
        }
        let lag_s = RISE_TO_LAG * actuator.rise_time_s;
        let (mut new_1, mut new_2) = (target, target);
        if lag_s > 0.0 && dt_s.is_finite() {
            let x = dt_s / lag_s;
            let decay = (-x).exp();
            new_1 = target + (x1 - target) * decay;
            new_2 = target + (x2 - target) * decay + (x1 - target) * x * decay;
            if (new_1 - target).abs() < SETTLED && (new_2 - target).abs() < SETTLED {
                (new_1, new_2) = (target, target);
            }
        }
        self.actuator_lag[edge] = new_1;
        if self.position[edge] != new_2 {
            self.position[edge] = new_2;
            self.hydraulics_valid = false;
        }
    }

    /// Copies positions and lags of all actuators.
    pub fn copy_actuators(&self, positions: &mut Vec<f64>, lags: &mut Vec<f64>) {
        positions.clone_from(&self.position);
        lags.clone_from(&self.actuator_lag);
    }

    /// Puts actuators and flows back to where they were: a step that is tried again.
    pub fn put_back(&mut self, positions: &[f64], lags: &[f64], m_flow_kg_s: &[f64]) {
        self.position.copy_from_slice(positions);
        self.actuator_lag.copy_from_slice(lags);
        self.m_flow_kg_s.copy_from_slice(m_flow_kg_s);
        self.hydraulics_valid = false;
    }

    /// Sets the given pressure, flow and temperature of a node.
    pub fn set_boundary(&mut self, node: usize, p_pa: f64, m_flow_kg_s: f64, t_k: f64) {
        if self.given_p_pa[node] != p_pa || self.given_m_flow_kg_s[node] != m_flow_kg_s {
            self.given_p_pa[node] = p_pa;
            self.given_m_flow_kg_s[node] = m_flow_kg_s;
            self.hydraulics_valid = false;
        }
        self.given_t_k[node] = t_k;
    }

    /// Sets the value of a prescription, SI.
    pub fn prescribe(&mut self, prescription: usize, value: f64) {
        let prescribed = &mut self.prescribed[prescription];
        if prescribed.value != value {
            prescribed.value = value;
            self.hydraulics_valid = false;
        }
    }

    /// Sets the set value of a self-acting valve, Pa.
    pub fn set_regulator(&mut self, regulator: usize, set_pa: f64) {
        let regulated = &mut self.regulated[regulator];
        if regulated.set_pa != set_pa {
            regulated.set_pa = set_pa;
            self.hydraulics_valid = false;
        }
    }

    /// Begins a step of all self-acting valves; infinite `dt_s` settles them. Those that are not where
    /// they want to be move with the next solve.
    pub fn advance_regulators(&mut self, network: &Network, dt_s: f64) {
        for (k, regulator) in network.regulators.iter().enumerate() {
            let from = self.position[regulator.edge.index()];
            let share = -(-dt_s / regulator.regulation.lag_s).exp_m1();
            let share = if regulator.regulation.lag_s > 0.0 { share.max(LEAST_SHARE) } else { 1.0 };
            let set_pa = self.regulated[k].set_pa;
            self.regulated[k] = Regulated { set_pa, from, share };
            if share * (self.wanted_opening(regulator, set_pa) - from).abs() > REGULATED {
                self.hydraulics_valid = false;
            }
        }
    }

    /// Where the pressures of now make a self-acting valve go.
    pub(crate) fn wanted_opening(&self, regulator: &Regulator, set_pa: f64) -> f64 {
        self.wanted_beyond(regulator, set_pa).clamp(0.0, 1.0)
    }

    /// The same on the straight line that goes on beyond the ends.
    pub(crate) fn wanted_beyond(&self, regulator: &Regulator, set_pa: f64) -> f64 {
        let low_pa = regulator.low.map_or(0.0, |node| self.p_pa[node.index()]);
        let sensed_pa = self.p_pa[regulator.high.index()] - low_pa;
        let rise = (sensed_pa - set_pa) / regulator.regulation.band_pa;
        if regulator.regulation.opens { rise } else { 1.0 - rise }
    }

    /// Puts the actuator of an edge where the solver found it.
    pub(crate) fn place_actuator(&mut self, edge: usize, position: f64) {
        self.actuator_lag[edge] = position;
        self.position[edge] = position;
    }

    /// Marks flows and pressures as not belonging to the present inputs, so that they are solved anew.
    pub fn invalidate_hydraulics(&mut self) {
        self.hydraulics_valid = false;
    }

    /// Pressure difference `p_a - p_b` of an edge, Pa.
    #[inline]
    pub fn dp_pa(&self, network: &Network, edge: usize) -> f64 {
        let edge = &network.edges[edge];
        self.p_pa[edge.from.index()] - self.p_pa[edge.to.index()]
    }

    /// Pressure difference of an edge without its hydrostatic part, Pa: what its law answers.
    pub fn driving_pa(&self, network: &Network, edge: usize) -> f64 {
        let (from, to) = (network.edges[edge].from.index(), network.edges[edge].to.index());
        let rise_m = network.nodes[to].elevation_m - network.nodes[from].elevation_m;
        let density = self.density_kg_m3.get(edge).unwrap_or(&network.medium.density_kg_m3);
        self.dp_pa(network, edge) - density * network.gravity_m_s2 * rise_m
    }

    /// Heat stored in all water and pipe walls above 0 degC, J.
    pub fn stored_j(&self, network: &Network) -> f64 {
        let medium = &network.medium;
        let mut stored = 0.0;
        for (i, node) in network.nodes.iter().enumerate() {
            stored += node.water_kg(medium.density_kg_m3) * medium.enthalpy_j_kg(self.t_node_k[i]);
        }
        for (i, edge) in network.edges.iter().enumerate() {
            stored += match edge.element.thermal() {
                EdgeThermal::Pass => 0.0,
                EdgeThermal::PlugFlow(pipe) => self.pipe_stored_j(i, &pipe, medium),
                EdgeThermal::Exchanger(x) => x.volume_kg * medium.enthalpy_j_kg(self.t_edge_k[i]),
            };
        }
        for (port, edge) in network.ports.iter().enumerate() {
            if let EdgeThermal::Exchanger(x) = network.edges[edge.index()].element.thermal() {
                stored += x.volume_kg * medium.enthalpy_j_kg(self.t_secondary_k[port]);
            }
        }
        stored
    }

    /// Heat capacity of all water and pipe walls, J/K.
    pub fn capacity_j_k(&self, network: &Network) -> f64 {
        let nodes = network.nodes.iter().map(|node| node.water_kg(network.medium.density_kg_m3));
        let edges = network.edges.iter().map(|edge| match edge.element.thermal() {
            EdgeThermal::Pass => 0.0,
            EdgeThermal::PlugFlow(pipe) => pipe.capacity_kg(),
            EdgeThermal::Exchanger(x) => x.volume_kg,
        });
        let behind =
            network.ports.iter().map(|port| match network.edges[port.index()].element.thermal() {
                EdgeThermal::Exchanger(x) => x.volume_kg,
                _ => 0.0,
            });
        (nodes.sum::<f64>() + edges.sum::<f64>() + behind.sum::<f64>())
            * network.medium.heat_capacity_j_kg_k
    }
}

/// Lag of each of the two actuator filters over the rise time: `sqrt(sqrt 2 - 1)/5`.
pub const RISE_TO_LAG: f64 = 0.128_718_850_581_116_7;
/// An actuator that follows a flow stays while its target is nearer than this share of its range, so that
/// the two do not chase each other over rounding errors.
const FOLLOWED: f64 = 1e-7;
/// A step is at least so long over the lag of a self-acting valve.
const LEAST_SHARE: f64 = 1e-9;
/// A self-acting valve has its opening within this.
pub(crate) const REGULATED: f64 = 1e-9;
/// An actuator this close to its target has arrived.
const SETTLED: f64 = 1e-9;

/// Water of a node without volume, kg.
pub(crate) const LEAST_WATER_KG: f64 = 1e-6;

impl crate::graph::Node {
    /// Water that mixes at the node, kg: at least 1 mg, so that the temperature of a node without
    /// volume stays defined, and its energy exact, when the flow stops.
    #[inline]
    pub fn water_kg(&self, density_kg_m3: f64) -> f64 {
        (self.volume_m3 * density_kg_m3).max(LEAST_WATER_KG)
    }

    /// Whether the node's pressure is given.
    #[inline]
    pub fn has_fixed_pressure(&self) -> bool {
        !matches!(self.kind, NodeKind::Junction | NodeKind::Source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::{ElementParams, pump::PumpParams};
    use crate::graph::{Edge, GRAVITY_M_S2, Node};
    use anergy_core::ids::NodeId;
    use anergy_core::medium::Medium;

    #[test]
    fn pump_follows_its_rise_time_whatever_the_step() {
        let medium = Medium::default();
        let node = Node { kind: NodeKind::Junction, elevation_m: 0.0, volume_m3: 0.0, ua_w_k: 0.0 };
        let edge = Edge {
            from: NodeId(0),
            to: NodeId(1),
            element: ElementParams::Pump(PumpParams::default()).build(&medium).unwrap(),
            loss_factor: 1.0,
            partner: None,
            leads_partner: false,
        };
        let network = Network {
            medium,
            gravity_m_s2: GRAVITY_M_S2,
            nodes: vec![node.clone(), node],
            edges: vec![edge],
            ports: vec![],
            prescriptions: vec![],
            couplings: vec![],
            soil: vec![],
            regulators: vec![],
        };
        // After the rise time x = 5/sqrt(sqrt 2 - 1) = 7.769: 1 - (1 + x) e^-x = 0.99630
        let run = |steps: i32| {
            let mut state = NetworkState::new(&network, 300.0);
            for _ in 0..steps {
                state.advance_actuator(&network, 0, 1.0, 8.0 / f64::from(steps));
            }
            state.position[0]
        };
        let x = 5.0 / (2_f64.sqrt() - 1.0).sqrt();
        let expected = 1.0 - (1.0 + x) * (-x).exp();
        assert!((expected - 0.9963).abs() < 1e-4);
        for steps in [1, 8, 800] {
            assert!((run(steps) - expected).abs() < 1e-12, "{}", run(steps));
        }
    }
}
