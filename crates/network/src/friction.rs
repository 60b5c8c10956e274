//! Friction of straight pipes: Darcy friction factors and the empirical power laws of water supply.
//!
//! **Equation** `Re <= 2000`: `f = 64/Re`. `Re >= 4000`: one of
//! - Haaland `f = [-1.8 log10((eps/d/3.7)^1.11 + 6.9/Re)]^-2`
//! - Colebrook `1/sqrt f = -2 log10(eps/d/3.7 + 2.51/(Re sqrt f))`
//! - Swamee-Jain `f = 0.25 [log10(eps/d/3.7 + 5.74/Re^0.9)]^-2`
//!
//! Between: cubic in Re with value and slope of both ends (C1), linear in Re, or Dunlop's cubic as in
//! EPANET. Power laws, head loss in m of L m of pipe at V in m3/s: Hazen-Williams
//! `h = 10.667 L C^-1.852 d^-4.871 V^1.852`, Chezy-Manning `h = 10.29 n^2 L d^-5.33 V^2`, both with the
//! constants of EPANET.
//!
//! **Validity** liquid in full circular pipes, `eps/d < 0.05`; the power laws: cold water, turbulent.
//!
//! **Numerics** what depends on the roughness alone is computed once for each pipe.
//!
//! **Sources**: `haaland1983`, `colebrook1939`, `swamee1976`, `rossman2020` (EPANET 2.2).

use anergy_core::linear::Linear;
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
    /// Explicit, used by the published three-prosumer reference and by EPANET.
    SwameeJain,
    /// Power law of water supply; needs `hazen_williams_c`.
    HazenWilliams,
    /// Power law of open channels and water supply; needs `manning_n`.
    ChezyManning,
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
    /// Dunlop's cubic as in EPANET, with Swamee-Jain only.
    Dunlop,
}

/// The friction factor of a pipe with what depends on its roughness alone computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DarcyFriction {
    correlation: Correlation,
    transition: Transition,
    /// `eps/d/3.7`, to the power of 1.11 for Haaland.
    roughness: f64,
    /// Coefficients over `Re/2000` between laminar and turbulent.
    between: [f64; 4],
}

impl DarcyFriction {
    /// Friction of a pipe with a relative roughness `eps/d`.
    ///
    /// # Panics
    /// Never; a power law is not a Darcy friction and is answered as Haaland.
    pub fn new(correlation: Correlation, transition: Transition, relative_roughness: f64) -> Self {
        let roughness = relative_roughness / 3.7;
        let mut friction = Self { correlation, transition, roughness, between: [0.0; 4] };
        if correlation == Correlation::Haaland {
            friction.roughness = roughness.powf(1.11);
        }
        if transition == Transition::Dunlop {
            let y2 = roughness + 5.74 * RE_TURBULENT.powf(-0.9);
            let y3 = -2.0 / LN_10 * y2.ln();
            let fa = y3.powi(-2);
            let fb = fa * (2.0 - 0.005_142_15 / (y2 * y3));
            friction.between = [
                7.0 * fa - fb,
                0.128 - 17.0 * fa + 2.5 * fb,
                -0.128 + 13.0 * fa - 2.0 * fb,
                0.032 - 3.0 * fa + 0.5 * fb,
            ];
        } else {
            let end = friction.turbulent(RE_TURBULENT);
            // Over x = Re/2000 from 1 to 2, t = x - 1: f = c0 + c1 t + c2 t^2 + c3 t^3.
            let (start, rise) = (64.0 / RE_LAMINAR, end.value - 64.0 / RE_LAMINAR);
            let (c1, end_slope) = (-start, end.slope * RE_LAMINAR);
            let (c2, c3) = (3.0 * rise - 2.0 * c1 - end_slope, c1 + end_slope - 2.0 * rise);
            friction.between = match transition {
                Transition::Linear => [start - rise, rise, 0.0, 0.0],
                _ => [start - c1 + c2 - c3, c1 - 2.0 * c2 + 3.0 * c3, c2 - 3.0 * c3, c3],
            };
        }
        friction
    }

