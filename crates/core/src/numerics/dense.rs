//! A small dense system of equations in memory of its own: nothing is allocated while it is solved.
//!
//! **Numerics** Gaussian elimination with partial pivoting. Rows are scaled by their largest entry for the
//! choice of the pivot, so that quantities of different units can stand in one system.

/// A square system with room for a largest number of unknowns.
#[derive(Debug, Clone, Default)]
pub struct DenseSystem {
    unknowns: usize,
    /// Row by row; after the factorisation the factors.
    matrix: Vec<f64>,
    scale: Vec<f64>,
    /// Row that each column took its pivot from.
    pivot: Vec<usize>,
}

impl DenseSystem {
    /// Room for `most` unknowns.
    pub fn with_room(most: usize) -> Self {
        Self {
            unknowns: 0,
            matrix: vec![0.0; most * most],
            scale: vec![0.0; most],
            pivot: vec![0; most],
        }
    }

    /// Begins a system of `unknowns` with a matrix of zeros; allocates beyond the room only.
    pub fn begin(&mut self, unknowns: usize) {
        self.unknowns = unknowns;
        self.matrix.clear();
        self.matrix.resize(unknowns * unknowns, 0.0);
        self.scale.clear();
        self.scale.resize(unknowns, 0.0);
        self.pivot.clear();
        self.pivot.resize(unknowns, 0);
    }

    /// Sets an entry.
    #[inline]
    pub fn set(&mut self, row: usize, column: usize, value: f64) {
        self.matrix[row * self.unknowns + column] = value;
    }

    /// Replaces the right-hand side by the solution and the matrix by its factors. False, with a right-hand
    /// side without meaning, where the matrix is singular or not finite.
    #[must_use]
    pub fn solve(&mut self, rhs: &mut [f64]) -> bool {
        self.factor() && self.solve_factored(rhs)
    }

    /// Replaces the matrix by its factors; false where it is singular or not finite.
    #[must_use]
    pub fn factor(&mut self) -> bool {
        let n = self.unknowns;
        for (scale, row) in self.scale.iter_mut().zip(self.matrix.chunks_exact(n.max(1))) {
            *scale = row.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        }
        for column in 0..n {
            let size = |row: usize| self.matrix[row * n + column].abs() / self.scale[row];
            let mut pivot = column;
            for row in column + 1..n {
                if size(row) > size(pivot) {
                    pivot = row;
                }
            }
            let found = size(pivot);
            if !found.is_finite() || found <= f64::EPSILON {
                return false;
            }
            self.pivot[column] = pivot;
            if pivot != column {
                let (above, below) = self.matrix.split_at_mut(pivot * n);
                above[column * n..(column + 1) * n].swap_with_slice(&mut below[..n]);
                self.scale.swap(pivot, column);
            }
            let (above, below) = self.matrix.split_at_mut((column + 1) * n);
            let pivot_row = &above[column * n..];
            for row in below.chunks_exact_mut(n) {
                let factor = row[column] / pivot_row[column];
                row[column] = factor;
                if factor == 0.0 {
                    continue;
                }
                for (entry, pivot) in row[column + 1..].iter_mut().zip(&pivot_row[column + 1..]) {
                    *entry -= factor * pivot;
                }
            }
        }
        true
    }

    /// Solves with the factors: right-hand side in, solution out; false where it is not finite.
    #[must_use]
    pub fn solve_factored(&self, rhs: &mut [f64]) -> bool {
        let n = self.unknowns;
        // The rows were exchanged as a whole, with the factors they had so far.
        for column in 0..n {
            rhs.swap(self.pivot[column], column);
        }
        for column in 0..n {
            let pivot_rhs = rhs[column];
            for (row, value) in rhs.iter_mut().enumerate().take(n).skip(column + 1) {
                let factor = self.matrix[row * n + column];
                if factor != 0.0 {
                    *value -= factor * pivot_rhs;
                }
            }
        }
        for row in (0..n).rev() {
            let entries = &self.matrix[row * n..(row + 1) * n];
            let known: f64 =
                entries[row + 1..].iter().zip(&rhs[row + 1..n]).map(|(a, x)| a * x).sum();
            rhs[row] = (rhs[row] - known) / entries[row];
        }
        rhs[..n].iter().all(|x| x.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solve(rows: &[&[f64]], rhs: &[f64]) -> Option<Vec<f64>> {
        let mut system = DenseSystem::with_room(4);
        system.begin(rows.len());
        for (i, row) in rows.iter().enumerate() {
            for (k, entry) in row.iter().enumerate() {
                system.set(i, k, *entry);
            }
        }
        let mut rhs = rhs.to_vec();
        let (mut again, solved) = (rhs.clone(), system.solve(&mut rhs));
        if solved {
            // The factors stay.
            assert!(system.solve_factored(&mut again));
            assert_eq!(again, rhs);
        }
        solved.then_some(rhs)
    }

    #[test]
    fn solves_what_has_a_solution() {
        // By hand: x = 1, y = -2, z = 3. The first pivot is zero.
        let rows: [&[f64]; 3] = [&[0.0, 2.0, 1.0], &[1.0, 1.0, 1.0], &[4.0, 0.0, -1.0]];
        let x = solve(&rows, &[-1.0, 2.0, 1.0]).unwrap();
        for (x, wanted) in x.iter().zip([1.0, -2.0, 3.0]) {
            assert!((x - wanted).abs() < 1e-15, "{x}");
        }
        // Rows in units far apart: a row times 1e12 changes nothing.
        let rows: [&[f64]; 2] = [&[1e-6, 1.0], &[1e12, 1e12]];
        let x = solve(&rows, &[1.0, 2e12]).unwrap();
        assert!((x[0] - 1.000_001).abs() < 1e-9 && (x[1] - 0.999_999).abs() < 1e-9, "{x:?}");
        assert_eq!(solve(&[&[1.0, 2.0], &[2.0, 4.0]], &[1.0, 1.0]), None);
        assert_eq!(solve(&[&[0.0]], &[1.0]), None);
        assert_eq!(solve(&[&[f64::NAN]], &[1.0]), None);
        assert_eq!(solve(&[], &[]), Some(vec![]));
    }
}
