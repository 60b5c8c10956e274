//! The steady state: inputs frozen at t = 0, actuators arrived, temperatures settled.
//!
//! A controller with integral action is replaced by "measured = set point, actuator free within its
//! limits, else at the limit": an outer Newton iteration on the actuators, its Jacobian by differences
//! of settled states.

mod acceleration;

use crate::build::build;
use crate::channels;
use crate::error::RunError;
use crate::model::Model;
use crate::simulation::{Crossing, Simulation, Unreached, crossings, missed_now};
use acceleration::Acceleration;
use anergy_network::hydraulics::HydraulicReport;
use anergy_network::state::Hold;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Temperatures have settled when none changes by more, K.
const SETTLED_K: f64 = 1e-9;
/// Flows have settled when none changes by more, kg/s.
const SETTLED_KG_S: f64 = 1e-11;
/// Water that a vessel may take up in the steady state, kg/s, as what a pressure reference may exchange.
const VESSEL_KG_S: f64 = 1e-6;
const MAX_ROUNDS: u32 = 2_000;
const MAX_CONTROL_ROUNDS: u32 = 60;
/// Actuator change for the difference quotient, relative to its range where that is finite.
const DIFFERENCE: f64 = 1e-5;
/// A set point is reached within this share of its scale.
const REACHED: f64 = 1e-9;

/// A node in the steady state.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SteadyNode {
    /// Name.
    pub id: String,
    /// Pressure above the atmosphere, Pa.
    pub p_pa: f64,
    /// Temperature, K.
    pub t_k: f64,
    /// Elevation, m.
    pub elevation_m: f64,
}

/// An edge in the steady state.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SteadyEdge {
    /// Name.
    pub id: String,
    /// Registry word.
    pub kind: String,
    /// Mass flow from a to b, kg/s.
    pub m_flow_kg_s: f64,
    /// `p_a - p_b`, Pa.
    pub dp_pa: f64,
}

/// Pressures, flows and temperatures of a whole network.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Steady {
    /// Nodes in the order of the model.
    pub nodes: Vec<SteadyNode>,
    /// Edges in the order of the model.
    pub edges: Vec<SteadyEdge>,
    /// Newton iterations of all hydraulic solves since the simulation began.
    pub iterations: u32,
    /// Largest pressure residual of an edge, Pa.
    pub residual_pa: f64,
    /// Prescriptions, set values of pumps and set points of controllers that cannot be reached.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unreached: Vec<Unreached>,
    /// Pressure limits that are crossed, each at its worst node.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub crossed: Vec<Crossing>,
}

impl Steady {
    /// The node with a name.
    pub fn node(&self, id: &str) -> Option<&SteadyNode> {
        self.nodes.iter().find(|node| node.id == id)
    }

    /// The edge with a name.
    pub fn edge(&self, id: &str) -> Option<&SteadyEdge> {
        self.edges.iter().find(|edge| edge.id == id)
    }
}

/// Solves the steady state of a model.
///
/// # Errors
/// What is wrong with the model, or what did not converge.
pub fn solve(model: &Model) -> Result<Steady, RunError> {
    let mut simulation = Simulation::new(build(model)?)?;
    let report = settle(&mut simulation)?;
    Ok(table(&simulation, report))
}

/// Brings a simulation into its steady state at the present inputs.
///
/// # Errors
/// [`RunError::NotSettled`] names what still moves.
pub fn settle(simulation: &mut Simulation) -> Result<HydraulicReport, RunError> {
    simulation.settle_once()?;
    if simulation.plan().controllers.is_empty() {
        settle_temperatures(simulation)?;
    } else {
        settle_controllers(simulation)?;
    }
    simulation.state_mut().network.invalidate_hydraulics();
    let last = simulation.solve_hydraulics()?;
    check_vessels(simulation)?;
    // Heat that cannot get out has no steady state below boiling.
    simulation.check_temperatures(&"steady state")?;
    let iterations = u32::try_from(simulation.state().iterations).unwrap_or(u32::MAX);
    Ok(HydraulicReport { iterations, ..last })
}

/// What enters a vessel all the time has no steady state.
fn check_vessels(simulation: &Simulation) -> Result<(), RunError> {
    let (plan, network) = (simulation.plan(), &simulation.state().network);
    for vessel in &plan.vessels {
        let m_flow_kg_s = -network.exchange_kg_s[vessel.node.index()];
        if m_flow_kg_s.abs() > VESSEL_KG_S {
            return Err(RunError::Unbalanced {
                time: "steady state".into(),
                node: plan.node_names[vessel.node.index()].clone(),
                m_flow_kg_s,
            });
        }
    }
    Ok(())
}

