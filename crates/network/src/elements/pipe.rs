//! A straight pipe with fittings: Darcy-Weisbach friction, heat loss to its surroundings.
//!
//! **Equation** `dp = (f(Re) L/d + zeta) rho/2 v|v|`, `v = 4 m/(pi rho d^2)`,
//! `Re = 4|m|/(pi d mu)`; f from [`crate::friction`]. With `fixed_velocity_m_s` the factor is frozen
//! at that velocity: `dp = K m|m|`. Heat: parcels cool towards the surroundings with
//! `tau = R rho A cp`, R the insulation resistance per length in K m/W.
//!
//! **Assumptions** full pipe, one bore, no axial conduction, no inertia. **Validity** all Re.
//!
//! **Numerics** laminar flow is linear, so friction needs no regularisation; fittings are regularised
//! below Re = 2000, the fixed coefficient below `delta_m` times the nominal flow.
//!
//! **Sources** `licklederer2021`, `wetter2014`.

use crate::friction::{Correlation, RE_LAMINAR, Transition, friction_factor};
use crate::two_port::{
    Characteristic, EdgeState, EdgeThermal, ElementError, PlugFlowPipe, TwoPort, not_negative,
    positive,
};
use anergy_core::linear::Linear;
use anergy_core::medium::Medium;
use anergy_core::numerics::regularize::quadratic;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A pipe as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PipeParams {
    /// Length, m.
    pub length_m: f64,
    /// Inner diameter, m.
    pub inner_diameter_m: f64,
    /// Wall roughness, m. Default: pre-insulated steel.
    #[serde(default = "default_roughness")]
    pub roughness_m: f64,
    /// Sum of the loss coefficients of the fittings.
    #[serde(default)]
    pub zeta: f64,
    /// Friction correlation of turbulent flow.
    #[serde(default)]
    pub friction: Correlation,
    /// Passage from laminar to turbulent flow.
    #[serde(default)]
    pub transition: Transition,
    /// Freezes the friction factor at this velocity, m/s: a purely quadratic law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fixed_velocity_m_s: Option<f64>,
    /// Below this share of the nominal flow a fixed coefficient is regularised.
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
    /// Thermal resistance water to surroundings per length, K m/W. Absent: no heat loss.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub insulation_resistance_k_m_w: Option<f64>,
    /// Temperature around the pipe, K. Absent: the ground temperature of the model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surroundings_k: Option<f64>,
    /// Temperature of the water at the start, K. Absent: the initial temperature of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_k: Option<f64>,
}

fn default_roughness() -> f64 {
    5e-5
}

fn default_delta_m() -> f64 {
    0.3
}

impl Default for PipeParams {
    fn default() -> Self {
        Self {
            length_m: 100.0,
            inner_diameter_m: 0.1,
            roughness_m: default_roughness(),
            zeta: 0.0,
            friction: Correlation::default(),
            transition: Transition::default(),
            fixed_velocity_m_s: None,
            delta_m: default_delta_m(),
            insulation_resistance_k_m_w: None,
            surroundings_k: None,
            initial_k: None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    Reynolds { correlation: Correlation, transition: Transition },
    Fixed { friction_factor: f64, m_turbulent_kg_s: f64 },
}

/// A pipe ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Pipe {
    length_m: f64,
    diameter_m: f64,
    relative_roughness: f64,
    zeta: f64,
    area_m2: f64,
    law: Law,
    thermal: PlugFlowPipe,
    m_flow_nominal_kg_s: f64,
}

impl PipeParams {
    /// The runtime pipe.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<Pipe, ElementError> {
        let length_m = positive("length_m", self.length_m)?;
        let diameter_m = positive("inner_diameter_m", self.inner_diameter_m)?;
        not_negative("zeta", self.zeta)?;
        positive("delta_m", self.delta_m)?;
        let relative_roughness = not_negative("roughness_m", self.roughness_m)? / diameter_m;
        if relative_roughness > 0.1 {
            return Err(ElementError::OutOfRange {
                field: "roughness_m",
                value: self.roughness_m,
                requirement: "is more than a tenth of the inner diameter",
            });
        }
        let area_m2 = PI / 4.0 * diameter_m * diameter_m;
        let velocity = self.fixed_velocity_m_s.map(|v| positive("fixed_velocity_m_s", v));
        let m_flow_nominal_kg_s =
            velocity.clone().transpose()?.unwrap_or(0.5) * area_m2 * medium.density_kg_m3;
        let law = match velocity.transpose()? {
            None => Law::Reynolds { correlation: self.friction, transition: self.transition },
            Some(v) => {
                let re = v * diameter_m * medium.density_kg_m3 / medium.viscosity_pa_s;
                Law::Fixed {
                    friction_factor: friction_factor(
                        self.friction,
                        self.transition,
                        re,
                        relative_roughness,
                    )
                    .value,
                    m_turbulent_kg_s: self.delta_m * m_flow_nominal_kg_s,
                }
            }
        };
        let capacity_j_k_m = medium.density_kg_m3 * medium.heat_capacity_j_kg_k * area_m2;
        let loss_time_constant_s = match self.insulation_resistance_k_m_w {
            None => f64::INFINITY,
            Some(resistance) => {
                positive("insulation_resistance_k_m_w", resistance)? * capacity_j_k_m
            }
        };
        let thermal = PlugFlowPipe {
            content_kg: medium.density_kg_m3 * area_m2 * length_m,
            loss_time_constant_s,
        };
        Ok(Pipe {
            length_m,
            diameter_m,
            relative_roughness,
            zeta: self.zeta,
            area_m2,
            law,
            thermal,
            m_flow_nominal_kg_s,
        })
    }
}

