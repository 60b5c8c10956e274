//! The seam of what stands behind a hydraulic interface: units that see water passing their ports.

use anergy_core::medium::Medium;
use anergy_core::port::{PortFlow, PortRequest};
use anergy_core::signal::Signals;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;
use std::borrow::Cow;
use thiserror::Error;

/// A place where a stream of water passes a unit: on an edge of the network or in a circuit of the house.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitPort {
    /// Name within the unit.
    pub name: SmolStr,
    /// Whether the unit sets the flow (it has the pump), or takes what comes.
    pub sets_flow: bool,
    /// Whether what it gets decides what the unit does at its other ports: the source of a heat pump.
    pub leads: bool,
}

impl UnitPort {
    /// The one port of a simple unit, whose flow it sets.
    pub const ONLY: Self =
        Self { name: SmolStr::new_static("port"), sets_flow: true, leads: false };
}

/// An input signal of a unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitInput {
    /// Name with its SI suffix, as in the model file.
    pub name: &'static str,
    /// Suffix of the unit, empty for ratios.
    pub unit: &'static str,
    /// Value while nothing drives it.
    pub initial: f64,
    /// Smallest value that makes sense.
    pub min: f64,
    /// Largest value that makes sense.
    pub max: f64,
    /// The signal that it follows while nothing drives it, where the model has it: `weather.t_outdoor_k`.
    pub follows: Option<&'static str>,
}

/// Input `follows`: the sum of an output of this name over the other units of the site, in the same step.
pub const OF_SITE: &str = "site.";
/// Input `follows`: the electricity that all units of the site and its pumps draw that do not follow it themselves, W.
pub const SITE_ELECTRICITY: &str = "site.electricity";
/// Input `follows`: the electricity of all other units of the site and of its pumps, W.
pub const SITE_GRID: &str = "site.grid";
/// Input `follows`: the electricity that all units of the site generate from fuel, W.
pub const SITE_COGENERATED: &str = "site.cogenerated";
/// Input `follows`: the reactive power of the units and pumps of the site whose power factor the unit knows, var.
pub const SITE_REACTIVE: &str = "site.reactive";
/// Input `follows`: the start of the run, s since 1970 (UTC); it stays.
pub const START_UNIX: &str = "run.start_unix_s";

/// An output that says that something is wrong while it is not 0: an event when it goes up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Flag {
    /// The output.
    pub output: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

/// A recorded output of a unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitOutput {
    /// Name with SI suffix.
    pub name: Cow<'static, str>,
    /// UDUNITS unit.
    pub unit: &'static str,
    /// Whether it is a state at the end of the step; else it is the mean over it. What is counted (J, m3) is at its end anyway.
    pub is_state: bool,
}

impl UnitOutput {
    /// An output with a fixed name, the mean over a step.
    pub const fn new(name: &'static str, unit: &'static str) -> Self {
        Self { name: Cow::Borrowed(name), unit, is_state: false }
    }

    /// A state at the end of a step.
    pub const fn state(name: &'static str, unit: &'static str) -> Self {
        Self { name: Cow::Borrowed(name), unit, is_state: true }
    }
}

/// What a unit exchanged besides the heat of the water through its ports; means over a step.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Exchange {
    /// Electricity drawn, W; negative for a generator.
    pub electric_w: f64,
    /// All other heat into the unit, W: surroundings, sun, people, fuel; demand and losses are negative.
    pub external_w: f64,
}

/// A thermal-only prosumer unit; its state lives in the slice it is given.
///
/// Over each step `d stored = dt (-sum_ports |m| cp (T_out - T_in) + electric + external)` holds to rounding.
pub trait ThermalUnit {
    /// Where water passes it.
    fn ports(&self) -> Vec<UnitPort> {
        vec![UnitPort::ONLY]
    }

    /// Whether the unit takes heat out of what passes a port at positive flow: behind a station that is water from the
    /// hot line to the cold one, against the direction of feed-in.
    fn takes_heat(&self, _port: usize) -> bool {
        false
    }

    /// Whether it is what heat and cold are for: a load, rooms, hot water.
    fn serves(&self) -> bool {
        false
    }

    /// The input signals, in the order [`Signals`] presents them.
    fn inputs(&self) -> Vec<UnitInput>;

    /// The recorded outputs, in the order of `out` in [`Self::advance`].
    fn outputs(&self) -> Vec<UnitOutput>;

    /// State at the start of a run in which all water has `initial_k`.
    fn initial_state(&self, initial_k: f64) -> Vec<f64>;

