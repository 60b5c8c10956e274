//! Random networks: whatever is connected to whatever, the hydraulics converge, water is conserved, the
//! result depends neither on the start of the iteration nor on the numbering, and the heat balance of
//! the transport closes to rounding.

#![allow(clippy::unwrap_used)]

use anergy_core::ids::{EdgeId, NodeId};
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortRequest};
use anergy_network::elements::resistance::ResistanceParams;
use anergy_network::elements::{Element, ElementParams};
use anergy_network::graph::{Edge, GRAVITY_M_S2, Network, Node, NodeKind};
use anergy_network::hydraulics::{HydraulicReport, HydraulicSolver};
use anergy_network::state::NetworkState;
use anergy_network::transport::Transport;
use anergy_tests::{Random, samples};
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Networks in a usual run of the tests; `NETWORKS=10000` looks further.
const NETWORKS: u32 = 100;
/// What a node may lose, kg/s.
const MASS_KG_S: f64 = 1e-9;
/// What flows may depend on the start of the iteration, kg/s and relative.
const START: f64 = 1e-8;
/// What flows may depend on the numbering, kg/s and relative.
const NUMBERING: f64 = 1e-9;
/// What the heat balance of a step may miss, relative to its largest part.
const HEAT: f64 = 1e-9;
/// Water at rest: what rounding leaves over at a node, kg/s.
const ROUNDING_KG_S: f64 = 1e-12;

/// A network as plain data.
#[derive(Debug, Clone)]
struct Sample {
    nodes: Vec<SampleNode>,
    edges: Vec<SampleEdge>,
    /// A second node with a given pressure, which makes both open ends; without it node 0 holds the
    /// pressure and exchanges nothing.
    open_end: Option<(usize, f64)>,
    /// Water that enters at one node and leaves at another, kg/s.
    source: Option<(usize, usize, f64)>,
    /// Whether the first two heat exchangers are the two sides of one.
    coupled: bool,
    /// For whatever else is random: start flows, numbering, temperatures, steps.
    seed: u64,
}

#[derive(Debug, Clone)]
struct SampleNode {
    elevation_m: f64,
    volume_m3: f64,
}

#[derive(Debug, Clone)]
struct SampleEdge {
    from: usize,
    to: usize,
    params: ElementParams,
    /// Position of the actuator within its range.
    share: f64,
}

fn params() -> impl Strategy<Value = ElementParams> {
    prop_oneof![
        4 => samples::params("pipe"),
        2 => samples::params("pump"),
        2 => samples::params("valve"),
        1 => samples::params("resistance"),
        1 => samples::params("check_valve"),
        2 => samples::params("heat_exchanger"),
    ]
}

/// An edge that imposes a flow or a pressure difference; there is at most one of each in a network.
fn ideal() -> impl Strategy<Value = (u32, u32, ElementParams)> {
    let params = prop_oneof![samples::params("flow_source"), samples::params("pressure_source")];
    (any::<u32>(), any::<u32>(), params)
}

/// What lets a prescribed flow through in any case.
fn way_out() -> ElementParams {
    ElementParams::Resistance(ResistanceParams {
        kv_m3_h: Some(4.0),
        dp_nominal_pa: None,
        m_flow_nominal_kg_s: None,
        delta_m: 0.1,
        ..ResistanceParams::default()
    })
}

