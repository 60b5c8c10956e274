//! The most probable values of the unknowns, and how well the data speak for a set of them.
//!
//! **Equation** minimise `F = sum e^2 + sum ((x - mean)/sd)^2` over the coordinates `x`, by Levenberg-Marquardt
//! with forward differences, renewed at the end and in between corrected by Broyden's rule. `e` are the residuals
//! `z = (y - yhat)/sigma`, whitened ([`Noise`]). The logarithm of the evidence (Laplace) is
//! `-F/2 - log det(I + S J^T J S)/2`, `J` the sensitivities of `e`, `S = diag(sd)`, but for a constant of the data.
//!
//! **Assumptions** what a model that is nearly right leaves behind is correlated from sample to sample and may be larger
//! than the noise of the sensor; as if each sample were new, small flaws would speak far too loudly. It is an
//! autoregressive process of first order, by sensor and run: `e_i = (z_i - r z_{i-1})/s`.
//!
//! **Sources** Laplace's method: MacKay 2003, chapter 27 (key `mackay2003`).

use crate::error::ExplainError;
use crate::experiment::Experiment;
use crate::unknown::{Estimate, Unknown};
use nalgebra::{DMatrix, DVector};
use std::collections::HashMap;

/// Step of a forward difference over the standard deviation of the prior.
const DIFFERENCE: f64 = 0.02;
/// A fit ends when a step gains less than this.
const GAIN: f64 = 1e-3;
const MAX_STEPS: u32 = 25;
/// Evidence that a fit may leave on the table, nats.
const ENOUGH: f64 = 0.05;
/// Coordinates stay within so many standard deviations of their prior.
const BOUND_SD: f64 = 6.0;

/// What is fitted to: uncertainty of every sample, and the samples that count.
pub struct Likelihood {
    /// Standard deviation of every sample, SI.
    pub sigma: Vec<f64>,
    /// The samples that are fitted.
    pub fitted: Vec<usize>,
    /// What a nearly right model leaves behind, by run and sensor.
    pub noise: HashMap<(usize, usize), Noise>,
}

/// Residuals as an autoregressive process of first order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Correlation from sample to sample.
    pub correlation: f64,
    /// Standard deviation of what is new in a sample, over sigma.
    pub innovation: f64,
}

impl Noise {
    /// As the sensors promise: every sample is new.
    pub const WHITE: Self = Self { correlation: 0.0, innovation: 1.0 };
}

impl Likelihood {
    /// Residuals over sigma, or their sensitivities, of all fitted samples, whitened.
    fn whitened(&self, experiment: &Experiment, z: impl Fn(usize) -> f64) -> DVector<f64> {
        let mut before = None;
        let e = self.fitted.iter().map(|&i| {
            let group = (experiment.samples[i].run, experiment.samples[i].sensor);
            let Noise { correlation: r, innovation } =
                self.noise.get(&group).copied().unwrap_or(Noise::WHITE);
            let here = z(i);
            let e = match before {
                Some((j, last)) if j + 1 == i && self.same(experiment, j, i) => here - r * last,
                // Of the first one all is new.
                _ => here * (1.0 - r * r).sqrt(),
            };
            before = Some((i, here));
            e / innovation
        });
        DVector::from_iterator(self.fitted.len(), e)
    }

    fn same(&self, experiment: &Experiment, i: usize, j: usize) -> bool {
        let (a, b) = (&experiment.samples[i], &experiment.samples[j]);
        (a.run, a.sensor) == (b.run, b.sensor)
    }

    /// What these readings leave behind. At least as much as the sensors promise.
    pub fn noise_of(
        &self,
        experiment: &Experiment,
        readings: &[f64],
    ) -> HashMap<(usize, usize), Noise> {
        let z = |i: usize| (experiment.samples[i].value - readings[i]) / self.sigma[i];
        let mut sums: HashMap<(usize, usize), [f64; 4]> = HashMap::new();
        for pair in self.fitted.windows(2).filter(|pair| pair[1] == pair[0] + 1) {
            if self.same(experiment, pair[0], pair[1]) {
                let (a, b) = (z(pair[0]), z(pair[1]));
                let sample = &experiment.samples[pair[0]];
                let sums = sums.entry((sample.run, sample.sensor)).or_default();
                for (sum, term) in sums.iter_mut().zip([a * a, b * b, a * b, 1.0]) {
                    *sum += term;
                }
            }
        }
        let noise = |[aa, bb, ab, n]: [f64; 4]| {
            let r = (ab / (aa * bb).sqrt().max(1e-300)).clamp(0.0, 1.0 - 4.0 / n.max(5.0));
            let new = ((bb - 2.0 * r * ab + r * r * aa) / n).max(0.0).sqrt();
            Noise { correlation: r, innovation: new.max((1.0 - r * r).sqrt()) }
        };
        sums.into_iter().map(|(group, sums)| (group, noise(sums))).collect()
    }
}

/// A fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Most probable coordinates.
    pub at: Vec<f64>,
    /// Readings there, all samples.
    pub readings: Vec<f64>,
    /// Logarithm of the evidence, but for a constant.
    pub log_evidence: f64,
    /// Covariance of the coordinates.
    pub covariance: DMatrix<f64>,
    /// Sensitivities of the whitened readings, fitted samples by unknowns.
    pub sensitivity: DMatrix<f64>,
}

impl Fit {
    /// Value of an unknown with its 95 % interval.
    pub fn estimate(&self, unknowns: &[Unknown], i: usize) -> Estimate {
        let half = 1.96 * self.covariance[(i, i)].max(0.0).sqrt();
        let value = |x: f64| unknowns[i].value(x);
        Estimate {
            value: value(self.at[i]),
            lo: value(self.at[i] - half),
            hi: value(self.at[i] + half),
        }
    }
}

