//! Units: their ports on edges and in circuits, and their signals.

use super::Builder;
use super::signals::{Writer, temperature_signal};
use crate::diagnostic::did_you_mean;
use crate::model::UnitSpec;
use crate::model_file::InterfaceEntry;
use crate::plan::{GridPort, PlannedCircuit, PlannedCoupling, PlannedUnit};
use crate::temperatures::SURROUNDINGS;
use crate::wording::refused;
use anergy_core::clock::NS_PER_S;
use anergy_core::ids::{EdgeId, SignalId};
use anergy_core::signal::{SignalSpec, SignalTable};
use anergy_network::elements::{Element, ElementParams};
use anergy_network::graph::Network;
use anergy_prosumer::equipment::Equipment;
use anergy_prosumer::thermal_unit::{START_UNIX, UnitPort};
use smol_str::{SmolStr, format_smolstr};
use std::collections::HashMap;
use std::ops::Range;

/// Units that could be built, and where their ports are.
pub(super) struct Houses {
    /// In the order of the model; `None` after a report.
    pub equipment: Vec<Option<Equipment>>,
    pub ports: Vec<Vec<UnitPort>>,
    pub slots: Vec<Range<usize>>,
    /// Those that are closed in themselves, and those that meet in points.
    pub circuits: Vec<PlannedCircuit>,
    pub couplings: Vec<PlannedCoupling>,
    /// Whether all circuits of the model could be built.
    pub circuits_whole: bool,
    pub grid_ports: Vec<GridPort>,
    /// Edge of each grid port.
    pub edges: Vec<EdgeId>,
    pub by_name: HashMap<SmolStr, usize>,
}

impl Houses {
    /// Number of slots.
    fn slots(&self) -> usize {
        self.slots.last().map_or(0, |slots| slots.end)
    }
}

