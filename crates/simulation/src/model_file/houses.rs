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
    /// Point at which its water comes from others, for a circuit that is a branch between two points: `from = "return"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<String>,
    /// Point at which its water goes to others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<String>,
    /// Of a branch: pressure loss over the square of the flow; only ratios count. 25 with a pump, 1 without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resistance: Option<f64>,
    /// Of a branch with a pump: how far it is open while its pump is off, 0 (automatic valve, default) to 1 (none).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub idle_opening: Option<f64>,
    /// Of a branch with a pump: share of what the strongest parallel pump delivers more that it draws with it; 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub suction: Option<f64>,
    /// Of a branch with a pump: whether it holds its flow also where others push more through it; true.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub throttled: Option<bool>,
    /// Of a branch with a pump: whether a check valve keeps water from flowing back while the pump is off; false.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub check_valve: Option<bool>,
}

impl CircuitEntry {
    /// The field of a branch that is given where it is no branch, or `from` or `to` where the other is missing.
    pub(super) fn misplaced(&self) -> Option<&'static str> {
        let given = [
            ("resistance", self.resistance.is_some()),
            ("idle_opening", self.idle_opening.is_some()),
            ("suction", self.suction.is_some()),
            ("throttled", self.throttled.is_some()),
            ("check_valve", self.check_valve.is_some()),
        ];
        match (&self.from, &self.to) {
            (Some(_), Some(_)) => None,
            (Some(_), None) => Some("from"),
            (None, Some(_)) => Some("to"),
            (None, None) => given.into_iter().find(|(_, given)| *given).map(|(field, _)| field),
        }
    }
}
