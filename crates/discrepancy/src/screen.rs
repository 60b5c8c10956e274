//! The first look at every effect: what it could gain, from one or two simulations and linear algebra.
//!
//! **Equation** the score test. With `d` what an effect of a typical strength changes in the whitened readings, `e` the
//! whitened residuals without it, and `P = I - N (N'N + S^-2)^-1 N'` that takes out what the tolerances (sensitivities `N`)
//! could take up, the effect with strength `a` gains `(e'e - |P^(1/2)(e - a d)|^2)/2 = a d'e - a^2 d'Pd/2` nats, largest
//! at `a = d'e/d'Pd`; `e` is at the optimum of the tolerances, where `N'e` is their prior's pull.
//!
//! A quantity that is a tolerance too is looked at along its sensitivity at the fit as well, with the tolerance given free.
//!
//! **Assumptions** linear in the strength up to half as much again; both signs are tried, of a flaw of a compared sensor, which
//! needs no simulation, five strengths of each; the best counts.
//!
//! **Sources** Rao 1948 (key `rao1948`).

use crate::catalogue::Candidate;
use crate::error::ExplainError;
use crate::experiment::Experiment;
use crate::fit::Fit;
use crate::likelihood::Likelihood;
use crate::unknown::{Unknown, curvature_at};
use anergy_core::cores::on_all_cores;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::collections::HashSet;

/// Directions that agree better than this may be those of one effect.
const PARALLEL: f64 = 0.99;
/// Most strengths over the typical one.
const MOST: f64 = 1.5;

/// What the first look says about a candidate.
#[derive(Debug, Clone)]
pub struct Screened {
    /// Its place among the candidates.
    pub candidate: usize,
    /// Coordinate that gained most.
    pub start: f64,
    /// Nats that it may gain.
    pub gain: f64,
    /// What it changes, without what the tolerances take up.
    pub direction: DVector<f64>,
}

/// A first look.
pub struct Looked {
    /// What could be looked at, best first.
    pub seen: Vec<Screened>,
    /// With which the model runs at no strength: places among the candidates, and why.
    pub fail: Vec<(usize, String)>,
}

/// What is there without the candidates.
pub struct Without<'a> {
    /// The experiment.
    pub experiment: &'a Experiment,
    /// What was fitted.
    pub unknowns: &'a [Unknown],
    /// How.
    pub likelihood: &'a Likelihood,
    /// The fit.
    pub fit: &'a Fit,
}

