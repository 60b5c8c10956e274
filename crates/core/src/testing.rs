//! Checks that tests of every crate share: slope, monotonicity, closed balance.

use crate::linear::Linear;

/// The slope of a law agrees with the central difference of its value.
///
/// # Errors
/// A sentence with both numbers when they differ by more than `relative` of the larger one.
pub fn check_slope(law: impl Fn(f64) -> Linear, m: f64, relative: f64) -> Result<(), String> {
    let h = 1e-6 * m.abs().max(1e-3);
    let difference = (law(m + h).value - law(m - h).value) / (2.0 * h);
    let slope = law(m).slope;
    // Rounding of the values limits what a difference can show.
    let rounding = law(m).value.abs() * 1e-15 / h;
    if (slope - difference).abs() <= relative * slope.abs().max(difference.abs()) + rounding {
        Ok(())
    } else {
        Err(format!("slope at m = {m} is {slope}, the finite difference {difference}"))
    }
}

/// A law is finite, has a positive slope, and rises strictly over the given increasing flows.
///
/// # Errors
/// A sentence with the place where it does not.
pub fn check_monotone(law: impl Fn(f64) -> Linear, flows: &[f64]) -> Result<(), String> {
    let mut last = f64::NEG_INFINITY;
    for &m in flows {
        let Linear { value, slope } = law(m);
        if !value.is_finite() || !slope.is_finite() || slope <= 0.0 {
            return Err(format!("at m = {m}: value {value}, slope {slope}"));
        }
        if value <= last {
            return Err(format!("at m = {m} the value {value} is not above {last} before it"));
        }
        last = value;
    }
    Ok(())
}

/// The parts of a balance sum to zero within `relative` of their largest magnitude.
///
/// # Errors
/// A sentence with the remainder.
pub fn balance_closes(parts: &[f64], relative: f64) -> Result<(), String> {
    let sum: f64 = parts.iter().sum();
    let scale = parts.iter().fold(0.0_f64, |scale, part| scale.max(part.abs()));
    if sum.abs() <= relative * scale {
        Ok(())
    } else {
        Err(format!("balance of {parts:?} leaves {sum}, {:e} of the largest part", sum / scale))
    }
}
