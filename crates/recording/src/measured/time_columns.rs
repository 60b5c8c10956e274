//! Which columns of a table hold the time.

use super::MeasuredError;
use super::names::Head;
use super::times::{Form, number};
use std::borrow::Cow;

/// Names of columns with times, in lower case; besides them a small `t`: a large one is a temperature.
const TIME_NAMES: [&str; 12] = [
    "time",
    "times",
    "timestamp",
    "datetime",
    "date_time",
    "date/time",
    "date",
    "zeit",
    "zeitstempel",
    "datum",
    "elapsed",
    "elapsed_time",
];
/// Names of columns with the day, and of those with the time of day beside them.
const DAY_NAMES: [&str; 2] = ["date", "datum"];
const CLOCK_NAMES: [&str; 3] = ["time", "zeit", "uhrzeit"];

/// The column with the time, or two of them.
pub(super) struct TimeColumns {
    pub time: usize,
    /// The column with the day where `time` has the time of day.
    pub day: Option<usize>,
}

impl TimeColumns {
    /// The column named `wanted`, else those whose names say so, else the first.
    pub fn of(
        names: &csv::StringRecord,
        heads: &[Head],
        wanted: Option<&str>,
    ) -> Result<Self, MeasuredError> {
        if let Some(wanted) = wanted {
            let time = names.iter().position(|name| name == wanted).ok_or_else(|| {
                let near =
                    names.iter().min_by_key(|name| strsim::damerau_levenshtein(name, wanted));
                let hint =
                    near.map_or(String::new(), |near| format!("; the nearest is \"{near}\""));
                MeasuredError::new(1, format!("there is no column \"{wanted}\" for the time{hint}"))
            })?;
            return Ok(Self { time, day: None });
        }
        let find = |known: &[&str]| {
            heads.iter().position(|head| {
                head.unit.is_none() && known.contains(&split(head).0.to_lowercase().as_str())
            })
        };
        if let (Some(day), Some(time)) = (find(&DAY_NAMES), find(&CLOCK_NAMES)) {
            return Ok(Self { time, day: Some(day) });
        }
        let known = |head: &Head| {
            let name = split(head).0;
            (name == "t" || TIME_NAMES.contains(&name.to_lowercase().as_str()))
                && head.unit.is_none_or(|unit| unit.si == "s")
        };
        Ok(Self { time: heads.iter().position(known).unwrap_or(0), day: None })
    }

    /// Leaves the column with the day aside where a row has the whole time in the other one.
    pub fn settle(&mut self, record: &csv::StringRecord) {
        let alone = record.get(self.time).unwrap_or_default();
        if number(alone).is_none() && Form::of(alone, None, 0.0).is_some() {
            self.day = None;
        }
    }

    /// Whether a column belongs to the time.
    pub fn contains(&self, column: usize) -> bool {
        column == self.time || self.day == Some(column)
    }

    /// The time of a row as it is written.
    pub fn text<'a>(&self, record: &'a csv::StringRecord) -> Cow<'a, str> {
        let cell = |column: usize| record.get(column).unwrap_or_default();
        match self.day {
            Some(day) => format!("{} {}", cell(day), cell(self.time)).into(),
            None => cell(self.time).into(),
        }
    }
}

/// The unit of times in s, where the head of their column says one.
pub(super) fn unit_s(head: &Head) -> Option<f64> {
    split(head).1
}

/// Name without unit, and the unit in s.
fn split(head: &Head) -> (&str, Option<f64>) {
    let stem = head.stem.as_str();
    if let Some(unit) = head.unit {
        return (stem, (unit.si == "s").then(|| unit.to_si(1.0, false)));
    }
    if let Some(word) = &head.unknown {
        return (stem, short_s(word));
    }
    match stem.rsplit_once('_') {
        Some((name, word)) if short_s(word).is_some() => (name, short_s(word)),
        _ => (stem, None),
    }
}

/// Units that only times of loggers have, s.
fn short_s(word: &str) -> Option<f64> {
    match word.to_lowercase().as_str() {
        "ms" | "msec" => Some(1e-3),
        // Micro sign and Greek mu.
        "us" | "\u{b5}s" | "\u{3bc}s" => Some(1e-6),
        "ns" => Some(1e-9),
        _ => None,
    }
}
