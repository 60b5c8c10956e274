//! Columns of CSV files as signals over time: `value = file * scale + offset` in the unit of the entry.

use super::SeriesEntry;
use super::tables::separator_byte;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::Tree;
use jiff::Timestamp;
use std::path::Path;

/// Times in s and values of a column.
pub(super) type Column = (Vec<f64>, Vec<f64>);

/// Reads the column that an entry names.
///
/// # Errors
/// A missing or unreadable file, an unknown column, a line that is not a number, times that do not
/// rise: each with line and column of the CSV file.
pub(super) fn load(
    entry: &SeriesEntry,
    start: Option<Timestamp>,
    dir: &Path,
    tree: &Tree,
) -> Result<Column, Diagnostic> {
    let at = |field: &str| tree.get(field).and_then(|tree| tree.span.clone());
    let wrong = |field: &str, message: String| Diagnostic::new(message, at(field));
    let separator = separator_byte(entry.separator).ok_or_else(|| {
        let message = format!(
            "series of \"{}\": separator = {:?} cannot separate numbers",
            entry.signal, entry.separator
        );
        wrong("separator", message).with_hint("usual are \",\", \";\" and \"\\t\"")
    })?;
    if entry.scale == 0.0 {
        let message =
            format!("series of \"{}\": scale = 0 leaves nothing of the file", entry.signal);
        return Err(
            wrong("scale", message).with_hint("a constant is given where the signal starts")
        );
    }
    let path = dir.join(&entry.file);
    let file = std::fs::File::open(&path).map_err(|error| {
        wrong("file", format!("series \"{}\": cannot read {}: {error}", entry.signal, entry.file))
            .with_hint("the path is relative to the folder of the model file")
    })?;
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(file);
    let headers = reader
        .headers()
        .map_err(|error| wrong("file", format!("{}: {error}", entry.file)))?
        .clone();
    let find = |name: &str, field: &str| {
        headers.iter().position(|header| header == name).ok_or_else(|| {
            let hint = did_you_mean(name, headers.iter()).unwrap_or_else(|| {
                format!("its columns: {}", headers.iter().collect::<Vec<_>>().join(", "))
            });
            wrong(field, format!("{} has no column \"{name}\"", entry.file)).with_hint(hint)
        })
    };
    let value_column = find(&entry.column, "column")?;
    let time_column = match &entry.time_column {
        Some(name) => find(name, "time_column")?,
        None => 0,
    };
    let (mut times_s, mut values) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(|error| wrong("file", format!("{}: {error}", entry.file)))?;
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |column: usize| record.get(column).unwrap_or_default();
        let value: f64 = parse_finite(cell(value_column)).ok_or_else(|| {
            let message = format!(
                "{} line {line}: \"{}\" in column \"{}\" is not a finite number",
                entry.file,
                cell(value_column),
                entry.column
            );
            wrong("column", message)
        })?;
        let time_s = time_s(cell(time_column), start)
            .map_err(|problem| wrong("file", format!("{} line {line}: {problem}", entry.file)))?;
        if let Some(before) = times_s.last().filter(|before| **before >= time_s) {
            let message =
                format!("{} line {line}: time {time_s} s is not after {before} s", entry.file);
            return Err(wrong("file", message).with_hint("the times of a series must rise"));
        }
        times_s.push(time_s);
        values.push(value * entry.scale + entry.offset);
    }
    if values.is_empty() {
        return Err(wrong("file", format!("{} has no rows", entry.file)));
    }
    Ok((times_s, values))
}

fn parse_finite(text: &str) -> Option<f64> {
    text.parse::<f64>().ok().filter(|value| value.is_finite())
}

/// Seconds since the start of the run.
fn time_s(text: &str, start: Option<Timestamp>) -> Result<f64, String> {
    if let Some(seconds) = parse_finite(text) {
        return Ok(seconds);
    }
    let time: Timestamp = text
        .parse()
        .map_err(|_| format!("time \"{text}\" is neither a number of seconds nor RFC 3339"))?;
    let start = start.ok_or("calendar times need `start` in [run]")?;
    Ok((time.as_nanosecond() - start.as_nanosecond()) as f64 / 1e9)
}
