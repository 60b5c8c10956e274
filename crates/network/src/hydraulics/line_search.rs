//! How far a Newton step is followed, and whether where it leads is the solution.
//!
//! **Numerics** with the pressures that belong to the step, the slope of the content along it is
//! `g(alpha) = sum step (phi(m + alpha step) - (p_a - p_b) + rho g dz)`; pressures cancel, since the step
//! has no net inflow anywhere. The content is convex: g rises, and its zero is the least content.

use super::{
    CORRECTION_KG_S, CORRECTION_RELATIVE, HydraulicError, HydraulicSolver, Kind, SLOPE_CAP,
    SLOPE_FLOOR,
};
use crate::graph::Network;
use crate::state::NetworkState;
use crate::two_port::Characteristic;
use anergy_core::ids::EdgeId;

/// A step is accepted when the slope of the content has fallen to this share.
const CONTENT_SLOPE_SHARE: f64 = 0.5;
/// Rounding of a pressure difference, relative to the largest pressure.
const PRESSURE_ROUNDING: f64 = 2e-15;
/// Beyond this pressure, which no component holds, misses within its rounding do not count.
const EXTREME_PA: f64 = 1e9;
/// A law is straight where its slope changes by less than this share in a step.
const STRAIGHT: f64 = 0.1;
const MAX_LINE_SEARCH: u32 = 40;

/// What a trial step found.
pub(super) struct Trial {
    /// Slope of the content along the step.
    content_slope: f64,
    /// Largest pressure residual, Pa.
    pub(super) residual_pa: f64,
    /// Largest flow that an edge would change by if its ends kept their pressures, over the tolerance;
    /// misses within the rounding of the law do not count.
    pub(super) correction: f64,
}

impl HydraulicSolver {
    /// Moves the flows along the Newton step.
    pub(super) fn take_step(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        line_search: bool,
        overshoot: f64,
    ) -> Result<Trial, HydraulicError> {
        let mut trial = self.evaluate_trial(network, state, 1.0)?;
        // Where the content still falls at its end, the full step is none too long.
        let mut start = 0.0;
        let mut overshoots = line_search && trial.content_slope > 0.0;
        if overshoots {
            let (content_slope, moved) = self.start_of_step();
            start = content_slope;
            // Below the rounding of the pressures the slope says nothing, and only a full step balances mass.
            let rounding = PRESSURE_ROUNDING * self.system.largest_p_pa() * moved;
            overshoots = trial.content_slope > rounding - overshoot * start;
        }
        if overshoots {
            // The full step overshoots the minimum of the content along it: false position and halving.
            let (mut low, mut low_slope, mut high, mut high_slope) =
                (0.0, start, 1.0, trial.content_slope);
            for i in 0..MAX_LINE_SEARCH {
                let secant = low + (high - low) * low_slope / (low_slope - high_slope);
                let margin = 0.1 * (high - low);
                let alpha = if i % 2 == 0 {
                    secant.clamp(low + margin, high - margin)
                } else {
                    0.5 * (low + high)
                };
                trial = self.evaluate_trial(network, state, alpha)?;
                // The content has surely fallen: it is convex, so it fell by -low_slope low at least and
                // rose by content_slope (alpha - low) at most.
                let falls = trial.content_slope * (alpha - low).max(0.0) <= -0.5 * low_slope * low;
                if falls && trial.content_slope.abs() <= -CONTENT_SLOPE_SHARE * start {
                    break;
                }
                if trial.content_slope < 0.0 {
                    (low, low_slope) = (alpha, trial.content_slope);
                } else {
                    (high, high_slope) = (alpha, trial.content_slope);
                }
            }
        }
        std::mem::swap(&mut state.m_flow_kg_s, &mut self.trial_m_kg_s);
        std::mem::swap(&mut self.laws, &mut self.trial_laws);
        Ok(trial)
    }

