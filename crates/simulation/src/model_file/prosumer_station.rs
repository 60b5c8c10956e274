//! The station of a prosumer: the water of the grid passes the unit itself.
//!
//! It has a pump for each direction, or a valve for extraction where the hot line is under pressure:
//!
//! ```text
//! hot --stub_hot-- port_hot --interface-- port_cold --+-- feed_in_check_valve -- feed_in_pump -- feed_in_shut_off --+
//!                                                     |                                                             |
//!                                                     +-- extraction_shut_off -- extraction_pump -- extraction_check_valve
//!                                                                                                                   |
//! cold -------------------------------------------stub_cold-------------------------------------------------branch_cold
//! ```
//! The shut-off valves are needed: a check valve opens for what other pumps send through an idle one, be it the
//! neighbour of the opposite direction or one of another house. With an extraction valve there are none.
//!
//! Positive flow is feed-in, from the cold to the hot line. `port_hot` and `port_cold` hold the water of the
//! interface.

use super::expand::Plain;
use super::station_parts::{Expanded, LONGEST_STEP, Names, PUMP, RESISTANCE, default_volume, stub};
use super::{InterfaceEntry, SiteEntry, StationKind, is_null, station_name};
use crate::document::Tree;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// `[[station]]` with `kind = "prosumer"`: pumps deliver the flow that the unit asks for, in its direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProsumerEntry {
    /// The site it stands at.
    pub site: String,
    /// `prosumer`.
    pub kind: StationKind,
    /// Name within its site; another name than "station" also prefixes its parts.
    #[serde(default = "station_name")]
    pub name: String,
    /// The directions it can deliver.
    #[serde(default)]
    pub directions: Directions,
    /// What makes the flow of extraction: a pump, or a valve where the hot line is under pressure.
    #[serde(default)]
    pub extraction: Extraction,
    /// A pump for each direction, or one between two three-way valves.
    #[serde(default)]
    pub hydraulics: Hydraulics,
    /// How the flow is held. Absent: `pi` in steps up to a quarter of the integral time, else `quasi_steady`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_control: Option<FlowControl>,
    /// Proportional gain of the PI control: speed or opening per kg/s.
    #[serde(default = "default_gain")]
    pub gain: f64,
    /// Integral time of the PI control, s.
    #[serde(default = "default_integral_time")]
    pub integral_time_s: f64,
    /// Pause of the PI control when the direction changes, s.
    #[serde(default = "default_dead_time")]
    pub dead_time_s: f64,
    /// Mixed water on either side of the unit, m3.
    #[serde(default = "default_volume")]
    pub volume_m3: f64,
    /// Heat conductance of the water on either side to the surroundings, W/K.
    #[serde(default)]
    pub ua_w_k: f64,
    /// Node of the grid that stands for the hot line. Absent: that of the site.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hot: Option<String>,
    /// Node of the grid that stands for the cold line. Absent: that of the site.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cold: Option<String>,
    /// Both house connection pipes, each: fields of a pipe, or `pipe` for a named type.
    #[serde(default, skip_serializing_if = "is_null")]
    pub stub: Value,
    /// The passage through the unit: fields of a resistance.
    #[serde(default, skip_serializing_if = "is_null")]
    pub interface: Value,
    /// The feed-in pump: fields of a pump.
    #[serde(default, skip_serializing_if = "is_null")]
    pub feed_in_pump: Value,
    /// The check valve behind it: fields of a check_valve.
    #[serde(default, skip_serializing_if = "is_null")]
    pub feed_in_check_valve: Value,
    /// The valve that shuts the idle pumps off from each other, each: fields of a ball_valve.
    #[serde(default, skip_serializing_if = "is_null")]
    pub shut_off: Value,
    /// The extraction pump: fields of a pump.
    #[serde(default, skip_serializing_if = "is_null")]
    pub extraction_pump: Value,
    /// The check valve behind it: fields of a check_valve.
    #[serde(default, skip_serializing_if = "is_null")]
    pub extraction_check_valve: Value,
    /// The extraction valve: fields of a valve, or of a flow_limiter where it is quasi-steady.
    #[serde(default, skip_serializing_if = "is_null")]
    pub extraction_valve: Value,
    /// The one pump of both directions: fields of a pump.
    #[serde(default, skip_serializing_if = "is_null")]
    pub pump: Value,
    /// The check valve behind it: fields of a check_valve.
    #[serde(default, skip_serializing_if = "is_null")]
    pub check_valve: Value,
    /// The four ways of the three-way valves around it, each: fields of a valve.
    #[serde(default, skip_serializing_if = "is_null")]
    pub way: Value,
}

