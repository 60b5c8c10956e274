//! Islands behind imposed flows: parts of the network without a pressure level of their own.

use super::{HydraulicError, Kind, Laws, MASS_RESIDUAL_KG_S};
use crate::graph::{Network, NodeKind, UnionFind};
use crate::state::NetworkState;
use anergy_core::ids::NodeId;

/// The parts that laws join, found again when the imposed edges change.
pub(super) struct Islands {
    kind_before: Vec<Kind>,
    sets: UnionFind,
    fixed: Vec<bool>,
    floating: Vec<u32>,
}

impl Islands {
    pub(super) fn new(nodes: usize, edges: usize) -> Self {
        Self {
            kind_before: Vec::with_capacity(edges),
            sets: UnionFind::new(nodes),
            fixed: vec![false; nodes],
            floating: Vec::with_capacity(nodes),
        }
    }

    /// A node of each part without a pressure level.
    pub(super) fn floating(&self) -> &[u32] {
        &self.floating
    }

    /// Whether a node lies in a part without a pressure level.
    pub(super) fn floats(&mut self, node: usize) -> bool {
        let root = self.sets.find(node);
        !self.fixed[root]
    }

    /// Finds the parts where other edges than before are imposed.
    pub(super) fn update(&mut self, network: &Network, kind: &[Kind]) {
        if self.kind_before == kind {
            return;
        }
        self.kind_before.clear();
        self.kind_before.extend_from_slice(kind);
        self.sets.reset();
        let joining = |(_, kind): &(_, &Kind)| **kind != Kind::Imposed;
        for (edge, _) in network.edges.iter().zip(kind).filter(joining) {
            self.sets.union(edge.from.index(), edge.to.index());
        }
        self.fixed.fill(false);
        for (i, node) in network.nodes.iter().enumerate() {
            let root = self.sets.find(i);
            self.fixed[root] |= node.has_fixed_pressure();
        }
        self.floating.clear();
        for i in 0..network.nodes.len() {
            if self.sets.find(i) == i && !self.fixed[i] {
                self.floating.push(i as u32);
            }
        }
    }

    /// What is imposed on an island must sum to zero; `net_inflow` is work space, one place per node.
    ///
    /// # Errors
    /// [`HydraulicError::Unbalanced`] names a node of the island.
    pub(super) fn check(
        &mut self,
        network: &Network,
        state: &NetworkState,
        kind: &[Kind],
        laws: &Laws,
        net_inflow: &mut [f64],
    ) -> Result<(), HydraulicError> {
        if self.floating.is_empty() {
            return Ok(());
        }
        net_inflow.fill(0.0);
        let imposed = |(i, _): &(usize, _)| kind[*i] == Kind::Imposed;
        for (i, edge) in network.edges.iter().enumerate().filter(imposed) {
            let m = laws.loss[i];
            let (a, b) = (self.sets.find(edge.from.index()), self.sets.find(edge.to.index()));
            net_inflow[a] -= m;
            net_inflow[b] += m;
        }
        for (i, node) in network.nodes.iter().enumerate() {
            if node.kind == NodeKind::Source {
                let root = self.sets.find(i);
                net_inflow[root] += state.given_m_flow_kg_s[i];
            }
        }
        for &root in &self.floating {
            let surplus = net_inflow[root as usize];
            if surplus.abs() > MASS_RESIDUAL_KG_S {
                return Err(HydraulicError::Unbalanced {
                    node: NodeId(root),
                    m_flow_kg_s: surplus,
                });
            }
        }
        Ok(())
    }
}
