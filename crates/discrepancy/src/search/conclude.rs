//! The verdict of the first round, and what the last one may make of it.

use super::wins::{
    BEHIND, EVEN, EXPECTED, MOST_OF_IT, TOGETHER, foretells, surely_foretells, together, wins,
};
use super::{
    BEYOND, DIFFERS, EXPLAINED, LEAVES, LEFT, MOST_TOGETHER, PARALLEL, Round, Search, Settled,
    TAKES, TOO_MUCH, UNEXPLAINED, excess, prior,
};
use crate::error::ExplainError;
use crate::explain::{Finding, Verdict};
use crate::trial::cosine;
use crate::uncertainty::Spread;

impl Search<'_> {
    /// What could be added next, with what these data do not tell from it. Empty where that is no more probable than that chance
    /// shows the best of all that was looked at; where residuals are beyond chance something is missing, however improbable each.
    pub(super) fn likely(&self, round: &Round, worst: f64) -> Vec<Finding> {
        let parallel: Vec<bool> =
            round.tried.iter().map(|t| cosine(&round.tried[0], t) > PARALLEL).collect();
        let class = class(&round.findings, &parallel, round.null_z);
        let class = with_rivals(class, &round.findings, round.null_z);
        let by_chance = probability(&class) <= EVEN && !is_discrepancy(round.null_z, worst);
        if by_chance { Vec::new() } else { ordered(with_others(class, &round.findings)) }
    }

    /// The verdict of the first round.
    pub(super) fn conclude(&self, round: &Round, worst: f64, settled: &mut Settled) {
        settled.class = self.likely(round, worst);
        (settled.verdict, settled.because) =
            verdict(&round.findings, settled.class.len(), round.null_z, worst);
    }

    /// Effects that leave far too much are not the cause, nor those that leave much of what a sensor shows; nor do two
    /// sensors begin to drift at once where one cause of the plant may,
    /// or three effects show for the first time together.
    pub(super) fn doubt(&mut self, settled: &mut Settled) -> Result<(), ExplainError> {
        let (unknowns, at) = settled.chosen.as_ref().unwrap_or(&settled.null);
        let simulated = self.experiment.simulated(unknowns, at, 1)?;
        let readings = self.experiment.observed(&simulated, unknowns, at);
        // What inputs leave open the effects carry on.
        let spread = Spread::new(self.experiment, simulated, unknowns, at);
        self.likelihood.predict(spread.seen(self.experiment, unknowns, at));
        self.likelihood.rescale(self.experiment, &readings);
        if settled.chosen.is_none() {
            return Ok(());
        }
        let z = self.z(&readings);
        let left = self.worst(&readings);
        let before = self.worst(&settled.null_readings);
        let other = left > UNEXPLAINED && excess(left) > LEFT * excess(before);
        let drifts = settled.effects.iter().filter(|f| f.id == "S3").count();
        if z > TOO_MUCH || other || drifts > 1 || settled.effects.len() > MOST_TOGETHER {
            let names = settled.effects.iter().map(|f| format!("{} at {}", f.id, f.component));
            let names: Vec<String> = names.collect();
            let best = format!("the best that was found, {}", names.join(" and "));
            settled.because = if drifts > 1 {
                format!(
                    "{best}, would be {drifts} drifts or jumps of sensors: rather one cause of the plant that is not in the catalogue"
                )
            } else if z > TOO_MUCH {
                format!("{best}, leaves residuals of {z:.1} standard deviations")
            } else if other {
                format!(
                    "{best}, leaves residuals of {left:.1} standard deviations at a sensor, beyond chance and not much less than there were"
                )
            } else {
                format!(
                    "{best}, would be {} effects at once: rather one cause that is not in the catalogue",
                    settled.effects.len()
                )
            };
            settled.verdict = Verdict::Unexplained;
            settled.effects.clear();
            settled.class.clear();
            settled.additions.clear();
            settled.chosen = None;
            self.taken.clear();
        }
        Ok(())
    }
}

