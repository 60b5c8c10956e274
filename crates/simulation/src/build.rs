//! From names to ids: a model becomes a plan, or all its problems are reported.

mod circuits;
mod commands;
mod control;
mod couplings;
mod losses;
mod meters;
mod network;
mod prescribed;
mod pressure;
mod pulses;
mod regulators;
mod rules;
mod signals;
mod site_inputs;
mod stations;
mod units;
mod weather;

pub(crate) use network::pipe_temperatures;

use crate::automatic_step::{AutomaticStep, Step};
use crate::channels;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::kpi;
use crate::model::{Model, Place};
use crate::model_file::InitialState;
use crate::plan::{self, EdgeOnMap, Ends, NodeOnMap, Plan, PlannedUnit};
use crate::simulation::{SwingState, watches};
use crate::state::{Reading, State};
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
use anergy_core::port::PortFlow;
use anergy_core::signal::{SignalSpec, SignalTable};
use anergy_network::elements::ElementParams;
use anergy_network::graph::Network;
use anergy_network::holding::VesselState;
use anergy_network::interface::{Station, StationState};
use anergy_network::state::NetworkState;
use anergy_prosumer::thermal_unit::Exchange;
use network::pipes;
use signals::Writer;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Turns a model into a plan that can be simulated.
///
/// # Errors
/// All problems of the model: doubled and dangling names, impossible values, signals with two drivers
/// or none, circuits without pressure reference.
pub fn build(model: &Model) -> Result<Arc<Plan>, Diagnostics> {
    let effective = model.with_effects().map_err(|problems| model.tables.located(problems.0))?;
    let mut builder = Builder { model: &effective, problems: Vec::new() };
    builder.check_names();
    let plan = builder.plan();
    match plan {
        Some(plan) if builder.problems.is_empty() => Ok(Arc::new(plan)),
        _ => Err(model.tables.located(builder.problems)),
    }
}

struct Builder<'a> {
    model: &'a Model,
    problems: Vec<Diagnostic>,
}

