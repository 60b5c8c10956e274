//! Rooms against the validation cases of VDI 6007-1 (`data/vdi6007`), and buildings in models.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use allocation_counter::measure;
use anergy_core::clock::{NS_PER_S, Time};
use anergy_prosumer::building::rc::RcNetwork;
use anergy_prosumer::building::zone::{Element, Zone, ideal_heat_w};
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::pages::write_table;
use anergy_tests::{reference_data, workspace};
use serde_json::Value;
use std::fmt::Write as _;

const DAY_S: f64 = 86_400.0;
const STEP_S: f64 = 60.0;
/// Expected temperatures are rounded to 0.1 K, heats to 1 W.
const TEMPERATURE_K: f64 = 0.1;
const HEAT_W: f64 = 1.0;
/// Film of the inner surfaces of the room, W/(m2 K): 2.7 at walls of 2 * 5 m * 3 m + 3.5 m * 3 m, 1.7 at floor and ceiling of 5 m * 3.5 m,
/// 2.2364 in the mean. The parameter is stated as 2.24, which moves the heat of case 6 by 0.8 W (up to 1.50 W from the table).
const INNER_FILM_W_M2_K: f64 = (2.7 * 40.5 + 1.7 * 35.0) / 75.5;

fn zone(case: &Value) -> (Zone, f64) {
    let number = |name: &str| case["zone_parameters"][name].as_f64().unwrap();
    let inner_film = match number("hConInt") {
        2.24 => INNER_FILM_W_M2_K,
        stated => stated,
    };
    let outer_w_k = case["outdoor"]["hA_ext_W_per_K"].as_f64().unwrap();
    let zone = Zone {
        air_j_k: number("VAir") * 1.2 * 1005.0,
        exterior: Element {
            area_m2: number("AExt"),
            convection_w_m2_k: number("hConExt"),
            resistance_k_w: number("RExt"),
            capacity_j_k: number("CExt"),
        },
        outside_k_w: number("RExtRem") + 1.0 / outer_w_k,
        interior: Element {
            area_m2: number("AInt"),
            convection_w_m2_k: inner_film,
            resistance_k_w: number("RInt"),
            capacity_j_k: number("CInt"),
        },
        radiation_w_m2_k: number("hRad"),
    };
    (zone, number("T_start"))
}

/// A daily table: the value from `t_s` on, for a step that begins at `t_s`.
fn held(table: &Value, t_s: f64) -> f64 {
    let rows = table.as_array().unwrap();
    // A set point that changes 0.1 s after the hour changes at the hour.
    let day_s = t_s % DAY_S + 0.5;
    let row = rows.iter().rev().find(|row| row[0].as_f64().unwrap() <= day_s).unwrap();
    row[1].as_f64().unwrap()
}

/// Hourly means over `(t - 3600 s, t]`: temperature of the air in degC, or heat of the heater in W.
fn simulate(case: &Value) -> Vec<f64> {
    let (zone, start_k) = zone(case);
    let radiative = if case["internal_gain"]["kind"] == "radiative" { 1.0 } else { 0.0 };
    let mut network = RcNetwork::default();
    let nodes = zone.put(&mut network, 0);
    nodes.gain(&mut network, 1, radiative);
    nodes.gain(&mut network, 2, 0.0);
    network.observe(0, nodes.air, 1.0);
    let model = network.model::<3, 3, 1>().unwrap();
    let mut t_k = vec![start_k; model.nodes()];
    let limit_w = case["actuator"]["limit_W"].as_f64().unwrap_or(f64::INFINITY);
    let last_s = case["expected"]["table_s_value"].as_array().unwrap().last().unwrap()[0].as_f64();
    let mut hours = vec![0.0; (last_s.unwrap() / 3600.0) as usize];
    let per_hour = (3600.0 / STEP_S) as usize;
    for step in 0..hours.len() * per_hour {
        let t_s = step as f64 * STEP_S;
        let gain_w = held(&case["internal_gain"]["periodic_table_s_W"], t_s);
        let outdoor_k = case["outdoor"]["T_K"].as_f64().unwrap();
        let mut running = model.begin(STEP_S, &t_k, [outdoor_k, gain_w, 0.0]);
        let mut heat_w = 0.0;
        if let Some(table) = case["setpoint"].get("periodic_table_s_degC") {
            let set_k = held(table, t_s) + 273.15;
            let rise = model.response(&running, 0, 2);
            heat_w = ideal_heat_w(set_k, model.mean(&running, 0), rise, (-limit_w, limit_w));
            model.add(&mut running, 2, heat_w);
        }
        let air_k = model.finish(&running, &mut t_k)[0];
        let value = if case.get("setpoint").is_some() { heat_w } else { air_k - 273.15 };
        hours[step / per_hour] += value / per_hour as f64;
    }
    hours
}

