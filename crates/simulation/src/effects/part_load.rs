//! G2, part load: a generator is better or worse at part load than its map says.
//!
//! **Equation** `eta = g(load) eta0`, straight between the factors at 20, 40 and 60 % and 1 at full load.
//!
//! **Neutral** all 1. **Looks like** an error over the load, none at full load; an efficiency level (G1) errs there too.

use crate::effect::{EffectError, ModelChange, unit, wanted};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::positive;
use anergy_prosumer::equipment::EquipmentParams;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PartLoad {
    /// Efficiency, or COP, over what the data say at 20 % of the load; 1 changes nothing.
    #[serde(default = "one")]
    pub factor_20: f64,
    /// The same at 40 %.
    #[serde(default = "one")]
    pub factor_40: f64,
    /// The same at 60 %.
    #[serde(default = "one")]
    pub factor_60: f64,
}

fn one() -> f64 {
    1.0
}

impl PartLoad {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("factor_20", self.factor_20)?;
        positive("factor_40", self.factor_40)?;
        positive("factor_60", self.factor_60)?;
        Ok(self.clone())
    }
}

impl ModelChange for PartLoad {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let now = match unit(model, component, "generator")? {
            EquipmentParams::CondensingBoiler(boiler) => &boiler.part_load_factor,
            EquipmentParams::Chp(engine) => &engine.part_load_factor,
            EquipmentParams::StirlingChp(engine) => &engine.part_load_factor,
            EquipmentParams::AirSourceHeatPump(pump) => &pump.part_load_factor,
            _ => return Err(wanted("generator with an efficiency over its load", component)),
        };
        let own = [self.factor_20, self.factor_40, self.factor_60];
        if own == [1.0; 3] {
            return Ok(Vec::new());
        }
        let of = |(i, factor): (usize, f64)| factor * now.get(i).copied().unwrap_or(1.0);
        let factors: Vec<f64> = own.into_iter().enumerate().map(of).collect();
        let parameter = format!("{component}.part_load_factor");
        Ok(vec![Change::Set { parameter, value: json!(factors) }])
    }
}
