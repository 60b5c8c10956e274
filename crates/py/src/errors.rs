//! Errors of the other crates as exceptions of `anergy.errors`, with their fields.

use anergy_core::error::RecordError;
use anergy_simulation::diagnostic::{Diagnostic, Diagnostics};
use anergy_simulation::error::RunError as SimulationError;
use anergy_simulation::overlay::OverlayError;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::io;
use std::path::{Path, PathBuf};

mod python {
    #![allow(missing_docs)]
    pyo3::import_exception!(anergy.errors, ConvergenceError);
    pyo3::import_exception!(anergy.errors, ModelError);
    pyo3::import_exception!(anergy.errors, OutOfRangeError);
    pyo3::import_exception!(anergy.errors, RecordingError);
    pyo3::import_exception!(anergy.errors, RunError);
    pyo3::import_exception!(anergy.errors, SnapshotError);
    pyo3::import_exception!(anergy.errors, UnknownNameError);
    pyo3::import_exception!(anergy.errors, Interrupted);
}
pub use python::{Interrupted, ModelError, SnapshotError};

/// Where a model came from: what its problems are called by.
#[derive(Debug, Clone)]
pub enum Origin {
    /// A file: `model.toml:12:3`.
    File(PathBuf),
    /// A string: `line 12, column 3`.
    Text,
    /// A dict: names only, as nobody has seen the text.
    Dict,
}

/// All problems of a model as one `ModelError`.
pub fn model_error(py: Python<'_>, problems: &Diagnostics, text: &str, origin: &Origin) -> PyErr {
    let lines: Vec<String> = problems.0.iter().map(|problem| line(problem, text, origin)).collect();
    match dicts(py, problems, text, origin) {
        Ok(list) => python::ModelError::new_err((lines.join("\n"), list.unbind())),
        Err(error) => error,
    }
}

/// Line and column of a problem in a text that the user has.
fn place(problem: &Diagnostic, text: &str, origin: &Origin) -> Option<(usize, usize)> {
    match origin {
        Origin::Dict => None,
        Origin::File(_) | Origin::Text => problem.line_and_column(text),
    }
}

fn line(problem: &Diagnostic, text: &str, origin: &Origin) -> String {
    let before = match (origin, place(problem, text, origin)) {
        (Origin::File(path), Some((line, column))) => {
            format!("{}:{line}:{column}: ", path.display())
        }
        (Origin::File(path), None) => format!("{}: ", path.display()),
        (_, Some((line, column))) => format!("line {line}, column {column}: "),
        (_, None) => String::new(),
    };
    let hint = problem.hint.as_ref().map_or(String::new(), |hint| format!("\n    hint: {hint}"));
    format!("{before}{}{hint}", problem.message)
}

fn dicts<'py>(
    py: Python<'py>,
    problems: &Diagnostics,
    text: &str,
    origin: &Origin,
) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for problem in &problems.0 {
        let place = place(problem, text, origin);
        let dict = PyDict::new(py);
        dict.set_item("message", &problem.message)?;
        dict.set_item("hint", &problem.hint)?;
        dict.set_item("line", place.map(|(line, _)| line))?;
        dict.set_item("column", place.map(|(_, column)| column))?;
        list.append(dict)?;
    }
    Ok(list)
}

