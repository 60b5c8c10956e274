//! Times as loggers write them.

use jiff::civil::DateTime;
use jiff::tz::Offset;
use jiff::{SignedDuration, Timestamp};

/// Calendar forms without time zone, the day before the month.
const LOCAL: [&str; 9] = [
    "%Y-%m-%d %H:%M:%S%.f",
    "%Y-%m-%d %H:%M",
    "%Y-%m-%dT%H:%M",
    "%Y/%m/%d %H:%M:%S%.f",
    "%Y/%m/%d %H:%M",
    "%d.%m.%Y %H:%M:%S%.f",
    "%d.%m.%Y %H:%M",
    "%d/%m/%Y %H:%M:%S%.f",
    "%d/%m/%Y %H:%M",
];
/// From these numbers on, times count since 1970 (1973 in each), in units of so many ns.
const UNIX: [(f64, f64); 4] = [(1e17, 1.0), (1e14, 1e3), (1e11, 1e6), (1e8, 1e9)];

/// How a column of times is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Form {
    /// Numbers in a unit of so many seconds, from anywhere.
    Relative(f64),
    /// Numbers since 1970 in a unit of so many ns.
    Unix(f64),
    /// RFC 3339: with time zone.
    Zoned,
    /// Calendar without time zone, this much ahead of UTC, s.
    Local(&'static str, i64),
    /// ISO 8601 without time zone.
    LocalIso(i64),
}

/// A time: seconds from anywhere, or ns since 1970.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Time {
    Relative(f64),
    Unix(i128),
}

impl Form {
    /// The form of a first time; `unit_s` where the head says a unit.
    pub fn of(text: &str, unit_s: Option<f64>, utc_offset_s: f64) -> Option<Self> {
        let offset_s = utc_offset_s.round() as i64;
        if let Some(value) = number(text) {
            let unit_s = unit_s.unwrap_or(1.0);
            // Nobody counts minutes, hours or days since 1970, but years of operation in hours.
            let since_1970 = UNIX.iter().find(|(from, _)| unit_s <= 1.0 && value * unit_s >= *from);
            return Some(match since_1970 {
                Some((_, unit_ns)) => Self::Unix(unit_ns * unit_s),
                None => Self::Relative(unit_s),
            });
        }
        let forms = std::iter::once(Self::Zoned)
            .chain(LOCAL.map(|form| Self::Local(form, offset_s)))
            .chain([Self::LocalIso(offset_s)]);
        forms.into_iter().find(|form| form.read(text).is_some())
    }

    /// A time in this form.
    pub fn read(self, text: &str) -> Option<Time> {
        match self {
            Self::Relative(unit_s) => Some(Time::Relative(number(text)? * unit_s)),
            Self::Unix(unit_ns) => Some(Time::Unix((number(text)? * unit_ns).round() as i128)),
            Self::Zoned => Some(Time::Unix(text.parse::<Timestamp>().ok()?.as_nanosecond())),
            Self::Local(form, offset_s) => local(DateTime::strptime(form, text).ok()?, offset_s),
            Self::LocalIso(offset_s) => local(text.parse().ok()?, offset_s),
        }
    }

    /// Whether a time zone had to be assumed.
    pub fn is_local(self) -> bool {
        matches!(self, Self::Local(..) | Self::LocalIso(_))
    }

    /// Whether the day could as well be the month.
    pub fn is_ambiguous(self) -> bool {
        matches!(self, Self::Local(form, _) if form.starts_with("%d/"))
    }
}

fn local(time: DateTime, offset_s: i64) -> Option<Time> {
    let utc = time.checked_sub(SignedDuration::from_secs(offset_s)).ok()?;
    Some(Time::Unix(Offset::UTC.to_timestamp(utc).ok()?.as_nanosecond()))
}

/// A finite number, with a decimal point or comma.
pub(super) fn number(text: &str) -> Option<f64> {
    let text = text.trim();
    let parsed = text.parse::<f64>().or_else(|error| {
        if text.contains('.') || text.matches(',').count() != 1 {
            return Err(error);
        }
        text.replace(',', ".").parse()
    });
    parsed.ok().filter(|value| value.is_finite())
}
