//! Sparse direct solvers on faer: symbolic analysis once, numeric refactorisation in place.
//!
//! [`SparseCholesky`] solves the nodal equations of the hydraulics (symmetric positive definite),
//! [`SparseLu`] the node temperatures of thermally closed loops (unsymmetric). Neither allocates
//! after its analysis. This is the only file that knows faer.

use crate::error::FactorError;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::{SupernodalThreshold, cholesky, lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// Compressed columns of a square matrix with a fixed pattern.
#[derive(Debug, Clone)]
struct Columns {
    n: usize,
    start: Vec<u32>,
    row: Vec<u32>,
    value: Vec<f64>,
}

impl Columns {
    /// Pattern with the given entries `(row, column)`; duplicates are one entry.
    fn new(n: usize, entries: impl Iterator<Item = (usize, usize)>) -> Self {
        let mut sorted: Vec<(u32, u32)> = entries.map(|(i, j)| (j as u32, i as u32)).collect();
        sorted.sort_unstable();
        sorted.dedup();
        let mut start = vec![0_u32; n + 1];
        for &(column, _) in &sorted {
            start[column as usize + 1] += 1;
        }
        for j in 0..n {
            start[j + 1] += start[j];
        }
        let row: Vec<u32> = sorted.iter().map(|&(_, i)| i).collect();
        let value = vec![0.0; row.len()];
        Self { n, start, row, value }
    }

    fn slot(&self, i: usize, j: usize) -> Option<usize> {
        let (begin, end) = (self.start[j] as usize, self.start[j + 1] as usize);
        self.row[begin..end].binary_search(&(i as u32)).ok().map(|k| begin + k)
    }

    fn symbolic(&self) -> SymbolicSparseColMatRef<'_, u32> {
        SymbolicSparseColMatRef::new_checked(self.n, self.n, &self.start, None, &self.row)
    }

    fn matrix(&self) -> SparseColMatRef<'_, u32, f64> {
        SparseColMatRef::new(self.symbolic(), &self.value)
    }
}

/// Cholesky factorisation of a sparse symmetric positive definite matrix.
pub struct SparseCholesky {
    lower: Columns,
    symbolic: cholesky::SymbolicCholesky<u32>,
    factor: Vec<f64>,
    scratch: MemBuffer,
}

impl SparseCholesky {
    /// Analyses the pattern of `n` unknowns: the diagonal and the given off-diagonal pairs (either
    /// triangle, duplicates allowed).
    ///
    /// # Errors
    /// [`FactorError::Symbolic`] when the ordering fails.
    pub fn analyze(n: usize, pairs: &[(usize, usize)]) -> Result<Self, FactorError> {
        let diagonal = (0..n).map(|i| (i, i));
        let lower =
            Columns::new(n, diagonal.chain(pairs.iter().map(|&(i, j)| (i.max(j), i.min(j)))));
        let symbolic = cholesky::factorize_symbolic_cholesky(
            lower.symbolic(),
            Side::Lower,
            cholesky::SymmetricOrdering::Amd,
            cholesky::CholeskySymbolicParams::default(),
        )
        .map_err(|_| FactorError::Symbolic { unknowns: n })?;
        let scratch = MemBuffer::new(
            symbolic
                .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default())
                .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq)),
        );
        let factor = vec![0.0; symbolic.len_val()];
        Ok(Self { lower, symbolic, factor, scratch })
    }

    /// Where entry (i, j) is kept in [`Self::values_mut`]; `None` outside the pattern.
    pub fn slot(&self, i: usize, j: usize) -> Option<usize> {
        self.lower.slot(i.max(j), i.min(j))
    }

    /// The stored entries of the lower triangle, to be set before [`Self::factor`].
    #[inline]
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.lower.value
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.lower.n
    }

    /// Whether there is nothing to solve.
    pub fn is_empty(&self) -> bool {
        self.lower.n == 0
    }

    /// Factorises the present values.
    ///
    /// # Errors
    /// [`FactorError::Singular`] when the matrix is not positive definite.
    pub fn factor(&mut self) -> Result<(), FactorError> {
        if self.is_empty() {
            return Ok(());
        }
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                self.lower.matrix(),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut self.scratch),
                Default::default(),
            )
            .map(|_| ())
            .map_err(|_| FactorError::Singular { unknowns: self.lower.n })
    }

    /// Solves with the last factorisation: right-hand side in, solution out.
    pub fn solve_in_place(&mut self, x: &mut [f64]) {
        if self.is_empty() {
            return;
        }
        let n = self.lower.n;
        cholesky::LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }
}

