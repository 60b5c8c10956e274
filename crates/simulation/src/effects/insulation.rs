//! P2, insulation: a pipe loses more or less heat than its data say.
//!
//! **Equation** `U = factor U0`, the conductance to the surroundings per length.
//!
//! **Neutral** `factor = 1`. **Looks like** a steady error of the temperature drop that goes with 1/m;
//! P3 differs in that it does not depend on the level of the water temperature.

use crate::effect::{EffectError, ModelChange, pipe};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::positive;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Insulation {
    /// Heat loss over what the data of the pipe say; 1 changes nothing.
    pub factor: f64,
}

impl Insulation {
    /// Checks the range.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("factor", self.factor)?;
        Ok(self.clone())
    }
}

impl ModelChange for Insulation {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        pipe(model, component)?;
        let parameter = format!("{component}.heat_loss_factor");
        Ok(vec![Change::Scale { parameter, factor: self.factor }])
    }
}
