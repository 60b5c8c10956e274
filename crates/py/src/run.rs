//! A whole run: into memory and, when wanted, into files; interruptible.

use crate::controller::Controllers;
use crate::errors::{self, Interrupted, Origin};
use crate::result::RunResult;
use anergy_core::clock::Time;
use anergy_core::error::RecordError;
use anergy_core::recorder::{Channel, Event, MemoryRecorder, Recorder, Recording, RunHeader};
use anergy_recording::McapRecorder;
use anergy_simulation::error::RunError;
use anergy_simulation::plan::Plan;
use anergy_simulation::run::RunOptions;
use anergy_simulation::simulation::Simulation;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Real time between two looks for Ctrl-C.
const LOOK_INTERVAL: Duration = Duration::from_millis(50);

/// Looks for Ctrl-C (and runs other signal handlers of the user) now and then.
pub struct SignalWatch {
    last: Instant,
    raised: Option<PyErr>,
}

impl SignalWatch {
    pub fn new() -> Self {
        Self { last: Instant::now(), raised: None }
    }

    /// Whether to go on.
    pub fn go_on(&mut self) -> bool {
        if self.last.elapsed() >= LOOK_INTERVAL {
            self.last = Instant::now();
            self.raised = Python::attach(|py| py.check_signals().err());
        }
        self.raised.is_none()
    }

    /// What a signal handler raised.
    pub fn into_raised(self) -> Option<PyErr> {
        self.raised
    }
}

/// Keeps the rows in memory and writes them into a file.
struct Tee<'a> {
    memory: &'a mut MemoryRecorder,
    file: Option<Box<McapRecorder>>,
}

impl Recorder for Tee<'_> {
    fn start(&mut self, header: &RunHeader, channels: &[Channel]) -> Result<(), RecordError> {
        self.memory.start(header, channels)?;
        self.file.as_mut().map_or(Ok(()), |file| file.start(header, channels))
    }

    fn row(&mut self, time: Time, values: &[f64]) -> Result<(), RecordError> {
        self.memory.row(time, values)?;
        self.file.as_mut().map_or(Ok(()), |file| file.row(time, values))
    }

    fn event(&mut self, event: &Event) -> Result<(), RecordError> {
        self.memory.event(event)?;
        self.file.as_mut().map_or(Ok(()), |file| file.event(event))
    }

    fn finish(self: Box<Self>, summary: &Value) -> Result<(), RecordError> {
        self.memory.recording.summary = summary.clone();
        self.file.map_or(Ok(()), |file| file.finish(summary))
    }
}

/// Runs a plan to its end.
///
/// Ctrl-C raises `Interrupted`, a failing step `RunError`, a controller what it raised; all have what was
/// recorded until then.
pub fn run(
    py: Python<'_>,
    plan: Arc<Plan>,
    options: RunOptions,
    out: Option<&Path>,
    controllers: Option<Vec<Bound<'_, PyAny>>>,
) -> PyResult<Py<RunResult>> {
    let mut simulation = py
        .detach(|| Simulation::new(plan))
        .map_err(|error| errors::run_error(py, &error, "", &Origin::Text))?;
    let raised = Controllers::attach(py, &mut simulation, controllers)?.raised;
    let file = match out {
        Some(folder) => Some(create(py, folder)?),
        None => None,
    };
    let mut memory = MemoryRecorder::default();
    let mut watch = SignalWatch::new();
    let outcome = py.detach(|| {
        let tee = Box::new(Tee { memory: &mut memory, file });
        anergy_simulation::run::run(&mut simulation, options, tee, &mut |_, _| watch.go_on())
    });
    let recording = memory.recording;
    let written = match out {
        Some(folder) if !recording.summary.is_null() => write_summary(py, folder, &recording),
        _ => Ok(()),
    };
    let text = recording.header.model_text.clone();
    let result = Py::new(py, RunResult::new(recording, None))?;
    let by_controller = outcome.as_ref().err().and_then(|error| raised.take(py, error));
    if let Some(raised) = watch.into_raised().or(by_controller) {
        if !raised.is_instance_of::<PyKeyboardInterrupt>(py) {
            // Not every exception takes attributes.
            let _ = raised.value(py).setattr("result", result);
            return Err(raised);
        }
        let message = "the run was interrupted; `.result` has what was recorded until then";
        return Err(Interrupted::new_err((message, result)));
    }
    if let Err(error) = outcome {
        let raised = errors::run_error(py, &error, &text, &Origin::Text);
        if !matches!(error, RunError::Record(_)) {
            raised.value(py).setattr("result", result)?;
        }
        return Err(raised);
    }
    written?;
    Ok(result)
}

fn create(py: Python<'_>, folder: &Path) -> PyResult<Box<McapRecorder>> {
    std::fs::create_dir_all(folder).map_err(|error| errors::os_error(py, &error, folder))?;
    let recorder = McapRecorder::create(&folder.join("results.mcap"));
    recorder.map(Box::new).map_err(|error| errors::record_error(py, &error))
}

fn write_summary(py: Python<'_>, folder: &Path, recording: &Recording) -> PyResult<()> {
    let path = folder.join("summary.json");
    std::fs::write(&path, format!("{:#}\n", recording.summary))
        .map_err(|error| errors::os_error(py, &error, &path))
}
