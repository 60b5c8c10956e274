//! Weather in models: what the signals `weather.*` are in a run, who follows them, and who takes them over.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::{NS_PER_S, Time};
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::running::get;
use anergy_tests::workspace;
use std::path::Path;

/// A plant whose supply temperature follows the weather, and a house.
const GRID: &str = r#"
[[site]]
id = "plant"
[[site]]
id = "house"
[[trench]]
from = "plant"
to = "house"
length_m = 50
pipe = "PE100 SDR11 32"
[[station]]
site = "plant"
kind = "plant"
outdoor_curve_degc = [[-20, 80], [40, 50]]
return_pressure_bar = 2
circulation_pump = { head_max_bar = 1, free_flow_m3_h = 6 }
[[station]]
site = "house"
kind = "prescribed_flow"
[[unit]]
site = "house"
kind = "heat_load"
load_kw = 4
temperature_difference_k = 20
"#;

fn text(run: &str, weather: &str) -> String {
    format!(
        "format = 1\n[run]\nuntil = \"1d\"\nstep = \"60s\"\n{run}\n[weather]\n{weather}\n{GRID}"
    )
}

fn read(text: &str, folder: &Path) -> Model {
    Model::from_toml(text, folder).unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn started(model: &Model) -> Simulation {
    Simulation::new(build(model).unwrap_or_else(|problems| panic!("{problems}"))).unwrap()
}

fn advance(simulation: &mut Simulation, until_s: i64, step_s: i64) {
    simulation.advance_to(Time(until_s * NS_PER_S), Time(step_s * NS_PER_S)).unwrap();
}

/// Quarters of an hour of two June days, times of their ends, with temperatures that rise and a global irradiance.
fn quarters() -> (String, Vec<f64>) {
    let mut csv =
        String::from("time,t_outdoor_degc,global_horizontal_w_m2,relative_humidity_percent\n");
    let mut global = Vec::new();
    for quarter in 1..=192 {
        let (day, of_day) = ((quarter - 1) / 96, (quarter - 1) % 96 + 1);
        // Highest at noon of summer time, up from 6:00 to 18:00.
        let sun =
            (800.0 * (std::f64::consts::PI * (f64::from(of_day) / 48.0 - 1.0)).cos()).max(0.0);
        let sun = (sun * 10.0).round() / 10.0;
        global.push(sun);
        let (hour, minute) = (of_day / 4, of_day % 4 * 15);
        let (date, hour) = if hour == 24 { (21 + day, 0) } else { (20 + day, hour) };
        let t = 10.0 + 0.1 * f64::from(quarter);
        csv += &format!("2024-06-{date:02} {hour:02}:{minute:02},{t:.1},{sun},55\n");
    }
    (csv, global)
}

const START: &str = "start = \"2024-06-20T00:00:00+02:00\"";
/// Local times of a file are those of summer here, on purpose.
const FILE: &str =
    "file = \"quarters.csv\"\nlatitude_deg = 48.14\nlongitude_deg = 11.58\nutc_offset_h = 2";

#[test]
fn energy_of_a_file_is_that_of_the_run_at_any_step() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, global) = quarters();
    std::fs::write(folder.path().join("quarters.csv"), csv).unwrap();
    let model = read(&text(START, FILE), folder.path());
    let wanted_j: f64 = global[..96].iter().sum::<f64>() * 900.0;
    for step_s in [60, 420, 900, 3600, 5000] {
        let mut simulation = started(&model);
        let (mut sum_j, mut beam_j) = (0.0, 0.0);
        while simulation.time() < Time(86_400 * NS_PER_S) {
            let before = simulation.time();
            let end = before.next_multiple(Time(step_s * NS_PER_S)).min(Time(86_400 * NS_PER_S));
            simulation.advance_to(end, Time(step_s * NS_PER_S)).unwrap();
            let dt_s = (simulation.time() - before).as_s();
            sum_j += get(&simulation, "weather.global_horizontal_w_m2") * dt_s;
            beam_j += get(&simulation, "weather.beam_normal_w_m2") * dt_s;
        }
        assert!((sum_j / wanted_j - 1.0).abs() < 1e-12, "{step_s} s: {sum_j} {wanted_j}");
        assert!(beam_j > 1e7, "{beam_j}");
        // 24:00, the 96th point.
        assert!((get(&simulation, "weather.t_outdoor_k") - (273.15 + 19.6)).abs() < 1e-9);
        assert!((get(&simulation, "weather.relative_humidity") - 0.55).abs() < 1e-12);
    }
}

