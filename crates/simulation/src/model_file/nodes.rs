//! `[[node]]` and `[pressure_reference]`: nodes and what holds their pressure.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

/// `[[node]]`: a plain node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodeEntry {
    /// Name.
    pub id: SmolStr,
    /// What is known at it.
    #[serde(default)]
    pub kind: NodeEntryKind,
    /// Elevation, m.
    #[serde(default)]
    pub elevation_m: f64,
    /// Mixed water volume, m3.
    #[serde(default)]
    pub volume_m3: f64,
    /// Heat loss of this volume to the ground's temperature, W/K.
    #[serde(default)]
    pub ua_w_k: f64,
    /// Given pressure, Pa (pressure_boundary).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure_pa: Option<f64>,
    /// Flow into the network, kg/s; negative takes water out (source).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub m_flow_kg_s: Option<f64>,
    /// Temperature of entering water, K (pressure_boundary, source).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature_k: Option<f64>,
    /// Below this pressure the node raises `pressure_low`, Pa. Absent: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_pressure_pa: Option<f64>,
    /// Above this pressure the node raises `pressure_high`, Pa. Absent: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_pressure_pa: Option<f64>,
    /// Position on the map, m east.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_m: Option<f64>,
    /// Position on the map, m north.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_m: Option<f64>,
}

/// What is known at a plain node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NodeEntryKind {
    /// Nothing.
    #[default]
    Junction,
    /// The pressure; water enters or leaves.
    PressureBoundary,
    /// The flow that enters or leaves.
    Source,
}

/// `[pressure_reference]` (or several as `[[pressure_reference]]`): pressure holding of a circuit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressureReferenceEntry {
    /// The node.
    pub node: String,
    /// Its pressure above the atmosphere, Pa; with a vessel that at the start of the run.
    #[serde(default = "holding_pressure")]
    pub pressure_pa: f64,
    /// Volume of a membrane expansion vessel at the node, m3. Absent: the pressure is held whatever happens.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vessel_volume_m3: Option<f64>,
    /// Pressure above the atmosphere of the gas in the vessel while it holds no water, Pa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vessel_precharge_pa: Option<f64>,
    /// Below this pressure anywhere its circuit raises `pressure_low`, Pa. Absent: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_pressure_pa: Option<f64>,
    /// Above this pressure anywhere its circuit raises `pressure_high`, Pa. Absent: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_pressure_pa: Option<f64>,
}

fn holding_pressure() -> f64 {
    1.5e5
}
