//! P10, length: a pipe is longer or shorter than the plan says.
//!
//! **Equation** `L = factor L0`: delay, heat loss and friction all follow.
//!
//! **Neutral** `factor = 1`. **Looks like** a wrong delay; a wrong flow meter does the same to the delay,
//! but not to the pressure loss.

use crate::effect::{EffectError, ModelChange, pipe};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::positive;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Length {
    /// Length over the plan's; 1 changes nothing.
    pub factor: f64,
}

impl Length {
    /// Checks the range.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("factor", self.factor)?;
        Ok(self.clone())
    }
}

impl ModelChange for Length {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        pipe(model, component)?;
        let parameter = format!("{component}.length_m");
        Ok(vec![Change::Scale { parameter, factor: self.factor }])
    }
}
