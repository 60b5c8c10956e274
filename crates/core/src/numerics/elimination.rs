//! Elimination of the potentials of a conductance network as a recorded list of updates, for networks
//! that fill in little.
//!
//! **Equation** unknown j has the conductance `g_j` to what is given and `c_ij` to the others. Taking it
//! out leaves `d_j = g_j + sum c_ij`, `l_ij = c_ij/d_j`, and adds `l_ij c_kj` to the conductance between
//! i and k and `l_ij g_j` to that from i to what is given (star-mesh transformation).
//!
//! **Numerics** only positive numbers are added and multiplied, so that every conductance keeps its
//! relative precision over any number of decades; the same elimination on matrix entries cancels and
//! ends in a zero pivot behind a nearly closed valve. Where each update goes is found once and kept: a
//! factorisation is a walk through one list, on near-tree networks several times cheaper than finding
//! the pattern of each row again. On meshes the list grows with the work and a blocked method wins.
//!
//! **Sources** `davis2006` (chapter 4: elimination tree), `alfa2002` (elimination without subtraction).

/// The recorded list is not worth it when a column has more updates than this on average.
const MAX_UPDATES_PER_COLUMN: usize = 24;

/// A conductance network in its elimination order. Entries: the `n` conductances to what is given, then
/// those between unknowns, column by column of the strictly lower triangle.
#[derive(Debug, Clone)]
pub(super) struct Elimination {
    n: usize,
    /// Start of each column in `row`.
    start: Vec<u32>,
    /// Row of each entry below the diagonal.
    row: Vec<u32>,
    /// Entry that each update changes, in the order of the updates; `None` to look for it each time.
    target: Option<Vec<u32>>,
    value: Vec<f64>,
}

impl Elimination {
    /// Analyses the pattern of the entries `(i, j)`, given in the order of elimination (either triangle,
    /// duplicates and diagonal allowed).
    pub(super) fn analyze(n: usize, entries: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let entries = entries.filter(|(i, j)| i != j).map(|(i, j)| (i.max(j), i.min(j)));
        let mut row_start = vec![0_u32; n + 1];
        for (i, _) in entries.clone() {
            row_start[i as usize + 1] += 1;
        }
        accumulate(&mut row_start);
        let mut column = vec![0_u32; row_start[n] as usize];
        let mut next = row_start.clone();
        for (i, j) in entries {
            column[next[i as usize] as usize] = j;
            next[i as usize] += 1;
        }
        let columns = |i: usize| &column[row_start[i] as usize..row_start[i + 1] as usize];
        let parent = elimination_tree(n, columns);
        let mut start = vec![0_u32; n + 1];
        each_entry(n, columns, &parent, |j, _| start[j + 1] += 1);
        let updates: usize =
            start.iter().map(|&c| (c as usize * (c as usize).saturating_sub(1)) / 2).sum();
        accumulate(&mut start);
        let mut row = vec![0_u32; start[n] as usize];
        let mut next = start.clone();
        each_entry(n, columns, &parent, |j, i| {
            row[next[j] as usize] = i;
            next[j] += 1;
        });
        Self::of_columns(start, row, updates)
    }

    /// With the columns of L below the diagonal, the rows of each ascending, and the number of their updates.
    fn of_columns(start: Vec<u32>, row: Vec<u32>, updates: usize) -> Self {
        let n = start.len() - 1;
        let value = vec![0.0; n + row.len()];
        let mut analyzed = Self { n, start, row, target: None, value };
        if updates <= MAX_UPDATES_PER_COLUMN * n {
            let mut target = Vec::with_capacity(updates);
            for j in 0..n {
                analyzed.updates(j, |_, to| target.push(to as u32));
            }
            analyzed.target = Some(target);
        }
        analyzed
    }

