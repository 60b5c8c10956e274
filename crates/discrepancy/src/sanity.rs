//! Data that cannot be what they claim to be, before anything is fitted to them.

use crate::data::Run;
use crate::experiment::Experiment;
use crate::sensors::Role;
use crate::unknown::{Target, Unknown};

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
const FAR_BETTER: f64 = 0.2;
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

/// What is wrong with the data by themselves.
pub fn of_data(experiment: &Experiment) -> Vec<String> {
    let mut problems = Vec::new();
    let sensors = &experiment.sensors.sensor;
    for run in &experiment.runs {
        let of = of_run(run);
        let most = run.tracks.iter().map(|track| track.value.len()).max().unwrap_or(0);
        for (track, sensor) in run.tracks.iter().zip(sensors) {
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
        for (factor, words) in FACTORS {
            if alike && (ratio / factor - 1.0).abs() < NEAR_FACTOR {
                let column = &sensor.column;
                problems.push(format!(
                    "column \"{column}\" differs from the simulation by {words}: check its unit"
                ));
            }
        }
    }
    problems.extend(units_of_inputs(experiment, readings, sigma));
    let misfit = |of_sensor: usize, as_sensor: usize| -> f64 {
        let (own, other) = (of(of_sensor), of(as_sensor));
        own.iter()
            .zip(&other)
            .map(|(&i, &j)| ((experiment.samples[j].value - readings[i]) / sigma[i]).powi(2))
            .sum()
    };
    for i in 0..sensors.len() {
        for j in 0..i {
            let (a, b) = (of(i), of(j));
            let alike = !a.is_empty() && a.len() == b.len() && sensors[i].si() == sensors[j].si();
            if alike {
                let (as_is, swapped) = (misfit(i, i) + misfit(j, j), misfit(i, j) + misfit(j, i));
                if as_is > 10.0 * swapped && as_is > 10.0 * (a.len() + b.len()) as f64 {
                    let (a, b) = (&sensors[j].column, &sensors[i].column);
                    problems.push(format!("columns \"{a}\" and \"{b}\" seem to be exchanged"));
                }
            }
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
        let other = |(factor, _): &&(f64, &str)| {
            experiment.readings(&gain, &[*factor]).is_ok_and(|y| misfit(&y) < FAR_BETTER * as_is)
        };
        if let Some((_, words)) = FACTORS.iter().filter(|(factor, _)| *factor > 0.0).find(other) {
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
