//! Weather: what the global signals `weather.*` are during a step.
//!
//! **Equation** the records of a weather lie side by side, one in each interval (an hour, a quarter of an hour).
//! Temperature, humidity and wind run in straight lines between the points of the records; a step has the value
//! at its end, as of any series. An irradiance of a record is the mean of its interval; within it runs as what the
//! horizontal gets outside the atmosphere,
//! ```text
//! G(t) = G_mean max(0, sin h(t)) / mean(max(0, sin h)),     G_bn(t) = G_bn,mean dt/(time with sun) while the sun is up
//! ```
//! so that the clearness of the sky and the diffuse share hold through the interval. A step has the exact mean over
//! the step, so that any steps that fill an interval have its mean. The sun stands where it does in the middle of the
//! sunlit part of the step.
//!
//! **Assumptions** an interval whose irradiance would exceed that outside the atmosphere (records of twilight, clocks
//! that are off) has it evenly instead. The declination of the sun is held within an interval.
//! **Validity** intervals up to 3 h; steps shorter than the night.
//! **Numerics** closed form, one or two pairs of sine and cosine in a step. **Sources** `michalsky1988`.

mod calendar;
mod days;
mod epw;
mod irradiance;
mod records;
mod synthetic;
mod table;

pub(crate) use calendar::Calendar;
pub use days::{Day, Season, TypeDay};
pub(crate) use epw::read as read_epw;
pub(crate) use records::PointAt;
pub use records::Records;
pub(crate) use synthetic::Synthetic;
pub(crate) use table::Reading as TableReading;

use anergy_core::clock::{NS_PER_S, Time};
use anergy_core::ids::SignalId;
use anergy_core::solar::{Location, SOLAR_CONSTANT_W_M2, SunPath};

/// The signals, in the order in which a step has their values.
pub(crate) const SIGNALS: [(&str, &str); 8] = [
    ("weather.t_outdoor_k", "k"),
    ("weather.relative_humidity", ""),
    ("weather.wind_m_s", "m_s"),
    ("weather.global_horizontal_w_m2", "w_m2"),
    ("weather.diffuse_horizontal_w_m2", "w_m2"),
    ("weather.beam_normal_w_m2", "w_m2"),
    ("weather.sun_elevation_rad", "rad"),
    ("weather.sun_azimuth_rad", "rad"),
];

/// The temperature of the ground, for units that know the weather only.
pub(crate) const T_GROUND: &str = "weather.t_ground_k";

/// Whether a signal is one of the weather.
pub(crate) fn is_signal(name: &str) -> bool {
    let is = || name == T_GROUND || SIGNALS.iter().any(|(signal, _)| *signal == name);
    name.starts_with("weather.") && is()
}

/// The first of those about the sun.
pub(crate) const SUN: usize = GLOBAL;

const GLOBAL: usize = 3;
const BEAM: usize = 5;

/// What is wrong with a weather, and at which field of the entry.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Problem {
    pub field: &'static str,
    pub message: String,
    pub hint: Option<String>,
}

impl Problem {
    pub(crate) fn new(field: &'static str, message: String) -> Self {
        Self { field, message, hint: None }
    }

    pub(crate) fn with_hint(self, hint: impl Into<String>) -> Self {
        Self { hint: Some(hint.into()), ..self }
    }
}

/// The weather of a run.
#[derive(Debug, Clone)]
pub(crate) struct Weather {
    pub records: std::sync::Arc<Records>,
    /// Start of the run, ns since 1970.
    pub start_unix_ns: i64,
    /// The signals it writes: those that nothing else drives.
    pub signals: [Option<SignalId>; SIGNALS.len()],
}

/// The interval that was looked at last: nothing but what the records say of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interval {
    number: i64,
    /// Its begin, ns since 1970, and its length.
    begin_ns: i64,
    length_s: f64,
    /// Temperature, humidity and wind at its begin and end.
    lines: [(f64, f64); 3],
    /// Means of global, diffuse and beam irradiance.
    means: [f64; 3],
    sun: Option<Sun>,
}

/// The sun around the middle of an interval.
#[derive(Debug, Clone, Copy)]
struct Sun {
    path: SunPath,
    /// Integral of the sine of its elevation where global and diffuse follow it, s; else 0.
    sine_s: f64,
    /// Time with sun where the beam follows it, s; else 0.
    sunshine_s: f64,
}

