//! Columns of CSV files as signals over time: `value = file * scale + offset` in the unit of the entry.
//!
//! Each file is read once, however many signals its columns drive, and their times are shared.

use super::SeriesEntry;
use super::tables::separator_byte;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::Tree;
use anergy_core::units::{Unit, split_suffix};
use jiff::Timestamp;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use std::sync::Arc;

/// Times in s and values of a column.
pub(super) type Column = (Arc<[f64]>, Arc<[f64]>);

/// A file with the way to read it: name, separator, column of the times.
type Key = (String, char, Option<String>);

fn key(entry: &SeriesEntry) -> Key {
    (entry.file.clone(), entry.separator, entry.time_column.clone())
}

/// What is wrong, and at which field of the entry and line of the file.
#[derive(Debug, Clone)]
struct Problem {
    field: &'static str,
    line: u64,
    message: String,
    hint: Option<String>,
}

impl Problem {
    fn new(field: &'static str, line: u64, message: String) -> Self {
        Self { field, line, message, hint: None }
    }

    fn diagnostic(self, tree: &Tree) -> Diagnostic {
        let span = tree.get(self.field).and_then(|tree| tree.span.range());
        let problem = Diagnostic::new(self.message, span);
        match self.hint {
            Some(hint) => problem.with_hint(hint),
            None => problem,
        }
    }
}

/// Values of a column up to its first problem.
struct Values {
    values: Arc<[f64]>,
    problem: Option<Problem>,
}

/// What was wanted of a file.
struct Contents {
    headers: Vec<String>,
    times: Values,
    /// By their place in the file.
    columns: HashMap<usize, Values>,
}

/// The files of all series of a model.
pub(super) struct Files<'a> {
    dir: &'a Path,
    start: Option<Timestamp>,
    wanted: HashMap<Key, BTreeSet<&'a str>>,
    read: HashMap<Key, Result<Contents, Problem>>,
}

impl<'a> Files<'a> {
    /// Nothing is read yet.
    pub(super) fn new(
        dir: &'a Path,
        start: Option<Timestamp>,
        entries: impl Iterator<Item = &'a SeriesEntry>,
    ) -> Self {
        let mut wanted: HashMap<Key, BTreeSet<&str>> = HashMap::new();
        for entry in entries {
            wanted.entry(key(entry)).or_default().insert(&entry.column);
        }
        Self { dir, start, wanted, read: HashMap::new() }
    }

    /// The column that an entry names.
    ///
    /// # Errors
    /// A missing or unreadable file, an unknown column, a line that is not a number, times that do not
    /// rise: each with line and column of the CSV file.
    pub(super) fn load(&mut self, entry: &SeriesEntry, tree: &Tree) -> Result<Column, Diagnostic> {
        let separator = separator_byte(entry.separator).ok_or_else(|| {
            let message = format!(
                "series of \"{}\": separator = {:?} cannot separate numbers",
                entry.signal, entry.separator
            );
            Problem {
                hint: Some("usual are \",\", \";\" and \"\\t\"".into()),
                ..Problem::new("separator", 0, message)
            }
            .diagnostic(tree)
        })?;
        if entry.scale == 0.0 {
            let message =
                format!("series of \"{}\": scale = 0 leaves nothing of the file", entry.signal);
            return Err(Problem {
                hint: Some("a constant is given where the signal starts".into()),
                ..Problem::new("scale", 0, message)
            }
            .diagnostic(tree));
        }
        let key = key(entry);
        let columns = self.wanted.get(&key).cloned().unwrap_or_default();
        let (dir, start) = (self.dir, self.start);
        let read = self
            .read
            .entry(key)
            .or_insert_with(|| contents(dir, start, entry, separator, &columns));
        let contents = match read {
            Ok(contents) => contents,
            Err(problem) => return Err(problem.clone().diagnostic(tree)),
        };
        let place = find(&contents.headers, &entry.file, &entry.column, "column");
        let column = place.and_then(|place| {
            let Values { values, problem } = &contents.columns[&place];
            let (first, second) = (problem.as_ref(), contents.times.problem.as_ref());
            let earlier = match (first, second) {
                (Some(first), Some(second)) if second.line < first.line => Some(second),
                (first, second) => first.or(second),
            };
            match earlier {
                Some(problem) => Err(problem.clone()),
                None if values.is_empty() => {
                    Err(Problem::new("file", 0, format!("{} has no rows", entry.file)))
                }
                None if (entry.scale, entry.offset) == (1.0, 0.0) => {
                    Ok((contents.times.values.clone(), values.clone()))
                }
                None => {
                    let scaled = values.iter().map(|value| value * entry.scale + entry.offset);
                    Ok((contents.times.values.clone(), scaled.collect()))
                }
            }
        });
        column.map_err(|problem| problem.diagnostic(tree))
    }
}

fn find(headers: &[String], file: &str, name: &str, field: &'static str) -> Result<usize, Problem> {
    headers.iter().position(|header| header == name).ok_or_else(|| {
        let hint = did_you_mean(name, headers.iter().map(String::as_str))
            .unwrap_or_else(|| format!("its columns: {}", headers.join(", ")));
        Problem {
            hint: Some(hint),
            ..Problem::new(field, 0, format!("{file} has no column \"{name}\""))
        }
    })
}

