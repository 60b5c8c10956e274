//! Controllers, their sensors, and the pumps they drive.

use crate::channels::Source;
use anergy_control::controllers::LocalController;
use anergy_control::sensor::Sensor;
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
use std::ops::Range;

/// A controller with its places in the flat state.
#[derive(Debug, Clone)]
pub(crate) struct PlannedController {
    pub name: String,
    pub controller: LocalController,
    pub measures: Vec<Source>,
    pub measured_names: Vec<String>,
    /// From where the first measured value counts: 0 degC for a temperature.
    pub zero: f64,
    /// Signals of its set points.
    pub set_points: Range<usize>,
    pub acts_on: Vec<SignalId>,
    /// Smallest and largest value of those signals.
    pub limits: Vec<(f64, f64)>,
    /// 0 is every step.
    pub interval: Time,
    pub state: Range<usize>,
}

/// A pump that a controller drives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SwingWatch {
    pub controller: usize,
    pub edge: usize,
    /// Whether the first set point is its flow.
    pub holds_flow: bool,
    /// Whether temperatures are in the loop.
    pub slow: bool,
}

/// A sensor and what it measures.
#[derive(Debug, Clone)]
pub(crate) struct PlannedSensor {
    pub name: String,
    /// Unit of its channel.
    pub unit: String,
    pub sensor: Sensor,
    pub measures: Source,
    /// What is subtracted.
    pub minus: Option<Source>,
}
