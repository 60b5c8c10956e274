//! Self-acting valves of a model, what they sense, and the signals of their set values.

use super::Builder;
use crate::diagnostic::did_you_mean;
use anergy_core::ids::{EdgeId, NodeId, SignalId};
use anergy_core::signal::{SignalSpec, SignalTable};
use anergy_network::elements::ElementParams;
use anergy_network::graph::{Edge, Regulator};
use smol_str::format_smolstr;
use std::collections::HashMap;

impl Builder<'_> {
    /// The self-acting valves, in the order of their edges.
    pub(super) fn regulators(
        &mut self,
        node_ids: &HashMap<&str, usize>,
        edges: &[Edge],
    ) -> Vec<Regulator> {
        let mut regulators = Vec::new();
        for (i, (spec, edge)) in self.model.edges.iter().zip(edges).enumerate() {
            let Some(regulation) = edge.element.regulation() else { continue };
            let what = format!("edge \"{}\" ({})", spec.id, spec.params.kind());
            let mut find = |field: &str, name: &str| {
                let found = node_ids.get(name).map(|&node| NodeId::from_index(node));
                if found.is_none() {
                    let hint = did_you_mean(name, node_ids.keys().copied());
                    let message = format!("{what}: {field} names no node: \"{name}\"");
                    self.report(message, spec.place.of(field), hint);
                }
                found
            };
            let (high, low) = match &spec.params {
                ElementParams::DpController(params) => {
                    let high = find("high_node", &params.high_node);
                    let low = find("low_node", &params.low_node);
                    if high.is_some() && high == low {
                        let message = format!("{what}: high_node and low_node are the same node");
                        let hint = "it senses the pressure difference between two nodes".to_owned();
                        self.report(message, spec.place.of("low_node"), Some(hint));
                    }
                    (high, low)
                }
                ElementParams::PressureReducingValve(params) => {
                    let sensed = params.sensed_node.as_deref();
                    (sensed.map_or(Some(edge.to), |name| find("sensed_node", name)), None)
                }
                ElementParams::PressureSustainingValve(params) => {
                    let sensed = params.sensed_node.as_deref();
                    (sensed.map_or(Some(edge.from), |name| find("sensed_node", name)), None)
                }
                _ => continue,
            };
            if let Some(high) = high {
                regulators.push(Regulator { edge: EdgeId::from_index(i), high, low, regulation });
            }
        }
        regulators
    }

    /// The signals of their set values.
    pub(super) fn regulator_signals(
        &mut self,
        regulators: &[Regulator],
        signals: &mut SignalTable,
    ) -> Vec<SignalId> {
        regulators
            .iter()
            .map(|regulator| {
                let spec = &self.model.edges[regulator.edge.index()];
                let signal = SignalSpec {
                    name: format_smolstr!("{}.{}", spec.id, regulator.regulation.name),
                    unit: "pa",
                    initial: regulator.regulation.set_pa,
                    min: 0.0,
                    max: f64::INFINITY,
                };
                self.add_signal(signals, signal, &spec.place)
            })
            .collect()
    }
}
