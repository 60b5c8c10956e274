//! The station of a balancing unit: it stands between the lines and takes what comes.
//!
//! ```text
//! cold --stub_cold-- port_cold --interface-- port_hot --stub_hot-- hot                  passive
//! cold --stub_cold-- branch_cold --pump-- port_cold --interface-- port_hot --stub_hot-- hot     pumped
//! ```
//! Passive (system A) the storage itself is the passage, of little resistance. Pumped (system B) there is an exchanger,
//! and a pump that turns both ways makes up for its resistance: it keeps the lines at the same pressure. The flow is
//! the same, that of the sum of the houses.
//!
//! Positive flow is feed-in, from the cold to the hot line. `port_hot` and `port_cold` hold the water of the
//! interface.

use super::station_parts::{Expanded, LONGEST_STEP, Names, PUMP, RESISTANCE, default_volume, stub};
use super::{InterfaceEntry, SiteEntry, StationKind, is_null, station_name};
use crate::document::Tree;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// `[[station]]` with `kind = "balancing_unit"`: the unit stands between the lines and takes what comes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BalancingUnitEntry {
    /// The site it stands at.
    pub site: String,
    /// `balancing_unit`.
    pub kind: StationKind,
    /// Name within its site; another name than "station" also prefixes its parts.
    #[serde(default = "station_name")]
    pub name: String,
    /// Mixed water on either side of the unit, m3.
    #[serde(default = "default_volume")]
    pub volume_m3: f64,
    /// Heat conductance of the water on either side to the surroundings, W/K.
    #[serde(default)]
    pub ua_w_k: f64,
    /// Both connection pipes, each: fields of a pipe, or `pipe` for a named type.
    #[serde(default, skip_serializing_if = "is_null")]
    pub stub: Value,
    /// The passage through the unit: fields of a resistance.
    #[serde(default, skip_serializing_if = "is_null")]
    pub interface: Value,
    /// Whether a pump keeps the lines at the same pressure.
    #[serde(default)]
    pub hydraulics: BalancingHydraulics,
    /// Proportional gain of that pump: speed per Pa. Absent: 2e-5.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
    /// Integral time of that pump, s. Absent: 8.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub integral_time_s: Option<f64>,
    /// That pump: fields of a pump.
    #[serde(default, skip_serializing_if = "is_null")]
    pub pump: Value,
}

/// What makes water pass a balancing unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BalancingHydraulics {
    /// The pumps of the houses (system A).
    #[default]
    Passive,
    /// A pump of its own, which turns both ways (system B).
    Pumped,
}

/// Proportional gain of the pump, speed per Pa.
const GAIN: f64 = 2e-5;
/// Integral time of the pump, s.
const INTEGRAL_TIME_S: f64 = 8.0;

impl BalancingUnitEntry {
    /// What cannot be, with the field and a hint; `step_s` is the longest step of the run.
    pub(super) fn problems(&self, step_s: f64) -> Vec<(&'static str, String, &'static str)> {
        let mut problems = Vec::new();
        let pumped = self.hydraulics == BalancingHydraulics::Pumped;
        for (field, value) in [("gain", self.gain), ("integral_time_s", self.integral_time_s)] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                let message = format!("{field} = {value} must be positive");
                problems.push((field, message, "2e-5 per Pa and 8 s suit most pumps"));
            }
        }
        for (field, given) in [
            ("pump", !self.pump.is_null()),
            ("gain", self.gain.is_some()),
            ("integral_time_s", self.integral_time_s.is_some()),
        ] {
            if given && !pumped {
                let message = format!("a passive balancing unit has no pump, so no {field}");
                problems.push((field, message, "hydraulics = \"pumped\" has it"));
            }
        }
        if self.pump.get("reversible") == Some(&json!(false)) {
            let message = "its pump turns both ways".to_owned();
            problems.push(("pump", message, "leave `reversible` out"));
        }
        let longest_s = LONGEST_STEP * self.integral_time_s.unwrap_or(INTEGRAL_TIME_S);
        if pumped && step_s > longest_s {
            problems.push((
                "hydraulics",
                format!("its pump is controlled in steps up to {longest_s} s, not {step_s} s"),
                "shorten `step` in [run]; a passive unit has the same flow, without the electricity of the pump",
            ));
        }
        problems
    }

    /// The parts of the station.
    pub(super) fn expand(&self, site: &SiteEntry, tree: &Tree, what: &str) -> Expanded {
        let names = Names::new(&self.name, site, tree, what);
        let pumped = self.hydraulics == BalancingHydraulics::Pumped;
        let water = Some((self.volume_m3, self.ua_w_k));
        let mut nodes = vec![names.node("port_hot", water), names.node("port_cold", water)];
        let (branch, resistance) = if pumped {
            nodes.push(names.node("branch_cold", None));
            ("branch_cold", json!({ "kv_m3_h": 4.0 }))
        } else {
            ("port_cold", json!({ "dp_nominal_pa": 500.0, "m_flow_nominal_kg_s": 1.0 }))
        };
        let ends = |from: &str, to: String| (names.inner(from), to);
        let mut edges = vec![
            names.part("stub_hot", "pipe", ends("port_hot", names.line(0)), stub()),
            names.part(
                "interface",
                "resistance",
                ends("port_cold", names.inner("port_hot")),
                names.unless("interface", RESISTANCE, resistance),
            ),
            names.part("stub_cold", "pipe", ends(branch, names.line(1)), stub()),
        ];
        let (mut sensors, mut controllers) = (Vec::new(), Vec::new());
        if pumped {
            let curve = json!({ "head_max_hpa": 402.21, "free_flow_l_min": 55.33 });
            let mut pump = names.unless("pump", PUMP, curve);
            if let Some(fields) = pump.as_object_mut() {
                fields.insert("reversible".to_owned(), json!(true));
            }
            edges.push(names.part("pump", "pump", ends(branch, names.inner("port_cold")), pump));
            let difference = names.inner("pump.lines");
            sensors.push(names.table(vec![
                ("id", json!(difference)),
                ("measures", json!(format!("{}.p_pa", names.line(0)))),
                ("minus", json!(format!("{}.p_pa", names.line(1)))),
            ]));
            controllers.push(names.table(vec![
                ("id", json!(names.inner("pump.balance"))),
                ("kind", json!("pi")),
                ("measures", json!(format!("{difference}.value"))),
                ("acts_on", json!(names.inner("pump.speed"))),
                ("set_point", json!(0.0)),
                ("gain", json!(self.gain.unwrap_or(GAIN))),
                ("integral_time_s", json!(self.integral_time_s.unwrap_or(INTEGRAL_TIME_S))),
            ]));
        }
        let interface = InterfaceEntry {
            edge: names.inner("interface"),
            ..InterfaceEntry::watching(names.id.clone())
        };
        Expanded { nodes, edges, interface, controllers, sensors }
    }
}
