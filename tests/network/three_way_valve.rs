//! Three-way valves and four-way mixers: several valves, one command.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady::{self, Steady};
use std::path::Path;

/// Hot and cold water at 1 bar, the common node at 0.5 bar below.
const MIXER: &str = r#"
format = 1
[[node]]
id = "hot"
kind = "pressure_boundary"
pressure_bar = 1
temperature_degc = 80
[[node]]
id = "cold"
kind = "pressure_boundary"
pressure_bar = 1
temperature_degc = 40
[[node]]
id = "mixed"
kind = "pressure_boundary"
pressure_bar = 0.5
[[three_way_valve]]
id = "mixer"
a = "hot"
b = "cold"
ab = "mixed"
kvs_m3_h = 4
"#;

fn model(text: &str) -> Model {
    let model = Model::from_toml(text, Path::new("."));
    model.unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn flows(steady: &Steady) -> (f64, f64) {
    let flow = |id: &str| steady.edge(id).unwrap().m_flow_kg_s;
    (flow("mixer.a"), flow("mixer.b"))
}

fn at(opening: f64, more: &str) -> (f64, f64) {
    flows(&steady::solve(&model(&format!("{MIXER}opening = {opening}\n{more}"))).unwrap())
}

#[test]
fn the_total_flow_is_constant_over_the_stroke() {
    // 4 m3/h at 1 bar: 4/3.6 sqrt(0.5) = 0.785674 kg/s with one way open, and the leak 1e-3 of it
    let open = 4.0 / 3.6 * 0.5_f64.sqrt();
    for i in 0..=20 {
        let x = f64::from(i) / 20.0;
        let (a, b) = at(x, "");
        assert!(((a + b) / (1.001 * open) - 1.0).abs() < 1e-3, "{x}: {a} {b}");
        // Linear with leak l: phi = l + (1 - l) x; the leak alone is laminar and less.
        assert!((a / open - (1e-3 + 0.999 * x)).abs() < 1e-3, "{x}: {a}");
    }
    // An equal-percentage way a is far from that.
    let (a, b) = at(0.5, "characteristic = \"equal_percentage\"\ncharacteristic_b = \"linear\"");
    assert!(a < 0.2 * open && (b / open - 0.5005).abs() < 1e-9, "{a} {b}");
    // Half the coefficient in way b.
    let (a, b) = at(0.5, "kvs_ratio = 0.5");
    assert!((b / a - 0.5).abs() < 1e-9, "{a} {b}");
}

#[test]
fn diverting_turns_the_ways_and_nothing_else() {
    let text = format!("{MIXER}opening = 0.3\n");
    let mixing = flows(&steady::solve(&model(&text)).unwrap());
    let diverting =
        flows(&steady::solve(&model(&format!("{text}mode = \"diverting\"\n"))).unwrap());
    assert!((mixing.0 + diverting.0).abs() < 1e-12 && (mixing.1 + diverting.1).abs() < 1e-12);
    // The direction is a result: with more pressure at the common node the water is diverted.
    let turned = text.replace("pressure_bar = 0.5", "pressure_bar = 1.5");
    let turned = flows(&steady::solve(&model(&turned)).unwrap());
    assert!((turned.0 + mixing.0).abs() < 1e-9 && (turned.1 + mixing.1).abs() < 1e-9);
}

#[test]
fn one_signal_drives_both_ways_within_the_stroke_time() {
    let text = format!(
        "{MIXER}opening = 0\nstroke_time_s = 10\n[[schedule]]\nsignal = \"mixer.opening\"\n\
         points = [[0, 0], [10, 0.75]]\n"
    );
    let plan = build(&model(&text)).unwrap();
    let openings: Vec<&str> = plan.signals().specs().iter().map(|s| s.name.as_str()).collect();
    assert!(openings.contains(&"mixer.opening") && !openings.contains(&"mixer.b.opening"));
    let mut simulation = Simulation::new(plan).unwrap();
    let get = |simulation: &Simulation, channel: &str| {
        simulation.get(simulation.channel(channel).unwrap())
    };
    let step = Time::from_s(1.0).unwrap();
    for time_s in [5.0, 13.0, 17.0, 60.0] {
        simulation.advance_to(Time::from_s(time_s).unwrap(), step).unwrap();
        let (a, b) = (get(&simulation, "mixer.a.opening"), get(&simulation, "mixer.b.opening"));
        assert!((a + b - 1.0).abs() < 1e-12, "{time_s}: {a} {b}");
        assert_eq!(time_s <= 10.0, a == 0.0);
    }
    assert!((get(&simulation, "mixer.a.opening") - 0.75).abs() < 1e-9);
    // The mixture: 0.75 of 80 and 0.25 of 40 degC but for the leaks, as a weighted mean.
    let (a, b) = (get(&simulation, "mixer.a.m_flow_kg_s"), get(&simulation, "mixer.b.m_flow_kg_s"));
    let mixed_degc = (80.0 * a + 40.0 * b) / (a + b);
    assert!((get(&simulation, "mixed.t_k") - 273.15 - mixed_degc).abs() < 0.01);
}

#[test]
fn a_switching_valve_is_open_to_one_side() {
    let (a, b) = at(0.49, "switch_at = 0.5\nleakage = 0");
    assert!(a == 0.0 && b > 0.7, "{a} {b}");
    let (a, b) = at(0.5, "switch_at = 0.5\nleakage = 0");
    assert!(b == 0.0 && a > 0.7, "{a} {b}");
}

#[test]
fn the_plain_model_is_the_same() {
    let model = model(&format!("{MIXER}opening = 0.3\n"));
    let text = model.to_plain_toml().unwrap();
    let again = Model::from_toml(&text, Path::new(".")).unwrap();
    assert_eq!(steady::solve(&again).unwrap(), steady::solve(&model).unwrap());
}

/// A source of 80 degC and a load that returns 40 degC, each with 0.5 bar across the mixer.
const FOUR_WAYS: &str = r#"
format = 1
[fluid]
kind = "constant_water"
density_kg_m3 = 1000
heat_capacity_j_kg_k = 4200
[[node]]
id = "flow"
kind = "pressure_boundary"
pressure_bar = 1
temperature_degc = 80
[[node]]
id = "back"
kind = "pressure_boundary"
pressure_bar = 0.5
[[node]]
id = "warm"
kind = "pressure_boundary"
pressure_bar = 0.5
[[node]]
id = "cold"
kind = "pressure_boundary"
pressure_bar = 1
temperature_degc = 40
[[four_way_mixer]]
id = "mixer"
source_supply = "flow"
source_return = "back"
load_supply = "warm"
load_return = "cold"
kvs_m3_h = 4
"#;

#[test]
fn a_four_way_mixer_mixes_both_ways() {
    let l = 1e-3;
    let mut before: Option<(f64, f64)> = None;
    for i in 0..=40 {
        let x = f64::from(i) / 40.0;
        let steady = steady::solve(&model(&format!("{FOUR_WAYS}opening = {x}\n"))).unwrap();
        let flow = |way: &str| steady.edge(&format!("mixer.{way}")).unwrap().m_flow_kg_s;
        let degc = |node: &str| steady.node(node).unwrap().t_k - 273.15;
        // Each pair of ways as a three-way valve: 4/3.6 sqrt(0.5) kg/s and the leak, whatever x.
        let total = 1.001 * 4.0 / 3.6 * 0.5_f64.sqrt();
        assert!(((flow("supply") + flow("recirculation")) / total - 1.0).abs() < 1e-3, "{x}");
        assert!(((flow("return") + flow("bypass")) / total - 1.0).abs() < 1e-3, "{x}");
        // x of the source and 1 - x of the return to the load, the other way round to the source:
        // 40 + 40 (l + (1 - l) x)/(1 + l).
        let share = (l + (1.0 - l) * x) / (1.0 + l);
        assert!((degc("warm") - (40.0 + 40.0 * share)).abs() < 0.05, "{x}: {}", degc("warm"));
        assert!((degc("back") - (80.0 - 40.0 * share)).abs() < 0.05, "{x}: {}", degc("back"));
        // What the source gives is what the load gets.
        let cp = 4200.0;
        let given = cp * (flow("supply") + flow("bypass")) * 80.0
            - cp * (flow("return") + flow("bypass")) * degc("back");
        let taken = cp * (flow("supply") + flow("recirculation")) * degc("warm")
            - cp * (flow("return") + flow("recirculation")) * 40.0;
        assert!((given - taken).abs() < 1e-6 * cp * 80.0, "{x}: {given} {taken}");
        // Without a jump over the stroke.
        let (warm, back) = (degc("warm"), degc("back"));
        if let Some((warm_before, back_before)) = before {
            assert!(warm > warm_before && warm - warm_before < 1.1 && back < back_before);
        }
        before = Some((warm, back));
    }
}

#[test]
fn the_ways_of_a_four_way_mixer_move_together() {
    let text = format!("{FOUR_WAYS}opening = 0\nstroke_time_s = 10\n");
    let plan = build(&model(&text)).unwrap();
    let names: Vec<&str> = plan.signals().specs().iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names.iter().filter(|name| name.ends_with(".opening")).count(), 1, "{names:?}");
    let mut simulation = Simulation::new(plan).unwrap();
    let command = simulation.signal("mixer.opening").unwrap();
    simulation.set(command, 0.6).unwrap();
    let step = Time::from_s(1.0).unwrap();
    for time_s in [3.0, 6.0, 30.0] {
        simulation.advance_to(Time::from_s(time_s).unwrap(), step).unwrap();
        let at = |way: &str| {
            let channel = simulation.channel(&format!("mixer.{way}.opening")).unwrap();
            simulation.get(channel)
        };
        assert_eq!(at("supply"), at("return"));
        assert_eq!(at("recirculation"), at("bypass"));
        assert!((at("supply") + at("bypass") - 1.0).abs() < 1e-12);
    }
}

