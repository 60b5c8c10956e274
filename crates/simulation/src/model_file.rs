//! The entries of a model file, as their fields are written (in SI after conversion).
//!
//! Each struct is one section of the file; together with the registries of elements, units and
//! controllers they make up the grammar that `anergy schema` prints.

mod balancing_unit;
mod duration;
pub mod expand;
mod fluid;
mod ground;
mod heat_pump_map;
pub mod house_library;
mod houses;
mod nodes;
mod one_pump;
mod plant;
mod prosumer_problems;
mod prosumer_station;
pub mod read;
pub mod schema;
pub mod series;
mod shared_command;
mod station_parts;
mod tables;
mod tolerance;
mod weather;

pub use balancing_unit::BalancingUnitEntry;
pub use duration::{Duration, StepEntry};
pub use fluid::{FluidEntry, FluidKind};
pub use ground::{GroundEntry, GroundKind};
pub use houses::{CircuitEntry, InterfaceEntry};
pub use nodes::{NodeEntry, NodeEntryKind, PressureReferenceEntry};
pub use plant::{DpAt, PlantEntry, WorstPointEntry};
pub use prosumer_station::{Directions, Extraction, FlowControl, ProsumerEntry};
pub use shared_command::{FourWayMixerEntry, ThreeWayMode, ThreeWayValveEntry};
pub use tables::NetworkEntry;
pub use tolerance::ToleranceEntry;
pub use weather::{Means, WeatherEntry, WeatherKind};

