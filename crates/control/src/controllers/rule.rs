//! One row of a table of rules: a device is on from one condition until another one, with a lock for its safety, alone or as
//! a backup behind what an energy management wants.
//!
//! **Equation** on where `on` holds, off where `off` holds, in between as before; where both hold it is off. Without `off`
//! it is on exactly while `on` holds. While locked (from `lock` until `unlock`, without `unlock` while `lock` holds) the output
//! is the safe one, and off is where it begins anew. As a backup the output is what is `wanted`, unless the rule is on and asks for
//! more of its own direction (from `off_output` to `on_output`). A value that is wanted outside of its limits, or that nobody
//! has renewed for `timeout_s` (the signal `heartbeat` did not change), is replaced by the safe output.
//!
//! **Assumptions** rules see what the rules before them have decided in the same update. **Validity** one output.
//! **Sources** `zinsmeister2022` (rules of the laboratory houses), `zinsmeister2024` (backup behind an energy management).

use crate::condition::{Condition, ON};
use crate::controller::{
    Balance, ControlError, Controller, Inputs, Ports, SetPoint, StateChannel, Timing, not_negative,
    positive,
};

mod params;

pub use params::{Role, RuleParams};

pub(super) const PORTS: Ports = Ports { measures: &[], acts_on: &["acts_on"] };

/// A rule ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    params: RuleParams,
    on: Condition,
    off: Option<Condition>,
    lock: Option<Condition>,
    unlock: Option<Condition>,
    safe: f64,
    wanted: f64,
    wanted_limits: (f64, f64),
}

/// Places in its state: whether it is on, locked, overrides what is wanted, refuses it, has lost the connection; how often
/// and for how long it has overridden; the heartbeat, and for how long it has not changed, s.
const IS_ON: usize = 0;
const LOCKED: usize = 1;
const OVERRIDES: usize = 2;
const REFUSES: usize = 3;
const LOST: usize = 4;
const COUNT: usize = 5;
const OVERRIDDEN_S: usize = 6;
const BEAT: usize = 7;
const SILENT_S: usize = 8;
const LENGTH: usize = 9;

const CHANNELS: [StateChannel; 7] = [
    StateChannel { name: ON, unit: "1", place: IS_ON, event: None },
    StateChannel { name: "locked", unit: "1", place: LOCKED, event: Some(["locked", "unlocked"]) },
    StateChannel {
        name: "overrides",
        unit: "1",
        place: OVERRIDES,
        event: Some(["overridden", "override_ended"]),
    },
    StateChannel {
        name: "refused",
        unit: "1",
        place: REFUSES,
        event: Some(["set_point_refused", "set_point_accepted"]),
    },
    StateChannel {
        name: "lost",
        unit: "1",
        place: LOST,
        event: Some(["connection_lost", "connection_found"]),
    },
    StateChannel { name: "override_count", unit: "1", place: COUNT, event: None },
    StateChannel { name: "overridden_s", unit: "s", place: OVERRIDDEN_S, event: None },
];
/// Of a rule without backup.
const OF_RULE: usize = 2;

const WANTED: usize = 0;
const BACKUP: usize = 1;
const HEARTBEAT: usize = 2;

