//! The next measurement: what would tell the members of a class apart, by simulation.
//!
//! **Equation** each member `a` of a class, at its fitted values, foretells the readings `y_a` of an addition to what was
//! measured; its rival `b`, fitted to what was measured already (covariance `C_b` of its unknowns), foretells `y_b` with
//! the sensitivities `J_b`. If `a` is true, the evidence for it over `b` is expected to grow by
//! `r'(I + J_b C_b J_b')^-1 r/2 = (r'r - r'J_b (C_b^-1 + J_b'J_b)^-1 J_b'r)/2` nats, `r` the whitened `y_a - y_b`. Of a pair
//! the smaller one of both ways counts, of a class the smallest of its first member with any other.
//!
//! **Assumptions** the addition is another run like the first one, with the same sensors; noise and slow errors are as they
//! were (`Noise`), the moment of a reading counts by the rate of what is foretold. A new sensor has an offset and a gain within
//! its class. Nothing is read while nothing flows.
//!
//! **Sources** Box and Hill 1967 (key `box1967`).

mod menu;

use crate::catalogue::Candidate;
use crate::experiment::Experiment;
use crate::fit::{DIFFERENCE, Slopes};
use crate::likelihood::Likelihood;
use crate::noise::{Noise, Residual, whitened};
use crate::trial::Tried;
use crate::uncertainty::jitter_s;
use crate::unknown::{Target, Unknown};
use anergy_core::cores::on_all_cores;
use menu::{Menu, menu};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// The first run once more: what any addition has to be better than.
pub(crate) const AGAIN: &str = "the same once more";

/// An addition to what was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Addition {
    /// What to do.
    pub what: String,
    /// Evidence by which the first member of the class is expected to be told from every other one, nats.
    pub nats: f64,
    /// The same for each other member: its name and component.
    pub from: Vec<(String, f64)>,
}

/// A class, and what its members were fitted to.
pub(crate) struct Rivals<'a> {
    pub(crate) experiment: &'a Experiment,
    pub(crate) likelihood: &'a Likelihood,
    pub(crate) all: &'a [Candidate],
    pub(crate) members: Vec<&'a Tried>,
}

/// A member in an addition.
struct Foretold {
    /// Readings, whitened.
    readings: DVector<f64>,
    /// Their sensitivities, whitened.
    sensitivity: DMatrix<f64>,
    /// Inverse of the covariance of the unknowns before.
    precision: DMatrix<f64>,
}

