//! What of a pipe stores, carries and loses heat.
//!
//! **Equation** `tau = R (C' + C_w')` with `C' = rho cp A` of the water and `C_w' = rho_w c_w pi/4 (D^2 - d^2)` of
//! the wall per length. A wall in equilibrium moves with the water: fronts run with `v/(1 + C_w'/C')`.
//! Behind a film (`wall = "film"`) water and wall exchange `h pi d`, h from [`crate::film`], and the wall loses
//! the heat: R counts from the wall there, from the water elsewhere.
//!
//! **Assumptions** one temperature across the wall; insulation stores nothing.
//!
//! **Sources** `vanderheijde2017`, `gnielinski1976`.

use super::PipeParams;
use crate::two_port::{ElementError, Film, PlugFlowPipe, Wall, not_negative, positive};
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Water slower than this share of the nominal flow stands still.
const STANDING_SHARE: f64 = 1e-4;
/// Flow that always counts as standing still, kg/s.
const STANDING_KG_S: f64 = 1e-6;

/// How the wall of the medium pipe stores heat.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WallModel {
    /// Not at all.
    #[default]
    None,
    /// In one perfectly mixed volume at port b.
    EndVolume,
    /// All along the pipe, at the temperature of the water: fronts are late and stay sharp.
    Equilibrium,
    /// All along the pipe, behind the film of the water: fronts are late and rounded.
    Film,
}

impl PipeParams {
    pub(super) fn thermal(
        &self,
        medium: &Medium,
        m_flow_nominal_kg_s: f64,
        resistance_k_m_w: Option<f64>,
    ) -> Result<PlugFlowPipe, ElementError> {
        let (length_m, diameter_m) = (self.length_m, self.inner_diameter_m);
        let cp = medium.heat_capacity_j_kg_k;
        let area_m2 = PI / 4.0 * diameter_m * diameter_m;
        let capacity_j_k_m = medium.density_kg_m3 * cp * area_m2;
        let wall_j_k_m = self.wall_capacity_j_k_m(diameter_m)?;
        let loss_factor = positive("heat_loss_factor", self.heat_loss_factor)?;
        let loss_time_constant_s = resistance_k_m_w.map_or(f64::INFINITY, |resistance| {
            resistance * (capacity_j_k_m + wall_j_k_m) / loss_factor
        });
        let dispersion_m2_s = not_negative("dispersion_m2_s", self.dispersion_m2_s)?;
        let film_factor = positive("wall_film_factor", self.wall_film_factor)?;
        let wall = match self.wall {
            _ if wall_j_k_m == 0.0 => Wall::None,
            WallModel::None => Wall::None,
            WallModel::EndVolume => Wall::EndVolume,
            WallModel::Equilibrium => Wall::Equilibrium,
            WallModel::Film => Wall::Film(Film {
                re_per_kg_s: 4.0 / (PI * diameter_m * medium.viscosity_pa_s),
                prandtl: medium.viscosity_pa_s * cp / medium.conductivity_w_m_k,
                // h pi d L = Nu lambda pi L
                per_nusselt_kg_s: film_factor * medium.conductivity_w_m_k * PI * length_m / cp,
            }),
        };
        let water_kg = medium.density_kg_m3 * area_m2 * length_m;
        let wall_kg = wall_j_k_m * length_m / cp;
        Ok(PlugFlowPipe {
            water_kg,
            wall_kg,
            wall,
            content_kg: if wall == Wall::Equilibrium { water_kg + wall_kg } else { water_kg },
            loss_time_constant_s,
            standstill_loss_factor: positive(
                "standstill_loss_factor",
                self.standstill_loss_factor,
            )?,
            standing_kg_s: (STANDING_SHARE * m_flow_nominal_kg_s).max(STANDING_KG_S),
            dispersion_kg_s: medium.density_kg_m3 * area_m2 * dispersion_m2_s / length_m,
        })
    }

