//! How badly readings fit, so that a few far ones do not decide.
//!
//! **Equation** mean of `ln(1 + z^2)`, `z` the residual over `sqrt(noise^2 + (jitter dy/dt)^2 + offset^2 + (gain y)^2)`: about 0.5 where
//! all is well, 2.3 where residuals are three standard deviations.

use crate::data::Track;
use crate::experiment::Experiment;
use crate::sensors::Role;
use crate::uncertainty::{interval_s, jitter_s};

/// Two readings further apart than this, in usual intervals, say nothing of what lies between them.
const APART: f64 = 2.5;

/// A compared column of one run beside its simulation.
pub(super) struct Column {
    /// Its sensor.
    pub sensor: usize,
    /// Its run.
    pub run: usize,
    /// As measured.
    pub measured: Track,
    /// As simulated, at the same times.
    pub simulated: Track,
    /// Standard deviation of every reading.
    pub sigma: Vec<f64>,
    /// Usual interval, s.
    pub interval_s: f64,
}

/// All compared columns.
pub(super) fn columns(experiment: &Experiment, readings: &[f64]) -> Vec<Column> {
    let mut columns: Vec<Column> = Vec::new();
    for (sample, reading) in experiment.samples.iter().zip(readings) {
        let (sensor, run) = (sample.sensor, sample.run);
        if columns.last().is_none_or(|c| (c.sensor, c.run) != (sensor, run)) {
            let measured = experiment.runs[run].tracks[sensor].clone();
            let interval_s = interval_s(&measured);
            let sigma = sigma(experiment, sensor, &measured);
            let simulated = Track { time_s: measured.time_s.clone(), value: Vec::new() };
            columns.push(Column { sensor, run, measured, simulated, sigma, interval_s });
        }
        if let Some(column) = columns.last_mut() {
            column.simulated.value.push(*reading);
        }
    }
    columns
}

fn sigma(experiment: &Experiment, sensor: usize, track: &Track) -> Vec<f64> {
    let accuracy = experiment.accuracy[sensor];
    // Temperatures that drive the model are no better.
    let sensors = experiment.sensors.sensor.iter().zip(&experiment.accuracy);
    let inputs = sensors.filter(|(s, _)| s.role == Role::Input && s.si() == "k");
    let driven = if experiment.sensors.sensor[sensor].si() == "k" {
        inputs.map(|(_, accuracy)| accuracy.bias).fold(0.0, f64::max)
    } else {
        0.0
    };
    let (t, y, jitter_s) = (&track.time_s, &track.value, jitter_s(track));
    let one = |i: usize| {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(t.len() - 1));
        let dt_s = (t[after] - t[before]).max(1e-9);
        let moved = (y[after] - y[before]) / dt_s * jitter_s;
        let of_value = accuracy.gain * y[i];
        let squares = [accuracy.noise, moved, accuracy.bias, of_value, driven].map(|x| x * x);
        squares.iter().sum::<f64>().sqrt()
    };
    (0..t.len()).map(one).collect()
}

impl Column {
    /// Misfit of its readings between two times, beside a simulation that runs ahead by `ahead_s`; none where too few lie beside
    /// readings of it.
    pub(super) fn beside(
        &self,
        simulated: &Track,
        (from_s, until_s): (f64, f64),
        ahead_s: f64,
    ) -> Option<f64> {
        let t = &self.measured.time_s;
        let (first, last) =
            (t.partition_point(|t| *t < from_s), t.partition_point(|t| *t < until_s));
        let (mut sum, mut count) = (0.0, 0.0);
        for (i, time_s) in t.iter().enumerate().take(last).skip(first) {
            if let Some(x) = between(simulated, time_s + ahead_s, APART * self.interval_s) {
                let z = (self.measured.value[i] - x) / self.sigma[i];
                (sum, count) = (sum + (z * z).ln_1p(), count + 1.0);
            }
        }
        (count >= FEWEST.max(0.6 * (last - first) as f64)).then_some(sum / count)
    }

    /// Misfit of all its readings.
    pub(super) fn misfit(&self) -> Option<f64> {
        self.beside(&self.simulated, (f64::NEG_INFINITY, f64::INFINITY), 0.0)
    }
}

/// Fewer readings say nothing.
const FEWEST: f64 = 15.0;

/// Linear between two readings that are no further apart than this.
fn between(track: &Track, time_s: f64, apart_s: f64) -> Option<f64> {
    let t = &track.time_s;
    let i = t.partition_point(|t| *t <= time_s);
    let on = i > 0 && t[i - 1] == time_s;
    let inside = i > 0 && i < t.len() && t[i] - t[i - 1] <= apart_s;
    (on || inside).then(|| track.at(time_s))
}
