//! T4, inlet jet: water that enters a storage mixes with the layers beside its inlet by its momentum.
//!
//! **Equation** `m_e = share m/(1 + Ri/Ri_c)` is exchanged with each neighbour, `Ri = g beta |T_in - T_l| d/v^2` with the diameter of
//! the ports, `port_diameter`.
//!
//! **Neutral** `share = 0`. **Looks like** mixing after steps of flow or temperature; conductivity (T2) also mixes at rest.

use crate::effect::{EffectError, ModelChange, storage};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::two_port::{not_negative, positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InletJet {
    /// Share of the water that enters which mixes with each neighbouring layer; 0 changes nothing.
    pub share: f64,
    /// Richardson number at which half of that is left.
    #[serde(default = "one")]
    pub richardson: f64,
}

fn one() -> f64 {
    1.0
}

impl InletJet {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        not_negative("share", self.share)?;
        positive("richardson", self.richardson)?;
        Ok(self.clone())
    }
}

impl ModelChange for InletJet {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let jet_share = storage(model, component)?.jet_share + self.share;
        if self.share == 0.0 {
            return Ok(Vec::new());
        }
        let set =
            |field: &str, value| Change::Set { parameter: format!("{component}.{field}"), value };
        Ok(vec![set("jet_share", json!(jet_share)), set("jet_richardson", json!(self.richardson))])
    }
}
