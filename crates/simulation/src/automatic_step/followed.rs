//! Quantities on the straight lines of their last values, and one number for what all of them miss.
//!
//! **Equation** with the ratio r_i of each quantity to its tolerance and the flow m_i that it belongs to
//! ```text
//! r = max( sqrt(sum m_i r_i^2 / sum m_i),  max sqrt(m_i/M) r_i )
//! ```
//! M the largest flow of the network. The first is the weighted root mean square of solvers of differential equations,
//! taken over the water that flows, so that a thousand valves of which some are fast are judged by all of them. The second
//! keeps single loops from being lost among quiet ones: errors of loops that know nothing of each other add as their
//! squares, and one that has a share of the flow may miss its tolerance by one over the root of that share. What all the
//! flow passes has to meet its tolerance itself, as all of a model with few loops.
//! **Sources** `hairer1993` (II.4, the root mean square).

use super::JUMP;
use serde::{Deserialize, Serialize};

/// A followed quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Quantity {
    pub value: f64,
    pub tolerance: f64,
    /// Flow that it belongs to.
    pub m_flow_kg_s: f64,
}

/// Quantities with the lines that they were on.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Followed {
    pub(super) last: Vec<f64>,
    pub(super) rate: Vec<f64>,
    /// Length of the step that led to them, s.
    step_s: f64,
}

impl Followed {
    /// Ratio of what they miss after a step to their tolerances, where `largest_kg_s` is the largest flow.
    pub fn miss(&self, dt_s: f64, largest_kg_s: f64, now: impl Iterator<Item = Quantity>) -> f64 {
        let share = self.share(dt_s);
        let (mut squares, mut flows, mut single) = (0.0, 0.0, 0.0_f64);
        for ((last, rate), now) in self.last.iter().zip(&self.rate).zip(now) {
            let ratio = share * (now.value - last - rate * dt_s).abs() / now.tolerance;
            // Where nothing flows all count the same.
            let part = if largest_kg_s > 0.0 { now.m_flow_kg_s / largest_kg_s } else { 1.0 };
            squares += part * ratio * ratio;
            flows += part;
            single = single.max(part.sqrt() * ratio);
        }
        if flows > 0.0 { single.max((squares / flows).sqrt()) } else { 0.0 }
    }

    fn share(&self, dt_s: f64) -> f64 {
        if dt_s > 0.0 { dt_s / (dt_s + self.step_s) } else { 0.0 }
    }

    /// Goes on from the values at the end of a step.
    pub fn keep(&mut self, dt_s: f64, now: impl Iterator<Item = Quantity>) {
        if dt_s <= 0.0 {
            return;
        }
        let share = self.share(dt_s);
        let lines = self.last.iter_mut().zip(&mut self.rate);
        for ((last, rate), now) in lines.zip(now) {
            let missed = share * (now.value - *last - *rate * dt_s).abs() / now.tolerance;
            *rate = if missed > JUMP { 0.0 } else { (now.value - *last) / dt_s };
            *last = now.value;
        }
        self.step_s = dt_s;
    }

    /// Values of the start, in which everything rests.
    pub fn rest(&mut self, now: impl Iterator<Item = Quantity>) {
        self.last.clear();
        self.last.extend(now.map(|now| now.value));
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
