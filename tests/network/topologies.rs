//! Shapes of networks: each is solved, whatever its shape and whether its pressure is held or given.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady::{self, Steady};
use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

const HEAD: &str = r#"
format = 1
[run]
initial_degc = 60
[pipe_type.p]
inner_diameter_mm = 28.5
insulation_resistance_k_m_w = 3.4
[station_type.feeder]
kind = "producer"
feed_in_pump = { speed = 1.0, initial_speed = 1.0 }
unit = { kind = "prescribed_source", supply_degc = 75, v_flow_l_min = 15 }
[station_type.house]
kind = "consumer"
extraction_valve = { kvs_m3_h = 1.6, opening = 0.8 }
unit = { kind = "prescribed_source", supply_degc = 40, v_flow_l_min = 6 }
"#;

/// Pressure is held at the first site, or the water column of an open tank gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Pressure {
    Held,
    OpenTank,
}

/// Five prosumers, `s0` and `s3` feed in; trenches of 60 m between them.
fn two_pipes(trenches: &[(usize, usize)], pressure: Pressure) -> String {
    let mut text = HEAD.to_owned();
    for i in 0..5 {
        let kind = if i % 3 == 0 { "feeder" } else { "house" };
        let _ = write!(
            text,
            "[[site]]\nid = \"s{i}\"\n[[station]]\nsite = \"s{i}\"\ntype = \"{kind}\"\n"
        );
    }
    for (a, b) in trenches {
        let _ = write!(
            text,
            "[[trench]]\nfrom = \"s{a}\"\nto = \"s{b}\"\nlength_m = 60\npipe = \"p\"\n"
        );
    }
    text + match pressure {
        Pressure::Held => "[pressure_reference]\nnode = \"s0.cold\"\npressure_bar = 2\n",
        // The tank takes and gives water at the pressure of the atmosphere.
        Pressure::OpenTank => {
            "[[node]]\nid = \"tank\"\nkind = \"pressure_boundary\"\npressure_bar = 0\n\
             temperature_degc = 40\n[[edge]]\nid = \"tank_pipe\"\nkind = \"pipe\"\nfrom = \"tank\"\n\
             to = \"s0.cold\"\nlength_m = 2\npipe = \"p\"\n"
        }
    }
}

