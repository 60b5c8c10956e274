//! Local controllers on whole networks: weighted PI beside pump blocking (SC-01 d), cascade, two-step,
//! feed-forward, thermostatic valve.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::workspace;

fn read(text: &str) -> Model {
    Model::from_toml(text, &workspace())
        .unwrap_or_else(|problems| panic!("{}\n{text}", problems.render(text)))
}

fn start(text: &str) -> Simulation {
    Simulation::new(build(&read(text)).unwrap_or_else(|p| panic!("{}", p.render(text)))).unwrap()
}

fn run(simulation: &mut Simulation, until_s: f64, step_s: f64) {
    simulation.advance_to(Time::from_s(until_s).unwrap(), Time::from_s(step_s).unwrap()).unwrap();
}

fn get(simulation: &Simulation, name: &str) -> f64 {
    simulation.get(simulation.channel(name).unwrap_or_else(|_| panic!("{name}")))
}

/// The three houses of SC-01, of which the feeders stand in `feeders`; the rest of the file follows.
fn three_houses(
    initial: &str,
    v_flow_l_min: f64,
    feeders: &[&str],
    kind: &str,
    parts: &str,
    rest: &str,
) -> String {
    let mut text = format!(
        r#"format = 1

[run]
until = "2h"
step = "1s"
initial_degc = 40
{initial}

[fluid]
kind = "constant_water"
density_kg_m3 = 1000
heat_capacity_j_kg_k = 4180

[ground]
temperature_degc = 12

[pipe_type.dn20]
inner_diameter_mm = 22
roughness_mm = 0.011
zeta = 10
insulation_resistance_k_m_w = 3.78

[[site]]
id = "sf1"

[[site]]
id = "sf2"

[[site]]
id = "sf4"

[[trench]]
from = "sf1"
to = "sf2"
length_m = 200
pipe = "dn20"

[[trench]]
from = "sf2"
to = "sf4"
length_m = 50
pipe = "dn20"

[[station]]
site = "sf4"
kind = "consumer"
stub = {{ pipe = "dn20", length_m = 5, zeta = 1.75 }}
extraction_valve = {{ command = "kappa", kappa = 0.5 }}

[[unit]]
site = "sf4"
kind = "prescribed_source"
supply_degc = 40
v_flow_l_min = 8

[pressure_reference]
node = "sf4.cold"
pressure_bar = 1.5
"#
    );
    for site in feeders {
        text.push_str(&format!(
            r#"
[[station]]
site = "{site}"
kind = "{kind}"
stub = {{ pipe = "dn20", length_m = 5, zeta = 1.75 }}
{parts}

[[unit]]
site = "{site}"
kind = "ideal_house"
sent_degc = 65
v_flow_l_min = {v_flow_l_min}
"#
        ));
    }
    text.push_str(rest);
    text
}

/// SC-01 d: both feeders under weighted PI control, kW each.
fn weighted(initial: &str, variant: &str, q_kw: f64) -> String {
    let valve = "extraction_valve = { command = \"kappa\", leakage = 0 }";
    let controller = |site: &str| {
        format!(
            "\n[[controller]]\nkind = \"weighted_pi\"\nstation = \"{site}.station\"\nvariant = \"{variant}\"\nq_flow_kw = {q_kw}\n\
             primary_hot_degc = 63.5\nsecondary_difference_k = 22\nfeed_in_primary_gain = 0.03\n"
        )
    };
    let rest = controller("sf1") + &controller("sf2");
    three_houses(initial, 8.0, &["sf1", "sf2"], "bidirectional", valve, &rest)
}

#[test]
fn weighted_pi_control_does_not_let_the_near_feeder_block_the_far_one() {
    // At fixed speeds 0.95 and 1 the far one has 9 % of the flow (tests/pumps/pump_blocking.rs).
    let mut simulation = start(&weighted("", "crossover", 4.0));
    run(&mut simulation, 7200.0, 1.0);
    for site in ["sf1", "sf2"] {
        let q_kw = get(&simulation, &format!("{site}.station.q_flow_w")) / 1000.0;
        assert!((q_kw - 4.0).abs() < 0.15 * 4.0, "{site}: {q_kw} kW");
        let speed = get(&simulation, &format!("{site}.feed_in_pump.speed"));
        assert!(speed < 0.99, "{site}: {speed}");
    }
    // 8 kW each are more than SF4 takes: the far feeder is at full speed, the near one is not.
    let mut simulation = start(&weighted("", "crossover", 8.0));
    run(&mut simulation, 7200.0, 1.0);
    let speed = |site: &str| get(&simulation, &format!("{site}.feed_in_pump.speed"));
    let q_kw = |site: &str| get(&simulation, &format!("{site}.station.q_flow_w")) / 1000.0;
    assert!(q_kw("sf1") + q_kw("sf2") < 15.0, "feasible after all");
    let (near, far) = (speed("sf2"), speed("sf1"));
    assert!(near < 0.995 && far > near, "{near} {far}");
    // The near one still has its 8 kW, and does not take all: 38 % are from the far one.
    assert!(q_kw("sf1") > 0.35 * (q_kw("sf1") + q_kw("sf2")), "{} {}", q_kw("sf1"), q_kw("sf2"));
}

