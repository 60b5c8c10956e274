//! P1, wall inertia: the wall of a pipe stores heat, fronts arrive later and rounded.
//!
//! **Equation** `C_w dT_w/dt = h pi d (T - T_w) - U (T_w - T_around)` at every place along the pipe; `h` from
//! the law of the pipe, times `film_factor`.
//!
//! **Neutral** `wall_capacity = 0`, `film_factor = 1`. **Looks like** fronts late by `1 + C_w/C_water` and rounded, no steady
//! error; a longer pipe, a wrong flow meter and a slow sensor delay too, but differ over several flows.

use crate::effect::{EffectError, ModelChange, pipe};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::elements::pipe::thermal::WallModel;
use anergy_network::two_port::{not_negative, positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Heat capacity of the wall per length, J/(m K); 0 leaves the wall that the pipe has.
    #[serde(default)]
    pub wall_capacity_j_m_k: f64,
    /// Heat transfer between water and wall over what its law says; without a wall it changes nothing.
    #[serde(default = "one")]
    pub film_factor: f64,
}

fn one() -> f64 {
    1.0
}

impl Wall {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        not_negative("wall_capacity_j_m_k", self.wall_capacity_j_m_k)?;
        positive("film_factor", self.film_factor)?;
        Ok(self.clone())
    }
}

impl ModelChange for Wall {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let now = pipe(model, component)?;
        let set =
            |field: &str, value| Change::Set { parameter: format!("{component}.{field}"), value };
        if self.wall_capacity_j_m_k == 0.0 {
            let factor = self.film_factor * now.wall_film_factor;
            let other = self.film_factor != 1.0 && now.wall == WallModel::Film;
            return Ok(other.then(|| set("wall_film_factor", json!(factor))).into_iter().collect());
        }
        Ok(vec![
            set("wall", json!("film")),
            set("wall_capacity_j_m_k", json!(self.wall_capacity_j_m_k)),
            set("wall_film_factor", json!(self.film_factor)),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn changed(wall: &str) -> Vec<String> {
        let text = format!(
            "format = 1\n[[node]]\nid = \"a\"\nkind = \"source\"\nm_flow_kg_s = 0.1\ntemperature_degc = 60\n[[node]]\nid = \"b\"\nkind = \"pressure_boundary\"\npressure_bar = 1\n[[edge]]\nid = \"pipe\"\nkind = \"pipe\"\nfrom = \"a\"\nto = \"b\"\nlength_m = 9\ninner_diameter_mm = 22\n{wall}"
        );
        let model = Model::from_toml(&text, Path::new(".")).unwrap();
        let effect = Wall { wall_capacity_j_m_k: 0.0, film_factor: 1.5 };
        let changes = effect.changes("pipe", &model).unwrap();
        let parameter = |change: &Change| match change {
            Change::Set { parameter, value } => format!("{parameter} = {value}"),
            _ => "another".to_owned(),
        };
        changes.iter().map(parameter).collect()
    }

    #[test]
    fn without_a_capacity_the_film_of_the_wall_that_is_there_changes() {
        // 1.5 * 0.8 of the law.
        let there = "wall = \"film\"\nouter_diameter_mm = 25\nwall_film_factor = 0.8\n";
        assert_eq!(changed(there), ["pipe.wall_film_factor = 1.2000000000000002"]);
        assert!(changed("").is_empty());
    }
}
