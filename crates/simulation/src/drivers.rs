//! Signals over time: schedules and series, evaluated at the ends of steps.

use crate::model_file::Interpolation;
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;

/// A signal with its points in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Driver {
    /// The signal it drives.
    pub signal: SignalId,
    /// Between the points.
    pub interpolation: Interpolation,
    /// Times of the points, rising.
    pub times: Vec<Time>,
    /// Values of the points, SI.
    pub values: Vec<f64>,
}

impl Driver {
    /// Value during a step that ends at `end`: the value held on the way there, or the interpolated
    /// value at the end. Before the first point and after the last one their values hold.
    pub fn value_until(&self, end: Time) -> f64 {
        // A held value changes at its point: a step that ends there still has the old one.
        let next = match self.interpolation {
            Interpolation::Hold => self.times.partition_point(|time| *time < end),
            Interpolation::Linear => self.times.partition_point(|time| *time <= end),
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

    /// The first point after `now`.
    pub fn next_breakpoint(&self, now: Time) -> Time {
        let next = self.times.partition_point(|time| *time <= now);
        self.times.get(next).copied().unwrap_or(Time::NEVER)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driver(interpolation: Interpolation) -> Driver {
        Driver {
            signal: SignalId(0),
            interpolation,
            times: vec![Time(10), Time(20), Time(40)],
            values: vec![1.0, 2.0, 4.0],
        }
    }

    #[test]
    fn held_values_change_at_their_points() {
        let hold = driver(Interpolation::Hold);
        assert_eq!(hold.value_until(Time(20)), 1.0);
        assert_eq!(hold.value_until(Time(21)), 2.0);
        assert_eq!(hold.value_at(Time(20)), 2.0);
        assert_eq!(hold.value_at(Time(0)), 1.0);
        assert_eq!(hold.value_until(Time(99)), 4.0);
        assert_eq!(hold.next_breakpoint(Time(10)), Time(20));
        assert_eq!(hold.next_breakpoint(Time(40)), Time::NEVER);
    }

    #[test]
    fn linear_values_are_those_at_the_end_of_the_step() {
        let linear = driver(Interpolation::Linear);
        assert_eq!(linear.value_until(Time(15)), 1.5);
        assert_eq!(linear.value_until(Time(20)), 2.0);
        assert_eq!(linear.value_until(Time(30)), 3.0);
        assert_eq!(linear.value_until(Time(5)), 1.0);
        assert_eq!(linear.value_until(Time(50)), 4.0);
    }
}
