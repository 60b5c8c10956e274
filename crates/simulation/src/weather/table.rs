//! Weather in CSV files: a row per interval, columns named like the signals, in any of their units.

use super::calendar::DAY_NS;
use super::irradiance::{Given, complete};
use super::records::{PointAt, Records};
use super::{Calendar, Problem};
use crate::diagnostic::did_you_mean;
use anergy_core::clock::NS_PER_S;
use anergy_core::solar::Location;
use anergy_core::units::{Unit, alternatives};
use jiff::civil::DateTime;
use jiff::tz::TimeZone;
use jiff::{SignedDuration, Timestamp};
use std::io::Read;

/// The longest interval: within it the sun is where it was in its middle, but for the turning of the earth.
const LONGEST_NS: i64 = 3 * 3600 * NS_PER_S;

/// The columns with their ranges in SI.
const COLUMNS: [(&str, (f64, f64)); 6] = [
    ("t_outdoor_k", (213.15, 343.15)),
    ("relative_humidity", (0.0, 1.1)),
    ("wind_m_s", (0.0, 100.0)),
    ("global_horizontal_w_m2", (0.0, 1500.0)),
    ("diffuse_horizontal_w_m2", (0.0, 1500.0)),
    ("beam_normal_w_m2", (0.0, 1500.0)),
];

/// How a file is to be read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reading<'a> {
    /// Its name in messages.
    pub name: &'a str,
    pub separator: u8,
    /// Column of the times; the first one where it is not named.
    pub time_column: Option<&'a str>,
    /// Start of the run, from which numbers of seconds count.
    pub start: Timestamp,
    /// What local times without time zone are ahead of UTC.
    pub ahead: Option<SignedDuration>,
    pub point_at: PointAt,
    pub location: Option<Location>,
}

/// A column that is read.
struct Column {
    place: usize,
    header: String,
    unit: Option<Unit>,
    range: (f64, f64),
    values: Vec<f64>,
}

