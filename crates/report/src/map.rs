//! The values that the network map shows over time.

use crate::decimate;
use crate::drawing;
use crate::escape;
use crate::lookup::{Lookup, value};
use crate::sites::{SiteGraph, Vertex};
use anergy_core::recorder::MapEdge;
use serde::Serialize;
use std::collections::BTreeMap;

/// Moments the slider offers.
const MAX_FRAMES: usize = 721;
const MIN_FRAMES: usize = 24;
/// Values embedded for the map at most.
const VALUE_BUDGET: usize = 2_000_000;
/// Values of the map over time; fields are indices into the columns of `data`.
#[derive(Debug, Serialize)]
pub struct MapData {
    vertices: Vec<VertexData>,
    edges: Vec<EdgeData>,
    /// Times of the frames, s, base64 of 64-bit floats.
    times: String,
    /// Frame after frame the values of all columns, base64 of 16-bit steps: SI = low + step * size; the largest
    /// step stands for no number.
    data: String,
    /// Least value of each column, SI, base64 of 64-bit floats.
    low: String,
    /// Size of a step of each column, SI, base64 of 64-bit floats.
    size: String,
    columns: usize,
}

#[derive(Debug, Serialize)]
struct VertexData {
    name: String,
    hot: Option<NodeData>,
    cold: Option<NodeData>,
    stations: Vec<StationData>,
}

#[derive(Debug, Serialize)]
struct NodeData {
    id: String,
    t: Option<usize>,
    p: Option<usize>,
}

#[derive(Debug, Serialize)]
struct StationData {
    id: String,
    flow: Option<usize>,
    requested: Option<usize>,
    heat: Option<usize>,
}

#[derive(Debug, Serialize)]
struct EdgeData {
    id: String,
    kind: String,
    length: f64,
    flow: Option<usize>,
    loss: Option<usize>,
    dp: Option<usize>,
    speed: Option<usize>,
    opening: Option<usize>,
    /// Temperature of the water in the edge at ports a and b.
    inside: [Option<usize>; 2],
    /// Temperature of the nodes at ports a and b.
    nodes: [Option<usize>; 2],
    /// Their pressures.
    pressures: [Option<usize>; 2],
    /// Cross-section of a pipe, m2; zero where it is not known.
    area: f64,
}

/// Drawing and data.
pub struct Map {
    /// The `<svg>` element.
    pub svg: String,
    /// For the script.
    pub data: MapData,
    /// Number of moments.
    pub frames: usize,
}

/// Draws the network and collects its values.
pub fn map(lookup: &Lookup, sites: &SiteGraph) -> Map {
    let mut columns = Columns { lookup, taken: Vec::new(), index: BTreeMap::new() };
    let network = &lookup.recording.header.map;
    let vertices = sites.vertices.iter().map(|vertex| columns.vertex(vertex)).collect();
    let edges = sites.lines.iter().map(|line| columns.edge(&network.edges[line.edge])).collect();
    let count = columns.taken.len();
    let max_frames = (VALUE_BUDGET / count.max(1)).clamp(MIN_FRAMES, MAX_FRAMES);
    let rows = decimate::frames(lookup.rows, max_frames);
    let times: Vec<f64> = rows.iter().map(|&row| lookup.times()[row]).collect();
    let scales: Vec<Scale> = columns.taken.iter().map(|column| Scale::of(column, &rows)).collect();
    let frame = |row: usize| {
        columns.taken.iter().zip(&scales).map(move |(column, scale)| scale.step(value(column, row)))
    };
    let data: Vec<u16> = rows.iter().flat_map(|&row| frame(row)).collect();
    let each = |number: fn(&Scale) -> f64| {
        escape::base64_f64(&scales.iter().map(number).collect::<Vec<f64>>())
    };
    let data = MapData {
        low: each(|scale| scale.low),
        size: each(|scale| scale.size),
        vertices,
        edges,
        times: escape::base64_f64(&times),
        data: escape::base64_u16(&data),
        columns: count,
    };
    Map { svg: drawing::svg(sites, &network.edges), data, frames: rows.len() }
}

/// The range of a column in 65 534 steps: a pressure of 10 bar to 15 Pa, temperatures to a millikelvin.
struct Scale {
    low: f64,
    size: f64,
}

