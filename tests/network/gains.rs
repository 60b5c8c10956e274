//! Gains of the linearised network: by hand, and against random networks that are solved again with
//! everything that can be given changed in turn.
#![allow(clippy::unwrap_used)]

use anergy_core::ids::{EdgeId, NodeId};
use anergy_core::medium::Medium;
use anergy_network::elements::check_valve::CheckValveParams;
use anergy_network::elements::dp_controller::DpControllerParams;
use anergy_network::elements::flow_source::FlowSourceParams;
use anergy_network::elements::pressure_source::PressureSourceParams;
use anergy_network::elements::pump::PumpParams;
use anergy_network::elements::resistance::ResistanceParams;
use anergy_network::elements::{Element, ElementParams};
use anergy_network::graph::{
    Edge, GRAVITY_M_S2, Network, Node, NodeKind, Prescription, Quantity, Regulator,
};
use anergy_network::hydraulics::{HydraulicError, HydraulicSolver};
use anergy_network::linearize::{Cause, Linearization, Response, Valves};
use anergy_network::state::{Hold, NetworkState};
use anergy_network::two_port::{Characteristic, EdgeState};
use anergy_tests::{Random, samples};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::collections::BTreeMap;

/// Networks in a usual run; `NETWORKS=10000` looks further.
const NETWORKS: u64 = 300;
/// What a gain may differ from the quotient of differences, relative to the largest gain of its cause,
/// besides twice what the quotients of two steps differ by.
const GAIN: f64 = 1e-4;

fn network(nodes: &[NodeKind], edges: &[(usize, usize, ElementParams)]) -> Network {
    let medium = Medium::default();
    let edges = edges.iter().map(|(from, to, params)| Edge {
        from: NodeId::from_index(*from),
        to: NodeId::from_index(*to),
        element: params.build(&medium).unwrap(),
        loss_factor: 1.0,
        partner: None,
        leads_partner: false,
    });
    let node = |&kind| Node { kind, elevation_m: 0.0, volume_m3: 0.0, ua_w_k: 0.0 };
    Network {
        medium,
        gravity_m_s2: GRAVITY_M_S2,
        nodes: nodes.iter().map(node).collect(),
        edges: edges.collect(),
        ports: Vec::new(),
        prescriptions: Vec::new(),
        couplings: Vec::new(),
        soil: Vec::new(),
        regulators: Vec::new(),
    }
}

/// `dp = dp_pa (m/m_flow_kg_s)^2`.
fn resistance(dp_pa: f64, m_flow_kg_s: f64) -> ElementParams {
    ElementParams::Resistance(ResistanceParams {
        kv_m3_h: None,
        dp_nominal_pa: Some(dp_pa),
        m_flow_nominal_kg_s: Some(m_flow_kg_s),
        delta_m: 1e-3,
        ..ResistanceParams::default()
    })
}

fn solved(network: &Network, mut state: NetworkState) -> Result<NetworkState, String> {
    let mut solver = HydraulicSolver::new(network).map_err(|error| error.to_string())?;
    state.invalidate_hydraulics();
    solver.solve(network, &mut state).map_err(|error| error.to_string())?;
    Ok(state)
}