impl TwoPort for Pipe {
    fn characteristic(&self, m: f64, state: &EdgeState) -> Characteristic {
        // rho/2 v|v| = m|m| / (2 rho A^2)
        let dynamic = 1.0 / (2.0 * state.density_kg_m3 * self.area_m2 * self.area_m2);
        let slenderness = self.length_m / self.diameter_m;
        let loss = match self.law {
            Law::Fixed { friction_factor, m_turbulent_kg_s } => quadratic(
                m,
                (friction_factor * slenderness + self.zeta) * dynamic,
                m_turbulent_kg_s,
            ),
            Law::Reynolds { correlation, transition } => {
                let re_per_m = 4.0 / (PI * self.diameter_m * state.viscosity_pa_s);
                let re = re_per_m * m.abs();
                let friction = if re <= RE_LAMINAR {
                    // f = 64/Re: dp = 64/re_per_m L/d dynamic m, linear through zero
                    let slope = 64.0 / re_per_m * slenderness * dynamic;
                    Linear::new(slope * m, slope)
                } else {
                    let f = friction_factor(correlation, transition, re, self.relative_roughness);
                    let factor = slenderness * dynamic;
                    Linear::new(
                        f.value * factor * m * m.abs(),
                        factor * (f.slope * re_per_m * m * m + 2.0 * f.value * m.abs()),
                    )
                };
                if self.zeta > 0.0 {
                    friction + quadratic(m, self.zeta * dynamic, RE_LAMINAR / re_per_m)
                } else {
                    friction
                }
            }
        };
        Characteristic::PressureLoss(loss)
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.m_flow_nominal_kg_s
    }

    fn thermal(&self) -> EdgeThermal {
        EdgeThermal::PlugFlow(self.thermal)
    }

    fn length_m(&self) -> f64 {
        self.length_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state() -> EdgeState {
        EdgeState { position: 0.0, density_kg_m3: 1000.0, viscosity_pa_s: 1.0016e-3 }
    }

    fn loss(pipe: &Pipe, m: f64) -> f64 {
        match pipe.characteristic(m, &state()) {
            Characteristic::PressureLoss(loss) => loss.value,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn laminar_flow_is_hagen_poiseuille() {
        // 128 mu L m/(pi rho d^4) = 128 * 1.0016e-3 * 100 * 0.01/(pi * 1000 * 1.6e-7) = 255.06 Pa
        let params = PipeParams { inner_diameter_m: 0.02, ..PipeParams::default() };
        let pipe = params.build(&Medium::default()).unwrap();
        let expected = 128.0 * 1.0016e-3 * 100.0 * 0.01 / (PI * 1000.0 * 0.02_f64.powi(4));
        assert!((loss(&pipe, 0.01) / expected - 1.0).abs() < 1e-12);
        assert_eq!(loss(&pipe, -0.01), -loss(&pipe, 0.01));
    }

    #[test]
    fn published_reference_pipe() {
        // 50 m, 22 mm, eps 0.011 mm, zeta 10, f at 0.22 m/s: K = 0.945155 hPa/(l/min)^2,
        // 8 l/min: 60.4899 hPa; the 10 m stub with zeta 3.5: 0.203449
        let mut params = PipeParams {
            length_m: 50.0,
            inner_diameter_m: 0.022,
            roughness_m: 1.1e-5,
            zeta: 10.0,
            friction: Correlation::SwameeJain,
            fixed_velocity_m_s: Some(0.22),
            delta_m: 0.01,
            ..PipeParams::default()
        };
        let pipe = params.build(&Medium::default()).unwrap();
        assert!((loss(&pipe, 8.0 / 60.0) - 0.945_155 * 6400.0).abs() < 0.01);
        (params.length_m, params.zeta) = (10.0, 3.5);
        let stub = params.build(&Medium::default()).unwrap();
        assert!((loss(&stub, 8.0 / 60.0) - 0.203_449 * 6400.0).abs() < 0.01);
    }

    #[test]
    fn loss_time_constant() {
        // specification 9.2: 22 mm, R = 3.7804 K m/W, cp 4200: 1.677 h
        let medium = Medium { heat_capacity_j_kg_k: 4200.0, ..Medium::default() };
        let params = PipeParams {
            inner_diameter_m: 0.022,
            insulation_resistance_k_m_w: Some(3.7804),
            ..PipeParams::default()
        };
        let hours = params.build(&medium).unwrap().thermal.loss_time_constant_s / 3600.0;
        assert!((hours - 1.677).abs() < 5e-4, "{hours}");
    }

    #[test]
    fn impossible_values_are_named() {
        let wrong = PipeParams { length_m: -1.0, ..PipeParams::default() };
        let error = wrong.build(&Medium::default()).unwrap_err();
        assert_eq!(error.to_string(), "length_m = -1 must be positive");
    }
}
