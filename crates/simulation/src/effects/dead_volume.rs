//! T3, dead volume at ports: water beyond a port takes part in what leaves through it.
//!
//! **Equation** what leaves is drawn from all layers within `entrainment + depth` of the port, the nearer the more, also below the lowest
//! and above the highest port.
//!
//! **Neutral** `depth = 0`. **Looks like** the lowest (highest) sensor follows the port, the others fit.

use crate::effect::{EffectError, ModelChange, storage};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::not_negative;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeadVolume {
    /// How much further below and above a port water is drawn along, m; 0 changes nothing.
    pub depth_m: f64,
}

impl DeadVolume {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        not_negative("depth_m", self.depth_m)?;
        Ok(self.clone())
    }
}

impl ModelChange for DeadVolume {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let entrainment_m = storage(model, component)?.entrainment_m + self.depth_m;
        let parameter = format!("{component}.entrainment_m");
        Ok(vec![Change::Set { parameter, value: json!(entrainment_m) }])
    }
}