#[test]
fn common_and_differential_gain_of_identical_feeders() {
    // N feeders at one pair of nodes, V each: u^2 H0 = K_own V^2 + K_sh (N V)^2, so in the common mode
    // dV/du = u H0/((K_own + N^2 K_sh) V), and in the differential mode, in which the shared part keeps
    // its flow, dV/du = u H0/(K_own V). K in hPa/(l/min)^2, H0 in hPa, V in l/min (SC-07).
    const OWN: f64 = 0.670_02;
    const SHARED: f64 = 3.004_95;
    const PUMP: f64 = 0.131_381;
    const HEAD: f64 = 402.21;
    // Speeds and gains of the specification: common, differential.
    for (n, v, speed, common, differential) in [
        (1_usize, 3.0, 0.287, 10.46, 0.0),
        (2, 3.0, 0.533, 5.63, 106.6),
        (3, 2.0, 0.525, 3.81, 157.6),
    ] {
        let u = ((OWN + SHARED * (n * n) as f64) / HEAD).sqrt() * v;
        assert!((u - speed).abs() < 1e-3, "{u}");
        // Node 0 is cold, 1 hot; each feeder has a node behind its pump. K hPa/(l/min)^2 = 100 * 3600 K Pa/(kg/s)^2.
        let mut kinds = vec![NodeKind::PressureReference, NodeKind::Junction];
        let mut edges = vec![(1, 0, resistance(3.6e5 * SHARED, 1.0))];
        for _ in 0..n {
            let pump = PumpParams { delta_m: 1e-3, ..PumpParams::default() };
            let node = kinds.len();
            kinds.push(NodeKind::Junction);
            edges.push((0, node, ElementParams::Pump(pump)));
            edges.push((node, 1, resistance(3.6e5 * (OWN - PUMP), 1.0)));
        }
        let network = network(&kinds, &edges);
        let mut state = NetworkState::new(&network, 300.0);
        let pumps: Vec<EdgeId> = (0..n).map(|i| EdgeId::from_index(1 + 2 * i)).collect();
        for pump in &pumps {
            state.position[pump.index()] = u;
        }
        let state = solved(&network, state).unwrap();
        for pump in &pumps {
            assert!((state.m_flow_kg_s[pump.index()] * 60.0 / v - 1.0).abs() < 1e-4);
        }
        let mut linearization = Linearization::new(&network, &state).unwrap();
        let mut response = Response::new(&network);
        let mut sum = vec![0.0; n];
        let mut own = Vec::new();
        for pump in &pumps {
            linearization.respond(&network, Cause::Position(*pump), &mut response);
            for (sum, other) in sum.iter_mut().zip(&pumps) {
                *sum += response.m_flow_kg_s[other.index()] * 60.0;
            }
            let at = |i: usize| response.m_flow_kg_s[pumps[i].index()] * 60.0;
            // One up, the next one down.
            own.push(if n > 1 && *pump == pumps[0] { at(0) - at(1) } else { 0.0 });
        }
        for sum in sum {
            let exact = u * HEAD / ((OWN + (n * n) as f64 * SHARED) * v);
            assert!((sum / exact - 1.0).abs() < 1e-3, "N = {n}: {sum} instead of {exact}");
            assert!((sum - common).abs() < 0.006, "N = {n}: {sum} instead of {common}");
        }
        if n > 1 {
            let exact = u * HEAD / (OWN * v);
            assert!((own[0] / exact - 1.0).abs() < 1e-3, "N = {n}: {} not {exact}", own[0]);
            assert!((own[0] / differential - 1.0).abs() < 1e-3, "N = {n}: {}", own[0]);
        }
    }
}

#[test]
fn every_effect_of_a_position_is_the_slope_of_the_law_over_it() {
    let medium = Medium::default();
    let mut runner = TestRunner::new_with_rng(
        Config::default(),
        TestRng::from_seed(RngAlgorithm::ChaCha, &[5; 32]),
    );
    let mut random = Random(3);
    for kind in ElementParams::KINDS {
        let (mut compared, mut moving) = (0, 0);
        for _ in 0..200 {
            let params = samples::params(kind).new_tree(&mut runner).unwrap().current();
            let element = params.build(&medium).unwrap();
            let ends = element.actuator().map(|a| (a.min, a.max));
            let ends = ends.or(element.regulation().map(|_| (0.0, 1.0)));
            let nominal = element.m_flow_nominal_kg_s();
            let Some((min, max)) = ends else {
                let at = EdgeState { position: 0.3, density_kg_m3: 998.0, viscosity_pa_s: 1e-3 };
                assert_eq!(element.loss_by_position(nominal, &at), 0.0, "{kind}");
                continue;
            };
            let max = if max.is_finite() { max } else { nominal };
            if !min.is_finite() {
                continue;
            }
            let position = random.between(min, max);
            // Any flow, and those about the one that it may hold.
            let m = match random.below(3) {
                0 => 2.0 * nominal * random.between(-1.0, 1.1),
                1 => position * random.between(-1.0, 1.1),
                _ => position * random.between(0.999, 1.001),
            };
            let loss = |position: f64| {
                let at = EdgeState { position, density_kg_m3: 998.0, viscosity_pa_s: 1e-3 };
                match element.characteristic(m, &at) {
                    Characteristic::PressureLoss(law) => law.value,
                    _ => f64::NAN,
                }
            };
            let at = EdgeState { position, density_kg_m3: 998.0, viscosity_pa_s: 1e-3 };
            let exact = element.loss_by_position(m, &at);
            let quotient = |share: f64| {
                let h = share * position.min(max - position);
                (loss(position + h) - loss(position - h)) / (2.0 * h)
            };
            let (wide, narrow) = (quotient(2e-5), quotient(1e-5));
            let rounding = 1e-15 * loss(position).abs() / (1e-5 * position.min(max - position));
            let off = (wide - narrow).abs();
            if !narrow.is_finite() || off > 1e-4 * exact.abs().max(narrow.abs()) + rounding {
                continue; // a kink, or shut
            }
            compared += 1;
            moving += i32::from(exact.abs() > 1e3 * rounding);
            let allowed = 1e-6 * exact.abs() + 2.0 * off + 10.0 * rounding;
            assert!(
                (exact - narrow).abs() <= allowed,
                "{params:?} at {position}, {m} kg/s: {exact}, {narrow}"
            );
        }
        let has_position = !matches!(
            *kind,
            "pipe"
                | "check_valve"
                | "resistance"
                | "heat_exchanger"
                | "heat_meter"
                | "overflow_valve"
                | "flow_source"
                | "pressure_source"
        );
        assert!(!has_position || (compared >= 100 && moving >= 50), "{kind}: {compared}, {moving}");
    }
}

