//! What a solve, a step, a recorded row and a build cost.
//!
//! Networks: the demo (`examples/three-houses`) and generated two-pipe networks of
//! [`anergy_benches`]. Results and targets are in `README.md` beside this file.
#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]

use anergy_benches::{two_pipe_network, two_pipe_network_with_edges};
use anergy_core::clock::{NS_PER_S, Time};
use anergy_core::ids::SignalId;
use anergy_core::recorder::{MemoryRecorder, Recorder, RunHeader};
use anergy_network::hydraulics::HydraulicSolver;
use anergy_network::state::NetworkState;
use anergy_recording::McapRecorder;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use anergy_simulation::plan::Plan;
use anergy_simulation::run::{RunOptions, run};
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, SamplingMode, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

const DEMO: &str = include_str!("../examples/three-houses/model.toml");
const SEED: u64 = 1;
const SECOND: Time = Time(NS_PER_S);
/// Commands that a pump is given one after the other, relative to the first.
const SPEEDS: [f64; 7] = [1.0, 0.997, 1.002, 0.995, 0.999, 0.993, 0.998];
/// Recorded rows that are kept in memory, and rows per file.
const ROWS: usize = 500;
const ROWS_PER_FILE: usize = 4000;

fn model(text: &str) -> Model {
    Model::from_toml(text, Path::new(".")).unwrap()
}

/// A network with the pump whose speed is changed and its usual speed.
type Network = (&'static str, Model, &'static str, f64);

/// The demo and a generated network.
fn small_networks() -> Vec<Network> {
    vec![
        ("demo", model(DEMO), "sf2.feed_in_pump", 0.85),
        ("100 consumers", model(&two_pipe_network(100, SEED)), "plant.feed_in_pump", 0.99),
    ]
}

fn large_network() -> Network {
    ("1000 consumers", model(&two_pipe_network(1000, SEED)), "plant.feed_in_pump", 0.99)
}

fn group<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group
        .sample_size(20)
        .nresamples(10_000)
        .sampling_mode(SamplingMode::Flat)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    group
}

/// A network at rest with the actuators of a plan where they are in operation.
fn operating(plan: &Plan, pump: &str, speed: f64) -> (NetworkState, usize) {
    let mut state = NetworkState::new(plan.network(), 323.15);
    state.given_p_pa.fill(1.5e5);
    state.p_pa.fill(1.5e5);
    let find = |name: &str| plan.edge_names().iter().position(|edge| edge == name);
    if let Some(other) = find("sf1.feed_in_pump") {
        state.position[other] = 0.95;
    }
    let pump = find(pump).unwrap();
    state.position[pump] = speed;
    (state, pump)
}

/// (a) Newton from the flows of nearly the same positions, (c) from a tenth of the nominal flows.
fn hydraulics(criterion: &mut Criterion) {
    let thousand = model(&two_pipe_network_with_edges(1000, SEED));
    let thousand = ("1000 edges", thousand, "plant.feed_in_pump", 0.99);
    let networks = small_networks().into_iter().chain([thousand, large_network()]);
    for (name, model, pump, speed) in networks {
        let plan = build(&model).unwrap();
        let network = plan.network();
        let (rest, pump) = operating(&plan, pump, speed);
        let valves: Vec<usize> = (0..network.edges.len())
            .filter(|&i| plan.edge_names()[i].ends_with("extraction_valve"))
            .step_by(10)
            .collect();
        let mut solver = HydraulicSolver::new(network).unwrap();
        let mut state = rest.clone();
        solver.solve(network, &mut state).unwrap();
        let mut k = 0;
        group(criterion, "hydraulics warm").bench_function(name, |bencher| {
            bencher.iter(|| {
                k = (k + 1) % SPEEDS.len();
                state.position[pump] = speed * SPEEDS[k];
                for &valve in &valves {
                    state.position[valve] = rest.position[valve] * SPEEDS[k].min(1.0);
                }
                state.invalidate_hydraulics();
                black_box(solver.solve(network, &mut state).unwrap())
            });
        });
        group(criterion, "hydraulics cold").bench_function(name, |bencher| {
            bencher.iter(|| {
                state.m_flow_kg_s.copy_from_slice(&rest.m_flow_kg_s);
                state.p_pa.copy_from_slice(&rest.p_pa);
                state.position.copy_from_slice(&rest.position);
                state.invalidate_hydraulics();
                black_box(solver.solve(network, &mut state).unwrap())
            });
        });
    }
}

