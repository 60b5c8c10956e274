//! Three ways to heat the water of the taps (SC-17): a fresh-water station and a coil at a heating storage, and a tank of
//! its own that the storage charges, with the same draws and the same volume.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::running::get;
use std::path::Path;

const AROUND: &str = r#"format = 1
[run]
until = "3d"
step = "60s"
initial_degc = 60
start = "2023-02-12T23:00:00Z"
[[site]]
id = "h"
[[edge]]
id = "pump"
kind = "pump"
from = "h.cold"
to = "h.hot"
head_max_bar = 0.4
free_flow_l_min = 55
[[edge]]
id = "pipe"
kind = "pipe"
from = "h.hot"
to = "h.cold"
length_m = 100
inner_diameter_mm = 22
[pressure_reference]
node = "h.cold"
[[unit]]
site = "h"
name = "boiler"
kind = "condensing_boiler"
flow_control = "constant_supply"
supply_set_degc = 70
[[circuit]]
site = "h"
id = "charging"
through = ["boiler", "storage.boiler"]
[[controller]]
id = "h.boiler_control"
kind = "two_sensors"
measures_on = "h.storage.t_8_k"
measures_off = "h.storage.t_4_k"
acts_on = "h.boiler.modulation"
on_below_degc = 62
off_above_degc = 62
"#;

/// The heating storage of 1000 l in a and b; in c half of it is a tank of its own.
fn house(variant: char) -> String {
    let storage = |volume_l: f64, ports: &str| {
        format!(
            r#"
[[unit]]
site = "h"
name = "storage"
kind = "storage"
volume_l = {volume_l}
height_m = 1.7
ua_w_k = 5
initial_degc = 65
ports = {{ boiler = {{ inlet_m = 1.6, outlet_m = 0.1 }}{ports} }}
"#
        )
    };
    let water = |heated_by: &str| {
        format!(
            r#"
[[unit]]
site = "h"
name = "water"
kind = "domestic_hot_water"
daily_l = 300
seed = 3
heated_by = "{heated_by}"
"#
        )
    };
    let tapping = |through: &str| {
        format!(
            "\n[[circuit]]\nsite = \"h\"\nid = \"tapping\"\nthrough = [\"water\", \"{through}\"]\n"
        )
    };
    let text = match variant {
        'a' => {
            storage(1000.0, ", tap = { inlet_m = 0.05, outlet_m = 1.65 }")
                + &water("exchanger")
                + &tapping("storage.tap")
        }
        'b' => {
            let coil = "coils = { tap = { area_m2 = 7.1, volume_l = 60, inlet_layer = 1, outlet_layer = 10 } }\n";
            storage(1000.0, "") + coil + &water("passing") + &tapping("storage.tap")
        }
        _ => {
            storage(500.0, ", tank = { inlet_m = 0.1, outlet_m = 1.6 }")
                + r#"
[[unit]]
site = "h"
name = "tank"
kind = "storage"
volume_l = 500
height_m = 1.7
ua_w_k = 3
initial_degc = 60
ports = { tap = { inlet_m = 0.05, outlet_m = 1.65 } }
coils = { heating = { area_m2 = 1.8, volume_l = 11.5, inlet_layer = 8, outlet_layer = 1 } }
[[circuit]]
site = "h"
id = "tank_pump"
through = ["storage.tank", "tank.heating"]
v_flow_l_min = 0
[[controller]]
id = "h.tank_control"
kind = "tank_charging"
measures_tank = "h.tank.t_8_k"
measures_source = "h.storage.t_10_k"
acts_on = "h.tank_pump.v_flow_m3_s"
on_output = 1e-4
off_above_degc = 58
"# + &water("passing")
                + &tapping("tank.tap")
        }
    };
    AROUND.to_owned() + &text
}

/// What the heating side of an installation did: return by flow, degC, heat, J; water drawn, m3; discomfort, K m3; starts
/// of the charging of the tank.
fn run(variant: char) -> (f64, f64, f64, f64, f64) {
    let text = house(variant);
    let model = Model::from_toml(&text, Path::new("."))
        .unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
    let plan = build(&model).unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
    let mut simulation = Simulation::new(plan).unwrap();
    // Where the heat of the water leaves the heating water: the station, the coil of the tank; a coil in the storage
    // cools what stands around its inlet.
    let (flow, back) = match variant {
        'a' => ("h.water.water.m_flow_kg_s", "h.water.t_return_k"),
        'b' => ("h.water.water.m_flow_kg_s", "h.storage.t_1_k"),
        _ => ("h.tank.heating.m_flow_kg_s", "h.tank.heating.t_out_k"),
    };
    let (mut kg, mut kg_k, mut starts, mut flowed) = (0.0, 0.0, 0.0, false);
    let step = Time::from_s(60.0).unwrap();
    for minute in 0..3 * 1440 {
        simulation.advance_to(Time::from_s(60.0 * f64::from(minute + 1)).unwrap(), step).unwrap();
        let m = get(&simulation, flow);
        kg += m;
        kg_k += m * (get(&simulation, back) - 273.15);
        starts += f64::from(u8::from(m > 0.0 && !flowed));
        flowed = m > 0.0;
    }
    assert!(Balances::of(&simulation).units_error() < 1e-9, "{variant}");
    let of = |name: &str| get(&simulation, &format!("h.water.{name}"));
    (kg_k / kg, of("taken_j"), of("drawn_m3"), of("dc_water_k_m3"), starts)
}