impl Without<'_> {
    /// The first look at candidates, best first.
    pub fn screen(&self, all: &[Candidate], open: &[usize]) -> Looked {
        let Some(factor) =
            curvature_at(&self.fit.sensitivity, self.unknowns, &self.fit.at).cholesky()
        else {
            return Looked { seen: Vec::new(), fail: Vec::new() };
        };
        let n = &self.fit.sensitivity;
        let without = |d: &DVector<f64>| d - n * factor.solve(&n.tr_mul(d));
        let left = self.left(&factor);
        let stuck = (0..self.unknowns.len()).any(|i| self.fit.at_bound(self.unknowns, i));
        let looked = on_all_cores(open.len(), |k| {
            let candidate = &all[open[k]];
            let mut best = self.along_tolerance(candidate, open[k], &factor, &left);
            let simulated = self.experiment.is_simulated(&candidate.unknown.target);
            let (mut runs, mut fails) = (best.is_some(), None);
            for start in strengths(candidate, simulated, stuck) {
                let d = match self.changes(candidate, start) {
                    Ok(d) => d,
                    Err(error) => {
                        fails = Some(error.to_string());
                        continue;
                    }
                };
                runs = true;
                let direction = without(&d);
                let (size, along) = (d.dot(&direction), d.dot(&left.1));
                if size < 1e-12 {
                    continue;
                }
                let a = (along / size).clamp(0.0, MOST);
                let gain = a * along - 0.5 * a * a * size;
                if best.as_ref().is_none_or(|best| gain > best.gain) {
                    let start = candidate.scaled(start, a);
                    best = Some(Screened { candidate: open[k], start, gain, direction });
                }
            }
            (best, fails.filter(|_| !runs).map(|why| (open[k], why)))
        });
        let (looked, fail): (Vec<_>, Vec<_>) = looked.into_iter().unzip();
        let fail = fail.into_iter().flatten().collect();
        let mut looked: Vec<Screened> = looked.into_iter().flatten().collect();
        // What lies well within a tolerance that is not fitted (a drift within the class of its sensor) is no effect.
        looked.retain(|screened| {
            let candidate = &all[screened.candidate];
            candidate.is_fitted(self.unknowns) || !candidate.well_within(screened.start)
        });
        looked.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        // Of one parameter at one place the best variant.
        let mut seen = HashSet::new();
        looked.retain(|screened| {
            let candidate = &all[screened.candidate];
            seen.insert((candidate.id, candidate.component.as_str(), candidate.parameter.0))
        });
        Looked { seen: looked, fail }
    }

    /// What the tolerances would still move by, and the whitened residuals after that: where they are fitted, nothing and those
    /// of the fit.
    fn left(&self, factor: &Cholesky<f64, Dyn>) -> (DVector<f64>, DVector<f64>) {
        let (n, fit) = (&self.fit.sensitivity, self.fit);
        let pull = |(u, x): (&Unknown, &f64)| u.slope(*x);
        let pull = self.unknowns.iter().zip(&fit.at).map(pull);
        let pull = DVector::from_iterator(self.unknowns.len(), pull);
        let moved = factor.solve(&(n.tr_mul(&fit.e) - pull));
        let e = &fit.e - n * &moved;
        (moved, e)
    }

    /// A quantity that is a tolerance too, by its sensitivity at the fit: without its narrow prior.
    fn along_tolerance(
        &self,
        candidate: &Candidate,
        place: usize,
        factor: &Cholesky<f64, Dyn>,
        (moved, e): &(DVector<f64>, DVector<f64>),
    ) -> Option<Screened> {
        let own = &candidate.unknown;
        let j = self.unknowns.iter().position(|u| u.target == own.target)?;
        // Coordinate of the effect, and slope of that of the tolerance by it.
        let coordinate = self.fit.at[j] + moved[j];
        let value = self.unknowns[j].value(coordinate);
        let (at, slope) = match (self.unknowns[j].logarithmic, own.logarithmic) {
            (false, true) if value > 0.0 => (value.ln(), value),
            (one, other) if one == other => (coordinate, 1.0),
            _ => return None,
        };
        let n = &self.fit.sensitivity;
        let d = n.column(j) * (slope * own.sd);
        let taken = factor.solve(&n.tr_mul(&d));
        let direction = &d - n * &taken;
        let (size, along) = (d.dot(&direction), d.dot(e));
        // Tolerances that stick to their bounds are no point to start from.
        if size < 1e-12 || (0..self.unknowns.len()).any(|i| self.fit.at_bound(self.unknowns, i)) {
            return None;
        }
        let a = along / size;
        let gain = 0.5 * a * along;
        // No more than there is to gain.
        let far = |(u, x): (&Unknown, &f64)| u.fall(*x);
        let strain = self.unknowns.iter().zip(&self.fit.at).map(far).sum::<f64>();
        if gain > 0.5 * (self.fit.e.norm_squared() + strain) {
            return None;
        }
        let start = at + a * (own.sd - taken[j] / slope);
        let start = start.clamp(own.mean - 2.0 * own.sd, own.mean + 2.0 * own.sd);
        Some(Screened { candidate: place, start, gain, direction })
    }

    /// Change of the whitened readings by a candidate.
    fn changes(
        &self,
        candidate: &Candidate,
        coordinate: f64,
    ) -> Result<DVector<f64>, ExplainError> {
        let own = &candidate.unknown;
        let kept = (0..self.unknowns.len()).filter(|&i| !candidate.owns(&self.unknowns[i]));
        let (mut unknowns, mut at): (Vec<Unknown>, Vec<f64>) =
            kept.map(|i| (self.unknowns[i].clone(), self.fit.at[i])).unzip();
        for beside in &candidate.beside {
            unknowns.push(beside.clone());
            at.push(beside.start);
        }
        unknowns.push(own.clone());
        at.push(coordinate);
        let mut own = candidate.beside.iter().chain([own]);
        let (readings, simulated) = (&self.fit.readings, &self.fit.simulated);
        let is_simulated = own.any(|unknown| self.experiment.is_simulated(&unknown.target));
        let readings = match candidate.unknown.target.sensor().filter(|_| !is_simulated) {
            Some(sensor) => {
                self.experiment.observed_beside(readings, sensor, simulated, &unknowns, &at)
            }
            None => self.experiment.readings(&unknowns, &at)?,
        };
        let z = |i: usize| (readings[i] - self.fit.readings[i]) / self.likelihood.sigma[i];
        Ok(self.likelihood.whitened(z).component_mul(&self.fit.weight))
    }
}

