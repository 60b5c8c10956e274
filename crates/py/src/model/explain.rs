//! `Model` beside measurements.

use super::Model;
use crate::errors::Origin;
use crate::{convert, errors};
use anergy_discrepancy::addition::added;
use anergy_discrepancy::data;
use anergy_discrepancy::error::ExplainError;
use anergy_discrepancy::experiment::Experiment;
use anergy_discrepancy::explain::explain;
use anergy_discrepancy::sensors::SensorFile;
use anergy_discrepancy::show;
use anergy_discrepancy::split::SplitFile;
use anergy_simulation::model;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::Value;

/// What was found: `report.json`, Markdown, HTML, and the model file with what was missing.
struct Told {
    json: Value,
    markdown: String,
    html: String,
    model: String,
}

#[pymethods]
impl Model {
    /// What `anergy.explain` asks: texts in, `(report, markdown, html, explained model)` out.
    fn _explain<'py>(
        &self,
        py: Python<'py>,
        data: &str,
        sensors: &str,
        split: Option<&str>,
    ) -> PyResult<(Bound<'py, PyAny>, String, String, Self)> {
        // After changes the plain text is what was compared.
        let text =
            if self.changes.is_empty() { self.model.text.to_string() } else { self.plain(py)? };
        let told = py.detach(|| compare(&self.model, &text, data, sensors, split));
        let Told { json, markdown, html, model } = told.map_err(|error| match error {
            ExplainError::Model(problems) => {
                errors::model_error(py, &problems, &self.model.text, &self.origin)
            }
            ExplainError::Run(error) => {
                errors::run_error(py, &error, &self.model.text, &self.origin)
            }
            other => PyValueError::new_err(other.to_string()),
        })?;
        let model = Self::read(py, &model, self.directory.clone(), Origin::Text)?;
        Ok((convert::to_python(py, &json)?, markdown, html, model))
    }
}

fn compare(
    model: &model::Model,
    text: &str,
    data: &str,
    sensors: &str,
    split: Option<&str>,
) -> Result<Told, ExplainError> {
    let sensors = SensorFile::from_toml(sensors)?;
    let runs = data::read(data, &sensors)?;
    let split = split.map(SplitFile::from_toml).transpose()?;
    let experiment = Experiment::new(model.clone(), sensors, runs)?;
    let found = explain(&experiment, split.as_ref())?;
    let title = format!("{}: simulation and measurement", model.name);
    Ok(Told {
        json: show::json(&found),
        markdown: show::markdown(&title, &found),
        html: show::html(&title, &experiment, &found),
        model: added(text, &found.effects, &found.because),
    })
}
