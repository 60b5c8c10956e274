//! What was tried, best first.

use super::wins::{TOGETHER, together};
use super::{AS_WELL, FAR_WORSE, Search, TRIED, WARM, excess, prior};
use crate::catalogue::Candidate;
use crate::elpd;
use crate::experiment::Experiment;
use crate::explain::{Finding, values_beside};
use crate::fit::{Fit, WIDE};
use crate::profile::profile;
use crate::trial::Tried;
use crate::uncertainty::pause_s;
use crate::unknown::{Estimate, Unknown};
use std::collections::HashSet;

impl Search<'_> {
    /// Findings of what was tried, best first; what does badly on samples that were not fitted, would be weaker
    /// than what is looked for, or is ruled out by readings, is refuted and comes last.
    pub(super) fn ranked(&self, null: &Fit, tried: &mut Vec<Tried>) -> Vec<Finding> {
        let least = tried.iter().map(|t| self.z(&t.fit.readings)).fold(f64::INFINITY, f64::min);
        let null_z = self.z(&null.readings);
        let out = |t: &Tried| {
            let mut own = t.candidates.iter().zip(&t.places);
            own.any(|(&k, &place)| {
                let at = t.fit.at[place];
                self.all[k].refuted(at, at - WIDE * 1.96 * t.fit.covariance[(place, place)].sqrt())
            })
        };
        let refuted = |t: &Tried| out(t) || leaves_more(self.z(&t.fit.readings), least, null_z);
        tried.sort_by(|a, b| {
            let evidence = || b.fit.log_evidence.total_cmp(&a.fit.log_evidence);
            refuted(a).cmp(&refuted(b)).then_with(evidence)
        });
        // Of one effect at one place (a drift, a jump) the best variant.
        let of = |t: &Tried| {
            let candidate = |&k: &usize| (self.all[k].id, self.all[k].component.as_str());
            t.candidates.iter().map(candidate).collect::<Vec<_>>()
        };
        let mut seen = HashSet::new();
        tried.retain(|t| seen.insert(of(t)));
        let Some(best) = tried.first() else { return Vec::new() };
        // What does not tell effects apart does not make them improbable either.
        let gain = best.fit.log_evidence - null.log_evidence;
        let loud = together(gain, least) / TOGETHER;
        let strain = |t: &Tried| {
            let of = |(&k, &place): (&usize, &usize)| self.all[k].strain(t.fit.at[place]);
            t.candidates.iter().zip(&t.places).map(of).fold(0.0, f64::max)
        };
        let over = |evidence: f64| ((evidence - best.fit.log_evidence) / loud / WARM).exp();
        let weight = |t: &Tried| over(t.fit.log_evidence) * (prior(strain(t)) / WARM).exp();
        // That nothing is missing counts as much as all that was looked at together: of many something fits best by chance.
        let nothing = self.all.len() as f64 * over(null.log_evidence);
        let total = tried.iter().filter(|t| !refuted(t)).map(&weight).sum::<f64>() + nothing;
        // Where most of what it gains is that tolerances are strained less, these had stood for it.
        let tolerated_by_null = strained(&self.base, &null.at, &[]);
        let imitated = |t: &Tried| {
            let relieved = tolerated_by_null - strained(&t.unknowns, &t.fit.at, &t.places);
            relieved > 0.5 * (t.fit.log_evidence - null.log_evidence)
        };
        let blocks = blocks(self.experiment, &self.likelihood.fitted);
        let of_null = elpd::by_block(null, &self.base, &blocks);
        let finding = |t: &Tried| -> Vec<Finding> {
            let elpd = elpd::by_block(&t.fit, &t.unknowns, &blocks);
            let (elpd, elpd_error) = elpd::difference(&elpd, &of_null);
            let one = |(&k, &place): (&usize, &usize)| {
                let candidate = &self.all[k];
                let estimate = self.estimate(t, place);
                let holds = |none: f64| (estimate.lo..=estimate.hi).contains(&none);
                Finding {
                    id: candidate.id,
                    component: candidate.component.clone(),
                    words: candidate.words,
                    parameter: candidate.parameter.0,
                    unit: candidate.parameter.1,
                    estimate,
                    is_open: candidate.neutral().is_some_and(holds),
                    profile: None,
                    beside: values_beside(candidate, &t.unknowns, &t.fit.at),
                    probability: if refuted(t) { 0.0 } else { TRIED * weight(t) / total },
                    evidence: t.fit.log_evidence - null.log_evidence,
                    elpd,
                    elpd_error,
                    strain: candidate.strain(t.fit.at[place]),
                    takes_along: takes_along(candidate, &t.unknowns, &t.fit.at),
                    tolerated: self.base.iter().any(|u| u.target == candidate.unknown.target)
                        || imitated(t),
                    within: candidate.within(t.fit.at[place]),
                    beyond: (t.fit.at[place] - candidate.unknown.mean).abs() / candidate.unknown.sd,
                    validation_z: self.z(&t.fit.readings),
                    reduction: self.reduction(&null.readings, &t.fit.readings),
                    flags: flags(t, place),
                    separates: candidate.separates,
                }
            };
            t.candidates.iter().zip(&t.places).map(one).collect()
        };
        tried.iter().flat_map(finding).collect()
    }

    /// A finding with the value and the interval of a fit, by its profile too.
    pub(super) fn valued(&self, finding: Finding, tried: &Tried, place: usize) -> Finding {
        let (unknowns, fit) = (&tried.unknowns, &tried.fit);
        let profile = profile(self.experiment, unknowns, &self.likelihood, fit, place);
        let estimate = self.estimate(tried, place);
        let of_it = Finding { estimate, flags: flags(tried, place), ..finding };
        of_it.with_profile(profile, &unknowns[place])
    }

    /// A fitted value with its interval, which no block of time may leave.
    fn estimate(&self, tried: &Tried, place: usize) -> Estimate {
        let blocks = blocks(self.experiment, &self.likelihood.fitted);
        let least_sd = elpd::jackknife(&tried.fit, &tried.unknowns, &blocks, place);
        tried.fit.estimate(&tried.unknowns, place, least_sd)
    }
}

