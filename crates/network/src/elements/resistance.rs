//! A fixed resistance: orifice, strainer, heat meter, fitting.
//!
//! **Equation** `dp = dp_nominal (m/m_nominal)^2`, or `m = Kv sqrt(dp)`, regularised below `delta_m`
//! times the nominal flow. **Sources** `wetter2014`.

use super::flow_coefficient;
use crate::two_port::{Characteristic, EdgeState, ElementError, TwoPort, positive};
use anergy_core::medium::Medium;
use anergy_core::numerics::regularize::quadratic;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A resistance as written in a model file: `m_flow_nominal_kg_s` with `dp_nominal_pa`, or `kv_m3_h`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ResistanceParams {
    /// Pressure loss at the nominal flow, Pa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dp_nominal_pa: Option<f64>,
    /// Nominal flow, kg/s. Absent with `kv_m3_h`: the flow at 0.1 bar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub m_flow_nominal_kg_s: Option<f64>,
    /// Flow in m3/h at 1 bar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kv_m3_h: Option<f64>,
    /// Regularised below this share of the nominal flow.
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
}

fn default_delta_m() -> f64 {
    0.3
}

impl Default for ResistanceParams {
    fn default() -> Self {
        Self {
            dp_nominal_pa: Some(1e4),
            m_flow_nominal_kg_s: Some(1.0),
            kv_m3_h: None,
            delta_m: default_delta_m(),
        }
    }
}

/// A resistance ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Resistance {
    coefficient: f64,
    m_flow_nominal_kg_s: f64,
    m_turbulent_kg_s: f64,
}

impl ResistanceParams {
    /// The runtime resistance.
    ///
    /// # Errors
    /// Names the field that is out of range or missing.
    pub fn build(&self, medium: &Medium) -> Result<Resistance, ElementError> {
        let (coefficient, m_flow_nominal_kg_s) = match (self.dp_nominal_pa, self.kv_m3_h) {
            (Some(dp), None) => {
                let Some(m) = self.m_flow_nominal_kg_s else {
                    return Err(ElementError::Fields {
                        problem: "dp_nominal_pa needs m_flow_nominal_kg_s".into(),
                    });
                };
                let m = positive("m_flow_nominal_kg_s", m)?;
                (positive("dp_nominal_pa", dp)? / (m * m), m)
            }
            (None, Some(kv)) => {
                let k = flow_coefficient(positive("kv_m3_h", kv)?, medium.density_kg_m3);
                let m = self.m_flow_nominal_kg_s.unwrap_or(k * 1e4_f64.sqrt());
                (1.0 / (k * k), positive("m_flow_nominal_kg_s", m)?)
            }
            _ => {
                return Err(ElementError::Fields {
                    problem: "give either dp_nominal_pa with m_flow_nominal_kg_s, or kv_m3_h"
                        .into(),
                });
            }
        };
        Ok(Resistance {
            coefficient,
            m_flow_nominal_kg_s,
            m_turbulent_kg_s: positive("delta_m", self.delta_m)? * m_flow_nominal_kg_s,
        })
    }
}

impl TwoPort for Resistance {
    fn characteristic(&self, m: f64, _state: &EdgeState) -> Characteristic {
        Characteristic::PressureLoss(quadratic(m, self.coefficient, self.m_turbulent_kg_s))
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.m_flow_nominal_kg_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kv_and_nominal_point_agree() {
        // Kv 3.6 m3/h is 1 kg/s at 1 bar
        let medium = Medium::default();
        let by_kv = ResistanceParams {
            dp_nominal_pa: None,
            m_flow_nominal_kg_s: None,
            kv_m3_h: Some(3.6),
            delta_m: 0.3,
        };
        let by_point = ResistanceParams {
            dp_nominal_pa: Some(1e5),
            m_flow_nominal_kg_s: Some(1.0),
            kv_m3_h: None,
            delta_m: 0.3,
        };
        let (a, b) = (by_kv.build(&medium).unwrap(), by_point.build(&medium).unwrap());
        assert!((a.coefficient / b.coefficient - 1.0).abs() < 1e-12);
        let both = ResistanceParams { kv_m3_h: Some(1.0), ..by_point };
        assert!(both.build(&medium).is_err());
    }
}
