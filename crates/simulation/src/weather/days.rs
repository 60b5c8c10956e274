//! The days of a weather, and their type.
//!
//! **Equation** after VDI 4655: winter below 5 degC in the mean of the day, summer above 15 degC, transition between;
//! workdays are Monday to Saturday; a day is sunny below 5/8 of cloud cover. Clouds follow from the irradiance
//! (Kasten and Czeplak): `G/G_clear = 1 - 0.75 (N/8)^3.4` is 0.848 at N = 5, with `G_clear` of Haurwitz.
//!
//! **Assumptions** holidays are not known. VDI 4655 itself does not tell sunny from cloudy days of summer: 10
//! types of these 12. **Sources** `vdi4655`, `kasten1980`, `haurwitz1945`.

use super::calendar::{Calendar, DAY_NS};
use super::records::Records;
use crate::model::WeatherSpec;
use anergy_core::clock::NS_PER_S;
use anergy_core::medium::ZERO_CELSIUS_K;
use anergy_core::solar::clear_sky_w_m2;
use jiff::Timestamp;
use jiff::civil::Weekday;
use jiff::tz::TimeZone;

/// Season of a day, by its mean temperature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Season {
    /// Below 5 degC.
    Winter,
    /// From 5 to 15 degC.
    Transition,
    /// Above 15 degC.
    Summer,
}

/// One of the twelve types of days.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TypeDay {
    /// The season.
    pub season: Season,
    /// Monday to Saturday.
    pub workday: bool,
    /// Below 5/8 of cloud cover.
    pub sunny: bool,
}

impl TypeDay {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        let seasons = [Season::Winter, Season::Transition, Season::Summer];
        seasons.into_iter().flat_map(|season| {
            [(true, true), (true, false), (false, true), (false, false)]
                .map(|(workday, sunny)| Self { season, workday, sunny })
        })
    }

    /// In words.
    pub fn words(&self) -> String {
        let season = match self.season {
            Season::Winter => "winter",
            Season::Transition => "transition",
            Season::Summer => "summer",
        };
        let day = if self.workday { "workday" } else { "Sunday" };
        let sky = if self.sunny { "sunny" } else { "cloudy" };
        format!("{season}, {day}, {sky}")
    }
}

/// A day in local standard time.
#[derive(Debug, Clone, PartialEq)]
pub struct Day {
    /// `2024-01-17`.
    pub date: String,
    /// Mean temperature, K.
    pub mean_k: f64,
    /// Lowest point of the temperature, K.
    pub lowest_k: f64,
    /// Highest point of the temperature, K.
    pub highest_k: f64,
    /// Global irradiation on the horizontal, J/m2, where there is one.
    pub global_j_m2: Option<f64>,
    /// Its type, where there is an irradiance.
    pub type_day: Option<TypeDay>,
}

/// Share of the clear sky at 5/8 of cloud cover: 1 - 0.75 (5/8)^3.4.
const SUNNY_FROM: f64 = 0.8483;

impl WeatherSpec {
    /// The days from that of a time on, ns since 1970: a year, or as many as the weather has.
    pub fn days(&self, from_unix_ns: i64) -> Vec<Day> {
        let Some(records) = &self.records else { return Vec::new() };
        let ahead_ns = match records.calendar {
            Calendar::EveryYear { ahead_ns, .. } => ahead_ns,
            Calendar::Given { .. } => self.ahead_ns(records),
        };
        let first = (from_unix_ns + ahead_ns).div_euclid(DAY_NS);
        (first..first + 365).map_while(|day| records.day(day, ahead_ns)).collect()
    }

    /// What local time is ahead of UTC, ns: as given, or by the longitude.
    fn ahead_ns(&self, records: &Records) -> i64 {
        let by_longitude =
            || records.location.map(|l| (l.longitude_rad.to_degrees() / 15.0).round() * 3600.0);
        let offset_s = self.entry.utc_offset_s.or_else(by_longitude).unwrap_or(0.0);
        (offset_s * NS_PER_S as f64).round() as i64
    }
}