impl RuleParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that cannot be.
    pub fn build(&self, _context: &()) -> Result<Rule, ControlError> {
        not_negative("interval_s", self.interval_s)?;
        not_negative("offset_s", self.offset_s)?;
        let mut names = Vec::new();
        let mut read = |field: &'static str, text: &str| {
            Condition::parse(text, &mut names).map_err(|error| ControlError::Fields {
                field,
                problem: format!("{field} = \"{text}\": {error}"),
            })
        };
        let on = read("on", &self.on)?;
        let mut optional = |field, text: &Option<String>| {
            text.as_deref().map(|text| read(field, text)).transpose()
        };
        let off = optional("off", &self.off)?;
        let lock = optional("lock", &self.lock)?;
        let unlock = optional("unlock", &self.unlock)?;
        let fields =
            |field, problem: &str| Err(ControlError::Fields { field, problem: problem.into() });
        if self.on_output == self.off_output {
            let (field, value) = ("on_output", self.on_output);
            let requirement = "must differ from off_output";
            return Err(ControlError::OutOfRange { field, value, requirement });
        }
        if off.is_some() && self.off.as_deref().map(str::trim) == Some(self.on.trim()) {
            return fields("off", "off is the same as on: it would never be on");
        }
        if unlock.is_some() && lock.is_none() {
            return fields("unlock", "unlock without lock: nothing locks it");
        }
        let backup = self.role == Role::Backup;
        for (field, given) in [
            ("wanted", self.wanted),
            ("wanted_min", self.wanted_min),
            ("wanted_max", self.wanted_max),
            ("timeout_s", self.timeout_s),
        ] {
            if given.is_some() && !backup {
                return fields(field, "only a rule with role = \"backup\" is told what is wanted");
            }
        }
        if let Some(timeout_s) = self.timeout_s {
            positive("timeout_s", timeout_s)?;
        }
        let (least, most) =
            (self.on_output.min(self.off_output), self.on_output.max(self.off_output));
        let limits = (self.wanted_min.unwrap_or(least), self.wanted_max.unwrap_or(most));
        if limits.0.is_nan() || limits.1.is_nan() || limits.0 >= limits.1 {
            let (field, value) = ("wanted_min", limits.0);
            let requirement = "must be below wanted_max";
            return Err(ControlError::OutOfRange { field, value, requirement });
        }
        let wanted = self.wanted.unwrap_or(self.off_output);
        if backup && !(limits.0..=limits.1).contains(&wanted) {
            let requirement = "must lie between wanted_min and wanted_max";
            return Err(ControlError::OutOfRange { field: "wanted", value: wanted, requirement });
        }
        Ok(Rule {
            params: self.clone(),
            on,
            off,
            lock,
            unlock,
            safe: self.safe_output.unwrap_or(self.off_output),
            wanted,
            wanted_limits: limits,
        })
    }
}

/// Whether what begins with one condition and ends with another one is on; without the other one it ends with the first.
fn latched(was: bool, begins: &Condition, ends: Option<&Condition>, measured: &[f64]) -> bool {
    let begins = begins.holds(measured);
    match ends {
        None => begins,
        Some(ends) => !ends.holds(measured) && (was || begins),
    }
}

impl Rule {
    /// Its conditions, with their fields.
    pub fn conditions(&self) -> impl Iterator<Item = (&'static str, &Condition)> {
        let all = [
            ("on", Some(&self.on)),
            ("off", self.off.as_ref()),
            ("lock", self.lock.as_ref()),
            ("unlock", self.unlock.as_ref()),
        ];
        all.into_iter().filter_map(|(field, condition)| Some((field, condition?)))
    }

    fn is_backup(&self) -> bool {
        self.params.role == Role::Backup
    }

    fn own_output(&self, on: bool) -> f64 {
        if on { self.params.on_output } else { self.params.off_output }
    }

    /// What is wanted of a backup now, and whether it counts.
    fn heard(&self, dt_s: f64, set_points: &[f64], state: &mut [f64]) -> f64 {
        if set_points[HEARTBEAT] == state[BEAT] {
            state[SILENT_S] += dt_s;
        } else {
            (state[BEAT], state[SILENT_S]) = (set_points[HEARTBEAT], 0.0);
        }
        let lost = self.params.timeout_s.is_some_and(|timeout_s| state[SILENT_S] > timeout_s);
        let (least, most) = self.wanted_limits;
        let refused = !(least..=most).contains(&set_points[WANTED]);
        state[LOST] = f64::from(u8::from(lost));
        state[REFUSES] = f64::from(u8::from(refused));
        if lost || refused { self.safe } else { set_points[WANTED] }
    }
}

impl Controller for Rule {
    fn timing(&self) -> Timing {
        Timing { interval_s: self.params.interval_s, offset_s: self.params.offset_s }
    }

