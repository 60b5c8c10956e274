//! The network at the level of the map: sites and plain nodes, and the lines between them.

use crate::layout::{self, Link, Point};
use crate::lookup::Lookup;
use anergy_core::recorder::{ChannelGroup, MapNode, NetworkMap};
use std::collections::{BTreeMap, BTreeSet};

/// The side of a pair of lines: hot is drawn on one side, cold on the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// Between hot nodes of sites.
    Hot,
    /// Neither.
    Plain,
    /// Between cold nodes of sites.
    Cold,
}

impl Side {
    fn of_node(id: &str) -> Self {
        match id.rsplit_once('.') {
            Some((_, "hot")) => Self::Hot,
            Some((_, "cold")) => Self::Cold,
            _ => Self::Plain,
        }
    }
}

/// One symbol of the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Vertex {
    /// Name of the site or the plain node.
    pub name: String,
    /// Index of its hot node, or of its only node, in the map.
    pub hot: Option<usize>,
    /// Index of its cold node in the map.
    pub cold: Option<usize>,
    /// Hydraulic interfaces at this place.
    pub stations: Vec<String>,
}

/// An edge that joins two symbols.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Line {
    /// Index of the edge in the map.
    pub edge: usize,
    /// Symbol at port a.
    pub from: usize,
    /// Symbol at port b.
    pub to: usize,
    /// Hot or cold line.
    pub side: Side,
}

/// What the map shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SiteGraph {
    /// Symbols.
    pub vertices: Vec<Vertex>,
    /// Lines.
    pub lines: Vec<Line>,
    /// Positions of the symbols, m, vertical axis upwards.
    pub positions: Vec<Point>,
    /// Whether the positions are those of the model.
    pub surveyed: bool,
    by_name: BTreeMap<String, usize>,
    site_of_node: BTreeMap<String, usize>,
    site_of_edge: BTreeMap<String, usize>,
}

impl SiteGraph {
    /// Groups the nodes of each site and places the groups.
    pub fn new(lookup: &Lookup) -> Self {
        let map = &lookup.recording.header.map;
        let mut graph = Self::default();
        graph.group_nodes(map);
        graph.connect(map);
        let stations: BTreeSet<&str> = lookup
            .recording
            .channels
            .iter()
            .filter(|channel| channel.group == ChannelGroup::Interfaces)
            .map(|channel| channel.component.as_str())
            .collect();
        for station in stations {
            if let Some(vertex) = graph.vertex_of(station) {
                graph.vertices[vertex].stations.push(station.to_owned());
            }
        }
        graph.place(map);
        graph
    }

    /// Name of the place a component belongs to; the component itself where there is none.
    pub fn place_of<'b>(&'b self, component: &'b str) -> &'b str {
        self.vertex_of(component).map_or(component, |vertex| self.vertices[vertex].name.as_str())
    }

    fn vertex_of(&self, component: &str) -> Option<usize> {
        let known = self.site_of_node.get(component).or_else(|| self.site_of_edge.get(component));
        let mut parents = component.rmatch_indices('.').map(|(at, _)| &component[..at]);
        known.copied().or_else(|| parents.find_map(|parent| self.by_name.get(parent).copied()))
    }

    fn group_nodes(&mut self, map: &NetworkMap) {
        let ids: BTreeSet<&str> = map.nodes.iter().map(|node| node.id.as_str()).collect();
        for (i, node) in map.nodes.iter().enumerate() {
            let name = place_name(node, &ids);
            let vertex = *self.by_name.entry(name.to_owned()).or_insert_with(|| {
                let (hot, cold, stations) = (None, None, Vec::new());
                self.vertices.push(Vertex { name: name.to_owned(), hot, cold, stations });
                self.vertices.len() - 1
            });
            self.site_of_node.insert(node.id.clone(), vertex);
            let outer = node.id.rsplit_once('.').is_some_and(|(parent, _)| parent == name);
            let symbol = &mut self.vertices[vertex];
            match Side::of_node(&node.id) {
                Side::Hot if outer => symbol.hot = Some(i),
                Side::Cold if outer => symbol.cold = Some(i),
                _ if node.id == name => symbol.hot = Some(i),
                _ => {}
            }
        }
    }

    fn connect(&mut self, map: &NetworkMap) {
        for (i, edge) in map.edges.iter().enumerate() {
            let ends = (self.site_of_node.get(&edge.from), self.site_of_node.get(&edge.to));
            let (Some(&from), Some(&to)) = ends else { continue };
            if from == to {
                self.site_of_edge.insert(edge.id.clone(), from);
                if !edge.station.is_empty() {
                    self.site_of_edge.insert(edge.station.clone(), from);
                }
                continue;
            }
            let (a, b) = (Side::of_node(&edge.from), Side::of_node(&edge.to));
            let side = match (a, b) {
                (Side::Plain, side) | (side, Side::Plain) => side,
                (a, b) if a == b => a,
                _ => Side::Plain,
            };
            self.lines.push(Line { edge: i, from, to, side });
        }
    }