fn sample() -> impl Strategy<Value = Sample> {
    let share = || prop_oneof![1 => Just(0.0), 1 => Just(1.0), 4 => 0.0..1.0];
    let node = (0.0..60.0, prop_oneof![Just(0.0), 1e-4..0.5])
        .prop_map(|(elevation_m, volume_m3)| SampleNode { elevation_m, volume_m3 });
    // Each node is joined to one before it, then come edges between any two.
    let tree = vec((node, any::<u32>(), any::<bool>(), params(), share()), 1..12);
    let chords = vec((any::<u32>(), any::<u32>(), params(), share()), 1..9);
    let open_end = option::weighted(0.4, (any::<u32>(), 0.0..6e5));
    let source = option::weighted(0.4, (any::<u32>(), any::<u32>(), 0.001..2.0));
    let rest = (option::weighted(0.4, ideal()), any::<bool>(), any::<u64>());
    (tree, chords, open_end, source, rest).prop_map(
        |(tree, chords, open_end, source, (ideal, coupled, seed))| {
            let mut nodes = vec![SampleNode { elevation_m: 0.0, volume_m3: 0.0 }];
            let mut edges = Vec::new();
            for (node, other, turned, params, share) in tree {
                let (new, old) = (nodes.len(), other as usize % nodes.len());
                nodes.push(node);
                let (from, to) = if turned { (new, old) } else { (old, new) };
                edges.push(SampleEdge { from, to, params, share });
            }
            let n = nodes.len();
            // Another node than the first one.
            let another = |first: usize, by: u32| (first + 1 + by as usize % (n - 1)) % n;
            for (from, by, params, share) in chords {
                let from = from as usize % n;
                edges.push(SampleEdge { from, to: another(from, by), params, share });
            }
            let open_end = open_end.map(|(by, p_pa)| (another(0, by), p_pa));
            // Water enters and leaves at nodes whose pressure is free.
            let free = |i: usize| i != 0 && open_end.is_none_or(|(end, _)| end != i);
            let source = source.and_then(|(first, by, m)| {
                let first = 1 + first as usize % (n - 1);
                let second = another(first, by);
                (free(first) && free(second)).then_some((first, second, m))
            });
            if let Some((from, to, _)) = source {
                // Otherwise the only way might be through a closed valve: no water, or 1e18 Pa.
                edges.push(SampleEdge { from, to, params: way_out(), share: 0.0 });
            }
            if let Some((from, by, params)) = ideal {
                let (from, to) = (from as usize % n, another(from as usize % n, by));
                // Two fixed pressures must not be joined by a head.
                let fixed = |i: usize| i == 0 || open_end.is_some_and(|(end, _)| end == i);
                let imposes_flow = matches!(params, ElementParams::FlowSource(_));
                if imposes_flow {
                    edges.push(SampleEdge { from, to, params: way_out(), share: 0.0 });
                }
                if imposes_flow || !(fixed(from) && fixed(to)) {
                    edges.push(SampleEdge { from, to, params, share: 0.0 });
                }
            }
            Sample { nodes, edges, open_end, source, coupled, seed }
        },
    )
}

impl Sample {
    /// The network and its state at rest. `order` are the nodes and edges in the order of their ids.
    fn build(&self, order: &Order) -> (Network, NetworkState) {
        let medium = Medium::default();
        let kind = |i: usize| match (self.open_end, self.source) {
            (Some((end, _)), _) if i == 0 || i == end => NodeKind::PressureBoundary,
            (None, _) if i == 0 => NodeKind::PressureReference,
            (_, Some((first, second, _))) if i == first || i == second => NodeKind::Source,
            _ => NodeKind::Junction,
        };
        let id = |i: usize| NodeId::from_index(order.nodes.iter().position(|&n| n == i).unwrap());
        let nodes = order.nodes.iter().map(|&i| Node {
            kind: kind(i),
            elevation_m: self.nodes[i].elevation_m,
            volume_m3: self.nodes[i].volume_m3,
            ua_w_k: 0.0,
        });
        let edges = order.edges.iter().map(|&i| {
            let SampleEdge { from, to, params, .. } = &self.edges[i];
            Edge {
                from: id(*from),
                to: id(*to),
                element: params.build(&medium).unwrap(),
                loss_factor: 1.0,
                partner: None,
                leads_partner: false,
            }
        });
        let mut network = Network {
            medium,
            gravity_m_s2: GRAVITY_M_S2,
            nodes: nodes.collect(),
            edges: edges.collect(),
            ports: Vec::new(),
            prescriptions: Vec::new(),
            couplings: Vec::new(),
            soil: Vec::new(),
            regulators: Vec::new(),
        };
        let exchangers = (0..self.edges.len())
            .filter(|&i| matches!(self.edges[i].params, ElementParams::HeatExchanger(_)));
        let mut exchangers: Vec<usize> = exchangers.collect();
        let id_of = |i: usize| order.edges.iter().position(|&e| e == i).unwrap();
        if self.coupled && exchangers.len() >= 2 {
            let (lead, other) = (id_of(exchangers[0]), id_of(exchangers[1]));
            network.edges[lead].partner = Some(EdgeId::from_index(other));
            network.edges[lead].leads_partner = true;
            network.edges[other].partner = Some(EdgeId::from_index(lead));
            exchangers.drain(..2);
        }
        // Units stand behind the other exchangers, and in the water of an imposed flow.
        let imposed = (0..self.edges.len())
            .filter(|&i| matches!(self.edges[i].params, ElementParams::FlowSource(_)));
        let ports = exchangers.into_iter().chain(imposed);
        network.ports = ports.map(|i| EdgeId::from_index(id_of(i))).collect();
        assert!(network.problems().is_empty(), "{:?}", network.problems());
        let mut state = NetworkState::new(&network, 320.0);
        for (edge, &i) in order.edges.iter().enumerate() {
            let actuator = network.edges[edge].element.actuator();
            if let Some(actuator) = actuator.filter(|actuator| actuator.max.is_finite()) {
                let range = actuator.max - actuator.min;
                state.position[edge] = actuator.min + self.edges[i].share * range;
            }
        }
        let mut given = |i: usize, p_pa: f64, m_flow_kg_s: f64| {
            state.set_boundary(id(i).index(), p_pa, m_flow_kg_s, 340.0);
        };
        given(0, 1.5e5, 0.0);
        if let Some((end, p_pa)) = self.open_end {
            given(end, p_pa, 0.0);
        }
        if let Some((first, second, m)) = self.source {
            given(first, 0.0, m);
            given(second, 0.0, -m);
        }
        (network, state)
    }

