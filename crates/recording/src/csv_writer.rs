//! A recording as a table of text: one row per recorded row, the unit at the end of each column's name.
//!
//! Columns: `time_s`, then `time` (RFC 3339) when the run has a calendar start, then the channels. Numbers
//! are written in the shortest form that reads back to the same bits; what is not a number is empty.

use crate::selection::Chosen;
use anergy_core::recorder::Recording;
use jiff::Timestamp;
use std::io::{self, Write};

/// What was written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CsvSize {
    /// Rows below the head.
    pub rows: usize,
    /// Columns besides the time.
    pub columns: usize,
}

/// Writes the chosen channels; with `every_s` the first row at or after each multiple of it.
///
/// # Errors
/// When `out` cannot be written.
pub fn write_csv(
    recording: &Recording,
    chosen: &[Chosen],
    every_s: Option<f64>,
    out: impl Write,
) -> io::Result<CsvSize> {
    let start = recording.header.start_unix_ns;
    let mut writer = csv::Writer::from_writer(out);
    let mut record = csv::StringRecord::new();
    record.push_field("time_s");
    if start != 0 {
        record.push_field("time");
    }
    for channel in chosen {
        record.push_field(&channel.name);
    }
    writer.write_record(&record)?;
    let rows = rows(&recording.time_s, every_s);
    for &row in &rows {
        record.clear();
        let time_s = recording.time_s[row];
        record.push_field(&number(time_s));
        if start != 0 {
            record.push_field(&calendar(start, time_s));
        }
        for channel in chosen {
            let value = recording.columns[channel.index].get(row).copied().unwrap_or(f64::NAN);
            let value = channel.unit.map_or(value, |unit| unit.of_si(value));
            record.push_field(&number(value));
        }
        writer.write_record(&record)?;
    }
    writer.flush()?;
    Ok(CsvSize { rows: rows.len(), columns: chosen.len() })
}

/// The rows that are wanted.
fn rows(time_s: &[f64], every_s: Option<f64>) -> Vec<usize> {
    let Some(every_s) = every_s else { return (0..time_s.len()).collect() };
    let mut next_s = f64::NEG_INFINITY;
    let mut rows = Vec::new();
    for (row, &time) in time_s.iter().enumerate() {
        if time >= next_s {
            rows.push(row);
            next_s = ((time / every_s).floor() + 1.0) * every_s;
        }
    }
    rows
}

pub(crate) fn number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or_else(|| text.clone(), str::to_owned)
}

pub(crate) fn calendar(start_unix_ns: i64, time_s: f64) -> String {
    // The nearest nanosecond; beyond the calendar of 9999 years nothing is written.
    let ns = i128::from(start_unix_ns) + (time_s * 1e9).round() as i128;
    Timestamp::from_nanosecond(ns).map(|time| time.to_string()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_at_multiples() {
        let times = [0.0, 4.0, 10.0, 19.0, 21.0, 40.0];
        assert_eq!(rows(&times, Some(10.0)), [0, 2, 4, 5]);
        assert_eq!(rows(&times, None).len(), 6);
        assert_eq!(rows(&[3.0, 5.0, 10.0], Some(5.0)), [0, 1, 2]);
    }

    #[test]
    fn numbers_read_back() {
        for value in [0.1 + 0.2, 1e-300, -1.5e20, 60.0, 0.0] {
            assert_eq!(number(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
        assert_eq!((number(60.0).as_str(), number(f64::NAN).as_str()), ("60", ""));
        assert_eq!(calendar(1_700_000_000_000_000_000, 0.5), "2023-11-14T22:13:20.5Z");
    }
}
