//! P8, roughness or deposit: a pipe takes more or less pressure than its data say.
//!
//! **Equation** `dp = factor dp0(m)` with the roughness `k = k0 + added_roughness`.
//!
//! **Neutral** `factor = 1`, `added_roughness = 0`. **Looks like** an error of the pressure difference
//! that goes with m squared, and none of the temperatures.

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
pub struct Friction {
    /// Pressure loss over what the data of the pipe say; 1 changes nothing.
    #[serde(default = "one")]
    pub factor: f64,
    /// What deposits add to the roughness of the wall, m; 0 changes nothing.
    #[serde(default)]
    pub added_roughness_m: f64,
}

fn one() -> f64 {
    1.0
}

impl Friction {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("factor", self.factor)?;
        not_negative("added_roughness_m", self.added_roughness_m)?;
        Ok(self.clone())
    }
}

impl ModelChange for Friction {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let roughness_m = pipe(model, component)?.roughness_m + self.added_roughness_m;
        Ok(vec![
            Change::WrapLaw { edge: component.to_owned(), loss_factor: self.factor },
            Change::Set {
                parameter: format!("{component}.roughness_m"),
                value: json!(roughness_m),
            },
        ])
    }
}
