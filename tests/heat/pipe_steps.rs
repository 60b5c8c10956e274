//! The error of the steps of a pipe with wall and loss, against steps of 1 s.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::pages::write_table;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

/// Means over 240 s of what leaves a steel pipe of 100 m, DN 100, at 1 kg/s, in K; the inlet swings by 20 K in 80 minutes.
fn outlet_k(wall: &str, step_s: u32) -> Vec<f64> {
    let text = format!(
        "format = 1\n[run]\ninitial_k = 330\n\
         [[node]]\nid = \"in\"\nkind = \"source\"\nm_flow_kg_s = 1\ntemperature_k = 330\n\
         [[node]]\nid = \"out\"\nkind = \"pressure_boundary\"\npressure_bar = 1\n\
         [[edge]]\nid = \"pipe\"\nkind = \"pipe\"\nfrom = \"in\"\nto = \"out\"\nlength_m = 100\n\
         inner_diameter_mm = 100\nouter_diameter_mm = 108\ninsulation_resistance_k_m_w = 2\nwall = \"{wall}\"\n"
    );
    let model =
        Model::from_toml(&text, Path::new(".")).unwrap_or_else(|p| panic!("{}", p.render(&text)));
    let plan = build(&model).unwrap_or_else(|p| panic!("{}", p.render(&text)));
    let mut simulation = Simulation::new(plan).unwrap();
    let inlet = simulation.signal("in.temperature_k").unwrap();
    let outlet = simulation.channel("out.t_k").unwrap();
    let step = Time::from_s(f64::from(step_s)).unwrap();
    let omega = TAU / 4800.0;
    let mut steps = Vec::new();
    for k in 0..9600 / step_s {
        // The inlet of a step is its mean, as behind a mixed node.
        let (from, to) = (f64::from(k * step_s), f64::from((k + 1) * step_s));
        let mean = ((omega * from).cos() - (omega * to).cos()) / (omega * (to - from));
        simulation.set(inlet, 330.0 + 20.0 * mean).unwrap();
        simulation.advance_to(Time::from_s(to).unwrap(), step).unwrap();
        steps.push(simulation.get(outlet));
    }
    let mean = |c: &[f64]| c.iter().sum::<f64>() / c.len() as f64;
    steps.chunks((240 / step_s) as usize).map(mean).collect()
}

#[test]
fn the_splitting_error_falls_at_least_with_the_step() {
    let mut table = String::from("| wall | 240 s | 120 s | 60 s | 30 s |\n|---|---|---|---|---|\n");
    for (wall, words) in [("equilibrium", "parcels"), ("film", "cells")] {
        let exact = outlet_k(wall, 1);
        let error = |step_s: u32| {
            let outlet = outlet_k(wall, step_s);
            outlet.iter().zip(&exact).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()))
        };
        let errors = [240, 120, 60, 30].map(error);
        // The floor of the parcels is what merging may change (1e-3 K).
        for pair in errors.windows(2) {
            assert!(pair[1] < 0.55 * pair[0] || pair[0] < 2e-3, "{wall}: {errors:?}");
        }
        let cells = errors.map(|e| format!("{e:.4}")).join(" | ");
        writeln!(table, "| `{wall}` ({words}) | {cells} |").unwrap();
    }
    write_table("pipe_steps", "errors", "cargo test --workspace --test heat pipe_steps::", &table);
}
