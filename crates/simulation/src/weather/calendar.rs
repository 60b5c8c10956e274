//! Which record belongs to which interval of time.

use anergy_core::clock::NS_PER_S;
use jiff::Timestamp;
use jiff::tz::TimeZone;

/// Length of a day, ns.
pub(crate) const DAY_NS: i64 = 86_400 * NS_PER_S;

/// No record.
const NONE: u32 = u32::MAX;

/// How the dates of records are meant.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Calendar {
    /// From this time on, ns since 1970, one after another.
    Given {
        /// Begin of the first interval.
        begin_ns: i64,
    },
    /// By the date in the year, whichever year it is.
    EveryYear {
        /// What local standard time is ahead of UTC, ns.
        ahead_ns: i64,
        /// The record of each interval of a leap year.
        of_slot: Box<[u32]>,
    },
}

/// Days before each month of a leap year.
const BEFORE_MONTH: [u32; 12] = [0, 31, 60, 91, 121, 152, 182, 213, 244, 274, 305, 335];
const LENGTH_OF_MONTH: [u32; 12] = [31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
/// Day of a leap year, from 0, of 29 February.
pub(crate) const LEAP_DAY: usize = 59;
/// Days of a leap year.
pub(crate) const DAYS: usize = 366;

/// The day of a leap year, from 0, of a month and a day from 1; `None` where there is no such date.
pub(crate) fn day_of_leap_year(month: u32, day: u32) -> Option<usize> {
    let month = (month as usize).checked_sub(1).filter(|month| *month < 12)?;
    (1..=LENGTH_OF_MONTH[month]).contains(&day).then(|| (BEFORE_MONTH[month] + day - 1) as usize)
}

/// Month and day of a day of a leap year, as people write them.
pub(crate) fn date_of(day: usize) -> String {
    let month = BEFORE_MONTH.iter().rposition(|before| *before as usize <= day).unwrap_or(0);
    format!("{:02}-{:02}", month + 1, day - BEFORE_MONTH[month] as usize + 1)
}

impl Calendar {
    /// By the date in the year: the slots of the records, in intervals of a leap year. 29 February takes the
    /// records of the day before where it has none.
    pub(crate) fn every_year(ahead_ns: i64, slots: &[usize], per_day: usize) -> Self {
        let mut of_slot = vec![NONE; DAYS * per_day];
        for (record, slot) in slots.iter().enumerate() {
            of_slot[*slot] = record as u32;
        }
        for slot in LEAP_DAY * per_day..(LEAP_DAY + 1) * per_day {
            if of_slot[slot] == NONE {
                of_slot[slot] = of_slot[slot - per_day];
            }
        }
        Self::EveryYear { ahead_ns, of_slot: of_slot.into() }
    }

    /// The interval in which a time lies.
    pub(crate) fn number(&self, at_ns: i64, interval_ns: i64) -> i64 {
        (at_ns - self.origin_ns()).div_euclid(interval_ns)
    }

    /// The begin of an interval, ns since 1970.
    pub(crate) fn begin_ns(&self, number: i64, interval_ns: i64) -> i64 {
        number * interval_ns + self.origin_ns()
    }

    fn origin_ns(&self) -> i64 {
        match self {
            Self::Given { begin_ns } => *begin_ns,
            Self::EveryYear { ahead_ns, .. } => -ahead_ns,
        }
    }

    /// The record of an interval.
    pub(crate) fn record(&self, number: i64, interval_ns: i64, count: usize) -> Option<usize> {
        match self {
            Self::Given { .. } => usize::try_from(number).ok().filter(|record| *record < count),
            Self::EveryYear { of_slot, .. } => {
                let per_day = DAY_NS / interval_ns;
                let (day, within) = (number.div_euclid(per_day), number.rem_euclid(per_day));
                let date = Timestamp::from_second(day * 86_400).ok()?.to_zoned(TimeZone::UTC);
                let month = u32::try_from(date.month()).ok()?;
                let day = day_of_leap_year(month, u32::try_from(date.day()).ok()?)?;
                let record = of_slot[day * per_day as usize + within as usize];
                (record != NONE).then_some(record as usize)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates() {
        assert_eq!(day_of_leap_year(2, 29), Some(LEAP_DAY));
        assert_eq!(day_of_leap_year(12, 31), Some(DAYS - 1));
        for (month, day) in [(0, 1), (13, 1), (4, 31), (1, 0)] {
            assert_eq!(day_of_leap_year(month, day), None);
        }
        assert_eq!(
            (date_of(0), date_of(LEAP_DAY), date_of(365)),
            ("01-01".into(), "02-29".into(), "12-31".into())
        );
    }

    #[test]
    fn years_with_and_without_leap_day() {
        // 365 records, one a day, that jump over 29 February.
        let slots: Vec<usize> = (0..DAYS).filter(|day| *day != LEAP_DAY).collect();
        let year = Calendar::every_year(0, &slots, 1);
        let record = |text: &str| {
            let at: Timestamp = format!("{text}T12:00Z").parse().unwrap();
            let number = year.number(i64::try_from(at.as_nanosecond()).unwrap(), DAY_NS);
            year.record(number, DAY_NS, 365)
        };
        assert_eq!(record("2023-01-01"), Some(0));
        assert_eq!(record("2024-02-28"), Some(58));
        assert_eq!(record("2024-02-29"), Some(58));
        assert_eq!(record("2024-03-01"), Some(59));
        assert_eq!(record("2023-03-01"), Some(59));
        assert_eq!(record("2023-12-31"), Some(364));
        assert_eq!(record("1999-12-31"), Some(364));
        // With a leap day of its own, which other years jump over.
        let slots: Vec<usize> = (0..DAYS).collect();
        let year = Calendar::every_year(0, &slots, 1);
        let record = |text: &str| {
            let at: Timestamp = format!("{text}T12:00Z").parse().unwrap();
            let number = year.number(i64::try_from(at.as_nanosecond()).unwrap(), DAY_NS);
            year.record(number, DAY_NS, 366)
        };
        assert_eq!(record("2024-02-29"), Some(59));
        assert_eq!(record("2023-02-28"), Some(58));
        assert_eq!(record("2023-03-01"), Some(60));
    }
}
