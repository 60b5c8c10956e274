//! How many modes grow: turns of the determinant of the closed loops along the imaginary axis.
//!
//! **Method** the determinant is a product: of the eigenvalues of the loops where they are uniform, otherwise of the
//! pivots of an elimination without exchanges, each the quotient of two leading minors. Factors are followed one by
//! one, so that many that turn a little, or two that pass zero together, are not taken for a whole turn. Where all
//! loops together answer less than they are given (a norm of `k L` below 1) no factor can turn round any more, and
//! what is left to the end is what the pivots, all in the right half plane, stand away from the real axis. **Sources**
//! `skogestad2005` (argument principle).

use super::elimination::Rows;
use super::loops::Loops;
use nalgebra::Complex;
use std::f64::consts::PI;

type C64 = Complex<f64>;

/// A scale beyond all gains, and how far down frequencies are looked for at which integrators prevail.
const HUGE: f64 = 1e9;
const MOST_DECADES: usize = 30;
/// Factors between two frequencies of a count; by how much the longest dead time may turn in between, rad; and where
/// the determinant is known as a whole only, so that two modes that pass together would be missed in a longer step.
const LONGEST_STEP: f64 = 1.25;
const LATE_RAD: f64 = 0.5;
const WHOLE_STEP: f64 = 1.005;
/// Largest turn of a factor between two frequencies, and where steps may grow, rad.
const LARGE_TURN: f64 = 0.7;
const SMALL_TURN: f64 = 0.3;
/// A pivot below this share of its row says nothing.
const LOST: f64 = 1e-9;
/// A norm below this is below 1, and frequencies above at which it is looked at again.
const QUIET: f64 = 0.9;
const QUIET_AGAIN: i32 = 6;

/// The loops with the eigenvalues of their gains, where they are uniform.
pub(super) struct Case<'a> {
    pub loops: &'a Loops,
    pub lambdas: Option<Vec<C64>>,
}

/// `det(1 + k L(i omega))` by its factors.
struct Determinant {
    /// Logarithm of its size.
    size: f64,
    /// Direction of each factor; the whole one where an elimination needs exchanges.
    directions: Vec<C64>,
    /// Smallest norm of `k L`.
    norm: f64,
}

impl Determinant {
    fn of(case: &Case, factor: f64, omega: f64) -> Self {
        let s = C64::new(0.0, omega);
        if let Some(lambdas) = &case.lambdas {
            let common = case.loops.common(s) * factor;
            let largest = lambdas.iter().fold(0.0_f64, |largest, x| largest.max(x.norm()));
            let factors = lambdas.iter().map(|lambda| lambda * common + 1.0);
            return Self::product(factors, largest * common.norm());
        }
        let matrix = case.loops.matrix(s);
        let norm = factor * norm(&matrix);
        match pivots(matrix.closed(factor)) {
            Some(pivots) => Self::product(pivots.into_iter(), norm),
            None => {
                let lu = case.loops.closed(s, factor).dense().lu();
                let sign: C64 = lu.p().determinant();
                let whole =
                    Self::product(lu.u().diagonal().iter().copied().chain([sign]), f64::INFINITY);
                Self { directions: vec![whole.directions.iter().product()], ..whole }
            }
        }
    }

    fn product(factors: impl Iterator<Item = C64>, norm: f64) -> Self {
        // As logarithms, so that many large factors do not overflow.
        let (mut size, mut directions) = (0.0, Vec::new());
        for value in factors {
            size += value.norm().ln();
            directions.push(value / value.norm());
        }
        Self { size, directions, norm }
    }

    /// Turn from here to another frequency, rad: all together, and the largest.
    fn turn(&self, next: &Self) -> (f64, f64) {
        let of = |(before, now): (&C64, &C64)| (now / before).arg();
        if self.directions.len() == next.directions.len() {
            let turns = self.directions.iter().zip(&next.directions).map(of);
            return turns.fold((0.0, 0.0_f64), |(all, most), t| (all + t, most.max(t.abs())));
        }
        let whole = |of: &Self| of.directions.iter().product::<C64>();
        let turn = of((&whole(self), &whole(next)));
        (turn, turn.abs())
    }
}

/// The smaller one of the largest sums of a row and of a column.
fn norm(matrix: &Rows) -> f64 {
    let (mut columns, mut largest) = (vec![0.0; matrix.columns()], 0.0_f64);
    for i in 0..matrix.rows() {
        let mut sum = 0.0;
        let (re, im) = matrix.row(i);
        for (column, (re, im)) in columns.iter_mut().zip(re.iter().zip(im)) {
            let size = re.abs() + im.abs();
            *column += size;
            sum += size;
        }
        largest = largest.max(sum);
    }
    columns.into_iter().fold(0.0, f64::max).min(largest)
}