/// A random network with everything that can be given or follows, solved.
fn sample(seed: u64) -> Option<(Network, NetworkState)> {
    let mut random = Random(seed);
    let mut bytes = [0_u8; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    let n = 3 + random.below(12);
    let mut kinds = vec![NodeKind::Junction; n];
    kinds[0] = NodeKind::PressureBoundary;
    if random.below(2) == 0 {
        kinds[n - 1] = NodeKind::PressureBoundary;
    }
    kinds[1] = NodeKind::Source;
    let mut edges = Vec::new();
    for i in 1..n + random.below(n) {
        let (from, to) = if i < n {
            (random.below(i), i)
        } else {
            let from = random.below(n);
            (from, (from + 1 + random.below(n - 1)) % n)
        };
        let kind = match random.below(20) {
            0..4 => "pump",
            4..7 => "valve",
            7 => "check_valve",
            8 => "flow_limiter",
            9 => "overflow_valve",
            10 => "ball_valve",
            11 | 12 => "dp_controller",
            13 => "heat_exchanger",
            14 => "resistance",
            _ => "pipe",
        };
        let mut params = samples::params(kind).new_tree(&mut runner).unwrap().current();
        if let ElementParams::DpController(controller) = &mut params {
            *controller =
                DpControllerParams { dp_set_pa: random.between(1e3, 1e5), ..controller.clone() };
        }
        let (from, to) = if random.below(2) == 0 { (from, to) } else { (to, from) };
        edges.push((from, to, params));
    }
    // No part may hang on a given flow or a closed valve alone.
    for i in 1..n {
        edges.push((random.below(i), i, resistance(random.between(1e3, 1e6), 1.0)));
    }
    if random.below(3) == 0 {
        edges.push((
            n - 2,
            0,
            ElementParams::PressureSource(PressureSourceParams {
                head_pa: random.between(0.0, 1e5),
            }),
        ));
    }
    let flow = FlowSourceParams { m_flow_kg_s: Some(random.between(0.0, 1.0)), v_flow_m3_s: None };
    edges.push((0, n / 2, ElementParams::FlowSource(flow)));
    let mut network = network(&kinds, &edges);
    for (i, edge) in network.edges.iter().enumerate() {
        if let Some(regulation) = edge.element.regulation() {
            let (high, low) = (random.below(n), random.below(n));
            let (high, low) = (NodeId::from_index(high), Some(NodeId::from_index(low)));
            network.regulators.push(Regulator {
                edge: EdgeId::from_index(i),
                high,
                low,
                regulation,
            });
        }
    }
    if !network.problems().is_empty() {
        return None;
    }
    let mut state = NetworkState::new(&network, 300.0);
    for (i, kind) in kinds.iter().enumerate() {
        match kind {
            NodeKind::PressureBoundary => {
                state.set_boundary(i, random.between(1e5, 3e5), 0.0, 300.0);
            }
            NodeKind::Source => state.set_boundary(i, 0.0, random.between(-0.5, 0.5), 300.0),
            _ => {}
        }
    }
    for (i, edge) in network.edges.iter().enumerate() {
        let actuator = edge.element.actuator();
        if let Some(actuator) = actuator.filter(|actuator| actuator.max.is_finite()) {
            state.position[i] =
                actuator.min + random.between(0.1, 0.9) * (actuator.max - actuator.min);
        }
    }
    let state = solved(&network, state).ok()?;
    // Something is given in place of an actuator: what it is now.
    let free: Vec<usize> = (0..network.edges.len())
        .filter(|&i| matches!(network.edges[i].element, Element::Pump(_) | Element::Valve(_)))
        .filter(|&i| state.m_flow_kg_s[i].abs() > 1e-3)
        .collect();
    if free.is_empty() || random.below(2) == 0 {
        return Some((network, state));
    }
    let free = EdgeId::from_index(*random.choose(&free));
    let some_edge = EdgeId::from_index(random.below(network.edges.len()));
    let quantity = match random.below(4) {
        0 => Quantity::MassFlow(free),
        1 => Quantity::MassFlow(some_edge),
        2 => Quantity::PressureDifference(some_edge),
        _ => Quantity::Pressure(NodeId::from_index(random.below(n))),
    };
    let value = match quantity {
        Quantity::MassFlow(edge) => state.m_flow_kg_s[edge.index()],
        Quantity::PressureDifference(edge) => state.dp_pa(&network, edge.index()),
        Quantity::Pressure(node) => state.p_pa[node.index()],
    };
    let mut given = network.clone();
    given.prescriptions = vec![Prescription { quantity, free }];
    if !given.problems().is_empty() {
        return Some((network, state));
    }
    let mut start = NetworkState::new(&given, 300.0);
    start.position.clone_from(&state.position);
    start.m_flow_kg_s.clone_from(&state.m_flow_kg_s);
    for i in 0..n {
        start.set_boundary(i, state.given_p_pa[i], state.given_m_flow_kg_s[i], 300.0);
    }
    start.prescribe(0, value);
    let held = solved(&given, start).ok()?;
    (held.prescribed[0].hold == Hold::Held).then_some((given, held))
}

/// The state with a given thing changed, solved again.
fn changed(network: &Network, state: &NetworkState, cause: Cause, by: f64) -> Option<NetworkState> {
    let mut state = state.clone();
    match cause {
        Cause::Position(edge) => state.position[edge.index()] += by,
        Cause::NodePressure(node) => state.given_p_pa[node.index()] += by,
        Cause::NodeInflow(node) => state.given_m_flow_kg_s[node.index()] += by,
        Cause::Prescribed(k) => state.prescribe(k, state.prescribed[k].value + by),
        Cause::Regulator(k) => state.set_regulator(k, state.regulated[k].set_pa + by),
        Cause::Head(_) | Cause::ImposedFlow(_) => return None,
    }
    // Not beyond the limits of a free actuator.
    solved(network, state)
        .ok()
        .filter(|state| state.prescribed.iter().all(|p| p.hold == Hold::Held))
}

/// Changes of flows and pressures over that of a cause: central differences of solved networks.
fn quotient(
    network: &Network,
    state: &NetworkState,
    cause: Cause,
    h: f64,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let (up, down) = (changed(network, state, cause, h)?, changed(network, state, cause, -h)?);
    let slope = |up: &[f64], down: &[f64]| -> Vec<f64> {
        up.iter().zip(down).map(|(up, down)| (up - down) / (2.0 * h)).collect()
    };
    Some((slope(&up.m_flow_kg_s, &down.m_flow_kg_s), slope(&up.p_pa, &down.p_pa)))
}

#[test]
fn gains_are_those_of_networks_solved_again() {
    let count = std::env::var("NETWORKS").ok().and_then(|n| n.parse().ok()).unwrap_or(NETWORKS);
    let (mut networks, mut compared, mut unclear) = (0, 0, 0);
    let (mut positions, mut boundaries, mut prescribed, mut set, mut again) = (0, 0, 0, 0, 0);
    for seed in 0..count {
        let Some((network, state)) = sample(seed) else { continue };
        networks += 1;
        let mut linearization = match Linearization::new(&network, &state) {
            // Given is by chance what it is without effect of the actuator.
            Err(HydraulicError::NoEffect { .. }) if !network.prescriptions.is_empty() => continue,
            linearization => linearization.unwrap(),
        };
        let mut response = Response::new(&network);
        // What is prescribed is met within 1e-2 Pa or 1e-8 kg/s and 1e-7 of it: so uncertain are the others.
        let mut uncertain = Response::new(&network);
        if let (Some(prescription), Some(prescribed)) =
            (network.prescriptions.first(), state.prescribed.first())
        {
            linearization.respond(&network, Cause::Prescribed(0), &mut uncertain);
            let least =
                if matches!(prescription.quantity, Quantity::MassFlow(_)) { 1e-8 } else { 1e-2 };
            let tolerance = 2.0 * (least + 1e-7 * prescribed.value.abs());
            let Response { m_flow_kg_s, p_pa } = &mut uncertain;
            m_flow_kg_s.iter_mut().chain(p_pa).for_each(|gain| *gain = gain.abs() * tolerance);
        }
        let mut causes = Vec::new();
        for (i, edge) in network.edges.iter().enumerate() {
            let Some(actuator) = edge.element.actuator() else { continue };
            let given = network.prescriptions.iter().any(|p| p.free.index() == i);
            let max = if actuator.max.is_finite() {
                actuator.max
            } else {
                edge.element.m_flow_nominal_kg_s()
            };
            if !given && state.position[i] > actuator.min {
                let pressure = matches!(edge.element, Element::PressureSource(_));
                causes.push((
                    Cause::Position(EdgeId::from_index(i)),
                    if pressure { 1e5 } else { max },
                ));
            }
        }
        for (i, node) in network.nodes.iter().enumerate() {
            let id = NodeId::from_index(i);
            match node.kind {
                NodeKind::PressureBoundary => causes.push((Cause::NodePressure(id), 1e5)),
                NodeKind::Source => causes.push((Cause::NodeInflow(id), 1.0)),
                _ => {}
            }
        }
        for k in 0..network.prescriptions.len() {
            causes.push((Cause::Prescribed(k), 10.0 * state.prescribed[k].value.abs()));
        }
        for k in 0..network.regulators.len() {
            causes.push((Cause::Regulator(k), state.regulated[k].set_pa));
        }
        for (cause, scale) in causes {
            linearization.respond(&network, cause, &mut response);
            // Openings that follow and prescribed quantities are found within 1e-9 and 1e-7 only.
            let loose = !network.prescriptions.is_empty() || !network.regulators.is_empty();
            let step = if loose { 1e-3 } else { 1e-4 } * scale;
            // A kink may be near: then a smaller step decides.
            let mut problems: BTreeMap<(usize, usize), String> = BTreeMap::new();
            for h in [step, 0.1 * step, 0.01 * step] {
                let quotient = |h: f64| quotient(&network, &state, cause, h);
                let (Some(wide), Some(narrow)) = (quotient(h), quotient(0.5 * h)) else { break };
                let noise = if loose { 1e-7 } else { 1e-9 } / h;
                let noise_pa = if loose { 3e-2 } else { 1e-4 } / h;
                let columns = [
                    (&response.m_flow_kg_s, &wide.0, &narrow.0, noise, &uncertain.m_flow_kg_s),
                    (&response.p_pa, &wide.1, &narrow.1, noise_pa, &uncertain.p_pa),
                ];
                let before = std::mem::take(&mut problems);
                for (column, (gains, wide, narrow, noise, uncertain)) in
                    columns.into_iter().enumerate()
                {
                    let largest = gains.iter().fold(0.0_f64, |most, gain| most.max(gain.abs()));
                    for (i, gain) in gains.iter().enumerate() {
                        if h < step && !before.contains_key(&(column, i)) {
                            continue;
                        }
                        let off = (wide[i] - narrow[i]).abs();
                        let noise = noise + uncertain[i] / h;
                        compared += 1;
                        if off > 0.02 * largest + noise {
                            unclear += 1;
                            continue;
                        }
                        let allowed = GAIN * largest + 2.0 * off + noise;
                        let too_noisy = h < step && noise > 0.01 * largest;
                        if (gain - narrow[i]).abs() > allowed || too_noisy {
                            let problem = format!(
                                "network {seed}, {cause:?}: gain {i} of {} is {gain}, by differences \
                                 {} or {}, largest {largest}, noise {noise}",
                                gains.len(),
                                narrow[i],
                                wide[i],
                            );
                            problems.insert((column, i), problem);
                        }
                    }
                    if h == step && largest > 100.0 * noise {
                        match cause {
                            Cause::Position(_) => positions += 1,
                            Cause::Prescribed(_) => prescribed += 1,
                            Cause::Regulator(_) => set += 1,
                            _ => boundaries += 1,
                        }
                    }
                }
                if problems.is_empty() {
                    break;
                }
                again += 1;
            }
            assert!(problems.is_empty(), "{problems:#?}");
        }
    }
    assert!(again * 20 < networks, "{again} times a smaller step");
    assert!(networks * 3 > count * 2, "{networks} of {count} networks solved");
    assert!(unclear * 20 < compared, "{unclear} of {compared} gains without a clear quotient");
    let seen = [positions, boundaries, prescribed, set];
    assert!(seen.iter().all(|seen| *seen > 10), "{seen:?}");
}

#[test]
fn heads_are_reciprocal_and_valves_that_stay_are_stiffer() {
    let mut differ = 0;
    for seed in 0..100 {
        let Some((network, state)) = sample(seed) else { continue };
        if !network.prescriptions.is_empty() {
            continue;
        }
        let mut stay = Linearization::with_valves(&network, &state, Valves::Stay).unwrap();
        let edges: Vec<EdgeId> = (0..network.edges.len()).map(EdgeId::from_index).collect();
        let mut response = Response::new(&network);
        // Stiff edges: their answers are small differences of their conductances.
        let conductance = |i: usize| match network.edges[i]
            .characteristic(state.m_flow_kg_s[i], &state.edge_state(&network, i))
        {
            Characteristic::PressureLoss(law) => 1.0 / law.slope,
            _ => 0.0,
        };
        let gains: Vec<Vec<f64>> = edges
            .iter()
            .map(|edge| {
                stay.respond(&network, Cause::Head(*edge), &mut response);
                response.m_flow_kg_s.clone()
            })
            .collect();
        for i in 0..edges.len() {
            assert!(gains[i][i] >= 0.0, "more head, less flow");
            for j in 0..i {
                let scale = (gains[i][i] * gains[j][j]).sqrt().max(1e-18);
                let rounding = 1e-13 * (conductance(i) + conductance(j));
                assert!(
                    (gains[i][j] - gains[j][i]).abs() <= 1e-9 * scale + rounding,
                    "network {seed}: {i}, {j}"
                );
                // Of a symmetric positive matrix.
                assert!(
                    gains[i][j].abs() <= scale * (1.0 + 1e-9) + rounding,
                    "network {seed}: {i}, {j}"
                );
            }
        }
        let mut follow = Linearization::new(&network, &state).unwrap();
        for (i, edge) in edges.iter().enumerate() {
            follow.respond(&network, Cause::Head(*edge), &mut response);
            differ += usize::from(
                response
                    .m_flow_kg_s
                    .iter()
                    .zip(&gains[i])
                    .any(|(a, b)| (a - b).abs() > 1e-3 * gains[i][i]),
            );
        }
    }
    assert!(differ > 10, "{differ}");
}

#[test]
fn the_check_valve_nearest_to_its_kink_is_named() {
    // Two branches from 0 to 1 with 1 and 4 kPa at 1 kg/s; 100 Pa drive 0.316 and 0.158 kg/s.
    let check_valve = CheckValveParams { kvs_m3_h: 1000.0, ..CheckValveParams::default() };
    let kinds = [
        NodeKind::PressureBoundary,
        NodeKind::PressureBoundary,
        NodeKind::Junction,
        NodeKind::Junction,
    ];
    let network = network(
        &kinds,
        &[
            (0, 2, resistance(1e3, 1.0)),
            (2, 1, ElementParams::CheckValve(check_valve.clone())),
            (0, 3, resistance(4e3, 1.0)),
            (3, 1, ElementParams::CheckValve(check_valve)),
        ],
    );
    let mut state = NetworkState::new(&network, 300.0);
    state.set_boundary(0, 100.0, 0.0, 300.0);
    let state = solved(&network, state).unwrap();
    let mut linearization = Linearization::new(&network, &state).unwrap();
    let mut response = Response::new(&network);
    // A head against the second branch: m/(dm/dh) = 2 * 100 Pa for a square law.
    let cause = Cause::Head(EdgeId::from_index(2));
    linearization.respond(&network, cause, &mut response);
    let (edge, change) = Linearization::closing(&network, &state, &response).unwrap();
    assert_eq!(edge, EdgeId::from_index(3));
    assert!((change + 200.0).abs() < 1.0, "{change}");
}

#[test]
fn an_answer_allocates_nothing() {
    let mut followed = 0;
    for seed in 0..40 {
        let Some((network, state)) = sample(seed) else { continue };
        let Ok(mut linearization) = Linearization::new(&network, &state) else { continue };
        let mut response = Response::new(&network);
        followed += network.prescriptions.len() + network.regulators.len();
        let allocated = allocation_counter::measure(|| {
            linearization.update(&network, &state).unwrap();
            for i in 0..network.edges.len() {
                let cause = Cause::Position(EdgeId::from_index(i));
                linearization.respond(&network, cause, &mut response);
            }
        });
        assert_eq!(allocated.count_total, 0, "network {seed}");
    }
    assert!(followed > 0);
}
