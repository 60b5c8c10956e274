//! Members give the same numbers whatever runs them, what fails is told, a killed ensemble goes on.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_core::error::RecordError;
use anergy_core::recorder::{Channel, Event, MemoryRecorder, Recorder, RunHeader};
use anergy_ensemble::definition::Definition;
use anergy_ensemble::ensemble::{Ensemble, EnsembleError};
use anergy_ensemble::member::Outcome;
use anergy_ensemble::store::{Store, StoreError, difference};
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use anergy_simulation::run;
use anergy_simulation::simulation::Simulation;
use serde_json::{Value, json};
use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

/// Keeps a recording that outlives the run.
struct Into<'a>(&'a mut MemoryRecorder);

impl Recorder for Into<'_> {
    fn start(&mut self, header: &RunHeader, channels: &[Channel]) -> Result<(), RecordError> {
        self.0.start(header, channels)
    }
    fn row(&mut self, time: Time, values: &[f64]) -> Result<(), RecordError> {
        self.0.row(time, values)
    }
    fn event(&mut self, event: &Event) -> Result<(), RecordError> {
        self.0.event(event)
    }
    fn finish(self: Box<Self>, summary: &Value) -> Result<(), RecordError> {
        self.0.recording.summary = summary.clone();
        Ok(())
    }
}

const MODEL: &str = include_str!("../../../examples/three-houses/model.toml");
const VARIATIONS: &str = r#"
format = 1
[ensemble]
design = "latin_hypercube"
members = 12
seed = 5
[run]
until = "10min"
step = "5s"
record = "1min"
[keep]
kpis = ["network.*", "sf1.station.*"]
channels = ["sf1.station.m_flow_kg_s", "sf4.hot"]
[[variation]]
parameter = "sf1.feed_in_pump.speed"
low = 0.9
high = 1.0
[[variation]]
name = "street"
parameters = ["sf1-sf2.*.length_km"]
mean = 0.2
standard_deviation = 0.02
[[variation]]
name = "insulation"
parameter = "*.insulation_resistance_k_m_w"
how = "scale"
low = 0.8
mode = 1.0
high = 1.2
"#;

fn model(text: &str) -> Arc<Model> {
    Arc::new(Model::from_toml(text, Path::new(".")).unwrap())
}

fn ensemble(variations: &str) -> Ensemble {
    Ensemble::new(model(MODEL), Definition::from_toml(variations).unwrap()).unwrap()
}

fn all(ensemble: &Ensemble, threads: usize) -> Vec<Outcome> {
    let members: Vec<usize> = (0..ensemble.len()).collect();
    let mut outcomes = Vec::new();
    ensemble.run_all(&members, threads, &mut |outcome| {
        outcomes.extend(outcome);
        true
    });
    outcomes.sort_by_key(|outcome| outcome.member);
    outcomes
}

#[test]
fn threads_do_not_change_a_bit_and_members_are_runs_of_changed_models() {
    let ensemble = ensemble(VARIATIONS);
    let (one, three) = (all(&ensemble, 1), all(&ensemble, 3));
    assert_eq!(one, three);
    assert_eq!(one.len(), 12);
    // Both pipes of the trench (in m) and every pipe: 2 trenches of 2, 3 stations of 2 stubs.
    let changes = ensemble.changes(7);
    let set = |parameter: &str| {
        changes.iter().find_map(|change| match change {
            Change::Set { parameter: name, value } if name == parameter => value.as_f64(),
            _ => None,
        })
    };
    let street_km = one[7].values[1].as_f64().unwrap();
    assert_eq!(set("sf1-sf2.hot.length_m"), Some(street_km * 1000.0));
    assert_eq!(set("sf1-sf2.cold.length_m"), Some(street_km * 1000.0));
    assert_eq!(changes.iter().filter(|c| matches!(c, Change::Scale { .. })).count(), 10);
    // The same by hand.
    let changed = ensemble.model().with(&changes).unwrap();
    let mut simulation = Simulation::new(build(&changed).unwrap()).unwrap();
    let mut memory = MemoryRecorder::default();
    let recorder = Box::new(Into(&mut memory));
    run::run(&mut simulation, ensemble.options(), recorder, &mut |_, _| true).unwrap();
    let recording = memory.recording;
    let kept = one[7].result.as_ref().unwrap();
    let told = &recording.summary["kpis"];
    assert_eq!(kept.kpis["network.heat_lost_kwh"], told["network"]["heat_lost_kwh"]);
    let given = "heat_given_kwh";
    assert_eq!(kept.kpis[&format!("sf1.station.{given}")], told["stations"]["sf1.station"][given]);
    assert!(
        kept.kpis
            .keys()
            .all(|name| name.starts_with("network.") || name.starts_with("sf1.station."))
    );
    let flow = recording.channels.iter().position(|c| c.name == "sf1.station.m_flow_kg_s").unwrap();
    assert_eq!(ensemble.channels()[0], "sf1.station.m_flow_kg_s");
    assert_eq!(kept.series.columns[0], recording.columns[flow]);
    assert_eq!(kept.series.time_s, recording.time_s);
    assert_eq!(kept.series.time_s.len(), 11);
}

