//! The steady state: inputs frozen at t = 0, actuators arrived, temperatures settled.
//!
//! A controller is replaced by the balance in which its outputs stay (`steady/control.rs`).

mod acceleration;
mod control;

use crate::build::build;
use crate::error::RunError;
use crate::model::Model;
use crate::simulation::{Crossing, Simulation, Unreached, crossings, missed_now};
use acceleration::Acceleration;
use anergy_network::hydraulics::HydraulicReport;
use anergy_network::state::Hold;
use control::settle_controllers;
use serde::Serialize;
use smol_str::SmolStr;

/// Temperatures have settled when none changes by more, K.
const SETTLED_K: f64 = 1e-9;
/// Flows have settled when none changes by more, kg/s.
const SETTLED_KG_S: f64 = 1e-11;
/// Water that a vessel may take up in the steady state, kg/s, as what a pressure reference may exchange.
const VESSEL_KG_S: f64 = 1e-6;
const MAX_ROUNDS: u32 = 2_000;

/// A node in the steady state.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SteadyNode {
    /// Name.
    pub id: SmolStr,
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
    pub id: SmolStr,
    /// Registry word.
    pub kind: SmolStr,
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
                node: plan.node_names[vessel.node.index()].to_string(),
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
        let units = simulation.state().unit_states.clone();
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
            let name = plan.unit_at(port);
            culprit = format!("unit \"{name}\" changes by {port_change:.2e} K per round");
        } else if round == 1 && simulation.state().unit_states != units {
            // Units answer from their state: what they have just heard shows in the next round.
            continue;
        } else if acceleration.far(simulation) {
            culprit = "what a unit asks for swings with what it gets".to_owned();
        } else {
            return Ok(round);
        }
        acceleration.after_round(simulation);
    }
    Err(RunError::NotSettled { iterations: MAX_ROUNDS, culprit })
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
            .edge_names
            .iter()
            .zip(&plan.edges_on_map)
            .enumerate()
            .map(|(i, (id, edge))| SteadyEdge {
                id: id.clone(),
                kind: SmolStr::new_static(edge.kind),
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

    /// Temperature at the house, degC, flow, kg/s, and what its taps take, W, when a circulation of 150 W hangs at a pipe of
    /// 62 K above the ground.
    fn circulation(length_m: f64, insulation_k_m_w: f64) -> (f64, f64, f64) {
        let text = format!(
            "format = 1\n[ground]\ntemperature_degc = 8\n[[site]]\nid = \"plant\"\n[[site]]\nid = \"c\"\n\
             [[trench]]\nfrom = \"plant\"\nto = \"c\"\nlength_m = {length_m}\ninner_diameter_mm = 22\n\
             insulation_resistance_k_m_w = {insulation_k_m_w}\n[[station]]\nsite = \"plant\"\nkind = \"plant\"\n\
             supply_degc = 70\ndp_bar = 0.5\nreturn_pressure_bar = 2\n\
             circulation_pump = {{ head_max_bar = 2, free_flow_m3_h = 5 }}\n[[station]]\nsite = \"c\"\n\
             kind = \"prescribed_flow\"\n[[unit]]\nsite = \"c\"\nkind = \"domestic_hot_water\"\n\
             heated_by = \"exchanger\"\ndaily_l = 250\ncirculation_loss_w = 150\n"
        );
        let model = Model::from_toml(&text, Path::new("."))
            .unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
        let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
        settle(&mut simulation).unwrap();
        let get = |name: &str| simulation.get(simulation.channel(name).unwrap());
        (get("c.hot.t_k") - 273.15, get("plant-c.hot.m_flow_kg_s"), -get("c.unit.q_flow_w"))
    }

    #[test]
    fn a_circulation_at_the_end_of_a_long_pipe_settles() {
        // UA of the pipe 50/3 W/K. At 45 degC the circulation needs 30.7 W/K and gets 8 + 62 e^(-16.667/30.7) = 44.03; a
        // little below, the pump has 2756 W/K more within 1 K: it rests at C = 16.667/ln(62/37) = 32.29 W/K and 45.00 degC.
        let (t_degc, m_flow_kg_s, taken_w) = circulation(50.0, 3.0);
        assert!(
            (t_degc - 45.0).abs() < 2e-3 && (taken_w - 150.0).abs() < 0.1,
            "{t_degc} {taken_w}"
        );
        let flow_w_k = m_flow_kg_s * 4180.0;
        assert!((flow_w_k - 32.29).abs() < 0.05, "{flow_w_k}");
        // C = 19/ln(62/37) = 36.81 W/K, of which (36.81 - 30.74)/2756 is missed by 2 mK.
        let (t_degc, m_flow_kg_s, _) = circulation(19.0, 1.0);
        assert!((t_degc - 44.999).abs() < 1e-3, "{t_degc}");
        assert!((m_flow_kg_s * 4180.0 - 36.81).abs() < 0.02, "{m_flow_kg_s}");
        // A pipe that the flow of the circulation alone leaves below 40 degC stays cold: 8 + 62 e^(-50/30) = 19.71.
        let (t_degc, m_flow_kg_s, _) = circulation(150.0, 3.0);
        assert!((t_degc - 19.71).abs() < 0.01, "{t_degc}");
        assert!((m_flow_kg_s * 4180.0 - 30.0).abs() < 1e-6, "{m_flow_kg_s}");
        for (length_m, insulation_k_m_w) in [(5.0, 1.0), (10.0, 1.0), (30.0, 6.0), (300.0, 20.0)] {
            circulation(length_m, insulation_k_m_w);
        }
    }

    /// Without acceleration: more than 20 000 behind a closed valve.
    const MOST_ROUNDS: u32 = 150;
}
