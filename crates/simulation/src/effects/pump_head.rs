//! H3, head of a pump: it delivers less or more pressure than its curve says, so that others block it sooner or later.
//!
//! **Equation** `H = factor H0(m)` at every speed.
//!
//! **Neutral** `factor = 1`. **Looks like** no flow at high speed while another pump runs; a stuck valve looks the same until the
//! pressure difference over the pump is measured.

use crate::effect::{EffectError, ModelChange, wanted};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::elements::ElementParams;
use anergy_network::two_port::positive;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PumpHead {
    /// Head over the curve of the pump; 1 changes nothing.
    pub factor: f64,
}

impl PumpHead {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("factor", self.factor)?;
        Ok(self.clone())
    }
}

impl ModelChange for PumpHead {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let Some(ElementParams::Pump(pump)) = model.edge(component).map(|edge| &edge.params) else {
            return Err(wanted("pump", component));
        };
        let name = |field: &str| format!("{component}.{field}");
        let list = |field: &str, values: &[f64]| {
            let values: Vec<f64> = values.iter().map(|value| self.factor * value).collect();
            Change::Set { parameter: name(field), value: json!(values) }
        };
        Ok(if !pump.curve_head_pa.is_empty() {
            vec![list("curve_head_pa", &pump.curve_head_pa)]
        } else if !pump.curve_polynomial.is_empty() {
            vec![list("curve_polynomial", &pump.curve_polynomial)]
        } else {
            vec![Change::Scale { parameter: name("head_max_pa"), factor: self.factor }]
        })
    }
}
