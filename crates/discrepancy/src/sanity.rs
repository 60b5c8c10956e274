//! Data that cannot be what they claim to be, before anything is fitted to them.

use crate::data::{Run, Track};
use crate::experiment::Experiment;
use crate::sensors::{Role, Sensor};
use crate::unknown::{Target, Unknown};

mod clocks;
mod exchanged;
mod misfit;

/// Fewest readings over those of the best column.
const LEAST_SHARE: f64 = 0.1;
/// Readings from which on a constant column is suspicious.
const MANY: usize = 20;
/// Temperatures of water in a network, K.
const COLDEST_K: f64 = 230.0;
const HOTTEST_K: f64 = 480.0;
/// A unit is confused where the ratio of reading and simulation is this near a factor of units, relative.
const NEAR_FACTOR: f64 = 0.05;
/// Another unit must reduce the squared residuals to this share.
const FAR_BETTER: f64 = 0.1;
/// An input may lie outside of the range of its signal by so many standard deviations of the noise, and of offset and gain.
const NOISES: f64 = 5.0;
const BIASES: f64 = 3.0;
/// Misfit ([`misfit`]) that another unit may leave.
const FITS: f64 = 3.0;
/// Factors by which units are confused.
const FACTORS: &[(f64, &str)] = &[
    (3.6, "a factor of 3.6 (m3/h and l/s, kWh and MJ)"),
    (1.0 / 3.6, "a factor of 1/3.6 (l/s and m3/h, MJ and kWh)"),
    (1000.0, "a factor of 1000 (kW and W, m3 and l)"),
    (1e-3, "a factor of 1/1000 (W and kW, l and m3)"),
    (100.0, "a factor of 100 (bar and kPa, hPa and Pa)"),
    (0.01, "a factor of 1/100 (kPa and bar, Pa and hPa)"),
    (60.0, "a factor of 60 (minutes and seconds)"),
    (1.0 / 60.0, "a factor of 1/60 (seconds and minutes)"),
    (3600.0, "a factor of 3600 (hours and seconds)"),
    (1.0 / 3600.0, "a factor of 1/3600 (seconds and hours)"),
    (-1.0, "the sign"),
];
/// Factors by which those of shares are confused: commands, modulations.
const SHARES: &[(f64, &str)] = &[
    (100.0, "a factor of 100 (a share and percent)"),
    (0.01, "a factor of 1/100 (percent and a share)"),
];

/// Factors by which the unit of a sensor may be confused.
fn factors(sensor: &Sensor) -> &'static [(f64, &'static str)] {
    if sensor.si() == "1" { SHARES } else { FACTORS }
}

/// What is wrong with the data by themselves.
pub fn of_data(experiment: &Experiment) -> Vec<String> {
    let mut problems = Vec::new();
    let sensors = &experiment.sensors.sensor;
    for run in &experiment.runs {
        let of = of_run(run);
        let most = run.tracks.iter().map(|track| track.value.len()).max().unwrap_or(0);
        let all = run.tracks.iter().zip(sensors).enumerate();
        for (k, (track, sensor)) in all.filter(|(_, (track, _))| !track.value.is_empty()) {
            let column = &sensor.column;
            let count = track.value.len();
            if (count as f64) < LEAST_SHARE * most as f64 {
                problems.push(format!(
                    "column \"{column}\"{of} has {count} readings where others have {most}"
                ));
            }
            let constant = track.value.iter().all(|y| *y == track.value[0]);
            if sensor.role == Role::Compare && count >= MANY && constant {
                problems.push(format!("column \"{column}\"{of} never changes: a stuck sensor?"));
            }
            problems.extend(outside(experiment, &of, k, track));
            let odd = |y: &&f64| !(COLDEST_K..=HOTTEST_K).contains(*y);
            if sensor.si() == "k"
                && let Some(y) = track.value.iter().find(odd)
            {
                let reading = sensor.of_si(*y);
                let unit = &sensor.unit;
                problems.push(format!(
                    "column \"{column}\"{of} reads {reading:.1} {unit}: K and degC confused?"
                ));
            }
        }
        for i in 0..sensors.len() {
            for j in 0..i {
                let (a, b) = (&run.tracks[i], &run.tracks[j]);
                let varies = a.value.iter().any(|y| *y != a.value[0]);
                if sensors[i].column != sensors[j].column
                    && varies
                    && a.value.len() >= MANY
                    && a == b
                {
                    let (a, b) = (&sensors[j].column, &sensors[i].column);
                    problems.push(format!(
                        "columns \"{a}\" and \"{b}\"{of} are the same, reading for reading"
                    ));
                }
            }
        }
    }
    problems
}

/// A reading of an input that its signal cannot have, by more than the accuracy of the sensor allows.
fn outside(experiment: &Experiment, of: &str, k: usize, track: &Track) -> Option<String> {
    let (sensor, accuracy) = (&experiment.sensors.sensor[k], experiment.accuracy[k]);
    let (low, high) = experiment.ranges[k];
    let allowed =
        |y: f64| NOISES * accuracy.noise + BIASES * (accuracy.bias + accuracy.gain * y.abs());
    let is_out = |y: &f64| *y < low - allowed(*y) || *y > high + allowed(*y);
    let at = track.value.iter().position(is_out)?;
    let (column, unit, signal) = (&sensor.column, &sensor.unit, &sensor.signal);
    let [y, low, high] = [track.value[at], low, high].map(|y| sensor.of_si(y));
    let time_s = track.time_s[at];
    let hint = if high == 1.0 && (1.5..=100.0).contains(&y) { ": in percent?" } else { "" };
    Some(format!(
        "column \"{column}\"{of} reads {y} {unit} at {time_s} s, and {signal} lies between {low} and {high} {unit}{hint}"
    ))
}

