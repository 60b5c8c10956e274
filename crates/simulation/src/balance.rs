//! The balances that every run reports, and the key results of a run.

use crate::channels;
use crate::kpi;
use crate::simulation::{Simulation, stored_j};
use anergy_core::units::l_min;
use anergy_network::two_port::EdgeThermal;
use serde_json::{Value, json};

/// Temperatures are resolved by about this: what the merging of parcels may change, K.
const RESOLUTION_K: f64 = 1e-3;
/// The work of 1e-6 kg/s (what a pressure reference may exchange) at 1 bar, W.
const RESOLUTION_W: f64 = 1e-4;

/// Sums of a run; energies in J since its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balances {
    /// Largest mass residual of a node in any solve, kg/s.
    pub mass_residual_kg_s: f64,
    /// Heat from the units into the water.
    pub units_j: f64,
    /// Heat from the losses of the pumps into the water.
    pub pump_heat_j: f64,
    /// Heat of friction in the water, where it is counted.
    pub friction_j: f64,
    /// Enthalpy that entered through boundaries.
    pub boundary_j: f64,
    /// Heat lost to the surroundings.
    pub loss_j: f64,
    /// Change of the heat stored in the water.
    pub stored_j: f64,
    /// Electricity of the pumps.
    pub electric_j: f64,
    /// Electricity of the units.
    pub units_electric_j: f64,
    /// Heat that the units took up from outside, without water and electricity; demand is negative.
    pub units_external_j: f64,
    /// Change of the heat that the units hold.
    pub units_stored_j: f64,
    /// Hydraulic work of pumps and boundaries.
    pub hydraulic_j: f64,
    /// Hydraulic work dissipated in the other elements.
    pub dissipated_j: f64,
    /// Change of the kinetic energy of the water, where it has inertia.
    pub kinetic_j: f64,
    /// Work that accelerated water and that the steps damp: less in shorter ones.
    pub step_damped_j: f64,
    /// Heat that warms all water, and what passed in the largest flow, by `RESOLUTION_K`.
    pub resolution_j: f64,
    /// Hydraulic work of `RESOLUTION_W`.
    pub hydraulic_resolution_j: f64,
}

impl Balances {
    /// The balances of a simulation up to now.
    pub fn of(simulation: &Simulation) -> Self {
        let state = simulation.state();
        let network = simulation.plan().network();
        let stored = state.network.stored_j(network);
        let capacity_j_k = state.network.capacity_j_k(network)
            + state.passed_kg * network.medium.heat_capacity_j_kg_k;
        Self {
            mass_residual_kg_s: state.largest_mass_residual_kg_s,
            units_j: state.units_j,
            pump_heat_j: state.pump_heat_j,
            friction_j: state.friction_j,
            boundary_j: state.boundary_j,
            loss_j: state.loss_j,
            stored_j: stored - state.initial_stored_j,
            electric_j: state.electric_j,
            units_electric_j: state.units_electric_j,
            units_external_j: state.units_external_j,
            units_stored_j: simulation.units_stored_j() - state.units_initial_j,
            hydraulic_j: state.pump_hydraulic_j,
            dissipated_j: state.dissipated_j,
            kinetic_j: state.network.kinetic_j(network) - state.initial_kinetic_j,
            step_damped_j: state.step_damped_j,
            resolution_j: RESOLUTION_K * capacity_j_k,
            hydraulic_resolution_j: RESOLUTION_W * state.time.as_s(),
        }
    }

    /// Heat that is not accounted for, relative to the heat that was moved, or to what temperatures are
    /// resolved by where next to nothing was.
    pub fn heat_error(&self) -> f64 {
        let gained = [self.units_j, self.pump_heat_j, self.friction_j, self.boundary_j];
        let terms = gained.into_iter().chain([self.loss_j, self.stored_j]);
        let gained_j = self.units_j + self.pump_heat_j + self.boundary_j + self.friction_j;
        relative(gained_j - self.loss_j - self.stored_j, terms, self.resolution_j)
    }

    /// Heat of the units that is not accounted for, relative to the heat that was moved.
    pub fn units_error(&self) -> f64 {
        let gained = [self.units_electric_j, self.units_external_j, -self.units_j];
        let left_j = gained.iter().sum::<f64>() - self.units_stored_j;
        relative(left_j, gained.into_iter().chain([self.units_stored_j]), self.resolution_j)
    }

    /// Hydraulic work that is not accounted for, relative to the work of the pumps, or to what flows are
    /// resolved by where next to nothing flowed.
    pub fn hydraulic_error(&self) -> f64 {
        let left_j = self.hydraulic_j - self.dissipated_j - self.kinetic_j - self.step_damped_j;
        let terms = [self.hydraulic_j, self.dissipated_j, self.kinetic_j];
        relative(left_j, terms.into_iter(), self.hydraulic_resolution_j)
    }
}

