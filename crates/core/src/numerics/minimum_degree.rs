//! Order of elimination by least degree, and the pattern that it fills in, on the graph itself.
//!
//! **Method** the unknown with the fewest neighbours is taken out and its neighbours are joined with each
//! other, until none is left; its neighbours at that moment are its column of L, so that no second pass has to
//! find the pattern. Pipe networks are trees and chains for the most part, where this is a few instructions per
//! unknown. On meshes the joining grows like the work of a factorisation, where quotient graphs (AMD) do not:
//! given up there.
//!
//! **Sources** `davis2006` (chapter 7: minimum degree).

/// Neighbours looked at per unknown before the order is left to AMD.
const MOST_LOOKS: usize = 160;

/// An order of elimination with its columns.
pub(super) struct Order {
    /// Place of each unknown in the order.
    pub place: Vec<u32>,
    /// Start of the column of each place in `row`.
    pub start: Vec<u32>,
    /// Places below the diagonal, ascending in each column.
    pub row: Vec<u32>,
}

/// Neighbours of each unknown: a list with those that are gone, and the number of the others.
struct Graph {
    begin: Vec<u32>,
    end: Vec<u32>,
    room: Vec<u32>,
    degree: Vec<u32>,
    neighbours: Vec<u32>,
    gone: Vec<bool>,
    /// The list that each unknown was seen in last, as a running number.
    seen: Vec<u32>,
    lists: u32,
}

impl Graph {
    fn new(n: usize, pairs: impl Iterator<Item = (usize, usize)> + Clone) -> Self {
        let mut begin = vec![0_u32; n + 1];
        for (i, j) in pairs.clone() {
            begin[i + 1] += 1;
            begin[j + 1] += 1;
        }
        for i in 0..n {
            begin[i + 1] += begin[i];
        }
        let mut neighbours = Vec::with_capacity(2 * begin[n] as usize);
        neighbours.resize(begin[n] as usize, 0);
        let mut end = begin[..n].to_vec();
        for (i, j) in pairs {
            for (of, other) in [(i, j), (j, i)] {
                neighbours[end[of] as usize] = other as u32;
                end[of] += 1;
            }
        }
        let room = end.clone();
        let (degree, gone, seen) = (vec![0; n], vec![false; n], vec![0; n]);
        let mut graph = Self { begin, end, room, degree, neighbours, gone, seen, lists: 0 };
        for i in 0..n {
            graph.tidy(i);
            graph.degree[i] = graph.end[i] - graph.begin[i];
        }
        graph
    }

    /// Takes those that are gone, and the second of two that are the same, out of a list; marks the others.
    fn tidy(&mut self, of: usize) {
        self.lists += 1;
        let mut end = self.begin[of];
        for k in self.begin[of]..self.end[of] {
            let other = self.neighbours[k as usize];
            if !self.gone[other as usize] && self.seen[other as usize] != self.lists {
                self.seen[other as usize] = self.lists;
                self.neighbours[end as usize] = other;
                end += 1;
            }
        }
        self.end[of] = end;
    }

    fn push(&mut self, of: usize, other: u32) {
        if self.end[of] == self.room[of] {
            let (begin, end) = (self.begin[of] as usize, self.end[of] as usize);
            self.begin[of] = self.neighbours.len() as u32;
            self.neighbours.extend_from_within(begin..end);
            self.end[of] = self.neighbours.len() as u32;
            self.neighbours.resize(self.neighbours.len() + (end - begin) + 2, 0);
            self.room[of] = self.neighbours.len() as u32;
        }
        self.neighbours[self.end[of] as usize] = other;
        self.end[of] += 1;
    }

    /// Takes an unknown out and joins its neighbours. What this looked at.
    fn eliminate(&mut self, j: usize) -> usize {
        self.gone[j] = true;
        self.tidy(j);
        let column = self.begin[j] as usize..self.end[j] as usize;
        let mut looks = column.len();
        for at in column.clone() {
            let k = self.neighbours[at] as usize;
            self.degree[k] -= 1;
            if column.len() == 1 {
                continue;
            }
            looks += (self.end[k] - self.begin[k]) as usize + column.len();
            self.tidy(k);
            self.seen[k] = self.lists;
            for other in column.clone() {
                let other = self.neighbours[other];
                if self.seen[other as usize] != self.lists {
                    self.push(k, other);
                }
            }
            self.degree[k] = self.end[k] - self.begin[k];
        }
        looks
    }
}