/// What these data do not tell from the winner, the winner included, the most plausible first; empty where nothing wins.
/// `parallel` says whose sensitivities are those of the winner.
fn class(findings: &[Finding], parallel: &[bool], null_z: f64) -> Vec<Finding> {
    let Some(winner) = findings.first().filter(|f| wins(f, null_z)) else { return Vec::new() };
    let near = together(winner.evidence, winner.validation_z);
    let belongs = |(f, parallel): &(&Finding, &bool)| {
        let behind = winner.evidence - f.evidence;
        let refuted = f.probability == 0.0;
        !refuted && (behind < near || (behind < 2.0 * near && **parallel))
    };
    let mut class: Vec<Finding> =
        findings.iter().zip(parallel).filter(belongs).map(|(f, _)| f.clone()).collect();
    // One that would not win alone does not go first.
    let order = |a: &Finding, b: &Finding| {
        let wins = wins(b, null_z).cmp(&wins(a, null_z));
        wins.then_with(|| weight(b).total_cmp(&weight(a)))
    };
    class.sort_by(order);
    class
}

/// Where a class has no more than half of the probability because others that would win too have the rest of it, all of these: that one of
/// them is missing is sure, which one is not.
fn with_rivals(class: Vec<Finding>, findings: &[Finding], null_z: f64) -> Vec<Finding> {
    let rivals: Vec<Finding> = findings.iter().filter(|f| wins(f, null_z)).cloned().collect();
    let is_split = probability(&class) <= EVEN && probability(&rivals) > EVEN;
    if is_split && !class.is_empty() { rivals } else { class }
}

/// One that is what it should be goes first in a class where its head would have to be further from that: what nobody expects has to be
/// told from it, not only to fit a little better.
fn ordered(mut class: Vec<Finding>) -> Vec<Finding> {
    let Some(head) = class.first() else { return class };
    let most = class.iter().map(|f| f.evidence).fold(f64::NEG_INFINITY, f64::max);
    let expected = |f: &Finding| {
        f.strain < EXPECTED
            && f.strain + EXPECTED < head.strain
            && most - f.evidence < 2.0 * TOGETHER
    };
    if let Some(k) = class.iter().position(expected) {
        class[..=k].rotate_right(1);
    }
    class
}

fn probability(findings: &[Finding]) -> f64 {
    findings.iter().map(|f| f.probability).sum()
}

/// A class with the next in probability, no further behind the winner than [`BEHIND`], until it holds [`MOST_OF_IT`] of what all that
/// was tried has together.
fn with_others(mut class: Vec<Finding>, findings: &[Finding]) -> Vec<Finding> {
    let Some(most) = class.iter().map(|f| f.evidence).max_by(f64::total_cmp) else {
        return class;
    };
    let is_new = |f: &&Finding| class.iter().all(|c| (c.id, &c.component) != (f.id, &f.component));
    let mut others: Vec<Finding> = findings.iter().filter(is_new).cloned().collect();
    others.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let all = probability(&class) + probability(&others);
    for other in others {
        if probability(&class) < MOST_OF_IT * all && most - other.evidence < BEHIND {
            class.push(other);
        }
    }
    class
}

/// Evidence with what is known beforehand: beyond two standard deviations the tail of a Cauchy distribution, `1/strain^2`.
fn weight(f: &Finding) -> f64 {
    f.evidence + prior(f.strain)
}

/// Whether residuals without an effect are those of something that is missing: large at a sensor, or over all where one is beyond chance.
/// Over all alone they may be those of one moment that was misread, unless they are far too large.
fn is_discrepancy(null_z: f64, worst: f64) -> bool {
    null_z > TOO_MUCH || (worst > 0.0 && null_z.max(worst) > UNEXPLAINED)
}

