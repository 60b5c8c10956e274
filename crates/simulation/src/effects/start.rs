//! G3, start: a generator takes longer to its full heat than its data say, and an engine takes heat for itself.
//!
//! **Equation** the times of the table of the start times `time_factor`; `energy` more of warm-up of a cold engine, falling to nothing over its
//! warm-up time as what it has.
//!
//! **Neutral** `time_factor = 1`, `energy = 0`. **Looks like** an area after each start, nothing in steady operation; a slow sensor
//! (S4) is slow at all steps.

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
pub struct Start {
    /// Length of a start over what the data say; 1 changes nothing.
    #[serde(default = "one")]
    pub time_factor: f64,
    /// Heat that a cold engine takes for itself besides, J; 0 changes nothing.
    #[serde(default)]
    pub energy_j: f64,
}

fn one() -> f64 {
    1.0
}

impl Start {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        positive("time_factor", self.time_factor)?;
        not_negative("energy_j", self.energy_j)?;
        Ok(self.clone())
    }
}

impl ModelChange for Start {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let name = |field: &str| format!("{component}.{field}");
        let scale = |field| Change::Scale { parameter: name(field), factor: self.time_factor };
        let stretched = |times_s: &[f64]| {
            let times_s: Vec<f64> = times_s.iter().map(|t_s| self.time_factor * t_s).collect();
            Change::Set { parameter: name("start_times_s"), value: json!(times_s) }
        };
        let generator = unit(model, component, "generator")?;
        if self.energy_j > 0.0 && !matches!(generator, EquipmentParams::Chp(_)) {
            let problem = "is of an engine (chp)".to_owned();
            return Err(EffectError::Needs { field: "energy_j", value: self.energy_j, problem });
        }
        match generator {
            EquipmentParams::AirSourceHeatPump(pump) => Ok(vec![stretched(&pump.start_times_s)]),
            EquipmentParams::CondensingBoiler(boiler) if !boiler.start_times_s.is_empty() => {
                Ok(vec![stretched(&boiler.start_times_s)])
            }
            EquipmentParams::BrineHeatPump(_) | EquipmentParams::BoosterHeatPump(_) => {
                Ok(vec![scale("start_s")])
            }
            EquipmentParams::Chp(engine) => {
                let mut changes = vec![scale("start_s"), scale("warm_start_s")];
                if self.energy_j > 0.0 {
                    // A warm-up that falls from `W` to nothing takes `W t/2`, of an engine of this size.
                    let per_w = 0.5 * engine.warm_up_s * engine.size_of_measured();
                    let value = json!(engine.warm_up_w() + self.energy_j / per_w);
                    changes.push(Change::Set { parameter: name("warm_up_w"), value });
                }
                Ok(changes)
            }
            _ => Err(wanted("generator with a start of its own", component)),
        }
    }
}
