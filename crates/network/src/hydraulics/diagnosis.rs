//! Who is to blame when a solve fails, and whether its result can be.

use super::{
    ABSURD_PA, HydraulicError, HydraulicSolver, Kind, MAX_ITERATIONS, REFERENCE_EXCHANGE_KG_S,
};
use crate::graph::{Network, NodeKind};
use crate::state::NetworkState;
use anergy_core::ids::{EdgeId, NodeId};

impl HydraulicSolver {
    /// Who is to blame at the iteration limit.
    pub(super) fn not_converged(
        &mut self,
        network: &Network,
        state: &NetworkState,
    ) -> HydraulicError {
        let mut worst = (0.0, 0);
        for i in 0..network.edges.len() {
            let miss = (self.system.driving_pa(state, i) - self.laws.loss[i]).abs();
            if self.kind[i] == Kind::Law && miss > worst.0 {
                worst = (miss, i);
            }
        }
        let dp_pa = |i: usize| state.dp_pa(network, i);
        let steepest = (0..network.edges.len())
            .filter(|&i| self.kind[i] == Kind::Law)
            .max_by(|&i, &j| dp_pa(i).abs().total_cmp(&dp_pa(j).abs()));
        if let Some(i) = steepest.filter(|&i| dp_pa(i).abs() > ABSURD_PA) {
            return HydraulicError::Absurd {
                edge: EdgeId::from_index(i),
                dp_pa: dp_pa(i),
                m_flow_kg_s: state.m_flow_kg_s[i],
            };
        }
        let (mass_residual_kg_s, node) = self.system.mass_residual(state);
        HydraulicError::NotConverged {
            iterations: MAX_ITERATIONS,
            edge: EdgeId::from_index(worst.1),
            residual_pa: worst.0,
            node: NodeId::from_index(node),
            mass_residual_kg_s,
        }
    }

    /// A pressure reference exchanges no water.
    pub(super) fn check_references(
        &self,
        network: &Network,
        state: &NetworkState,
    ) -> Result<(), HydraulicError> {
        for (i, node) in network.nodes.iter().enumerate() {
            let exchange = state.exchange_kg_s[i];
            if node.kind == NodeKind::PressureReference && exchange.abs() > REFERENCE_EXCHANGE_KG_S
            {
                return Err(HydraulicError::Unbalanced {
                    node: NodeId::from_index(i),
                    m_flow_kg_s: -exchange,
                });
            }
        }
        Ok(())
    }
}
