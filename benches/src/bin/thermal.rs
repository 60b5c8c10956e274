//! Times of whole runs with heat, one line each: `make bench-thermal`.
//!
//! - `thermal destest FOLDER [DAYS]`: the DESTEST network (definition in FOLDER), 256 days at 1 min.
//! - `thermal year CONSUMERS [DAYS]`: a generated grid at 15 min, loads from profiles, 365 days.
//! - `thermal valves CONSUMERS [DAYS]`: the same with a thermostatic valve at every consumer, in steps of 15 min and in automatic
//!   ones (a year of 1 000 takes an hour); two days of winter and of summer in other steps against those of 5 s.
//! - `thermal steps CONSUMERS...`: time per step of such grids, 96 steps after a day.
//! - `thermal model CONSUMERS FILE [valves]`: the model file of such a grid, its profiles beside it.
//!
//! Rows are gathered every hour and not kept. Building and reading are not in the time of the run.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use anergy_benches::valves::two_pipe_network_with_valves;
use anergy_benches::{destest, two_pipe_network_of_a_year, write_profiles};
use anergy_core::clock::{NS_PER_S, Time};
use anergy_core::error::RecordError;
use anergy_core::recorder::{Channel, Event, Recorder, RunHeader};
use anergy_simulation::automatic_step::{AutomaticStep, Step};
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::run::{RunOptions, run};
use anergy_simulation::simulation::Simulation;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

const SEED: u64 = 1;
const HOUR: Time = Time(3600 * NS_PER_S);
const QUARTER: Time = Time(900 * NS_PER_S);

/// Keeps nothing.
struct Nothing;

impl Recorder for Nothing {
    fn start(&mut self, _: &RunHeader, _: &[Channel]) -> Result<(), RecordError> {
        Ok(())
    }

    fn row(&mut self, _: Time, values: &[f64]) -> Result<(), RecordError> {
        black_box(values);
        Ok(())
    }

    fn event(&mut self, _: &Event) -> Result<(), RecordError> {
        Ok(())
    }

