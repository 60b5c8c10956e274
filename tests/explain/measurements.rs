//! What `explain` makes of measurements before it compares them: moments of a step, lags, ranges; and data that are not what they
//! claim to be.

#![allow(clippy::unwrap_used)]

use anergy_discrepancy::data;
use anergy_discrepancy::error::ExplainError;
use anergy_discrepancy::experiment::Experiment;
use anergy_discrepancy::explain::{Explanation, Finding, Verdict, explain};
use anergy_discrepancy::sensors::SensorFile;
use anergy_simulation::model::Model;
use std::fmt::Write;
use std::path::Path;

/// A pipe without loss, steps of 20 s.
const PIPE: &str = r#"
format = 1
[run]
step = "20s"
initial_degc = 20
[fluid]
kind = "constant_water"
density_kg_m3 = 988
heat_capacity_j_kg_k = 4180
[[node]]
id = "plant"
kind = "source"
m_flow_kg_s = 0.35
temperature_degc = 20
[[node]]
id = "house"
kind = "pressure_boundary"
pressure_bar = 2
[[edge]]
id = "street"
kind = "pipe"
from = "plant"
to = "house"
length_m = 60.7036
inner_diameter_mm = 43.1
outer_diameter_mm = 48.3
"#;

/// An entry of the sensor file.
fn sensor(column: &str, signal: &str, unit: &str, role: &str, more: &str) -> String {
    format!(
        "[[sensor]]\ncolumn = \"{column}\"\nsignal = \"{signal}\"\nunit = \"{unit}\"\nrole = \"{role}\"\n{more}\n"
    )
}

/// A row every 10 s: what each column reads at a time.
fn table(until_s: u32, columns: &[(&str, &dyn Fn(f64) -> f64)]) -> String {
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    let mut out = format!("time_s,{}\n", names.join(","));
    for time_s in (0..=until_s).step_by(10) {
        let t = f64::from(time_s);
        let cells: Vec<String> = columns.iter().map(|(_, of)| of(t).to_string()).collect();
        writeln!(out, "{t},{}", cells.join(",")).unwrap();
    }
    out
}

fn experiment(model: &str, sensors: &str, data: &str) -> Result<Experiment, ExplainError> {
    let sensors = SensorFile::from_toml(sensors)?;
    let runs = data::read(data, &sensors)?;
    Experiment::new(Model::from_toml(model, Path::new(".")).unwrap(), sensors, runs)
}

#[test]
fn means_of_a_step_belong_to_its_middle_and_states_to_its_end() {
    // 988 pi/4 0.0431^2 60.7036 = 87.5 kg: 250 s at 0.35 kg/s. Behind a ramp of 0.02 K/s the outlet is 5 K behind. At the end of a
    // step the water there is that of the middle of a step, whose temperature is its mean.
    let ramp = |t: f64| 20.0 + 0.02 * t;
    let sensors = sensor("T_in", "plant.temperature_k", "degC", "input", "")
        + &sensor("node", "house.t_k", "degC", "compare", "")
        + &sensor("end", "street.t_b_k", "degC", "compare", "");
    let data = table(2000, &[("T_in", &ramp), ("node", &ramp), ("end", &ramp)]);
    let experiment = experiment(PIPE, &sensors, &data).unwrap();
    let readings = experiment.readings(&[], &[]).unwrap();
    let seen = experiment.samples.iter().zip(&readings).filter(|(s, _)| s.time_s > 600.0);
    for (sample, reading) in seen {
        let behind = sample.value - reading;
        // Half a step would be 0.2 K.
        assert!((behind - 5.0).abs() < 1e-3, "sensor {}: {behind}", sample.sensor);
    }
}

