//! The first iterations of a cold solve: flows far from any that their pressures could drive.
//!
//! **Numerics** Newton halves the flow through a quadratic law in each iteration while it is far too
//! large; the linear first guess can be nine decades too large in a closed check valve.

use super::{HydraulicError, HydraulicSolver, Kind, SLOPE_CAP, SLOPE_FLOOR};
use crate::graph::Network;
use crate::state::NetworkState;
use crate::two_port::Characteristic;
use anergy_core::ids::EdgeId;

/// In so many iterations flows are reconsidered.
pub(super) const ITERATIONS: u32 = 4;
/// Those whose loss is so many times what drives them ...
const RATIO: f64 = 10.0;
/// ... and more than this share of the largest pressure.
const SHARE: f64 = 0.1;

impl HydraulicSolver {
    /// Flows that a first step pressed through what is nearly closed are put near those that their
    /// pressures would drive, instead of being halved in each of many iterations; the next step balances
    /// mass again. Whether there was any.
    pub(super) fn reconsider(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<bool, HydraulicError> {
        let much_pa = SHARE * self.system.largest_p_pa();
        let mut any = false;
        for (i, edge) in network.edges.iter().enumerate() {
            let loss = self.laws.loss[i].abs();
            if self.kind[i] != Kind::Law || loss <= much_pa {
                continue;
            }
            let driving_pa = self.system.driving_pa(state, i);
            let driving = driving_pa.abs();
            if loss <= RATIO * driving {
                continue;
            }
            // As if the loss rose with the square of the flow.
            let m = state.m_flow_kg_s[i] * (driving / loss).sqrt();
            let at = state.edge_state(network, i);
            if let Characteristic::PressureLoss(law) = self.answer(edge, i, m, &at) {
                if !(law.value.is_finite() && law.slope.is_finite()) {
                    return Err(HydraulicError::NotFinite { edge: EdgeId::from_index(i) });
                }
                state.m_flow_kg_s[i] = m;
                self.laws.loss[i] = law.value;
                self.laws.slope[i] = law.slope.clamp(SLOPE_FLOOR, SLOPE_CAP);
                self.miss_pa[i] = driving_pa - law.value;
                any = true;
            }
        }
        Ok(any)
    }
}
