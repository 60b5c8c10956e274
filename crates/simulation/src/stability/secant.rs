//! A zero of a complex function: secant steps from a start.

use nalgebra::Complex;

type C64 = Complex<f64>;

const MAX_SECANT: usize = 40;
const CLOSE: f64 = 1e-10;

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
        (a, fa) = (b, fb);
        b -= step;
        fb = f(b);
        if step.norm() <= CLOSE * b.norm() {
            return Some(b);
        }
    }
    None
}