use anergy_core::clock::Time;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[model]`: what the model is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModelEntry {
    /// Title of the study.
    #[serde(default = "untitled")]
    pub name: String,
    /// Free text.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// Gravity in m/s2.
    #[serde(default = "gravity")]
    pub gravity: f64,
    /// Whether warm water is lighter than cold water: buoyancy.
    #[serde(default)]
    pub thermosiphon: bool,
    /// Whether the hydraulic power that an edge takes from the water warms it: friction.
    #[serde(default)]
    pub dissipation: bool,
    /// Whether the water in pipes has inertia: flows need time to change.
    #[serde(default)]
    pub fluid_inertia: bool,
    /// Where x_m = 0 and y_m = 0 lie on the earth (WGS84): latitude, north positive, rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latitude_rad: Option<f64>,
    /// The longitude of that place, east positive, rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longitude_rad: Option<f64>,
}

impl ModelEntry {
    /// Latitude and longitude of the origin of the map, rad, or what is wrong with them.
    pub(crate) fn origin_rad(&self) -> Result<Option<[f64; 2]>, (&'static str, String)> {
        let (latitude, longitude) = match (self.latitude_rad, self.longitude_rad) {
            (None, None) => return Ok(None),
            (Some(latitude), Some(longitude)) => (latitude, longitude),
            (Some(_), None) => return Err(("latitude_rad", "latitude needs a longitude".into())),
            (None, Some(_)) => return Err(("longitude_rad", "longitude needs a latitude".into())),
        };
        for (field, value, most_deg) in
            [("latitude_rad", latitude, 89.9), ("longitude_rad", longitude, 180.0)]
        {
            let name = field.trim_end_matches("_rad");
            let deg = value.to_degrees();
            if deg.is_nan() || deg.abs() > most_deg {
                let message = format!("{name} of {deg:.6} deg is not within {most_deg} deg");
                return Err((field, message));
            }
        }
        Ok(Some([latitude, longitude]))
    }
}

fn untitled() -> String {
    "untitled".into()
}

fn gravity() -> f64 {
    anergy_network::graph::GRAVITY_M_S2
}

/// `[run]`: how long, how fine, from when.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RunEntry {
    /// End of the run, for example "1h".
    #[serde(default = "one_hour")]
    pub until: Duration,
    /// Largest time step, for example "1s", or "auto": as long as flows, temperatures and controllers allow.
    #[serde(default = "one_second")]
    pub step: StepEntry,
    /// Shortest automatic step.
    #[serde(default = "tenth_second")]
    pub step_min: Duration,
    /// Longest automatic step.
    #[serde(default = "quarter_hour")]
    pub step_max: Duration,
    /// Error of a temperature that an automatic step may make at the ports of units, K.
    #[serde(default = "half_kelvin")]
    pub step_tolerance_difference_k: f64,
    /// Error of a flow that an automatic step may make, relative to the flow and at least to a tenth of its
    /// nominal flow; of the output of a continuous controller, relative to its range.
    #[serde(default = "one_percent")]
    pub step_tolerance_flow: f64,
    /// Time between recorded rows, for example "10s".
    #[serde(default = "ten_seconds")]
    pub record: Duration,
    /// Calendar time of the start, RFC 3339; needed only with calendar data.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<String>,
    /// Temperature of all water at the start, K.
    #[serde(default = "twenty_degc")]
    pub initial_k: f64,
    /// What the run starts from.
    #[serde(default, skip_serializing_if = "InitialState::is_given")]
    pub initial: InitialState,
}

impl RunEntry {
    /// The longest step it asks for, s.
    pub fn longest_step_s(&self) -> f64 {
        match self.step {
            StepEntry::Fixed(step) => step.0.as_s(),
            StepEntry::Automatic => self.step_max.0.as_s(),
        }
    }

    /// What is wrong with the automatic step: field and message.
    pub fn step_problems(&self) -> Vec<(&'static str, String)> {
        let mut problems = Vec::new();
        if self.step_min > self.step_max {
            let (min, max) = (self.step_min.0, self.step_max.0);
            let message = format!("the shortest step, {min}, is longer than the longest, {max}");
            problems.push(("step_min", message));
        }
        let k = self.step_tolerance_difference_k;
        if !(k.is_finite() && k > 0.0) {
            let message = format!("step_tolerance_difference_k = {k} must be positive");
            problems.push(("step_tolerance_difference_k", message));
        }
        let share = self.step_tolerance_flow;
        if !(share > 0.0 && share < 1.0) {
            let message = format!("step_tolerance_flow = {share} must be between 0 and 1");
            problems.push(("step_tolerance_flow", message));
        }
        problems
    }
}

/// What a run starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InitialState {
    /// The initial temperatures, positions and outputs of the entries.
    #[default]
    Given,
    /// The steady state of the inputs at t = 0, controllers at rest in it.
    Steady,
}

impl InitialState {
    #[allow(clippy::trivially_copy_pass_by_ref)]
    fn is_given(&self) -> bool {
        *self == Self::Given
    }
}

fn one_hour() -> Duration {
    Duration(Time(3_600_000_000_000))
}

fn one_second() -> StepEntry {
    StepEntry::Fixed(Duration(Time(1_000_000_000)))
}

fn tenth_second() -> Duration {
    Duration(Time(100_000_000))
}

fn quarter_hour() -> Duration {
    Duration(Time(900_000_000_000))
}

fn half_kelvin() -> f64 {
    0.5
}

fn one_percent() -> f64 {
    0.01
}

fn ten_seconds() -> Duration {
    Duration(Time(10_000_000_000))
}

fn twenty_degc() -> f64 {
    293.15
}

/// `[[site]]`: a place with a node on each line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SiteEntry {
    /// Name of the place.
    pub id: String,
    /// Elevation, m.
    #[serde(default)]
    pub elevation_m: f64,
    /// Names of its lines, the hot one first: a node `id.line` each.
    #[serde(default = "two_lines")]
    pub lines: Vec<String>,
    /// Position on the map, m east.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_m: Option<f64>,
    /// Position on the map, m north.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_m: Option<f64>,
}

fn two_lines() -> Vec<String> {
    vec!["hot".into(), "cold".into()]
}

/// `[[station]]`: a transfer station between the lines of a site. The parts take the fields of their
/// elements; what is not given has the published value of the laboratory's station.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StationEntry {
    /// The site it stands at.
    pub site: String,
    /// What it can do.
    pub kind: StationKind,
    /// Name within its site; another name than "station" also prefixes its parts.
    #[serde(default = "station_name")]
    pub name: String,
    /// Flow that its pump means to deliver, m3/s; decides the `blocked` flag.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub requested_flow_m3_s: Option<f64>,
    /// Both house connection pipes, each: fields of a pipe, or `pipe` for a named type.
    #[serde(default, skip_serializing_if = "is_null")]
    pub stub: serde_json::Value,
    /// The heat exchanger: fields of a heat_exchanger.
    #[serde(default, skip_serializing_if = "is_null")]
    pub heat_exchanger: serde_json::Value,
    /// The feed-in pump: fields of a pump.
    #[serde(default, skip_serializing_if = "is_null")]
    pub feed_in_pump: serde_json::Value,
    /// The check valve behind the pump: fields of a check_valve.
    #[serde(default, skip_serializing_if = "is_null")]
    pub feed_in_check_valve: serde_json::Value,
    /// The extraction valve: fields of a valve.
    #[serde(default, skip_serializing_if = "is_null")]
    pub extraction_valve: serde_json::Value,
    /// A check valve behind the extraction valve, which lets water out of the exchanger only: fields of a
    /// check_valve. Absent: none.
    #[serde(default, skip_serializing_if = "is_null")]
    pub extraction_check_valve: serde_json::Value,
}

fn is_null(value: &serde_json::Value) -> bool {
    value.is_null()
}

fn station_name() -> String {
    "station".into()
}

/// What a station can do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StationKind {
    /// Feed in with a pump and extract with a valve, through one heat exchanger.
    Bidirectional,
    /// Extract with a valve through a heat exchanger.
    Consumer,
    /// Feed in with a pump through a heat exchanger.
    Producer,
    /// The flow is what the unit asks for; its water is grid water.
    PrescribedFlow,
    /// Circulate the water and give it the supply temperature.
    Plant,
    /// Deliver the flow that a unit in the grid water asks for, with a pump for each direction.
    Prosumer,
    /// A unit in the grid water between the lines, which takes what comes.
    BalancingUnit,
}

/// `[[prescribed]]`: a quantity that is given, and the actuator that is left free in its place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PrescribedEntry {
    /// Name. Absent: the free actuator and `.prescribed`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// What is given: `EDGE.m_flow_kg_s`, `STATION.m_flow_kg_s`, `EDGE.dp_pa` or `NODE.p_pa`.
    pub quantity: String,
    /// Its value.
    pub value: f64,
    /// Unit of the value. Absent: SI.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The command that is free: `PUMP.speed`, `VALVE.opening`.
    pub free: String,
}

/// How a signal runs between its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// The value of a point holds until the next one.
    #[default]
    Hold,
    /// Straight lines.
    Linear,
}

/// `[[schedule]]`: a signal over time, in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ScheduleEntry {
    /// The signal it drives.
    pub signal: String,
    /// Unit of the values, for example "percent" or "degC". Absent: SI.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Between the points.
    #[serde(default)]
    pub interpolation: Interpolation,
    /// Pairs of time in s and value.
    pub points: Vec<(f64, f64)>,
}

/// `[[series]]`: a signal over time, from a column of a CSV file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SeriesEntry {
    /// The file, relative to the model file.
    pub file: String,
    /// The column.
    pub column: String,
    /// The signal it drives.
    pub signal: String,
    /// Unit of the values (after `scale` and `offset`). Absent: SI.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// What the values of the file are multiplied by: -1 turns a direction, a converter has its gain.
    #[serde(default = "one")]
    pub scale: f64,
    /// What is added then.
    #[serde(default)]
    pub offset: f64,
    /// Between the rows.
    #[serde(default)]
    pub interpolation: Interpolation,
    /// The column with the time: s since the start, in another unit where its name says so (`time_h`, `hour`), or RFC 3339
    /// with `[run] start`. Absent: the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_column: Option<String>,
    /// Field separator.
    #[serde(default = "comma")]
    pub separator: char,
}

fn comma() -> char {
    ','
}

fn one() -> f64 {
    1.0
}
