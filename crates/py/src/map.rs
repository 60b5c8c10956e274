//! Where the places of a network are drawn, for plots.

use crate::model::Model;
use crate::result::RunResult;
use anergy_core::medium::Medium;
use anergy_core::recorder::{MapEdge, MapNode, NetworkMap};
use anergy_network::elements::ElementParams;
use anergy_report::places;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// Places and lines as lists of dicts.
fn to_python<'py>(
    py: Python<'py>,
    map: &NetworkMap,
    density_kg_m3: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let (places, lines) = py.detach(|| places::drawn(map));
    let (all, joined) = (PyList::empty(py), PyList::empty(py));
    for place in &places {
        let dict = PyDict::new(py);
        dict.set_item("name", &place.name)?;
        dict.set_item("x_m", place.x_m)?;
        dict.set_item("y_m", place.y_m)?;
        dict.set_item("hot", &place.hot)?;
        dict.set_item("cold", &place.cold)?;
        all.append(dict)?;
    }
    for line in &lines {
        let dict = PyDict::new(py);
        dict.set_item("edge", &line.edge)?;
        dict.set_item("kind", &line.kind)?;
        dict.set_item("from", line.from)?;
        dict.set_item("to", line.to)?;
        dict.set_item("side", line.side)?;
        dict.set_item("nodes", &line.nodes)?;
        joined.append(dict)?;
    }
    let map = PyDict::new(py);
    map.set_item("density_kg_m3", density_kg_m3)?;
    map.set_item("places", all)?;
    map.set_item("lines", joined)?;
    Ok(map)
}

#[pymethods]
impl RunResult {
    /// Where places are drawn, and the lines between them.
    fn _map<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let header = &self.recording.header;
        let density_kg_m3 = self.density_kg_m3();
        let map = to_python(py, &header.map, density_kg_m3)?;
        map.set_item("start_s", header.start_unix_ns as f64 / 1e9)?;
        Ok(map)
    }

    /// The density that makes l/min of kg/s.
    fn _density_kg_m3(&self) -> f64 {
        self.density_kg_m3()
    }
}

#[pymethods]
impl Model {
    /// Where places are drawn, and the lines between them.
    fn _map<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        to_python(py, &self.map(), self.model.medium.density_kg_m3)
    }
}

impl RunResult {
    fn density_kg_m3(&self) -> f64 {
        let settings = &self.recording.header.settings;
        let set = settings.iter().find(|(name, _)| name == "density_kg_m3");
        let density = set.and_then(|(_, value)| value.parse().ok());
        density.unwrap_or(Medium::default().density_kg_m3)
    }
}

impl Model {
    fn map(&self) -> NetworkMap {
        let nodes = self.model.nodes.iter().map(|node| MapNode {
            id: node.entry.id.to_string(),
            site: node.site.to_string(),
            x_m: node.entry.x_m,
            y_m: node.entry.y_m,
        });
        let size = |params: &ElementParams| match params {
            ElementParams::Pipe(pipe) => (pipe.length_m, pipe.inner_diameter_m),
            _ => (0.0, 0.0),
        };
        let edges = self.model.edges.iter().map(|edge| {
            let (length_m, inner_diameter_m) = size(&edge.params);
            MapEdge {
                id: edge.id.to_string(),
                kind: edge.params.kind().to_owned(),
                from: edge.from.to_string(),
                to: edge.to.to_string(),
                length_m,
                inner_diameter_m,
                station: edge.station.to_string(),
            }
        });
        NetworkMap { nodes: nodes.collect(), edges: edges.collect() }
    }
}