    fn in_order(&self) -> Order {
        Order { nodes: (0..self.nodes.len()).collect(), edges: (0..self.edges.len()).collect() }
    }
}

/// Which node and edge of the sample has which id.
struct Order {
    nodes: Vec<usize>,
    edges: Vec<usize>,
}

/// Runs a check on random networks, the same ones every time.
fn for_networks(check: impl Fn(&Sample) -> Result<(), String>) {
    let cases = std::env::var("NETWORKS").ok().and_then(|n| n.parse().ok()).unwrap_or(NETWORKS);
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let mut runner =
        TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &[11; 32]));
    let checked = runner.run(&sample(), |sample| check(&sample).map_err(TestCaseError::fail));
    if let Err(problem) = checked {
        panic!("{problem}");
    }
}

fn solve(network: &Network, state: &mut NetworkState) -> Result<HydraulicReport, String> {
    let mut solver = HydraulicSolver::new(network).map_err(|error| error.to_string())?;
    solver.solve(network, state).map_err(|error| error.to_string())
}

fn same_flows(found: &[f64], expected: &[f64], tolerance: f64) -> Result<(), String> {
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        if (found - expected).abs() > tolerance * expected.abs().max(1.0) {
            return Err(format!("edge {i} has {found} kg/s instead of {expected} kg/s"));
        }
    }
    Ok(())
}

#[test]
fn hydraulics_converge_and_conserve_water() {
    for_networks(|sample| {
        let (network, mut state) = sample.build(&sample.in_order());
        let report = solve(&network, &mut state)?;
        if report.mass_residual_kg_s > MASS_KG_S {
            return Err(format!("reports {report:?}"));
        }
        let mut balance = state.exchange_kg_s.clone();
        // What the sum at a node rounds: laws that no pipe has let 1e10 kg/s through.
        let mut rounding = vec![0.0; balance.len()];
        for (edge, m) in network.edges.iter().zip(&state.m_flow_kg_s) {
            balance[edge.from.index()] -= m;
            balance[edge.to.index()] += m;
            for node in [edge.from, edge.to] {
                rounding[node.index()] += 4.0 * f64::EPSILON * m.abs();
            }
        }
        for (i, (miss, rounding)) in balance.iter().zip(&rounding).enumerate() {
            if miss.is_nan() || miss.abs() > MASS_KG_S + rounding {
                return Err(format!("node {i} gains {miss} kg/s"));
            }
        }
        Ok(())
    });
}

#[test]
fn flows_do_not_depend_on_the_start() {
    for_networks(|sample| {
        let (network, mut state) = sample.build(&sample.in_order());
        solve(&network, &mut state)?;
        let expected = state.m_flow_kg_s.clone();
        let mut random = Random(sample.seed);
        for largest in [0.0, 0.01, 10.0] {
            state.m_flow_kg_s.fill_with(|| random.between(-largest, largest));
            state.invalidate_hydraulics();
            solve(&network, &mut state).map_err(|error| format!("from {largest}: {error}"))?;
            same_flows(&state.m_flow_kg_s, &expected, START)?;
        }
        Ok(())
    });
}