    /// A step of `dt_s` is about to be asked for: what is wanted of the ports are means over it; 0 for a steady state.
    fn begin(&self, _dt_s: f64, _state: &mut [f64]) {}

    /// What the unit wants of its ports in the coming step; `got` is what they had in the last one, with the flows
    /// that circuits will have where it takes them. May be asked several times for a step.
    fn request(
        &self,
        signals: &Signals<'_>,
        got: &[PortFlow],
        state: &mut [f64],
        wanted: &mut [PortRequest],
    );

    /// A port that leads got its answer for this step, the others may be wanted otherwise.
    fn respond(
        &self,
        _port: usize,
        _signals: &Signals<'_>,
        _got: &[PortFlow],
        _state: &mut [f64],
        _wanted: &mut [PortRequest],
    ) {
    }

    /// Advances the unit by `dt_s` with what its ports got; 0 only settles its outputs.
    fn advance(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange;

    /// The longest step that it follows with these flows through its ports, s: a run makes shorter ones.
    fn longest_step_s(&self, _ports: &[PortFlow], _state: &[f64]) -> f64 {
        f64::INFINITY
    }

    /// Outputs that are worth an event.
    fn flags(&self) -> &'static [Flag] {
        &[]
    }

    /// What a user should know of how it was parametrised: warnings at the start of a run.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    /// Heat that it holds, J above 0 degC.
    fn stored_j(&self, _state: &[f64]) -> f64 {
        0.0
    }
}

/// A parameter of a unit that cannot be.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum UnitError {
    /// A number outside its range.
    #[error("{field} = {value} {requirement}")]
    OutOfRange {
        /// Field of the model file, in SI.
        field: &'static str,
        /// What was given.
        value: f64,
        /// For example `must be positive`.
        requirement: &'static str,
    },
    /// A temperature at which the medium is not liquid.
    #[error("{field} = {value} is no temperature of {what} ({min_degc} to {max_degc} degC)")]
    NotLiquid {
        /// Field of the model file, in SI.
        field: &'static str,
        /// What was given, K.
        value: f64,
        /// The medium.
        what: &'static str,
        /// Lowest temperature, degC.
        min_degc: f64,
        /// Highest temperature, degC.
        max_degc: f64,
    },
    /// Something within a field that is a table or a list.
    #[error("{problem}")]
    Within {
        /// Field of the model file, in SI.
        field: &'static str,
        /// Sentence naming what is wrong.
        problem: String,
    },
    /// Two fields of which exactly one must be given.
    #[error("{problem}")]
    Fields {
        /// Sentence naming the fields.
        problem: String,
    },
}

impl UnitError {
    /// The field concerned, where one field is.
    pub fn field(&self) -> Option<&'static str> {
        match self {
            Self::OutOfRange { field, .. }
            | Self::NotLiquid { field, .. }
            | Self::Within { field, .. } => Some(field),
            Self::Fields { .. } => None,
        }
    }
}

/// A unit may be this much larger than the one whose data it has.
const LARGEST_SCALE: f64 = 3.0;

/// The remark on a unit that was scaled further than its data carry.
pub(crate) fn scaled_far(factor: f64) -> Vec<String> {
    let far = !(1.0 / LARGEST_SCALE..=LARGEST_SCALE).contains(&factor);
    let remark = || {
        format!(
            "its size is {factor:.3} times that of the unit whose data it has: efficiency, start and stop \
             may differ"
        )
    };
    far.then(remark).into_iter().collect()
}

/// Heat per kelvin that a flow carries, W/K.
#[inline]
pub(crate) fn capacity_w_k(medium: &Medium, m_flow_kg_s: f64) -> f64 {
    m_flow_kg_s.abs() * medium.heat_capacity_j_kg_k
}

/// A number above zero.
///
/// # Errors
/// Names the field and its value.
pub(crate) fn positive(field: &'static str, value: f64) -> Result<f64, UnitError> {
    let requirement = "must be positive";
    match value {
        _ if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err(UnitError::OutOfRange { field, value, requirement }),
    }
}

/// A number that is not below zero.
///
/// # Errors
/// Names the field and its value.
pub(crate) fn not_negative(field: &'static str, value: f64) -> Result<f64, UnitError> {
    let requirement = "must not be negative";
    match value {
        _ if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err(UnitError::OutOfRange { field, value, requirement }),
    }
}

/// A number between 0 and 1.
///
/// # Errors
/// Names the field and its value.
pub(crate) fn share(field: &'static str, value: f64) -> Result<f64, UnitError> {
    match value {
        0.0..=1.0 => Ok(value),
        _ => Err(UnitError::OutOfRange { field, value, requirement: "must lie between 0 and 1" }),
    }
}
