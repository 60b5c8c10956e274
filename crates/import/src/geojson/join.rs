//! Ends of lines become nodes.

use super::features::{Network, Point};
use super::place::{Earth, LonLat, Plane};
use crate::{ImportError, Note, NoteKind};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Tolerance at least: what is closer is the same place, m.
const SAME_M: f64 = 1e-3;
/// A given length that differs from the drawn one by more than this share and this many metres is told.
const ODD_SHARE: f64 = 0.05;
const ODD_M: f64 = 1.0;

/// Points of the plane by the squares they are in.
struct Grid {
    plane: Plane,
    reach_m: f64,
    squares: HashMap<[i64; 2], Vec<usize>>,
    places: Vec<([f64; 2], String)>,
}

impl Grid {
    fn square(&self, place: [f64; 2]) -> [i64; 2] {
        place.map(|metres| (metres / self.reach_m).floor() as i64)
    }

    fn add(&mut self, at: LonLat, id: &str) {
        let place = self.plane.metres(at);
        let square = self.square(place);
        self.squares.entry(square).or_default().push(self.places.len());
        self.places.push((place, id.to_owned()));
    }

    /// The nearest point within reach; of equal ones the first.
    fn nearest(&self, at: LonLat) -> Option<&str> {
        self.nearest_of(at, self.places.len())
    }

    /// The same among the first `count` points.
    fn nearest_of(&self, at: LonLat, count: usize) -> Option<&str> {
        let place = self.plane.metres(at);
        let [east, north] = self.square(place);
        let mut best: Option<(f64, usize)> = None;
        for square in (-1..=1).flat_map(|i| (-1..=1).map(move |j| [east + i, north + j])) {
            for &index in self.squares.get(&square).into_iter().flatten() {
                let other = self.places[index].0;
                let distance = (place[0] - other[0]).hypot(place[1] - other[1]);
                let better = best.is_none_or(|found| (distance, index) < found);
                if index < count && distance <= self.reach_m && better {
                    best = Some((distance, index));
                }
            }
        }
        best.map(|(_, index)| self.places[index].1.as_str())
    }
}

/// Gives every line its nodes and every pipe its length.
pub(super) fn join(
    network: &mut Network,
    snap_m: f64,
    notes: &mut Vec<Note>,
) -> Result<(), Vec<ImportError>> {
    let drawn = network.lines.iter().flat_map(|line| line.path.iter().copied());
    let places = network.points.iter().filter_map(|point| point.at).chain(drawn);
    let reach_m = snap_m.max(SAME_M);
    let plane = Plane::around(places);
    ends(network, plane, reach_m, notes)?;
    if let Some(plane) = plane {
        near_misses(network, plane, reach_m, notes);
    }
    lengths(network, notes)?;
    left_out(network, notes);
    parts(network, notes);
    Ok(())
}

