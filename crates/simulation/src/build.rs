//! From names to ids: a model becomes a plan, or all its problems are reported.

use crate::channels;
use crate::diagnostic::{Diagnostic, Diagnostics, did_you_mean};
use crate::drivers::Driver;
use crate::model::{EdgeSpec, Model, Place};
use crate::model_file::NodeEntryKind;
use crate::simulation::{NodeInputs, Plan, PlannedController, PlannedUnit, State};
use anergy_core::clock::Time;
use anergy_core::ids::{EdgeId, NodeId, SignalId};
use anergy_core::recorder::{MapEdge, MapNode, NetworkMap};
use anergy_core::signal::{SignalSpec, SignalTable};
use anergy_core::units::Unit;
use anergy_network::elements::pipe::PipeParams;
use anergy_network::elements::{Element, ElementParams};
use anergy_network::graph::{Edge, GraphProblem, Network, Node, NodeKind};
use anergy_network::interface::{Station, StationState};
use anergy_network::state::NetworkState;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// Turns a model into a plan that can be simulated.
///
/// # Errors
/// All problems of the model: doubled and dangling names, impossible values, signals with two drivers
/// or none, circuits without pressure reference.
pub fn build(model: &Model) -> Result<Arc<Plan>, Diagnostics> {
    let mut builder = Builder { model, problems: Vec::new() };
    builder.check_names();
    let plan = builder.plan();
    match plan {
        Some(plan) if builder.problems.is_empty() => Ok(Arc::new(plan)),
        _ => Err(Diagnostics(builder.problems)),
    }
}

struct Builder<'a> {
    model: &'a Model,
    problems: Vec<Diagnostic>,
}

/// Who writes a signal.
struct Writer {
    what: String,
    span: Option<Range<usize>>,
}

