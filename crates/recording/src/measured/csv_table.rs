//! Tables of text.

use super::names::{self, Head};
use super::remarks::Remarks;
use super::times::{Form, Time, number};
use super::{MeasuredColumn, MeasuredError, MeasuredOptions, MeasuredTable};
use std::borrow::Cow;

/// Names of columns with times.
const TIME_NAMES: [&str; 12] = [
    "time",
    "times",
    "timestamp",
    "datetime",
    "date_time",
    "date",
    "zeit",
    "zeitstempel",
    "datum",
    "t",
    "elapsed",
    "elapsed_time",
];
/// Words for nothing measured.
const NOTHING: [&str; 9] = ["", "nan", "na", "n/a", "null", "none", "-", "--", "nat"];

pub(super) fn read(
    bytes: &[u8],
    options: &MeasuredOptions,
) -> Result<MeasuredTable, MeasuredError> {
    let text: Cow<'_, str> = match std::str::from_utf8(bytes) {
        Ok(text) => text.trim_start_matches('\u{feff}').into(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect::<String>().into(),
    };
    let separator = match options.separator {
        Some(c) if c.is_ascii() && !c.is_ascii_alphanumeric() && !".\"#\n\r".contains(c) => c as u8,
        Some(c) => {
            return Err(MeasuredError::new(None, format!("{c:?} cannot separate cells")));
        }
        None => separator(&text),
    };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .comment(Some(b'#'))
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let heads = reader.headers().map_err(|error| unreadable(&error))?.clone();
    if heads.iter().all(str::is_empty) {
        return Err(MeasuredError::new(None, "the file has no head with the names of its columns"));
    }
    let mut table = Rows::new(&heads, options)?;
    let mut record = csv::StringRecord::new();
    let mut first = true;
    while reader.read_record(&mut record).map_err(|error| unreadable(&error))? {
        let line = record.position().map_or(0, csv::Position::line);
        if first && table.units(&record) {
            continue;
        }
        first = false;
        table.row(&record, line);
    }
    table.finish()
}

fn unreadable(error: &csv::Error) -> MeasuredError {
    MeasuredError::new(error.position().map(csv::Position::line), error.to_string())
}

/// What splits the first line that is no comment into most cells; of equals a semicolon, then a tab.
fn separator(text: &str) -> u8 {
    let head = text.lines().find(|line| !line.starts_with('#') && !line.trim().is_empty());
    let count =
        |separator: u8| head.unwrap_or_default().bytes().filter(|b| *b == separator).count();
    let mut best = b',';
    for candidate in [b'\t', b';'] {
        if count(candidate) > 0 && count(candidate) >= count(best).min(1) {
            best = candidate;
        }
    }
    best
}

struct Rows<'a> {
    options: &'a MeasuredOptions,
    heads: Vec<Head>,
    time: usize,
    form: Option<Form>,
    /// Line, time and values of each row.
    rows: Vec<(u64, Time, Vec<f64>)>,
    remarks: Remarks,
}

impl<'a> Rows<'a> {
    fn new(heads: &csv::StringRecord, options: &'a MeasuredOptions) -> Result<Self, MeasuredError> {
        let parsed: Vec<Head> = heads.iter().map(Head::of).collect();
        let time = match &options.time_column {
            Some(name) => heads.iter().position(|head| head == name).ok_or_else(|| {
                let names: Vec<&str> = heads.iter().collect();
                let near = names.iter().min_by_key(|head| strsim::damerau_levenshtein(head, name));
                let hint =
                    near.map_or(String::new(), |near| format!("; the nearest is \"{near}\""));
                MeasuredError::new(1, format!("there is no column \"{name}\" for the time{hint}"))
            })?,
            None => {
                let known = |head: &Head| {
                    TIME_NAMES.contains(&head.stem.to_lowercase().as_str())
                        && head.unit.is_none_or(|unit| unit.si == "s")
                };
                parsed.iter().position(known).unwrap_or(0)
            }
        };
        let (rows, remarks) = (Vec::new(), Remarks::default());
        Ok(Self { options, heads: parsed, time, form: None, rows, remarks })
    }

    /// Takes the row below the head where it holds units.
    fn units(&mut self, record: &csv::StringRecord) -> bool {
        if record.len() != self.heads.len() {
            return false;
        }
        let cell = |i: usize| record.get(i).unwrap_or_default().trim_matches(['[', ']', '(', ')']);
        let known = |i: usize| cell(i).is_empty() || names::unit(cell(i)).is_some();
        let word = |i: usize| !cell(i).is_empty() && number(cell(i)).is_none();
        let others = || (0..record.len()).filter(|&i| i != self.time);
        let time_is_time = Form::of(cell(self.time), None, 0.0).is_some();
        if time_is_time || !others().all(known) || !others().any(word) {
            return false;
        }
        for i in 0..self.heads.len() {
            if !cell(i).is_empty() && self.heads[i].unit.is_none() {
                self.heads[i].unit = names::unit(cell(i));
            }
        }
        true
    }

