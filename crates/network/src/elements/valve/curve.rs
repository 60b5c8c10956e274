//! Relative flow coefficient of a valve over its stroke, and back: the equations are in [`super`].
//!
//! What does not depend on the stroke is computed once: the solver asks for the coefficient in every
//! iteration of every step.

use crate::two_port::ElementError;
use anergy_core::numerics::interpolate::{Pchip, cubic_hermite};

/// Width of the linear foot of the equal-percentage characteristic, and of the region in which the
/// quick-opening one leaves its power law.
pub(super) const FOOT: f64 = 0.01;
/// Slope of a table at its ends, at least, as a share of the first and last secant.
const END_SLOPE_SHARE: f64 = 0.1;
/// Halvings of an interval of the stroke until neighbouring numbers are left.
const BISECTIONS: u32 = 60;

/// A characteristic that rises strictly from the leakage to 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    leakage: f64,
    shape: Shape,
}

#[derive(Debug, Clone, PartialEq)]
enum Shape {
    Linear,
    EqualPercentage(EqualPercentage),
    QuickOpening { exponent: f64, scale: f64 },
    Table(Pchip),
}

/// `phi = R^(y - 1)` above a linear foot.
#[derive(Debug, Clone, PartialEq)]
struct EqualPercentage {
    ln_rangeability: f64,
    foot_slope: f64,
    /// Stroke, phi and slope at the ends of the blend.
    blend_from: (f64, f64, f64),
    blend_to: (f64, f64, f64),
}

impl Curve {
    /// `phi = l + (1 - l) y`.
    pub(super) fn linear(leakage: f64) -> Self {
        Self { leakage, shape: Shape::Linear }
    }

    /// Equal percentage with a rangeability; the leakage is below that of the foot.
    pub(super) fn equal_percentage(leakage: f64, rangeability: f64) -> Self {
        let ln_rangeability = rangeability.ln();
        let foot_slope = (((FOOT - 1.0) * ln_rangeability).exp() - leakage) / FOOT;
        let (from, to) = (0.5 * FOOT, 1.5 * FOOT);
        let end = ((to - 1.0) * ln_rangeability).exp();
        let shape = Shape::EqualPercentage(EqualPercentage {
            ln_rangeability,
            foot_slope,
            blend_from: (from, leakage + from * foot_slope, foot_slope),
            blend_to: (to, end, end * ln_rangeability),
        });
        Self { leakage, shape }
    }

    /// `phi = l + (1 - l) y^(1/alpha)` with a finite slope at the seat.
    pub(super) fn quick_opening(leakage: f64, alpha: f64) -> Self {
        let exponent = 0.5 * (1.0 / alpha - 1.0);
        let scale = (1.0 + FOOT * FOOT).powf(-exponent);
        Self { leakage, shape: Shape::QuickOpening { exponent, scale } }
    }

    /// `phi = l + (1 - l) f(y)` with f through points.
    ///
    /// # Errors
    /// Names the column and the point that is wrong.
    pub(super) fn table(leakage: f64, opening: &[f64], phi: &[f64]) -> Result<Self, ElementError> {
        let wrong = |field, problem| Err(ElementError::Table { field, problem });
        let points = match Pchip::new(opening, phi) {
            Ok(points) => points.with_end_slopes(END_SLOPE_SHARE),
            Err(error) => return wrong("table_opening", error.to_string()),
        };
        for (field, column) in [("table_opening", opening), ("table_phi", phi)] {
            let (first, last) = (column[0], column[column.len() - 1]);
            if first != 0.0 || last != 1.0 {
                let problem =
                    format!("must begin with 0 and end with 1, not with {first} and {last}");
                return wrong(field, problem);
            }
        }
        if let Some(i) = (1..phi.len()).find(|&i| phi[i] <= phi[i - 1]) {
            let problem = format!(
                "the coefficient must rise strictly with the opening: point {} has {}, the point \
                 before {}",
                i + 1,
                phi[i],
                phi[i - 1]
            );
            return wrong("table_phi", problem);
        }
        Ok(Self { leakage, shape: Shape::Table(points) })
    }

    /// Relative flow coefficient at an opening.
    pub(super) fn phi(&self, y: f64) -> f64 {
        let l = self.leakage;
        match &self.shape {
            Shape::Linear => l + (1.0 - l) * y,
            Shape::EqualPercentage(curve) => {
                if y <= curve.blend_from.0 {
                    l + y * curve.foot_slope
                } else if y >= curve.blend_to.0 {
                    ((y - 1.0) * curve.ln_rangeability).exp()
                } else {
                    cubic_hermite(y, curve.blend_from, curve.blend_to).value
                }
            }
            Shape::QuickOpening { exponent, scale } => {
                l + (1.0 - l) * scale * y * (y * y + FOOT * FOOT).powf(*exponent)
            }
            Shape::Table(points) => l + (1.0 - l) * points.at(y).value,
        }
    }