/// The directions of a prosumer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Directions {
    /// Feed-in and extraction.
    #[default]
    Both,
    /// Only from the cold to the hot line.
    FeedIn,
    /// Only from the hot to the cold line.
    Extraction,
}

/// What makes the flow of extraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Extraction {
    /// A pump.
    #[default]
    Pump,
    /// A valve: the lines must give the pressure difference.
    Valve,
}

/// What makes the flow of a prosumer in both directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Hydraulics {
    /// A pump for each direction, or an extraction valve.
    #[default]
    TwoPumps,
    /// One pump between two three-way valves.
    OnePump,
}

/// How a prosumer holds the flow that its unit asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FlowControl {
    /// A PI controller of the speed or opening.
    Pi,
    /// At once, within what the curve at full speed or the open valve allows.
    QuasiSteady,
    /// At once and whatever head it takes: flow sources instead of pumps and valves, for long runs of many houses.
    Ideal,
}

fn default_gain() -> f64 {
    // 0.01 per l/min
    0.6
}

fn default_integral_time() -> f64 {
    8.0
}

fn default_dead_time() -> f64 {
    5.0
}

/// Flow sources for the directions that are there: feed-in, extraction.
fn ideal(
    names: &Names<'_>,
    nodes: Vec<Plain>,
    mut edges: Vec<Plain>,
    (feeds_in, extracts): (bool, bool),
) -> Expanded {
    let mut source = |part: &'static str, from: &str, to: &str| {
        let ends = (names.inner(from), names.inner(to));
        edges.push(names.part(part, "flow_source", ends, json!({})));
        names.inner(&format!("{part}.m_flow_set_kg_s"))
    };
    let interface = InterfaceEntry {
        edge: names.inner("interface"),
        feed_in_set: feeds_in.then(|| source("feed_in_source", "branch_cold", "port_cold")),
        extraction_set: extracts.then(|| source("extraction_source", "port_cold", "branch_cold")),
        ..InterfaceEntry::watching(names.id.clone())
    };
    Expanded { nodes, edges, interface, controllers: Vec::new(), sensors: Vec::new() }
}

impl ProsumerEntry {
    /// The longest step that its control follows, s.
    pub(super) fn longest_step_s(&self, control: FlowControl) -> Option<f64> {
        (control == FlowControl::Pi).then_some(LONGEST_STEP * self.integral_time_s)
    }

