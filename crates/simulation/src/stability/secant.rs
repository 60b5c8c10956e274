//! A zero of a complex function: secant steps from a start.

use nalgebra::Complex;

type C64 = Complex<f64>;

const MAX_SECANT: usize = 40;
/// A step this small, relative, is the last.
const CLOSE: f64 = 1e-10;
/// So is one whose product with the one before is this small, as what is left is about that product, once steps shrink.
const LEFT: f64 = 1e-12;
const SHRINKING: f64 = 1e-2;

/// A zero of a function, from a start.
pub(super) fn secant(f: impl Fn(C64) -> C64, start: C64) -> Option<C64> {
    let mut a = start;
    let mut b = start + C64::new(1e-4, 1e-4) * start.norm();
    let (mut fa, mut fb) = (f(a), f(b));
    for _ in 0..MAX_SECANT {
        let slope = (fb - fa) / (b - a);
        let step = fb / slope;
        if !step.re.is_finite() || !step.im.is_finite() {
            return (fb.norm() == 0.0).then_some(b);
        }
        // No further than half the way to the origin: modes lie around the start.
        let step = step * (0.5 * b.norm() / step.norm()).min(1.0);
        let before = (b - a).norm();
        (a, fa) = (b, fb);
        b -= step;
        let (before, now) = (before / b.norm(), step.norm() / b.norm());
        if now <= CLOSE || (before <= SHRINKING && now * before <= LEFT) {
            return Some(b);
        }
        fb = f(b);
    }
    None
}
