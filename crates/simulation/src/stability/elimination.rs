//! Dense complex matrices, real and imaginary parts apart, so that the inner loops are those of plain numbers along
//! rows; their elimination with exchanges.
//!
//! **Numerics** rows are filled up with zeros to whole vectors of the processor (`lanes.rs`). Pivots are taken off in panels
//! of one vector: what is right of a panel waits until all pivots of it are known, and is then read and written once for
//! all of them. **Sources** `golub2013` (3.2.11).

use super::lanes::{LANES, Row, RowMut, add_rows, more, take_off};
use nalgebra::{Complex, DMatrix, DVector};

type C64 = Complex<f64>;

/// A matrix, row by row.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    columns: usize,
    /// Length of a row: whole lanes.
    width: usize,
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Rows {
    pub fn zeros(rows: usize, columns: usize) -> Self {
        let width = columns.next_multiple_of(LANES);
        Self { columns, width, re: vec![0.0; rows * width], im: vec![0.0; rows * width] }
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.re.len().checked_div(self.width).unwrap_or(0)
    }

    pub fn at(&self, i: usize, j: usize) -> C64 {
        C64::new(self.re[i * self.width + j], self.im[i * self.width + j])
    }

    pub fn set(&mut self, i: usize, j: usize, value: C64) {
        (self.re[i * self.width + j], self.im[i * self.width + j]) = (value.re, value.im);
    }

    /// A row with the zeros behind it.
    #[inline]
    pub fn row(&self, i: usize) -> Row<'_> {
        let of = i * self.width..(i + 1) * self.width;
        (&self.re[of.clone()], &self.im[of])
    }

    /// A row with the zeros behind it.
    #[inline]
    pub fn row_mut(&mut self, i: usize) -> RowMut<'_> {
        let of = i * self.width..(i + 1) * self.width;
        (&mut self.re[of.clone()], &mut self.im[of])
    }

    /// `1 + factor M` of a square matrix.
    pub fn closed(mut self, factor: f64) -> Self {
        self.re.iter_mut().for_each(|x| *x *= factor);
        self.im.iter_mut().for_each(|x| *x *= factor);
        self.re.iter_mut().step_by(self.width + 1).for_each(|x| *x += 1.0);
        self
    }

    /// `left^H M right`.
    pub fn between(&self, left: &DVector<C64>, right: &DVector<C64>) -> C64 {
        let (mut re, mut im) = (vec![0.0; self.width], vec![0.0; self.width]);
        let shares: Vec<C64> = left.iter().map(C64::conj).collect();
        add_rows(&shares, (&self.re, &self.im), (&mut re, &mut im));
        let entries = re.into_iter().zip(im).map(|(re, im)| C64::new(re, im));
        entries.zip(right.iter()).map(|(entry, right)| entry * right).sum()
    }

    /// As a matrix of nalgebra.
    pub fn dense(&self) -> DMatrix<C64> {
        DMatrix::from_fn(self.rows(), self.columns, |i, j| self.at(i, j))
    }
}

/// A square matrix, eliminated.
pub(super) struct Eliminated {
    /// Multipliers below the diagonal, what is left from it on.
    rows: Rows,
    /// Which row of the matrix each row was.
    order: Vec<usize>,
}

impl Eliminated {
    /// Eliminates a matrix; `None` where it is singular or not a number.
    pub fn of(matrix: Rows) -> Option<Self> {
        let n = matrix.columns;
        let mut all = Self { rows: matrix, order: (0..n).collect() };
        for k in 0..n {
            let pivot = all.rows.largest_below(k);
            let size = all.rows.at(pivot, k).norm_sqr();
            if !(size > 0.0 && size.is_finite()) {
                return None;
            }
            all.exchange(k, pivot);
            all.rows.eliminate(k);
        }
        Some(all)
    }

    fn exchange(&mut self, i: usize, j: usize) {
        if i != j {
            self.order.swap(i, j);
            let (n, low, high) = (self.rows.width, i.min(j), i.max(j));
            for part in [&mut self.rows.re, &mut self.rows.im] {
                let (upper, lower) = part.split_at_mut(high * n);
                upper[low * n..(low + 1) * n].swap_with_slice(&mut lower[..n]);
            }
        }
    }

