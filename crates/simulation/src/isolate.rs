//! Cuts a sub-graph out of a model: its cut nodes become boundaries driven by series.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::model::{CircuitSpec, DriverSpec, Model, Place};
use crate::model_file::{Interpolation, NodeEntryKind};
use anergy_network::elements::ElementParams;
use anergy_prosumer::equipment::WITHOUT_PORTS;
use smol_str::{SmolStr, format_smolstr};
use std::collections::{HashMap, HashSet};

/// What is given at a cut node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CutKind {
    /// The pressure; the flow through the cut is a result.
    Pressure,
    /// The flow into the cut-out part, kg/s; the pressure is a result.
    Flow,
}

/// A cut node with the series that drive it, SI, linear between the times.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// The node.
    pub node: String,
    /// What is given.
    pub kind: CutKind,
    /// Times, s.
    pub times_s: Vec<f64>,
    /// Pressure in Pa or flow into the part in kg/s.
    pub values: Vec<f64>,
    /// Temperature of entering water, K.
    pub t_k: Vec<f64>,
}

impl Model {
    /// The model of the edges named in `components`; every node that also belongs to another edge must be
    /// in `boundary`. Units, stations, controllers and drivers of what remains are kept.
    ///
    /// # Errors
    /// Unknown edges, cut nodes without a boundary, boundaries that are no cut nodes.
    pub fn isolate(&self, components: &[&str], boundary: &[Cut]) -> Result<Self, Diagnostics> {
        let mut problems = Vec::new();
        let mut report = |message: String| problems.push(Diagnostic::new(message, None));
        let wanted: HashSet<&str> = components.iter().copied().collect();
        for name in components {
            if self.edge(name).is_none() {
                report(format!("isolate: there is no edge \"{name}\""));
            }
        }
        let mut model = self.clone();
        model.edges.retain(|edge| wanted.contains(edge.id.as_str()));
        let touched = |inside: bool| -> HashSet<&str> {
            self.edges
                .iter()
                .filter(|edge| wanted.contains(edge.id.as_str()) == inside)
                .flat_map(|edge| [edge.from.as_str(), edge.to.as_str()])
                .collect()
        };
        let (inside, outside) = (touched(true), touched(false));
        let cuts: HashMap<&str, &Cut> =
            boundary.iter().map(|cut| (cut.node.as_str(), cut)).collect();
        let mut cut_nodes: Vec<&str> = inside.intersection(&outside).copied().collect();
        cut_nodes.sort_unstable();
        for node in &cut_nodes {
            if !cuts.contains_key(node) {
                report(format!("isolate: the cut node \"{node}\" has no boundary"));
            }
        }
        for cut in boundary {
            if !inside.contains(cut.node.as_str()) {
                report(format!("isolate: boundary \"{}\" is no node of the part", cut.node));
            }
            let lengths = [cut.values.len(), cut.t_k.len()];
            if cut.times_s.is_empty() || lengths.iter().any(|len| *len != cut.times_s.len()) {
                report(format!("isolate: boundary \"{}\" needs as many values as times", cut.node));
            }
        }
        for edge in &model.edges {
            let ElementParams::Pipe(pipe) = &edge.params else { continue };
            if let Some(other) = pipe.companion.as_deref().filter(|id| !wanted.contains(id)) {
                report(format!("isolate: \"{}\" lies beside \"{other}\": take both", edge.id));
            }
        }
        for edge in self.edges.iter().filter(|edge| !wanted.contains(edge.id.as_str())) {
            let ElementParams::Pipe(pipe) = &edge.params else { continue };
            if let Some(other) = pipe.companion.as_deref().filter(|id| wanted.contains(id)) {
                report(format!("isolate: \"{other}\" lies beside \"{}\": take both", edge.id));
            }
        }
        if !problems.is_empty() {
            return Err(Diagnostics(problems));
        }
        model.nodes.retain(|node| inside.contains(node.entry.id.as_str()));
        model.references.retain(|reference| {
            let node = reference.entry.node.as_str();
            inside.contains(node) && !cuts.contains_key(node)
        });
        for node in &mut model.nodes {
            if let Some(cut) = cuts.get(node.entry.id.as_str()) {
                let first = cut.values[0];
                node.entry.temperature_k = Some(cut.t_k[0]);
                match cut.kind {
                    CutKind::Pressure => {
                        node.entry.kind = NodeEntryKind::PressureBoundary;
                        node.entry.pressure_pa = Some(first);
                    }
                    CutKind::Flow => {
                        node.entry.kind = NodeEntryKind::Source;
                        node.entry.m_flow_kg_s = Some(first);
                    }
                }
            }
        }
        let kept_edge = |id: &str| wanted.contains(id);
        let of = |member: &str, unit: &str| {
            member.strip_prefix(unit).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let mut kept_units: HashSet<SmolStr> = HashSet::new();
        kept_units.extend(model.units.iter().filter(|u| kept_edge(&u.port)).map(|u| u.id.clone()));
        // Circuits bring the rest of a house along.
        loop {
            let before = kept_units.len();
            for circuit in &model.circuits {
                // Branches that meet belong together.
                let meet = |other: &&CircuitSpec| match (&circuit.branch, &other.branch) {
                    (Some(a), Some(b)) => {
                        [&a.from, &a.to].iter().any(|p| **p == b.from || **p == b.to)
                    }
                    _ => other.id == circuit.id,
                };
                let passes = |unit: &SmolStr| {
                    let mut together = model.circuits.iter().filter(meet);
                    together.any(|other| other.through.iter().any(|member| of(member, unit)))
                };
                if kept_units.iter().any(passes) {
                    let units = model.units.iter().map(|unit| &unit.id);
                    kept_units.extend(units.filter(|unit| passes(unit)).cloned());
                }
            }
            if kept_units.len() == before {
                break;
            }
        }
        // Units that no water passes come along with the others of their site.
        let site = |unit: &str| unit.split_once('.').map(|(site, _)| SmolStr::from(site));
        let sites: HashSet<SmolStr> = kept_units.iter().filter_map(|unit| site(unit)).collect();
        let dry = model.units.iter().filter(|unit| {
            WITHOUT_PORTS.contains(&unit.params.kind())
                && site(&unit.id).is_some_and(|site| sites.contains(&site))
        });
        kept_units.extend(dry.map(|unit| unit.id.clone()));
        model.units.retain(|unit| kept_units.contains(&unit.id));
        model.circuits.retain(|circuit| {
            kept_units.iter().any(|unit| circuit.through.iter().any(|member| of(member, unit)))
        });
        let kept_circuit = |id: &str| model.circuits.iter().any(|circuit| circuit.id == id);
        model.effects.retain(|effect| {
            let component = effect.component.as_str();
            kept_edge(component) || kept_units.contains(component) || kept_circuit(component)
        });
        model.interfaces.retain(|interface| {
            kept_edge(&interface.entry.edge)
                && interface.entry.pump.as_deref().is_none_or(kept_edge)
                && interface.entry.valve.as_deref().is_none_or(kept_edge)
        });
        let kept: HashSet<String> = model
            .edges
            .iter()
            .map(|edge| edge.id.to_string())
            .chain(model.nodes.iter().map(|node| node.entry.id.to_string()))
            .chain(model.units.iter().map(|unit| unit.id.to_string()))
            .chain(model.circuits.iter().map(|circuit| circuit.id.to_string()))
            .chain(model.interfaces.iter().map(|interface| interface.entry.id.clone()))
            .chain(["ground", "weather"].map(str::to_owned))
            .collect();
        for point in &mut model.worst_points {
            let pairs = &mut point.entry.between;
            pairs.retain(|(a, b)| inside.contains(a.as_str()) && inside.contains(b.as_str()));
        }
        model.worst_points.retain(|point| !point.entry.between.is_empty());
        let points = model.worst_points.iter().map(|point| point.entry.id.clone());
        let shared = model.edges.iter().filter_map(|edge| match &edge.params {
            ElementParams::Valve(valve) => valve.command_of.clone(),
            _ => None,
        });
        let kept: HashSet<String> = kept.into_iter().chain(points).chain(shared).collect();
        let component = |name: &str| name.rsplit_once('.').is_some_and(|(c, _)| kept.contains(c));
        model.sensors.retain(|sensor| {
            component(&sensor.entry.measures) && sensor.entry.minus.as_deref().is_none_or(component)
        });
        let sensors: HashSet<String> =
            model.sensors.iter().map(|sensor| format!("{}.value", sensor.entry.id)).collect();
        // A rule goes by other rules, which must be left as well.
        loop {
            let before = model.controllers.len();
            let ids: HashSet<String> = model.controllers.iter().map(|c| c.id.clone()).collect();
            let of_rule =
                |name: &str| name.rsplit_once('.').is_some_and(|(id, _)| ids.contains(id));
            model.controllers.retain(|c| {
                c.named()
                    .all(|(_, name)| component(name) || sensors.contains(name) || of_rule(name))
            });
            if model.controllers.len() == before {
                break;
            }
        }
        model.prescriptions.retain(|p| component(&p.entry.quantity) && component(&p.entry.free));
        let set_points: HashSet<String> = model
            .controllers
            .iter()
            .flat_map(|c| {
                let points = c.params.build(&()).map(|c| c.set_points()).unwrap_or_default();
                points
                    .into_iter()
                    .map(|point| format!("{}.{}", c.id, point.name))
                    .collect::<Vec<_>>()
            })
            .chain(model.prescriptions.iter().map(|p| format!("{}.value", p.id)))
            .collect();
        model.drivers.retain(|driver| {
            component(&driver.signal) || set_points.contains(driver.signal.as_str())
        });
        for cut in boundary {
            let quantity = match cut.kind {
                CutKind::Pressure => "pressure_pa",
                CutKind::Flow => "m_flow_kg_s",
            };
            for (quantity, values) in [(quantity, &cut.values), ("temperature_k", &cut.t_k)] {
                model.drivers.push(DriverSpec {
                    signal: format_smolstr!("{}.{quantity}", cut.node),
                    unit: None,
                    interpolation: Interpolation::Linear,
                    times_s: cut.times_s.as_slice().into(),
                    values: values.as_slice().into(),
                    source: format_smolstr!("isolate at \"{}\"", cut.node),
                    place: Place::default(),
                });
            }
        }
        Ok(model)
    }
}
