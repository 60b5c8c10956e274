//! Sensors: what a controller sees of a quantity.
//!
//! **Equation** first-order lag `tau dy/dt = x - y`, then dead time `z(t) = y(t - theta)`, then `z + offset +
//! noise` rounded to the resolution. **Assumptions** the quantity moves straight from the end of one step to
//! that of the next. **Numerics** the lag is exact for that; the dead time keeps the last
//! [`KEPT`] moments at most, so that points closer than a 256th of the dead time are merged. Noise is
//! normal, drawn once per step from the sensor's own stream. **Sources** `astrom2006`.

use crate::controller::{ControlError, not_negative};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg32;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Moments that a dead time keeps.
pub const KEPT: usize = 260;
const PARTS: i64 = 256;
const NS_PER_S: f64 = 1e9;

/// A sensor as written in a model file; its value is the channel `id.value`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorEntry {
    /// Name.
    pub id: String,
    /// Channel that it measures.
    pub measures: String,
    /// Channel that is subtracted, for a sensor of a difference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub minus: Option<String>,
    /// Time constant, s.
    #[serde(default)]
    pub time_constant_s: f64,
    /// Time by which it is late, s.
    #[serde(default)]
    pub dead_time_s: f64,
    /// Systematic error, in the SI unit of what is measured.
    #[serde(default)]
    pub offset: f64,
    /// Standard deviation of its noise, in the same unit; drawn anew at each step.
    #[serde(default)]
    pub noise: f64,
    /// Step of its reading, in the same unit; 0 is continuous.
    #[serde(default)]
    pub resolution: f64,
    /// Start of its random numbers.
    #[serde(default)]
    pub seed: u64,
}

/// A sensor ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    time_constant_s: f64,
    dead_time_ns: i64,
    offset: f64,
    noise: f64,
    resolution: f64,
    seed: u64,
}

/// What a sensor remembers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SensorState {
    /// The quantity at the end of the last step.
    raw: f64,
    lagged: f64,
    /// Reading.
    value: f64,
    /// What was before all moments.
    before: f64,
    /// Moments, ns, with the lagged value, in a ring.
    moments: Vec<(i64, f64)>,
    first: usize,
    len: usize,
    random: Pcg32,
}

impl SensorEntry {
    /// The runtime sensor.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self) -> Result<Sensor, ControlError> {
        not_negative("time_constant_s", self.time_constant_s)?;
        not_negative("dead_time_s", self.dead_time_s)?;
        not_negative("noise", self.noise)?;
        not_negative("resolution", self.resolution)?;
        if !self.offset.is_finite() {
            let (field, value) = ("offset", self.offset);
            return Err(ControlError::OutOfRange { field, value, requirement: "must be a number" });
        }
        let dead_time_ns = self.dead_time_s * NS_PER_S;
        if dead_time_ns > 1e18 {
            let (field, value) = ("dead_time_s", self.dead_time_s);
            return Err(ControlError::OutOfRange { field, value, requirement: "is too long" });
        }
        #[allow(clippy::cast_possible_truncation)]
        Ok(Sensor {
            time_constant_s: self.time_constant_s,
            dead_time_ns: dead_time_ns.round() as i64,
            offset: self.offset,
            noise: self.noise,
            resolution: self.resolution,
            seed: self.seed,
        })
    }
}

impl Sensor {
    /// Time constant, s.
    pub fn time_constant_s(&self) -> f64 {
        self.time_constant_s
    }

    /// Dead time, s.
    #[allow(clippy::cast_precision_loss)]
    pub fn dead_time_s(&self) -> f64 {
        self.dead_time_ns as f64 / NS_PER_S
    }

    /// A sensor that has always seen `raw`.
    pub fn resting(&self, raw: f64) -> SensorState {
        let moments = if self.dead_time_ns > 0 { vec![(0, 0.0); KEPT] } else { Vec::new() };
        let mut state = SensorState {
            raw,
            lagged: raw,
            value: raw,
            before: raw,
            moments,
            first: 0,
            len: 0,
            random: Pcg32::new(self.seed, 0x0a02_bdbf_7bb3_c0a7),
        };
        state.value = self.reading(raw, &mut state);
        state
    }

    /// Makes a sensor rest at `raw`.
    pub fn rest(&self, raw: f64, state: &mut SensorState) {
        (state.raw, state.lagged, state.before) = (raw, raw, raw);
        (state.first, state.len) = (0, 0);
        state.value = self.reading(raw, state);
    }

    /// The quantity has moved to `raw` within `dt_s`, at whose end it is `now_ns`.
    pub fn advance(&self, now_ns: i64, dt_s: f64, raw: f64, state: &mut SensorState) {
        let tau = self.time_constant_s;
        state.lagged = if tau > 0.0 {
            // Exact for x from `raw` before to `raw` now along a straight line.
            let decay = (-dt_s / tau).exp();
            let behind = (raw - state.raw) * tau / dt_s;
            raw - behind + (state.lagged - state.raw + behind) * decay
        } else {
            raw
        };
        state.raw = raw;
        let seen = if self.dead_time_ns > 0 { self.delayed(now_ns, state) } else { state.lagged };
        state.value = self.reading(seen, state);
    }

