//! The people of a house: their electricity, when they are there, and the heat of what they use.
//!
//! **Equation** a day has the energy `E_a/365 (1 + a cos(2 pi (d - d_0)/365))`, spread over its quarters of an hour by
//! weights `w = b + (1 - b) s(t) (0.3 + 0.7 p(t)) x`, with a base share `b`, the typical course `s` of weekday or weekend,
//! the presence `p` and an exponentially distributed number `x` of each quarter: the sum of every day is exact. Each
//! person leaves on a workday with a probability around 7:30 and comes back around 16:30, at weekends from 10:30 to
//! 16:00.
//!
//! **Assumptions** quarters are independent; neither holidays nor long absences. **Validity** statistics of a
//! household, not measurements of one. **Numerics** numbers of a seed and the date: means over a step do not depend on
//! how time is cut into steps. **Sources** annual energy `zinsmeister2024`; the course follows the standard profile of
//! households `bdew1999` in its shape, its numbers are assumed.

use crate::calendar::{DAY_S, Moment, normal, season, uniform};
use crate::thermal_unit::{
    Exchange, START_UNIX, ThermalUnit, UnitError, UnitInput, UnitOutput, UnitPort, not_negative,
    share,
};
use anergy_core::medium::Medium;
use anergy_core::port::{PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Length of a quarter, s, and quarters of a day.
const QUARTER_S: f64 = 900.0;
const QUARTERS: usize = 96;
/// Day of the year with the most electricity.
const DARKEST_DAY: f64 = 10.0;
/// The typical course over the day by hours, relative.
const WORKDAY: [f64; 24] = [
    0.35, 0.25, 0.2, 0.2, 0.2, 0.3, 0.8, 1.2, 1.1, 0.9, 0.9, 1.1, 1.4, 1.2, 0.9, 0.9, 1.1, 1.5,
    1.9, 2.0, 1.8, 1.5, 1.1, 0.6,
];
const WEEKEND: [f64; 24] = [
    0.5, 0.35, 0.25, 0.2, 0.2, 0.2, 0.3, 0.6, 1.1, 1.5, 1.6, 1.8, 1.9, 1.5, 1.2, 1.1, 1.1, 1.3,
    1.6, 1.7, 1.6, 1.4, 1.1, 0.7,
];

/// The people of a house as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct HouseholdParams {
    /// Electricity in a year, J.
    pub annual_j: f64,
    /// People who live there.
    pub inhabitants: u32,
    /// Number that chooses the sequence of everything random, with the name of the unit.
    pub seed: u64,
    /// Share of the electricity that is always drawn.
    pub base_share: f64,
    /// How much more is drawn on the darkest day than on average, relative.
    pub season_amplitude: f64,
    /// Probability with which a person is out on a workday.
    pub workday_absence: f64,
    /// The same of a day at the weekend.
    pub weekend_absence: f64,
    /// Share of the electricity that heats the rooms, output `appliances_w`. 0: the building counts it with its people.
    pub gain_share: f64,
    /// Local clock over UTC, s.
    pub utc_offset_s: f64,
}

impl Default for HouseholdParams {
    fn default() -> Self {
        Self {
            annual_j: 7000.0 * 3.6e6,
            inhabitants: 6,
            seed: 1,
            base_share: 0.3,
            season_amplitude: 0.15,
            workday_absence: 0.7,
            weekend_absence: 0.4,
            gain_share: 0.0,
            utc_offset_s: 3600.0,
        }
    }
}

/// The people of a house. State: time since the start, s; day whose sum of weights is known, that sum; electricity, J.
#[derive(Debug, Clone, PartialEq)]
pub struct Household {
    params: HouseholdParams,
}

const ELAPSED_S: usize = 0;
const DAY: usize = 1;
const WEIGHTS: usize = 2;
const ELECTRIC_J: usize = 3;

/// Indices of random numbers: quarters, then people.
const PEOPLE: u64 = 1000;
const MOST_PEOPLE: u32 = 1000;

