//! The scale of all gains at which the first mode stops decaying.
//!
//! **Method** the modes that grow most, or decay least, at the present gains are followed over the scale to the axis, and
//! refined there with Newton on scale and frequency; that nothing grows below is counted. Where none of them is the
//! first, the scale is bisected by counting.

use super::count::{Case, count_growing};
use super::loops::Loops;
use super::modes::{Limit, Probes, SAME, SCALE_STEP, general, resolvent, swings};
use super::secant::secant;
use nalgebra::Complex;

type C64 = Complex<f64>;

/// Modes that are followed, and for how many steps of the scale.
const LIMITS: usize = 4;
const MOST_SCALES: usize = 100;

/// Newton on scale and frequency from those of a scalar equation.
fn refine_limit(loops: &Loops, start: Limit, probes: &Probes) -> Option<Limit> {
    let f = |factor: f64, omega: f64| resolvent(loops, C64::new(0.0, omega), factor, probes);
    let (mut factor, mut omega) = (start.factor, start.omega_rad_s);
    for _ in 0..30 {
        let value = f(factor, omega);
        let by_factor = (f(factor * (1.0 + 1e-6), omega) - value) / (1e-6 * factor);
        let by_omega = (f(factor, omega * (1.0 + 1e-6)) - value) / (1e-6 * omega);
        let det = by_factor.re * by_omega.im - by_factor.im * by_omega.re;
        let d_factor = -(value.re * by_omega.im - value.im * by_omega.re) / det;
        let d_omega = -(by_factor.re * value.im - by_factor.im * value.re) / det;
        if !(d_factor.is_finite() && d_omega.is_finite()) {
            return None;
        }
        factor *= (d_factor / factor).clamp(-0.5, 1.0) + 1.0;
        omega *= (d_omega / omega).clamp(-0.3, 0.3) + 1.0;
        if omega > loops.highest_rad_s() {
            return None;
        }
        if d_factor.abs() < 1e-9 * factor && d_omega.abs() < 1e-9 * omega {
            return Some(Limit { factor, omega_rad_s: omega });
        }
    }
    None
}

/// Where a mode stops decaying: followed from the present gains to the axis.
fn to_axis(loops: &Loops, (root, probes): &(C64, Probes)) -> Option<Limit> {
    let (mut s, mut factor) = (*root, 1.0);
    let step = if s.re > 0.0 { 1.0 / SCALE_STEP } else { SCALE_STEP };
    for _ in 0..MOST_SCALES {
        if (s.re > 0.0) != (root.re > 0.0) {
            return refine_limit(loops, Limit { factor, omega_rad_s: s.im.abs() }, probes);
        }
        factor *= step;
        s = secant(|s| resolvent(loops, s, factor, probes), s)?;
    }
    None
}

/// The first limit below which nothing grows (there a mode stands still, so that beyond it one grows), of the modes that
/// grow most.
pub(super) fn limit_of_modes(case: &Case, mut found: Vec<(C64, Probes)>) -> Option<Limit> {
    const MARGIN: f64 = 1e-3;
    found.retain(|(s, _)| swings(*s));
    found.sort_by(|a, b| b.0.re.total_cmp(&a.0.re));
    found.dedup_by(|a, b| (a.0 - b.0).norm() < SAME * b.0.norm());
    let first = |limit: &Limit| count_growing(case, limit.factor * (1.0 - MARGIN)) == 0;
    found.iter().take(LIMITS).filter_map(|mode| to_axis(case.loops, mode)).find(first)
}

/// The limit by bisection, where no mode leads to it.
pub(super) fn limit_by_counting(case: &Case, omegas: &[f64]) -> Option<Limit> {
    let loops = case.loops;
    let (mut low, mut high) = (1e-6, 1e6);
    if count_growing(case, high) == 0 {
        return None;
    }
    while high / low > 1.0 + 1e-6 {
        let middle = (low * high).sqrt();
        if count_growing(case, middle) == 0 { low = middle } else { high = middle }
    }
    // The frequency is that at which the determinant comes closest to zero.
    let size = |omega: &f64| loops.closed(C64::new(0.0, *omega), high).dense().determinant().norm();
    let omega = omegas.iter().copied().min_by(|a, b| size(a).total_cmp(&size(b)))?;
    Some(
        refine_limit(loops, Limit { factor: high, omega_rad_s: omega }, &general(loops))
            .filter(|refined| (refined.factor / high - 1.0).abs() < 1e-2)
            .unwrap_or(Limit { factor: high, omega_rad_s: omega }),
    )
}