/// A difference of the terms over the largest of them, at least over `resolution`.
fn relative(difference: f64, terms: impl Iterator<Item = f64>, resolution: f64) -> f64 {
    let scale = terms.fold(resolution, |largest, term| largest.max(term.abs()));
    if scale > 0.0 { difference.abs() / scale } else { difference.abs() }
}

/// What the pumps that swung did: seconds, the largest swing and its period.
fn swings(simulation: &Simulation) -> Value {
    let (plan, state) = (simulation.plan(), simulation.state());
    let swung = plan.swing_watches.iter().zip(&state.swings);
    let swung = swung.filter(|(_, swing)| swing.hunting_s > 0.0 || swing.oscillating_s > 0.0);
    let told = swung.map(|(watch, swing)| {
        json!({
            "pump": plan.edge_names[watch.edge],
            "hunting_s": swing.hunting_s,
            "oscillating_s": swing.oscillating_s,
            "peak_to_peak_kg_s": swing.largest_kg_s,
            "period_s": swing.period_s,
        })
    });
    Value::Array(told.collect())
}

/// Circuits of houses that did not settle, and in how many steps.
fn unsettled(simulation: &Simulation) -> Vec<Value> {
    let (plan, state) = (simulation.plan(), simulation.state());
    let counts = state.unsettled.iter().enumerate().filter(|(_, steps)| **steps > 0);
    counts.map(|(i, steps)| json!({ "circuits": plan.circuits_at(i), "steps": steps })).collect()
}

/// When stations were blocked, and by whom.
fn blocked_spans(simulation: &Simulation) -> Vec<Value> {
    let (plan, state) = (simulation.plan(), simulation.state());
    let spans = state.blocked_spans.iter().map(|span| {
        json!({
            "station": plan.station_names[span.station],
            "from_s": span.from.as_s(),
            "to_s": span.to.map(anergy_core::clock::Time::as_s),
            "blocked_by": span.by.map(|edge| &plan.edge_names[edge.index()]),
        })
    });
    spans.collect()
}

/// Stations among the key results: of more, those with the most heat.
const KEY_STATIONS: usize = 10;
/// Where the line of friction stands among the balances: behind the pumps.
const FRICTION_LINE: usize = 2;
/// Pipes in the summary: those with the largest losses.
const KEY_PIPES: usize = 20;

/// Heat of a pipe since the start of a run, J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PipeBalance {
    /// The edge.
    pub edge: usize,
    /// What the flow has brought and left there.
    pub brought_j: f64,
    /// What was lost to the surroundings.
    pub lost_j: f64,
    /// Change of what its content holds.
    pub stored_j: f64,
    /// Heat that warms its content by `RESOLUTION_K`.
    pub resolution_j: f64,
}

impl PipeBalance {
    /// The balances of all pipes up to now, in the order of the edges.
    pub fn of(simulation: &Simulation) -> Vec<Self> {
        let (plan, state) = (simulation.plan(), simulation.state());
        let medium = &plan.network.medium;
        let pipes = plan.pipes.iter().zip(&state.pipes).enumerate();
        pipes
            .map(|(k, (&edge, heat))| Self {
                edge,
                brought_j: heat.brought_j,
                lost_j: heat.lost_j,
                stored_j: stored_j(plan, state, k),
                resolution_j: match plan.network.edges[edge].element.thermal() {
                    EdgeThermal::PlugFlow(pipe) => {
                        RESOLUTION_K * medium.heat_capacity_j_kg_k * pipe.content_kg
                    }
                    _ => 0.0,
                },
            })
            .collect()
    }

    /// Heat that is not accounted for, relative to the largest term.
    pub fn error(&self) -> f64 {
        let terms = [self.brought_j, self.lost_j, self.stored_j];
        let left_j = self.brought_j - self.lost_j - self.stored_j;
        relative(left_j, terms.into_iter(), self.resolution_j)
    }
}

/// The pipes with the largest losses, and how well the balances of all of them close.
fn pipes(simulation: &Simulation) -> (Vec<Value>, f64) {
    let plan = simulation.plan();
    let mut all = PipeBalance::of(simulation);
    let worst = all.iter().map(PipeBalance::error).fold(0.0, f64::max);
    all.sort_by(|a, b| b.lost_j.abs().total_cmp(&a.lost_j.abs()));
    all.truncate(KEY_PIPES);
    let seconds = simulation.time().as_s();
    let entry = |pipe: &PipeBalance| {
        json!({
            "component": plan.edge_names[pipe.edge],
            "brought_kwh": pipe.brought_j / 3.6e6,
            "lost_kwh": pipe.lost_j / 3.6e6,
            "stored_kwh": pipe.stored_j / 3.6e6,
            "mean_loss_w": if seconds > 0.0 { pipe.lost_j / seconds } else { 0.0 },
            "relative_error": pipe.error(),
        })
    };
    (all.iter().map(entry).collect(), worst)
}