    /// Slope of the relative flow coefficient over the opening.
    pub(super) fn phi_slope(&self, y: f64) -> f64 {
        let l = self.leakage;
        match &self.shape {
            Shape::Linear => 1.0 - l,
            Shape::EqualPercentage(curve) => {
                if y <= curve.blend_from.0 {
                    curve.foot_slope
                } else if y >= curve.blend_to.0 {
                    self.phi(y) * curve.ln_rangeability
                } else {
                    cubic_hermite(y, curve.blend_from, curve.blend_to).slope
                }
            }
            Shape::QuickOpening { exponent, scale } => {
                let square = y * y + FOOT * FOOT;
                let by_y = 1.0 + 2.0 * exponent * y * y / square;
                (1.0 - l) * scale * square.powf(*exponent) * by_y
            }
            Shape::Table(points) => (1.0 - l) * points.at(y).slope,
        }
    }

    /// Opening with a relative flow coefficient.
    pub(super) fn opening(&self, phi: f64) -> f64 {
        let l = self.leakage;
        if phi <= l {
            return 0.0;
        }
        if phi >= 1.0 {
            return 1.0;
        }
        match &self.shape {
            Shape::Linear => ((phi - l) / (1.0 - l)).min(1.0),
            Shape::EqualPercentage(curve) => {
                let y = 1.0 + phi.ln() / curve.ln_rangeability;
                if y >= curve.blend_to.0 { y.min(1.0) } else { self.bisect(phi, curve.blend_to.0) }
            }
            Shape::QuickOpening { .. } | Shape::Table(_) => self.bisect(phi, 1.0),
        }
    }

    /// Opening below `high` with a relative flow coefficient.
    fn bisect(&self, phi: f64, high: f64) -> f64 {
        let (mut low, mut high) = (0.0, high);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if self.phi(middle) < phi { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_inverse_table() {
        // kappa : opening for R = 50 (elizarov2021)
        let curve = Curve::equal_percentage(2e-3, 50.0);
        let table = [
            (0.029575152, 0.1),
            (0.043734483, 0.2),
            (0.0646727, 0.3),
            (0.09563525, 0.4),
            (0.14142136, 0.5),
            (0.20912792, 0.6),
            (0.3092495, 0.7),
            (0.45730504, 0.8),
            (0.67624336, 0.9),
            (1.0, 1.0),
        ];
        for (kappa, opening) in table {
            assert!((curve.opening(kappa) - opening).abs() < 1e-6, "{kappa}");
        }
        for phi in [0.0025, 0.01, 0.0205, 0.021, 0.5] {
            assert!((curve.phi(curve.opening(phi)) - phi).abs() < 1e-12, "{phi}");
        }
    }

    #[test]
    fn equal_percentage_is_the_power_of_the_rangeability() {
        for (leakage, r) in [(0.0, 2.0), (2e-3, 50.0), (1e-3, 100.0)] {
            let curve = Curve::equal_percentage(leakage, r);
            let foot_slope = (f64::powf(r, FOOT - 1.0) - leakage) / FOOT;
            for i in 0..=1000 {
                let y = f64::from(i) / 1000.0;
                let expected = if y <= 0.5 * FOOT {
                    leakage + y * foot_slope
                } else if y >= 1.5 * FOOT {
                    r.powf(y - 1.0)
                } else {
                    continue;
                };
                assert!((curve.phi(y) / expected.max(1e-300) - 1.0).abs() < 1e-12 || y == 0.0);
            }
            assert_eq!(curve.phi(0.0), leakage);
        }
    }

    #[test]
    fn quick_opening_and_table_have_their_inverse() {
        // sqrt(0.25) = 0.5: phi = 0.05 + 0.95 * 0.5 = 0.525. The foot lowers the root by
        // (1 + (0.01/0.25)^2)^(-1/4) = 0.9996 and the scale raises it by 1.000025: 0.52482.
        let quick = Curve::quick_opening(0.05, 2.0);
        assert!((quick.phi(0.25) - 0.52482).abs() < 1e-5, "{}", quick.phi(0.25));
        let table = Curve::table(0.0, &[0.0, 0.2, 0.6, 1.0], &[0.0, 0.05, 0.7, 1.0]).unwrap();
        assert!((table.phi(0.6) - 0.7).abs() < 1e-15);
        for curve in [quick, table, Curve::quick_opening(1e-4, 3.5)] {
            for phi in [0.051, 0.06, 0.2, 0.525, 0.7, 0.999] {
                assert!((curve.phi(curve.opening(phi)) - phi).abs() < 1e-12, "{phi}");
            }
            assert_eq!((curve.opening(0.0), curve.opening(1.0)), (0.0, 1.0));
            assert!((curve.phi(1.0) - 1.0).abs() < 1e-15);
        }
    }
}
