//! Performance maps of heat pumps from files: a table with a row per point, or a row of `hplib_database.csv`.
//!
//! **Table** columns are named like the fields of a map with their units (`modulation`, `source_degc`, `return_degc`
//! or `supply_degc`, `heat_kw`, `electric_kw` or `cop`); rows in any order, every combination once.
//!
//! **hplib** the columns `Model`, `Titel`, `Group`, `P_th_h_ref [W]`, `P_el_h_ref [W]`, `p1_P_el_h [1/°C]` to
//! `p4_P_el_h`, `p1_COP [-]` to `p4_COP`; for cooling `P_el_c_ref [W]`, `P_th_c_ref [W]`, `p1_P_el_c`, `p1_EER`.
//! The rows `Generic` have no reference: their heat at the reference point is given, and the electricity follows from
//! their COP there, as in the library (cooling: 0.6852 of the electricity of heating). **Source** `hplib2021`.

use crate::diagnostic::did_you_mean;
use crate::fields::converted;
use crate::grammar::Grammar;
use anergy_prosumer::performance_map::params::PerformanceMapParams;
use serde_json::Value;
use std::path::Path;

/// What is wrong with a map, and at which field of the entry.
#[derive(Debug)]
pub(super) struct Problem {
    pub field: &'static str,
    pub message: String,
    pub hint: Option<String>,
}

impl Problem {
    fn new(field: &'static str, message: impl Into<String>) -> Self {
        Self { field, message: message.into(), hint: None }
    }

    fn hint(self, hint: impl Into<String>) -> Self {
        Self { hint: Some(hint.into()), ..self }
    }
}

/// A CSV file in memory: header, and rows with their lines.
struct Sheet {
    file: String,
    header: Vec<String>,
    rows: Vec<(u64, csv::StringRecord)>,
}

impl Sheet {
    fn read(file: &str, dir: &Path) -> Result<Self, Problem> {
        let unreadable = |error: String| Problem::new("file", format!("{file}: {error}"));
        let text = std::fs::read_to_string(dir.join(file)).map_err(|error| {
            unreadable(format!("cannot be read: {error}"))
                .hint("the path is relative to the folder of the model file")
        })?;
        // Line by line, so that remarks do not shift the lines of messages.
        let mut rows = Vec::new();
        for (line, text) in (1..).zip(text.lines()) {
            if text.trim().is_empty() || text.starts_with('#') {
                continue;
            }
            let reader = csv::ReaderBuilder::new()
                .has_headers(false)
                .trim(csv::Trim::All)
                .from_reader(text.as_bytes());
            for record in reader.into_records() {
                rows.push((line, record.map_err(|error| unreadable(error.to_string()))?));
            }
        }
        if rows.is_empty() {
            return Err(unreadable("is empty".into()));
        }
        let header = rows.remove(0).1.iter().map(str::to_owned).collect();
        Ok(Self { file: file.to_owned(), header, rows })
    }

    /// The column that begins with a name: units in brackets may be spelled otherwise.
    fn column(&self, name: &str) -> Option<usize> {
        let is = |header: &String| {
            let rest = header.strip_prefix(name);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(" ["))
        };
        self.header.iter().position(is)
    }

    fn number(&self, row: &(u64, csv::StringRecord), column: usize) -> Result<f64, Problem> {
        let text = row.1.get(column).unwrap_or_default();
        text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
            let (file, line, name) = (&self.file, row.0, &self.header[column]);
            let message = format!("{file} line {line}, column {name}: \"{text}\" is not a number");
            Problem::new("file", message)
        })
    }
}

/// Fills a map from its file, if it names one.
///
/// # Errors
/// Names the file, the line and the column.
pub(super) fn from_file(map: &mut PerformanceMapParams, dir: &Path) -> Result<(), Problem> {
    let Some(file) = map.file.take() else {
        return match &map.hplib_model {
            Some(_) => Err(Problem::new("hplib_model", "hplib_model needs the database").hint(
                "write file = \"hplib_database.csv\", which github.com/FZJ-IEK3-VSA/hplib has",
            )),
            None => Ok(()),
        };
    };
    if !map.heat_w.is_empty() || !map.source_k.is_empty() {
        return Err(Problem::new("file", "file and a table are both given").hint("give only one"));
    }
    let sheet = Sheet::read(&file, dir)?;
    match map.hplib_model.take() {
        Some(model) => fit(map, &sheet, &model),
        None if sheet.column("p1_COP").is_some() => {
            Err(Problem::new("file", format!("{file} is a database: it is not said which unit"))
                .hint("write hplib_model = \"...\", its column Model"))
        }
        None => table(map, &sheet),
    }
}

/// Rising values of an axis, without repetition.
fn axis(values: &[f64]) -> Vec<f64> {
    let mut axis = values.to_vec();
    axis.sort_by(f64::total_cmp);
    axis.dedup();
    axis
}