/// Rounds until no temperature and no flow changes any more.
fn settle_temperatures(simulation: &mut Simulation) -> Result<u32, RunError> {
    let mut culprit = String::new();
    let mut acceleration = Acceleration::default();
    for round in 1..=MAX_ROUNDS {
        let network = &simulation.state().network;
        let (flows, nodes, ports) =
            (network.m_flow_kg_s.clone(), network.t_node_k.clone(), network.t_secondary_k.clone());
        simulation.settle_once()?;
        let after = &simulation.state().network;
        let largest = |old: &[f64], new: &[f64]| {
            old.iter().zip(new).map(|(old, new)| (new - old).abs()).enumerate().fold(
                (0, 0.0_f64),
                |worst, (i, change)| if change > worst.1 { (i, change) } else { worst },
            )
        };
        let (node, node_change) = largest(&nodes, &after.t_node_k);
        let (port, port_change) = largest(&ports, &after.t_secondary_k);
        let (edge, flow_change) = largest(&flows, &after.m_flow_kg_s);
        let plan = simulation.plan();
        if flow_change > SETTLED_KG_S {
            culprit = format!(
                "edge \"{}\" changes by {flow_change:.2e} kg/s per round",
                plan.edge_names[edge]
            );
        } else if node_change > SETTLED_K {
            culprit = format!(
                "node \"{}\" changes by {node_change:.2e} K per round",
                plan.node_names[node]
            );
        } else if port_change > SETTLED_K {
            let unit = plan.units.iter().find(|unit| unit.port == port);
            let name = unit.map_or("", |unit| unit.name.as_str());
            culprit = format!("unit \"{name}\" changes by {port_change:.2e} K per round");
        } else {
            return Ok(round);
        }
        acceleration.after_round(simulation);
    }
    Err(RunError::NotSettled { iterations: MAX_ROUNDS, culprit })
}

/// Newton on the actuators of all controllers, within their limits.
fn settle_controllers(simulation: &mut Simulation) -> Result<(), RunError> {
    let plan = simulation.plan().clone();
    let n = plan.controllers.len();
    let limits: Vec<(f64, f64)> = plan
        .controllers
        .iter()
        .map(|controller| {
            let spec = plan.signals.spec(controller.acts_on);
            controller.controller.output_limits((spec.min, spec.max))
        })
        .collect();
    let set =
        |simulation: &mut Simulation, outputs: &DVector<f64>| -> Result<DVector<f64>, RunError> {
            for (controller, output) in plan.controllers.iter().zip(outputs) {
                simulation.state_mut().signals[controller.acts_on.index()] = *output;
            }
            settle_temperatures(simulation)?;
            Ok(errors(simulation))
        };
    let start = |(min, max): (f64, f64)| {
        if min.is_finite() && max.is_finite() { min + 0.7 * (max - min) } else { 0.0 }
    };
    let mut outputs = DVector::from_iterator(n, limits.iter().map(|l| start(*l)));
    let scale: Vec<f64> = plan
        .controllers
        .iter()
        .map(|c| simulation.state().signals[c.set_point.index()].abs().max(1e-3))
        .collect();
    for _ in 0..MAX_CONTROL_ROUNDS {
        let error = set(simulation, &outputs)?;
        // At a limit, an error that pushes beyond it stays.
        let held = |i: usize| {
            let push = error[i] * plan.controllers[i].controller.direction();
            (outputs[i] >= limits[i].1 && push > 0.0) || (outputs[i] <= limits[i].0 && push < 0.0)
        };
        let free: Vec<usize> = (0..n).filter(|&i| !held(i)).collect();
        if free.iter().all(|&i| error[i].abs() <= REACHED * scale[i]) {
            return Ok(());
        }
        let mut jacobian = DMatrix::zeros(free.len(), free.len());
        for (column, &i) in free.iter().enumerate() {
            let range = limits[i].1 - limits[i].0;
            let step = if range.is_finite() { DIFFERENCE * range } else { DIFFERENCE };
            let step = if outputs[i] + step > limits[i].1 { -step } else { step };
            let mut moved = outputs.clone();
            moved[i] += step;
            let moved_error = set(simulation, &moved)?;
            for (row, &j) in free.iter().enumerate() {
                jacobian[(row, column)] = (moved_error[j] - error[j]) / step;
            }
        }
        let without_effect = |i: usize| RunError::NotSettled {
            iterations: 1,
            culprit: format!(
                "the actuator of controller \"{}\" has no effect on what it measures",
                plan.controllers[i].name
            ),
        };
        // An actuator beyond what its element can do, like a head that the pump does not reach at this
        // flow, has no effect here, but may have one elsewhere.
        let idle = (0..free.len()).find(|&k| jacobian.column(k).iter().all(|slope| *slope == 0.0));
        if let Some(k) = idle {
            let i = free[k];
            let (min, max) = limits[i];
            let push = error[i] * plan.controllers[i].controller.direction();
            let mut other = outputs.clone();
            other[i] = if outputs[i] > min { min } else { max };
            if !other[i].is_finite() || set(simulation, &other)? == error {
                return Err(without_effect(i));
            }
            outputs[i] = (outputs[i] + 0.3 * (max - min) * push.signum()).clamp(min, max);
            continue;
        }
        let rhs = DVector::from_iterator(free.len(), free.iter().map(|&i| -error[i]));
        let Some(change) = jacobian.lu().solve(&rhs) else {
            return Err(without_effect(free[0]));
        };
        for (k, &i) in free.iter().enumerate() {
            let (min, max) = limits[i];
            let range = if (max - min).is_finite() { max - min } else { f64::INFINITY };
            outputs[i] = (outputs[i] + change[k].clamp(-0.3 * range, 0.3 * range)).clamp(min, max);
        }
    }
    let error = errors(simulation);
    let worst =
        (0..n).max_by(|&i, &j| (error[i].abs() / scale[i]).total_cmp(&(error[j].abs() / scale[j])));
    let worst = worst.unwrap_or(0);
    Err(RunError::NotSettled {
        iterations: MAX_CONTROL_ROUNDS,
        culprit: format!(
            "controller \"{}\" misses its set point by {:.3e}",
            plan.controllers[worst].name, error[worst]
        ),
    })
}

