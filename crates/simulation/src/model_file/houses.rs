//! Interfaces of houses with the network, and circuits within them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[[interface]]`: what a station is in a model written as plain nodes and edges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InterfaceEntry {
    /// Name, for example "sf1.station".
    pub id: String,
    /// Edge whose flow from a to b is the station's feed-in.
    pub edge: String,
    /// Pump that feeds in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pump: Option<String>,
    /// Valve that extracts; stays closed until the pump has run down.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub valve: Option<String>,
    /// Pump that extracts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extraction_pump: Option<String>,
    /// Flow that the pump means to deliver, m3/s; decides the `blocked` flag.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub requested_flow_m3_s: Option<f64>,
    /// Signal that gets the flow the unit on the edge asks for in feed-in, kg/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub feed_in_set: Option<String>,
    /// Signal that gets the flow the unit on the edge asks for in extraction, kg/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extraction_set: Option<String>,
    /// Signal that is 1 while feed-in is asked for: a shut-off valve.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub feed_in_open: Option<String>,
    /// Signal that is 1 while extraction is asked for: a shut-off valve.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extraction_open: Option<String>,
    /// Pause when the direction changes, s.
    #[serde(default)]
    pub dead_time_s: f64,
    /// The longest step in which the controllers of its flow follow, s; a run with longer ones warns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_step_s: Option<f64>,
}

impl InterfaceEntry {
    /// An interface that watches and drives nothing; its edge is to be said.
    pub(super) fn watching(id: String) -> Self {
        Self {
            id,
            edge: String::new(),
            pump: None,
            valve: None,
            extraction_pump: None,
            requested_flow_m3_s: None,
            feed_in_set: None,
            extraction_set: None,
            feed_in_open: None,
            extraction_open: None,
            dead_time_s: 0.0,
            longest_step_s: None,
        }
    }
}

/// `[[circuit]]`: a closed circuit of water in a house, through ports of its units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CircuitEntry {
    /// Site that it belongs to, in front of its name and of those of its units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub site: Option<String>,
    /// Name, within its site where one is given.
    pub id: String,
    /// Ports in the order of the flow: `UNIT.PORT`, or `UNIT` where it has one port.
    pub through: Vec<String>,
    /// Flow of its own pump while nothing drives it, m3/s. Absent: one of its units sets the flow.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub v_flow_m3_s: Option<f64>,
}
