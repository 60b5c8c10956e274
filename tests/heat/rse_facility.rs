//! The district heating test facility of RSE (Milan), measured in four tests, beside `examples/rse-facility`.
//!
//! The model is driven by the commands and by what was measured at its cuts (see the README of the example);
//! flows, pressures and temperatures of the network are results. The same model without heat loss and delay,
//! and with pipes that have no pressure loss either, shows what the pipes contribute; without the resistances
//! calibrated on one test it shows what the documented parameters say alone.
//!
//! `make test` runs the two shortest tests in coarse steps; `RSE_TESTS=all` (`make validate`) all four with
//! the tables of `docs/src/validation/rse_facility.md`; `RSE_OUT=folder` also leaves the curves.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use anergy_core::clock::Time;
use anergy_network::elements::ElementParams;
use anergy_network::elements::pipe::PipeParams;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use anergy_simulation::simulation::Simulation;
use anergy_tests::pages::write_table;
use anergy_tests::{reference_data, workspace};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;

/// The tests of January 2024; the resistances of the example are from the last one.
const TESTS: [&str; 4] = ["rse_1701_test1", "rse_2401_test2", "rse_2601_test1", "rse_3001_test1"];
/// The ones that are short.
const SHORT: [&str; 2] = ["rse_1701_test1", "rse_3001_test1"];
const IN_THE_FILE: &str = "rse_3001_test1";
const LOADS: [&str; 4] = ["701", "711", "721", "731"];
/// Compared from here on, s: until then the water that was in the pipes at the start leaves them.
const FROM_S: f64 = 300.0;
/// Largest step when all is compared, and in the short run, s.
const STEPS_S: (f64, f64) = (2.0, 10.0);
/// Density of the model, kg/m3, for the volume flows of the meters.
const DENSITY: f64 = 980.0;
/// Darcy friction per bore of the pipes, 1/m: `0.016/0.051`.
const FRICTION_PER_M: f64 = 0.016 / 0.051;
/// A mean error beyond this is discussed on the page, %.
const DISCUSSED_PERCENT: f64 = 10.0;

/// What a meter reads: its column and the channel of the model.
struct Sensor {
    column: String,
    channel: String,
}

impl Sensor {
    fn new(column: &str, channel: &str) -> Self {
        Self { column: column.to_owned(), channel: channel.to_owned() }
    }

    /// The reading of the model in the unit of the column.
    fn reading(&self, value: f64) -> f64 {
        match self.column.split_once('_').unwrap().1 {
            "m3_h" => value / DENSITY * 3600.0,
            "bar" => value / 1e5,
            "degC" => value - 273.15,
            other => panic!("{other}"),
        }
    }
}

fn sensors() -> Vec<Sensor> {
    let mut all = vec![Sensor::new("FT901_m3_h", "p901.m_flow_kg_s")];
    let of_loads = |column: &dyn Fn(&str) -> String, channel: &dyn Fn(&str) -> String| {
        LOADS.map(|load| Sensor::new(&column(load), &channel(load)))
    };
    let tag = |kind: &'static str, end: &'static str| {
        move |load: &str| {
            let unit = if kind == "PT" { "bar" } else { "degC" };
            format!("{kind}{}{end}_{unit}", &load[..2])
        }
    };
    all.extend(of_loads(&|load| format!("FT{load}_m3_h"), &|load| format!("ft{load}.m_flow_kg_s")));
    all.push(Sensor::new("FTA12_m3_h", "fta12.m_flow_kg_s"));
    all.extend(of_loads(&tag("TT", "2"), &|load| format!("e{load}.hot.t_k")));
    all.extend(of_loads(&tag("TT", "1"), &|load| format!("e{load}.cold.t_k")));
    all.extend(of_loads(&tag("TT", "4"), &|load| format!("e{load}.cooling_out.t_k")));
    all.push(Sensor::new("TT901_degC", "s900.cold.t_k"));
    all.push(Sensor::new("PT902_bar", "s900.hot.p_pa"));
    all.extend(of_loads(&tag("PT", "2"), &|load| format!("e{load}.hot.p_pa")));
    all.extend(of_loads(&tag("PT", "1"), &|load| format!("e{load}.cold.p_pa")));
    all.push(Sensor::new("PTA20_bar", "c02.hot.p_pa"));
    all.push(Sensor::new("PTA19_bar", "c02.cold.p_pa"));
    all
}

/// The record of a test by the names of its columns.
struct Record(HashMap<String, Vec<f64>>);

impl Record {
    fn read(file: &Path) -> Self {
        let mut reader = csv::Reader::from_path(file).unwrap();
        let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
        let mut columns = vec![Vec::new(); names.len()];
        for row in reader.records().map(Result::unwrap) {
            for (column, cell) in columns.iter_mut().zip(&row) {
                column.push(cell.parse().unwrap());
            }
        }
        Self(names.into_iter().zip(columns).collect())
    }

    fn column(&self, name: &str) -> &[f64] {
        self.0.get(name).unwrap_or_else(|| panic!("the record has no {name}"))
    }
}

