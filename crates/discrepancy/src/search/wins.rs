//! When an effect is more than what tolerances, noise and the flaws of a model would show.

use super::BEYOND;
use crate::explain::Finding;

/// Evidence by which an effect must beat the model without it, nats.
pub(super) const WINS: f64 = 4.0;
/// Residuals below so many standard deviations are well within what the sensors promise: only what is very sure is named then,
/// as many samples also tell the layers of a model from the water of a storage.
pub(super) const WITHIN: f64 = 0.75;
/// ... with evidence above this, nats.
pub(super) const SURE: f64 = 25.0;
/// ... or, as a tolerance that is strained by more than this has no more evidence than half of its square, with that.
const STRAINED: f64 = 5.0;
/// The same, where it foretells no better than strained tolerances.
pub(super) const STRAINS: f64 = 8.0;
/// Log predictive density by which it must beat it, nats; and as many standard errors.
const FORETELLS: (f64, f64) = (4.0, 2.0);
/// Standard errors by which it foretells in nearly every block.
const SURELY: f64 = 5.0;
/// The least reduction of the error on samples that were not fitted.
const REDUCTION: f64 = 0.02;
/// Evidence within which two effects are not told apart, nats ...
pub(crate) const TOGETHER: f64 = 3.0;
/// ... or this share of what the winner gains, as far as what it leaves is the error of the model and not noise.
const NEARLY: f64 = 0.15;

/// An effect within so many standard deviations is what is expected.
pub(super) const EXPECTED: f64 = 1.0;
/// Share of the probability of all that was tried that a class holds ...
pub(super) const MOST_OF_IT: f64 = 0.95;
/// ... with what is no further behind its best one, nats.
pub(super) const BEHIND: f64 = 9.0;
/// Probability above which an effect, or a class of them, is named.
pub(super) const EVEN: f64 = 0.5;

/// Whether an effect is more than what tolerances, noise and the flaws of a model would show; `null_z` are the residuals without it.
pub(super) fn wins(f: &Finding, null_z: f64) -> bool {
    let sure = f.evidence > SURE
        || (f.tolerated && f.strain > STRAINED && f.evidence > 0.5 * STRAINED * STRAINED);
    let refuted = f.probability == 0.0;
    // The moment of a jump is held where it would have to be foretold: that the rest is foretold says little.
    let unsure_jump = f.parameter == "step_k" && f.evidence < SURE;
    if refuted || unsure_jump || f.within || f.is_open || (null_z < WITHIN && !sure) {
        return false;
    }
    // Tolerances foretell as well as an effect that they imitate: only how far they are strained tells.
    let foretells_or_strained = f.tolerated || f.elpd > FORETELLS.1 * f.elpd_error;
    (f.evidence > STRAINS && foretells_or_strained) || (f.evidence > WINS && foretells(f))
}

/// Whether one more effect beside so many that were taken is one: a second one must foretell beyond chance, more must in every
/// respect, as what the first ones do not quite explain is left for others.
pub(super) fn adds(f: &Finding, taken: usize) -> bool {
    match taken {
        0 => true,
        // What has to be out of its range is no explanation: so much is left for `unexplained`. Nor is a clock against a lag of
        // the same sensor beyond what it can have: together they are a blur of the model, not a flaw of the sensor.
        _ if f.beyond.max(f.takes_along) > BEYOND => false,
        1 => f.elpd > FORETELLS.1 * f.elpd_error,
        _ => f.evidence > STRAINS && foretells(f),
    }
}

/// Whether it foretells what was not fitted clearly better than the model without it.
pub(super) fn foretells(f: &Finding) -> bool {
    let (nats, errors) = FORETELLS;
    f.elpd > nats.max(errors * f.elpd_error) && f.reduction > REDUCTION
}

/// Whether it does so in nearly every block.
pub(super) fn surely_foretells(f: &Finding) -> bool {
    foretells(f) && f.elpd > SURELY * f.elpd_error
}

/// Nats within which effects are not told apart where the best one gains `gain` nats and leaves residuals of `z` standard
/// deviations, of whose squares `1 - 1/z^2` are the error of the model.
pub(super) fn together(gain: f64, z: f64) -> f64 {
    let wrong = 1.0 - 1.0 / z.max(1.0).powi(2);
    TOGETHER.max(NEARLY * wrong * gain)
}