#[test]
fn units_follow_and_what_drives_a_signal_wins() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("quarters.csv"), quarters().0).unwrap();
    let curve_k = |t_degc: f64| 273.15 + 80.0 - (t_degc + 20.0) / 60.0 * 30.0;
    let mut simulation = started(&read(&text(START, FILE), folder.path()));
    advance(&mut simulation, 3600, 60);
    // 01:00 is 10.4 degC; the plant follows it: 80 - 30.4/60 30 = 64.8 degC.
    assert!((get(&simulation, "weather.t_outdoor_k") - 283.55).abs() < 1e-9);
    assert!((get(&simulation, "plant.unit.supply_set_k") - curve_k(10.4)).abs() < 1e-9);
    // Taken over and given back.
    let outdoor = simulation.signal("weather.t_outdoor_k").unwrap();
    simulation.set(outdoor, 263.15).unwrap();
    advance(&mut simulation, 3660, 60);
    assert!((get(&simulation, "plant.unit.supply_set_k") - curve_k(-10.0)).abs() < 1e-9);
    simulation.release(outdoor);
    advance(&mut simulation, 7200, 60);
    assert!((get(&simulation, "plant.unit.supply_set_k") - curve_k(10.8)).abs() < 1e-9);
    // A schedule drives the weather, another one a unit.
    let schedule = |signal: &str| {
        let drive =
            format!("\n[[schedule]]\nsignal = \"{signal}\"\nunit = \"degC\"\npoints = [[0, 0]]\n");
        let mut simulation = started(&read(&(text(START, FILE) + &drive), folder.path()));
        advance(&mut simulation, 3600, 60);
        (get(&simulation, "weather.t_outdoor_k"), get(&simulation, "plant.unit.supply_set_k"))
    };
    assert_eq!(schedule("weather.t_outdoor_k"), (273.15, curve_k(0.0)));
    let (outdoor_k, supply_k) = schedule("plant.unit.outdoor_k");
    assert!((outdoor_k - 283.55).abs() < 1e-9 && (supply_k - curve_k(0.0)).abs() < 1e-9);
}

#[test]
fn a_pipe_above_the_ground_lies_in_the_air_of_the_weather() {
    let lost_w = |t_degc: f64| {
        let grid = "[[node]]\nid = \"in\"\nkind = \"source\"\nm_flow_kg_s = 0.5\ntemperature_degc = 60\n\
            [[node]]\nid = \"out\"\nkind = \"pressure_boundary\"\npressure_bar = 1\n[[edge]]\nid = \"pipe\"\n\
            kind = \"pipe\"\nfrom = \"in\"\nto = \"out\"\nlength_m = 10\ninner_diameter_mm = 28.5\n\
            outer_diameter_mm = 33.7\ncasing_diameter_mm = 110\nlaying = \"above_ground\"\n";
        let text = format!(
            "format = 1\n[weather]\nkind = \"constant\"\nt_outdoor_degc = {t_degc}\n{grid}"
        );
        let model = read(&text, Path::new("."));
        let mut simulation = started(&model);
        steady::settle(&mut simulation).unwrap();
        get(&simulation, "pipe.q_loss_w")
    };
    // In proportion to the difference from some 60 degC: 60 K and 40 K (the air film is that of 10 degC).
    assert!((lost_w(0.0) / lost_w(20.0) - 1.5).abs() < 2e-3, "{} {}", lost_w(0.0), lost_w(20.0));
    assert!(lost_w(0.0) > 50.0);
}

#[test]
fn controllers_measure_the_weather() {
    // A two-point controller on the outdoor temperature: the pump runs below 15 degC.
    let control = "\n[[controller]]\nkind = \"hysteresis\"\nmeasures = \"weather.t_outdoor_k\"\n\
        acts_on = \"house.unit.load_w\"\nset_point = 285.15\nband = 0.5\non_output = 5000\n\
        off_output = 1000\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("quarters.csv"), quarters().0).unwrap();
    let model = read(&(text(START, FILE) + control), folder.path());
    let mut simulation = started(&model);
    advance(&mut simulation, 3600, 60);
    assert_eq!(get(&simulation, "house.unit.load_w_command"), 5000.0);
    // 06:00 has 12.4 degC.
    advance(&mut simulation, 21_600, 60);
    assert_eq!(get(&simulation, "house.unit.load_w_command"), 1000.0);
}

#[test]
fn solve_takes_the_weather_of_the_start() {
    let made = |start: &str| {
        let run = format!("start = \"{start}\"");
        let model = read(&text(&run, "kind = \"synthetic\"\nseed = 5"), Path::new("."));
        let t_k = get(&started(&model), "weather.t_outdoor_k");
        let supply_k = steady::solve(&model).unwrap().node("plant.hot").unwrap().t_k;
        // 80 degC - (t + 20 K) 30/60
        assert!((supply_k - (353.15 - 0.5 * (t_k - 253.15))).abs() < 1e-6, "{t_k} {supply_k}");
        t_k
    };
    // Any year, the same date: a synthetic year has no year of its own. 29 February is the leap year's.
    assert_eq!(made("2024-07-15T12:00:00+01:00"), made("1999-07-15T12:00:00+01:00"));
    assert!(made("2024-07-15T14:00:00+01:00") > made("2024-01-15T14:00:00+01:00"));
    made("2024-02-29T00:30:00+01:00");
}