    /// The parts of the station; `step_s` is the longest step of the run.
    pub(super) fn expand(
        &self,
        site: &SiteEntry,
        tree: &Tree,
        what: &str,
        step_s: f64,
    ) -> Expanded {
        let names = Names::new(&self.name, site, tree, what);
        let control = self.flow_control.unwrap_or({
            let fine = step_s <= LONGEST_STEP * self.integral_time_s;
            if fine { FlowControl::Pi } else { FlowControl::QuasiSteady }
        });
        let (feeds_in, extracts) =
            (self.directions != Directions::Extraction, self.directions != Directions::FeedIn);
        let water = Some((self.volume_m3, self.ua_w_k));
        let hot = self.hot.clone().unwrap_or_else(|| names.line(0));
        let cold = self.cold.clone().unwrap_or_else(|| names.line(1));
        let mut nodes = vec![
            names.node("port_hot", water),
            names.node("port_cold", water),
            names.node("branch_cold", None),
        ];
        let resistance = names.unless("interface", RESISTANCE, json!({ "kv_m3_h": 4.0 }));
        let mut edges = vec![
            names.part("stub_hot", "pipe", (names.inner("port_hot"), hot), stub()),
            names.part(
                "interface",
                "resistance",
                (names.inner("port_cold"), names.inner("port_hot")),
                resistance,
            ),
        ];
        let stub_cold = names.part("stub_cold", "pipe", (names.inner("branch_cold"), cold), stub());
        if control == FlowControl::Ideal {
            edges.push(stub_cold);
            return ideal(&names, nodes, edges, (feeds_in, extracts));
        }
        let mode = match control {
            FlowControl::Pi => json!({}),
            FlowControl::QuasiSteady | FlowControl::Ideal => {
                json!({ "mode": "flow", "rise_time_s": 0.0 })
            }
        };
        let pump = |part: &str| {
            let curve = json!({ "head_max_hpa": 402.21, "free_flow_l_min": 55.33 });
            let mut defaults = names.unless(part, PUMP, curve);
            if let (Some(all), Some(mode)) = (defaults.as_object_mut(), mode.as_object()) {
                all.extend(mode.clone());
            }
            defaults
        };
        let check_valve = json!({ "kvs_m3_h": 11.0, "leakage": 1e-3 });
        if self.hydraulics == Hydraulics::OnePump {
            edges.push(stub_cold);
            let pump = pump("pump");
            return self.with_one_pump(&names, control, (nodes, edges), (pump, check_valve));
        }
        let branch = |from: &str, to: &str| (names.inner(from), names.inner(to));
        let by_valve = extracts && self.extraction == Extraction::Valve;
        let shut_off = !by_valve;
        let valve = |part: &'static str, ends: (String, String)| {
            let stroke_time_s = if control == FlowControl::Pi { self.dead_time_s } else { 0.0 };
            let defaults = json!({ "kvs_m3_h": 11.0, "open": 0.0, "stroke_time_s": stroke_time_s });
            names.part(part, "ball_valve", ends, defaults)
        };
        if feeds_in {
            let inlet = if shut_off { "pump_inlet" } else { "branch_cold" };
            if shut_off {
                nodes.push(names.node(inlet, None));
                edges.push(valve("feed_in_shut_off", branch("branch_cold", inlet)));
            }
            nodes.push(names.node("pump_outlet", None));
            let ends = branch(inlet, "pump_outlet");
            edges.push(names.part("feed_in_pump", "pump", ends, pump("feed_in_pump")));
            let ends = branch("pump_outlet", "port_cold");
            edges.push(names.part("feed_in_check_valve", "check_valve", ends, check_valve.clone()));
        }
        if by_valve {
            let (kind, defaults) = match control {
                FlowControl::Pi => {
                    ("valve", json!({ "kvs_m3_h": 2.5, "leakage": 2e-3, "opening": 0.0 }))
                }
                FlowControl::QuasiSteady | FlowControl::Ideal => {
                    ("flow_limiter", json!({ "kvs_m3_h": 2.5, "m_flow_set_kg_s": 0.0 }))
                }
            };
            let ends = branch("port_cold", "branch_cold");
            edges.push(names.part("extraction_valve", kind, ends, defaults));
        } else if extracts {
            let inlet = if shut_off { "extraction_inlet" } else { "port_cold" };
            if shut_off {
                nodes.push(names.node(inlet, None));
                edges.push(valve("extraction_shut_off", branch("port_cold", inlet)));
            }
            nodes.push(names.node("extraction_outlet", None));
            let ends = branch(inlet, "extraction_outlet");
            edges.push(names.part("extraction_pump", "pump", ends, pump("extraction_pump")));
            let ends = branch("extraction_outlet", "branch_cold");
            edges.push(names.part("extraction_check_valve", "check_valve", ends, check_valve));
        }
        edges.push(stub_cold);
        let mut controllers = Vec::new();
        let mut set = |part: &str, command: &str| {
            let (set, controller) = self.flow_set(&names, control, part, command);
            controllers.extend(controller);
            set
        };
        let feed_in_set = feeds_in.then(|| set("feed_in_pump", "speed"));
        let extraction_set = extracts.then(|| match by_valve {
            true => set("extraction_valve", "opening"),
            false => set("extraction_pump", "speed"),
        });
        let interface = InterfaceEntry {
            edge: names.inner("interface"),
            pump: feeds_in.then(|| names.inner("feed_in_pump")),
            valve: by_valve.then(|| names.inner("extraction_valve")),
            extraction_pump: (extracts && !by_valve).then(|| names.inner("extraction_pump")),
            requested_flow_m3_s: None,
            feed_in_set,
            extraction_set,
            feed_in_open: (feeds_in && shut_off).then(|| names.inner("feed_in_shut_off.open")),
            extraction_open: (extracts && shut_off)
                .then(|| names.inner("extraction_shut_off.open")),
            dead_time_s: if control == FlowControl::Pi { self.dead_time_s } else { 0.0 },
            longest_step_s: self.longest_step_s(control),
            id: names.id,
        };
        Expanded { nodes, edges, interface, controllers, sensors: Vec::new() }
    }

    /// The signal that a part gets its flow by, with the controller that holds it.
    pub(super) fn flow_set(
        &self,
        names: &Names<'_>,
        control: FlowControl,
        part: &str,
        command: &str,
    ) -> (String, Option<Tree>) {
        if control != FlowControl::Pi {
            return (names.inner(&format!("{part}.m_flow_set_kg_s")), None);
        }
        let id = names.inner(&format!("{part}.flow_control"));
        let set = format!("{id}.set_point");
        let controller = names.table(vec![
            ("id", json!(id)),
            ("kind", json!("pi")),
            ("measures", json!(names.inner(&format!("{part}.m_flow_kg_s")))),
            ("acts_on", json!(names.inner(&format!("{part}.{command}")))),
            ("set_point", json!(0.0)),
            ("gain", json!(self.gain)),
            ("integral_time_s", json!(self.integral_time_s)),
            ("off_at_zero", json!(true)),
        ]);
        (set, Some(controller))
    }
}
