//! A check valve: lets water pass from a to b, all but a leak back.
//!
//! **Equation** `m >= 0`: `dp = m^2/k_vs^2` (regularised); `m < 0`:
//! `dp = -(s0 |m| + m^2/(l k_vs)^2)` with `s0` the slope of the forward branch at zero.
//!
//! **Assumptions** no inertia of the flap, no closing zone: results differ from laws with one for
//! `0 < dp < dp_closing`. **Validity** `0 < l < 1`. **Numerics** strictly monotone, C1.
//!
//! **Sources** `wetter2014`; `elizarov2021` (Kvs 11 m3/h, l = 1e-3).

use super::flow_coefficient;
use crate::two_port::{Characteristic, EdgeState, ElementError, TwoPort, positive};
use anergy_core::linear::Linear;
use anergy_core::medium::Medium;
use anergy_core::numerics::regularize::{quadratic, quadratic_slope_at_zero};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A check valve as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CheckValveParams {
    /// Flow in m3/h at 1 bar when open.
    pub kvs_m3_h: f64,
    /// Flow coefficient of the closed valve over that of the open one.
    #[serde(default = "default_leakage")]
    pub leakage: f64,
    /// Nominal flow for the regularisation, kg/s.
    #[serde(default = "default_m_flow_nominal")]
    pub m_flow_nominal_kg_s: f64,
    /// Regularised below this share of the nominal flow.
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
}

fn default_leakage() -> f64 {
    1e-3
}

fn default_m_flow_nominal() -> f64 {
    0.3584
}

fn default_delta_m() -> f64 {
    0.02
}

impl Default for CheckValveParams {
    fn default() -> Self {
        Self {
            kvs_m3_h: 11.0,
            leakage: default_leakage(),
            m_flow_nominal_kg_s: default_m_flow_nominal(),
            delta_m: default_delta_m(),
        }
    }
}

/// A check valve ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckValve {
    open: f64,
    closed: f64,
    slope_at_zero: f64,
    m_turbulent_kg_s: f64,
    m_flow_nominal_kg_s: f64,
}

impl CheckValveParams {
    /// The runtime check valve.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<CheckValve, ElementError> {
        let k = flow_coefficient(positive("kvs_m3_h", self.kvs_m3_h)?, medium.density_kg_m3);
        let leakage = positive("leakage", self.leakage)?;
        if leakage >= 1.0 {
            return Err(ElementError::OutOfRange {
                field: "leakage",
                value: leakage,
                requirement: "must be below 1",
            });
        }
        let m_flow_nominal_kg_s = positive("m_flow_nominal_kg_s", self.m_flow_nominal_kg_s)?;
        let m_turbulent_kg_s = positive("delta_m", self.delta_m)? * m_flow_nominal_kg_s;
        let open = 1.0 / (k * k);
        Ok(CheckValve {
            open,
            closed: open / (leakage * leakage),
            slope_at_zero: quadratic_slope_at_zero(open, m_turbulent_kg_s),
            m_turbulent_kg_s,
            m_flow_nominal_kg_s,
        })
    }
}

impl TwoPort for CheckValve {
    fn characteristic(&self, m: f64, _state: &EdgeState) -> Characteristic {
        Characteristic::PressureLoss(if m >= 0.0 {
            quadratic(m, self.open, self.m_turbulent_kg_s)
        } else {
            Linear::new(
                self.slope_at_zero * m - self.closed * m * m,
                self.slope_at_zero - 2.0 * self.closed * m,
            )
        })
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.m_flow_nominal_kg_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_leak() {
        // Kvs 11, l = 1e-3, 40 kPa reverse: 1.93e-3 kg/s
        let valve = CheckValveParams::default().build(&Medium::default()).unwrap();
        let state = EdgeState { position: 0.0, density_kg_m3: 1000.0, viscosity_pa_s: 1e-3 };
        let Characteristic::PressureLoss(loss) = valve.characteristic(-1.9325e-3, &state) else {
            panic!("not a loss");
        };
        assert!((loss.value / -40_000.0 - 1.0).abs() < 1e-3, "{}", loss.value);
    }
}
