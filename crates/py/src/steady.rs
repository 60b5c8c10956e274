//! The steady state as tables.

use crate::model::Model;
use anergy_simulation::steady::Steady;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The `anergy.steady.Steady` of a steady state.
pub fn to_python<'py>(
    py: Python<'py>,
    steady: &Steady,
    model: &Bound<'py, Model>,
) -> PyResult<Bound<'py, PyAny>> {
    let nodes = PyDict::new(py);
    let column =
        |value: &dyn Fn(usize) -> f64, rows: usize| PyArray1::from_iter(py, (0..rows).map(value));
    let n = steady.nodes.len();
    nodes.set_item("id", steady.nodes.iter().map(|node| node.id.as_str()).collect::<Vec<_>>())?;
    nodes.set_item("p_pa", column(&|i| steady.nodes[i].p_pa, n))?;
    nodes.set_item("t_k", column(&|i| steady.nodes[i].t_k, n))?;
    nodes.set_item("elevation_m", column(&|i| steady.nodes[i].elevation_m, n))?;
    let edges = PyDict::new(py);
    let n = steady.edges.len();
    edges.set_item("id", steady.edges.iter().map(|edge| edge.id.as_str()).collect::<Vec<_>>())?;
    edges
        .set_item("kind", steady.edges.iter().map(|edge| edge.kind.as_str()).collect::<Vec<_>>())?;
    edges.set_item("m_flow_kg_s", column(&|i| steady.edges[i].m_flow_kg_s, n))?;
    edges.set_item("dp_pa", column(&|i| steady.edges[i].dp_pa, n))?;
    let module = py.import("anergy.steady")?;
    let table = module.getattr("Table")?;
    let (nodes, edges) = (table.call1((nodes,))?, table.call1((edges,))?);
    module.getattr("Steady")?.call1((nodes, edges, steady.iterations, steady.residual_pa, model))
}