impl HouseholdParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _medium: &Medium) -> Result<Household, UnitError> {
        not_negative("annual_j", self.annual_j)?;
        for (field, value) in [
            ("base_share", self.base_share),
            ("season_amplitude", self.season_amplitude),
            ("workday_absence", self.workday_absence),
            ("weekend_absence", self.weekend_absence),
            ("gain_share", self.gain_share),
        ] {
            share(field, value)?;
        }
        if self.utc_offset_s.is_nan() || self.utc_offset_s.abs() > DAY_S {
            let (value, requirement) = (self.utc_offset_s, "must lie within a day");
            return Err(UnitError::OutOfRange { field: "utc_offset_s", value, requirement });
        }
        if self.inhabitants > MOST_PEOPLE {
            let (value, requirement) = (f64::from(self.inhabitants), "must be 1000 or less");
            return Err(UnitError::OutOfRange { field: "inhabitants", value, requirement });
        }
        Ok(Household { params: self.clone() })
    }
}

impl Household {
    /// Share of the people who are there in a quarter of a day.
    fn presence(&self, day: i64, quarter: usize) -> f64 {
        let p = &self.params;
        if p.inhabitants == 0 {
            return 0.0;
        }
        let weekend = crate::calendar::weekend(day);
        let (absence, leaves_h, returns_h) =
            if weekend { (p.weekend_absence, 10.5, 16.0) } else { (p.workday_absence, 7.5, 16.5) };
        let time_h = (quarter as f64 + 0.5) * QUARTER_S / 3600.0;
        // Nobody leaves more than five hours from the usual time.
        if (time_h - leaves_h) < -5.0 || (time_h - returns_h) > 5.0 {
            return 1.0;
        }
        let away = |person: &u32| {
            let index = PEOPLE + 5 * u64::from(*person);
            if uniform(p.seed, day, index) >= absence {
                return false;
            }
            let from_h = leaves_h + normal(p.seed, day, index + 1).clamp(-5.0, 5.0);
            let until_h = returns_h + 1.5 * normal(p.seed, day, index + 2).clamp(-3.3, 3.3);
            (from_h..until_h).contains(&time_h)
        };
        1.0 - (0..p.inhabitants).filter(away).count() as f64 / f64::from(p.inhabitants)
    }

    /// Weight of a quarter within its day, and the presence.
    fn weight(&self, day: i64, quarter: usize) -> (f64, f64) {
        let p = &self.params;
        let course = if crate::calendar::weekend(day) { &WEEKEND } else { &WORKDAY };
        let presence = self.presence(day, quarter);
        let chance = -uniform(p.seed, day, quarter as u64).ln();
        let active = course[quarter / 4] * (0.3 + 0.7 * presence) * chance;
        (p.base_share + (1.0 - p.base_share) * active, presence)
    }

    /// Energy of a day, J.
    fn day_j(&self, day: i64) -> f64 {
        let p = &self.params;
        p.annual_j / 365.2425 * (1.0 + p.season_amplitude * season(day, DARKEST_DAY))
    }

    /// Energy, J, and presence times time, s, of a stretch of time; `state` remembers the sum of the day.
    fn stretch(&self, start_unix_s: f64, dt_s: f64, state: &mut [f64]) -> (f64, f64) {
        let (mut energy_j, mut present_s, mut done_s) = (0.0, 0.0, 0.0);
        // Each turn ends a quarter or the step.
        for _ in 0..2 + (dt_s / QUARTER_S) as usize {
            let elapsed_s = state[ELAPSED_S] + done_s;
            let Moment { day, time_s } =
                Moment::after(start_unix_s, self.params.utc_offset_s, elapsed_s);
            if state[DAY] != day as f64 {
                let weights = (0..QUARTERS).map(|quarter| self.weight(day, quarter).0);
                state[WEIGHTS] = weights.sum();
                state[DAY] = day as f64;
            }
            let quarter = ((time_s / QUARTER_S) as usize).min(QUARTERS - 1);
            let (weight, presence) = self.weight(day, quarter);
            let left_s = ((quarter + 1) as f64 * QUARTER_S - time_s).max(1e-6);
            let piece_s = left_s.min(dt_s - done_s);
            energy_j += self.day_j(day) * weight / state[WEIGHTS] * piece_s / QUARTER_S;
            present_s += presence * piece_s;
            done_s += piece_s;
            if done_s >= dt_s {
                break;
            }
        }
        (energy_j, present_s)
    }
}

impl ThermalUnit for Household {
    fn ports(&self) -> Vec<UnitPort> {
        Vec::new()
    }

