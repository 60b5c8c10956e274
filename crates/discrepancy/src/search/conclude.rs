//! The verdict of the first round.

use super::{
    BEYOND, EXPLAINED, LEAVES, NEARLY, PARALLEL, PLAUSIBLE, Round, Search, Settled, TOGETHER,
    UNEXPLAINED, excess,
};
use crate::explain::{Finding, Verdict};
use crate::trial::cosine;

impl Search<'_> {
    /// The verdict of the first round.
    pub(super) fn conclude(&self, round: &Round, worst: f64, settled: &mut Settled) {
        let Some(winner) = round.findings.first() else {
            (settled.verdict, settled.because) =
                (Verdict::Unexplained, "no effect of the catalogue could be tried".into());
            return;
        };
        let wins = round.wins();
        if wins {
            let refuted = |f: &Finding| f.probability == 0.0;
            for (t, f) in round.tried.iter().zip(&round.findings) {
                let behind = winner.evidence - f.evidence;
                let parallel = behind < 2.0 * TOGETHER && cosine(&round.tried[0], t) > PARALLEL;
                if !refuted(f) && (behind < TOGETHER.max(NEARLY * winner.evidence) || parallel) {
                    settled.class.push(f.clone());
                }
            }
            // What is far from plausible goes last; of the rest the evidence decides.
            let far = |f: &Finding| f.strain.max(PLAUSIBLE);
            settled
                .class
                .sort_by(|a, b| far(a).total_cmp(&far(b)).then(b.evidence.total_cmp(&a.evidence)));
        }
        let null_z = round.null_z;
        let explained = 1.0 - excess(winner.validation_z) / excess(null_z).max(1e-9);
        (settled.verdict, settled.because) = if !wins && null_z.max(worst) < UNEXPLAINED {
            (
                Verdict::Nothing,
                format!(
                    "residuals are {null_z:.2} standard deviations, {worst:.2} at the worst sensor, and no effect explains them better than the tolerances"
                ),
            )
        } else if !wins {
            (
                Verdict::Unexplained,
                format!(
                    "residuals are {:.1} standard deviations, and no effect of the catalogue takes much of them away",
                    null_z.max(worst)
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
        } else if explained < EXPLAINED && winner.validation_z > LEAVES {
            (
                Verdict::Unexplained,
                format!(
                    "the best effect, {} at {}, takes away only {:.0} % of the discrepancy",
                    winner.id,
                    winner.component,
                    100.0 * explained
                ),
            )
        } else if settled.class.len() > 1 {
            (
                Verdict::Class,
                format!("{} effects explain the data about equally well", settled.class.len()),
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
    }
}
