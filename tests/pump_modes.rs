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