fn model(text: &str) -> Model {
    let model = Model::from_toml(text, Path::new("."));
    model.unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

/// Solves, and checks every node and the direction of the heat.
fn solved(name: &str, text: &str) -> Steady {
    let model = model(text);
    let steady = steady::solve(&model).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut sums: HashMap<&str, f64> = HashMap::new();
    for (edge, found) in model.edges.iter().zip(&steady.edges) {
        *sums.entry(&edge.from).or_default() -= found.m_flow_kg_s;
        *sums.entry(&edge.to).or_default() += found.m_flow_kg_s;
    }
    for (node, sum) in sums {
        assert!(sum.abs() < 1e-9, "{name}: {node} gains {sum} kg/s");
    }
    assert!(steady.residual_pa < 1e-3, "{name}: {} Pa", steady.residual_pa);
    // Between the ground, where the water stands, and the supply.
    let temperatures = 285.1..348.2;
    for node in &steady.nodes {
        assert!(temperatures.contains(&node.t_k), "{name}: {} has {} K", node.id, node.t_k);
    }
    steady
}

fn flow(steady: &Steady, edge: &str) -> f64 {
    steady.edge(edge).unwrap_or_else(|| panic!("no edge {edge}")).m_flow_kg_s
}

const LINE: &[(usize, usize)] = &[(0, 1), (1, 2), (2, 3), (3, 4)];
const RING: &[(usize, usize)] = &[(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)];
const TREE: &[(usize, usize)] = &[(0, 1), (1, 2), (1, 3), (3, 4)];
const STAR: &[(usize, usize)] = &[(0, 1), (0, 2), (0, 3), (0, 4)];
const MESH: &[(usize, usize)] = &[(0, 1), (1, 2), (2, 3), (3, 4), (4, 0), (0, 2), (1, 3), (2, 4)];
/// The ring without the trench from s0 to s1.
const BROKEN_RING: &[(usize, usize)] = &[(1, 2), (2, 3), (3, 4), (4, 0)];

#[test]
fn every_shape_of_two_pipes_is_solved() {
    let shapes = [
        ("line", LINE),
        ("ring", RING),
        ("tree", TREE),
        ("star", STAR),
        ("mesh", MESH),
        ("broken ring", BROKEN_RING),
    ];
    for (name, trenches) in shapes {
        let [held, open] = [Pressure::Held, Pressure::OpenTank]
            .map(|pressure| solved(name, &two_pipes(trenches, pressure)));
        for house in ["s1", "s2", "s4"] {
            let exchanger = format!("{house}.heat_exchanger");
            // A pressure level moves no water: the tank gives and takes nothing.
            let (held, open) = (flow(&held, &exchanger), flow(&open, &exchanger));
            assert!(held < -0.01, "{name}: {house} gets {held} kg/s");
            assert!((open / held - 1.0).abs() < 1e-6, "{name}: {house} {open} {held}");
        }
        assert!(flow(&open, "tank_pipe").abs() < 1e-9, "{name}");
    }
}

#[test]
fn a_ring_needs_less_pressure_than_a_line() {
    let largest = |trenches: &[(usize, usize)]| {
        let steady = solved("", &two_pipes(trenches, Pressure::Held));
        let edges = trenches.iter().map(|(a, b)| format!("s{a}-s{b}.hot"));
        edges.map(|id| steady.edge(&id).unwrap().dp_pa.abs()).fold(0.0, f64::max)
    };
    assert!(largest(RING) < largest(BROKEN_RING));
}

#[test]
fn the_supply_frontier_moves_with_the_feeders() {
    // A line with feeders at s0 and s3: their waters meet where the supply line changes its direction.
    let toward_s3 = |speed: f64| {
        let feeder = "site = \"s3\"\ntype = \"feeder\"\n";
        let weaker =
            format!("{feeder}feed_in_pump = {{ speed = {speed}, initial_speed = {speed} }}\n");
        let text = two_pipes(LINE, Pressure::Held).replace(feeder, &weaker);
        let steady = solved("frontier", &text);
        ["s0-s1.hot", "s1-s2.hot", "s2-s3.hot"].map(|trench| flow(&steady, trench))
    };
    let (equal, weak) = (toward_s3(1.0), toward_s3(0.5));
    assert!(equal[0] > 0.0 && equal[2] < 0.0, "{equal:?}");
    assert!(equal.iter().zip(&weak).all(|(equal, weak)| weak > equal), "{equal:?} {weak:?}");
    let frontier = |flows: [f64; 3]| flows.iter().filter(|flow| **flow > 0.0).count();
    assert!(frontier(weak) > frontier(equal), "{equal:?} {weak:?}");
}

/// Feeders at both ends of `f0 - h1 - h2 - f3`, equal houses between them; check valves that hold.
fn two_feeders(trenches: &[(&str, &str)]) -> String {
    let mut text = HEAD.replace(
        "kind = \"producer\"\n",
        "kind = \"producer\"\nfeed_in_check_valve = { kvs_m3_h = 11, leakage = 1e-9 }\n",
    ) + "[ground]\ntemperature_degc = 10\n[pressure_reference]\nnode = \"f0.cold\"\npressure_bar = 2\n";
    for (site, kind) in [("f0", "feeder"), ("h1", "house"), ("h2", "house"), ("f3", "feeder")] {
        let _ = write!(
            text,
            "[[site]]\nid = \"{site}\"\n[[station]]\nsite = \"{site}\"\ntype = \"{kind}\"\n"
        );
    }
    for (a, b) in trenches {
        let _ =
            write!(text, "[[trench]]\nfrom = \"{a}\"\nto = \"{b}\"\nlength_m = 60\npipe = \"p\"\n");
    }
    text
}

#[test]
fn water_between_two_feeders_stands_and_cools_until_one_grows_weaker() {
    const LINE: &[(&str, &str)] = &[("f0", "h1"), ("h1", "h2"), ("h2", "f3")];
    const RING: &[(&str, &str)] = &[("f0", "h1"), ("h1", "h2"), ("h2", "f3"), ("f3", "f0")];
    // tau_R = 3.4 K m/W * 1000 * 4180 * pi/4 * 0.0285^2 = 9066 s
    let tau_s = 3.4 * 1000.0 * 4180.0 * std::f64::consts::PI / 4.0 * 0.0285 * 0.0285;
    const HOURS_4_S: f64 = 14_400.0;
    for (name, trenches, standing) in
        [("line", LINE, &["h1-h2"][..]), ("ring", RING, &["h1-h2", "f3-f0"][..])]
    {
        let mut simulation =
            Simulation::new(build(&model(&two_feeders(trenches))).unwrap()).unwrap();
        let get = |simulation: &Simulation, channel: String| {
            simulation.get(simulation.channel(&channel).unwrap())
        };
        let flow = |simulation: &Simulation, trench: &str| {
            get(simulation, format!("{trench}.hot.m_flow_kg_s"))
        };
        // The colder end of a supply pipe: a trace passes the check valve and keeps the other end warm.
        let degc = |simulation: &Simulation, trench: &str| {
            let end = |end: &str| get(simulation, format!("{trench}.hot.{end}")) - 273.15;
            end("t_a_k").min(end("t_b_k"))
        };
        let minute = Time::from_s(60.0).unwrap();
        let after = |s: f64| Time::from_s(s).unwrap();
        // Equal feeders: by symmetry nothing moves half way, where the water cools from 60 degC.
        simulation.advance_to(after(HOURS_4_S), minute).unwrap();
        let cooled = 10.0 + 50.0 * (-HOURS_4_S / tau_s).exp();
        for trench in standing {
            assert!(flow(&simulation, trench).abs() < 1e-7, "{name}: {trench} moves");
            let found = degc(&simulation, trench);
            assert!((found - cooled).abs() < 0.1, "{name}: {trench} {found}, expected {cooled}");
        }
        assert!(degc(&simulation, "f0-h1") > 60.0, "{name}");
        assert!(flow(&simulation, "f0-h1") > 0.0 && flow(&simulation, "h2-f3") < 0.0, "{name}");
        let before_degc = degc(&simulation, "h2-f3");
        // f3 becomes too weak to open its check valve: the zone moves to it. In the line its pipe stands
        // and cools now, and what stood before reaches h2 as a cold plug.
        let speed = simulation.signal("f3.feed_in_pump.speed").unwrap();
        simulation.set(speed, 0.3).unwrap();
        let mut coldest = f64::INFINITY;
        for k in 1..=20 {
            simulation.advance_to(after(HOURS_4_S + 60.0 * f64::from(k)), minute).unwrap();
            coldest = coldest.min(get(&simulation, "h2.hot.t_k".into()) - 273.15);
        }
        assert!(coldest < 45.0, "{name}: {coldest}");
        simulation.advance_to(after(2.0 * HOURS_4_S), minute).unwrap();
        assert!(flow(&simulation, "h1-h2") > 1e-3, "{name}: {}", flow(&simulation, "h1-h2"));
        assert!(degc(&simulation, "h1-h2") > 50.0, "{name}: {}", degc(&simulation, "h1-h2"));
        if name == "line" {
            assert!(flow(&simulation, "h2-f3").abs() < 1e-6);
            let cooled = 10.0 + (before_degc - 10.0) * (-HOURS_4_S / tau_s).exp();
            let found = degc(&simulation, "h2-f3");
            assert!((found - cooled).abs() < 1.0, "{found}, expected {cooled}");
        } else {
            // Round the other way f0 serves h2 too.
            assert!(flow(&simulation, "f3-f0") < 0.0 && flow(&simulation, "h2-f3") < 0.0);
        }
        let balances = Balances::of(&simulation);
        assert!(balances.heat_error() < 1e-6, "{name}: {balances:?}");
    }
}

#[test]
fn a_symmetric_ring_splits_in_halves() {
    // A feeder at s0, a house at the opposite s2: both ways have the same two pipes.
    let mut text = HEAD.to_owned();
    for i in 0..4 {
        let _ = writeln!(text, "[[site]]\nid = \"s{i}\"");
    }
    for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        let _ = write!(
            text,
            "[[trench]]\nfrom = \"s{a}\"\nto = \"s{b}\"\nlength_m = 60\npipe = \"p\"\n"
        );
    }
    text += "[[station]]\nsite = \"s0\"\ntype = \"feeder\"\n[[station]]\nsite = \"s2\"\ntype = \"house\"\n\
             [pressure_reference]\nnode = \"s0.cold\"\n";
    let steady = solved("symmetric ring", &text);
    let (east, west) = (flow(&steady, "s0-s1.hot"), -flow(&steady, "s3-s0.hot"));
    let fed_in = flow(&steady, "s0.heat_exchanger");
    assert!((east / west - 1.0).abs() < 1e-9, "{east} {west}");
    assert!((east / (0.5 * fed_in) - 1.0).abs() < 1e-9, "{east} of {fed_in}");
}

