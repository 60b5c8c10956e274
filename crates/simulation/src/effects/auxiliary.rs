//! G6, auxiliary heater: it gives more or less than its rating.
//!
//! **Equation** `P = factor P_rated`.
//!
//! **Neutral** `factor = 1`. **Looks like** steps of heat and electricity that are off by the same share.

use crate::effect::{EffectError, ModelChange, unit, wanted};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::positive;
use anergy_prosumer::equipment::EquipmentParams;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Auxiliary {
    /// Power over its rating; 1 changes nothing.
    pub factor: f64,
}

impl Auxiliary {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("factor", self.factor)?;
        Ok(self.clone())
    }
}

impl ModelChange for Auxiliary {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let field = match unit(model, component, "unit with an auxiliary heater")? {
            EquipmentParams::AirSourceHeatPump(_) | EquipmentParams::BrineHeatPump(_) => {
                "aux_rated_w"
            }
            EquipmentParams::BoosterHeatPump(pump) if pump.aux_rated_w.is_some() => "aux_rated_w",
            EquipmentParams::StirlingChp(_) => "rod_rated_w",
            _ => return Err(wanted("unit with an auxiliary heater", component)),
        };
        Ok(vec![Change::Scale { parameter: format!("{component}.{field}"), factor: self.factor }])
    }
}
