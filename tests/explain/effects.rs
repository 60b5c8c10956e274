//! Effects: entries of the model file that add physics; their neutral values change nothing.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::build::build;
use anergy_simulation::effects::EffectParams;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::workspace;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;

/// A pipe of 100 m with a given flow and inlet temperature, 22 mm, R = 2 K m/W, ground 10 degC.
const PIPE: &str = r#"
format = 1
[run]
initial_degc = 60
[ground]
temperature_degc = 10
[[node]]
id = "in"
kind = "source"
m_flow_kg_s = 0.1
temperature_degc = 60
[[node]]
id = "out"
kind = "pressure_boundary"
pressure_bar = 1
[[edge]]
id = "pipe"
kind = "pipe"
from = "in"
to = "out"
length_m = 100
inner_diameter_mm = 22
roughness_mm = 0.05
insulation_resistance_k_m_w = 2
"#;

fn model(effects: &str) -> Model {
    Model::from_toml(&format!("{PIPE}{effects}"), Path::new(".")).unwrap()
}

fn outlet_degc(model: &Model) -> f64 {
    steady::solve(model).unwrap().node("out").unwrap().t_k - 273.15
}

fn dp_pa(model: &Model) -> f64 {
    steady::solve(model).unwrap().edge("pipe").unwrap().dp_pa
}

/// An example with a component that the effect can be of.
fn subject(id: &str) -> (&'static str, &'static str) {
    match id {
        "H1" | "H2" => ("two-pipe", "sf1.engine"),
        "H3" => ("three-houses", "sf1.feed_in_pump"),
        "H4" => ("three-houses", "sf2.feed_in_check_valve"),
        "H8" => ("three-way", "mixer"),
        "P11" => ("three-houses", "sf1.hot"),
        "X1" => ("three-houses", "sf1.heat_exchanger"),
        "G4" | "G6" => ("heat-pumps", "h3.heat_pump"),
        "G1" | "G2" | "G3" => ("two-pipe", "sf1.chp"),
        "G7" => ("two-pipe", "sf1.boiler"),
        _ if id.starts_with('T') => ("two-pipe", "sf1.storage"),
        _ => ("three-houses", "sf1-sf2.hot"),
    }
}

/// The neutral values of every effect.
fn neutral(id: &str) -> Value {
    match id {
        "P4" => json!({ "capacity_j_m_k": 0.0, "share": 0.5 }),
        "P6" => json!({ "volume_m3": 0.0 }),
        "P1" => json!({ "wall_capacity_j_m_k": 0.0, "film_factor": 1.0 }),
        "P7" => json!({ "dispersion_m2_s": 0.0 }),
        "H1" => json!({ "opening": 0.0 }),
        "P11" => json!({ "m_flow_kg_s": 0.0 }),
        "H2" | "H4" | "H8" => json!({ "share": 0.0 }),
        "T3" => json!({ "depth_m": 0.0 }),
        "T4" => json!({ "share": 0.0, "richardson": 1.0 }),
        "G2" => json!({ "factor_20": 1.0, "factor_40": 1.0, "factor_60": 1.0 }),
        "G3" => json!({ "time_factor": 1.0, "energy_j": 0.0 }),
        "G4" => json!({ "heat_w": 0.0 }),
        "G7" => json!({ "capacity_j_k": 0.0, "conductance_w_k": 100.0 }),
        "H3" | "T1" | "T2" | "G1" | "G6" | "X1" => json!({ "factor": 1.0 }),
        "P2" | "P5" | "P10" => json!({ "factor": 1.0 }),
        "P3" => json!({ "difference_k": 0.0, "lag_s": 0.0 }),
        "P8" => json!({ "factor": 1.0, "added_roughness_m": 0.0 }),
        other => panic!("effect {other} has no neutral value here"),
    }
}

