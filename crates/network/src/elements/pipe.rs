//! A straight pipe with fittings: Darcy-Weisbach friction, heat loss to its surroundings.
//!
//! **Equation** `dp = (f(Re) L/d + zeta) rho/2 v|v|`, `v = 4 m/(pi rho d^2)`,
//! `Re = 4|m|/(pi d mu)`; f from [`crate::friction`]. With `fixed_velocity_m_s` the factor is frozen
//! at that velocity, `friction_factor` gives it: `dp = K m|m|`. Hazen-Williams and Chezy-Manning give
//! `dp = K m|m|^(n-1)`. Heat: see [`thermal`].
//!
//! **Assumptions** full pipe, one bore; inertia is that of [`crate::inertia`], where it counts. **Validity** all Re.
//!
//! **Numerics** laminar flow is linear, so friction needs no regularisation; fittings are regularised
//! below Re = 2000, the fixed coefficient below `delta_m` times the nominal flow, the power laws below
//! 1 mm/s.
//!
//! **Sources** `licklederer2021`, `wetter2014`, `rossman2020`.

mod ground_node;
mod laying;
mod power_law;
pub mod thermal;

use self::thermal::WallModel;
use crate::friction::{Correlation, DarcyFriction, RE_LAMINAR, Transition};
use crate::graph::GRAVITY_M_S2;
use crate::ground::Ground;
use crate::two_port::{
    Characteristic, EdgeState, EdgeThermal, ElementError, PlugFlowPipe, TwoPort, not_negative,
    positive,
};
use anergy_core::linear::Linear;
use anergy_core::medium::Medium;
use anergy_core::numerics::regularize::{power, quadratic};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

pub use laying::{FOAM_W_M_K, Laying, POLYETHYLENE_W_M_K, Resistance, STEEL_W_M_K};

/// Below this velocity a power law is regularised.
const POWER_LAW_VELOCITY_M_S: f64 = 1e-3;

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
    /// Roughness coefficient C of Hazen-Williams; with `friction = "hazen_williams"` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hazen_williams_c: Option<f64>,
    /// Manning's n, s/m^(1/3); with `friction = "chezy_manning"` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub manning_n: Option<f64>,
    /// Freezes the friction factor at this velocity, m/s: a purely quadratic law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fixed_velocity_m_s: Option<f64>,
    /// A friction factor (Darcy: four times Fanning's) that holds at any flow, instead of a correlation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_factor: Option<f64>,
    /// Below this share of the nominal flow a fixed coefficient is regularised.
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
    /// Thermal resistance water to surroundings per length, K m/W. Absent: no heat loss.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub insulation_resistance_k_m_w: Option<f64>,
    /// Heat loss over what the other fields say.
    #[serde(default = "one")]
    pub heat_loss_factor: f64,
    /// How the wall of the medium pipe stores heat.
    #[serde(default)]
    pub wall: WallModel,
    /// Outer diameter of the medium pipe, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outer_diameter_m: Option<f64>,
    /// Density of the wall, kg/m3. Default: steel.
    #[serde(default = "default_wall_density")]
    pub wall_density_kg_m3: f64,
    /// Specific heat capacity of the wall, J/(kg K). Default: steel.
    #[serde(default = "default_wall_heat_capacity")]
    pub wall_heat_capacity_j_kg_k: f64,
    /// Heat capacity of the wall per length, J/(m K), in place of the one from its diameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall_capacity_j_m_k: Option<f64>,
    /// Multiplies the heat transfer between water and wall with `wall = "film"`.
    #[serde(default = "one")]
    pub wall_film_factor: f64,
    /// Axial dispersion coefficient of the water, m2/s; 0 keeps fronts sharp.
    #[serde(default)]
    pub dispersion_m2_s: f64,
    /// Multiplies the heat loss while the water stands still.
    #[serde(default = "one")]
    pub standstill_loss_factor: f64,
    /// How it lies: its heat loss then follows from its layers, in place of
    /// `insulation_resistance_k_m_w`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laying: Option<Laying>,
    /// Thermal conductivity of the wall, W/(m K). Absent: 50, steel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall_conductivity_w_m_k: Option<f64>,
    /// Outer diameter of the casing around the insulation, m. Absent, without `insulation_thickness_m`: no
    /// insulation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub casing_diameter_m: Option<f64>,
    /// Wall thickness of the casing (PE), m. Absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub casing_thickness_m: Option<f64>,
    /// Thickness of the insulation, m, instead of `casing_diameter_m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub insulation_thickness_m: Option<f64>,
    /// Thermal conductivity of the insulation, W/(m K). Absent: 0.028, polyurethane foam.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub insulation_conductivity_w_m_k: Option<f64>,
    /// Heat transfer from water to wall, W/(m2 K). Absent: 3500.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub film_w_m2_k: Option<f64>,
    /// Depth of the axis below the ground, m; of a twin pipe that of its casing. Absent: that of `[ground]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth_m: Option<f64>,
    /// Distance of the axes of this pipe and its companion, m: they exchange heat. The two lines of a trench
    /// are companions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spacing_m: Option<f64>,
    /// The pipe beside it, by name; given on one of the two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub companion: Option<String>,
    /// Whether port a of the companion lies beside port b.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub companion_reversed: Option<bool>,
    /// Rings of soil around a pipe buried alone that store heat, 1 to 5. Absent: the soil stores none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub soil_rings: Option<usize>,
    /// Heat capacity around the pipe per length, J/(m K): one node in its thermal resistance. Absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground_capacity_j_m_k: Option<f64>,
    /// Share of the thermal resistance that lies beyond that node. Absent: 0.5.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground_share: Option<f64>,
    /// Wind across a pipe in the air, m/s. Absent: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wind_m_s: Option<f64>,
    /// Heat transfer from jacket to air, W/(m2 K). Absent: radiation and wind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outer_film_w_m2_k: Option<f64>,
    /// Temperature around the pipe, K. Absent: the ground temperature of the model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surroundings_k: Option<f64>,
    /// Added to the temperature around the pipe, K.
    #[serde(default)]
    pub surroundings_difference_k: f64,
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