/// A pulsing mixer with a meter before each way.
fn pulsing() -> String {
    let meter = |of: &str| {
        format!(
            "[[node]]\nid = \"{of}_metered\"\n[[edge]]\nid = \"meter_{of}\"\nkind = \"heat_meter\"\n\
             from = \"{of}\"\nto = \"{of}_metered\"\nreturn_node = \"mixed\"\nm_flow_nominal_kg_s = 1\n\
             dp_nominal_pa = 1000\n"
        )
    };
    let valve = MIXER.replace("a = \"hot\"", "a = \"hot_metered\"");
    let valve = valve.replace("b = \"cold\"", "b = \"cold_metered\"");
    let fields = "opening = 0.3\npulse_period_s = 60\nstroke_time_s = 0\nleakage = 0\n";
    format!("{valve}{fields}{}{}", meter("hot"), meter("cold"))
}

/// Water in m3 that has passed way a and way b.
fn volumes(simulation: &Simulation) -> (f64, f64) {
    let get = |channel: &str| simulation.get(simulation.channel(channel).unwrap());
    (get("meter_hot.volume_m3"), get("meter_cold.volume_m3"))
}

#[test]
fn pulses_have_their_share_of_each_period_whatever_the_step() {
    // 4 m3/h at 1 bar and the meter 0.01 bar at 3.6 m3/h: v = sqrt(0.5/(1/16 + 0.01/12.96)) = 2.811 m3/h.
    let open_m3 = (0.5 / (1.0 / 16.0 + 0.01 / 12.96_f64)).sqrt() / 60.0;
    let plan = build(&model(&pulsing())).unwrap();
    let time = |s: f64| Time::from_s(s).unwrap();
    for step_s in [1.0, 7.0, 25.0, 60.0, 3600.0] {
        let mut simulation = Simulation::new(plan.clone()).unwrap();
        let share = simulation.signal("mixer.opening").unwrap();
        let mut before = (0.0, 0.0);
        let mut passed = |simulation: &mut Simulation, until_s: f64| {
            simulation.advance_to(time(until_s), time(step_s)).unwrap();
            let now = volumes(simulation);
            let passed = ((now.0 - before.0) / open_m3, (now.1 - before.1) / open_m3);
            before = now;
            passed
        };
        for (period, x) in [0.3, 0.0, 0.77, 1.0, 1.0 / 3.0].into_iter().enumerate() {
            simulation.set(share, x).unwrap();
            let (a, b) = passed(&mut simulation, 60.0 * (period as f64 + 1.0));
            // Exact to the nanosecond of the clock and the residual of the solver.
            assert!((a - x).abs() < 1e-9 && (b - (1.0 - x)).abs() < 1e-9, "{step_s}, {x}: {a} {b}");
        }
        // A new share within a period waits for the next one: half of it, of which 10 s come after 320 s.
        simulation.set(share, 0.5).unwrap();
        passed(&mut simulation, 320.0);
        simulation.set(share, 1.0).unwrap();
        let (a, b) = passed(&mut simulation, 360.0);
        assert!((a - 10.0 / 60.0).abs() < 1e-9 && (b - 30.0 / 60.0).abs() < 1e-9, "{a} {b}");
    }
}