#[test]
fn neutral_values_leave_the_model_and_its_run_identical() {
    let end = |model: &Model| {
        let mut simulation = Simulation::new(build(model).unwrap()).unwrap();
        simulation.advance_to(Time::from_s(300.0).unwrap(), Time::from_s(1.0).unwrap()).unwrap();
        simulation.snapshot().to_bytes().unwrap()
    };
    let mut before: HashMap<&str, (String, Model, Vec<u8>)> = HashMap::new();
    for id in EffectParams::KINDS {
        let (example, component) = subject(id);
        let dir = workspace().join("examples").join(example);
        let (text, plain, end_of_plain) = before.entry(example).or_insert_with(|| {
            let text = match example {
                "three-way" => MIXER.to_owned(),
                _ => std::fs::read_to_string(dir.join("model.toml")).unwrap(),
            };
            let plain = Model::from_toml(&text, &dir).unwrap();
            let end_of_plain = end(&plain);
            (text, plain, end_of_plain)
        });
        let Value::Object(params) = neutral(id) else { panic!() };
        let fields: String =
            params.iter().map(|(name, value)| format!("{name} = {value}\n")).collect();
        let entry =
            format!("{text}\n[[effect]]\nid = \"{id}\"\ncomponent = \"{component}\"\n{fields}");
        let with = Model::from_toml(&entry, &dir).unwrap();
        assert_eq!(with.effects.len(), 1, "{id}");
        let mut effective = with.with_effects().unwrap().into_owned();
        // The text is what was read, with the entry.
        effective.text.clone_from(&plain.text);
        assert_eq!(effective, *plain, "{id}");
        assert_eq!(end(&with), *end_of_plain, "{id}");
    }
}

#[test]
fn insulation_scales_the_loss() {
    // T_out = 10 + 50 exp(-f L/(R m cp)), L/(R m cp) = 100/(2 * 0.1 * 4180) = 0.119617:
    // f = 1: 54.3636, f = 2: 49.3611
    let by_hand = |factor: f64| 10.0 + 50.0 * (-factor * 100.0 / (2.0 * 0.1 * 4180.0)).exp();
    let plain = outlet_degc(&model(""));
    assert!((plain - by_hand(1.0)).abs() < 1e-6, "{plain} {}", by_hand(1.0));
    let twice = model("[[effect]]\nid = \"P2\"\ncomponent = \"pipe\"\nfactor = 2\n");
    assert!((outlet_degc(&twice) - by_hand(2.0)).abs() < 1e-6);
    assert!((by_hand(2.0) - 49.3611).abs() < 1e-3);
}

#[test]
fn surroundings_are_warmer_by_the_difference() {
    // 15 + 45 exp(-0.119617) = 54.9272
    let warmer = model("[[effect]]\nid = \"P3\"\ncomponent = \"pipe\"\ndifference_k = 5\n");
    assert!((outlet_degc(&warmer) - 54.9272).abs() < 1e-3, "{}", outlet_degc(&warmer));
}

#[test]
fn surroundings_arrive_late() {
    // The ground rises by 1 K in 100 s; with a lag of 50 s the pipe sees at t = 80 s what the ground was at
    // 30 s: 10.3 degC.
    let schedule = "[[schedule]]\nsignal = \"ground.temperature_k\"\nunit = \"degC\"\n\
                    interpolation = \"linear\"\npoints = [[0, 10], [100, 11]]\n";
    let effect = "[[effect]]\nid = \"P3\"\ncomponent = \"pipe\"\nlag_s = 50\n";
    let late = model(&format!("{schedule}{effect}"));
    let mut simulation = Simulation::new(build(&late).unwrap()).unwrap();
    simulation.advance_to(Time::from_s(80.0).unwrap(), Time::from_s(1.0).unwrap()).unwrap();
    let around = simulation.channel("pipe.surroundings_k_command").unwrap();
    let around_k = simulation.get(around);
    assert!((around_k - 283.45).abs() < 1e-9, "{around_k}");
    // At a constant ground there is nothing to be late.
    let problems = build(&model(effect)).unwrap_err().to_string();
    assert!(problems.contains("lag_s = 50 needs a temperature that changes"), "{problems}");
}