#[test]
fn flows_do_not_depend_on_the_numbering() {
    for_networks(|sample| {
        let (network, mut state) = sample.build(&sample.in_order());
        solve(&network, &mut state)?;
        let mut order = sample.in_order();
        let mut random = Random(sample.seed);
        random.shuffle(&mut order.nodes);
        random.shuffle(&mut order.edges);
        let (renumbered, mut other) = sample.build(&order);
        solve(&renumbered, &mut other)?;
        let expected: Vec<f64> = order.edges.iter().map(|&i| state.m_flow_kg_s[i]).collect();
        same_flows(&other.m_flow_kg_s, &expected, NUMBERING)
    });
}

#[test]
fn heat_balance_closes() {
    for_networks(|sample| {
        let (network, mut state) = sample.build(&sample.in_order());
        let mut solver = HydraulicSolver::new(&network).map_err(|error| error.to_string())?;
        let mut transport = Transport::new(&network).map_err(|error| error.to_string())?;
        let mut random = Random(sample.seed);
        for edge in 0..network.edges.len() {
            state.fill_pipe(edge, random.between(280.0, 360.0));
            state.t_edge_k[edge] = random.between(280.0, 360.0);
            state.surroundings_k[edge] = random.between(270.0, 300.0);
        }
        state.t_node_k.fill_with(|| random.between(280.0, 360.0));
        let cp = network.medium.heat_capacity_j_kg_k;
        let mut before_j = state.stored_j(&network);
        for step in 0..20 {
            let dt_s = 10_f64.powf(random.between(-1.0, 3.5));
            if step % 5 == 4 {
                // Other positions: flows change, some turn.
                for (position, edge) in state.position.iter_mut().zip(&network.edges) {
                    let actuator = edge.element.actuator().filter(|a| a.max.is_finite());
                    let largest = actuator.map_or(*position, |actuator| actuator.max);
                    *position = random.between(0.05, 1.0) * largest;
                }
                state.invalidate_hydraulics();
            }
            for request in &mut state.requests {
                let outlet = match random.below(3) {
                    0 => Outlet::HeatFlow(random.between(-1e3, 1e3)),
                    _ => Outlet::Temperature(random.between(280.0, 360.0)),
                };
                let idle = random.below(5) == 0;
                let m_flow_kg_s = if idle { 0.0 } else { random.between(-1.0, 1.0) };
                *request = PortRequest { m_flow_kg_s, outlet };
            }
            solver.solve(&network, &mut state).map_err(|error| error.to_string())?;
            transport.advance(&network, &mut state, dt_s).map_err(|error| error.to_string())?;
            let after_j = state.stored_j(&network);
            let units_w: f64 = state
                .port_flows
                .iter()
                .map(|flow| flow.m_flow_kg_s.abs() * cp * (flow.t_out_k - flow.t_in_k))
                .sum();
            let loss_w = state.q_loss_w.iter().sum::<f64>() + state.q_loss_nodes_w;
            let pumps = network.edges.iter().zip(&state.q_flow_w);
            let pumps = pumps.filter(|(edge, _)| matches!(edge.element, Element::Pump(_)));
            let pumps_w: f64 = pumps.map(|(_, q_w)| q_w).sum();
            let booked_j = dt_s * (units_w + pumps_w + state.boundary_w - loss_w);
            let miss_j = after_j - before_j - booked_j;
            // Pumps of networks without water to speak of heat it to any temperature.
            let span = |span: f64, t_k: &f64| span.max((t_k - 320.0).abs());
            let span_k = state.t_node_k.iter().fold(50.0, span);
            let through_j: f64 =
                state.m_flow_kg_s.iter().map(|m| m.abs() * cp * span_k * dt_s).sum();
            let largest_j = before_j.abs().max(booked_j.abs()).max(through_j);
            let rounding_j = ROUNDING_KG_S * cp * 100.0 * dt_s;
            if miss_j.is_nan() || miss_j.abs() > HEAT * largest_j + rounding_j {
                return Err(format!(
                    "step {step} of {dt_s} s misses {miss_j} J: stored {before_j} J, then {after_j} J; \
                     units {units_w} W, pumps {pumps_w} W, boundary {} W, loss {loss_w} W",
                    state.boundary_w
                ));
            }
            before_j = after_j;
        }
        Ok(())
    });
}
