//! `anergy run`: a model over time, into a folder of results.

use crate::failure::Failure;
use crate::output::line;
use crate::progress::Progress;
use crate::{interrupt, tables};
use anergy_core::clock::Time;
use anergy_recording::McapRecorder;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::model_file::{Duration, StepEntry};
use anergy_simulation::run::{self, RunOptions};
use anergy_simulation::simulation::Simulation;
use std::path::{Path, PathBuf};

/// Runs a model file.
pub fn run(
    path: &Path,
    [until, step, record]: [Option<String>; 3],
    out: Option<&Path>,
) -> Result<(), Failure> {
    let duration = |name: &str, text: Option<String>| -> Result<Option<Time>, Failure> {
        text.map(|text| Duration::parse(&text).map(|duration| duration.0))
            .transpose()
            .map_err(|problem| Failure::Usage(format!("--{name}: {problem}")))
    };
    let options = RunOptions {
        until: duration("until", until)?,
        step: step
            .map(|text| StepEntry::parse(&text))
            .transpose()
            .map_err(|problem| Failure::Usage(format!("--step: {problem}")))?,
        record: duration("record", record)?,
    };
    let (text, model) = read_model(path)?;
    let out = out.map_or_else(|| default_folder(path), Path::to_path_buf);
    let recording = run_into(&model, &text, &path.display().to_string(), options, &out)?;
    line!("");
    tables::print_key_results(&recording.summary);
    if !recording.events.is_empty() {
        line!("");
        tables::print_events(&recording.events);
    }
    print_files(&out);
    finished()
}

/// Exit code of an interrupted run.
pub fn finished() -> Result<(), Failure> {
    if interrupt::requested() { Err(Failure::Interrupted) } else { Ok(()) }
}

/// Where the results are.
pub fn print_files(out: &Path) {
    line!("\nresults in {}: report.html, results.mcap, summary.json", out.display());
}

/// `results/<name of the model's folder or file>`.
fn default_folder(model: &Path) -> PathBuf {
    let stem = model.file_stem().and_then(|stem| stem.to_str()).unwrap_or("run");
    let folder = model.parent().and_then(Path::file_name).and_then(|name| name.to_str());
    Path::new("results").join(if stem == "model" { folder.unwrap_or(stem) } else { stem })
}

/// Reads a model file, or says what is wrong with it.
pub fn read_model(path: &Path) -> Result<(String, Model), Failure> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::file("cannot read", path, &error))?;
    let dir = path.parent().unwrap_or(Path::new("."));
    match Model::from_toml(&text, dir) {
        Ok(model) => Ok((text, model)),
        Err(problems) => Err(Failure::Model { problems, file: path.display().to_string(), text }),
    }
}

/// Runs a model into a folder: results.mcap while running, then summary.json and report.html.
pub fn run_into(
    model: &Model,
    text: &str,
    file: &str,
    options: RunOptions,
    out: &Path,
) -> Result<anergy_core::recorder::Recording, Failure> {
    let plan = build(model).map_err(|problems| Failure::Model {
        problems,
        file: file.to_owned(),
        text: text.to_owned(),
    })?;
    std::fs::create_dir_all(out)
        .map_err(|error| Failure::file("cannot make the folder", out, &error))?;
    let mut simulation = Simulation::new(plan)?;
    let results = out.join("results.mcap");
    let recorder = McapRecorder::create(&results)?;
    interrupt::listen();
    let mut progress = Progress::new();
    let outcome = run::run(&mut simulation, options, Box::new(recorder), &mut |now, end| {
        progress.update(now, end);
        !interrupt::requested()
    });
    progress.finish();
    // A failed run has kept its rows: report them too, then say why it failed.
    let recording = match &outcome {
        Err(anergy_simulation::error::RunError::Record(_)) => None,
        _ => Some(anergy_recording::read(&results)?.recording),
    };
    if let Some(recording) = &recording {
        write_results(recording, out)?;
    }
    let report = outcome?;
    recording.ok_or_else(|| Failure::File(format!("no results: {}", report.summary)))
}

fn write_results(recording: &anergy_core::recorder::Recording, out: &Path) -> Result<(), Failure> {
    let write = |name: &str, text: String| {
        let path = out.join(name);
        std::fs::write(&path, text).map_err(|error| Failure::file("cannot write", &path, &error))
    };
    write("summary.json", format!("{:#}\n", recording.summary))?;
    write("report.html", anergy_report::html(recording))
}
