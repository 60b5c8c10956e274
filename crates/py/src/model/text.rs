//! A model from text and as text: as it was read, as plain entries, with its series, in a pickle.

use super::Model;
use crate::convert;
use crate::errors::{self, Origin};
use anergy_simulation::build::build;
use anergy_simulation::document;
use anergy_simulation::model;
use anergy_simulation::overlay::Change;
use anergy_simulation::plan::Plan;
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl Model {
    pub(super) fn read(
        py: Python<'_>,
        text: &str,
        directory: PathBuf,
        origin: Origin,
    ) -> PyResult<Self> {
        match py.detach(|| model::Model::from_toml(text, &directory)) {
            Ok(model) => Ok(Self { model, origin, directory, changes: Vec::new() }),
            Err(problems) => Err(errors::model_error(py, &problems, text, &origin)),
        }
    }

    /// The plan of a run. It keeps the text of what is run: after changes, the plain text.
    pub(super) fn plan(&self, py: Python<'_>) -> PyResult<Arc<Plan>> {
        let built = py.detach(|| {
            if self.changes.is_empty() {
                return build(&self.model);
            }
            let mut model = self.model.clone();
            model.text = model.to_plain_toml()?.into();
            build(&model)
        });
        // Places are always those of the text that was read.
        built.map_err(|error| errors::model_error(py, &error, &self.model.text, &self.origin))
    }

    pub(super) fn plain(&self, py: Python<'_>) -> PyResult<String> {
        let plain = self.model.to_plain_toml();
        plain.map_err(|error| errors::model_error(py, &error, "", &Origin::Dict))
    }

    pub(super) fn document(&self, py: Python<'_>) -> PyResult<Value> {
        let text = if self.changes.is_empty() { &*self.model.text } else { &*self.plain(py)? };
        let tree = document::parse_toml(text);
        let tree = tree.map_err(|error| errors::model_error(py, &error, text, &self.origin))?;
        Ok(tree.to_json())
    }

    /// The text that was read, with the series of CSV files written into it; `None` when it has
    /// none.
    pub(super) fn text_with_series(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let text = &self.model.text;
        let tree = document::parse_toml(text);
        let tree = tree.map_err(|error| errors::model_error(py, &error, text, &self.origin))?;
        let Value::Object(mut file) = tree.to_json() else { return Ok(None) };
        let Some(Value::Array(series)) = file.shift_remove("series") else { return Ok(None) };
        // Drivers are those of the schedules, then those of the series.
        let first = self.model.drivers.len().saturating_sub(series.len());
        let points = self.model.drivers[first..].iter().map(|driver| {
            let points: Vec<_> = driver.times_s.iter().zip(driver.values.iter()).collect();
            let mut entry = json!({
                "signal": driver.signal, "interpolation": driver.interpolation, "points": points
            });
            if let Some(unit) = &driver.unit {
                entry["unit"] = json!(unit);
            }
            entry
        });
        let points: Vec<Value> = points.collect();
        match file.entry("schedule").or_insert_with(|| json!([])) {
            Value::Array(schedules) => schedules.extend(points),
            _ => return Ok(None),
        }
        let text = document::to_toml(&file);
        text.map(Some).map_err(|error| errors::model_error(py, &error, "", &Origin::Dict))
    }
}

/// Whether a file is in a directory.
pub(super) fn same_directory(directory: &Path, file: &Path) -> bool {
    let canonical = |path: &Path| {
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        std::fs::canonicalize(path).ok()
    };
    file.parent().is_some_and(|parent| canonical(parent) == canonical(directory))
}

/// How to make the model again: the text that was read, then the changes.
pub(super) fn pickle<'py>(model: &Model, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
    let series = model.text_with_series(py)?;
    let path = match (&model.origin, &series) {
        (Origin::File(path), None) => Some(path.as_os_str()),
        _ => None,
    };
    let given_as_dict = matches!(model.origin, Origin::Dict);
    let mut changes = Vec::with_capacity(model.changes.len());
    for change in &model.changes {
        match change {
            Change::Set { parameter, value } => {
                changes.push((parameter, "set", convert::to_python(py, value)?));
            }
            Change::Scale { parameter, factor } => {
                changes.push((parameter, "scale", factor.into_pyobject(py)?.into_any()));
            }
            // Not made in Python.
            _ => {}
        }
    }
    let text = series.as_deref().unwrap_or(&model.model.text);
    let load = py.import("anergy._core")?.getattr("_load_model")?;
    let arguments = (text, model.directory.as_os_str(), path, given_as_dict, changes);
    Ok((load, arguments).into_pyobject(py)?.into_any())
}

/// A model from its pickle.
#[pyfunction]
#[pyo3(name = "_load_model")]
pub fn load_model(
    py: Python<'_>,
    text: &str,
    directory: PathBuf,
    path: Option<PathBuf>,
    given_as_dict: bool,
    changes: Vec<(String, String, Bound<'_, PyAny>)>,
) -> PyResult<Model> {
    let origin = match path {
        Some(path) => Origin::File(path),
        None if given_as_dict => Origin::Dict,
        None => Origin::Text,
    };
    let mut model = Model::read(py, text, directory, origin)?;
    for (parameter, verb, value) in changes {
        model = match verb.as_str() {
            "set" => model.set(&parameter, &value)?,
            _ => model.scale(&parameter, value.extract()?)?,
        };
    }
    Ok(model)
}
