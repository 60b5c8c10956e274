//! The interval of a parameter by its profile likelihood: how far it can move until the data speak against it, with everything
//! else fitted anew.
//!
//! **Equation** `F(x) = min over the others of sum e^2 + sum f_j(x_j)`, `f_j` twice the fall of their priors, without the prior of the parameter itself.
//! The likelihood's 95 % interval holds the `x` with `F(x) - min F < 3.84` (chi-squared, one degree of freedom); it is made as wide as cases say (`WIDE`). On each side
//! `sqrt(F - min F)` is nearly straight: two fits and the line through them give the end. A side on which it does not rise so
//! far within the bounds of a fit is open: the data alone do not bound it there.
//!
//! **Sources** Raue et al. 2009 (key `raue2009`).

use crate::experiment::Experiment;
use crate::fit::{BOUND_SD, Care, Fit, WIDE, fit};
use crate::likelihood::Likelihood;
use crate::unknown::Unknown;

/// Rise of the objective at the ends of the interval.
const RISE: f64 = 3.84;
/// Fits on each side.
const FITS: usize = 3;
/// Near enough, relative to the root of the rise.
const NEAR: f64 = 0.1;
/// A fixed parameter moves by no more than this share of its standard deviation.
const FIXED: f64 = 1e-5;

/// Ends of an interval in coordinates; none where it is open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// Lower end.
    pub lo: Option<f64>,
    /// Upper end.
    pub hi: Option<f64>,
}

/// The profile of the unknown at `place`.
pub fn profile(
    experiment: &Experiment,
    unknowns: &[Unknown],
    likelihood: &Likelihood,
    at: &Fit,
    place: usize,
) -> Profile {
    let own = &unknowns[place];
    let bound = |sign: f64| own.mean + sign * BOUND_SD * own.sd;
    let objective = |x: f64| -> f64 {
        let mut fixed = unknowns.to_vec();
        for (unknown, at) in fixed.iter_mut().zip(&at.at) {
            unknown.start = *at;
        }
        fixed[place] =
            Unknown { mean: x, start: x, sd: FIXED * own.sd, limited: false, ..own.clone() };
        // A value with which the model does not run is none.
        let found = fit(experiment, &fixed, likelihood, &at.slopes, Care::Quick);
        found.map_or(f64::INFINITY, |found| without_own(&found, &fixed, place))
    };
    let least = without_own(at, unknowns, place);
    // Standard deviation by the data and the other priors alone.
    let own_precision = 1.0 / (own.sd * own.sd);
    let precision = 1.0 / at.covariance[(place, place)].max(1e-300) - own_precision;
    let sd = if precision > 1e-6 * own_precision { precision.powf(-0.5) } else { 1e3 * own.sd };
    let middle = at.at[place];
    let wide = |end: f64| middle + WIDE * (end - middle);
    Profile {
        lo: end(&objective, middle, least, -sd, bound(-1.0)).map(wide),
        hi: end(&objective, middle, least, sd, bound(1.0)).map(wide),
    }
}

/// Objective of a fit without the prior of one unknown.
fn without_own(fit: &Fit, unknowns: &[Unknown], place: usize) -> f64 {
    let priors = unknowns.iter().zip(&fit.at).enumerate().filter(|(j, _)| *j != place);
    fit.e.norm_squared() + priors.map(|(_, (u, x))| u.fall(*x)).sum::<f64>()
}

/// Where the objective has risen by [`RISE`], from the middle towards a bound; `sd` has the sign of the side.
fn end(
    objective: &dyn Fn(f64) -> f64,
    middle: f64,
    least: f64,
    sd: f64,
    bound: f64,
) -> Option<f64> {
    let root = RISE.sqrt();
    let within =
        |step: f64| if sd > 0.0 { step.min(bound - middle) } else { step.max(bound - middle) };
    let (mut before, mut height_before) = (0.0, 0.0);
    let mut step = within(root * sd);
    for _ in 0..FITS {
        let height = (objective(middle + step) - least).max(0.0).sqrt();
        if height.is_infinite() {
            step = 0.5 * (before + step);
            continue;
        }
        if (height - root).abs() < NEAR * root {
            return Some(middle + step * root / height);
        }
        if height < root && step == within(f64::INFINITY.copysign(sd)) {
            return None;
        }
        // The line through the last two points, at most three times as far.
        let slope = (height - height_before) / (step - before);
        let next = if slope * sd.signum() > 0.0 {
            before + (root - height_before) / slope
        } else {
            3.0 * step
        };
        let next = if sd > 0.0 {
            next.clamp(0.2 * step, 3.0 * step)
        } else {
            next.clamp(3.0 * step, 0.2 * step)
        };
        if height < root {
            (before, height_before) = (step, height);
        }
        step = within(next);
    }
    Some(middle + step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_by_hand() {
        // F = (x/0.5)^2 rises by 3.84 at 0.98.
        let parabola = |x: f64| (x / 0.5).powi(2);
        let found = end(&parabola, 0.0, 0.0, 0.3, 10.0).unwrap();
        assert!((found - 0.98).abs() < 1e-3, "{found}");
        let found = end(&parabola, 0.0, 0.0, -2.0, -10.0).unwrap();
        assert!((found + 0.98).abs() < 1e-3, "{found}");
        // Steeper above than below: ln-like.
        let skew = |x: f64| (x.exp() - 1.0).powi(2) * 4.0;
        // e^x - 1 = 0.98: x = 0.683.
        let found = end(&skew, 0.0, 0.0, 0.5, 10.0).unwrap();
        assert!((found - 0.683).abs() < 0.03, "{found}");
        // Below it never rises by more than 4 (1)^2 = 4 > 3.84 only at e^x = 0.02.
        assert_eq!(end(&skew, 0.0, 0.0, -0.5, -2.0), None);
        // Flat: open.
        assert_eq!(end(&|_| 0.0, 0.0, 0.0, 1.0, 6.0), None);
    }

    #[test]
    fn a_value_with_which_the_model_does_not_run_shortens_the_step() {
        // The first step, 1.96 * 0.8 = 1.57, ends where nothing runs; half of it is 0.784: 1.568^2, less than 1.96^2.
        let edge = |x: f64| if x > 1.0 { f64::INFINITY } else { (x / 0.5).powi(2) };
        let found = end(&edge, 0.0, 0.0, 0.8, 10.0).unwrap();
        assert!((found - 0.98).abs() < 1e-3, "{found}");
        // It runs nowhere near the end: between the last value that runs and the first that does not.
        let near = |x: f64| if x > 0.3 { f64::INFINITY } else { (x / 0.5).powi(2) };
        let found = end(&near, 0.0, 0.0, 0.8, 10.0).unwrap();
        assert!(found > 0.0 && found < 0.8, "{found}");
    }
}
