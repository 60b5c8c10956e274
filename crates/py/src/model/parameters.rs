//! The parameters of a model and their changes.

use super::Model;
use crate::errors;
use anergy_simulation::overlay::Change;
use pyo3::prelude::*;
use serde_json::{Value, json};

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
        let edges = self.model.edges.iter().map(|edge| (&edge.id, edge.params.to_value()));
        let units = self.model.units.iter().map(|unit| (&unit.id, unit.params.to_value()));
        let mut known =
            vec![("ground.temperature_k".to_owned(), json!(self.model.ground.temperature_k))];
        for (id, values) in edges.chain(units) {
            if let Value::Object(values) = values {
                known.extend(
                    values.into_iter().map(|(name, value)| (format!("{id}.{name}"), value)),
                );
            }
        }
        known
    }
}