#[test]
fn pulses_over_a_step_of_many_periods() {
    // A step of an hour has 60 periods: the share is exact over it.
    let mut simulation = Simulation::new(build(&model(&pulsing())).unwrap()).unwrap();
    let hour = Time::from_s(3600.0).unwrap();
    simulation.advance_to(hour, hour).unwrap();
    let (a, b) = volumes(&simulation);
    assert!((a / (a + b) - 0.3).abs() < 1e-9, "{a} {b}");
}

#[test]
fn pulses_settle_in_their_mean_and_survive_a_snapshot() {
    let text =
        format!("{MIXER}opening = 0.3\npulse_period_s = 60\nstroke_time_s = 0\nleakage = 0\n");
    let open = 4.0 / 3.6 * 0.5_f64.sqrt();
    let (a, b) = flows(&steady::solve(&model(&text)).unwrap());
    assert!((a / open - 0.3).abs() < 1e-6 && (b / open - 0.7).abs() < 1e-6, "{a} {b}");
    let mut simulation = Simulation::new(build(&model(&pulsing())).unwrap()).unwrap();
    let (time, step) = (|s| Time::from_s(s).unwrap(), Time::from_s(5.0).unwrap());
    simulation.advance_to(time(10.0), step).unwrap();
    // The command changes, the period keeps its share also over the snapshot: 18 s of 60 s.
    let share = simulation.signal("mixer.opening").unwrap();
    simulation.set(share, 0.9).unwrap();
    let here = simulation.snapshot();
    simulation.advance_to(time(60.0), step).unwrap();
    let once = volumes(&simulation);
    simulation.restore(&here).unwrap();
    simulation.advance_to(time(60.0), step).unwrap();
    assert_eq!(once, volumes(&simulation));
    assert!((once.0 / (once.0 + once.1) - 0.3).abs() < 1e-9, "{once:?}");
}

#[test]
fn a_pulsing_valve_is_quick() {
    let text = format!("{MIXER}opening = 0.3\npulse_period_s = 60\n");
    let problems = build(&model(&text)).unwrap_err().render(&text);
    assert!(problems.contains("at most a tenth of pulse_period_s"), "{problems}");
}