    /// Part of a row.
    fn part(&self, i: usize, of: std::ops::Range<usize>) -> Row<'_> {
        let (re, im) = self.rows.row(i);
        (&re[of.clone()], &im[of])
    }

    /// The solution for a right-hand side.
    pub fn solve(&self, b: &DVector<C64>) -> DVector<C64> {
        let n = self.order.len();
        let mut x_re: Vec<f64> = self.order.iter().map(|&i| b[i].re).collect();
        let mut x_im: Vec<f64> = self.order.iter().map(|&i| b[i].im).collect();
        for i in 1..n {
            let known = dot(self.part(i, 0..i), (&x_re[..i], &x_im[..i]));
            (x_re[i], x_im[i]) = (x_re[i] - known.re, x_im[i] - known.im);
        }
        for i in (0..n).rev() {
            let known = dot(self.part(i, i + 1..n), (&x_re[i + 1..], &x_im[i + 1..]));
            let value = (C64::new(x_re[i], x_im[i]) - known) / self.rows.at(i, i);
            (x_re[i], x_im[i]) = (value.re, value.im);
        }
        DVector::from_iterator(n, x_re.into_iter().zip(x_im).map(|(re, im)| C64::new(re, im)))
    }

    /// The solution of the adjoint system, `M^H x = b`.
    pub fn solve_adjoint(&self, b: &DVector<C64>) -> DVector<C64> {
        let n = self.order.len();
        // Conjugated, so that rows are as they stand: M^T conj(x) = conj(b), M = P^T L U.
        let (mut re, mut im): (Vec<f64>, Vec<f64>) = b.iter().map(|b| (b.re, -b.im)).unzip();
        for i in 0..n {
            let value = C64::new(re[i], im[i]) / self.rows.at(i, i);
            (re[i], im[i]) = (value.re, value.im);
            more(-value, self.part(i, i + 1..n), (&mut re[i + 1..], &mut im[i + 1..]));
        }
        for i in (1..n).rev() {
            let value = C64::new(re[i], im[i]);
            more(-value, self.part(i, 0..i), (&mut re[..i], &mut im[..i]));
        }
        let mut x = DVector::zeros(n);
        for (k, &was) in self.order.iter().enumerate() {
            x[was] = C64::new(re[k], -im[k]);
        }
        x
    }

    /// The inverse of the matrix.
    pub fn inverse(&self) -> Rows {
        let (n, width) = (self.order.len(), self.rows.width);
        let mut inverse = Rows::zeros(n, n);
        for (row, &was) in self.order.iter().enumerate() {
            inverse.re[row * width + was] = 1.0;
        }
        let shares = |i: usize, of: std::ops::Range<usize>| -> Vec<C64> {
            of.map(|k| -self.rows.at(i, k)).collect()
        };
        for i in 1..n {
            let (known_re, own_re) = inverse.re.split_at_mut(i * width);
            let (known_im, own_im) = inverse.im.split_at_mut(i * width);
            let own = (&mut own_re[..width], &mut own_im[..width]);
            add_rows(&shares(i, 0..i), (known_re, known_im), own);
        }
        for i in (0..n).rev() {
            let (before_re, known_re) = inverse.re.split_at_mut((i + 1) * width);
            let (before_im, known_im) = inverse.im.split_at_mut((i + 1) * width);
            let (own_re, own_im) = (&mut before_re[i * width..], &mut before_im[i * width..]);
            add_rows(&shares(i, i + 1..n), (known_re, known_im), (own_re, own_im));
            let pivot = self.rows.at(i, i).inv();
            for (x, y) in own_re.iter_mut().zip(own_im) {
                let value = C64::new(*x, *y) * pivot;
                (*x, *y) = (value.re, value.im);
            }
        }
        inverse
    }
}

impl Rows {
    /// The row from `k` on with the largest entry in column `k`, the last of them where some are equal.
    fn largest_below(&self, k: usize) -> usize {
        let (mut largest, mut row) = (0.0, k);
        for i in k..self.columns {
            let size = self.at(i, k).norm_sqr();
            if size >= largest {
                (largest, row) = (size, i);
            }
        }
        row
    }

    /// Takes row `k` of a square matrix off the rows below it, right of its panel with the last row of the panel; the
    /// multipliers stay in its column.
    pub fn eliminate(&mut self, k: usize) {
        let inverse = self.at(k, k).inv();
        take_off((&mut self.re, &mut self.im), self.width, k, inverse);
    }
}

/// Sum of the products of two rows.
fn dot((a_re, a_im): Row, (b_re, b_im): Row) -> C64 {
    let mut sums = [0.0; 4];
    for ((a, b), (x, y)) in a_re.iter().zip(a_im).zip(b_re.iter().zip(b_im)) {
        sums[0] += a * x;
        sums[1] += b * y;
        sums[2] += a * y;
        sums[3] += b * x;
    }
    C64::new(sums[0] - sums[1], sums[2] + sums[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_and_inverses_give_the_matrix_back() {
        // The first pivot is zero: rows have to be exchanged.
        let entry = |i: usize, j: usize| {
            let size = if i == j { 0.0 } else { 0.3 + 0.1 * ((i * 7 + j * 3) % 5) as f64 };
            C64::from_polar(size, (i + 2 * j) as f64)
        };
        let matrix = DMatrix::from_fn(6, 6, entry);
        let mut rows = Rows::zeros(6, 6);
        (0..36).for_each(|k| rows.set(k / 6, k % 6, entry(k / 6, k % 6)));
        assert_eq!(rows.dense(), matrix);
        let eliminated = Eliminated::of(rows.clone()).unwrap();
        let b = DVector::from_fn(6, |i, _| C64::new(i as f64, 1.0 - i as f64));
        assert!((&matrix * eliminated.solve(&b) - &b).norm() < 1e-12);
        assert!((matrix.adjoint() * eliminated.solve_adjoint(&b) - &b).norm() < 1e-12);
        let identity = DMatrix::from_diagonal_element(6, 6, C64::new(1.0, 0.0));
        assert!((&matrix * eliminated.inverse().dense() - &identity).norm() < 1e-12);
        let c = b.map(|b| b * C64::new(0.2, 0.9));
        assert!((rows.between(&c, &b) - c.dotc(&(&matrix * &b))).norm() < 1e-12);
        assert!(
            (rows.closed(0.5).dense() - (matrix * C64::new(0.5, 0.0) + identity)).norm() < 1e-12
        );
        assert!(Eliminated::of(Rows::zeros(3, 3)).is_none());
    }
}