/// Coordinates at which it is tried: two, or more where it needs no simulation, or where tolerances stick to their bounds and may
/// be as far already.
fn strengths(candidate: &Candidate, simulated: bool, stuck: bool) -> Vec<f64> {
    let unknown = &candidate.unknown;
    let beside: &[f64] = match (simulated, stuck) {
        (false, _) => &[0.2, 0.4, 0.7, 1.2, 1.8],
        (true, false) => &[0.7],
        (true, true) => &[0.7, 1.8],
    };
    beside
        .iter()
        .flat_map(|sd| [unknown.mean - sd * unknown.sd, unknown.mean + sd * unknown.sd])
        .collect()
}

/// The best of the first look, and what points the same way as the best one.
pub fn kept(looked: &[Screened], most: usize) -> Vec<&Screened> {
    let Some(best) = looked.first() else { return Vec::new() };
    let rivals = |screened: &&Screened| {
        let cosine = screened.direction.dot(&best.direction)
            / (screened.direction.norm() * best.direction.norm()).max(1e-300);
        cosine > PARALLEL
    };
    let mut kept: Vec<&Screened> = looked.iter().take(most).collect();
    kept.extend(looked.iter().skip(most).filter(rivals).take(most / 2));
    kept
}

/// What effects together gain, by the first look at each, nats.
pub fn together(looked: &[&Screened], e: &DVector<f64>) -> f64 {
    let n = looked.len();
    let along = DVector::from_fn(n, |i, _| looked[i].direction.dot(e));
    let gram = DMatrix::from_fn(n, n, |i, j| looked[i].direction.dot(&looked[j].direction));
    gram.cholesky().map_or(0.0, |g| 0.5 * g.solve(&along).dot(&along))
}