/// The verdict, and why; `members` is the size of the class, `null_z` the residuals without an effect, `worst` those of the
/// worst sensor that are more than chance.
fn verdict(findings: &[Finding], members: usize, null_z: f64, worst: f64) -> (Verdict, String) {
    let Some(winner) = findings.first() else {
        return (Verdict::Unexplained, "no effect of the catalogue could be tried".into());
    };
    if members == 0 {
        return if !is_discrepancy(null_z, worst) {
            (
                Verdict::Nothing,
                match worst > 0.0 {
                    true => format!(
                        "residuals are {null_z:.2} standard deviations, {worst:.2} at the worst sensor, and no effect explains them better than the tolerances"
                    ),
                    false => format!(
                        "residuals are {null_z:.2} standard deviations, at no sensor more than chance, and no effect explains them better than the tolerances"
                    ),
                },
            )
        } else {
            (
                Verdict::Unexplained,
                format!(
                    "residuals are {:.1} standard deviations, and no effect of the catalogue takes much of them away",
                    null_z.max(worst)
                ),
            )
        };
    }
    let explained = 1.0 - excess(winner.validation_z) / excess(null_z).max(1e-9);
    if winner.beyond > BEYOND {
        (
            Verdict::Unexplained,
            format!(
                "the best effect, {} at {}, would have to be {:.1} standard deviations from what is plausible",
                winner.id, winner.component, winner.beyond
            ),
        )
    } else if explained < EXPLAINED
        && ((winner.validation_z > LEAVES && !(explained > TAKES && surely_foretells(winner)))
            || (winner.validation_z > DIFFERS && !winner.tolerated && !foretells(winner)))
    {
        (
            Verdict::Unexplained,
            format!(
                "the best effect, {} at {}, takes away only {:.0} % of the discrepancy",
                winner.id,
                winner.component,
                100.0 * explained
            ),
        )
    } else if members > 1 {
        (Verdict::Class, format!("these data do not tell {members} effects apart"))
    } else {
        (
            Verdict::Named,
            format!(
                "its probability is {:.2}, with {:.0} nats more evidence than the model without it",
                winner.probability, winner.evidence
            ),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::wins::adds;
    use super::*;
    use crate::unknown::Estimate;

    fn finding(id: &'static str, evidence: f64) -> Finding {
        Finding {
            id,
            component: "p".into(),
            words: "",
            parameter: "factor",
            unit: "1",
            estimate: Estimate { value: 1.0, lo: 0.9, hi: 1.1 },
            profile: None,
            beside: Vec::new(),
            probability: 0.5,
            evidence,
            elpd: evidence,
            elpd_error: 1.0,
            strain: 1.0,
            beyond: 1.0,
            takes_along: 0.0,
            tolerated: false,
            within: false,
            is_open: false,
            validation_z: 1.0,
            reduction: 0.5,
            flags: Vec::new(),
            separates: "",
        }
    }

    fn ids(class: &[Finding]) -> Vec<&str> {
        class.iter().map(|f| f.id).collect()
    }

    #[test]
    fn a_class_is_what_is_near_or_parallel_and_not_refuted() {
        let findings =
            [finding("A", 30.0), finding("B", 28.0), finding("C", 25.0), finding("D", 23.0)];
        // 3 nats; parallel ones within 6.
        assert_eq!(ids(&class(&findings, &[true, false, false, false], 3.0)), ["A", "B"]);
        assert_eq!(ids(&class(&findings, &[true, false, true, true], 3.0)), ["A", "B", "C"]);
        let refuted = Finding { probability: 0.0, ..finding("B", 28.0) };
        assert_eq!(ids(&class(&[finding("A", 30.0), refuted], &[true, true], 3.0)), ["A"]);
        // However much there is to explain; but 0.15 * 300 (1 - 1/2^2) = 34 nats where the best one leaves two standard deviations.
        let loud = |z| Finding { validation_z: z, ..finding("A", 300.0) };
        let of = |z| class(&[loud(z), finding("B", 290.0)], &[true, false], 3.0).len();
        assert_eq!((of(1.0), of(2.0)), (1, 2));
        assert!(class(&[finding("A", 1.0)], &[true], 3.0).is_empty());
        // A drift within the class of its sensor is none.
        let tolerated = Finding { within: true, ..finding("A", 30.0) };
        assert!(class(&[tolerated, finding("B", 29.0)], &[true, false], 3.0).is_empty());
        // Nor is an effect of which blocks of time leave open whether it is there.
        let open = Finding { is_open: true, ..finding("A", 30.0) };
        assert!(class(&[open], &[true], 3.0).is_empty());
        // Nor is the best one, where all are refuted.
        assert!(
            class(&[Finding { probability: 0.0, ..finding("A", 30.0) }], &[true], 3.0).is_empty()
        );
        // Nor is a jump that is not very sure.
        let jump = |evidence| Finding { parameter: "step_k", ..finding("S3", evidence) };
        assert!(class(&[jump(24.0)], &[true], 3.0).is_empty());
        assert_eq!(ids(&class(&[jump(26.0)], &[true], 3.0)), ["S3"]);
        // Within what the sensors promise only what is very sure counts.
        assert!(class(&[finding("A", 20.0)], &[true], 0.7).is_empty());
        assert_eq!(ids(&class(&[finding("A", 26.0)], &[true], 0.7)), ["A"]);
        // 5^2/2 = 12.5 nats are all that a tolerance strained by five standard deviations can show.
        let strained = |strain| Finding { tolerated: true, strain, ..finding("A", 13.0) };
        assert_eq!(ids(&class(&[strained(5.5)], &[true], 0.7)), ["A"]);
        assert!(class(&[strained(4.5)], &[true], 0.7).is_empty());
        // Loud, but not what was not fitted: none, but where a tolerance foretells as well.
        let silent = |tolerated| Finding { tolerated, elpd: 1.0, ..finding("A", 30.0) };
        assert!(class(&[silent(false)], &[true], 3.0).is_empty());
        assert_eq!(ids(&class(&[silent(true)], &[true], 3.0)), ["A"]);
        // Another one that is more plausible, but not as sure, comes second.
        let plausible = Finding { strain: 1.0, ..finding("B", 12.5) };
        assert_eq!(ids(&class(&[strained(5.5), plausible], &[true, false], 0.7)), ["A", "B"]);
    }

    #[test]
    fn what_rivals_share_is_not_by_chance() {
        let of = |id, evidence, probability| Finding { probability, ..finding(id, evidence) };
        let all =
            [of("A", 119.0, 0.29), of("B", 94.0, 0.44), of("C", 83.0, 0.0), of("D", 2.0, 0.1)];
        let class = |all: &[Finding]| ids(&with_rivals(all[..1].to_vec(), all, 2.7)).join(" ");
        // C is refuted, D would not win.
        assert_eq!(class(&all), "A B");
        assert_eq!(class(&[of("A", 119.0, 0.6), all[1].clone()]), "A");
        assert_eq!(class(&[of("A", 119.0, 0.29), of("B", 94.0, 0.1)]), "A");
        assert!(with_rivals(Vec::new(), &all, 2.7).is_empty());
    }

    #[test]
    fn the_plausible_one_goes_first() {
        let strained = Finding { strain: 9.0, ..finding("A", 30.0) };
        let findings =
            [strained, finding("B", 28.0), Finding { strain: 1.9, ..finding("C", 29.0) }];
        // Of those within two standard deviations the one with more evidence; 2 ln(9/2) = 3.0 nats less for 9 of them.
        assert_eq!(ids(&class(&findings, &[true, false, false], 3.0)), ["C", "B", "A"]);
    }

    #[test]
    fn a_second_effect_takes_nothing_out_of_its_range() {
        let good = finding("A", 30.0);
        let far = Finding { beyond: 3.5, ..good.clone() };
        let blur = Finding { takes_along: 3.5, ..good.clone() };
        assert_eq!([&good, &far, &blur].map(|f| adds(f, 0)), [true; 3]);
        assert_eq!([&good, &far, &blur].map(|f| adds(f, 1)), [true, false, false]);
    }

    #[test]
    fn what_is_expected_goes_first() {
        let of = |id, evidence, strain| Finding { strain, ..finding(id, evidence) };
        let order = |class: &[Finding]| -> Vec<&str> {
            ordered(class.to_vec()).iter().map(|f| f.id).collect()
        };
        // The slow record of Liege: a sensor slower than they are, by 4.7 nats, and the wall that the pipe has.
        assert_eq!(order(&[of("S4", 368.1, 2.1), of("P1", 363.4, 0.5)]), ["P1", "S4"]);
        // Too far behind; none that is expected; no further off than the other.
        assert_eq!(order(&[of("S4", 370.1, 2.1), of("P1", 363.4, 0.5)]), ["S4", "P1"]);
        assert_eq!(order(&[of("S2", 20.0, 60.0), of("P10", 19.0, 50.0)]), ["S2", "P10"]);
        assert_eq!(order(&[of("S4", 20.0, 1.4), of("P1", 19.0, 0.5)]), ["S4", "P1"]);
        assert!(ordered(Vec::new()).is_empty());
    }

    #[test]
    fn a_class_holds_nearly_all_of_the_probability() {
        let of = |id, probability| Finding { probability, ..finding(id, 20.0) };
        let all = |class: &[Finding], findings: &[Finding]| {
            ids(&with_others(class.to_vec(), findings)).join(" ")
        };
        let findings = [of("A", 0.7), of("B", 0.03), of("C", 0.15), of("D", 0.0)];
        // 0.7 + 0.15 = 0.85 is 97 % of 0.88.
        assert_eq!(all(&findings[..1], &findings), "A C");
        // 0.85 of 0.88 are in it already; and 0.7 of 0.73 where there is no C.
        assert_eq!(all(&[findings[2].clone(), findings[0].clone()], &findings), "C A");
        assert_eq!(all(&findings[..1], &findings[..2]), "A");
        assert_eq!(all(&[], &findings), "");
        // However probable where the likelihood is tempered: the data say clearly which.
        let far = Finding { evidence: 8.0, ..of("F", 0.2) };
        assert_eq!(all(&findings[..1], &[findings[0].clone(), far]), "A");
    }

    #[test]
    fn every_verdict_has_its_reason() {
        let of = |f: &[Finding], members, null_z, worst| verdict(f, members, null_z, worst).0;
        let good = finding("A", 30.0);
        assert_eq!(of(&[], 0, 3.0, 3.0), Verdict::Unexplained);
        assert_eq!(of(&[finding("A", 1.0)], 0, 1.2, 0.0), Verdict::Nothing);
        assert_eq!(of(&[finding("A", 20.0)], 0, 0.7, 0.0), Verdict::Nothing);
        assert_eq!(of(&[finding("A", 1.0)], 0, 1.2, 2.5), Verdict::Unexplained);
        // Large over all, but at no sensor beyond chance: one moment, unless it is far too large.
        assert_eq!(of(&[finding("A", 1.0)], 0, 2.9, 0.0), Verdict::Nothing);
        assert_eq!(of(&[finding("A", 1.0)], 0, 4.5, 0.0), Verdict::Unexplained);
        assert_eq!(of(std::slice::from_ref(&good), 1, 3.0, 3.0), Verdict::Named);
        assert_eq!(of(std::slice::from_ref(&good), 2, 3.0, 3.0), Verdict::Class);
        let far = Finding { beyond: 3.5, ..good.clone() };
        assert_eq!(of(&[far], 1, 3.0, 3.0), Verdict::Unexplained);
        // 3^2 - 1 = 8; 2.5^2 - 1 = 5.25: takes away 34 %.
        let little = Finding { validation_z: 2.5, elpd_error: 10.0, ..good.clone() };
        let (verdict, because) = verdict(&[little], 1, 3.0, 3.0);
        assert_eq!(verdict, Verdict::Unexplained);
        assert!(because.contains("34 %"), "{because}");
        // 30 nats of 1 each block: it foretells everywhere, though something is left.
        let everywhere = Finding { validation_z: 2.5, ..good.clone() };
        assert_eq!(of(&[everywhere], 1, 3.0, 3.0), Verdict::Named);
        // 1.5^2 - 1 = 1.25 of 1.7^2 - 1 = 1.89: takes away 34 %, and foretells nothing.
        let nothing = Finding { validation_z: 1.5, elpd: -4.0, ..good };
        assert_eq!(of(std::slice::from_ref(&nothing), 1, 1.7, 1.7), Verdict::Unexplained);
        // A tolerance that is strained leaves no more than the effect that it imitates.
        let tolerated = Finding { tolerated: true, ..nothing };
        assert_eq!(of(&[tolerated], 1, 1.5, 1.5), Verdict::Named);
    }
}
