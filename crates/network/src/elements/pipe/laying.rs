//! The heat resistance of a pipe as it is written: its layers, and how it lies.
//!
//! **Equation** film + wall + insulation + casing, then the soil, or the air around it
//! ([`crate::buried_pipe`]).
//!
//! **Assumptions** concentric layers; the casing is PE of [`POLYETHYLENE_W_M_K`]. The casing of a twin pipe
//! counts as soil, and the conductivity of what is between the pipes is that of the insulation.
//! **Validity** that of the formulas; what does not fit is refused. **Sources** `en253`, `en13941`.

use super::PipeParams;
use super::thermal::WallModel;
use crate::buried_pipe::{
    PipePair, TwinPipe, film_k_m_w, layer_k_m_w, neighbour_k_m_w, outer_film_w_m2_k, soil_k_m_w,
};
use crate::ground::Ground;
use crate::soil::{MOST_RINGS, RingsAround, SoilRings};
use crate::two_port::{ElementError, not_negative, positive};
use anergy_core::ids::EdgeId;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Conductivity of a wall that does not say its own, W/(m K): steel.
pub const STEEL_W_M_K: f64 = 50.0;
/// Conductivity of a casing, W/(m K).
pub const POLYETHYLENE_W_M_K: f64 = 0.4;
/// Conductivity of an insulation that does not say its own, W/(m K): rigid polyurethane foam.
pub const FOAM_W_M_K: f64 = 0.028;
/// Film of turbulent water, W/(m2 K).
pub const FILM_W_M2_K: f64 = 3500.0;
/// Wind across a pipe in the air that does not say its own, m/s: nearly still.
pub const WIND_M_S: f64 = 1.0;
/// Temperature at which a jacket in the air radiates, K.
const JACKET_K: f64 = 283.15;

/// How a pipe lies: the heat it loses then follows from its layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Laying {
    /// In the ground, alone or beside another pipe (`spacing_m`).
    Buried,
    /// In the ground, beside another pipe in one casing.
    Twin,
    /// In the air.
    AboveGround,
}

/// The thermal resistance of a pipe, K m/W.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resistance {
    /// From the water to what touches the surroundings.
    pub inside_k_m_w: f64,
    /// From there to the undisturbed surroundings.
    pub outside_k_m_w: f64,
}

impl Resistance {
    /// From the water to the undisturbed surroundings.
    pub fn total_k_m_w(&self) -> f64 {
        self.inside_k_m_w + self.outside_k_m_w
    }
}

pub(super) fn problem<T>(problem: impl Into<String>) -> Result<T, ElementError> {
    Err(ElementError::Fields { problem: problem.into() })
}

pub(super) fn out_of_range<T>(
    field: &'static str,
    value: f64,
    requirement: &'static str,
) -> Result<T, ElementError> {
    Err(ElementError::OutOfRange { field, value, requirement })
}

impl PipeParams {
    /// The depth of the axis, m.
    pub fn depth_m(&self, ground: &Ground) -> f64 {
        self.depth_m.unwrap_or(ground.depth_m)
    }

    /// Outer diameter of what touches the surroundings, m: casing, insulation or wall.
    ///
    /// # Errors
    /// Names the field that is missing or does not fit.
    pub fn jacket_diameter_m(&self) -> Result<f64, ElementError> {
        let Some(wall_m) = self.outer_diameter_m else {
            return problem("laying needs outer_diameter_m, the outer diameter of the wall");
        };
        positive("outer_diameter_m", wall_m)?;
        if wall_m <= self.inner_diameter_m {
            return out_of_range(
                "outer_diameter_m",
                wall_m,
                "must be more than the inner diameter",
            );
        }
        let casing_m = match (self.casing_diameter_m, self.insulation_thickness_m) {
            (Some(_), Some(_)) => {
                return problem(
                    "casing_diameter_m and insulation_thickness_m say the same: give one",
                );
            }
            (Some(casing_m), None) => positive("casing_diameter_m", casing_m)?,
            (None, Some(thickness_m)) => {
                let casing_m = 2.0 * self.casing_thickness_m.unwrap_or(0.0);
                wall_m + 2.0 * positive("insulation_thickness_m", thickness_m)? + casing_m
            }
            (None, None) => {
                let insulation = [
                    ("insulation_conductivity_w_m_k", self.insulation_conductivity_w_m_k),
                    ("casing_thickness_m", self.casing_thickness_m),
                ];
                if let Some((field, _)) = insulation.iter().find(|(_, value)| value.is_some()) {
                    return problem(format!(
                        "{field} needs casing_diameter_m or insulation_thickness_m"
                    ));
                }
                return Ok(wall_m);
            }
        };
        let foam_m = casing_m
            - 2.0 * not_negative("casing_thickness_m", self.casing_thickness_m.unwrap_or(0.0))?;
        if foam_m <= wall_m {
            let requirement = "leaves no room for insulation around the wall";
            return out_of_range("casing_diameter_m", casing_m, requirement);
        }
        Ok(casing_m)
    }

