//! Simulated time in integer nanoseconds: no drift, exact breakpoints, equal on every platform.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::{Add, Sub};

/// Nanoseconds in a second.
pub const NS_PER_S: i64 = 1_000_000_000;

/// A point in simulated time or a duration, in nanoseconds since the start of the run.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
pub struct Time(pub i64);

impl Time {
    /// The start of the run.
    pub const ZERO: Self = Self(0);
    /// Later than any event.
    pub const NEVER: Self = Self(i64::MAX);

    /// From seconds, rounded to the nanosecond; `None` when not finite or beyond 292 years.
    pub fn from_s(seconds: f64) -> Option<Self> {
        let ns = (seconds * NS_PER_S as f64).round();
        (ns.is_finite() && ns.abs() < 9.2e18).then_some(Self(ns as i64))
    }

    /// In seconds.
    #[inline]
    pub fn as_s(self) -> f64 {
        self.0 as f64 / NS_PER_S as f64
    }

    /// The first multiple of `interval` that is later than `self`.
    #[inline]
    pub fn next_multiple(self, interval: Self) -> Self {
        if interval.0 <= 0 {
            return Self::NEVER;
        }
        Self((self.0.div_euclid(interval.0) + 1).saturating_mul(interval.0))
    }

    /// Whether `self` is a multiple of `interval`.
    #[inline]
    pub fn is_multiple_of(self, interval: Self) -> bool {
        interval.0 > 0 && self.0.rem_euclid(interval.0) == 0
    }
}

impl Add for Time {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl Sub for Time {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

/// Human form: `2h 13m 20s`, `1.5s`, `250ms`.
impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::NEVER {
            return f.write_str("never");
        }
        let (sign, ns) = (if self.0 < 0 { "-" } else { "" }, self.0.unsigned_abs());
        f.write_str(sign)?;
        let total_s = ns / NS_PER_S as u64;
        if total_s < 60 {
            return write!(f, "{}s", ns as f64 / NS_PER_S as f64);
        }
        let (d, h, m) = (total_s / 86_400, total_s / 3600 % 24, total_s / 60 % 60);
        let s = (ns % (60 * NS_PER_S as u64)) as f64 / NS_PER_S as f64;
        let mut parts = Vec::with_capacity(4);
        for (value, unit) in [(d, "d"), (h, "h"), (m, "m")] {
            if value > 0 {
                parts.push(format!("{value}{unit}"));
            }
        }
        if s > 0.0 {
            parts.push(format!("{s}s"));
        }
        f.write_str(&parts.join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_are_exact() {
        let tenth = Time::from_s(0.1).unwrap();
        let mut t = Time::ZERO;
        for _ in 0..36_000 {
            t = t.next_multiple(tenth);
        }
        // 36 000 steps of 0.1 s are exactly one hour; in f64 the sum would be off by 1e-9 s.
        assert_eq!(t, Time::from_s(3600.0).unwrap());
        assert_eq!(Time(5).next_multiple(Time(5)), Time(10));
        assert_eq!(Time(-1).next_multiple(Time(5)), Time(0));
        assert_eq!(Time(4).next_multiple(Time(0)), Time::NEVER);
    }

    #[test]
    fn text() {
        assert_eq!(Time::from_s(3661.5).unwrap().to_string(), "1h 1m 1.5s");
        assert_eq!(Time::from_s(86_400.0).unwrap().to_string(), "1d");
        assert_eq!(Time::from_s(0.25).unwrap().to_string(), "0.25s");
        assert!(Time::from_s(f64::NAN).is_none());
    }
}