/// Pivots of a matrix in the order of its rows; `None` where one is lost.
fn pivots(mut matrix: Rows) -> Option<Vec<C64>> {
    let largest = |i: usize| {
        let (re, im) = matrix.row(i);
        re.iter().chain(im).fold(0.0_f64, |largest, x| largest.max(x.abs()))
    };
    let scales: Vec<f64> = (0..matrix.rows()).map(largest).collect();
    let mut pivots = Vec::with_capacity(scales.len());
    for (k, scale) in scales.iter().enumerate() {
        let pivot = matrix.at(k, k);
        let found = pivot.norm() > LOST * scale;
        if !found {
            return None;
        }
        pivots.push(pivot);
        matrix.eliminate(k);
    }
    Some(pivots)
}

/// Number of growing modes: turns of the determinant along the imaginary axis.
///
/// With p poles at zero (integrators) it is `p/2 - change of phase/pi`.
pub(super) fn count_growing(case: &Case, factor: f64) -> i64 {
    let (_, slowest) = case.loops.times_s();
    let mut low = 1e-3 / slowest;
    let order = |factor: f64, omega: f64| {
        let size = |omega| Determinant::of(case, factor, omega).size;
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
    let late_s = case.loops.dead_s();
    let longest = |omega: f64, factors: usize| {
        let all = if factors == 1 && case.loops.len() > 1 { WHOLE_STEP } else { LONGEST_STEP };
        all.min(1.0 + LATE_RAD / (omega * late_s))
    };
    let mut phase = 0.0;
    let mut at = (low, Determinant::of(case, factor, low));
    let mut step = longest(low, at.1.directions.len());
    while at.0 < high {
        if at.1.norm < QUIET && stays_quiet(case, factor, at.0, high) {
            phase -= at.1.directions.iter().map(|direction| direction.arg()).sum::<f64>();
            break;
        }
        let next = (at.0 * step).min(high);
        let value = Determinant::of(case, factor, next);
        let (turn, most) = at.1.turn(&value);
        if most > LARGE_TURN && step > 1.0 + 1e-8 {
            step = 1.0 + 0.3 * (step - 1.0);
            continue;
        }
        phase += turn;
        step = if most < SMALL_TURN { 1.0 + 2.0 * (step - 1.0) } else { step }
            .min(longest(next, value.directions.len()));
        at = (next, value);
    }
    let count = 0.5 * poles - phase / PI;
    #[allow(clippy::cast_possible_truncation)]
    let count = count.round() as i64;
    count
}

/// Whether the norm of `k L` is below 1 at all higher frequencies that are looked at.
fn stays_quiet(case: &Case, factor: f64, omega: f64, high: f64) -> bool {
    (1..=QUIET_AGAIN).all(|i| {
        let share = f64::from(i) / f64::from(QUIET_AGAIN);
        let s = C64::new(0.0, omega * (high / omega).powf(share));
        match &case.lambdas {
            Some(_) => Determinant::of(case, factor, s.im).norm < 1.0,
            None => factor * norm(&case.loops.matrix(s)) < 1.0,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pivots_are_quotients_of_leading_minors() {
        let rows = |n: usize, entry: &dyn Fn(usize, usize) -> C64| {
            let mut rows = Rows::zeros(n, n);
            (0..n * n).for_each(|k| rows.set(k / n, k % n, entry(k / n, k % n)));
            rows
        };
        let entry = |i: usize, j: usize| {
            C64::from_polar(0.3 + 0.1 * (i * 7 + j * 3 % 5) as f64, (i + 2 * j) as f64)
        };
        let closed = rows(5, &entry).closed(1.0);
        let found = pivots(closed.clone()).unwrap();
        let minor = |k: usize| closed.dense().view((0, 0), (k, k)).into_owned().determinant();
        for (k, found) in found.iter().enumerate() {
            let expected = if k == 0 { minor(1) } else { minor(k + 1) / minor(k) };
            assert!((found - expected).norm() < 1e-12, "{k}");
        }
        // A leading minor of zero: only with exchanges.
        let turned = rows(2, &|i, j| C64::new([[0.0, 1.0], [1.0, 1.0]][i][j], 0.0));
        assert!(pivots(turned).is_none());
        // Sums of the rows 3 and 7, of the columns 4 and 6.
        let one_to_four = rows(2, &|i, j| C64::new(0.0, (1 + 2 * i + j) as f64));
        assert_eq!(norm(&one_to_four), 6.0);
    }
}