#[test]
fn members_that_fail_are_told_and_the_others_go_on() {
    let text = "format = 1\n[run]\nuntil = \"1min\"\n[[variation]]\nparameter = \"sf1-sf2.hot.length_m\"\n\
                values = [100, -1, \"long\", 200]\n";
    let outcomes = all(&ensemble(text), 2);
    assert_eq!(outcomes.len(), 4);
    assert!(outcomes[0].result.is_ok() && outcomes[3].result.is_ok());
    let messages: Vec<&String> = outcomes.iter().filter_map(|o| o.result.as_ref().err()).collect();
    assert!(messages[0].contains("length_m = -1"), "{messages:?}");
    assert!(messages[1].contains("sf1-sf2.hot.length_m"), "{messages:?}");
}

#[test]
fn a_stopped_ensemble_hears_no_more() {
    let ensemble = ensemble(VARIATIONS);
    let members: Vec<usize> = (0..12).collect();
    let mut count = 0;
    ensemble.run_all(&members, 2, &mut |outcome| {
        count += usize::from(outcome.is_some());
        count < 3
    });
    assert_eq!(count, 3);
}

const NOISY: &str = "\n[[sensor]]\nid = \"meter\"\nmeasures = \"sf2.station.m_flow_kg_s\"\nnoise = 0.01\nseed = 9\n";

#[test]
fn members_of_a_sample_draw_random_numbers_of_their_own() {
    let model = model(&format!("{MODEL}{NOISY}"));
    let readings = |random: &str| {
        let text = format!(
            "format = 1\n[ensemble]\ndesign = \"monte_carlo\"\nmembers = 2\n{random}\n[run]\nuntil = \"1min\"\n\
             [keep]\nchannels = [\"meter.value\"]\n[[variation]]\nparameter = \"sf1.feed_in_pump.speed\"\nvalues = [1.0]\n"
        );
        let ensemble = Ensemble::new(model.clone(), Definition::from_toml(&text).unwrap()).unwrap();
        let (once, again) = (all(&ensemble, 1), all(&ensemble, 2));
        assert_eq!(once, again);
        let column = |o: &Outcome| o.result.as_ref().unwrap().series.columns[0].clone();
        [column(&once[0]), column(&once[1])]
    };
    let [first, second] = readings("");
    assert_ne!(first, second);
    let [first, second] = readings("random = \"same\"");
    assert_eq!(first, second);
}

fn fill(ensemble: &Ensemble, folder: &Path, most: usize) {
    let mut store = Store::open(folder, ensemble).unwrap();
    let pending = store.pending(ensemble.len());
    let mut left = most;
    ensemble.run_all(&pending, 2, &mut |outcome| {
        if let Some(outcome) = outcome {
            store.keep(&outcome).unwrap();
            left -= 1;
        }
        left > 0
    });
    store.write_table().unwrap();
}

