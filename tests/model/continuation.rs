//! State is data: snapshots, overlays and cut-out parts behave as the whole.
#![allow(clippy::unwrap_used)]

use anergy_control::controllers::ControllerParams;
use anergy_core::clock::Time;
use anergy_core::recorder::{Channel, Event, Recorder, Recording, RunHeader};
use anergy_simulation::build::build;
use anergy_simulation::isolate::{Cut, CutKind};
use anergy_simulation::model::{ControllerSpec, Model, Place};
use anergy_simulation::model_file::{Duration, StepEntry};
use anergy_simulation::overlay::{Change, OverlayError};
use anergy_simulation::run::{self, RunOptions};
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::workspace;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::rc::Rc;

fn model() -> Model {
    let dir = workspace().join("examples/three-houses");
    let text = std::fs::read_to_string(dir.join("model.toml")).unwrap();
    Model::from_toml(&text, &dir).unwrap()
}

/// The example with a PI controller on the flow of SF1, sampled every 0.7 s.
fn controlled() -> Model {
    let mut model = model();
    let params = json!({
        "set_point": 0.03, "gain": 0.6, "integral_time_s": 8.0, "interval_s": 0.7
    });
    model.controllers.push(ControllerSpec {
        id: "flow".into(),
        measures: vec!["sf1.feed_in_pump.m_flow_kg_s".into()],
        acts_on: vec!["sf1.feed_in_pump.speed".into()],
        params: ControllerParams::deserialize("pi", params).unwrap().unwrap(),
        place: Place::default(),
    });
    model
}

fn seconds(s: f64) -> Time {
    Time::from_s(s).unwrap()
}

fn simulation(model: &Model) -> Simulation {
    Simulation::new(build(model).unwrap()).unwrap()
}

/// Keeps the rows of a run.
struct Keep(Rc<RefCell<Recording>>);

impl Recorder for Keep {
    fn start(
        &mut self,
        header: &RunHeader,
        channels: &[Channel],
    ) -> Result<(), anergy_core::error::RecordError> {
        let mut recording = self.0.borrow_mut();
        recording.header = header.clone();
        recording.channels = channels.to_vec();
        recording.columns = vec![Vec::new(); channels.len()];
        Ok(())
    }

    fn row(&mut self, time: Time, values: &[f64]) -> Result<(), anergy_core::error::RecordError> {
        let mut recording = self.0.borrow_mut();
        recording.time_s.push(time.as_s());
        for (column, value) in recording.columns.iter_mut().zip(values) {
            column.push(*value);
        }
        Ok(())
    }

    fn event(&mut self, event: &Event) -> Result<(), anergy_core::error::RecordError> {
        self.0.borrow_mut().events.push(event.clone());
        Ok(())
    }

    fn finish(self: Box<Self>, summary: &Value) -> Result<(), anergy_core::error::RecordError> {
        self.0.borrow_mut().summary = summary.clone();
        Ok(())
    }
}

fn run_all(model: &Model, until_s: f64, step_s: f64) -> Recording {
    run_recorded(model, until_s, step_s, 10.0)
}

fn run_recorded(model: &Model, until_s: f64, step_s: f64, record_s: f64) -> Recording {
    let rows = Rc::new(RefCell::new(Recording::default()));
    let options = RunOptions {
        until: Some(seconds(until_s)),
        step: Some(StepEntry::Fixed(Duration(seconds(step_s)))),
        record: Some(seconds(record_s)),
    };
    let recorder = Box::new(Keep(rows.clone()));
    run::run(&mut simulation(model), options, recorder, &mut |_, _| true).unwrap();
    Rc::try_unwrap(rows).unwrap().into_inner()
}

#[test]
fn a_restored_snapshot_continues_bit_for_bit() {
    let model = controlled();
    let mut whole = simulation(&model);
    let mut first_half = simulation(&model);
    for simulation in [&mut whole, &mut first_half] {
        simulation.advance_to(seconds(2235.3), seconds(1.0)).unwrap();
    }
    let bytes = first_half.snapshot().to_bytes().unwrap();
    // Somewhere else in between: the solver's work space must not matter.
    let mut restored = simulation(&model);
    restored.advance_to(seconds(100.0), seconds(7.0)).unwrap();
    restored.restore_bytes(&bytes).unwrap();
    for simulation in [&mut whole, &mut restored] {
        simulation.advance_to(seconds(3000.0), seconds(1.0)).unwrap();
    }
    assert_eq!(whole.snapshot().to_bytes().unwrap(), restored.snapshot().to_bytes().unwrap());
    assert!(restored.restore_bytes(&bytes[..bytes.len() / 2]).is_err());
    let other = Model::from_toml(&model.text.replace("sf1", "x"), &workspace()).unwrap();
    let longer = Change::InsertInSeries {
        edge: "x.stub_hot".into(),
        id: "extra".into(),
        params: other.edge("x.stub_hot").unwrap().params.clone(),
    };
    let mut other = simulation(&other.with(&[longer]).unwrap());
    assert!(other.restore_bytes(&bytes).is_err());
}

