//! Measured inputs as what drives the model.
//!
//! **Equation** a step takes the quantity behind the readings at its middle: `x = y + lag dy/dt` behind a first-order lag, then
//! the response of the sensor backwards ([`Response`]), within the range of the signal. The slope is that of a straight line through
//! the readings within half a lag (at least those beside): what entered is known no more sharply than that, and its noise grows
//! by about `sqrt(1 + 12 interval/lag)`, at most 2.6 times.
//!
//! **Validity** a flow that never reads below zero stays there; what a reading cannot have been (a speed of -0.0001) is the end of
//! the range. A command is off within five standard deviations of the lower end of its range; it is switched in the middle between two
//! readings, as early as late. So is a flow that only runs forward, unless one of the readings was taken on its way: as much flows as
//! with a straight line, and a pause is neither too short nor too long.

use crate::data::{Run, Track};
use crate::response::Response;
use crate::sensors::{Accuracy, Role, Sensor, SensorFile};
use crate::uncertainty::on_its_way;
use anergy_core::clock::Time;
use anergy_simulation::model::{DriverSpec, Place};
use anergy_simulation::model_file::Interpolation;

/// Two readings further apart than this, in usual intervals, are not neighbours.
const APART: f64 = 2.5;
/// A command is off so many standard deviations of its noise above the lower end of its range.
const OFF: f64 = 5.0;
/// A flow meter with an offset reads it as exactly as so many standard deviations of its noise.
const STILL: f64 = 3.0;

/// Runs in which a command that reads nothing but its noise reads the lower end of its range.
pub(crate) fn off_is_off(
    mut runs: Vec<Run>,
    sensors: &SensorFile,
    ranges: &[(f64, f64)],
    accuracy: &[Accuracy],
) -> Vec<Run> {
    for (i, sensor) in sensors.sensor.iter().enumerate() {
        if sensor.role == Role::Input && sensor.si() == "1" {
            let (off, _) = ranges[i];
            let is_off = |y: f64| y < off + OFF * accuracy[i].noise;
            let values = runs.iter_mut().flat_map(|run| &mut run.tracks[i].value);
            values.filter(|y| is_off(**y)).for_each(|y| *y = off);
        }
    }
    runs
}

/// A measured input.
pub(crate) struct Input<'a> {
    /// Its sensor.
    pub sensor: &'a Sensor,
    /// Its readings, SI.
    pub track: &'a Track,
    /// What the sensor makes of its quantity.
    pub response: &'a Response,
    /// Smallest and largest value of the signal.
    pub range: (f64, f64),
    /// Standard deviation of the noise of a reading, SI.
    pub noise: f64,
}

impl Input<'_> {
    /// What drives the signal in so many steps of a run.
    pub(crate) fn driver(&self, span_s: (f64, f64), step: Time, rows: usize) -> DriverSpec {
        let (sensor, response) = (self.sensor, self.response);
        let is_flow = ["kg_s", "m3_s"].contains(&sensor.si().as_str());
        let forward = is_flow && self.track.value.iter().all(|y| *y >= 0.0);
        let mut ahead = before_lag(self.track, sensor.lag_s + response.lag_s);
        if forward {
            ahead.value.iter_mut().for_each(|y| *y = y.max(0.0));
        }
        let smooth = (sensor.si() == "k").then(|| ahead.usual_bend());
        let measured = |k: usize| {
            let time_s = span_s.0 + (k as f64 - 0.5).max(0.0) * step.as_s() - response.clock_s;
            let reading = if let Some(usually) = smooth {
                ahead.smooth_at(time_s, usually)
            } else if sensor.si() == "1" {
                let off = self.range.0 + OFF * self.noise;
                switched(&ahead, time_s, self.range.0, |y| y < off, |_| false)
            } else if forward {
                let still = self.still(response.offset(time_s, span_s));
                let on_its_way = |i| on_its_way(&self.track.value, i);
                switched(&ahead, time_s, 0.0, |y| y <= still, on_its_way)
            } else {
                ahead.at(time_s)
            };
            // A flow meter that reads nothing has cut off a flow too small for it.
            if is_flow && (self.track.at(time_s) == 0.0 || forward && reading == 0.0) {
                0.0
            } else {
                response.before(reading, time_s, span_s).clamp(self.range.0, self.range.1)
            }
        };
        DriverSpec {
            signal: sensor.signal.as_str().into(),
            unit: None,
            interpolation: Interpolation::Linear,
            times_s: (0..=rows).map(|k| k as f64 * step.as_s()).collect(),
            values: (0..=rows).map(measured).collect(),
            source: sensor.column.as_str().into(),
            place: Place::default(),
        }
    }

    /// What a meter of forward flow reads at most while nothing flows: nothing, or its offset as far as noise blurs it.
    fn still(&self, offset: f64) -> f64 {
        offset.max(0.0) + (STILL * self.noise).min(offset.max(0.0))
    }
}