    fn row(&mut self, record: &csv::StringRecord, line: u64) {
        let (cells, wanted) = (record.len(), self.heads.len());
        if cells != wanted {
            self.remarks.add(1, "torn", Some(line), || {
                format!("{cells} cells instead of {wanted}: the row is left out (torn, or a separator in a number?)")
            });
            return;
        }
        let text = record.get(self.time).unwrap_or_default();
        let unit = self.heads[self.time].unit.filter(|unit| unit.si == "s");
        let form = self.form.or_else(|| {
            Form::of(text, unit.map(|unit| unit.to_si(1.0, false)), self.options.utc_offset_s)
        });
        let Some(time) = form.and_then(|form| form.read(text)) else {
            self.remarks.add(2, "time", Some(line), || {
                format!("\"{text}\" is no time as the others are: the row is left out")
            });
            return;
        };
        self.form = form;
        let mut values = Vec::with_capacity(wanted);
        for (i, head) in self.heads.iter().enumerate() {
            let cell = record.get(i).unwrap_or_default();
            let value = match number(cell) {
                _ if i == self.time => f64::NAN,
                Some(value) => {
                    head.unit.map_or(value, |unit| unit.to_si(value, head.is_difference()))
                }
                None => {
                    if !NOTHING.contains(&cell.to_lowercase().as_str()) {
                        let name = head.stem.clone();
                        self.remarks.add(3, &name, Some(line), || {
                            format!("\"{cell}\" in column \"{name}\" is no number: a gap")
                        });
                    }
                    f64::NAN
                }
            };
            values.push(value);
        }
        self.rows.push((line, time, values));
    }

    fn finish(mut self) -> Result<MeasuredTable, MeasuredError> {
        let time_name = &self.heads[self.time].stem;
        let Some(form) = self.form else {
            return Err(MeasuredError::new(
                2,
                format!(
                    "no row has a time in column \"{time_name}\": seconds, RFC 3339 (2024-01-31T12:00:00Z) or \
                     31.01.2024 12:00:00 are read"
                ),
            ));
        };
        if form.is_local() && self.options.utc_offset_s == 0.0 {
            self.remarks.add(7, "zone", None, || {
                "the times have no time zone and count as UTC: give the offset of the clock".into()
            });
        }
        if form.is_ambiguous() {
            self.remarks.add(7, "day", None, || "the times are read as day/month/year".into());
        }
        self.order();
        let rows = std::mem::take(&mut self.rows);
        let start_unix_ns = match rows.first() {
            Some((_, Time::Unix(ns), _)) => i64::try_from(*ns).ok(),
            _ => None,
        };
        let time_s = |time: &Time| match time {
            Time::Relative(seconds) => *seconds,
            Time::Unix(ns) => (ns - i128::from(start_unix_ns.unwrap_or(0))) as f64 / 1e9,
        };
        let mut columns: Vec<MeasuredColumn> = Vec::new();
        for (i, head) in self.heads.iter().enumerate().filter(|(i, _)| *i != self.time) {
            let values: Vec<f64> = rows.iter().map(|(.., values)| values[i]).collect();
            if let Some(word) = &head.unknown {
                let text =
                    || format!("column \"{}\": \"{word}\" is no known unit: as it is", head.stem);
                self.remarks.add(6, &head.stem, None, text);
            } else if head.unit.is_none() {
                let text = || format!("column \"{}\" has no unit: as it is, in SI?", head.stem);
                self.remarks.add(6, &head.stem, None, text);
            }
            if values.iter().all(|value| value.is_nan()) {
                self.remarks.add(5, &head.stem, None, || {
                    format!("column \"{}\" has no numbers: left out", head.stem)
                });
                continue;
            }
            let name = free(&columns, head.name());
            let unit = head.unit.map_or("", |unit| unit.si).to_owned();
            columns.push(MeasuredColumn { name, unit, values });
        }
        if columns.is_empty() {
            return Err(MeasuredError::new(None, "no column besides the time has numbers"));
        }
        let time_s = rows.iter().map(|(_, time, _)| time_s(time)).collect();
        Ok(MeasuredTable { start_unix_ns, time_s, columns, remarks: self.remarks.finish() })
    }

    /// Sorts the rows by time and leaves one of those at the same time.
    fn order(&mut self) {
        let key = |time: &Time| match time {
            Time::Relative(seconds) => (0, *seconds),
            Time::Unix(ns) => (*ns, 0.0),
        };
        let later = |a: &Time, b: &Time| {
            let (a, b) = (key(a), key(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        };
        for pair in 1..self.rows.len() {
            let [(_, before, _), (line, time, _)] = [&self.rows[pair - 1], &self.rows[pair]];
            if later(before, time).is_gt() {
                let line = *line;
                self.remarks.add(4, "order", Some(line), || {
                    "time goes back: the rows are sorted (was the clock set back? times with offset are safe)".into()
                });
            }
        }
        self.rows.sort_by(|a, b| later(&a.1, &b.1));
        let mut kept: Vec<(u64, Time, Vec<f64>)> = Vec::with_capacity(self.rows.len());
        for row in self.rows.drain(..) {
            match kept.last() {
                Some((first, time, values)) if *time == row.1 => {
                    let same = values.iter().zip(&row.2).all(|(a, b)| a.to_bits() == b.to_bits());
                    let (first, word) = (*first, if same { "the same" } else { "other" });
                    self.remarks.add(4, word, Some(row.0), || {
                        format!(
                            "the time of line {first} again, with {word} values: the first counts"
                        )
                    });
                }
                _ => kept.push(row),
            }
        }
        self.rows = kept;
    }
}

/// A name that no column has yet.
fn free(columns: &[MeasuredColumn], wanted: String) -> String {
    let taken = |name: &str| columns.iter().any(|column| column.name == name);
    if !taken(&wanted) {
        return wanted;
    }
    let stem = anergy_core::units::split_suffix(&wanted);
    let numbered = |i: usize| match stem {
        Some((stem, suffix)) => format!("{stem}_{i}_{suffix}"),
        None => format!("{wanted}_{i}"),
    };
    (2..).map(numbered).find(|name| !taken(name)).unwrap_or_default()
}
