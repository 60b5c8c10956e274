//! The seam of a controller.

use thiserror::Error;

/// A local controller; its state lives in the slice it is given.
pub trait Controller {
    /// Time between two updates, s; 0 updates at every step.
    fn interval_s(&self) -> f64;

    /// State at the start of a run.
    fn initial_state(&self) -> Vec<f64>;

    /// Reads `measured` and writes `outputs`; `dt_s` is the time since the last update (0 at the first),
    /// `limits` are the smallest and largest useful output.
    ///
    /// # Errors
    /// [`ControlError`] when no output can be given.
    fn update(
        &self,
        dt_s: f64,
        measured: f64,
        set_point: f64,
        limits: (f64, f64),
        state: &mut [f64],
    ) -> Result<f64, ControlError>;

    /// Smallest and largest output, given those of the actuator.
    fn output_limits(&self, actuator: (f64, f64)) -> (f64, f64);

    /// +1 when a larger output is the answer to a measured value below the set point, -1 otherwise.
    fn direction(&self) -> f64;

    /// Set point while nothing drives it.
    fn set_point(&self) -> f64;
}

/// A controller that cannot be, or cannot answer.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum ControlError {
    /// A parameter outside its range.
    #[error("{field} = {value} {requirement}")]
    OutOfRange {
        /// Field of the model file, in SI.
        field: &'static str,
        /// What was given.
        value: f64,
        /// For example `must be positive`.
        requirement: &'static str,
    },
    /// The measured value is not a number.
    #[error("the measured value is {measured}")]
    Measured {
        /// The value.
        measured: f64,
    },
}

impl ControlError {
    /// The field concerned, where one field is.
    pub fn field(&self) -> Option<&'static str> {
        match self {
            Self::OutOfRange { field, .. } => Some(field),
            Self::Measured { .. } => None,
        }
    }
}
