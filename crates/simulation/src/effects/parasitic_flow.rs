//! H1, parasitic flow: water passes a generator that is off, because nothing closes its branch.
//!
//! **Equation** the conductance of the branch of a coupling while its pump is off is `opening` times that in operation, at least
//! that of the model: `R_off = R/opening^2`.
//!
//! **Neutral** `opening = 0`. **Looks like** the outlet of the idle generator follows the loop, its heat is drawn off, the supply of
//! the heating falls; only while another pump runs. A leaking valve (H4) looks the same: this is the same with more.

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
pub struct ParasiticFlow {
    /// Conductance of the branch while its pump is off, as a share of that in operation; 0 changes nothing.
    pub opening: f64,
}

impl ParasiticFlow {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        let (value, requirement) = (self.opening, "must lie between 0 and 1");
        if !(0.0..=1.0).contains(&value) {
            return Err(ElementError::OutOfRange { field: "opening", value, requirement }.into());
        }
        Ok(self.clone())
    }
}

impl ModelChange for ParasiticFlow {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let opening = branch(model, component)?.idle_opening.max(self.opening);
        let parameter = format!("{component}.idle_opening");
        Ok(vec![Change::Set { parameter, value: json!(opening) }])
    }
}