/// Temperature at the outlet over time, degC, from 20 degC everywhere, with 60 degC entering from t = 0 and no
/// heat loss.
fn front(effect: &str, until_s: usize) -> Vec<f64> {
    let text = PIPE
        .replace("initial_degc = 60", "initial_degc = 20")
        .replace("insulation_resistance_k_m_w = 2\n", "");
    let model = Model::from_toml(&format!("{text}{effect}"), Path::new(".")).unwrap();
    let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
    let outlet = simulation.channel("pipe.t_b_k").unwrap();
    let second = Time::from_s(1.0).unwrap();
    let at = |simulation: &mut Simulation, s: usize| {
        simulation.advance_to(Time::from_s(s as f64).unwrap(), second).unwrap();
        simulation.get(outlet) - 273.15
    };
    (0..until_s).map(|s| at(&mut simulation, s)).collect()
}

/// First second at which the outlet is warmer.
fn passes(front: &[f64], degc: f64) -> f64 {
    front.iter().position(|t| *t > degc).unwrap() as f64
}

#[test]
fn a_wall_delays_the_front() {
    // Water 1000 pi/4 0.022^2 100 = 38.013 kg, 380.1 s at 0.1 kg/s. A wall of half the capacity of the
    // water, 0.5 * 380.13 * 4.18 = 794.5 J/(m K), delays the middle of the front to 570.2 s.
    let sharp = front("", 400);
    assert!((passes(&sharp, 40.0) - 380.1).abs() < 2.0);
    let effect = "[[effect]]\nid = \"P1\"\ncomponent = \"pipe\"\nwall_capacity_j_m_k = 794.5\n";
    let late = front(effect, 800);
    assert!((passes(&late, 40.0) / 570.2 - 1.0).abs() < 0.03, "{}", passes(&late, 40.0));
    // A better film rounds less.
    let width = |front: &[f64]| passes(front, 55.0) - passes(front, 25.0);
    let better = front(&format!("{effect}film_factor = 4\n"), 800);
    assert!(width(&better) < 0.8 * width(&late), "{} {}", width(&better), width(&late));
}

#[test]
fn a_standing_pipe_cools_by_its_own_factor() {
    // 2 K m/W * 1588.9 J/(m K) = 3177.9 s: after 1800 s 10 + 50 exp(-0.56641) = 38.378, with a factor 2
    // 26.105 degC. In flow the factor does not count.
    let standing = |effect: &str| {
        let text = PIPE.replace("m_flow_kg_s = 0.1", "m_flow_kg_s = 0");
        let model = Model::from_toml(&format!("{text}{effect}"), Path::new(".")).unwrap();
        let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
        let end = Time::from_s(1800.0).unwrap();
        simulation.advance_to(end, Time::from_s(60.0).unwrap()).unwrap();
        simulation.get(simulation.channel("pipe.t_b_k").unwrap()) - 273.15
    };
    let effect = "[[effect]]\nid = \"P5\"\ncomponent = \"pipe\"\nfactor = 2\n";
    assert!((standing("") - 38.378).abs() < 2e-3, "{}", standing(""));
    assert!((standing(effect) - 26.105).abs() < 2e-3, "{}", standing(effect));
    assert_eq!(outlet_degc(&model(effect)), outlet_degc(&model("")));
}

#[test]
fn dispersion_blurs_the_front() {
    // v = 100 m/380.13 s = 0.26307 m/s; D = 0.05 m2/s: the front arrives with a standard deviation of
    // sqrt(2 D tau)/v = sqrt(2 * 0.05 * 380.13)/0.26307 = 23.44 s, so that 16 % and 84 % of it lie
    // 46.9 s apart.
    let effect = "[[effect]]\nid = \"P7\"\ncomponent = \"pipe\"\ndispersion_m2_s = 0.05\n";
    let blurred = front(effect, 600);
    let (early, late) =
        (passes(&blurred, 20.0 + 0.159 * 40.0), passes(&blurred, 20.0 + 0.841 * 40.0));
    assert!(((late - early) / 46.9 - 1.0).abs() < 0.08, "{early} {late}");
    assert!((passes(&blurred, 40.0) - 380.1).abs() < 4.0, "{}", passes(&blurred, 40.0));
}

