//! Expected log predictive density by blocked cross-validation: how well a fit foretells blocks of time it was not fitted to.
//!
//! **Equation** around the fit the residuals are linear in the unknowns. Without block `b` the unknowns move by
//! `delta = -A_b^-1 J_b' e_b`, `A_b = A - J_b' J_b`, and foretell the block with `e_b' = e_b - J_b delta` of covariance
//! `I + J_b A_b^-1 J_b'`. Its log density, `-(e_b'^2 - (J_b' e_b')' A^-1 (J_b' e_b'))/2 - (log det A - log det A_b)/2` but for
//! a constant, is summed over the blocks. No fit is repeated.
//!
//! **Sources** Vehtari, Gelman, Gabry 2017 (key `vehtari2017`).

use crate::fit::Fit;
use crate::response::STEP_TAKES;
use crate::unknown::{Target, Unknown, curvature, square};
use nalgebra::DVector;

/// What is known of an unknown without a block. A jump of a sensor moves readings that lie within it only: how far off its moment could be
/// without the block it falls into, no straight line tells, so that it is taken for known as well as a jump is short.
fn precision(unknown: &Unknown) -> f64 {
    match unknown.target {
        Target::StepShare(_) => 12.0 / STEP_TAKES.powi(2),
        _ => unknown.precision(),
    }
}

/// Log predictive density of every block; `blocks` are ranges of the fitted samples.
pub fn by_block(fit: &Fit, unknowns: &[Unknown], blocks: &[(usize, usize)]) -> Vec<f64> {
    let a = curvature(&fit.sensitivity, unknowns.iter().map(precision));
    let Some(whole) = a.clone().cholesky() else { return vec![f64::NEG_INFINITY; blocks.len()] };
    let log_det = |factor: &nalgebra::Cholesky<f64, nalgebra::Dyn>| {
        2.0 * factor.l().diagonal().iter().map(|d| d.ln()).sum::<f64>()
    };
    let of = |&(from, until): &(usize, usize)| {
        let j = fit.sensitivity.rows(from, until - from);
        let e: DVector<f64> = fit.e.rows(from, until - from).into_owned();
        let Some(rest) = (&a - square(&j)).cholesky() else { return f64::NEG_INFINITY };
        let foretold = &e + j * rest.solve(&j.tr_mul(&e));
        let along = j.tr_mul(&foretold);
        let square = foretold.norm_squared() - along.dot(&whole.solve(&along));
        -0.5 * (square + log_det(&whole) - log_det(&rest))
    };
    blocks.iter().map(of).collect()
}

/// Standard deviation of an unknown by the jackknife: how far the fit moves when one block after the other is left out,
/// `sqrt((B - 1)/B sum delta_b^2)`. It tells what the covariance does not: blocks that contradict each other. Few of them say it
/// badly: it is larger by what the 95 % interval of Student's distribution is wider than the normal one, with the degrees of freedom
/// of so many squares of unlike size, `3 (sum delta_b^2)^2/sum delta_b^4` (Satterthwaite 1946, key `satterthwaite1946`; the 3 as `E delta^4 = 3 (E delta^2)^2`).
pub fn jackknife(fit: &Fit, unknowns: &[Unknown], blocks: &[(usize, usize)], i: usize) -> f64 {
    let a = curvature(&fit.sensitivity, unknowns.iter().map(precision));
    let of = |&(from, until): &(usize, usize)| {
        let j = fit.sensitivity.rows(from, until - from);
        let e: DVector<f64> = fit.e.rows(from, until - from).into_owned();
        let rest = (&a - square(&j)).cholesky()?;
        Some(-rest.solve(&j.tr_mul(&e))[i])
    };
    let moved: Vec<f64> = blocks.iter().filter_map(of).collect();
    let n = moved.len() as f64;
    if n < 2.0 {
        return 0.0;
    }
    let mean = moved.iter().sum::<f64>() / n;
    let of_power = |k| moved.iter().map(|x| (x - mean).powi(k)).sum::<f64>();
    let squares = of_power(2);
    let freedom = 3.0 * squares * squares / of_power(4).max(1e-300);
    ((n - 1.0) / n * squares).sqrt() * wider(freedom.max(3.0))
}

/// 97.5 % quantile of Student's distribution with so many degrees of freedom (3 or more) over that of the normal one, within 1 % by the
/// expansion after Cornish and Fisher (Abramowitz and Stegun 1964, 26.7.5, key `abramowitz1964`).
fn wider(freedom: f64) -> f64 {
    let z: f64 = 1.959_964;
    let term =
        |coefficients: [f64; 4]| coefficients.iter().rev().fold(0.0, |sum, c| sum * z * z + c);
    1.0 + term([1.0, 1.0, 0.0, 0.0]) / (4.0 * freedom)
        + term([3.0, 16.0, 5.0, 0.0]) / (96.0 * freedom.powi(2))
        + term([-15.0, 17.0, 19.0, 3.0]) / (384.0 * freedom.powi(3))
}

