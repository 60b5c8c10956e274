//! Repeats one warm hydraulic solve of a generated two-pipe network, for instruction counts:
//! `warm_solve EDGES REPEATS`. `make instructions` runs it under callgrind with two numbers of repeats;
//! the difference is what the solves alone execute.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use anergy_benches::two_pipe_network_with_edges;
use anergy_network::hydraulics::HydraulicSolver;
use anergy_network::state::NetworkState;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use std::path::Path;

/// Pump speeds taken in turn, as in the bench `hydraulics warm`.
const SPEEDS: [f64; 7] = [1.0, 0.997, 1.002, 0.995, 0.999, 0.993, 0.998];

fn main() {
    let mut arguments =
        std::env::args().skip(1).map(|argument| argument.parse().unwrap_or(1000_usize));
    let (edges, repeats) = (arguments.next().unwrap_or(1000), arguments.next().unwrap_or(100));
    let model = Model::from_toml(&two_pipe_network_with_edges(edges, 1), Path::new(".")).unwrap();
    let plan = build(&model).unwrap();
    let network = plan.network();
    let mut state = NetworkState::new(network, 323.15);
    state.given_p_pa.fill(1.5e5);
    let pump = plan.edge_names().iter().position(|edge| edge == "plant.feed_in_pump").unwrap();
    let valves: Vec<usize> = (0..network.edges.len())
        .filter(|&i| plan.edge_names()[i].ends_with("extraction_valve"))
        .step_by(10)
        .collect();
    let at_rest = state.position.clone();
    let mut solver = HydraulicSolver::new(network).unwrap();
    let mut iterations = 0;
    for repeat in 0..=repeats {
        let factor = SPEEDS[repeat % SPEEDS.len()];
        state.position[pump] = 0.99 * factor;
        for &valve in &valves {
            state.position[valve] = at_rest[valve] * factor.min(1.0);
        }
        state.invalidate_hydraulics();
        let report = solver.solve(network, &mut state).unwrap();
        if repeat > 0 {
            iterations += report.iterations;
        }
    }
    println!("{} edges, {repeats} warm solves, {iterations} iterations", network.edges.len());
}