/// What is off or on at a time: linear, but from off to on at one moment in the middle between two readings, unless it was read
/// `on_its_way`; `zero` where it is off.
fn switched(
    track: &Track,
    time_s: f64,
    zero: f64,
    is_off: impl Fn(f64) -> bool,
    on_its_way: impl Fn(usize) -> bool,
) -> f64 {
    let (t, y) = (&track.time_s, &track.value);
    let i = t.partition_point(|t| *t <= time_s);
    let reading = track.at(time_s);
    let held = if i > 0 && i < t.len() && is_off(y[i - 1]) != is_off(y[i]) && !on_its_way(i) {
        if 2.0 * time_s < t[i - 1] + t[i] { y[i - 1] } else { y[i] }
    } else {
        reading
    };
    if is_off(held) { zero } else { held }
}

/// The quantity in front of a first-order lag.
pub(crate) fn before_lag(track: &Track, lag_s: f64) -> Track {
    let (t, y) = (&track.time_s, &track.value);
    if lag_s <= 0.0 || t.len() < 2 {
        return track.clone();
    }
    let usual_s = crate::uncertainty::interval_s(track);
    let (mut first, mut last) = (0, 0);
    let one = |i: usize| {
        // Readings within half a lag, and those beside, but none beyond a gap.
        while t[first] < t[i] - 0.5 * lag_s {
            first += 1;
        }
        while last + 1 < t.len() && t[last + 1] <= t[i] + 0.5 * lag_s {
            last += 1;
        }
        let (mut from, mut until) = (i, i);
        while from > 0 && from > first.min(i - 1) && t[from] - t[from - 1] < APART * usual_s {
            from -= 1;
        }
        while until + 1 < t.len()
            && until < last.max(i + 1)
            && t[until + 1] - t[until] < APART * usual_s
        {
            until += 1;
        }
        y[i] + lag_s * slope(&t[from..=until], &y[from..=until])
    };
    let value = (0..t.len()).map(one).collect();
    Track { time_s: t.clone(), value }
}