    /// Friction factor and its derivative with respect to Re over all regimes (Re > 0).
    #[inline]
    pub fn factor(&self, re: f64) -> Linear {
        if re <= RE_LAMINAR {
            return Linear::new(64.0 / re, -64.0 / (re * re));
        }
        if re >= RE_TURBULENT {
            return self.turbulent(re);
        }
        let x = re / RE_LAMINAR;
        let [c0, c1, c2, c3] = self.between;
        Linear::new(
            c0 + x * (c1 + x * (c2 + x * c3)),
            (c1 + x * (2.0 * c2 + 3.0 * x * c3)) / RE_LAMINAR,
        )
    }

    /// Turbulent friction factor and its derivative with respect to Re (Re > 0).
    #[inline]
    fn turbulent(&self, re: f64) -> Linear {
        // f = root^-2, root = -a log10(inner).
        let (root, root_slope) = match self.correlation {
            Correlation::SwameeJain => {
                let term = 5.74 * re.powf(-0.9);
                let inner = self.roughness + term;
                (-2.0 / LN_10 * inner.ln(), 2.0 / LN_10 / inner * 0.9 * term / re)
            }
            Correlation::Colebrook => colebrook(re, self.roughness),
            _ => {
                let term = 6.9 / re;
                let inner = self.roughness + term;
                (-1.8 / LN_10 * inner.ln(), 1.8 / LN_10 / inner * term / re)
            }
        };
        let inverse = 1.0 / root;
        let value = inverse * inverse;
        Linear::new(value, -2.0 * value * inverse * root_slope)
    }
}

/// `1/sqrt f` of Colebrook's equation and its derivative, k = eps/d/3.7: Newton on
/// `x + 2 log10(k + 2.51 x/Re) = 0`, concave and rising, from Haaland's value.
fn colebrook(re: f64, k: f64) -> (f64, f64) {
    let mut x = -1.8 / LN_10 * (k.powf(1.11) + 6.9 / re).ln();
    for _ in 0..20 {
        let inner = k + 2.51 * x / re;
        let slope = 1.0 + 2.0 / LN_10 / inner * 2.51 / re;
        let step = (x + 2.0 / LN_10 * inner.ln()) / slope;
        x -= step;
        if step.abs() < 1e-13 * x {
            break;
        }
    }
    let weight = 2.0 / LN_10 / (k + 2.51 * x / re) * 2.51 / re;
    (x, weight * x / re / (1.0 + weight))
}

/// Head loss of one m of pipe, m, at V in m3/s as `h = coefficient V^exponent`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerFriction {
    /// m per m and (m3/s)^exponent.
    pub coefficient: f64,
    /// Exponent of the flow.
    pub exponent: f64,
}

impl PowerFriction {
    /// Hazen-Williams with the roughness coefficient `c`; `4.727` in ft and ft3/s.
    pub fn hazen_williams(c: f64, diameter_m: f64) -> Self {
        let coefficient = 4.727 * FT.powf(4.871) / FT.powf(3.0 * 1.852);
        Self {
            coefficient: coefficient * c.powf(-1.852) * diameter_m.powf(-4.871),
            exponent: 1.852,
        }
    }

    /// Chezy-Manning with Manning's `n`, s/m^(1/3): `h = (4 n/(1.49 pi d^2))^2 (d/4)^-1.333 V^2` in ft.
    pub fn chezy_manning(n: f64, diameter_m: f64) -> Self {
        let d = diameter_m / FT;
        let per_ft =
            (4.0 * n / (1.49 * std::f64::consts::PI * d * d)).powi(2) * (d / 4.0).powf(-1.333);
        Self { coefficient: per_ft / FT.powi(6), exponent: 2.0 }
    }
}

