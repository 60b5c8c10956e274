//! T2, conductivity of a storage: heat is conducted along its height better or worse than its data say.
//!
//! **Equation** `lambda = factor lambda0`. What layers mix because they are few is not part of it: take more layers, or plug flow,
//! where the model mixes too much.
//!
//! **Neutral** `factor = 1`. **Looks like** the width of the thermocline, also while nothing flows; a jet (T4) mixes only in flow.

use crate::effect::{EffectError, ModelChange, storage};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::positive;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StorageConductivity {
    /// Vertical conductivity over what the data of the storage say; 1 changes nothing.
    pub factor: f64,
}

impl StorageConductivity {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("factor", self.factor)?;
        Ok(self.clone())
    }
}

impl ModelChange for StorageConductivity {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        storage(model, component)?;
        let parameter = format!("{component}.conductivity_w_m_k");
        Ok(vec![Change::Scale { parameter, factor: self.factor }])
    }
}
