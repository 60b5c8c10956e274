//! SC-07: the limit of each loop and group without simulating, against the analytic limit and simulation.

use anergy_core::clock::Time;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::stability::{Hunting, hunting};
use anergy_tests::workspace;

/// The example with N feeders, changed by replacing words.
fn model(n: usize, changes: &[(&str, &str)]) -> Model {
    let folder = workspace().join("examples/pump-hunting");
    let mut text = std::fs::read_to_string(folder.join(format!("n{n}.toml"))).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    Model::from_toml(&text, &folder).unwrap()
}

fn analysis(model: &Model) -> Hunting {
    hunting(&Simulation::new(build(model).unwrap()).unwrap()).unwrap()
}

#[test]
fn critical_gains_are_those_of_the_analytic_limit() {
    // K_c G = 2.887 (phase -180 deg at 0.6144 rad/s) with G = u H0/(K_own V): 0.276, 0.0271, 0.0183 per l/min
    for (n, critical) in [(1, 0.276), (2, 0.0271), (3, 0.0183)] {
        let found = analysis(&model(n, &[]));
        println!("{found:#?}");
        for controller in &found.controllers {
            let gain = controller.critical_gain.unwrap() / 60.0;
            assert!((gain / critical - 1.0).abs() < 0.02, "N = {n}: {gain}");
        }
    }
}
