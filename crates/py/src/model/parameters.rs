//! The parameters of a model and their changes.

use super::Model;
use crate::errors::{self, Origin};
use anergy_simulation::overlay::{Change, OverlayError};
use pyo3::prelude::*;
use serde_json::Value;

impl Model {
    /// A new model with one more change.
    pub(super) fn with(&self, change: Change) -> PyResult<Self> {
        self.with_all(&[change]).map_err(|error| {
            let known = self.known_parameters();
            errors::overlay_error(&error, known.iter().map(|(name, _)| name.as_str()))
        })
    }

    /// A new model with several more changes.
    pub(crate) fn with_all(&self, more: &[Change]) -> Result<Self, OverlayError> {
        let model = self.model.with(more)?;
        let changes = [&self.changes, more].concat();
        Ok(Self { model, origin: self.origin.clone(), directory: self.directory.clone(), changes })
    }

    /// Where it came from.
    pub(crate) fn origin(&self) -> &Origin {
        &self.origin
    }

    /// Every parameter that can be set, with its value.
    pub(super) fn known_parameters(&self) -> Vec<(String, Value)> {
        self.model.parameters()
    }
}
