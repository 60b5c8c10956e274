//! Cases with a solution on paper: single loop, symmetric networks, elevation, plug flow, standstill.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady::{self, Steady};
use std::path::Path;

fn model(text: &str) -> Model {
    Model::from_toml(text, Path::new("."))
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn solve(text: &str) -> Steady {
    steady::solve(&model(text)).unwrap_or_else(|error| panic!("{error}"))
}

fn l_min(steady: &Steady, edge: &str) -> f64 {
    steady.edge(edge).unwrap().m_flow_kg_s * 60.0
}

const PUMP: &str = "head_max_hpa = 402.21\nfree_flow_l_min = 55.33\nspeed = 1.0\ndelta_m = 1e-4\n";

fn edge(id: &str, kind: &str, from: &str, to: &str, fields: &str) -> String {
    format!(
        "[[edge]]\nid = \"{id}\"\nkind = \"{kind}\"\nfrom = \"{from}\"\nto = \"{to}\"\n{fields}\n"
    )
}

/// A resistance of k hPa/(l/min)^2.
fn quadratic(id: &str, from: &str, to: &str, k: f64) -> String {
    let fields =
        format!("dp_nominal_hpa = {}\nm_flow_nominal_kg_min = 10.0\ndelta_m = 1e-4", k * 100.0);
    edge(id, "resistance", from, to, &fields)
}

fn file(nodes: &[&str], rest: &str) -> String {
    let nodes: String = nodes.iter().map(|node| format!("[[node]]\nid = \"{node}\"\n")).collect();
    format!("format = 1\n{nodes}{rest}[pressure_reference]\nnode = \"a\"\npressure_bar = 1.5\n")
}

#[test]
fn single_loop() {
    // 14.2: V = sqrt(H0/(a + K)) = sqrt(402.21/1.131381) = 18.8548 l/min
    let text =
        file(&["a", "b"], &(edge("pump", "pump", "a", "b", PUMP) + &quadratic("r", "b", "a", 1.0)));
    let steady = solve(&text);
    assert!((l_min(&steady, "pump") - 18.8548).abs() < 1e-4);
    assert!((l_min(&steady, "r") - 18.8548).abs() < 1e-4);
}

#[test]
fn parallel_pumps_share_and_a_ring_splits_evenly() {
    // 14.3: two pumps in parallel against K: each V/2, V = sqrt(H0/(a/4 + K))
    let pumps = edge("p1", "pump", "a", "b", PUMP) + &edge("p2", "pump", "a", "b", PUMP);
    let steady = solve(&file(&["a", "b"], &(pumps + &quadratic("r", "b", "a", 1.0))));
    let total = (402.21_f64 / (402.21 / 55.33_f64.powi(2) / 4.0 + 1.0)).sqrt();
    assert!((l_min(&steady, "p1") - total / 2.0).abs() < 1e-6);
    assert!((l_min(&steady, "p1") - l_min(&steady, "p2")).abs() < 1e-9);
    // Ring of four equal pipes with the load opposite of the pump.
    let pipe = |id: &str, from: &str, to: &str| {
        edge(id, "pipe", from, to, "length_m = 100.0\ninner_diameter_mm = 40.0")
    };
    let ring = [
        edge("pump", "pump", "a", "s", PUMP),
        pipe("left_1", "s", "l"),
        pipe("left_2", "l", "e"),
        pipe("right_1", "s", "r"),
        pipe("right_2", "e", "r"),
        quadratic("load", "e", "a", 0.5),
    ]
    .concat();
    let steady = solve(&file(&["a", "s", "l", "r", "e"], &ring));
    let total = l_min(&steady, "pump");
    assert!((l_min(&steady, "left_2") - total / 2.0).abs() < 1e-9 * total);
    assert!((l_min(&steady, "right_1") - total / 2.0).abs() < 1e-9 * total);
    assert!(
        (l_min(&steady, "right_2") + total / 2.0).abs() < 1e-9 * total,
        "connected against the flow"
    );
    // Two symmetric meshes: no flow in the bridge.
    let bridge = ring + &pipe("bridge", "l", "r");
    let steady = solve(&file(&["a", "s", "l", "r", "e"], &bridge));
    assert!(l_min(&steady, "bridge").abs() < 1e-6);
}

#[test]
fn elevation_changes_pressures_not_flows() {
    // 14.4: 20 m are 1000 * 9.81 * 20 = 196.2 kPa
    let flat = file(
        &["a", "b", "c"],
        &(edge("pump", "pump", "a", "b", PUMP)
            + &quadratic("up", "b", "c", 0.5)
            + &quadratic("down", "c", "a", 0.5)),
    );
    let high = flat.replace("id = \"c\"\n", "id = \"c\"\nelevation_m = 20.0\n");
    let (flat, high) = (solve(&flat), solve(&high));
    assert!((l_min(&flat, "pump") - l_min(&high, "pump")).abs() < 1e-9);
    let p = |steady: &Steady| steady.node("c").unwrap().p_pa;
    assert!((p(&flat) - p(&high) - 196_200.0).abs() < 1e-3);
}

#[test]
fn reversed_connections_mirror_the_result() {
    let loop_of = |pipe_ends: (&str, &str), load_ends: (&str, &str)| {
        let pipe = "length_m = 80.0\ninner_diameter_mm = 22.0\nzeta = 5.0";
        file(
            &["a", "b", "c"],
            &(edge("pump", "pump", "a", "b", PUMP)
                + &edge("pipe", "pipe", pipe_ends.0, pipe_ends.1, pipe)
                + &quadratic("load", load_ends.0, load_ends.1, 0.7)),
        )
    };
    let forward = solve(&loop_of(("b", "c"), ("c", "a")));
    let reversed = solve(&loop_of(("c", "b"), ("a", "c")));
    for edge in ["pipe", "load"] {
        let (m, n) = (forward.edge(edge).unwrap(), reversed.edge(edge).unwrap());
        assert!((m.m_flow_kg_s + n.m_flow_kg_s).abs() < 1e-9);
        assert!((m.dp_pa + n.dp_pa).abs() < 1e-6);
    }
    assert!((l_min(&forward, "pump") - l_min(&reversed, "pump")).abs() < 1e-9);
}

#[test]
fn ideal_head_sources_merge_nodes() {
    // Head 100 hPa against K = 1: 10 l/min, at rest at a middle node of two sources in series.
    let text = file(
        &["a", "b", "c"],
        &(edge("s1", "pressure_source", "a", "b", "head_pa = 6000.0")
            + &edge("s2", "pressure_source", "c", "b", "head_pa = -4000.0")
            + &quadratic("r", "c", "a", 1.0)),
    );
    let steady = solve(&text);
    assert!((l_min(&steady, "s1") - 10.0).abs() < 1e-9, "{}", l_min(&steady, "s1"));
    assert!((l_min(&steady, "s2") + 10.0).abs() < 1e-9);
    assert!((steady.node("b").unwrap().p_pa - 156_000.0).abs() < 1e-6);
    assert!((steady.node("c").unwrap().p_pa - 160_000.0).abs() < 1e-6);
}

/// A pipe between an open end and a sink with a given flow.
fn open_pipe(fields: &str, l_min: f64, t_in: f64, initial: f64, ground: f64, step: &str) -> String {
    format!(
        "format = 1\n[run]\nstep = \"{step}\"\ninitial_degc = {initial}\n\
         [fluid]\nheat_capacity_j_kg_k = 4200.0\n[ground]\ntemperature_degc = {ground}\n\
         [[node]]\nid = \"in\"\nkind = \"pressure_boundary\"\npressure_bar = 2.0\ntemperature_degc = {t_in}\n\
         [[node]]\nid = \"out\"\nkind = \"source\"\nm_flow_kg_min = {}\ntemperature_degc = {initial}\n{}",
        -l_min,
        edge("pipe", "pipe", "in", "out", fields)
    )
}

const LONG: &str =
    "length_m = 100.0\ninner_diameter_mm = 100.0\ninsulation_resistance_k_m_w = 5.2631578947368425";
const THIN: &str =
    "length_m = 50.0\ninner_diameter_mm = 22.0\ninsulation_resistance_k_m_w = 3.7804";

fn simulation(text: &str) -> Simulation {
    Simulation::new(build(&model(text)).unwrap()).unwrap()
}

fn advance(simulation: &mut Simulation, until_s: f64, step_s: f64) {
    simulation.advance_to(Time::from_s(until_s).unwrap(), Time::from_s(step_s).unwrap()).unwrap();
}

fn degc(simulation: &Simulation, channel: &str) -> f64 {
    simulation.get(simulation.channel(channel).unwrap()) - 273.15
}

#[test]
fn plug_flow_delivers_the_published_temperatures() {
    // 9.2: (100 m, 100 mm, 0.19 W/(m K), 10 l/min, 60 into 10 degC): 58.6611 degC after 4712.4 s;
    // (50 m, 22 mm, 3.7804 K m/W, 5 l/min, 65 into 20 degC): 63.3312 degC after 228.1 s.
    // Whatever the step, also when the water passes several pipes in one.
    let cases = [(LONG, 10.0, 60.0, 10.0, 58.6611), (THIN, 5.0, 65.0, 20.0, 63.3312)];
    for (fields, flow, t_in, ground, expected) in cases {
        for step_s in [1.0, 7.0, 60.0, 600.0] {
            let text = open_pipe(fields, flow, t_in, 30.0, ground, &format!("{step_s}s"));
            let mut simulation = simulation(&text);
            advance(&mut simulation, 12_000.0, step_s);
            let t_out = degc(&simulation, "out.t_k");
            assert!((t_out - expected).abs() < 1e-3, "step {step_s}: {t_out}, expected {expected}");
        }
        // The steady solve says the same.
        let text = open_pipe(fields, flow, t_in, 30.0, ground, "1s");
        let t_out = solve(&text).node("out").unwrap().t_k - 273.15;
        assert!((t_out - expected).abs() < 1e-3, "{t_out}");
    }
}

#[test]
fn a_front_arrives_as_a_step_after_the_delay() {
    // tau = 228.1 s: at 228 s the old water leaves, one step later the new one.
    let text = open_pipe("length_m = 50.0\ninner_diameter_mm = 22.0", 5.0, 65.0, 30.0, 20.0, "1s");
    let mut simulation = simulation(&text);
    advance(&mut simulation, 228.0, 1.0);
    assert!((degc(&simulation, "out.t_k") - 30.0).abs() < 1e-6);
    advance(&mut simulation, 230.0, 1.0);
    assert!((degc(&simulation, "out.t_k") - 65.0).abs() < 1e-3);
}

#[test]
fn standing_water_cools_as_published() {
    // 9.4: 60 degC in 10 degC ground, tau_R = 48.23 h: 40.4 degC after 24 h;
    // 22 mm: from 60 to 15.1 degC in 3.84 h (cp 4200).
    let cases = [(LONG, 86_400.0, 40.4, 0.05), (THIN, 3.84 * 3600.0, 15.1, 0.1)];
    for (fields, until_s, expected, tolerance) in cases {
        let mut simulation = simulation(&open_pipe(fields, 0.0, 60.0, 60.0, 10.0, "60s"));
        advance(&mut simulation, until_s, 60.0);
        let t_k = degc(&simulation, "pipe.t_a_k");
        assert!((t_k - expected).abs() < tolerance, "{t_k}, expected {expected}");
    }
}

#[test]
fn mixing_and_reversal() {
    // 10: 4 l/min of 15 and 4 l/min of 60 degC mix to 37.5 degC.
    let source = |id: &str, t: f64| {
        format!(
            "[[node]]\nid = \"{id}\"\nkind = \"source\"\nm_flow_kg_min = 4.0\ntemperature_degc = {t}\n"
        )
    };
    let text = format!(
        "format = 1\n{}{}[[node]]\nid = \"mix\"\n[[node]]\nid = \"end\"\nkind = \"pressure_boundary\"\n\
         pressure_bar = 1.0\n{}{}{}",
        source("cold", 15.0),
        source("hot", 60.0),
        quadratic("r1", "cold", "mix", 0.1),
        quadratic("r2", "hot", "mix", 0.1),
        quadratic("r3", "mix", "end", 0.1),
    );
    let t_mix = solve(&text).node("mix").unwrap().t_k - 273.15;
    assert!((t_mix - 37.5).abs() < 1e-4, "{t_mix}");
    // Water that turns round comes back as it went: 100 s in, 100 s back.
    let text = open_pipe("length_m = 50.0\ninner_diameter_mm = 22.0", 5.0, 65.0, 30.0, 20.0, "1s")
        + "[[schedule]]\nsignal = \"out.m_flow_kg_s\"\nunit = \"kg/min\"\npoints = [[0, -5], [100, 5]]\n";
    let mut simulation = simulation(&text);
    advance(&mut simulation, 100.0, 1.0);
    assert!((degc(&simulation, "pipe.t_a_k") - 65.0).abs() < 1e-9);
    advance(&mut simulation, 198.0, 1.0);
    assert!((degc(&simulation, "in.t_k") - 65.0).abs() < 1e-3, "the hot plug comes back");
    advance(&mut simulation, 202.0, 1.0);
    assert!((degc(&simulation, "in.t_k") - 30.0).abs() < 1e-3, "behind it the old water");
}

#[test]
fn the_energy_of_a_pipe_closes_over_reversals_standstill_and_long_steps() {
    let points = "[[0, -5], [60, 12], [200, 0], [400, -0.01], [500, -60], [700, 3], [900, -7]]";
    for step in [0.5, 1.0, 30.0, 200.0] {
        let text = open_pipe(THIN, 5.0, 65.0, 30.0, 10.0, "1s")
            + &format!(
                "[[schedule]]\nsignal = \"out.m_flow_kg_s\"\nunit = \"kg/min\"\npoints = {points}\n"
            )
            + "[[schedule]]\nsignal = \"in.temperature_k\"\nunit = \"degC\"\ninterpolation = \"linear\"\n\
               points = [[0, 65], [300, 40], [800, 70]]\n";
        let mut simulation = simulation(&text);
        advance(&mut simulation, 3600.0, step);
        let balances = Balances::of(&simulation);
        assert!(balances.loss_j > 0.0);
        assert!(balances.heat_error() < 1e-9, "step {step}: {balances:?}");
        assert!(balances.mass_residual_kg_s < 1e-9);
    }
}

#[test]
fn two_circuits_meet_in_a_heat_exchanger() {
    // Both sides 21.5 l/min, UA 5955.1: eps = NTU/(1 + NTU), NTU = 5955.1/(0.3583 * 4180) = 3.976:
    // the secondary leaves with 30 + 0.7991 * (70 - 30) degC and takes what the primary gives.
    let side = |name: &str, t: f64| {
        format!(
            "[[node]]\nid = \"{name}_in\"\nkind = \"source\"\nm_flow_kg_min = 21.5\ntemperature_degc = {t}\n\
             [[node]]\nid = \"{name}_out\"\nkind = \"pressure_boundary\"\npressure_bar = 1.0\n"
        )
    };
    let exchanger = |name: &str, extra: &str| {
        edge(
            &format!("{name}_side"),
            "heat_exchanger",
            &format!("{name}_in"),
            &format!("{name}_out"),
            extra,
        )
    };
    let text = format!(
        "format = 1\n{}{}{}{}",
        side("hot", 70.0),
        side("cold", 30.0),
        exchanger("hot", "partner = \"cold_side\"\nflow_exponent = 0.0"),
        exchanger("cold", "")
    );
    let steady = solve(&text);
    let t = |node: &str| steady.node(node).unwrap().t_k - 273.15;
    let ntu = 5955.1 / (21.5 / 60.0 * 4180.0);
    let eps = ntu / (1.0 + ntu);
    assert!((t("cold_out") - (30.0 + 40.0 * eps)).abs() < 1e-3, "{}", t("cold_out"));
    assert!((t("hot_out") - (70.0 - 40.0 * eps)).abs() < 1e-3);
    let mut simulation = simulation(&text);
    advance(&mut simulation, 600.0, 1.0);
    assert!((degc(&simulation, "cold_out.t_k") - (30.0 + 40.0 * eps)).abs() < 1e-3);
    assert!(Balances::of(&simulation).heat_error() < 1e-9);
}
