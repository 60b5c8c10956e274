//! Fluid inertia: run-up of a pipe against its closed form, time constants, energy, continuation.

#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::automatic_step::Step;
use anergy_simulation::balance::{Balances, summary};
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::running::simulation;
use anergy_tests::workspace;

fn advance(simulation: &mut Simulation, until_s: f64, step_s: f64) {
    simulation.advance_to(Time::from_s(until_s).unwrap(), Time::from_s(step_s).unwrap()).unwrap();
}

fn get(simulation: &Simulation, channel: &str) -> f64 {
    simulation.get(simulation.channel(channel).unwrap())
}

fn near(what: &str, found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{what}: {found} instead of {expected}");
}

/// 100 m of 50 mm with a friction factor of 0.02 from a boundary whose pressure follows the points.
///
/// `A = 1.96350e-3 m2`, `L/A = 50929.6 1/m`; at 1 m/s (1.96350 kg/s) `0.02 * 2000 * 500 = 20 kPa`, so
/// `K = 20000/1.96350^2 = 5187.65 Pa s2/kg2`; time constant of the run-up `L/A m/dp = 5 s`.
fn pipe(points: &str, turned: bool, more: &str) -> String {
    let (from, to) = if turned { ("out", "in") } else { ("in", "out") };
    format!(
        "format = 1\n[model]\nfluid_inertia = true\n[fluid]\nkind = \"constant_water\"\ndensity_kg_m3 = 1000\n\
         heat_capacity_j_kg_k = 4180\nviscosity_pa_s = 1e-3\n\
         [[node]]\nid = \"in\"\nkind = \"pressure_boundary\"\npressure_pa = 0\n[[node]]\nid = \"out\"\nkind = \"pressure_boundary\"\npressure_pa = 0\n\
         [[edge]]\nid = \"pipe\"\nkind = \"pipe\"\nfrom = \"{from}\"\nto = \"{to}\"\nlength_m = 100\n\
         inner_diameter_mm = 50\nfriction_factor = 0.02\ndelta_m = 1e-9\n\
         [[schedule]]\nsignal = \"in.pressure_pa\"\npoints = {points}\n{more}"
    )
}

const AT_1_M_S: f64 = 1.963_495_408;
const INERTANCE_1_M: f64 = 100.0 / 1.963_495_408e-3;

#[test]
fn a_pipe_runs_up_like_the_hyperbolic_tangent() {
    // dm/dt = K/I (m_inf^2 - m^2): m = m_inf tanh(t/5 s)
    let mut misses = Vec::new();
    for step_s in [0.4, 0.2, 0.1, 0.05] {
        let mut run = simulation(&pipe("[[0, 0], [2, 20000]]", false, ""));
        advance(&mut run, 2.0, 1.0);
        near("still", get(&run, "pipe.m_flow_kg_s"), 0.0, 1e-9);
        let mut worst = 0.0_f64;
        for k in 1..=5 {
            let t_s = 2.0 * f64::from(k);
            advance(&mut run, 2.0 + t_s, step_s);
            let exact = AT_1_M_S * (t_s / 5.0).tanh();
            worst = worst.max((get(&run, "pipe.m_flow_kg_s") - exact).abs());
        }
        misses.push(worst);
    }
    for pair in misses.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((0.95..1.1).contains(&order), "order {order}: {misses:?}");
    }
    assert!(misses[3] < 0.003 * AT_1_M_S, "{misses:?}");
    // One step of 1 s by hand: 5187.65 m^2 + 50929.6 m = 20000, m = 0.378140 kg/s.
    let mut run = simulation(&pipe("[[0, 0], [2, 20000]]", false, ""));
    advance(&mut run, 3.0, 1.0);
    near("first step", get(&run, "pipe.m_flow_kg_s"), 0.378_14, 2e-5);
}

