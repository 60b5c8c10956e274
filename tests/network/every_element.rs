//! What every registered element must fulfil, whatever its parameters: slope = finite difference,
//! strictly monotone, C1 through zero flow, finite up to +-1000 kg/s, mirrored when it is connected the
//! other way round, parameters that survive being written and read.

#![allow(clippy::unwrap_used)]

use anergy_core::ids::NodeId;
use anergy_core::linear::Linear;
use anergy_core::medium::Medium;
use anergy_core::testing::check_monotone;
use anergy_network::elements::pump::PumpParams;
use anergy_network::elements::resistance::ResistanceParams;
use anergy_network::elements::{Element, ElementParams};
use anergy_network::graph::{Edge, GRAVITY_M_S2, Network, Node, NodeKind};
use anergy_network::hydraulics::HydraulicSolver;
use anergy_network::state::NetworkState;
use anergy_network::two_port::{Characteristic, EdgeState};
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use anergy_simulation::steady;
use anergy_tests::samples::{self, Nature};
use anergy_tests::workspace;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Random parameter sets of each kind.
const CASES: u32 = 256;
/// Flows of a mirrored network may differ by this, kg/s, and relative to the flow.
const MIRROR: f64 = 1e-9;

/// The same random numbers in every run.
fn runner() -> TestRunner {
    let config = Config { cases: CASES, failure_persistence: None, ..Config::default() };
    TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]))
}

/// Runs a check on random parameters of every registered kind.
fn for_every_element(check: impl Fn(&ElementParams) -> Result<(), String>) {
    for kind in ElementParams::KINDS {
        let checked = runner().run(&samples::params(kind), |params| {
            prop_assert_eq!(params.kind(), *kind);
            check(&params).map_err(TestCaseError::fail)
        });
        if let Err(problem) = checked {
            panic!("{kind}: {problem}");
        }
    }
}

/// Water of two temperatures and a heavier liquid.
fn media() -> [Medium; 3] {
    let water = Medium::default();
    [
        water,
        Medium { density_kg_m3: 965.0, viscosity_pa_s: 3.1e-4, ..water },
        Medium { density_kg_m3: 1050.0, viscosity_pa_s: 5e-3, ..water },
    ]
}

/// Positions from rest to full, also where a law might have a joint.
fn positions(element: &Element) -> Vec<f64> {
    match element.actuator() {
        None => vec![0.0],
        Some(actuator) if actuator.max.is_finite() => {
            [0.0, 0.004, 0.005, 0.012, 0.015, 0.02, 0.05, 0.3, 0.7, 1.0]
                .map(|share| actuator.min + share * (actuator.max - actuator.min))
                .to_vec()
        }
        Some(actuator) => vec![actuator.initial_position, -1.0, 0.0, 2.5],
    }
}

/// The flows -1000 to 1000 kg/s, 15 in each decade down to 1e-8 kg/s, and zero.
fn flows() -> Vec<f64> {
    let positive = (0..=15 * 11).map(|i| 1e-8 * 10_f64.powf(f64::from(i) / 15.0));
    let mut flows: Vec<f64> = positive.clone().chain(positive.map(|m| -m)).chain([0.0]).collect();
    flows.sort_by(f64::total_cmp);
    flows
}

/// The slope agrees with a difference of the law over `m (1 +- width)`, within 1e-5 and rounding.
fn check_difference(law: impl Fn(f64) -> Linear, m: f64, width: f64) -> Result<(), String> {
    let h = width * m.abs();
    let difference = (law(m + h).value - law(m - h).value) / (2.0 * h);
    let slope = law(m).slope;
    let rounding = (law(0.0).value.abs() + law(m).value.abs()) * 4.0 * f64::EPSILON / h;
    if (slope - difference).abs() > 1e-5 * slope + rounding {
        return Err(format!("slope at m = {m} is {slope}, the finite difference {difference}"));
    }
    Ok(())
}

