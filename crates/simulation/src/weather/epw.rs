//! Weather files of EnergyPlus (EPW).
//!
//! Eight lines of header, then a line per interval. The first line has the place, the eighth the number of
//! intervals in an hour. Hour 1 ends at 01:00 of local standard time: irradiance is the mean of the time before,
//! temperature, humidity and wind are those at that time. Years mean nothing: typical years are made of months of
//! different ones.

use super::calendar::{DAY_NS, LEAP_DAY, date_of, day_of_leap_year};
use super::irradiance::{Given, complete};
use super::records::{PointAt, Records};
use super::{Calendar, Problem};
use anergy_core::clock::NS_PER_S;
use anergy_core::medium::ZERO_CELSIUS_K;
use anergy_core::solar::Location;
use std::io::Read;

/// A field of a line: its column from 0, its name, its range, and from where on a number means that it is missing.
struct Field {
    column: usize,
    name: &'static str,
    range: (f64, f64),
    missing_from: f64,
}

const fn field(column: usize, name: &'static str, range: (f64, f64), missing_from: f64) -> Field {
    Field { column, name, range, missing_from }
}

const TEMPERATURE: Field = field(6, "dry bulb temperature", (-60.0, 70.0), 99.9);
const HUMIDITY: Field = field(8, "relative humidity", (0.0, 110.0), 999.0);
const GLOBAL: Field = field(13, "global horizontal radiation", (0.0, 1500.0), 9999.0);
const BEAM: Field = field(14, "direct normal radiation", (0.0, 1500.0), 9999.0);
const DIFFUSE: Field = field(15, "diffuse horizontal radiation", (0.0, 1500.0), 9999.0);
const WIND: Field = field(21, "wind speed", (0.0, 100.0), 999.0);

/// What a whole number of the header or a date can be.
const HEADER_LINES: u64 = 8;

/// Reads a file; `name` is that of messages.
///
/// # Errors
/// The first problem, with line and column.
pub(crate) fn read(name: &str, file: impl Read) -> Result<Records, Problem> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .quoting(false)
        .from_reader(std::io::BufReader::with_capacity(1 << 16, file));
    let mut lines = Lines { name, record: csv::ByteRecord::new(), line: 0 };
    let (mut place, mut per_hour) = (None, 1);
    while lines.line < HEADER_LINES {
        if !lines.next(&mut reader)? {
            let hint = "an EPW file begins with eight lines of header, the first of them LOCATION";
            if lines.line == 0 {
                return Err(Problem::new("file", format!("{name} is empty")).with_hint(hint));
            }
            return Err(lines.problem("the file ends in its header").with_hint(hint));
        }
        match (lines.line, lines.text(0).to_uppercase().as_str()) {
            (1, "LOCATION") => place = Some(lines.location()?),
            (1, _) => {
                let found = lines.text(0);
                let message = format!("an EPW file begins with LOCATION, not \"{found}\"");
                return Err(lines.problem(&message));
            }
            (_, "DATA PERIODS") => per_hour = lines.per_hour()?,
            _ => {}
        }
    }
    let Some((location, ahead_ns)) = place else { return Err(lines.problem("no LOCATION")) };
    let per_day = 24 * per_hour;
    let mut slots: Vec<usize> = Vec::with_capacity(366 * per_day);
    let mut used = vec![false; 366 * per_day];
    let mut columns: [Vec<f64>; 6] = Default::default();
    while lines.next(&mut reader)? {
        let slot = lines.slot(per_hour)?;
        if let Some(before) = slots.last() {
            lines.follows(*before, slot, per_day)?;
        }
        if std::mem::replace(&mut used[slot], true) {
            let message = format!("{} occurs twice", words(slot, per_day));
            return Err(lines.problem(&message));
        }
        slots.push(slot);
        let fields = [TEMPERATURE, HUMIDITY, WIND, GLOBAL, DIFFUSE, BEAM];
        for (column, field) in columns.iter_mut().zip(&fields) {
            column.push(lines.number(field)?);
        }
    }
    if slots.is_empty() {
        return Err(lines.problem("no weather after the header"));
    }
    let [t_degc, humidity, wind, global, diffuse, beam] = columns;
    let mut records = Records {
        interval_ns: DAY_NS / per_day as i64,
        calendar: Calendar::every_year(ahead_ns, &slots, per_day),
        point_at: PointAt::End,
        location: Some(location),
        t_outdoor_k: t_degc.iter().map(|degc| degc + ZERO_CELSIUS_K).collect(),
        relative_humidity: Some(humidity.iter().map(|percent| (0.01 * percent).min(1.0)).collect()),
        wind_m_s: Some(wind.into()),
        irradiance: None,
    };
    let given = Given {
        global_w_m2: Some(global),
        diffuse_w_m2: Some(diffuse),
        beam_normal_w_m2: Some(beam),
    };
    let begins = std::iter::empty();
    records.irradiance =
        Some(complete(&records, begins, given).map_err(|missing| lines.problem(missing))?);
    Ok(records)
}

/// `03-27 14:00`: the end of an interval.
fn words(slot: usize, per_day: usize) -> String {
    let minutes = (slot % per_day + 1) * 1440 / per_day;
    format!("{} {:02}:{:02}", date_of(slot / per_day), minutes / 60, minutes % 60)
}

