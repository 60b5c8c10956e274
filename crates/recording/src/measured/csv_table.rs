//! Tables of text.

use super::names::{self, Head};
use super::remarks::Remarks;
use super::time_columns::{self, TimeColumns};
use super::times::{Form, Time, number};
use super::{MeasuredColumn, MeasuredError, MeasuredOptions, MeasuredTable};
use std::borrow::Cow;

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
        if first {
            table.times.settle(&record);
            if table.units(&record) {
                continue;
            }
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
    // Every second piece is between quotes.
    let open: String = head.unwrap_or_default().split('"').step_by(2).collect();
    let count = |separator: u8| open.bytes().filter(|byte| *byte == separator).count();
    [b',', b'\t', b';']
        .into_iter()
        .filter(|c| count(*c) > 0)
        .max_by_key(|c| count(*c))
        .unwrap_or(b',')
}

/// Numbers with one comma, which could stand before decimals or thousands.
#[derive(Default)]
struct Commas {
    /// Line and text of the first that could be either.
    doubtful: Option<(u64, String)>,
    /// Whether one can only be a decimal comma.
    decimal: bool,
}

impl Commas {
    fn see(&mut self, line: u64, cell: &str) {
        let Some((whole, rest)) = cell.split_once(',') else { return };
        let whole = whole.trim_start_matches(['-', '+']);
        let thousands =
            rest.len() == 3 && (1..=3).contains(&whole.len()) && !whole.starts_with('0');
        if !thousands {
            self.decimal = true;
        } else if self.doubtful.is_none() {
            self.doubtful = Some((line, cell.to_owned()));
        }
    }
}

struct Rows<'a> {
    options: &'a MeasuredOptions,
    heads: Vec<Head>,
    times: TimeColumns,
    form: Option<Form>,
    /// Line, time and values of each row.
    rows: Vec<(u64, Time, Vec<f64>)>,
    commas: Commas,
    remarks: Remarks,
}

impl<'a> Rows<'a> {
    fn new(heads: &csv::StringRecord, options: &'a MeasuredOptions) -> Result<Self, MeasuredError> {
        let parsed: Vec<Head> = heads.iter().map(Head::of).collect();
        let times = TimeColumns::of(heads, &parsed, options.time_column.as_deref())?;
        let (rows, commas, remarks) = (Vec::new(), Commas::default(), Remarks::default());
        Ok(Self { options, heads: parsed, times, form: None, rows, commas, remarks })
    }

    /// Takes the row below the head where it holds units.
    fn units(&mut self, record: &csv::StringRecord) -> bool {
        if record.len() != self.heads.len() {
            return false;
        }
        let cell = |i: usize| record.get(i).unwrap_or_default().trim_matches(['[', ']', '(', ')']);
        let known = |i: usize| cell(i).is_empty() || names::unit(cell(i)).is_some();
        let word = |i: usize| !cell(i).is_empty() && number(cell(i)).is_none();
        let others = || (0..record.len()).filter(|&i| !self.times.contains(i));
        let time_is_time = Form::of(&self.times.text(record), None, 0.0).is_some();
        if time_is_time || !others().all(known) || !others().any(word) {
            return false;
        }
        for i in 0..self.heads.len() {
            if !cell(i).is_empty() && self.heads[i].unit.is_none() {
                self.heads[i].unit = names::unit(cell(i));
                if i == self.times.time && self.heads[i].unit.is_none() {
                    self.heads[i].unknown = Some(cell(i).to_owned());
                }
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
        let text = self.times.text(record);
        let form = self.form.or_else(|| {
            let unit_s = time_columns::unit_s(&self.heads[self.times.time]);
            Form::of(&text, unit_s, self.options.utc_offset_s)
        });
        let Some(time) = form.and_then(|form| form.read(&text)) else {
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
                _ if self.times.contains(i) => f64::NAN,
                Some(value) => {
                    self.commas.see(line, cell);
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
        let time_head = &self.heads[self.times.time];
        let time_name = &time_head.stem;
        let day_name = self.times.day.map(|day| &self.heads[day].stem);
        let Some(form) = self.form else {
            if let Some(day_name) = day_name {
                let problem = format!(
                    "no row has a day in column \"{day_name}\" and a time of day in column \"{time_name}\" \
                     (2024-01-31 and 12:00:00): name the column that has the whole time"
                );
                return Err(MeasuredError::new(2, problem));
            }
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
        if let Some(day_name) = day_name {
            self.remarks.add(7, "columns", None, || {
                format!("the time is put together from columns \"{day_name}\" and \"{time_name}\"")
            });
        }
        if let (Form::Unix(unit_ns), Some(unit_s)) = (form, time_columns::unit_s(time_head))
            && unit_ns < 0.5e9 * unit_s
        {
            self.remarks.add(7, "unit", None, || {
                format!(
                    "column \"{time_name}\" counts in units of {} s since 1970, as its numbers are too large for \
                     the unit in the head",
                    unit_ns / 1e9
                )
            });
        }
        if let (Some((line, cell)), false) = (self.commas.doubtful.take(), self.commas.decimal) {
            self.remarks.add(6, "commas", Some(line), || {
                format!("decimal commas: \"{cell}\" is {}, not thousands", cell.replace(',', "."))
            });
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
        for (i, head) in self.heads.iter().enumerate().filter(|(i, _)| !self.times.contains(*i)) {
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
pub(super) fn free(columns: &[MeasuredColumn], wanted: String) -> String {
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
