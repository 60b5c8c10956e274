//! Times of the hydraulics of a model, as JSON: `solve_timing MODEL SECONDS`. For the comparison with
//! other programs in `benches/peers`.
//!
//! *cold*: analysis of the pattern, then a solve from the start flows; *warm*: a solve from the last
//! flows after all given flows changed by 5 % (without any: all pump speeds by 2 %); *iteration*: a
//! cold solve without its analysis over its iterations, that is one evaluation, factorisation and
//! solution. Minimum and median of the repeats within the time.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use anergy_network::hydraulics::HydraulicSolver;
use anergy_network::state::NetworkState;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use std::path::Path;
use std::time::{Duration, Instant};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().unwrap_or_default();
    let seconds = arguments.next().and_then(|s| s.parse().ok()).unwrap_or(1.0);
    let path = Path::new(&path);
    let text = std::fs::read_to_string(path).unwrap();
    let model = Model::from_toml(&text, path.parent().unwrap())
        .unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
    let simulation = Simulation::new(build(&model).unwrap()).unwrap();
    let plan = simulation.plan().clone();
    let network = plan.network();
    // What is given at t = 0, with the start flows of a first solve.
    let mut state = NetworkState::new(network, model.run.initial_k);
    let given = simulation.network_state();
    state.given_p_pa.copy_from_slice(&given.given_p_pa);
    state.given_m_flow_kg_s.copy_from_slice(&given.given_m_flow_kg_s);
    state.position.copy_from_slice(&given.position);
    state.prescribed.clone_from(&given.prescribed);

    let (start_m_kg_s, start_p_pa) = (state.m_flow_kg_s.clone(), state.p_pa.clone());
    let (demands_kg_s, positions) = (state.given_m_flow_kg_s.clone(), state.position.clone());
    let cold_start = |state: &mut NetworkState| {
        state.m_flow_kg_s.copy_from_slice(&start_m_kg_s);
        state.p_pa.copy_from_slice(&start_p_pa);
        state.position.copy_from_slice(&positions);
        state.prescribed.clone_from(&given.prescribed);
        state.invalidate_hydraulics();
    };
    let mut solver = HydraulicSolver::new(network).unwrap();
    let report = solver.solve(network, &mut state).unwrap();
    let cold = repeat(seconds, || {
        cold_start(&mut state);
        let start = Instant::now();
        let mut solver = HydraulicSolver::new(network).unwrap();
        solver.solve(network, &mut state).unwrap();
        start.elapsed()
    });
    let from_rest = repeat(seconds, || {
        cold_start(&mut state);
        let start = Instant::now();
        solver.solve(network, &mut state).unwrap();
        start.elapsed()
    });
    let kinds = model.edges.iter().map(|edge| edge.params.kind());
    let pumps: Vec<usize> =
        kinds.enumerate().filter(|(_, kind)| *kind == "pump").map(|(i, _)| i).collect();
    let demands = demands_kg_s.iter().any(|m| *m != 0.0);
    let (mut warm_iterations, mut solves, mut low) = (0, 0_u32, false);
    let warm = repeat(seconds, || {
        low = !low;
        if demands {
            let share = if low { 0.95 } else { 1.0 };
            for (m, full) in state.given_m_flow_kg_s.iter_mut().zip(&demands_kg_s) {
                *m = share * full;
            }
        } else {
            let share = if low { 0.98 } else { 1.0 };
            for &pump in &pumps {
                state.position[pump] = share * positions[pump];
            }
        }
        state.invalidate_hydraulics();
        let start = Instant::now();
        warm_iterations += solver.solve(network, &mut state).unwrap().iterations;
        solves += 1;
        start.elapsed()
    });
    let us = |times: &[Duration]| {
        let us = |time: Duration| time.as_secs_f64() * 1e6;
        serde_json::json!({ "min": us(times[0]), "median": us(times[times.len() / 2]) })
    };
    let iteration = from_rest[0].as_secs_f64() * 1e6 / f64::from(report.iterations);
    println!(
        "{}",
        serde_json::json!({
            "edges": network.edges.len(),
            "nodes": network.nodes.len(),
            "cold_us": us(&cold),
            "cold_iterations": report.iterations,
            "iteration_us": iteration,
            "warm_us": us(&warm),
            "warm_iterations": f64::from(warm_iterations) / f64::from(solves),
            "warm_over_iteration": warm[0].as_secs_f64() * 1e6 / iteration,
            "peak_memory_mb": peak_memory_mb(),
        })
    );
}

/// Times of repeats, sorted; at least three, then until the time is over.
fn repeat(seconds: f64, mut run: impl FnMut() -> Duration) -> Vec<Duration> {
    let start = Instant::now();
    let mut times = Vec::new();
    while times.len() < 3 || start.elapsed().as_secs_f64() < seconds {
        times.push(run());
    }
    times.sort();
    times
}

/// Largest resident memory of this process so far, MB; 0 where it is not known.
fn peak_memory_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let kb = line.and_then(|line| line.split_whitespace().nth(1)).and_then(|kb| kb.parse().ok());
    kb.unwrap_or(0.0) / 1024.0
}
