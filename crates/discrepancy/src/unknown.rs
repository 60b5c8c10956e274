//! What is not exactly known: accuracy of the sensors, tolerances of the model, strength of an effect.
//!
//! An unknown has a prior: the normal distribution of its coordinate around a mean, or, where limits are stated (the largest
//! permissible error of a sensor, a tolerance of a length), anything within them. The coordinate of a strength that spans decades is
//! its logarithm.
//!
//! **Equation** with `u = (x - mean)/sd` the logarithm of the density falls by `u^2/2`; of a range of limits `+-h`, `sd = h/root 3`,
//! by `(0.1 u^2 + max(|u| - root 3, 0)^2/0.35^2)/2`: at its limit by 0.15, where a normal distribution of this standard deviation has
//! fallen by 1.5 as if many at their limits at once were a wonder, and at twice the limit by 12.8, where that has by 6 only.

use nalgebra::{DMatrix, Dyn, Matrix, Storage};
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
    /// Whether it is known to lie within limits, root 3 standard deviations from the middle, and anywhere there is as likely.
    pub limited: bool,
}

/// Half of a range of limits over its standard deviation.
pub(crate) const ROOT3: f64 = 1.732_050_807_568_877_2;
/// What is left within limits of the pull of a normal distribution to its middle, that what data do not say has a value at all.
const PULL: f64 = 0.1;
/// How far beyond its limits a quantity may be, standard deviations of its range: a fifth of the half of it.
const SOFT: f64 = 0.35;

impl Unknown {
    /// A coordinate that is the value itself.
    pub fn plain(target: Target, mean: f64, sd: f64) -> Self {
        Self { target, logarithmic: false, mean, sd, start: mean, limited: false }
    }

    /// The same within limits, of which its standard deviation is a root of three, if these are stated.
    #[must_use]
    pub fn limited(self, are_stated: bool) -> Self {
        Self { limited: are_stated, ..self }
    }

    /// Coordinate in standard deviations from the middle, and how far beyond its limits.
    fn far(&self, coordinate: f64) -> (f64, f64) {
        let far = (coordinate - self.mean) / self.sd;
        let beyond = if self.limited { (far.abs() - ROOT3).max(0.0).copysign(far) } else { 0.0 };
        (far, beyond)
    }

    fn pull_to_middle(&self) -> f64 {
        if self.limited { PULL } else { 1.0 }
    }

    /// Twice the fall of the logarithm of its density from the middle.
    pub fn fall(&self, coordinate: f64) -> f64 {
        let (far, beyond) = self.far(coordinate);
        self.pull_to_middle() * far.powi(2) + (beyond / SOFT).powi(2)
    }

    /// Half the slope of [`Unknown::fall`].
    pub fn slope(&self, coordinate: f64) -> f64 {
        let (far, beyond) = self.far(coordinate);
        (self.pull_to_middle() * far + beyond / SOFT.powi(2)) / self.sd
    }

    /// Half of the curvature of [`Unknown::fall`] that a normal distribution of this standard deviation has.
    pub fn precision(&self) -> f64 {
        self.sd.powi(-2)
    }

    /// Half its curvature there.
    pub fn curvature(&self, coordinate: f64) -> f64 {
        let (_, beyond) = self.far(coordinate);
        let outside = if beyond == 0.0 { 0.0 } else { SOFT.powi(-2) };
        (self.pull_to_middle() + outside) / self.sd.powi(2)
    }

    /// A value that lies between two bounds with 95 % probability, on a logarithmic scale.
    pub fn between(target: Target, low: f64, high: f64) -> Self {
        // 2 * 1.96 standard deviations between the bounds.
        let (mean, sd) = (0.5 * (low.ln() + high.ln()), (high / low).ln() / 3.92);
        Self { target, logarithmic: true, mean, sd, start: mean, limited: false }
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

/// `j^T j`, by products of blocks (`tr_mul` takes one column after the other).
pub(crate) fn square<S: Storage<f64, Dyn, Dyn>>(j: &Matrix<f64, Dyn, Dyn, S>) -> DMatrix<f64> {
    j.transpose() * j
}

/// Curvature of half of what a fit of unknowns minimises: sensitivities of its residuals, and curvatures of the priors of all in order.
pub(crate) fn curvature(
    sensitivity: &DMatrix<f64>,
    priors: impl Iterator<Item = f64>,
) -> DMatrix<f64> {
    let mut hessian = square(sensitivity);
    for (i, prior) in priors.enumerate() {
        hessian[(i, i)] += prior;
    }
    hessian
}

/// The same for a step from a place.
pub(crate) fn curvature_at(
    sensitivity: &DMatrix<f64>,
    unknowns: &[Unknown],
    at: &[f64],
) -> DMatrix<f64> {
    curvature(sensitivity, unknowns.iter().zip(at).map(|(u, x)| u.curvature(*x)))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_free_within_and_steep_beyond() {
        let free = Unknown::plain(Target::Bias(0), 1.0, 0.2);
        let limited = free.clone().limited(true);
        // u = 1, root 3 and 2 root 3; 0.1, 0.3 and 0.1 12 + 3/0.1225 = 25.69.
        let at = |u: f64| 1.0 + 0.2 * u;
        for (u, usual, within) in [(1.0, 1.0, 0.1), (ROOT3, 3.0, 0.3), (-2.0 * ROOT3, 12.0, 25.69)]
        {
            assert!((free.fall(at(u)) - usual).abs() < 1e-9);
            assert!((limited.fall(at(u)) - within).abs() < 1e-3, "{}", limited.fall(at(u)));
        }
        // Slope and curvature by differences.
        for unknown in [free, limited] {
            for u in [-3.0, -1.0, 0.5, 2.5] {
                let (x, d) = (at(u), 1e-4);
                let (less, more) = (unknown.fall(x - d), unknown.fall(x + d));
                assert!((unknown.slope(x) - 0.25 * (more - less) / d).abs() < 1e-5);
                let bent = 0.5 * (more + less - 2.0 * unknown.fall(x)) / (d * d);
                assert!((unknown.curvature(x) - bent).abs() < 1e-3 * bent);
            }
        }
    }
}