impl Scale {
    const NO_NUMBER: u16 = u16::MAX;
    const STEPS: f64 = 65_534.0;

    fn of(column: &[f64], rows: &[usize]) -> Self {
        let finite = rows.iter().map(|&row| value(column, row)).filter(|value| value.is_finite());
        let (low, high) = finite
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        if low < high {
            // Half the range first: the whole one may be too large for a number.
            Self { low, size: (high / 2.0 - low / 2.0) / (Self::STEPS / 2.0) }
        } else {
            Self { low: if low.is_finite() { low } else { 0.0 }, size: 0.0 }
        }
    }

    fn step(&self, value: f64) -> u16 {
        if !value.is_finite() {
            Self::NO_NUMBER
        } else if self.size > 0.0 {
            ((value - self.low) / self.size).round().clamp(0.0, Self::STEPS) as u16
        } else {
            0
        }
    }
}

struct Columns<'a, 'b> {
    lookup: &'b Lookup<'a>,
    taken: Vec<&'a [f64]>,
    index: BTreeMap<(String, &'static str), usize>,
}

impl Columns<'_, '_> {
    fn take(&mut self, component: &str, quantity: &'static str) -> Option<usize> {
        let column = self.lookup.column(component, quantity)?;
        let taken = &mut self.taken;
        Some(*self.index.entry((component.to_owned(), quantity)).or_insert_with(|| {
            taken.push(column);
            taken.len() - 1
        }))
    }

    fn vertex(&mut self, vertex: &Vertex) -> VertexData {
        let mut node = |index: Option<usize>| {
            let id = self.lookup.recording.header.map.nodes.get(index?)?.id.clone();
            let (t, p) = (self.take(&id, "t_k"), self.take(&id, "p_pa"));
            Some(NodeData { id, t, p })
        };
        let (hot, cold) = (node(vertex.hot), node(vertex.cold));
        let mut station = |id: &String| StationData {
            id: id.clone(),
            flow: self.take(id, "m_flow_kg_s"),
            requested: self.take(id, "requested_m_flow_kg_s"),
            heat: self.take(id, "q_flow_w"),
        };
        let stations = vertex.stations.iter().map(&mut station).collect();
        VertexData { name: vertex.name.clone(), hot, cold, stations }
    }

    fn edge(&mut self, edge: &MapEdge) -> EdgeData {
        EdgeData {
            id: edge.id.clone(),
            kind: edge.kind.clone(),
            length: edge.length_m,
            flow: self.take(&edge.id, "m_flow_kg_s"),
            loss: self.take(&edge.id, "q_loss_w"),
            dp: self.take(&edge.id, "dp_pa"),
            speed: self.take(&edge.id, "speed"),
            opening: self.take(&edge.id, "opening"),
            inside: [self.take(&edge.id, "t_a_k"), self.take(&edge.id, "t_b_k")],
            nodes: [self.take(&edge.from, "t_k"), self.take(&edge.to, "t_k")],
            pressures: [self.take(&edge.from, "p_pa"), self.take(&edge.to, "p_pa")],
            area: std::f64::consts::FRAC_PI_4 * edge.inner_diameter_m.powi(2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_fine_and_keep_what_is_no_number() {
        let column = [-1.0, f64::NAN, 9.0, 0.123_456];
        let scale = Scale::of(&column, &[0, 1, 2, 3]);
        let shown = |value: f64| scale.low + f64::from(scale.step(value)) * scale.size;
        for value in [-1.0, 0.123_456, 9.0] {
            assert!((shown(value) - value).abs() <= 10.0 / 65_534.0 / 2.0 + 1e-12, "{value}");
        }
        assert_eq!(scale.step(f64::NAN), Scale::NO_NUMBER);
        let flat = Scale::of(&[5.0, 5.0], &[0, 1]);
        assert_eq!((flat.low, flat.step(5.0), flat.size), (5.0, 0, 0.0));
        let wide = Scale::of(&[-f64::MAX, f64::MAX], &[0, 1]);
        assert!(wide.size.is_finite() && wide.step(f64::MAX) > 65_000);
        assert_eq!(Scale::of(&[f64::NAN], &[0]).step(1.0), 0);
    }
}
