//! G7, metal of a generator: what it has stored while it was idle, or while the return changed, comes out with the water.
//!
//! **Equation** `C dT/dt = -m cp (1 - exp(-K/(m cp))) (T - T_in)`, beside what start and stop of the model show.
//!
//! **Neutral** `capacity_j_k = 0`. **Looks like** the first minutes after a pause are too warm or too cold, however long a start takes
//! (G3); heat out of an idle generator through which water passes (H1).

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
pub struct Metal {
    /// Heat capacity of metal beside what the model has, J/K; 0 changes nothing.
    pub capacity_j_k: f64,
    /// Conductance between metal and water, W/K.
    #[serde(default = "usual")]
    pub conductance_w_k: f64,
}

fn usual() -> f64 {
    100.0
}

impl Metal {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        not_negative("capacity_j_k", self.capacity_j_k)?;
        positive("conductance_w_k", self.conductance_w_k)?;
        Ok(self.clone())
    }
}

impl ModelChange for Metal {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let EquipmentParams::CondensingBoiler(boiler) = unit(model, component, "boiler")? else {
            return Err(wanted("boiler", component));
        };
        if self.capacity_j_k == 0.0 {
            return Ok(Vec::new());
        }
        let set = |field: &str, value: f64| Change::Set {
            parameter: format!("{component}.{field}"),
            value: json!(value),
        };
        Ok(vec![
            set("metal_capacity_j_k", boiler.metal_capacity_j_k + self.capacity_j_k),
            set("metal_conductance_w_k", self.conductance_w_k),
        ])
    }
}