#[test]
fn constant_weather_needs_no_date() {
    let weather =
        "kind = \"constant\"\nt_outdoor_degc = -5\nbeam_normal_w_m2 = 500\nsun_elevation_deg = 30";
    let mut simulation = started(&read(&text("", weather), Path::new(".")));
    advance(&mut simulation, 600, 60);
    assert_eq!(get(&simulation, "weather.t_outdoor_k"), 268.15);
    assert_eq!(get(&simulation, "weather.beam_normal_w_m2"), 500.0);
    assert!(
        (get(&simulation, "weather.sun_elevation_rad") - std::f64::consts::FRAC_PI_6).abs() < 1e-9
    );
    // 80 - 15/60 30 = 72.5 degC
    assert!((get(&simulation, "plant.unit.supply_set_k") - 345.65).abs() < 1e-9);
}

#[test]
fn a_run_goes_on_bit_for_bit_and_does_not_outlive_its_weather() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("quarters.csv"), quarters().0).unwrap();
    let model = read(&text(START, FILE), folder.path());
    let mut whole = started(&model);
    advance(&mut whole, 40_000, 70);
    let here = whole.snapshot();
    advance(&mut whole, 80_000, 70);
    let mut other = started(&model);
    other.restore(&here).unwrap();
    advance(&mut other, 80_000, 70);
    assert_eq!(whole.state(), other.state());
    // Two days are in the file; stepped on by hand it is an error and not a made-up weather.
    advance(&mut whole, 172_800, 600);
    let error = whole.advance_to(Time(173_000 * NS_PER_S), Time(60 * NS_PER_S)).unwrap_err();
    assert!(error.to_string().contains("the file of [weather] ends here"), "{error}");
    assert_eq!(whole.time(), Time(172_800 * NS_PER_S));
}

#[test]
fn the_expanded_model_is_the_same() {
    let model = read(
        &text(START, "kind = \"synthetic\"\nmean_degc = 8\nlatitude_deg = 55"),
        Path::new("."),
    );
    let plain = model.to_plain_toml().unwrap();
    let again = read(&plain, Path::new("."));
    assert_eq!(model.weather, again.weather);
    let defaults = model.defaults();
    let of = |field: &str| defaults.iter().any(|d| d.component == "weather" && d.field == field);
    assert!(of("amplitude_k") && !of("mean_k") && !of("separator"), "{defaults:?}");
}

/// `examples/weather`.
#[test]
fn the_example_runs_its_week() {
    let folder = workspace().join("examples/weather");
    let model = read(&std::fs::read_to_string(folder.join("model.toml")).unwrap(), &folder);
    let mut simulation = started(&model);
    let (mut sum, mut coldest, mut warmest) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
    let mut global_kwh = 0.0;
    for hour in 1..=168 {
        advance(&mut simulation, hour * 3600, 300);
        let t_degc = get(&simulation, "weather.t_outdoor_k") - 273.15;
        sum += t_degc / 168.0;
        (coldest, warmest) = (t_degc.min(coldest), t_degc.max(warmest));
        global_kwh += get(&simulation, "weather.global_horizontal_w_m2") / 1000.0;
        let supply_k = get(&simulation, "plant.unit.supply_set_k");
        let curve_k = 348.15 - 15.0 / 25.0 * (t_degc + 10.0).clamp(0.0, 25.0);
        assert!((supply_k - curve_k).abs() < 1e-9, "{hour} h: {supply_k} {curve_k}");
    }
    // The ground of the weather is that of the year: 1 m deep on 22 January some 4 degC.
    let ground_k = get(&simulation, "weather.t_ground_k");
    assert!((ground_k - 277.15).abs() < 1.0, "{ground_k}");
    assert_eq!(ground_k, get(&simulation, "ground.temperature_k_command"));
    // January: around -0.5 degC, with 4 K up and down in a day and 3.5 K of weather; some 1 kWh/m2 of sun a day.
    assert!((-8.0..7.0).contains(&sum), "{sum}");
    assert!(warmest - coldest > 8.0 && warmest < 15.0 && coldest > -20.0, "{coldest} {warmest}");
    assert!((1.5..15.0).contains(&global_kwh), "{global_kwh}");
    // The last hour of Sunday: 5.05 kW in the series.
    assert!((get(&simulation, "h1.unit.q_flow_w") + 5050.0).abs() < 60.0);
}
