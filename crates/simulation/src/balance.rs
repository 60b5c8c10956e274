//! The balances that every run reports, and the key results of a run.

use crate::channels;
use crate::simulation::Simulation;
use anergy_core::units::l_min;
use serde_json::{Value, json};

/// Sums of a run; energies in J since its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balances {
    /// Largest mass residual of a node in any solve, kg/s.
    pub mass_residual_kg_s: f64,
    /// Heat from the units into the water.
    pub units_j: f64,
    /// Enthalpy that entered through boundaries.
    pub boundary_j: f64,
    /// Heat lost to the surroundings.
    pub loss_j: f64,
    /// Change of the heat stored in the water.
    pub stored_j: f64,
    /// Electricity of the pumps.
    pub electric_j: f64,
    /// Hydraulic work of pumps and boundaries.
    pub hydraulic_j: f64,
    /// Hydraulic work dissipated in the other elements.
    pub dissipated_j: f64,
}

impl Balances {
    /// The balances of a simulation up to now.
    pub fn of(simulation: &Simulation) -> Self {
        let state = simulation.state();
        let stored = state.network.stored_j(simulation.plan().network());
        Self {
            mass_residual_kg_s: state.largest_mass_residual_kg_s,
            units_j: state.units_j,
            boundary_j: state.boundary_j,
            loss_j: state.loss_j,
            stored_j: stored - state.initial_stored_j,
            electric_j: state.electric_j,
            hydraulic_j: state.pump_hydraulic_j,
            dissipated_j: state.dissipated_j,
        }
    }

    /// Heat that is not accounted for, relative to the heat that was moved.
    pub fn heat_error(&self) -> f64 {
        let moved = self
            .units_j
            .abs()
            .max(self.boundary_j.abs())
            .max(self.loss_j.abs())
            .max(self.stored_j.abs());
        relative(self.units_j + self.boundary_j - self.loss_j - self.stored_j, moved)
    }

    /// Hydraulic work that is not accounted for, relative to the work of the pumps.
    pub fn hydraulic_error(&self) -> f64 {
        relative(self.hydraulic_j - self.dissipated_j, self.hydraulic_j.abs())
    }
}

fn relative(difference: f64, scale: f64) -> f64 {
    if scale > 0.0 { difference.abs() / scale } else { difference.abs() }
}

/// Key results, balances and statistics of a run as JSON: `summary.json` and the report's tables.
pub fn summary(simulation: &Simulation, interrupted: bool) -> Value {
    let (plan, state) = (simulation.plan(), simulation.state());
    let balances = Balances::of(simulation);
    let density = plan.network.medium.density_kg_m3;
    let mut key_results = Vec::new();
    let mut add = |label: &str, value: f64, unit: &str, component: &str| {
        key_results
            .push(json!({ "label": label, "value": value, "unit": unit, "component": component }));
    };
    for (i, name) in plan.station_names.iter().enumerate() {
        let flow = plan.stations[i].m_flow_kg_s(&state.network);
        add("flow at the end (feed-in positive)", l_min(flow, density), "l/min", name);
        let heat = channels::value(plan, state, channels::Source::StationHeat(i));
        add("heat at the end (feed-in positive)", heat / 1000.0, "kW", name);
        add("heat fed in", state.station_heat_j[i] / 3.6e6, "kWh", name);
        if plan.stations[i].requested_m_flow_kg_s.is_some() {
            add("time blocked", state.stations[i].blocked_s, "s", name);
        }
    }
    add("heat lost", balances.loss_j / 3.6e6, "kWh", "network");
    add("electricity of the pumps", balances.electric_j / 3.6e6, "kWh", "network");
    let balance = |label: &str, value: f64, unit: &str, error: f64| json!({ "label": label, "value": value, "unit": unit, "relative_error": error });
    let heat = balances.heat_error();
    json!({
        "model": plan.model_name,
        "interrupted": interrupted,
        "end_s": state.time.as_s(),
        "key_results": key_results,
        "balances": [
            balance("heat from units", balances.units_j / 3.6e6, "kWh", heat),
            balance("heat through boundaries", balances.boundary_j / 3.6e6, "kWh", heat),
            balance("heat lost", balances.loss_j / 3.6e6, "kWh", heat),
            balance("heat stored", balances.stored_j / 3.6e6, "kWh", heat),
            balance("pump work", balances.hydraulic_j / 3600.0, "Wh", balances.hydraulic_error()),
            balance("dissipated", balances.dissipated_j / 3600.0, "Wh", balances.hydraulic_error()),
            balance("electricity", balances.electric_j / 3.6e6, "kWh", 0.0),
        ],
        "statistics": {
            "steps": state.steps,
            "hydraulic solves": state.solves,
            "Newton iterations": state.iterations,
            "largest mass residual in kg/s": balances.mass_residual_kg_s,
        },
    })
}