#[test]
fn a_run_that_starts_steady_stays_in_the_equilibrium_of_weighted_pi_control() {
    // Without heat loss: the profile of a pipe that cools starts as straight lines, which takes a while.
    let text = weighted("initial = \"steady\"", "crossover", 4.0).replace("= 3.78", "= 1e5");
    let mut simulation = start(&text);
    let look = |simulation: &Simulation| {
        ["sf1", "sf2"].map(|site| {
            let at = |name: &str| get(simulation, &format!("{site}.{name}"));
            let heat = 4.0 - at("station.q_flow_w") / 1000.0;
            let hot_k = 63.5 + 273.15 - at("exchanger_hot.t_k");
            let difference_k = 22.0 - (at("unit.t_hot_k") - at("unit.t_cold_k"));
            let pump = 2.0 / 3.0 * heat + difference_k / 9.0;
            let flow = heat / 3.0 + 2.0 / 9.0 * hot_k;
            [at("feed_in_pump.speed"), at("unit.v_flow_m3_s_command") * 60_000.0, pump, flow]
        })
    };
    let before = look(&simulation);
    run(&mut simulation, 1800.0, 1.0);
    let after = look(&simulation);
    for (before, after) in before.iter().zip(&after) {
        for (k, (before, after)) in before.iter().zip(after).enumerate() {
            assert!((before - after).abs() < 1e-4, "{k}: {before} {after}");
        }
        // Weighted errors are zero, or the output is at its limit.
        let [speed, flow_l_min, pump, flow] = *before;
        assert!(pump.abs() < 1e-6 || !(0.25 + 1e-6..1.0 - 1e-6).contains(&speed), "{before:?}");
        assert!(flow.abs() < 1e-6 || !(2.0 + 1e-6..8.5 - 1e-6).contains(&flow_l_min), "{before:?}");
    }
}

#[test]
fn what_a_station_stands_for_is_visible() {
    let model = read(&weighted("", "crossover", 4.0));
    let controller = &model.controllers[0];
    assert_eq!(controller.id, "sf1.controller");
    let named: Vec<(&str, &str)> = controller.named().collect();
    assert_eq!(
        named,
        [
            ("measures_heat", "sf1.station.q_flow_w"),
            ("measures_primary_hot", "sf1.exchanger_hot.t_k"),
            ("measures_primary_cold", "sf1.branch_cold.t_k"),
            ("measures_secondary_hot", "sf1.unit.t_hot_k"),
            ("measures_secondary_cold", "sf1.unit.t_cold_k"),
            ("acts_on_pump", "sf1.feed_in_pump.speed"),
            ("acts_on_valve", "sf1.extraction_valve.kappa"),
            ("acts_on_secondary", "sf1.unit.v_flow_m3_s"),
        ]
    );
}

#[test]
fn a_cascade_holds_the_supply_temperature_of_a_feeder() {
    // Outer: too hot wants more pressure difference, hence the negative gain.
    let rest = r#"
[[sensor]]
id = "dp"
measures = "sf1.hot.p_pa"
minus = "sf1.cold.p_pa"

[[controller]]
id = "cascade"
kind = "cascade"
measures = "sf1.exchanger_hot.t_k"
inner_measures = "dp.value"
acts_on = "sf1.feed_in_pump.speed"
set_point = 331.15
gain = -500
integral_time_s = 60
inner_set_min = 2000
inner_set_max = 35000
inner_gain = 2e-6
inner_integral_time_s = 5
initial_output = 0.3
"#;
    let text = three_houses("", 4.0, &["sf1"], "producer", "", rest);
    let steady = steady::solve(&read(&text)).unwrap();
    let settled_degc = steady.node("sf1.exchanger_hot").unwrap().t_k - 273.15;
    assert!((settled_degc - 58.0).abs() < 1e-3, "{settled_degc}");
    let mut simulation = start(&text);
    run(&mut simulation, 7200.0, 1.0);
    let t_degc = get(&simulation, "sf1.exchanger_hot.t_k") - 273.15;
    // 1 % of 58 degC; the pressure difference is where solve has it.
    assert!((t_degc - 58.0).abs() < 0.58, "{t_degc}");
    let p = |node: &str| steady.node(node).unwrap().p_pa;
    let (dp, expected) = (get(&simulation, "dp.value"), p("sf1.hot") - p("sf1.cold"));
    assert!((dp - expected).abs() < 0.01 * expected, "{dp} {expected}");
}

