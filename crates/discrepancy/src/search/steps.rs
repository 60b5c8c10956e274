//! A step back, and pairs of effects that hide each other.

use super::wins::{SURE, WINS, WITHIN};
use super::{BEYOND, EXPLAINED, First, KEEPS, PAIRS, Search, Settled, WARM, excess};
use crate::catalogue::tolerances;
use crate::error::ExplainError;
use crate::explain::Verdict;
use crate::fit::{Care, fit};
use crate::screen::{Screened, pairs, together};
use crate::trial::{Start, Tried};
use crate::unknown::Unknown;

impl Search<'_> {
    /// Takes out what a later effect has made superfluous, and what that had stood for.
    pub(super) fn step_back(&mut self, settled: &mut Settled) -> Result<(), ExplainError> {
        if self.taken.len() < 2 {
            return Ok(());
        }
        let mut with =
            fit(self.experiment, &self.base, &self.likelihood, &self.slopes, Care::Quick)?;
        // The last one stays.
        let mut k = self.taken.len() - 1;
        while k > 0 {
            k -= 1;
            let candidate = &self.all[self.taken[k]];
            let mut base = self.base.clone();
            base.retain(|unknown| !candidate.owns(unknown));
            // What it is made of is uncertain again as it was before.
            base.extend(tolerances(self.experiment).into_iter().filter(|u| candidate.owns(u)));
            let without =
                fit(self.experiment, &base, &self.likelihood, &self.slopes, Care::Thorough);
            // Without which the model does not run is not superfluous.
            let Ok(without) = without else { continue };
            // What the others leave within what the sensors promise needs no further one that is not very sure.
            let least = if self.z(&without.readings) < WITHIN { SURE } else { KEEPS };
            if with.log_evidence - without.log_evidence < least {
                self.base = base;
                self.taken.remove(k);
                settled.effects.remove(k);
                settled.chosen = Some((self.base.clone(), without.at.clone()));
                with = without;
                k = self.taken.len() - 1;
            }
        }
        Ok(())
    }

    /// Values of several effects go together: with their intervals from one fit of all.
    pub(super) fn joint(&mut self, settled: &mut Settled) -> Result<(), ExplainError> {
        let Some((unknowns, at)) = settled.chosen.clone().filter(|_| self.taken.len() > 1) else {
            return Ok(());
        };
        let readings = self.experiment.readings(&unknowns, &at)?;
        self.predict(&unknowns, &at);
        self.likelihood.learn(self.experiment, &readings);
        self.likelihood.temperature = self.temperature(&settled.null_readings, &readings);
        let started = unknowns.into_iter().zip(at);
        let unknowns: Vec<Unknown> = started.map(|(u, start)| Unknown { start, ..u }).collect();
        let fit = fit(self.experiment, &unknowns, &self.likelihood, &self.slopes, Care::Alone)?;
        let place = |k: &usize| {
            unknowns.iter().position(|unknown| unknown.target == self.all[*k].unknown.target)
        };
        let places = self.taken.iter().filter_map(place).collect();
        let tried = Tried { candidates: self.taken.clone(), unknowns, places, fit };
        for (finding, &place) in settled.effects.iter_mut().zip(&tried.places) {
            *finding = self.valued(finding.clone(), &tried, place);
        }
        settled.chosen = Some((tried.unknowns, tried.fit.at));
        Ok(())
    }

    /// Two effects that hide each other: takes a pair instead of what was found, where it explains clearly more.
    pub(super) fn pair(
        &mut self,
        first: &First,
        settled: &mut Settled,
    ) -> Result<(), ExplainError> {
        let found = matches!(settled.verdict, Verdict::Named | Verdict::Class);
        let (most, of) = PAIRS;
        let looked = &first.round.looked;
        let best = &looked[..of.min(looked.len())];
        let e = &first.round.e;
        let taken: Vec<&Screened> =
            looked.iter().filter(|s| self.taken.contains(&s.candidate)).collect();
        if !(found || settled.verdict == Verdict::Unexplained) || self.taken.len() > 2 {
            return Ok(());
        }
        // What was found gains at least what its fits have shown.
        let shown = settled.effects.iter().map(|f| f.evidence).sum::<f64>() * first.temperature;
        let could = together(&taken, e).max(shown);
        let starts = pairs(best, e, most).into_iter().filter(|(i, j, gain)| {
            let pair = [best[*i].candidate, best[*j].candidate];
            *gain > could + WINS
                && !(self.taken.len() == 2 && pair.iter().all(|k| self.taken.contains(k)))
        });
        let starts = starts.map(|(i, j, _)| Start {
            candidates: vec![best[i].candidate, best[j].candidate],
            at: vec![best[i].start, best[j].start],
            earlier: None,
        });
        let starts: Vec<Start> = starts.collect();
        if starts.is_empty() {
            return Ok(());
        }
        let with = (self.base.clone(), self.slopes.clone());
        self.likelihood.forget();
        self.base.clone_from(&first.base);
        self.slopes.clone_from(&first.slopes);
        let mut rough = self.common().fits(&starts, Care::Quick);
        rough.sort_by(|a, b| b.fit.log_evidence.total_cmp(&a.fit.log_evidence));
        rough.truncate(1);
        let Some(best) = rough.first() else { return Ok(()) };
        self.predict(&best.unknowns, &best.fit.at);
        self.likelihood.learn(self.experiment, &best.fit.readings);
        self.likelihood.temperature = self.temperature(&first.round.quick, &best.fit.readings);
        let again: Vec<Start> = rough.into_iter().map(Start::again).collect();
        let mut tried = self.common().fits(&again, Care::Thorough);
        let null = fit(self.experiment, &self.base, &self.likelihood, &self.slopes, Care::Quick)?;
        let findings = self.ranked(&null, &mut tried);
        let single = if self.taken.is_empty() {
            first.round.tried.iter().take(1).map(|t| (&t.unknowns, &t.fit.slopes)).next()
        } else {
            Some((&with.0, &with.1))
        };
        let single = single
            .map(|(unknowns, slopes)| {
                fit(self.experiment, unknowns, &self.likelihood, slopes, Care::Quick)
            })
            .transpose()?;
        let rival = single.as_ref().unwrap_or(&null);
        // What one effect leaves within what the sensors promise needs no second one that is not very sure; and of all that could be
        // the second one, one fits best by chance.
        let chance = WARM * (self.all.len() as f64).ln();
        let least = if self.z(&rival.readings) < WITHIN { SURE } else { WINS.max(chance) };
        let (Some(pair), [one, other, ..]) = (tried.first(), &findings[..]) else { return Ok(()) };
        let gain = pair.fit.log_evidence - rival.log_evidence;
        let explained = 1.0 - excess(one.validation_z) / excess(self.z(&null.readings)).max(1e-9);
        let plausible = one.beyond.max(other.beyond) < BEYOND;
        if gain > least
            && pair.fit.log_evidence - null.log_evidence > WINS
            && explained > EXPLAINED
            && plausible
            && one.probability > 0.0
            && one.elpd > 2.0 * one.elpd_error
        {
            settled.because = format!(
                "{} and {} together explain more than one alone, with {gain:.0} nats more evidence",
                one.id, other.id
            );
            settled.verdict = Verdict::Named;
            settled.class.clear();
            settled.additions.clear();
            settled.effects.clear();
            self.taken.clear();
            let findings = findings[..2].to_vec();
            let pair = tried.swap_remove(0);
            return self.take(&pair, &findings, settled);
        }
        Ok(())
    }
}