impl Reading<'_> {
    /// Reads a file.
    ///
    /// # Errors
    /// The first problem, with line and column.
    pub(crate) fn read(&self, file: impl Read) -> Result<Records, Problem> {
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(self.separator)
            .comment(Some(b'#'))
            .flexible(true)
            .from_reader(std::io::BufReader::with_capacity(1 << 16, file));
        let headers = reader.headers().map_err(|error| self.unreadable(&error))?;
        let headers: Vec<String> = headers.iter().map(|header| header.trim().to_owned()).collect();
        let time_column = self.time_column(&headers)?;
        let mut columns = self.columns(&headers, time_column)?;
        let mut times: Vec<i64> = Vec::new();
        let mut record = csv::ByteRecord::new();
        while reader.read_byte_record(&mut record).map_err(|error| self.unreadable(&error))? {
            let line = record.position().map_or(0, csv::Position::line);
            if record.len() != headers.len() {
                let (found, expected) = (record.len(), headers.len());
                let message = format!("{found} columns instead of {expected}");
                return Err(self.at(line, &message).with_hint("is the file torn?"));
            }
            let cell = |place: usize| {
                String::from_utf8_lossy(record.get(place).unwrap_or_default()).trim().to_owned()
            };
            let time = self.unix_ns(&cell(time_column)).map_err(|problem| {
                let message = format!("column \"{}\": {problem}", headers[time_column]);
                self.at(line, &message)
            })?;
            self.follows(&times, time, line)?;
            times.push(time);
            for column in &mut columns {
                let value = column.value(&cell(column.place)).map_err(|problem| {
                    self.at(line, &format!("column \"{}\": {problem}", column.header))
                })?;
                column.values.push(value);
            }
        }
        self.records(&times, columns)
    }

    fn records(&self, times: &[i64], columns: Vec<Column>) -> Result<Records, Problem> {
        let [first, second, ..] = times else {
            let found = if times.is_empty() { "no rows" } else { "one row, from which" };
            let message = format!("{} has {found}", self.name)
                .replace("from which", "from which its interval does not follow");
            return Err(Problem::new("file", message));
        };
        let interval_ns = second - first;
        let begin_ns = match self.point_at {
            PointAt::Begin => *first,
            PointAt::End => first - interval_ns,
        };
        let mut found: [Option<Vec<f64>>; COLUMNS.len()] = Default::default();
        for column in columns {
            if let Some(i) = COLUMNS.iter().position(|(name, _)| si_name(&column.header) == *name) {
                found[i] = Some(column.values);
            }
        }
        let [t_outdoor_k, humidity, wind, global_w_m2, diffuse_w_m2, beam_normal_w_m2] = found;
        let mut records = Records {
            interval_ns,
            calendar: Calendar::Given { begin_ns },
            point_at: self.point_at,
            location: self.location,
            t_outdoor_k: t_outdoor_k.unwrap_or_default().into(),
            relative_humidity: humidity
                .map(|values| values.into_iter().map(|value| value.min(1.0)).collect()),
            wind_m_s: wind.map(Into::into),
            irradiance: None,
        };
        let given = Given { global_w_m2, diffuse_w_m2, beam_normal_w_m2 };
        if !given.is_empty() {
            if self.location.is_none() {
                let message = format!(
                    "{} has irradiances: latitude_rad and longitude_rad are missing",
                    self.name
                );
                let hint =
                    "write for example latitude_deg = 48.14 and longitude_deg = 11.58 (east)";
                return Err(Problem::new("file", message).with_hint(hint));
            }
            let begins = (0..times.len()).map(|i| begin_ns + i as i64 * interval_ns);
            let irradiance = complete(&records, begins, given).map_err(|missing| {
                Problem::new("file", format!("{} has no column {missing}", self.name))
            })?;
            records.irradiance = Some(irradiance);
        }
        Ok(records)
    }

    fn unreadable(&self, error: &csv::Error) -> Problem {
        Problem::new("file", format!("{}: {error}", self.name))
    }

    fn at(&self, line: u64, message: &str) -> Problem {
        Problem::new("file", format!("{} line {line}: {message}", self.name))
    }

    fn time_column(&self, headers: &[String]) -> Result<usize, Problem> {
        let Some(name) = self.time_column else { return Ok(0) };
        headers.iter().position(|header| header == name).ok_or_else(|| {
            let message = format!("{} has no column \"{name}\"", self.name);
            let hint = did_you_mean(name, headers.iter().map(String::as_str));
            let hint = hint.unwrap_or_else(|| format!("its columns: {}", headers.join(", ")));
            Problem::new("time_column", message).with_hint(hint)
        })
    }

    /// The columns that are weather; others must not look like weather.
    fn columns(&self, headers: &[String], time_column: usize) -> Result<Vec<Column>, Problem> {
        let mut columns: Vec<Column> = Vec::new();
        for (place, header) in headers.iter().enumerate() {
            if place == time_column {
                continue;
            }
            let si = si_name(header);
            let known = COLUMNS.iter().find(|(name, _)| si == *name);
            let Some((name, range)) = known else {
                let hint = did_you_mean(header, spellings().iter().map(String::as_str));
                let hint = hint.unwrap_or_else(|| {
                    format!("weather has the columns {}, also in other units", names())
                });
                let message = format!("{}: unknown column \"{header}\"", self.name);
                return Err(Problem::new("file", message).with_hint(hint));
            };
            if let Some(other) = columns.iter().find(|other| si_name(&other.header) == *name) {
                let message =
                    format!("{}: \"{}\" and \"{header}\" are the same", self.name, other.header);
                return Err(Problem::new("file", message));
            }
            let unit = spelled(name).into_iter().find(|(spelling, _)| spelling == header);
            columns.push(Column {
                place,
                header: header.clone(),
                unit: unit.and_then(|(_, unit)| unit),
                range: *range,
                values: Vec::new(),
            });
        }
        if columns.iter().all(|column| si_name(&column.header) != COLUMNS[0].0) {
            let message = format!("{} has no column t_outdoor_k", self.name);
            return Err(Problem::new("file", message).with_hint("also possible: t_outdoor_degc"));
        }
        Ok(columns)
    }

    /// Times rise in equal intervals.
    fn follows(&self, times: &[i64], time: i64, line: u64) -> Result<(), Problem> {
        let words = |ns: i64| {
            Timestamp::from_nanosecond(i128::from(ns))
                .map_or_else(|_| ns.to_string(), |t| t.to_string())
        };
        let Some(before) = times.last() else { return Ok(()) };
        if time <= *before {
            let message = format!("time {} is not after {}", words(time), words(*before));
            return Err(self.at(line, &message).with_hint("the times of a weather must rise"));
        }
        let found = time - before;
        let [first, second, ..] = times else {
            if found > LONGEST_NS || DAY_NS % found != 0 {
                let seconds = found as f64 / NS_PER_S as f64;
                let message = format!("an interval of {seconds} s");
                let hint =
                    "intervals are a part of a day, 3 h at most: hours or quarters of an hour";
                return Err(self.at(line, &message).with_hint(hint));
            }
            return Ok(());
        };
        let interval = second - first;
        if found == interval {
            return Ok(());
        }
        let (now, then) = (words(time), words(*before));
        let message = if found % interval == 0 {
            let missing = found / interval - 1;
            let are = if missing == 1 { "row is" } else { "rows are" };
            format!("{now} follows {then}: {missing} {are} missing")
        } else {
            let seconds = |ns: i64| ns as f64 / NS_PER_S as f64;
            let (found, interval) = (seconds(found), seconds(interval));
            format!("{now} follows {then}: {found} s, in rows of {interval} s")
        };
        Err(self.at(line, &message))
    }

    /// ns since 1970.
    fn unix_ns(&self, text: &str) -> Result<i64, String> {
        let ns = |time: Timestamp| i64::try_from(time.as_nanosecond()).map_err(|_| far(text));
        let start = ns(self.start)?;
        if let Ok(seconds) = text.parse::<f64>() {
            let after = anergy_core::clock::Time::from_s(seconds).ok_or_else(|| far(text))?;
            return Ok(start.saturating_add(after.0));
        }
        if let Ok(time) = text.parse::<Timestamp>() {
            return ns(time);
        }
        let local: DateTime = text.parse().map_err(|_| {
            format!("\"{text}\" is neither a time such as 2024-01-17T00:00:00+01:00 nor seconds")
        })?;
        let ahead = self.ahead.ok_or_else(|| {
            format!("\"{text}\" does not say its time zone: give utc_offset_h in [weather]")
        })?;
        let utc = local.to_zoned(TimeZone::UTC).map_err(|_| far(text))?.timestamp();
        ns(utc.checked_sub(ahead).map_err(|_| far(text))?)
    }
}

