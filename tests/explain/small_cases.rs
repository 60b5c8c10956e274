//! `explain` on small cases: a hidden effect is named, found again where there is none, and its entry is a model.

#![allow(clippy::unwrap_used)]

use anergy_discrepancy::addition::{added, reverted};
use anergy_discrepancy::data;
use anergy_discrepancy::experiment::Experiment;
use anergy_discrepancy::explain::{Explanation, Verdict, explain};
use anergy_discrepancy::sensors::SensorFile;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_tests::workspace;
use std::path::Path;

fn file(name: &str) -> String {
    std::fs::read_to_string(workspace().join("examples/hidden-effect").join(name)).unwrap()
}

fn explained(model: &str, data: &str) -> Explanation {
    let sensors = SensorFile::from_toml(&file("sensors.toml")).unwrap();
    let runs = data::read(data, &sensors).unwrap();
    let model = Model::from_toml(model, Path::new(".")).unwrap();
    explain(&Experiment::new(model, sensors, runs).unwrap(), None).unwrap()
}

#[test]
fn the_hidden_wall_is_named_and_the_model_with_it_has_nothing_left() {
    let (model, data) = (file("model.toml"), file("data.csv"));
    let found = explained(&model, &data);
    assert_eq!(found.verdict, Verdict::Named, "{found:#?}");
    let [wall] = &found.effects[..] else { panic!("{:?}", found.effects) };
    assert_eq!((wall.id, wall.component.as_str()), ("P1", "street"));
    // 7850 * 470 * pi/4 (0.0483^2 - 0.0431^2) = 1377 J/(m K), which the interval holds.
    assert!(wall.estimate.lo < 1377.0 && 1377.0 < wall.estimate.hi, "{:?}", wall.estimate);
    let all = found.gaps.iter().find(|gap| gap.part == anergy_discrepancy::split::Use::Show);
    let gap = all.unwrap();
    assert!(gap.rmse_after < 0.2 * gap.rmse_before, "{gap:?}");

    let text = added(&model, &found.effects, &found.because);
    build(&Model::from_toml(&text, Path::new(".")).unwrap()).unwrap();
    assert_eq!(reverted(&text, "P1").unwrap(), model);
    let again = explained(&text, &data);
    assert_eq!(again.verdict, Verdict::Nothing, "{again:#?}");
    assert!(again.effects.is_empty());
}

#[test]
fn data_that_contradict_themselves_are_not_fitted() {
    let (model, data) = (file("model.toml"), file("data.csv"));
    let changed = |change: &dyn Fn(&mut [f64])| -> Explanation {
        let mut lines = data.lines();
        let mut out = lines.next().unwrap().to_owned();
        for line in lines {
            let mut cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            change(&mut cells);
            let cells: Vec<String> = cells.iter().map(f64::to_string).collect();
            out = format!("{out}\n{}", cells.join(","));
        }
        explained(&model, &out)
    };
    for (change, words) in [
        (&(|cells: &mut [f64]| cells[3] = 50.0) as &dyn Fn(&mut [f64]), "never changes"),
        (&|cells: &mut [f64]| cells[3] += 273.15, "K and degC confused"),
        (&|cells: &mut [f64]| cells[3] = cells[1], "the same, reading for reading"),
        (&|cells: &mut [f64]| cells[2] /= 3.6, "\"flow_kg_h\" fits far better with"),
    ] {
        let found = changed(change);
        assert_eq!(found.verdict, Verdict::DataProblem);
        assert!(found.because.contains(words), "{}", found.because);
        assert!(found.effects.is_empty());
    }
}
