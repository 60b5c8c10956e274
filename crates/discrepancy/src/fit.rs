//! The most probable values of the unknowns, and how well the data speak for a set of them.
//!
//! **Equation** minimise `F = sum e^2 + sum f(x)` over the coordinates `x`, `f` twice the fall of the logarithm of their priors
//! ([`Unknown::fall`]), by Levenberg-Marquardt with forward differences, in between corrected by Broyden's rule. `e` are the residuals
//! `z = (y - yhat)/sigma`, whitened, as they count ([`Likelihood`]). The logarithm of the evidence (Laplace) is
//! `-F/2 - log det(I + S J^T J S)/2`, `J` the sensitivities of `e`, `S = diag(sd)`, but for a constant of the data.
//!
//! **Numerics** one simulation per unknown and round of sensitivities is what costs. Flaws of compared sensors need none.
//! Their sensitivities are those of each point; those of the others, which another fit may have found near by ([`Slopes`]), Broyden's
//! rule corrects, and a thorough fit renews them at its end.
//!
//! **Sources** Laplace's method: MacKay 2003, chapter 27 (key `mackay2003`).

use crate::error::ExplainError;
use crate::experiment::{Experiment, Simulated};
use crate::likelihood::Likelihood;
use crate::unknown::{Estimate, Target, Unknown, curvature, curvature_at};
use anergy_core::cores::on_all_cores;
use nalgebra::{DMatrix, DVector};
use std::collections::HashMap;

/// Step of a forward difference over the standard deviation of the prior.
pub(crate) const DIFFERENCE: f64 = 0.02;
/// A fit ends when a step gains less than this.
const GAIN: f64 = 0.02;
const MAX_STEPS: u32 = 25;
/// Evidence that a fit may leave on the table, nats.
const ENOUGH: f64 = 0.05;
/// Nats that sensitivities of elsewhere may promise without a step that gains, before they are simulated again.
const PROMISED: f64 = 2.0;
/// Moments of a jump that are looked at, equally far apart.
const MOMENTS: u32 = 50;
/// Half of a 95 % interval over what the likelihood says: plant and model differ by more than what is uncertain of either. In cases of
/// development the interval of the likelihood held the truth in 85 %.
pub(crate) const WIDE: f64 = 1.4;
/// Coordinates stay within so many standard deviations of their prior.
pub(crate) const BOUND_SD: f64 = 6.0;

/// Change of all readings with the coordinate of an unknown, SI.
pub type Slopes = HashMap<Target, Vec<f64>>;

/// A fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Most probable coordinates.
    pub at: Vec<f64>,
    /// Readings there, all samples.
    pub readings: Vec<f64>,
    /// Whitened residuals of the fitted samples, as they count.
    pub e: DVector<f64>,
    /// Their slopes by the whitened residuals.
    pub weight: DVector<f64>,
    /// Logarithm of the evidence, but for a constant.
    pub log_evidence: f64,
    /// Covariance of the coordinates.
    pub covariance: DMatrix<f64>,
    /// Sensitivities of the whitened readings, fitted samples by unknowns.
    pub sensitivity: DMatrix<f64>,
    /// Sensitivities that were simulated last.
    pub slopes: Slopes,
    /// Quantities there, before the sensors.
    pub simulated: Simulated,
}

impl Fit {
    /// Value of an unknown with its 95 % interval; at least as wide as this standard deviation says.
    pub fn estimate(&self, unknowns: &[Unknown], i: usize, least_sd: f64) -> Estimate {
        let half = WIDE * 1.96 * self.covariance[(i, i)].max(0.0).sqrt().max(least_sd);
        let value = |x: f64| unknowns[i].value(x);
        Estimate {
            value: value(self.at[i]),
            lo: value(self.at[i] - half),
            hi: value(self.at[i] + half),
        }
    }

    /// The same fit without the unknowns that change nothing.
    #[must_use]
    pub fn only(self, kept: &[usize]) -> Self {
        Self {
            at: kept.iter().map(|&j| self.at[j]).collect(),
            covariance: self.covariance.select_rows(kept).select_columns(kept),
            sensitivity: self.sensitivity.select_columns(kept),
            ..self
        }
    }

    /// Whether an unknown sticks to the bound of its range.
    pub fn at_bound(&self, unknowns: &[Unknown], i: usize) -> bool {
        (self.at[i] - unknowns[i].mean).abs() > 0.999 * BOUND_SD * unknowns[i].sd
    }
}