impl Builder<'_> {
    fn report(&mut self, message: String, span: Option<Range<usize>>, hint: Option<String>) {
        let problem = Diagnostic::new(message, span);
        self.problems.push(match hint {
            Some(hint) => problem.with_hint(hint),
            None => problem,
        });
    }

    fn check_names(&mut self) {
        let model = self.model;
        let nodes = model.nodes.iter().map(|node| ("node", &node.entry.id, &node.place));
        self.check_doubled(nodes.collect());
        let others = model
            .edges
            .iter()
            .map(|edge| ("edge", &edge.id, &edge.place))
            .chain(model.units.iter().map(|unit| ("unit", &unit.id, &unit.place)))
            .chain(model.interfaces.iter().map(|i| ("interface", &i.id, &i.place)))
            .chain(model.controllers.iter().map(|c| ("controller", &c.id, &c.place)));
        self.check_doubled(others.collect());
        if model.edges.is_empty() && self.problems.is_empty() {
            let hint = "add a [[trench]], a [[station]] or an [[edge]]".to_owned();
            self.report("the model has no edges".into(), None, Some(hint));
        }
    }

    fn check_doubled(&mut self, named: Vec<(&str, &String, &Place)>) {
        let mut seen: HashMap<&str, &str> = HashMap::new();
        for (what, id, place) in named {
            if let Some(before) = seen.insert(id, what) {
                let message = if before == what {
                    format!("{what} \"{id}\" exists twice")
                } else {
                    format!("{what} \"{id}\" has the name of a {before}")
                };
                let hint = "give one of them another id".to_owned();
                self.report(message, place.span.clone(), Some(hint));
            }
        }
    }

    fn plan(&mut self) -> Option<Plan> {
        let model = self.model;
        let node_ids: HashMap<&str, usize> =
            model.nodes.iter().enumerate().map(|(i, node)| (node.entry.id.as_str(), i)).collect();
        let edge_ids: HashMap<&str, usize> =
            model.edges.iter().enumerate().map(|(i, edge)| (edge.id.as_str(), i)).collect();
        let mut nodes = self.nodes();
        self.references(&mut nodes, &node_ids);
        let edges = self.edges(&node_ids, &edge_ids);
        let ports = self.ports(&edge_ids);
        let whole = edges.len() == model.edges.len();
        let network =
            Network { medium: model.medium, gravity_m_s2: model.gravity_m_s2, nodes, edges, ports };
        if whole && self.problems.is_empty() {
            self.check_graph(&network);
        }
        let mut signals = SignalTable::default();
        let ground = signals.add(temperature_signal("ground.temperature_k", model.ground_k));
        let node_inputs = self.node_signals(&mut signals);
        let commands = if whole {
            edge_signals(model, &network, &mut signals)
        } else {
            vec![None; model.edges.len()]
        };
        let surroundings = self.surroundings(&mut signals, ground);
        let mut writers: HashMap<SignalId, Writer> = HashMap::new();
        let units = self.units(&edge_ids, &network, &commands, &mut signals, &mut writers);
        let stations = self.stations(&edge_ids);
        let controller_signals: Vec<SignalId> = self
            .model
            .controllers
            .iter()
            .map(|spec| {
                // A controller that cannot be built is reported later.
                let set_point = spec.params.build(&()).map_or(0.0, |built| built.set_point());
                signals.add(free_signal(&format!("{}.set_point", spec.id), "", set_point))
            })
            .collect();
        let drivers = self.drivers(&signals, &mut writers);
        let steps = self.run_times();
        if !self.problems.is_empty() || !whole {
            // Controllers measure channels, which need a sound plan.
            return None;
        }
        let initial = self.initial_state(&network, &units, &stations, &signals);
        let mut plan = Plan {
            node_names: model.nodes.iter().map(|node| node.entry.id.clone()).collect(),
            edge_names: model.edges.iter().map(|edge| edge.id.clone()).collect(),
            station_names: model.interfaces.iter().map(|spec| spec.id.clone()).collect(),
            stations,
            units,
            controllers: Vec::new(),
            drivers,
            signals,
            commands,
            node_inputs,
            ground,
            surroundings,
            initial,
            channels: Vec::new(),
            sources: Vec::new(),
            map: map(model),
            model_name: model.name.clone(),
            model_text: model.text.clone(),
            start_unix_ns: start_unix_ns(model),
            step: steps.0,
            record: steps.1,
            until: steps.2,
            network,
        };
        (plan.channels, plan.sources) = channels::channels(&plan);
        self.controllers(&mut plan, &controller_signals, &mut writers);
        Some(plan)
    }

    fn nodes(&mut self) -> Vec<Node> {
        self.model
            .nodes
            .iter()
            .map(|spec| Node {
                kind: match spec.entry.kind {
                    NodeEntryKind::Junction => NodeKind::Junction,
                    NodeEntryKind::PressureBoundary => NodeKind::PressureBoundary,
                    NodeEntryKind::Source => NodeKind::Source,
                },
                elevation_m: spec.entry.elevation_m,
                volume_m3: spec.entry.volume_m3,
            })
            .collect()
    }

    fn references(&mut self, nodes: &mut [Node], node_ids: &HashMap<&str, usize>) {
        for spec in &self.model.references {
            let name = spec.entry.node.as_str();
            let Some(&node) = node_ids.get(name) else {
                let hint = did_you_mean(name, node_ids.keys().copied());
                let message = format!("pressure_reference: there is no node \"{name}\"");
                self.report(message, spec.place.of("node"), hint);
                continue;
            };
            if nodes[node].kind == NodeKind::Junction {
                nodes[node].kind = NodeKind::PressureReference;
            } else {
                let message = format!(
                    "pressure_reference: node \"{name}\" is a boundary or source, or a reference already"
                );
                self.report(message, spec.place.of("node"), None);
            }
        }
    }

    fn edges(
        &mut self,
        node_ids: &HashMap<&str, usize>,
        edge_ids: &HashMap<&str, usize>,
    ) -> Vec<Edge> {
        let mut edges = Vec::with_capacity(self.model.edges.len());
        for spec in &self.model.edges {
            let ends = [("from", &spec.from), ("to", &spec.to)].map(|(field, name)| {
                let found = node_ids.get(name.as_str()).copied();
                if found.is_none() {
                    let hint = did_you_mean(name, node_ids.keys().copied());
                    let message =
                        format!("edge \"{}\": {field} names no node: \"{name}\"", spec.id);
                    self.report(message, spec.place.of(field), hint);
                }
                found
            });
            if spec.from == spec.to && ends[0].is_some() {
                let message = format!("edge \"{}\" begins and ends at \"{}\"", spec.id, spec.to);
                self.report(message, spec.place.span.clone(), None);
            }
            let partner = self.partner(spec, edge_ids);
            match spec.params.build(&self.model.medium) {
                Err(error) => {
                    let span = error
                        .field()
                        .map_or_else(|| spec.place.span.clone(), |field| spec.place.of(field));
                    let message = format!("edge \"{}\" ({}): {error}", spec.id, spec.params.kind());
                    self.report(message, span, None);
                }
                Ok(element) => {
                    if let [Some(from), Some(to)] = ends {
                        edges.push(Edge {
                            from: NodeId::from_index(from),
                            to: NodeId::from_index(to),
                            element,
                            loss_factor: spec.loss_factor,
                            partner: partner.map(|(edge, _)| EdgeId::from_index(edge)),
                            leads_partner: partner.is_some_and(|(_, leads)| leads),
                        });
                    }
                }
            }
        }
        edges
    }

    /// The other side of a heat exchanger, and whether this side's UA counts.
    fn partner(
        &mut self,
        spec: &EdgeSpec,
        edge_ids: &HashMap<&str, usize>,
    ) -> Option<(usize, bool)> {
        let ElementParams::HeatExchanger(exchanger) = &spec.params else { return None };
        if let Some(name) = &exchanger.partner {
            let Some(&other) = edge_ids.get(name.as_str()) else {
                let hint = did_you_mean(name, edge_ids.keys().copied());
                let message = format!("edge \"{}\": partner names no edge: \"{name}\"", spec.id);
                self.report(message, spec.place.of("partner"), hint);
                return None;
            };
            let other_params = &self.model.edges[other].params;
            let mutual = match other_params {
                ElementParams::HeatExchanger(other) => other.partner.is_some(),
                _ => true,
            };
            if mutual || *name == spec.id {
                let message = format!(
                    "edge \"{}\": partner \"{name}\" must be another heat_exchanger without a partner \
                     of its own",
                    spec.id
                );
                self.report(message, spec.place.of("partner"), None);
                return None;
            }
            return Some((other, true));
        }
        let lead = self.model.edges.iter().position(|edge| {
            matches!(&edge.params, ElementParams::HeatExchanger(x)
                if x.partner.as_deref() == Some(spec.id.as_str()))
        });
        lead.map(|lead| (lead, false))
    }

    fn ports(&mut self, edge_ids: &HashMap<&str, usize>) -> Vec<EdgeId> {
        let mut taken: HashMap<usize, &str> = HashMap::new();
        let mut ports = Vec::new();
        for spec in &self.model.units {
            let Some(&edge) = edge_ids.get(spec.port.as_str()) else {
                let hint = did_you_mean(&spec.port, edge_ids.keys().copied());
                let message =
                    format!("unit \"{}\": port names no edge: \"{}\"", spec.id, spec.port);
                self.report(message, spec.place.of("port"), hint);
                continue;
            };
            if let Some(before) = taken.insert(edge, &spec.id) {
                let message = format!(
                    "units \"{before}\" and \"{}\" stand on the same interface \"{}\"",
                    spec.id, spec.port
                );
                let hint = "give the site a second station, or one of the units another one";
                self.report(message, spec.place.span.clone(), Some(hint.into()));
            }
            let params = &self.model.edges[edge].params;
            let fits =
                matches!(params, ElementParams::HeatExchanger(_) | ElementParams::FlowSource(_));
            if !fits {
                let message =
                    format!("unit \"{}\": a {} cannot carry a unit", spec.id, params.kind());
                let hint = "a unit stands behind a heat_exchanger or on a flow_source";
                self.report(message, spec.place.of("port"), Some(hint.into()));
            }
            ports.push(EdgeId::from_index(edge));
        }
        ports
    }

    fn check_graph(&mut self, network: &Network) {
        let name = |id: &NodeId| self.model.nodes[id.index()].entry.id.clone();
        let mut found = Vec::new();
        for problem in network.problems() {
            found.push(match problem {
                GraphProblem::NoPressureReference { circuit } => {
                    let names: Vec<String> = circuit.iter().take(4).map(name).collect();
                    let more = circuit.len().saturating_sub(4);
                    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                    Diagnostic::new(
                        format!(
                            "the circuit of {}{more} has no pressure reference",
                            names.join(", ")
                        ),
                        self.model.nodes[circuit[0].index()].place.span.clone(),
                    )
                    .with_hint(format!("add [[pressure_reference]] with node = \"{}\"", names[0]))
                }
                GraphProblem::SeveralReferences { references } => {
                    let names: Vec<String> = references.iter().map(name).collect();
                    Diagnostic::new(
                        format!(
                            "one circuit has {} pressure references: {}",
                            names.len(),
                            names.join(", ")
                        ),
                        self.reference_place(&names[1]),
                    )
                    .with_hint(
                        "keep one, or make open ends nodes with kind = \"pressure_boundary\"",
                    )
                }
                GraphProblem::ReferenceAndBoundary { reference, boundary } => Diagnostic::new(
                    format!(
                        "one circuit has the pressure reference \"{}\", which exchanges no water, and \
                         the pressure boundary \"{}\", which does",
                        name(&reference),
                        name(&boundary)
                    ),
                    self.reference_place(&name(&reference)),
                )
                .with_hint("keep one of them"),
                GraphProblem::IdealLoop { edge } => Diagnostic::new(
                    format!(
                        "edge \"{}\" closes a loop of pressure sources and fixed pressures alone",
                        self.model.edges[edge.index()].id
                    ),
                    self.model.edges[edge.index()].place.span.clone(),
                )
                .with_hint("put a resistance into the loop"),
            });
        }
        self.problems.extend(found);
    }

    fn reference_place(&self, node: &str) -> Option<Range<usize>> {
        let spec = self.model.references.iter().find(|spec| spec.entry.node == node)?;
        spec.place.of("node")
    }

    fn node_signals(&mut self, signals: &mut SignalTable) -> Vec<NodeInputs> {
        let mut inputs = Vec::new();
        for (node, spec) in self.model.nodes.iter().enumerate() {
            let entry = &spec.entry;
            let held = self.model.references.iter().find(|r| r.entry.node == entry.id);
            let pressure = held.map(|r| r.entry.pressure_pa).or(entry.pressure_pa);
            let mut add = |quantity: &str, unit: &'static str, value: f64| {
                signals.add(free_signal(&format!("{}.{quantity}", entry.id), unit, value))
            };
            let exchanges = entry.kind != NodeEntryKind::Junction;
            if held.is_some() || exchanges {
                let of_kind = |kind| entry.kind == kind;
                let p_pa = (held.is_some() || of_kind(NodeEntryKind::PressureBoundary))
                    .then(|| add("pressure_pa", "pa", pressure.unwrap_or(0.0)));
                let m_flow_kg_s = of_kind(NodeEntryKind::Source)
                    .then(|| add("m_flow_kg_s", "kg_s", entry.m_flow_kg_s.unwrap_or(0.0)));
                let t_k = exchanges.then(|| {
                    let value = entry.temperature_k.unwrap_or(self.model.run.initial_k);
                    signals.add(temperature_signal(&format!("{}.temperature_k", entry.id), value))
                });
                inputs.push(NodeInputs { node, p_pa, m_flow_kg_s, t_k });
            }
        }
        inputs
    }

    fn surroundings(&mut self, signals: &mut SignalTable, ground: SignalId) -> Vec<SignalId> {
        self.model
            .edges
            .iter()
            .map(|spec| match &spec.params {
                ElementParams::Pipe(pipe) => pipe.surroundings_k.map_or(ground, |t_k| {
                    signals.add(temperature_signal(&format!("{}.surroundings_k", spec.id), t_k))
                }),
                _ => ground,
            })
            .collect()
    }

    fn units(
        &mut self,
        edge_ids: &HashMap<&str, usize>,
        network: &Network,
        commands: &[Option<SignalId>],
        signals: &mut SignalTable,
        writers: &mut HashMap<SignalId, Writer>,
    ) -> Vec<PlannedUnit> {
        let mut units = Vec::new();
        let (mut state_len, mut output_len) = (0, 0);
        for (port, spec) in self.model.units.iter().enumerate() {
            let equipment = match spec.params.build(&self.model.medium) {
                Ok(equipment) => equipment,
                Err(error) => {
                    let span = error
                        .field()
                        .map_or_else(|| spec.place.span.clone(), |field| spec.place.of(field));
                    let message = format!("unit \"{}\" ({}): {error}", spec.id, spec.params.kind());
                    self.report(message, span, None);
                    continue;
                }
            };
            let Some(&edge) = edge_ids.get(spec.port.as_str()) else { continue };
            let first = signals.specs().len();
            for input in equipment.inputs() {
                signals.add(SignalSpec {
                    name: format!("{}.{}", spec.id, input.name),
                    unit: input.unit,
                    initial: input.initial,
                    min: input.min,
                    max: f64::INFINITY,
                });
            }
            let imposes_flow = network
                .edges
                .get(edge)
                .filter(|edge| matches!(edge.element, Element::FlowSource(_)))
                .and_then(|_| commands[edge]);
            if let Some(command) = imposes_flow {
                let what = format!("unit \"{}\"", spec.id);
                writers.insert(command, Writer { what, span: spec.place.span.clone() });
            }
            let states = equipment.initial_state(self.model.run.initial_k).len();
            let outputs = equipment.outputs().len();
            units.push(PlannedUnit {
                name: spec.id.clone(),
                equipment,
                port,
                imposes_flow,
                inputs: first..signals.specs().len(),
                state: state_len..state_len + states,
                outputs: output_len..output_len + outputs,
            });
            state_len += states;
            output_len += outputs;
        }
        units
    }

    fn stations(&mut self, edge_ids: &HashMap<&str, usize>) -> Vec<Station> {
        let mut stations = Vec::new();
        for spec in &self.model.interfaces {
            let mut find = |name: &str| {
                let found = edge_ids.get(name).copied();
                if found.is_none() {
                    let hint = did_you_mean(name, edge_ids.keys().copied());
                    let message = format!("interface \"{}\": there is no edge \"{name}\"", spec.id);
                    self.report(message, spec.place.span.clone(), hint);
                }
                found
            };
            let edge = find(&spec.edge);
            let pump = spec.pump.as_deref().and_then(find);
            if let Some(flow) = spec.requested_flow_m3_s.filter(|flow| *flow <= 0.0) {
                let message = format!(
                    "interface \"{}\": requested_flow_m3_s = {flow} must be positive",
                    spec.id
                );
                self.report(message, spec.place.of("requested_flow_m3_s"), None);
            }
            if let Some(edge) = edge {
                stations.push(Station {
                    edge: EdgeId::from_index(edge),
                    pump: pump.map(EdgeId::from_index),
                    requested_m_flow_kg_s: spec
                        .requested_flow_m3_s
                        .map(|flow| flow * self.model.medium.density_kg_m3),
                });
            }
        }
        stations
    }

    fn drivers(
        &mut self,
        signals: &SignalTable,
        writers: &mut HashMap<SignalId, Writer>,
    ) -> Vec<Driver> {
        let mut drivers = Vec::new();
        for spec in &self.model.drivers {
            let Some(signal) = signals.find(&spec.signal) else {
                let names = signals.specs().iter().map(|signal| signal.name.as_str());
                let hint = did_you_mean(&spec.signal, names)
                    .unwrap_or_else(|| "`anergy check --signals` lists all signals".into());
                let message = format!("{}: there is no such signal", spec.source);
                self.report(message, spec.place.of("signal"), Some(hint));
                continue;
            };
            self.claim(writers, signal, signals, &spec.source, spec.place.of("signal"));
            let known = signals.spec(signal);
            let Some(unit) =
                self.driver_unit(spec.unit.as_deref(), known, &spec.source, &spec.place)
            else {
                continue;
            };
            let values: Vec<f64> = spec
                .values
                .iter()
                .map(|value| unit.map_or(*value, |unit| unit.to_si(*value)))
                .collect();
            if let Some(i) = values.iter().position(|v| !(known.min..=known.max).contains(v)) {
                let message = format!(
                    "{}: value {} at {} s is outside {} to {}",
                    spec.source, spec.values[i], spec.times_s[i], known.min, known.max
                );
                let span =
                    spec.place.of(if spec.place.has("points") { "points" } else { "column" });
                self.report(message, span, None);
                continue;
            }
            let times: Option<Vec<Time>> = spec.times_s.iter().map(|s| Time::from_s(*s)).collect();
            let Some(times) = times else {
                let message = format!("{}: a time is beyond what can be simulated", spec.source);
                self.report(message, spec.place.span.clone(), None);
                continue;
            };
            drivers.push(Driver { signal, interpolation: spec.interpolation, times, values });
        }
        drivers
    }

    /// A signal has one writer.
    fn claim(
        &mut self,
        writers: &mut HashMap<SignalId, Writer>,
        signal: SignalId,
        signals: &SignalTable,
        what: &str,
        span: Option<Range<usize>>,
    ) {
        let writer = Writer { what: what.to_owned(), span: span.clone() };
        if let Some(before) = writers.insert(signal, writer) {
            let name = &signals.spec(signal).name;
            let message = format!("signal \"{name}\" is driven by {} and by {what}", before.what);
            self.report(message, span.or(before.span), Some("a signal has one driver".into()));
        }
    }

    /// The unit a driver's values are written in; the outer `None` after a report.
    fn driver_unit(
        &mut self,
        unit: Option<&str>,
        signal: &SignalSpec,
        source: &str,
        place: &Place,
    ) -> Option<Option<Unit>> {
        let Some(word) = unit else { return Some(None) };
        let suffix = word.trim().to_lowercase().replace('/', "_").replace('%', "percent");
        let si = if signal.unit.is_empty() { "1" } else { signal.unit };
        if suffix == si {
            return Some(None);
        }
        let found = Unit::find(&suffix);
        if let Some(unit) = found.filter(|unit| unit.si == signal.unit) {
            return Some(Some(unit));
        }
        let possible: Vec<&str> = anergy_core::units::UNITS
            .iter()
            .filter(|unit| unit.si == signal.unit)
            .map(|unit| unit.suffix)
            .chain(std::iter::once(si))
            .collect();
        let message = format!("{source}: unit \"{word}\" does not fit the signal");
        let hint = format!("possible units: {}", possible.join(", "));
        self.report(message, place.of("unit"), Some(hint));
        None
    }

    fn controllers(
        &mut self,
        plan: &mut Plan,
        set_points: &[SignalId],
        writers: &mut HashMap<SignalId, Writer>,
    ) {
        let mut state_len = 0;
        for (spec, set_point) in self.model.controllers.iter().zip(set_points) {
            let what = format!("controller \"{}\"", spec.id);
            let controller = spec.params.build(&());
            if let Err(error) = &controller {
                let span = error
                    .field()
                    .map_or_else(|| spec.place.span.clone(), |field| spec.place.of(field));
                self.report(format!("{what}: {error}"), span, None);
            }
            let measured = plan.channels.iter().position(|c| c.name == spec.measures);
            if measured.is_none() {
                let hint =
                    did_you_mean(&spec.measures, plan.channels.iter().map(|c| c.name.as_str()));
                let message =
                    format!("{what} measures \"{}\", which does not exist", spec.measures);
                self.report(message, spec.place.span.clone(), hint);
            }
            let acts_on = plan.signals.find(&spec.acts_on);
            match acts_on {
                None => {
                    let names = plan.signals.specs().iter().map(|signal| signal.name.as_str());
                    let hint = did_you_mean(&spec.acts_on, names);
                    let message =
                        format!("{what} acts on \"{}\", which does not exist", spec.acts_on);
                    self.report(message, spec.place.span.clone(), hint);
                }
                Some(signal) => {
                    self.claim(writers, signal, &plan.signals, &what, spec.place.span.clone());
                }
            }
            let (Ok(controller), Some(measured), Some(acts_on)) = (controller, measured, acts_on)
            else {
                continue;
            };
            let state = controller.initial_state();
            let interval = Time::from_s(controller.interval_s()).unwrap_or(Time::ZERO);
            plan.controllers.push(PlannedController {
                name: spec.id.clone(),
                controller,
                measures: plan.sources[measured],
                set_point: *set_point,
                acts_on,
                interval,
                state: state_len..state_len + state.len(),
            });
            state_len += state.len();
            plan.initial.controller_states.extend(state);
            plan.initial.next_tick.push(Time::ZERO);
            plan.initial.last_tick.push(Time::ZERO);
        }
    }

    fn run_times(&mut self) -> (Time, Time, Time) {
        let run = &self.model.run;
        (run.step.0, run.record.0, run.until.0)
    }

    fn initial_state(
        &self,
        network: &Network,
        units: &[PlannedUnit],
        stations: &[Station],
        signals: &SignalTable,
    ) -> State {
        let initial_k = self.model.run.initial_k;
        let mut state = NetworkState::new(network, initial_k);
        for (i, spec) in self.model.edges.iter().enumerate() {
            if let ElementParams::Pipe(PipeParams { initial_k: Some(t_k), .. }) = &spec.params {
                state.parcels.fill(i, *t_k);
            }
        }
        // A cold solve starts from the pressure level of the model.
        let level = self.model.references.first().map_or(0.0, |r| r.entry.pressure_pa);
        state.p_pa.fill(level);
        State {
            time: Time::ZERO,
            network: state,
            signals: signals.initial_values(),
            taken_over: vec![false; signals.specs().len()],
            unit_states: units
                .iter()
                .flat_map(|unit| unit.equipment.initial_state(initial_k))
                .collect(),
            unit_outputs: vec![0.0; units.last().map_or(0, |unit| unit.outputs.end)],
            stations: vec![StationState::default(); stations.len()],
            station_heat_j: vec![0.0; stations.len()],
            controller_states: Vec::new(),
            next_tick: Vec::new(),
            last_tick: Vec::new(),
            electric_j: 0.0,
            units_j: 0.0,
            loss_j: 0.0,
            boundary_j: 0.0,
            pump_hydraulic_j: 0.0,
            dissipated_j: 0.0,
            initial_stored_j: 0.0,
            largest_mass_residual_kg_s: 0.0,
            steps: 0,
            solves: 0,
            iterations: 0,
        }
    }
}