/// What holds for the law of an element with a pressure loss.
fn check_law(law: impl Fn(f64) -> Linear, flows: &[f64]) -> Result<(), String> {
    check_monotone(&law, flows)?;
    for &m in flows.iter().filter(|m| **m != 0.0) {
        let width = if m.abs() < 1e-3 { 1e-4 } else { 1e-6 };
        // Across a joint, where only the slope is continuous, or in the narrow band in which a pump
        // changes from one law to another, only a narrower difference shows the slope.
        let check = |share: f64| check_difference(&law, m, share * width);
        check(1.0).or_else(|_| check(1e-2)).or_else(|_| check(1e-3))?;
    }
    let head = law(0.0).value.abs();
    // Nearer than any difference: the slope is that at zero, and the value does not jump.
    let zero = law(0.0);
    for m in [1e-18, -1e-18, 1e-30, -1e-30, f64::MIN_POSITIVE, -f64::MIN_POSITIVE, -0.0] {
        let near = law(m);
        let (d_slope, d_value) = (near.slope - zero.slope, near.value - zero.value);
        let jump = d_slope.abs() > 1e-6 * zero.slope
            || d_value.abs() > 2.0 * m.abs() * zero.slope + 2.0 * f64::EPSILON * head;
        if jump || !near.value.is_finite() {
            return Err(format!("jumps at zero flow: {near:?} at m = {m}, {zero:?} at 0"));
        }
    }
    Ok(())
}

#[test]
fn laws_are_smooth_and_strictly_monotone() {
    let flows = flows();
    for_every_element(|params| {
        for medium in media() {
            let element = params.build(&medium).map_err(|error| error.to_string())?;
            for position in positions(&element) {
                let state = EdgeState {
                    position,
                    density_kg_m3: medium.density_kg_m3,
                    viscosity_pa_s: medium.viscosity_pa_s,
                };
                let at = |m: f64| element.characteristic(m, &state);
                let fails = |problem: String| format!("at position {position}: {problem}");
                let first = at(0.0);
                match first {
                    Characteristic::PressureLoss(_) => {
                        let law = |m: f64| match at(m) {
                            Characteristic::PressureLoss(law) => law,
                            // Fails as not finite.
                            _ => Linear::new(f64::NAN, f64::NAN),
                        };
                        check_law(law, &flows).map_err(fails)?;
                    }
                    Characteristic::ImposedFlow { m_flow_kg_s: given }
                    | Characteristic::ImposedPressure { dp_pa: given } => {
                        if !given.is_finite() || flows.iter().any(|&m| at(m) != first) {
                            return Err(fails("what is imposed depends on the flow".into()));
                        }
                    }
                }
            }
        }
        Ok(())
    });
}

#[test]
fn what_elements_say_of_themselves_is_sound() {
    for_every_element(|params| {
        let medium = Medium::default();
        let element = params.build(&medium).map_err(|error| error.to_string())?;
        let nominal = element.m_flow_nominal_kg_s();
        if !(nominal.is_finite() && nominal > 0.0) {
            return Err(format!("nominal flow {nominal}"));
        }
        if let Some(actuator) = element.actuator() {
            let range = actuator.min..=actuator.max;
            for share in [0.0, 0.1, 0.5, 0.99, 1.0] {
                let whole = (actuator.max - actuator.min).min(1e3);
                let command = actuator.min.max(-1e3) + share * whole;
                let target = element.target_position(command);
                let again = element.target_position(command);
                if !range.contains(&target) || target.to_bits() != again.to_bits() {
                    return Err(format!("command {command} leads to {target}, not in {range:?}"));
                }
            }
            if !range.contains(&actuator.initial_position)
                || !range.contains(&actuator.initial_command)
            {
                return Err(format!("starts outside of its range: {actuator:?}"));
            }
        }
        for position in positions(&element) {
            let state = EdgeState {
                position,
                density_kg_m3: medium.density_kg_m3,
                viscosity_pa_s: medium.viscosity_pa_s,
            };
            for m in [-1000.0, -1.0, 0.0, 1e-6, 1.0, 1000.0] {
                let power = element.electric_power_w(m, &state).unwrap_or(0.0);
                if !power.is_finite() || power < 0.0 {
                    return Err(format!("power {power} W at {m} kg/s and position {position}"));
                }
                let heat = element.heat_to_water_w(m, &state);
                if !(0.0..=power).contains(&heat) {
                    return Err(format!("{heat} W of {power} W at {m} kg/s, position {position}"));
                }
            }
        }
        Ok(())
    });
}

