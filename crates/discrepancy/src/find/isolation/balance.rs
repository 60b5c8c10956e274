//! Which flows and temperatures of the graph are known, and the parts that they cut out.

use super::reads_everywhere;
use crate::data::Run;
use crate::experiment::Experiment;
use crate::inputs::before_lag;
use anergy_network::elements::ElementParams;
use anergy_simulation::model::Model;
use anergy_simulation::model_file::NodeEntryKind;
use nalgebra::DMatrix;
use std::collections::{BTreeMap, BTreeSet};

/// Most unknown flows for which balances are solved.
const MOST: usize = 400;

/// A sum of measured flows: sensor and factor; and a constant, kg/s.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Sum {
    pub(super) of: BTreeMap<usize, f64>,
    constant: f64,
}

impl Sum {
    fn one(sensor: usize) -> Self {
        Self { of: BTreeMap::from([(sensor, 1.0)]), constant: 0.0 }
    }

    pub(super) fn add(&mut self, other: &Self, factor: f64) {
        for (sensor, x) in &other.of {
            *self.of.entry(*sensor).or_default() += factor * x;
        }
        self.constant += factor * other.constant;
        self.of.retain(|_, x| x.abs() > 1e-9);
    }

    pub(super) fn at(&self, run: &Run, time_s: f64) -> f64 {
        self.constant + self.of.iter().map(|(k, x)| x * run.tracks[*k].at(time_s)).sum::<f64>()
    }
}

/// The graph with what is measured of it.
pub(super) struct Measured<'a> {
    pub(super) experiment: &'a Experiment,
    /// The runs, in front of the known lags of their sensors.
    pub(super) ahead: Vec<Run>,
    /// Sensor of the temperature of a node.
    pub(super) t: BTreeMap<&'a str, usize>,
    /// Flow of every edge that is known, from its a to its b.
    pub(super) flow: BTreeMap<&'a str, Sum>,
}

impl<'a> Measured<'a> {
    pub(super) fn new(experiment: &'a Experiment) -> Self {
        let model = &experiment.model;
        let (mut t, mut flow) = (BTreeMap::new(), BTreeMap::new());
        let mut enters: BTreeMap<&str, Sum> = BTreeMap::new();
        for node in &model.nodes {
            let entry = &node.entry;
            if entry.kind == NodeEntryKind::Source {
                let constant = entry.m_flow_kg_s.unwrap_or(0.0);
                enters.insert(entry.id.as_str(), Sum { constant, ..Sum::default() });
            }
        }
        let all = experiment.sensors.sensor.iter().enumerate();
        for (k, sensor) in all.filter(|(k, _)| reads_everywhere(experiment, *k)) {
            let Some((of, quantity)) = sensor.signal.rsplit_once('.') else { continue };
            let is_node = model.nodes.iter().any(|node| node.entry.id == of);
            match quantity {
                "t_k" | "temperature_k" if is_node => drop(t.insert(of, k)),
                "m_flow_kg_s" if is_node => drop(enters.insert(of, Sum::one(k))),
                "m_flow_kg_s" | "m_flow_set_kg_s" if model.edge(of).is_some() => {
                    flow.insert(of, Sum::one(k));
                }
                _ => {}
            }
        }
        let ahead = experiment.runs.iter().map(|run| {
            let tracks = run.tracks.iter().zip(&experiment.sensors.sensor);
            let tracks = tracks.map(|(track, sensor)| before_lag(track, sensor.lag_s)).collect();
            Run { tracks, ..run.clone() }
        });
        let mut measured = Self { experiment, ahead: ahead.collect(), t, flow };
        measured.balance(&enters);
        measured
    }