#[test]
fn a_missing_piece_delays_without_friction_or_loss() {
    // 10 l at 0.1 kg/s are 100 s: the middle of the front is at the outlet at 380.1 + 100 = 480.1 s. The water is as warm, and the
    // pressure loss that of the pipe.
    let cold = PIPE.replace("initial_degc = 60", "initial_degc = 20");
    let arrives_s = |effect: &str| {
        let model = Model::from_toml(&format!("{cold}{effect}"), Path::new(".")).unwrap();
        let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
        let outlet = simulation.channel("out.t_k").unwrap();
        let second = Time::from_s(1.0).unwrap();
        let mut warm = |s: u32| {
            simulation.advance_to(Time::from_s(f64::from(s)).unwrap(), second).unwrap();
            simulation.get(outlet) > 310.0
        };
        f64::from((0..700).find(|s| warm(*s)).unwrap())
    };
    let piece = "[[effect]]\nid = \"P6\"\ncomponent = \"pipe\"\nvolume_l = 10\n";
    let (before, after) = (arrives_s(""), arrives_s(piece));
    assert!((after - before - 100.0).abs() < 1.5, "{before} {after}");
    let with = steady::solve(&model(piece)).unwrap();
    assert!(with.edge("pipe.piece").unwrap().dp_pa < 1e-3 * dp_pa(&model("")));
    let (with_k, before_k) = (outlet_degc(&model(piece)), outlet_degc(&model("")));
    assert!((with_k - before_k).abs() < 1e-6, "{with_k} {before_k}");
}

#[test]
fn the_ground_takes_heat_up_before_the_loss_is_steady() {
    // Half of 2 K m/W lies before the ground, still at 10 degC: 10 + 50 exp(-100/(1 * 0.1 * 4180)) = 49.361 degC when the front has just
    // passed. The node has 100 kJ/(m K) and follows within 1e5/(1 + 1) = 50000 s; then 54.364 degC, as without it.
    let text = PIPE.replace("initial_degc = 60", "initial_degc = 10");
    let effect = "[[effect]]\nid = \"P4\"\ncomponent = \"pipe\"\ncapacity_j_m_k = 1e5\n";
    let model = Model::from_toml(&format!("{text}{effect}"), Path::new(".")).unwrap();
    let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
    let outlet = simulation.channel("pipe.t_b_k").unwrap();
    let mut degc = |s: f64| {
        let step = Time::from_s(10.0).unwrap();
        simulation.advance_to(Time::from_s(s).unwrap(), step).unwrap();
        simulation.get(outlet) - 273.15
    };
    assert!((degc(500.0) - 49.361).abs() < 0.1, "{}", degc(500.0));
    assert!((degc(400_000.0) - 54.364).abs() < 0.02, "{}", degc(400_000.0));
    let settled = outlet_degc(&self::model(effect));
    // The node has one temperature along the pipe: 0.1 % less loss where the water cools by a tenth.
    let loss_share = (60.0 - settled) / (60.0 - outlet_degc(&self::model("")));
    assert!((loss_share - 0.999).abs() < 2e-4, "{loss_share}");
}

#[test]
fn friction_follows_factor_and_roughness() {
    let before = dp_pa(&model(""));
    let twice = model("[[effect]]\nid = \"P8\"\ncomponent = \"pipe\"\nfactor = 2\n");
    assert!((dp_pa(&twice) / before - 2.0).abs() < 1e-12);
    // 0.05 mm and 0.45 mm more are a pipe with 0.5 mm.
    let deposit =
        model("[[effect]]\nid = \"P8\"\ncomponent = \"pipe\"\nadded_roughness_mm = 0.45\n");
    let text = PIPE.replace("roughness_mm = 0.05", "roughness_mm = 0.5");
    let rough = Model::from_toml(&text, Path::new(".")).unwrap();
    assert!((dp_pa(&deposit) / dp_pa(&rough) - 1.0).abs() < 1e-12);
    assert!(dp_pa(&deposit) > 1.3 * before);
}

#[test]
fn a_longer_pipe_has_more_friction_and_loss() {
    // No fittings: dp goes with the length; the loss of 130 m is that of a factor 1.3.
    let longer = model("[[effect]]\nid = \"P10\"\ncomponent = \"pipe\"\nfactor = 1.3\n");
    assert!((dp_pa(&longer) / dp_pa(&model("")) - 1.3).abs() < 1e-12);
    let lossy = model("[[effect]]\nid = \"P2\"\ncomponent = \"pipe\"\nfactor = 1.3\n");
    assert!((outlet_degc(&longer) - outlet_degc(&lossy)).abs() < 1e-6);
}