fn far(text: &str) -> String {
    format!("\"{text}\" is beyond what can be simulated")
}

impl Column {
    fn value(&self, text: &str) -> Result<f64, String> {
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        let number = number.ok_or_else(|| format!("\"{text}\" is not a finite number"))?;
        let value = self.unit.map_or(number, |unit| unit.to_si(number));
        let (min, max) = self.range;
        if (min..=max).contains(&value) {
            return Ok(value);
        }
        let written = |si: f64| self.unit.map_or(si, |unit| (unit.of_si(si) * 1e9).round() / 1e9);
        Err(format!("{number} is outside {} to {}", written(min), written(max)))
    }
}

/// The ways to write a column, SI first.
fn spelled(name: &str) -> Vec<(String, Option<Unit>)> {
    let mut all = vec![(name.to_owned(), None)];
    all.extend(alternatives(name).map(|(name, unit)| (name, Some(unit))));
    if name == "relative_humidity" {
        all.push((format!("{name}_percent"), Unit::find("percent")));
    }
    all
}

fn spellings() -> Vec<String> {
    COLUMNS.iter().flat_map(|(name, _)| spelled(name)).map(|(name, _)| name).collect()
}

fn names() -> String {
    COLUMNS.map(|(name, _)| name).join(", ")
}

/// The SI name of a column; itself where it is none.
fn si_name(header: &str) -> &str {
    let is = |name: &&str| spelled(name).iter().any(|(spelling, _)| spelling == header);
    COLUMNS.iter().map(|(name, _)| *name).find(is).unwrap_or(header)
}
