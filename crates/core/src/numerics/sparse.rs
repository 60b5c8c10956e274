//! Sparse direct solvers on faer: symbolic analysis once, numeric refactorisation in place.
//!
//! [`ConductanceSolver`] solves the nodal equations of the hydraulics (recorded elimination where there is
//! little fill-in, Cholesky by faer where there is much), [`SparseLu`] the node temperatures of thermally
//! closed loops (unsymmetric). Neither allocates after its analysis. This is the only file that knows
//! faer.

use super::elimination::Elimination;
use super::minimum_degree::{self, Order};
use crate::error::FactorError;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::{SupernodalThreshold, amd, cholesky, lu};
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

    /// All entries as (row, column, value).
    fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        (0..self.n).flat_map(move |j| {
            (self.start[j] as usize..self.start[j + 1] as usize)
                .map(move |k| (self.row[k] as usize, j, self.value[k]))
        })
    }

    /// Writes the matrix of these conductances, in the same pattern with the diagonal first in each
    /// column.
    fn laplacian(&self, matrix: &mut Self) {
        matrix.value.copy_from_slice(&self.value);
        for j in 0..self.n {
            for k in self.start[j] as usize + 1..self.start[j + 1] as usize {
                matrix.value[k] = -self.value[k];
                matrix.value[self.start[j] as usize] += self.value[k];
                matrix.value[self.start[self.row[k] as usize] as usize] += self.value[k];
            }
        }
    }

    fn symbolic(&self) -> SymbolicSparseColMatRef<'_, u32> {
        SymbolicSparseColMatRef::new_checked(self.n, self.n, &self.start, None, &self.row)
    }

    fn matrix(&self) -> SparseColMatRef<'_, u32, f64> {
        SparseColMatRef::new(self.symbolic(), &self.value)
    }
}

/// Potentials of a network of conductances between unknowns and to given potentials (weighted graph
/// Laplacian, symmetric positive definite).
pub struct ConductanceSolver {
    n: usize,
    method: Method,
}

/// How the potentials are found.
enum Method {
    /// By recorded updates, where there is little fill-in.
    Recorded(Ordered),
    /// By blocked factorisation, where there is much.
    Blocked(Box<Blocked>),
}

/// Elimination in an order of its own.
struct Ordered {
    elimination: Elimination,
    /// Place of each unknown in the order of elimination; empty where they are counted in that order.
    place: Vec<u32>,
    work: Vec<f64>,
}

impl Ordered {
    fn slot(&self, i: usize, j: usize) -> Option<usize> {
        let place = |i: usize| self.place.get(i).map_or(i, |&place| place as usize);
        let (i, j) = (place(i), place(j));
        self.elimination.slot(i.max(j), i.min(j))
    }

    fn solve_in_place(&mut self, x: &mut [f64]) {
        if self.place.is_empty() {
            return self.elimination.solve_in_place(x);
        }
        for (&place, &x) in self.place.iter().zip(&*x) {
            self.work[place as usize] = x;
        }
        self.elimination.solve_in_place(&mut self.work);
        for (&place, x) in self.place.iter().zip(x) {
            *x = self.work[place as usize];
        }
    }
}

/// Cholesky factorisation by faer, and an elimination for what it cannot factorise.
struct Blocked {
    /// Conductances; the diagonal holds those to given potentials.
    lower: Columns,
    /// The matrix of them.
    matrix: Columns,
    symbolic: cholesky::SymbolicCholesky<u32>,
    factor: Vec<f64>,
    scratch: MemBuffer,
    /// For conductances that are too many decades apart.
    careful: Ordered,
    /// Whether the last factorisation is the careful one.
    use_careful: bool,
}

