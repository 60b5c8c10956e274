//! An overflow valve: opens by itself when the pressure difference across it exceeds a set one.
//!
//! **Equation** opening `y = clamp((dp - dp_open)/X_p, 0, 1)` of the pressure difference `dp = p_a - p_b`
//! that is across the valve, and `m = k_vs phi(y) sqrt(dp)` with `phi = l + (1 - l) y`. As a law over the
//! flow, with the pressures `dp_1 = dp_open` where it begins to open, at `m_1 = l k_vs sqrt(dp_open)`, and
//! `dp_2 = dp_open + X_p` where it is open, at `m_2 = k_vs sqrt(dp_2)`: the leak below `m_1`, the open
//! valve above `m_2`, the inverse of `m(dp)` between, which is computed by Newton from above.
//!
//! **Assumptions** no lag, no friction of the stem: the valve is where its spring wants it. It senses its
//! own pressure difference only. Reverse flow meets the shut valve.
//!
//! **Validity** steady or slow; a valve that hunts is outside. **Numerics** strictly monotone; C1 by
//! rounding the corners of y within 5 % of the band; regularised below `delta_m` times the leak.
//!
//! **Sources** specification 5.8 (proportional band), `wetter2014` (regularised law).

use super::flow_coefficient;
use crate::two_port::{Characteristic, EdgeState, ElementError, TwoPort, positive};
use anergy_core::linear::Linear;
use anergy_core::medium::Medium;
use anergy_core::numerics::regularize::{quadratic, smooth_max, smooth_min};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Rounding of the corners of the law relative to the proportional band.
const ROUNDING: f64 = 0.05;
/// Relative change of the opening at which its iteration ends, and its most steps.
const ARRIVED: f64 = 1e-15;
const MOST_STEPS: u32 = 50;

/// An overflow valve as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OverflowValveParams {
    /// Flow in m3/h at 1 bar when fully open.
    pub kvs_m3_h: f64,
    /// Pressure difference from a to b at which it begins to open, Pa.
    pub opening_dp_pa: f64,
    /// Rise of the pressure difference over which it opens, Pa. Absent: a tenth of `opening_dp_pa`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band_dp_pa: Option<f64>,
    /// Flow coefficient of the shut valve over that of the open one.
    #[serde(default = "default_leakage")]
    pub leakage: f64,
    /// Regularised below this share of the flow at 0.1 bar.
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
}

fn default_leakage() -> f64 {
    1e-3
}

fn default_delta_m() -> f64 {
    0.02
}

impl Default for OverflowValveParams {
    fn default() -> Self {
        Self {
            kvs_m3_h: 2.5,
            opening_dp_pa: 5e4,
            band_dp_pa: None,
            leakage: default_leakage(),
            delta_m: default_delta_m(),
        }
    }
}

/// An overflow valve ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct OverflowValve {
    k_open: f64,
    opening_dp_pa: f64,
    band_dp_pa: f64,
    leakage: f64,
    m_flow_nominal_kg_s: f64,
    m_turbulent_kg_s: f64,
}

impl OverflowValveParams {
    /// The runtime overflow valve.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<OverflowValve, ElementError> {
        let out_of_range =
            |field, value, requirement| Err(ElementError::OutOfRange { field, value, requirement });
        let k_open = flow_coefficient(positive("kvs_m3_h", self.kvs_m3_h)?, medium.density_kg_m3);
        let opening_dp_pa = positive("opening_dp_pa", self.opening_dp_pa)?;
        let band_dp_pa = positive("band_dp_pa", self.band_dp_pa.unwrap_or(0.1 * opening_dp_pa))?;
        // Otherwise the corners of the law reach down to zero flow.
        if band_dp_pa > opening_dp_pa {
            return out_of_range("band_dp_pa", band_dp_pa, "must not be above opening_dp_pa");
        }
        if !(1e-6..0.5).contains(&self.leakage) {
            return out_of_range("leakage", self.leakage, "must lie between 1e-6 and 0.5");
        }
        let m_flow_nominal_kg_s = k_open * 1e4_f64.sqrt();
        Ok(OverflowValve {
            k_open,
            opening_dp_pa,
            band_dp_pa,
            leakage: self.leakage,
            m_flow_nominal_kg_s,
            m_turbulent_kg_s: positive("delta_m", self.delta_m)? * m_flow_nominal_kg_s,
        })
    }
}

