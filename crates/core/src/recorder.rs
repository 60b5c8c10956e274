//! The seam between a run and whatever keeps its results.
//!
//! The simulation writes rows into preallocated buffers and hands them to a [`Recorder`]; files are
//! written behind this trait. [`Recording`] is the result in memory: what a reader of a file gives
//! back, and what reports and Python see.

use crate::clock::Time;
use crate::error::RecordError;
use serde::{Deserialize, Serialize};

/// What a channel belongs to; one topic of the recorded file each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChannelGroup {
    /// Pressures and temperatures of nodes.
    Nodes,
    /// Flows, pressure differences, actuator positions, heat of edges.
    Edges,
    /// Hydraulic interfaces: station flow, heat, blocked flag.
    Interfaces,
    /// Thermal units.
    Units,
    /// Commands and controller set points.
    Control,
    /// Network-wide sums and balances.
    Balances,
}

impl ChannelGroup {
    /// All groups in the order of their topics.
    pub const ALL: [Self; 6] =
        [Self::Nodes, Self::Edges, Self::Interfaces, Self::Units, Self::Control, Self::Balances];

    /// Topic of the recorded file.
    pub const fn topic(self) -> &'static str {
        match self {
            Self::Nodes => "/network/nodes",
            Self::Edges => "/network/edges",
            Self::Interfaces => "/interfaces",
            Self::Units => "/units",
            Self::Control => "/control",
            Self::Balances => "/balances",
        }
    }

    /// The group of a topic.
    pub fn from_topic(topic: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|group| group.topic() == topic)
    }
}

/// One recorded quantity of one component.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Channel {
    /// `component.quantity_unit`, for example `sf1.feed_in_pump.m_flow_kg_s`.
    pub name: String,
    /// SI unit as in UDUNITS (`kg s-1`, `Pa`, `K`, `W`, `J`), `1` for ratios and flags.
    pub unit: String,
    /// What the channel belongs to.
    pub group: ChannelGroup,
    /// The component part of the name, for example `sf1.feed_in_pump`.
    pub component: String,
    /// The quantity part of the name, for example `m_flow_kg_s`.
    pub quantity: String,
}

/// How important an event is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing.
    Info,
    /// The plant does not do what was asked of it.
    Warning,
}

/// Something that happened at one time: a station blocked, a pressure limit passed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Event {
    /// Simulated time, ns.
    pub time: Time,
    /// Importance.
    pub severity: Severity,
    /// The component concerned.
    pub component: String,
    /// Machine-readable word, for example `blocked` or `unblocked`.
    pub kind: String,
    /// Sentence for the user, with numbers.
    pub message: String,
}

/// A node of the network map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapNode {
    /// Name of the node.
    pub id: String,
    /// Name of the site the node belongs to; empty for plain nodes.
    pub site: String,
    /// Horizontal position, m, if the model gives one.
    pub x_m: Option<f64>,
    /// Vertical position, m, if the model gives one.
    pub y_m: Option<f64>,
}

/// An edge of the network map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapEdge {
    /// Name of the edge.
    pub id: String,
    /// Registry word, for example `pipe`.
    pub kind: String,
    /// Node at port a.
    pub from: String,
    /// Node at port b.
    pub to: String,
    /// Length, m; zero for what is not a pipe.
    pub length_m: f64,
    /// Inner diameter, m; zero for what is not a pipe, and in older recordings.
    #[serde(default)]
    pub inner_diameter_m: f64,
    /// Name of the station the edge belongs to; empty for others.
    pub station: String,
}

/// Geometry of the network for maps.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct NetworkMap {
    /// Nodes.
    pub nodes: Vec<MapNode>,
    /// Edges.
    pub edges: Vec<MapEdge>,
}

/// What is known before the first row.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunHeader {
    /// Name of the model.
    pub model_name: String,
    /// The model file as the user wrote it.
    pub model_text: String,
    /// Calendar time of the start of the run, ns since 1970; zero for relative runs.
    pub start_unix_ns: i64,
    /// Settings and versions, in order: step, record interval, solver tolerances, program version.
    pub settings: Vec<(String, String)>,
    /// Geometry for maps.
    pub map: NetworkMap,
}

/// Receives the rows of a run.
pub trait Recorder {
    /// Called once before the first row.
    ///
    /// # Errors
    /// When the destination cannot be written.
    fn start(&mut self, header: &RunHeader, channels: &[Channel]) -> Result<(), RecordError>;

    /// One recorded row: `values[i]` belongs to `channels[i]`, in SI.
    ///
    /// # Errors
    /// When the destination cannot be written.
    fn row(&mut self, time: Time, values: &[f64]) -> Result<(), RecordError>;

    /// Something that happened.
    ///
    /// # Errors
    /// When the destination cannot be written.
    fn event(&mut self, event: &Event) -> Result<(), RecordError>;

    /// Called once after the last row, also after an interrupted run.
    ///
    /// # Errors
    /// When the destination cannot be written.
    fn finish(self: Box<Self>, summary: &serde_json::Value) -> Result<(), RecordError>;
}

/// The results of a run in memory, one column per channel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// What was known before the first row.
    pub header: RunHeader,
    /// Names and units of the columns.
    pub channels: Vec<Channel>,
    /// Time of each row, s since the start.
    pub time_s: Vec<f64>,
    /// `columns[channel][row]`, SI.
    pub columns: Vec<Vec<f64>>,
    /// What happened.
    pub events: Vec<Event>,
    /// Key results and balances; `Null` when the run did not reach its end.
    pub summary: serde_json::Value,
}

impl Recording {
    /// The column of a channel.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let index = self.channels.iter().position(|channel| channel.name == name)?;
        self.columns.get(index).map(Vec::as_slice)
    }
}

/// Keeps everything in memory.
#[derive(Debug, Default)]
pub struct MemoryRecorder {
    /// The rows so far.
    pub recording: Recording,
}

impl Recorder for MemoryRecorder {
    fn start(&mut self, header: &RunHeader, channels: &[Channel]) -> Result<(), RecordError> {
        self.recording = Recording {
            header: header.clone(),
            channels: channels.to_vec(),
            columns: vec![Vec::new(); channels.len()],
            ..Recording::default()
        };
        Ok(())
    }

    fn row(&mut self, time: Time, values: &[f64]) -> Result<(), RecordError> {
        self.recording.time_s.push(time.as_s());
        for (column, value) in self.recording.columns.iter_mut().zip(values) {
            column.push(*value);
        }
        Ok(())
    }

    fn event(&mut self, event: &Event) -> Result<(), RecordError> {
        self.recording.events.push(event.clone());
        Ok(())
    }

    fn finish(self: Box<Self>, _summary: &serde_json::Value) -> Result<(), RecordError> {
        Ok(())
    }
}
