//! The linear answer of the nodal system to small disturbances.

use super::{EdgeSlots, NONE, NodalSystem, balance, difference};
use crate::graph::Network;
use crate::hydraulics::{HydraulicError, Kind, Laws};

/// A small disturbance of a network, and its answer.
#[derive(Debug, Clone, Default)]
pub(in crate::hydraulics) struct Disturbance {
    /// Change of the flow of each edge while no pressure changes, kg/s.
    pub pushed_kg_s: Vec<f64>,
    /// Given change of pressure: of fixed nodes, and of those that ideal heads join to them, Pa.
    pub shift_pa: Vec<f64>,
    /// Water that enters at each node, kg/s.
    pub inflow_kg_s: Vec<f64>,
}

impl Disturbance {
    pub(in crate::hydraulics) fn new(network: &Network) -> Self {
        let (nodes, edges) = (network.nodes.len(), network.edges.len());
        Self {
            pushed_kg_s: vec![0.0; edges],
            shift_pa: vec![0.0; nodes],
            inflow_kg_s: vec![0.0; nodes],
        }
    }

    pub(in crate::hydraulics) fn clear(&mut self) {
        self.pushed_kg_s.fill(0.0);
        self.shift_pa.fill(0.0);
        self.inflow_kg_s.fill(0.0);
    }
}

impl NodalSystem {
    /// Factorises for the slopes of the laws, without a step.
    pub(in crate::hydraulics) fn factorise(
        &mut self,
        network: &Network,
        kind: &[Kind],
        laws: &Laws,
    ) -> Result<(), HydraulicError> {
        self.islands.update(network, kind);
        let values = self.conductances.values_mut();
        values.fill(0.0);
        let mut largest_conductance = 0.0_f64;
        for (i, slots) in self.slots.iter().enumerate().filter(|(i, _)| kind[*i] == Kind::Law) {
            let conductance = 1.0 / laws.slope[i];
            largest_conductance = largest_conductance.max(conductance);
            if slots.conductance != NONE {
                values[slots.conductance as usize] += conductance;
            }
        }
        self.tie_floating(largest_conductance);
        Ok(self.conductances.factor()?)
    }

    /// An island without fixed pressure keeps its level: no flow passes this conductance.
    pub(super) fn tie_floating(&mut self, largest_conductance: f64) {
        let values = self.conductances.values_mut();
        for &root in self.islands.floating() {
            let slot = self.to_fixed[self.unknown_of_node[root as usize] as usize];
            values[slot as usize] += largest_conductance.max(1e-12);
        }
    }

    /// Answer to a disturbance, at the last factorisation: change of the flows, kg/s, and pressures, Pa.
    pub(in crate::hydraulics) fn answer(
        &mut self,
        network: &Network,
        kind: &[Kind],
        laws: &Laws,
        disturbance: &Disturbance,
        m_flow_kg_s: &mut [f64],
        p_pa: &mut [f64],
    ) {
        let Disturbance { pushed_kg_s, shift_pa, inflow_kg_s } = disturbance;
        self.increment.fill(0.0);
        for (&unknown, inflow) in self.unknown_of_node.iter().zip(inflow_kg_s) {
            if unknown != NONE {
                self.increment[unknown as usize] += inflow;
            }
        }
        for (i, slots) in self.slots.iter().enumerate() {
            let mut m = pushed_kg_s[i];
            if kind[i] == Kind::Law {
                m += shift_between(slots, shift_pa) / laws.slope[i];
            }
            if kind[i] != Kind::Ideal {
                balance(&mut self.increment, slots, m);
            }
            m_flow_kg_s[i] = m;
        }
        self.solve();
        for (node, p) in p_pa.iter_mut().enumerate() {
            *p = shift_pa[node] + self.response_pa(node);
        }
        for (i, slots) in self.slots.iter().enumerate().filter(|(i, _)| kind[*i] == Kind::Law) {
            // Not from the pressures: the differences of a stiff network would drown in them.
            m_flow_kg_s[i] += difference(&self.increment, slots) / laws.slope[i];
        }
        if !self.ideal_links.is_empty() {
            self.flows_of_ideal_heads(network, inflow_kg_s, m_flow_kg_s);
        }
    }

