//! Where the sites are drawn when the model gives no coordinates.
//!
//! Small graphs: stress majorization on shortest-path distances (Gansner, Koren, North 2004), so that
//! distances on paper are in proportion to lengths of pipe. Large graphs: a radial tree with edges in
//! proportion. Both are deterministic.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Above this number of vertices in a component a radial tree is drawn.
const STRESS_LIMIT: usize = 300;
/// Sweeps of stress majorization at most.
const MAX_SWEEPS: usize = 600;
/// Largest move of a vertex in a sweep at which the layout counts as settled, of its extent.
const SETTLED: f64 = 1e-5;

/// A point of the drawing plane.
pub type Point = [f64; 2];

/// An undirected connection of two vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// One end.
    pub from: usize,
    /// The other end.
    pub to: usize,
    /// Length, m; what has no length > 0 is drawn with a usual one.
    pub length: f64,
}

/// Positions of `count` vertices: the long axis horizontal, the first vertex of each component left,
/// separate components side by side.
pub fn positions(count: usize, links: &[Link]) -> Vec<Point> {
    let links = drawable(count, links);
    let neighbours = adjacency(count, &links);
    let mut placed = vec![[0.0, 0.0]; count];
    let mut seen = vec![false; count];
    let mut left_edge = 0.0;
    let mean = links.iter().map(|link| link.length).sum::<f64>() / links.len().max(1) as f64;
    let gap = if mean > 0.0 { mean } else { 1.0 };
    for start in 0..count {
        if seen[start] {
            continue;
        }
        let members = component(start, &neighbours, &mut seen);
        let local = place_component(&members, &neighbours);
        let min_x = local.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
        let max_x = local.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
        for (&vertex, point) in members.iter().zip(&local) {
            placed[vertex] = [point[0] - min_x + left_edge, point[1]];
        }
        left_edge += max_x - min_x + gap;
    }
    placed
}

/// Links with lengths that can be drawn: what has none gets a usual one, and very short ones are drawn
/// longer than they are, for symbols need room.
fn drawable(count: usize, links: &[Link]) -> Vec<Link> {
    let real = |length: f64| length.is_finite() && length > 0.0;
    let mut known: Vec<f64> = links.iter().map(|link| link.length).filter(|l| real(*l)).collect();
    known.sort_by(f64::total_cmp);
    let usual = known.get(known.len() / 2).copied().unwrap_or(1.0);
    let complete = links.iter().map(|link| Link {
        length: if real(link.length) { link.length } else { 0.7 * usual },
        ..*link
    });
    let mut links: Vec<Link> = complete.collect();
    if let Some(first) = links.first() {
        let neighbours = adjacency(count, &links);
        let reach = |from: usize| {
            let (mut distance, _) = shortest(from, &neighbours);
            distance.iter_mut().filter(|d| d.is_infinite()).for_each(|d| *d = 0.0);
            distance
        };
        let end = farthest(&reach(first.from));
        let diameter = reach(end).into_iter().fold(0.0, f64::max);
        let least = diameter / (8.0 + count as f64 / 4.0);
        links.iter_mut().for_each(|link| link.length = link.length.max(least));
    }
    links
}

/// Neighbours of each vertex with the distance to them.
fn adjacency(count: usize, links: &[Link]) -> Vec<Vec<(usize, f64)>> {
    let mut neighbours = vec![Vec::new(); count];
    for link in links {
        neighbours[link.from].push((link.to, link.length));
        neighbours[link.to].push((link.from, link.length));
    }
    neighbours
}

/// Vertices connected with `start`, ascending.
fn component(start: usize, neighbours: &[Vec<(usize, f64)>], seen: &mut [bool]) -> Vec<usize> {
    let mut members = vec![start];
    seen[start] = true;
    let mut next = 0;
    while next < members.len() {
        for &(other, _) in &neighbours[members[next]] {
            if !seen[other] {
                seen[other] = true;
                members.push(other);
            }
        }
        next += 1;
    }
    members.sort_unstable();
    members
}

fn place_component(members: &[usize], neighbours: &[Vec<(usize, f64)>]) -> Vec<Point> {
    let local: Vec<Vec<(usize, f64)>> = members
        .iter()
        .map(|&vertex| {
            let inside = |&(other, length): &(usize, f64)| {
                members.binary_search(&other).ok().map(|other| (other, length))
            };
            neighbours[vertex].iter().filter_map(inside).collect()
        })
        .collect();
    let mut points = radial_tree(&local);
    if members.len() <= STRESS_LIMIT {
        points = least_stress(&local, points);
    }
    turn(&mut points);
    points
}