    /// With an order whose columns are known.
    pub(super) fn in_order(start: Vec<u32>, row: Vec<u32>) -> Self {
        let lengths = start.windows(2).map(|ends| (ends[1] - ends[0]) as usize);
        let updates = lengths.map(|length| length * length.saturating_sub(1) / 2).sum();
        Self::of_columns(start, row, updates)
    }

    /// Whether the list of updates is short enough to be kept.
    pub(super) fn is_recorded(&self) -> bool {
        self.target.is_some()
    }

    /// Calls `update` with the place in the column and the entry it changes, for the entries of column j
    /// after each of its rows: those rows are rows of that row's column too, in the same order.
    fn updates(&self, j: usize, mut update: impl FnMut(usize, usize)) {
        let below = &self.row[self.start[j] as usize..self.start[j + 1] as usize];
        for (q, &k) in below.iter().enumerate() {
            let mut place = self.start[k as usize] as usize;
            for (p, &i) in below.iter().enumerate().skip(q + 1) {
                while self.row[place] != i {
                    place += 1;
                }
                update(p, self.n + place);
            }
        }
    }

    /// Where entry (i, j), `i >= j`, is kept.
    pub(super) fn slot(&self, i: usize, j: usize) -> Option<usize> {
        if i == j {
            return Some(i);
        }
        let (begin, end) = (self.start[j] as usize, self.start[j + 1] as usize);
        let column = &self.row[begin..end];
        column.binary_search(&(i as u32)).ok().map(|k| self.n + begin + k)
    }

    #[inline]
    pub(super) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.value
    }

    /// Eliminates in place: `1/d` for each unknown and L between them. False where an unknown is
    /// connected with nothing.
    pub(super) fn factor(&mut self) -> bool {
        let Self { n, start, row, target, value } = self;
        let (given, between) = value.split_at_mut(*n);
        let mut recorded = target.as_deref().unwrap_or_default().iter();
        for j in 0..*n {
            let (begin, end) = (start[j] as usize, start[j + 1] as usize);
            // Entries of later columns lie behind this one's.
            let (column, later) = between[begin..].split_at_mut(end - begin);
            let pivot = given[j] + column.iter().sum::<f64>();
            if !(pivot > 0.0 && pivot < f64::INFINITY) {
                return false;
            }
            let (inverse, given_j) = (1.0 / pivot, given[j]);
            let below = &row[begin..end];
            for (q, &k) in below.iter().enumerate() {
                let share = column[q] * inverse;
                given[k as usize] += share * given_j;
                if target.is_some() {
                    for (c, &to) in column[q + 1..].iter().zip(&mut recorded) {
                        later[to as usize - (*n + end)] += share * c;
                    }
                } else {
                    let mut place = start[k as usize] as usize;
                    for (c, &i) in column[q + 1..].iter().zip(&below[q + 1..]) {
                        while row[place] != i {
                            place += 1;
                        }
                        later[place - end] += share * c;
                    }
                }
                column[q] = share;
            }
            given[j] = inverse;
        }
        true
    }

    /// Solves with the last factorisation, right-hand side in, solution out.
    pub(super) fn solve_in_place(&self, x: &mut [f64]) {
        let (inverse, below) = self.value.split_at(self.n);
        let column = |j: usize| self.start[j] as usize..self.start[j + 1] as usize;
        for j in 0..self.n {
            let xj = x[j];
            // What is put in at a few places does not reach all.
            if xj == 0.0 {
                continue;
            }
            for (&i, l) in self.row[column(j)].iter().zip(&below[column(j)]) {
                x[i as usize] += l * xj;
            }
        }
        for j in (0..self.n).rev() {
            let mut xj = x[j] * inverse[j];
            for (&i, l) in self.row[column(j)].iter().zip(&below[column(j)]) {
                xj += l * x[i as usize];
            }
            x[j] = xj;
        }
    }
}

/// Turns counts, kept one place later, into starts.
fn accumulate(counts: &mut [u32]) {
    for i in 1..counts.len() {
        counts[i] += counts[i - 1];
    }
}

