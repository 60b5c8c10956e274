//! `[tolerance]`: how well the numbers of the model are known. It moves nothing in a run; `anergy explain` goes by it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[tolerance]`: how far the numbers of the model may lie from those of the plant without an effect, each anywhere within plus or
/// minus its tolerance. What is not given is known as well as usual (`docs/src/explain.md`). A run does not depend on it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ToleranceEntry {
    /// Length of a pipe, relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<f64>,
    /// Heat loss of a pipe, relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loss: Option<f64>,
    /// Temperature around a pipe, K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surroundings_difference_k: Option<f64>,
    /// Pressure loss of a pipe, relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
    /// Heat transfer between the water and the wall of a pipe, relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub film: Option<f64>,
    /// Head of a pump, relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pump_head: Option<f64>,
    /// Conductance of a heat exchanger, relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exchanger: Option<f64>,
    /// Heat loss of a storage, relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub storage_loss: Option<f64>,
    /// Conduction along the height of a storage, relative: 1 for anything from half to twice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub storage_mixing: Option<f64>,
    /// Efficiency of a generator at all loads, relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub efficiency: Option<f64>,
    /// Efficiency of a generator at each part load by itself, relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part_load: Option<f64>,
    /// Length of the start of a generator, relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<f64>,
    /// Time by which what leaves a generator follows what enters later than in the model, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outlet_lag_s: Option<f64>,
}

impl ToleranceEntry {
    /// Every tolerance by the name of its field.
    fn all(&self) -> [(&'static str, Option<f64>); 13] {
        [
            ("length", self.length),
            ("loss", self.loss),
            ("surroundings_difference_k", self.surroundings_difference_k),
            ("friction", self.friction),
            ("film", self.film),
            ("pump_head", self.pump_head),
            ("exchanger", self.exchanger),
            ("storage_loss", self.storage_loss),
            ("storage_mixing", self.storage_mixing),
            ("efficiency", self.efficiency),
            ("part_load", self.part_load),
            ("start", self.start),
            ("outlet_lag_s", self.outlet_lag_s),
        ]
    }

    /// The problems of its numbers: field, and what is wrong.
    pub(crate) fn problems(&self) -> Vec<(&'static str, String)> {
        let given = self.all().into_iter().filter_map(|(field, value)| Some((field, value?)));
        let mut problems = Vec::new();
        for (field, value) in given {
            // A percentage that was written as it is spoken is far beyond what a tolerance can be.
            let most = if has_unit(field) { f64::INFINITY } else { MOST };
            if value <= 0.0 {
                problems.push((field, format!("{field} = {value} must be positive")));
            } else if value > most {
                let message = format!("{field} = {value} must be at most {most}: 0.05 is 5 %");
                problems.push((field, message));
            }
        }
        problems
    }
}

/// Largest relative tolerance: conduction in a storage may well be four times of what is written.
const MOST: f64 = 3.0;

fn has_unit(field: &str) -> bool {
    field.ends_with("_k") || field.ends_with("_s")
}