#[test]
fn effects_survive_the_plain_form_and_are_cut_out_with_their_pipe() {
    let told = "[[effect]]\nid = \"P10\"\ncomponent = \"pipe\"\nfactor = 1.3\nci95 = [1.2, 1.4]\n\
                because = \"delay 30 % longer\"\n";
    let model = model(told);
    let text = model.to_plain_toml().unwrap();
    let again = Model::from_toml(&text, Path::new(".")).unwrap();
    assert_eq!(again.effects, model.effects);
    assert_eq!(again.effects[0].provenance["because"], json!("delay 30 % longer"));
    assert_eq!(dp_pa(&again).to_bits(), dp_pa(&model).to_bits());
    let part = model.isolate(&["pipe"], &[]).unwrap();
    assert_eq!(part.effects, model.effects);
}

/// Hot and cold water at the same pressure, mixed behind a three-way valve.
const MIXER: &str = r#"
format = 1
[run]
initial_degc = 40
[[node]]
id = "warm"
kind = "pressure_boundary"
pressure_bar = 2
temperature_degc = 60
[[node]]
id = "cool"
kind = "pressure_boundary"
pressure_bar = 2
temperature_degc = 30
[[node]]
id = "mixed"
[[node]]
id = "out"
kind = "pressure_boundary"
pressure_bar = 1
[[three_way_valve]]
id = "mixer"
a = "warm"
b = "cool"
ab = "mixed"
kvs_m3_h = 4
opening = 1
[[edge]]
id = "rest"
kind = "resistance"
from = "mixed"
to = "out"
dp_nominal_bar = 0.5
m_flow_nominal_kg_s = 0.5
"#;

#[test]
fn a_three_way_valve_leaks_its_share() {
    // 0.9 of 60 degC and 0.1 of 30 degC: 57 degC; without the leak 60 degC.
    let mixed_degc = |effect: &str| {
        let model = Model::from_toml(&format!("{MIXER}{effect}"), Path::new(".")).unwrap();
        steady::solve(&model).unwrap().node("mixed").unwrap().t_k - 273.15
    };
    let leaky = mixed_degc("[[effect]]\nid = \"H8\"\ncomponent = \"mixer\"\nshare = 0.1\n");
    assert!((mixed_degc("") - 60.0).abs() < 0.05, "{}", mixed_degc(""));
    assert!((leaky - 57.0).abs() < 0.05, "{leaky}");
}

#[test]
fn a_leak_follows_the_pressure() {
    // 1 g/s at 1 bar is 1.5 g/s at 2.25 bar.
    let text = PIPE.replace("pressure_bar = 1\n", "pressure_bar = 2.25\n");
    let effect = "[[effect]]\nid = \"P11\"\ncomponent = \"out\"\nm_flow_kg_s = 0.001\n";
    let leaky = Model::from_toml(&format!("{text}{effect}"), Path::new(".")).unwrap();
    let lost = steady::solve(&leaky).unwrap().edge("out.leak").unwrap().m_flow_kg_s;
    assert!((lost - 0.0015).abs() < 1e-9, "{lost}");
}

/// An example with one effect.
fn example(name: &str, effect: &str) -> Model {
    let dir = workspace().join("examples").join(name);
    let text = std::fs::read_to_string(dir.join("model.toml")).unwrap();
    let text = format!("{text}\n[[effect]]\n{effect}\n");
    Model::from_toml(&text, &dir).unwrap_or_else(|problems| panic!("{}", problems.render(&text)))
}

/// Parameters of a component of an example once an effect is at work.
fn parameters(name: &str, component: &str, effect: &str) -> Value {
    let model = example(name, &format!("component = \"{component}\"\n{effect}"));
    let model = model.with_effects().unwrap_or_else(|problems| panic!("{problems}"));
    let unit = model.units.iter().find(|unit| unit.id == component);
    let circuit = model.circuits.iter().find(|circuit| circuit.id == component);
    match (unit, circuit) {
        (Some(unit), _) => unit.params.to_value(),
        (_, Some(circuit)) => json!(circuit.branch),
        _ => model.edge(component).unwrap().params.to_value(),
    }
}

