//! The seam of a controller.

use thiserror::Error;

/// The fields of an entry that name what a controller measures and what it drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ports {
    /// Each names a channel; the order of [`Inputs::measured`].
    pub measures: &'static [&'static str],
    /// Each names a signal; the order of the outputs.
    pub acts_on: &'static [&'static str],
}

impl Ports {
    /// One channel in, one signal out.
    pub const SINGLE: Self = Self { measures: &["measures"], acts_on: &["acts_on"] };
}

/// When a controller updates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Time between two updates, s; 0 updates at every step.
    pub interval_s: f64,
    /// Time of the first update, s.
    pub offset_s: f64,
}

/// A value that the user sets, and that schedules can drive as the signal `id.name`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SetPoint {
    /// Name of the signal within the controller.
    pub name: &'static str,
    /// Suffix of its SI unit; empty where it is that of the measured signal.
    pub unit: &'static str,
    /// Value while nothing drives it.
    pub value: f64,
}

/// What a controller sees at an update.
#[derive(Debug, Clone, Copy)]
pub struct Inputs<'a> {
    /// Measured values, in the order of [`Ports::measures`].
    pub measured: &'a [f64],
    /// Set points, in the order of [`Controller::set_points`].
    pub set_points: &'a [f64],
    /// Smallest and largest value that each actuator can take.
    pub limits: &'a [(f64, f64)],
}

impl Inputs<'_> {
    /// The inputs, if all measured values are numbers.
    ///
    /// # Errors
    /// [`ControlError::Measured`].
    pub fn checked(&self) -> Result<&Self, ControlError> {
        match self.measured.iter().find(|value| !value.is_finite()) {
            Some(&measured) => Err(ControlError::Measured { measured }),
            None => Ok(self),
        }
    }
}

/// How far an output is from where it would stay.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Balance {
    /// Positive while the output should be larger, zero at rest.
    pub miss: f64,
    /// What is much for `miss`; positive.
    pub scale: f64,
}

/// A part of the state of a controller that is recorded as `id.name`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StateChannel {
    /// Name within the controller.
    pub name: &'static str,
    /// Unit of the channel.
    pub unit: &'static str,
    /// Its place in the state.
    pub place: usize,
    /// Kinds of the events when it becomes 1, and 0 again, where that is worth one.
    pub event: Option<[&'static str; 2]>,
}

/// A local controller; its state lives in the slice it is given.
pub trait Controller {
    /// When it updates.
    fn timing(&self) -> Timing;

    /// The values it is to hold.
    fn set_points(&self) -> Vec<SetPoint>;

    /// State at the start of a run.
    fn initial_state(&self) -> Vec<f64>;

    /// The parts of its state that others can see.
    fn channels(&self) -> &'static [StateChannel] {
        &[]
    }

    /// The words of an event of one of its channels.
    fn says(&self, _event: &str, _inputs: &Inputs, _outputs: &[f64]) -> String {
        String::new()
    }

    /// Reads the inputs and writes the outputs; `dt_s` is the time since the last update (0 at the
    /// first).
    ///
    /// # Errors
    /// [`ControlError`] when no output can be given.
    fn update(
        &self,
        dt_s: f64,
        inputs: &Inputs,
        state: &mut [f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError>;

    /// Smallest and largest value of an output, given those of its actuator.
    fn output_limits(&self, output: usize, actuator: (f64, f64)) -> (f64, f64);

    /// Smallest and largest value of an output with these inputs, where a mode narrows them; equal where the
    /// output is not in use.
    fn limits_now(&self, output: usize, inputs: &Inputs) -> (f64, f64) {
        self.output_limits(output, inputs.limits[output])
    }

    /// Whether these set points switch it off: it then holds nothing.
    fn is_off(&self, _set_points: &[f64]) -> bool {
        false
    }

    /// Whether the outputs would stay: in a steady state every miss is zero, or its output at the limit
    /// that it pushes against.
    fn balance(&self, inputs: &Inputs, outputs: &[f64], balance: &mut [Balance]);

    /// The state in which these outputs stay.
    fn rest(&self, inputs: &Inputs, outputs: &[f64], state: &mut [f64]);

    /// Whether the first measured value is to become the first set point.
    fn tracks(&self) -> bool;

    /// Proportional gain, actuator unit per SI unit of what is measured; the number by which a user
    /// makes the controller faster or slower.
    fn gain(&self) -> f64;
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
    /// Fields that do not fit each other.
    #[error("{problem}")]
    Fields {
        /// The first of them.
        field: &'static str,
        /// What does not fit.
        problem: String,
    },
    /// A controller of the user cannot answer.
    #[error("{problem}")]
    User {
        /// Its words.
        problem: String,
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
            Self::OutOfRange { field, .. } | Self::Fields { field, .. } => Some(field),
            Self::Measured { .. } | Self::User { .. } => None,
        }
    }
}

/// `value`, if it is a positive number.
pub(crate) fn positive(field: &'static str, value: f64) -> Result<f64, ControlError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(ControlError::OutOfRange { field, value, requirement: "must be positive" })
    }
}

/// `value`, if it is a number not below zero.
pub(crate) fn not_negative(field: &'static str, value: f64) -> Result<f64, ControlError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(ControlError::OutOfRange { field, value, requirement: "must not be negative" })
    }
}

/// `value`, if it is a number other than zero.
pub(crate) fn not_zero(field: &'static str, value: f64) -> Result<f64, ControlError> {
    if value.is_finite() && value != 0.0 {
        Ok(value)
    } else {
        Err(ControlError::OutOfRange { field, value, requirement: "must not be zero" })
    }
}

/// An actuator's limits, narrowed by those of the file: never beyond what the actuator can do.
pub(crate) fn narrowed((min, max): (f64, f64), low: Option<f64>, high: Option<f64>) -> (f64, f64) {
    let low = low.map_or(min, |low| low.clamp(min, max));
    let high = high.map_or(max, |high| high.clamp(min, max));
    (low, high.max(low))
}

/// The limits of an output, if they are in order.
pub(crate) fn ordered(min: Option<f64>, max: Option<f64>) -> Result<(), ControlError> {
    match (min, max) {
        (Some(min), Some(max)) if min >= max => Err(ControlError::OutOfRange {
            field: "output_min",
            value: min,
            requirement: "must be below output_max",
        }),
        _ => Ok(()),
    }
}
