//! Effects of pumps, valves, exchangers and leaks.

use super::tolerance::Known;
use super::{Candidate, effect_target, has, sensed};
use crate::experiment::Experiment;
use crate::sensors::Role;
use crate::unknown::Unknown;
use anergy_network::elements::ElementParams;
use anergy_simulation::model::{EdgeSpec, Model};
use anergy_simulation::model_file::NodeEntryKind;
use std::collections::HashMap;

/// A command that always reads more than this keeps its valve open.
const OPEN: f64 = 0.02;

pub(super) fn tolerances(experiment: &Experiment, all: &mut Vec<Unknown>) {
    let known = Known::of(experiment);
    let mut add = |id: &'static str, component: &str, sd: f64, declared: Option<f64>| {
        if !has(experiment, id, component) {
            let factor = Unknown::plain(effect_target(id, component, "factor"), 0.0, sd);
            all.push(Unknown { logarithmic: true, ..factor.limited(declared.is_some()) });
        }
    };
    if flows(experiment) {
        for edge in experiment.model.edges.iter().filter(|edge| is_pump(edge)) {
            add("H3", &edge.id, known.pump_head, known.declared.pump_head);
        }
    }
    if heat(experiment) {
        for component in exchangers(&experiment.model) {
            add("X1", component, known.exchanger, known.declared.exchanger);
        }
    }
}

pub(super) fn candidates(experiment: &Experiment, all: &mut Vec<Candidate>) {
    let (model, known) = (&experiment.model, Known::of(experiment));
    let (flows, heat) = (flows(experiment), heat(experiment));
    for edge in &model.edges {
        let id = edge.id.as_str();
        if flows && is_pump(edge) {
            let range = |target| Unknown::between(target, 0.7, 1.3).starting_at(1.0);
            let words = "head of the pump";
            let separates = "the pressure difference over the pump";
            let head = Candidate::effect("H3", id, words, ("factor", "1"), range, separates);
            all.push(head.tolerated(0.0, known.pump_head));
        }
        if (flows || heat) && closes(experiment, edge) {
            all.push(Candidate::effect(
                "H4",
                id,
                "leak of the closed valve",
                ("share", "1"),
                |target| Unknown::between(target, 0.001, 0.1),
                "the valve shut off by hand, or a temperature behind it",
            ));
        }
    }
    if heat || flows {
        for valve in three_way_valves(model) {
            all.push(Candidate::effect(
                "H8",
                valve,
                "leak of the closed way of the three-way valve",
                ("share", "1"),
                |target| Unknown::between(target, 0.005, 0.15),
                "temperatures of both inlets, at both ends of the stroke",
            ));
        }
    }
    if heat {
        for component in exchangers(model) {
            let range = |target| Unknown::between(target, 0.3, 1.1).starting_at(1.0);
            let words = "conductance of the heat exchanger (fouling)";
            let separates = "flows of both sides, or its pressure loss";
            let fouled =
                Candidate::effect("X1", component, words, ("factor", "1"), range, separates);
            all.push(fouled.tolerated(0.0, known.exchanger));
        }
    }
    of_leaks(experiment, all);
}

fn is_pump(edge: &EdgeSpec) -> bool {
    matches!(edge.params, ElementParams::Pump(_))
}

/// Whether flows or pressures are compared.
fn flows(experiment: &Experiment) -> bool {
    ["kg_s", "m3_s", "pa"].iter().any(|si| sensed(experiment, si))
}

/// Whether temperatures or heat are compared.
fn heat(experiment: &Experiment) -> bool {
    ["k", "w"].iter().any(|si| sensed(experiment, si))
}

/// Whether it is a valve that closes; one whose measured command never is at its end does not.
fn closes(experiment: &Experiment, edge: &EdgeSpec) -> bool {
    match &edge.params {
        ElementParams::CheckValve(_) => true,
        ElementParams::Valve(valve) if valve.command_of.is_some() => false,
        ElementParams::Valve(_) | ElementParams::BallValve(_) => {
            let own = |signal: &str| signal.rsplit_once('.').is_some_and(|(of, _)| *of == *edge.id);
            let sensors = experiment.sensors.sensor.iter().enumerate();
            let mut commands = sensors.filter(|(_, s)| s.role == Role::Input && own(&s.signal));
            commands.all(|(k, _)| {
                experiment.runs.iter().any(|run| run.tracks[k].value.iter().any(|y| *y < OPEN))
            })
        }
        _ => false,
    }
}

