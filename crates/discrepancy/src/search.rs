//! Name: which effects explain the difference; one after the other, with a step back, and pairs that hide each other.

mod conclude;
mod left;
mod rank;
mod settled;
mod steps;
mod wins;

use crate::catalogue::Candidate;
use crate::error::ExplainError;
use crate::experiment::Experiment;
use crate::explain::{Finding, Stopwatch, Verdict};
use crate::fit::{Care, Fit, Slopes, fit, unfitted};
use crate::likelihood::Likelihood;
use crate::next::{Addition, Rivals};
use crate::screen::{Looked, Screened, Without, kept};
use crate::trial::{Common, Start, Tried};
use crate::uncertainty::Spread;
use crate::unknown::Unknown;
use nalgebra::DVector;
pub(crate) use settled::Settled;
use std::collections::HashSet;
pub(crate) use wins::TOGETHER;
use wins::{STRAINS, WINS, adds, together};

/// The likelihood is taken to the power of one over this ...
const TEMPERATURE: f64 = 1.0;
/// ... or over this times the root of the nats that the best effect gains: the more is explained, the more its flaws weigh.
const LOUD: f64 = 0.125;
/// An effect that brings less than this is taken out again, nats.
const KEEPS: f64 = 2.0;
/// Effects whose residuals on samples not fitted are so many times the best one's, and take away so much less, are refuted ...
const AS_WELL: (f64, f64) = (2.0, 0.25);
/// ... or are so many times the best one's, however much there was.
const FAR_WORSE: f64 = 3.0;
/// An effect that lies so many standard deviations from the middle of its range is no explanation.
const BEYOND: f64 = 3.0;
/// Odds are taken to the power of one over this for a probability ...
const WARM: f64 = 3.0;
/// ... of which this share belongs to causes that were tried: so that in cases of development it is how often a name was right.
const TRIED: f64 = 0.94;
/// Values within so many standard deviations of what is plausible are equally so.
const PLAUSIBLE: f64 = 2.0;
/// Sensitivities whose directions agree better than this are not told apart.
const PARALLEL: f64 = 0.99;
/// Residuals beyond this many standard deviations (root mean square) are a discrepancy.
pub(crate) const DIFFERS: f64 = 1.3;
/// Without an effect that explains it, a discrepancy below this is one of the tolerances.
const UNEXPLAINED: f64 = 1.6;
/// A discrepancy is explained where an effect takes away this share of it.
const EXPLAINED: f64 = 0.5;
/// ... or leaves no more than this, standard deviations, and foretells what was not fitted ...
const LEAVES: f64 = 1.6;
/// ... or takes away this share and foretells in nearly every block: that fronts leave more than their sigma is no second cause.
const TAKES: f64 = 0.1;
/// Whatever was found, more than this is left by another cause, standard deviations.
const TOO_MUCH: f64 = 4.0;
/// ... or where a sensor leaves more than [`UNEXPLAINED`] beyond chance, and this share of what it showed.
const LEFT: f64 = 0.25;
/// What comes so near the best one, nats, is fitted with care; at most so many.
const CLOSE: f64 = 8.0;
const MOST_CLOSE: usize = 4;
const MOST_EFFECTS: usize = 5;
/// More effects than these at once are rather one cause that is not in the catalogue.
const MOST_TOGETHER: usize = 2;
/// Candidates that are compared in earnest after the first look.
const MOST_COMPARED: usize = 6;
/// Pairs that are compared in earnest, and candidates of which they are made.
const PAIRS: (usize, usize) = (3, 8);
/// An unknown that can move no more than this in all samples together, standard deviations, is left out.
const MOVES: f64 = 0.1;

/// The first round, and from where it started.
struct First {
    round: Round,
    /// Of its fits.
    temperature: f64,
    base: Vec<Unknown>,
    slopes: Slopes,
}

/// One round: what could be added next.
struct Round {
    /// Readings without it, every sample new.
    quick: Vec<f64>,
    /// Their whitened residuals.
    e: DVector<f64>,
    looked: Vec<Screened>,
    /// Residuals without it on samples that were not fitted.
    null_z: f64,
    tried: Vec<Tried>,
    findings: Vec<Finding>,
}

