//! Memory of networks: `make bench-memory`.
//!
//! - `memory tables CONSUMERS FOLDER`: writes the model file and tables of a generated grid.
//! - `memory text CONSUMERS`: the same grid with a series for each load as one text, read and solved in this
//!   process; the memory after each phase.
//! - `memory folder FOLDER`: the phases of the model in a folder.
//! - `memory state CONSUMERS`: bytes of the state of such a grid and of its snapshot.
//!
//! Memory is what the system counts for the process; an edge is a pipe of one line, a station or the plant.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use anergy_benches::tables::write_two_pipe_tables;
use anergy_benches::{two_pipe_network_of_a_year, write_profiles};
use anergy_core::clock::{NS_PER_S, Time};
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use std::path::Path;

const SEED: u64 = 1;
const QUARTER: Time = Time(900 * NS_PER_S);

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let consumers = || arguments[1].parse().unwrap();
    match arguments.first().map(String::as_str) {
        Some("tables") => {
            let folder = Path::new(&arguments[2]);
            std::fs::create_dir_all(folder).unwrap();
            write_two_pipe_tables(consumers(), SEED, folder).unwrap();
        }
        Some("text") => phases(&generated(consumers()), Path::new(".")),
        Some("folder") => {
            let folder = Path::new(&arguments[1]);
            phases(&std::fs::read_to_string(folder.join("model.toml")).unwrap(), folder);
        }
        Some("state") => state(consumers()),
        _ => println!(
            "usage: memory tables CONSUMERS FOLDER | text CONSUMERS | folder FOLDER | state CONSUMERS"
        ),
    }
}

fn generated(consumers: usize) -> String {
    let profiles = std::env::temp_dir().join("anergy_profiles_of_a_year.csv");
    std::fs::write(&profiles, write_profiles(SEED)).unwrap();
    two_pipe_network_of_a_year(consumers, SEED, profiles.to_str().unwrap())
}

/// Prints the memory after each phase of a solve, with and without the model.
fn phases(text: &str, folder: &Path) {
    println!("| Phase | now, MB | peak, MB |\n|---|---|---|");
    let phase = |name: &str| {
        println!("| {name} | {:.0} | {:.0} |", status_mb("VmRSS:"), status_mb("VmHWM:"));
    };
    phase(&format!("text of {:.1} MB", text.len() as f64 / 1e6));
    let model = Model::from_toml(text, folder);
    let model = model.unwrap_or_else(|problems| panic!("{}", problems.render(text)));
    phase("model read");
    let plan = build(&model).unwrap();
    phase("plan built");
    drop(model);
    phase("model dropped");
    let mut simulation = Simulation::new(plan).unwrap();
    phase("simulation at its start");
    let report = steady::settle(&mut simulation).unwrap();
    phase("settled");
    let table = steady::table(&simulation, report);
    phase("table of results");
    let peak_mb = status_mb("VmHWM:");
    let edges = table.edges.len();
    println!(
        "{edges} edges, {} nodes: peak {peak_mb:.0} MB, {:.0} bytes per edge",
        table.nodes.len(),
        peak_mb * 1024.0 * 1024.0 / edges as f64
    );
}

/// Prints the size of the state after a day of a grid with a series for each load.
fn state(consumers: usize) {
    let text = generated(consumers);
    let model = Model::from_toml(&text, Path::new(".")).unwrap();
    let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
    let edges = simulation.plan().network().edges.len();
    for steps in [0, 96] {
        for _ in 0..steps {
            let next = simulation.time() + QUARTER;
            simulation.advance_to(next, QUARTER).unwrap();
        }
        let in_memory = simulation.state().bytes();
        let snapshot = simulation.snapshot().to_bytes().unwrap().len();
        println!(
            "after {steps} steps: {consumers} consumers, {edges} edges: state {in_memory} bytes, {} per \
             consumer; snapshot {snapshot} bytes, {} per consumer",
            in_memory / consumers,
            snapshot / consumers
        );
    }
}

/// A line of the process status, MB (0 where the system does not tell).
fn status_mb(field: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(field));
    line.and_then(|line| line.split_whitespace().next()?.parse().ok())
        .map_or(0.0, |kb: f64| kb / 1024.0)
}