    /// Flows that follow from balances.
    fn balance(&mut self, enters: &BTreeMap<&'a str, Sum>) {
        let model = &self.experiment.model;
        let unknown: Vec<_> =
            model.edges.iter().filter(|edge| !self.flow.contains_key(edge.id.as_str())).collect();
        if unknown.is_empty() || unknown.len() > MOST {
            return;
        }
        let referenced: BTreeSet<&str> =
            model.references.iter().map(|reference| reference.entry.node.as_str()).collect();
        let closed: Vec<&str> = model
            .nodes
            .iter()
            .filter(|node| node.entry.kind != NodeEntryKind::PressureBoundary)
            .map(|node| node.entry.id.as_str())
            .filter(|id| {
                !referenced.contains(id)
                    || model.nodes.iter().all(|n| n.entry.kind == NodeEntryKind::Junction)
            })
            .collect();
        let place: BTreeMap<&str, usize> =
            closed.iter().enumerate().map(|(i, id)| (*id, i)).collect();
        // Into a node less out of it, of the known ones with the other sign.
        let mut a: DMatrix<f64> = DMatrix::zeros(closed.len(), unknown.len());
        for (j, edge) in unknown.iter().enumerate() {
            for (node, sign) in [(edge.to.as_str(), 1.0), (edge.from.as_str(), -1.0)] {
                if let Some(i) = place.get(node) {
                    a[(*i, j)] += sign;
                }
            }
        }
        let mut b: Vec<Sum> = closed
            .iter()
            .map(|node| {
                let mut sum = Sum::default();
                if let Some(own) = enters.get(node) {
                    sum.add(own, -1.0);
                }
                sum
            })
            .collect();
        for edge in &model.edges {
            let Some(known) = self.flow.get(edge.id.as_str()) else { continue };
            for (node, sign) in [(edge.to.as_str(), -1.0), (edge.from.as_str(), 1.0)] {
                if let Some(i) = place.get(node) {
                    b[*i].add(known, sign);
                }
            }
        }
        let Ok(inverse) = a.clone().pseudo_inverse(1e-9) else { return };
        let whole = &inverse * &a;
        for (j, edge) in unknown.iter().enumerate() {
            if (whole[(j, j)] - 1.0).abs() < 1e-6 {
                let mut sum = Sum::default();
                for (i, known) in
                    b.iter().enumerate().filter(|(i, _)| inverse[(j, *i)].abs() > 1e-9)
                {
                    sum.add(known, inverse[(j, i)]);
                }
                self.flow.insert(edge.id.as_str(), sum);
            }
        }
    }

    /// Sets of edges between nodes with a measured temperature.
    pub(super) fn parts(&self) -> Vec<Vec<&'a str>> {
        let model = &self.experiment.model;
        let mut own: Vec<usize> = (0..model.edges.len()).collect();
        let ends = |i: usize| [model.edges[i].from.as_str(), model.edges[i].to.as_str()];
        // Edges that share a node without a measured temperature belong together; so do the members of a unit or pair.
        let together = |i: usize, j: usize| {
            ends(i).iter().any(|node| !self.t.contains_key(node) && ends(j).contains(node))
                || companions(model, i, j)
        };
        loop {
            let before = own.clone();
            for i in 0..own.len() {
                for j in 0..i {
                    if own[i] != own[j] && together(i, j) {
                        let (low, high) = (own[i].min(own[j]), own[i].max(own[j]));
                        own.iter_mut().filter(|x| **x == high).for_each(|x| *x = low);
                    }
                }
            }
            if own == before {
                break;
            }
        }
        let names: BTreeSet<usize> = own.iter().copied().collect();
        let own = &own;
        let of = |name: usize| {
            let members = (0..own.len()).filter(move |&i| own[i] == name);
            members.map(|i| model.edges[i].id.as_str())
        };
        names.into_iter().map(|name| of(name).collect()).collect()
    }
}

/// Whether two edges lie beside each other in one trench.
fn companions(model: &Model, i: usize, j: usize) -> bool {
    let beside = |i: usize, j: usize| match &model.edges[i].params {
        ElementParams::Pipe(pipe) => pipe.companion.as_deref() == Some(model.edges[j].id.as_str()),
        _ => false,
    };
    beside(i, j) || beside(j, i)
}