#[test]
fn a_killed_ensemble_goes_on_and_equals_the_uninterrupted_one() {
    let ensemble = ensemble(VARIATIONS);
    let (whole, killed) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    fill(&ensemble, whole.path(), usize::MAX);
    fill(&ensemble, killed.path(), 5);
    // Killed within a line, and within the file of a channel.
    let journal = killed.path().join("journal.jsonl");
    let text = std::fs::read(&journal).unwrap();
    std::fs::write(&journal, &text[..text.len() - 40]).unwrap();
    std::fs::write(killed.path().join("channels/member-000003.csv.part"), "time_").unwrap();
    let store = Store::open(killed.path(), &ensemble).unwrap();
    assert_eq!((store.finished(), store.pending(12).len()), (4, 8));
    drop(store);
    fill(&ensemble, killed.path(), usize::MAX);
    let read = |folder: &Path, name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    for member in 0..12 {
        let name = format!("channels/member-{member:06}.csv");
        assert_eq!(read(whole.path(), &name), read(killed.path(), &name));
    }
    let table = read(whole.path(), "members.csv");
    assert_eq!(table, read(killed.path(), "members.csv"));
    let mut lines = table.lines();
    let head = "member,sf1.feed_in_pump.speed,street,insulation,error,network.";
    assert!(lines.next().unwrap().starts_with(head), "{table}");
    assert_eq!(lines.count(), 12);
    // Numbers of the table are those of the members, bit for bit.
    let value = all(&ensemble, 1)[11].values[0].as_f64().unwrap();
    let cell = table.lines().last().unwrap().split(',').nth(1).unwrap().parse::<f64>().unwrap();
    assert_eq!(cell.to_bits(), value.to_bits());
}

#[test]
fn a_folder_belongs_to_one_ensemble() {
    let folder = tempfile::tempdir().unwrap();
    drop(Store::open(folder.path(), &ensemble(VARIATIONS)).unwrap());
    assert!(Store::open(folder.path(), &ensemble(VARIATIONS)).is_ok());
    let other = ensemble(&VARIATIONS.replace("seed = 5", "seed = 6"));
    let error = Store::open(folder.path(), &other).unwrap_err();
    assert!(matches!(&error, StoreError::Other { what, .. } if *what == "variations"), "{error}");
    let warmer = MODEL.replace("temperature_degc = 12", "temperature_degc = 13");
    let definition = Definition::from_toml(VARIATIONS).unwrap();
    let other = Ensemble::new(model(&warmer), definition).unwrap();
    let error = Store::open(folder.path(), &other).unwrap_err().to_string();
    assert!(error.contains("other model"), "{error}");
}

#[test]
fn objects_and_texts_say_the_same() {
    let object = json!({
        "ensemble": { "design": "grid" },
        "variation": [{ "parameter": "ground.temperature_degc", "values": [5, 10] }]
    });
    let Value::Object(object) = object else { unreachable!() };
    let definition = Definition::from_json(&object).unwrap();
    let ensemble = Ensemble::new(model(MODEL), definition).unwrap();
    let set = Change::Set { parameter: "ground.temperature_k".into(), value: json!(283.15) };
    assert_eq!(ensemble.changes(1), [set]);
}

/// Message and hint of the first problem of a definition, with its place.
fn refusal(text: &str) -> String {
    let problems = match Definition::from_toml(text) {
        Err(problems) => problems,
        Ok(definition) => match Ensemble::new(model(MODEL), definition) {
            Err(EnsembleError::Variations(problems)) => problems,
            other => panic!("{other:?}"),
        },
    };
    problems.render(text)
}

