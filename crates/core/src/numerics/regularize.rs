//! The one place where laws are made smooth and strictly monotone at zero flow.
//!
//! **Equation** `dp = c m|m|` for `|m| >= m_t`; inside, with `x = m/m_t`,
//! `dp = c m_t^2 x (0.375 + (0.75 - 0.125 x^2) x^2)`: odd, C2, slope at zero `0.375 c m_t > 0`.
//!
//! **Sources**: IBPSA Modelica library, `basicFlowFunction_m_flow` (key `wetter2014`).

use crate::linear::Linear;

/// Smooth quadratic law `dp = c m|m|` with turbulent threshold `m_turbulent` (> 0), both in the same
/// unit of flow; `coefficient` = `1/k^2` of the flow coefficient k.
#[inline]
pub fn quadratic(m: f64, coefficient: f64, m_turbulent: f64) -> Linear {
    let x = m / m_turbulent;
    if x.abs() >= 1.0 {
        Linear::new(coefficient * m * m.abs(), 2.0 * coefficient * m.abs())
    } else {
        let x2 = x * x;
        Linear::new(
            coefficient * m_turbulent * m_turbulent * x * (0.375 + (0.75 - 0.125 * x2) * x2),
            coefficient * m_turbulent * (0.375 + (2.25 - 0.625 * x2) * x2),
        )
    }
}

/// Slope of [`quadratic`] at zero flow.
#[inline]
pub fn quadratic_slope_at_zero(coefficient: f64, m_turbulent: f64) -> f64 {
    0.375 * coefficient * m_turbulent
}

/// C1 step from 0 (x <= 0) to 1 (x >= 1): `x^2 (3 - 2x)`.
#[inline]
pub fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Odd power law `c m |m|^(n-1)` with n > 0, C1 and with a positive, finite slope at zero: inside the
/// threshold, with `x = |m|/m_t`, `c m_t^n x (1 - b + b x^(2 max(1, n - 1)))`, `b = min(n - 1, 1)/2`.
#[inline]
pub fn power(m: f64, coefficient: f64, exponent: f64, m_turbulent: f64) -> Linear {
    let n = exponent;
    if m.abs() >= m_turbulent {
        let slope = coefficient * m.abs().powf(n - 1.0);
        return Linear::new(slope * m, n * slope);
    }
    let x = m.abs() / m_turbulent;
    let (b, k) = (0.5 * (n - 1.0).min(1.0), 2.0 * (n - 1.0).max(1.0));
    let bent = b * x.powf(k);
    let scale = coefficient * m_turbulent.powf(n - 1.0);
    Linear::new(scale * m * (1.0 - b + bent), scale * (1.0 - b + (1.0 + k) * bent))
}

/// The larger of two laws, C1 where they cross: `max(a, b) + (e - d)^2/(4 e)` where `d = |a - b| < e`, so
/// at most `e/4` above; elsewhere exactly the larger one. The slope is a weighted mean of the two slopes.
#[inline]
pub fn smooth_max(a: Linear, b: Linear, rounding: f64) -> Linear {
    let (above, below) = if a.value >= b.value { (a, b) } else { (b, a) };
    let within = rounding - (above.value - below.value);
    if within <= 0.0 {
        return above;
    }
    let weight = 0.5 * within / rounding;
    Linear::new(
        above.value + 0.5 * weight * within,
        above.slope * (1.0 - weight) + below.slope * weight,
    )
}

