//! Whether a quantity swings: turning points, their period and amplitude.
//!
//! **Method** a turning point is confirmed when the quantity has come back from it by half of the least swing.
//! It swings when the last [`TURNS`] turning points lie at least the least swing apart, every two of a kind
//! are between the shortest and the longest period apart, and these periods are alike; it rests when the next
//! turning point is more than one and a half periods late. Two quantities that swing with like periods have
//! the correlation `cos(2 pi lag/period)` of their fundamental waves, the lag taken between their turning
//! points. **Sources** specification 4.3 (peak-to-peak above 20 % of the set value over three periods,
//! correlation below -0.5).

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Turning points that make a swing: three periods.
pub const TURNS: usize = 7;
/// Periods of one swing differ by less than this factor.
const ALIKE: f64 = 1.5;
/// A turning point this late, in periods, ends a swing.
const LATE: f64 = 1.5;

/// What counts as a swing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    /// Shortest period, s.
    pub shortest_s: f64,
    /// Longest period, s.
    pub longest_s: f64,
}

/// Extreme value and when it was.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Turn {
    time_s: f64,
    value: f64,
}

/// What is remembered of a quantity.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Swing {
    rising: bool,
    /// The most extreme value since the last turning point.
    extreme: Turn,
    /// Turning points, the last one first; maxima and minima take turns.
    turns: [Turn; TURNS],
    known: usize,
    begun: bool,
    /// Whether it swings.
    swinging: bool,
}

impl Swing {
    /// The quantity is `value` at a time; swings below `least` peak to peak do not count. Returns whether
    /// it swings.
    pub fn follow(&mut self, time_s: f64, value: f64, least: f64, criterion: Criterion) -> bool {
        let now = Turn { time_s, value };
        if !self.begun {
            (self.begun, self.extreme) = (true, now);
        }
        let further =
            if self.rising { value >= self.extreme.value } else { value <= self.extreme.value };
        if further {
            self.extreme = now;
        } else if (value - self.extreme.value).abs() > 0.5 * least {
            self.turns.rotate_right(1);
            self.turns[0] = self.extreme;
            self.known = (self.known + 1).min(TURNS);
            (self.rising, self.extreme) = (!self.rising, now);
            self.swinging = self.is_swing(least, criterion);
        }
        if self.swinging && time_s - self.turns[0].time_s > LATE * self.period_s() {
            (self.swinging, self.known) = (false, 0);
        }
        self.swinging
    }

    fn is_swing(&self, least: f64, criterion: Criterion) -> bool {
        if self.known < TURNS {
            return false;
        }
        let wide = self.turns.windows(2).all(|pair| (pair[0].value - pair[1].value).abs() >= least);
        let periods = self.turns.windows(3).map(|three| three[0].time_s - three[2].time_s);
        let (shortest, longest) = periods.fold((f64::INFINITY, 0.0_f64), |(low, high), period| {
            (low.min(period), high.max(period))
        });
        wide && shortest >= criterion.shortest_s
            && longest <= criterion.longest_s
            && longest < ALIKE * shortest
    }

    /// Whether it swings.
    pub fn swinging(&self) -> bool {
        self.swinging
    }

    /// Mean period of the known turning points, s.
    pub fn period_s(&self) -> f64 {
        if self.known < 3 {
            return f64::INFINITY;
        }
        #[allow(clippy::cast_precision_loss)]
        let halves = (self.known - 1) as f64;
        2.0 * (self.turns[0].time_s - self.turns[self.known - 1].time_s) / halves
    }

    /// Mean distance of neighbouring turning points.
    pub fn peak_to_peak(&self) -> f64 {
        let known = &self.turns[..self.known];
        let sum: f64 = known.windows(2).map(|pair| (pair[0].value - pair[1].value).abs()).sum();
        #[allow(clippy::cast_precision_loss)]
        let n = known.len().saturating_sub(1).max(1) as f64;
        sum / n
    }

    /// Middle between the turning points.
    pub fn middle(&self) -> f64 {
        let known = &self.turns[..self.known];
        let sum: f64 = known.windows(2).map(|pair| 0.5 * (pair[0].value + pair[1].value)).sum();
        #[allow(clippy::cast_precision_loss)]
        let n = known.len().saturating_sub(1).max(1) as f64;
        sum / n
    }

    /// Correlation with another swing; `None` where the periods are not alike or one does not swing.
    pub fn correlation(&self, other: &Self) -> Option<f64> {
        let period_s = self.period_s();
        let alike = period_s < ALIKE * other.period_s() && other.period_s() < ALIKE * period_s;
        // One that has just begun is known by two periods.
        if self.known < 5 || other.known < 5 || !alike {
            return None;
        }
        // Turning points of one kind: while rising, the last one was a minimum.
        let shift = usize::from(self.rising != other.rising);
        let mut sum = 0.0;
        for turn in &self.turns[..4] {
            let lag_s = other.turns[..other.known]
                .iter()
                .enumerate()
                .filter(|(k, _)| {
                    let own = self.turns[..4].iter().position(|t| t == turn).unwrap_or(0);
                    (k + own + shift) % 2 == 0
                })
                .map(|(_, other)| other.time_s - turn.time_s)
                .min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
            sum += (TAU * lag_s / period_s).cos();
        }
        Some(0.25 * sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAST: Criterion = Criterion { shortest_s: 4.0, longest_s: 60.0 };

    /// Follows `f` for 100 s.
    fn followed(f: impl Fn(f64) -> f64) -> Swing {
        let mut swing = Swing::default();
        for k in 0..1000 {
            let t = 0.1 * f64::from(k);
            swing.follow(t, f(t), 0.5, FAST);
        }
        swing
    }

    #[test]
    fn period_amplitude_and_phase_of_waves_are_found() {
        let wave = |phase: f64| followed(move |t| 3.0 + (TAU * t / 10.0 + phase).sin());
        let swing = wave(0.0);
        assert!(swing.swinging());
        assert!(
            (swing.period_s() - 10.0).abs() < 0.05 && (swing.peak_to_peak() - 2.0).abs() < 0.01
        );
        assert!((swing.middle() - 3.0).abs() < 0.01);
        for phase in [0.0, 0.7, 1.6, 2.5, 3.1, 4.0, 5.5] {
            let correlation = swing.correlation(&wave(phase)).unwrap();
            assert!((correlation - phase.cos()).abs() < 0.05, "{phase}: {correlation}");
        }
    }

    #[test]
    fn small_slow_decaying_and_single_moves_are_no_swings() {
        assert!(!followed(|t| 0.2 * (TAU * t / 10.0).sin()).swinging(), "small");
        assert!(!followed(|t| (TAU * t / 90.0).sin()).swinging(), "slow");
        assert!(!followed(|t| (TAU * t / 2.0).sin()).swinging(), "fast");
        let decaying = followed(|t| 2.0 * (-t / 15.0).exp() * (TAU * t / 10.0).sin());
        assert!(!decaying.swinging(), "decaying");
        assert!(!followed(|t| if t > 50.0 { 2.0 } else { 0.0 }).swinging(), "step");
        // It ends one and a half periods after the last turning point.
        let ended = followed(|t| if t < 60.0 { (TAU * t / 10.0).sin() } else { 0.0 });
        assert!(!ended.swinging(), "ended");
    }
}