#[test]
fn a_flow_belongs_to_the_middle_of_its_step_too() {
    let ramp = |t: f64| 0.2 + 1e-4 * t;
    let sensors = sensor("flow", "plant.m_flow_kg_s", "kg_s", "input", "")
        + &sensor("again", "street.m_flow_kg_s", "kg_s", "compare", "");
    let data = table(1000, &[("flow", &ramp), ("again", &ramp)]);
    let experiment = experiment(PIPE, &sensors, &data).unwrap();
    let readings = experiment.readings(&[], &[]).unwrap();
    let inner = experiment.samples.iter().zip(&readings).take(100).skip(2);
    for (sample, reading) in inner {
        assert!((sample.value - reading).abs() < 1e-9, "{} {reading}", sample.value);
    }
}

#[test]
fn a_slow_sensor_of_an_input_is_taken_into_account() {
    // Behind 40 s a ramp of 0.02 K/s reads 0.8 K too little.
    let ramp = |t: f64| 20.0 + 0.02 * (t - 40.0 + 40.0 * (-t / 40.0).exp());
    let truth = |t: f64| 20.0 + 0.02 * t;
    let sensors = sensor("T_in", "plant.temperature_k", "degC", "input", "lag_s = 40")
        + &sensor("T_out", "house.t_k", "degC", "compare", "");
    let data = table(2000, &[("T_in", &ramp), ("T_out", &truth)]);
    let readings = experiment(PIPE, &sensors, &data).unwrap().readings(&[], &[]).unwrap();
    let behind = 20.0 + 0.02 * 2000.0 + 273.15 - readings.last().unwrap();
    assert!((behind - 5.0).abs() < 0.02, "{behind}");
    let long = sensors.replace("lag_s = 40", "lag_s = 600");
    let refused = experiment(PIPE, &long, &data).err().unwrap().to_string();
    assert!(refused.contains("sensor \"T_in\": lag_s = 600 is more than a quarter"), "{refused}");
}

/// A pump between two boundaries.
const PUMP: &str = r#"
format = 1
[run]
step = "10s"
initial_degc = 20
[[node]]
id = "cold"
kind = "pressure_boundary"
pressure_bar = 2
[[node]]
id = "middle"
[[node]]
id = "hot"
kind = "pressure_boundary"
pressure_bar = 2
[[edge]]
id = "pump"
kind = "pump"
from = "cold"
to = "middle"
head_max_hpa = 400
free_flow_l_min = 48
[[edge]]
id = "rest"
kind = "resistance"
from = "middle"
to = "hot"
dp_nominal_hpa = 100
m_flow_nominal_kg_s = 0.3
"#;

#[test]
fn noise_around_the_ends_of_a_command_is_no_error_and_nonsense_is_one() {
    let sensors =
        sensor("n_2", "pump.speed", "1", "input", "class = \"electric_0_2\"\nquantisation = 0.001")
            + &sensor("flow", "pump.m_flow_kg_s", "kg_s", "compare", "class = \"mid\"");
    let speed = |t: f64| if t < 500.0 { -0.000_125 } else { 1.000_3 };
    let flow = |t: f64| if t < 500.0 { 0.0 } else { 0.5 };
    let noisy = experiment(PUMP, &sensors, &table(1000, &[("n_2", &speed), ("flow", &flow)]));
    let readings = noisy.unwrap().readings(&[], &[]).unwrap();
    assert!(readings[10].abs() < 1e-9 && *readings.last().unwrap() > 0.2, "{readings:?}");

    let percent = |t: f64| 100.0 * speed(t);
    let wrong = experiment(PUMP, &sensors, &table(1000, &[("n_2", &percent), ("flow", &flow)]));
    let found = explain(&wrong.unwrap(), None).unwrap();
    assert_eq!(found.verdict, Verdict::DataProblem);
    let words = "column \"n_2\" reads 100.03 1 at 500 s, and pump.speed lies between 0 and 1";
    assert!(found.because.contains(words), "{}", found.because);
}