pub(crate) struct Search<'a> {
    experiment: &'a Experiment,
    spread: &'a Spread,
    all: &'a [Candidate],
    base: Vec<Unknown>,
    likelihood: Likelihood,
    validated: Vec<usize>,
    taken: Vec<usize>,
    slopes: Slopes,
    /// With which the model does not run, and why.
    fail: Vec<(usize, String)>,
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        experiment: &'a Experiment,
        spread: &'a Spread,
        all: &'a [Candidate],
        base: Vec<Unknown>,
        likelihood: Likelihood,
        validated: Vec<usize>,
    ) -> Self {
        let (taken, slopes, fail) = (Vec::new(), Slopes::new(), Vec::new());
        Self { experiment, spread, all, base, likelihood, validated, taken, slopes, fail }
    }

    pub(crate) fn run(&mut self, watch: &mut Stopwatch) -> Result<Settled, ExplainError> {
        let mut settled = Settled::nothing();
        let mut first: Option<First> = None;
        while self.taken.len() < MOST_EFFECTS {
            let is_first = self.taken.is_empty();
            self.likelihood.forget();
            let care = if is_first { Care::Alone } else { Care::Quick };
            let null = fit(self.experiment, &self.base, &self.likelihood, &self.slopes, care)?;
            self.likelihood.predict(self.spread.seen(self.experiment, &self.base, &null.at));
            // As large as what is predicted beside the noise of the sensors really is.
            self.likelihood.rescale(self.experiment, &null.readings);
            self.likelihood.temper(self.experiment, &null.readings);
            let from = |(u, at): (&Unknown, &f64)| Unknown { start: *at, ..u.clone() };
            let started: Vec<Unknown> = self.base.iter().zip(&null.at).map(from).collect();
            let (likelihood, slopes) = (&self.likelihood, &null.slopes);
            let null = fit(self.experiment, &started, likelihood, slopes, Care::Quick)?;
            watch.lap("tolerances");
            let z = self.z(&null.readings);
            if is_first {
                settled.null_readings.clone_from(&null.readings);
                settled.null = (self.base.clone(), null.at.clone());
            }
            let worst = self.worst(&null.readings);
            let null = if is_first { self.leave_out(null) } else { null };
            let Some(round) = self.round(null, z, watch)? else {
                if is_first {
                    settled.because = format!(
                        "residuals are {z:.2} standard deviations (root mean square), and no effect would change that"
                    );
                }
                break;
            };
            if is_first {
                self.conclude(&round, worst, &mut settled);
                settled.tried.clone_from(&round.findings);
                if settled.verdict == Verdict::Class {
                    settled.additions = self.additions(&round, &settled.class);
                    watch.lap("next measurement");
                }
            }
            let named = matches!(settled.verdict, Verdict::Named | Verdict::Class);
            let adds = |f: &Finding| adds(f, self.taken.len());
            let next = named && round.findings.first().is_some_and(adds);
            if !next || self.likely(&round, worst).is_empty() {
                first = first.or_else(|| self.first(round));
                break;
            }
            let started = (self.base.clone(), self.slopes.clone(), self.likelihood.temperature);
            // Of a class the most plausible one.
            let head =
                settled.class.first().filter(|_| is_first && settled.verdict == Verdict::Class);
            let is_head =
                |f: &Finding| head.is_some_and(|h| (h.id, &h.component) == (f.id, &f.component));
            let k = round.findings.iter().position(is_head).unwrap_or(0);
            let is_class = head.is_some();
            self.take(&round.tried[k], &round.findings[k..=k], &mut settled)?;
            if is_class {
                // It stands for the class.
                settled.effects[0].probability = settled.class.iter().map(|f| f.probability).sum();
            }
            self.step_back(&mut settled)?;
            watch.lap("step back");
            let (base, slopes, temperature) = started;
            first = first.or(Some(First { round, temperature, base, slopes }));
        }
        self.joint(&mut settled)?;
        if let Some(first) = first {
            self.pair(&first, &mut settled)?;
            watch.lap("pairs");
        }
        self.doubt(&mut settled)?;
        settled.sigma.clone_from(&self.likelihood.sigma);
        settled.taken.clone_from(&self.taken);
        settled.fail = std::mem::take(&mut self.fail);
        Ok(settled)
    }

    fn first(&self, round: Round) -> Option<First> {
        let (base, slopes) = (self.base.clone(), self.slopes.clone());
        let temperature = self.likelihood.temperature;
        self.taken.is_empty().then_some(First { round, temperature, base, slopes })
    }

    /// What would tell the members of a class apart.
    fn additions(&self, round: &Round, class: &[Finding]) -> Vec<Addition> {
        let of = |f: &Finding| {
            let mut found = round.tried.iter().zip(&round.findings);
            found.find(|(_, g)| (g.id, &g.component) == (f.id, &f.component)).map(|(t, _)| t)
        };
        let members = class.iter().filter_map(of).collect();
        let (experiment, likelihood) = (self.experiment, &self.likelihood);
        Rivals { experiment, likelihood, all: self.all, members }.additions()
    }

    /// Predicts what might have been as the sensors of a fit show it.
    fn predict(&mut self, unknowns: &[Unknown], at: &[f64]) {
        self.likelihood.predict(self.spread.seen(self.experiment, unknowns, at));
    }

    /// Leaves out what can hardly change anything.
    fn leave_out(&mut self, null: Fit) -> Fit {
        let moves = |j: usize| null.sensitivity.column(j).norm() * self.base[j].sd;
        let kept: Vec<usize> = (0..self.base.len()).filter(|&j| moves(j) > MOVES).collect();
        let started = kept.iter().map(|&j| Unknown { start: null.at[j], ..self.base[j].clone() });
        self.base = started.collect();
        self.slopes.clone_from(&null.slopes);
        null.only(&kept)
    }

    fn common(&self) -> Common<'_> {
        Common {
            experiment: self.experiment,
            base: &self.base,
            all: self.all,
            likelihood: &self.likelihood,
            slopes: &self.slopes,
        }
    }

    /// Looks at everything, compares the best in earnest.
    fn round(
        &mut self,
        quick: Fit,
        null_z: f64,
        watch: &mut Stopwatch,
    ) -> Result<Option<Round>, ExplainError> {
        let open: Vec<usize> = (0..self.all.len()).filter(|i| !self.taken.contains(i)).collect();
        let Looked { seen: looked, fail } = self.screen(&quick, &open);
        if self.taken.is_empty() {
            self.fail = fail;
        }
        watch.lap("screen");
        let could = looked.first().map_or(0.0, |s| s.gain);
        let far = |(u, x): (&Unknown, &f64)| u.fall(*x);
        let strain = 0.5 * self.base.iter().zip(&quick.at).map(far).sum::<f64>();
        if could < WINS && strain < STRAINS && null_z < UNEXPLAINED {
            return Ok(None);
        }
        let starts: Vec<Start> = kept(&looked, MOST_COMPARED).into_iter().map(Start::of).collect();
        // At first every sample counts in full, so that each candidate shows how well it can fit.
        let mut rough = self.common().fits(&starts, Care::Quick);
        watch.lap("fits");
        if self.taken.is_empty() && strain > STRAINS {
            rough.extend(self.afresh(&open));
            watch.lap("fits afresh");
        }
        rough.sort_by(|a, b| b.fit.log_evidence.total_cmp(&a.fit.log_evidence));
        let mut seen = HashSet::new();
        rough.retain(|tried| seen.insert(tried.candidates.clone()));
        rough.truncate(MOST_COMPARED);
        let (quick, e) = (quick.readings, quick.e);
        let none = Round { quick, e, looked, null_z, tried: Vec::new(), findings: Vec::new() };
        let Some(best) = rough.first() else { return Ok(Some(none)) };
        self.predict(&best.unknowns, &best.fit.at);
        self.likelihood.learn(self.experiment, &best.fit.readings);
        self.likelihood.temperature = self.temperature(&none.quick, &best.fit.readings);
        let null = fit(self.experiment, &self.base, &self.likelihood, &self.slopes, Care::Quick)?;
        let mut again: Vec<Start> = rough.into_iter().map(Start::again).collect();
        // What a few samples far off had hidden.
        let seen = self.screen(&null, &open).seen;
        let known = |s: &&Screened| again.iter().any(|start| start.candidates == [s.candidate]);
        let new: Vec<Start> =
            kept(&seen, MOST_COMPARED).into_iter().filter(|s| !known(s)).map(Start::of).collect();
        again.extend(new);
        let mut tried = self.common().fits(&again, Care::Quick);
        tried.sort_by(|a, b| b.fit.log_evidence.total_cmp(&a.fit.log_evidence));
        // Those that may win, or belong to its class, with all sensitivities renewed.
        let most = tried.first().map_or(0.0, |best| best.fit.log_evidence);
        let least = tried.iter().map(|t| self.z(&t.fit.readings)).fold(f64::INFINITY, f64::min);
        let near = CLOSE.max(2.0 * together(most - null.log_evidence, least));
        let close = tried.partition_point(|t| t.fit.log_evidence > most - near).min(MOST_CLOSE);
        let thorough: Vec<Start> = tried.drain(..close).map(Start::again).collect();
        tried.extend(self.common().fits(&thorough, Care::Thorough));
        let null = self.null_beside(null, &tried);
        watch.lap("fits again");
        let null_z = self.z(&null.readings);
        let findings = self.ranked(&null, &mut tried);
        Ok(Some(Round { null_z, tried, findings, ..none }))
    }

    /// Fits of what looks best where no tolerance is fitted yet: fitted ones may have gone where no effect helps any more, and
    /// where sensitivities are others.
    fn afresh(&self, open: &[usize]) -> Vec<Tried> {
        let new = |u: &Unknown| Unknown { start: u.mean, ..u.clone() };
        let base: Vec<Unknown> = self.base.iter().map(new).collect();
        let (experiment, likelihood) = (self.experiment, &self.likelihood);
        let Ok(fit) = unfitted(experiment, &base, likelihood) else { return Vec::new() };
        let without = Without { experiment, unknowns: &base, likelihood, fit: &fit };
        let looked = without.screen(self.all, open).seen;
        let starts: Vec<Start> = kept(&looked, MOST_COMPARED).into_iter().map(Start::of).collect();
        let (base, slopes) = (&base[..], &Slopes::new());
        Common { base, slopes, ..self.common() }.fits(&starts, Care::Quick)
    }

    fn screen(&self, fit: &Fit, open: &[usize]) -> Looked {
        let (experiment, unknowns, likelihood) = (self.experiment, &self.base, &self.likelihood);
        Without { experiment, unknowns, likelihood, fit }.screen(self.all, open)
    }

    /// The fit without an effect once more, from the tolerances that the best one has found: where it was only stuck, the effect
    /// gains nothing. Where the model without the effect does not run with them, they are no start.
    fn null_beside(&self, null: Fit, tried: &[Tried]) -> Fit {
        let evidence = |t: &&Tried| t.fit.log_evidence;
        let Some(best) = tried.iter().max_by(|a, b| evidence(a).total_cmp(&evidence(b))) else {
            return null;
        };
        let from = |u: &Unknown| {
            let place = best.unknowns.iter().position(|v| v.target == u.target);
            let place = place.filter(|place| !best.places.contains(place));
            Unknown { start: place.map_or(u.start, |place| best.fit.at[place]), ..u.clone() }
        };
        let beside: Vec<Unknown> = self.base.iter().map(from).collect();
        let slopes = &best.fit.slopes;
        let again = fit(self.experiment, &beside, &self.likelihood, slopes, Care::Thorough);
        again.ok().filter(|again| again.log_evidence > null.log_evidence).unwrap_or(null)
    }

    /// The power of the likelihood: see [`TEMPERATURE`] and [`LOUD`].
    fn temperature(&self, null: &[f64], best: &[f64]) -> f64 {
        let square = |readings: &[f64]| {
            let z = self.likelihood.z(self.experiment, readings);
            self.likelihood.counted(&self.likelihood.whitened(|i| z[i])).0.norm_squared()
        };
        let gain = 0.5 * (square(null) - square(best)).max(0.0);
        TEMPERATURE.max(LOUD * gain.sqrt())
    }

    fn take(
        &mut self,
        tried: &Tried,
        findings: &[Finding],
        settled: &mut Settled,
    ) -> Result<(), ExplainError> {
        self.taken.extend(&tried.candidates);
        for (finding, &place) in findings.iter().zip(&tried.places) {
            settled.effects.push(self.valued(finding.clone(), tried, place));
        }
        let started = tried.unknowns.iter().zip(&tried.fit.at);
        self.base = started.map(|(u, at)| Unknown { start: *at, ..u.clone() }).collect();
        self.slopes.clone_from(&tried.fit.slopes);
        settled.chosen = Some((tried.unknowns.clone(), tried.fit.at.clone()));
        Ok(())
    }
}

/// Logarithm of the odds of an effect so far from what is plausible, nats.
fn prior(strain: f64) -> f64 {
    -2.0 * (strain / PLAUSIBLE).max(1.0).ln()
}

/// Squared residuals beyond those that noise explains.
fn excess(z: f64) -> f64 {
    (z * z - 1.0).max(0.0)
}

#[cfg(test)]
mod tests;