/// Parent of each column: the row of its first entry below the diagonal of L; `u32::MAX` for a root.
fn elimination_tree<'a>(n: usize, columns: impl Fn(usize) -> &'a [u32]) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
    for i in 0..n {
        for &j in columns(i) {
            let mut k = j;
            while k != NONE && k < i as u32 {
                let above = std::mem::replace(&mut ancestor[k as usize], i as u32);
                if above == NONE {
                    parent[k as usize] = i as u32;
                }
                k = above;
            }
        }
    }
    parent
}

/// Visits the entries (column, row) of L below the diagonal, row by row: those of row i lie on the ways
/// up the tree from the entries of the matrix to i.
fn each_entry<'a>(
    n: usize,
    columns: impl Fn(usize) -> &'a [u32],
    parent: &[u32],
    mut visit: impl FnMut(usize, u32),
) {
    let mut seen: Vec<u32> = (0..n as u32).collect();
    for i in 0..n {
        for &j in columns(i) {
            let mut k = j as usize;
            while seen[k] != i as u32 {
                seen[k] = i as u32;
                visit(k, i as u32);
                k = parent[k] as usize;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrow_and_chain() {
        // Unknown 0 has 2 to what is given and 1 to each of 1 and 2, which have 2: eliminating it joins
        // them. Inflow at x = [1, 2, 3]: [4 - 2 - 3, -1 + 6, -1 + 9] = [-1, 5, 8]
        let mut solver = Elimination::analyze(3, [(0, 2), (1, 0)].into_iter());
        for (i, j, value) in [(0, 0, 2.0), (1, 1, 2.0), (2, 2, 2.0), (1, 0, 1.0), (2, 0, 1.0)] {
            let slot = solver.slot(i, j).unwrap();
            solver.values_mut()[slot] = value;
        }
        assert!(solver.slot(2, 1).is_some());
        assert!(solver.factor());
        let mut x = [-1.0, 5.0, 8.0];
        solver.solve_in_place(&mut x);
        for (x, expected) in x.iter().zip([1.0, 2.0, 3.0]) {
            assert!((x - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn conductances_of_thirty_decades_keep_their_digits() {
        // Given - 1e-20 - 0 - 1e9 - 1 - 1e10 - 2, 1 kg/s into 2: x0 = 1e20, x1 = x0 + 1e-9, ...; the
        // differences drown in x0, but the inflow must come out of the weak conductance alone.
        let mut solver = Elimination::analyze(3, [(0, 1), (1, 2)].into_iter());
        for (i, j, value) in [(0, 0, 1e-20), (1, 0, 1e9), (2, 1, 1e10)] {
            let slot = solver.slot(i, j).unwrap();
            solver.values_mut()[slot] = value;
        }
        assert!(solver.factor());
        let mut x = [0.0, 0.0, 1.0];
        solver.solve_in_place(&mut x);
        assert!(x.iter().all(|x| (x / 1e20 - 1.0).abs() < 1e-14), "{x:?}");
    }

    #[test]
    fn without_a_list_the_result_is_the_same() {
        // All of 60 connected with conductance 1, the first to the given potential 0: 1 kg/s into the
        // last: x_0 = 1, and between two of a complete graph the resistance is 2/60.
        let entries = (0..60).flat_map(|j| (0..j).map(move |i| (i, j)));
        let mut solver = Elimination::analyze(60, entries);
        assert!(!solver.is_recorded());
        solver.values_mut().fill(1.0);
        solver.values_mut()[1..60].fill(0.0);
        assert!(solver.factor());
        let mut x = [0.0; 60];
        x[59] = 1.0;
        solver.solve_in_place(&mut x);
        assert!((x[0] - 1.0).abs() < 1e-14 && (x[59] - 1.0 - 2.0 / 60.0).abs() < 1e-14, "{x:?}");
    }
}