/// How a fit goes about it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Care {
    /// Sensitivities that are known already are corrected only by what the steps show.
    Quick,
    /// All sensitivities are renewed at the end.
    Thorough,
    /// The same, on all cores.
    Alone,
}

struct Point {
    simulated: Simulated,
    readings: Vec<f64>,
    /// Whitened residuals.
    e: DVector<f64>,
    /// As they count, with their slopes.
    counted: (DVector<f64>, DVector<f64>),
    objective: f64,
}

impl Point {
    /// Sensitivities of what counts, from those of the whitened readings.
    fn weighted(&self, sensitivity: &DMatrix<f64>) -> DMatrix<f64> {
        let mut weighted = sensitivity.clone();
        for mut column in weighted.column_iter_mut() {
            column.component_mul_assign(&self.counted.1);
        }
        weighted
    }
}

struct Problem<'a> {
    experiment: &'a Experiment,
    unknowns: &'a [Unknown],
    likelihood: &'a Likelihood,
    care: Care,
}

/// Fits the unknowns; `known` are sensitivities found near by.
///
/// # Errors
/// What keeps the model from running.
pub fn fit(
    experiment: &Experiment,
    unknowns: &[Unknown],
    likelihood: &Likelihood,
    known: &Slopes,
    care: Care,
) -> Result<Fit, ExplainError> {
    let problem = Problem { experiment, unknowns, likelihood, care };
    let n = unknowns.len();
    let mut at: Vec<f64> = unknowns.iter().map(|unknown| unknown.start).collect();
    let here = problem.evaluate(&at)?;
    let mut here = problem.best_moment(&mut at, here);
    let mut slopes = Slopes::new();
    let of_known = |j: &usize| known.contains_key(&unknowns[*j].target);
    let (old, new): (Vec<usize>, Vec<usize>) = (0..n).partition(of_known);
    for &j in &old {
        let target = &unknowns[j].target;
        slopes.insert(target.clone(), known[target].clone());
    }
    problem.differences(&at, &here, &new, &mut slopes)?;
    let all: Vec<usize> = (0..n).collect();
    // Those of flaws of compared sensors need no simulation: they are those of each point.
    let needs_none = |j: &usize| !experiment.is_simulated(&unknowns[*j].target);
    let of_sensors: Vec<usize> = (0..n).filter(needs_none).collect();
    let renewed = if care == Care::Quick { &new } else { &all };
    let mut sensitivity = DMatrix::zeros(likelihood.fitted.len(), n);
    problem.columns(&slopes, &all, &mut sensitivity);
    let (mut damping, mut fresh) = (1e-3, old.is_empty());
    // What the steps have gained since the sensitivities were simulated.
    let mut since = if fresh { 0.0 } else { f64::INFINITY };
    for _ in 0..MAX_STEPS {
        let (gradient, hessian) = problem.downhill(&at, &here, &sensitivity);
        let (mut gained, mut promised) = (0.0, 0.0);
        for _ in 0..6 {
            let mut damped = hessian.clone();
            for i in 0..n {
                damped[(i, i)] *= 1.0 + damping;
            }
            let Some(factor) = damped.cholesky() else { break };
            let step = factor.solve(&gradient);
            // A step that hardly changes anything is not worth a simulation.
            let promises = 0.5 * step.dot(&gradient);
            if promises < 0.1 * ENOUGH {
                break;
            }
            promised = f64::max(promised, promises);
            let there = at.iter().zip(step.iter()).zip(unknowns);
            let there: Vec<f64> = there
                .map(|((x, dx), u)| {
                    (x + dx).clamp(u.mean - BOUND_SD * u.sd, u.mean + BOUND_SD * u.sd)
                })
                .collect();
            // Where the model does not run, the step was too long.
            let Ok(trial) = problem.evaluate(&there) else {
                damping *= 5.0;
                continue;
            };
            // Broyden: the sensitivities that the step has shown. Residuals fall where readings rise.
            let moved =
                DVector::from_iterator(n, there.iter().zip(&at).map(|(new, old)| new - old));
            let scaled = DVector::from_fn(n, |i, _| moved[i] / unknowns[i].sd.powi(2));
            let size = scaled.dot(&moved);
            if size > 0.0 {
                let miss = (&here.e - &trial.e) - &sensitivity * &moved;
                sensitivity += miss * scaled.transpose() / size;
                fresh = false;
            }
            let better = trial.objective < here.objective;
            if better {
                gained = here.objective - trial.objective;
                (at, here) = (there, trial);
                problem.differences(&at, &here, &of_sensors, &mut slopes)?;
            }
            problem.columns(&slopes, &of_sensors, &mut sensitivity);
            if better {
                damping = (damping * 0.2).max(1e-6);
                break;
            }
            damping *= 5.0;
        }
        since += gained;
        if gained > GAIN * (1.0 + 1e-3 * here.objective) {
            continue;
        }
        // Where true sensitivities have led nowhere, they will not if they are simulated once more.
        if fresh || 0.5 * since < ENOUGH {
            break;
        }
        // Sensitivities that promise much and lead nowhere are those of another place.
        let stale = gained == 0.0 && promised > PROMISED;
        let renewed = if stale { &all } else { renewed };
        problem.differences(&at, &here, renewed, &mut slopes)?;
        problem.columns(&slopes, renewed, &mut sensitivity);
        (damping, fresh, since) = (1e-3, true, 0.0);
        let (gradient, hessian) = problem.downhill(&at, &here, &sensitivity);
        let step = hessian.cholesky().map(|factor| factor.solve(&gradient));
        // What a step with the true sensitivities would still gain.
        if step.is_none_or(|step| 0.5 * step.dot(&gradient) < ENOUGH) {
            break;
        }
    }
    if !fresh && since > 0.0 {
        problem.differences(&at, &here, renewed, &mut slopes)?;
    }
    Ok(problem.ends(at, here, slopes))
}