/// Key results, balances and statistics of a run as JSON: `summary.json` and the report's tables.
pub fn summary(simulation: &Simulation, interrupted: bool) -> Value {
    let (plan, state) = (simulation.plan(), simulation.state());
    let balances = Balances::of(simulation);
    let density = plan.network.medium.density_kg_m3;
    let result = |label: &str, value: f64, unit: &str, component: &str| json!({ "label": label, "value": value, "unit": unit, "component": component });
    let mut results: Vec<(f64, Vec<Value>)> = Vec::new();
    for (i, name) in plan.station_names.iter().enumerate() {
        let mut entries = Vec::new();
        let mut add = |label: &str, value: f64, unit: &str, component: &str| {
            entries.push(result(label, value, unit, component));
        };
        let flow = plan.stations[i].m_flow_kg_s(&state.network);
        add("flow at the end (feed-in positive)", l_min(flow, density), "l/min", name);
        let heat = channels::value(plan, state, channels::Source::StationHeat(i));
        add("heat at the end (feed-in positive)", heat / 1000.0, "kW", name);
        add("heat fed in", state.station_heat_j[i] / 3.6e6, "kWh", name);
        if plan.stations[i].requested_m_flow_kg_s.is_some() {
            add("time blocked", state.stations[i].blocked_s, "s", name);
        }
        results.push((state.station_heat_j[i].abs(), entries));
    }
    let stations: Vec<Value> = results.iter().flat_map(|(_, entries)| entries.clone()).collect();
    let others = results.len().saturating_sub(KEY_STATIONS);
    if others > 0 {
        results.sort_by(|a, b| b.0.total_cmp(&a.0));
        results.truncate(KEY_STATIONS);
    }
    let mut key_results: Vec<Value> =
        results.into_iter().flat_map(|(_, entries)| entries).collect();
    key_results.push(result("heat lost", balances.loss_j / 3.6e6, "kWh", "network"));
    let electric = balances.electric_j / 3.6e6;
    key_results.push(result("electricity of the pumps", electric, "kWh", "network"));
    let balance = |label: &str, value: f64, unit: &str, error: f64| json!({ "label": label, "value": value, "unit": unit, "relative_error": error });
    let heat = balances.heat_error();
    let (pipes, pipe_error) = pipes(simulation);
    let mut summary = json!({
        "model": plan.model_name,
        "interrupted": interrupted,
        "end_s": state.time.as_s(),
        "key_results": key_results,
        "stations_beyond_key_results": others,
        "stations": stations,
        "balances": [
            balance("heat from units", balances.units_j / 3.6e6, "kWh", heat),
            balance("heat from pumps", balances.pump_heat_j / 3.6e6, "kWh", heat),
            balance("heat through boundaries", balances.boundary_j / 3.6e6, "kWh", heat),
            balance("heat lost", balances.loss_j / 3.6e6, "kWh", heat),
            balance("heat stored", balances.stored_j / 3.6e6, "kWh", heat),
            balance("pump work", balances.hydraulic_j / 3600.0, "Wh", balances.hydraulic_error()),
            balance("dissipated", balances.dissipated_j / 3600.0, "Wh", balances.hydraulic_error()),
            balance("electricity", balances.electric_j / 3.6e6, "kWh", 0.0),
        ],
        "blocked": blocked_spans(simulation),
        "swings": swings(simulation),
        "kpis": kpi::kpis(simulation),
        "pipes": pipes,
        "largest_pipe_error": pipe_error,
        "statistics": {
            "steps": state.steps,
            "hydraulic solves": state.solves,
            "Newton iterations": state.iterations,
            "largest mass residual in kg/s": balances.mass_residual_kg_s,
        },
    });
    let unsettled = unsettled(simulation);
    if !unsettled.is_empty() {
        summary["unsettled"] = Value::Array(unsettled);
    }
    if let Some(steps) = state.stepping.report() {
        summary["automatic_step"] = steps;
    }
    if plan.has_houses()
        && let Some(lines) = summary["balances"].as_array_mut()
    {
        let error = balances.units_error();
        lines.extend([
            balance("electricity of units", balances.units_electric_j / 3.6e6, "kWh", error),
            balance("other heat into units", balances.units_external_j / 3.6e6, "kWh", error),
            balance("heat stored in units", balances.units_stored_j / 3.6e6, "kWh", error),
        ]);
    }
    if state.network.counts_inertia()
        && let Some(lines) = summary["balances"].as_array_mut()
    {
        let (energy_j, damped_j) = (balances.kinetic_j, balances.step_damped_j);
        let error = balances.hydraulic_error();
        lines.extend([
            balance("kinetic energy of the water", energy_j / 3600.0, "Wh", error),
            balance("damped by the steps", damped_j / 3600.0, "Wh", error),
        ]);
    }
    let friction = balance("heat of friction", balances.friction_j / 3.6e6, "kWh", heat);
    if !state.network.friction_k.is_empty()
        && let Some(lines) = summary["balances"].as_array_mut()
    {
        lines.insert(FRICTION_LINE, friction);
    }
    summary
}
