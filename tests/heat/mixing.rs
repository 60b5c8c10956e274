//! Mixing at nodes, volumes that lose heat, loops without pipes, exchangers with walls, friction as heat, and
//! the heat of every pipe.

#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::{Balances, PipeBalance, summary};
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::workspace;

fn model(text: &str) -> Model {
    Model::from_toml(text, &workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn simulation(text: &str) -> Simulation {
    Simulation::new(build(&model(text)).unwrap()).unwrap()
}

fn advance(simulation: &mut Simulation, until_s: f64, step_s: f64) {
    simulation.advance_to(Time::from_s(until_s).unwrap(), Time::from_s(step_s).unwrap()).unwrap();
}

fn get(simulation: &Simulation, channel: &str) -> f64 {
    simulation.get(simulation.channel(channel).unwrap())
}

fn degc(simulation: &Simulation, channel: &str) -> f64 {
    get(simulation, channel) - 273.15
}

fn near(what: &str, found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{what}: {found} instead of {expected}");
}

fn resistance(id: &str, from: &str, to: &str) -> String {
    format!(
        "[[edge]]\nid = \"{id}\"\nkind = \"resistance\"\nfrom = \"{from}\"\nto = \"{to}\"\n\
         dp_nominal_bar = 0.1\nm_flow_nominal_kg_s = 0.1\n"
    )
}

fn source(id: &str, l_min: f64, t_degc: f64) -> String {
    format!(
        "[[node]]\nid = \"{id}\"\nkind = \"source\"\nm_flow_kg_min = {l_min:?}\ntemperature_degc = {t_degc:?}\n"
    )
}

/// 4 l/min at 15 and 4 l/min at 60 degC meet at `mix`, for 1000 s; then nothing flows.
fn meeting(node: &str) -> String {
    format!(
        "format = 1\n[ground]\ntemperature_degc = 10.0\n[run]\ninitial_degc = 20.0\n[[node]]\nid = \"mix\"\n{node}\n\
         [[node]]\nid = \"end\"\nkind = \"pressure_boundary\"\npressure_bar = 1.0\n{}{}{}{}{}\
         [[schedule]]\nsignal = \"cold.m_flow_kg_s\"\nunit = \"kg/min\"\npoints = [[0, 4], [1000, 0]]\n\
         [[schedule]]\nsignal = \"hot.m_flow_kg_s\"\nunit = \"kg/min\"\npoints = [[0, 4], [1000, 0]]\n",
        source("cold", 4.0, 15.0),
        source("hot", 4.0, 60.0),
        resistance("r1", "cold", "mix"),
        resistance("r2", "hot", "mix"),
        resistance("r3", "mix", "end"),
    )
}

#[test]
fn two_flows_mix_to_their_mean_and_hold_it() {
    let mut at_once = simulation(&meeting(""));
    advance(&mut at_once, 1000.0, 10.0);
    near("mixed", degc(&at_once, "mix.t_k"), 37.5, 1e-9);
    // Without flow a node without volume takes the ambient within hours: 10 + 27.5 e^(-1/60) after 60 s.
    advance(&mut at_once, 1060.0, 10.0);
    near("held", degc(&at_once, "mix.t_k"), 10.0 + 27.5 * (-1.0_f64 / 60.0).exp(), 1e-9);
    // The steady state of a volume without loss is the mean, too.
    let steady = steady::solve(&model(&meeting("volume_l = 20.0"))).unwrap();
    near("steady", steady.node("mix").unwrap().t_k - 273.15, 37.5, 1e-4);
    // 20 l with 8 kg/min: T = 37.5 - 17.5 e^(-t/150 s), whatever the step.
    for step in [1.0, 50.0] {
        let mut volume = simulation(&meeting("volume_l = 20.0"));
        advance(&mut volume, 300.0, step);
        let expected = 37.5 - 17.5 * (-2.0_f64).exp();
        // The nodes of the sources hold 1 mg of 20 degC each, of 20 kg.
        near("volume", degc(&volume, "mix.t_k"), expected, 2e-6);
        advance(&mut volume, 1000.0, step);
        let before = degc(&volume, "mix.t_k");
        advance(&mut volume, 100_000.0, 1000.0);
        near("a volume without loss holds", degc(&volume, "mix.t_k"), before, 1e-12);
        assert!(Balances::of(&volume).heat_error() < 1e-9);
    }
}

#[test]
fn where_pipes_meet_the_water_cools_with_them() {
    // 50 m of DN20 behind the joint, R = 3.78 K m/W: R C' = 3.78 * 1000 * 4180 * pi/4 * 0.022^2 = 6006 s.
    let pipe = |id: &str, from: &str, to: &str| {
        format!(
            "[[edge]]\nid = \"{id}\"\nkind = \"pipe\"\nfrom = \"{from}\"\nto = \"{to}\"\nlength_m = 50\n\
             inner_diameter_mm = 22\ninsulation_resistance_k_m_w = 3.78\n"
        )
    };
    let text = format!(
        "format = 1\n[ground]\ntemperature_degc = 10.0\n[run]\ninitial_degc = 20.0\n[[node]]\nid = \"joint\"\n\
         [[node]]\nid = \"end\"\nkind = \"pressure_boundary\"\npressure_bar = 1.0\n{}{}{}\
         [[schedule]]\nsignal = \"hot.m_flow_kg_s\"\nunit = \"kg/min\"\npoints = [[0, 4], [3600, 0]]\n",
        source("hot", 4.0, 60.0),
        pipe("before", "hot", "joint"),
        pipe("behind", "joint", "end"),
    );
    let mut simulation = simulation(&text);
    advance(&mut simulation, 3600.0, 10.0);
    let stopped = degc(&simulation, "joint.t_k");
    let cooled = |hours: f64| 10.0 + (stopped - 10.0) * (-hours * 3600.0 / 6006.0).exp();
    for hours in [0.5, 1.0, 4.0] {
        advance(&mut simulation, 3600.0 + hours * 3600.0, 10.0);
        // Behind the ends by 60 s of 6006 s of their cooling.
        let behind = 60.0 / 6006.0 * (cooled(hours) - 10.0);
        near("joint", degc(&simulation, "joint.t_k"), cooled(hours) + behind, 0.05);
    }
}

#[test]
fn a_volume_loses_heat_with_and_without_flow() {
    // 20 l, UA 50 W/K, 8 kg/min: w = 0.13333, u = 50/4180 = 0.0119617 kg/s;
    // T = (0.13333 * 37.5 + 0.0119617 * 10)/0.145295 = 35.236 degC in the end.
    let text = meeting("volume_l = 20.0\nua_w_k = 50.0");
    let (w, u) = (8.0 / 60.0, 50.0 / 4180.0);
    let settled = (w * 37.5 + u * 10.0) / (w + u);
    near("by hand", settled, 35.236, 1e-3);
    let steady = steady::solve(&model(&text)).unwrap();
    near("steady", steady.node("mix").unwrap().t_k - 273.15, settled, 1e-4);
    let mut run = simulation(&text);
    advance(&mut run, 500.0, 20.0);
    let expected = settled + (20.0 - settled) * (-(w + u) * 500.0_f64 / 20.0).exp();
    near("with flow", degc(&run, "mix.t_k"), expected, 2e-6);
    advance(&mut run, 1000.0, 20.0);
    let before = degc(&run, "mix.t_k");
    advance(&mut run, 1000.0 + 1672.0, 20.0);
    // Standing: time constant 20 * 4180/50 = 1672 s.
    near("standing", degc(&run, "mix.t_k"), 10.0 + (before - 10.0) * (-1.0_f64).exp(), 1e-9);
    let balances = Balances::of(&run);
    assert!(balances.heat_error() < 1e-9, "{balances:?}");
    assert!(balances.loss_j > 1e6, "{balances:?}");
}

/// A pump drives water round two nodes without any pipe; its losses heat 10 l.
const LOOP: &str = "format = 1
[run]
initial_degc = 20.0
[[node]]
id = \"a\"
volume_l = 10.0
[[node]]
id = \"b\"
[[edge]]
id = \"pump\"
kind = \"pump\"
from = \"a\"
to = \"b\"
head_max_hpa = 402.21
free_flow_l_min = 55.33
speed = 1.0
initial_speed = 1.0
heat_to_water = 1.0
[[edge]]
id = \"back\"
kind = \"resistance\"
from = \"b\"
to = \"a\"
dp_nominal_bar = 0.2
m_flow_nominal_kg_s = 0.4
[pressure_reference]
node = \"a\"
";

#[test]
fn a_loop_without_pipes_keeps_its_heat() {
    let mut plain = simulation(&LOOP.replace("heat_to_water = 1.0\n", ""));
    advance(&mut plain, 3600.0, 60.0);
    near("no heat, no change", degc(&plain, "a.t_k"), 20.0, 1e-9);
    let mut heated = simulation(LOOP);
    advance(&mut heated, 3600.0, 60.0);
    let balances = Balances::of(&heated);
    // 10 kg take the whole heat of the pump.
    let rise_k = balances.pump_heat_j / (10.0 * 4180.0);
    assert!(rise_k > 1.0, "{balances:?}");
    near("heat of the pump", degc(&heated, "a.t_k"), 20.0 + rise_k, 1e-6);
    assert!(balances.heat_error() < 1e-9 && balances.friction_j == 0.0, "{balances:?}");
}

#[test]
fn friction_gives_the_work_of_the_pumps_back_as_heat() {
    let text = LOOP.replace("format = 1\n", "format = 1\n[model]\ndissipation = true\n");
    let mut simulation = simulation(&text);
    advance(&mut simulation, 3600.0, 60.0);
    let balances = Balances::of(&simulation);
    near("all work", balances.friction_j / balances.hydraulic_j, 1.0, 1e-6);
    near("work", balances.hydraulic_error(), 0.0, 1e-6);
    assert!(balances.heat_error() < 1e-9, "{balances:?}");
    // A wet rotor: everything the pump draws ends in the 10 kg.
    let rise_k = balances.electric_j / (10.0 * 4180.0);
    near("all electricity", degc(&simulation, "a.t_k"), 20.0 + rise_k, 1e-4);
    near("share of friction", get(&simulation, "network.friction_j"), balances.friction_j, 0.0);
    let lines = summary(&simulation, false)["balances"].clone();
    assert!(lines.as_array().unwrap().iter().any(|line| line["label"] == "heat of friction"));
    // Water that falls 20 m through a resistance of 0.4 bar/(0.4 kg/s)^2: 0.4 bar warm it by
    // 4e4/(1000 * 4180) = 9.57 mK; the height does not.
    let open = "format = 1\n[model]\ndissipation = true\n[[node]]\nid = \"in\"\nkind = \"pressure_boundary\"\n\
         pressure_bar = 1.0\ntemperature_degc = 40.0\nelevation_m = 20.0\n[[node]]\nid = \"mid\"\n\
         [[node]]\nid = \"out\"\nkind = \"source\"\nm_flow_kg_s = -0.4\n\
         [[edge]]\nid = \"r\"\nkind = \"resistance\"\nfrom = \"in\"\nto = \"mid\"\ndp_nominal_bar = 0.4\n\
         m_flow_nominal_kg_s = 0.4\n\
         [[edge]]\nid = \"p\"\nkind = \"resistance\"\nfrom = \"out\"\nto = \"mid\"\ndp_nominal_bar = 0.1\n\
         m_flow_nominal_kg_s = 0.4\n";
    let steady = steady::solve(&model(open)).unwrap();
    let t_degc = |node: &str| steady.node(node).unwrap().t_k - 273.15;
    near("falling", t_degc("mid"), 40.0 + 4e4 / 4.18e6, 1e-6);
    near("against its ports", t_degc("out"), 40.0 + 5e4 / 4.18e6, 1e-6);
}

#[test]
fn the_wall_of_an_exchanger_slows_it_and_keeps_its_heat() {
    let text = |wall: &str| {
        format!(
            "format = 1\n[run]\ninitial_degc = 45.0\n{}[[node]]\nid = \"out\"\nkind = \"pressure_boundary\"\n\
             pressure_bar = 1.0\n\
             [[edge]]\nid = \"hx\"\nkind = \"heat_exchanger\"\nfrom = \"hot\"\nto = \"out\"\nflow_exponent = 0.0\n\
             ua_w_k = 5955.0\nvolume_l = 3.0\n{wall}\n\
             [[unit]]\nid = \"house\"\nkind = \"prescribed_source\"\nport = \"hx\"\nsupply_degc = 45.0\n\
             v_flow_l_min = 21.48\n",
            source("hot", 21.48, 70.0)
        )
    };
    // 30 kW station: NTU 3.980, eps 0.7992, 29.9 kW; the outlet settles at 70 - 0.7992 * 25 = 50.02 degC.
    let (settled, m) = (70.0 - 0.799_2 * 25.0, 0.358);
    for (wall, wall_j_k) in [("", 0.0), ("wall_capacity_j_k = 12540.0", 12_540.0)] {
        let mut run = simulation(&text(wall));
        advance(&mut run, 10.0, 1.0);
        near("30 kW", get(&run, "hx.q_flow_w"), -29_900.0, 20.0);
        // (V rho cp + C/2)/(m cp): 3/0.358 = 8.38 s without, (3 + 1.5)/0.358 = 12.57 s with the wall.
        let tau_s = (3.0 + wall_j_k / 2.0 / 4180.0) / m;
        let expected = settled + (45.0 - settled) * (-10.0_f64 / tau_s).exp();
        near("first order", degc(&run, "hx.t_out_k"), expected, 0.01);
        assert!(Balances::of(&run).heat_error() < 1e-9);
    }
    assert!(
        Model::from_toml(&text("wall_capacity_j_k = -1.0"), &workspace())
            .is_ok_and(|m| build(&m).is_err())
    );
}

/// A ring main of lossy pipes that stands, turns and runs.
fn pipes(dissipation: bool) -> String {
    let pipe = |id: &str, from: &str, to: &str, length: f64| {
        format!(
            "[[edge]]\nid = \"{id}\"\nkind = \"pipe\"\nfrom = \"{from}\"\nto = \"{to}\"\nlength_m = {length:?}\n\
             inner_diameter_mm = 22.0\ninsulation_resistance_k_m_w = 3.78\n"
        )
    };
    format!(
        "format = 1\n[model]\ndissipation = {dissipation}\n[run]\ninitial_degc = 40.0\n\
         {}[[node]]\nid = \"b\"\n[[node]]\nid = \"c\"\n[[node]]\nid = \"out\"\nkind = \"pressure_boundary\"\n\
         pressure_bar = 1.0\ntemperature_degc = 30.0\n{}{}{}{}\
         [[schedule]]\nsignal = \"a.m_flow_kg_s\"\nunit = \"kg/min\"\n\
         points = [[0, 5], [900, 0], [1800, -4], [2400, 0.01], [3000, 60], [3300, 7]]\n",
        source("a", 5.0, 70.0),
        pipe("ab", "a", "b", 50.0),
        pipe("bc", "b", "c", 30.0),
        pipe("cb", "c", "b", 45.0),
        pipe("out_c", "out", "c", 2.0),
    )
}

#[test]
fn the_heat_of_every_pipe_closes() {
    for dissipation in [false, true] {
        for step in [7.0, 60.0] {
            let mut run = simulation(&pipes(dissipation));
            advance(&mut run, 7200.0, step);
            let all = PipeBalance::of(&run);
            assert_eq!(all.len(), 4);
            for pipe in &all {
                assert!(pipe.error() < 1e-9, "{pipe:?}");
                assert!(pipe.lost_j > 0.0, "{pipe:?}");
            }
            let lost: f64 = all.iter().map(|pipe| pipe.lost_j).sum();
            let balances = Balances::of(&run);
            // The nodes without volume lose next to nothing.
            near("sum of the losses", lost / balances.loss_j, 1.0, 1e-6);
            assert!(balances.heat_error() < 1e-9, "{balances:?}");
            near("channel", get(&run, "ab.loss_j"), all[0].lost_j, 0.0);
            near("channel", get(&run, "ab.stored_j"), all[0].stored_j, 0.0);
            let summary = summary(&run, false);
            let table = summary["pipes"].as_array().unwrap();
            assert_eq!(table[0]["component"], "ab");
            near("table", table[0]["lost_kwh"].as_f64().unwrap() * 3.6e6, all[0].lost_j, 1e-6);
            assert!(summary["largest_pipe_error"].as_f64().unwrap() < 1e-9);
        }
    }
}

#[test]
fn a_load_does_not_cool_below_its_coldest_return() {
    // 0.1 kg/s of 60 degC, then of 12 degC; 12.54 kW need 30 K: 30 degC leave, then 10 degC are the limit,
    // 0.1 * 4180 * 2 = 836 W, from the first step on in which cold water arrives.
    let text = r#"
format = 1
[run]
initial_degc = 60
[[node]]
id = "in"
kind = "pressure_boundary"
pressure_bar = 1
temperature_degc = 60
[[node]]
id = "out"
kind = "pressure_boundary"
pressure_bar = 1
[[edge]]
id = "load"
kind = "flow_source"
from = "out"
to = "in"
m_flow_kg_s = 0
[[unit]]
id = "house"
port = "load"
kind = "heat_load"
load_kw = 12.54
temperature_difference_k = 30
coldest_return_degc = 10
[[schedule]]
signal = "in.temperature_k"
unit = "degC"
points = [[0, 60], [1800, 12]]
"#;
    let mut simulation = simulation(text);
    let step = Time::from_s(900.0).unwrap();
    for (end_s, out_degc, q_w) in
        [(1800.0, 30.0, 12_540.0), (2700.0, 10.0, 836.0), (3600.0, 10.0, 836.0)]
    {
        simulation.advance_to(Time::from_s(end_s).unwrap(), step).unwrap();
        let get = |name: &str| simulation.get(simulation.channel(name).unwrap());
        assert!(
            (get("house.t_out_k") - 273.15 - out_degc).abs() < 1e-3,
            "{}",
            get("house.t_out_k")
        );
        assert!((get("house.q_flow_w") + q_w).abs() < 1.0, "{}", get("house.q_flow_w"));
        assert!((get("house.unmet_w") - (12_540.0 - q_w)).abs() < 1.0);
    }
    assert!(Balances::of(&simulation).heat_error() < 1e-9);
}

#[test]
fn loads_in_a_loop_without_pipes_end_at_their_coldest_return() {
    // Two loads cool a few milligrams that pass them again and again within the first step, far beyond
    // freezing if nothing held them: the one that may cool further, to 10 degC, decides; the other, which
    // must not cool below 20 degC, lets the colder water pass.
    let load = |id: &str, coldest: f64| {
        format!(
            "[[edge]]\nid = \"{id}\"\nkind = \"flow_source\"\nfrom = \"r\"\nto = \"s\"\nm_flow_kg_s = 0\n\
             [[unit]]\nid = \"{id}.unit\"\nport = \"{id}\"\nkind = \"heat_load\"\nload_kw = 12.54\n\
             temperature_difference_k = 30\ncoldest_return_degc = {coldest}\n"
        )
    };
    let text = format!(
        "format = 1\n[run]\ninitial_degc = 60\n[[node]]\nid = \"s\"\n[[node]]\nid = \"r\"\n\
         [pressure_reference]\nnode = \"r\"\n[[edge]]\nid = \"back\"\nkind = \"resistance\"\nfrom = \"r\"\n\
         to = \"s\"\ndp_nominal_bar = 0.1\nm_flow_nominal_kg_s = 0.2\n{}{}",
        load("a", 20.0),
        load("b", 10.0)
    );
    let mut simulation = simulation(&text);
    let step = Time::from_s(60.0).unwrap();
    simulation.advance_to(step, step).unwrap();
    let get = |name: &str| simulation.get(simulation.channel(name).unwrap());
    for name in ["s.t_k", "a.unit.t_out_k", "b.unit.t_out_k"] {
        assert!((get(name) - 283.15).abs() < 1e-2, "{name} {}", get(name) - 273.15);
    }
    assert!(get("a.unit.q_flow_w").abs() < 1e-6, "{}", get("a.unit.q_flow_w"));
    assert!(Balances::of(&simulation).heat_error() < 1e-9);
}

#[test]
fn a_flow_that_is_a_rounding_error_has_a_temperature() {
    // The transit time, 0.2 m3 over 1e-320 kg/s, is beyond all numbers. A loop without pipes makes all nodes one system.
    let text = format!(
        "format = 1\n[run]\ninitial_degc = 40.0\n{}[[node]]\nid = \"b\"\n[[node]]\nid = \"c\"\n[[node]]\nid = \"d\"\n\
         [[node]]\nid = \"out\"\nkind = \"pressure_boundary\"\npressure_bar = 1.0\n\
         [[node]]\nid = \"end\"\nkind = \"source\"\nm_flow_kg_s = -1e-320\n\
         [[edge]]\nid = \"dead\"\nkind = \"pipe\"\nfrom = \"b\"\nto = \"end\"\nlength_m = 100\ninner_diameter_mm = 50\n\
         [[edge]]\nid = \"pump\"\nkind = \"pump\"\nfrom = \"c\"\nto = \"d\"\nhead_max_bar = 0.2\nfree_flow_l_min = 60\n{}{}{}",
        source("a", 5.0, 70.0),
        resistance("in", "a", "b"),
        resistance("round", "d", "c"),
        resistance("back", "d", "out"),
    ) + &resistance("on", "b", "c");
    let steady = steady::solve(&model(&text)).unwrap();
    // At rest: it has taken the temperature around it.
    near("dead end", steady.node("end").unwrap().t_k, 285.15, 1e-3);
    near("behind the loop", steady.node("out").unwrap().t_k, 343.15, 1e-3);
}
