//! Candidates beside what is uncertain anyway: a fit of each, on all cores.

use crate::catalogue::Candidate;
use crate::error::ExplainError;
use crate::experiment::Experiment;
use crate::fit::{Care, Fit, Slopes, fit};
use crate::likelihood::Likelihood;
use crate::screen::Screened;
use crate::unknown::Unknown;
use anergy_core::cores::on_all_cores;

/// Candidates with their fit.
pub struct Tried {
    /// Their places among the candidates: one, or a pair.
    pub candidates: Vec<usize>,
    /// Everything that was fitted.
    pub unknowns: Vec<Unknown>,
    /// Places of the candidates' parameters among the unknowns.
    pub places: Vec<usize>,
    /// The fit.
    pub fit: Fit,
}

/// What all trials have in common.
pub struct Common<'a> {
    /// The experiment.
    pub experiment: &'a Experiment,
    /// What is uncertain, and what was found before, from where a fit starts.
    pub base: &'a [Unknown],
    /// The catalogue.
    pub all: &'a [Candidate],
    /// What is fitted to.
    pub likelihood: &'a Likelihood,
    /// Sensitivities that are known near by.
    pub slopes: &'a Slopes,
}

/// What is tried, and where its fit starts.
pub struct Start {
    /// Places among the candidates.
    pub candidates: Vec<usize>,
    /// Coordinates of their parameters.
    pub at: Vec<f64>,
    /// An earlier fit of the same unknowns.
    pub earlier: Option<Tried>,
}

impl Start {
    /// From where the first look leads.
    pub fn of(screened: &Screened) -> Self {
        let Screened { candidate, start, .. } = *screened;
        Self { candidates: vec![candidate], at: vec![start], earlier: None }
    }

    /// From where an earlier fit ended.
    pub fn again(tried: Tried) -> Self {
        let at = vec![0.0; tried.candidates.len()];
        Self { candidates: tried.candidates.clone(), at, earlier: Some(tried) }
    }
}

impl Common<'_> {
    /// Fits beside what is there. A candidate with which the model does not run, nor with half and a quarter of it, is none, nor
    /// one that lies within a tolerance that is not fitted (a drift within the class of its sensor).
    pub fn fits(&self, starts: &[Start], care: Care) -> Vec<Tried> {
        let weaker = |k: usize| {
            let mut shares = [1.0, 0.5, 0.25].into_iter();
            shares.find_map(|share| self.fit_one(&starts[k], share, care).ok())
        };
        let none = |tried: &Tried| {
            let mut own = tried.candidates.iter().zip(&tried.places);
            own.any(|(&k, &place)| {
                self.all[k].within(tried.fit.at[place]) && !self.all[k].is_fitted(self.base)
            })
        };
        let mut tried: Vec<Tried> =
            on_all_cores(starts.len(), weaker).into_iter().flatten().collect();
        tried.retain(|tried| !none(tried));
        tried
    }

    /// The fit from this share of the strength.
    fn fit_one(&self, start: &Start, share: f64, care: Care) -> Result<Tried, ExplainError> {
        let own: Vec<&Candidate> = start.candidates.iter().map(|&k| &self.all[k]).collect();
        let taken = |unknown: &&Unknown| !own.iter().any(|c| c.owns(unknown));
        let mut unknowns: Vec<Unknown> = self.base.iter().filter(taken).cloned().collect();
        for candidate in &own {
            unknowns.extend(candidate.beside.iter().cloned());
        }
        let first = unknowns.len();
        for (candidate, at) in own.iter().zip(&start.at) {
            let start = if share < 1.0 { candidate.scaled(*at, share) } else { *at };
            unknowns.push(Unknown { start, ..candidate.unknown.clone() });
        }
        let mut slopes = self.slopes;
        if let Some(earlier) = &start.earlier {
            for (unknown, at) in unknowns.iter_mut().zip(&earlier.fit.at) {
                unknown.start = *at;
            }
            slopes = &earlier.fit.slopes;
        }
        let places = (first..unknowns.len()).collect();
        let fit = fit(self.experiment, &unknowns, self.likelihood, slopes, care)?;
        Ok(Tried { candidates: start.candidates.clone(), unknowns, places, fit })
    }
}

/// Cosine of the sensitivities of two effects, without what the tolerances could take up.
pub fn cosine(a: &Tried, b: &Tried) -> f64 {
    let own = |tried: &Tried| {
        let place = tried.places[0];
        let mut column = tried.fit.sensitivity.column(place).into_owned();
        let others = tried.fit.sensitivity.columns(0, place);
        if let Ok(inverse) = (others.tr_mul(&others)).pseudo_inverse(1e-12) {
            column -= others * (inverse * others.tr_mul(&column));
        }
        column
    };
    let (a, b) = (own(a), own(b));
    (a.dot(&b) / (a.norm() * b.norm()).max(1e-300)).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench;
    use crate::catalogue::candidates;

    #[test]
    fn what_does_not_run_is_tried_weaker_or_is_worthless() {
        let experiment = bench::experiment(&[]);
        let mut all = candidates(&experiment);
        let is_length = |c: &Candidate| (c.id, c.component.as_str()) == ("P10", "far");
        let k = all.iter().position(is_length).unwrap();
        // However near to what the plan says it ends.
        all[k].tolerance = None;
        let n = experiment.samples.len();
        let likelihood = Likelihood::new(vec![0.1; n], (0..n).collect());
        let (base, slopes) = (Vec::new(), Slopes::new());
        let common = Common {
            experiment: &experiment,
            base: &base,
            all: &all,
            likelihood: &likelihood,
            slopes: &slopes,
        };
        let from = |at: f64| Start { candidates: vec![k], at: vec![at], earlier: None };
        // A length of -0.1 is none, half of that change is a length of 0.45. Of -10 not even a quarter is: 1 - 11/4 < 0.
        let tried = common.fits(&[from(-0.1), from(-10.0)], Care::Quick);
        assert_eq!(tried.len(), 1);
        assert!((tried[0].fit.at[0] - 1.0).abs() < 0.2, "{:?}", tried[0].fit.at);
    }

    #[test]
    fn a_drift_within_what_its_class_permits_is_none() {
        use crate::unknown::Target;
        let house = 3;
        // (0.15 + 0.002 * 50) K are permitted, but below 0.4 K none is told.
        for (drift_k, count) in [(0.3, 0), (0.5, 1)] {
            let drift = Unknown::plain(Target::Drift(house), 0.0, 1.0);
            let experiment = bench::experiment(&[(drift, drift_k)]);
            let all = candidates(&experiment);
            let is_drift = |c: &Candidate| c.unknown.target == Target::Drift(house);
            let k = all.iter().position(is_drift).unwrap();
            let n = experiment.samples.len();
            let likelihood = Likelihood::new(vec![0.02; n], (0..n).collect());
            let (base, slopes) = (Vec::new(), Slopes::new());
            let (experiment, base, likelihood) = (&experiment, &base, &likelihood);
            let common = Common { experiment, base, all: &all, likelihood, slopes: &slopes };
            // A first guess may be less than what a fit finds.
            let start = Start { candidates: vec![k], at: vec![0.25], earlier: None };
            assert_eq!(common.fits(&[start], Care::Quick).len(), count);
        }
    }
}