#[test]
fn a_small_step_has_the_time_constant_of_the_slope() {
    // L/(A 2 K m) = 50929.6/(2 * 5187.65 * 1.96350) = 2.5 s, from 1 m/s up by 0.1 % of the pressure.
    let mut run = simulation(&pipe("[[0, 20000], [1, 20020]]", false, ""));
    let start = get(&run, "pipe.m_flow_kg_s");
    near("steady start", start, AT_1_M_S, 1e-9);
    advance(&mut run, 3.5, 0.01);
    let risen = (get(&run, "pipe.m_flow_kg_s") - start) / (AT_1_M_S * (1.001_f64.sqrt() - 1.0));
    near("share after one time constant", risen, 1.0 - (-1.0_f64).exp(), 2e-3);
    let late = INERTANCE_1_M / (2.0 * 5187.65 * AT_1_M_S);
    near("time constant", late, 2.5, 1e-4);
}

#[test]
fn a_turned_pipe_mirrors_and_a_long_step_is_at_rest() {
    let points = "[[0, 5000], [1, 20000], [4, -8000]]";
    let (mut one, mut other) =
        (simulation(&pipe(points, false, "")), simulation(&pipe(points, true, "")));
    for k in 1..=80 {
        let at_s = 0.1 * f64::from(k);
        advance(&mut one, at_s, 0.1);
        advance(&mut other, at_s, 0.1);
        let (a, b) = (get(&one, "pipe.m_flow_kg_s"), get(&other, "pipe.m_flow_kg_s"));
        near("mirror", a, -b, 1e-12);
    }
    // -8000 Pa in the end: -sqrt(8000/5187.65) kg/s. One step of 1000 time constants goes nearly there.
    let at_rest = -(8000.0_f64 / 5187.65).sqrt();
    advance(&mut one, 5000.0, 2500.0);
    near("long steps", get(&one, "pipe.m_flow_kg_s"), at_rest, 1e-4);
}

#[test]
fn water_at_rest_costs_no_solves_and_continues_bit_for_bit() {
    let points = "[[0, 5000], [1, 20000], [300, 12000]]";
    let mut run = simulation(&pipe(points, false, ""));
    advance(&mut run, 3.3, 0.1);
    let (snapshot, bytes) = (run.snapshot(), run.snapshot().to_bytes().unwrap());
    let solves =
        |run: &Simulation| summary(run, false)["statistics"]["hydraulic solves"].as_u64().unwrap();
    let series = |run: &mut Simulation| -> Vec<u64> {
        let at = |k: i32| 3.3 + 0.1 * f64::from(k);
        let sample = |k: i32| {
            advance(run, at(k), 0.1);
            get(run, "pipe.m_flow_kg_s").to_bits()
        };
        (1..=50).map(sample).collect()
    };
    let first = series(&mut run);
    run.restore(&snapshot).unwrap();
    assert_eq!(first, series(&mut run));
    let mut fresh = simulation(&pipe(points, false, ""));
    fresh.restore_bytes(&bytes).unwrap();
    assert_eq!(first, series(&mut fresh));
    // 2.5 s: 23 of them to 1e-10.
    advance(&mut run, 100.0, 0.1);
    let before = solves(&run);
    advance(&mut run, 300.0, 0.1);
    assert_eq!(solves(&run), before);
    advance(&mut run, 301.0, 0.1);
    assert_eq!(solves(&run), before + 10);
}

#[test]
fn the_automatic_step_follows_flows_that_move_by_themselves() {
    let text = pipe(
        "[[0, 0], [60, 20000]]",
        false,
        "[run]\nuntil = \"1h\"\nstep = \"auto\"\nstep_min = \"0.01s\"\n",
    );
    let model = Model::from_toml(&text, &workspace()).unwrap();
    let mut run = Simulation::new(build(&model).unwrap()).unwrap();
    let step = Step::Automatic(run.plan().automatic_step());
    let mut worst = 0.0_f64;
    for k in 1..=20 {
        run.advance_to(Time::from_s(60.0 + f64::from(k)).unwrap(), step).unwrap();
        let exact = AT_1_M_S * (f64::from(k) / 5.0).tanh();
        worst = worst.max((get(&run, "pipe.m_flow_kg_s") - exact).abs());
    }
    assert!(worst < 0.02 * AT_1_M_S, "{worst}");
    run.advance_to(Time::from_s(3600.0).unwrap(), step).unwrap();
    let steps = summary(&run, false)["automatic_step"]["steps"].as_u64().unwrap();
    assert!(steps < 400, "{steps}");
}