/// The smaller of two laws, C1 where they cross: `-smooth_max(-a, -b)`.
#[inline]
pub fn smooth_min(a: Linear, b: Linear, rounding: f64) -> Linear {
    smooth_max(a.scaled(-1.0), b.scaled(-1.0), rounding).scaled(-1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_slope;

    #[test]
    fn half_the_threshold() {
        // x = 0.5: 0.5 (0.375 + (0.75 - 0.03125) 0.25) = 0.5 * 0.5546875 = 0.27734375
        let law = quadratic(0.05, 3.0, 0.1);
        assert!((law.value - 3.0 * 0.01 * 0.277_343_75).abs() < 1e-15);
        let slope = quadratic_slope_at_zero(3.0, 0.1);
        assert!((quadratic(0.0, 3.0, 0.1).slope / slope - 1.0).abs() < 1e-15);
    }

    #[test]
    fn joins_the_square_law_twice_differentiably() {
        let (c, m_t) = (2.0, 0.3);
        let inside = quadratic(m_t * (1.0 - 1e-9), c, m_t);
        let outside = quadratic(m_t * (1.0 + 1e-9), c, m_t);
        assert!((inside.value - outside.value).abs() < 1e-8);
        assert!((inside.slope - outside.slope).abs() < 1e-8);
        let curvature =
            |m: f64| (quadratic(m + 1e-6, c, m_t).slope - quadratic(m - 1e-6, c, m_t).slope) / 2e-6;
        assert!((curvature(m_t - 2e-6) - curvature(m_t + 2e-6)).abs() < 1e-3);
        for m in [-1.0, -0.3, -0.1, 0.0, 0.05, 0.299, 0.5] {
            check_slope(|m| quadratic(m, c, m_t), m, 1e-5).unwrap();
        }
    }

    #[test]
    fn power_laws_join_their_foot() {
        // n = 1.5 at x = 2: 2^1.5 = 2.8284; n = 1 is linear; n = 3 at x = 0.5, b = 0.5, k = 4:
        // 0.5 (0.5 + 0.5 * 0.0625) = 0.265625
        assert!((power(0.2, 1.0, 1.5, 0.1).value - 0.2_f64.powf(1.5)).abs() < 1e-15);
        assert!((power(0.03, 2.0, 1.0, 0.1).value - 0.06).abs() < 1e-15);
        assert!((power(0.05, 1.0, 3.0, 0.1).value - 1e-3 * 0.265_625).abs() < 1e-15);
        for n in [0.3, 0.9, 1.0, 1.5, 2.0, 2.7, 5.0, 20.0] {
            for m in [-1.0, -0.1, -0.03, 1e-4, 0.05, 0.0999, 0.5] {
                check_slope(|m| power(m, 2.0, n, 0.1), m, 1e-5).unwrap();
            }
            let (inside, outside) = (power(0.1 - 1e-12, 2.0, n, 0.1), power(0.1, 2.0, n, 0.1));
            assert!((inside.slope / outside.slope - 1.0).abs() < 1e-8, "{n}");
            assert!(power(0.0, 2.0, n, 0.1).slope > 0.0);
            assert_eq!(power(-0.02, 2.0, n, 0.1).value, -power(0.02, 2.0, n, 0.1).value);
        }
    }

    #[test]
    fn the_larger_of_two_laws_is_rounded_at_the_crossing_only() {
        // Lines x and 3x cross at 0: there 0.1/4 above; at x = 0.02 they are 0.04 apart:
        // 0.06 + 0.06^2/0.4 = 0.069, slope (3 * 0.7 + 1 * 0.3) = 2.4; at x = 1 exactly 3.
        let of = |x: f64| smooth_max(Linear::new(x, 1.0), Linear::new(3.0 * x, 3.0), 0.1);
        assert!((of(0.0).value - 0.025).abs() < 1e-15);
        assert!((of(0.02).value - 0.069).abs() < 1e-15);
        assert!((of(0.02).slope - 2.4).abs() < 1e-14);
        assert_eq!(of(1.0), Linear::new(3.0, 3.0));
        let least = |x: f64| smooth_min(Linear::new(x, 1.0), Linear::new(3.0 * x, 3.0), 0.1);
        assert!((least(0.02).value - 0.011).abs() < 1e-15);
        for x in [-1.0, -0.02, 0.01, 0.3] {
            check_slope(of, x, 1e-6).unwrap();
            check_slope(least, x, 1e-6).unwrap();
        }
    }
}