fn default_wall_density() -> f64 {
    7850.0
}

fn default_wall_heat_capacity() -> f64 {
    460.0
}

fn one() -> f64 {
    1.0
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
            hazen_williams_c: None,
            manning_n: None,
            fixed_velocity_m_s: None,
            friction_factor: None,
            delta_m: default_delta_m(),
            insulation_resistance_k_m_w: None,
            heat_loss_factor: one(),
            wall: WallModel::default(),
            outer_diameter_m: None,
            wall_density_kg_m3: default_wall_density(),
            wall_heat_capacity_j_kg_k: default_wall_heat_capacity(),
            wall_capacity_j_m_k: None,
            wall_film_factor: one(),
            dispersion_m2_s: 0.0,
            standstill_loss_factor: one(),
            laying: None,
            wall_conductivity_w_m_k: None,
            casing_diameter_m: None,
            casing_thickness_m: None,
            insulation_thickness_m: None,
            insulation_conductivity_w_m_k: None,
            film_w_m2_k: None,
            depth_m: None,
            spacing_m: None,
            companion: None,
            companion_reversed: None,
            soil_rings: None,
            ground_capacity_j_m_k: None,
            ground_share: None,
            wind_m_s: None,
            outer_film_w_m2_k: None,
            surroundings_k: None,
            surroundings_difference_k: 0.0,
            initial_k: None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    /// `dp = f(Re) friction_per_kg m|m|/rho` and fittings.
    Darcy { friction: DarcyFriction },
    /// `dp = coefficient m|m|/rho`, fittings included.
    Fixed { coefficient: f64, m_turbulent_kg_s: f64 },
    /// `dp = coefficient rho (m/rho)^n` and fittings.
    Power { coefficient: f64, exponent: f64, v_turbulent_m3_s: f64 },
}

/// A pipe ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Pipe {
    length_m: f64,
    law: Law,
    /// `Re mu/|m|`, 1/m.
    re_m: f64,
    /// `L/d/(2 A^2)`, 1/m4: friction factor 1 gives this times `m|m|/rho`.
    friction_per_m4: f64,
    /// `zeta/(2 A^2)`, 1/m4.
    fittings_per_m4: f64,
    thermal: PlugFlowPipe,
    m_flow_nominal_kg_s: f64,
}

