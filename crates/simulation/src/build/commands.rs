//! The command signals of actuators: one each, or one for several valves.

use super::Builder;
use crate::model::EdgeSpec;
use crate::plan::{Plan, Target};
use crate::simulation::Missed;
use anergy_core::ids::SignalId;
use anergy_core::signal::{SignalSpec, SignalTable};
use anergy_network::elements::{Element, ElementParams};
use anergy_network::graph::Network;
use std::collections::HashMap;

impl Builder<'_> {
    /// A command signal for every element with an actuator.
    pub(super) fn edge_signals(
        &mut self,
        network: &Network,
        signals: &mut SignalTable,
    ) -> Vec<Option<SignalId>> {
        let mut commands = Vec::with_capacity(network.edges.len());
        let mut shared: HashMap<String, SignalId> = HashMap::new();
        for (spec, edge) in self.model.edges.iter().zip(&network.edges) {
            let common = match &spec.params {
                ElementParams::Valve(valve) => valve.command_of.as_deref(),
                _ => None,
            };
            commands.push(edge.element.actuator().map(|actuator| {
                let name = format!("{}.{}", common.unwrap_or(&spec.id), actuator.command);
                if let Some(&id) = shared.get(&name) {
                    self.check_shared(spec, &name, actuator.initial_command, signals.spec(id));
                    return id;
                }
                let signal = SignalSpec {
                    name: name.as_str().into(),
                    unit: actuator.unit,
                    initial: actuator.initial_command,
                    min: actuator.min,
                    max: actuator.max,
                };
                let id = self.add_signal(signals, signal, &spec.place);
                if common.is_some() {
                    shared.insert(name, id);
                }
                id
            }));
        }
        commands
    }

    /// What is to be held: by pumps whose command is not left free, and by controllers.
    pub(super) fn targets(&mut self, plan: &mut Plan) {
        let holds = |edge: usize| matches!(&plan.network.edges[edge].element, Element::Pump(pump) if pump.holds());
        let pumps = (0..plan.commands.len()).filter(|&i| plan.commands[i].is_some() && holds(i));
        let pumps = pumps.map(Target::Pump);
        let controllers =
            plan.controllers.iter().enumerate().filter(|(_, planned)| planned.controller.tracks());
        let controllers = controllers.map(|(i, _)| Target::Controller(i));
        plan.targets = pumps.chain(controllers).collect();
        plan.initial.missed = vec![Missed::default(); plan.targets.len()];
    }

    /// Valves with one command begin with the same one.
    fn check_shared(&mut self, edge: &EdgeSpec, name: &str, command: f64, shared: &SignalSpec) {
        if command != shared.initial {
            let what = format!("edge \"{}\"", edge.id);
            let what = edge.place.entry_or(&what);
            let message = format!(
                "{what}: begins with {command}, but the other valve of \"{name}\" with {}",
                shared.initial
            );
            let hint = "valves that share a command need the same initial one".to_owned();
            self.report(message, edge.place.span.range(), Some(hint));
        }
    }
}