#[test]
fn three_pipes_cascade() {
    // Two supply lines of 75 and 55 degC with a common return: the second house takes what the first
    // one returns, and the third one the common return.
    let text = r#"
format = 1
[run]
initial_degc = 50
[pipe_type.p]
inner_diameter_mm = 28.5
insulation_resistance_k_m_w = 3.4
[[site]]
id = "plant"
lines = ["high", "low", "return"]
[[site]]
id = "town"
lines = ["high", "low", "return"]
[[trench]]
from = "plant"
to = "town"
length_m = 150
pipe = "p"
[[edge]]
id = "high_pump"
kind = "pump"
from = "plant.return"
to = "boiler.inlet"
head_max_bar = 1
free_flow_l_min = 60
speed = 1.0
initial_speed = 1.0
[[node]]
id = "boiler.inlet"
[[edge]]
id = "boiler"
kind = "resistance"
from = "boiler.inlet"
to = "plant.high"
kv_m3_h = 20
[[unit]]
id = "boiler.unit"
port = "boiler"
kind = "heat_source"
supply_degc = 75
[[edge]]
id = "first"
kind = "heat_exchanger"
from = "town.high"
to = "first.outlet"
[[unit]]
id = "first.unit"
port = "first"
kind = "prescribed_source"
supply_degc = 40
v_flow_l_min = 6
[[node]]
id = "first.outlet"
[[edge]]
id = "first_valve"
kind = "valve"
from = "first.outlet"
to = "town.low"
kvs_m3_h = 2.5
[[edge]]
id = "second"
kind = "heat_exchanger"
from = "town.low"
to = "second.outlet"
[[unit]]
id = "second.unit"
port = "second"
kind = "prescribed_source"
supply_degc = 40
v_flow_l_min = 6
[[node]]
id = "second.outlet"
[[edge]]
id = "second_valve"
kind = "valve"
from = "second.outlet"
to = "town.return"
kvs_m3_h = 2.5
[[edge]]
id = "plant_bypass"
kind = "valve"
from = "plant.low"
to = "plant.return"
kvs_m3_h = 1.0
[pressure_reference]
node = "plant.return"
pressure_bar = 2
"#;
    let held = solved("cascade", text);
    let t_degc = |node: &str| held.node(node).unwrap().t_k - 273.15;
    assert!(t_degc("town.high") > t_degc("town.low") + 5.0, "{}", t_degc("town.low"));
    assert!(t_degc("town.low") > t_degc("second.outlet") + 1.0);
    // What the first house passes on is what the second one takes and what flows back in the low line.
    let (low, second) = (flow(&held, "plant-town.low"), flow(&held, "second"));
    assert!((flow(&held, "first") - (second - low)).abs() < 1e-9);
    assert!(low < 0.0 && second > 0.0);
}