/// Two pipes one after the other, and their sensors.
const BENCH: &str = r#"
format = 1
[run]
step = "5s"
initial_degc = 40
[fluid]
kind = "constant_water"
density_kg_m3 = 988
heat_capacity_j_kg_k = 4180
[ground]
temperature_degc = 12
[[node]]
id = "plant"
kind = "source"
m_flow_kg_s = 0.35
temperature_degc = 40
[[node]]
id = "middle"
[[node]]
id = "house"
kind = "pressure_boundary"
pressure_bar = 2
[[edge]]
id = "near"
kind = "pipe"
from = "plant"
to = "middle"
length_m = 15
inner_diameter_mm = 27.2
insulation_resistance_k_m_w = 4
[[edge]]
id = "far"
kind = "pipe"
from = "middle"
to = "house"
length_m = 20
inner_diameter_mm = 27.2
insulation_resistance_k_m_w = 4
"#;

fn bench_sensors() -> String {
    let warm = "class = \"pt100_a\"\nquantisation = 0.1";
    sensor("T_in", "plant.temperature_k", "degC", "input", warm)
        + &sensor("flow", "plant.m_flow_kg_s", "kg_h", "input", "class = \"mid\"\nquantisation = 1")
        + &sensor("T_middle", "middle.t_k", "degC", "compare", warm)
        + &sensor("T_house", "house.t_k", "degC", "compare", warm)
        + &sensor(
            "dp_far",
            "far.dp_pa",
            "hPa",
            "compare",
            "class = \"dp_0_25\"\nquantisation = 0.1",
        )
}

