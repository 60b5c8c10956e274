//! One heat capacity in the thermal resistance of a pipe: ground of which little is known.
//!
//! **Equation** `C dT/dt = (T_water - T)/((1 - s) R) - (T - T_around)/(s R)`, solved as the only ring of [`crate::soil`].

use super::PipeParams;
use super::laying::{Laying, out_of_range, problem};
use crate::soil::SoilRings;
use crate::two_port::{ElementError, positive};
use anergy_core::ids::EdgeId;

/// Share of the thermal resistance beyond the node, where it is not given.
const SHARE: f64 = 0.5;

impl PipeParams {
    fn share_beyond(&self) -> f64 {
        self.ground_share.unwrap_or(SHARE)
    }

    /// The node, where there is one; `whole_k_m_w` is the resistance from the water to the ground.
    pub(super) fn ground_node(
        &self,
        edge: EdgeId,
        first: usize,
        whole_k_m_w: f64,
    ) -> Option<SoilRings> {
        let share = self.share_beyond();
        let between_k_m_w = [(1.0 - share) * whole_k_m_w, share * whole_k_m_w];
        let capacity_j_m_k = self.ground_capacity_j_m_k?;
        Some(SoilRings::node(edge, first, self.length_m, capacity_j_m_k, between_k_m_w))
    }

    /// Whether a node of the ground can be around it.
    pub(super) fn check_ground_node(&self) -> Result<(), ElementError> {
        let Some(capacity_j_m_k) = self.ground_capacity_j_m_k else {
            return match self.ground_share {
                Some(_) => problem("ground_share needs ground_capacity_j_m_k"),
                None => Ok(()),
            };
        };
        positive("ground_capacity_j_m_k", capacity_j_m_k)?;
        let share = self.share_beyond();
        if !(0.01..=0.99).contains(&share) {
            return out_of_range("ground_share", share, "must lie between 0.01 and 0.99");
        }
        let beside = self.spacing_m.is_some() || self.companion.is_some();
        if self.soil_rings.is_some() || beside || self.laying == Some(Laying::Twin) {
            return problem(
                "ground_capacity_j_m_k is that of a pipe that lies alone, without soil_rings, companion or twin",
            );
        }
        if self.laying.is_none() && self.insulation_resistance_k_m_w.is_none() {
            return problem(
                "ground_capacity_j_m_k needs a heat loss: insulation_resistance_k_m_w or laying",
            );
        }
        Ok(())
    }
}