/// Times and wanted columns of a file.
fn contents(
    dir: &Path,
    start: Option<Timestamp>,
    entry: &SeriesEntry,
    separator: u8,
    wanted: &BTreeSet<&str>,
) -> Result<Contents, Problem> {
    let name = &entry.file;
    let file = std::fs::File::open(dir.join(name)).map_err(|error| Problem {
        hint: Some("the path is relative to the folder of the model file".into()),
        ..Problem::new(
            "file",
            0,
            format!("series \"{}\": cannot read {name}: {error}", entry.signal),
        )
    })?;
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .comment(Some(b'#'))
        .from_reader(std::io::BufReader::with_capacity(1 << 16, file));
    let unreadable =
        |line: u64, error: csv::Error| Problem::new("file", line, format!("{name}: {error}"));
    let headers = reader.headers().map_err(|error| unreadable(0, error))?;
    let headers: Vec<String> = headers.iter().map(|header| header.trim().to_owned()).collect();
    let time_column = match &entry.time_column {
        // A column of values that is missing is told first.
        Some(time) => find(&headers, name, &entry.column, "column")
            .and_then(|_| find(&headers, name, time, "time_column"))?,
        None => 0,
    };
    let time_unit = time_unit(&headers[time_column]);
    let places = headers.iter().enumerate().filter(|(_, header)| wanted.contains(header.as_str()));
    // Of columns with the same name the first counts.
    let mut columns: Vec<(usize, Vec<f64>, Option<Problem>)> = Vec::new();
    for (place, header) in places {
        if columns.iter().all(|(before, ..)| headers[*before] != *header) {
            columns.push((place, Vec::new(), None));
        }
    }
    let mut times: (Vec<f64>, Option<Problem>) = (Vec::new(), None);
    let mut record = csv::ByteRecord::new();
    loop {
        let line = reader.position().line();
        match reader.read_byte_record(&mut record) {
            Ok(true) => {}
            Ok(false) => break,
            Err(error) => {
                times.1.get_or_insert(unreadable(line, error));
                break;
            }
        }
        let line = record.position().map_or(line, csv::Position::line);
        let cell = |column: usize| String::from_utf8_lossy(record.get(column).unwrap_or_default());
        for (place, values, problem) in &mut columns {
            let text = cell(*place);
            match parse_finite(text.trim()) {
                Some(value) => values.push(value),
                None if problem.is_none() => {
                    let message = format!(
                        "{name} line {line}: \"{}\" in column \"{}\" is not a finite number",
                        text.trim(),
                        headers[*place]
                    );
                    *problem = Some(Problem::new("column", line, message));
                }
                None => {}
            }
        }
        if times.1.is_some() {
            continue;
        }
        match time_s(cell(time_column).trim(), time_unit, start) {
            Err(problem) => {
                let message = format!("{name} line {line}: {problem}");
                times.1 = Some(Problem::new("file", line, message));
            }
            Ok(time_s) => match times.0.last().filter(|before| **before >= time_s) {
                Some(before) => {
                    let message =
                        format!("{name} line {line}: time {time_s} s is not after {before} s");
                    times.1 = Some(Problem {
                        hint: Some("the times of a series must rise".into()),
                        ..Problem::new("file", line, message)
                    });
                }
                None => times.0.push(time_s),
            },
        }
    }
    let values = |values: Vec<f64>, problem| Values { values: values.into(), problem };
    Ok(Contents {
        headers,
        times: values(times.0, times.1),
        columns: columns
            .into_iter()
            .map(|(place, found, problem)| (place, values(found, problem)))
            .collect(),
    })
}

fn parse_finite(text: &str) -> Option<f64> {
    text.parse::<f64>().ok().filter(|value| value.is_finite())
}

/// The unit of a column of times by its name: `time_h`, `hour`, `day`; `None`: s.
fn time_unit(header: &str) -> Option<Unit> {
    let word = match header.to_lowercase().trim_end_matches('s') {
        "hour" | "h" => "h",
        "minute" | "min" => "min",
        "day" | "d" => "d",
        _ => split_suffix(header)?.1,
    };
    Unit::find(word).filter(|unit| unit.si == "s")
}

/// Seconds since the start of the run.
fn time_s(text: &str, unit: Option<Unit>, start: Option<Timestamp>) -> Result<f64, String> {
    if let Some(time) = parse_finite(text) {
        return Ok(unit.map_or(time, |unit| unit.to_si(time)));
    }
    let time: Timestamp = text
        .parse()
        .map_err(|_| format!("time \"{text}\" is neither a number of seconds nor RFC 3339"))?;
    let start = start.ok_or("calendar times need `start` in [run]")?;
    Ok((time.as_nanosecond() - start.as_nanosecond()) as f64 / 1e9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_a_column_says_the_unit_of_its_times() {
        let seconds = |header: &str| time_unit(header).map_or(1.0, |unit| unit.to_si(1.0));
        for (header, expected) in [
            ("time_s", 1.0),
            ("time", 1.0),
            ("timestamp", 1.0),
            ("t", 1.0),
            ("time_min", 60.0),
            ("time_h", 3600.0),
            ("Hour", 3600.0),
            ("hours", 3600.0),
            ("h", 3600.0),
            ("day", 86_400.0),
            ("elapsed_d", 86_400.0),
            ("time_kw", 1.0),
        ] {
            assert_eq!(seconds(header), expected, "{header}");
        }
        assert_eq!(time_s("1.5", time_unit("time_h"), None), Ok(5400.0));
    }
}
