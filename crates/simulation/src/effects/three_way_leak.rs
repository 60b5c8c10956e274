//! H8, leak of a three-way valve: the closed way lets water through.
//!
//! **Equation** at the ends of the stroke `m_closed = share m` of the water where both ways have the same pressure difference: the closed way
//! keeps `share/(1 - share)` of the conductance of the open one.
//!
//! **Neutral** `share = 0`. **Looks like** an outlet that is pulled towards the other inlet; a biased sensor is off at all positions.

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
pub struct ThreeWayLeak {
    /// Share of the water that comes through the closed way; 0 changes nothing.
    pub share: f64,
}

impl ThreeWayLeak {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        let (value, requirement) = (self.share, "must not be negative and below 0.5");
        if !(0.0..0.5).contains(&value) {
            return Err(ElementError::OutOfRange { field: "share", value, requirement }.into());
        }
        Ok(self.clone())
    }
}

impl ModelChange for ThreeWayLeak {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let way = |name: &str| {
            let id = format!("{component}.{name}");
            match model.edge(&id).map(|edge| &edge.params) {
                Some(ElementParams::Valve(valve))
                    if valve.command_of.as_deref() == Some(component) =>
                {
                    let leakage = valve.leakage + self.share / (1.0 - self.share);
                    Ok(Change::Set { parameter: format!("{id}.leakage"), value: json!(leakage) })
                }
                _ => Err(wanted("three_way_valve", component)),
            }
        };
        Ok(vec![way("a")?, way("b")?])
    }
}