#[test]
fn two_step_control_waits_for_hot_water_and_holds_what_it_feeds_in() {
    let rest = r#"
[[controller]]
kind = "two_step"
station = "sf1.station"
supply_degc = 58
head_max_hpa = 402.21

[[schedule]]
signal = "sf1.unit.sent_k"
unit = "degC"
interpolation = "hold"
points = [[0, 50], [600, 65], [7200, 59]]
"#;
    let mut simulation = start(&three_houses("", 4.0, &["sf1"], "producer", "", rest));
    run(&mut simulation, 590.0, 1.0);
    assert_eq!(get(&simulation, "sf1.feed_in_pump.speed"), 0.0, "50 degC are not enough");
    run(&mut simulation, 7190.0, 1.0);
    let t_degc = get(&simulation, "sf1.exchanger_hot.t_k") - 273.15;
    assert!((t_degc - 58.0).abs() < 0.1, "{t_degc}");
    // Its head at zero flow, u2 H0, is above the pressure difference of the grid.
    let speed = get(&simulation, "sf1.feed_in_pump.speed");
    let dp_pa = get(&simulation, "sf1.hot.p_pa") - get(&simulation, "sf1.cold.p_pa");
    assert!(speed * speed * 40_221.0 > dp_pa, "{speed} {dp_pa}");
    run(&mut simulation, 7400.0, 1.0);
    assert_eq!(
        get(&simulation, "sf1.feed_in_pump.speed_command"),
        0.0,
        "59 degC are below 58 + 5 - 2"
    );
}

/// Seconds until the heat of SF1 has done 90 % of a step from 4 to 6 kW.
fn rises(controller: &str) -> f64 {
    let rest = format!(
        "\n[[controller]]\nid = \"heat\"\n{controller}\ninitial = 0\n\n[[schedule]]\nsignal = \"heat.SET\"\n\
         interpolation = \"hold\"\npoints = [[0, 4000], [3600, 6000]]\n"
    );
    let set = if controller.contains("feed_forward") { "q_flow_w" } else { "set_point" };
    let rest = rest.replace("\ninitial = 0", "").replace("SET", set);
    let pump = "feed_in_pump = { mode = \"flow\", m_flow_set_kg_s = 0.05 }";
    let mut simulation = start(&three_houses("", 4.0, &["sf1"], "producer", pump, &rest));
    run(&mut simulation, 3600.0, 1.0);
    let q_w = get(&simulation, "sf1.station.q_flow_w");
    assert!((q_w - 4000.0).abs() < 40.0, "{q_w}");
    for k in 1..=1200_u32 {
        run(&mut simulation, 3600.0 + f64::from(k), 1.0);
        if get(&simulation, "sf1.station.q_flow_w") > 5800.0 {
            return f64::from(k);
        }
    }
    f64::INFINITY
}

#[test]
fn feed_forward_is_faster_than_its_trim_alone() {
    let ports = "measures = \"sf1.station.q_flow_w\"\nacts_on = \"sf1.feed_in_pump.m_flow_set_kg_s\"\n\
                 gain = 2e-6\nintegral_time_s = 60";
    let with = rises(&format!(
        "kind = \"feed_forward\"\nq_flow_w = 4000\ntemperature_difference_k = 20\n{ports}"
    ));
    let without = rises(&format!("kind = \"pi\"\nset_point = 4000\n{ports}"));
    println!("with {with} s, without {without} s");
    assert!(with < 0.5 * without, "with {with} s, without {without} s");
}

#[test]
fn a_thermostatic_valve_rests_on_its_proportional_line() {
    let rest = r#"
[[controller]]
id = "thermostat"
kind = "thermostatic_valve"
measures = "sf4.branch_cold.t_k"
acts_on = "sf4.extraction_valve.kappa"
set_point_degc = 41
proportional_band_difference_k = 2
time_constant_s = 60
"#;
    let text = three_houses("", 4.0, &["sf1"], "producer", "feed_in_pump = { speed = 0.8 }", rest);
    let line = |t_k: f64| (0.5 - (t_k - 314.15) / 2.0).clamp(0.0, 1.0);
    let mut simulation = start(&text);
    run(&mut simulation, 7200.0, 1.0);
    let t_k = get(&simulation, "sf4.branch_cold.t_k");
    let kappa = get(&simulation, "sf4.extraction_valve.kappa_command");
    assert!((0.05..0.95).contains(&kappa), "{kappa}");
    assert!((kappa - line(t_k)).abs() < 1e-4, "{kappa} {}", line(t_k));
    let steady = steady::solve(&read(&text)).unwrap();
    assert!((steady.node("sf4.branch_cold").unwrap().t_k - t_k).abs() < 0.05);
}