/// A command signal for every element with an actuator.
fn edge_signals(
    model: &Model,
    network: &Network,
    signals: &mut SignalTable,
) -> Vec<Option<SignalId>> {
    model
        .edges
        .iter()
        .zip(&network.edges)
        .map(|(spec, edge)| {
            edge.element.actuator().map(|actuator| {
                signals.add(SignalSpec {
                    name: format!("{}.{}", spec.id, actuator.command),
                    unit: actuator.unit,
                    initial: actuator.initial_command,
                    min: actuator.min,
                    max: actuator.max,
                })
            })
        })
        .collect()
}

fn free_signal(name: &str, unit: &'static str, initial: f64) -> SignalSpec {
    SignalSpec { name: name.to_owned(), unit, initial, min: f64::NEG_INFINITY, max: f64::INFINITY }
}

fn temperature_signal(name: &str, initial: f64) -> SignalSpec {
    SignalSpec { name: name.to_owned(), unit: "k", initial, min: 173.15, max: 473.15 }
}

fn start_unix_ns(model: &Model) -> i64 {
    let start = model.run.start.as_ref().and_then(|text| text.parse::<jiff::Timestamp>().ok());
    start.and_then(|start| i64::try_from(start.as_nanosecond()).ok()).unwrap_or(0)
}

fn map(model: &Model) -> NetworkMap {
    NetworkMap {
        nodes: model
            .nodes
            .iter()
            .map(|spec| MapNode {
                id: spec.entry.id.clone(),
                site: spec.site.clone(),
                x_m: spec.entry.x_m,
                y_m: spec.entry.y_m,
            })
            .collect(),
        edges: model
            .edges
            .iter()
            .map(|spec| MapEdge {
                id: spec.id.clone(),
                kind: spec.params.kind().to_owned(),
                from: spec.from.clone(),
                to: spec.to.clone(),
                length_m: match &spec.params {
                    ElementParams::Pipe(pipe) => pipe.length_m,
                    _ => 0.0,
                },
                station: spec.station.clone(),
            })
            .collect(),
    }
}