#[test]
fn the_same_run_gives_the_same_bits() {
    let model = controlled();
    let (a, b) = (run_all(&model, 300.0, 1.0), run_all(&model, 300.0, 1.0));
    assert_eq!(a, b);
}

#[test]
fn neutral_changes_leave_the_model_identical() {
    let model = model();
    let pipe = model.edge("sf1-sf2.hot").unwrap().params.clone();
    let neutral = [
        Change::Scale { parameter: "sf1-sf2.hot.length_m".into(), factor: 1.0 },
        Change::Scale { parameter: "sf1.unit.v_flow_m3_s".into(), factor: 1.0 },
        Change::Set {
            parameter: "ground.temperature_k".into(),
            value: json!(model.ground.temperature_k),
        },
        Change::ReplaceElement { edge: "sf1-sf2.hot".into(), params: pipe },
        Change::WrapLaw { edge: "sf2.feed_in_pump".into(), loss_factor: 1.0 },
    ];
    let changed = model.with(&neutral).unwrap();
    assert_eq!(changed, model);
    let (a, b) = (run_all(&model, 120.0, 1.0), run_all(&changed, 120.0, 1.0));
    assert_eq!(a.columns, b.columns);
}

#[test]
fn changes_act_as_physics_says() {
    let model = model();
    let flow = |model: &Model| {
        let steady = steady::solve(model).unwrap();
        steady.edge("sf4.extraction_valve").unwrap().m_flow_kg_s
    };
    let base = flow(&model);
    // Twice the loss is, in a quadratic pipe, twice the length and twice the fittings.
    let wrapped = Change::WrapLaw { edge: "sf2-sf4.hot".into(), loss_factor: 2.0 };
    let doubled = ["length_m", "zeta"]
        .map(|field| Change::Scale { parameter: format!("sf2-sf4.hot.{field}"), factor: 2.0 });
    let (by_law, by_size) =
        (flow(&model.with(&[wrapped]).unwrap()), flow(&model.with(&doubled).unwrap()));
    assert!((by_law / by_size - 1.0).abs() < 1e-9 && by_law < base, "{by_law} {by_size} {base}");
    // The same resistance again, in series.
    let twin = Change::InsertInSeries {
        edge: "sf2-sf4.hot".into(),
        id: "twin".into(),
        params: model.edge("sf2-sf4.hot").unwrap().params.clone(),
    };
    assert!((flow(&model.with(&[twin]).unwrap()) / by_law - 1.0).abs() < 1e-9);
}

#[test]
fn impossible_changes_name_their_target() {
    let model = model();
    let error = |change: Change| model.with(&[change]).unwrap_err();
    let set = |parameter: &str, value: Value| Change::Set { parameter: parameter.into(), value };
    assert_eq!(
        error(set("sf1-sf2.hot.lenght_m", json!(1.0))),
        OverlayError::UnknownParameter { parameter: "sf1-sf2.hot.lenght_m".into() }
    );
    assert!(error(set("nobody.length_m", json!(1.0))).to_string().contains("nobody.length_m"));
    assert!(error(set("sf1-sf2.hot.length_m", json!("long"))).to_string().contains("length_m"));
    let scale = Change::Scale { parameter: "sf1-sf2.hot.friction".into(), factor: 2.0 };
    assert!(error(scale).to_string().contains("not a number"));
    assert!(matches!(
        error(Change::WrapLaw { edge: "nowhere".into(), loss_factor: 2.0 }),
        OverlayError::UnknownEdge { .. }
    ));
    // A value that the component refuses is found by the build, with the component's name.
    let negative = model.with(&[set("sf1-sf2.hot.length_m", json!(-1.0))]).unwrap();
    let problems = build(&negative).unwrap_err().to_string();
    assert!(
        problems.contains("sf1-sf2.hot") && problems.contains("must be positive"),
        "{problems}"
    );
}

