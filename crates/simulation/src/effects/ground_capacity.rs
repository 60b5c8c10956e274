//! P4, capacity of the ground: what is around a pipe is warmed by it, and answers hours to days later.
//!
//! **Equation** one node in the resistance `R` of the pipe: `C dT/dt = (T_water - T)/((1 - s) R) - (T - T_around)/(s R)`, `s` the share
//! of the resistance beyond the node. The steady loss is that without it as long as the water changes little on its way: the node has one temperature along the
//! pipe (0.1 % less where the water cools by a tenth of its difference).
//!
//! **Neutral** `capacity = 0`. **Looks like** a loss that drifts for hours to days after a change of level; a drifting sensor (S3)
//! does not follow the level. **Validity** pipes with a heat loss that are no companions and have no `soil_rings`, which say the same
//! with more.

use crate::effect::{EffectError, ModelChange, pipe};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::{ElementError, not_negative};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GroundCapacity {
    /// Heat capacity per length, J/(m K); 0 changes nothing.
    pub capacity_j_m_k: f64,
    /// Share of the thermal resistance of the pipe that lies beyond it.
    #[serde(default = "half")]
    pub share: f64,
}

fn half() -> f64 {
    0.5
}

impl GroundCapacity {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        not_negative("capacity_j_m_k", self.capacity_j_m_k)?;
        let (field, value) = ("share", self.share);
        if !(0.01..=0.99).contains(&value) {
            let requirement = "must lie between 0.01 and 0.99";
            return Err(ElementError::OutOfRange { field, value, requirement }.into());
        }
        Ok(self.clone())
    }
}

impl ModelChange for GroundCapacity {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        pipe(model, component)?;
        if self.capacity_j_m_k == 0.0 {
            return Ok(Vec::new());
        }
        let set = |field: &str, value: f64| Change::Set {
            parameter: format!("{component}.{field}"),
            value: json!(value),
        };
        Ok(vec![set("ground_capacity_j_m_k", self.capacity_j_m_k), set("ground_share", self.share)])
    }
}
