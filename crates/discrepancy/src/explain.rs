//! Find, name, add, show: the whole workflow.

use crate::catalogue::{Candidate, candidates, tolerances};
use crate::error::ExplainError;
use crate::experiment::Experiment;
use crate::fit::{Likelihood, fit};
use crate::gap::{Gap, gaps};
use crate::sanity;
use crate::split::{SplitFile, Use, split};
use crate::trial::{Tried, cosine, fits};
use crate::unknown::{Estimate, Target, Unknown};
use serde::Serialize;
use std::collections::HashMap;

/// Evidence of residuals that are not quite what they are taken for speaks too loudly: it is divided by this. With 8, the
/// two records of the pipe of Liege name its wall, and each one alone leaves wall and slow sensor as a class.
const TEMPERATURE: f64 = 8.0;
/// Evidence by which an effect must beat the model without it, nats.
const WINS: f64 = 4.0;
/// Evidence within which two effects are not told apart, nats.
const TOGETHER: f64 = 3.0;
/// Effects whose residuals on samples that were not fitted are so many times those of the best are refuted.
const AS_WELL: f64 = 1.5;
/// An effect that lies so many standard deviations from the middle of its range is no explanation.
const BEYOND: f64 = 3.0;
/// Values within so many standard deviations of what is plausible are equally so.
const PLAUSIBLE: f64 = 2.0;
/// Sensitivities whose directions agree better than this are not told apart.
const PARALLEL: f64 = 0.99;
/// The least reduction of the error on samples that were not fitted.
const REDUCTION: f64 = 0.05;
/// Residuals beyond this many standard deviations (root mean square) are a discrepancy.
const DIFFERS: f64 = 1.3;
/// After an effect was added, nothing is looked for any more below this.
const AGREES: f64 = 1.2;
/// A discrepancy is explained where an effect takes away this share of it.
const EXPLAINED: f64 = 0.5;
const MOST_EFFECTS: usize = 5;
/// Candidates that are compared in earnest after the first look.
const MOST_COMPARED: usize = 6;

fn tempered(evidence: f64) -> f64 {
    evidence / TEMPERATURE
}

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
    /// What else of the effect was fitted: parameter and value.
    pub beside: Vec<(&'static str, f64)>,
    /// Probability among what was tried.
    pub probability: f64,
    /// Evidence over the model without it, nats.
    pub evidence: f64,
    /// Distance from what is plausible, standard deviations.
    pub strain: f64,
    /// Distance from the middle of the range of the effect, standard deviations.
    pub beyond: f64,
    /// Root mean square of all residuals on the validation samples over their uncertainty.
    pub validation_z: f64,
    /// What would tell it from its rivals.
    pub separates: &'static str,
}

impl Finding {
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
    /// The effects found, in the order in which they were added.
    pub effects: Vec<Finding>,
    /// Effects that the data do not tell apart from the first one, the first one included.
    pub class: Vec<Finding>,
    /// Everything that was tried in the first round, best first.
    pub tried: Vec<Finding>,
    /// Before and after, by sensor and regime.
    pub gaps: Vec<Gap>,
    /// Readings of every sample: as measured, of the model as it is, and with the effects.
    #[serde(skip)]
    pub curves: Curves,
}

/// Readings to draw, SI.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curves {
    /// Of the model as it is.
    pub before: Vec<f64>,
    /// With the effects.
    pub after: Vec<f64>,
    /// Use of every sample.
    pub uses: Vec<Option<Use>>,
}