    fn inputs(&self) -> Vec<UnitInput> {
        vec![UnitInput {
            name: "start_unix_s",
            unit: "s",
            initial: 0.0,
            min: f64::NEG_INFINITY,
            max: f64::INFINITY,
            follows: Some(START_UNIX),
        }]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![
            UnitOutput::new("electric_w", "W"),
            UnitOutput::new("presence", "1"),
            UnitOutput::new("appliances_w", "W"),
            UnitOutput::new("used_j", "J"),
        ]
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        vec![0.0, f64::MIN, 1.0, 0.0]
    }

    fn request(
        &self,
        _signals: &Signals<'_>,
        _got: &[PortFlow],
        _state: &mut [f64],
        _wanted: &mut [PortRequest],
    ) {
    }

    fn advance(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        _ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        // A step without length shows the next second.
        let span_s = if dt_s > 0.0 { dt_s } else { 1.0 };
        let (energy_j, present_s) = self.stretch(signals.get(0), span_s, state);
        let electric_w = energy_j / span_s;
        state[ELAPSED_S] += dt_s;
        state[ELECTRIC_J] += dt_s * electric_w;
        let gain_w = self.params.gain_share * electric_w;
        out.copy_from_slice(&[electric_w, present_s / span_s, gain_w, state[ELECTRIC_J]]);
        Exchange { electric_w, external_w: -electric_w }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2023-01-01, a Sunday, 00:00 local time.
    const START_S: f64 = 19_358.0 * DAY_S - 3600.0;

    fn run(unit: &Household, dt_s: f64, span_s: f64) -> Vec<[f64; 4]> {
        let mut state = unit.initial_state(0.0);
        let step = |_| {
            let mut out = [0.0; 4];
            unit.advance(dt_s, &Signals(&[START_S]), &[], &mut state, &mut out);
            out
        };
        (0..(span_s / dt_s).round() as usize).map(step).collect()
    }

    #[test]
    fn a_year_has_its_energy_and_no_step_changes_it() {
        let unit = HouseholdParams::default().build(&Medium::default()).unwrap();
        let year = run(&unit, 3600.0, 365.0 * DAY_S);
        let kwh = year.last().unwrap()[3] / 3.6e6;
        assert!((kwh - 7000.0).abs() < 7.0, "{kwh}");
        // More in winter: 1.15 to 0.85 of 19.17 kWh.
        let day = |d: usize| year[24 * d..24 * (d + 1)].iter().map(|out| out[0]).sum::<f64>() / 1e3;
        assert!((day(10) - 22.04).abs() < 0.1 && (day(192) - 16.29).abs() < 0.1, "{}", day(10));
        for dt_s in [10.0, 60.0, 900.0] {
            let days = run(&unit, dt_s, 2.0 * DAY_S);
            let (last, hourly) = (days.last().unwrap()[3], year[47][3]);
            assert!((last - hourly).abs() < 1e-9 * hourly, "{dt_s} s: {last} {hourly}");
        }
        let other = HouseholdParams { seed: 2, ..HouseholdParams::default() };
        let other = run(&other.build(&Medium::default()).unwrap(), 900.0, DAY_S);
        assert_ne!(other[40][0], run(&unit, 900.0, DAY_S)[40][0]);
    }

    #[test]
    fn people_are_there_at_night_and_use_more_while_they_are() {
        let unit = HouseholdParams::default().build(&Medium::default()).unwrap();
        let days = run(&unit, 900.0, 364.0 * DAY_S);
        let at = |quarter: usize| days.iter().skip(quarter).step_by(96);
        assert!(at(8).all(|out| out[1] == 1.0), "at two o'clock everybody sleeps there");
        let noon = at(48).map(|out| out[1]).sum::<f64>() / 364.0;
        // 1 - (5/7 0.7 + 2/7 0.4) = 0.386 with everybody out at noon; some leave later or come back.
        assert!((noon - 0.40).abs() < 0.03, "{noon}");
        // Correlated: the same hour with many and with few people.
        let mean = |many: bool| {
            let of = at(48).filter(|out| (out[1] > 0.45) == many).map(|out| out[0]);
            let (n, sum) = of.fold((0.0, 0.0), |(n, sum), w| (n + 1.0, sum + w));
            sum / n
        };
        assert!(mean(true) > 1.2 * mean(false), "{} {}", mean(true), mean(false));
    }
}
