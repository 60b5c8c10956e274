//! Darcy friction factor of straight pipes.
//!
//! **Equation** `Re <= 2000`: `f = 64/Re`. `Re >= 4000`: one of
//! - Haaland `f = [-1.8 log10((eps/d/3.7)^1.11 + 6.9/Re)]^-2`
//! - Colebrook `1/sqrt f = -2 log10(eps/d/3.7 + 2.51/(Re sqrt f))`
//! - Swamee-Jain `f = 0.25 [log10(eps/d/3.7 + 5.74/Re^0.9)]^-2`
//!
//! Between: cubic in Re with value and slope of both ends (C1), or linear in Re.
//!
//! **Validity** liquid in full circular pipes, `eps/d < 0.05`.
//!
//! **Sources**: Haaland 1983, Colebrook 1939, Swamee and Jain 1976 (keys `haaland1983`,
//! `colebrook1939`, `swamee1976`).

use anergy_core::linear::Linear;
use anergy_core::numerics::interpolate::cubic_hermite;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::LN_10;

/// Upper end of laminar flow.
pub const RE_LAMINAR: f64 = 2000.0;
/// Lower end of turbulent flow.
pub const RE_TURBULENT: f64 = 4000.0;

/// Correlation for turbulent flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Correlation {
    /// Explicit, within 2 % of Colebrook.
    #[default]
    Haaland,
    /// Implicit, solved to rounding.
    Colebrook,
    /// Explicit, used by the published three-prosumer reference.
    SwameeJain,
}

/// How the friction factor passes from laminar to turbulent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Transition {
    /// Cubic in Re, C1.
    #[default]
    Cubic,
    /// Linear in Re, C0; for comparison with published codes.
    Linear,
}

/// Turbulent friction factor and its derivative with respect to Re (Re > 0).
pub fn turbulent(correlation: Correlation, re: f64, relative_roughness: f64) -> Linear {
    match correlation {
        Correlation::Haaland => {
            let inner = (relative_roughness / 3.7).powf(1.11) + 6.9 / re;
            let root = -1.8 * inner.log10();
            let root_slope = 1.8 / LN_10 / inner * 6.9 / (re * re);
            Linear::new(root.powi(-2), -2.0 * root.powi(-3) * root_slope)
        }
        Correlation::SwameeJain => {
            let inner = relative_roughness / 3.7 + 5.74 * re.powf(-0.9);
            let root = -2.0 * inner.log10();
            let root_slope = 2.0 / LN_10 / inner * 0.9 * 5.74 * re.powf(-1.9);
            Linear::new(root.powi(-2), -2.0 * root.powi(-3) * root_slope)
        }
        Correlation::Colebrook => {
            // Newton on x = 1/sqrt f: x + 2 log10(k + 2.51 x/Re) = 0, concave and rising: it
            // converges from Haaland's value in three steps.
            let k = relative_roughness / 3.7;
            let mut x = turbulent(Correlation::Haaland, re, relative_roughness).value.powf(-0.5);
            let mut slope = 1.0;
            for _ in 0..20 {
                let inner = k + 2.51 * x / re;
                slope = 1.0 + 2.0 / LN_10 / inner * 2.51 / re;
                let step = (x + 2.0 * inner.log10()) / slope;
                x -= step;
                if step.abs() < 1e-13 * x {
                    break;
                }
            }
            let inner = k + 2.51 * x / re;
            let x_slope = 2.0 / LN_10 / inner * 2.51 * x / (re * re) / slope;
            Linear::new(x.powi(-2), -2.0 * x.powi(-3) * x_slope)
        }
    }
}

/// Friction factor and its derivative with respect to Re over all regimes (Re > 0).
pub fn friction_factor(
    correlation: Correlation,
    transition: Transition,
    re: f64,
    relative_roughness: f64,
) -> Linear {
    if re <= RE_LAMINAR {
        return Linear::new(64.0 / re, -64.0 / (re * re));
    }
    if re >= RE_TURBULENT {
        return turbulent(correlation, re, relative_roughness);
    }
    let end = turbulent(correlation, RE_TURBULENT, relative_roughness);
    let start = 64.0 / RE_LAMINAR;
    match transition {
        Transition::Cubic => cubic_hermite(
            re,
            (RE_LAMINAR, start, -64.0 / (RE_LAMINAR * RE_LAMINAR)),
            (RE_TURBULENT, end.value, end.slope),
        ),
        Transition::Linear => {
            let slope = (end.value - start) / (RE_TURBULENT - RE_LAMINAR);
            Linear::new(start + slope * (re - RE_LAMINAR), slope)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Correlation::{Colebrook, Haaland, SwameeJain};

    #[test]
    fn published_values() {
        // (Re, eps/d, Haaland, Colebrook, Swamee-Jain), specification table 5.1
        let table = [
            (4e3, 0.0, 0.040423, 0.039907, 0.040551),
            (1e4, 0.0, 0.030886, 0.030883, 0.030972),
            (1e4, 5e-4, 0.031497, 0.031644, 0.031838),
            (1e5, 5e-4, 0.020067, 0.020327, 0.020415),
            (1e5, 5e-3, 0.031279, 0.031306, 0.031560),
            (1e6, 5e-3, 0.030516, 0.030465, 0.030522),
        ];
        for (re, roughness, haaland, colebrook, swamee) in table {
            for (correlation, expected) in
                [(Haaland, haaland), (Colebrook, colebrook), (SwameeJain, swamee)]
            {
                let f = friction_factor(correlation, Transition::Cubic, re, roughness).value;
                assert!((f - expected).abs() < 1e-5 * expected + 5e-7, "{correlation:?} {re}: {f}");
            }
        }
    }

    #[test]
    fn colebrook_satisfies_its_equation() {
        for (re, k) in [(4e3, 1e-4), (1e5, 0.0), (1e7, 0.02)] {
            let f = turbulent(Colebrook, re, k).value;
            let rhs = -2.0 * (k / 3.7 + 2.51 / (re * f.sqrt())).log10();
            assert!((1.0 / f.sqrt() - rhs).abs() < 1e-12 * rhs);
        }
    }

    #[test]
    fn slopes_and_joints() {
        for correlation in [Haaland, Colebrook, SwameeJain] {
            for re in [500.0, 1999.0, 2500.0, 3500.0, 4500.0, 1e5] {
                let at = |re: f64| friction_factor(correlation, Transition::Cubic, re, 1e-3);
                let difference = (at(re + 0.01).value - at(re - 0.01).value) / 0.02;
                assert!((at(re).slope - difference).abs() < 1e-5 * difference.abs(), "{re}");
            }
            for re in [RE_LAMINAR, RE_TURBULENT] {
                let at = |re: f64| friction_factor(correlation, Transition::Cubic, re, 1e-3);
                assert!((at(re - 1e-6).value - at(re + 1e-6).value).abs() < 1e-10);
                assert!((at(re - 1e-6).slope - at(re + 1e-6).slope).abs() < 1e-10);
            }
        }
        // 5.1 reference: u = 0.22 m/s in 22 mm, eps = 0.011 mm, Re = 4832.268
        let f = turbulent(SwameeJain, 4832.268, 0.0005).value;
        assert!((f - 0.038_867_2).abs() < 1e-6);
    }
}