/// Explains the difference between a model and measurements.
///
/// # Errors
/// Files that cannot be read, a model that does not run. Data that contradict themselves are a verdict.
pub fn explain(
    experiment: &Experiment,
    split_file: Option<&SplitFile>,
) -> Result<Explanation, ExplainError> {
    let problems = sanity::of_data(experiment);
    if !problems.is_empty() {
        return Ok(data_problem(problems));
    }
    let uses = split(experiment, split_file)?;
    let before = experiment.readings(&[], &[])?;
    let sigma = uncertainties(experiment, &before)?;
    let problems = sanity::beside(experiment, &before, &sigma);
    if !problems.is_empty() {
        return Ok(data_problem(problems));
    }
    let of = |wanted: Use| -> Vec<usize> {
        (0..uses.len()).filter(|&i| uses[i] == Some(wanted)).collect()
    };
    let (fitted, validated) = (of(Use::Identify), of(Use::Validate));
    let all = candidates(experiment);
    let mut base = tolerances(experiment);
    let mut likelihood = Likelihood { sigma, fitted, noise: HashMap::new() };
    let z = |likelihood: &Likelihood, readings: &[f64], samples: &[usize]| -> f64 {
        let square = |&i: &usize| {
            ((experiment.samples[i].value - readings[i]) / likelihood.sigma[i]).powi(2)
        };
        (samples.iter().map(square).sum::<f64>() / samples.len() as f64).sqrt()
    };
    let mut found: Vec<Finding> = Vec::new();
    let mut first: Option<(Vec<Finding>, Vec<Finding>)> = None;
    let mut taken: Vec<usize> = Vec::new();
    let mut chosen: Option<(Vec<Unknown>, Vec<f64>)> = None;
    let mut null_z = 0.0;
    let mut verdict = Verdict::Nothing;
    let mut because = String::new();
    while taken.len() < MOST_EFFECTS {
        // At first every sample counts in full, so that each candidate shows how well it can fit.
        likelihood.noise.clear();
        let null = fit(experiment, &base, &likelihood)?;
        let here_z = z(&likelihood, &null.readings, &validated);
        if taken.is_empty() {
            null_z = here_z;
            if here_z <= DIFFERS {
                because =
                    format!("residuals are {here_z:.2} standard deviations (root mean square)");
                break;
            }
        } else if here_z <= AGREES {
            break;
        }
        let open: Vec<usize> = (0..all.len()).filter(|i| !taken.contains(i)).collect();
        let mut rough = fits(experiment, &base, &all, &open, &likelihood, &[])?;
        rough.sort_by(|a, b| b.fit.log_evidence.total_cmp(&a.fit.log_evidence));
        rough.truncate(MOST_COMPARED);
        let open: Vec<usize> = rough.iter().map(|tried| tried.candidate).collect();
        let Some(best) = rough.first() else { break };
        likelihood.noise = likelihood.noise_of(experiment, &best.fit.readings);
        let null = fit(experiment, &base, &likelihood)?;
        let mut tried = fits(experiment, &base, &all, &open, &likelihood, &rough)?;
        // What does badly on samples that were not fitted is refuted, however well it was fitted.
        let own_z = |t: &Tried| z(&likelihood, &t.fit.readings, &validated);
        let least = tried.iter().map(own_z).fold(f64::INFINITY, f64::min);
        let refuted = |t: &Tried| own_z(t) > AS_WELL * least;
        tried.sort_by(|a, b| {
            let evidence = || b.fit.log_evidence.total_cmp(&a.fit.log_evidence);
            refuted(a).cmp(&refuted(b)).then_with(evidence)
        });
        let here_z = z(&likelihood, &null.readings, &validated);
        let over = |log_evidence: f64| tempered(log_evidence - tried[0].fit.log_evidence).exp();
        let open = tried.iter().filter(|t| !refuted(t)).map(|t| over(t.fit.log_evidence));
        let total = open.sum::<f64>() + over(null.log_evidence);
        let finding = |t: &Tried| {
            let candidate = &all[t.candidate];
            Finding {
                id: candidate.id,
                component: candidate.component.clone(),
                words: candidate.words,
                parameter: candidate.parameter.0,
                unit: candidate.parameter.1,
                estimate: t.fit.estimate(&t.unknowns, t.place),
                beside: values_beside(candidate, &t.unknowns, &t.fit.at),
                probability: if refuted(t) { 0.0 } else { over(t.fit.log_evidence) / total },
                evidence: tempered(t.fit.log_evidence - null.log_evidence),
                strain: candidate.strain(t.fit.at[t.place]),
                beyond: (t.fit.at[t.place] - candidate.unknown.mean).abs() / candidate.unknown.sd,
                validation_z: z(&likelihood, &t.fit.readings, &validated),
                separates: candidate.separates,
            }
        };
        let findings: Vec<Finding> = tried.iter().map(finding).collect();
        let Some(winner) = findings.first() else { break };
        let wins = winner.evidence > WINS && winner.validation_z < (1.0 - REDUCTION) * here_z;
        if first.is_none() {
            let mut class: Vec<Finding> = Vec::new();
            if wins {
                for (t, f) in tried.iter().zip(&findings) {
                    let behind = winner.evidence - f.evidence;
                    let parallel = behind < 2.0 * TOGETHER && cosine(&tried[0], t) > PARALLEL;
                    if !refuted(t) && (behind < TOGETHER || parallel) {
                        class.push(f.clone());
                    }
                }
                // What is far from plausible goes last; of the rest the evidence decides.
                let far = |f: &Finding| f.strain.max(PLAUSIBLE);
                class.sort_by(|a, b| {
                    far(a).total_cmp(&far(b)).then(b.evidence.total_cmp(&a.evidence))
                });
            }
            let excess = |z: f64| (z * z - 1.0).max(0.0);
            let explained = 1.0 - excess(winner.validation_z) / excess(null_z).max(1e-9);
            (verdict, because) = if !wins {
                (
                    Verdict::Unexplained,
                    format!(
                        "residuals are {null_z:.1} standard deviations, and no effect of the catalogue takes much of them away"
                    ),
                )
            } else if winner.beyond > BEYOND {
                (
                    Verdict::Unexplained,
                    format!(
                        "the best effect, {} at {}, would need a value far from anything plausible",
                        winner.id, winner.component
                    ),
                )
            } else if explained < EXPLAINED {
                (
                    Verdict::Unexplained,
                    format!(
                        "the best effect takes away only {:.0} % of the discrepancy",
                        100.0 * explained
                    ),
                )
            } else if class.len() > 1 {
                (
                    Verdict::Class,
                    format!("{} effects explain the data about equally well", class.len()),
                )
            } else {
                (
                    Verdict::Named,
                    format!(
                        "its probability is {:.2}, with {:.0} nats more evidence than the model without it",
                        winner.probability, winner.evidence
                    ),
                )
            };
            first = Some((class, findings.clone()));
        }
        let go_on = matches!(verdict, Verdict::Named | Verdict::Class) && wins;
        if !go_on {
            break;
        }
        // Of a class the most plausible one.
        let class = first.iter().flat_map(|(class, _)| class).next();
        let head = class.filter(|_| verdict == Verdict::Class && taken.is_empty());
        let is_head =
            |f: &Finding| head.is_some_and(|h| (h.id, &h.component) == (f.id, &f.component));
        let k = findings.iter().position(is_head).unwrap_or(0);
        taken.push(tried[k].candidate);
        found.push(findings[k].clone());
        base.clone_from(&tried[k].unknowns);
        chosen = Some((tried[k].unknowns.clone(), tried[k].fit.at.clone()));
        if verdict == Verdict::Class {
            break;
        }
    }
    // What the written model gives: the effects alone, every tolerance at its middle.
    let after = match &chosen {
        Some((unknowns, at)) => {
            let effects: Vec<usize> = (0..unknowns.len())
                .filter(|&i| {
                    let mut added =
                        taken.iter().flat_map(|&k| all[k].beside.iter().chain([&all[k].unknown]));
                    added.any(|unknown| unknown.target == unknowns[i].target)
                })
                .collect();
            let only: Vec<Unknown> = effects.iter().map(|&i| unknowns[i].clone()).collect();
            let values: Vec<f64> = effects.iter().map(|&i| at[i]).collect();
            for (finding, k) in found.iter_mut().zip(&taken) {
                if let Some(i) = unknowns.iter().position(|u| u.target == all[*k].unknown.target) {
                    finding.estimate.value = unknowns[i].value(at[i]);
                    finding.beside = values_beside(&all[*k], unknowns, at);
                }
            }
            experiment.readings(&only, &values)?
        }
        None => before.clone(),
    };
    let (class, tried) = first.unwrap_or_default();
    let gaps = gaps(experiment, &uses, &likelihood.sigma, &before, &after);
    Ok(Explanation {
        verdict,
        because,
        problems: Vec::new(),
        effects: found,
        class,
        tried,
        gaps,
        curves: Curves { before, after, uses },
    })
}