    /// Flows of the ideal head sources from those of the other edges and what enters the nodes.
    fn flows_of_ideal_heads(
        &mut self,
        network: &Network,
        inflow_kg_s: &[f64],
        m_flow_kg_s: &mut [f64],
    ) {
        self.net_inflow.copy_from_slice(inflow_kg_s);
        for (edge, m) in network.edges.iter().zip(&*m_flow_kg_s) {
            if !network.is_ideal(edge) {
                self.net_inflow[edge.from.index()] -= m;
                self.net_inflow[edge.to.index()] += m;
            }
        }
        for link in self.ideal_links.iter().rev() {
            let surplus = self.net_inflow[link.child as usize];
            self.net_inflow[link.parent as usize] += surplus;
            let edge = link.edge as usize;
            let towards_parent = network.edges[edge].to.0 == link.parent;
            m_flow_kg_s[edge] = if towards_parent { surplus } else { -surplus };
        }
    }

    /// Adds a change of pressure, Pa, of a node and of all that ideal heads join to it from there on.
    pub(in crate::hydraulics) fn shift_tree(&self, node: usize, by_pa: f64, shift_pa: &mut [f64]) {
        shift_pa[node] += by_pa;
        // Links are ordered from the root to the leaves.
        let below = |link: &&crate::hydraulics::ideal::IdealLink| {
            let mut at = link.parent as usize;
            loop {
                if at == node {
                    return true;
                }
                match self.ideal_links.iter().find(|above| above.child as usize == at) {
                    Some(above) => at = above.parent as usize,
                    None => return false,
                }
            }
        };
        for link in self.ideal_links.iter().filter(below) {
            shift_pa[link.child as usize] += by_pa;
        }
    }

    /// The node that an ideal head sets against the rest, with the sign of `p_b - p_a` there.
    pub(in crate::hydraulics) fn set_by_head(
        &self,
        network: &Network,
        edge: usize,
    ) -> (usize, f64) {
        let child = self
            .ideal_links
            .iter()
            .find(|link| link.edge as usize == edge)
            .map_or(network.edges[edge].to.index(), |link| link.child as usize);
        (child, if network.edges[edge].to.index() == child { 1.0 } else { -1.0 })
    }

    /// Response of the pressures to 1 Pa of head in an edge, at the last factorisation.
    pub(in crate::hydraulics) fn respond(&mut self, edge: usize, laws: &Laws) {
        self.increment.fill(0.0);
        balance(&mut self.increment, &self.slots[edge], 1.0 / laws.slope[edge]);
        self.solve();
    }

    /// Response of all unknowns, Pa/Pa; one place more for the fixed pressures.
    pub(in crate::hydraulics) fn responses(&self) -> &[f64] {
        &self.increment
    }

    /// Response of the pressure of a node, Pa/Pa.
    pub(in crate::hydraulics) fn response_pa(&self, node: usize) -> f64 {
        let unknown = self.unknown_of_node[node];
        if unknown == NONE { 0.0 } else { self.increment[unknown as usize] }
    }

    /// Response of the pressure difference of an edge, Pa/Pa.
    pub(in crate::hydraulics) fn response_dp_pa(&self, edge: usize) -> f64 {
        let slots = &self.slots[edge];
        self.response_pa(slots.node_a as usize) - self.response_pa(slots.node_b as usize)
    }
}

/// `p_a - p_b` of an edge.
fn shift_between(slots: &EdgeSlots, p_pa: &[f64]) -> f64 {
    p_pa[slots.node_a as usize] - p_pa[slots.node_b as usize]
}
