//! What is not exactly known: accuracy of the sensors, tolerances of the model, strength of an effect.
//!
//! An unknown has a prior: the normal distribution of its coordinate around a mean. The coordinate of a
//! strength that spans decades is its logarithm.

use serde::Serialize;
use std::fmt;

/// What an unknown changes.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Target {
    /// Offset of a sensor, SI.
    Bias(usize),
    /// Gain of a sensor.
    Gain(usize),
    /// Time constant of a sensor, s.
    Lag(usize),
    /// The clock of a sensor is late by this time, s.
    Clock(usize),
    /// The clock of a logger is late by this time, s: that of this sensor, and of all that share it.
    Logger(usize),
    /// A sensor drifts by this from the beginning of a run to its end, SI.
    Drift(usize),
    /// The readings of a sensor jump by this within a run, SI.
    Step(usize),
    /// Share of a run that is over when they jump.
    StepShare(usize),
    /// The water of a run begins warmer by this than the mean of the temperatures read first, K.
    Initial(usize),
    /// A parameter of an effect of the model file.
    Effect {
        /// Word of the catalogue.
        id: &'static str,
        /// Component of the model.
        component: String,
        /// Its parameter, SI.
        field: &'static str,
    },
}

impl Target {
    /// The sensor that it is a flaw of.
    pub fn sensor(&self) -> Option<usize> {
        match self {
            Self::Bias(i)
            | Self::Gain(i)
            | Self::Lag(i)
            | Self::Clock(i)
            | Self::Drift(i)
            | Self::Step(i)
            | Self::StepShare(i) => Some(*i),
            Self::Logger(_) | Self::Initial(_) | Self::Effect { .. } => None,
        }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of_sensor = |f: &mut fmt::Formatter<'_>, what: &str, i: &usize| {
            write!(f, "{what} of sensor {}", i + 1)
        };
        match self {
            Self::Bias(i) => of_sensor(f, "offset", i),
            Self::Gain(i) => of_sensor(f, "gain", i),
            Self::Lag(i) => of_sensor(f, "lag", i),
            Self::Clock(i) => of_sensor(f, "clock", i),
            Self::Logger(i) => of_sensor(f, "logger", i),
            Self::Drift(i) => of_sensor(f, "drift", i),
            Self::Step(i) => of_sensor(f, "jump", i),
            Self::StepShare(i) => of_sensor(f, "moment of the jump", i),
            Self::Initial(run) => write!(f, "temperature at the start of run {}", run + 1),
            Self::Effect { id, component, field } => write!(f, "{id} of {component} ({field})"),
        }
    }
}

/// An unknown with its prior.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    /// What it changes.
    pub target: Target,
    /// Whether the coordinate is the logarithm of the value.
    pub logarithmic: bool,
    /// Mean of the coordinate.
    pub mean: f64,
    /// Standard deviation of the coordinate.
    pub sd: f64,
    /// Coordinate at which a fit starts.
    pub start: f64,
}

impl Unknown {
    /// A coordinate that is the value itself.
    pub fn plain(target: Target, mean: f64, sd: f64) -> Self {
        Self { target, logarithmic: false, mean, sd, start: mean }
    }

    /// A value that lies between two bounds with 95 % probability, on a logarithmic scale.
    pub fn between(target: Target, low: f64, high: f64) -> Self {
        // 2 * 1.96 standard deviations between the bounds.
        let (mean, sd) = (0.5 * (low.ln() + high.ln()), (high / low).ln() / 3.92);
        Self { target, logarithmic: true, mean, sd, start: mean }
    }

    /// The same prior, a fit starts at another value.
    #[must_use]
    pub fn starting_at(self, value: f64) -> Self {
        let start = if self.logarithmic { value.ln() } else { value };
        Self { start, ..self }
    }

    /// Value of a coordinate.
    pub fn value(&self, coordinate: f64) -> f64 {
        if self.logarithmic { coordinate.exp() } else { coordinate }
    }
}

/// A fitted value with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}