    fn finish(self: Box<Self>, _: &serde_json::Value) -> Result<(), RecordError> {
        Ok(())
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, or: f64| arguments.get(i).map_or(or, |text| text.parse().unwrap());
    match arguments.first().map(String::as_str) {
        Some("destest") => {
            let text = destest::model(Path::new(&arguments[1])).unwrap();
            whole_run("DESTEST, 16 houses, step 1 min", &text, number(2, 256.0));
        }
        Some("year") => {
            let consumers = number(1, 1000.0) as usize;
            let folder = tempfile();
            let name = format!("{consumers} consumers, step 15 min");
            whole_run(&name, &generated(consumers, &folder), number(2, 365.0));
        }
        Some("valves") => {
            let consumers = number(1, 1000.0) as usize;
            let text = two_pipe_network_with_valves(consumers, SEED, &tempfile());
            let days = number(2, 365.0);
            for step in ["15min", "auto"] {
                let text = text.replace("step = \"15min\"", &format!("step = \"{step}\""));
                let name = format!("{consumers} thermostatic valves, step {step}");
                whole_run(&name, &text, days);
            }
            deviations(&text);
        }
        Some("steps") => {
            println!(
                "| consumers | edges | per step, us | per step and consumer, us | peak memory, MB |"
            );
            println!("|---|---|---|---|---|");
            for i in 1..arguments.len() {
                steps(number(i, 100.0) as usize);
            }
        }
        Some("model") => {
            let file = Path::new(&arguments[2]);
            let profiles = file.with_extension("csv");
            std::fs::write(&profiles, write_profiles(SEED)).unwrap();
            let (consumers, profiles) = (number(1, 100.0) as usize, profiles.to_str().unwrap());
            let text = match arguments.get(3).map(String::as_str) {
                Some("valves") => two_pipe_network_with_valves(consumers, SEED, profiles),
                _ => two_pipe_network_of_a_year(consumers, SEED, profiles),
            };
            std::fs::write(file, text).unwrap();
        }
        _ => println!(
            "thermal destest FOLDER [DAYS] | year CONSUMERS [DAYS] | valves CONSUMERS [DAYS] | steps CONSUMERS..."
        ),
    }
}

/// A file for the profiles that is the same for every run.
fn tempfile() -> String {
    let path = std::env::temp_dir().join("anergy_profiles_of_a_year.csv");
    std::fs::write(&path, write_profiles(SEED)).unwrap();
    path.to_str().unwrap().to_owned()
}

fn generated(consumers: usize, profiles: &str) -> String {
    two_pipe_network_of_a_year(consumers, SEED, profiles)
}

fn simulation(text: &str) -> Simulation {
    let model = Model::from_toml(text, Path::new("."));
    let model = model.unwrap_or_else(|problems| panic!("{}", problems.render(text)));
    Simulation::new(build(&model).unwrap()).unwrap()
}

fn whole_run(name: &str, text: &str, days: f64) {
    let start = Instant::now();
    let mut simulation = simulation(text);
    let built_s = start.elapsed().as_secs_f64();
    let options =
        RunOptions { until: Time::from_s(days * 86_400.0), step: None, record: Some(HOUR) };
    let start = Instant::now();
    let report = run(&mut simulation, options, Box::new(Nothing), &mut |_, _| true).unwrap();
    let spent_s = start.elapsed().as_secs_f64();
    println!(
        "{name}, {days} days: {spent_s:.2} s ({built_s:.2} s before to read and build), peak memory {:.0} MB",
        peak_mb()
    );
    println!("{}", report.summary["balances"]);
}

/// Plant and a consumer over two days of winter and of summer: flow, return and heat, at full hours, in other steps against those
/// of 5 s.
fn deviations(text: &str) {
    let mut simulation = simulation(text);
    println!(
        "| step, 48 h | time, s | flow of the plant, rms | its return, rms K | heat of a house, rms |"
    );
    println!("|---|---|---|---|---|");
    for (season, first_day) in [("winter", 0), ("summer", 182)] {
        simulation.advance_to(Time(first_day * 24 * HOUR.0), QUARTER).unwrap();
        deviations_from_here(season, &mut simulation);
    }
}

fn deviations_from_here(season: &str, simulation: &mut Simulation) {
    let start = simulation.snapshot();
    let channels = ["plant.station.m_flow_kg_s", "plant.generator_inlet.t_k", "c1.unit.q_flow_w"]
        .map(|name| simulation.channel(name).unwrap());
    let automatic = simulation.plan().automatic_step();
    let coarse = AutomaticStep { tolerance_flow: 5.0 * automatic.tolerance_flow, ..automatic };
    let mut hours = |step: Step| -> (Vec<[f64; 3]>, f64) {
        simulation.restore(&start).unwrap();
        let (began, clock) = (simulation.time(), Instant::now());
        let mut rows = Vec::new();
        for hour in 1..=48 {
            simulation.advance_to(began + Time(hour * HOUR.0), step).unwrap();
            rows.push(channels.map(|channel| simulation.get(channel)));
        }
        (rows, clock.elapsed().as_secs_f64())
    };
    let (exact, exact_s) = hours(Step::Fixed(Time(5 * NS_PER_S)));
    println!("| {season}, 5 s | {exact_s:.2} | - | - | - |");
    let seconds = |s: i64| Step::Fixed(Time(s * NS_PER_S));
    let kinds = [
        ("30 s", seconds(30)),
        ("1 min", seconds(60)),
        ("15 min", Step::Fixed(QUARTER)),
        ("automatic", Step::Automatic(automatic)),
        ("automatic, 5 times the tolerance of flows", Step::Automatic(coarse)),
    ];
    for (name, step) in kinds {
        let (rows, spent_s) = hours(step);
        // In winter the first hours are the filling of the pipes.
        let rms = |of: usize| {
            let squares = rows.iter().zip(&exact).skip(6).map(|(a, b)| (a[of] - b[of]).powi(2));
            (squares.sum::<f64>() / (rows.len() - 6) as f64).sqrt()
        };
        let mean = |of: usize| exact.iter().skip(6).map(|row| row[of]).sum::<f64>() / 42.0;
        println!(
            "| {season}, {name} | {spent_s:.2} | {:.2} % | {:.3} | {:.2} % |",
            100.0 * rms(0) / mean(0).abs(),
            rms(1),
            100.0 * rms(2) / mean(2).abs()
        );
    }
}

fn steps(consumers: usize) {
    const STEPS: u32 = 96;
    let mut simulation = simulation(&generated(consumers, &tempfile()));
    let edges = simulation.plan().network().edges.len();
    let mut advance = |steps: u32| {
        let start = Instant::now();
        for _ in 0..steps {
            let next = simulation.time() + QUARTER;
            simulation.advance_to(next, QUARTER).unwrap();
        }
        start.elapsed().as_secs_f64() * 1e6 / f64::from(steps)
    };
    advance(STEPS);
    let least_us = (0..3).map(|_| advance(STEPS)).fold(f64::INFINITY, f64::min);
    println!(
        "| {consumers} | {edges} | {least_us:.0} | {:.3} | {:.0} |",
        least_us / consumers as f64,
        peak_mb()
    );
}

/// Largest memory of this process so far, MB (0 where the system does not tell).
fn peak_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.split_whitespace().next()?.parse().ok())
        .map_or(0.0, |kb: f64| kb / 1024.0)
}