fn table(map: &mut PerformanceMapParams, sheet: &Sheet) -> Result<(), Problem> {
    const COLUMNS: [&str; 7] =
        ["modulation", "source_k", "return_k", "supply_k", "heat_w", "electric_w", "cop"];
    let (file, grammar) = (&sheet.file, Grammar::of::<PerformanceMapParams>());
    let mut columns: [Option<Vec<f64>>; 7] = Default::default();
    for (at, name) in sheet.header.iter().enumerate() {
        let place = grammar.field(name).and_then(|(si, unit)| {
            COLUMNS.iter().position(|column| *column == si).map(|place| (place, unit))
        });
        let Some((place, unit)) = place else {
            let known: Vec<String> =
                COLUMNS.iter().flat_map(|column| Grammar::spellings(column)).collect();
            let hint = did_you_mean(name, known.iter().map(String::as_str))
                .unwrap_or_else(|| format!("its columns can be {}", known.join(", ")));
            return Err(
                Problem::new("file", format!("{file}: unknown column \"{name}\"")).hint(hint)
            );
        };
        let mut values = Vec::new();
        for row in &sheet.rows {
            let value = Value::from(sheet.number(row, at)?);
            let si = unit.map_or(Some(value.clone()), |unit| converted(&value, unit));
            values.push(si.and_then(|value| value.as_f64()).unwrap_or(f64::NAN));
        }
        if columns[place].replace(values).is_some() {
            return Err(Problem::new(
                "file",
                format!("{file}: two columns are {}", COLUMNS[place]),
            ));
        }
    }
    if sheet.rows.is_empty() {
        return Err(Problem::new("file", format!("{file} has no rows")));
    }
    let [modulation, source, returned, supply, heat, electric, cop] = columns;
    let missing = |name: &str| {
        let others = Grammar::spellings(name).join(", ");
        Problem::new("file", format!("{file} has no column {name}"))
            .hint(format!("possible: {others}"))
    };
    let source = source.ok_or_else(|| missing("source_k"))?;
    let heat = heat.ok_or_else(|| missing("heat_w"))?;
    let (water, by_return) = match (returned, supply) {
        (Some(water), None) => (water, true),
        (None, Some(water)) => (water, false),
        _ => {
            let message = format!("{file} needs one column of return_degc and supply_degc");
            return Err(Problem::new("file", message));
        }
    };
    let modulation = modulation.unwrap_or_else(|| vec![1.0; source.len()]);
    let (m_axis, s_axis, w_axis) = (axis(&modulation), axis(&source), axis(&water));
    let mut row_of = vec![None; m_axis.len() * s_axis.len() * w_axis.len()];
    let at = |axis: &[f64], value: f64| axis.partition_point(|point| *point < value);
    for (row, (line, _)) in sheet.rows.iter().enumerate() {
        let cell = (at(&m_axis, modulation[row]) * s_axis.len() + at(&s_axis, source[row]))
            * w_axis.len()
            + at(&w_axis, water[row]);
        if let Some(before) = row_of[cell].replace(row) {
            let before: usize = before;
            let message =
                format!("{file} line {line}: the point of line {} again", sheet.rows[before].0);
            return Err(Problem::new("file", message));
        }
    }
    if let Some(hole) = row_of.iter().position(Option::is_none) {
        let (outer, water) = (hole / w_axis.len(), w_axis[hole % w_axis.len()]);
        let (m, source) = (m_axis[outer / s_axis.len()], s_axis[outer % s_axis.len()]);
        let message = format!(
            "{file}: the map has a hole: no row for modulation {m}, source {:.2} degC, water {:.2} degC",
            source - 273.15,
            water - 273.15
        );
        return Err(Problem::new("file", message).hint(
            "every combination needs a row; repeat the nearest point where a unit cannot work",
        ));
    }
    let width = w_axis.len();
    map.heat_w = in_order(&row_of, width, &heat);
    map.electric_w = electric.map_or_else(Vec::new, |values| in_order(&row_of, width, &values));
    map.cop = cop.map_or_else(Vec::new, |values| in_order(&row_of, width, &values));
    if by_return {
        map.return_k = w_axis.clone();
    } else {
        map.supply_k = w_axis.clone();
    }
    (map.modulation, map.source_k) = (m_axis.clone(), s_axis.clone());
    Ok(())
}

/// A column in the order of the map: `row_of` is the row of each point, `width` the number of water temperatures.
fn in_order(row_of: &[Option<usize>], width: usize, values: &[f64]) -> Vec<Vec<f64>> {
    let cells: Vec<f64> = row_of.iter().flatten().map(|row| values[*row]).collect();
    cells.chunks(width).map(<[f64]>::to_vec).collect()
}

