//! The parameters of a model and their changes.

use super::Model;
use crate::errors;
use anergy_simulation::overlay::Change;
use pyo3::prelude::*;
use serde_json::Value;

impl Model {
    /// A new model with one more change.
    pub(super) fn with(&self, change: Change) -> PyResult<Self> {
        let model = self.model.with(std::slice::from_ref(&change)).map_err(|error| {
            let known = self.known_parameters();
            errors::overlay_error(&error, known.iter().map(|(name, _)| name.as_str()))
        })?;
        let mut changes = self.changes.clone();
        changes.push(change);
        Ok(Self { model, origin: self.origin.clone(), directory: self.directory.clone(), changes })
    }

    /// Every parameter that can be set, with its value.
    pub(super) fn known_parameters(&self) -> Vec<(String, Value)> {
        self.model.parameters()
    }
}