impl OverflowValve {
    /// Flow and its slope over the opening, with the pressure difference that belongs to it.
    fn flow(&self, y: f64) -> (f64, f64, f64) {
        let dp = self.opening_dp_pa + self.band_dp_pa * y;
        let phi = self.leakage + (1.0 - self.leakage) * y;
        let root = dp.sqrt();
        let by_phi = (1.0 - self.leakage) * root;
        (self.k_open * phi * root, self.k_open * (by_phi + 0.5 * phi * self.band_dp_pa / root), dp)
    }

    /// The law while the valve is partly open, continued along its tangents.
    fn controlled(&self, m: f64) -> Linear {
        let tangent = |y: f64| {
            let (m_end, slope, dp) = self.flow(y);
            Linear::new(dp + self.band_dp_pa / slope * (m - m_end), self.band_dp_pa / slope)
        };
        if m <= self.flow(0.0).0 {
            return tangent(0.0);
        }
        if m >= self.flow(1.0).0 {
            return tangent(1.0);
        }
        // Without leak and rise of the pressure the opening would be larger: the squared flow is convex
        // over the opening, so that Newton comes down to the solution.
        let mut y = (m / (self.k_open * (1.0 - self.leakage) * self.opening_dp_pa.sqrt())).min(1.0);
        for _ in 0..MOST_STEPS {
            let (flow, slope, _) = self.flow(y);
            let step = (flow * flow - m * m) / (2.0 * flow * slope);
            y = (y - step).max(0.0);
            if step.abs() <= ARRIVED * y {
                break;
            }
        }
        let (_, slope, dp) = self.flow(y);
        Linear::new(dp, self.band_dp_pa / slope)
    }
}

impl TwoPort for OverflowValve {
    fn characteristic(&self, m: f64, _state: &EdgeState) -> Characteristic {
        let square = |k: f64| quadratic(m, 1.0 / (k * k), self.m_turbulent_kg_s * k / self.k_open);
        let rounding = ROUNDING * self.band_dp_pa;
        let opened = smooth_max(square(self.k_open), self.controlled(m), rounding);
        let leak = square(self.leakage * self.k_open);
        Characteristic::PressureLoss(smooth_min(leak, opened, rounding))
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.m_flow_nominal_kg_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opens_over_its_band() {
        // Kvs 3.6 m3/h (k = 1/sqrt(1e5)), opens from 0.4 to 0.5 bar, l = 1e-3.
        let params = OverflowValveParams {
            kvs_m3_h: 3.6,
            opening_dp_pa: 4e4,
            band_dp_pa: Some(1e4),
            ..OverflowValveParams::default()
        };
        let valve = params.build(&Medium::default()).unwrap();
        let state = EdgeState { position: 0.0, density_kg_m3: 1000.0, viscosity_pa_s: 1e-3 };
        let loss = |m: f64| match valve.characteristic(m, &state) {
            Characteristic::PressureLoss(loss) => loss.value,
            other => panic!("{other:?}"),
        };
        // Shut: 5e-4 kg/s leak at (5e-4/1e-3)^2 = 0.25 bar, backwards too.
        assert!((loss(5e-4) - 25_000.0).abs() < 1e-6);
        assert!((loss(-5e-4) + 25_000.0).abs() < 1e-6);
        // Half open at 0.45 bar: phi = 0.5005, m = 0.5005 sqrt(0.45) = 0.335747 kg/s.
        assert!((loss(0.335_747) - 45_000.0).abs() < 0.1, "{}", loss(0.335_747));
        // Fully open: 1 kg/s at 1 bar.
        assert!((loss(1.0) - 1e5).abs() < 1e-6);
        assert_eq!(loss(0.0), 0.0);
        let wide = OverflowValveParams { band_dp_pa: Some(6e4), ..OverflowValveParams::default() };
        assert_eq!(wide.build(&Medium::default()).unwrap_err().field(), Some("band_dp_pa"));
    }
}