/// Shortest distance of every vertex from `start` and the vertex before it.
fn shortest(start: usize, neighbours: &[Vec<(usize, f64)>]) -> (Vec<f64>, Vec<usize>) {
    #[derive(PartialEq)]
    struct Candidate(f64, usize);
    impl Eq for Candidate {}
    impl Ord for Candidate {
        fn cmp(&self, other: &Self) -> Ordering {
            other.0.total_cmp(&self.0).then(other.1.cmp(&self.1))
        }
    }
    impl PartialOrd for Candidate {
        fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
            Some(self.cmp(other))
        }
    }
    let mut distance = vec![f64::INFINITY; neighbours.len()];
    let mut before = vec![start; neighbours.len()];
    let mut queue = BinaryHeap::from([Candidate(0.0, start)]);
    distance[start] = 0.0;
    while let Some(Candidate(reached, vertex)) = queue.pop() {
        if reached > distance[vertex] {
            continue;
        }
        for &(other, length) in &neighbours[vertex] {
            if reached + length < distance[other] {
                distance[other] = reached + length;
                before[other] = vertex;
                queue.push(Candidate(reached + length, other));
            }
        }
    }
    (distance, before)
}

fn farthest(distance: &[f64]) -> usize {
    (0..distance.len())
        .max_by(|&a, &b| distance[a].total_cmp(&distance[b]).then(b.cmp(&a)))
        .unwrap_or(0)
}

/// Shortest-path tree around the middle of the graph (equal-angle layout, Felsenstein 2004): every edge
/// has its length and points into the middle of its sector, sectors are in proportion to the number of
/// leaves, so that edges of the tree never cross.
fn radial_tree(neighbours: &[Vec<(usize, f64)>]) -> Vec<Point> {
    let count = neighbours.len();
    let end = farthest(&shortest(0, neighbours).0);
    let (distance, before) = shortest(end, neighbours);
    let diameter = distance.iter().copied().fold(0.0, f64::max);
    let mut root = farthest(&distance);
    while root != end && distance[root] > diameter / 2.0 {
        root = before[root];
    }
    let (distance, before) = shortest(root, neighbours);
    let mut outward: Vec<usize> = (0..count).collect();
    outward.sort_by(|&a, &b| distance[a].total_cmp(&distance[b]).then(a.cmp(&b)));
    let mut children = vec![Vec::new(); count];
    for &vertex in outward.iter().skip(1) {
        children[before[vertex]].push(vertex);
    }
    let mut leaves = vec![0.0_f64; count];
    for &vertex in outward.iter().rev() {
        leaves[vertex] = children[vertex].iter().map(|&child| leaves[child]).sum::<f64>().max(1.0);
    }
    let mut sector = vec![(0.0, std::f64::consts::TAU); count];
    let mut points = vec![[0.0, 0.0]; count];
    for &vertex in &outward {
        let (mut from, to) = sector[vertex];
        let width = (to - from) / leaves[vertex];
        for &child in &children[vertex] {
            let wide = width * leaves[child];
            let middle = from + wide / 2.0;
            let length = distance[child] - distance[vertex];
            points[child] = [
                points[vertex][0] + length * middle.cos(),
                points[vertex][1] + length * middle.sin(),
            ];
            sector[child] = (from, from + wide);
            from += wide;
        }
    }
    points
}

/// The better of two starts: the tree as it is keeps a chain straight, a slightly disturbed one lets a
/// ring open that starts as a line.
fn least_stress(neighbours: &[Vec<(usize, f64)>], start: Vec<Point>) -> Vec<Point> {
    let wanted: Vec<Vec<f64>> =
        (0..start.len()).map(|vertex| shortest(vertex, neighbours).0).collect();
    let extent = wanted.iter().flatten().copied().fold(0.0, f64::max);
    let disturbed = start.iter().enumerate().map(|(i, point)| {
        let shift = |k: f64| 0.02 * extent * (((i as f64 + 1.0) * k).fract() - 0.5);
        [point[0] + shift(0.618_033_988_749_895), point[1] + shift(0.754_877_666_246_693)]
    });
    let mut disturbed: Vec<Point> = disturbed.collect();
    let mut straight = start;
    majorize(&wanted, extent, &mut straight);
    majorize(&wanted, extent, &mut disturbed);
    if stress(&wanted, &straight) <= stress(&wanted, &disturbed) { straight } else { disturbed }
}

/// Sum of squared relative differences to the wanted distances.
fn stress(wanted: &[Vec<f64>], points: &[Point]) -> f64 {
    let mut sum = 0.0;
    for (i, row) in wanted.iter().enumerate() {
        for (j, &distance) in row.iter().enumerate().take(i) {
            let drawn = (points[i][0] - points[j][0]).hypot(points[i][1] - points[j][1]);
            sum += (drawn / distance - 1.0).powi(2);
        }
    }
    sum
}