#[test]
fn what_is_wrong_is_told_with_place_and_hint() {
    let one = "[[variation]]\nparameter = \"ground.temperature_k\"\nvalues = [280]\n";
    for (text, expected) in [
        (format!("format = 1\n[ensemble]\nmember = 3\n{one}"), "3:1: ensemble: unknown field `member`\n    hint: did you mean `members`?"),
        (format!("format = 1\n[ensembel]\n{one}"), "2:2: unknown section `ensembel`\n    hint: did you mean `ensemble`?"),
        (one.to_owned(), "1:1: format is missing"),
        ("format = 1\n".to_owned(), "there is no [[variation]]"),
        (format!("format = 1\n{one}value = 3\n"), "5:1: variation \"ground.temperature_k\": unknown field `value`\n    hint: did you mean `values`?"),
        (format!("format = 1\n[ensemble]\ndesign = \"monte_carlo\"\n{one}"), "3:10: ensemble: members is missing"),
        (format!("format = 1\n[ensemble]\nmembers = 4\n{one}"), "3:11: ensemble: members belongs to samples"),
        (format!("format = 1\n[run]\nuntil = \"soon\"\n{one}"), "3:9: run: "),
        (format!("format = 1\n[keep]\nchannels = [\"sf1.staton.m_flow_kg_s\"]\n{one}"), "3:12: keep: no channel matches \"sf1.staton.m_flow_kg_s\": did you mean"),
        ("format = 1\n[[variation]]\nparameter = \"sf1-sf2.hot.lenght_m\"\nvalues = [1]\n".into(), "3:13: variation \"sf1-sf2.hot.lenght_m\": there is no parameter \"sf1-sf2.hot.lenght_m\"\n    hint: did you mean `sf1-sf2.hot.length_m`?"),
        ("format = 1\n[[variation]]\nparameter = \"sf2.feed_in_pump.speed\"\nvalues = [1]\n".into(), "follows a schedule or a series: its own value is never used"),
        ("format = 1\n[[variation]]\nparameter = \"ground.temperature_k\"\nlow = 280\nhigh = 290\n".into(), "4:7: variation \"ground.temperature_k\": a distribution has no values to go through\n    hint: add count"),
        ("format = 1\n[[variation]]\nparameter = \"ground.temperature_degc\"\nvalues = [2.0]\nhow = \"scale\"\n".into(), "in degC cannot be scaled"),
        ("format = 1\n[ensemble]\ndesign = \"points\"\npoints = [[0.5], [0.5, 1.5]]\n[[variation]]\nparameter = \"ground.temperature_k\"\nlow = 280\nhigh = 290\n".into(), "4:10: ensemble: points[1] has 2 numbers for 1 variations"),
        (format!("format = 1\n[ensemble]\ndesign = \"list\"\n{one}[[variation]]\nparameter = \"sf1.feed_in_pump.speed\"\nvalues = [1, 2]\n"), "variation \"sf1.feed_in_pump.speed\" has 2 values, \"ground.temperature_k\" has 1"),
        (format!("format = 1\n{one}{one}"), "there is another variation of that name"),
        (format!("format = 1\n{one}name = \"id\"\n"), "5:8: variation \"id\": the name is one of a column of the results"),
        (format!("format = 1\n{one}name = \"time_s\"\n"), "the name is one of a column of the results"),
        (format!("format = 1\n{one}name = \"network.heat_lost_kwh\"\n"), "5:8: variation \"network.heat_lost_kwh\": the name looks like that of an indicator"),
        // A pattern takes a parameter that was named.
        ("format = 1\n[[variation]]\nparameter = \"sf1-sf2.hot.length_m\"\nvalues = [100]\n[[variation]]\nname = \"all\"\nparameter = \"*.length_km\"\nvalues = [0.1]\n".into(), "7:13: variation \"all\" means \"sf1-sf2.hot.length_m\", which \"sf1-sf2.hot.length_m\" varies already"),
        ("format = 1\n[[variation]]\nparameters = [\"ground.temperature_k\", \"ground.temperature_degc\"]\nvalues = [280]\n".into(), "means \"ground.temperature_k\" twice"),
        // No member can be.
        ("format = 1\n[[variation]]\nparameter = \"sf1-sf2.hot.length_m\"\nvalues = [-1, -2]\n".into(), "4:10: variation \"sf1-sf2.hot.length_m\": "),
        ("format = 1\n[[variation]]\nparameter = \"ground.temperature_degc\"\nvalues = [[1.0, 2.0]]\n".into(), "4:10: variation \"ground.temperature_degc\": "),
        // Too many.
        (format!("format = 1\n[ensemble]\ndesign = \"monte_carlo\"\nmembers = 1000000000000\n{one}"), "4:11: ensemble: members = 1000000000000 is too many"),
        (format!("format = 1\n{one}[[variation]]\nparameter = \"sf1.feed_in_pump.speed\"\nlow = 0\nhigh = 1\ncount = 4611686018427387904\n[[variation]]\nparameter = \"sf1-sf2.hot.length_m\"\nvalues = [1, 2, 3, 4, 5]\n"), "9:9: variation \"sf1.feed_in_pump.speed\": its 4611686018427387904 values make too many members"),
    ] {
        let told = refusal(&text);
        assert!(told.contains(expected), "{expected}\nis not in\n{told}\nof\n{text}");
        assert!(told.contains("hint: ") || told.contains("did you mean"), "{told}");
    }
}

