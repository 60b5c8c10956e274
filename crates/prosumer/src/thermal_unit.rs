//! The seam between the network and what stands behind a hydraulic interface.

use anergy_core::medium::Medium;
use anergy_core::port::{PortFlow, PortRequest};
use anergy_core::signal::Signals;
use thiserror::Error;

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
}

/// A recorded output of a unit: name with SI suffix, UDUNITS unit.
pub type UnitOutput = (&'static str, &'static str);

/// A thermal-only prosumer unit; its state lives in the slice it is given.
pub trait ThermalUnit {
    /// The input signals, in the order [`Signals`] presents them.
    fn inputs(&self) -> Vec<UnitInput>;

    /// The recorded outputs, in the order of `out` in [`Self::advance`].
    fn outputs(&self) -> &'static [UnitOutput];

    /// State at the start of a run in which all water has `initial_k`.
    fn initial_state(&self, initial_k: f64) -> Vec<f64>;

    /// What the unit wants of its ports in the coming step.
    fn request(&self, state: &[f64], signals: &Signals<'_>, wanted: &mut [PortRequest]);

    /// Advances the unit by `dt_s` with what its ports got.
    fn advance(
        &self,
        dt_s: f64,
        ports: &[PortFlow],
        signals: &Signals<'_>,
        state: &mut [f64],
        out: &mut [f64],
    );
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
            Self::OutOfRange { field, .. } | Self::NotLiquid { field, .. } => Some(field),
            Self::Fields { .. } => None,
        }
    }
}

/// Heat per kelvin that a flow carries, W/K.
#[inline]
pub(crate) fn capacity_w_k(medium: &Medium, m_flow_kg_s: f64) -> f64 {
    m_flow_kg_s.abs() * medium.heat_capacity_j_kg_k
}
