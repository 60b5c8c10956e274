//! Draws of hot water: a reproducible random sequence with the statistics of DHWcalc.
//!
//! **Equation** four kinds of draws (short, medium, bath, shower) of a flow, a duration and a share of the daily volume.
//! A day has `V_d = 7 V {1, w}/(5 + 2 w) (1 + a cos(2 pi (d - d_0)/365))` with the factor `w` of weekends. A kind has as
//! many draws as its share needs, `n = share V_d/(flow duration)` on average: between two days `floor(N(d) + x_d)` more,
//! with the sum `N` of all days before and a random number `x_d` below 1, which for kinds rarer than once a day stays the
//! same. They begin at times spread by the daily course; the flow is normally distributed, at least `LEAST_L_MIN`, and `n`
//! counts with its mean.
//!
//! **Assumptions** draws do not depend on each other and may overlap; a draw ends before midnight. **Validity**
//! statistics of households. **Numerics** a day's draws follow from the seed and the date alone (the sum `N` has a
//! closed form for each day of the week); the state keeps only their numbers by their begin, and begin and flow are made
//! again from the number where they are needed; means over a step are exact.
//!
//! **Sources** `jordan2001`; flows, durations, shares and courses as in the profiles of the laboratory, `zinsmeister2023`.

use crate::calendar::{DAY_S, normal, season_rad, uniform, weekend};

/// A flow of less is drawn as this, l/min.
const LEAST_L_MIN: f64 = 0.5;
/// Kinds of draws: flow and its deviation, l/min; duration, s; share of the volume.
const KINDS: [(f64, f64, f64, f64); 4] = [
    (1.0, 2.0, 60.0, 0.14),
    (6.0, 2.0, 60.0, 0.36),
    (14.0, 0.2, 600.0, 0.10),
    (8.0, 0.4, 300.0, 0.40),
];
/// The course of a day: until which hour which share of the volume is drawn; from midnight.
const WORKDAY: [(f64, f64); 7] = [
    (6.5, 2.0 * 6.5 / 8.5),
    (7.5, 50.0),
    (12.0, 6.0),
    (13.0, 16.0),
    (18.0, 6.0),
    (22.0, 20.0),
    (24.0, 2.0 * 2.0 / 8.5),
];
const WEEKEND: [(f64, f64); 8] = [
    (7.0, 3.8 * 7.0 / 8.0),
    (9.0, 47.5),
    (15.0, 7.1),
    (17.0, 23.8),
    (20.0, 3.6),
    (23.0, 14.3),
    (24.0, 3.8 / 8.0),
    (24.0, 0.0),
];
/// Kinds with fewer draws a day are spread evenly over the days: with weekends and seasons at least one must remain.
const LEAST_A_DAY: f64 = 2.0;
/// Day of the year with the largest volume.
const LARGEST_DAY: f64 = 45.0;
const M3_PER_L: f64 = 1e-3;
const S_PER_MIN: f64 = 60.0;
/// Indices of the random numbers of a kind on a day.
const PER_KIND: u64 = 100_000;

/// A profile of draws.
#[derive(Debug, Clone, PartialEq)]
pub struct Draws {
    seed: u64,
    daily_m3: f64,
    weekend_factor: f64,
    season_amplitude: f64,
    /// Mean flow of each kind, m3/s.
    mean_m3_s: [f64; 4],
    most: usize,
}

/// What is drawn in a span.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Drawn {
    /// Volume, m3.
    pub volume_m3: f64,
    /// Volume of each kind, m3.
    pub kinds_m3: [f64; 4],
    /// Time with at least one draw, s.
    pub drawing_s: f64,
}

/// Places in front of the draws: the day, their count, the first that has not ended. A draw is its number: that of its kind
/// times `PER_KIND`, and which of its kind it is.
const DAY: usize = 0;
const COUNT: usize = 1;
const NEXT: usize = 2;
const FIRST: usize = 3;

/// Mean of a normally distributed number that is at least `least`.
fn mean_at_least(mean: f64, deviation: f64, least: f64) -> f64 {
    // Midpoints of fine steps over eight deviations.
    let (mut sum, mut weights) = (0.0, 0.0);
    for i in 0..3200 {
        let z = -8.0 + (f64::from(i) + 0.5) / 200.0;
        let weight = (-0.5 * z * z).exp();
        sum += weight * (mean + deviation * z).max(least);
        weights += weight;
    }
    sum / weights
}

