//! The people of a house: their electricity, when they are there, and the heat of what they use.
//!
//! **Equation** a day has the energy `E_a/365 (1 + a cos(2 pi (d - d_0)/365))`, spread over its quarters of an hour by
//! weights `w = b + (1 - b) s(t) (0.3 + 0.7 p(t)) x`, with a base share `b`, the typical course `s` of weekday or weekend,
//! the presence `p` and an exponentially distributed number `x` of each quarter: the sum of every day is exact. Each
//! person leaves on a workday with a probability around 7:30 and comes back around 16:30, at weekends from 10:30 to
//! 16:00.
//!
//! With `phases = "random"` the base is a third on each phase of the grid, and what is drawn besides in a quarter is spread by
//! three exponentially distributed numbers: the phases add up to the whole.
//!
//! **Assumptions** quarters are independent; neither holidays nor long absences. **Validity** statistics of a
//! household, not measurements of one. **Numerics** numbers of a seed and the date: means over a step do not depend on
//! how time is cut into steps. **Sources** annual energy `zinsmeister2024`; the course follows the standard profile of
//! households `bdew1999` in its shape, its numbers are assumed.

use crate::calendar::{DAY_S, Moment, normal, season, uniform};
use crate::phases::{self, PHASES};
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

/// How the electricity of a household is spread over the three phases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HouseholdPhases {
    /// A third on each.
    #[default]
    Even,
    /// What is always drawn evenly, the rest of each quarter of an hour by chance: devices of one phase.
    Random,
}

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
    /// How the electricity is spread over the three phases of the grid.
    pub phases: HouseholdPhases,
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
            phases: HouseholdPhases::Even,
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

/// Indices of random numbers: quarters, then people, then phases.
const PEOPLE: u64 = 1000;
const ON_PHASES: u64 = 10_000;
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

    /// Share of each phase in the energy of a quarter of this weight.
    fn phase_shares(&self, day: i64, quarter: usize, weight: f64) -> [f64; PHASES] {
        let p = &self.params;
        let chance = |phase: usize| {
            let index = ON_PHASES + (PHASES * quarter + phase) as u64;
            -uniform(p.seed, day, index).ln()
        };
        let chances = [chance(0), chance(1), chance(2)];
        let sum: f64 = chances.iter().sum();
        let base = p.base_share / weight;
        chances.map(|chance| base / PHASES as f64 + (1.0 - base) * chance / sum)
    }

    /// Energy, J, and presence times time, s, of a stretch of time, and the energy of each phase where they are told;
    /// `state` remembers the sum of the day.
    fn stretch(
        &self,
        start_unix_s: f64,
        dt_s: f64,
        state: &mut [f64],
    ) -> (f64, f64, [f64; PHASES]) {
        let (mut energy_j, mut present_s, mut done_s) = (0.0, 0.0, 0.0);
        let mut phases_j = [0.0; PHASES];
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
            let piece_j = self.day_j(day) * weight / state[WEIGHTS] * piece_s / QUARTER_S;
            energy_j += piece_j;
            if self.params.phases == HouseholdPhases::Random {
                let shares = self.phase_shares(day, quarter, weight);
                phases_j.iter_mut().zip(shares).for_each(|(sum, share)| *sum += share * piece_j);
            }
            present_s += presence * piece_s;
            done_s += piece_s;
            if done_s >= dt_s {
                break;
            }
        }
        (energy_j, present_s, phases_j)
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
        let own = [
            UnitOutput::new("electric_w", "W"),
            UnitOutput::new("presence", "1"),
            UnitOutput::new("appliances_w", "W"),
            UnitOutput::new("used_j", "J"),
        ];
        let told = self.params.phases == HouseholdPhases::Random;
        own.into_iter().chain(phases::outputs().filter(|_| told)).collect()
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
        let (energy_j, present_s, phases_j) = self.stretch(signals.get(0), span_s, state);
        let electric_w = energy_j / span_s;
        state[ELAPSED_S] += dt_s;
        state[ELECTRIC_J] += dt_s * electric_w;
        let gain_w = self.params.gain_share * electric_w;
        let (own, phases) = out.split_at_mut(4);
        own.copy_from_slice(&[electric_w, present_s / span_s, gain_w, state[ELECTRIC_J]]);
        phases.iter_mut().zip(phases_j).for_each(|(out, phase_j)| *out = phase_j / span_s);
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

    #[test]
    fn phases_add_up_and_differ() {
        let even = HouseholdParams::default().build(&Medium::default()).unwrap();
        let params =
            HouseholdParams { phases: HouseholdPhases::Random, ..HouseholdParams::default() };
        let unit = params.build(&Medium::default()).unwrap();
        assert_eq!((even.outputs().len(), unit.outputs().len()), (4, 7));
        let (mut state, mut sums_j) = (unit.initial_state(0.0), [0.0; PHASES]);
        let mut apart = 0.0;
        for _ in 0..364 * QUARTERS {
            let mut out = [0.0; 7];
            unit.advance(QUARTER_S, &Signals(&[START_S]), &[], &mut state, &mut out);
            let phases = &out[4..];
            assert!((phases.iter().sum::<f64>() - out[0]).abs() < 1e-9 * out[0]);
            // 30 % of the weight is always there, a third of it on each.
            assert!(phases.iter().all(|w| *w > 0.0));
            sums_j.iter_mut().zip(phases).for_each(|(sum, w)| *sum += QUARTER_S * w);
            let most = phases.iter().fold(0.0, |m: f64, w| m.max(*w));
            apart += (most / out[0] - 1.0 / 3.0) / (364.0 * QUARTERS as f64);
        }
        // A third each in the long run; the largest of three exponential shares is 11/18 on average, times the 0.7 or so that
        // are not the base: 1/3 + 0.6 (11/18 - 1/3) = 0.50.
        assert!(sums_j.iter().all(|j| (j / sums_j.iter().sum::<f64>() - 1.0 / 3.0).abs() < 0.01));
        assert!((0.12..0.22).contains(&apart), "{apart}");
    }
}