/// What a fit of the unknowns begins with, as if it were one: how things look where nothing has been fitted yet.
///
/// # Errors
/// What keeps the model from running.
pub fn unfitted(
    experiment: &Experiment,
    unknowns: &[Unknown],
    likelihood: &Likelihood,
) -> Result<Fit, ExplainError> {
    let problem = Problem { experiment, unknowns, likelihood, care: Care::Alone };
    let at: Vec<f64> = unknowns.iter().map(|unknown| unknown.start).collect();
    let here = problem.evaluate(&at)?;
    let mut slopes = Slopes::new();
    let all: Vec<usize> = (0..unknowns.len()).collect();
    problem.differences(&at, &here, &all, &mut slopes)?;
    Ok(problem.ends(at, here, slopes))
}

impl Problem<'_> {
    fn evaluate(&self, at: &[f64]) -> Result<Point, ExplainError> {
        let simulated = self.experiment.simulated(self.unknowns, at, 1)?;
        let readings = self.experiment.observed(&simulated, self.unknowns, at);
        Ok(self.point(simulated, readings, at))
    }

    fn point(&self, simulated: Simulated, readings: Vec<f64>, at: &[f64]) -> Point {
        let z = self.likelihood.z(self.experiment, &readings);
        let e = self.likelihood.whitened(|i| z[i]);
        let prior = self.unknowns.iter().zip(at).map(|(u, x)| u.fall(*x));
        let counted = self.likelihood.counted(&e);
        let objective = counted.0.norm_squared() + prior.sum::<f64>();
        Point { simulated, readings, e, counted, objective }
    }

    /// The best moment of a jump of a compared sensor, of many: between two readings nothing changes with it, and no slope leads there.
    fn best_moment(&self, at: &mut [f64], mut here: Point) -> Point {
        for j in 0..at.len() {
            let target = &self.unknowns[j].target;
            let Target::StepShare(sensor) = *target else { continue };
            if self.experiment.is_simulated(target) {
                continue;
            }
            let mut best = at[j];
            for k in 1..MOMENTS {
                at[j] = f64::from(k) / f64::from(MOMENTS);
                let (known, simulated) = (&here.readings, &here.simulated);
                let readings =
                    self.experiment.observed_beside(known, sensor, simulated, self.unknowns, at);
                let there = self.point(Simulated::default(), readings, at);
                if there.objective < here.objective {
                    best = at[j];
                    here = Point { simulated: here.simulated, ..there };
                }
            }
            at[j] = best;
        }
        here
    }

    /// The fit that ends here.
    fn ends(&self, at: Vec<f64>, here: Point, slopes: Slopes) -> Fit {
        let (unknowns, n) = (self.unknowns, self.unknowns.len());
        let all: Vec<usize> = (0..n).collect();
        let mut sensitivity = DMatrix::zeros(self.likelihood.fitted.len(), n);
        self.columns(&slopes, &all, &mut sensitivity);
        let sensitivity = here.weighted(&sensitivity);
        let hessian = curvature(&sensitivity, unknowns.iter().map(Unknown::precision));
        let covariance = hessian
            .clone()
            .cholesky()
            .map_or_else(|| DMatrix::identity(n, n), |factor| factor.inverse());
        // det(S H S)
        let scaled =
            DMatrix::from_fn(n, n, |i, j| hessian[(i, j)] * unknowns[i].sd * unknowns[j].sd);
        let log_det = scaled
            .cholesky()
            .map_or(0.0, |factor| 2.0 * factor.l().diagonal().iter().map(|d| d.ln()).sum::<f64>());
        let log_evidence = -0.5 * here.objective - 0.5 * log_det;
        let Point { readings, counted: (e, weight), simulated, .. } = here;
        Fit { at, readings, e, weight, log_evidence, covariance, sensitivity, slopes, simulated }
    }

    /// Half of the fall of the objective with the unknowns, and half of its curvature.
    fn downhill(
        &self,
        at: &[f64],
        here: &Point,
        sensitivity: &DMatrix<f64>,
    ) -> (DVector<f64>, DMatrix<f64>) {
        let weighted = here.weighted(sensitivity);
        let slopes = self.unknowns.iter().zip(at).map(|(u, x)| u.slope(*x));
        let slopes = DVector::from_iterator(at.len(), slopes);
        let hessian = curvature_at(&weighted, self.unknowns, at);
        (weighted.tr_mul(&here.counted.0) - slopes, hessian)
    }

    /// Simulated sensitivities of the unknowns at `wanted`.
    fn differences(
        &self,
        at: &[f64],
        here: &Point,
        wanted: &[usize],
        slopes: &mut Slopes,
    ) -> Result<(), ExplainError> {
        let toward = |j: usize, step: f64| -> Result<Vec<f64>, ExplainError> {
            let mut beside = at.to_vec();
            beside[j] += step;
            let target = &self.unknowns[j].target;
            let (readings, simulated) = (&here.readings, &here.simulated);
            let changed = if self.experiment.is_simulated(target) {
                self.experiment.readings(self.unknowns, &beside)?
            } else if let Some(sensor) = target.sensor() {
                self.experiment.observed_beside(readings, sensor, simulated, self.unknowns, &beside)
            } else {
                self.experiment.observed(simulated, self.unknowns, &beside)
            };
            Ok(changed.iter().zip(&here.readings).map(|(y, y0)| (y - y0) / step).collect())
        };
        // At the edge of where the model runs the other side tells the slope.
        let slope = |j: usize| {
            let step = DIFFERENCE * self.unknowns[j].sd;
            toward(j, step).or_else(|error| toward(j, -step).map_err(|_| error))
        };
        let found: Vec<_> = if self.care == Care::Alone {
            on_all_cores(wanted.len(), |k| slope(wanted[k]))
        } else {
            wanted.iter().map(|&j| slope(j)).collect()
        };
        for (&j, found) in wanted.iter().zip(found) {
            slopes.insert(self.unknowns[j].target.clone(), found?);
        }
        Ok(())
    }

    /// The whitened columns of the unknowns at `wanted`.
    fn columns(&self, slopes: &Slopes, wanted: &[usize], sensitivity: &mut DMatrix<f64>) {
        for &j in wanted {
            let slope = &slopes[&self.unknowns[j].target];
            let z = |i: usize| slope[i] / self.likelihood.sigma[i];
            sensitivity.set_column(j, &self.likelihood.whitened(z));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench;

    #[test]
    fn a_trial_with_which_the_model_does_not_run_shortens_the_step() {
        // Water that begins at 47 degC, valid until 99 degC: 51 K warmer it runs, 0.02 * 100 K more it does not.
        let experiment = bench::experiment(&[]);
        let warmer = Unknown::plain(Target::Initial(0), 0.0, 100.0);
        assert!(experiment.readings(std::slice::from_ref(&warmer), &[53.0]).is_err());
        let n = experiment.samples.len();
        let likelihood = Likelihood::new(vec![0.1; n], (0..n).collect());
        let from = |start: f64| {
            let unknown = Unknown { start, ..warmer.clone() };
            fit(&experiment, &[unknown], &likelihood, &Slopes::new(), Care::Quick)
        };
        for start in [51.0, 0.5] {
            let found = from(start).unwrap();
            assert!(found.at[0].abs() < 0.05, "{start}: {}", found.at[0]);
        }
        // Nothing runs at its start: no fit.
        assert!(from(60.0).is_err());
    }
}