impl PipeParams {
    /// The runtime pipe, alone in ordinary ground.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<Pipe, ElementError> {
        positive("inner_diameter_m", self.inner_diameter_m)?;
        let resistance = self.resistance(&Ground::default())?;
        self.build_with(medium, resistance.map(|alone| alone.total_k_m_w()))
    }

    /// The runtime pipe with a thermal resistance from water to surroundings per length, K m/W; `None`
    /// loses no heat.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build_with(
        &self,
        medium: &Medium,
        resistance_k_m_w: Option<f64>,
    ) -> Result<Pipe, ElementError> {
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
        let velocity =
            self.fixed_velocity_m_s.map(|v| positive("fixed_velocity_m_s", v)).transpose()?;
        let m_flow_nominal_kg_s = velocity.unwrap_or(0.5) * area_m2 * medium.density_kg_m3;
        let re_m = 4.0 / (PI * diameter_m);
        let friction_per_m4 = length_m / diameter_m / (2.0 * area_m2 * area_m2);
        let fittings_per_m4 = self.zeta / (2.0 * area_m2 * area_m2);
        let darcy = || DarcyFriction::new(self.friction, self.transition, relative_roughness);
        let frozen = match (velocity, self.friction_factor) {
            (None, None) => None,
            (Some(v), None) => {
                let re = v * diameter_m * medium.density_kg_m3 / medium.viscosity_pa_s;
                Some(darcy().factor(re).value)
            }
            (None, Some(factor)) if self.friction == Correlation::default() => {
                Some(positive("friction_factor", factor)?)
            }
            (_, Some(_)) => {
                let problem = "friction_factor stands for friction and fixed_velocity_m_s: leave \
                               them out";
                return Err(ElementError::Fields { problem: problem.into() });
            }
        };
        let law = match (self.power_friction(diameter_m)?, frozen) {
            (Some(_), Some(_)) => {
                let problem =
                    "fixed_velocity_m_s freezes a Darcy friction factor: a power law has none";
                return Err(ElementError::Fields { problem: problem.into() });
            }
            (Some(law), None) => Law::Power {
                coefficient: law.coefficient * length_m * GRAVITY_M_S2,
                exponent: law.exponent,
                v_turbulent_m3_s: POWER_LAW_VELOCITY_M_S * area_m2,
            },
            (None, None) => Law::Darcy { friction: darcy() },
            (None, Some(factor)) => Law::Fixed {
                coefficient: factor * friction_per_m4 + fittings_per_m4,
                m_turbulent_kg_s: self.delta_m * m_flow_nominal_kg_s,
            },
        };
        Ok(Pipe {
            length_m,
            law,
            re_m,
            friction_per_m4,
            fittings_per_m4,
            thermal: self.thermal(medium, m_flow_nominal_kg_s, resistance_k_m_w)?,
            m_flow_nominal_kg_s,
        })
    }
}

impl TwoPort for Pipe {
    #[inline]
    fn characteristic(&self, m: f64, state: &EdgeState) -> Characteristic {
        let per_density = 1.0 / state.density_kg_m3;
        let friction = match &self.law {
            Law::Fixed { coefficient, m_turbulent_kg_s } => {
                let loss = quadratic(m, coefficient * per_density, *m_turbulent_kg_s);
                return Characteristic::PressureLoss(loss);
            }
            Law::Darcy { friction } => {
                let size = m.abs();
                let factor = self.friction_per_m4 * per_density;
                let re_per_kg_s = self.re_m / state.viscosity_pa_s;
                let re = re_per_kg_s * size;
                if re <= RE_LAMINAR {
                    // f = 64/Re: linear through zero
                    let slope = 64.0 / re_per_kg_s * factor;
                    Linear::new(slope * m, slope)
                } else {
                    let f = friction.factor(re);
                    Linear::new(
                        f.value * factor * m * size,
                        factor * size * (f.slope * re + 2.0 * f.value),
                    )
                }
            }
            Law::Power { coefficient, exponent, v_turbulent_m3_s } => {
                let law = power(m * per_density, *coefficient, *exponent, *v_turbulent_m3_s);
                Linear::new(law.value * state.density_kg_m3, law.slope)
            }
        };
        if self.fittings_per_m4 == 0.0 {
            return Characteristic::PressureLoss(friction);
        }
        let m_turbulent = RE_LAMINAR * state.viscosity_pa_s / self.re_m;
        let fittings = quadratic(m, self.fittings_per_m4 * per_density, m_turbulent);
        Characteristic::PressureLoss(friction + fittings)
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

    fn inertance_1_m(&self) -> f64 {
        // Re mu/|m| is 4/(pi d), the cross-section pi d^2/4.
        self.length_m * PI / 4.0 * self.re_m * self.re_m
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
    fn given_friction_factor() {
        // Fanning 0.004, so Darcy 0.016; 10 m of 51 mm at 2.5 kg/s: A = 2.04282e-3 m2, v = 1.22380 m/s,
        // (0.016 * 10/0.051 + 2) * 1000/2 * 1.22380^2 = 3846.99 Pa
        let mut params = PipeParams {
            length_m: 10.0,
            inner_diameter_m: 0.051,
            zeta: 2.0,
            friction_factor: Some(0.016),
            ..PipeParams::default()
        };
        let pipe = params.build(&Medium::default()).unwrap();
        assert!((loss(&pipe, 2.5) - 3846.99).abs() < 0.01, "{}", loss(&pipe, 2.5));
        assert!((loss(&pipe, 5.0) / loss(&pipe, 2.5) - 4.0).abs() < 1e-12);
        params.fixed_velocity_m_s = Some(1.0);
        let error = params.build(&Medium::default()).unwrap_err();
        assert!(error.to_string().contains("friction_factor stands for"), "{error}");
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
