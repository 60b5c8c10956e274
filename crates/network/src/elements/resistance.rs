//! A fixed resistance: orifice, strainer, heat meter, fitting.
//!
//! **Equation** `dp = dp_nominal (m/m_nominal)^2`, or `m = Kv sqrt(dp)`, regularised below `delta_m`
//! times the nominal flow. With `exponent = n` the odd power law `dp_nominal (m/m_nominal)^n`; with a table
//! the monotone curve through its points of volume flow and loss, which goes on straight beyond its end.
//! Backwards the same with the other sign.
//!
//! **Validity** the exponent lies between 0.5 and 4; a table belongs to the density of the medium.
//! **Sources** `wetter2014`; `rossman2020` (emitters, general purpose valves).

use super::flow_coefficient;
use crate::two_port::{Characteristic, EdgeState, ElementError, TwoPort, positive};
use anergy_core::linear::Linear;
use anergy_core::medium::Medium;
use anergy_core::numerics::interpolate::Pchip;
use anergy_core::numerics::regularize::{power, quadratic};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Exponents for which the regularised power law is neither flat nor upright at zero flow.
const EXPONENTS: std::ops::RangeInclusive<f64> = 0.5..=4.0;
/// Slope of a table at its ends, at least, as a share of the first and last secant.
const END_SLOPE_SHARE: f64 = 0.1;

/// A resistance as written in a model file: `m_flow_nominal_kg_s` with `dp_nominal_pa`, or `kv_m3_h`, or the
/// two columns of a table.
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
    /// Exponent of the flow, with `dp_nominal_pa`. Absent: 2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exponent: Option<f64>,
    /// Flows of the table, m3/s, rising from 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_v_flow_m3_s: Vec<f64>,
    /// Pressure losses of the table, Pa, rising from 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_dp_pa: Vec<f64>,
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
            exponent: None,
            curve_v_flow_m3_s: Vec::new(),
            curve_dp_pa: Vec::new(),
            delta_m: default_delta_m(),
        }
    }
}

/// A resistance ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Resistance {
    law: Law,
    m_flow_nominal_kg_s: f64,
    m_turbulent_kg_s: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Law {
    Quadratic {
        coefficient: f64,
    },
    Power {
        coefficient: f64,
        exponent: f64,
    },
    /// Over the mass flow.
    Curve(Pchip),
}

impl ResistanceParams {
    /// The runtime resistance.
    ///
    /// # Errors
    /// Names the field that is out of range or missing.
    pub fn build(&self, medium: &Medium) -> Result<Resistance, ElementError> {
        let fields = |problem: &str| Err(ElementError::Fields { problem: problem.into() });
        let table = !self.curve_v_flow_m3_s.is_empty() || !self.curve_dp_pa.is_empty();
        if self.exponent.is_some() && self.dp_nominal_pa.is_none() {
            return fields("exponent belongs to dp_nominal_pa");
        }
        let (law, m_flow_nominal_kg_s) = match (self.dp_nominal_pa, self.kv_m3_h, table) {
            (Some(dp), None, false) => {
                let Some(m) = self.m_flow_nominal_kg_s else {
                    return fields("dp_nominal_pa needs m_flow_nominal_kg_s");
                };
                let m = positive("m_flow_nominal_kg_s", m)?;
                (self.through(positive("dp_nominal_pa", dp)?, m)?, m)
            }
            (None, Some(kv), false) => {
                let k = flow_coefficient(positive("kv_m3_h", kv)?, medium.density_kg_m3);
                let m = self.m_flow_nominal_kg_s.unwrap_or(k * 1e4_f64.sqrt());
                let law = Law::Quadratic { coefficient: 1.0 / (k * k) };
                (law, positive("m_flow_nominal_kg_s", m)?)
            }
            (None, None, true) => {
                let curve = self.curve(medium.density_kg_m3)?;
                let m = self.m_flow_nominal_kg_s.unwrap_or(curve.range().1);
                (Law::Curve(curve), positive("m_flow_nominal_kg_s", m)?)
            }
            _ => {
                return fields(
                    "give one of dp_nominal_pa with m_flow_nominal_kg_s, kv_m3_h, and the table \
                     curve_v_flow_m3_s with curve_dp_pa",
                );
            }
        };
        Ok(Resistance {
            law,
            m_flow_nominal_kg_s,
            m_turbulent_kg_s: positive("delta_m", self.delta_m)? * m_flow_nominal_kg_s,
        })
    }

    /// The power law through a point.
    fn through(&self, dp_pa: f64, m_flow_kg_s: f64) -> Result<Law, ElementError> {
        match self.exponent {
            None => Ok(Law::Quadratic { coefficient: dp_pa / (m_flow_kg_s * m_flow_kg_s) }),
            Some(exponent) if EXPONENTS.contains(&exponent) => {
                Ok(Law::Power { coefficient: dp_pa / m_flow_kg_s.powf(exponent), exponent })
            }
            Some(value) => Err(ElementError::OutOfRange {
                field: "exponent",
                value,
                requirement: "must lie between 0.5 and 4",
            }),
        }
    }