#[track_caller]
fn assert_near(value: &Value, expected: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - expected).abs() <= 1e-12 * expected.abs(), "{value} instead of {expected}");
}

#[test]
fn effects_of_units_change_what_they_say() {
    let storage = |effect: &str| parameters("two-pipe", "sf1.storage", effect);
    // 20 W/K, 0.644 W/(m K), no entrainment in the model.
    assert_near(&storage("id = \"T1\"\nfactor = 2.5")["ua_w_k"], 50.0);
    assert_near(&storage("id = \"T2\"\nfactor = 3")["conductivity_w_m_k"], 1.932);
    assert_near(&storage("id = \"T3\"\ndepth_m = 0.1")["entrainment_m"], 0.1);
    let jet = storage("id = \"T4\"\nshare = 0.3\nrichardson = 2");
    assert_near(&jet["jet_share"], 0.3);
    assert_near(&jet["jet_richardson"], 2.0);
    let engine = |effect: &str| parameters("two-pipe", "sf1.chp", effect);
    assert_near(&engine("id = \"G1\"\nfactor = 0.9")["efficiency_factor"], 0.9);
    let part = engine("id = \"G2\"\nfactor_40 = 0.8");
    assert_eq!(part["part_load_factor"], json!([1.0, 0.8, 1.0]));
    // 0.6 MJ in 2400 s of warm-up that falls to nothing are 0.5 kW at its start.
    let start = engine("id = \"G3\"\ntime_factor = 1.2\nenergy_j = 6e5");
    assert_near(&start["start_s"], 990.0);
    assert_near(&start["warm_start_s"], 240.0);
    assert_near(&start["warm_up_w"], 500.0);
    let boiler = parameters(
        "two-pipe",
        "sf1.boiler",
        "id = \"G7\"\ncapacity_j_k = 8000\nconductance_w_k = 150",
    );
    assert_near(&boiler["metal_capacity_j_k"], 8000.0);
    assert_near(&boiler["metal_conductance_w_k"], 150.0);
    let pump = |effect: &str| parameters("heat-pumps", "h3.heat_pump", effect);
    assert_near(&pump("id = \"G6\"\nfactor = 0.91")["aux_rated_w"], 8190.0);
    let ice = pump("id = \"G4\"\nheat_kw = 4\nafter_s = 1800");
    assert_near(&ice["defrost_heat_w"], 4000.0);
    assert_near(&ice["frost_after_s"], 1800.0);
    assert_near(&pump("id = \"G3\"\ntime_factor = 2")["start_times_s"][6], 1200.0);
    let branch = |effect: &str| parameters("two-pipe", "sf1.burner", effect);
    assert_near(&branch("id = \"H1\"\nopening = 0.3")["idle_opening"], 0.3);
    assert_near(&branch("id = \"H2\"\nshare = 0.2")["suction"], 0.2);
    // One that is open is not closed by it.
    let open = parameters("two-pipe", "sf1.engine", "id = \"H1\"\nopening = 0.3");
    assert_near(&open["idle_opening"], 1.0);
}

#[test]
fn effects_of_elements_change_what_they_say() {
    let of = |component: &str, effect: &str| parameters("three-houses", component, effect);
    let head = of("sf1.feed_in_pump", "id = \"H3\"\nfactor = 1")["head_max_pa"].clone();
    let lower = of("sf1.feed_in_pump", "id = \"H3\"\nfactor = 0.8")["head_max_pa"].clone();
    assert_near(&lower, 0.8 * head.as_f64().unwrap());
    let leak = of("sf2.feed_in_check_valve", "id = \"H4\"\nshare = 0.02")["leakage"].clone();
    let tight = of("sf2.feed_in_check_valve", "id = \"H4\"\nshare = 0")["leakage"].clone();
    assert_near(&leak, 0.02 + tight.as_f64().unwrap());
    let clean = of("sf1.heat_exchanger", "id = \"X1\"\nfactor = 1")["ua_w_k"].clone();
    let fouled = of("sf1.heat_exchanger", "id = \"X1\"\nfactor = 0.6")["ua_w_k"].clone();
    assert_near(&fouled, 0.6 * clean.as_f64().unwrap());
}