impl Draws {
    /// A profile of a mean daily volume, m3.
    pub fn new(seed: u64, daily_m3: f64, weekend_factor: f64, season_amplitude: f64) -> Self {
        let mean_m3_s = KINDS.map(|(flow, deviation, _, _)| {
            mean_at_least(flow, deviation, LEAST_L_MIN) * M3_PER_L / S_PER_MIN
        });
        let mut draws =
            Self { seed, daily_m3, weekend_factor, season_amplitude, mean_m3_s, most: 0 };
        let largest = draws.daily_m3 * weekend_factor.max(1.0) * (1.0 + season_amplitude) * 1.4;
        draws.most = (0..KINDS.len()).map(|kind| draws.number(kind, largest) as usize + 2).sum();
        draws
    }

    /// Numbers it takes in a state.
    pub fn state_len(&self) -> usize {
        FIRST + self.most
    }

    /// Nothing made yet.
    pub fn initial(&self, state: &mut [f64]) {
        state.fill(0.0);
        state[DAY] = f64::MIN;
    }

    /// Number of draws of a kind in a volume.
    fn number(&self, kind: usize, volume_m3: f64) -> f64 {
        let (_, _, duration_s, share) = KINDS[kind];
        share * volume_m3 / (self.mean_m3_s[kind] * duration_s)
    }

    /// Mean volume of a day, m3.
    pub fn day_m3(&self, day: i64) -> f64 {
        let w = self.weekend_factor;
        let of_day = if weekend(day) { w } else { 1.0 };
        let of_season = 1.0 + self.season_amplitude * season_rad(day, LARGEST_DAY).cos();
        self.daily_m3 * 7.0 * of_day / (5.0 + 2.0 * w) * of_season
    }

    /// Mean volume of all days from 1970 on before a day, m3.
    fn before_m3(&self, day: i64) -> f64 {
        let w = self.weekend_factor;
        let mut sum = 0.0;
        for weekday in 0..7 {
            // The days 7 j + weekday, j = 0 to n - 1, and the sum of their cosines.
            let n = (day - weekday + 6).div_euclid(7) as f64;
            let week_rad = 7.0 * season_rad(1, 0.0);
            let middle_rad = season_rad(weekday, LARGEST_DAY) + 0.5 * (n - 1.0) * week_rad;
            let cosines = middle_rad.cos() * (0.5 * n * week_rad).sin() / (0.5 * week_rad).sin();
            let of_day = if weekend(weekday) { w } else { 1.0 };
            sum += of_day * (n + self.season_amplitude * cosines);
        }
        self.daily_m3 * 7.0 / (5.0 + 2.0 * w) * sum
    }

    /// Draws of a kind before a day.
    fn before(&self, kind: usize, day: i64) -> f64 {
        let base = kind as u64 * PER_KIND;
        // A number that changes every day could take a draw away where there is less than one a day.
        let rare = self.number(kind, self.daily_m3) < LEAST_A_DAY;
        let chance = uniform(self.seed, if rare { 0 } else { day }, base);
        (self.number(kind, self.before_m3(day)) + chance).floor()
    }

    /// Makes the draws of a day.
    fn make(&self, day: i64, state: &mut [f64]) {
        let (head, draws) = state.split_at_mut(FIRST);
        let mut count = 0;
        for kind in 0..KINDS.len() {
            let number = self.before(kind, day + 1) - self.before(kind, day);
            for i in 0..number as u64 {
                let Some(draw) = draws.get_mut(count) else { break };
                *draw = (kind as u64 * PER_KIND + i) as f64;
                count += 1;
            }
        }
        let begin_s = |draw: f64| self.span_s(day, draw).0;
        draws[..count].sort_unstable_by(|a, b| {
            begin_s(*a).total_cmp(&begin_s(*b)).then_with(|| a.total_cmp(b))
        });
        (head[DAY], head[COUNT], head[NEXT]) = (day as f64, count as f64, 0.0);
    }

    /// Begin and end of a draw within the day, s.
    fn span_s(&self, day: i64, draw: f64) -> (f64, f64) {
        let (_, _, duration_s, _) = KINDS[kind_of(draw)];
        let begin_s = time_of_day_s(weekend(day), uniform(self.seed, day, index_of(draw)));
        let begin_s = begin_s.min(DAY_S - duration_s);
        (begin_s, begin_s + duration_s)
    }