/// Numbers of the cases, and what they are.
const CASES: [(&str, &str); 5] = [
    ("01", "heavy room, convective gain"),
    ("02", "heavy room, radiative gain"),
    ("03", "light room, convective gain"),
    ("06", "heater without limit, set point 22/27 degC"),
    ("07", "heater of 500 W"),
];

#[test]
fn cases_of_the_guideline() {
    let Some(folder) = reference_data("vdi6007") else { return };
    let mut table = "| case | compared | hours | largest difference | mean difference |\n\
                     |---|---|---|---|---|\n"
        .to_owned();
    for (number, name) in CASES {
        let text = std::fs::read_to_string(folder.join(format!("testcase{number}.json"))).unwrap();
        let case: Value = serde_json::from_str(&text).unwrap();
        let hours = simulate(&case);
        let heat = case.get("setpoint").is_some();
        // The table of case 6 counts heat that leaves the room.
        let sign = if number == "06" { -1.0 } else { 1.0 };
        let mut differences = Vec::new();
        for row in case["expected"]["table_s_value"].as_array().unwrap() {
            let (t_s, expected) = (row[0].as_f64().unwrap(), row[1].as_f64().unwrap());
            if t_s > 0.0 {
                let got = sign * hours[(t_s / 3600.0).round() as usize - 1];
                differences.push((t_s, got - expected));
            }
        }
        assert_eq!(differences.len(), 72, "case {number}");
        let largest = differences
            .iter()
            .fold((0.0, 0.0_f64), |a, b| if b.1.abs() > a.1.abs() { *b } else { a });
        let mean = differences.iter().map(|d| d.1).sum::<f64>() / 72.0;
        let (what, unit, limit) =
            if heat { ("heat", "W", HEAT_W) } else { ("air temperature", "K", TEMPERATURE_K) };
        let _ = writeln!(
            table,
            "| {number} {name} | {what} | 72 | {:.3} {unit} at hour {} | {mean:.3} {unit} |",
            largest.1,
            largest.0 / 3600.0
        );
        assert!(largest.1.abs() <= limit, "case {number}: {largest:?}");
    }
    write_table("building", "cases", "cargo test --workspace --test prosumers building::", &table);
}

/// Two houses beside a pipe that only makes a network of it: one heated from a boiler, one cooled from a chiller.
const HOUSES: &str = r#"
format = 1

[[node]]
id = "in"
kind = "pressure_boundary"
pressure_bar = 2.0
temperature_degc = 50

[[node]]
id = "out"
kind = "source"
m_flow_kg_s = -0.01

[[edge]]
id = "pipe"
kind = "pipe"
from = "in"
to = "out"
length_m = 100
inner_diameter_mm = 20

[[unit]]
id = "boiler"
kind = "heat_source"
supply_degc = 60

[[circuit]]
id = "radiators"
through = ["boiler", "warm.heating"]

[[unit]]
id = "warm"
kind = "building"
construction = "until_2001"
emitter = "radiator"
heating_w_m2 = 45
night_set_degc = 18

[[unit]]
id = "chiller"
kind = "heat_source"
supply_degc = 15

[[circuit]]
id = "floor"
through = ["chiller", "cool.cooling"]

[[unit]]
id = "cool"
kind = "building"
construction = "enev_2016"
outdoor_degc = 22
ground_degc = -1
initial_living_degc = 23
heating = false
cooling = true

[[schedule]]
signal = "warm.outdoor_k"
unit = "degc"
interpolation = "linear"
points = [[0, -5], [43200, 3], [86400, -5]]

[[schedule]]
signal = "cool.appliances_w"
interpolation = "hold"
points = [[0, 4000], [46800, 0]]
"#;

fn houses() -> Simulation {
    simulation(HOUSES)
}

fn simulation(text: &str) -> Simulation {
    let model = Model::from_toml(text, &workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)));
    Simulation::new(build(&model).unwrap()).unwrap()
}

fn seconds(s: i64) -> Time {
    Time(s * NS_PER_S)
}

