//! Monotone interpolation: piecewise cubic Hermite (PCHIP) with value and slope.
//!
//! **Equation** Between two points a cubic with the slopes of Fritsch and Butland: the weighted
//! harmonic mean of the neighbouring secants, zero where they differ in sign; so the curve is C1 and
//! monotone wherever the data are. Outside the data it continues linearly with the end slope.
//!
//! **Sources**: Fritsch and Carlson 1980, Fritsch and Butland 1984 (key `fritsch1984`).

use crate::linear::Linear;
use thiserror::Error;

/// Data that cannot carry an interpolation.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum InterpolationError {
    /// Fewer than two points.
    #[error("a table needs at least 2 points, this one has {points}")]
    TooFewPoints {
        /// Number of points given.
        points: usize,
    },
    /// The two columns have different lengths.
    #[error("the table has {x} abscissas but {y} values")]
    DifferentLengths {
        /// Number of abscissas.
        x: usize,
        /// Number of values.
        y: usize,
    },
    /// The abscissa does not rise.
    #[error("the abscissa must rise strictly: point {index} is {value}, the point before {before}")]
    NotRising {
        /// Index of the point, from 1.
        index: usize,
        /// Its abscissa.
        value: f64,
        /// Abscissa of the point before.
        before: f64,
    },
    /// A number is NaN or infinite.
    #[error("point {index} is not a finite number")]
    NotFinite {
        /// Index of the point, from 1.
        index: usize,
    },
}

/// A monotone piecewise cubic curve y(x).
#[derive(Debug, Clone, PartialEq)]
pub struct Pchip {
    x: Vec<f64>,
    y: Vec<f64>,
    slope: Vec<f64>,
}

impl Pchip {
    /// A curve through the points `(x[i], y[i])`, x strictly rising.
    ///
    /// # Errors
    /// [`InterpolationError`] names the point that is wrong.
    pub fn new(x: &[f64], y: &[f64]) -> Result<Self, InterpolationError> {
        if x.len() != y.len() {
            return Err(InterpolationError::DifferentLengths { x: x.len(), y: y.len() });
        }
        if x.len() < 2 {
            return Err(InterpolationError::TooFewPoints { points: x.len() });
        }
        if let Some(index) = (0..x.len()).find(|&i| !x[i].is_finite() || !y[i].is_finite()) {
            return Err(InterpolationError::NotFinite { index: index + 1 });
        }
        if let Some(i) = (1..x.len()).find(|&i| x[i] <= x[i - 1]) {
            return Err(InterpolationError::NotRising {
                index: i + 1,
                value: x[i],
                before: x[i - 1],
            });
        }
        let n = x.len();
        let secant: Vec<f64> = (0..n - 1).map(|i| (y[i + 1] - y[i]) / (x[i + 1] - x[i])).collect();
        let mut slope = vec![0.0; n];
        slope[0] = end_slope(x[1] - x[0], secant[0], secant.get(1).map(|s| (x[2] - x[1], *s)));
        slope[n - 1] = end_slope(
            x[n - 1] - x[n - 2],
            secant[n - 2],
            (n > 2).then(|| (x[n - 2] - x[n - 3], secant[n - 3])),
        );
        for i in 1..n - 1 {
            let (left, right) = (secant[i - 1], secant[i]);
            if left * right > 0.0 {
                let (h_left, h_right) = (x[i] - x[i - 1], x[i + 1] - x[i]);
                let (w_left, w_right) = (2.0 * h_right + h_left, h_right + 2.0 * h_left);
                slope[i] = (w_left + w_right) / (w_left / left + w_right / right);
            }
        }
        Ok(Self { x: x.to_vec(), y: y.to_vec(), slope })
    }

    /// Value and slope at x.
    pub fn at(&self, x: f64) -> Linear {
        let last = self.x.len() - 1;
        if x <= self.x[0] {
            return Linear::new(self.y[0] + self.slope[0] * (x - self.x[0]), self.slope[0]);
        }
        if x >= self.x[last] {
            return Linear::new(
                self.y[last] + self.slope[last] * (x - self.x[last]),
                self.slope[last],
            );
        }
        let i = self.x.partition_point(|&xi| xi <= x) - 1;
        cubic_hermite(
            x,
            (self.x[i], self.y[i], self.slope[i]),
            (self.x[i + 1], self.y[i + 1], self.slope[i + 1]),
        )
    }

    /// Replaces the slopes at all points, for data that come from a smooth curve. Each is bounded so that
    /// the curve stays strictly monotone where the data are: between a share of the smaller and three
    /// times the smaller of the neighbouring secants.
    pub fn with_slopes(mut self, slopes: &[f64], least_share: f64) -> Self {
        let last = self.x.len() - 1;
        for (i, wanted) in slopes.iter().enumerate().take(last + 1) {
            let (left, right) = (self.secant(i.saturating_sub(1)), self.secant(i.min(last - 1)));
            let smaller = if left.abs() < right.abs() { left } else { right };
            let share = if smaller == 0.0 { 0.0 } else { wanted / smaller };
            self.slope[i] = smaller * share.clamp(least_share, 3.0);
        }
        self
    }

    /// Replaces the slope at the first point (for a prescribed continuation below the data).
    pub fn with_first_slope(mut self, slope: f64) -> Self {
        self.slope[0] = slope;
        self
    }

