//! P1, wall inertia: the wall of a pipe stores heat, fronts arrive later and rounded.
//!
//! **Equation** `C_w dT_w/dt = h pi d (T - T_w) - U (T_w - T_around)` at every place along the pipe; `h` from
//! the law of the pipe, times `film_factor`.
//!
//! **Neutral** `wall_capacity = 0`. **Looks like** fronts late by `1 + C_w/C_water` and rounded, no steady
//! error; a longer pipe, a wrong flow meter and a slow sensor delay too, but differ over several flows.

use crate::effect::{EffectError, ModelChange, pipe};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::{not_negative, positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Heat capacity of the wall per length, J/(m K); 0 changes nothing.
    pub wall_capacity_j_m_k: f64,
    /// Heat transfer between water and wall over what its law says.
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
        pipe(model, component)?;
        if self.wall_capacity_j_m_k == 0.0 {
            return Ok(Vec::new());
        }
        let set =
            |field: &str, value| Change::Set { parameter: format!("{component}.{field}"), value };
        Ok(vec![
            set("wall", json!("film")),
            set("wall_capacity_j_m_k", json!(self.wall_capacity_j_m_k)),
            set("wall_film_factor", json!(self.film_factor)),
        ])
    }
}
