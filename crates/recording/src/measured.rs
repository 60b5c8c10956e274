//! Measured series: tables of a logger, whatever they look like, as columns in SI over one time.
//!
//! [`MeasuredTable::from_csv`] finds separator, decimal comma, time and units by itself and keeps what it can: what it
//! leaves out, reads as a gap or changes is told with line and reason in [`MeasuredTable::remarks`]. Only what would
//! make every number doubtful is an error.

mod csv_table;
mod messages;
mod names;
mod remarks;
#[cfg(test)]
mod tests;
mod time_columns;
mod times;

pub use remarks::Remark;

use anergy_core::recorder::Recording;
use std::io::{self, Write};
use thiserror::Error;

/// A gap in time is longer than this many usual intervals.
const GAP_INTERVALS: f64 = 2.5;

/// How a table is read; by default all of it is found out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeasuredOptions {
    /// Between the cells; absent: what gives the head the most cells.
    pub separator: Option<char>,
    /// The column with the time; absent: one whose name says so, or a day and a time of day, else the first.
    pub time_column: Option<String>,
    /// What times without time zone are ahead of UTC, s.
    pub utc_offset_s: f64,
    /// Topic of a recording of another program; absent: the only one with numbers.
    pub topic: Option<String>,
}

/// Why a file gives no table.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{}{problem}", .line.map_or(String::new(), |line| format!("line {line}: ")))]
pub struct MeasuredError {
    /// Line of the file.
    pub line: Option<u64>,
    /// What is wrong, and what to do.
    pub problem: String,
}

impl MeasuredError {
    fn new(line: impl Into<Option<u64>>, problem: impl Into<String>) -> Self {
        Self { line: line.into(), problem: problem.into() }
    }
}

/// One measured quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredColumn {
    /// Name, which ends in the SI unit where one is known.
    pub name: String,
    /// SI unit as at the end of names, for example `kg_s`; empty where the file says none.
    pub unit: String,
    /// Values in SI; NaN where nothing was measured.
    pub values: Vec<f64>,
}

/// A stretch of a column without values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Last time before it, s; the first time where nothing was measured before.
    pub from_s: f64,
    /// First time after it, s; the last time where nothing was measured after.
    pub to_s: f64,
}

/// Measured series over one time, which rises strictly.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeasuredTable {
    /// Calendar time of `time_s` = 0, ns since 1970; absent where the file counts seconds from anywhere.
    pub start_unix_ns: Option<i64>,
    /// Times, s.
    pub time_s: Vec<f64>,
    /// The quantities.
    pub columns: Vec<MeasuredColumn>,
    /// What was left out, changed, or is doubtful.
    pub remarks: Vec<Remark>,
}

impl MeasuredTable {
    /// Reads a table of text: UTF-8 or Latin-1, comments with `#`, a head with names, perhaps a row of units below.
    ///
    /// # Errors
    /// When there is no head, no column with times, or no row that can be read.
    pub fn from_csv(bytes: &[u8], options: &MeasuredOptions) -> Result<Self, MeasuredError> {
        csv_table::read(bytes, options)
    }

    /// Reads a recording in MCAP: one of this program, or JSON messages of another one.
    ///
    /// # Errors
    /// When it is no MCAP file, or it is not clear which topic is meant.
    pub fn from_mcap(bytes: &[u8], options: &MeasuredOptions) -> Result<Self, MeasuredError> {
        match crate::read_from_bytes(bytes, "recording") {
            Ok(read) => {
                let mut table = Self::from_recording(&read.recording);
                table.remarks.extend(read.damage.map(Remark::of_file));
                Ok(table)
            }
            Err(_) => messages::read(bytes, options),
        }
    }

    /// The rows of a run as if they had been measured.
    pub fn from_recording(recording: &Recording) -> Self {
        let start = recording.header.start_unix_ns;
        let column = |(channel, values): (&anergy_core::recorder::Channel, &Vec<f64>)| {
            let unit = anergy_core::units::split_suffix(&channel.quantity);
            MeasuredColumn {
                name: channel.name.clone(),
                unit: unit.map_or(String::new(), |(_, unit)| unit.to_owned()),
                values: values.clone(),
            }
        };
        let columns = recording.channels.iter().zip(&recording.columns).map(column).collect();
        let time_s = recording.time_s.clone();
        let start_unix_ns = (start != 0).then_some(start);
        Self { start_unix_ns, time_s, columns, remarks: Vec::new() }
    }

