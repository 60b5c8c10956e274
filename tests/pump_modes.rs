//! Pumps that hold a flow or a head, in networks: they reach their set value where the speed allows it,
//! are at full speed or at rest where not, and the solver needs no more than its usual iterations.

#![allow(clippy::unwrap_used)]

use anergy_core::ids::NodeId;
use anergy_core::medium::Medium;
use anergy_network::elements::pump::{PumpMode, PumpParams};
use anergy_network::elements::resistance::ResistanceParams;
use anergy_network::elements::{Element, ElementParams};
use anergy_network::graph::{Edge, GRAVITY_M_S2, Network, Node, NodeKind};
use anergy_network::hydraulics::HydraulicSolver;
use anergy_network::state::NetworkState;
use anergy_tests::Random;

/// Iterations of a cold solve.
const COLD_ITERATIONS: u32 = 30;

fn pump(mode: PumpMode) -> ElementParams {
    ElementParams::Pump(PumpParams { mode, ..PumpParams::default() })
}

/// `dp = c m^2` with 1 kPa at a flow.
fn resistance(m_flow_kg_s: f64) -> ElementParams {
    ElementParams::Resistance(ResistanceParams {
        dp_nominal_pa: Some(1e3),
        m_flow_nominal_kg_s: Some(m_flow_kg_s),
        kv_m3_h: None,
        delta_m: 0.02,
    })
}

fn network(nodes: usize, parts: &[(usize, usize, ElementParams)]) -> Network {
    let medium = Medium::default();
    let node = |kind| Node { kind, elevation_m: 0.0, volume_m3: 0.0 };
    let mut all = vec![node(NodeKind::PressureReference)];
    all.resize(nodes, node(NodeKind::Junction));
    let edges = parts.iter().map(|(from, to, params)| Edge {
        from: NodeId::from_index(*from),
        to: NodeId::from_index(*to),
        element: params.build(&medium).unwrap(),
        loss_factor: 1.0,
        partner: None,
        leads_partner: false,
    });
    let edges = edges.collect();
    Network {
        medium,
        gravity_m_s2: GRAVITY_M_S2,
        nodes: all,
        edges,
        ports: Vec::new(),
        prescriptions: Vec::new(),
    }
}

#[test]
fn one_loop_at_its_set_value_saturated_and_at_rest() {
    // Pump 0 -> 1 and a resistance back, 1 kPa at 0.1 kg/s: c = 1e5. Full speed: 40221/(c + 4.72972e4)
    // = 0.273060, m = 0.52255 kg/s.
    let solve = |mode, position| {
        let network = network(2, &[(0, 1, pump(mode)), (1, 0, resistance(0.1))]);
        let mut state = NetworkState::new(&network, 300.0);
        state.position[0] = position;
        let report = HydraulicSolver::new(&network).unwrap().solve(&network, &mut state).unwrap();
        assert!(report.iterations <= COLD_ITERATIONS, "{report:?}");
        let Element::Pump(pump) = &network.edges[0].element else { panic!("no pump") };
        let m = state.m_flow_kg_s[0];
        (m, -state.dp_pa(&network, 0), pump.speed(m, &state.edge_state(&network, 0)))
    };
    // 0.3 kg/s needs 9 kPa: u^2 = (9000 + 4256.7)/40221, u = 0.57410.
    let (m, _, speed) = solve(PumpMode::Flow, 0.3);
    assert!((m - 0.3).abs() < 3e-5 && (speed - 0.57410).abs() < 1e-4, "{m} {speed}");
    let (m, _, speed) = solve(PumpMode::Flow, 0.8);
    assert!((m - 0.52255).abs() < 1e-5 && speed > 0.9999, "{m} {speed}");
    let (m, ..) = solve(PumpMode::Flow, 0.0);
    assert!(m.abs() < 1e-8, "{m}");
    // 10 kPa drive sqrt(0.1) = 0.31623 kg/s, less 7e-4 of the head by the droop.
    let (m, head, _) = solve(PumpMode::Head, 1e4);
    assert!((m / 0.31623 - 1.0).abs() < 1e-3 && (head / 1e4 - 1.0).abs() < 1e-3, "{m} {head}");
    let (m, _, speed) = solve(PumpMode::Head, 35_000.0);
    assert!((m - 0.52255).abs() < 1e-4 && speed > 0.999, "{m} {speed}");
}

#[test]
fn houses_on_a_line_with_their_own_pumps_and_a_feed_pump() {
    // Supply 1..=n, return n+1..=2n, each house a pump and a resistance; the plant is a pump in head mode
    // from 0 (its return) to 1. Some houses ask for more than they can get, some for nothing.
    let n = 12;
    let mut parts = vec![(0, 1, pump(PumpMode::Head)), (n + 1, 0, resistance(3.0))];
    for i in 1..=n {
        parts.push((i, 2 * n + i, pump(PumpMode::Flow)));
        parts.push((2 * n + i, n + i, resistance(0.1)));
        if i < n {
            parts.push((i, i + 1, resistance(0.6)));
            parts.push((n + i + 1, n + i, resistance(0.6)));
        }
    }
    let network = network(3 * n + 1, &parts);
    let mut state = NetworkState::new(&network, 300.0);
    let mut solver = HydraulicSolver::new(&network).unwrap();
    let mut random = Random(5);
    let (mut held, mut full, mut most, mut total) = (0, 0, 0, 0);
    for _ in 0..200 {
        for (i, edge) in network.edges.iter().enumerate() {
            if let Some(actuator) = edge.element.actuator() {
                let share = *random.choose(&[0.0, 0.05, 0.3, 0.5, 0.9]);
                state.position[i] = share * actuator.max * random.between(0.8, 1.0);
            }
        }
        state.invalidate_hydraulics();
        let report = solver.solve(&network, &mut state).unwrap();
        most = most.max(report.iterations);
        total += report.iterations;
        for (i, edge) in network.edges.iter().enumerate().skip(2) {
            let Element::Pump(pump) = &edge.element else { continue };
            let (m, set) = (state.m_flow_kg_s[i], state.position[i]);
            let speed = pump.speed(m, &state.edge_state(&network, i));
            if set == 0.0 {
                assert_eq!(speed, 0.0, "edge {i} is off");
            } else if (m / set - 1.0).abs() < 1e-3 {
                held += 1;
            } else if m < set {
                assert!(speed > 0.99, "edge {i}: {m} of {set} kg/s at speed {speed}");
                full += 1;
            } else {
                assert!(speed < 0.05, "edge {i}: {m} of {set} kg/s at speed {speed}");
            }
        }
    }
    assert!(held > 500 && full > 100, "{held} held, {full} at full speed");
    // Kinked laws cost iterations, never the solution.
    assert!(most <= 120 && total <= 200 * 40, "at most {most}, {total} in all");
}