/// Reference points: temperatures of air, brine and water, of the supply and of the air outdoors, degC.
const SOURCE_DEGC: [f64; 3] = [-7.0, 0.0, 10.0];
const SUPPLY_DEGC: f64 = 52.0;
const OUTDOOR_DEGC: f64 = -7.0;
/// Electricity of a generic unit at 35/7 degC in cooling, as a share of that of heating.
const COOLING_SHARE: f64 = 0.6852;

fn fit(map: &mut PerformanceMapParams, sheet: &Sheet, model: &str) -> Result<(), Problem> {
    let file = &sheet.file;
    let column = |name: &str| {
        sheet.column(name).ok_or_else(|| {
            Problem::new("file", format!("{file} has no column \"{name}\""))
                .hint("hplib_database.csv of hplib 1.9 or newer has it")
        })
    };
    let text = |row: &(u64, csv::StringRecord), column: usize| {
        row.1.get(column).unwrap_or_default().to_owned()
    };
    let models = column("Model")?;
    let of_model: Vec<_> = sheet.rows.iter().filter(|row| text(row, models) == model).collect();
    if of_model.is_empty() {
        let mut names: Vec<String> = sheet.rows.iter().map(|row| text(row, models)).collect();
        names.sort();
        names.dedup();
        let hint = did_you_mean(model, names.iter().map(String::as_str))
            .unwrap_or_else(|| format!("it has {} units; look at its column Model", names.len()));
        let message = format!("{file} has no unit \"{model}\"");
        return Err(Problem::new("hplib_model", message).hint(hint));
    }
    let (groups, titles) = (column("Group")?, column("Titel")?);
    let mut found = Vec::new();
    for row in of_model {
        let group = sheet.number(row, groups)?;
        let of_group = map.hplib_group.is_none_or(|wanted| f64::from(wanted) == group);
        let of_title = map.hplib_title.as_ref().is_none_or(|title| *title == text(row, titles));
        if of_group && of_title {
            found.push((group, row));
        }
    }
    let (group, row) = match found[..] {
        [(group, row)] => (group, row),
        [] => {
            let message = format!("{file}: no row of \"{model}\" has that group and title");
            return Err(Problem::new("hplib_model", message));
        }
        _ => {
            let each =
                found.iter().map(|(group, row)| format!("{group} \"{}\"", text(row, titles)));
            let each: Vec<String> = each.collect();
            let message = format!("{file}: {} rows are \"{model}\"", found.len());
            return Err(Problem::new("hplib_model", message)
                .hint(format!("choose by hplib_group and hplib_title: {}", each.join(", "))));
        }
    };
    let number = |name: &str| sheet.number(row, column(name)?);
    let four = |name: &str| -> Result<[f64; 4], Problem> {
        let [a, b, c, d] = [1, 2, 3, 4].map(|i| number(&format!("p{i}_{name}")));
        Ok([a?, b?, c?, d?])
    };
    let line = |p: &[f64; 4], source: f64, supply: f64, outdoor: f64| {
        p[0] * source + p[1] * supply + p[2] + p[3] * outdoor
    };
    // The heating row decides the size; the fields say what the unit is at its reference point.
    let heat_w = number("P_th_h_ref").ok();
    let cop = four("COP")?;
    let source = SOURCE_DEGC[(group as usize).saturating_sub(1) % 3];
    let generic = |heat_w: f64| heat_w / line(&cop, source, SUPPLY_DEGC, OUTDOOR_DEGC);
    let wanted_w = map.hplib_heat_w.or(heat_w).ok_or_else(|| {
        Problem::new("hplib_model", format!("\"{model}\" has no size: hplib_heat_w is missing"))
            .hint("give hplib_heat_kw, its heat at the reference point (supply 52 degC)")
    })?;
    let heating_w = match heat_w {
        Some(heat_w) => number("P_el_h_ref")? * wanted_w / heat_w,
        None => generic(wanted_w),
    };
    let (electric_w, power, ratio) = if map.cooling {
        let ratio = four("EER").map_err(|_| {
            let message = format!("{file} line {}: \"{model}\" has no cooling", row.0);
            Problem::new("hplib_model", message)
        })?;
        let reference_w = match heat_w {
            Some(heat_w) => number("P_el_c_ref")? * wanted_w / heat_w,
            None => COOLING_SHARE * heating_w,
        };
        (reference_w, four("P_el_c")?, ratio)
    } else {
        (heating_w, four("P_el_h")?, cop)
    };
    map.hplib_group = Some(group as u8);
    map.hplib_title = None;
    map.hplib_heat_w = Some(wanted_w);
    map.hplib_electric_w = Some(electric_w);
    map.hplib_power_coefficients = Some(power);
    map.hplib_ratio_coefficients = Some(ratio);
    Ok(())
}

#[cfg(test)]
mod tests;
