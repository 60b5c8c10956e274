//! Find, name, add, show: the whole workflow.

use crate::catalogue::{Candidate, candidates, tolerances};
use crate::error::ExplainError;
use crate::experiment::Experiment;
use crate::find::{Found, find};
use crate::gap::{Gap, gaps};
use crate::likelihood::Likelihood;
use crate::next::Addition;
use crate::profile::Profile;
use crate::sanity;
use crate::search::{Search, Settled};
use crate::split::{SplitFile, Use, split};
use crate::uncertainty::{Spread, Uncertainties};
use crate::unknown::{Estimate, Target, Unknown};
use serde::Serialize;
use std::time::Instant;

/// What `explain` concludes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// One effect, or several, by name.
    Named,
    /// Effects that these data cannot tell apart.
    Class,
    /// A discrepancy that no effect of the catalogue explains.
    Unexplained,
    /// Simulation and measurement agree within the accuracy of the sensors.
    Nothing,
    /// The data contradict themselves.
    DataProblem,
}

/// An effect that was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Word of the catalogue.
    pub id: &'static str,
    /// Component, or column of a sensor.
    pub component: String,
    /// What it is.
    pub words: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// Unit of the parameter.
    pub unit: &'static str,
    /// Fitted value and 95 % interval.
    pub estimate: Estimate,
    /// Ends of the 95 % interval by the profile likelihood, made as wide as cases say; none where the data alone do not bound it. Only of what was added.
    pub profile: Option<[Option<f64>; 2]>,
    /// What else of the effect was fitted: parameter and value.
    pub beside: Vec<(&'static str, f64)>,
    /// Probability among what was tried.
    pub probability: f64,
    /// Evidence over the model without it, nats, tempered.
    pub evidence: f64,
    /// Log predictive density of blocks that were left out over that of the model without it, nats.
    pub elpd: f64,
    /// Standard error of it.
    pub elpd_error: f64,
    /// Distance from what is plausible, standard deviations.
    pub strain: f64,
    /// Distance from the middle of the range of the effect, standard deviations.
    pub beyond: f64,
    /// How far it takes what else is uncertain of the same sensor from the middle of its range, standard deviations.
    pub takes_along: f64,
    /// Whether tolerances that are fitted without it too can stand for it: its own quantity is one, or most of its evidence is that
    /// others are strained less.
    pub tolerated: bool,
    /// Whether it is no more than the tolerance of its quantity: a sensor that drifts within its class.
    pub within: bool,
    /// Whether its interval, which no block of time may leave, holds the value at which it is none.
    pub is_open: bool,
    /// Root mean square of all residuals on the validation samples over their uncertainty.
    pub validation_z: f64,
    /// The largest reduction of the error of a sensor on the validation samples, relative.
    pub reduction: f64,
    /// What the data leave open about the value: at its bound, hardly narrower than its range, or tied to another unknown.
    pub flags: Vec<String>,
    /// What would tell it from its rivals.
    pub separates: &'static str,
}

impl Finding {
    /// With the interval of the profile likelihood, at least as wide as it was.
    pub(crate) fn with_profile(mut self, profile: Profile, unknown: &Unknown) -> Self {
        let ends = [profile.lo, profile.hi].map(|end| end.map(|x| unknown.value(x)));
        let estimate = &mut self.estimate;
        estimate.lo = ends[0].map_or(estimate.lo, |lo| lo.min(estimate.lo));
        estimate.hi = ends[1].map_or(estimate.hi, |hi| hi.max(estimate.hi));
        let flag = match ends {
            [None, None] => Some("the data alone bound it on neither side"),
            [None, _] => Some("the data alone do not bound it below"),
            [_, None] => Some("the data alone do not bound it above"),
            _ => None,
        };
        self.flags.extend(flag.map(str::to_owned));
        self.profile = Some(ends);
        self
    }

