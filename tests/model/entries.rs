//! What a model file can say, used as its author means it.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use serde_json::json;
use std::path::Path;

fn model_in(text: &str, dir: &Path) -> Model {
    Model::from_toml(text, dir).unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn simulation(model: &Model) -> Simulation {
    let plan = build(model).unwrap_or_else(|problems| panic!("{}", problems.render(&model.text)));
    Simulation::new(plan).unwrap()
}

fn get(simulation: &Simulation, channel: &str) -> f64 {
    simulation.get(simulation.channel(channel).unwrap_or_else(|error| panic!("{error}")))
}

fn advance(simulation: &mut Simulation, until_s: f64) {
    simulation.advance_to(Time::from_s(until_s).unwrap(), Time::from_s(1.0).unwrap()).unwrap();
}

/// A 5GDHC pair: a plant whose pump circulates, a house that takes what its load needs.
const WARM_COLD: &str = r#"
format = 1
[run]
initial_degc = 20
start = "2024-01-17T00:00:00+01:00"
[pipe_type.pe40]
inner_diameter_mm = 32.6
roughness_mm = 0.007
insulation_resistance_k_m_w = 1.2
[[site]]
id = "plant"
lines = ["warm", "cold"]
[[site]]
id = "house"
lines = ["warm", "cold"]
[[trench]]
from = "plant"
to = "house"
length_m = 60
pipe = "pe40"
[[station]]
site = "plant"
kind = "producer"
feed_in_pump = { speed = 0.6 }
[[unit]]
site = "plant"
kind = "prescribed_source"
supply_degc = 22
v_flow_l_min = 20
[[station]]
site = "house"
kind = "prescribed_flow"
[[unit]]
site = "house"
name = "load"
kind = "heat_load"
load_kw = 3
temperature_difference_k = 5
v_flow_min_l_min = 0.5
[pressure_reference]
node = "plant.cold"
"#;

#[test]
fn a_heat_load_takes_the_flow_it_needs() {
    let mut simulation = simulation(&model_in(WARM_COLD, Path::new(".")));
    advance(&mut simulation, 3600.0);
    // 3 kW over 5 K: 3000/(4180 * 5) = 0.143541 kg/s, against feed-in
    let flow = get(&simulation, "house.station.m_flow_kg_s");
    assert!((flow + 0.143_541).abs() < 1e-6, "{flow}");
    assert!((get(&simulation, "house.load.q_flow_w") + 3000.0).abs() < 1e-6);
    let cooled = get(&simulation, "house.load.t_in_k") - get(&simulation, "house.load.t_out_k");
    assert!((cooled - 5.0).abs() < 1e-9);
    assert_eq!(get(&simulation, "house.load.unmet_w"), 0.0);
    let balances = Balances::of(&simulation);
    assert!(balances.heat_error() < 1e-9, "{balances:?}");
    // The steady solve finds the same flow.
    let steady = steady::solve(&model_in(WARM_COLD, Path::new("."))).unwrap();
    let edge = steady.edge("house.flow_source").unwrap().m_flow_kg_s;
    assert!((edge + 0.143_541).abs() < 1e-6);
}

#[test]
fn a_return_temperature_is_kept_behind_an_exchanger() {
    let text = WARM_COLD
        .replace("kind = \"prescribed_flow\"", "kind = \"consumer\"")
        .replace("temperature_difference_k = 5", "return_degc = 14\nv_flow_max_l_min = 20")
        .replace("load_kw = 3", "load_kw = 1.5");
    let mut simulation = simulation(&model_in(&text, Path::new(".")));
    advance(&mut simulation, 7200.0);
    let t_out = get(&simulation, "house.load.t_out_k") - 273.15;
    assert!((t_out - 14.0).abs() < 0.02, "{t_out}");
    let (unit, grid) =
        (get(&simulation, "house.load.q_flow_w"), get(&simulation, "house.station.q_flow_w"));
    assert!((unit + 1500.0).abs() < 1.0 && (grid + 1500.0).abs() < 5.0, "{unit} {grid}");
    assert!(Balances::of(&simulation).heat_error() < 1e-9);
}

#[test]
fn series_drive_signals_in_their_units() {
    let dir = tempfile::tempdir().unwrap();
    let csv = "time_s,load_kW,P_pct\n0,3,60\n600,1,80\n1200,2,80\n";
    std::fs::write(dir.path().join("run.csv"), csv).unwrap();
    let series = r#"
[[series]]
file = "run.csv"
column = "load_kW"
signal = "house.load.load_w"
unit = "kW"
interpolation = "linear"
[[series]]
file = "run.csv"
column = "P_pct"
signal = "plant.feed_in_pump.speed"
unit = "percent"
"#;
    let mut simulation = simulation(&model_in(&format!("{WARM_COLD}{series}"), dir.path()));
    advance(&mut simulation, 300.0);
    assert!((get(&simulation, "house.load.load_w_command") - 2000.0).abs() < 1e-9);
    assert!((get(&simulation, "plant.feed_in_pump.speed_command") - 0.6).abs() < 1e-12);
    advance(&mut simulation, 601.0);
    assert!((get(&simulation, "plant.feed_in_pump.speed_command") - 0.8).abs() < 1e-12);
    advance(&mut simulation, 5000.0);
    assert!(
        (get(&simulation, "house.load.load_w_command") - 2000.0).abs() < 1e-9,
        "the last value holds"
    );
}

#[test]
fn series_are_scaled_and_shifted_before_their_unit() {
    let dir = tempfile::tempdir().unwrap();
    // A converter of 30 to 50 Hz over its command, of a pump with its curve at 50 Hz; a meter that counts
    // the heat given off as negative.
    std::fs::write(dir.path().join("run.csv"), "time_s,P_pct,heat_kW\n0,0,-3\n600,50,-2\n")
        .unwrap();
    let series = r#"
[[series]]
file = "run.csv"
column = "P_pct"
signal = "plant.feed_in_pump.speed"
scale = 0.004
offset = 0.6
[[series]]
file = "run.csv"
column = "heat_kW"
signal = "house.load.load_w"
unit = "kW"
scale = -1
interpolation = "linear"
"#;
    let mut simulation = simulation(&model_in(&format!("{WARM_COLD}{series}"), dir.path()));
    advance(&mut simulation, 300.0);
    assert!((get(&simulation, "plant.feed_in_pump.speed_command") - 0.6).abs() < 1e-12);
    assert!((get(&simulation, "house.load.load_w_command") - 2500.0).abs() < 1e-9);
    advance(&mut simulation, 601.0);
    assert!((get(&simulation, "plant.feed_in_pump.speed_command") - 0.8).abs() < 1e-12);
}

#[test]
fn series_with_calendar_times_count_from_the_start_of_the_run() {
    let dir = tempfile::tempdir().unwrap();
    let csv = "when;T\n2024-01-16T23:00:00Z;12\n2024-01-16T23:10:00Z;6\n";
    std::fs::write(dir.path().join("ground.csv"), csv).unwrap();
    let series = r#"
[[series]]
file = "ground.csv"
column = "T"
separator = ";"
signal = "ground.temperature_k"
unit = "degC"
"#;
    let mut simulation = simulation(&model_in(&format!("{WARM_COLD}{series}"), dir.path()));
    advance(&mut simulation, 599.0);
    assert_eq!(get(&simulation, "ground.temperature_k_command"), 285.15);
    advance(&mut simulation, 601.0);
    assert_eq!(get(&simulation, "ground.temperature_k_command"), 279.15);
}

#[test]
fn a_controller_in_the_file_reaches_its_set_point() {
    let controller = r#"
[[controller]]
kind = "pi"
measures = "plant.feed_in_pump.dp_pa"
acts_on = "plant.feed_in_pump.speed"
set_point = -12000
gain = -2e-6
integral_time_s = 10
interval_s = 1
initial_output = 0.6
"#;
    let model = model_in(&format!("{WARM_COLD}{controller}"), Path::new("."));
    let mut simulation = simulation(&model);
    advance(&mut simulation, 1800.0);
    let dp = get(&simulation, "plant.feed_in_pump.dp_pa");
    assert!((dp + 12_000.0).abs() < 20.0, "{dp}");
    let steady = steady::solve(&model).unwrap().edge("plant.feed_in_pump").unwrap().dp_pa;
    assert!((steady + 12_000.0).abs() < 1e-3, "{steady}");
}

#[test]
fn a_second_station_has_its_own_names() {
    let second = r#"
[[station]]
site = "plant"
name = "station2"
kind = "producer"
[[unit]]
site = "plant"
station = "station2"
name = "unit2"
kind = "prescribed_source"
supply_degc = 30
v_flow_l_min = 5
"#;
    let model = model_in(&format!("{WARM_COLD}{second}"), Path::new("."));
    assert!(model.edge("plant.feed_in_pump").is_some());
    assert!(model.edge("plant.station2.feed_in_pump").is_some());
    let unit = model.units.iter().find(|unit| unit.id == "plant.unit2").unwrap();
    assert_eq!(unit.port, "plant.station2.heat_exchanger");
    build(&model).unwrap();
}

#[test]
fn a_model_can_come_as_json_with_the_same_grammar() {
    let value = json!({
        "format": 1,
        "run": { "until": 60 },
        "node": [{ "id": "a" }, { "id": "b" }],
        "edge": [
            { "id": "pump", "kind": "pump", "from": "a", "to": "b",
              "head_max_hpa": 402.21, "free_flow_l_min": 55.33, "speed": 1 },
            { "id": "r", "kind": "resistance", "from": "b", "to": "a", "kv_m3_h": 2.0 }
        ],
        "pressure_reference": { "node": "a", "pressure_bar": 1.5 }
    });
    let model = Model::from_json(&value, Path::new(".")).unwrap();
    assert_eq!(model.run.until.0, Time::from_s(60.0).unwrap());
    assert!(steady::solve(&model).unwrap().edge("pump").unwrap().m_flow_kg_s > 0.1);
    let error = Model::from_json(&json!({ "format": 1, "edges": [] }), Path::new(".")).unwrap_err();
    assert!(error.0[0].hint.as_deref().unwrap().contains("`edge`"), "{error:?}");
}

#[test]
fn a_signal_can_be_taken_over_and_given_back() {
    let schedule =
        "[[schedule]]\nsignal = \"plant.feed_in_pump.speed\"\npoints = [[0, 0.6], [100, 0.8]]\n";
    let mut simulation = simulation(&model_in(&format!("{WARM_COLD}{schedule}"), Path::new(".")));
    let speed = simulation.signal("plant.feed_in_pump.speed").unwrap();
    simulation.set(speed, 0.3).unwrap();
    advance(&mut simulation, 200.0);
    assert!((get(&simulation, "plant.feed_in_pump.speed") - 0.3).abs() < 1e-6);
    simulation.release(speed);
    advance(&mut simulation, 300.0);
    assert!((get(&simulation, "plant.feed_in_pump.speed") - 0.8).abs() < 1e-6);
    assert!(simulation.set(speed, 1.5).is_err());
    let error = simulation.signal("plant.feed_in_pump.sped").unwrap_err().to_string();
    assert!(error.contains("did you mean `plant.feed_in_pump.speed`"), "{error}");
}
