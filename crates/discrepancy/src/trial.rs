//! Candidates beside what is uncertain anyway: a fit of each, on all cores.

use crate::catalogue::Candidate;
use crate::error::ExplainError;
use crate::experiment::Experiment;
use crate::fit::{Fit, Likelihood, fit};
use crate::unknown::Unknown;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A candidate with its fit.
pub struct Tried {
    /// Its place among the candidates.
    pub candidate: usize,
    /// Everything that was fitted.
    pub unknowns: Vec<Unknown>,
    /// Place of the candidate's parameter among the unknowns.
    pub place: usize,
    /// The fit.
    pub fit: Fit,
}

/// Fits of candidates beside what is there; from the values of an earlier round where there is one.
///
/// # Errors
/// What keeps the model from running with every one of them.
pub fn fits(
    experiment: &Experiment,
    base: &[Unknown],
    all: &[Candidate],
    open: &[usize],
    likelihood: &Likelihood,
    earlier: &[Tried],
) -> Result<Vec<Tried>, ExplainError> {
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, Result<Tried, ExplainError>)>> = Mutex::new(Vec::new());
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(open.len().max(1));
    std::thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    let Some(&candidate) = open.get(k) else { break };
                    let start = earlier.iter().find(|tried| tried.candidate == candidate);
                    let tried = try_one(experiment, base, all, candidate, likelihood, start);
                    if let Ok(mut done) = done.lock() {
                        done.push((k, tried));
                    }
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_default();
    done.sort_by_key(|(k, _)| *k);
    // A candidate with which the model does not run is none, unless it runs with none of them.
    let (ran, failed): (Vec<_>, Vec<_>) =
        done.into_iter().map(|(_, tried)| tried).partition(Result::is_ok);
    if ran.is_empty()
        && let Some(error) = failed.into_iter().find_map(Result::err)
    {
        return Err(error);
    }
    Ok(ran.into_iter().filter_map(Result::ok).collect())
}

fn try_one(
    experiment: &Experiment,
    base: &[Unknown],
    all: &[Candidate],
    candidate: usize,
    likelihood: &Likelihood,
    start: Option<&Tried>,
) -> Result<Tried, ExplainError> {
    let own = &all[candidate].unknown;
    let mut unknowns: Vec<Unknown> =
        base.iter().filter(|unknown| unknown.target != own.target).cloned().collect();
    unknowns.extend(all[candidate].beside.iter().cloned());
    unknowns.push(own.clone());
    if let Some(start) = start {
        for (unknown, at) in unknowns.iter_mut().zip(&start.fit.at) {
            unknown.start = *at;
        }
    }
    let place = unknowns.len() - 1;
    let fit = fit(experiment, &unknowns, likelihood)?;
    Ok(Tried { candidate, unknowns, place, fit })
}

/// Cosine of the sensitivities of two effects, without what the tolerances could take up.
pub fn cosine(a: &Tried, b: &Tried) -> f64 {
    let own = |tried: &Tried| {
        let mut column = tried.fit.sensitivity.column(tried.place).into_owned();
        let others = tried.fit.sensitivity.columns(0, tried.place);
        if let Ok(inverse) = (others.tr_mul(&others)).pseudo_inverse(1e-12) {
            column -= others * (inverse * others.tr_mul(&column));
        }
        column
    };
    let (a, b) = (own(a), own(b));
    (a.dot(&b) / (a.norm() * b.norm()).max(1e-300)).abs()
}