#[test]
fn parameters_survive_being_written_and_read() {
    for_every_element(|params| {
        let value = params.to_value();
        let read = ElementParams::deserialize(params.kind(), value.clone());
        let read = read.ok_or("its own kind is unknown")?.map_err(|error| error.to_string())?;
        if read != *params {
            return Err(format!("{value} is read as {read:?}"));
        }
        let schema = ElementParams::schema(params.kind()).ok_or("has no schema")?;
        let fields = value.as_object().ok_or("is not an object")?;
        let known = schema.get("properties").and_then(|known| known.as_object());
        for field in fields.keys() {
            if !known.is_some_and(|known| known.contains_key(field)) {
                return Err(format!("the schema does not know {field}"));
            }
        }
        let mut more = value.clone();
        more["colour"] = "red".into();
        match ElementParams::deserialize(params.kind(), more) {
            Some(Err(error)) if error.to_string().contains("colour") => Ok(()),
            other => Err(format!("an unknown field is not refused: {other:?}")),
        }
    });
    assert!(ElementParams::deserialize("turbine", serde_json::json!({})).is_none());
    assert!(ElementParams::schema("turbine").is_none());
}

/// An edge of a test network: ends, component, position of its actuator.
type Part = (usize, usize, ElementParams, f64);

/// Flows and pressures of a network whose node 0 holds the pressure.
fn solved(nodes: usize, parts: &[Part]) -> Result<(Vec<f64>, Vec<f64>), String> {
    let medium = Medium::default();
    let node = |kind| Node { kind, elevation_m: 0.0, volume_m3: 0.0, ua_w_k: 0.0 };
    let mut edges = Vec::new();
    for (from, to, params, _) in parts {
        edges.push(Edge {
            from: NodeId::from_index(*from),
            to: NodeId::from_index(*to),
            element: params.build(&medium).map_err(|error| error.to_string())?,
            loss_factor: 1.0,
            partner: None,
            leads_partner: false,
        });
    }
    let mut all = vec![node(NodeKind::PressureReference)];
    all.resize(nodes, node(NodeKind::Junction));
    let network = Network {
        medium,
        gravity_m_s2: GRAVITY_M_S2,
        nodes: all,
        edges,
        ports: Vec::new(),
        prescriptions: Vec::new(),
        couplings: Vec::new(),
        soil: Vec::new(),
        regulators: Vec::new(),
    };
    if let Some(problem) = network.problems().first() {
        return Err(format!("{problem:?}"));
    }
    let mut state = NetworkState::new(&network, 300.0);
    for (position, part) in state.position.iter_mut().zip(parts) {
        *position = part.3;
    }
    let mut solver = HydraulicSolver::new(&network).map_err(|error| error.to_string())?;
    solver.solve(&network, &mut state).map_err(|error| error.to_string())?;
    Ok((state.m_flow_kg_s, state.p_pa))
}

/// A pump drives the element and a by-pass in parallel, the water returns through a resistance.
fn pump_loop(params: &ElementParams, position: f64) -> Vec<Part> {
    let resistance = |dp: f64| {
        ElementParams::Resistance(ResistanceParams {
            dp_nominal_pa: Some(dp),
            m_flow_nominal_kg_s: Some(0.5),
            delta_m: 0.1,
            ..ResistanceParams::default()
        })
    };
    vec![
        (0, 1, ElementParams::Pump(PumpParams::default()), 0.8),
        (1, 2, params.clone(), position),
        (1, 2, resistance(8e3), 0.0),
        (2, 0, resistance(3e3), 0.0),
    ]
}

/// The same connected the other way round.
fn turned(part: &Part) -> Part {
    (part.1, part.0, part.2.clone(), part.3)
}

