//! Where the map draws what, for drawings outside of the report.

use crate::lookup::Lookup;
use crate::sites::{Side, SiteGraph};
use anergy_core::recorder::{NetworkMap, Recording};

/// A symbol of the map: a site, or a node of none.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnPlace {
    /// Its name.
    pub name: String,
    /// Where it is drawn: as the model says, or laid out by the lengths of the pipes.
    pub x_m: f64,
    /// The same, upwards.
    pub y_m: f64,
    /// Its hot node, or its only one; empty without.
    pub hot: String,
    /// Its cold node; empty without.
    pub cold: String,
}

/// A line of the map.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnLine {
    /// Name of the edge.
    pub edge: String,
    /// Its kind.
    pub kind: String,
    /// Index of the place at port a.
    pub from: usize,
    /// Index of the place at port b.
    pub to: usize,
    /// `hot`, `cold` or `plain`.
    pub side: &'static str,
    /// Nodes at port a and b.
    pub nodes: [String; 2],
}

/// Symbols and lines of a network, as the report draws them.
pub fn drawn(map: &NetworkMap) -> (Vec<DrawnPlace>, Vec<DrawnLine>) {
    let mut recording = Recording::default();
    recording.header.map = map.clone();
    let graph = SiteGraph::new(&Lookup::new(&recording));
    let id = |node: Option<usize>| {
        node.and_then(|node| map.nodes.get(node)).map_or(String::new(), |node| node.id.clone())
    };
    let places = graph.vertices.iter().zip(&graph.positions).map(|(vertex, at)| DrawnPlace {
        name: vertex.name.clone(),
        x_m: at[0],
        y_m: at[1],
        hot: id(vertex.hot),
        cold: id(vertex.cold),
    });
    let lines = graph.lines.iter().map(|line| {
        let edge = &map.edges[line.edge];
        DrawnLine {
            edge: edge.id.clone(),
            kind: edge.kind.clone(),
            from: line.from,
            to: line.to,
            side: match line.side {
                Side::Hot => "hot",
                Side::Cold => "cold",
                Side::Plain => "plain",
            },
            nodes: [edge.from.clone(), edge.to.clone()],
        }
    });
    (places.collect(), lines.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use anergy_core::recorder::{MapEdge, MapNode};

    #[test]
    fn places_and_lines_have_their_names() {
        let node = |id: &str, site: &str, x: f64| MapNode {
            id: id.to_owned(),
            site: site.to_owned(),
            x_m: Some(x),
            y_m: Some(1.0),
        };
        let edge = |id: &str, from: &str, to: &str| MapEdge {
            id: id.to_owned(),
            kind: "pipe".to_owned(),
            from: from.to_owned(),
            to: to.to_owned(),
            length_m: 5.0,
            inner_diameter_m: 0.02,
            station: String::new(),
        };
        let map = NetworkMap {
            nodes: vec![
                node("a.hot", "a", 0.0),
                node("a.cold", "a", 0.0),
                node("b.hot", "b", 7.0),
                node("b.cold", "b", 7.0),
            ],
            edges: vec![edge("h", "a.hot", "b.hot"), edge("c", "b.cold", "a.cold")],
        };
        let (places, lines) = drawn(&map);
        assert_eq!((places[1].name.as_str(), places[1].x_m, places[1].y_m), ("b", 7.0, 1.0));
        assert_eq!((places[1].hot.as_str(), places[1].cold.as_str()), ("b.hot", "b.cold"));
        assert_eq!((lines[1].from, lines[1].to, lines[1].side), (1, 0, "cold"));
        assert_eq!(
            (lines[0].edge.as_str(), &lines[0].nodes),
            ("h", &["a.hot".into(), "b.hot".into()])
        );
    }
}
