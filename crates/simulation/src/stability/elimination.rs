//! Dense complex matrices, real and imaginary parts apart, so that the inner loops are those of plain numbers along
//! rows; their elimination with exchanges.
//!
//! **Numerics** the inner loops are compiled for the vectors of the processor too (`pulp`), which changes no digit: each
//! number is worked out by the same operations.

use nalgebra::{Complex, DMatrix, DVector};
use pulp::Arch;

type C64 = Complex<f64>;

/// A part of a row, or a row: real and imaginary parts.
type Row<'a> = (&'a [f64], &'a [f64]);
type RowMut<'a> = (&'a mut [f64], &'a mut [f64]);

/// A matrix, row by row.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    columns: usize,
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Rows {
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { columns, re: vec![0.0; rows * columns], im: vec![0.0; rows * columns] }
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.re.len().checked_div(self.columns).unwrap_or(0)
    }

    pub fn at(&self, i: usize, j: usize) -> C64 {
        C64::new(self.re[i * self.columns + j], self.im[i * self.columns + j])
    }

    pub fn set(&mut self, i: usize, j: usize, value: C64) {
        (self.re[i * self.columns + j], self.im[i * self.columns + j]) = (value.re, value.im);
    }

    pub fn row(&self, i: usize) -> Row<'_> {
        let of = i * self.columns..(i + 1) * self.columns;
        (&self.re[of.clone()], &self.im[of])
    }

    pub fn row_mut(&mut self, i: usize) -> RowMut<'_> {
        let of = i * self.columns..(i + 1) * self.columns;
        (&mut self.re[of.clone()], &mut self.im[of])
    }

    /// `1 + factor M` of a square matrix.
    pub fn closed(mut self, factor: f64) -> Self {
        let n = self.columns;
        self.re.iter_mut().chain(&mut self.im).for_each(|x| *x *= factor);
        self.re.iter_mut().step_by(n + 1).for_each(|x| *x += 1.0);
        self
    }

    /// `left^H M right`.
    pub fn between(&self, left: &DVector<C64>, right: &DVector<C64>) -> C64 {
        let n = self.columns;
        let (mut re, mut im) = (vec![0.0; n], vec![0.0; n]);
        Arch::new().dispatch(|| {
            for (i, share) in left.iter().enumerate() {
                more(share.conj(), self.row(i), (&mut re, &mut im));
            }
        });
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
            let sizes = (k..n).map(|i| (all.rows.at(i, k).norm_sqr(), i));
            let (size, pivot) = sizes.max_by(|a, b| a.0.total_cmp(&b.0))?;
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
            let (n, low, high) = (self.order.len(), i.min(j), i.max(j));
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
        let n = self.order.len();
        let mut inverse = Rows::zeros(n, n);
        for (row, &was) in self.order.iter().enumerate() {
            inverse.re[row * n + was] = 1.0;
        }
        for i in 1..n {
            let (known_re, own_re) = inverse.re.split_at_mut(i * n);
            let (known_im, own_im) = inverse.im.split_at_mut(i * n);
            for (k, row) in known_re.chunks_exact(n).zip(known_im.chunks_exact(n)).enumerate() {
                more(-self.rows.at(i, k), row, (&mut own_re[..n], &mut own_im[..n]));
            }
        }
        for i in (0..n).rev() {
            let (before_re, known_re) = inverse.re.split_at_mut((i + 1) * n);
            let (before_im, known_im) = inverse.im.split_at_mut((i + 1) * n);
            let (own_re, own_im) = (&mut before_re[i * n..], &mut before_im[i * n..]);
            for (k, row) in known_re.chunks_exact(n).zip(known_im.chunks_exact(n)).enumerate() {
                more(-self.rows.at(i, i + 1 + k), row, (own_re, own_im));
            }
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
    /// Takes row `k` of a square matrix off the rows below it; the multipliers stay in its column.
    pub fn eliminate(&mut self, k: usize) {
        let n = self.columns;
        let inverse = self.at(k, k).inv();
        let (upper_re, lower_re) = self.re.split_at_mut((k + 1) * n);
        let (upper_im, lower_im) = self.im.split_at_mut((k + 1) * n);
        let row = (&upper_re[k * n + k + 1..], &upper_im[k * n + k + 1..]);
        Arch::new().dispatch(|| {
            for (re, im) in lower_re.chunks_exact_mut(n).zip(lower_im.chunks_exact_mut(n)) {
                let share = C64::new(re[k], im[k]) * inverse;
                (re[k], im[k]) = (share.re, share.im);
                more(-share, row, (&mut re[k + 1..], &mut im[k + 1..]));
            }
        });
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

/// `own += share other`.
#[inline]
pub(super) fn more(share: C64, (other_re, other_im): Row, own: RowMut) {
    for ((x, y), (a, b)) in own.0.iter_mut().zip(own.1).zip(other_re.iter().zip(other_im)) {
        *x += share.re * a - share.im * b;
        *y += share.re * b + share.im * a;
    }
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
