//! How many modes grow: turns of the determinant of the closed loops along the imaginary axis.
//!
//! **Sources** `skogestad2005` (argument principle).

use super::loops::Loops;
use nalgebra::Complex;
use std::f64::consts::PI;

type C64 = Complex<f64>;

/// A scale beyond all gains, and how far down frequencies are looked for at which integrators prevail.
const HUGE: f64 = 1e9;
const MOST_DECADES: usize = 30;
/// Factors between two frequencies of a count, anywhere and near a crossing: two modes that pass together in one
/// step would turn the determinant once around, and be missed.
const LONGEST_STEP: f64 = 1.12;
const HOT_STEP: f64 = 1.005;

/// The loops with the eigenvalues of their gains, where they are uniform.
pub(super) struct Case<'a> {
    pub loops: &'a Loops,
    pub lambdas: Option<Vec<C64>>,
    /// Frequencies near which modes may cross, rad/s.
    pub hot: Vec<f64>,
}

/// `det(1 + k L(i omega))`: logarithm of its size, and its direction.
fn determinant(case: &Case, factor: f64, omega: f64) -> (f64, C64) {
    let s = C64::new(0.0, omega);
    // As a product, so that many large factors do not overflow.
    let gather = |(size, direction): (f64, C64), value: C64| {
        let norm = value.norm();
        (size + norm.ln(), direction * value / norm)
    };
    let start = (0.0, C64::new(1.0, 0.0));
    match &case.lambdas {
        Some(lambdas) => {
            let common = case.loops.common(s) * factor;
            lambdas.iter().map(|lambda| lambda * common + 1.0).fold(start, gather)
        }
        None => {
            let lu = case.loops.closed(s, factor).lu();
            let sign: C64 = lu.p().determinant();
            lu.u().diagonal().iter().copied().chain([sign]).fold(start, gather)
        }
    }
}

/// Number of growing modes: turns of the determinant along the imaginary axis.
///
/// With p poles at zero (integrators) it is `p/2 - change of phase/pi`.
pub(super) fn count_growing(case: &Case, factor: f64) -> i64 {
    let (_, slowest) = case.loops.times_s();
    let mut low = 1e-4 / slowest;
    let order = |factor: f64, omega: f64| {
        let size = |omega| determinant(case, factor, omega).0;
        (size(0.1 * omega) - size(omega)) / std::f64::consts::LN_10
    };
    // With a huge scale every loop with an integrator shows its pole.
    let poles = order(HUGE, low).round();
    for _ in 0..MOST_DECADES {
        if (order(factor, low) - poles).abs() < 0.02 {
            break;
        }
        low *= 0.1;
    }
    let high = case.loops.highest_rad_s();
    let longest = |omega: f64| {
        let near = case.hot.iter().any(|hot| (omega / hot - 1.0).abs() < 0.05);
        if near { HOT_STEP } else { LONGEST_STEP }
    };
    let mut phase = 0.0;
    let mut at = (low, determinant(case, factor, low).1);
    let mut step = LONGEST_STEP;
    while at.0 < high {
        let next = (at.0 * step).min(high);
        let value = determinant(case, factor, next).1;
        let turn = (value / at.1).arg();
        if turn.abs() > 0.7 && step > 1.0 + 1e-8 {
            step = 1.0 + 0.3 * (step - 1.0);
            continue;
        }
        phase += turn;
        at = (next, value);
        step = if turn.abs() < 0.3 { 1.0 + 2.0 * (step - 1.0) } else { step }.min(longest(next));
    }
    let count = 0.5 * poles - phase / PI;
    #[allow(clippy::cast_possible_truncation)]
    let count = count.round() as i64;
    count
}