/// Unknowns by degree, the first that got a degree first: those taken out one after another then are seldom
/// neighbours, and their divisions do not wait for each other.
struct Queue {
    /// For each degree the unknowns that had it at some time, and how many are dealt with.
    of_degree: Vec<(Vec<u32>, usize)>,
    lowest: usize,
}

impl Queue {
    fn push(&mut self, j: u32, degree: u32) {
        let degree = degree as usize;
        if degree >= self.of_degree.len() {
            self.of_degree.resize_with(degree + 1, Default::default);
        }
        self.of_degree[degree].0.push(j);
        self.lowest = self.lowest.min(degree);
    }

    fn pop(&mut self, graph: &Graph) -> Option<usize> {
        while let Some((unknowns, done)) = self.of_degree.get_mut(self.lowest) {
            let Some(&j) = unknowns.get(*done) else {
                self.lowest += 1;
                continue;
            };
            *done += 1;
            let j = j as usize;
            if !graph.gone[j] && graph.degree[j] as usize == self.lowest {
                return Some(j);
            }
        }
        None
    }
}

/// The order for `n` unknowns of which these are connected (either order, duplicates allowed, none with itself);
/// `None` where it would be found too slowly.
pub(super) fn order(
    n: usize,
    pairs: impl Iterator<Item = (usize, usize)> + Clone,
) -> Option<Order> {
    let mut graph = Graph::new(n, pairs);
    let mut queue = Queue { of_degree: Vec::new(), lowest: 0 };
    for (j, &degree) in graph.degree.iter().enumerate() {
        queue.push(j as u32, degree);
    }
    let (mut unknown, mut looks) = (Vec::with_capacity(n), 0);
    while let Some(j) = queue.pop(&graph) {
        let (begin, end) = (graph.begin[j] as usize, graph.end[j] as usize);
        debug_assert!(end >= begin);
        unknown.push(j);
        looks += graph.eliminate(j);
        if looks > MOST_LOOKS * n {
            return None;
        }
        for at in graph.begin[j]..graph.end[j] {
            let k = graph.neighbours[at as usize];
            queue.push(k, graph.degree[k as usize]);
        }
    }
    Some(columns(&graph, &unknown))
}

/// The columns of L in the order of these unknowns.
fn columns(graph: &Graph, unknown: &[usize]) -> Order {
    let mut place = vec![0_u32; unknown.len()];
    for (at, &j) in unknown.iter().enumerate() {
        place[j] = at as u32;
    }
    let entries = unknown.iter().map(|&j| (graph.end[j] - graph.begin[j]) as usize).sum();
    let (mut start, mut row) = (Vec::with_capacity(unknown.len() + 1), Vec::with_capacity(entries));
    start.push(0);
    for &j in unknown {
        let begin = row.len();
        let column = &graph.neighbours[graph.begin[j] as usize..graph.end[j] as usize];
        row.extend(column.iter().map(|&k| place[k as usize]));
        row[begin..].sort_unstable();
        start.push(row.len() as u32);
    }
    Order { place, start, row }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_with_a_branch_begins_with_the_branch() {
        // Ring 0-1-2-3, branch 3-4-5, one pair twice. 5 goes first, then 4, then three of the ring: the first
        // joins its neighbours, and L has 1 + 1 + 2 + 2 + 1 = 7 entries.
        let pairs = [(0, 1), (1, 2), (3, 2), (0, 3), (3, 4), (5, 4), (4, 5)];
        let Order { place, start, row } = order(6, pairs.into_iter()).unwrap();
        assert_eq!(place[5], 0);
        assert_eq!(row[0], place[4]);
        let lengths: Vec<u32> = start.windows(2).map(|ends| ends[1] - ends[0]).collect();
        assert_eq!(lengths.iter().sum::<u32>(), 7);
        let mut sorted = place.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, [0, 1, 2, 3, 4, 5]);
        // Below the diagonal, ascending.
        for j in 0..6 {
            let column = &row[start[j] as usize..start[j + 1] as usize];
            assert!(column.iter().all(|&i| i as usize > j));
            assert!(column.is_sorted_by(|a, b| a < b));
        }
    }

    #[test]
    fn stars_are_quick_and_meshes_are_left_alone() {
        // The hub of a star keeps its list of 1e5 leaves until the end.
        let star = order(100_001, (1..=100_000).map(|i| (0, i))).unwrap();
        assert_eq!(star.row.len(), 100_000);
        let complete = (0..800).flat_map(|i| (0..i).map(move |j| (i, j)));
        assert!(order(800, complete).is_none());
    }
}