/// The nodes at the ends of all lines; new ones where there are none.
fn ends(
    network: &mut Network,
    plane: Option<Plane>,
    reach_m: f64,
    notes: &mut Vec<Note>,
) -> Result<(), Vec<ImportError>> {
    let plane = plane.unwrap_or(Plane::at([0.0, 0.0]));
    let mut grid = Grid { plane, reach_m, squares: HashMap::new(), places: Vec::new() };
    let mut known: HashSet<String> = network.points.iter().map(|point| point.id.clone()).collect();
    for point in &network.points {
        if let Some(at) = point.at {
            grid.add(at, &point.id);
        }
    }
    let drawn = grid.places.len();
    let mut new = |id: String, at: Option<LonLat>, grid: &mut Grid| {
        if let Some(at) = at {
            grid.add(at, &id);
        }
        network.points.push(Point { id, at, fields: Vec::new() });
    };
    let (mut problems, mut number) = (Vec::new(), 0);
    // Names first: a name later in the file keeps its place from becoming another node.
    for named in [true, false] {
        for line in &mut network.lines {
            let places = [line.path.first().copied(), line.path.last().copied()];
            for (end, at) in line.ends.iter_mut().zip(places) {
                match (end.as_ref(), at) {
                    (Some(id), at) if named && known.insert(id.clone()) => {
                        if let Some(other) = at.and_then(|at| grid.nearest_of(at, drawn)) {
                            let text = format!(
                                "pipe \"{}\" names node \"{id}\", which no point is; it ends at point \"{other}\", to \
                                 which it is not connected: a slip of the name?",
                                line.id
                            );
                            notes.push(Note { kind: NoteKind::Problem, line: None, text });
                        }
                        new(id.clone(), at, &mut grid);
                    }
                    (None, Some(at)) if !named => {
                        *end = Some(match grid.nearest(at) {
                            Some(id) => id.to_owned(),
                            None => {
                                let id = loop {
                                    number += 1;
                                    let id = format!("node{number}");
                                    if known.insert(id.clone()) {
                                        break id;
                                    }
                                };
                                new(id.clone(), Some(at), &mut grid);
                                id
                            }
                        });
                    }
                    (None, None) if !named => {
                        let what = "has neither geometry nor `from` and `to`";
                        let message = format!("pipe \"{}\" {what}", line.id);
                        problems.push(ImportError::new(None, message));
                    }
                    _ => {}
                }
            }
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(problems) }
}

/// Every pipe gets a length: the given one, else the drawn one.
fn lengths(network: &mut Network, notes: &mut Vec<Note>) -> Result<(), Vec<ImportError>> {
    let earth = Earth::new();
    let (mut count, mut total_m, mut problems) = (0, 0.0, Vec::new());
    let (mut odd, mut most): (usize, Option<(f64, String)>) = (0, None);
    for line in network.lines.iter_mut().filter(|line| line.is_pipe()) {
        let drawn_m = earth.length_m(&line.path);
        match line.length_m {
            Some(given_m) => {
                let odd_m = (given_m - drawn_m).abs();
                if odd_m > (ODD_SHARE * given_m).max(ODD_M) && !line.path.is_empty() {
                    odd += 1;
                    if most.as_ref().is_none_or(|(largest_m, _)| odd_m > *largest_m) {
                        let text =
                            format!("\"{}\", {given_m} m given, {drawn_m:.1} m drawn", line.id);
                        most = Some((odd_m, text));
                    }
                }
            }
            None if drawn_m > 0.0 => {
                count += 1;
                total_m += drawn_m;
                line.length_m = Some(drawn_m);
            }
            None => {
                let what = "has no length: give `length_m`, or draw it";
                problems.push(ImportError::new(None, format!("pipe \"{}\" {what}", line.id)));
            }
        }
    }
    if let Some((_, most)) = most {
        let text = format!(
            "the lengths given are taken; {odd} differ by more than 5 % from the lines, most that of pipe {most}"
        );
        notes.push(Note { kind: NoteKind::Changed, line: None, text });
    }
    if count > 0 {
        let text = format!(
            "{count} pipes without `length_m` have the length of their lines (WGS84), {total_m:.1} m together"
        );
        notes.push(Note { kind: NoteKind::Changed, line: None, text });
    }
    if problems.is_empty() { Ok(()) } else { Err(problems) }
}

/// Lines that end where they begin, and points without lines.
fn left_out(network: &mut Network, notes: &mut Vec<Note>) {
    let mut note =
        |text: String| notes.push(Note { kind: NoteKind::NotTranslated, line: None, text });
    network.lines.retain(|line| {
        let closed = line.ends[0] == line.ends[1];
        if closed {
            let node = line.ends[0].as_deref().unwrap_or_default();
            note(format!("left out: \"{}\" begins and ends at node \"{node}\"", line.id));
        }
        !closed
    });
    let used: BTreeSet<&String> =
        network.lines.iter().flat_map(|line| line.ends.iter().flatten()).collect();
    let unused: Vec<String> = network
        .points
        .iter()
        .filter(|point| !used.contains(&point.id))
        .map(|point| point.id.clone())
        .collect();
    for id in &unused {
        note(format!("left out: no line ends at point \"{id}\""));
    }
    let unused: HashSet<String> = unused.into_iter().collect();
    network.points.retain(|point| !unused.contains(&point.id));
}

/// Ends that lie on another line without a node there: probably a junction that is not drawn as one.
fn near_misses(network: &Network, plane: Plane, reach_m: f64, notes: &mut Vec<Note>) {
    let mut degree: BTreeMap<&str, usize> = BTreeMap::new();
    for end in network.lines.iter().flat_map(|line| line.ends.iter().flatten()) {
        *degree.entry(end).or_insert(0) += 1;
    }
    let lines: Vec<Vec<[f64; 2]>> = network
        .lines
        .iter()
        .map(|line| line.path.iter().map(|place| plane.metres(*place)).collect())
        .collect();
    for (i, line) in network.lines.iter().enumerate() {
        for (end, place) in line.ends.iter().zip([lines[i].first(), lines[i].last()]) {
            let (Some(end), Some(place)) = (end, place) else { continue };
            if degree.get(end.as_str()) != Some(&1) {
                continue;
            }
            let touches = |path: &Vec<[f64; 2]>| {
                path.windows(2).any(|ends| distance(*place, ends[0], ends[1]) <= reach_m)
            };
            let other = (0..lines.len()).find(|&j| j != i && touches(&lines[j]));
            if let Some(j) = other {
                let text = format!(
                    "pipe \"{}\" ends on pipe \"{}\", which has no node there: they are not connected; split the \
                     other one",
                    line.id, network.lines[j].id
                );
                notes.push(Note { kind: NoteKind::Problem, line: None, text });
            }
        }
    }
}

/// Distance of a place from a straight piece, m.
fn distance(place: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let from_a = [place[0] - a[0], place[1] - a[1]];
    let share = if square > 0.0 {
        ((from_a[0] * along[0] + from_a[1] * along[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (from_a[0] - share * along[0]).hypot(from_a[1] - share * along[1])
}

/// Says when the lines are several networks.
fn parts(network: &Network, notes: &mut Vec<Note>) {
    let index: HashMap<&str, usize> =
        network.points.iter().enumerate().map(|(i, point)| (point.id.as_str(), i)).collect();
    let mut part: Vec<usize> = (0..network.points.len()).collect();
    fn root(part: &mut [usize], mut i: usize) -> usize {
        while part[i] != i {
            part[i] = part[part[i]];
            i = part[i];
        }
        i
    }
    for line in &network.lines {
        let [Some(a), Some(b)] = &line.ends else { continue };
        let (Some(&a), Some(&b)) = (index.get(a.as_str()), index.get(b.as_str())) else { continue };
        let (a, b) = (root(&mut part, a), root(&mut part, b));
        part[a.max(b)] = a.min(b);
    }
    let mut sizes: BTreeMap<usize, usize> = BTreeMap::new();
    for i in 0..part.len() {
        *sizes.entry(root(&mut part, i)).or_insert(0) += 1;
    }
    if sizes.len() > 1 {
        let smallest = sizes.iter().min_by_key(|(_, size)| **size).map_or(0, |(first, _)| *first);
        let text = format!(
            "the lines are {} networks that are not connected; the smallest has the node \"{}\": a larger --snap \
             joins ends that are farther apart",
            sizes.len(),
            network.points[smallest].id
        );
        notes.push(Note { kind: NoteKind::Problem, line: None, text });
    }
}
