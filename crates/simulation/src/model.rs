//! A model: plain nodes and edges, units, controllers and drivers by name, typed and in SI.
//!
//! This is what a model file becomes after composites are expanded, what overlays change and
//! `isolate` cuts, and what `build` turns into a simulation.

mod place;

pub use place::{Place, WrittenField};

use crate::diagnostic::Diagnostics;
use crate::effect::EffectSpec;
use crate::model_file::{
    GroundEntry, InterfaceEntry, Interpolation, NodeEntry, PrescribedEntry, PressureReferenceEntry,
    RunEntry, ToleranceEntry, WeatherEntry, WeatherKind, WorstPointEntry,
};
use crate::table::Tables;
use crate::weather::Records;
use anergy_control::controllers::{ControllerParams, ports};
use anergy_control::sensor::SensorEntry;
use anergy_core::medium::Medium;
use anergy_network::elements::ElementParams;
use anergy_prosumer::equipment::EquipmentParams;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use smol_str::SmolStr;
use std::path::Path;
use std::sync::Arc;

/// A node.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeSpec {
    /// Its fields.
    pub entry: NodeEntry,
    /// The site it belongs to; empty for others.
    pub site: SmolStr,
    /// Where it stands.
    pub place: Place,
}

/// An edge.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeSpec {
    /// Name.
    pub id: SmolStr,
    /// Node at port a.
    pub from: SmolStr,
    /// Node at port b.
    pub to: SmolStr,
    /// The component.
    pub params: ElementParams,
    /// Multiplies the pressure loss; 1 leaves the law alone.
    pub loss_factor: f64,
    /// The station it belongs to; empty for others.
    pub station: SmolStr,
    /// Where it stands.
    pub place: Place,
}

/// A thermal unit.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitSpec {
    /// Name.
    pub id: SmolStr,
    /// The edge that its port outside of circuits stands on; empty where all its ports are in circuits.
    pub port: SmolStr,
    /// The unit.
    pub params: EquipmentParams,
    /// Where it stands.
    pub place: Place,
}

impl UnitSpec {
    /// The same unit with other parameters of its kind, SI; none where they cannot be read.
    pub fn with_params(&self, params: serde_json::Value) -> Option<Self> {
        let params = EquipmentParams::deserialize(self.params.kind(), params)?.ok()?;
        Some(Self { params, ..self.clone() })
    }
}

/// A circuit of a house.
#[derive(Debug, Clone, PartialEq)]
pub struct CircuitSpec {
    /// Name.
    pub id: SmolStr,
    /// Ports in the order of the flow: `UNIT.PORT`, or `UNIT` where it has one port.
    pub through: Vec<SmolStr>,
    /// Flow of its own pump while nothing drives it, m3/s.
    pub v_flow_m3_s: Option<f64>,
    /// The points between which it is a branch; `None` where it is closed in itself.
    pub branch: Option<BranchSpec>,
    /// Where it stands.
    pub place: Place,
}

/// What a circuit is between two points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BranchSpec {
    /// Point at which positive flow enters.
    #[schemars(with = "String")]
    pub from: SmolStr,
    /// Point at which positive flow leaves.
    #[schemars(with = "String")]
    pub to: SmolStr,
    /// Pressure loss over the square of the flow; only ratios count.
    pub resistance: Option<f64>,
    /// How far it is open while its pump is off, 0 to 1.
    pub idle_opening: f64,
    /// Share of what the strongest parallel pump delivers more that it draws with it.
    pub suction: f64,
    /// Whether its pump holds its flow also where others push more through it.
    pub throttled: bool,
    /// Whether a check valve keeps water from flowing back while the pump is off.
    pub check_valve: bool,
}

/// A hydraulic interface.
#[derive(Debug, Clone, PartialEq)]
pub struct InterfaceSpec {
    /// As written.
    pub entry: InterfaceEntry,
    /// Where it stands.
    pub place: Place,
}

/// A controller.
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerSpec {
    /// Name.
    pub id: String,
    /// Channels it measures, in the order of its ports.
    pub measures: Vec<String>,
    /// Signals it drives, in the order of its ports.
    pub acts_on: Vec<String>,
    /// The controller.
    pub params: ControllerParams,
    /// Where it stands.
    pub place: Place,
}

impl ControllerSpec {
    /// Field and name of every channel that it measures; a rule names its channels within its conditions.
    pub fn measured(&self) -> Vec<(&'static str, &str)> {
        let fields: Vec<&'static str> = match &self.params {
            ControllerParams::Rule(rule) => {
                rule.measures().into_iter().map(|(field, _)| field).collect()
            }
            params => ports(params.kind()).measures.to_vec(),
        };
        fields.into_iter().zip(self.measures.iter().map(String::as_str)).collect()
    }

    /// Field and name of every channel and signal.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let acts_on = ports(self.params.kind()).acts_on.iter().copied();
        let acts_on = acts_on.zip(self.acts_on.iter().map(String::as_str));
        self.measured().into_iter().chain(acts_on)
    }
}

/// A sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorSpec {
    /// Its fields.
    pub entry: SensorEntry,
    /// Where it stands.
    pub place: Place,
}

/// The smallest of several pressure differences, as a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct WorstPointSpec {
    /// Its fields.
    pub entry: WorstPointEntry,
    /// Where it stands.
    pub place: Place,
}