impl Builder<'_> {
    /// Builds the units and finds the place of each of their ports.
    pub(super) fn houses(&mut self, edge_ids: &HashMap<&str, usize>) -> Houses {
        let units = &self.model.units;
        let equipment: Vec<_> = units.iter().map(|spec| self.equipment(spec)).collect();
        let ports: Vec<_> = equipment
            .iter()
            .map(|unit| unit.as_ref().map_or(Vec::new(), |unit| unit.ports()))
            .collect();
        let mut end = 0;
        let slots = ports.iter().map(|ports| {
            let first = end;
            end += ports.len();
            first..end
        });
        let slots = slots.collect();
        let mut houses = Houses {
            equipment,
            ports,
            slots,
            circuits: Vec::new(),
            couplings: Vec::new(),
            circuits_whole: true,
            grid_ports: Vec::new(),
            edges: Vec::new(),
            by_name: units.iter().enumerate().map(|(i, unit)| (unit.id.clone(), i)).collect(),
        };
        let mut circuit_of: Vec<Option<&str>> = vec![None; houses.slots()];
        let mut branches = Vec::new();
        for spec in &self.model.circuits {
            match (self.circuit(spec, &houses, &mut circuit_of), &spec.branch) {
                (None, _) => houses.circuits_whole = false,
                (Some(circuit), None) => houses.circuits.push(circuit),
                (Some(circuit), Some(branch)) => branches.push((spec, branch, circuit)),
            }
        }
        if houses.circuits_whole {
            houses.couplings = self.couplings(branches);
        }
        houses.circuits.sort_by_key(|circuit| circuit.leads.is_empty());
        self.grid_ports(&mut houses, &circuit_of, edge_ids);
        houses
    }

    fn equipment(&mut self, spec: &UnitSpec) -> Option<Equipment> {
        let named = spec.params.named(&spec.id);
        match named.as_ref().unwrap_or(&spec.params).build(&self.model.medium) {
            Ok(equipment) => Some(equipment),
            Err(error) => {
                let what = format!("unit \"{}\" ({})", spec.id, spec.params.kind());
                let mut problem = refused(&what, &spec.place, error.field(), &error.to_string());
                let hint =
                    error.field().and_then(|field| self.liquid().unit_hint(field, &spec.place));
                problem.hint = problem.hint.or(hint);
                self.problems.push(problem);
                None
            }
        }
    }

    /// Ports that are in no circuit stand on an edge.
    fn grid_ports(
        &mut self,
        houses: &mut Houses,
        circuit_of: &[Option<&str>],
        edge_ids: &HashMap<&str, usize>,
    ) {
        let mut taken: HashMap<usize, &str> = HashMap::new();
        for (unit, spec) in self.model.units.iter().enumerate() {
            if houses.equipment[unit].is_none() {
                continue;
            }
            let what = format!("unit \"{}\"", spec.id);
            let mut left = houses.slots[unit].clone().filter(|slot| circuit_of[*slot].is_none());
            let (first, more) = (left.next(), left.next());
            let Some(slot) = first else {
                // The site may have a station that is another unit's.
                let given = ["station", "port"].into_iter().find(|field| spec.place.has(field));
                if let Some(field) = given {
                    let message = format!("{what}: all its ports are in circuits");
                    let hint = format!("leave `{field}` out, or one of the ports");
                    self.report(message, spec.place.of(field), Some(hint));
                }
                continue;
            };
            let name =
                |slot: usize| houses.ports[unit][slot - houses.slots[unit].start].name.clone();
            if more.is_some() || spec.port.is_empty() {
                if !houses.circuits_whole {
                    // One that is wrong may be that of the port.
                    continue;
                }
                let free = match more {
                    Some(more) => format!("ports \"{}\" and \"{}\" are", name(slot), name(more)),
                    None => format!("port \"{}\" is", name(slot)),
                };
                let message = format!("{what}: its {free} in no circuit");
                let hint = match spec.port.is_empty() {
                    true => "pass it by a [[circuit]], or give the site a [[station]] for it",
                    false => {
                        "one port can stand behind the station: pass the others by a [[circuit]]"
                    }
                };
                self.report(message, spec.place.span.range(), Some(hint.into()));
                continue;
            }
            let Some(&edge) = edge_ids.get(spec.port.as_str()) else {
                let hint = did_you_mean(&spec.port, edge_ids.keys().copied());
                let message = format!("{what}: port names no edge: \"{}\"", spec.port);
                self.report(message, spec.place.of("port"), hint);
                continue;
            };
            if let Some(before) = taken.insert(edge, &spec.id) {
                let message = format!(
                    "units \"{before}\" and \"{}\" stand on the same interface \"{}\"",
                    spec.id, spec.port
                );
                let hint = "give the site a second station, or one of the units another one";
                self.report(message, spec.place.span.range(), Some(hint.into()));
            }
            let port = slot - houses.slots[unit].start;
            let sets_flow = houses.ports[unit][port].sets_flow;
            self.check_carrier(spec, sets_flow, edge);
            let takes = houses.equipment[unit].as_ref().is_some_and(|unit| unit.takes_heat(port));
            let direction = if takes { -1.0 } else { 1.0 };
            houses.grid_ports.push(GridPort { unit, slot, direction, imposes_flow: None });
            houses.edges.push(EdgeId::from_index(edge));
        }
    }

    /// A unit that sets the flow stands where it can be set, one that takes what comes where something comes.
    fn check_carrier(&mut self, spec: &UnitSpec, sets_flow: bool, edge: usize) {
        let (unit, model) = (spec.params.kind(), self.model);
        let carrier = &model.edges[edge];
        let (fits, hint) = match (&carrier.params, sets_flow) {
            (ElementParams::HeatExchanger(_) | ElementParams::FlowSource(_), true) => (true, ""),
            (ElementParams::Resistance(_), true) => {
                let driven =
                    |i: &InterfaceEntry| i.feed_in_set.is_some() || i.extraction_set.is_some();
                let driven =
                    model.interfaces.iter().any(|i| i.entry.edge == carrier.id && driven(&i.entry));
                (
                    driven,
                    "its flow is set by the unit: give the site a [[station]] of kind \"prosumer\"",
                )
            }
            (_, true) => (false, "a unit stands behind a heat_exchanger or on a flow_source"),
            (params, false) => (
                matches!(params, ElementParams::Resistance(_)),
                "it stands on a resistance, through which its water passes",
            ),
        };
        if !fits {
            let edge = carrier.params.kind();
            let (message, hint) = match sets_flow {
                true => {
                    (format!("unit \"{}\": a {edge} cannot carry a unit", spec.id), hint.into())
                }
                false => (
                    format!("unit \"{}\": a {edge} cannot carry a {unit}", spec.id),
                    hint.replacen("it", &format!("a {unit}"), 1),
                ),
            };
            self.report(message, spec.place.of("port"), Some(hint));
        }
    }

    /// The units with their signals.
    pub(super) fn units(
        &mut self,
        houses: &mut Houses,
        network: &Network,
        commands: &[Option<SignalId>],
        signals: &mut SignalTable,
        writers: &mut HashMap<SignalId, Writer>,
    ) -> Vec<PlannedUnit> {
        let mut units = Vec::new();
        let (mut state_len, mut output_len) = (0, 0);
        for (i, spec) in self.model.units.iter().enumerate() {
            let Some(equipment) = houses.equipment[i].take() else { continue };
            let first = signals.specs().len();
            for mut input in equipment.inputs() {
                if input.follows == Some(START_UNIX) {
                    input.initial = super::start_unix_ns(self.model) as f64 / NS_PER_S as f64;
                }
                let name = format!("{}.{}", spec.id, input.name);
                let around = ["outdoor", "ambient", "ground"];
                let around = around.iter().any(|word| input.name.contains(word));
                let signal = if input.unit == "k" && !input.name.contains("difference") {
                    let range = if around { SURROUNDINGS } else { self.liquid() };
                    temperature_signal(&name, input.initial, &range)
                } else {
                    SignalSpec {
                        name: name.into(),
                        unit: input.unit,
                        initial: input.initial,
                        min: input.min,
                        max: input.max,
                    }
                };
                self.add_signal(signals, signal, &spec.place);
            }
            let states = equipment.initial_state(self.model.run.initial_k).len();
            let outputs = equipment.outputs().len();
            units.push(PlannedUnit {
                name: spec.id.clone(),
                equipment,
                ports: std::mem::take(&mut houses.ports[i]),
                slots: houses.slots[i].clone(),
                inputs: first..signals.specs().len(),
                state: state_len..state_len + states,
                outputs: output_len..output_len + outputs,
                turn: 0,
            });
            state_len += states;
            output_len += outputs;
        }
        for (port, edge) in houses.grid_ports.iter_mut().zip(&houses.edges) {
            let imposes = network.edges.get(edge.index());
            let imposes = imposes.filter(|edge| matches!(edge.element, Element::FlowSource(_)));
            port.imposes_flow = imposes.and_then(|_| commands[edge.index()]);
            if let Some(command) = port.imposes_flow {
                let spec = &self.model.units[port.unit];
                let what = format_smolstr!("unit \"{}\"", spec.id);
                writers.insert(command, Writer { what, span: spec.place.span });
            }
        }
        let branches = houses.couplings.iter_mut().flat_map(|coupling| &mut coupling.circuits);
        for circuit in houses.circuits.iter_mut().chain(branches) {
            let spec = self.model.circuits.iter().find(|spec| spec.id == circuit.name);
            if let Some((spec, initial)) = spec.and_then(|spec| Some((spec, spec.v_flow_m3_s?))) {
                let name = format!("{}.v_flow_m3_s", spec.id);
                let signal = SignalSpec {
                    name: name.into(),
                    unit: "m3_s",
                    initial,
                    min: 0.0,
                    max: f64::INFINITY,
                };
                circuit.v_flow = Some(self.add_signal(signals, signal, &spec.place));
            }
        }
        units
    }

    /// Inputs that follow another signal where nothing else drives them: to, from.
    pub(super) fn follows(
        &self,
        units: &[PlannedUnit],
        signals: &SignalTable,
        writers: &HashMap<SignalId, Writer>,
    ) -> Vec<(SignalId, SignalId)> {
        let inputs = units.iter().flat_map(|unit| {
            let ids = unit.inputs.clone().map(SignalId::from_index);
            ids.zip(unit.equipment.inputs())
        });
        let follows = inputs.filter_map(|(to, input)| {
            let from = signals.find(input.follows?)?;
            (!writers.contains_key(&to)).then_some((to, from))
        });
        follows.collect()
    }
}
