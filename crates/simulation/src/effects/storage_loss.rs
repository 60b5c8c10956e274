//! T1, loss of a storage: it loses more or less heat than its data say.
//!
//! **Equation** `UA = factor UA0`, envelope and bridges.
//!
//! **Neutral** `factor = 1`. **Looks like** a decay in standby; the temperature around (P3) looks the same in one state and
//! differs over several.

use crate::effect::{EffectError, ModelChange, storage};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::positive;
use anergy_prosumer::equipment::storage::U_W_M2_K;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StorageLoss {
    /// Heat loss over what the data of the storage say; 1 changes nothing.
    pub factor: f64,
}

impl StorageLoss {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("factor", self.factor)?;
        Ok(self.clone())
    }
}

impl ModelChange for StorageLoss {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let storage = storage(model, component)?;
        if self.factor == 1.0 {
            return Ok(Vec::new());
        }
        let set =
            |field: &str, value| Change::Set { parameter: format!("{component}.{field}"), value };
        let bridges: Vec<f64> = storage.bridges_w_k.iter().map(|w_k| self.factor * w_k).collect();
        let envelope = match (storage.ua_w_k, storage.u_w_m2_k) {
            (Some(ua_w_k), _) => set("ua_w_k", json!(self.factor * ua_w_k)),
            (None, u_w_m2_k) => set("u_w_m2_k", json!(self.factor * u_w_m2_k.unwrap_or(U_W_M2_K))),
        };
        Ok(vec![envelope, set("bridges_w_k", json!(bridges))])
    }
}
