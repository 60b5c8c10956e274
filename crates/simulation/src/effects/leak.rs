//! H4, leaking valve: a closed valve or check valve lets water through.
//!
//! **Equation** `k_closed = (leakage + share) k_open`, the flow at the same pressure difference.
//!
//! **Neutral** `share = 0`. **Looks like** flow or temperature that creep at command 0; a zero offset of the meter (S8) does not warm
//! a pipe.

use crate::effect::{EffectError, ModelChange, wanted};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::elements::ElementParams;
use anergy_network::two_port::ElementError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Leak {
    /// What the closed valve lets through more, as a share of the open one; 0 changes nothing.
    pub share: f64,
}

impl Leak {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        let (value, requirement) = (self.share, "must not be negative and below 1");
        if !(0.0..1.0).contains(&value) {
            return Err(ElementError::OutOfRange { field: "share", value, requirement }.into());
        }
        Ok(self.clone())
    }
}

impl ModelChange for Leak {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let leakage = match model.edge(component).map(|edge| &edge.params) {
            Some(ElementParams::Valve(valve)) => valve.leakage,
            Some(ElementParams::BallValve(valve)) => valve.leakage,
            Some(ElementParams::CheckValve(valve)) => valve.leakage,
            _ => return Err(wanted("valve, ball_valve or check_valve", component)),
        };
        let parameter = format!("{component}.leakage");
        Ok(vec![Change::Set { parameter, value: json!(leakage + self.share) }])
    }
}
