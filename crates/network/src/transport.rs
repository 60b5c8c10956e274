//! Temperatures of the whole network during one step of constant flow.
//!
//! Every edge states its mean outlet temperature as a linear function of its inlet temperature (pipes
//! usually as a constant: what leaves was inside already); every node mixes what flows in. The nodes
//! are swept in flow direction; where a thermally closed loop remains, the node temperatures are one
//! sparse linear system. Flows of heat are means over the step, so energy closes to rounding.
//!
//! **Equation** node with mass M: `M dT/dt = sum m_in (T_in - T)`, solved exactly over the step:
//! with `a = sum m_in dt/M` the mean outflow temperature is `g T_old + (1-g) T_mix`,
//! `g = (1 - e^-a)/a`. A loss `UA (T - T_ambient)` is one more inflow, `UA/cp` at the ambient. Standing nodes without volume take the
//! mean of the ends of their pipes ([`JOINT_RELAXATION_S`]); without pipes that of the ambient ([`NODE_RELAXATION_S`]).
//!
//! **Sources** specification 9 and 10; `vanderheijde2017`.

pub mod cells;
mod content;
mod coupling;
mod edges;
mod follow;
mod friction;
mod nodes;
pub mod parcels;
mod pipes;
mod plug_flow;
mod pool;
mod weight;

use self::coupling::Coupled;
use self::plug_flow::Decay;
use crate::graph::Network;
use crate::state::NetworkState;
use anergy_core::error::FactorError;
use anergy_core::numerics::sparse::SparseLu;

/// Time constant with which the water of a node without flow takes the temperature of the ends of its pipes, s.
pub const JOINT_RELAXATION_S: f64 = 60.0;
/// Time constant with which it takes the temperature around it where there are no pipes, s.
pub const NODE_RELAXATION_S: f64 = 3600.0;
const NONE: u32 = u32::MAX;

/// Mean outlet temperature of an edge: `constant_k + of_inlet T_in + of_partner T_in(partner)`, at least
/// `coldest_k` where the inlet is not colder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Relation {
    constant_k: f64,
    of_inlet: f64,
    of_partner: f64,
    coldest_k: f64,
}

impl Relation {
    const PASS: Self =
        Self { constant_k: 0.0, of_inlet: 1.0, of_partner: 0.0, coldest_k: f64::NEG_INFINITY };

    fn constant(t_k: f64) -> Self {
        Self { constant_k: t_k, of_inlet: 0.0, ..Self::PASS }
    }

    /// Behind a mixed volume of temperature `t_k` that keeps the share `kept`.
    fn through_volume(self, t_k: f64, kept: f64) -> Self {
        Self {
            constant_k: kept * t_k + (1.0 - kept) * self.constant_k,
            of_inlet: (1.0 - kept) * self.of_inlet,
            of_partner: (1.0 - kept) * self.of_partner,
            ..self
        }
    }
}

/// Share of its temperature that a volume keeps in its mean outflow, `(1 - e^-a)/a`, and at the end of
/// the step, `e^-a`; `a` is the throughput over the content.
fn volume_shares(throughput_kg: f64, content_kg: f64) -> (f64, f64) {
    if content_kg <= 0.0 {
        return (0.0, 0.0);
    }
    let a = throughput_kg / content_kg;
    if a < 1e-9 { (1.0 - 0.5 * a, 1.0 - a) } else { (-(-a).exp_m1() / a, (-a).exp()) }
}

/// Work space of the thermal sweep; holds no state of the network.
pub struct Transport {
    relation: Vec<Relation>,
    /// The same in loops that are solved together, where coldest temperatures are held.
    in_loops: Vec<Relation>,
    /// Edge of each port and port of each edge.
    port_of_edge: Vec<u32>,
    /// Edges at each node: `incident[first[n]..first[n + 1]]`.
    first: Vec<u32>,
    incident: Vec<u32>,
    /// Nodes in flow direction; shorter than the number of nodes when a loop remains.
    order: Vec<u32>,
    waiting: Vec<u32>,
    /// What the order depends on: direction of flow and dependence of each edge.
    key: Vec<u8>,
    inflow_kg_s: Vec<f64>,
    inflow_heat: Vec<f64>,
    /// Mean temperature of the water that leaves each node, K.
    t_mean_k: Vec<f64>,
    lu: SparseLu,
    /// Heat loss of each pipe over a step of `decays_dt_s`.
    decays: Vec<Decay>,
    decays_dt_s: f64,
    coupled: Coupled,
}