impl Weather {
    /// The values at the end of a step, or their means over it, in the order of [`SIGNALS`]; `None` beyond the
    /// records. A step without length has the values at its time.
    pub(crate) fn values(
        &self,
        step: (Time, Time),
        near: &mut Option<Interval>,
    ) -> Option<[f64; SIGNALS.len()]> {
        let unix = |time: Time| self.start_unix_ns.saturating_add(time.0);
        let (from_ns, to_ns) = (unix(step.0), unix(step.1));
        let number = |at_ns: i64| self.records.number(at_ns);
        let first = number(from_ns);
        let last = if to_ns > from_ns { number(to_ns - 1) } else { first };
        let mut sums = [0.0; 3];
        for number in first..=last {
            let interval = self.interval(number, near)?;
            let part = interval.within(from_ns, to_ns);
            for (sum, value) in sums.iter_mut().zip(interval.irradiances(part)) {
                // A part without length has its values.
                let seconds = if to_ns > from_ns { part.1 - part.0 } else { 1.0 };
                *sum += value * seconds;
            }
        }
        let interval = self.interval(last, near)?;
        let step_s = if to_ns > from_ns { seconds(to_ns - from_ns) } else { 1.0 };
        let end_s = seconds(to_ns - interval.begin_ns);
        let mut values = [0.0; SIGNALS.len()];
        for (value, (begin, end)) in values.iter_mut().zip(interval.lines) {
            *value = begin + (end - begin) * (end_s / interval.length_s);
        }
        for (value, sum) in values[GLOBAL..=BEAM].iter_mut().zip(sums) {
            *value = sum / step_s;
        }
        if let Some(sun) = interval.sun {
            let to_s = end_s - 0.5 * interval.length_s;
            let from_s = to_s - seconds(to_ns - from_ns);
            let position = sun.path.position(sun.path.middle_s(from_s, to_s));
            values[BEAM + 1] = position.elevation_rad;
            values[BEAM + 2] = position.azimuth_rad;
        }
        Some(values)
    }

    /// Leaves the signals that something else drives.
    pub(crate) fn leave(&mut self, driven: impl Fn(SignalId) -> bool) {
        for signal in &mut self.signals {
            *signal = signal.filter(|signal| !driven(*signal));
        }
    }

    fn interval<'a>(&self, number: i64, near: &'a mut Option<Interval>) -> Option<&'a Interval> {
        if near.is_none_or(|near| near.number != number) {
            *near = Some(Interval::new(&self.records, number)?);
        }
        near.as_ref()
    }
}

fn seconds(ns: i64) -> f64 {
    ns as f64 / NS_PER_S as f64
}

impl Interval {
    fn new(records: &Records, number: i64) -> Option<Self> {
        let record = records.record(number)?;
        let [before, after] = records.points_around(number, record);
        let length_s = seconds(records.interval_ns());
        let begin_ns = records.begin_ns(number);
        let line = |values: &Option<Box<[f64]>>| {
            values.as_ref().map_or((0.0, 0.0), |values| (values[before], values[after]))
        };
        let means =
            records.irradiance.as_ref().map_or([0.0; 3], |irradiance| irradiance.at(record));
        let sun = records.location.map(|location| {
            Sun::new(location, seconds(begin_ns) + 0.5 * length_s, length_s, means)
        });
        Some(Self {
            number,
            begin_ns,
            length_s,
            lines: [
                (records.t_outdoor_k[before], records.t_outdoor_k[after]),
                line(&records.relative_humidity),
                line(&records.wind_m_s),
            ],
            means,
            sun,
        })
    }

    /// The part of a span that lies in it, s from its begin.
    fn within(&self, from_ns: i64, to_ns: i64) -> (f64, f64) {
        let from_s = seconds(from_ns - self.begin_ns).max(0.0);
        (from_s, seconds(to_ns - self.begin_ns).min(self.length_s))
    }

    /// Means of global, diffuse and beam irradiance over a part; the values of a part without length.
    fn irradiances(&self, (from_s, to_s): (f64, f64)) -> [f64; 3] {
        let [global, diffuse, beam] = self.means;
        let Some(sun) = self.sun else { return self.means };
        if self.means == [0.0; 3] {
            return self.means;
        }
        let (from_s, to_s) = (from_s - 0.5 * self.length_s, to_s - 0.5 * self.length_s);
        let span_s = to_s - from_s;
        let (sine, sunshine) = if span_s > 0.0 {
            (sun.path.sine_s(from_s, to_s) / span_s, sun.path.sunshine_s(from_s, to_s) / span_s)
        } else {
            let sine = sun.path.position(from_s).elevation_rad.sin().max(0.0);
            (sine, if sine > 0.0 { 1.0 } else { 0.0 })
        };
        let of_mean = |now: f64, whole_s: f64| {
            if whole_s > 0.0 { now * self.length_s / whole_s } else { 1.0 }
        };
        let (by_sine, by_sun) = (of_mean(sine, sun.sine_s), of_mean(sunshine, sun.sunshine_s));
        [global * by_sine, diffuse * by_sine, beam * by_sun]
    }
}

impl Sun {
    fn new(location: Location, middle_s: f64, length_s: f64, means: [f64; 3]) -> Self {
        let path = location.path(middle_s);
        let (from_s, to_s) = (-0.5 * length_s, 0.5 * length_s);
        let [global, diffuse, beam] = means;
        let possible = |mean: f64, whole_s: f64| mean * length_s <= SOLAR_CONSTANT_W_M2 * whole_s;
        let sine_s = path.sine_s(from_s, to_s);
        let sunshine_s = path.sunshine_s(from_s, to_s);
        Self {
            path,
            sine_s: if possible(global.max(diffuse), sine_s) { sine_s } else { 0.0 },
            sunshine_s: if possible(beam, sunshine_s) { sunshine_s } else { 0.0 },
        }
    }
}

#[cfg(test)]
mod tests;
