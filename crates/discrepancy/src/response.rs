//! What a sensor makes of its quantity.
//!
//! **Equation** `y(t) = g x(t + clock) + b + drift s + step [s > s_step]`, `s` the share of the run that is over, behind a
//! first-order lag where it has one. A flow meter that shows no flow backward reads `max(y, min(g x, 0))`: an offset is seen at no
//! flow where it is positive only. The step takes a fiftieth of the run, so that its moment can be fitted.

use crate::data::Track;
use crate::unknown::Target;

/// Share of a run that a step takes.
pub(crate) const STEP_TAKES: f64 = 0.02;

/// The response of one sensor.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Response {
    bias: f64,
    gain: f64,
    /// Time constant beyond the one that is known, s.
    pub(crate) lag_s: f64,
    /// Its clock is late by this, s.
    pub(crate) clock_s: f64,
    drift: f64,
    step: f64,
    step_share: f64,
    /// Its offset shows no flow backward.
    pub(crate) one_way: bool,
}

impl Default for Response {
    fn default() -> Self {
        let (bias, lag_s, clock_s, drift, step, step_share) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.5);
        Self { bias, gain: 1.0, lag_s, clock_s, drift, step, step_share, one_way: false }
    }
}

impl Response {
    /// Takes one more flaw along.
    pub(crate) fn take(&mut self, flaw: &Target, value: f64) {
        match flaw {
            Target::Bias(_) => self.bias += value,
            Target::Gain(_) => self.gain *= value,
            Target::Lag(_) => self.lag_s += value,
            Target::Clock(_) | Target::Logger(_) => self.clock_s += value,
            Target::Drift(_) => self.drift += value,
            Target::Step(_) => self.step += value,
            Target::StepShare(_) => self.step_share = value,
            Target::Initial(_) | Target::Effect { .. } => {}
        }
    }

    /// Reading of a quantity at a time of a run.
    pub(crate) fn of(&self, quantity: f64, time_s: f64, span_s: (f64, f64)) -> f64 {
        let without = self.gain * quantity;
        let reading = without + self.offset(time_s, span_s);
        if self.one_way { reading.max(without.min(0.0)) } else { reading }
    }

    /// Quantity behind a reading.
    pub(crate) fn before(&self, reading: f64, time_s: f64, span_s: (f64, f64)) -> f64 {
        if self.one_way && reading <= 0.0 {
            return reading / self.gain;
        }
        (reading - self.offset(time_s, span_s)) / self.gain
    }

    /// What it reads of nothing.
    pub(crate) fn offset(&self, time_s: f64, span_s: (f64, f64)) -> f64 {
        let share = ((time_s - span_s.0) / (span_s.1 - span_s.0).max(1e-9)).clamp(0.0, 1.0);
        let stepped = ((share - self.step_share) / STEP_TAKES + 0.5).clamp(0.0, 1.0);
        self.bias + self.drift * share + self.step * stepped
    }
}

/// Behind a first-order lag: exact for a quantity that is straight between its points.
pub(crate) fn lagged(track: &Track, lag_s: f64) -> Track {
    if lag_s <= 0.0 {
        return track.clone();
    }
    let mut value = Vec::with_capacity(track.value.len());
    value.push(track.value[0]);
    for i in 1..track.value.len() {
        let dt = track.time_s[i] - track.time_s[i - 1];
        let slope = (track.value[i] - track.value[i - 1]) / dt;
        // y follows x = x0 + s t: y = x - s tau + (y0 - x0 + s tau) exp(-t/tau).
        let rest = value[i - 1] - track.value[i - 1] + slope * lag_s;
        value.push(track.value[i] - slope * lag_s + rest * (-dt / lag_s).exp());
    }
    Track { time_s: track.time_s.clone(), value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_shows_no_flow_backward() {
        let of = |bias: f64, quantity: f64| {
            let response = Response { bias, gain: 1.1, one_way: true, ..Response::default() };
            response.of(quantity, 0.0, (0.0, 1.0))
        };
        // 1.1 0.2 - 0.02; nothing, and what leaks backward, are not moved below zero, but up.
        assert!((of(-0.02, 0.2) - 0.20).abs() < 1e-12);
        assert_eq!((of(-0.02, 0.0), of(-0.02, 0.01)), (0.0, 0.0));
        assert!((of(-0.02, -1e-3) + 1.1e-3).abs() < 1e-12);
        assert!((of(0.02, 0.0) - 0.02).abs() < 1e-12);
        // Backward: what reads zero may be nothing, whatever the offset.
        let response = Response { bias: -0.02, gain: 1.1, one_way: true, ..Response::default() };
        assert_eq!(response.before(0.0, 0.0, (0.0, 1.0)), 0.0);
        assert!((response.before(0.2, 0.0, (0.0, 1.0)) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn a_lag_by_hand() {
        // A ramp of 1 K/s behind 10 s, after 10 s: 10 - 10 (1 - 1/e) = 3.6788 K.
        let times: Vec<f64> = (0..=10).map(f64::from).collect();
        let ramp = Track { value: times.clone(), time_s: times };
        assert!((lagged(&ramp, 10.0).value[10] - 3.678_794).abs() < 1e-6);
        assert_eq!(lagged(&ramp, 0.0), ramp);
    }

    #[test]
    fn a_reading_by_hand_and_back() {
        let mut response = Response::default();
        for (flaw, value) in [
            (Target::Bias(0), 1.0),
            (Target::Gain(0), 1.1),
            (Target::Drift(0), 2.0),
            (Target::Step(0), 0.5),
            (Target::StepShare(0), 0.25),
        ] {
            response.take(&flaw, value);
        }
        // Half of the run is over: 1.1 * 10 + 1 + 2 * 0.5 + 0.5 = 13.5.
        assert!((response.of(10.0, 50.0, (0.0, 100.0)) - 13.5).abs() < 1e-12);
        assert!((response.before(13.5, 50.0, (0.0, 100.0)) - 10.0).abs() < 1e-12);
        // Before the step: 1.1 * 10 + 1 + 0.4 = 12.4.
        assert!((response.of(10.0, 20.0, (0.0, 100.0)) - 12.4).abs() < 1e-12);
    }
}
