//! P5, cooling at zero flow: a pipe that stands still cools faster or slower than one in flow.
//!
//! **Equation** `C dT/dt = -factor U0 (T - T_around)` while `m = 0`; in flow `factor` does not count.
//!
//! **Neutral** `factor = 1`. **Looks like** an error only at restart that grows with the time at rest.

use crate::effect::{EffectError, ModelChange, pipe};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::positive;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Standstill {
    /// Heat loss at zero flow over that in flow; 1 changes nothing.
    pub factor: f64,
}

impl Standstill {
    /// Checks the range.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("factor", self.factor)?;
        Ok(self.clone())
    }
}

impl ModelChange for Standstill {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        pipe(model, component)?;
        let parameter = format!("{component}.standstill_loss_factor");
        Ok(vec![Change::Scale { parameter, factor: self.factor }])
    }
}
