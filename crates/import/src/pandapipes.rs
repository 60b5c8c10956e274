//! Networks of pandapipes (`pandapipes.to_json`) as models: water, hydraulics and heat consumers.
//!
//! **Laws** The friction law is an option of pandapipes' solver and not part of the file: it is chosen for
//! the import. Properties of the water are those at the mean start temperature of the junctions.
//! What is out of service, or without a way to an external grid, is left out.

mod boundaries;
mod links;
mod pumps;
mod tables;
mod translate;
mod water;

use crate::model_text::ModelText;
use crate::{Import, ImportError, text_of};
use serde_json::Value;
use tables::Tables;

/// Friction laws that pandapipes and anergy both have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Friction {
    /// `friction_model="colebrook"`.
    #[default]
    Colebrook,
    /// `friction_model="swamee-jain"`.
    SwameeJain,
}

impl Friction {
    fn word(self) -> &'static str {
        match self {
            Self::Colebrook => "colebrook",
            Self::SwameeJain => "swamee_jain",
        }
    }
}

/// The model file of a pandapipes net.
///
/// # Errors
/// When the file is no pandapipes net, its fluid is a gas, or a table lacks what it needs.
pub fn import(bytes: &[u8], friction: Friction) -> Result<Import, Vec<ImportError>> {
    let content = text_of(bytes);
    let value: Value = tables::parse(&content).map_err(|error| {
        vec![ImportError::new(error.line(), format!("this is no JSON: {error}"))]
    })?;
    let read = || -> Result<Import, ImportError> {
        let tables = Tables::of(&value)?;
        let mut text = ModelText::default();
        translate::translate(&tables, friction, &mut text)?;
        Ok(text.finish("Imported from a pandapipes net. What it says otherwise or not at all:"))
    };
    read().map_err(|error| vec![error])
}

#[cfg(test)]
mod tests;