impl Transport {
    /// Prepares the sweep of a network.
    ///
    /// # Errors
    /// [`FactorError::Symbolic`] when the pattern of the node temperatures cannot be analysed.
    pub fn new(network: &Network) -> Result<Self, FactorError> {
        let (n, edges) = (network.nodes.len(), network.edges.len());
        let mut port_of_edge = vec![NONE; edges];
        for (port, edge) in network.ports.iter().enumerate() {
            port_of_edge[edge.index()] = port as u32;
        }
        let mut first = vec![0_u32; n + 1];
        for edge in &network.edges {
            first[edge.from.index() + 1] += 1;
            first[edge.to.index() + 1] += 1;
        }
        for i in 0..n {
            first[i + 1] += first[i];
        }
        let mut fill = first.clone();
        let mut incident = vec![0_u32; 2 * edges];
        let mut pattern = Vec::with_capacity(4 * edges);
        for (i, edge) in network.edges.iter().enumerate() {
            let (a, b) = (edge.from.index(), edge.to.index());
            for node in [a, b] {
                incident[fill[node] as usize] = i as u32;
                fill[node] += 1;
            }
            pattern.extend([(a, b), (b, a)]);
            if let Some(partner) = edge.partner {
                let other = &network.edges[partner.index()];
                for row in [a, b] {
                    pattern.extend([(row, other.from.index()), (row, other.to.index())]);
                }
            }
        }
        Ok(Self {
            relation: vec![Relation::PASS; edges],
            in_loops: vec![Relation::PASS; edges],
            port_of_edge,
            first,
            incident,
            order: Vec::with_capacity(n),
            waiting: vec![0; n],
            key: vec![u8::MAX; edges],
            inflow_kg_s: vec![0.0; n],
            inflow_heat: vec![0.0; n],
            t_mean_k: vec![0.0; n],
            lu: SparseLu::analyze(n, &pattern)?,
            decays: vec![Decay::default(); edges],
            decays_dt_s: f64::NAN,
            coupled: Coupled::new(network),
        })
    }

    /// Advances all temperatures by `dt_s` with the flows of the state.
    ///
    /// # Errors
    /// [`FactorError::Singular`] when a closed loop of nodes has no defined temperature.
    pub fn advance(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        dt_s: f64,
    ) -> Result<(), FactorError> {
        self.prepare_decays(network, dt_s);
        state.q_flow_w.fill(0.0);
        state.q_loss_w.fill(0.0);
        self.exchange_beside(network, state, 0.5 * dt_s, dt_s);
        self.collect_inflows(network, state);
        self.relax_nodes(network, state, dt_s);
        for edge in 0..network.edges.len() {
            self.relation[edge] = self.edge_relation(network, state, edge, Some(dt_s));
        }
        self.add_friction(network, state);
        self.node_temperatures(network, state, Some(dt_s))?;
        state.q_loss_nodes_w += self.volume_losses_w(network, state);
        self.advance_edges(network, state, dt_s);
        self.exchange_beside(network, state, 0.5 * dt_s, dt_s);
        self.advance_nodes(network, state, dt_s);
        self.weigh(network, state);
        self.follow(network, state);
        Ok(())
    }

    /// Mean temperature of the water that left a node in the last step (or leaves it in the steady state),
    /// K.
    pub fn mean_k(&self, node: usize) -> f64 {
        self.t_mean_k[node]
    }

    /// Settles all temperatures to the steady state of the present flows and requests: pipes get
    /// their steady profile, volumes their inlet temperature. One pass; units whose outlet depends
    /// on what they get need several.
    ///
    /// # Errors
    /// [`FactorError::Singular`] when a closed loop of nodes has no defined temperature.
    pub fn settle(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<(), FactorError> {
        self.collect_inflows(network, state);
        for edge in 0..network.edges.len() {
            self.relation[edge] = self.edge_relation(network, state, edge, None);
        }
        self.add_friction(network, state);
        self.node_temperatures(network, state, None)?;
        state.q_loss_nodes_w = self.volume_losses_w(network, state);
        for edge in 0..network.edges.len() {
            self.settle_edge(network, state, edge);
        }
        state.t_node_k.copy_from_slice(&self.t_mean_k);
        self.weigh_settled(network, state);
        self.follow_settled(network, state);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
