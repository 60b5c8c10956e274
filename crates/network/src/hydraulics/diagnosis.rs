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
        if let Some(absurd) = self.absurd(network, state) {
            return absurd;
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

    /// Who is to blame for a law that is not finite at the flows of a trial: pressures that nothing holds may have
    /// led there, otherwise an input.
    pub(super) fn not_finite(
        &self,
        network: &Network,
        state: &NetworkState,
        edge: usize,
    ) -> HydraulicError {
        let not_finite = HydraulicError::NotFinite { edge: EdgeId::from_index(edge) };
        self.absurd(network, state).unwrap_or(not_finite)
    }

    /// The edge with the largest pressure difference, if nothing holds that.
    fn absurd(&self, network: &Network, state: &NetworkState) -> Option<HydraulicError> {
        let dp_pa = |i: usize| state.dp_pa(network, i);
        let steepest = (0..network.edges.len())
            .filter(|&i| self.kind[i] == Kind::Law && dp_pa(i).is_finite())
            .max_by(|&i, &j| dp_pa(i).abs().total_cmp(&dp_pa(j).abs()))?;
        (dp_pa(steepest).abs() > ABSURD_PA).then(|| HydraulicError::Absurd {
            edge: EdgeId::from_index(steepest),
            dp_pa: dp_pa(steepest),
            m_flow_kg_s: state.m_flow_kg_s[steepest],
        })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::{ElementParams, pipe::PipeParams};
    use crate::graph::{Edge, GRAVITY_M_S2, Node};
    use anergy_core::medium::Medium;

    #[test]
    fn a_law_that_overflows_at_pressures_that_nothing_holds_is_not_an_input() {
        let medium = Medium::default();
        let node = |kind| Node { kind, elevation_m: 0.0, volume_m3: 0.0, ua_w_k: 0.0 };
        let edge = |from, to| Edge {
            from: NodeId(from),
            to: NodeId(to),
            element: ElementParams::Pipe(PipeParams::default()).build(&medium).unwrap(),
            loss_factor: 1.0,
            partner: None,
            leads_partner: false,
        };
        let kinds = [NodeKind::PressureBoundary, NodeKind::Junction, NodeKind::Source];
        let network = Network {
            gravity_m_s2: GRAVITY_M_S2,
            nodes: kinds.map(node).to_vec(),
            edges: vec![edge(0, 1), edge(1, 2)],
            medium,
            ports: vec![],
            prescriptions: vec![],
            couplings: vec![],
            soil: vec![],
            regulators: vec![],
        };
        let mut state = NetworkState::new(&network, 300.0);
        let solver = HydraulicSolver::new(&network).unwrap();
        state.p_pa.copy_from_slice(&[1e5, 0.9e5, -2e5]);
        let blamed = solver.not_finite(&network, &state, 0);
        assert_eq!(blamed, HydraulicError::NotFinite { edge: EdgeId(0) });
        // 12 kg/s would have to pass the second edge at 1e20 Pa, whichever law overflows on the way there.
        state.p_pa[2] = -1e20;
        state.m_flow_kg_s[1] = 12.0;
        match solver.not_finite(&network, &state, 0) {
            HydraulicError::Absurd { edge, dp_pa, m_flow_kg_s } => {
                assert_eq!((edge, m_flow_kg_s), (EdgeId(1), 12.0));
                assert!((dp_pa / 1e20 - 1.0).abs() < 1e-12, "{dp_pa}");
            }
            other => panic!("{other:?}"),
        }
    }
}
