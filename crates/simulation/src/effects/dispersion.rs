//! P7, axial dispersion: turbulence and the velocity profile blur a front while it travels.
//!
//! **Equation** `+ D d2T/dx2`.
//!
//! **Neutral** `dispersion = 0`. **Looks like** a symmetric blur of fronts that grows with the square root
//! of the time they travel.

use crate::effect::{EffectError, ModelChange, pipe};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::not_negative;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dispersion {
    /// Dispersion coefficient D added to that of the pipe, m2/s; 0 changes nothing.
    pub dispersion_m2_s: f64,
}

impl Dispersion {
    /// Checks the range.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        not_negative("dispersion_m2_s", self.dispersion_m2_s)?;
        Ok(self.clone())
    }
}

impl ModelChange for Dispersion {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let dispersion_m2_s = pipe(model, component)?.dispersion_m2_s + self.dispersion_m2_s;
        let parameter = format!("{component}.dispersion_m2_s");
        Ok(vec![Change::Set { parameter, value: json!(dispersion_m2_s) }])
    }
}