    /// Flow of a draw, m3/s.
    fn flow_m3_s(&self, day: i64, draw: f64) -> f64 {
        let (flow, deviation, _, _) = KINDS[kind_of(draw)];
        let chance = normal(self.seed, day, index_of(draw) + 40_000);
        (flow + deviation * chance).max(LEAST_L_MIN) * M3_PER_L / S_PER_MIN
    }

    /// What is drawn on a day from `from_s` on for `span_s`, not beyond its end.
    pub fn drawn(&self, day: i64, from_s: f64, span_s: f64, state: &mut [f64]) -> Drawn {
        if state[DAY] != day as f64 {
            self.make(day, state);
        }
        let until_s = from_s + span_s;
        let (head, draws) = state.split_at_mut(FIRST);
        let draws = &draws[..head[COUNT] as usize];
        let mut drawn = Drawn::default();
        let mut next = head[NEXT] as usize;
        // A repeated request may go back to the begin of its step: what ended before stays skipped.
        while draws.get(next).is_some_and(|draw| self.span_s(day, *draw).1 <= from_s) {
            next += 1;
        }
        head[NEXT] = next as f64;
        let mut covered_s = from_s;
        for &draw in &draws[next..] {
            let (begin_s, end_s) = self.span_s(day, draw);
            if begin_s >= until_s {
                break;
            }
            let length_s = end_s.min(until_s) - begin_s.max(from_s);
            if length_s > 0.0 {
                let volume_m3 = self.flow_m3_s(day, draw) * length_s;
                drawn.volume_m3 += volume_m3;
                drawn.kinds_m3[kind_of(draw)] += volume_m3;
                let end_s = end_s.min(until_s);
                drawn.drawing_s += (end_s - begin_s.max(covered_s)).max(0.0);
                covered_s = covered_s.max(end_s);
            }
        }
        drawn
    }
}

/// The kind of a draw.
fn kind_of(draw: f64) -> usize {
    (draw as u64 / PER_KIND) as usize
}

/// Index of the first random number of a draw.
fn index_of(draw: f64) -> u64 {
    let draw = draw as u64;
    draw - draw % PER_KIND + 10 + 2 * (draw % PER_KIND)
}

