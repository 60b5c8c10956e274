//! Wrong model files: every file of `invalid/` must be refused, with a message that helps.
//!
//! The messages are snapshots in `invalid/snapshots/`, each with the lines of the file it points at:
//! read them as somebody who sees the program for the first time. A new case is a new file; its first
//! line says what is wrong.

#![allow(clippy::unwrap_used)]

use anergy_simulation::build::build;
use anergy_simulation::diagnostic::Diagnostics;
use anergy_simulation::error::RunError;
use anergy_simulation::model::Model;
use anergy_simulation::steady;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::time::Duration;

/// A refusal that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(20);

/// Cases that are found while solving: their message names components instead of a place.
const FOUND_BY_SOLVING: &[&str] =
    &["controller_without_effect", "flows_imposed", "source_into_reference"];

/// Cases about something that is not in the file at all.
const WITHOUT_PLACE: &[&str] = &["empty", "format_missing", "no_edges"];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("invalid")
}

fn cases() -> Vec<String> {
    let files = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let toml = files.filter(|path| path.extension().is_some_and(|end| end == "toml"));
    let mut names: Vec<String> =
        toml.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    names.sort();
    names
}

/// How a model was refused.
enum Refusal {
    Model(Diagnostics),
    Run(RunError),
}

fn refusal(text: &str) -> Option<Refusal> {
    let model = match Model::from_toml(text, &folder()) {
        Ok(model) => model,
        Err(problems) => return Some(Refusal::Model(problems)),
    };
    if let Err(problems) = build(&model) {
        return Some(Refusal::Model(problems));
    }
    steady::solve(&model).err().map(Refusal::Run)
}

/// The refusal, found in a thread of its own so that a hanging one is noticed.
fn refusal_in_time(name: &str, text: &str) -> Refusal {
    let (send, receive) = mpsc::channel();
    let owned = text.to_owned();
    std::thread::spawn(move || send.send(refusal(&owned)));
    match receive.recv_timeout(PATIENCE) {
        Ok(Some(refusal)) => refusal,
        Ok(None) => panic!("{name}: is not refused"),
        Err(mpsc::RecvTimeoutError::Timeout) => panic!("{name}: still thinking"),
        Err(mpsc::RecvTimeoutError::Disconnected) => panic!("{name}: panics"),
    }
}

/// What the user sees, and below it the lines it points at.
fn shown(text: &str, problems: &Diagnostics) -> String {
    let places = problems.0.iter().filter_map(|problem| problem.line_and_column(text));
    let lines: BTreeSet<usize> = places.map(|(line, _)| line).collect();
    let mut out = problems.render(text);
    for line in lines {
        let content = text.lines().nth(line - 1).unwrap_or("(end of the file)");
        out.push_str(&format!("\n{line:>4} | {content}"));
    }
    out
}

fn check(name: &str) {
    let text = std::fs::read_to_string(folder().join(format!("{name}.toml"))).unwrap();
    assert!(text.starts_with("# "), "{name}: the first line says what is wrong");
    let (message, solved) = match refusal_in_time(name, &text) {
        Refusal::Model(problems) => {
            assert!(!problems.0.is_empty(), "{name}: refused without a reason");
            for problem in &problems.0 {
                assert!(!problem.message.trim().is_empty(), "{name}: an empty message");
                assert!(
                    problem.line_and_column(&text).is_some() || WITHOUT_PLACE.contains(&name),
                    "{name}: no place: {}",
                    problem.message
                );
            }
            (shown(&text, &problems), false)
        }
        Refusal::Run(error) => (error.to_string(), true),
    };
    assert_eq!(solved, FOUND_BY_SOLVING.contains(&name), "{name}: found elsewhere:\n{message}");
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../invalid/snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description(text.lines().next().unwrap_or_default().trim_start_matches("# "));
    settings.bind(|| insta::assert_snapshot!(name, message));
}

#[test]
fn every_wrong_model_is_refused_with_its_message() {
    let cases = cases();
    assert!(cases.len() >= 100, "only {} cases were found", cases.len());
    let failed: Vec<&String> = cases
        .iter()
        .filter(|name| catch_unwind(AssertUnwindSafe(|| check(name))).is_err())
        .collect();
    assert!(failed.is_empty(), "{} of {} cases fail: {failed:?}", failed.len(), cases.len());
}

/// Snapshots and cases belong together.
#[test]
fn no_message_is_left_over() {
    let cases = cases();
    for entry in std::fs::read_dir(folder().join("snapshots")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let case = name.strip_suffix(".snap");
        assert!(case.is_some_and(|case| cases.iter().any(|c| c == case)), "{name} has no case");
    }
}