/// Two parallel pipes behind a pump whose speed moves, and a third one back.
fn ring() -> String {
    let pipe = |id: &str, from: &str, to: &str, length: f64, mm: f64| {
        format!(
            "[[edge]]\nid = \"{id}\"\nkind = \"pipe\"\nfrom = \"{from}\"\nto = \"{to}\"\nlength_m = {length:?}\n\
             inner_diameter_mm = {mm:?}\n"
        )
    };
    format!(
        "format = 1\n[model]\nfluid_inertia = true\ndissipation = true\n[[node]]\nid = \"a\"\n[[node]]\nid = \"b\"\n\
         [[node]]\nid = \"c\"\n[[edge]]\nid = \"pump\"\nkind = \"pump\"\nfrom = \"a\"\nto = \"b\"\nrise_time_s = 1.0\nhead_max_pa = 50000\nfree_flow_l_min = 60\n\
         [pressure_reference]\nnode = \"a\"\npressure_bar = 1.5\n{}{}{}\
         [[schedule]]\nsignal = \"pump.speed\"\npoints = [[0, 0.2], [2, 1.0], [20, 0.3], [40, 0]]\n",
        pipe("one", "b", "c", 150.0, 22.0),
        pipe("two", "c", "b", 40.0, 15.0),
        pipe("back", "c", "a", 100.0, 32.0),
    )
}

#[test]
fn the_work_of_the_pump_is_friction_and_kinetic_energy() {
    let mut damped = Vec::new();
    for step_s in [0.2, 0.1, 0.05] {
        let mut run = simulation(&ring());
        let start_j = kinetic_j(&run);
        for until_s in [4.0, 25.0, 60.0] {
            advance(&mut run, until_s, step_s);
            let balances = Balances::of(&run);
            assert!(balances.hydraulic_error() < 1e-9, "{balances:?}");
            assert!(balances.heat_error() < 1e-9, "{balances:?}");
            // Once the water drives the pump, that brakes it too.
            assert!(balances.friction_j > (1.0 - 1e-9) * balances.dissipated_j, "{balances:?}");
            near("kinetic energy", balances.kinetic_j, kinetic_j(&run) - start_j, 1e-9);
            if until_s == 4.0 {
                // Far more than what the tolerance of the balance could hide.
                assert!(balances.kinetic_j > 0.02 * balances.hydraulic_j, "{balances:?}");
                near("friction", balances.friction_j / balances.dissipated_j, 1.0, 1e-9);
                damped.push(balances.step_damped_j);
            }
        }
    }
    for pair in damped.windows(2) {
        near("damping falls with the step", pair[0] / pair[1], 2.0, 0.15);
    }
    let mut run = simulation(&ring());
    advance(&mut run, 3.0, 0.1);
    let lines = summary(&run, false)["balances"].to_string();
    assert!(lines.contains("kinetic energy of the water") && lines.contains("damped by the steps"));
}

/// `sum L/A m^2/(2 rho)` of the ring.
fn kinetic_j(run: &Simulation) -> f64 {
    let of = |id: &str, length_m: f64, d_m: f64| {
        let area = std::f64::consts::PI / 4.0 * d_m * d_m;
        let m = get(run, &format!("{id}.m_flow_kg_s"));
        length_m / area * m * m / (2.0 * run.plan().network().medium.density_kg_m3)
    };
    of("one", 150.0, 0.022) + of("two", 40.0, 0.015) + of("back", 100.0, 0.032)
}