/// Set point minus measured value of every controller.
fn errors(simulation: &Simulation) -> DVector<f64> {
    let (plan, state) = (simulation.plan(), simulation.state());
    DVector::from_iterator(
        plan.controllers.len(),
        plan.controllers.iter().map(|controller| {
            state.signals[controller.set_point.index()]
                - channels::value(plan, state, controller.measures)
        }),
    )
}

/// The tables of a settled simulation.
pub fn table(simulation: &Simulation, report: HydraulicReport) -> Steady {
    let (plan, network) = (simulation.plan(), &simulation.state().network);
    Steady {
        nodes: plan
            .node_names
            .iter()
            .enumerate()
            .map(|(i, id)| SteadyNode {
                id: id.clone(),
                p_pa: network.p_pa[i],
                t_k: network.t_node_k[i],
                elevation_m: plan.network.nodes[i].elevation_m,
            })
            .collect(),
        edges: plan
            .map
            .edges
            .iter()
            .enumerate()
            .map(|(i, edge)| SteadyEdge {
                id: edge.id.clone(),
                kind: edge.kind.clone(),
                m_flow_kg_s: network.m_flow_kg_s[i],
                dp_pa: network.dp_pa(&plan.network, i),
            })
            .collect(),
        iterations: report.iterations,
        residual_pa: report.residual_pa,
        unreached: (0..plan.prescriptions.len())
            .filter(|&k| network.prescribed[k].hold != Hold::Held)
            .map(|k| Unreached::new(plan, simulation.state(), k))
            .chain(missed_now(plan, simulation.state()))
            .collect(),
        crossed: crossings(plan, simulation.state()),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use std::path::Path;

    /// Rounds, the load that is met and the heat through the exchanger, W, of a house of 10 kW whose valve has
    /// an opening.
    fn rounds(opening: f64, unit: &str) -> (u32, f64, f64) {
        let text = format!(
            "format = 1\n[[site]]\nid = \"plant\"\n[[site]]\nid = \"c\"\n[[trench]]\nfrom = \"plant\"\n\
             to = \"c\"\nlength_m = 200\ninner_diameter_mm = 22\ninsulation_resistance_k_m_w = 3.78\n\
             [[station]]\nsite = \"plant\"\nkind = \"plant\"\nsupply_degc = 80\ndp_bar = 0.5\n\
             return_pressure_bar = 2\ncirculation_pump = {{ head_max_bar = 2, free_flow_m3_h = 5 }}\n\
             [[station]]\nsite = \"c\"\nkind = \"consumer\"\nextraction_valve = {{ opening = {opening} }}\n\
             [[unit]]\nsite = \"c\"\nkind = \"heat_load\"\nload_kw = 10\n{unit}\n"
        );
        let model = Model::from_toml(&text, Path::new(".")).unwrap();
        let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
        let rounds = settle_temperatures(&mut simulation).unwrap();
        let get = |name: &str| simulation.get(simulation.channel(name).unwrap());
        (rounds, -get("c.unit.q_flow_w"), -get("c.station.q_flow_w"))
    }

    #[test]
    fn a_load_behind_an_almost_closed_valve_settles_in_few_rounds() {
        for opening in [0.0, 1e-4, 1e-3, 3e-3, 0.01, 0.02, 0.03, 0.05, 0.1, 0.3, 1.0] {
            for unit in ["return_degc = 40", "return_degc = 60", "temperature_difference_k = 30"] {
                let (rounds, unit_w, station_w) = rounds(opening, unit);
                assert!(rounds <= MOST_ROUNDS, "opening {opening}, {unit}: {rounds} rounds");
                // Settled: what the unit gets is what leaves the water of the network.
                let wrong_w = (unit_w - station_w).abs();
                assert!(wrong_w < 1e-3, "opening {opening}, {unit}: {unit_w} W, {station_w} W");
            }
        }
    }

    /// Without acceleration: more than 20 000 behind a closed valve.
    const MOST_ROUNDS: u32 = 150;
}