fn compare(what: &str, found: &[f64], expected: &[f64], tolerance: f64) -> Result<(), String> {
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        if (found - expected).abs() > tolerance * expected.abs().max(1.0) {
            return Err(format!("{what} of {i} is {found}, mirrored {expected}"));
        }
    }
    Ok(())
}

#[test]
fn connected_the_other_way_round_the_result_is_mirrored() {
    for_every_element(|params| {
        let element = params.build(&Medium::default()).map_err(|error| error.to_string())?;
        let mut places = positions(&element);
        if let Some(actuator) = element.actuator() {
            places.push(actuator.initial_position);
        }
        for position in places {
            let parts = pump_loop(params, position);
            let fails = |problem: String| format!("at position {position}: {problem}");
            let (flows, pressures) = solved(3, &parts).map_err(fails)?;
            // Everything that is not symmetric is turned: the water of the symmetric edges flows the
            // other way, the others see what they saw, and pressures are mirrored at the reference.
            let symmetric: Vec<bool> =
                parts.iter().map(|part| samples::nature(&part.2) == Nature::Symmetric).collect();
            let mirror: Vec<Part> = parts
                .iter()
                .zip(&symmetric)
                .map(|(part, symmetric)| if *symmetric { part.clone() } else { turned(part) })
                .collect();
            let (mirrored, mirrored_p) = solved(3, &mirror).map_err(fails)?;
            let expected: Vec<f64> =
                flows.iter().zip(&symmetric).map(|(m, s)| if *s { -m } else { *m }).collect();
            compare("the flow", &mirrored, &expected, MIRROR).map_err(fails)?;
            let expected: Vec<f64> = pressures.iter().map(|p| -p).collect();
            compare("the pressure", &mirrored_p, &expected, 1e-6).map_err(fails)?;
            // A symmetric element turned alone changes nothing but the sign of its own flow.
            if symmetric[1] {
                let mut alone = parts.clone();
                alone[1] = turned(&parts[1]);
                let (turned_flows, turned_p) = solved(3, &alone).map_err(fails)?;
                let mut expected = flows.clone();
                expected[1] = -expected[1];
                compare("the flow", &turned_flows, &expected, MIRROR).map_err(fails)?;
                compare("the pressure", &turned_p, &pressures, 1e-6).map_err(fails)?;
            }
        }
        Ok(())
    });
}

#[test]
fn nothing_flows_when_all_pumps_are_off() {
    let folder = workspace().join("examples/three-houses");
    let text = std::fs::read_to_string(folder.join("model.toml")).unwrap();
    let model = Model::from_toml(&text, &folder).unwrap();
    let pumps = model.edges.iter().filter(|edge| edge.params.kind() == "pump");
    let off: Vec<Change> = pumps
        .map(|pump| Change::Set { parameter: format!("{}.speed", pump.id), value: 0.0.into() })
        .collect();
    assert_eq!(off.len(), 2);
    let mut still = model.with(&off).unwrap();
    still.drivers.clear();
    let steady = steady::solve(&still).unwrap();
    for edge in &steady.edges {
        assert!(edge.m_flow_kg_s.abs() < 1e-8, "{}: {} kg/s", edge.id, edge.m_flow_kg_s);
    }
    for node in &steady.nodes {
        assert!((node.p_pa - 1.5e5).abs() < 1e-3, "{}: {} Pa", node.id, node.p_pa);
    }
    // At rest every law has a finite, positive slope.
    let plan = build(&still).unwrap();
    let (network, state) = (plan.network(), NetworkState::new(plan.network(), 300.0));
    for (i, edge) in network.edges.iter().enumerate() {
        let name = &plan.edge_names()[i];
        let Characteristic::PressureLoss(law) =
            edge.characteristic(0.0, &state.edge_state(network, i))
        else {
            panic!("{name} has no pressure loss");
        };
        assert!(law.slope.is_finite() && law.slope > 0.0, "{name}: slope {}", law.slope);
    }
}