/// The time of day up to which a share of the volume is drawn, s.
fn time_of_day_s(weekend: bool, share: f64) -> f64 {
    let course: &[(f64, f64)] = if weekend { &WEEKEND } else { &WORKDAY };
    let mut left = share * course.iter().map(|(_, part)| part).sum::<f64>();
    let mut from_h = 0.0;
    for &(until_h, part) in course {
        if left < part {
            return 3600.0 * (from_h + (until_h - from_h) * left / part);
        }
        left -= part;
        from_h = until_h;
    }
    DAY_S
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2023-01-02, a Monday.
    const MONDAY: i64 = 19_359;

    fn days(draws: &Draws, count: i64) -> Vec<Drawn> {
        let mut state = vec![0.0; draws.state_len()];
        draws.initial(&mut state);
        (0..count).map(|i| draws.drawn(MONDAY + i, 0.0, DAY_S, &mut state)).collect()
    }

    #[test]
    fn statistics_of_ten_years() {
        for (seed, daily_m3) in [(1, 0.3), (2, 0.4), (3, 0.75)] {
            let draws = Draws::new(seed, daily_m3, 1.2, 0.1);
            let days = days(&draws, 3652);
            let volume = |of: &dyn Fn(usize) -> bool| {
                let (n, sum) = days
                    .iter()
                    .enumerate()
                    .filter(|(i, _)| of(*i))
                    .fold((0.0, 0.0), |(n, sum), (_, day)| (n + 1.0, sum + day.volume_m3));
                sum / n
            };
            let mean_m3 = volume(&|_| true);
            assert!((mean_m3 / daily_m3 - 1.0).abs() < 0.02, "{seed}: {mean_m3}");
            let total: f64 = days.iter().map(|day| day.volume_m3).sum();
            for (kind, share) in [0.14, 0.36, 0.10, 0.40].into_iter().enumerate() {
                let got = days.iter().map(|day| day.kinds_m3[kind]).sum::<f64>() / total;
                assert!((got - share).abs() < 0.02 * share.max(0.2), "{seed} kind {kind}: {got}");
            }
            let ratio = volume(&|i| i % 7 >= 5) / volume(&|i| i % 7 < 5);
            assert!((ratio - 1.2).abs() < 0.02 * 1.2, "{seed}: {ratio}");
            // Winter (three months round the largest day) over summer: 1 +- 0.09.
            let season = |d: i64, of: i64| {
                let apart = (d - of).rem_euclid(365);
                !(45..=320).contains(&apart)
            };
            let of_year = |i: usize| (MONDAY + i as i64) - (365.2425 * 53.0) as i64;
            let winter = volume(&|i| season(of_year(i) % 365, 45));
            let summer = volume(&|i| season(of_year(i) % 365, 228));
            assert!((winter / summer - 1.2).abs() < 0.03, "{seed}: {}", winter / summer);
        }
    }

    #[test]
    fn half_of_a_workday_is_drawn_from_half_past_six_to_half_past_seven() {
        let draws = Draws::new(1, 0.3, 1.2, 0.1);
        let mut state = vec![0.0; draws.state_len()];
        draws.initial(&mut state);
        let (mut morning_m3, mut all_m3) = (0.0, 0.0);
        for day in (0..3640).filter(|day| day % 7 < 5) {
            let day = MONDAY + day;
            let before = draws.drawn(day, 0.0, 6.5 * 3600.0, &mut state).volume_m3;
            let morning = draws.drawn(day, 6.5 * 3600.0, 3600.0, &mut state).volume_m3;
            let after = draws.drawn(day, 7.5 * 3600.0, 16.5 * 3600.0, &mut state).volume_m3;
            morning_m3 += morning;
            all_m3 += before + morning + after;
        }
        // A draw that begins in the hour may end behind it: a little less than half.
        let share = morning_m3 / all_m3;
        assert!((share - 0.48).abs() < 0.02, "{share}");
    }

    #[test]
    fn steps_do_not_change_what_is_drawn() {
        let draws = Draws::new(5, 0.3, 1.2, 0.1);
        let whole = days(&draws, 3);
        for step_s in [1.0, 60.0, 900.0, 3600.0] {
            let mut state = vec![0.0; draws.state_len()];
            draws.initial(&mut state);
            for (i, whole) in whole.iter().enumerate() {
                let mut sum = Drawn::default();
                for step in 0..(DAY_S / step_s) as usize {
                    let from_s = step as f64 * step_s;
                    let part = draws.drawn(MONDAY + i as i64, from_s, step_s, &mut state);
                    sum.volume_m3 += part.volume_m3;
                    sum.drawing_s += part.drawing_s;
                }
                assert!((sum.volume_m3 - whole.volume_m3).abs() < 1e-12, "{step_s} s, day {i}");
                assert!((sum.drawing_s - whole.drawing_s).abs() < 1e-6);
            }
        }
        assert_ne!(days(&Draws::new(6, 0.3, 1.2, 0.1), 1), days(&draws, 1));
    }

    #[test]
    fn a_day_does_not_depend_on_what_was_asked_before() {
        let draws = Draws::new(5, 0.3, 1.2, 0.1);
        let whole = days(&draws, 3);
        let mut state = vec![0.0; draws.state_len()];
        draws.initial(&mut state);
        // Back and forth over midnight, as steps that are tried and repeated.
        for i in [2, 0, 1, 0, 2, 1] {
            let again = draws.drawn(MONDAY + i, 0.0, DAY_S, &mut state);
            assert_eq!(again, whole[i as usize], "day {i}");
        }
        // The closed form of the sum.
        let sum: f64 = (MONDAY..MONDAY + 500).map(|day| draws.day_m3(day)).sum();
        let closed = draws.before_m3(MONDAY + 500) - draws.before_m3(MONDAY);
        assert!((sum - closed).abs() < 1e-8, "{sum} {closed}");
    }

    #[test]
    fn a_mean_with_a_least_value() {
        // Without deviation the value itself; of N(0, 1) at least 0 it is 1/sqrt(2 pi).
        assert!((mean_at_least(6.0, 0.0, 0.5) - 6.0).abs() < 1e-12);
        assert!((mean_at_least(0.0, 1.0, 0.0) - 0.398_942).abs() < 1e-5);
    }
}