    /// The thermal resistance of the pipe alone: from its layers where it says how it lies, else as given.
    /// `None`: it loses no heat.
    ///
    /// # Errors
    /// Names the fields that are missing, too many or out of range.
    pub fn resistance(&self, ground: &Ground) -> Result<Option<Resistance>, ElementError> {
        if let Some(depth_m) = self.depth_m {
            positive("depth_m", depth_m)?;
        }
        self.check_ground_node()?;
        let Some(laying) = self.laying else {
            if let Some(field) = self.field_of_laying() {
                return problem(format!(
                    "{field} needs laying = \"buried\", \"twin\" or \"above_ground\""
                ));
            }
            let Some(resistance) = self.insulation_resistance_k_m_w else { return Ok(None) };
            let inside_k_m_w = positive("insulation_resistance_k_m_w", resistance)?;
            return Ok(Some(Resistance { inside_k_m_w, outside_k_m_w: 0.0 }));
        };
        if self.insulation_resistance_k_m_w.is_some() {
            return problem("insulation_resistance_k_m_w and laying both give the loss: keep one");
        }
        let jacket_m = self.jacket_diameter_m()?;
        if laying != Laying::AboveGround
            && 2.0 * ground.soil.corrected_depth_m(self.depth_m(ground)) <= jacket_m
        {
            let requirement = "is the depth of the axis: the pipe reaches out of the ground";
            return out_of_range("depth_m", self.depth_m(ground), requirement);
        }
        if laying != Laying::AboveGround
            && (self.wind_m_s.is_some() || self.outer_film_w_m2_k.is_some())
        {
            return problem("wind_m_s and outer_film_w_m2_k need laying = \"above_ground\"");
        }
        self.check_rings(laying)?;
        let to_wall = self.to_wall_k_m_w()?;
        match laying {
            Laying::Buried => Ok(Some(Resistance {
                inside_k_m_w: to_wall + self.insulation_k_m_w(jacket_m)?,
                outside_k_m_w: soil_k_m_w(jacket_m, self.depth_m(ground), &ground.soil),
            })),
            Laying::AboveGround => Ok(Some(Resistance {
                inside_k_m_w: to_wall + self.insulation_k_m_w(jacket_m)?,
                outside_k_m_w: film_k_m_w(jacket_m, self.outer_film_w_m2_k(jacket_m)?),
            })),
            Laying::Twin => {
                let pair = self.twin_pair(ground)?;
                // Alone means: the other one is as warm as the ground.
                let alone = 1.0 / (1.0 / pair.ground_k_m_w[0] + pair.between_w_m_k);
                Ok(Some(Resistance { inside_k_m_w: alone, outside_k_m_w: 0.0 }))
            }
        }
    }

    fn check_rings(&self, laying: Laying) -> Result<(), ElementError> {
        let Some(rings) = self.soil_rings else { return Ok(()) };
        if !(1..=MOST_RINGS).contains(&rings) {
            return out_of_range("soil_rings", rings as f64, "must be 1 to 5");
        }
        if laying != Laying::Buried || self.spacing_m.is_some() {
            return problem(
                "soil_rings are those of a pipe that is buried alone: laying = \"buried\", no spacing_m",
            );
        }
        Ok(())
    }

