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
const VALUE_BUDGET: usize = 900_000;
/// Values of the map over time; fields are indices into the columns of `data`.
#[derive(Debug, Serialize)]
pub struct MapData {
    vertices: Vec<VertexData>,
    edges: Vec<EdgeData>,
    /// Times of the frames, s, base64 of 64-bit floats.
    times: String,
    /// Frame after frame the values of all columns, SI, base64 of 32-bit floats.
    data: String,
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
    let frame = |row: usize| columns.taken.iter().map(move |column| value(column, row) as f32);
    let data: Vec<f32> = rows.iter().flat_map(|&row| frame(row)).collect();
    let data = MapData {
        vertices,
        edges,
        times: escape::base64_f64(&times),
        data: escape::base64_f32(&data),
        columns: count,
    };
    Map { svg: drawing::svg(sites, &network.edges), data, frames: rows.len() }
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
        }
    }
}