/// A loop of one pipe: every house takes water from it with its own pump and gives it back a metre on.
fn single_pipe(reference: &str) -> String {
    let mut text = String::from(
        "format = 1\n[run]\ninitial_degc = 20\n[pipe_type.p]\ninner_diameter_mm = 80\n\
         insulation_resistance_k_m_w = 1.0\n[ground]\ntemperature_degc = 10\n",
    );
    text += reference;
    // source -> h1.in -> h1.out -> h2.in ... -> h3.out -> circulation -> source
    let names = ["source", "h1.in", "h1.out", "h2.in", "h2.out", "h3.in", "h3.out", "end"];
    for name in
        names.iter().chain(["h1.a", "h1.b", "h2.a", "h2.b", "h3.a", "h3.b", "pump.out"].iter())
    {
        let _ = writeln!(text, "[[node]]\nid = \"{name}\"");
    }
    for pair in names.windows(2) {
        let length_m = if pair[1].ends_with("out") { 1 } else { 100 };
        let _ = write!(
            text,
            "[[edge]]\nid = \"{}_{}\"\nkind = \"pipe\"\nfrom = \"{0}\"\nto = \"{1}\"\npipe = \"p\"\n\
             length_m = {length_m}\n",
            pair[0], pair[1]
        );
    }
    for house in ["h1", "h2", "h3"] {
        let _ = write!(
            text,
            "[[edge]]\nid = \"{house}.pump\"\nkind = \"pump\"\nfrom = \"{house}.in\"\n\
             to = \"{house}.a\"\nhead_max_bar = 0.4\nfree_flow_l_min = 40\nspeed = 0.8\n\
             initial_speed = 0.8\n[[edge]]\nid = \"{house}.heat_exchanger\"\nkind = \"heat_exchanger\"\n\
             from = \"{house}.a\"\nto = \"{house}.b\"\n[[edge]]\nid = \"{house}.valve\"\nkind = \"valve\"\n\
             from = \"{house}.b\"\nto = \"{house}.out\"\nkvs_m3_h = 4\n[[unit]]\nid = \"{house}.unit\"\n\
             port = \"{house}.heat_exchanger\"\nkind = \"prescribed_source\"\nsupply_degc = 5\n\
             v_flow_l_min = 15\n"
        );
    }
    text + "[[edge]]\nid = \"circulation\"\nkind = \"pump\"\nfrom = \"end\"\nto = \"pump.out\"\n\
            head_max_bar = 1\nfree_flow_l_min = 400\nspeed = 0.7\ninitial_speed = 0.7\n[[edge]]\n\
            id = \"reservoir\"\nkind = \"resistance\"\nfrom = \"pump.out\"\nto = \"source\"\nkv_m3_h = 50\n\
            [[unit]]\nid = \"reservoir.unit\"\nport = \"reservoir\"\nkind = \"heat_source\"\nsupply_degc = 16\n"
}