impl Records {
    /// A day since 1970 in local time; `None` where it is not whole.
    fn day(&self, day: i64, ahead_ns: i64) -> Option<Day> {
        let begin_ns = day * DAY_NS - ahead_ns;
        let first = self.number(begin_ns + self.interval_ns() / 2);
        let per_day = DAY_NS / self.interval_ns();
        let interval_s = self.interval_ns() as f64 / NS_PER_S as f64;
        let (mut sum, mut lowest_k, mut highest_k) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
        let (mut global_j_m2, mut clear_j_m2) = (0.0, 0.0);
        for number in first..first + per_day {
            let record = self.record(number)?;
            for point in self.points_around(number, record) {
                let t_k = self.t_outdoor_k[point];
                sum += 0.5 * t_k / per_day as f64;
                (lowest_k, highest_k) = (t_k.min(lowest_k), t_k.max(highest_k));
            }
            if let (Some(irradiance), Some(location)) = (&self.irradiance, self.location) {
                global_j_m2 += irradiance.at(record)[0] * interval_s;
                let middle_s = self.begin_ns(number) as f64 / NS_PER_S as f64 + 0.5 * interval_s;
                let sine = location.path(middle_s).sine_s(-0.5 * interval_s, 0.5 * interval_s);
                clear_j_m2 += clear_sky_w_m2(sine / interval_s) * interval_s;
            }
        }
        let date = Timestamp::from_second(day * 86_400).ok()?.to_zoned(TimeZone::UTC).date();
        let shines = self.irradiance.is_some();
        let mean_degc = sum - ZERO_CELSIUS_K;
        let type_day = TypeDay {
            season: match mean_degc {
                t if t < 5.0 => Season::Winter,
                t if t > 15.0 => Season::Summer,
                _ => Season::Transition,
            },
            workday: date.weekday() != Weekday::Sunday,
            sunny: global_j_m2 >= SUNNY_FROM * clear_j_m2,
        };
        Some(Day {
            date: date.to_string(),
            mean_k: sum,
            lowest_k,
            highest_k,
            global_j_m2: shines.then_some(global_j_m2),
            type_day: shines.then_some(type_day),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use std::path::Path;

    fn weather(lines: &str) -> WeatherSpec {
        let text = format!(
            "format = 1\n[run]\nstart = \"2024-01-01T00:00:00+01:00\"\n[weather]\n{lines}\n[[node]]\nid = \"a\"\n"
        );
        Model::from_toml(&text, Path::new(".")).unwrap().weather.unwrap()
    }

    /// 2024-01-01 00:00 in UTC+1.
    const NEW_YEAR_NS: i64 = 1_704_063_600 * NS_PER_S;

    #[test]
    fn a_year_of_days() {
        // Without noise: day d has the mean 9.5 - 10 cos(2 pi (d - 20)/366), and swings by 4 to 7 K.
        let days = weather("kind = \"synthetic\"\nnoise_difference_k = 0").days(NEW_YEAR_NS);
        assert_eq!(
            (days.len(), days[0].date.as_str(), days[364].date.as_str()),
            (365, "2024-01-01", "2024-12-30")
        );
        for (i, day) in days.iter().enumerate() {
            let season = (std::f64::consts::TAU * (i as f64 + 0.5 - 20.0) / 366.0).cos();
            assert!((day.mean_k - (282.65 - 10.0 * season)).abs() < 0.05, "{day:?}");
            let swing = 5.5 - 1.5 * season;
            assert!((day.highest_k - day.lowest_k - 2.0 * swing).abs() < 0.2, "{day:?} {swing}");
            let kind = day.type_day.unwrap();
            let season = match day.mean_k - 273.15 {
                t if t < 5.0 => Season::Winter,
                t if t <= 15.0 => Season::Transition,
                _ => Season::Summer,
            };
            assert_eq!(kind.season, season);
            // 1 January 2024 was a Monday.
            assert_eq!(kind.workday, i % 7 != 6, "{day:?}");
        }
        // Clearness Beta(1.5, 1): P(c > 0.848) = 1 - 0.848^1.5 = 0.219, of 365 days 80, give or take 8.
        let sunny = days.iter().filter(|day| day.type_day.unwrap().sunny).count();
        assert!((56..104).contains(&sunny), "{sunny}");
        assert_eq!(TypeDay::all().count(), 12);
        let global_kwh: f64 = days.iter().map(|day| day.global_j_m2.unwrap() / 3.6e6).sum();
        assert!((1000.0..1250.0).contains(&global_kwh), "{global_kwh}");
    }

    #[test]
    fn clear_days_are_sunny() {
        let clear = "kind = \"synthetic\"\nclearness_alpha = 1000\nclearness_beta = 1";
        let dull = "kind = \"synthetic\"\nclearness_alpha = 1\nclearness_beta = 1000";
        let sunny = |lines| {
            weather(lines)
                .days(NEW_YEAR_NS)
                .iter()
                .filter(|day| day.type_day.unwrap().sunny)
                .count()
        };
        assert_eq!((sunny(clear), sunny(dull)), (365, 0));
        assert!(weather("kind = \"constant\"").days(NEW_YEAR_NS).is_empty());
    }
}
