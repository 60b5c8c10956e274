//! `anergy check`: everything that is wrong with a model, and what it is in detail.

use super::run::read_model;
use crate::failure::Failure;
use crate::output::{self, line};
use crate::tables::print_table;
use anergy_simulation::build::build;
use std::path::Path;

/// Checks a model file.
pub fn check(
    path: &Path,
    expand: bool,
    explain_defaults: bool,
    signals: bool,
) -> Result<(), Failure> {
    let (text, model) = read_model(path)?;
    let failed = |problems| Failure::Model {
        problems,
        file: path.display().to_string(),
        text: text.clone(),
    };
    let plan = build(&model).map_err(failed)?;
    if expand {
        output::print(&model.to_plain_toml().map_err(failed)?);
    }
    if explain_defaults {
        let rows: Vec<Vec<String>> = model
            .defaults()
            .into_iter()
            .map(|default| {
                let value = match &default.value {
                    serde_json::Value::Null => "-".into(),
                    value => value.to_string(),
                };
                let name = format!("{}.{}", default.component, default.field);
                vec![name, value, default.source.into(), default.meaning]
            })
            .collect();
        print_table(&["value not given", "used", "from", "meaning"], &rows);
    }
    if signals {
        let rows: Vec<Vec<String>> = plan
            .signals()
            .specs()
            .iter()
            .map(|spec| {
                let unit = if spec.unit.is_empty() { "1" } else { spec.unit };
                vec![spec.name.to_string(), unit.into(), spec.initial.to_string()]
            })
            .collect();
        print_table(&["signal", "unit", "initial"], &rows);
    }
    if !(expand || explain_defaults || signals) {
        line!(
            "{} is sound: {} nodes, {} edges, {} stations, {} units, {} controllers",
            path.display(),
            model.nodes.len(),
            model.edges.len(),
            model.interfaces.len(),
            model.units.len(),
            model.controllers.len()
        );
    }
    Ok(())
}
