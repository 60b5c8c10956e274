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

/// Smooth power law `coefficient m|m|^(exponent-1)` (1 < exponent < 3) above `m_turbulent` (> 0); below,
/// with `x = m/m_turbulent`, the odd cubic `x ((3-n)/2 + (n-1)/2 x^2)` that joins it with its slope.
#[inline]
pub fn power(m: f64, coefficient: f64, exponent: f64, m_turbulent: f64) -> Linear {
    if m.abs() >= m_turbulent {
        let slope = coefficient * m.abs().powf(exponent - 1.0);
        Linear::new(slope * m, exponent * slope)
    } else {
        let scale = coefficient * m_turbulent.powf(exponent - 1.0);
        let (x, linear, cubic) = (m / m_turbulent, 0.5 * (3.0 - exponent), 0.5 * (exponent - 1.0));
        Linear::new(scale * m * (linear + cubic * x * x), scale * (linear + 3.0 * cubic * x * x))
    }
}

/// C1 step from 0 (x <= 0) to 1 (x >= 1): `x^2 (3 - 2x)`.
#[inline]
pub fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
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
}