/// The two effects that together gain most, by the first look at each: places in `looked`.
pub fn pairs(looked: &[Screened], e: &DVector<f64>, most: usize) -> Vec<(usize, usize, f64)> {
    let directions: Vec<&DVector<f64>> = looked.iter().map(|s| &s.direction).collect();
    let mut all = Vec::new();
    for i in 0..directions.len() {
        for j in 0..i {
            let (a, b) = (directions[i], directions[j]);
            let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
            let gram = DMatrix::from_row_slice(2, 2, &[aa, ab, ab, bb]);
            let along = DVector::from_column_slice(&[a.dot(e), b.dot(e)]);
            // Nearly parallel ones are one.
            if ab * ab > 0.98 * aa * bb {
                continue;
            }
            let Some(x) = gram.cholesky().map(|g| g.solve(&along)) else { continue };
            all.push((j, i, 0.5 * x.dot(&along)));
        }
    }
    all.sort_by(|a, b| b.2.total_cmp(&a.2));
    all.truncate(most);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench;
    use crate::catalogue::{candidates, tolerances};
    use crate::fit::{Care, Slopes, fit, unfitted};
    use crate::unknown::Target;

    #[test]
    fn a_lag_that_a_tolerance_stands_for_is_seen() {
        // The tolerance of 1.5 s takes up 7 s, at 4.7 standard deviations: 0.5 4.7^2 = 11 nats are what a slow sensor would gain.
        let house = 3;
        let experiment = bench::experiment(&[(Unknown::plain(Target::Lag(house), 0.0, 1.0), 7.0)]);
        let all = candidates(&experiment);
        let base = tolerances(&experiment);
        let n = experiment.samples.len();
        let likelihood = Likelihood::new(vec![0.02; n], (0..n).collect());
        let null = fit(&experiment, &base, &likelihood, &Slopes::new(), Care::Alone).unwrap();
        let lag = base.iter().position(|u| u.target == Target::Lag(house)).unwrap();
        assert!((null.at[lag] - 7.0).abs() < 0.5, "{}", null.at[lag]);
        let experiment = &experiment;
        let without = Without { experiment, unknowns: &base, likelihood: &likelihood, fit: &null };
        let open: Vec<usize> = (0..all.len()).collect();
        let looked = without.screen(&all, &open).seen;
        let is_slow = |s: &&Screened| {
            (all[s.candidate].id, all[s.candidate].component.as_str()) == ("S4", "T_house")
        };
        let slow = looked.iter().find(is_slow).unwrap();
        let gain = 0.5 * (null.at[lag] / base[lag].sd).powi(2);
        assert!((slow.gain - gain).abs() < 0.2 * gain, "{} {gain}", slow.gain);
        // Given free, it takes over what the clock stood for.
        assert!((7.0..20.0).contains(&slow.start.exp()), "{}", slow.start.exp());
        // It is the best one, too, from where nothing is fitted yet; what it gains there is a straight line's guess.
        let fit = unfitted(experiment, &base, &likelihood).unwrap();
        let without = Without { experiment, unknowns: &base, likelihood: &likelihood, fit: &fit };
        let looked = without.screen(&all, &open).seen;
        assert!(is_slow(&&looked[0]) && looked[0].gain > 0.8 * gain, "{}", looked[0].gain);
    }

    #[test]
    fn with_what_the_model_does_not_run_is_said() {
        let experiment = bench::experiment(&[]);
        let mut all = candidates(&experiment);
        all.retain(|c| c.id == "P10");
        // However far, the far pipe would end before it begins.
        let far = all.iter().position(|c| c.component == "far").unwrap();
        (all[far].unknown.mean, all[far].unknown.sd) = (-10.0, 1.0);
        let n = experiment.samples.len();
        let likelihood = Likelihood::new(vec![0.02; n], (0..n).collect());
        let fit = fit(&experiment, &[], &likelihood, &Slopes::new(), Care::Quick).unwrap();
        let experiment = &experiment;
        let without = Without { experiment, unknowns: &[], likelihood: &likelihood, fit: &fit };
        let looked = without.screen(&all, &[0, 1]);
        let [(k, why)] = &looked.fail[..] else { panic!("{:?}", looked.fail) };
        assert!(*k == far && why.contains("far"), "{why}");
        assert!(looked.seen.iter().all(|s| s.candidate != far));
    }

    #[test]
    fn readings_beside_others_are_those_of_all() {
        let experiment = bench::experiment(&[]);
        let simulated = experiment.simulated(&[], &[], 1).unwrap();
        let lag = [Unknown::plain(Target::Lag(3), 0.0, 1.0)];
        let plain = experiment.observed(&simulated, &lag, &[0.0]);
        let slow = experiment.observed(&simulated, &lag, &[20.0]);
        let beside = experiment.observed_beside(&plain, 3, &simulated, &lag, &[20.0]);
        assert_eq!(beside, slow);
        assert_ne!(beside, plain);
    }
}