/// Values of the further parameters of an effect.
fn values_beside(
    candidate: &Candidate,
    unknowns: &[Unknown],
    at: &[f64],
) -> Vec<(&'static str, f64)> {
    let fitted = |wanted: &Unknown| {
        let i = unknowns.iter().position(|unknown| unknown.target == wanted.target)?;
        let Target::Effect { field, .. } = wanted.target else { return None };
        Some((field, unknowns[i].value(at[i])))
    };
    candidate.beside.iter().filter_map(fitted).collect()
}

fn data_problem(problems: Vec<String>) -> Explanation {
    Explanation {
        verdict: Verdict::DataProblem,
        because: problems[0].clone(),
        problems,
        effects: Vec::new(),
        class: Vec::new(),
        tried: Vec::new(),
        gaps: Vec::new(),
        curves: Curves::default(),
    }
}

/// Uncertainty of every sample: noise and resolution of its sensor, the time at which it was read within its interval,
/// and what the step of the simulation does (the difference to half the step).
fn uncertainties(experiment: &Experiment, readings: &[f64]) -> Result<Vec<f64>, ExplainError> {
    let finer = experiment.readings_in_steps(&[], &[], 2)?;
    let samples = &experiment.samples;
    let sigma = samples.iter().enumerate().map(|(i, sample)| {
        let same =
            |j: usize| samples.get(j).filter(|s| (s.run, s.sensor) == (sample.run, sample.sensor));
        let before = i.checked_sub(1).and_then(same).unwrap_or(sample);
        let after = same(i + 1).unwrap_or(sample);
        // Somewhere in the interval: a rectangular distribution over half of the two beside it.
        let moved = 0.5 * (after.value - before.value).abs() / 12.0_f64.sqrt();
        let noise = experiment.accuracy[sample.sensor].noise;
        let numerical = finer[i] - readings[i];
        (noise * noise + moved * moved + numerical * numerical).sqrt()
    });
    Ok(sigma.collect())
}
