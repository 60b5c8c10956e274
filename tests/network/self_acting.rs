//! Self-acting valves: differential-pressure controllers and pressure-reducing valves.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady::{self, Steady};
use std::fmt::Write;
use std::path::Path;

fn model(text: &str) -> Model {
    let model = Model::from_toml(text, Path::new("."));
    model.unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn problems(text: &str) -> String {
    match Model::from_toml(text, Path::new(".")).map_err(|problems| problems.render(text)) {
        Err(problems) => problems,
        Ok(model) => build(&model).err().unwrap().render(text),
    }
}

fn solve(text: &str) -> Steady {
    steady::solve(&model(text)).unwrap_or_else(|error| panic!("{error}"))
}

fn simulation(text: &str) -> Simulation {
    Simulation::new(build(&model(text)).unwrap()).unwrap_or_else(|error| panic!("{error}"))
}

fn get(simulation: &Simulation, channel: &str) -> f64 {
    simulation.get(simulation.channel(channel).unwrap())
}

fn set(simulation: &mut Simulation, signal: &str, value: f64) {
    let signal = simulation.signal(signal).unwrap();
    simulation.set(signal, value).unwrap();
}

fn advance(simulation: &mut Simulation, until_s: f64, step_s: f64) {
    let time = |s| Time::from_s(s).unwrap();
    simulation.advance_to(time(until_s), time(step_s)).unwrap();
}

/// Supply and return at 2 and 1 bar; a consumer's valve of 3.6 m3/h (1 kg/s at 1 bar) in series with a
/// controller of the same size, which holds 0.3 bar over the valve with a band of 0.03 bar.
const HOUSE: &str = r#"
format = 1
[[node]]
id = "supply"
kind = "pressure_boundary"
pressure_bar = 2
[[node]]
id = "return"
kind = "pressure_boundary"
pressure_bar = 1
[[node]]
id = "between"
[[edge]]
id = "load"
kind = "valve"
from = "supply"
to = "between"
kvs_m3_h = 3.6
characteristic = "linear"
leakage = 0
delta_m = 1e-3
stroke_time_s = 0
opening = 0.5
[[edge]]
id = "controller"
kind = "dp_controller"
from = "between"
to = "return"
kvs_m3_h = 3.6
high_node = "supply"
low_node = "between"
dp_set_bar = 0.3
delta_m = 1e-3
"#;

#[test]
fn a_controller_by_hand() {
    // With x = p_between below supply in bar: m = 0.5 sqrt(x) = phi sqrt(1 - x), phi = 1e-3 + 0.999 y,
    // y = (0.33 - x)/0.03. At x = 0.32: m = 0.282843, phi = 0.342997, y = 0.342340, but (0.33 - 0.32)/0.03 =
    // 0.333333; so x lies a little below: x = 0.319765 gives m = 0.282739, phi = 0.342812, y = 0.342154,
    // and (0.33 - 0.319765)/0.03 = 0.341167; x = 0.319735: m = 0.282726, phi = 0.342789, y = 0.342131 and
    // 0.342167.
    let steady = solve(HOUSE);
    let edge = steady.edge("load").unwrap();
    assert!((edge.dp_pa - 31_973.5).abs() < 1.0, "{}", edge.dp_pa);
    assert!((edge.m_flow_kg_s - 0.282_726).abs() < 1e-5, "{}", edge.m_flow_kg_s);
}

#[test]
fn the_band_is_held_over_the_load() {
    // Whatever the consumer takes, and whatever the network gives beyond what it needs.
    for pressure_bar in [1.4, 2.0, 5.0] {
        for opening in [0.02, 0.1, 0.3, 0.6, 0.8] {
            let text = HOUSE
                .replace("opening = 0.5", &format!("opening = {opening}"))
                .replace("pressure_bar = 2", &format!("pressure_bar = {pressure_bar}"));
            let dp_pa = solve(&text).edge("load").unwrap().dp_pa;
            // m = 0.8 sqrt(0.3) of the consumer; with 0.1 bar over the controller it passes 0.316 at most.
            let reached = opening * 0.3_f64.sqrt() < (pressure_bar - 1.3_f64).sqrt();
            let held = (30_000.0..=33_000.0).contains(&dp_pa);
            assert_eq!(held, reached, "{pressure_bar} bar, opening {opening}: {dp_pa} Pa");
            assert!(dp_pa <= 33_000.0);
        }
    }
}

#[test]
fn a_run_follows_with_its_lag_and_ends_where_solve_does() {
    // In one step of 1 s after the load has closed from 0.5 to 0.1: y moves 1 - e^-0.2 of the way to where the
    // pressures at the end of the step want it.
    let wanted = solve(&HOUSE.replace("opening = 0.5", "opening = 0.1"));
    let wanted = wanted.edge("load").unwrap().dp_pa;
    let mut ends = Vec::new();
    for step_s in [0.1, 1.0, 10.0, 600.0] {
        let mut simulation = simulation(HOUSE);
        let start = get(&simulation, "controller.opening");
        assert!((start - 0.342_15).abs() < 1e-4, "it starts where it wants to be: {start}");
        set(&mut simulation, "load.opening", 0.1);
        advance(&mut simulation, step_s, step_s);
        let (y, dp_pa) = (get(&simulation, "controller.opening"), get(&simulation, "load.dp_pa"));
        let end = ((33_000.0 - dp_pa) / 3000.0).clamp(0.0, 1.0);
        let by_law = start - (-step_s / 5.0_f64).exp_m1() * (end - start);
        assert!((y - by_law).abs() < 1e-8, "{step_s}: {y} {by_law}");
        advance(&mut simulation, 1200.0, step_s);
        ends.push(get(&simulation, "load.dp_pa"));
    }
    assert!(ends.iter().all(|end| (end - wanted).abs() < 0.1), "{ends:?}, {wanted}");
}

#[test]
fn the_set_value_is_a_signal() {
    let mut simulation = simulation(HOUSE);
    set(&mut simulation, "controller.dp_set_pa", 5e4);
    advance(&mut simulation, 600.0, 60.0);
    // The band stays that of the file.
    assert!((5e4..5.3e4).contains(&get(&simulation, "load.dp_pa")));
    // What cannot be held leaves the valve open.
    set(&mut simulation, "controller.dp_set_pa", 9e4);
    advance(&mut simulation, 1200.0, 60.0);
    assert!(get(&simulation, "controller.opening") > 1.0 - 1e-9);
}

/// A line with a pump and `houses` behind pipes, each with a load and a controller; the last houses need
/// what the first ones throttle.
fn line(houses: usize, head_bar: f64) -> String {
    let mut text = format!(
        "format = 1\n[[node]]\nid = \"s0\"\n[[node]]\nid = \"r0\"\n[pressure_reference]\nnode = \"r0\"\n\
         pressure_bar = 2\n[[edge]]\nid = \"pump\"\nkind = \"pump\"\nfrom = \"r0\"\nto = \"s0\"\n\
         head_max_bar = {head_bar}\nfree_flow_m3_h = 60\nspeed = 1\ninitial_speed = 1\n"
    );
    for i in 1..=houses {
        let (opening, last) = (0.1 + 0.8 * (i as f64 * 0.618).fract(), i - 1);
        write!(
            text,
            "[[node]]\nid = \"s{i}\"\n[[node]]\nid = \"r{i}\"\n[[node]]\nid = \"b{i}\"\n\
             [[edge]]\nid = \"supply{i}\"\nkind = \"pipe\"\nfrom = \"s{last}\"\nto = \"s{i}\"\nlength_m = 60\n\
             inner_diameter_mm = 70\n\
             [[edge]]\nid = \"return{i}\"\nkind = \"pipe\"\nfrom = \"r{i}\"\nto = \"r{last}\"\nlength_m = 60\n\
             inner_diameter_mm = 70\n\
             [[edge]]\nid = \"load{i}\"\nkind = \"valve\"\nfrom = \"s{i}\"\nto = \"b{i}\"\nkvs_m3_h = 1.6\n\
             opening = {opening}\nstroke_time_s = 0\n\
             [[edge]]\nid = \"dpc{i}\"\nkind = \"dp_controller\"\nfrom = \"b{i}\"\nto = \"r{i}\"\n\
             kvs_m3_h = 2.5\nhigh_node = \"s{i}\"\nlow_node = \"b{i}\"\ndp_set_bar = 0.2\n"
        )
        .unwrap();
    }
    text
}

#[test]
fn many_controllers_in_one_network_hold_their_bands() {
    let text = line(20, 2.0);
    let steady = solve(&text);
    for i in 1..=20 {
        let dp_pa = steady.edge(&format!("load{i}")).unwrap().dp_pa;
        assert!((20_000.0..=22_000.0).contains(&dp_pa), "house {i}: {dp_pa} Pa");
    }
    // All loads change at every step of a minute; each stays in its band, and nothing hunts: constant again,
    // they come to rest at the same place as `solve`.
    let mut simulation = simulation(&text);
    for step in 1..=10 {
        for i in 1..=20 {
            let opening = 0.1 + 0.8 * (f64::from(i * step) * 0.618).fract();
            set(&mut simulation, &format!("load{i}.opening"), opening);
        }
        advance(&mut simulation, 60.0 * f64::from(step), 60.0);
        for i in 1..=20 {
            let dp_pa = get(&simulation, &format!("load{i}.dp_pa"));
            assert!((19_990.0..=22_010.0).contains(&dp_pa), "house {i} at {step}: {dp_pa} Pa");
        }
    }
    for i in 1..=20 {
        let opening = 0.1 + 0.8 * (f64::from(i) * 0.618).fract();
        set(&mut simulation, &format!("load{i}.opening"), opening);
    }
    advance(&mut simulation, 1800.0, 60.0);
    for i in 1..=20 {
        let wanted = steady.edge(&format!("load{i}")).unwrap().dp_pa;
        let dp_pa = get(&simulation, &format!("load{i}.dp_pa"));
        assert!((dp_pa - wanted).abs() < 0.01, "house {i}: {dp_pa} instead of {wanted}");
    }
}

#[test]
fn what_the_pump_cannot_give_leaves_the_far_controllers_open() {
    let steady = solve(&line(30, 0.4));
    let dp_pa = |i: usize| steady.edge(&format!("load{i}")).unwrap().dp_pa;
    assert!((20_000.0..=22_000.0).contains(&dp_pa(1)));
    assert!(dp_pa(30) < 20_000.0 && dp_pa(30) > 0.0, "{}", dp_pa(30));
}

/// Two pressure zones in series: 6 bar, reduced to 4 and then to 2.5 bar, with a draw-off at each.
const ZONES: &str = r#"
format = 1
[[node]]
id = "works"
kind = "pressure_boundary"
pressure_bar = 6
[[node]]
id = "upper"
kind = "source"
m_flow_kg_s = -1
temperature_degc = 10
[[node]]
id = "lower"
kind = "source"
m_flow_kg_s = -2
temperature_degc = 10
[[edge]]
id = "first"
kind = "pressure_reducing_valve"
from = "works"
to = "upper"
kvs_m3_h = 25
pressure_set_bar = 4
[[edge]]
id = "second"
kind = "pressure_reducing_valve"
from = "upper"
to = "lower"
kvs_m3_h = 25
pressure_set_bar = 2.5
band_pressure_bar = 0.1
"#;

#[test]
fn pressure_zones_keep_their_pressure() {
    // Below: 2 kg/s = 7.2 m3/h through k y = 25 phi sqrt(dp); the first valve has 3 kg/s = 10.8 m3/h at about
    // 1.6 bar: phi = 0.3415, so p = 4.4 - 0.4*0.3408 = 4.2637 and dp = 1.7363: phi = 0.32785, y = 0.32718,
    // p = 4.26913; dp = 1.73087, phi = 0.328362, y = 0.327690: p = 4.268924 bar.
    let steady = solve(ZONES);
    let p_bar = |id: &str| steady.node(id).unwrap().p_pa / 1e5;
    assert!((p_bar("upper") - 4.268_93).abs() < 2e-5, "{}", p_bar("upper"));
    // 7.2 = 25 phi sqrt(4.26893 - p), p = 2.6 - 0.1 y: y = 0.2208 gives p = 2.57792 and
    // phi = 0.288/sqrt(1.69101) = 0.221471, y = 0.220692; p = 2.577931.
    assert!((p_bar("lower") - 2.577_93).abs() < 2e-5, "{}", p_bar("lower"));
    // Over a day of draw-offs both zones stay in their bands, but for the moment of the change.
    let mut simulation = simulation(ZONES);
    for (k, draw) in [0.1, 3.0, 0.5, 4.0, 0.02].into_iter().enumerate() {
        set(&mut simulation, "lower.m_flow_kg_s", -draw);
        set(&mut simulation, "upper.m_flow_kg_s", -0.5 * draw);
        advance(&mut simulation, 300.0 * (k as f64 + 1.0), 60.0);
        let p_bar = |id: &str| get(&simulation, &format!("{id}.p_pa")) / 1e5;
        assert!((4.0..=4.4).contains(&p_bar("upper")), "{draw}: {}", p_bar("upper"));
        assert!((2.5..=2.6).contains(&p_bar("lower")), "{draw}: {}", p_bar("lower"));
    }
}

#[test]
fn a_remote_sensor_and_a_pressure_too_low_to_reduce() {
    // It senses the far zone: there the pressure is in the band.
    let remote = ZONES.replace(
        "pressure_set_bar = 4\n",
        "pressure_set_bar = 2.4\nband_pressure_bar = 0.05\nsensed_node = \"lower\"\n",
    );
    let p_bar = |text: &str, id: &str| solve(text).node(id).unwrap().p_pa / 1e5;
    let lower = p_bar(&remote, "lower");
    assert!((2.4..=2.45).contains(&lower), "{lower}");
    // 3.9 bar at the works: the first valve is open, 10.8 m3/h take (10.8/25)^2 = 0.186624 bar.
    let low = ZONES.replace("pressure_bar = 6", "pressure_bar = 3.9");
    assert!((p_bar(&low, "upper") - (3.9 - 0.186_624)).abs() < 1e-6);
}

#[test]
fn what_it_senses_must_be_there() {
    let said = problems(&HOUSE.replace("high_node = \"supply\"", "high_node = \"suply\""));
    assert!(said.contains("high_node names no node: \"suply\""), "{said}");
    let said = problems(&HOUSE.replace("low_node = \"between\"", "low_node = \"supply\""));
    assert!(said.contains("high_node and low_node are the same node"), "{said}");
    let said = problems(&ZONES.replace("pressure_set_bar = 4", "pressure_set_bar = 0"));
    assert!(said.contains("pressure_set_bar") && said.contains("must be positive"), "{said}");
}

#[test]
fn valves_that_need_each_other_come_to_rest() {
    // Both sense the lower zone, the second one with a lower set value than the first: the first stays open as
    // long as the pressure is below its own, so the second alone reduces.
    let one =
        ZONES.replace("pressure_set_bar = 4\n", "pressure_set_bar = 3\nsensed_node = \"lower\"\n");
    let steady = solve(&one);
    let p_bar = |id: &str| steady.node(id).unwrap().p_pa / 1e5;
    assert!((2.5..=2.6).contains(&p_bar("lower")), "{}", p_bar("lower"));
    assert!((p_bar("upper") - (6.0 - 0.186_624)).abs() < 1e-6, "{}", p_bar("upper"));
    // Narrow bands, as of a pilot-operated valve: 1 mbar.
    let narrow = ZONES.replace("band_pressure_bar = 0.1", "band_pressure_bar = 0.001");
    let narrow = narrow.replace("set_bar = 4\n", "set_bar = 4\nband_pressure_bar = 0.001\n");
    let steady = solve(&narrow);
    for (id, set_pa) in [("upper", 4e5), ("lower", 2.5e5)] {
        let p_pa = steady.node(id).unwrap().p_pa;
        assert!((set_pa..set_pa + 100.0).contains(&p_pa), "{id}: {p_pa}");
    }
}

#[test]
fn a_sustaining_valve_leaves_the_zone_before_it_its_pressure() {
    // A main of 4 bar through a resistance of 1 bar at 2 kg/s; behind the valve the open at 0 bar. It opens from
    // 3 to 3.2 bar before it: m = 2 sqrt(4 - p), m = phi 25/3.6 sqrt(p), y = (p - 3)/0.2. At p = 3.0315:
    // m = 1.96826, phi = 0.162784, y = 0.161946 against 0.1575; p = 3.0323: m = 1.967436, phi = 0.162694,
    // y = 0.161856 against 0.1615; p = 3.03237: 1.967364, 0.162686, 0.161848 and 0.16185.
    let text = |drawn_kg_s: f64| {
        format!(
            "format = 1\n[[node]]\nid = \"main\"\nkind = \"pressure_boundary\"\npressure_bar = 4\n\
             [[node]]\nid = \"zone\"\nkind = \"source\"\nm_flow_kg_s = {}\ntemperature_degc = 10\n\
             [[node]]\nid = \"open\"\nkind = \"pressure_boundary\"\npressure_bar = 0\n\
             [[edge]]\nid = \"pipe\"\nkind = \"resistance\"\nfrom = \"main\"\nto = \"zone\"\n\
             dp_nominal_bar = 1\nm_flow_nominal_kg_s = 2\ndelta_m = 0.01\n\
             [[edge]]\nid = \"valve\"\nkind = \"pressure_sustaining_valve\"\nfrom = \"zone\"\nto = \"open\"\n\
             kvs_m3_h = 25\npressure_set_bar = 3\nband_pressure_bar = 0.2\n",
            -drawn_kg_s
        )
    };
    let steady = solve(&text(0.0));
    let p_bar = |steady: &Steady| steady.node("zone").unwrap().p_pa / 1e5;
    assert!((p_bar(&steady) - 3.032_37).abs() < 2e-5, "{}", p_bar(&steady));
    // The more the zone takes, the less the valve lets out; 2 kg/s leave the zone its 3 bar, more does not.
    for drawn_kg_s in [0.5, 1.0, 1.9, 2.5] {
        let steady = solve(&text(drawn_kg_s));
        let out = steady.edge("valve").unwrap().m_flow_kg_s;
        assert_eq!((3.0..3.2).contains(&p_bar(&steady)), drawn_kg_s < 2.0, "{}", p_bar(&steady));
        assert!(out < 1.967_36 - 0.9 * drawn_kg_s.min(2.0) && out > 0.0, "{drawn_kg_s}: {out}");
    }
    let mut simulation = simulation(&text(0.0));
    set(&mut simulation, "zone.m_flow_kg_s", -1.5);
    advance(&mut simulation, 120.0, 60.0);
    let p_pa = get(&simulation, "zone.p_pa");
    assert!((3e5..3.2e5).contains(&p_pa), "{p_pa}");
}