    /// The soil that stores heat around the pipe, if it does; `first` is its place in the state.
    ///
    /// # Errors
    /// As [`Self::resistance`].
    pub fn soil(
        &self,
        edge: EdgeId,
        first: usize,
        ground: &Ground,
    ) -> Result<Option<SoilRings>, ElementError> {
        let Some(alone) = self.resistance(ground)? else { return Ok(None) };
        if let Some(node) = self.ground_node(edge, first, alone.total_k_m_w()) {
            return Ok(Some(node));
        }
        let Some(rings) = self.soil_rings else { return Ok(None) };
        let around = RingsAround {
            length_m: self.length_m,
            jacket_diameter_m: self.jacket_diameter_m()?,
            depth_m: self.depth_m(ground),
            inside_k_m_w: alone.inside_k_m_w,
            outside_k_m_w: alone.outside_k_m_w,
        };
        Ok(Some(SoilRings::new(edge, first, rings, &around, ground)))
    }

    /// The three resistors of this pipe and the one beside it.
    ///
    /// # Errors
    /// Says what the two do not have in common, or what does not fit.
    pub fn pair(&self, other: &Self, ground: &Ground) -> Result<PipePair, ElementError> {
        let resistances = (self.resistance(ground)?, other.resistance(ground)?);
        let ((Some(a), Some(b)), Some(laying)) = (resistances, self.laying) else {
            return problem("a companion needs laying = \"buried\" or \"twin\" on both pipes");
        };
        if other.laying != Some(laying) || laying == Laying::AboveGround {
            return problem("a companion needs laying = \"buried\" or \"twin\" on both pipes");
        }
        if (self.length_m - other.length_m).abs() > 1e-9 * self.length_m {
            return out_of_range("length_m", self.length_m, "is not the length of its companion");
        }
        if laying == Laying::Twin {
            let pair = self.twin_pair(ground)?;
            return if other.twin_pair(ground)? == pair {
                Ok(pair)
            } else {
                problem("two pipes in one casing must be equal")
            };
        }
        let Some(spacing_m) = self.spacing_m.or(other.spacing_m) else {
            return problem("a companion needs spacing_m, the distance of the axes");
        };
        if other.spacing_m.is_some_and(|its_m| its_m != spacing_m) {
            return problem("spacing_m must be the same for both pipes");
        }
        let room_m = 0.5 * (self.jacket_diameter_m()? + other.jacket_diameter_m()?);
        let depths_m = [self.depth_m(ground), other.depth_m(ground)];
        if positive("spacing_m", spacing_m)?.hypot(depths_m[0] - depths_m[1]) < room_m {
            let requirement = "from axis to axis is less than the pipes are thick";
            return out_of_range("spacing_m", spacing_m, requirement);
        }
        let neighbour = neighbour_k_m_w(depths_m, spacing_m, &ground.soil);
        match PipePair::of([a.total_k_m_w(), b.total_k_m_w()], neighbour) {
            Some(pair) => Ok(pair),
            None => problem("the pipes are too near each other to be two pipes in soil"),
        }
    }

    fn twin_pair(&self, ground: &Ground) -> Result<PipePair, ElementError> {
        let Some(spacing_m) = self.spacing_m else {
            return problem("laying = \"twin\" needs spacing_m, the distance of the two axes");
        };
        let jacket_m = self.jacket_diameter_m()?;
        let pipe_diameter_m = self.outer_diameter_m.unwrap_or(jacket_m);
        let twin = TwinPipe {
            pipe_diameter_m,
            spacing_m,
            casing_diameter_m: jacket_m - 2.0 * self.casing_thickness_m.unwrap_or(0.0),
            insulation_w_m_k: self.insulation_w_m_k()?,
            depth_m: self.depth_m(ground),
        };
        let fitting = Some(twin).filter(TwinPipe::fits);
        match fitting.and_then(|twin| twin.pair(self.to_wall_k_m_w().ok()?, &ground.soil)) {
            Some(pair) => Ok(pair),
            None => out_of_range(
                "spacing_m",
                spacing_m,
                "from axis to axis: two such pipes do not fit into the casing",
            ),
        }
    }

