//! `anergy check`: everything that is wrong with a model, and what it is in detail.

use super::run::read_model;
use crate::failure::Failure;
use crate::output::{self, line};
use crate::tables::print_table;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::weather::{Day, TypeDay};
use std::path::Path;

/// What is shown besides whether the model is sound.
#[derive(Debug, Clone, Copy)]
pub struct Detail {
    /// Plain nodes and edges.
    pub expand: bool,
    /// Values that were not given.
    pub explain_defaults: bool,
    /// Input signals.
    pub signals: bool,
    /// Months and type days of the weather.
    pub weather: bool,
}

/// Checks a model file.
pub fn check(path: &Path, detail: Detail) -> Result<(), Failure> {
    let Detail { expand, explain_defaults, signals, weather } = detail;
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
    if weather {
        show_weather(&model, plan.start_unix_ns());
    }
    if !(expand || explain_defaults || signals || weather) {
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

/// Months and type days of the year from the start of the run on.
fn show_weather(model: &Model, start_unix_ns: i64) {
    let days = model.weather.as_ref().map(|weather| weather.days(start_unix_ns));
    let Some(days) = days.filter(|days| !days.is_empty()) else {
        line!("the model has no weather that lasts a day");
        return;
    };
    let mut months: Vec<&str> = days.iter().map(|day| &day.date[..7]).collect();
    months.dedup();
    let rows: Vec<Vec<String>> = months
        .iter()
        .map(|month| {
            let mut row = vec![(*month).to_owned()];
            row.extend(of_days(days.iter().filter(|day| day.date.starts_with(month))));
            row
        })
        .chain([[vec!["all".to_owned()], of_days(days.iter())].concat()])
        .collect();
    let columns = ["days", "mean degC", "lowest", "highest", "global kWh/m2"];
    print_table(&[&["month"], &columns[..]].concat(), &rows);
    let rows: Vec<Vec<String>> = TypeDay::all()
        .map(|kind| {
            let of_kind = days.iter().filter(|day| day.type_day == Some(kind));
            [vec![kind.words()], of_days(of_kind)].concat()
        })
        .collect();
    if days.iter().any(|day| day.type_day.is_some()) {
        line!("");
        print_table(&[&["type of day (VDI 4655)"], &columns[..]].concat(), &rows);
    }
}

/// Number, mean, extremes and irradiation of days.
fn of_days<'a>(days: impl Iterator<Item = &'a Day>) -> Vec<String> {
    let days: Vec<&Day> = days.collect();
    let degc = |t_k: f64| if t_k.is_finite() { format!("{:.1}", t_k - 273.15) } else { "-".into() };
    let mean_k = days.iter().map(|day| day.mean_k).sum::<f64>() / days.len() as f64;
    let lowest_k = days.iter().fold(f64::INFINITY, |lowest, day| lowest.min(day.lowest_k));
    let highest_k = days.iter().fold(f64::NEG_INFINITY, |highest, day| highest.max(day.highest_k));
    let global: Option<f64> = days.iter().map(|day| day.global_j_m2).sum();
    vec![
        days.len().to_string(),
        degc(mean_k),
        degc(lowest_k),
        degc(highest_k),
        global.map_or("-".into(), |j_m2| format!("{:.1}", j_m2 / 3.6e6)),
    ]
}