/// A simulation in operation: settled, the demo beyond its schedule.
fn in_operation(model: &Model) -> Simulation {
    let mut simulation = Simulation::new(build(model).unwrap()).unwrap();
    steady::settle(&mut simulation).unwrap();
    if !model.drivers.is_empty() {
        simulation.advance_to(Time(7200 * NS_PER_S), SECOND).unwrap();
    }
    simulation.take_events();
    simulation
}

fn step(simulation: &mut Simulation) {
    let end = simulation.time() + SECOND;
    simulation.advance_to(end, SECOND).unwrap();
}

fn speed_signal(simulation: &Simulation, pump: &str) -> SignalId {
    simulation.signal(&format!("{pump}.speed")).unwrap()
}

/// (b) A whole step of 1 s.
fn steps(criterion: &mut Criterion) {
    for (name, model, pump, speed) in small_networks().into_iter().chain([large_network()]) {
        let mut simulation = in_operation(&model);
        group(criterion, "step settled")
            .bench_function(name, |bencher| bencher.iter(|| step(&mut simulation)));
        let signal = speed_signal(&simulation, pump);
        let mut k = 0;
        let mut changing = |simulation: &mut Simulation| {
            k = (k + 1) % SPEEDS.len();
            simulation.set(signal, speed * SPEEDS[k]).unwrap();
            step(simulation);
        };
        // Until the pipes are full of the water of this operation.
        for _ in 0..600 {
            changing(&mut simulation);
        }
        group(criterion, "step with changing pump")
            .bench_function(name, |bencher| bencher.iter(|| changing(&mut simulation)));
    }
}

/// One pipe of 60 m, 0.4 kg/s; what its temperatures need.
const PIPE: &str = r#"
format = 1
[model]
name = "pipe"
[run]
step = "10s"
[ground]
temperature_degc = 10
[[node]]
id = "plant"
kind = "source"
m_flow_kg_s = 0.4
temperature_degc = 60
[[node]]
id = "house"
kind = "pressure_boundary"
pressure_bar = 2
temperature_degc = 60
[[edge]]
id = "pipe"
kind = "pipe"
from = "plant"
to = "house"
length_m = 60
inner_diameter_mm = 32
insulation_resistance_k_m_w = 2
"#;

/// (c) A step of 10 s of one pipe into which a front is going every two minutes.
fn pipes(criterion: &mut Criterion) {
    let wall = "wall_capacity_j_m_k = 1200\n";
    for (name, keys) in [
        ("parcels", String::new()),
        ("end volume", format!("wall = \"end_volume\"\n{wall}")),
        ("film", format!("wall = \"film\"\n{wall}")),
        ("dispersion", "dispersion_m2_s = 0.02\n".to_owned()),
        ("film and dispersion", format!("wall = \"film\"\ndispersion_m2_s = 0.02\n{wall}")),
    ] {
        let mut simulation = in_operation(&model(&format!("{PIPE}{keys}")));
        let inlet = simulation.signal("plant.temperature_k").unwrap();
        let mut k = 0;
        group(criterion, "step of a pipe").bench_function(name, |bencher| {
            bencher.iter(|| {
                k = (k + 1) % 24;
                simulation.set(inlet, if k < 12 { 333.15 } else { 318.15 }).unwrap();
                let end = simulation.time() + Time(10 * NS_PER_S);
                simulation.advance_to(end, Time(10 * NS_PER_S)).unwrap();
            });
        });
    }
}

/// Rows of an operation with changing pump, 10 s apart.
fn rows(simulation: &mut Simulation, pump: &str, speed: f64) -> Vec<Vec<f64>> {
    let signal = speed_signal(simulation, pump);
    (0..ROWS)
        .map(|i| {
            simulation.set(signal, speed * SPEEDS[i % SPEEDS.len()]).unwrap();
            let end = simulation.time() + Time(10 * NS_PER_S);
            simulation.advance_to(end, SECOND).unwrap();
            let mut row = vec![0.0; simulation.plan().channels().len()];
            simulation.fill_row(&mut row);
            row
        })
        .collect()
}