/// LU factorisation of a sparse unsymmetric matrix.
pub struct SparseLu {
    matrix: Columns,
    symbolic: lu::SymbolicLu<u32>,
    numeric: lu::NumericLu<u32, f64>,
    scratch: MemBuffer,
}

impl SparseLu {
    /// Analyses the pattern of `n` unknowns: the diagonal and the given entries (row, column).
    ///
    /// # Errors
    /// [`FactorError::Symbolic`] when the ordering fails.
    pub fn analyze(n: usize, entries: &[(usize, usize)]) -> Result<Self, FactorError> {
        let matrix = Columns::new(n, (0..n).map(|i| (i, i)).chain(entries.iter().copied()));
        // The simplicial path refactorises without allocation.
        let params = lu::LuSymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
            ..Default::default()
        };
        let symbolic = lu::factorize_symbolic_lu(matrix.symbolic(), params)
            .map_err(|_| FactorError::Symbolic { unknowns: n })?;
        let scratch = MemBuffer::new(
            symbolic
                .factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default())
                .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq)),
        );
        Ok(Self { matrix, symbolic, numeric: lu::NumericLu::new(), scratch })
    }

    /// Where entry (row, column) is kept in [`Self::values_mut`]; `None` outside the pattern.
    pub fn slot(&self, i: usize, j: usize) -> Option<usize> {
        self.matrix.slot(i, j)
    }

    /// The stored entries, to be set before [`Self::solve_in_place`].
    #[inline]
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.matrix.value
    }

    /// Factorises the present values and solves: right-hand side in, solution out.
    ///
    /// # Errors
    /// [`FactorError::Singular`] when the matrix is singular.
    pub fn solve_in_place(&mut self, x: &mut [f64]) -> Result<(), FactorError> {
        let n = self.matrix.n;
        if n == 0 {
            return Ok(());
        }
        let stack = MemStack::new(&mut self.scratch);
        self.symbolic
            .factorize_numeric_lu(
                &mut self.numeric,
                self.matrix.matrix(),
                Par::Seq,
                stack,
                Default::default(),
            )
            .map_err(|_| FactorError::Singular { unknowns: n })?
            .solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(x, n, 1),
                Par::Seq,
                stack,
            );
        // faer reports no numerically singular matrix; NaN does.
        if x.iter().all(|value| value.is_finite()) {
            Ok(())
        } else {
            Err(FactorError::Singular { unknowns: n })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cholesky_of_a_chain() {
        // Conductances 1-2: 2, 2-3: 3, ground at 1: 1. Unit inflow at 3 leaves at ground:
        // p1 = 1/1, p2 = p1 + 1/2, p3 = p2 + 1/3.
        let mut solver = SparseCholesky::analyze(3, &[(0, 1), (2, 1)]).unwrap();
        let entries = [(0, 0, 3.0), (1, 1, 5.0), (2, 2, 3.0), (0, 1, -2.0), (1, 2, -3.0)];
        for round in 1..=2 {
            for (i, j, value) in entries {
                let slot = solver.slot(i, j).unwrap();
                solver.values_mut()[slot] = value * f64::from(round);
            }
            solver.factor().unwrap();
            let mut x = [0.0, 0.0, f64::from(round)];
            solver.solve_in_place(&mut x);
            for (x, expected) in x.iter().zip([1.0, 1.5, 1.5 + 1.0 / 3.0]) {
                assert!((x - expected).abs() < 1e-14);
            }
        }
        assert_eq!(solver.slot(0, 2), None);
        for value in solver.values_mut() {
            *value = 0.0;
        }
        assert_eq!(solver.factor(), Err(FactorError::Singular { unknowns: 3 }));
    }

    #[test]
    fn lu_of_a_small_system() {
        // [2 1; 0 4] x = [4, 8] -> x = [1, 2]
        let mut solver = SparseLu::analyze(2, &[(0, 1), (1, 0)]).unwrap();
        for (i, j, value) in [(0, 0, 2.0), (0, 1, 1.0), (1, 0, 0.0), (1, 1, 4.0)] {
            let slot = solver.slot(i, j).unwrap();
            solver.values_mut()[slot] = value;
        }
        let mut x = [4.0, 8.0];
        solver.solve_in_place(&mut x).unwrap();
        assert!((x[0] - 1.0).abs() < 1e-15 && (x[1] - 2.0).abs() < 1e-15);
        let slot = solver.slot(1, 1).unwrap();
        solver.values_mut()[slot] = 0.0;
        assert_eq!(solver.solve_in_place(&mut x), Err(FactorError::Singular { unknowns: 2 }));
    }
}
