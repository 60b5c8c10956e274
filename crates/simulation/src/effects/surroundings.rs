//! P3, surroundings: it is warmer or colder around a pipe than assumed, or the season arrives later.
//!
//! **Equation** `T_around(t) = T_around,0(t - lag) + difference`.
//!
//! **Neutral** `difference = 0`, `lag = 0`. **Looks like** P2, but does not depend on the level of the water
//! temperature.
//!
//! **Validity** a lag needs a temperature that changes: a schedule or series on the ground, or on the
//! pipe's own surroundings. Until the lag is over, its first value holds.

use crate::effect::{EffectError, ModelChange, pipe};
use crate::model::{DriverSpec, Model};
use crate::overlay::Change;
use anergy_network::two_port::{ElementError, not_negative};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Warmer or colder than this is another climate, K.
const LARGEST_DIFFERENCE_K: f64 = 40.0;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Surroundings {
    /// Added to the temperature around the pipe, K; 0 changes nothing.
    #[serde(default)]
    pub difference_k: f64,
    /// How much later than assumed the temperature arrives, s; 0 changes nothing.
    #[serde(default)]
    pub lag_s: f64,
}

impl Surroundings {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        not_negative("lag_s", self.lag_s)?;
        if self.difference_k.abs() > LARGEST_DIFFERENCE_K || self.difference_k.is_nan() {
            let requirement = "must lie between -40 and 40";
            let (field, value) = ("difference_k", self.difference_k);
            return Err(ElementError::OutOfRange { field, value, requirement }.into());
        }
        Ok(self.clone())
    }

    /// What drives the surroundings, later.
    fn delayed(
        &self,
        component: &str,
        own: &str,
        model: &Model,
    ) -> Result<DriverSpec, EffectError> {
        let driver = |name: &str| model.drivers.iter().find(|driver| driver.signal == name);
        let around = match pipe(model, component)?.surroundings_k {
            Some(_) => driver(own),
            None => driver("ground.temperature_k"),
        };
        let mut driver = around.cloned().ok_or_else(|| EffectError::Needs {
            field: "lag_s",
            value: self.lag_s,
            problem: format!(
                "needs a temperature that changes, and what is around \"{component}\" is constant"
            ),
        })?;
        driver.signal = own.into();
        driver.times_s = driver.times_s.iter().map(|time_s| time_s + self.lag_s).collect();
        Ok(driver)
    }
}

impl ModelChange for Surroundings {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let difference_k = pipe(model, component)?.surroundings_difference_k + self.difference_k;
        let mut changes = vec![Change::Set {
            parameter: format!("{component}.surroundings_difference_k"),
            value: json!(difference_k),
        }];
        if self.lag_s > 0.0 {
            let own = format!("{component}.surroundings_k");
            let driver = self.delayed(component, &own, model)?;
            let around_k =
                pipe(model, component)?.surroundings_k.unwrap_or(model.ground.temperature_k);
            changes.push(Change::Set { parameter: own, value: json!(around_k) });
            changes.push(Change::Drive { driver });
        }
        Ok(changes)
    }
}