    /// Slope of the content at the start of the step, and the sum of what all flows move by.
    fn start_of_step(&self) -> (f64, f64) {
        let steps = self.step.iter().zip(&self.laws.slope).zip(&self.kind);
        let laws = steps.filter(|(_, kind)| **kind == Kind::Law);
        laws.fold((0.0, 0.0), |(content_slope, moved), ((step, slope), _)| {
            (content_slope - step * step * slope, moved + step.abs())
        })
    }

    /// Laws at the flows that this share of the step leads to.
    fn evaluate_trial(
        &mut self,
        network: &Network,
        state: &NetworkState,
        share: f64,
    ) -> Result<Trial, HydraulicError> {
        let mut trial = Trial { content_slope: 0.0, residual_pa: 0.0, correction: 0.0 };
        let extreme_pa = self.extreme_pa();
        for (i, edge) in network.edges.iter().enumerate() {
            let m = state.m_flow_kg_s[i] + share * self.step[i];
            self.trial_m_kg_s[i] = m;
            if self.kind[i] != Kind::Law {
                self.trial_laws.loss[i] = self.laws.loss[i];
                self.trial_laws.slope[i] = self.laws.slope[i];
                continue;
            }
            let Characteristic::PressureLoss(law) =
                self.answer(edge, i, m, &state.edge_state(network, i))
            else {
                return Err(HydraulicError::NotFinite { edge: EdgeId::from_index(i) });
            };
            let miss = self.system.driving_pa(state, i) - law.value;
            let slope = law.slope.clamp(SLOPE_FLOOR, SLOPE_CAP);
            self.trial_laws.loss[i] = law.value;
            self.trial_laws.slope[i] = slope;
            self.miss_pa[i] = miss;
            trial.content_slope -= self.step[i] * miss;
            let size = miss.abs();
            if !size.is_finite() {
                return Err(self.not_finite(network, state, i));
            }
            trial.residual_pa = trial.residual_pa.max(size);
            let tolerance = slope * (CORRECTION_KG_S + CORRECTION_RELATIVE * m.abs());
            let rounding = PRESSURE_ROUNDING * extreme_pa.max(law.value.abs());
            if size - rounding > trial.correction * tolerance {
                trial.correction = (size - rounding) / tolerance;
            }
        }
        Ok(trial)
    }

    /// Whether the flows that belong to the pressures are where the slopes say. Behind a corner of a law they
    /// are not: a limiter at rest misses 1e-6 Pa with a slope of 1e6 Pa s/kg, and its flow by 1e-8 kg/s.
    /// Laws whose slope did not change over the last step are straight enough.
    pub(super) fn surrounds(&self, network: &Network, state: &NetworkState) -> bool {
        let extreme_pa = self.extreme_pa();
        // The step exchanged the laws: those of the trial are the ones before it.
        let slopes = self.laws.slope.iter().zip(&self.trial_laws.slope);
        slopes.zip(&network.edges).enumerate().all(|(i, ((&slope, &before), edge))| {
            if self.kind[i] != Kind::Law || (slope - before).abs() <= STRAIGHT * slope {
                return true;
            }
            let (m, loss, miss) = (state.m_flow_kg_s[i], self.laws.loss[i], self.miss_pa[i]);
            if miss.abs() <= PRESSURE_ROUNDING * extreme_pa.max(loss.abs()) {
                return true;
            }
            let allowed = 2.0 * (CORRECTION_KG_S + CORRECTION_RELATIVE * m.abs());
            match self.answer(edge, i, m + allowed.copysign(miss), &state.edge_state(network, i)) {
                Characteristic::PressureLoss(beyond) => (beyond.value - loss).abs() >= miss.abs(),
                _ => false,
            }
        })
    }

    /// The largest pressure where it is one that no component holds, otherwise 0, Pa: what is below its rounding does
    /// not count.
    fn extreme_pa(&self) -> f64 {
        let largest_p_pa = self.system.largest_p_pa();
        if largest_p_pa > EXTREME_PA { largest_p_pa } else { 0.0 }
    }
}
