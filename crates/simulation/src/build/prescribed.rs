//! Prescriptions: what is given, and which actuator is free in its place.

use super::Builder;
use super::signals::{Writer, free_signal};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::model::PrescriptionSpec;
use crate::plan::PlannedPrescription;
use anergy_core::ids::{EdgeId, NodeId, SignalId};
use anergy_core::signal::SignalTable;
use anergy_network::elements::ElementParams;
use anergy_network::graph::{Edge, Prescription, Quantity};
use anergy_network::well_posed::{Equation, Unknown};
use std::collections::HashMap;

impl Builder<'_> {
    /// The prescriptions of the network, in the order of those of the model that can be resolved.
    pub(super) fn prescriptions(
        &mut self,
        node_ids: &HashMap<&str, usize>,
        edge_ids: &HashMap<&str, usize>,
        edges: &[Edge],
    ) -> Vec<Prescription> {
        let mut prescriptions = Vec::new();
        for spec in &self.model.prescriptions {
            let quantity = self.quantity(spec, node_ids, edge_ids);
            let free = self.free_edge(spec, edge_ids, edges);
            if let (Some(quantity), Some(free)) = (quantity, free) {
                prescriptions.push(Prescription { quantity, free });
            }
        }
        prescriptions
    }

    fn quantity(
        &mut self,
        spec: &PrescriptionSpec,
        node_ids: &HashMap<&str, usize>,
        edge_ids: &HashMap<&str, usize>,
    ) -> Option<Quantity> {
        let (component, word) = spec.entry.quantity.rsplit_once('.').unwrap_or(("", ""));
        let station = self.model.interfaces.iter().find(|station| station.entry.id == component);
        let edge = |name: &str| edge_ids.get(name).map(|&i| EdgeId::from_index(i));
        let found = match word {
            "m_flow_kg_s" => edge(station.map_or(component, |station| &station.entry.edge))
                .map(Quantity::MassFlow),
            "dp_pa" => edge(component).map(Quantity::PressureDifference),
            "p_pa" => node_ids.get(component).map(|&i| Quantity::Pressure(NodeId::from_index(i))),
            _ => None,
        };
        if found.is_none() {
            let names = edge_ids
                .keys()
                .flat_map(|id| [format!("{id}.m_flow_kg_s"), format!("{id}.dp_pa")])
                .chain(node_ids.keys().map(|id| format!("{id}.p_pa")))
                .collect::<Vec<_>>();
            let hint = did_you_mean(&spec.entry.quantity, names.iter().map(String::as_str))
                .unwrap_or_else(|| {
                    "give EDGE.m_flow_kg_s, STATION.m_flow_kg_s, EDGE.dp_pa or NODE.p_pa".into()
                });
            let what = spec.place.entry_or(&spec.entry.quantity);
            let message = format!(
                "{what}: quantity \"{}\" is no flow, pressure difference or pressure of this model",
                spec.entry.quantity
            );
            self.report(message, spec.place.of("quantity"), Some(hint));
        }
        found
    }

    fn free_edge(
        &mut self,
        spec: &PrescriptionSpec,
        edge_ids: &HashMap<&str, usize>,
        edges: &[Edge],
    ) -> Option<EdgeId> {
        // A valve that shares its command cannot be left free alone.
        let alone = |i: usize| match &self.model.edges[i].params {
            ElementParams::Valve(valve) => valve.command_of.is_none(),
            _ => true,
        };
        // The position of a free edge is found on its law, between limits: no ideal source.
        let command = |i: usize| {
            let actuator = edges[i].element.actuator()?;
            (alone(i) && actuator.max.is_finite()).then_some(actuator.command)
        };
        let (component, word) = spec.entry.free.rsplit_once('.').unwrap_or(("", ""));
        let found = edge_ids.get(component).copied().filter(|&i| command(i) == Some(word));
        if found.is_none() {
            let names: Vec<String> = edge_ids
                .iter()
                .filter_map(|(id, &i)| command(i).map(|command| format!("{id}.{command}")))
                .collect();
            let hint = did_you_mean(&spec.entry.free, names.iter().map(String::as_str));
            let what = spec.place.entry_or(&spec.entry.quantity);
            let message = format!(
                "{what}: \"{}\" is no actuator of this model that could be left free",
                spec.entry.free
            );
            self.report(message, spec.place.of("free"), hint);
        }
        found.map(EdgeId::from_index)
    }

    /// More equations than unknowns, in words.
    pub(super) fn over_determined(&self, equations: &[Equation]) -> Diagnostic {
        let named = |wanted: fn(&Equation) -> bool| equations.iter().filter(move |e| wanted(e));
        let given: Vec<&PrescriptionSpec> = named(|e| matches!(e, Equation::Prescription(_)))
            .filter_map(|equation| match equation {
                Equation::Prescription(k) => self.model.prescriptions.get(*k),
                _ => None,
            })
            .collect();
        let nodes = named(|e| matches!(e, Equation::MassBalance(_))).filter_map(|e| match e {
            Equation::MassBalance(node) => Some(self.model.nodes[node.index()].entry.id.as_str()),
            _ => None,
        });
        let edges = named(|e| matches!(e, Equation::Law(_))).filter_map(|e| match e {
            Equation::Law(edge) => Some(self.model.edges[edge.index()].id.as_str()),
            _ => None,
        });
        let mut parts = vec![format!(
            "the prescribed {}",
            few(given.iter().map(|spec| spec.entry.quantity.as_str()))
        )];
        if equations.iter().any(|e| matches!(e, Equation::MassBalance(_))) {
            parts.push(format!("the mass balance at {}", few(nodes)));
        }
        if equations.iter().any(|e| matches!(e, Equation::Law(_))) {
            parts.push(format!("the law of {}", few(edges)));
        }
        let message = format!(
            "too much is prescribed: {} determine each other, none can be chosen freely",
            parts.join(", ")
        );
        let place = given.last().and_then(|spec| spec.place.span.range());
        Diagnostic::new(message, place)
            .with_hint("take out one of these prescriptions, or free an actuator in this part")
    }

    /// Fewer equations than unknowns, in words.
    pub(super) fn under_determined(&self, unknowns: &[Unknown]) -> Diagnostic {
        let flows = unknowns.iter().filter_map(|unknown| match unknown {
            Unknown::Flow(edge) => Some(self.model.edges[edge.index()].id.as_str()),
            Unknown::Pressure(_) => None,
        });
        let pressures = unknowns.iter().filter_map(|unknown| match unknown {
            Unknown::Pressure(node) => Some(self.model.nodes[node.index()].entry.id.as_str()),
            Unknown::Flow(_) => None,
        });
        let mut parts = Vec::new();
        if unknowns.iter().any(|u| matches!(u, Unknown::Flow(_))) {
            parts.push(format!("the flow of {}", few(flows)));
        }
        if unknowns.iter().any(|u| matches!(u, Unknown::Pressure(_))) {
            parts.push(format!("the pressure at {}", few(pressures)));
        }
        let free = self.model.prescriptions.iter().find(|spec| {
            let edge = spec.entry.free.rsplit_once('.').map_or("", |(edge, _)| edge);
            unknowns.iter().any(|unknown| {
                matches!(unknown, Unknown::Flow(id) if self.model.edges[id.index()].id == edge)
            })
        });
        let place = free.and_then(|spec| spec.place.of("free"));
        Diagnostic::new(format!("nothing determines {}", parts.join(" and ")), place)
            .with_hint("what is prescribed must depend on the actuator that is free")
    }

    /// The signals with the prescribed values; nothing else may drive the free actuators.
    pub(super) fn prescribed_signals(
        &mut self,
        prescriptions: &[Prescription],
        commands: &[Option<SignalId>],
        signals: &mut SignalTable,
        writers: &mut HashMap<SignalId, Writer>,
    ) -> Vec<PlannedPrescription> {
        let mut planned = Vec::new();
        for (spec, prescription) in self.model.prescriptions.iter().zip(prescriptions) {
            let unit = match prescription.quantity {
                Quantity::MassFlow(_) => "kg_s",
                _ => "pa",
            };
            let mut signal = free_signal(&format!("{}.value", spec.id), unit, 0.0);
            let word = spec.entry.unit.as_deref();
            let what = spec.place.entry_or(&spec.id).to_owned();
            let Some(unit) = self.driver_unit(word, &signal, &what, &spec.place) else { continue };
            signal.initial = unit.map_or(spec.entry.value, |unit| unit.to_si(spec.entry.value));
            if !signal.initial.is_finite() {
                let message = format!("{what}: value = {} is no number", spec.entry.value);
                self.report(message, spec.place.of("value"), None);
            }
            let signal = self.add_signal(signals, signal, &spec.place);
            if let Some(command) = commands[prescription.free.index()] {
                self.claim(writers, command, signals, &what, spec.place.of("free"));
            }
            planned.push(PlannedPrescription { name: spec.id.clone(), signal });
        }
        planned
    }
}

/// The first few names of a list.
fn few<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const SHOWN: usize = 4;
    let names: Vec<&str> = names.collect();
    let more = names.len().saturating_sub(SHOWN);
    let shown = names[..names.len() - more].join(", ");
    if more > 0 { format!("{shown} and {more} more") } else { shown }
}
