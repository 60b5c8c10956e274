//! Step responses of what temperatures take part in: short runs of the model itself with open loops.
//!
//! **Method** in the steady state all signals are frozen; one output after the other is moved up and down by a
//! small step, its actuator at once, and the measured values are followed until they rest. **Equation** the
//! response r, straight between its samples, is the transfer `R(s) = sum (r_k - r_(k-1)) exp(-s t_(k-1))
//! (1 - exp(-s h))/(s h)`. Transport, mixing, exchangers and units are so those of the simulation.
//! **Assumptions** the answer is linear for small steps; inputs stay what they are at the operating point.

use crate::error::RunError;
use crate::simulation::Simulation;
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
use nalgebra::Complex;

/// Step of an output, relative to its range.
const STEP: f64 = 2e-3;
/// A response rests when its last third changes by less than this share of its largest value.
const RESTS: f64 = 2e-3;
const FIRST_SAMPLES: usize = 256;
const MOST_SAMPLES: usize = 16_384;

/// Answer of a measured value to a unit step of an output, without the lags of actuator and sensor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StepResponse {
    interval_s: f64,
    /// Increments of the response from sample to sample.
    increments: Vec<f64>,
}

impl StepResponse {
    fn new(interval_s: f64, values: &[f64]) -> Self {
        let before = std::iter::once(&0.0).chain(values);
        let mut increments: Vec<f64> =
            values.iter().zip(before).map(|(now, before)| now - before).collect();
        let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let settled = increments.iter().rposition(|step| step.abs() > 1e-9 * largest);
        increments.truncate(settled.map_or(0, |last| last + 1));
        Self { interval_s, increments }
    }

    /// The transfer at a complex frequency, 1/s.
    pub fn at(&self, s: Complex<f64>) -> Complex<f64> {
        let x = s * self.interval_s;
        let one_later = (-x).exp();
        let spread = if x.norm() < 1e-8 { Complex::new(1.0, 0.0) } else { (1.0 - one_later) / x };
        let mut sum = Complex::new(0.0, 0.0);
        for step in self.increments.iter().rev() {
            sum = sum * one_later + *step;
        }
        sum * spread
    }

    /// What it comes to.
    pub fn settled(&self) -> f64 {
        self.increments.iter().sum()
    }

    /// Time until it has made nine tenths of its moves, s.
    #[allow(clippy::cast_precision_loss)]
    pub fn time_s(&self) -> f64 {
        let all: f64 = self.increments.iter().map(|step| step.abs()).sum();
        let mut moved = 0.0;
        let most = self.increments.iter().position(|step| {
            moved += step.abs();
            moved >= 0.9 * all
        });
        most.map_or(0.0, |k| (k + 1) as f64 * self.interval_s)
    }
}

/// Responses of what `read` reads to a step of each output with its limits; `[output][value]`. The simulation
/// is left as it was.
///
/// # Errors
/// What a run can fail of.
pub(super) fn responses(
    simulation: &mut Simulation,
    outputs: &[(SignalId, (f64, f64))],
    read: &dyn Fn(&Simulation) -> Vec<f64>,
) -> Result<Vec<Vec<StepResponse>>, RunError> {
    let rest = simulation.snapshot();
    let interval = simulation.plan().step;
    let found = outputs
        .iter()
        .map(|(signal, (min, max))| {
            let range = if (max - min).is_finite() { max - min } else { 1.0 };
            let value = rest.signals[signal.index()];
            let up = (value + STEP * range).min(*max);
            let down = (value - STEP * range).max(*min);
            let mut samples = FIRST_SAMPLES;
            loop {
                let high = run(simulation, &rest, *signal, up, interval, samples, read)?;
                let low = run(simulation, &rest, *signal, down, interval, samples, read)?;
                let per_unit = 1.0 / (up - down);
                let values = high.iter().zip(&low).map(|(high, low)| -> Vec<f64> {
                    high.iter().zip(low).map(|(high, low)| (high - low) * per_unit).collect()
                });
                let values: Vec<Vec<f64>> = values.collect();
                if samples >= MOST_SAMPLES || values.iter().all(|values| rests(values)) {
                    let response = |values: &Vec<f64>| StepResponse::new(interval.as_s(), values);
                    return Ok(values.iter().map(response).collect());
                }
                samples *= 2;
            }
        })
        .collect();
    simulation.restore(&rest)?;
    found
}

/// Whether a response has come to rest.
fn rests(values: &[f64]) -> bool {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let last = &values[values.len() / 3 * 2..];
    let (low, high) = last
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    high - low <= RESTS * largest && largest > 0.0
}

/// Measured values, `[value][sample]`, while a signal is frozen at a value and all others where they are.
fn run(
    simulation: &mut Simulation,
    rest: &crate::state::State,
    signal: SignalId,
    value: f64,
    interval: Time,
    samples: usize,
    read: &dyn Fn(&Simulation) -> Vec<f64>,
) -> Result<Vec<Vec<f64>>, RunError> {
    simulation.restore(rest)?;
    let state = simulation.state_mut();
    state.taken_over.fill(true);
    state.signals[signal.index()] = value;
    simulation.arrive();
    let mut values: Vec<Vec<f64>> = Vec::new();
    for _ in 0..samples {
        let end = simulation.time() + interval;
        simulation.advance_to(end, interval)?;
        let now = read(simulation);
        values.resize_with(now.len(), || Vec::with_capacity(samples));
        values.iter_mut().zip(now).for_each(|(values, now)| values.push(now));
    }
    let _ = simulation.take_events();
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_lag_has_its_transfer() {
        // 3 s late, then 5 s of lag: exp(-3 s)/(1 + 5 s)
        let h = 0.01;
        let value = |k: usize| {
            let t = (k + 1) as f64 * h - 3.0;
            if t > 0.0 { 1.0 - (-t / 5.0).exp() } else { 0.0 }
        };
        let values: Vec<f64> = (0..10_000).map(value).collect();
        let response = StepResponse::new(h, &values);
        for s in [Complex::new(0.0, 0.3), Complex::new(0.02, 1.0)] {
            let exact = (-s * 3.0).exp() / (s * 5.0 + 1.0);
            assert!((response.at(s) - exact).norm() < 1e-4);
        }
        assert!((response.settled() - 1.0).abs() < 1e-6);
        assert!((response.time_s() - (3.0 + 5.0 * 10.0_f64.ln())).abs() < 0.05);
    }
}