struct Point {
    readings: Vec<f64>,
    /// Whitened residuals.
    e: DVector<f64>,
    objective: f64,
}

/// Fits the unknowns.
///
/// # Errors
/// What keeps the model from running.
pub fn fit(
    experiment: &Experiment,
    unknowns: &[Unknown],
    likelihood: &Likelihood,
) -> Result<Fit, ExplainError> {
    let n = unknowns.len();
    let mut at: Vec<f64> = unknowns.iter().map(|unknown| unknown.start).collect();
    let evaluate = |at: &[f64]| -> Result<Point, ExplainError> {
        let readings = experiment.readings(unknowns, at)?;
        let z = |i: usize| (experiment.samples[i].value - readings[i]) / likelihood.sigma[i];
        let e = likelihood.whitened(experiment, z);
        let prior = unknowns.iter().zip(at).map(|(u, x)| ((x - u.mean) / u.sd).powi(2));
        let objective = e.norm_squared() + prior.sum::<f64>();
        Ok(Point { readings, e, objective })
    };
    let mut here = evaluate(&at)?;
    let mut sensitivity = DMatrix::zeros(likelihood.fitted.len(), n);
    differences(experiment, unknowns, likelihood, &at, &here.readings, &mut sensitivity)?;
    let (mut damping, mut fresh) = (1e-3, true);
    for _ in 0..MAX_STEPS {
        let prior = DVector::from_iterator(
            n,
            unknowns.iter().zip(&at).map(|(u, x)| (x - u.mean) / (u.sd * u.sd)),
        );
        let gradient = sensitivity.tr_mul(&here.e) - prior;
        let hessian = curvature(&sensitivity, unknowns);
        let mut gained = 0.0;
        for _ in 0..6 {
            let mut damped = hessian.clone();
            for i in 0..n {
                damped[(i, i)] *= 1.0 + damping;
            }
            let Some(factor) = damped.cholesky() else { break };
            let step = factor.solve(&gradient);
            let there = at.iter().zip(step.iter()).zip(unknowns);
            let there: Vec<f64> = there
                .map(|((x, dx), u)| {
                    (x + dx).clamp(u.mean - BOUND_SD * u.sd, u.mean + BOUND_SD * u.sd)
                })
                .collect();
            // Where the model does not run, the step was too long.
            let Ok(trial) = evaluate(&there) else {
                damping *= 5.0;
                continue;
            };
            // Broyden: the sensitivities that the step has shown. Residuals fall where readings rise.
            let moved =
                DVector::from_iterator(n, there.iter().zip(&at).map(|(new, old)| new - old));
            let size = moved.norm_squared();
            if size > 0.0 {
                let miss = (&here.e - &trial.e) - &sensitivity * &moved;
                sensitivity += miss * moved.transpose() / size;
                fresh = false;
            }
            if trial.objective < here.objective {
                gained = here.objective - trial.objective;
                (at, here) = (there, trial);
                damping = (damping * 0.2).max(1e-6);
                break;
            }
            damping *= 5.0;
        }
        if gained > GAIN * (1.0 + 1e-3 * here.objective) {
            continue;
        }
        if fresh {
            break;
        }
        differences(experiment, unknowns, likelihood, &at, &here.readings, &mut sensitivity)?;
        (damping, fresh) = (1e-3, true);
        let prior = unknowns.iter().zip(&at).map(|(u, x)| (x - u.mean) / (u.sd * u.sd));
        let gradient = sensitivity.tr_mul(&here.e) - DVector::from_iterator(n, prior);
        let step =
            curvature(&sensitivity, unknowns).cholesky().map(|factor| factor.solve(&gradient));
        // What a step with the true sensitivities would still gain.
        if step.is_none_or(|step| 0.5 * step.dot(&gradient) < ENOUGH) {
            break;
        }
    }
    if !fresh {
        differences(experiment, unknowns, likelihood, &at, &here.readings, &mut sensitivity)?;
    }
    let hessian = curvature(&sensitivity, unknowns);
    let covariance = hessian
        .clone()
        .cholesky()
        .map_or_else(|| DMatrix::identity(n, n), |factor| factor.inverse());
    // det(S H S)
    let scaled = DMatrix::from_fn(n, n, |i, j| hessian[(i, j)] * unknowns[i].sd * unknowns[j].sd);
    let log_det = scaled
        .cholesky()
        .map_or(0.0, |factor| 2.0 * factor.l().diagonal().iter().map(|d| d.ln()).sum::<f64>());
    let log_evidence = -0.5 * here.objective - 0.5 * log_det;
    Ok(Fit { at, readings: here.readings, log_evidence, covariance, sensitivity })
}

fn differences(
    experiment: &Experiment,
    unknowns: &[Unknown],
    likelihood: &Likelihood,
    at: &[f64],
    readings: &[f64],
    sensitivity: &mut DMatrix<f64>,
) -> Result<(), ExplainError> {
    for (j, unknown) in unknowns.iter().enumerate() {
        let mut beside = at.to_vec();
        let step = DIFFERENCE * unknown.sd;
        beside[j] += step;
        let changed = experiment.readings(unknowns, &beside)?;
        let slope = |i: usize| (changed[i] - readings[i]) / step / likelihood.sigma[i];
        sensitivity.set_column(j, &likelihood.whitened(experiment, slope));
    }
    Ok(())
}

fn curvature(sensitivity: &DMatrix<f64>, unknowns: &[Unknown]) -> DMatrix<f64> {
    let mut hessian = sensitivity.tr_mul(sensitivity);
    for (i, unknown) in unknowns.iter().enumerate() {
        hessian[(i, i)] += 1.0 / (unknown.sd * unknown.sd);
    }
    hessian
}