/// What it costs that unknowns are off the middle of their ranges, but for those at `places`, nats.
fn strained(unknowns: &[Unknown], at: &[f64], places: &[usize]) -> f64 {
    let others = (0..unknowns.len()).filter(|i| !places.contains(i));
    0.5 * others.map(|i| unknowns[i].fall(at[i])).sum::<f64>()
}

/// Whether residuals on samples not fitted refute an effect beside one that leaves the `least`; there were `null_z` without any.
fn leaves_more(z: f64, least: f64, null_z: f64) -> bool {
    let share = |z: f64| excess(z) / excess(null_z).max(1e-9);
    let times = z / least.max(1.0);
    times > FAR_WORSE || (times > AS_WELL.0 && share(z) - share(least) > AS_WELL.1)
}

/// Ranges of the fitted samples that belong to one block of time of one sensor: one that reads now and then only (behind a boiler that
/// runs) has a block of every time.
fn blocks(experiment: &Experiment, fitted: &[usize]) -> Vec<(usize, usize)> {
    let of = |k: usize| &experiment.samples[fitted[k]];
    let from_one = |k: usize| (of(k).run, of(k).sensor) == (of(k - 1).run, of(k - 1).sensor);
    let mut blocks = Vec::new();
    let (mut from, mut longest_s) = (0, 0.0);
    for k in 1..=fitted.len() {
        if k == from + 1 {
            longest_s = pause_s(&experiment.runs[of(from).run].tracks[of(from).sensor]);
        }
        let goes_on = k < fitted.len()
            && fitted[k] == fitted[k - 1] + 1
            && from_one(k)
            && of(k).time_s - of(k - 1).time_s < longest_s;
        if !goes_on {
            blocks.push((from, k));
            from = k;
        }
    }
    // A record in one piece is cut.
    let most = fitted.len().div_ceil(8).max(1);
    let cut = |(from, until): (usize, usize)| {
        let parts = (until - from).div_ceil(most);
        let at = move |i: usize| from + (until - from) * i / parts;
        (0..parts).map(move |i| (at(i), at(i + 1)))
    };
    blocks.into_iter().flat_map(cut).collect()
}

/// How far the tolerances of the sensor that an effect is a flaw of are from the middle of their ranges, standard deviations.
fn takes_along(candidate: &Candidate, unknowns: &[Unknown], at: &[f64]) -> f64 {
    let Some(sensor) = candidate.unknown.target.sensor() else { return 0.0 };
    let of_it = |u: &Unknown| u.target.sensor() == Some(sensor) && !candidate.owns(u);
    let far = unknowns.iter().zip(at).filter(|(u, _)| of_it(u)).map(|(u, x)| (x - u.mean) / u.sd);
    far.fold(0.0, |most, far| most.max(far.abs()))
}

/// What the data leave open about a fitted value.
fn flags(tried: &Tried, place: usize) -> Vec<String> {
    let (fit, unknowns) = (&tried.fit, &tried.unknowns);
    let mut flags = Vec::new();
    let sd = |i: usize| fit.covariance[(i, i)].max(0.0).sqrt();
    if fit.at_bound(unknowns, place) {
        flags.push("at the bound of its range".to_owned());
    }
    if sd(place) > 0.7 * unknowns[place].sd {
        flags.push("the data hardly say more than its range".to_owned());
    }
    for i in (0..unknowns.len()).filter(|&i| i != place) {
        let correlation = fit.covariance[(i, place)] / (sd(i) * sd(place)).max(1e-300);
        if correlation.abs() > 0.95 {
            flags.push(format!("tied to {} (correlation {correlation:.2})", unknowns[i].target));
        }
    }
    flags
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_leaves_twice_as_much_is_refuted_where_that_is_much() {
        // 2.6^2 - 1 = 5.76 less 0.44 are 85 % of 2.7^2 - 1, and 1 % of 20^2 - 1.
        assert!(leaves_more(2.6, 1.2, 2.7) && !leaves_more(2.6, 1.2, 20.0));
        // Below what sensors promise nothing is twice as much; three times as much always is.
        assert!(!leaves_more(1.9, 0.5, 2.0));
        assert!(leaves_more(5.3, 1.24, 11.0) && !leaves_more(3.7, 1.24, 11.0));
    }

    #[test]
    fn blocks_end_where_samples_are_missing_or_another_sensor_begins() {
        let mut experiment = crate::bench::experiment(&[]);
        let second = experiment.samples.iter().position(|s| s.sensor == 3).unwrap();
        // 0 to 3, 6 to 9 of the first sensor, four of the second; at most 12/8 = 2 samples each.
        let fitted: Vec<usize> = (0..4).chain(6..10).chain(second..second + 4).collect();
        let found = blocks(&experiment, &fitted);
        assert_eq!(found, [(0, 2), (2, 4), (4, 6), (6, 8), (8, 10), (10, 12)]);
        assert!(blocks(&experiment, &[]).is_empty());
        // Every 10 s; the second one, which stands at first, reads again after 80 s.
        for sample in &mut experiment.samples[second + 1..] {
            sample.time_s += 70.0;
        }
        let found = blocks(&experiment, &fitted);
        assert_eq!(found[4..], [(8, 9), (9, 10), (10, 12)]);
    }
}
