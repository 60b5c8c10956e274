//! The local calendar of profiles, and reproducible numbers for them.
//!
//! **Equation** local time is the start of the run (UTC) plus the offset of the clock plus the time since; a day is its
//! number since 1970-01-01, a Thursday; the year has 365.2425 days. Numbers are hashes (SplitMix64) of a seed, a day and
//! an index: they depend on nothing that happened before, so profiles do not depend on steps or snapshots.
//!
//! **Assumptions** no daylight saving time. **Sources** `steele2014` (SplitMix64).

use std::f64::consts::TAU;

/// Length of a day, s.
pub const DAY_S: f64 = 86_400.0;
const YEAR_DAYS: f64 = 365.2425;

/// A moment of the local calendar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Days since 1970-01-01.
    pub day: i64,
    /// Time of day, s.
    pub time_s: f64,
}

impl Moment {
    /// The moment some time after the start of a run: start since 1970 in UTC, offset of the local clock, s.
    pub fn after(start_unix_s: f64, utc_offset_s: f64, elapsed_s: f64) -> Self {
        // The start is whole seconds, mostly: its day is split off first, so that long runs stay exact.
        let start_s = start_unix_s + utc_offset_s;
        let day = (start_s / DAY_S).floor();
        let time_s = start_s - day * DAY_S + elapsed_s;
        let more = (time_s / DAY_S).floor();
        Self { day: (day + more) as i64, time_s: time_s - more * DAY_S }
    }

    /// Whether the day is a Saturday or Sunday.
    pub fn weekend(&self) -> bool {
        weekend(self.day)
    }
}

/// Whether a day is a Saturday or Sunday.
pub fn weekend(day: i64) -> bool {
    // Day 0 is a Thursday, the fourth of the week.
    (day + 3).rem_euclid(7) >= 5
}

/// The calendar of people: Saturdays, Sundays and holidays are days off.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DaysOff {
    /// Local clock ahead of UTC, s.
    pub utc_offset_s: f64,
    /// Days since 1970-01-01.
    pub holidays: Vec<i64>,
}

impl DaysOff {
    /// Whether nobody works on a day.
    pub fn is_off(&self, day: i64) -> bool {
        weekend(day) || self.holidays.contains(&day)
    }
}

/// Days from 1970-01-01 to a date written `2024-12-25`; `None` where it is no date of the Gregorian calendar.
pub fn day_of_date(text: &str) -> Option<i64> {
    let mut parts = text.split('-');
    let mut next = |digits: usize| {
        let part = parts.next().filter(|part| part.len() == digits)?;
        part.parse::<u32>().ok().map(i64::from)
    };
    let (year, month, day) = (next(4)?, next(2)?, next(2)?);
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let longest = match month {
        2 => 28 + i64::from(leap),
        4 | 6 | 9 | 11 => 30,
        1..=12 => 31,
        _ => return None,
    };
    if parts.next().is_some() || !(1..=longest).contains(&day) {
        return None;
    }
    // Years from March on: 153 days in five months; day 719 468 is 1970-01-01.
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let of_year = (153 * month + 2) / 5 + day - 1;
    Some(
        365 * year + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400) + of_year
            - 719_468,
    )
}

/// `cos(2 pi (d - d_0)/year)` of a day, with the day of the year of the maximum.
pub fn season(day: i64, maximum_day: f64) -> f64 {
    season_rad(day, maximum_day).cos()
}

/// Where a day stands in the year, from the day of the year `maximum_day` on, rad.
pub fn season_rad(day: i64, maximum_day: f64) -> f64 {
    TAU * ((day as f64) - maximum_day) / YEAR_DAYS
}

/// A number above 0 and below 1 for a seed, a day and an index.
pub fn uniform(seed: u64, day: i64, index: u64) -> f64 {
    let mut z = seed
        ^ (day as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ index.wrapping_add(1).wrapping_mul(0xd1b5_4a32_d192_ed03);
    for _ in 0..2 {
        z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
    }
    ((z >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
}

/// A number of the standard normal distribution (Box and Muller) from two uniform ones.
pub fn normal(seed: u64, day: i64, index: u64) -> f64 {
    let radius = (-2.0 * uniform(seed, day, 2 * index).ln()).sqrt();
    radius * (TAU * uniform(seed, day, 2 * index + 1)).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_by_hand() {
        // 2024-02-03 (a Saturday) 23:30 UTC is 1 706 996 000 - 200 s: 19 756 days and 84 600 s.
        let start_s = 19_756.0 * DAY_S + 84_600.0;
        let moment = Moment::after(start_s, 3600.0, 0.0);
        assert_eq!((moment.day, moment.time_s), (19_757, 1800.0));
        assert!(moment.weekend() && weekend(19_756) && !weekend(19_755) && !weekend(19_758));
        let moment = Moment::after(start_s, 3600.0, 3.0 * DAY_S);
        assert_eq!((moment.day, moment.time_s), (19_760, 1800.0));
        assert!((season(45, 45.0) - 1.0).abs() < 1e-12 && season(228, 45.0) < -0.99);
    }

    #[test]
    fn dates_by_hand() {
        for (text, day) in [
            ("1970-01-01", Some(0)),
            ("1970-03-01", Some(59)),
            ("2000-02-29", Some(11_016)),
            ("2024-02-03", Some(19_756)),
            ("2024-02-30", None),
            ("1900-02-29", None),
            ("2024-13-01", None),
            ("2024-2-3", None),
            ("24.12.2024", None),
            ("2024-12-25-1", None),
        ] {
            assert_eq!(day_of_date(text), day, "{text}");
        }
        let days = DaysOff { holidays: vec![19_754], ..DaysOff::default() };
        // A Thursday that is one, the Friday after it, Saturday, Monday.
        assert!(
            days.is_off(19_754)
                && !days.is_off(19_755)
                && days.is_off(19_756)
                && !days.is_off(19_758)
        );
    }

    #[test]
    fn numbers_are_spread_evenly() {
        let numbers: Vec<f64> = (0..40_000).map(|i| uniform(7, i / 100, i as u64 % 100)).collect();
        let mean = numbers.iter().sum::<f64>() / 40_000.0;
        // Standard deviation of the mean: 0.2887/200 = 0.0014
        assert!((mean - 0.5).abs() < 0.005, "{mean}");
        for tenth in 0..10 {
            let low = 0.1 * f64::from(tenth);
            let count = numbers.iter().filter(|x| (low..low + 0.1).contains(*x)).count();
            assert!((3700..4300).contains(&count), "{tenth}: {count}");
        }
        let (mut sum, mut squares) = (0.0, 0.0);
        for i in 0..20_000 {
            let x = normal(3, i / 50, i as u64 % 50);
            sum += x;
            squares += x * x;
        }
        assert!((sum / 20_000.0).abs() < 0.02 && (squares / 20_000.0 - 1.0).abs() < 0.03);
        assert_eq!(uniform(7, 3, 5), uniform(7, 3, 5));
        assert_ne!(uniform(7, 3, 5), uniform(8, 3, 5));
    }
}