/// A quantity that is given while an actuator is free.
#[derive(Debug, Clone, PartialEq)]
pub struct PrescriptionSpec {
    /// Name; the given value is the signal `id.value`.
    pub id: String,
    /// Its fields.
    pub entry: PrescribedEntry,
    /// Where it stands.
    pub place: Place,
}

/// A signal driven over time by a schedule or a series.
#[derive(Debug, Clone, PartialEq)]
pub struct DriverSpec {
    /// The signal.
    pub signal: SmolStr,
    /// Unit of the values; `None` is SI.
    pub unit: Option<SmolStr>,
    /// Between the points.
    pub interpolation: Interpolation,
    /// Times, s since the start.
    pub times_s: Arc<[f64]>,
    /// Values in `unit`.
    pub values: Arc<[f64]>,
    /// Where it comes from, for messages.
    pub source: SmolStr,
    /// Where it stands.
    pub place: Place,
}

/// A pressure reference.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceSpec {
    /// Its fields.
    pub entry: PressureReferenceEntry,
    /// Where it stands.
    pub place: Place,
}

/// The weather.
#[derive(Debug, Clone, PartialEq)]
pub struct WeatherSpec {
    /// Its fields.
    pub entry: WeatherEntry,
    /// Its records; absent where it is constant.
    pub records: Option<Arc<Records>>,
    /// Where it stands.
    pub place: Place,
}

/// A whole model.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Title.
    pub name: String,
    /// The text it was read from.
    pub text: Arc<str>,
    /// The tables it was read from.
    pub tables: Tables,
    /// How to run it.
    pub run: RunEntry,
    /// The water.
    pub medium: Medium,
    /// Whether viscosity and density in the pressure losses of pipes follow the temperature.
    pub follow_temperature: bool,
    /// Gravity, m/s2.
    pub gravity_m_s2: f64,
    /// Whether warm water is lighter than cold water: buoyancy.
    pub thermosiphon: bool,
    /// Whether friction warms the water.
    pub dissipation: bool,
    /// Whether the water in pipes has inertia.
    pub fluid_inertia: bool,
    /// Latitude and longitude of the origin of the map, rad.
    pub origin_rad: Option<[f64; 2]>,
    /// What the pipes lie in.
    pub ground: GroundEntry,
    /// Where it stands.
    pub ground_place: Place,
    /// The weather, where there is one.
    pub weather: Option<WeatherSpec>,
    /// How well its numbers are known.
    pub tolerance: ToleranceEntry,
    /// Nodes.
    pub nodes: Vec<NodeSpec>,
    /// Edges.
    pub edges: Vec<EdgeSpec>,
    /// Thermal units.
    pub units: Vec<UnitSpec>,
    /// Circuits of houses.
    pub circuits: Vec<CircuitSpec>,
    /// Hydraulic interfaces.
    pub interfaces: Vec<InterfaceSpec>,
    /// Sensors.
    pub sensors: Vec<SensorSpec>,
    /// Controllers.
    pub controllers: Vec<ControllerSpec>,
    /// Worst points.
    pub worst_points: Vec<WorstPointSpec>,
    /// Prescriptions.
    pub prescriptions: Vec<PrescriptionSpec>,
    /// Schedules and series.
    pub drivers: Vec<DriverSpec>,
    /// Pressure references.
    pub references: Vec<ReferenceSpec>,
    /// Effects, not yet at work.
    pub effects: Vec<EffectSpec>,
}

impl Model {
    /// Reads a model from TOML text; files it refers to are looked up in `dir`.
    ///
    /// # Errors
    /// All problems of the text, with places and hints. Problems of the network it describes are
    /// found by [`crate::build`].
    pub fn from_toml(text: &str, dir: &Path) -> Result<Self, Diagnostics> {
        let tree = crate::document::parse_toml(text)?;
        crate::model_file::read::model(tree, text, dir)
    }

    /// Reads a model from a JSON object with the same grammar.
    ///
    /// # Errors
    /// As [`Self::from_toml`]; there are no places, names are given instead.
    pub fn from_json(value: &Value, dir: &Path) -> Result<Self, Diagnostics> {
        let text = match value {
            Value::Object(map) => crate::document::to_toml(map)?,
            _ => String::new(),
        };
        // Through the text, so that places and hints are those of the file the user could save.
        Self::from_toml(&text, dir)
    }

    /// Starts of random numbers that are drawn: who draws, and the seed.
    pub fn seeds(&self) -> Vec<(String, u64)> {
        let weather = self.weather.iter().map(|weather| &weather.entry);
        let weather = weather.filter(|entry| entry.kind == WeatherKind::Synthetic);
        let noisy = self.sensors.iter().map(|sensor| &sensor.entry).filter(|s| s.noise > 0.0);
        let weather = weather.map(|entry| ("weather".to_owned(), entry.seed));
        let units = self.units.iter().filter_map(|unit| {
            let seed = match &unit.params {
                EquipmentParams::Household(params) => params.seed,
                EquipmentParams::ElectricVehicle(params) => params.seed,
                EquipmentParams::DomesticHotWater(params) => {
                    params.daily_m3.map(|_| params.seed)?
                }
                _ => return None,
            };
            Some((unit.id.to_string(), seed))
        });
        let noisy = noisy.map(|sensor| (sensor.id.to_string(), sensor.seed));
        weather.chain(noisy).chain(units).collect()
    }

    /// The edge with a name.
    pub fn edge(&self, id: &str) -> Option<&EdgeSpec> {
        self.edges.iter().find(|edge| edge.id == id)
    }
}
