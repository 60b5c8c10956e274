//! G1, efficiency level: a generator needs less or more fuel or electricity for its heat than its map says, at all loads.
//!
//! **Equation** `eta = factor eta0`, or the COP.
//!
//! **Neutral** `factor = 1`. **Looks like** an error of fuel or electricity in proportion to it, in all regimes; a meter that is off
//! looks the same until both sides of the energy are measured.

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
pub struct EfficiencyLevel {
    /// Efficiency, or COP, over what the data of the generator say; 1 changes nothing.
    pub factor: f64,
}

impl EfficiencyLevel {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("factor", self.factor)?;
        Ok(self.clone())
    }
}

impl ModelChange for EfficiencyLevel {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let field = match unit(model, component, "generator")? {
            EquipmentParams::CondensingBoiler(_)
            | EquipmentParams::Chp(_)
            | EquipmentParams::StirlingChp(_)
            | EquipmentParams::AirSourceHeatPump(_) => "efficiency_factor",
            EquipmentParams::BrineHeatPump(pump) if pump.map.is_none() => "cop_nominal",
            EquipmentParams::BoosterHeatPump(pump) if pump.map.is_none() => "carnot_share",
            _ => return Err(wanted("generator with an efficiency", component)),
        };
        Ok(vec![Change::Scale { parameter: format!("{component}.{field}"), factor: self.factor }])
    }
}
