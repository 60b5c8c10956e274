//! A rule as written in a model file.

use crate::condition::Condition;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

fn one() -> f64 {
    1.0
}

/// Whether a rule decides, or only helps out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Its output is that of the rule.
    #[default]
    Rule,
    /// Its output is what is wanted, unless the rule asks for more.
    Backup,
}

/// A rule as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RuleParams {
    /// When it goes on, for example "storage.soc < 0.6 and storage.t_8_k < 65 degC".
    pub on: String,
    /// When it goes off, for example "storage.t_3_k > 70 degC". Absent: where `on` does not hold.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub off: Option<String>,
    /// When it is locked for safety.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lock: Option<String>,
    /// When the lock is released. Absent: where `lock` does not hold.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unlock: Option<String>,
    /// Output while on.
    #[serde(default = "one")]
    pub on_output: f64,
    /// Output while off.
    #[serde(default)]
    pub off_output: f64,
    /// Output while locked, and instead of what must not be wanted. Absent: that of off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub safe_output: Option<f64>,
    /// On at the start of a run.
    #[serde(default)]
    pub initially_on: bool,
    /// Whether it decides, or only helps out behind what an energy management wants.
    #[serde(default)]
    pub role: Role,
    /// Output that is wanted while nothing drives the signal; for a backup. Absent: that of off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wanted: Option<f64>,
    /// The smallest value that may be wanted; for a backup. Absent: the smaller of both outputs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wanted_min: Option<f64>,
    /// The largest value that may be wanted; for a backup. Absent: the larger of both outputs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wanted_max: Option<f64>,
    /// What is wanted counts no more where the signal `heartbeat` has not changed for so long, s; for a backup.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timeout_s: Option<f64>,
    /// Time between two updates, s; 0 updates at every step.
    #[serde(default)]
    pub interval_s: f64,
    /// Time of the first update, s.
    #[serde(default)]
    pub offset_s: f64,
}

impl RuleParams {
    /// The conditions that are given, with their fields.
    pub fn texts(&self) -> impl Iterator<Item = (&'static str, &str)> {
        [
            ("on", Some(self.on.as_str())),
            ("off", self.off.as_deref()),
            ("lock", self.lock.as_deref()),
            ("unlock", self.unlock.as_deref()),
        ]
        .into_iter()
        .filter_map(|(field, text)| Some((field, text?)))
    }

    /// The channels that its conditions need, each with the field that names it first; those of a text that cannot be read
    /// are left out.
    pub fn measures(&self) -> Vec<(&'static str, String)> {
        let mut all = Vec::new();
        let mut fields = Vec::new();
        for (field, text) in self.texts() {
            let mut with = all.clone();
            if Condition::parse(text, &mut with).is_ok() {
                all = with;
            }
            fields.resize(all.len(), field);
        }
        fields.into_iter().zip(all).collect()
    }
}