    /// The curve through the points of the table.
    fn curve(&self, density_kg_m3: f64) -> Result<Pchip, ElementError> {
        let wrong = |field, problem: String| Err(ElementError::Table { field, problem });
        let (flows, losses) = (&self.curve_v_flow_m3_s, &self.curve_dp_pa);
        let m_flows: Vec<f64> = flows.iter().map(|v| v * density_kg_m3).collect();
        let curve = match Pchip::new(&m_flows, losses) {
            Ok(curve) => curve.with_end_slopes(END_SLOPE_SHARE),
            Err(error) => return wrong("curve_v_flow_m3_s", error.to_string()),
        };
        for (field, column) in [("curve_v_flow_m3_s", flows), ("curve_dp_pa", losses)] {
            if column[0] != 0.0 {
                return wrong(field, format!("must begin with 0, not {}", column[0]));
            }
        }
        if let Some(i) = (1..losses.len()).find(|&i| losses[i] <= losses[i - 1]) {
            let (loss, before) = (losses[i], losses[i - 1]);
            let problem = format!(
                "the loss must rise strictly with the flow: point {} has {loss}, the point before {before}",
                i + 1
            );
            return wrong("curve_dp_pa", problem);
        }
        Ok(curve)
    }
}

impl TwoPort for Resistance {
    fn characteristic(&self, m: f64, _state: &EdgeState) -> Characteristic {
        Characteristic::PressureLoss(match &self.law {
            Law::Quadratic { coefficient } => quadratic(m, *coefficient, self.m_turbulent_kg_s),
            Law::Power { coefficient, exponent } => {
                power(m, *coefficient, *exponent, self.m_turbulent_kg_s)
            }
            Law::Curve(curve) => {
                let loss = curve.at(m.abs());
                Linear::new(loss.value.copysign(m), loss.slope)
            }
        })
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.m_flow_nominal_kg_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loss(resistance: &Resistance, m: f64) -> f64 {
        let state = EdgeState { position: 0.0, density_kg_m3: 1000.0, viscosity_pa_s: 1e-3 };
        match resistance.characteristic(m, &state) {
            Characteristic::PressureLoss(loss) => loss.value,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn kv_and_nominal_point_agree() {
        // Kv 3.6 m3/h is 1 kg/s at 1 bar
        let medium = Medium::default();
        let of = |dp_nominal_pa, kv_m3_h| ResistanceParams {
            dp_nominal_pa,
            m_flow_nominal_kg_s: Some(1.0),
            kv_m3_h,
            ..ResistanceParams::default()
        };
        let (a, b) = (of(None, Some(3.6)).build(&medium), of(Some(1e5), None).build(&medium));
        let (a, b) = (loss(&a.unwrap(), 2.0), loss(&b.unwrap(), 2.0));
        assert!((a / b - 1.0).abs() < 1e-12);
        assert!(of(Some(1e5), Some(1.0)).build(&medium).is_err());
        assert!(of(None, None).build(&medium).is_err());
    }

    #[test]
    fn powers_and_tables() {
        let medium = Medium { density_kg_m3: 1000.0, ..Medium::default() };
        // 1 bar at 2 kg/s, n = 1.5: at 4 kg/s 2^1.5 = 2.828427 bar; odd.
        let power = ResistanceParams {
            dp_nominal_pa: Some(1e5),
            m_flow_nominal_kg_s: Some(2.0),
            exponent: Some(1.5),
            ..ResistanceParams::default()
        };
        let built = power.build(&medium).unwrap();
        assert!((loss(&built, 4.0) - 282_842.7).abs() < 0.1);
        assert_eq!(loss(&built, -4.0), -loss(&built, 4.0));
        let wrong = ResistanceParams { exponent: Some(5.0), ..power.clone() };
        assert_eq!(wrong.build(&medium).unwrap_err().field(), Some("exponent"));
        let wrong = ResistanceParams { dp_nominal_pa: None, kv_m3_h: Some(1.0), ..power };
        assert!(wrong.build(&medium).is_err());
        // Points of a straight line: 1 kPa per l/s, also beyond its end and backwards.
        let table = ResistanceParams {
            dp_nominal_pa: None,
            m_flow_nominal_kg_s: None,
            curve_v_flow_m3_s: vec![0.0, 1e-3, 3e-3],
            curve_dp_pa: vec![0.0, 1e3, 3e3],
            ..ResistanceParams::default()
        };
        let built = table.build(&medium).unwrap();
        for m in [-5.0, -0.5, 0.0, 1.0, 2.0, 4.0] {
            assert!((loss(&built, m) - 1e3 * m).abs() < 1e-9, "{m}");
        }
        let falls = ResistanceParams { curve_dp_pa: vec![0.0, 2e3, 1e3], ..table.clone() };
        let message = falls.build(&medium).unwrap_err().to_string();
        assert!(message.contains("point 3 has 1000, the point before 2000"), "{message}");
        let late = ResistanceParams { curve_v_flow_m3_s: vec![1e-3, 2e-3, 3e-3], ..table };
        assert!(late.build(&medium).unwrap_err().to_string().contains("must begin with 0"));
    }
}