/// The example with the series of a test, its pipes at the temperatures of its first row.
fn model(data: &Path, test: &str, record: &Record) -> Model {
    let file = workspace().join("examples/rse-facility/model.toml");
    let text = std::fs::read_to_string(file).unwrap().replace(IN_THE_FILE, test);
    let model = Model::from_toml(&text, data)
        .unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
    let first = |column: &str| record.column(column)[0] + 273.15;
    let warm = pipes(&model, |id, _| {
        let hot = id.ends_with(".hot") || id.ends_with(".feed");
        let t_k = first(if hot { "TT902_degC" } else { "TT901_degC" });
        vec![("initial_k", json!(t_k))]
    });
    model.with(&warm).unwrap()
}

/// Changes of all pipes, from name and parameters.
fn pipes(
    model: &Model,
    fields: impl Fn(&str, &PipeParams) -> Vec<(&'static str, Value)>,
) -> Vec<Change> {
    let mut changes = Vec::new();
    for edge in &model.edges {
        let ElementParams::Pipe(pipe) = &edge.params else { continue };
        changes.extend(fields(&edge.id, pipe).into_iter().map(|(field, value)| Change::Set {
            parameter: format!("{}.{field}", edge.id),
            value,
        }));
    }
    assert!(changes.len() >= 32, "{} changes of pipes", changes.len());
    changes
}

/// The same hydraulics without heat loss and without water in the pipes.
fn without_loss_and_delay(model: &Model) -> Model {
    let changes = pipes(model, |_, pipe| {
        vec![
            ("length_m", json!(1e-3)),
            ("zeta", json!(pipe.zeta + FRICTION_PER_M * pipe.length_m)),
            ("insulation_resistance_k_m_w", json!(1e9)),
        ]
    });
    model.with(&changes).unwrap()
}

/// Pipes that only connect: no pressure loss either.
fn with_ideal_pipes(model: &Model) -> Model {
    let bare = without_loss_and_delay(model);
    let changes = pipes(&bare, |_, _| vec![("zeta", json!(0.0))]);
    bare.with(&changes).unwrap()
}

/// Pipes with another heat resistance, K m/W.
fn insulated(model: &Model, resistance_k_m_w: f64) -> Model {
    let changes =
        pipes(model, |_, _| vec![("insulation_resistance_k_m_w", json!(resistance_k_m_w))]);
    model.with(&changes).unwrap()
}

/// Only documented parameters: no fittings, no further resistance of the loads, the rangeability that the
/// published library takes when none is given.
fn as_documented(model: &Model) -> Model {
    let mut changes = pipes(model, |_, _| vec![("zeta", json!(0.0))]);
    let mut set = |parameter: String, value: f64| {
        changes.push(Change::Set { parameter, value: json!(value) });
    };
    for load in LOADS {
        set(format!("e{load}.rest.kv_m3_h"), 1e3);
        set(format!("fcv{load}.rangeability"), 50.0);
        set(format!("tcv{load}.rangeability"), 50.0);
    }
    set("fta12.kv_m3_h".into(), 1e3);
    set("fcvc01.rangeability".into(), 50.0);
    set("fcvc02.rangeability".into(), 50.0);
    model.with(&changes).unwrap()
}

/// Readings of all sensors at the times of the record.
fn run(model: &Model, sensors: &[Sensor], times_s: &[f64], step_s: f64) -> Vec<Vec<f64>> {
    let mut simulation = Simulation::new(build(model).unwrap()).unwrap();
    let channels: Vec<_> =
        sensors.iter().map(|sensor| simulation.channel(&sensor.channel).unwrap()).collect();
    let mut readings = vec![Vec::with_capacity(times_s.len()); sensors.len()];
    for &time_s in times_s {
        simulation
            .advance_to(Time::from_s(time_s).unwrap(), Time::from_s(step_s).unwrap())
            .unwrap();
        for ((sensor, channel), readings) in sensors.iter().zip(&channels).zip(&mut readings) {
            readings.push(sensor.reading(simulation.get(*channel)));
        }
    }
    assert!(Balances::of(&simulation).heat_error() < 1e-9);
    readings
}

/// Mean error and root mean square error in the unit of the sensor, and the measured mean.
#[derive(Clone, Copy)]
struct Errors {
    bias: f64,
    rmse: f64,
    mean: f64,
}

impl Errors {
    fn of(readings: &[f64], measured: &[f64], times_s: &[f64]) -> Self {
        let compared: Vec<(f64, f64)> = times_s
            .iter()
            .zip(readings.iter().zip(measured))
            .filter(|(time_s, _)| **time_s >= FROM_S)
            .map(|(_, (reading, measured))| (*reading, *measured))
            .collect();
        let mean_of = |of: &dyn Fn((f64, f64)) -> f64| {
            compared.iter().map(|&pair| of(pair)).sum::<f64>() / compared.len() as f64
        };
        Self {
            bias: mean_of(&|(reading, measured)| reading - measured),
            rmse: mean_of(&|(reading, measured)| (reading - measured).powi(2)).sqrt(),
            mean: mean_of(&|(_, measured)| measured),
        }
    }

    fn nmbe_percent(&self) -> f64 {
        100.0 * self.bias / self.mean
    }

    fn cv_rmse_percent(&self) -> f64 {
        100.0 * self.rmse / self.mean
    }
}

/// Leaves measured and simulated curves in a folder that was asked for.
fn leave_curves(
    test: &str,
    sensors: &[Sensor],
    measured: &[Vec<f64>],
    runs: &[(&str, Vec<Vec<f64>>)],
    times_s: &[f64],
) {
    let Some(folder) = std::env::var_os("RSE_OUT") else { return };
    let file = Path::new(&folder).join(format!("{test}.csv"));
    let mut writer = csv::Writer::from_path(file).unwrap();
    let names = runs.iter().flat_map(|(name, _)| {
        sensors.iter().map(move |sensor| format!("{}|{name}", sensor.column))
    });
    let columns = sensors.iter().map(|sensor| sensor.column.clone());
    writer.write_record(std::iter::once("time_s".to_owned()).chain(columns).chain(names)).unwrap();
    for (row, time_s) in times_s.iter().enumerate() {
        let measured = measured.iter().map(|values| values[row]);
        let found = runs.iter().flat_map(|(_, readings)| readings.iter().map(|r| r[row]));
        let cells = std::iter::once(*time_s).chain(measured).chain(found);
        writer.write_record(cells.map(|value| format!("{value:.5}"))).unwrap();
    }
    writer.flush().unwrap();
}

/// Compares one test; the sensors that are no better with the pipes than without.
fn compare(data: &Path, test: &str, all: bool) -> Vec<String> {
    let record = Record::read(&data.join(format!("{test}.csv")));
    let times_s: Vec<f64> = record
        .column("time_s")
        .iter()
        .copied()
        .filter(|time_s| all || (time_s / STEPS_S.1).fract() == 0.0)
        .collect();
    let rows: Vec<usize> = times_s.iter().map(|time_s| (time_s / 2.0) as usize).collect();
    let step_s = if all { STEPS_S.0 } else { STEPS_S.1 };
    let sensors = sensors();
    let full = model(data, test, &record);
    let variants: Vec<(&str, Model)> = vec![
        ("model", full.clone()),
        ("no heat loss, no delay", without_loss_and_delay(&full)),
        ("ideal pipes", with_ideal_pipes(&full)),
        ("documented only", as_documented(&full)),
        ("insulated", insulated(&full, 7.6)),
    ];
    let runs: Vec<(&str, Vec<Vec<f64>>)> = variants
        .iter()
        .map(|(name, model)| (*name, run(model, &sensors, &times_s, step_s)))
        .collect();
    let names: Vec<String> = runs[1..].iter().map(|(name, _)| format!("RMSE {name}")).collect();
    let mut table = format!(
        "| sensor | measured mean | NMBE % | CV(RMSE) % | RMSE | {} |\n|---|--:|--:|--:|--:|{}\n",
        names.join(" | "),
        "--:|".repeat(names.len())
    );
    let mut missed = Vec::new();
    let at_rows = |sensor: &Sensor| -> Vec<f64> {
        rows.iter().map(|&row| record.column(&sensor.column)[row]).collect()
    };
    let measured: Vec<Vec<f64>> = sensors.iter().map(at_rows).collect();
    for (i, sensor) in sensors.iter().enumerate() {
        let errors: Vec<Errors> =
            runs.iter().map(|(_, found)| Errors::of(&found[i], &measured[i], &times_s)).collect();
        let own = errors[0];
        let star = if own.nmbe_percent().abs() > DISCUSSED_PERCENT { " *" } else { "" };
        let _ = writeln!(
            table,
            "| {}{star} | {:.2} | {:+.1} | {:.1} | {:.3} | {} |",
            sensor.column,
            own.mean,
            own.nmbe_percent(),
            own.cv_rmse_percent(),
            own.rmse,
            errors[1..].iter().map(|e| format!("{:.3}", e.rmse)).collect::<Vec<_>>().join(" | "),
        );
        // Flows are those of the pipes' pressure losses, temperatures those of their heat losses and delays.
        let of_load = LOADS.iter().any(|load| sensor.column == format!("FT{load}_m3_h"));
        let supply = LOADS.iter().any(|load| sensor.column == format!("TT{}2_degC", &load[..2]));
        if of_load && own.rmse >= errors[2].rmse || supply && own.rmse >= errors[1].rmse {
            missed.push(format!("{test}: {}", sensor.column));
        }
    }
    leave_curves(test, &sensors, &measured, &runs, &times_s);
    if all {
        let command = "RSE_TESTS=all cargo test --workspace --test heat rse_facility::";
        write_table("rse_facility", test, command, &table);
    } else {
        println!("{table}");
    }
    missed
}

#[test]
fn flows_and_supply_temperatures_need_the_pipes() {
    let Some(data) = reference_data("rse_dhtf") else { return };
    let all = std::env::var_os("RSE_TESTS").is_some_and(|which| which == "all");
    let tests = if all { &TESTS[..] } else { &SHORT[..] };
    let missed: Vec<String> = tests.iter().flat_map(|test| compare(&data, test, all)).collect();
    assert!(missed.is_empty(), "no better with the pipes than without: {missed:?}");
}
