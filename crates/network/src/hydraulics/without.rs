//! The network without the flow through one edge: what the rest does to its ends.

use super::linearize::Linearization;
use super::prescribed::Stand;
use super::{HydraulicError, HydraulicSolver};
use crate::graph::Network;
use crate::state::NetworkState;
use anergy_core::ids::EdgeId;

impl HydraulicSolver {
    /// Lets nothing flow through an edge, whatever its law, from the next solve on; `None` gives it back. A
    /// prescription that has this edge as its free one rests.
    pub fn shut(&mut self, network: &Network, edge: Option<EdgeId>) {
        self.shut = edge;
        self.known = false;
        self.stand.clear();
        if edge.is_some() || !network.prescriptions.is_empty() {
            self.stand.resize(network.edges.len(), Stand::Own);
        }
        self.clear_stands();
    }

    pub(super) fn is_shut(&self, edge: usize) -> bool {
        self.shut.is_some_and(|shut| shut.index() == edge)
    }

    /// Every edge has its own law again, but for the one that is shut.
    pub(super) fn clear_stands(&mut self) {
        self.stand.fill(Stand::Own);
        if let Some(shut) = self.shut {
            self.stand[shut.index()] = Stand::Flow(0.0);
        }
    }
}

impl Linearization {
    /// Solves the network with nothing flowing through an edge (with all edges for `None`) and linearises it
    /// there; `state` becomes that state.
    ///
    /// # Errors
    /// As [`HydraulicSolver::solve`] and [`Linearization::update`].
    pub fn solve_without(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        edge: Option<EdgeId>,
    ) -> Result<(), HydraulicError> {
        self.solver.shut(network, edge);
        state.begin_flow_step(f64::INFINITY);
        state.invalidate_hydraulics();
        self.solver.solve(network, state)?;
        self.update(network, state)
    }

    /// Whether nothing determines the pressure at an end of an edge, after a solve.
    pub(crate) fn floats(&mut self, network: &Network, edge: EdgeId) -> bool {
        self.solver.system.joins_floating(network, edge.index())
    }
}
