//! The records of a weather, whatever file or generator they come from.

use super::{Calendar, SIGNALS, irradiance::Irradiance};
use anergy_core::solar::Location;

/// Side of an interval on which its record has the temperature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PointAt {
    /// The begin: the irradiance is the mean of the time after.
    Begin,
    /// The end: the irradiance is the mean of the time before.
    End,
}

/// The records of a weather, SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Records {
    /// Length of an interval, ns; a day is a multiple of it.
    pub(crate) interval_ns: i64,
    /// Which record belongs to which interval.
    pub(crate) calendar: Calendar,
    /// Where the points of temperature, humidity and wind lie.
    pub(crate) point_at: PointAt,
    /// Where the sun is seen from.
    pub(crate) location: Option<Location>,
    /// Outdoor temperature, K.
    pub(crate) t_outdoor_k: Box<[f64]>,
    /// Relative humidity, 0 to 1.
    pub(crate) relative_humidity: Option<Box<[f64]>>,
    /// Wind, m/s.
    pub(crate) wind_m_s: Option<Box<[f64]>>,
    /// Irradiances, W/m2.
    pub(crate) irradiance: Option<Irradiance>,
}

impl Records {
    /// Number of records.
    pub fn count(&self) -> usize {
        self.t_outdoor_k.len()
    }

    /// Length of an interval, ns.
    pub(crate) fn interval_ns(&self) -> i64 {
        self.interval_ns
    }

    /// The interval in which a time lies.
    pub(crate) fn number(&self, at_ns: i64) -> i64 {
        self.calendar.number(at_ns, self.interval_ns)
    }

    /// The begin of an interval, ns since 1970.
    pub(crate) fn begin_ns(&self, number: i64) -> i64 {
        self.calendar.begin_ns(number, self.interval_ns)
    }

    /// The record of an interval.
    pub(crate) fn record(&self, number: i64) -> Option<usize> {
        self.calendar.record(number, self.interval_ns, self.count())
    }

    /// The records with the points at begin and end of an interval; beyond the records the nearest holds.
    pub(crate) fn points_around(&self, number: i64, record: usize) -> [usize; 2] {
        match self.point_at {
            PointAt::Begin => [record, self.record(number + 1).unwrap_or(record)],
            PointAt::End => [self.record(number - 1).unwrap_or(record), record],
        }
    }

    /// Begin of the first and end of the last interval, ns since 1970, where they have a year.
    pub(crate) fn span_ns(&self) -> Option<(i64, i64)> {
        let given = matches!(self.calendar, Calendar::Given { .. });
        given.then(|| (self.begin_ns(0), self.begin_ns(self.count() as i64)))
    }

    /// Which of the signals it has.
    pub(crate) fn has(&self) -> [bool; SIGNALS.len()] {
        let (shines, sun) = (self.irradiance.is_some(), self.location.is_some());
        let (humid, windy) = (self.relative_humidity.is_some(), self.wind_m_s.is_some());
        [true, humid, windy, shines, shines, shines, sun, sun]
    }

    /// The first time of a span, ns since 1970, that has no record.
    pub(crate) fn first_gap_ns(&self, from_ns: i64, to_ns: i64) -> Option<i64> {
        // After a leap cycle every date has been seen.
        let cycle = 5 * 366 * super::calendar::DAY_NS / self.interval_ns;
        let (first, last) = (self.number(from_ns), self.number((to_ns - 1).max(from_ns)));
        let gap = (first..=last.min(first + cycle)).find(|number| self.record(*number).is_none());
        let gap = gap.or_else(|| {
            let given = matches!(self.calendar, Calendar::Given { .. });
            (given && self.record(last).is_none()).then_some(self.count() as i64)
        });
        gap.map(|number| self.begin_ns(number).max(from_ns))
    }
}
