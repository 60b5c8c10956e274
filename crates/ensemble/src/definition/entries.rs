//! The entries of the file of variations.

use anergy_simulation::model_file::{Duration, StepEntry};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// How members are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Design {
    /// Every value of every variation with every other one; the last variation changes fastest.
    #[default]
    Grid,
    /// The first values of all variations, then the second ones, ...
    List,
    /// Independent draws.
    MonteCarlo,
    /// Draws that meet every one of as many equally probable intervals as there are members once.
    LatinHypercube,
    /// Given points of the unit cube, such as those of a sensitivity analysis.
    Points,
}

/// Which random numbers members draw, where the model has some (weather, hot water, noise of sensors, ...).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Random {
    /// All draw those of the model.
    Same,
    /// Each draws its own, told by the seed of the ensemble and the number of the member.
    Own,
}

/// `[ensemble]`: how members are chosen.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EnsembleEntry {
    /// How members are chosen.
    #[serde(default)]
    pub design: Design,
    /// How many, in samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub members: Option<usize>,
    /// Start of the random numbers of samples.
    #[serde(default)]
    pub seed: u32,
    /// Which random numbers members draw; absent: their own in samples, the same in grids, lists and points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub random: Option<Random>,
    /// Points of the unit cube: a row per member, a number between 0 and 1 per variation; points.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<Vec<f64>>,
}

/// `[run]`: what replaces the `[run]` of the model.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RunEntry {
    /// End of each run, for example "1d".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<Duration>,
    /// Largest time step, for example "1s", or "auto".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<StepEntry>,
    /// Time between recorded rows, for example "1h".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub record: Option<Duration>,
}

/// `[keep]`: what is kept of each run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KeepEntry {
    /// Indicators by name; `*` is any text. Absent: all.
    #[serde(default = "everything")]
    pub kpis: Vec<String>,
    /// Channels by name, component or with `*`: their recorded rows. Absent: none.
    #[serde(default)]
    pub channels: Vec<String>,
}

fn everything() -> Vec<String> {
    vec!["*".to_owned()]
}

impl Default for KeepEntry {
    fn default() -> Self {
        Self { kpis: everything(), channels: Vec::new() }
    }
}

/// What is done with a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum How {
    /// The parameter gets it.
    #[default]
    Set,
    /// The parameter is multiplied by it.
    Scale,
}

/// A `[[variation]]`: a parameter, or several that change together, and its values.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VariationEntry {
    /// What its column is called; absent: the parameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// `component.field` of the model, in any unit of the field; `*` is any text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameter: Option<String>,
    /// Several of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<String>,
    /// Whether values are set, or multiply those of the model.
    #[serde(default)]
    pub how: How,
    /// Values that are listed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values: Option<Vec<Value>>,
    /// Smallest value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    /// Largest value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
    /// How many values a grid has from `low` to `high`, ends included.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<usize>,
    /// Most frequent value of a triangular distribution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode: Option<f64>,
    /// Mean of a normal distribution; `low` and `high` cut it off where they are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean: Option<f64>,
    /// Standard deviation of a normal distribution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub standard_deviation: Option<f64>,
}

/// The whole file, for its JSON Schema.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VariationsFile {
    /// Version of the grammar: 1.
    pub format: u32,
    /// How members are chosen.
    #[serde(default)]
    pub ensemble: EnsembleEntry,
    /// What replaces the `[run]` of the model.
    #[serde(default)]
    pub run: RunEntry,
    /// What is kept of each run.
    #[serde(default)]
    pub keep: KeepEntry,
    /// What is varied.
    #[serde(default)]
    pub variation: Vec<VariationEntry>,
}