#[test]
fn houses_in_circuits_hold_their_rooms() {
    let mut simulation = houses();
    let get =
        |simulation: &Simulation, name: &str| simulation.get(simulation.channel(name).unwrap());
    let (mut set_points, mut rooms) = (Vec::new(), Vec::new());
    for hour in 1..=24 {
        simulation.advance_to(seconds(3600 * hour), seconds(60)).unwrap();
        set_points.push(get(&simulation, "warm.set_k"));
        rooms.push((get(&simulation, "warm.t_room_k"), get(&simulation, "cool.t_room_k")));
        let (boiler_w, house_w) =
            (get(&simulation, "boiler.q_flow_w"), get(&simulation, "warm.heating_w"));
        assert!((boiler_w - house_w).abs() < 1e-6 && (hour != 12 || boiler_w > 2000.0));
    }
    // At night 18 degC at most: the house cools, slowly; by day it is 21 degC within the band, at noon also within
    // 0.5 K of it. The cooled house stays at 23 degC - 0.5 + 1.5 K.
    assert_eq!((set_points[4], set_points[11], set_points[23]), (291.15, 294.15, 291.15));
    assert!(rooms[5].0 < 294.15 && rooms[5].0 > 291.15, "{rooms:?}");
    assert!((rooms[20].0 - 294.15).abs() < 0.5, "{rooms:?}");
    assert!(rooms[..13].iter().all(|room| (295.65..297.65).contains(&room.1)), "{rooms:?}");
    let error = Balances::of(&simulation).heat_error();
    assert!(error < 1e-9, "{error}");
    // At rest: 74 (walls) + 85 (windows) + 157 (air) + 42 (ceiling) + 50 (floor) = 408 W/K times 21.5 K less 660 W of
    // people are 8.1 kW, 195 kWh in a day; the run begins with all walls at 21 degC, which brings a part of it.
    let heat_kwh = get(&simulation, "warm.heat_j") / 3.6e6;
    assert!((150.0..195.0).contains(&heat_kwh), "{heat_kwh}");
    assert!(get(&simulation, "cool.cold_j") > 3.6e6 && get(&simulation, "cool.dc_cool_k_s") == 0.0);
}

#[test]
fn houses_continue_bit_for_bit_and_allocate_nothing() {
    let mut simulation = houses();
    simulation.advance_to(seconds(7200), seconds(60)).unwrap();
    let here = simulation.snapshot();
    let row = |simulation: &mut Simulation| {
        let mut row = vec![0.0; simulation.plan().channels().len()];
        simulation.fill_row(&mut row);
        row.iter().map(|value| value.to_bits()).collect::<Vec<_>>()
    };
    simulation.advance_to(seconds(9000), seconds(60)).unwrap();
    let first = row(&mut simulation);
    simulation.restore(&here).unwrap();
    simulation.advance_to(seconds(9000), seconds(60)).unwrap();
    assert_eq!(row(&mut simulation), first);
    simulation.take_events();
    let found = measure(|| simulation.advance_to(seconds(12_600), seconds(60)).unwrap());
    assert_eq!((simulation.take_events().count(), found.count_total), (0, 0));
}

#[test]
fn houses_stand_in_the_weather() {
    // Sun of 500 W/m2 in the south, 30 deg up, over 100 W/m2 of the sky: the front of the house (sides 1 : 1.25, so 5/9 of
    // the walls are front and back) gets 433 W/m2. Mean 5/18 * 433.01 + 50 + 35 = 205.28 W/m2 on 45 m2 of windows, of
    // which 0.6 * 0.7 comes in: 3879.8 W. What a schedule drives does not follow the weather.
    let after = |t_outdoor_degc: f64| {
        let weather = format!(
            "[weather]\nkind = \"constant\"\nt_outdoor_degc = {t_outdoor_degc:?}\nbeam_normal_w_m2 = 500\n\
             diffuse_horizontal_w_m2 = 100\nglobal_horizontal_w_m2 = 350\nsun_elevation_deg = 30\n"
        );
        let mut simulation = simulation(&format!("{HOUSES}\n{weather}"));
        simulation.advance_to(seconds(60), seconds(60)).unwrap();
        let get = |name: &str| simulation.get(simulation.channel(name).unwrap());
        for house in ["warm", "cool"] {
            let sun_w = get(&format!("{house}.sun_w"));
            assert!((sun_w - 3879.8).abs() < 0.1, "{house}: {sun_w}");
        }
        (get("warm.loss_w"), get("cool.loss_w"))
    };
    let ((warm, cool), (same, more)) = (after(17.0), after(7.0));
    assert!(warm == same && more > cool + 1000.0, "{warm} {same}, {cool} {more}");
}