    /// Whether it is an effect of a sensor, not of the plant.
    pub fn of_sensor(&self) -> bool {
        self.id.starts_with('S')
    }
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// The conclusion.
    pub verdict: Verdict,
    /// Why, in a sentence.
    pub because: String,
    /// What is wrong with the data.
    pub problems: Vec<String>,
    /// Where and when simulation and measurement differ.
    pub found: Option<Found>,
    /// The effects found, in the order in which they were added.
    pub effects: Vec<Finding>,
    /// Effects that the data do not tell apart from the first one, the first one included.
    pub class: Vec<Finding>,
    /// What would tell the members of the class apart, by simulation, the most telling first.
    pub additions: Vec<Addition>,
    /// Everything that was tried in the first round, best first.
    pub tried: Vec<Finding>,
    /// What could not be tried, as the model does not run with it.
    pub not_tried: Vec<NotTried>,
    /// Unknowns of the last fit: name, value, and distance from the middle of their range in standard deviations.
    pub strained: Vec<(String, f64, f64)>,
    /// Before and after, by sensor and regime.
    pub gaps: Vec<Gap>,
    /// How long each part took, s.
    pub times: Vec<(&'static str, f64)>,
    /// Readings of every sample: as measured, of the model as it is, and with the effects.
    #[serde(skip)]
    pub curves: Curves,
}

/// An effect with which the model does not run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NotTried {
    /// Word of the catalogue.
    pub id: &'static str,
    /// Where.
    pub component: String,
    /// What the run ended with.
    pub because: String,
}

/// Readings to draw, SI.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curves {
    /// Of the model as it is.
    pub before: Vec<f64>,
    /// With the effects.
    pub after: Vec<f64>,
    /// Standard deviation of every sample.
    pub sigma: Vec<f64>,
    /// Use of every sample.
    pub uses: Vec<Option<Use>>,
}

/// Measures how long parts take.
pub(crate) struct Stopwatch {
    begun: Instant,
    times: Vec<(&'static str, f64)>,
}

impl Stopwatch {
    /// Begins now.
    pub(crate) fn new() -> Self {
        Self { begun: Instant::now(), times: Vec::new() }
    }