/// Noise between -1 and 1 that is the same in every run.
fn noise(seed: u64) -> f64 {
    let mut x = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678;
    for _ in 0..3 {
        x ^= x >> 31;
        x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    }
    (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// What the sensors of the bench read of a plant, every 10 s of an hour: rows of time, `T_in`, `flow`, `T_middle`, `T_house`, `dp_far`.
fn read_of(plant: &str) -> Vec<[f64; 6]> {
    // A new level every five minutes, reached within a minute; three flows.
    let level = |block: u64| 50.0 + 15.0 * noise(block + 77);
    let t_in = |t: f64| {
        let (block, into) = ((t / 300.0).floor(), t % 300.0);
        let before = if block < 1.0 { 40.0 } else { level(block as u64 - 1) };
        before + (level(block as u64) - before) * ((into - 20.0) / 60.0).clamp(0.0, 1.0)
    };
    let flow = |t: f64| [800.0, 1000.0, 1300.0][(t / 300.0) as usize % 3];
    let nothing = |_: f64| 40.0;
    let columns: [(&str, &dyn Fn(f64) -> f64); 5] = [
        ("T_in", &t_in),
        ("flow", &flow),
        ("T_middle", &nothing),
        ("T_house", &nothing),
        ("dp_far", &nothing),
    ];
    let truth = experiment(plant, &bench_sensors(), &table(3600, &columns)).unwrap();
    let readings = truth.readings(&[], &[]).unwrap();
    let rows = readings.len() / 3;
    let as_read = |k: usize, seed: usize, y: f64, bias: f64, lsb: f64| {
        ((y + bias + 0.03 * noise((7 * k + seed) as u64)) / lsb).round() * lsb
    };
    let row = |k: usize| {
        let t = 10.0 * k as f64;
        [
            t,
            as_read(k, 1, t_in(t), 0.05, 0.1),
            as_read(k, 2, flow(t), 0.5, 1.0),
            as_read(k, 3, readings[k] - 273.15, -0.1, 0.1),
            as_read(k, 4, readings[rows + k] - 273.15, 0.08, 0.1),
            as_read(k, 5, readings[2 * rows + k] / 100.0, 0.02, 0.1),
        ]
    };
    (0..rows).map(row).collect()
}

/// What `explain` says of such readings with the bench as its model.
fn explained(rows: &[[f64; 6]]) -> Explanation {
    let mut data = "time_s,T_in,flow,T_middle,T_house,dp_far\n".to_owned();
    for row in rows {
        let cells = row.iter().map(|x| if x.is_nan() { String::new() } else { x.to_string() });
        writeln!(data, "{}", cells.collect::<Vec<_>>().join(",")).unwrap();
    }
    explain(&experiment(BENCH, &bench_sensors(), &data).unwrap(), None).unwrap()
}

const T_IN: usize = 1;
const FLOW: usize = 2;
const T_MIDDLE: usize = 3;
const T_HOUSE: usize = 4;
const DP_FAR: usize = 5;

#[test]
fn broken_columns_are_a_problem_of_the_data() {
    let good = read_of(BENCH);
    let broken = |change: &dyn Fn(&mut Vec<[f64; 6]>), words: &[&str]| {
        let mut rows = good.clone();
        change(&mut rows);
        let found = explained(&rows);
        assert_eq!(found.verdict, Verdict::DataProblem, "{words:?}: {}", found.because);
        assert!(words.iter().all(|w| found.because.contains(w)), "{words:?}: {}", found.because);
        assert!(found.effects.is_empty() && found.class.is_empty());
    };
    let each =
        |rows: &mut Vec<[f64; 6]>, change: &dyn Fn(&mut [f64; 6])| rows.iter_mut().for_each(change);
    // Exchanged: two that are compared, and one that drives.
    broken(
        &|rows| each(rows, &|r| r.swap(T_MIDDLE, T_HOUSE)),
        &["\"T_middle\" and \"T_house\"", "exchanged"],
    );
    broken(
        &|rows| each(rows, &|r| r.swap(T_IN, T_HOUSE)),
        &["\"T_in\" and \"T_house\"", "exchanged"],
    );
    // A clock that jumps, forth or back.
    let late = |rows: &mut Vec<[f64; 6]>, column: usize, from: usize, by: usize| {
        let before: Vec<f64> = rows.iter().map(|r| r[column]).collect();
        (from + by..rows.len()).for_each(|i| rows[i][column] = before[i - by]);
    };
    broken(&|rows| late(rows, T_HOUSE, 180, 20), &["clock of column \"T_house\"", "jump by 200 s"]);
    broken(
        &|rows| late(rows, T_MIDDLE, 90, 15),
        &["clock of column \"T_middle\"", "jump by 150 s"],
    );
    // Half an hour late.
    broken(&|rows| late(rows, T_HOUSE, 0, 180), &["\"T_house\"", "1800 s late"]);
    // Doubled, stuck, all but gone, in other units, of the other sign.
    broken(&|rows| each(rows, &|r| r[T_HOUSE] = r[T_IN]), &["are the same"]);
    broken(&|rows| each(rows, &|r| r[DP_FAR] = 21.5), &["\"dp_far\" never changes"]);
    broken(
        &|rows| (0..rows.len()).filter(|i| i % 14 != 0).for_each(|i| rows[i][T_HOUSE] = f64::NAN),
        &["\"T_house\" has 26 readings where others have 361"],
    );
    broken(&|rows| each(rows, &|r| r[FLOW] /= 60.0), &["\"flow\""]);
    broken(&|rows| each(rows, &|r| r[FLOW] *= 1000.0), &["\"flow\""]);
    broken(&|rows| each(rows, &|r| r[DP_FAR] *= 100.0), &["\"dp_far\"", "factor of 100"]);
    broken(&|rows| each(rows, &|r| r[DP_FAR] = -r[DP_FAR]), &["\"dp_far\"", "sign"]);
    broken(&|rows| each(rows, &|r| r[T_MIDDLE] += 273.15), &["\"T_middle\"", "K and degC"]);
}

#[test]
fn a_good_column_is_no_problem_of_the_data_whatever_the_plant_does() {
    let far = |line: &str, other: &str| {
        let (head, tail) = BENCH.split_at(BENCH.find("id = \"far\"").unwrap());
        format!("{head}{}", tail.replace(line, other))
    };
    let longer = far("length_m = 20", "length_m = 25");
    let worse = far("insulation_resistance_k_m_w = 4", "insulation_resistance_k_m_w = 1.5");
    for (plant, id) in [(BENCH, ""), (&longer, "P10"), (&worse, "P2")] {
        let found = explained(&read_of(plant));
        assert!(found.problems.is_empty(), "{:?}", found.problems);
        assert_eq!(found.verdict == Verdict::Nothing, id.is_empty(), "{}", found.because);
        let is_it = |f: &Finding| f.id == id && f.component == "far";
        assert!(id.is_empty() || found.class.iter().any(is_it), "{id}: {:?}", found.class);
    }
}

#[test]
fn data_of_another_topology_are_not_named() {
    // A branch leaves in the middle; beside the far pipe there is one three times as long.
    let branch = "[[node]]\nid = \"out\"\nkind = \"pressure_boundary\"\npressure_bar = 2\n[[edge]]\nid = \"branch\"\n\
                  kind = \"pipe\"\nfrom = \"middle\"\nto = \"out\"\nlength_m = 40\ninner_diameter_mm = 27.2\n\
                  insulation_resistance_k_m_w = 4\n";
    let found = explained(&read_of(&format!("{BENCH}{branch}")));
    assert_eq!(found.verdict, Verdict::Unexplained, "{}", found.because);
    let beside = "[[edge]]\nid = \"beside\"\nkind = \"pipe\"\nfrom = \"middle\"\nto = \"house\"\nlength_m = 60\n\
                  inner_diameter_mm = 27.2\ninsulation_resistance_k_m_w = 4\n";
    let found = explained(&read_of(&format!("{BENCH}{beside}")));
    assert_ne!(found.verdict, Verdict::Named, "{}", found.because);
}

#[test]
fn a_sensor_in_the_place_of_another_says_which_of_two_is_wrong() {
    let warm = "class = \"pt100_a\"\nquantisation = 0.1";
    let inlet = |column| sensor(column, "plant.temperature_k", "degC", "input", warm);
    let flow =
        sensor("flow", "plant.m_flow_kg_s", "kg_h", "input", "class = \"mid\"\nquantisation = 1");
    let house = sensor("T_house", "house.t_k", "degC", "compare", warm);
    // The sensor at the inlet reads 2 K too much, the one in its place in a second run what is true.
    let rows = read_of(BENCH);
    let run = |name: &str, first: &dyn Fn(f64) -> String| {
        let row = |[t, t_in, flow, _, t_house, _]: &[f64; 6]| {
            format!("{t},{name},{},{flow},{t_house}\n", first(*t_in))
        };
        rows.iter().map(row).collect::<String>()
    };
    let wrong = run("1", &|t_in| format!("{},", t_in + 2.0));
    let right = run("2", &|t_in| format!(",{t_in}"));
    let said = |sensors: &str, data: &str| {
        let data = format!("time_s,run,T_in,T_new,flow,T_house\n{data}");
        let found = explain(&experiment(BENCH, sensors, &data).unwrap(), None).unwrap();
        let of = |all: &[Finding]| -> Vec<String> {
            all.iter().map(|f| format!("{} {}", f.id, f.component)).collect()
        };
        (found.verdict, of(&found.effects), of(&found.class))
    };
    let (verdict, _, class) = said(&(inlet("T_in") + &flow + &house), &wrong);
    assert_eq!(verdict, Verdict::Class);
    assert!(
        ["S1 T_in", "S1 T_house"].iter().all(|s| class.contains(&(*s).to_owned())),
        "{class:?}"
    );
    let both = inlet("T_in") + &inlet("T_new") + &flow + &house;
    let (verdict, effects, _) = said(&both, &(wrong + &right));
    assert_eq!((verdict, effects.join(" ").as_str()), (Verdict::Named, "S1 T_in"));
}