    /// Heat capacity of the wall per length, J/(m K); 0 where it counts for nothing.
    fn wall_capacity_j_k_m(&self, diameter_m: f64) -> Result<f64, ElementError> {
        let density_kg_m3 = positive("wall_density_kg_m3", self.wall_density_kg_m3)?;
        let heat_j_kg_k = positive("wall_heat_capacity_j_kg_k", self.wall_heat_capacity_j_kg_k)?;
        let given = self.wall_capacity_j_m_k.map(|c| not_negative("wall_capacity_j_m_k", c));
        let outer_m = self.outer_diameter_m.map(|outer_m| {
            if outer_m.is_finite() && outer_m > diameter_m {
                return Ok(outer_m);
            }
            Err(ElementError::OutOfRange {
                field: "outer_diameter_m",
                value: outer_m,
                requirement: "must be more than the inner diameter",
            })
        });
        let (given, outer_m) = (given.transpose()?, outer_m.transpose()?);
        match (self.wall, given, outer_m) {
            (WallModel::None, ..) => Ok(0.0),
            (_, Some(capacity_j_m_k), _) => Ok(capacity_j_m_k),
            (_, None, Some(outer_m)) => {
                let metal_m2 = PI / 4.0 * (outer_m * outer_m - diameter_m * diameter_m);
                Ok(density_kg_m3 * heat_j_kg_k * metal_m2)
            }
            (_, None, None) => Err(ElementError::Fields {
                problem: "a wall that stores heat needs outer_diameter_m or wall_capacity_j_m_k"
                    .into(),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wall_of_a_steel_pipe() {
        // Water: 1000 * 4180 * pi/4 * 0.05248^2 = 9041.8 J/(m K). Steel: 7850 * 460 * pi/4
        // * (0.0603^2 - 0.05248^2) = 2501.2 J/(m K). Loss: 2.164 * (9041.8 + 2501.2) = 24 979 s.
        let mut params = PipeParams {
            length_m: 39.0,
            inner_diameter_m: 0.052_48,
            outer_diameter_m: Some(0.0603),
            insulation_resistance_k_m_w: Some(2.164),
            wall: WallModel::Equilibrium,
            ..PipeParams::default()
        };
        let thermal = |params: &PipeParams| {
            let resistance = params.insulation_resistance_k_m_w;
            params.thermal(&Medium::default(), 1.0, resistance).unwrap()
        };
        let pipe = thermal(&params);
        assert!((pipe.wall_kg / pipe.water_kg - 2501.2 / 9041.8).abs() < 2e-4);
        assert!((pipe.loss_time_constant_s - 24_979.0).abs() < 5.0);
        assert_eq!(pipe.content_kg, pipe.water_kg + pipe.wall_kg);
        // 39/(2.164 * 4180) kg/s of heat loss with each of the models; the film adds its resistance:
        // Nu 3.66 at rest: 1/(3.66 * 0.6 * pi) = 0.14495 K m/W.
        let loss = 39.0 / (2.164 * 4180.0);
        assert!((pipe.loss_kg_s(0.0) / loss - 1.0).abs() < 1e-12);
        params.wall = WallModel::Film;
        let behind_film = 39.0 / ((2.164 + 0.144_95) * 4180.0);
        assert!((thermal(&params).loss_kg_s(0.0) / behind_film - 1.0).abs() < 1e-5);
        params.wall = WallModel::None;
        assert!((thermal(&params).loss_kg_s(0.0) / loss - 1.0).abs() < 1e-12);
        assert_eq!(thermal(&params).wall_kg, 0.0);
    }

    #[test]
    fn a_wall_needs_a_capacity() {
        let mut params = PipeParams { wall: WallModel::Film, ..PipeParams::default() };
        let refused =
            |params: &PipeParams| params.thermal(&Medium::default(), 1.0, None).unwrap_err();
        assert!(refused(&params).to_string().contains("wall_capacity_j_m_k"));
        params.outer_diameter_m = Some(0.1);
        assert_eq!(refused(&params).field(), Some("outer_diameter_m"));
    }
}