/// What is wrong with the data beside the simulation: units, signs, exchanged columns.
pub fn beside(experiment: &Experiment, readings: &[f64], sigma: &[f64]) -> Vec<String> {
    let mut problems = Vec::new();
    let sensors = &experiment.sensors.sensor;
    let of = |sensor: usize| -> Vec<usize> {
        (0..readings.len()).filter(|&i| experiment.samples[i].sensor == sensor).collect()
    };
    for (k, sensor) in sensors.iter().enumerate() {
        let own = of(k);
        if own.is_empty() || sensor.si() == "k" {
            continue;
        }
        let (mut products, mut squares, mut total) = (0.0, 0.0, 0.0);
        for &i in &own {
            products += experiment.samples[i].value * readings[i];
            squares += readings[i] * readings[i];
            total += experiment.samples[i].value.powi(2);
        }
        let ratio = products / squares;
        let alike = products.powi(2) / (squares * total) > 0.9;
        for (factor, words) in factors(sensor) {
            if alike && (ratio / factor - 1.0).abs() < NEAR_FACTOR {
                let column = &sensor.column;
                problems.push(format!(
                    "column \"{column}\" differs from the simulation by {words}: check its unit"
                ));
            }
        }
    }
    problems.extend(units_of_inputs(experiment, readings, sigma));
    // What a unit explains needs no other explanation.
    if problems.is_empty() {
        problems.extend(exchanged::exchanged(experiment, readings));
    }
    if problems.is_empty() {
        problems.extend(clocks::jumps(experiment, readings));
    }
    problems
}

/// Why the model does not run with its inputs: a unit with which it does, and fits.
pub fn keeps_from_running(experiment: &Experiment) -> Vec<String> {
    let mut problems = Vec::new();
    for (i, sensor) in experiment.sensors.sensor.iter().enumerate() {
        if sensor.role != Role::Input || sensor.si() == "k" {
            continue;
        }
        let gain = [Unknown::plain(Target::Gain(i), 1.0, 1.0)];
        let runs = |(factor, _): &&(f64, &str)| {
            let readings = experiment.readings(&gain, &[*factor]);
            readings.is_ok_and(|y| exchanged::misfit(experiment, &y) < FITS)
        };
        if let Some((_, words)) = factors(sensor).iter().find(runs) {
            let column = &sensor.column;
            problems.push(format!(
                "the model does not run with column \"{column}\" as it is, and fits with {words}: check its unit"
            ));
        }
    }
    problems
}

/// Inputs that fit far better in another unit.
fn units_of_inputs(experiment: &Experiment, readings: &[f64], sigma: &[f64]) -> Vec<String> {
    let misfit = |readings: &[f64]| -> f64 {
        let samples = experiment.samples.iter().zip(readings).zip(sigma);
        samples.map(|((sample, y), sigma)| ((sample.value - y) / sigma).powi(2)).sum()
    };
    let as_is = misfit(readings);
    if as_is < 10.0 * readings.len() as f64 {
        return Vec::new();
    }
    let mut problems = Vec::new();
    for (i, sensor) in experiment.sensors.sensor.iter().enumerate() {
        if sensor.role != Role::Input || sensor.si() == "k" {
            continue;
        }
        let gain = [Unknown::plain(Target::Gain(i), 1.0, 1.0)];
        // A pump that does nothing in percent takes away a gap of another one, and still fits nothing.
        let other = |(factor, _): &&(f64, &str)| {
            let fits = |y: &Vec<f64>| exchanged::misfit(experiment, y) < FITS;
            experiment
                .readings(&gain, &[*factor])
                .is_ok_and(|y| misfit(&y) < FAR_BETTER * as_is && fits(&y))
        };
        if let Some((_, words)) = factors(sensor).iter().find(other) {
            let column = &sensor.column;
            problems
                .push(format!("column \"{column}\" fits far better with {words}: check its unit"));
        }
    }
    problems
}

fn of_run(run: &Run) -> String {
    if run.name.is_empty() { String::new() } else { format!(" of run \"{}\"", run.name) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensors::SensorFile;

    #[test]
    fn a_command_is_in_no_litres() {
        let of = |unit: &str| {
            let text = format!(
                "[[sensor]]\ncolumn = \"x\"\nsignal = \"p.x\"\nunit = \"{unit}\"\nrole = \"compare\"\n"
            );
            let sensors = SensorFile::from_toml(&text).unwrap();
            factors(&sensors.sensor[0]).iter().map(|(factor, _)| *factor).collect::<Vec<f64>>()
        };
        // A weak pump was told to have a speed in l/s.
        assert_eq!(of("1"), [100.0, 0.01]);
        assert_eq!(of("percent"), [100.0, 0.01]);
        assert!(of("l_h").contains(&(1.0 / 3.6)));
    }
}