/// Length of a foot, m.
const FT: f64 = 0.3048;

#[cfg(test)]
mod tests {
    use super::*;
    use Correlation::{Colebrook, Haaland, SwameeJain};

    fn factor(correlation: Correlation, re: f64, relative_roughness: f64) -> Linear {
        DarcyFriction::new(correlation, Transition::Cubic, relative_roughness).factor(re)
    }

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
                let f = factor(correlation, re, roughness).value;
                assert!((f - expected).abs() < 1e-5 * expected + 5e-7, "{correlation:?} {re}: {f}");
            }
        }
    }

    #[test]
    fn colebrook_satisfies_its_equation() {
        for (re, k) in [(4e3, 1e-4), (1e5, 0.0), (1e7, 0.02)] {
            let f = factor(Colebrook, re, k).value;
            let rhs = -2.0 * (k / 3.7 + 2.51 / (re * f.sqrt())).log10();
            assert!((1.0 / f.sqrt() - rhs).abs() < 1e-12 * rhs);
        }
    }

    #[test]
    fn slopes_and_joints() {
        for correlation in [Haaland, Colebrook, SwameeJain] {
            for re in [500.0, 1999.0, 2500.0, 3500.0, 4500.0, 1e5] {
                let at = |re: f64| factor(correlation, re, 1e-3);
                let difference = (at(re + 0.01).value - at(re - 0.01).value) / 0.02;
                assert!((at(re).slope - difference).abs() < 1e-5 * difference.abs(), "{re}");
            }
            for re in [RE_LAMINAR, RE_TURBULENT] {
                let at = |re: f64| factor(correlation, re, 1e-3);
                assert!((at(re - 1e-6).value - at(re + 1e-6).value).abs() < 1e-10);
                assert!((at(re - 1e-6).slope - at(re + 1e-6).slope).abs() < 1e-10);
            }
        }
        // 5.1 reference: u = 0.22 m/s in 22 mm, eps = 0.011 mm, Re = 4832.268
        let f = factor(SwameeJain, 4832.268, 0.0005).value;
        assert!((f - 0.038_867_2).abs() < 1e-6);
    }
    #[test]
    fn dunlop_joins_laminar_flow_and_swamee_jain() {
        let dunlop = DarcyFriction::new(SwameeJain, Transition::Dunlop, 1e-3);
        assert!((dunlop.factor(2000.0 + 1e-9).value - 0.032).abs() < 1e-12);
        // EPANET's AC = -0.00514215 is rounded: the end is met to 1e-6.
        let end = dunlop.factor(4000.0 - 1e-9).value;
        assert!((end - dunlop.factor(4000.0).value).abs() < 1e-6, "{end}");
        // Slope of the published cubic by its coefficients at Re = 3000.
        let difference = (dunlop.factor(3000.1).value - dunlop.factor(2999.9).value) / 0.2;
        assert!((dunlop.factor(3000.0).slope - difference).abs() < 1e-10);
    }

    #[test]
    fn power_laws() {
        // SI form of Hazen-Williams, textbook 10.67: 1 m of 0.3 m pipe, C = 130, 0.1 m3/s:
        // 10.67 * 130^-1.852 * 0.3^-4.871 * 0.1^1.852 = 0.006428
        let law = PowerFriction::hazen_williams(130.0, 0.3);
        let h = law.coefficient * 0.1_f64.powf(1.852);
        assert!((h / 0.006_428 - 1.0).abs() < 1e-3, "{h}");
        // Manning, full pipe: h = n^2 v^2 / (d/4)^(4/3); n = 0.012, d = 0.3, V = 0.1: v = 1.41471,
        // 1.44e-4 * 2.00140 / 0.0316979 = 0.0090921
        let law = PowerFriction::chezy_manning(0.012, 0.3);
        let h = law.coefficient * 0.01;
        assert!((h / 0.009_092_1 - 1.0).abs() < 5e-3, "{h}");
    }
}