/// A table of values is in the unit of its name, number by number.
#[test]
fn curves_are_converted_number_by_number() {
    let curve = "speed = 0.95, curve_v_flow_m3_h = [0, 1, 2], curve_head_hpa = [400, 300, 100]";
    let model = model(&MODEL.replace("speed = 0.95", curve));
    let text = "format = 1\n[[variation]]\nname = \"curve\"\nparameter = \"sf1.feed_in_pump.curve_head_hpa\"\n\
                values = [[300, 250, 50], [400, 350, 100]]\n";
    let ensemble = Ensemble::new(model, Definition::from_toml(text).unwrap()).unwrap();
    let set = Change::Set {
        parameter: "sf1.feed_in_pump.curve_head_pa".into(),
        value: json!([40000.0, 35000.0, 10000.0]),
    };
    assert_eq!(ensemble.changes(1), [set]);
}

/// Layers of a storage are counted.
#[test]
fn whole_numbers_stay_whole_and_what_gives_others_is_refused() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/two-pipe");
    let text = std::fs::read_to_string(folder.join("model.toml")).unwrap();
    let model = Arc::new(Model::from_toml(&text, &folder).unwrap());
    let parameters = model.parameters();
    let layers = parameters.iter().find(|(name, _)| name.ends_with(".layers")).unwrap().0.clone();
    let of = |rest: &str| {
        let text = format!("format = 1\n{rest}\n").replace("LAYERS", &layers);
        Ensemble::new(model.clone(), Definition::from_toml(&text).unwrap())
    };
    let set = |n: u32| Change::Set { parameter: layers.clone(), value: json!(n) };
    let variation = "[[variation]]\nparameter = \"LAYERS\"\n";
    let grid = of(&format!("{variation}low = 10\nhigh = 20\ncount = 3")).unwrap();
    assert_eq!([grid.changes(0), grid.changes(1)], [[set(10)], [set(15)]]);
    let listed = of(&format!("{variation}values = [12.0, 14]")).unwrap();
    assert_eq!([listed.changes(0), listed.changes(1)], [[set(12)], [set(14)]]);
    for (rest, told) in [
        (format!("{variation}low = 10\nhigh = 20\ncount = 4"), "whole number, 13.33"),
        (format!("{variation}values = [12.5]"), "whole number, 12.5 is none"),
        (format!("{variation}values = [2]\nhow = \"scale\""), "cannot be scaled"),
        (
            format!(
                "[ensemble]\ndesign = \"monte_carlo\"\nmembers = 3\n{variation}low = 10\nhigh = 20"
            ),
            "a distribution gives others",
        ),
    ] {
        let error = of(&rest).unwrap_err().to_string();
        assert!(error.contains(told), "{told} is not in {error}");
    }
}