impl Builder<'_> {
    fn report(&mut self, message: String, span: Option<Range<usize>>, hint: Option<String>) {
        let problem = Diagnostic::new(message, span);
        self.problems.push(match hint {
            Some(hint) => problem.with_hint(hint),
            None => problem,
        });
    }

    /// Adds a signal of the entry at a place; reports one whose name is taken.
    fn add_signal(
        &mut self,
        signals: &mut SignalTable,
        spec: SignalSpec,
        place: &Place,
    ) -> SignalId {
        signals.add(spec).unwrap_or_else(|doubled| {
            let component = doubled.name.rsplit_once('.').map_or("", |(component, _)| component);
            let what = place.entry_or(component);
            let hint = match component {
                "weather" => "`weather` is what is outdoors: give this another id",
                "ground" => "`ground` is what surrounds the pipes: give this another id",
                _ => "something else has the same name: give one of the two another id",
            };
            self.report(format!("{what}: {doubled}"), place.span.range(), Some(hint.to_owned()));
            doubled.id
        })
    }

    fn check_names(&mut self) {
        let model = self.model;
        let nodes = model.nodes.iter().map(|node| ("node", node.entry.id.as_str(), &node.place));
        self.check_doubled(nodes.collect());
        let others = model
            .edges
            .iter()
            .map(|edge| ("edge", edge.id.as_str(), &edge.place))
            .chain(model.units.iter().map(|unit| ("unit", unit.id.as_str(), &unit.place)))
            .chain(model.circuits.iter().map(|c| ("circuit", c.id.as_str(), &c.place)))
            .chain(model.interfaces.iter().map(|i| ("interface", i.entry.id.as_str(), &i.place)))
            .chain(model.sensors.iter().map(|s| ("sensor", s.entry.id.as_str(), &s.place)))
            .chain(model.controllers.iter().map(|c| ("controller", c.id.as_str(), &c.place)))
            .chain(
                model.worst_points.iter().map(|p| ("worst point", p.entry.id.as_str(), &p.place)),
            )
            .chain(model.prescriptions.iter().map(|p| ("prescription", p.id.as_str(), &p.place)));
        self.check_doubled(others.collect());
        let alone = model.nodes.is_empty() && !model.units.is_empty();
        if model.edges.is_empty() && !alone && self.problems.is_empty() {
            let hint = Some("add a [[trench]], a [[station]] or an [[edge]]".into());
            self.report("the model has no edges".into(), None, hint);
        }
    }

    fn check_doubled(&mut self, named: Vec<(&str, &str, &Place)>) {
        let mut seen: HashMap<&str, &str> = HashMap::new();
        for (what, id, place) in named {
            if let Some(before) = seen.insert(id, what) {
                let message = if before == what {
                    format!("{what} \"{id}\" exists twice")
                } else {
                    format!("{what} \"{id}\" has the name of {} {before}", article(before))
                };
                let hint = "give one of them another id".to_owned();
                self.report(message, place.span.range(), Some(hint));
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
        let (edges, couplings, soil) = self.edges(&node_ids, &edge_ids);
        let mut houses = self.houses(&edge_ids);
        let whole = edges.len() == model.edges.len();
        let prescriptions =
            if whole { self.prescriptions(&node_ids, &edge_ids, &edges) } else { Vec::new() };
        let regulators = if whole { self.regulators(&node_ids, &edges) } else { Vec::new() };
        let network = Network {
            medium: model.medium,
            gravity_m_s2: model.gravity_m_s2,
            nodes,
            edges,
            ports: houses.edges.clone(),
            prescriptions,
            couplings,
            soil,
            regulators,
        };
        if whole && self.problems.is_empty() {
            self.check_graph(&network);
        }
        let mut signals = SignalTable::default();
        let mut writers: HashMap<SignalId, Writer> = HashMap::new();
        let (ground, by_depth, seasonal_ground) = self.ground_signals(&mut signals, &mut writers);
        let mut weather = self.weather_signals(&mut signals, ground);
        let node_inputs = self.node_signals(&mut signals);
        let mut commands = if whole {
            self.edge_signals(&network, &mut signals)
        } else {
            vec![None; model.edges.len()]
        };
        let regulators = self.regulator_signals(&network.regulators, &mut signals);
        let surroundings = self.surroundings(&mut signals, ground, &by_depth);
        let units = self.units(&mut houses, &network, &commands, &mut signals, &mut writers);
        let stations = self.stations(&edge_ids);
        let worst_points = self.worst_points(&node_ids);
        let prescriptions =
            self.prescribed_signals(&network.prescriptions, &commands, &mut signals, &mut writers);
        for prescription in &network.prescriptions {
            // What is free follows no command.
            commands[prescription.free.index()] = None;
        }
        let set_points = self.set_points(&mut signals);
        let drives = self.drives(&houses, &stations, &mut signals, &mut writers);
        // Without all edges there are not all signals: what is missing has been reported.
        let drivers = if whole { self.drivers(&signals, &mut writers) } else { Vec::new() };
        let steps = self.run_times();
        if !self.problems.is_empty() || !whole {
            return None; // Controllers measure channels, which need a sound plan.
        }
        let soil_step = network.soil.iter().filter_map(|s| Time::from_s(s.longest_step_s())).min();
        let vessels = self.vessels(&network, &node_ids);
        let pressure_watches = self.pressure_watches(&network, &node_ids);
        let meters = self.meters(&node_ids);
        drop((node_ids, edge_ids));
        let mut initial = self.initial_state(&units, &stations, &signals);
        initial.meters = vec![Reading::default(); meters.len()];
        let (pulses, pulse_of) = self.pulses(&commands);
        initial.pulse_shares = vec![0.0; pulses.len()];
        initial.vessels = vec![VesselState::default(); vessels.len()];
        initial.crossed = vec![false; pressure_watches.len()];
        let mut plan = Plan {
            node_names: model.nodes.iter().map(|node| node.entry.id.clone()).collect(),
            edge_names: model.edges.iter().map(|edge| edge.id.clone()).collect(),
            station_names: model.interfaces.iter().map(|spec| spec.entry.id.clone()).collect(),
            station_of_valve: stations::interlocks(model.edges.len(), &stations),
            stations,
            drives,
            units,
            grid_ports: houses.grid_ports,
            circuits: houses.circuits,
            couplings: houses.couplings,
            follows: Vec::new(),
            sensors: Vec::new(),
            controllers: Vec::new(),
            swing_watches: Vec::new(),
            worst_points,
            prescriptions,
            regulators,
            vessels,
            meters,
            kpi_places: kpi::Places::default(),
            pipes: pipes(&network),
            pumps: plan::pumps(&network),
            ends: Ends::of(&network),
            pulses,
            pulse_of,
            pressure_watches,
            targets: Vec::new(),
            drivers,
            signals,
            commands,
            node_inputs,
            ground,
            seasonal_ground,
            weather: None,
            surroundings,
            initial,
            initial_water: self.initial_water(),
            channels: Vec::new(),
            sources: Vec::new(),
            known_channels: OnceLock::new(),
            nodes_on_map: model
                .nodes
                .iter()
                .map(|spec| {
                    let (x_m, y_m) = (spec.entry.x_m, spec.entry.y_m);
                    NodeOnMap { site: spec.site.clone(), x_m, y_m }
                })
                .collect(),
            edges_on_map: edges_on_map(model),
            model_name: model.name.clone(),
            model_text: model.text.clone(),
            start_unix_ns: start_unix_ns(model),
            origin_rad: model.origin_rad,
            seeds: model.seeds(),
            site_inputs: Vec::new(),
            flags: Vec::new(),
            step: steps.0.shortest(),
            stepping: steps.0,
            automatic: AutomaticStep::of(&self.model.run),
            record: steps.1,
            until: steps.2,
            starts_settled: model.run.initial == InitialState::Steady,
            soil_step,
            network,
        };
        if !model.controllers.is_empty() || !model.sensors.is_empty() {
            (plan.channels, plan.sources) = channels::channels(&plan);
        }
        self.sensors(&mut plan);
        self.controllers(&mut plan, &set_points, &mut writers);
        if let Some(weather) = &mut weather {
            weather.leave(|signal| writers.contains_key(&signal));
        }
        self.check_sun(&plan, &writers);
        plan.weather = weather;
        (plan.channels, plan.sources) = (Vec::new(), Vec::new());
        plan.follows.extend(self.weather_ground(&plan, &writers));
        plan.follows.extend(self.follows(&plan.units, &plan.signals, &writers));
        site_inputs::find(&mut plan, &writers);
        self.check_power_factors(&plan);
        self.targets(&mut plan);
        plan.swing_watches = watches(&plan);
        plan.initial.unsettled = vec![0; plan.circuits.len() + plan.couplings.len()];
        plan.initial.swings = vec![SwingState::default(); plan.swing_watches.len()];
        plan.kpi_places = kpi::Places::of(&plan);
        plan.initial.kpis = kpi::Sums::of(&plan);
        Some(plan)
    }

    fn run_times(&mut self) -> (Step, Time, Time) {
        let run = &self.model.run;
        (Step::of(run), run.record.0, run.until.0)
    }

    fn initial_state(
        &self,
        units: &[PlannedUnit],
        stations: &[Station],
        signals: &SignalTable,
    ) -> State {
        let initial_k = self.model.run.initial_k;
        let standing = PortFlow { t_in_k: initial_k, t_out_k: initial_k, ..PortFlow::default() };
        State {
            time: Time::ZERO,
            network: NetworkState::new(&without_parts(self.model), initial_k),
            signals: signals.initial_values(),
            taken_over: vec![false; signals.specs().len()],
            unit_states: units
                .iter()
                .flat_map(|unit| unit.equipment.initial_state(initial_k))
                .collect(),
            unit_outputs: vec![0.0; units.last().map_or(0, |unit| unit.outputs.end)],
            unit_ports: vec![standing; units.last().map_or(0, |unit| unit.slots.end)],
            unit_exchange: vec![Exchange::default(); units.len()],
            unsettled: Vec::new(),
            unit_flags: Vec::new(),
            stations: vec![StationState::default(); stations.len()],
            blocked_spans: Vec::new(),
            station_heat_j: vec![0.0; stations.len()],
            meters: Vec::new(),
            kpis: kpi::Sums::default(),
            pulse_shares: Vec::new(),
            vessels: Vec::new(),
            crossed: Vec::new(),
            missed: Vec::new(),
            sensors: Vec::new(),
            swings: Vec::new(),
            controller_states: Vec::new(),
            next_tick: Vec::new(),
            last_tick: Vec::new(),
            user_ticks: Vec::new(),
            user_overruled: Vec::new(),
            electric_j: 0.0,
            units_j: 0.0,
            units_electric_j: 0.0,
            units_external_j: 0.0,
            units_initial_j: 0.0,
            pump_heat_j: 0.0,
            friction_j: 0.0,
            pipes: Vec::new(),
            loss_j: 0.0,
            boundary_j: 0.0,
            passed_kg: 0.0,
            pump_hydraulic_j: 0.0,
            dissipated_j: 0.0,
            step_damped_j: 0.0,
            initial_kinetic_j: 0.0,
            initial_stored_j: 0.0,
            largest_mass_residual_kg_s: 0.0,
            stepping: crate::automatic_step::StepMemory::default(),
            steps: 0,
            solves: 0,
            iterations: 0,
        }
    }
}

/// A network of which nothing changes.
fn without_parts(model: &Model) -> Network {
    Network {
        medium: model.medium,
        gravity_m_s2: model.gravity_m_s2,
        nodes: Vec::new(),
        edges: Vec::new(),
        ports: Vec::new(),
        prescriptions: Vec::new(),
        couplings: Vec::new(),
        soil: Vec::new(),
        regulators: Vec::new(),
    }
}

fn article(word: &str) -> &'static str {
    if word.starts_with(['a', 'e', 'i', 'o']) { "an" } else { "a" }
}

fn start_unix_ns(model: &Model) -> i64 {
    let start = model.run.start.as_ref().and_then(|text| text.parse::<jiff::Timestamp>().ok());
    start.and_then(|start| i64::try_from(start.as_nanosecond()).ok()).unwrap_or(0)
}

fn edges_on_map(model: &Model) -> Vec<EdgeOnMap> {
    let size = |params: &ElementParams| match params {
        ElementParams::Pipe(pipe) => (pipe.length_m, pipe.inner_diameter_m),
        _ => (0.0, 0.0),
    };
    let edges = model.edges.iter().map(|spec| {
        let (kind, station) = (spec.params.kind(), spec.station.clone());
        let (length_m, inner_diameter_m) = size(&spec.params);
        EdgeOnMap { kind, length_m, inner_diameter_m, station }
    });
    edges.collect()
}