/// The lines of a file, one at a time.
struct Lines<'a> {
    name: &'a str,
    record: csv::ByteRecord,
    line: u64,
}

impl Lines<'_> {
    fn next(&mut self, reader: &mut csv::Reader<impl Read>) -> Result<bool, Problem> {
        let read = reader.read_byte_record(&mut self.record);
        let more = read.map_err(|error| Problem::new("file", format!("{}: {error}", self.name)))?;
        if more {
            self.line = self.record.position().map_or(self.line + 1, csv::Position::line);
        }
        Ok(more)
    }

    fn text(&self, column: usize) -> String {
        String::from_utf8_lossy(self.record.get(column).unwrap_or_default()).trim().to_owned()
    }

    fn problem(&self, message: &str) -> Problem {
        Problem::new("file", format!("{} line {}: {message}", self.name, self.line))
    }

    fn in_column(&self, column: usize, what: &str, message: &str) -> Problem {
        let (name, line) = (self.name, self.line);
        Problem::new(
            "file",
            format!("{name} line {line}, column {} ({what}): {message}", column + 1),
        )
    }

    /// A number within a range.
    fn within(&self, column: usize, what: &str, (min, max): (f64, f64)) -> Result<f64, Problem> {
        let text = self.text(column);
        if column >= self.record.len() {
            return Err(self
                .in_column(column, what, &format!("the line has {} columns", self.record.len()))
                .with_hint("is the file torn?"));
        }
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        let number = number.ok_or_else(|| {
            self.in_column(column, what, &format!("\"{text}\" is not a finite number"))
        })?;
        if !(min..=max).contains(&number) {
            let message = format!("{number} is outside {min} to {max}");
            return Err(self.in_column(column, what, &message));
        }
        Ok(number)
    }

    fn number(&self, field: &Field) -> Result<f64, Problem> {
        let Field { column, name, range, missing_from } = *field;
        if self.text(column).parse().is_ok_and(|number: f64| number >= missing_from) {
            let message = format!("{} means that it is missing", self.text(column));
            let hint = "fill the gaps of the file first: nothing is made up here";
            return Err(self.in_column(column, name, &message).with_hint(hint));
        }
        self.within(column, name, range)
    }

    fn whole(&self, column: usize, what: &str, range: (u32, u32)) -> Result<u32, Problem> {
        let number = self.within(column, what, (f64::from(range.0), f64::from(range.1)))?;
        if number.fract() != 0.0 {
            return Err(self.in_column(column, what, &format!("{number} is no whole number")));
        }
        Ok(number as u32)
    }

    /// Place and time zone: what it is ahead of UTC, ns.
    fn location(&self) -> Result<(Location, i64), Problem> {
        let latitude = self.within(6, "latitude", (-90.0, 90.0))?;
        let longitude = self.within(7, "longitude", (-180.0, 180.0))?;
        let hours = self.within(8, "time zone", (-14.0, 14.0))?;
        let location =
            Location { latitude_rad: latitude.to_radians(), longitude_rad: longitude.to_radians() };
        Ok((location, (hours * 3600.0).round() as i64 * NS_PER_S))
    }

    /// Intervals in an hour.
    fn per_hour(&self) -> Result<usize, Problem> {
        let what = "number of intervals in an hour";
        let number = self.whole(2, what, (1, 60))?;
        if 60 % number != 0 {
            let message = format!("an hour cannot be cut into {number}");
            return Err(self.in_column(2, what, &message));
        }
        Ok(number as usize)
    }

    /// The interval of the line, in intervals of a leap year.
    fn slot(&self, per_hour: usize) -> Result<usize, Problem> {
        let (month, date) = (self.whole(1, "month", (1, 12))?, self.whole(2, "day", (1, 31))?);
        let day = day_of_leap_year(month, date)
            .ok_or_else(|| self.in_column(2, "day", &format!("month {month} has no day {date}")))?;
        let hour = self.whole(3, "hour", (1, 24))? as usize;
        let minute = self.whole(4, "minute", (0, 60))? as usize;
        // In files of whole hours the minute is 0 or 60.
        let within = if per_hour == 1 { 1 } else { minute * per_hour / 60 };
        if per_hour > 1 && (minute == 0 || !(minute * per_hour).is_multiple_of(60)) {
            let message = format!("{minute} is no end of one of {per_hour} intervals in an hour");
            return Err(self.in_column(4, "minute", &message));
        }
        Ok((24 * day + hour - 1) * per_hour + within - 1)
    }

    /// Whether an interval follows another one: across New Year, and across a leap day that the file lacks.
    fn follows(&self, before: usize, slot: usize, per_day: usize) -> Result<(), Problem> {
        let expected = (before + 1) % (366 * per_day);
        let leap = LEAP_DAY * per_day;
        if slot == expected || (expected == leap && slot == leap + per_day) {
            return Ok(());
        }
        let (now, then) = (words(slot, per_day), words(before, per_day));
        if slot > before {
            let message = format!("{now} follows {then}: {} are missing", slot - before - 1);
            Err(self.problem(&message.replace(": 1 are", ": 1 is")))
        } else {
            let hint = "the times of a weather must rise";
            Err(self.problem(&format!("{now} is not after {then}")).with_hint(hint))
        }
    }
}

#[cfg(test)]
mod tests;
