//! X1, fouling: a heat exchanger transfers less than its data say.
//!
//! **Equation** `UA = factor UA0`, of an exchanger of the network, a direct exchanger of a house or that of a balancing unit.
//!
//! **Neutral** `factor = 1`. **Looks like** an approach that grows with the load on both sides.

use crate::effect::{EffectError, ModelChange, wanted};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::elements::ElementParams;
use anergy_network::two_port::positive;
use anergy_prosumer::equipment::EquipmentParams;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fouling {
    /// Conductance over what the data of the exchanger say; 1 changes nothing.
    pub factor: f64,
}

impl Fouling {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("factor", self.factor)?;
        Ok(self.clone())
    }
}

impl ModelChange for Fouling {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let edge = model.edge(component).map(|edge| &edge.params);
        let unit = model.units.iter().find(|unit| unit.id == component).map(|unit| &unit.params);
        match (edge, unit) {
            (Some(ElementParams::HeatExchanger(_)), _)
            | (
                _,
                Some(EquipmentParams::DirectExchanger(_) | EquipmentParams::BalancingExchanger(_)),
            ) => {}
            _ => return Err(wanted("heat_exchanger", component)),
        }
        let parameter = format!("{component}.ua_w_k");
        Ok(vec![Change::Scale { parameter, factor: self.factor }])
    }
}