/// Difference of two sums over blocks, and its standard error.
///
/// Under the hypothesis that `a` foretells no better, differences are distributed symmetrically around zero at best: those
/// that speak against `a` tell how large they are by chance. (Those that speak for it differ because a front passes in
/// one block and none in another.)
pub fn difference(a: &[f64], b: &[f64]) -> (f64, f64) {
    let each = a.iter().zip(b).map(|(a, b)| a - b);
    let against = each.clone().map(|d| d.min(0.0).powi(2)).sum::<f64>();
    (each.sum(), (2.0 * against).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Slopes;
    use nalgebra::DMatrix;

    #[test]
    fn few_degrees_of_freedom_are_wider() {
        // Tables: 3.1824, 2.5706, 2.2281, 1.9600.
        for (freedom, quantile) in [(3.0, 3.1824), (5.0, 2.5706), (10.0, 2.2281), (1e9, 1.959_964)]
        {
            let found = 1.959_964 * wider(freedom);
            assert!((found - quantile).abs() < 0.01 * quantile, "{freedom}: {found}");
        }
    }

    #[test]
    fn a_mean_foretold_by_hand() {
        // One unknown, the mean of four samples, with a prior of standard deviation 1 around 0: y = 1, 2, 3, 2.
        // Posterior: A = 5, mean 8/5. Without the last block (3, 2): A = 3, mean 1; foretells 3 and 2 with residuals 2 and 1,
        // covariance I + 1/3 ones: inverse I - ones/5, determinant 5/3. -(5 - 9/5)/2 - ln(5/3)/2 = -1.8554.
        let y = [1.0, 2.0, 3.0, 2.0];
        let at = 1.6;
        let fit = Fit {
            at: vec![at],
            readings: vec![at; 4],
            e: DVector::from_iterator(4, y.iter().map(|y| y - at)),
            weight: DVector::from_element(4, 1.0),
            log_evidence: 0.0,
            covariance: DMatrix::from_element(1, 1, 0.2),
            sensitivity: DMatrix::from_element(4, 1, 1.0),
            slopes: Slopes::new(),
            simulated: crate::experiment::Simulated::default(),
        };
        let unknowns = [Unknown::plain(Target::Bias(0), 0.0, 1.0)];
        let found = by_block(&fit, &unknowns, &[(0, 2), (2, 4)]);
        assert!((found[1] + 1.8554).abs() < 1e-4, "{found:?}");
        // Without either block the mean moves by -(e1 + e2)/3: residuals -0.6, 0.4 and 1.4, 0.4:
        // 0.0667 and -0.6; sqrt((0.3333^2 + 0.3333^2)/2) = 0.3333; two alike: 6 degrees of freedom, 2.4469/1.9600 = 1.2485.
        let moved = jackknife(&fit, &unknowns, &[(0, 2), (2, 4)], 0);
        assert!((moved - 0.3333 * 1.2485).abs() < 1e-3, "{moved}");
        // 2 - 1 = 1; sqrt(2 * 1).
        assert_eq!(difference(&[3.0, 0.0], &[1.0, 1.0]), (1.0, 2.0_f64.sqrt()));
    }

    #[test]
    fn the_moment_of_a_jump_is_held_without_its_block() {
        // Two samples in one block, each moved by 100 standard deviations a share, residuals 1 and -1. Without it the moment is known as
        // well as a jump is short, A = 12/0.02^2 = 30000; with it 30000 + 2 100^2: -(1 + 1)/2 - ln(5/3)/2 = -1.2554. (With its prior,
        // 1/0.3^2 = 11.1, it would be -1 - ln(20011/11.1)/2 = -4.75.)
        let fit = Fit {
            at: vec![0.4],
            readings: vec![0.0; 2],
            e: DVector::from_vec(vec![1.0, -1.0]),
            weight: DVector::from_element(2, 1.0),
            log_evidence: 0.0,
            covariance: DMatrix::from_element(1, 1, 1.0 / 20_011.0),
            sensitivity: DMatrix::from_element(2, 1, 100.0),
            slopes: Slopes::new(),
            simulated: crate::experiment::Simulated::default(),
        };
        let unknowns = [Unknown::plain(Target::StepShare(0), 0.5, 0.3)];
        let found = by_block(&fit, &unknowns, &[(0, 2)]);
        assert!((found[0] + 1.2554).abs() < 1e-4, "{found:?}");
    }
}