    fn place(&mut self, map: &NetworkMap) {
        let given = self.given_positions(map);
        self.surveyed = given.is_some();
        self.positions = given.unwrap_or_else(|| {
            let link = |line: &Line| Link {
                from: line.from,
                to: line.to,
                length: map.edges[line.edge].length_m,
            };
            let links: Vec<Link> = self.lines.iter().map(link).collect();
            layout::positions(self.vertices.len(), &links)
        });
    }

    /// Mean position of the nodes of each symbol; `None` unless every symbol has one and they differ.
    fn given_positions(&self, map: &NetworkMap) -> Option<Vec<Point>> {
        let mut sums = vec![[0.0, 0.0, 0.0]; self.vertices.len()];
        for node in &map.nodes {
            if let (Some(x), Some(y), Some(&vertex)) =
                (node.x_m, node.y_m, self.site_of_node.get(&node.id))
                && x.is_finite()
                && y.is_finite()
            {
                let sum = &mut sums[vertex];
                *sum = [sum[0] + x, sum[1] + y, sum[2] + 1.0];
            }
        }
        let mean = |sum: &[f64; 3]| (sum[2] > 0.0).then(|| [sum[0] / sum[2], sum[1] / sum[2]]);
        let points: Vec<Point> = sums.iter().map(mean).collect::<Option<_>>()?;
        let first = points.first()?;
        (points.len() == 1 || points.iter().any(|point| point != first)).then_some(points)
    }
}

/// The site of a node. Plain nodes `x.hot` and `x.cold` are a junction `x` of a pair of lines.
fn place_name<'a>(node: &'a MapNode, ids: &BTreeSet<&str>) -> &'a str {
    if !node.site.is_empty() {
        return &node.site;
    }
    match (node.id.rsplit_once('.'), Side::of_node(&node.id)) {
        (Some((parent, _)), Side::Hot) if ids.contains(format!("{parent}.cold").as_str()) => parent,
        (Some((parent, _)), Side::Cold) if ids.contains(format!("{parent}.hot").as_str()) => parent,
        _ => &node.id,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anergy_core::recorder::{MapEdge, Recording};

    fn node(id: &str, site: &str) -> MapNode {
        MapNode { id: id.to_owned(), site: site.to_owned(), x_m: None, y_m: None }
    }

    fn edge(id: &str, from: &str, to: &str, station: &str) -> MapEdge {
        let [id, from, to, station] = [id, from, to, station].map(str::to_owned);
        MapEdge {
            id,
            kind: "pipe".to_owned(),
            from,
            to,
            length_m: 10.0,
            inner_diameter_m: 0.02,
            station,
        }
    }

    #[test]
    fn nodes_of_a_site_become_one_symbol() {
        let mut recording = Recording::default();
        let map = &mut recording.header.map;
        map.nodes = vec![
            node("a.hot", "a"),
            node("a.station.inner.hot", "a"),
            node("a.cold", "a"),
            node("j.hot", ""),
            node("j.cold", ""),
            node("tank", ""),
        ];
        map.edges = vec![
            edge("h", "a.hot", "j.hot", ""),
            edge("c", "j.cold", "a.cold", ""),
            edge("a.pump", "a.cold", "a.station.inner.hot", "a.station"),
            edge("fill", "tank", "j.cold", ""),
            edge("lost", "nowhere", "j.cold", ""),
        ];
        let graph = SiteGraph::new(&Lookup::new(&recording));
        let names: Vec<&str> = graph.vertices.iter().map(|vertex| vertex.name.as_str()).collect();
        assert_eq!(names, ["a", "j", "tank"]);
        assert_eq!((graph.vertices[0].hot, graph.vertices[0].cold), (Some(0), Some(2)));
        assert_eq!((graph.vertices[2].hot, graph.vertices[2].cold), (Some(5), None));
        let sides: Vec<Side> = graph.lines.iter().map(|line| line.side).collect();
        assert_eq!(sides, [Side::Hot, Side::Cold, Side::Cold]);
        assert_eq!(graph.place_of("a.pump"), "a");
        assert_eq!(graph.place_of("a.station"), "a");
        assert_eq!(graph.place_of("fill"), "fill");
        assert!(!graph.surveyed);
    }

    #[test]
    fn positions_of_the_model_are_used_when_every_symbol_has_one() {
        let mut recording = Recording::default();
        let placed = |id: &str, site: &str, x: f64, y: f64| MapNode {
            x_m: Some(x),
            y_m: Some(y),
            ..node(id, site)
        };
        let nodes = vec![
            placed("a.hot", "a", 10.0, 2.0),
            placed("a.cold", "a", 10.0, 4.0),
            placed("b", "", -5.0, 0.0),
        ];
        recording.header.map.nodes = nodes;
        let graph = SiteGraph::new(&Lookup::new(&recording));
        assert!(graph.surveyed);
        assert_eq!(graph.positions, [[10.0, 3.0], [-5.0, 0.0]]);
        recording.header.map.nodes.push(node("c", ""));
        assert!(!SiteGraph::new(&Lookup::new(&recording)).surveyed);
    }
}