#[test]
fn seeds_that_vary_are_not_drawn() {
    let text = "format = 1\n[ensemble]\ndesign = \"monte_carlo\"\nmembers = 2\n[run]\nuntil = \"1min\"\n\
                [[variation]]\nparameter = \"meter.seed\"\nvalues = [4, 5]\n";
    let definition = Definition::from_toml(text).unwrap();
    let ensemble = Ensemble::new(model(&format!("{MODEL}{NOISY}")), definition).unwrap();
    let value = ensemble.values(1)[0].clone();
    assert_eq!(ensemble.changes(1), [Change::Set { parameter: "meter.seed".into(), value }]);
}

#[test]
fn a_folder_has_one_writer() {
    let (folder, ensemble) = (tempfile::tempdir().unwrap(), ensemble(VARIATIONS));
    let first = Store::open(folder.path(), &ensemble).unwrap();
    let error = Store::open(folder.path(), &ensemble).unwrap_err();
    assert!(matches!(&error, StoreError::Busy { .. }), "{error}");
    drop(first);
    assert!(Store::open(folder.path(), &ensemble).is_ok());
    // The Parquet files of Python are no journal; other controllers give other results.
    let of_python = ensemble.identity("anergy.ensemble", None).unwrap();
    std::fs::write(folder.path().join("ensemble.json"), of_python.to_string()).unwrap();
    let error = Store::open(folder.path(), &ensemble).unwrap_err().to_string();
    assert!(error.contains("other writer"), "{error}");
    let with = ensemble.identity("anergy.ensemble", Some("mine.Pi 1f")).unwrap();
    assert_eq!(difference(&with, &of_python.to_string()), Some("controllers"));
    assert_eq!(difference(&with, &with.to_string()), None);
}

#[test]
fn only_a_torn_last_line_is_cut_off() {
    let (folder, ensemble) = (tempfile::tempdir().unwrap(), ensemble(VARIATIONS));
    fill(&ensemble, folder.path(), 4);
    let journal = folder.path().join("journal.jsonl");
    let whole = std::fs::read_to_string(&journal).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    for (text, told) in [
        (format!("{}{{\"member\": 3,\n{}{}", lines[0], lines[2], lines[3]), "journal.jsonl:2: "),
        (format!("{whole}{}", lines[1]), "journal.jsonl:5: member"),
        (format!("{whole}{{\"member\": 12, \"values\": []}}\n"), "there is no member 12"),
    ] {
        std::fs::write(&journal, &text).unwrap();
        let error = Store::open(folder.path(), &ensemble).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
        assert_eq!(std::fs::read_to_string(&journal).unwrap(), text, "nothing is lost");
    }
    std::fs::write(&journal, whole.trim_end()).unwrap();
    assert_eq!(Store::open(folder.path(), &ensemble).unwrap().finished(), 3);
}

#[test]
fn no_indicator_is_called_like_a_parameter() {
    let text =
        VARIATIONS.replace("members = 12", "members = 1").replace("\"sf1.station.*\"", "\"*\"");
    let ensemble = ensemble(&text);
    let parameters: HashSet<String> =
        ensemble.model().parameters().into_iter().map(|(name, _)| name).collect();
    let outcomes = all(&ensemble, 1);
    let kpis = &outcomes[0].result.as_ref().unwrap().kpis;
    assert!(kpis.len() > 5, "{kpis:?}");
    assert!(kpis.keys().all(|name| !parameters.contains(name)));
}

/// The examples fit the models that they name.
#[test]
fn the_examples_are_ensembles() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut count = 0;
    for file in std::fs::read_dir(examples.join("ensembles")).unwrap() {
        let file = file.unwrap().path();
        if file.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&file).unwrap();
        let named = text.lines().find_map(|line| line.strip_prefix("# anergy sweep ")).unwrap();
        let named = named.split(' ').next().unwrap();
        let named = examples.join("..").join(named);
        let model = std::fs::read_to_string(&named).unwrap();
        let model = Model::from_toml(&model, named.parent().unwrap()).unwrap();
        let definition = Definition::from_toml(&text).unwrap();
        let ensemble = Ensemble::new(Arc::new(model), definition).unwrap();
        assert!(ensemble.len() > 1, "{}", file.display());
        count += 1;
    }
    assert!(count > 0);
}