#[test]
fn an_isolated_part_follows_the_whole() {
    let model = model();
    let whole = run_recorded(&model, 3600.0, 1.0, 1.0);
    let column = |name: &str| whole.column(name).unwrap().to_vec();
    let cut = |node: &str| Cut {
        node: node.into(),
        kind: CutKind::Pressure,
        times_s: whole.time_s.clone(),
        values: column(&format!("{node}.p_pa")),
        t_k: column(&format!("{node}.t_k")),
    };
    let parts: Vec<&str> = model
        .edges
        .iter()
        .map(|edge| edge.id.as_str())
        .filter(|id| id.starts_with("sf1"))
        .collect();
    let part = model.isolate(&parts, &[cut("sf2.hot"), cut("sf2.cold")]).unwrap();
    assert_eq!(part.units.len(), 1);
    let alone = run_recorded(&part, 3600.0, 1.0, 1.0);
    // The boundaries are the recorded rows, one per step; their temperatures are those at the end of the
    // step, where the whole has the mean of the step: fronts of 25 K differ by hundredths.
    for (name, tolerance) in
        [("sf1.station.m_flow_kg_s", 1e-6), ("sf1-sf2.hot.t_b_k", 0.1), ("sf1.unit.t_in_k", 0.1)]
    {
        let (a, b) = (whole.column(name).unwrap(), alone.column(name).unwrap());
        for (row, (a, b)) in a.iter().zip(b).enumerate().skip(1) {
            assert!((a - b).abs() < tolerance, "{name} row {row}: {a} {b}");
        }
    }
    let missing = model.isolate(&parts, &[cut("sf2.hot")]).unwrap_err().to_string();
    assert!(missing.contains("sf2.cold"), "{missing}");
    assert!(model.isolate(&["nothing"], &[]).is_err());
    // What no water passes comes along with its site.
    let dir = workspace().join("examples/three-houses");
    let text = std::fs::read_to_string(dir.join("model.toml")).unwrap();
    let load = |site| {
        format!("\n[[unit]]\nsite = \"{site}\"\nname = \"lamp\"\nkind = \"electric_load\"\n")
    };
    let model = Model::from_toml(&(text + &load("sf1") + &load("sf2")), &dir).unwrap();
    let part = model.isolate(&parts, &[cut("sf2.hot"), cut("sf2.cold")]).unwrap();
    let units: Vec<&str> = part.units.iter().map(|unit| unit.id.as_str()).collect();
    assert_eq!(units, ["sf1.unit", "sf1.lamp"]);
}

#[test]
fn every_run_closes_its_balances() {
    for model in [model(), controlled()] {
        for step_s in [0.5, 1.0, 13.0, 300.0] {
            let recording = run_all(&model, 3600.0, step_s);
            for balance in recording.summary["balances"].as_array().unwrap() {
                let error = balance["relative_error"].as_f64().unwrap();
                assert!(error < 1e-9, "step {step_s}: {balance}");
            }
            let mass = &recording.summary["statistics"]["largest mass residual in kg/s"];
            assert!(mass.as_f64().unwrap() < 1e-9);
        }
    }
}

#[test]
fn stopped_pumps_stop_the_water() {
    let stop = ["sf1", "sf2"].map(|site| Change::Set {
        parameter: format!("{site}.feed_in_pump.speed"),
        value: json!(0.0),
    });
    let mut model = model().with(&stop).unwrap();
    model.drivers.clear();
    for edge in steady::solve(&model).unwrap().edges {
        assert!(edge.m_flow_kg_s.abs() < 1e-8, "{}: {}", edge.id, edge.m_flow_kg_s);
    }
}

#[test]
fn a_controller_is_settled_in_the_steady_solve() {
    let flow =
        |model: &Model| steady::solve(model).unwrap().edge("sf1.feed_in_pump").unwrap().m_flow_kg_s;
    assert!((flow(&controlled()) - 0.03).abs() < 1e-8);
    // A set point beyond the pump leaves it at full speed: 2.050 l/min (SC-01).
    let mut impossible = controlled();
    let ControllerParams::Pi(pi) = &mut impossible.controllers[0].params else { panic!() };
    pi.set_point = 0.2;
    assert!((flow(&impossible) * 60.0 - 2.050).abs() < 0.01, "{}", flow(&impossible) * 60.0);
}

#[test]
fn the_plain_form_is_the_same_model() {
    let model = controlled();
    let plain = Model::from_toml(&model.to_plain_toml().unwrap(), &workspace()).unwrap();
    let (a, b) = (steady::solve(&model).unwrap(), steady::solve(&plain).unwrap());
    assert_eq!(a, b);
    let (a, b) = (run_all(&model, 120.0, 1.0), run_all(&plain, 120.0, 1.0));
    assert_eq!(a.columns, b.columns);
}