fn three_way_valves(model: &Model) -> impl Iterator<Item = &str> {
    model.edges.iter().filter_map(|edge| match &edge.params {
        ElementParams::Valve(valve) => {
            let of = valve.command_of.as_deref()?;
            (edge.id.strip_prefix(of)? == ".a").then_some(of)
        }
        _ => None,
    })
}

fn exchangers(model: &Model) -> impl Iterator<Item = &str> {
    let edges = model.edges.iter().filter(|e| matches!(e.params, ElementParams::HeatExchanger(_)));
    let kinds = ["direct_exchanger", "balancing_exchanger"];
    let units = model.units.iter().filter(move |unit| kinds.contains(&unit.params.kind()));
    edges.map(|edge| edge.id.as_str()).chain(units.map(|unit| unit.id.as_str()))
}

/// Leaks: one node of each part of the graph between measured flows and pressure losses, that where most edges meet. Where in such
/// a part the water leaves does not show; and none between flows where the pressure is held, and what is lost is made up for unseen.
fn of_leaks(experiment: &Experiment, all: &mut Vec<Candidate>) {
    let model = &experiment.model;
    let mut largest = 0.0_f64;
    let (mut metered, mut seen): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    for (k, sensor) in experiment.sensors.sensor.iter().enumerate() {
        let Some((of, quantity)) = sensor.signal.rsplit_once('.') else { continue };
        if quantity.starts_with("m_flow_kg_s") {
            metered.push(of);
            let values = experiment.runs.iter().flat_map(|run| &run.tracks[k].value);
            largest = values.fold(largest, |most, y| most.max(y.abs()));
        } else if quantity.starts_with("dp_pa") {
            seen.push(of);
        }
    }
    if metered.len() < 2 || largest <= 0.0 || !sensed(experiment, "kg_s") {
        return;
    }
    let part = parts(model, &metered);
    let held = |first: &str| {
        model.nodes.iter().any(|node| {
            let kept = node.entry.kind == NodeEntryKind::PressureBoundary
                || model.references.iter().any(|r| r.entry.node == node.entry.id);
            kept && part[node.entry.id.as_str()] == first
        })
    };
    let beside_meter = |first: &str| {
        let ends = |edge: &EdgeSpec| [part.get(edge.from.as_str()), part.get(edge.to.as_str())];
        let mut edges = model.edges.iter().filter(|edge| metered.contains(&edge.id.as_str()));
        edges.any(|edge| ends(edge).contains(&Some(&first)))
            || metered.iter().any(|of| part.get(of) == Some(&first))
    };
    let meet = |node: &str| {
        model
            .edges
            .iter()
            .filter(|edge| [edge.from.as_str(), edge.to.as_str()].contains(&node))
            .count()
    };
    seen.extend(&metered);
    let finer = parts(model, &seen);
    for node in &model.nodes {
        let first = node.entry.id.as_str();
        if finer[first] != first || held(part[first]) || !beside_meter(part[first]) {
            continue;
        }
        let own = finer.iter().filter(|(_, of)| **of == first).map(|(node, _)| *node);
        // Of several alike the first by name.
        let Some(id) = own.min_by_key(|node| (usize::MAX - meet(node), *node)) else { continue };
        all.push(Candidate::effect(
            "P11",
            id,
            "leak",
            ("m_flow_kg_s", "kg/s at 1 bar"),
            |target| Unknown::between(target, 0.001 * largest, 0.05 * largest),
            "a second flow meter, or another pressure",
        ));
    }
}

/// Every node with the first one of its part, where the graph is cut at these edges.
fn parts<'a>(model: &'a Model, cut: &[&str]) -> HashMap<&'a str, &'a str> {
    let own = model.nodes.iter().map(|n| (n.entry.id.as_str(), n.entry.id.as_str()));
    let mut part: HashMap<&str, &str> = own.collect();
    for edge in model.edges.iter().filter(|edge| !cut.contains(&edge.id.as_str())) {
        let (Some(&a), Some(&b)) = (part.get(edge.from.as_str()), part.get(edge.to.as_str()))
        else {
            continue;
        };
        part.values_mut().filter(|first| **first == b).for_each(|first| *first = a);
    }
    part
}
