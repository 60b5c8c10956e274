//! Quantities on the straight lines of their last values.

use super::JUMP;
use serde::{Deserialize, Serialize};

/// Quantities with the lines that they were on.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Followed {
    pub(super) last: Vec<f64>,
    pub(super) rate: Vec<f64>,
    /// Length of the step that led to them, s.
    step_s: f64,
}

impl Followed {
    /// Largest ratio of what they miss after a step to their tolerances.
    pub fn miss(&self, dt_s: f64, now: impl Iterator<Item = (f64, f64)>) -> f64 {
        let share = self.share(dt_s);
        let lines = self.last.iter().zip(&self.rate);
        let ratio = |((last, rate), (now, tolerance)): ((&f64, &f64), (f64, f64))| {
            share * (now - last - rate * dt_s).abs() / tolerance
        };
        lines.zip(now).map(ratio).fold(0.0, f64::max)
    }

    fn share(&self, dt_s: f64) -> f64 {
        if dt_s > 0.0 { dt_s / (dt_s + self.step_s) } else { 0.0 }
    }

    /// Goes on from the values at the end of a step.
    pub fn keep(&mut self, dt_s: f64, now: impl Iterator<Item = (f64, f64)>) {
        if dt_s <= 0.0 {
            return;
        }
        let share = self.share(dt_s);
        let lines = self.last.iter_mut().zip(&mut self.rate);
        for ((last, rate), (now, tolerance)) in lines.zip(now) {
            let missed = share * (now - *last - *rate * dt_s).abs() / tolerance;
            *rate = if missed > JUMP { 0.0 } else { (now - *last) / dt_s };
            *last = now;
        }
        self.step_s = dt_s;
    }

    /// Values of the start, in which everything rests.
    pub fn rest(&mut self, now: impl Iterator<Item = (f64, f64)>) {
        self.last.clear();
        self.last.extend(now.map(|(value, _)| value));
        self.rate.clear();
        self.rate.resize(self.last.len(), 0.0);
        self.step_s = 0.0;
    }

    /// Values at the end of the last step.
    pub fn last(&self) -> &[f64] {
        &self.last
    }

    /// Length of the step that led to the values, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    pub fn fits(&self, other: &Self) -> bool {
        self.last.len() == other.last.len() || self.last.is_empty() || other.last.is_empty()
    }
}