#[test]
fn three_installations_with_the_same_draws() {
    let [a, b, c] = ['a', 'b', 'c'].map(run);
    println!("| installation | mean return degC | heat kWh | discomfort K l |");
    println!("|---|---|---|---|");
    for (name, (back_degc, heat_j, _, discomfort_k_m3, _)) in [("a", a), ("b", b), ("c", c)] {
        println!(
            "| {name} | {back_degc:.1} | {:.1} | {:.1} |",
            heat_j / 3.6e6,
            1e3 * discomfort_k_m3
        );
    }
    for (name, installation) in [("a", a), ("b", b), ("c", c)] {
        // The same water, all of it warm.
        assert!(
            (installation.2 - a.2).abs() < 1e-12 && installation.2 > 0.6,
            "{name}: {installation:?}"
        );
        assert_eq!(installation.3, 0.0, "{name}: discomfort {installation:?}");
        assert!(
            (installation.1 / a.1 - 1.0).abs() < 0.01,
            "{name}: {} J of {} J",
            installation.1,
            a.1
        );
    }
    // What docs/src/domestic-hot-water.md says.
    for (name, back_degc, expected_degc) in [("a", a.0, 7.3), ("b", b.0, 32.1), ("c", c.0, 31.8)] {
        let off_k: f64 = back_degc - expected_degc;
        assert!(off_k.abs() < 0.5, "{name}: {back_degc:.2} degC, documented {expected_degc}");
    }
    // The external exchanger sends the coldest water back.
    assert!(a.0 < b.0 && a.0 < c.0, "a {:.1}, b {:.1}, c {:.1} degC", a.0, b.0, c.0);
    assert!(a.0 < 20.0, "{:.1}", a.0);
    // The tank is charged in a few goes a day, not all the time.
    assert!((2.0..40.0).contains(&c.4), "{}", c.4);
}

#[test]
fn heat_cold_and_hot_water_come_from_files() {
    let dir = tempfile::tempdir().unwrap();
    // Heat in kW, cold in W, hot water in l/min, by the hour; heat beyond what the emulator takes is missing.
    let csv = "hour,heat_kW,cold_W,taps\n0,12,0,0\n1,40,3000,6\n2,0,3000,0\n";
    std::fs::write(dir.path().join("loads.csv"), csv).unwrap();
    let text = r#"format = 1
[run]
until = "3h"
step = "60s"
initial_degc = 60
[[site]]
id = "h"
[[edge]]
id = "pipe"
kind = "pipe"
from = "h.hot"
to = "h.cold"
length_m = 100
inner_diameter_mm = 22
[pressure_reference]
node = "h.cold"
[[unit]]
site = "h"
name = "warm"
kind = "storage"
volume_l = 3000
height_m = 2
initial_degc = 70
ports = { heating = { inlet_m = 0.1, outlet_m = 1.9 }, tap = { inlet_m = 0.1, outlet_m = 1.9 } }
[[unit]]
site = "h"
name = "chilled"
kind = "storage"
volume_l = 3000
height_m = 2
initial_degc = 8
ports = { cooling = { inlet_m = 1.9, outlet_m = 0.1 } }
[[unit]]
site = "h"
name = "heat"
kind = "heat_load"
load_max_kw = 30
temperature_difference_k = 20
[[unit]]
site = "h"
name = "cold"
kind = "cooling_load"
temperature_difference_k = 5
[[unit]]
site = "h"
name = "taps"
kind = "domestic_hot_water"
heated_by = "exchanger"
[[circuit]]
site = "h"
id = "heating"
through = ["heat", "warm.heating"]
[[circuit]]
site = "h"
id = "cooling"
through = ["cold", "chilled.cooling"]
[[circuit]]
site = "h"
id = "tapping"
through = ["taps", "warm.tap"]
"#;
    let series = [
        ("heat_kW", "heat.load_w", "kW"),
        ("cold_W", "cold.load_w", "W"),
        ("taps", "taps.v_flow_m3_s", "l/min"),
    ]
    .map(|(column, signal, unit)| {
        format!(
            "[[series]]\nfile = \"loads.csv\"\ncolumn = \"{column}\"\ntime_column = \"hour\"\n\
                 signal = \"h.{signal}\"\nunit = \"{unit}\"\ninterpolation = \"hold\"\n"
        )
    });
    let text = text.to_owned() + &series.concat();
    let model = Model::from_toml(&text, dir.path())
        .unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
    let plan = build(&model).unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
    let mut simulation = Simulation::new(plan).unwrap();
    let (mut heat_j, mut missing_j) = (0.0, 0.0);
    for minute in 1..=180 {
        let end = Time::from_s(60.0 * f64::from(minute)).unwrap();
        simulation.advance_to(end, Time::from_s(60.0).unwrap()).unwrap();
        heat_j -= 60.0 * get(&simulation, "h.heat.q_flow_w");
        missing_j += 60.0 * get(&simulation, "h.heat.unmet_w");
    }
    // 12 + 30 kWh, and 10 kWh that the emulator cannot take.
    assert!((heat_j / 3.6e6 - 42.0).abs() < 1e-6, "{heat_j}");
    assert!((missing_j / 3.6e6 - 10.0).abs() < 1e-6, "{missing_j}");
    // 3 kW for two hours; 6 l/min for one.
    assert!((get(&simulation, "h.cold.cold_j") / 3.6e6 - 6.0).abs() < 1e-6);
    assert!((get(&simulation, "h.taps.drawn_m3") - 0.36).abs() < 1e-9);
    assert!(Balances::of(&simulation).units_error() < 1e-9);
}