impl Blocked {
    fn factor(&mut self) -> bool {
        self.lower.laplacian(&mut self.matrix);
        let done = self.symbolic.factorize_numeric_llt(
            &mut self.factor,
            self.matrix.matrix(),
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut self.scratch),
            Default::default(),
        );
        self.use_careful = done.is_err();
        if !self.use_careful {
            return true;
        }
        self.careful.elimination.values_mut().fill(0.0);
        for (i, j, value) in self.lower.entries() {
            if let Some(slot) = self.careful.slot(i, j) {
                self.careful.elimination.values_mut()[slot] = value;
            }
        }
        self.careful.elimination.factor()
    }

    fn solve_in_place(&mut self, x: &mut [f64]) {
        if self.use_careful {
            return self.careful.solve_in_place(x);
        }
        let n = x.len();
        cholesky::LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }
}

impl ConductanceSolver {
    /// Analyses the pattern of `n` unknowns: the diagonal and the given off-diagonal pairs (either
    /// triangle, duplicates allowed).
    ///
    /// # Errors
    /// [`FactorError::Symbolic`] when the ordering fails.
    pub fn analyze(n: usize, pairs: &[(usize, usize)]) -> Result<Self, FactorError> {
        let between = pairs.iter().copied().filter(|(i, j)| i != j);
        if let Some(Order { place, start, row }) = minimum_degree::order(n, between) {
            let elimination = Elimination::in_order(start, row);
            if elimination.is_recorded() {
                let ordered = Ordered { elimination, place, work: vec![0.0; n] };
                return Ok(Self { n, method: Method::Recorded(ordered) });
            }
        }
        Self::analyze_mesh(n, pairs)
    }

