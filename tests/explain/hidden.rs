//! `explain` on cases of the independent truth generator (`tests/hidden_effects`): a small fixed part of what
//! `make explain-score` runs. The files are those of `cases.py --rig R1 --seed 11 --draws 2 --nulls 2`,
//! of `cases.py fixed --rig R1 --seed 12 --sensors poor --effect S3 T_house 100`, and two of fresh scores.

#![allow(clippy::unwrap_used)]

use anergy_discrepancy::data;
use anergy_discrepancy::experiment::Experiment;
use anergy_discrepancy::explain::{Explanation, Verdict, explain};
use anergy_discrepancy::sensors::SensorFile;
use anergy_discrepancy::split::SplitFile;
use anergy_simulation::model::Model;
use anergy_tests::workspace;
use std::path::Path;

fn explained(case: &str) -> Explanation {
    let folder = workspace().join("tests/hidden_effects/fixed").join(case);
    let file = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let sensors = SensorFile::from_toml(&file("sensors.toml")).unwrap();
    let runs = data::read(&file("data.csv"), &sensors).unwrap();
    let model = Model::from_toml(&file("model.toml"), Path::new(".")).unwrap();
    let split = SplitFile::from_toml(&file("split.toml")).unwrap();
    explain(&Experiment::new(model, sensors, runs).unwrap(), Some(&split)).unwrap()
}

#[test]
fn at_the_edge_of_every_tolerance_there_is_nothing() {
    let found = explained("R1-12-01");
    assert_eq!(found.verdict, Verdict::Nothing, "{found:#?}");
    assert!(found.effects.is_empty());
}

#[test]
fn an_offset_of_one_of_two_sensors_is_found_but_not_which() {
    // The sensor of the outlet reads 1.79 K too much; one of the inlet that reads too little looks the same.
    let found = explained("R1-12-03");
    let class: Vec<(&str, &str)> =
        found.class.iter().map(|f| (f.id, f.component.as_str())).collect();
    assert_eq!(found.verdict, Verdict::Class, "{:?}", found.because);
    assert!(class.contains(&("S1", "T_house")) && class.iter().all(|c| c.0 == "S1"), "{class:?}");
    let bias = found.effects[0].estimate;
    assert!(bias.lo < 1.79 && 1.79 < bias.hi, "{bias:?}");
}

#[test]
fn kelvin_for_celsius_is_a_problem_of_the_data() {
    let found = explained("R1-12-10");
    assert_eq!(found.verdict, Verdict::DataProblem);
    assert!(found.because.contains("T_in") && found.effects.is_empty(), "{}", found.because);
}

#[test]
fn a_drift_of_one_of_two_sensors_is_found_but_not_which() {
    // The outlet drifts by -0.62 K in the run; an inlet that drifts by as much the other way looks the same.
    let found = explained("R1-12-S3");
    let class: Vec<(&str, &str)> =
        found.class.iter().map(|f| (f.id, f.component.as_str())).collect();
    assert_eq!(found.verdict, Verdict::Class, "{:?}", found.because);
    assert!(class.contains(&("S3", "T_house")) && class.iter().all(|c| c.0 == "S3"), "{class:?}");
    let drift = found.class.iter().find(|f| f.component == "T_house").unwrap().estimate;
    assert!(drift.lo < -0.62 && -0.62 < drift.hi, "{drift:?}");
}

/// A pump with 0.7 of its head is blocked by the other one, and the meter of that is slow. A speed in another unit, and another command in
/// its place, take away much of the gap and fit nothing.
#[test]
fn a_blocked_pump_is_no_problem_of_the_data() {
    let found = explained("R3-13000006-11");
    let effects: Vec<(&str, &str)> =
        found.effects.iter().map(|f| (f.id, f.component.as_str())).collect();
    assert_eq!(effects, [("H3", "pump1"), ("S4", "flow_2")], "{:?}", found.because);
    let head = found.effects[0].estimate;
    assert!(head.lo < 0.7 && 0.7 < head.hi, "{head:?}");
}

/// A clock that is 60 s slow: a flow in another unit would take away four fifths of it.
#[test]
fn a_slow_clock_is_no_unit_of_a_flow() {
    let found = explained("R1-14000004-08");
    let effects: Vec<(&str, &str)> =
        found.effects.iter().map(|f| (f.id, f.component.as_str())).collect();
    assert_eq!(effects, [("S7", "T_house")], "{:?}", found.because);
    let clock = found.effects[0].estimate;
    assert!(clock.lo < 59.95 && 59.95 < clock.hi, "{clock:?}");
}