#[test]
fn a_single_pipe_cascades_along_the_loop() {
    let held = "[pressure_reference]\nnode = \"source\"\npressure_bar = 2\n";
    let tank = "[[node]]\nid = \"lake\"\nkind = \"pressure_boundary\"\npressure_bar = 0\n\
                temperature_degc = 16\n[[edge]]\nid = \"intake\"\nkind = \"resistance\"\n\
                from = \"lake\"\nto = \"end\"\nkv_m3_h = 50\n";
    for (name, reference) in [("held", held), ("open", tank)] {
        let model = model(&single_pipe(reference));
        let steady = steady::solve(&model).unwrap_or_else(|error| panic!("{name}: {error}"));
        let t_degc = |node: &str| steady.node(node).unwrap().t_k - 273.15;
        // Each house cools the water of the next one.
        let along = ["source", "h1.out", "h2.out", "h3.out"].map(t_degc);
        assert!((along[0] - 16.0).abs() < 1e-6, "{name}: {along:?}");
        assert!(along.windows(2).all(|pair| pair[1] < pair[0] - 0.3), "{name}: {along:?}");
        // Between the two points of a house lies only a metre of pipe: the houses hardly see each other.
        let flows = ["h1", "h2", "h3"].map(|house| flow(&steady, &format!("{house}.pump")));
        assert!((flows[0] / flows[2] - 1.0).abs() < 0.02, "{name}: {flows:?}");
        assert!(flow(&steady, "circulation") > 2.0 * flows[0], "{name}");
    }
}
