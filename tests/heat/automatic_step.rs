//! The automatic step: its error against short fixed steps, its cost in quiet periods, determinism.
#![allow(clippy::unwrap_used)]

use anergy_benches::{two_pipe_network_of_a_year, write_profiles};
use anergy_core::clock::Time;
use anergy_simulation::automatic_step::Step;
use anergy_simulation::balance;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::workspace;
use serde_json::Value;
use std::path::Path;

fn time(seconds: f64) -> Time {
    Time::from_s(seconds).unwrap()
}

fn example(path: &str, changes: &[(&str, &str)]) -> Simulation {
    let path = workspace().join("examples").join(path);
    let mut text = std::fs::read_to_string(&path).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    simulation(&text, path.parent().unwrap())
}

fn simulation(text: &str, folder: &Path) -> Simulation {
    let model = Model::from_toml(text, folder)
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)));
    Simulation::new(build(&model).unwrap()).unwrap()
}

fn automatic(simulation: &Simulation) -> Step {
    Step::Automatic(simulation.plan().automatic_step())
}

/// Values of channels every `every_s` until `until_s`.
fn rows(
    simulation: &mut Simulation,
    channels: &[&str],
    (until_s, every_s): (f64, f64),
    step: Step,
) -> Vec<Vec<f64>> {
    let ids: Vec<_> = channels.iter().map(|name| simulation.channel(name).unwrap()).collect();
    let mut rows = Vec::new();
    while simulation.time() < time(until_s) {
        let end = simulation.time() + time(every_s);
        simulation.advance_to(end, step).unwrap();
        rows.push(ids.iter().map(|id| simulation.get(*id)).collect());
    }
    rows
}

