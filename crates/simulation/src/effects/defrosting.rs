//! G4, de-icing: an air-source heat pump turns its cycle round to melt the ice on its evaporator.
//!
//! **Equation** after `after` of operation in cold air (faster in humid air) it takes `heat` from the water for `duration`.
//!
//! **Neutral** `heat = 0`. **Looks like** dips of the heat in cold air at about equal times of operation.

use crate::effect::{EffectError, ModelChange, unit, wanted};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::{not_negative, positive};
use anergy_prosumer::equipment::EquipmentParams;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Defrosting {
    /// Heat taken from the water in a defrost at full speed, W; 0 changes nothing.
    pub heat_w: f64,
    /// Operation in cold air until a defrost, s; that of the unit without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after_s: Option<f64>,
    /// Duration of a defrost, s; that of the unit without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
}

impl Defrosting {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        not_negative("heat_w", self.heat_w)?;
        for (field, value) in [("after_s", self.after_s), ("duration_s", self.duration_s)] {
            value.map(|value| positive(field, value)).transpose()?;
        }
        Ok(self.clone())
    }
}

impl ModelChange for Defrosting {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let EquipmentParams::AirSourceHeatPump(_) = unit(model, component, "air_source_heat_pump")?
        else {
            return Err(wanted("air_source_heat_pump", component));
        };
        if self.heat_w == 0.0 {
            return Ok(Vec::new());
        }
        let set =
            |field: &str, value| Change::Set { parameter: format!("{component}.{field}"), value };
        let mut changes =
            vec![set("defrost", json!(true)), set("defrost_heat_w", json!(self.heat_w))];
        changes.extend(self.after_s.map(|s| set("frost_after_s", json!(s))));
        changes.extend(self.duration_s.map(|s| set("defrost_duration_s", json!(s))));
        Ok(changes)
    }
}