    /// The column of a name.
    pub fn column(&self, name: &str) -> Option<&MeasuredColumn> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// Usual time between two rows, s: the median; absent with less than two rows.
    pub fn interval_s(&self) -> Option<f64> {
        let mut steps: Vec<f64> = self.time_s.windows(2).map(|ends| ends[1] - ends[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied()
    }

    /// Where a column has no values: empty cells, and rows that are far apart.
    pub fn gaps(&self, column: &MeasuredColumn) -> Vec<Gap> {
        let (Some(first), Some(last)) = (self.time_s.first(), self.time_s.last()) else {
            return Vec::new();
        };
        let longest_s = GAP_INTERVALS * self.interval_s().unwrap_or(0.0);
        let mut gaps = Vec::new();
        let mut before: Option<(usize, f64)> = None;
        for (row, (&time_s, value)) in self.time_s.iter().zip(&column.values).enumerate() {
            if value.is_nan() {
                continue;
            }
            let next = before.map_or(0, |(row, _)| row + 1);
            let from_s = before.map_or(*first, |(_, time_s)| time_s);
            if row > next || (before.is_some() && time_s - from_s > longest_s) {
                gaps.push(Gap { from_s, to_s: time_s });
            }
            before = Some((row, time_s));
        }
        if before.is_none_or(|(row, _)| row + 1 < self.time_s.len()) {
            gaps.push(Gap { from_s: before.map_or(*first, |(_, time_s)| time_s), to_s: *last });
        }
        gaps
    }

    /// Empty cells get values on the line between their neighbours where these are not farther apart than
    /// `longest_s`; at the ends the nearest value holds for as long. The number of cells filled.
    pub fn fill(&mut self, longest_s: f64) -> usize {
        let mut filled = 0;
        for column in &mut self.columns {
            let known: Vec<usize> =
                (0..column.values.len()).filter(|&row| !column.values[row].is_nan()).collect();
            for row in 0..column.values.len() {
                if !column.values[row].is_nan() {
                    continue;
                }
                let after = known.partition_point(|&other| other < row);
                let next = known.get(after).copied();
                let last = after.checked_sub(1).map(|at| known[at]);
                let time = |row: usize| self.time_s[row];
                let value = match (last, next) {
                    (Some(a), Some(b)) if time(b) - time(a) <= longest_s => {
                        let share = (time(row) - time(a)) / (time(b) - time(a));
                        column.values[a] + share * (column.values[b] - column.values[a])
                    }
                    (Some(only), None) | (None, Some(only))
                        if (time(row) - time(only)).abs() <= longest_s =>
                    {
                        column.values[only]
                    }
                    _ => continue,
                };
                column.values[row] = value;
                filled += 1;
            }
        }
        filled
    }

    /// Writes the table as a file for `[[series]]`: `time` (RFC 3339) or `time_s`, then the columns in SI.
    ///
    /// # Errors
    /// When `out` cannot be written.
    pub fn write_csv(&self, out: impl Write) -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(out);
        let head = if self.start_unix_ns.is_some() { "time" } else { "time_s" };
        let names = self.columns.iter().map(|column| column.name.as_str());
        writer.write_record(std::iter::once(head).chain(names))?;
        for (row, &time_s) in self.time_s.iter().enumerate() {
            let time = match self.start_unix_ns {
                Some(start) => crate::csv_writer::calendar(start, time_s),
                None => crate::csv_writer::number(time_s),
            };
            let cells = self.columns.iter().map(|column| {
                crate::csv_writer::number(column.values.get(row).copied().unwrap_or(f64::NAN))
            });
            writer.write_record(std::iter::once(time).chain(cells))?;
        }
        writer.flush()
    }
}