/// Largest and mean difference of each channel between two runs.
fn differences(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<(f64, f64)> {
    (0..a[0].len())
        .map(|i| {
            let each = a.iter().zip(b).map(|(a, b)| (a[i] - b[i]).abs());
            (each.clone().fold(0.0, f64::max), each.sum::<f64>() / a.len() as f64)
        })
        .collect()
}

fn report(simulation: &Simulation) -> Value {
    balance::summary(simulation, false)["automatic_step"].clone()
}

fn steps(report: &Value) -> u64 {
    report["steps"].as_u64().unwrap()
}

/// Largest swing of the first pump in the last 10 min of 30, l/min, and the steps of the first 20 min.
fn hunting(n: u32, short: bool) -> (f64, Value) {
    let mut simulation = example(&format!("pump-hunting/n{n}.toml"), &[]);
    let step = if short { Step::Fixed(time(0.1)) } else { automatic(&simulation) };
    let flow = ["plant.feeder1.feed_in_pump.m_flow_kg_s"];
    rows(&mut simulation, &flow, (1200.0, 600.0), step);
    let before = report(&simulation);
    let flows = rows(&mut simulation, &flow, (1800.0, 0.5), step);
    let range = flows.iter().fold((f64::INFINITY, 0.0_f64), |r, m| (r.0.min(m[0]), r.1.max(m[0])));
    (60.0 * (range.1 - range.0), before)
}

#[test]
fn continuous_controllers_are_resolved() {
    // Two pumps hunt as they do in steps of 0.1 s.
    let ((short, _), (chosen, _)) = (hunting(2, true), hunting(2, false));
    assert!(short > 6.0 && (chosen / short - 1.0).abs() < 0.1, "{chosen} {short} l/min");
    // One is stable: what remains of a push is below the tolerance of 1 % of 3.3 l/min, in few steps.
    let (chosen, before) = hunting(1, false);
    assert!(chosen < 0.033, "{chosen} l/min");
    assert!(steps(&before) < 120, "{before}");
}

#[test]
fn blocked_pump_and_its_relief() {
    let channels = ["sf1.station.m_flow_kg_s", "sf2.station.m_flow_kg_s"];
    let run = |short: bool| {
        let mut simulation = example("three-houses/model.toml", &[]);
        let step = if short { Step::Fixed(time(0.1)) } else { automatic(&simulation) };
        let rows = rows(&mut simulation, &channels, (3600.0, 60.0), step);
        (rows, report(&simulation))
    };
    let ((short, _), (chosen, report)) = (run(true), run(false));
    let nominal_kg_s = 8.0 / 60.0;
    for (largest, mean) in differences(&chosen, &short) {
        // In the ramp of 20 s a moment; otherwise far below the tolerance of 1 %.
        assert!(largest < 0.02 * nominal_kg_s && mean < 1e-3 * nominal_kg_s, "{largest} {mean}");
    }
    assert!(steps(&report) < 300, "{report}");
}

#[test]
fn cold_plug_arrives_in_time() {
    let run = |short: bool| {
        let mut simulation = example("cold-plug/model.toml", &[]);
        let step = if short { Step::Fixed(time(0.1)) } else { automatic(&simulation) };
        let rows = rows(&mut simulation, &["sf4.hot.t_k"], (2400.0, 10.0), step);
        (rows, report(&simulation))
    };
    let ((short, _), (chosen, report)) = (run(true), run(false));
    let (_, mean) = differences(&chosen, &short)[0];
    assert!(short.iter().any(|row| row[0] < 273.15 + 40.0), "no plug");
    assert!(mean < 0.5, "{mean} K");
    let far = chosen.iter().zip(&short).filter(|(a, b)| (a[0] - b[0]).abs() > 0.5).count();
    // The plug lasts 570 s; a front passes within a row of 10 s.
    assert!(far <= 2, "{far} rows differ by more than 0.5 K");
    assert!(steps(&report) < 1000, "{report}");
}

/// A grid of houses with loads from profiles.
fn grid(consumers: usize) -> Simulation {
    let folder = std::env::temp_dir();
    let file = folder.join(format!("anergy_automatic_step_{consumers}.csv"));
    std::fs::write(&file, write_profiles(1)).unwrap();
    simulation(&two_pipe_network_of_a_year(consumers, 1, file.to_str().unwrap()), &folder)
}

#[test]
fn a_grid_with_loads_over_two_days() {
    let channels = ["plant.cold.t_k", "c7.hot.t_k", "c29.hot.t_k"];
    let run = |step: Option<Step>| {
        let mut simulation = grid(30);
        let step = step.unwrap_or(automatic(&simulation));
        let rows = rows(&mut simulation, &channels, (172_800.0, 3600.0), step);
        (rows, balance::Balances::of(&simulation), report(&simulation))
    };
    let (short, short_sums, _) = run(Some(Step::Fixed(time(10.0))));
    let (chosen, sums, report) = run(None);
    for (largest, _) in differences(&chosen[24..], &short[24..]) {
        assert!(largest < 0.05, "{largest} K");
    }
    for (a, b) in [(sums.units_j, short_sums.units_j), (sums.loss_j, short_sums.loss_j)] {
        let scale = short_sums.loss_j;
        assert!(((a - b) / scale).abs() < 2e-3, "{a} {b} J");
    }
    assert!(sums.heat_error() < 1e-9);
    // 192 steps of 15 min, the warming up of the network and the first steps beside.
    assert!(steps(&report) < 700, "{report}");
}

const CIRCUIT: &str = r#"
format = 1
[run]
initial_degc = 20
[[node]]
id = "r"
[[node]]
id = "s"
[pressure_reference]
node = "r"
[[edge]]
id = "pump"
kind = "pump"
from = "r"
to = "s"
head_max_bar = 1
free_flow_m3_h = 5
speed = 0.5
[[edge]]
id = "pipe"
kind = "pipe"
from = "s"
to = "r"
length_m = 500
inner_diameter_mm = 40
"#;

#[test]
fn quiet_periods_are_cheap() {
    let mut simulation = simulation(CIRCUIT, Path::new("."));
    let step = automatic(&simulation);
    simulation.advance_to(time(86_400.0), step).unwrap();
    let first = report(&simulation);
    for day in 2..=10 {
        simulation.advance_to(time(86_400.0 * f64::from(day)), step).unwrap();
    }
    let all = report(&simulation);
    assert!(steps(&first) < 150, "{first}");
    assert_eq!(steps(&all) - steps(&first), 9 * 96, "96 steps of 15 min a day: {all}");
    assert_eq!(all["limited_most_often_by"], "longest step");
}

#[test]
fn a_quick_continuous_controller_at_rest_costs_a_few_steps_more() {
    // Steps of 15 min are 45 integral times: unstable, so that steps shorten whenever its output begins to move.
    let text = format!(
        "{CIRCUIT}[[controller]]\nid = \"pi\"\nkind = \"pi\"\nmeasures = \"pump.m_flow_kg_s\"\n\
         acts_on = \"pump.speed\"\nset_point = 0.4\ngain = 0.1\nintegral_time_s = 20\n"
    );
    let mut simulation = simulation(&text, Path::new("."));
    let step = automatic(&simulation);
    let flows = rows(&mut simulation, &["pump.m_flow_kg_s"], (864_000.0, 3600.0), step);
    for flow in &flows[1..] {
        assert!((flow[0] / 0.4 - 1.0).abs() < 0.01, "{} kg/s", flow[0]);
    }
    let report = report(&simulation);
    assert!(steps(&report) < 10 * 500, "{report}");
}

#[test]
fn the_same_again_and_from_a_snapshot_bit_for_bit() {
    let flow = ["plant.feeder1.feed_in_pump.m_flow_kg_s"];
    let mut whole = example("pump-hunting/n2.toml", &[]);
    let step = automatic(&whole);
    rows(&mut whole, &flow, (630.0, 7.0), step);
    let bytes = whole.snapshot().to_bytes().unwrap();
    let end = |simulation: &mut Simulation| {
        rows(simulation, &flow, (700.0, 7.0), step);
        simulation.snapshot().to_bytes().unwrap()
    };
    let first = end(&mut whole);
    // Into a simulation that has been elsewhere, and one that has done no automatic step.
    for until_s in [0.0, 50.0] {
        let mut other = example("pump-hunting/n2.toml", &[]);
        rows(&mut other, &flow, (until_s, 10.0), step);
        other.restore_bytes(&bytes).unwrap();
        assert!(end(&mut other) == first, "differs after {until_s} s elsewhere");
    }
    let mut again = example("pump-hunting/n2.toml", &[]);
    rows(&mut again, &flow, (630.0, 7.0), step);
    assert!(end(&mut again) == first, "a second run differs");
}

#[test]
fn steps_end_where_they_have_to() {
    let mut simulation = example(
        "pump-hunting/n2.toml",
        &[("integral_time_s = 8", "integral_time_s = 8\ninterval_s = 2")],
    );
    let step = automatic(&simulation);
    let mut ends = Vec::new();
    while simulation.time() < time(650.0) {
        simulation.advance_once(time(650.0), &step).unwrap();
        ends.push(simulation.time());
    }
    for k in 1..325 {
        assert!(ends.contains(&time(2.0 * f64::from(k))), "update at {} s", 2 * k);
    }
    assert!(ends.windows(2).all(|pair| pair[1] > pair[0]));
}