    fn set_points(&self) -> Vec<SetPoint> {
        if !self.is_backup() {
            return Vec::new();
        }
        let point = |name, value| SetPoint { name, unit: "", value };
        vec![point("wanted", self.wanted), point("backup", 1.0), point("heartbeat", 0.0)]
    }

    fn initial_state(&self) -> Vec<f64> {
        let mut state = vec![0.0; LENGTH];
        state[IS_ON] = f64::from(u8::from(self.params.initially_on));
        state
    }

    fn channels(&self) -> &'static [StateChannel] {
        if self.is_backup() { &CHANNELS } else { &CHANNELS[..OF_RULE] }
    }

    fn says(&self, event: &str, inputs: &Inputs, outputs: &[f64]) -> String {
        let p = &self.params;
        let given =
            outputs.first().map_or(String::new(), |output| format!(", its output is {output}"));
        let wanted = inputs.set_points.get(WANTED).copied().unwrap_or(f64::NAN);
        match event {
            "locked" => format!("locked by {}{given}", p.lock.as_deref().unwrap_or_default()),
            "unlocked" => format!("free again{given}"),
            "overridden" => format!("{wanted} is wanted, the rule asks for more ({}){given}", p.on),
            "override_ended" => format!("the rule asks for no more{given}"),
            "set_point_refused" => format!(
                "{wanted} is wanted, which is outside {} to {}{given}",
                self.wanted_limits.0, self.wanted_limits.1
            ),
            "set_point_accepted" => format!("{wanted} is wanted, which can be{given}"),
            "connection_lost" => format!(
                "the signal heartbeat has not changed for {} s{given}",
                p.timeout_s.unwrap_or_default()
            ),
            _ => format!("the signal heartbeat changes again{given}"),
        }
    }

    fn output_limits(&self, _output: usize, actuator: (f64, f64)) -> (f64, f64) {
        actuator
    }

    fn update(
        &self,
        dt_s: f64,
        inputs: &Inputs,
        state: &mut [f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError> {
        let inputs = inputs.checked()?;
        let locked = self.lock.as_ref().is_some_and(|lock| {
            latched(state[LOCKED] > 0.5, lock, self.unlock.as_ref(), inputs.measured)
        });
        let on = latched(state[IS_ON] > 0.5, &self.on, self.off.as_ref(), inputs.measured);
        let on = on && !locked;
        state[LOCKED] = f64::from(u8::from(locked));
        state[IS_ON] = f64::from(u8::from(on));
        let mut output = self.own_output(on);
        if self.is_backup() {
            let was = state[OVERRIDES] > 0.5;
            if was {
                state[OVERRIDDEN_S] += dt_s;
            }
            let wanted = self.heard(dt_s, inputs.set_points, state);
            let direction = self.params.on_output - self.params.off_output;
            let more = (output - wanted) * direction > 0.0;
            let overrides = on && more && inputs.set_points[BACKUP] > 0.5;
            state[OVERRIDES] = f64::from(u8::from(overrides));
            if overrides && !was {
                state[COUNT] += 1.0;
            }
            if !overrides {
                output = wanted;
            }
        }
        if locked {
            state[OVERRIDES] = 0.0;
            output = self.safe;
        }
        if let Some(first) = outputs.first_mut() {
            *first = output;
        }
        Ok(())
    }

    fn balance(&self, _inputs: &Inputs, outputs: &[f64], balance: &mut [Balance]) {
        // It has no steady state: it stays as it starts.
        let stays =
            if self.is_backup() { self.wanted } else { self.own_output(self.params.initially_on) };
        if let (Some(output), Some(balance)) = (outputs.first(), balance.first_mut()) {
            *balance = Balance { miss: stays - output, scale: 1.0 };
        }
    }

    fn rest(&self, _inputs: &Inputs, _outputs: &[f64], state: &mut [f64]) {
        state.copy_from_slice(&self.initial_state());
    }

    fn tracks(&self) -> bool {
        false
    }

    fn gain(&self) -> f64 {
        0.0
    }
}

#[cfg(test)]
#[path = "rule/tests.rs"]
mod tests;