    /// Gives both ends at least a share of the slope of their secants, so that strictly monotone data
    /// give a strictly monotone curve, also beyond its ends.
    pub fn with_end_slopes(mut self, share: f64) -> Self {
        let last = self.x.len() - 1;
        for (end, left) in [(0, 0), (last, last - 1)] {
            let least = share * self.secant(left);
            if self.slope[end].abs() < least.abs() {
                self.slope[end] = least;
            }
        }
        self
    }

    /// Slope of the straight line from point i to the next one.
    pub fn secant(&self, i: usize) -> f64 {
        (self.y[i + 1] - self.y[i]) / (self.x[i + 1] - self.x[i])
    }

    /// First and last abscissa.
    pub fn range(&self) -> (f64, f64) {
        (self.x[0], self.x[self.x.len() - 1])
    }
}

/// Straight between points of rising `x`, the end values beyond them.
pub fn between_points(x: &[f64], y: &[f64], at: f64) -> f64 {
    let right = x.partition_point(|x| *x <= at);
    if right == 0 {
        return y[0];
    }
    if right == x.len() {
        return y[right - 1];
    }
    let share = (at - x[right - 1]) / (x[right] - x[right - 1]);
    y[right - 1] + share * (y[right] - y[right - 1])
}

/// Cubic through two points `(x, y, dy/dx)` with value and slope.
#[inline]
pub fn cubic_hermite(x: f64, left: (f64, f64, f64), right: (f64, f64, f64)) -> Linear {
    let h = right.0 - left.0;
    let t = (x - left.0) / h;
    let (t2, t3) = (t * t, t * t * t);
    Linear::new(
        (2.0 * t3 - 3.0 * t2 + 1.0) * left.1
            + (t3 - 2.0 * t2 + t) * h * left.2
            + (3.0 * t2 - 2.0 * t3) * right.1
            + (t3 - t2) * h * right.2,
        (6.0 * t2 - 6.0 * t) / h * (left.1 - right.1)
            + (3.0 * t2 - 4.0 * t + 1.0) * left.2
            + (3.0 * t2 - 2.0 * t) * right.2,
    )
}

/// Three-point end slope that keeps the sign of the data and at most three times the secant.
fn end_slope(h: f64, secant: f64, next: Option<(f64, f64)>) -> f64 {
    let Some((h_next, secant_next)) = next else {
        return secant;
    };
    let slope = ((2.0 * h + h_next) * secant - h * secant_next) / (h + h_next);
    if slope * secant <= 0.0 {
        0.0
    } else if secant * secant_next <= 0.0 && slope.abs() > 3.0 * secant.abs() {
        3.0 * secant
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_slope;

    #[test]
    fn passes_through_its_points_and_is_linear_for_linear_data() {
        let curve = Pchip::new(&[0.0, 1.0, 3.0], &[2.0, 4.0, 8.0]).unwrap();
        for x in [-1.0, 0.0, 0.3, 1.0, 2.9, 3.0, 5.0] {
            assert!((curve.at(x).value - (2.0 + 2.0 * x)).abs() < 1e-12);
            assert!((curve.at(x).slope - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn keeps_monotone_data_monotone() {
        let x = [0.0, 1.0, 2.0, 3.0, 4.0];
        let curve = Pchip::new(&x, &[10.0, 9.9, 9.8, 2.0, 1.9]).unwrap();
        let mut last = f64::INFINITY;
        for i in 0..=400 {
            let point = curve.at(f64::from(i) * 0.01);
            assert!(point.value <= last && point.slope <= 0.0);
            last = point.value;
        }
        for m in [0.3, 1.5, 2.5, 3.9, 4.5] {
            check_slope(|m| curve.at(m), m, 1e-6).unwrap();
        }
    }

    #[test]
    fn wrong_tables_are_named() {
        assert_eq!(
            Pchip::new(&[0.0, 1.0, 1.0], &[1.0, 2.0, 3.0]).unwrap_err().to_string(),
            "the abscissa must rise strictly: point 3 is 1, the point before 1"
        );
        assert!(Pchip::new(&[0.0], &[1.0]).is_err());
        assert!(Pchip::new(&[0.0, f64::NAN], &[1.0, 1.0]).is_err());
        assert!(Pchip::new(&[0.0, 1.0], &[1.0]).is_err());
    }

    #[test]
    fn given_slopes_reproduce_a_cubic() {
        // y = -x^3 - x with y' = -3 x^2 - 1
        let x = [0.0, 0.5, 1.0, 2.0];
        let curve = Pchip::new(&x, &x.map(|x| -x * x * x - x)).unwrap();
        let curve = curve.with_slopes(&x.map(|x| -3.0 * x * x - 1.0), 0.01);
        for x in [0.1, 0.7, 1.5, 2.0] {
            assert!((curve.at(x).value + x * x * x + x).abs() < 1e-14, "{x}");
        }
        // A slope of the wrong sign becomes the least share of the secant, -1.25.
        let bounded = curve.with_slopes(&[5.0, -1.75, -4.0, -13.0], 0.01);
        assert!((bounded.at(0.0).slope + 0.0125).abs() < 1e-14);
    }
}