impl Rivals<'_> {
    /// Every addition that can be simulated, the most telling first.
    pub(crate) fn additions(&self) -> Vec<Addition> {
        let menu = menu(self);
        let found = on_all_cores(menu.len(), |k| self.evaluated(&menu[k]).unwrap_or_default());
        let mut found: Vec<Addition> = found.into_iter().flatten().collect();
        found.sort_by(|a, b| b.nats.total_cmp(&a.nats));
        found
    }

    /// What an entry of the menu, and each of its new sensors, tells; none where it does not run.
    fn evaluated(&self, entry: &Menu) -> Option<Vec<Addition>> {
        let experiment = &entry.experiment;
        let mut slopes = Slopes::new();
        let mut each = Vec::new();
        for tried in &self.members {
            let (unknowns, at) = entry.exchanged(tried, &self.experiment.accuracy);
            let readings = experiment.readings(&unknowns, &at).ok()?;
            for (j, unknown) in unknowns.iter().enumerate() {
                if !slopes.contains_key(&unknown.target) {
                    let (mut beside, step) = (at.clone(), DIFFERENCE * unknown.sd);
                    beside[j] += step;
                    let changed = experiment.readings(&unknowns, &beside).ok()?;
                    let slope = changed.iter().zip(&readings).map(|(y, y0)| (y - y0) / step);
                    slopes.insert(unknown.target.clone(), slope.collect());
                }
            }
            each.push((unknowns, readings, entry.precision(tried)?));
        }
        let sigma = self.sigma(experiment, &each[0].1);
        let others = entry.new_sensors();
        let mut found = Vec::new();
        for (what, new) in
            [(entry.what.clone(), None)].into_iter().chain(others.map(|(k, what)| (what, Some(k))))
        {
            // Without the other new sensors.
            let counts = |i: usize| {
                let sensor = experiment.samples[i].sensor;
                sensor < self.experiment.sensors.sensor.len() || Some(sensor) == new
            };
            let white = |y: &[f64]| self.whitened(experiment, &sigma, y, &counts);
            let foretold: Vec<Foretold> = each
                .iter()
                .map(|(unknowns, readings, precision)| {
                    let columns: Vec<DVector<f64>> =
                        unknowns.iter().map(|u| white(&slopes[&u.target])).collect();
                    let (sensitivity, precision) =
                        (DMatrix::from_columns(&columns), precision.clone());
                    Foretold { readings: white(readings), sensitivity, precision }
                })
                .collect();
            let from: Vec<(String, f64)> = (1..foretold.len())
                .map(|k| {
                    let nats = separation(&foretold[0], &foretold[k])
                        .min(separation(&foretold[k], &foretold[0]));
                    let candidate = &self.all[self.members[k].candidates[0]];
                    (format!("{} at {}", candidate.id, candidate.component), nats)
                })
                .collect();
            let nats = from.iter().map(|(_, nats)| *nats).fold(f64::INFINITY, f64::min);
            found.push(Addition { what, nats, from });
        }
        Some(found)
    }

    /// Standard deviation of every sample, SI.
    fn sigma(&self, experiment: &Experiment, readings: &[f64]) -> Vec<f64> {
        let samples = &experiment.samples;
        let of = |i: usize| {
            let sample = &samples[i];
            let same = |j: &usize| {
                samples.get(*j).is_some_and(|s| (s.run, s.sensor) == (sample.run, sample.sensor))
            };
            let before = i.checked_sub(1).filter(same).unwrap_or(i);
            let after = Some(i + 1).filter(same).unwrap_or(i);
            let dt_s = samples[after].time_s - samples[before].time_s;
            let rate = if dt_s > 0.0 { (readings[after] - readings[before]) / dt_s } else { 0.0 };
            let jitter_s = jitter_s(&experiment.runs[sample.run].tracks[sample.sensor]);
            experiment.accuracy[sample.sensor].noise.hypot(rate * jitter_s)
        };
        (0..samples.len()).map(of).collect()
    }

    /// Values of the samples that count, over their noise and slow error.
    fn whitened(
        &self,
        experiment: &Experiment,
        sigma: &[f64],
        values: &[f64],
        counts: &dyn Fn(usize) -> bool,
    ) -> DVector<f64> {
        let cold = 1.0 / self.likelihood.temperature.sqrt();
        let mut out = Vec::with_capacity(values.len());
        let all: Vec<usize> = (0..values.len()).filter(|&i| counts(i)).collect();
        let group = |i: usize| (experiment.samples[i].run, experiment.samples[i].sensor);
        for part in all.chunk_by(|&i, &j| group(i) == group(j)) {
            let of = |&i: &usize| Residual {
                time_s: experiment.samples[i].time_s,
                value: values[i],
                sigma: sigma[i],
            };
            let residuals: Vec<Residual> = part.iter().map(of).collect();
            let noise = self.likelihood.noises.get(&group(part[0])).unwrap_or(&Noise::WHITE);
            let gains = noise.gains(&residuals);
            out.extend(whitened(&gains, residuals.iter().map(|r| r.value)).map(|e| cold * e));
        }
        DVector::from_vec(out)
    }
}

/// Nats by which the evidence for `a` over `b` is expected to grow, if `a` is true.
fn separation(a: &Foretold, b: &Foretold) -> f64 {
    let r = &a.readings - &b.readings;
    let along = b.sensitivity.tr_mul(&r);
    let after = &b.precision + b.sensitivity.tr_mul(&b.sensitivity);
    let taken = after.cholesky().map_or(0.0, |factor| along.dot(&factor.solve(&along)));
    0.5 * (r.norm_squared() - taken).max(0.0)
}

/// The prior of what is new in a sensor that was exchanged: neutral value and standard deviation; none for what a sensor
/// within its class does not do.
fn of_new(
    target: &Target,
    unknown: &Unknown,
    accuracy: &crate::sensors::Accuracy,
) -> Option<(f64, f64)> {
    match target {
        Target::Bias(_) => Some((0.0, accuracy.bias.max(accuracy.noise))),
        Target::Gain(_) => Some((1.0, accuracy.gain.max(1e-3))),
        Target::Clock(_) => Some((0.0, unknown.sd)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rival_that_can_follow_is_not_told_apart() {
        let foretold = |y: [f64; 2], j: [f64; 2], precision: f64| Foretold {
            readings: DVector::from_column_slice(&y),
            sensitivity: DMatrix::from_column_slice(2, 1, &j),
            precision: DMatrix::from_element(1, 1, precision),
        };
        // r = (2, 0); without freedom 2^2/2 = 2 nats.
        let a = foretold([2.0, 0.0], [0.0, 1.0], 1.0);
        assert!((separation(&a, &foretold([0.0, 0.0], [0.0, 1.0], 1.0)) - 2.0).abs() < 1e-12);
        // A rival that moves along r with precision 1: (4 - 2^2/(1 + 1))/2 = 1 nat; freely: nothing.
        assert!((separation(&a, &foretold([0.0, 0.0], [1.0, 0.0], 1.0)) - 1.0).abs() < 1e-12);
        assert!(separation(&a, &foretold([0.0, 0.0], [1.0, 0.0], 1e-9)) < 1e-6);
    }
}