    /// The values that stand in for fields of its layers that are not given: field, value, where from.
    pub fn layer_defaults(&self, ground: &Ground) -> Vec<(&'static str, f64, &'static str)> {
        let Some(laying) = self.laying else { return Vec::new() };
        let insulated = self.casing_diameter_m.is_some() || self.insulation_thickness_m.is_some();
        let in_air = laying == Laying::AboveGround;
        let all = [
            (
                "film_w_m2_k",
                self.film_w_m2_k,
                FILM_W_M2_K,
                true,
                "turbulent water (licklederer2021)",
            ),
            ("wall_conductivity_w_m_k", self.wall_conductivity_w_m_k, STEEL_W_M_K, true, "steel"),
            (
                "insulation_conductivity_w_m_k",
                self.insulation_conductivity_w_m_k,
                FOAM_W_M_K,
                insulated,
                "polyurethane foam (en253: at most 0.029)",
            ),
            ("depth_m", self.depth_m, ground.depth_m, !in_air, "[ground] depth_m"),
            (
                "wind_m_s",
                self.wind_m_s.or(self.outer_film_w_m2_k),
                WIND_M_S,
                in_air,
                "nearly still air (assumed)",
            ),
        ];
        let used = all.into_iter().filter(|(_, given, _, counts, _)| given.is_none() && *counts);
        used.map(|(field, _, value, _, source)| (field, value, source)).collect()
    }

    /// Film and wall, K m/W.
    fn to_wall_k_m_w(&self) -> Result<f64, ElementError> {
        let film = self.film_w_m2_k.unwrap_or(FILM_W_M2_K);
        let film = match self.wall {
            // The wall has a temperature of its own, from which the heat is lost.
            WallModel::Film => 0.0,
            _ => film_k_m_w(self.inner_diameter_m, positive("film_w_m2_k", film)?),
        };
        let wall = self.wall_conductivity_w_m_k.unwrap_or(STEEL_W_M_K);
        let wall = positive("wall_conductivity_w_m_k", wall)?;
        let outer_m = self.outer_diameter_m.unwrap_or(self.inner_diameter_m);
        Ok(film + layer_k_m_w(self.inner_diameter_m, outer_m, wall))
    }

    fn insulation_w_m_k(&self) -> Result<f64, ElementError> {
        let conductivity = self.insulation_conductivity_w_m_k.unwrap_or(FOAM_W_M_K);
        positive("insulation_conductivity_w_m_k", conductivity)
    }

    /// Insulation and casing of a single pipe, K m/W.
    fn insulation_k_m_w(&self, jacket_m: f64) -> Result<f64, ElementError> {
        let wall_m = self.outer_diameter_m.unwrap_or(jacket_m);
        let foam_m = jacket_m - 2.0 * self.casing_thickness_m.unwrap_or(0.0);
        Ok(layer_k_m_w(wall_m, foam_m, self.insulation_w_m_k()?)
            + layer_k_m_w(foam_m, jacket_m, POLYETHYLENE_W_M_K))
    }

    fn outer_film_w_m2_k(&self, jacket_m: f64) -> Result<f64, ElementError> {
        match (self.outer_film_w_m2_k, self.wind_m_s) {
            (Some(_), Some(_)) => problem("wind_m_s has no effect beside outer_film_w_m2_k"),
            (Some(film), None) => positive("outer_film_w_m2_k", film),
            (None, wind_m_s) => {
                let wind_m_s = not_negative("wind_m_s", wind_m_s.unwrap_or(WIND_M_S))?;
                Ok(outer_film_w_m2_k(jacket_m, wind_m_s, JACKET_K))
            }
        }
    }

    /// A field that means nothing without `laying`.
    fn field_of_laying(&self) -> Option<&'static str> {
        let fields = [
            ("casing_diameter_m", self.casing_diameter_m.is_some()),
            ("casing_thickness_m", self.casing_thickness_m.is_some()),
            ("insulation_thickness_m", self.insulation_thickness_m.is_some()),
            ("insulation_conductivity_w_m_k", self.insulation_conductivity_w_m_k.is_some()),
            ("wall_conductivity_w_m_k", self.wall_conductivity_w_m_k.is_some()),
            ("film_w_m2_k", self.film_w_m2_k.is_some()),
            ("spacing_m", self.spacing_m.is_some()),
            ("companion", self.companion.is_some()),
            ("soil_rings", self.soil_rings.is_some()),
            ("wind_m_s", self.wind_m_s.is_some()),
            ("outer_film_w_m2_k", self.outer_film_w_m2_k.is_some()),
        ];
        fields.into_iter().find(|(_, given)| *given).map(|(field, _)| field)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pre_insulated() -> PipeParams {
        PipeParams {
            inner_diameter_m: 0.0285,
            outer_diameter_m: Some(0.0337),
            casing_diameter_m: Some(0.110),
            casing_thickness_m: Some(0.003),
            laying: Some(Laying::Buried),
            depth_m: Some(0.8),
            ..PipeParams::default()
        }
    }