#[test]
fn effects_of_a_house_do_what_they_say() {
    let run = |effect: &str, until_s: f64| {
        let model = example("two-pipe", effect);
        let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
        let step = Time::from_s(10.0).unwrap();
        simulation.advance_to(Time::from_s(until_s).unwrap(), step).unwrap();
        simulation
    };
    let get = |simulation: &Simulation, name: &str| {
        simulation.get(simulation.channel(&format!("sf1.{name}")).unwrap())
    };
    let plain = "id = \"P10\"\ncomponent = \"pipe\"\nfactor = 1";
    let (before, hour_s) = (run(plain, 3600.0), 3600.0);
    // Fuel goes with 1/eta, heat and electricity stay.
    let worse = run("id = \"G1\"\ncomponent = \"sf1.chp\"\nfactor = 0.8", hour_s);
    let fuel = get(&worse, "chp.fuel_j") / get(&before, "chp.fuel_j");
    assert!((fuel - 1.25).abs() < 1e-9, "{fuel}");
    assert_eq!(get(&worse, "chp.heat_j").to_bits(), get(&before, "chp.heat_j").to_bits());
    // Loss in the first ten seconds: UA (T - T_around) with 20 and 60 W/K.
    let (first, lossy) =
        (run(plain, 10.0), run("id = \"T1\"\ncomponent = \"sf1.storage\"\nfactor = 3", 10.0));
    let loss = get(&lossy, "storage.loss_w") / get(&first, "storage.loss_w");
    assert!((loss - 3.0).abs() < 1e-2, "{loss}");
    // Nothing closes the boiler, as nothing closes the engine: the storage and the two, with 25 times its resistance, share
    // what the heating takes as 1 : 1/5 : 1/5.
    let leaky = example("two-pipe", "id = \"H1\"\ncomponent = \"sf1.burner\"\nopening = 1");
    let mut leaky = Simulation::new(build(&leaky).unwrap()).unwrap();
    for unit in ["chp", "boiler"] {
        let enable = leaky.signal(&format!("sf1.{unit}.enable")).unwrap();
        leaky.set(enable, 0.0).unwrap();
    }
    leaky.advance_to(Time::from_s(3600.0).unwrap(), Time::from_s(10.0).unwrap()).unwrap();
    let boiler = get(&leaky, "boiler.water.m_flow_kg_s");
    let storage = get(&leaky, "storage.point_m_flow_kg_s");
    assert!(storage < 0.0 && (boiler / -storage - 0.2).abs() < 1e-9, "{boiler} {storage}");
}

#[test]
fn effects_name_what_they_cannot_be_of() {
    let refused = |effect: &str| {
        let model = example("two-pipe", effect);
        model.with_effects().unwrap_err().to_string()
    };
    for (effect, message) in [
        (
            "id = \"T1\"\ncomponent = \"sf1.storag\"\nfactor = 2",
            "there is no storage \"sf1.storag\"",
        ),
        ("id = \"T1\"\ncomponent = \"sf1.chp\"\nfactor = 2", "there is no storage \"sf1.chp\""),
        ("id = \"H1\"\ncomponent = \"sf1.tapping\"\nopening = 1", "circuit between two points"),
        ("id = \"H1\"\ncomponent = \"sf1.burner\"\nopening = 1.5", "must lie between 0 and 1"),
        ("id = \"G4\"\ncomponent = \"sf1.chp\"\nheat_w = 1", "there is no air_source_heat_pump"),
        ("id = \"G3\"\ncomponent = \"sf1.boiler\"\nenergy_j = 1", "is of an engine"),
        ("id = \"G7\"\ncomponent = \"sf1.chp\"\ncapacity_j_k = 1", "boiler"),
        ("id = \"H3\"\ncomponent = \"pipe\"\nfactor = 2", "there is no pump \"pipe\""),
        ("id = \"X1\"\ncomponent = \"sf1.chp\"\nfactor = 2", "there is no heat_exchanger"),
    ] {
        let refused = refused(effect);
        assert!(refused.contains(message), "{effect}\n{refused}");
    }
}
