//! A step back, and pairs of effects that hide each other.

use super::{BEYOND, EXPLAINED, FORETELLS, KEEPS, PAIRS, Round, Search, Settled, WINS, excess};
use crate::error::ExplainError;
use crate::explain::Verdict;
use crate::fit::{Care, fit};
use crate::screen::pairs;
use crate::trial::Start;
use crate::unknown::Unknown;

impl Search<'_> {
    /// Takes out what a later effect has made superfluous.
    pub(super) fn step_back(&mut self, settled: &mut Settled) -> Result<(), ExplainError> {
        if self.taken.len() < 2 {
            return Ok(());
        }
        let with = fit(self.experiment, &self.base, &self.likelihood, &self.slopes, Care::Quick)?;
        for k in (0..self.taken.len() - 1).rev() {
            let candidate = &self.all[self.taken[k]];
            let own: Vec<_> =
                candidate.beside.iter().chain([&candidate.unknown]).map(|u| &u.target).collect();
            let mut base = self.base.clone();
            base.retain(|unknown| !own.contains(&&unknown.target));
            if let Some((middle, sd)) = candidate.tolerance.filter(|(_, sd)| *sd > 0.0) {
                let unknown =
                    Unknown { mean: middle, sd, start: middle, ..candidate.unknown.clone() };
                base.push(unknown);
            }
            let without = fit(self.experiment, &base, &self.likelihood, &self.slopes, Care::Quick)?;
            if with.log_evidence - without.log_evidence < KEEPS {
                self.base = base;
                self.taken.remove(k);
                settled.effects.remove(k);
                let at = without.at.clone();
                settled.chosen = Some((self.base.clone(), at));
                break;
            }
        }
        Ok(())
    }

    /// Two effects that hide each other; whether a pair explains what no single one does.
    pub(super) fn pair(
        &mut self,
        round: &Round,
        settled: &mut Settled,
    ) -> Result<bool, ExplainError> {
        let (most, of) = PAIRS;
        let best = &round.looked[..of.min(round.looked.len())];
        let starts = pairs(best, &round.null.e, most).into_iter().map(|(i, j, _)| Start {
            candidates: vec![best[i].candidate, best[j].candidate],
            at: vec![best[i].start, best[j].start],
            earlier: None,
        });
        let starts: Vec<Start> = starts.collect();
        if starts.is_empty() {
            return Ok(false);
        }
        let mut tried = self.common().fits(&starts, Care::Thorough)?;
        let findings = self.ranked(&round.null, &mut tried);
        let (Some(first), [one, other, ..]) = (tried.first(), &findings[..]) else {
            return Ok(false);
        };
        let single =
            round.tried.iter().map(|t| t.fit.log_evidence).fold(f64::NEG_INFINITY, f64::max);
        let gain = first.fit.log_evidence - single;
        let explained = 1.0 - excess(one.validation_z) / excess(round.null_z).max(1e-9);
        let plausible = one.beyond.max(other.beyond) < BEYOND;
        let (nats, errors) = FORETELLS;
        if gain > WINS
            && one.elpd > nats.max(errors * one.elpd_error)
            && explained > EXPLAINED
            && plausible
        {
            settled.because = format!(
                "{} and {} together explain what none does alone, with {gain:.0} nats more evidence than the best one",
                one.id, other.id
            );
            settled.verdict = Verdict::Named;
            settled.class.clear();
            let findings = findings[..2].to_vec();
            let first = tried.swap_remove(0);
            self.take(&first, &findings, settled);
            return Ok(true);
        }
        Ok(false)
    }
}