    fn close(value: f64, expected: f64, within: f64) {
        assert!((value - expected).abs() <= within, "{value} is not {expected}");
    }

    #[test]
    fn layers_of_a_buried_pipe() {
        // 1/(pi 0.0285 3500) = 0.003191; ln(33.7/28.5)/(2 pi 50) = 0.000533;
        // ln(104/33.7)/(2 pi 0.028) = 6.405379; ln(110/104)/(2 pi 0.4) = 0.022317; soil 0.347943
        let alone = pre_insulated().resistance(&Ground::default()).unwrap().unwrap();
        close(alone.inside_k_m_w, 0.003_191 + 0.000_533 + 6.405_379 + 0.022_317, 2e-6);
        close(alone.outside_k_m_w, 0.347_943, 1e-6);
    }

    #[test]
    fn thickness_instead_of_casing() {
        let mut pipe = pre_insulated();
        let with_casing = pipe.resistance(&Ground::default()).unwrap().unwrap();
        pipe.casing_diameter_m = None;
        pipe.insulation_thickness_m = Some(0.5 * (0.104 - 0.0337));
        let with_thickness = pipe.resistance(&Ground::default()).unwrap().unwrap();
        close(with_thickness.total_k_m_w(), with_casing.total_k_m_w(), 1e-12);
    }

    #[test]
    fn bare_plastic_pipe() {
        // PE 63 x 5.8: ln(63/51.4)/(2 pi 0.4) = 0.080969, film 1/(pi 0.0514 3500) = 0.001769
        let pipe = PipeParams {
            inner_diameter_m: 0.0514,
            outer_diameter_m: Some(0.063),
            wall_conductivity_w_m_k: Some(0.4),
            laying: Some(Laying::Buried),
            ..PipeParams::default()
        };
        let alone = pipe.resistance(&Ground::default()).unwrap().unwrap();
        close(alone.inside_k_m_w, 0.080_969 + 0.001_769, 2e-6);
        close(alone.outside_k_m_w, soil_k_m_w(0.063, 1.0, &Ground::default().soil), 1e-15);
    }

    #[test]
    fn in_the_air_the_outer_film_counts() {
        // 1/(pi 0.11 10) = 0.289373
        let mut pipe = pre_insulated();
        pipe.laying = Some(Laying::AboveGround);
        pipe.outer_film_w_m2_k = Some(10.0);
        let alone = pipe.resistance(&Ground::default()).unwrap().unwrap();
        close(alone.outside_k_m_w, 0.289_373, 1e-6);
    }

    #[test]
    fn pairs_lose_what_the_formula_says() {
        let mut pipe = pre_insulated();
        pipe.spacing_m = Some(0.25);
        let ground = Ground::default();
        let alone = pipe.resistance(&ground).unwrap().unwrap().total_k_m_w();
        let m = neighbour_k_m_w([0.8, 0.8], 0.25, &ground.soil);
        let pair = pipe.pair(&pipe, &ground).unwrap();
        let [q1, q2] = pair.losses_w_m([60.0, 30.0]);
        close(q1 + q2, 90.0 / (alone + m), 1e-12);
        close(q1 - q2, 30.0 / (alone - m), 1e-12);
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let said = |change: fn(&mut PipeParams)| {
            let mut pipe = pre_insulated();
            change(&mut pipe);
            pipe.resistance(&Ground::default()).unwrap_err().to_string()
        };
        assert!(said(|pipe| pipe.laying = None).contains("casing_diameter_m needs laying"));
        assert!(said(|pipe| pipe.outer_diameter_m = None).contains("needs outer_diameter_m"));
        assert!(said(|pipe| pipe.outer_diameter_m = Some(0.02)).contains("more than the inner"));
        assert!(said(|pipe| pipe.casing_diameter_m = Some(0.035)).contains("no room"));
        assert!(said(|pipe| pipe.depth_m = Some(-0.1)).contains("depth_m = -0.1"));
        assert!(said(|pipe| pipe.laying = Some(Laying::Twin)).contains("needs spacing_m"));
        assert!(said(|pipe| pipe.insulation_resistance_k_m_w = Some(3.0)).contains("keep one"));
        assert!(said(|pipe| pipe.wind_m_s = Some(2.0)).contains("above_ground"));
    }
}