    /// Remembers the present moment and recalls that of a dead time ago.
    fn delayed(&self, now_ns: i64, state: &mut SensorState) -> f64 {
        let wanted = now_ns - self.dead_time_ns;
        let at = |state: &SensorState, k: usize| state.moments[(state.first + k) % KEPT];
        // What is older than the moment wanted and the one before it is over.
        while state.len >= 2 && at(state, 1).0 <= wanted {
            state.before = at(state, 0).1;
            state.first = (state.first + 1) % KEPT;
            state.len -= 1;
        }
        let spacing = self.dead_time_ns / PARTS;
        let crowded =
            state.len >= 2 && at(state, state.len - 1).0 - at(state, state.len - 2).0 < spacing;
        if crowded || state.len == KEPT {
            state.len -= 1;
        }
        let place = (state.first + state.len) % KEPT;
        state.moments[place] = (now_ns, state.lagged);
        state.len += 1;
        let (first_ns, first) = at(state, 0);
        if wanted <= first_ns {
            return if wanted == first_ns { first } else { state.before };
        }
        let mut k = 1;
        while k < state.len && at(state, k).0 < wanted {
            k += 1;
        }
        if k == state.len {
            return at(state, state.len - 1).1;
        }
        let ((left_ns, left), (right_ns, right)) = (at(state, k - 1), at(state, k));
        #[allow(clippy::cast_precision_loss)]
        let share = (wanted - left_ns) as f64 / (right_ns - left_ns) as f64;
        left + share * (right - left)
    }

    fn reading(&self, seen: f64, state: &mut SensorState) -> f64 {
        let mut value = seen + self.offset;
        if self.noise > 0.0 {
            let drawn: f64 = StandardNormal.sample(&mut state.random);
            value += self.noise * drawn;
        }
        if self.resolution > 0.0 {
            (value / self.resolution).round() * self.resolution
        } else {
            value
        }
    }
}

impl SensorState {
    /// The reading.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Whether another state can stand in its place.
    pub fn fits(&self, other: &Self) -> bool {
        self.moments.len() == other.moments.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry() -> SensorEntry {
        SensorEntry {
            id: "s".into(),
            measures: "x".into(),
            minus: None,
            time_constant_s: 0.0,
            dead_time_s: 0.0,
            offset: 0.0,
            noise: 0.0,
            resolution: 0.0,
            seed: 0,
        }
    }

    #[test]
    fn a_ramp_is_followed_exactly_whatever_the_step() {
        // x = t: y = t - tau + tau exp(-t/tau), then 3 s late
        let sensor =
            SensorEntry { time_constant_s: 2.0, dead_time_s: 3.0, ..entry() }.build().unwrap();
        let mut state = sensor.resting(0.0);
        let (mut now, mut k) = (0_i64, 0);
        while now < 20_000_000_000 {
            let dt = [100_000_000, 350_000_000, 50_000_000][k % 3];
            (now, k) = (now + dt, k + 1);
            let (t, dt_s) = (now as f64 * 1e-9, dt as f64 * 1e-9);
            sensor.advance(now, dt_s, t, &mut state);
            let late = t - 3.0;
            let expected = if late > 0.0 { late - 2.0 + 2.0 * (-late / 2.0).exp() } else { 0.0 };
            // Straight lines between the moments kept: h^2/8 y'' = 0.35^2/8/2
            assert!((state.value() - expected).abs() < 8e-3, "{t}: {} {expected}", state.value());
        }
    }

    #[test]
    fn a_dead_time_of_whole_steps_is_exact_and_very_short_steps_do_not_overflow() {
        let sensor = SensorEntry { dead_time_s: 1.0, ..entry() }.build().unwrap();
        let mut state = sensor.resting(0.0);
        for k in 1..=30_i64 {
            sensor.advance(k * 100_000_000, 0.1, k as f64, &mut state);
            assert_eq!(state.value(), (k - 10).max(0) as f64);
        }
        let mut state = sensor.resting(0.0);
        for k in 1..=40_000_i64 {
            let t = k as f64 * 1e-4;
            sensor.advance(k * 100_000, 1e-4, t, &mut state);
            assert!((state.value() - (t - 1.0).max(0.0)).abs() < 5e-3, "{t}: {}", state.value());
        }
    }

    #[test]
    fn noise_has_its_deviation_and_readings_their_step() {
        let sensor = SensorEntry { noise: 0.5, seed: 7, ..entry() }.build().unwrap();
        let mut state = sensor.resting(10.0);
        let n = 20_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for k in 1..=n {
            sensor.advance(k, 1e-9, 10.0, &mut state);
            sum += state.value() - 10.0;
            squares += (state.value() - 10.0).powi(2);
        }
        // Standard errors 0.5/sqrt(n) = 0.0035 and 0.5/sqrt(2 n) = 0.0025; four of them
        let n = n as f64;
        assert!((sum / n).abs() < 0.014 && ((squares / n).sqrt() - 0.5).abs() < 0.01);
        let sensor = SensorEntry { resolution: 0.25, offset: 0.1, ..entry() }.build().unwrap();
        assert_eq!(sensor.resting(1.0).value(), 1.0);
        assert_eq!(sensor.resting(1.1).value(), 1.25);
        assert_eq!(
            SensorEntry { noise: -1.0, ..entry() }.build().unwrap_err().field(),
            Some("noise")
        );
    }
}
