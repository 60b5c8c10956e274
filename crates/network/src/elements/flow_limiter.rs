//! A flow limiter: an open valve up to its set flow, which it does not let be exceeded.
//!
//! **Equation** `dp = max(m|m|/k_vs^2, k (m - m_set))` with a steep `k` of 1 bar per 1e-4 of the set flow:
//! beyond the set flow the valve throttles whatever pressure there is. Reverse flow meets the open valve.
//!
//! **Assumptions** no lag beyond that of its command; any pressure difference can be throttled.
//! **Validity** forward flow from a to b, the only direction that is limited.
//!
//! **Numerics** strictly monotone; C1 by rounding the corner within 10 Pa, beyond the set flow. The corner
//! is sharper than a Newton step can foresee: several limiters that begin to act together take one or two
//! iterations each. A set flow below 1 % of the nominal flow is held as sharply as that one.
//!
//! **Sources** Rossman et al. 2020 (flow control valve, key `rossman2020`), `wetter2014` (regularised law).

use super::flow_coefficient;
use crate::two_port::{
    Actuator, Characteristic, EdgeState, ElementError, TwoPort, not_negative, positive,
};
use anergy_core::linear::Linear;
use anergy_core::medium::Medium;
use anergy_core::numerics::regularize::{quadratic, smooth_max};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Pressure difference that the limiter takes over its band, Pa.
const BAND_PA: f64 = 1e5;
/// Excess of the flow at that pressure difference, relative to the set flow.
const BAND: f64 = 1e-4;
/// The band is that of this share of the nominal flow, at least.
const LEAST_FLOW: f64 = 1e-2;
/// Rounding of the corner, Pa.
const ROUNDING_PA: f64 = 10.0;

/// A flow limiter as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlowLimiterParams {
    /// Flow in m3/h at 1 bar when fully open.
    pub kvs_m3_h: f64,
    /// Largest flow from a to b while nothing drives it, kg/s.
    pub m_flow_set_kg_s: f64,
    /// Time in which the set flow follows its command by 99.6 %, s.
    #[serde(default)]
    pub rise_time_s: f64,
    /// Regularised below this share of the flow at 0.1 bar.
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
}

fn default_delta_m() -> f64 {
    0.02
}

impl Default for FlowLimiterParams {
    fn default() -> Self {
        Self { kvs_m3_h: 2.5, m_flow_set_kg_s: 0.2, rise_time_s: 0.0, delta_m: default_delta_m() }
    }
}

/// A flow limiter ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowLimiter {
    open: f64,
    m_flow_set_kg_s: f64,
    rise_time_s: f64,
    m_flow_nominal_kg_s: f64,
    m_turbulent_kg_s: f64,
}

impl FlowLimiterParams {
    /// The runtime flow limiter.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<FlowLimiter, ElementError> {
        let k = flow_coefficient(positive("kvs_m3_h", self.kvs_m3_h)?, medium.density_kg_m3);
        let m_flow_nominal_kg_s = k * 1e4_f64.sqrt();
        Ok(FlowLimiter {
            open: 1.0 / (k * k),
            m_flow_set_kg_s: not_negative("m_flow_set_kg_s", self.m_flow_set_kg_s)?,
            rise_time_s: not_negative("rise_time_s", self.rise_time_s)?,
            m_flow_nominal_kg_s,
            m_turbulent_kg_s: positive("delta_m", self.delta_m)? * m_flow_nominal_kg_s,
        })
    }
}

impl FlowLimiter {
    /// The law of the open valve, and that at the set flow.
    fn branches(&self, m: f64, set: f64) -> (Linear, Linear) {
        let slope = BAND_PA / (BAND * set.max(LEAST_FLOW * self.m_flow_nominal_kg_s));
        // The rounding begins beyond the set flow, so that a set flow of zero leaves zero alone.
        let limit = Linear::new(slope * (m - set) - 2.0 * ROUNDING_PA, slope);
        (quadratic(m, self.open, self.m_turbulent_kg_s), limit)
    }
}

impl TwoPort for FlowLimiter {
    fn characteristic(&self, m: f64, state: &EdgeState) -> Characteristic {
        let (open, limit) = self.branches(m, state.position.max(0.0));
        Characteristic::PressureLoss(smooth_max(open, limit, ROUNDING_PA))
    }

    fn loss_by_position(&self, m: f64, state: &EdgeState) -> f64 {
        let set = state.position.max(0.0);
        let (open, limit) = self.branches(m, set);
        // Above the least flow the slope falls with the set flow as well.
        let least = LEAST_FLOW * self.m_flow_nominal_kg_s;
        let by_set = -limit.slope * if set > least { m / set } else { 1.0 };
        // The weights of the rounding are those of the slopes.
        let (open, limit) = (Linear::new(open.value, 0.0), Linear::new(limit.value, by_set));
        smooth_max(open, limit, ROUNDING_PA).slope
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.m_flow_nominal_kg_s
    }

    fn actuator(&self) -> Option<Actuator> {
        Some(Actuator {
            position: "m_flow_set_kg_s",
            command: "m_flow_set_kg_s",
            unit: "kg_s",
            initial_command: self.m_flow_set_kg_s,
            initial_position: self.m_flow_set_kg_s,
            rise_time_s: self.rise_time_s,
            min: 0.0,
            max: f64::INFINITY,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lets_pass_its_set_flow_and_no_more() {
        // Kvs 3.6 m3/h: 1 bar at 1 kg/s, 4 kPa at 0.2 kg/s.
        let params = FlowLimiterParams { kvs_m3_h: 3.6, ..FlowLimiterParams::default() };
        let limiter = params.build(&Medium::default()).unwrap();
        let loss = |m: f64, set: f64| {
            let state = EdgeState { position: set, density_kg_m3: 1000.0, viscosity_pa_s: 1e-3 };
            match limiter.characteristic(m, &state) {
                Characteristic::PressureLoss(loss) => loss.value,
                other => panic!("{other:?}"),
            }
        };
        // Open below the set flow of 0.3 kg/s and backwards.
        assert!((loss(0.2, 0.3) - 4e3).abs() < 1e-9);
        assert!((loss(-0.5, 0.3) + 25e3).abs() < 1e-9);
        // 2 bar take 2e-4 of the set flow more (less the 20 Pa before the rounding).
        assert!((loss(0.3 * (1.0 + 2e-4), 0.3) - (2e5 - 20.0)).abs() < 1e-3);
        // Shut: no flow, and 1 bar for 1e-4 of 1 % of 0.31623 kg/s.
        assert_eq!(loss(0.0, 0.0), 0.0);
        assert!((loss(0.316_228e-6, 0.0) - 1e5).abs() < 100.0);
    }
}