    /// The time since the last call belongs to this part.
    pub(crate) fn lap(&mut self, part: &'static str) {
        let took = self.begun.elapsed().as_secs_f64();
        match self.times.iter_mut().find(|(name, _)| *name == part) {
            Some((_, time)) => *time += took,
            None => self.times.push((part, took)),
        }
        self.begun = Instant::now();
    }
}

/// Explains the difference between a model and measurements.
///
/// # Errors
/// Files that cannot be read, a model that does not run. Data that contradict themselves are a verdict.
pub fn explain(
    experiment: &Experiment,
    split_file: Option<&SplitFile>,
) -> Result<Explanation, ExplainError> {
    let mut watch = Stopwatch::new();
    let problems = sanity::of_data(experiment);
    if !problems.is_empty() {
        return Ok(data_problem(problems));
    }
    let uses = split(experiment, split_file)?;
    let model = match experiment.simulated(&[], &[], 1) {
        Ok(model) => model,
        Err(error) => match sanity::keeps_from_running(experiment) {
            problems if problems.is_empty() => return Err(error),
            problems => return Ok(data_problem(problems)),
        },
    };
    let before = experiment.observed(&model, &[], &[]);
    let spread = Spread::new(experiment, model, &[], &[]);
    let Uncertainties { sigma, known } = spread.seen(experiment, &[], &[]);
    watch.lap("uncertainty");
    let problems = sanity::beside(experiment, &before, &sigma);
    watch.lap("sanity");
    if !problems.is_empty() {
        return Ok(data_problem(problems));
    }
    let of = |wanted: Use| -> Vec<usize> {
        (0..uses.len()).filter(|&i| uses[i] == Some(wanted)).collect()
    };
    let all = candidates(experiment);
    // What was fitted foretells what chooses: both together weigh the evidence. What is shown stays untouched.
    let fitted = (0..uses.len()).filter(|&i| uses[i].is_some_and(|u| u != Use::Show)).collect();
    let likelihood = Likelihood { known, ..Likelihood::new(sigma, fitted) };
    let found_sigma = likelihood.sigma.clone();
    let validated = of(Use::Validate);
    let beside = tolerances(experiment);
    let mut search = Search::new(experiment, &spread, &all, beside, likelihood, validated);
    let settled = search.run(&mut watch)?;
    let strained = settled.strained();
    let not_tried = |(k, because): (usize, String)| {
        let Candidate { id, ref component, .. } = all[k];
        NotTried { id, component: component.clone(), because }
    };
    let Settled {
        verdict,
        because,
        taken,
        effects: mut found_effects,
        class,
        tried,
        fail,
        null_readings,
        additions,
        null: _,
        chosen,
        sigma,
    } = settled;
    let found = find(experiment, &uses, &found_sigma, &before, &null_readings)?;
    watch.lap("find");
    // What the written model gives: the effects alone, every tolerance at its middle.
    let (after, fitted) = match &chosen {
        Some((unknowns, at)) => (
            alone(experiment, &all, &taken, unknowns, at, &mut found_effects)?,
            experiment.readings(unknowns, at)?,
        ),
        None => (before.clone(), null_readings),
    };
    let fitted = if fitted.is_empty() { &before } else { &fitted };
    let gaps = gaps(experiment, &uses, &sigma, &before, &after, fitted);
    watch.lap("show");
    Ok(Explanation {
        verdict,
        because,
        problems: Vec::new(),
        found: Some(found),
        effects: found_effects,
        class,
        additions,
        tried,
        not_tried: fail.into_iter().map(not_tried).collect(),
        strained,
        gaps,
        times: watch.times,
        curves: Curves { before, after, sigma, uses },
    })
}

/// Compares only: how far the model is from the measurements on every use of the samples, and fits nothing. (An explained model
/// beside new data; a model that somebody has mended.)
///
/// # Errors
/// Files that cannot be read, a model that does not run.
pub fn compare(
    experiment: &Experiment,
    split_file: Option<&SplitFile>,
) -> Result<Vec<Gap>, ExplainError> {
    let uses = split(experiment, split_file)?;
    let model = experiment.simulated(&[], &[], 1)?;
    let before = experiment.observed(&model, &[], &[]);
    let sigma = Spread::new(experiment, model, &[], &[]).seen(experiment, &[], &[]).sigma;
    Ok(gaps(experiment, &uses, &sigma, &before, &before, &before))
}

/// Readings with the effects alone; their values are those of the last fit.
fn alone(
    experiment: &Experiment,
    all: &[Candidate],
    taken: &[usize],
    unknowns: &[Unknown],
    at: &[f64],
    effects: &mut [Finding],
) -> Result<Vec<f64>, ExplainError> {
    let of_effect = |i: &usize| {
        let mut added = taken.iter().flat_map(|&k| all[k].beside.iter().chain([&all[k].unknown]));
        added.any(|unknown| unknown.target == unknowns[*i].target)
    };
    let effective: Vec<usize> = (0..unknowns.len()).filter(of_effect).collect();
    let only: Vec<Unknown> = effective.iter().map(|&i| unknowns[i].clone()).collect();
    let values: Vec<f64> = effective.iter().map(|&i| at[i]).collect();
    for (finding, k) in effects.iter_mut().zip(taken) {
        if let Some(i) = unknowns.iter().position(|u| u.target == all[*k].unknown.target) {
            finding.estimate.value = unknowns[i].value(at[i]);
            finding.beside = values_beside(&all[*k], unknowns, at);
        }
    }
    experiment.readings(&only, &values)
}

/// Values of the further parameters of an effect.
pub(crate) fn values_beside(
    candidate: &Candidate,
    unknowns: &[Unknown],
    at: &[f64],
) -> Vec<(&'static str, f64)> {
    let fitted = |wanted: &Unknown| {
        let i = unknowns.iter().position(|unknown| unknown.target == wanted.target)?;
        let field = match wanted.target {
            Target::Effect { field, .. } => field,
            Target::StepShare(_) => "step_share",
            _ => return None,
        };
        Some((field, unknowns[i].value(at[i])))
    };
    candidate.beside.iter().filter_map(fitted).collect()
}

fn data_problem(problems: Vec<String>) -> Explanation {
    Explanation {
        verdict: Verdict::DataProblem,
        because: problems[0].clone(),
        problems,
        found: None,
        effects: Vec::new(),
        class: Vec::new(),
        additions: Vec::new(),
        tried: Vec::new(),
        not_tried: Vec::new(),
        strained: Vec::new(),
        gaps: Vec::new(),
        times: Vec::new(),
        curves: Curves::default(),
    }
}