/// Moves every vertex in turn to where the weighted differences to the wanted distances are least.
fn majorize(wanted: &[Vec<f64>], extent: f64, points: &mut [Point]) {
    for _ in 0..MAX_SWEEPS {
        let mut moved: f64 = 0.0;
        for i in 0..points.len() {
            let here = points[i];
            let (mut sum, mut weights) = ([0.0, 0.0], 0.0);
            for (there, &distance) in points.iter().zip(&wanted[i]) {
                if distance <= 0.0 {
                    continue;
                }
                let weight = 1.0 / (distance * distance);
                let (dx, dy) = (here[0] - there[0], here[1] - there[1]);
                let stretch = distance / dx.hypot(dy).max(1e-9 * extent);
                sum[0] += weight * (there[0] + stretch * dx);
                sum[1] += weight * (there[1] + stretch * dy);
                weights += weight;
            }
            if weights > 0.0 {
                points[i] = [sum[0] / weights, sum[1] / weights];
                moved = moved.max((points[i][0] - here[0]).hypot(points[i][1] - here[1]));
            }
        }
        if moved < SETTLED * extent {
            break;
        }
    }
}

/// Turns the long axis horizontal, the first vertex to the left, the most distant one from it upwards.
fn turn(points: &mut [Point]) {
    let count = points.len().max(1) as f64;
    let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / count;
    let centre = [mean(0), mean(1)];
    let moment = |a: usize, b: usize| {
        points.iter().map(|p| (p[a] - centre[a]) * (p[b] - centre[b])).sum::<f64>()
    };
    let angle = 0.5 * (2.0 * moment(0, 1)).atan2(moment(0, 0) - moment(1, 1));
    let (sin, cos) = angle.sin_cos();
    for point in points.iter_mut() {
        let (dx, dy) = (point[0] - centre[0], point[1] - centre[1]);
        *point = [cos * dx + sin * dy, cos * dy - sin * dx];
    }
    let flip_x = if points.first().is_some_and(|p| p[0] > 0.0) { -1.0 } else { 1.0 };
    let lowest_first =
        points.iter().map(|p| p[1]).fold(0.0_f64, |a, b| if b.abs() > a.abs() { b } else { a });
    let flip_y = if lowest_first > 0.0 { -1.0 } else { 1.0 };
    for point in points.iter_mut() {
        *point = [flip_x * point[0], flip_y * point[1]];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain(lengths: &[f64]) -> Vec<Link> {
        lengths.iter().enumerate().map(|(i, &length)| Link { from: i, to: i + 1, length }).collect()
    }

    fn distance(a: Point, b: Point) -> f64 {
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    #[test]
    fn a_chain_is_straight_and_in_proportion() {
        let lengths = [200.0, 50.0, 120.0, 80.0];
        let points = positions(5, &chain(&lengths));
        for (i, length) in lengths.iter().enumerate() {
            assert!((distance(points[i], points[i + 1]) / length - 1.0).abs() < 0.01, "{points:?}");
            assert!(points[i][0] < points[i + 1][0], "from left to right: {points:?}");
        }
        assert!(points.iter().all(|p| p[1].abs() < 0.01 * 450.0), "{points:?}");
    }

    #[test]
    fn lengths_that_cannot_be_drawn_become_usual() {
        let links = drawable(4, &chain(&[100.0, 0.0, f64::NAN]));
        assert_eq!(links.iter().map(|link| link.length).collect::<Vec<_>>(), [100.0, 70.0, 70.0]);
        // 300 m long: nothing is drawn shorter than 300 / (8 + 3 / 4) = 34.3 m.
        let links = drawable(3, &chain(&[299.0, 1.0]));
        assert!((links[1].length - 34.3).abs() < 0.1);
    }

    #[test]
    fn a_ring_opens() {
        let links: Vec<Link> =
            (0..20).map(|i| Link { from: i, to: (i + 1) % 20, length: 10.0 }).collect();
        let points = positions(20, &links);
        // A regular polygon of 20 sides of 10 m has a circumradius of 10 / (2 sin(9 deg)) = 31.96 m.
        // Path distances bend outward, so the ring becomes somewhat larger.
        for point in &points {
            let radius = distance(*point, [36.0, 0.0]);
            assert!(radius > 20.0 && radius < 55.0, "{points:?}");
        }
    }

    #[test]
    fn large_trees_are_radial_and_finite() {
        let links: Vec<Link> = (1..1000)
            .map(|i| Link { from: (i - 1) / 3, to: i, length: 10.0 + (i % 7) as f64 })
            .collect();
        let points = positions(1000, &links);
        for link in &links {
            let drawn = distance(points[link.from], points[link.to]);
            assert!((drawn / link.length - 1.0).abs() < 1e-9);
        }
        assert!(points.iter().flatten().all(|value| value.is_finite()));
        assert_eq!(points, positions(1000, &links));
    }

    #[test]
    fn separate_parts_do_not_overlap() {
        let mut links = chain(&[10.0, 10.0]);
        links.push(Link { from: 3, to: 4, length: 10.0 });
        let points = positions(6, &links);
        assert!(points[..3].iter().all(|p| p[0] < points[3][0]));
        assert!(points[4][0] < points[5][0]);
        assert!(positions(0, &[]).is_empty());
        assert!(positions(1, &[])[0].iter().all(|value| value.is_finite()));
    }
}
