//! Signals over time: schedules and series, evaluated at the ends of steps.

use crate::model_file::Interpolation;
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
use std::sync::Arc;

/// A signal with its points in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Driver {
    /// The signal it drives.
    pub signal: SignalId,
    /// Between the points.
    pub interpolation: Interpolation,
    /// Times of the points, rising.
    pub times: Arc<[Time]>,
    /// Values of the points, SI.
    pub values: Arc<[f64]>,
}

impl Driver {
    /// Value during a step that ends at `end`: the value held on the way there, or the interpolated
    /// value at the end. Before the first point and after the last one their values hold. `near` is
    /// where the points may be, as [`Self::next_breakpoint`] left it.
    pub fn value_until(&self, end: Time, near: usize) -> f64 {
        // A held value changes at its point: a step that ends there still has the old one.
        let next = match self.interpolation {
            Interpolation::Hold => self.passed(near, |time| time < end),
            Interpolation::Linear => self.passed(near, |time| time <= end),
        };
        self.between(next, end)
    }

    /// Value at a time, with a held value changing at its point.
    pub fn value_at(&self, time: Time) -> f64 {
        let next = self.times.partition_point(|point| *point <= time);
        self.between(next, time)
    }

    fn between(&self, next: usize, time: Time) -> f64 {
        if next == 0 {
            return self.values[0];
        }
        let (before, left) = (self.times[next - 1], self.values[next - 1]);
        match self.interpolation {
            Interpolation::Linear if next < self.times.len() => {
                let share = (time.0 - before.0) as f64 / (self.times[next].0 - before.0) as f64;
                left + (self.values[next] - left) * share
            }
            _ => left,
        }
    }

    /// The first point after `now`; `near` is where it was before, and is moved there.
    pub fn next_breakpoint(&self, now: Time, near: &mut usize) -> Time {
        *near = self.passed(*near, |time| time <= now);
        self.times.get(*near).copied().unwrap_or(Time::NEVER)
    }

    /// Whether its last point, of `passed` ones, is now.
    pub fn turns_at(&self, now: Time, passed: usize) -> bool {
        passed > 0 && self.times.get(passed - 1) == Some(&now)
    }

    /// Whether the value changes at the last one of `passed` points instead of from there on.
    pub fn jumps_at(&self, passed: usize) -> bool {
        let held = self.interpolation == Interpolation::Hold;
        held && passed > 1 && self.values[passed - 1] != self.values[passed - 2]
    }

    /// Number of points that have passed: looked for from `near` on, anywhere if it is not there.
    fn passed(&self, near: usize, passed: impl Fn(Time) -> bool) -> usize {
        let is = |i: usize| self.times.get(i).is_some_and(|time| passed(*time));
        if near > self.times.len() || (near > 0 && !is(near - 1)) {
            return self.times.partition_point(|time| passed(*time));
        }
        if !is(near) {
            near
        } else if !is(near + 1) {
            near + 1
        } else {
            self.times.partition_point(|time| passed(*time))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driver(interpolation: Interpolation) -> Driver {
        Driver {
            signal: SignalId(0),
            interpolation,
            times: [Time(10), Time(20), Time(40)].into(),
            values: [1.0, 2.0, 4.0].into(),
        }
    }

    #[test]
    fn held_values_change_at_their_points() {
        let hold = driver(Interpolation::Hold);
        assert_eq!(hold.value_until(Time(20), 0), 1.0);
        assert_eq!(hold.value_until(Time(21), 0), 2.0);
        assert_eq!(hold.value_at(Time(20)), 2.0);
        assert_eq!(hold.value_at(Time(0)), 1.0);
        assert_eq!(hold.value_until(Time(99), 0), 4.0);
        assert_eq!(hold.next_breakpoint(Time(10), &mut 0), Time(20));
        assert_eq!(hold.next_breakpoint(Time(40), &mut 0), Time::NEVER);
    }

    #[test]
    fn linear_values_are_those_at_the_end_of_the_step() {
        let linear = driver(Interpolation::Linear);
        assert_eq!(linear.value_until(Time(15), 0), 1.5);
        assert_eq!(linear.value_until(Time(20), 0), 2.0);
        assert_eq!(linear.value_until(Time(30), 0), 3.0);
        assert_eq!(linear.value_until(Time(5), 0), 1.0);
        assert_eq!(linear.value_until(Time(50), 0), 4.0);
    }

    #[test]
    fn wherever_it_looks_first() {
        let linear = driver(Interpolation::Linear);
        for (time, next, value) in [(5, 10, 1.0), (15, 20, 1.5), (20, 40, 2.0), (50, -1, 4.0)] {
            let next = if next < 0 { Time::NEVER } else { Time(next) };
            for start in 0..=9 {
                let mut near = start;
                assert_eq!(linear.next_breakpoint(Time(time), &mut near), next);
                assert_eq!(linear.value_until(Time(time), start), value);
                assert_eq!(linear.value_until(Time(time), near), value);
            }
        }
    }
}