/// What made a run, a solve or a command fail.
pub fn run_error(py: Python<'_>, error: &SimulationError, text: &str, origin: &Origin) -> PyErr {
    use SimulationError as E;
    let message = error.to_string();
    let failed = |time: &str, component: Option<&String>| {
        with(py, python::RunError::new_err(message.clone()), |value| {
            value.setattr("time", time)?;
            value.setattr("component", component)
        })
    };
    match error {
        E::Model(problems) => model_error(py, problems, text, origin),
        E::NotConverged { time, iterations, edge, residual_pa, node, mass_residual_kg_s } => {
            with(py, python::ConvergenceError::new_err(message), |value| {
                value.setattr("time", time)?;
                value.setattr("component", edge)?;
                value.setattr("iterations", iterations)?;
                value.setattr("residual_pa", residual_pa)?;
                value.setattr("node", node)?;
                value.setattr("mass_residual_kg_s", mass_residual_kg_s)
            })
        }
        E::NotSettled { iterations, .. } => {
            with(py, python::ConvergenceError::new_err(message), |value| {
                value.setattr("iterations", iterations)
            })
        }
        E::Singular { time, .. } => with(py, python::ConvergenceError::new_err(message), |value| {
            value.setattr("time", time)
        }),
        E::Hunting { time, valve, .. } => {
            with(py, python::ConvergenceError::new_err(message), |value| {
                value.setattr("time", time)?;
                value.setattr("component", valve)
            })
        }
        E::WeatherEnds { time } => failed(time, None),
        E::Unbalanced { time, node, .. } => failed(time, Some(node)),
        E::NotFinite { time, component } | E::Temperature { time, component, .. } => {
            failed(time, Some(component))
        }
        E::Absurd { time, edge, .. } => failed(time, Some(edge)),
        E::Prescribed { time, free, .. } => failed(time, Some(free)),
        E::Control { time, controller: component, .. }
        | E::UndefinedCircuit { time, circuit: component } => failed(time, Some(component)),
        E::UnknownName { name, .. } => python::UnknownNameError::new_err((message, name.clone())),
        E::OutOfRange { signal, value, min, max } => {
            python::OutOfRangeError::new_err((message, signal.clone(), *value, *min, *max))
        }
        E::UserOutput { time, controller, signal, value, min, max } => {
            let arguments = (message, signal.clone(), *value, *min, *max);
            with(py, python::OutOfRangeError::new_err(arguments), |value| {
                value.setattr("time", time)?;
                value.setattr("component", controller)
            })
        }
        E::Snapshot { .. } => python::SnapshotError::new_err(message),
        E::Record(error) => record_error(py, error),
    }
}

/// Sets fields of an exception.
fn with(
    py: Python<'_>,
    error: PyErr,
    set: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<()>,
) -> PyErr {
    match set(error.value(py).as_any()) {
        Ok(()) => error,
        Err(problem) => problem,
    }
}

/// A change that a model cannot take; `known` are the names it has.
pub fn overlay_error<'a>(error: &OverlayError, known: impl Iterator<Item = &'a str>) -> PyErr {
    match error {
        OverlayError::UnknownParameter { parameter } => unknown("parameter", parameter, known),
        OverlayError::Value { parameter, reason } => {
            PyValueError::new_err(format!("{parameter}: {reason}"))
        }
        OverlayError::UnknownEdge { .. } | OverlayError::Taken { .. } => {
            PyValueError::new_err(error.to_string())
        }
    }
}

/// A name that does not exist, with the one that was probably meant: it begins with `name` or is
/// the most similar.
pub fn unknown<'a>(what: &str, name: &str, known: impl Iterator<Item = &'a str>) -> PyErr {
    unknown_to("", what, name, known)
}

/// The same with words before the message: who asks.
pub fn unknown_to<'a>(
    who: &str,
    what: &str,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> PyErr {
    let meant = known
        .map(|candidate| {
            let beginning = !name.is_empty() && candidate.starts_with(name);
            (!beginning, strsim::damerau_levenshtein(name, candidate), candidate)
        })
        .filter(|(other, distance, candidate)| {
            !other || *distance <= 1 + candidate.chars().count() / 4
        })
        .min();
    let hint = meant.map_or(String::new(), |(_, _, best)| format!("; did you mean `{best}`?"));
    let message = format!("{who}there is no {what} \"{name}\"{hint}");
    python::UnknownNameError::new_err((message, name.to_owned()))
}

/// The error for a name that does not exist, for the Python part of the package.
#[pyfunction]
#[pyo3(name = "_unknown_name")]
pub fn unknown_name(what: &str, name: &str, known: Vec<String>) -> PyErr {
    unknown(what, name, known.iter().map(String::as_str))
}

/// A recording that could not be written or read.
pub fn record_error(py: Python<'_>, error: &RecordError) -> PyErr {
    match error {
        RecordError::File { path, source, .. } => os_error(py, source, Path::new(path)),
        RecordError::Format { .. } => python::RecordingError::new_err(error.to_string()),
    }
}

/// `FileNotFoundError` and its like, with `errno` and `filename`.
pub fn os_error(py: Python<'_>, source: &io::Error, path: &Path) -> PyErr {
    let Some(code) = source.raw_os_error() else {
        return PyOSError::new_err(format!("{}: {source}", path.display()));
    };
    let text = py
        .import("os")
        .and_then(|os| os.call_method1("strerror", (code,)))
        .map_or_else(|_| source.to_string(), |text| text.to_string());
    PyOSError::new_err((code, text, path.display().to_string()))
}