/// Time of `count` rows, each gathered and handed over; a new recorder every [`ROWS_PER_FILE`] rows.
fn record(
    simulation: &Simulation,
    rows: &[Vec<f64>],
    count: u64,
    mut recorder: impl FnMut() -> Box<dyn Recorder>,
) -> Duration {
    let channels = simulation.plan().channels();
    let mut gathered = vec![0.0; channels.len()];
    let mut spent = Duration::ZERO;
    let mut left = usize::try_from(count).unwrap();
    while left > 0 {
        let rows_now = left.min(ROWS_PER_FILE);
        let mut recorder = recorder();
        recorder.start(&RunHeader::default(), channels).unwrap();
        let start = Instant::now();
        for i in 0..rows_now {
            simulation.fill_row(black_box(&mut gathered));
            recorder.row(Time(i as i64 * 10 * NS_PER_S), &rows[i % rows.len()]).unwrap();
        }
        spent += start.elapsed();
        recorder.finish(&serde_json::Value::Null).unwrap();
        left -= rows_now;
    }
    spent
}

/// (d) A recorded row.
fn recorded_rows(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("rows.mcap");
    for (name, model, pump, speed) in small_networks() {
        let mut simulation = in_operation(&model);
        let rows = rows(&mut simulation, pump, speed);
        let mut gathered = vec![0.0; simulation.plan().channels().len()];
        group(criterion, "row gathered").bench_function(name, |bencher| {
            bencher.iter(|| simulation.fill_row(black_box(&mut gathered)));
        });
        group(criterion, "row to memory").bench_function(name, |bencher| {
            bencher.iter_custom(|count| {
                record(&simulation, &rows, count, || Box::<MemoryRecorder>::default())
            });
        });
        group(criterion, "row to file").bench_function(name, |bencher| {
            bencher.iter_custom(|count| {
                record(&simulation, &rows, count, || Box::new(McapRecorder::create(&file).unwrap()))
            });
        });
        print_size_of_run(name, build(&model).unwrap(), &file);
    }
}

/// Bytes per recorded value of the run that the model asks for.
fn print_size_of_run(name: &str, plan: Arc<Plan>, file: &Path) {
    let rows = plan.until().0 / plan.record_interval().0 + 1;
    let values = rows as f64 * plan.channels().len() as f64;
    let channels = plan.channels().len();
    let mut simulation = Simulation::new(plan).unwrap();
    let recorder = Box::new(McapRecorder::create(file).unwrap());
    run(&mut simulation, RunOptions::default(), recorder, &mut |_, _| true).unwrap();
    let bytes = std::fs::metadata(file).unwrap().len();
    println!(
        "{name}: {rows} rows of {channels} channels in {bytes} bytes, {:.2} bytes per value",
        bytes as f64 / values
    );
}

/// (e) From a changed model to a simulation.
fn builds(criterion: &mut Criterion) {
    for (name, model, pump, _) in small_networks() {
        let changes = [Change::Scale { parameter: format!("{pump}.rise_time_s"), factor: 1.01 }];
        group(criterion, "overlay").bench_function(name, |bencher| {
            bencher.iter(|| black_box(model.with(&changes).unwrap()));
        });
        group(criterion, "overlay and build").bench_function(name, |bencher| {
            bencher.iter(|| build(&model.with(&changes).unwrap()).unwrap());
        });
        let plan = build(&model).unwrap();
        group(criterion, "start of a simulation").bench_function(name, |bencher| {
            bencher.iter(|| Simulation::new(black_box(plan.clone())).unwrap());
        });
    }
    group(criterion, "read the model file")
        .bench_function("demo", |bencher| bencher.iter(|| model(black_box(DEMO))));
}

criterion_group!(benches, hydraulics, steps, pipes, recorded_rows, builds);
criterion_main!(benches);
