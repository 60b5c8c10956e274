//! Dense complex systems: elimination with exchanges, real and imaginary parts apart, so that the inner loops are
//! those of plain numbers along rows.

use nalgebra::{Complex, DMatrix, DVector};

type C64 = Complex<f64>;

/// A square matrix, eliminated.
pub(super) struct Eliminated {
    n: usize,
    /// Row by row: multipliers below the diagonal, what is left from it on.
    re: Vec<f64>,
    im: Vec<f64>,
    /// Which row of the matrix each row was.
    order: Vec<usize>,
}

impl Eliminated {
    /// Eliminates a matrix; `None` where it is singular or not a number.
    pub fn of(matrix: &DMatrix<C64>) -> Option<Self> {
        let n = matrix.nrows();
        let (re, im) = rows(matrix);
        let mut all = Self { n, re, im, order: (0..n).collect() };
        for k in 0..n {
            let sizes = (k..n).map(|i| (all.at(i, k).norm_sqr(), i));
            let (size, pivot) = sizes.max_by(|a, b| a.0.total_cmp(&b.0))?;
            if !(size > 0.0 && size.is_finite()) {
                return None;
            }
            all.exchange(k, pivot);
            all.eliminate(k);
        }
        Some(all)
    }

    fn at(&self, i: usize, j: usize) -> C64 {
        C64::new(self.re[i * self.n + j], self.im[i * self.n + j])
    }

    fn exchange(&mut self, i: usize, j: usize) {
        if i != j {
            self.order.swap(i, j);
            let (n, low, high) = (self.n, i.min(j), i.max(j));
            for part in [&mut self.re, &mut self.im] {
                let (upper, lower) = part.split_at_mut(high * n);
                upper[low * n..(low + 1) * n].swap_with_slice(&mut lower[..n]);
            }
        }
    }

    /// Takes row `k` off the rows below it.
    fn eliminate(&mut self, k: usize) {
        let n = self.n;
        let inverse = self.at(k, k).inv();
        let (upper_re, lower_re) = self.re.split_at_mut((k + 1) * n);
        let (upper_im, lower_im) = self.im.split_at_mut((k + 1) * n);
        let (row_re, row_im) = (&upper_re[k * n + k + 1..], &upper_im[k * n + k + 1..]);
        for (re, im) in lower_re.chunks_exact_mut(n).zip(lower_im.chunks_exact_mut(n)) {
            let share = C64::new(re[k], im[k]) * inverse;
            (re[k], im[k]) = (share.re, share.im);
            less(share, (row_re, row_im), (&mut re[k + 1..], &mut im[k + 1..]));
        }
    }

    /// The solution for a right-hand side.
    pub fn solve(&self, b: &DVector<C64>) -> DVector<C64> {
        let n = self.n;
        let mut x_re: Vec<f64> = self.order.iter().map(|&i| b[i].re).collect();
        let mut x_im: Vec<f64> = self.order.iter().map(|&i| b[i].im).collect();
        let row = |i: usize, of: std::ops::Range<usize>| {
            let of = i * n + of.start..i * n + of.end;
            (&self.re[of.clone()], &self.im[of])
        };
        for i in 1..n {
            let known = dot(row(i, 0..i), (&x_re[..i], &x_im[..i]));
            (x_re[i], x_im[i]) = (x_re[i] - known.re, x_im[i] - known.im);
        }
        for i in (0..n).rev() {
            let known = dot(row(i, i + 1..n), (&x_re[i + 1..], &x_im[i + 1..]));
            let value = (C64::new(x_re[i], x_im[i]) - known) / self.at(i, i);
            (x_re[i], x_im[i]) = (value.re, value.im);
        }
        DVector::from_iterator(n, x_re.into_iter().zip(x_im).map(|(re, im)| C64::new(re, im)))
    }

    /// The inverse of the matrix.
    pub fn inverse(&self) -> DMatrix<C64> {
        let n = self.n;
        let (mut re, mut im) = (vec![0.0; n * n], vec![0.0; n * n]);
        for (row, &was) in self.order.iter().enumerate() {
            re[row * n + was] = 1.0;
        }
        for i in 1..n {
            let (known_re, own_re) = re.split_at_mut(i * n);
            let (known_im, own_im) = im.split_at_mut(i * n);
            for (k, row) in known_re.chunks_exact(n).zip(known_im.chunks_exact(n)).enumerate() {
                less(self.at(i, k), row, (&mut own_re[..n], &mut own_im[..n]));
            }
        }
        for i in (0..n).rev() {
            let (before_re, known_re) = re.split_at_mut((i + 1) * n);
            let (before_im, known_im) = im.split_at_mut((i + 1) * n);
            let (own_re, own_im) = (&mut before_re[i * n..], &mut before_im[i * n..]);
            for (k, row) in known_re.chunks_exact(n).zip(known_im.chunks_exact(n)).enumerate() {
                less(self.at(i, i + 1 + k), row, (own_re, own_im));
            }
            let pivot = self.at(i, i).inv();
            for (x, y) in own_re.iter_mut().zip(own_im) {
                let value = C64::new(*x, *y) * pivot;
                (*x, *y) = (value.re, value.im);
            }
        }
        DMatrix::from_fn(n, n, |i, j| C64::new(re[i * n + j], im[i * n + j]))
    }
}

/// Real and imaginary parts of a matrix, row by row.
pub(super) fn rows(matrix: &DMatrix<C64>) -> (Vec<f64>, Vec<f64>) {
    let n = matrix.nrows();
    let (mut re, mut im) = (vec![0.0; n * n], vec![0.0; n * n]);
    for (j, column) in matrix.column_iter().enumerate() {
        for (i, entry) in column.iter().enumerate() {
            (re[i * n + j], im[i * n + j]) = (entry.re, entry.im);
        }
    }
    (re, im)
}

/// Sum of the products of two rows.
fn dot((a_re, a_im): (&[f64], &[f64]), (b_re, b_im): (&[f64], &[f64])) -> C64 {
    let mut sums = [0.0; 4];
    for ((a, b), (x, y)) in a_re.iter().zip(a_im).zip(b_re.iter().zip(b_im)) {
        sums[0] += a * x;
        sums[1] += b * y;
        sums[2] += a * y;
        sums[3] += b * x;
    }
    C64::new(sums[0] - sums[1], sums[2] + sums[3])
}

/// `own -= share other`.
fn less(share: C64, (other_re, other_im): (&[f64], &[f64]), own: (&mut [f64], &mut [f64])) {
    for ((x, y), (a, b)) in own.0.iter_mut().zip(own.1).zip(other_re.iter().zip(other_im)) {
        *x -= share.re * a - share.im * b;
        *y -= share.re * b + share.im * a;
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
        let eliminated = Eliminated::of(&matrix).unwrap();
        let b = DVector::from_fn(6, |i, _| C64::new(i as f64, 1.0 - i as f64));
        assert!((&matrix * eliminated.solve(&b) - b).norm() < 1e-12);
        let identity = DMatrix::from_diagonal_element(6, 6, C64::new(1.0, 0.0));
        assert!((&matrix * eliminated.inverse() - identity).norm() < 1e-12);
        assert!(Eliminated::of(&DMatrix::zeros(3, 3)).is_none());
    }
}