    /// The same with the order of AMD.
    fn analyze_mesh(n: usize, pairs: &[(usize, usize)]) -> Result<Self, FactorError> {
        let failed = FactorError::Symbolic { unknowns: n };
        let lower = Columns::new(n, pairs.iter().map(|&(i, j)| (i.max(j), i.min(j))));
        let (mut forward, mut place) = (vec![0_u32; n], vec![0_u32; n]);
        let scratch = amd::order_maybe_unsorted_scratch::<u32>(n, lower.row.len());
        amd::order_maybe_unsorted(
            &mut forward,
            &mut place,
            lower.symbolic(),
            amd::Control::default(),
            MemStack::new(&mut MemBuffer::new(scratch)),
        )
        .map_err(|_| failed)?;
        let elimination = Elimination::analyze(n, pairs.iter().map(|&(i, j)| (place[i], place[j])));
        let recorded = elimination.is_recorded();
        let ordered = Ordered { elimination, place, work: vec![0.0; n] };
        if recorded {
            return Ok(Self { n, method: Method::Recorded(ordered) });
        }
        let diagonal = (0..n).map(|i| (i, i));
        let lower =
            Columns::new(n, diagonal.chain(pairs.iter().map(|&(i, j)| (i.max(j), i.min(j)))));
        let symbolic = cholesky::factorize_symbolic_cholesky(
            lower.symbolic(),
            Side::Lower,
            cholesky::SymmetricOrdering::Custom(PermRef::new_checked(&forward, &ordered.place, n)),
            cholesky::CholeskySymbolicParams::default(),
        )
        .map_err(|_| failed)?;
        let scratch = MemBuffer::new(
            symbolic
                .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default())
                .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq)),
        );
        let blocked = Blocked {
            matrix: lower.clone(),
            lower,
            factor: vec![0.0; symbolic.len_val()],
            symbolic,
            scratch,
            careful: ordered,
            use_careful: false,
        };
        Ok(Self { n, method: Method::Blocked(Box::new(blocked)) })
    }

    /// From now on counts the unknowns in the order of elimination, which saves to put them there and back in every
    /// solution: the new number of each; none where the numbers stay.
    pub fn count_in_order(&mut self) -> Vec<u32> {
        match &mut self.method {
            Method::Recorded(ordered) => std::mem::take(&mut ordered.place),
            Method::Blocked(_) => Vec::new(),
        }
    }

    /// Where the conductance between i and j is kept in [`Self::values_mut`], for `i = j` that to given
    /// potentials; `None` outside the pattern.
    pub fn slot(&self, i: usize, j: usize) -> Option<usize> {
        match &self.method {
            Method::Recorded(ordered) => ordered.slot(i, j),
            Method::Blocked(blocked) => blocked.lower.slot(i.max(j), i.min(j)),
        }
    }

    /// The conductances, all to be set before [`Self::factor`], which may overwrite them.
    #[inline]
    pub fn values_mut(&mut self) -> &mut [f64] {
        match &mut self.method {
            Method::Recorded(ordered) => ordered.elimination.values_mut(),
            Method::Blocked(blocked) => &mut blocked.lower.value,
        }
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.n
    }

    /// Whether there is nothing to solve.
    pub fn is_empty(&self) -> bool {
        self.n == 0
    }

    /// Factorises for the present conductances (not negative).
    ///
    /// # Errors
    /// [`FactorError::Singular`] when a part has no conductance to a given potential.
    pub fn factor(&mut self) -> Result<(), FactorError> {
        let done = match &mut self.method {
            Method::Recorded(ordered) => ordered.elimination.factor(),
            Method::Blocked(blocked) => blocked.factor(),
        };
        if done { Ok(()) } else { Err(FactorError::Singular { unknowns: self.n }) }
    }

    /// Solves with the last factorisation: right-hand side in, solution out.
    pub fn solve_in_place(&mut self, x: &mut [f64]) {
        match &mut self.method {
            Method::Recorded(ordered) => ordered.solve_in_place(x),
            Method::Blocked(blocked) => blocked.solve_in_place(x),
        }
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
    fn potentials_of_a_chain() {
        // Conductances 1-2: 2, 2-3: 3, 1 to given 0: 1. Unit inflow at 3 leaves there:
        // p1 = 1/1, p2 = p1 + 1/2, p3 = p2 + 1/3.
        let mut solver = ConductanceSolver::analyze(3, &[(0, 1), (2, 1)]).unwrap();
        for round in 1..=2 {
            solver.values_mut().fill(0.0);
            for (i, j, value) in [(0, 0, 1.0), (0, 1, 2.0), (1, 2, 3.0)] {
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
        solver.values_mut().fill(0.0);
        assert_eq!(solver.factor(), Err(FactorError::Singular { unknowns: 3 }));
    }

    #[test]
    fn recorded_and_blocked_elimination_agree_with_the_balance() {
        // A chain fills in little, a 30 x 30 grid much; both: inflows of the potentials sin i.
        let grid = |i: usize, j: usize| 30 * i + j;
        let mut grid_pairs = Vec::new();
        for i in 0..30 {
            for j in 0..30 {
                grid_pairs.extend((i > 0).then(|| (grid(i, j), grid(i - 1, j))));
                grid_pairs.extend((j > 0).then(|| (grid(i, j), grid(i, j - 1))));
            }
        }
        let chain_pairs: Vec<_> = (1..900).map(|i| (i - 1, i)).collect();
        for (pairs, recorded) in [(chain_pairs, true), (grid_pairs, false)] {
            let mut solver = ConductanceSolver::analyze(900, &pairs).unwrap();
            assert_eq!(matches!(solver.method, Method::Recorded(_)), recorded);
            let x: Vec<f64> = (0..900).map(|i| f64::from(i).sin()).collect();
            let mut inflow: Vec<f64> = x.iter().map(|x| 1e-3 * x).collect();
            for i in 0..900 {
                let slot = solver.slot(i, i).unwrap();
                solver.values_mut()[slot] = 1e-3;
            }
            for (k, &(i, j)) in pairs.iter().enumerate() {
                let conductance = 1.0 + (k % 7) as f64;
                let slot = solver.slot(i, j).unwrap();
                solver.values_mut()[slot] += conductance;
                inflow[i] += conductance * (x[i] - x[j]);
                inflow[j] += conductance * (x[j] - x[i]);
            }
            solver.factor().unwrap();
            solver.solve_in_place(&mut inflow);
            let worst = x.iter().zip(&inflow).map(|(x, b)| (x - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-10, "{worst}");
        }
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