/// Slope of the straight line through some points; none where there is but one.
fn slope(t: &[f64], y: &[f64]) -> f64 {
    let n = t.len() as f64;
    let (middle, mean) = (t.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let along: f64 = t.iter().zip(y).map(|(t, y)| (t - middle) * (y - mean)).sum();
    let size: f64 = t.iter().map(|t| (t - middle).powi(2)).sum();
    if size > 0.0 { along / size } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::lagged;
    use crate::sensors::SensorFile;

    fn track(n: i32, value: impl Fn(f64) -> f64) -> Track {
        let time_s: Vec<f64> = (0..n).map(f64::from).collect();
        Track { value: time_s.iter().map(|t| value(*t)).collect(), time_s }
    }

    #[test]
    fn what_entered_is_found_in_front_of_a_lag() {
        // A ramp of 1 K/s behind 10 s lies 10 K behind once exp(-t/10) is gone; in front of it it is back.
        let behind = lagged(&track(200, |t| t), 10.0);
        assert!((behind.value[150] - 140.0).abs() < 1e-3);
        let ahead = before_lag(&behind, 10.0);
        assert!((ahead.value[150] - 150.0).abs() < 1e-3, "{}", ahead.value[150]);
        // A step: 10 s later the lagged one has 63 %; in front of the lag it has all of it, blurred by half a lag.
        let behind = lagged(&track(200, |t| if t < 100.0 { 0.0 } else { 1.0 }), 10.0);
        let ahead = before_lag(&behind, 10.0);
        assert!((behind.value[109] - 0.63).abs() < 0.03, "{}", behind.value[109]);
        assert!(ahead.value[94].abs() < 1e-9 && (ahead.value[106] - 1.0).abs() < 0.02);
        assert_eq!(before_lag(&behind, 0.0), behind);
    }

    #[test]
    fn a_gap_gives_no_slope() {
        let mut gap = track(100, |t| if t < 50.0 { 0.0 } else { 100.0 });
        gap.time_s.iter_mut().skip(50).for_each(|t| *t += 100.0);
        assert_eq!(before_lag(&gap, 20.0), gap);
    }

    #[test]
    fn inputs_stay_within_the_range_of_their_signal() {
        let text = "[[sensor]]\ncolumn = \"n\"\nsignal = \"p.speed\"\nunit = \"1\"\nrole = \"input\"\n\
                    [[sensor]]\ncolumn = \"T\"\nsignal = \"b.t_k\"\nunit = \"degC\"\nrole = \"compare\"\n";
        let file = SensorFile::from_toml(text).unwrap();
        let noisy = track(10, |t| if t < 5.0 { -0.000_125 } else { 1.000_3 });
        let response = Response::default();
        let (sensor, track, range) = (&file.sensor[0], &noisy, (0.0, 1.0));
        let input = Input { sensor, track, response: &response, range, noise: 1e-3 };
        let driver = input.driver((0.0, 9.0), Time::from_s(1.0).unwrap(), 9);
        assert_eq!((driver.values[1], driver.values[9]), (0.0, 1.0));
        // From off to on between 4 and 5 s: at one moment.
        let halves = input.driver((0.0, 9.0), Time::from_s(0.25).unwrap(), 36);
        assert!(halves.values.iter().all(|v| [0.0, 1.0].contains(v)), "{:?}", halves.values);
    }

    #[test]
    fn a_command_that_reads_its_noise_is_off() {
        let text = "[[sensor]]\ncolumn = \"n\"\nsignal = \"p.speed\"\nunit = \"1\"\nrole = \"input\"\n\
                    [[sensor]]\ncolumn = \"T\"\nsignal = \"b.t_k\"\nunit = \"degC\"\nrole = \"compare\"\n";
        let sensors = SensorFile::from_toml(text).unwrap();
        let value = vec![0.9, 0.002, 0.0, 0.004, 0.006, 0.9];
        let track = Track { time_s: (0..6).map(f64::from).collect(), value };
        let tracks = vec![track.clone(), track.clone()];
        let runs = vec![Run { name: String::new(), tracks, span_s: (0.0, 5.0) }];
        let accuracy = [Accuracy { noise: 1e-3, ..sensors.sensor[0].accuracy(0.5, 0.9) }; 2];
        let runs = off_is_off(runs, &sensors, &[(0.0, 1.0); 2], &accuracy);
        assert_eq!(runs[0].tracks[0].value, [0.9, 0.0, 0.0, 0.0, 0.006, 0.9]);
        // A temperature is as it is read.
        assert_eq!(runs[0].tracks[1], track);
    }

    #[test]
    fn a_pause_of_a_flow_is_as_long_as_its_readings_say() {
        use crate::unknown::Target;
        let text = "[[sensor]]\ncolumn = \"m\"\nsignal = \"a.m_flow_kg_s\"\nunit = \"kg_s\"\nrole = \"input\"\n\
                    [[sensor]]\ncolumn = \"T\"\nsignal = \"b.t_k\"\nunit = \"degC\"\nrole = \"compare\"\n";
        let file = SensorFile::from_toml(text).unwrap();
        let range = (f64::NEG_INFINITY, f64::INFINITY);
        // A reading every 10 s, none while nothing flows: at 30, 40 and 50 s.
        let every_10 = |zero: f64| Track {
            time_s: (0..10).map(|k| 10.0 * f64::from(k)).collect(),
            value: (0..10).map(|k| if (3..6).contains(&k) { zero } else { 1.0 + zero }).collect(),
        };
        let still = |track: &Track, response: &Response| {
            let input = Input { sensor: &file.sensor[0], track, response, range, noise: 0.01 };
            let driver = input.driver((0.0, 90.0), Time::from_s(1.0).unwrap(), 90);
            driver.values.iter().filter(|m| **m == 0.0).count()
        };
        // From 25 to 55 s.
        assert_eq!(still(&every_10(0.0), &Response::default()), 30);
        // The same with an offset of 0.05, whose noise of 0.01 is none of the water; 0.03 beside it is.
        let mut response = Response::default();
        response.take(&Target::Bias(0), 0.05);
        let mut noisy = every_10(0.05);
        noisy.value[4] = 0.07;
        assert_eq!(still(&noisy, &response), 30);
        noisy.value[4] = 0.1;
        assert!(still(&noisy, &response) < 25);
        // Read on its way down it stops where it was read: from 30 to 55 s.
        let mut ramp = every_10(0.0);
        ramp.value[2] = 0.5;
        assert_eq!(still(&ramp, &Response::default()), 25);
    }

    #[test]
    fn a_step_takes_what_was_in_front_of_the_sensor() {
        use crate::unknown::Target;
        let text = "[[sensor]]\ncolumn = \"m\"\nsignal = \"a.m_flow_kg_s\"\nunit = \"kg_s\"\nrole = \"input\"\n\
                    [[sensor]]\ncolumn = \"T\"\nsignal = \"b.t_k\"\nunit = \"degC\"\nrole = \"compare\"\n";
        let file = SensorFile::from_toml(text).unwrap();
        let sensor = &file.sensor[0];
        // It reads 10 % and 0.1 kg/s too much, 2 s early: y(t) = 1.1 x(t + 2) + 0.1.
        let mut response = Response::default();
        for (flaw, value) in
            [(Target::Gain(0), 1.1), (Target::Bias(0), 0.1), (Target::Clock(0), 2.0)]
        {
            response.take(&flaw, value);
        }
        let rising = track(30, |t| 1.0 + 0.01 * t);
        let range = (0.0, f64::INFINITY);
        let input = Input { sensor, track: &rising, response: &response, range, noise: 0.0 };
        let driver = input.driver((0.0, 29.0), Time::from_s(2.0).unwrap(), 14);
        // Fifth step, 8 to 10 s, its middle 9 s: read at 7 s, 1.07; (1.07 - 0.1)/1.1 = 0.8818.
        assert!((driver.values[5] - 0.881_818).abs() < 1e-6, "{}", driver.values[5]);
        // A meter that reads nothing has cut off: its offset does not flow.
        let still = track(30, |_| 0.0);
        let input = Input { track: &still, ..input };
        let driver = input.driver((0.0, 29.0), Time::from_s(2.0).unwrap(), 14);
        assert!(driver.values.iter().all(|m| *m == 0.0), "{:?}", driver.values);
        // What reads too much never drives backwards: (0.05 - 0.1)/1.1 < 0.
        let little = track(30, |_| 0.05);
        let input = Input { track: &little, ..input };
        assert_eq!(input.driver((0.0, 29.0), Time::from_s(2.0).unwrap(), 14).values[5], 0.0);
    }
}
