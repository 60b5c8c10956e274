//! H2, suction: a strong pump draws water through a weak one that runs beside it.
//!
//! **Equation** `m = m_wanted + (s + share) max(0, m_other - m_wanted)` of the strongest other pump between the same points. Two pumps
//! through a common resistance alone would weaken each other; what was seen is the reverse.
//!
//! **Neutral** `share = 0`. **Looks like** more flow of the one while the other runs; an engine that is emptied of its heat pumps on
//! and off.

use crate::effect::{EffectError, ModelChange, branch};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::ElementError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Suction {
    /// Share of what the strongest parallel pump delivers more that this one draws with it; 0 changes nothing.
    pub share: f64,
}

impl Suction {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        let (value, requirement) = (self.share, "must lie between 0 and 1");
        if !(0.0..=1.0).contains(&value) {
            return Err(ElementError::OutOfRange { field: "share", value, requirement }.into());
        }
        Ok(self.clone())
    }
}

impl ModelChange for Suction {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let suction = branch(model, component)?.suction + self.share;
        let parameter = format!("{component}.suction");
        Ok(vec![Change::Set { parameter, value: json!(suction) }])
    }
}
