//! Effects of sensors, and of what is known of a run at its beginning.

use super::Candidate;
use crate::experiment::Experiment;
use crate::sensors::Role;
use crate::uncertainty::{interval_s, jitter_s};
use crate::unknown::{Target, Unknown};

/// What the first readings may say too little of the water at the start, at least, K.
const FIRST_K: f64 = 0.3;

/// Tolerance of a clock, s: one interval, equally distributed, where it is not that of the inputs; else the jitter.
fn clock_s(experiment: &Experiment, sensor: usize) -> f64 {
    let own = &experiment.sensors.sensor[sensor].clock;
    let mut inputs = experiment.sensors.sensor.iter().filter(|s| s.role == Role::Input);
    let tracks = experiment.runs.iter().map(|run| &run.tracks[sensor]);
    if inputs.any(|input| input.clock != *own) {
        tracks.map(interval_s).fold(0.0, f64::max) / 3.0_f64.sqrt()
    } else {
        tracks.map(jitter_s).fold(0.0, f64::max)
    }
}

pub(super) fn tolerances(experiment: &Experiment, all: &mut Vec<Unknown>) {
    for (i, accuracy) in experiment.accuracy.iter().enumerate() {
        if accuracy.bias > 0.0 {
            all.push(Unknown::plain(Target::Bias(i), 0.0, accuracy.bias));
        }
        if accuracy.gain > 0.0 {
            all.push(Unknown::plain(Target::Gain(i), 1.0, accuracy.gain));
        }
        if experiment.sensors.sensor[i].role == Role::Compare {
            all.push(Unknown::plain(Target::Clock(i), 0.0, clock_s(experiment, i)));
        }
    }
    for run in 0..experiment.runs.len() {
        if let Some((_, far_k)) = experiment.first_k(run) {
            all.push(Unknown::plain(Target::Initial(run), 0.0, far_k.max(FIRST_K)));
        }
    }
}

pub(super) fn candidates(experiment: &Experiment, all: &mut Vec<Candidate>) {
    for (i, sensor) in experiment.sensors.sensor.iter().enumerate() {
        let accuracy = experiment.accuracy[i];
        let mut add = |id, words, parameter, unknown, tolerance, separates| {
            let (component, beside) = (sensor.column.clone(), Vec::new());
            all.push(Candidate {
                id,
                component,
                words,
                parameter,
                unknown,
                beside,
                tolerance,
                separates,
            });
        };
        if sensor.si() == "k" {
            add(
                "S1",
                "offset of the sensor",
                ("bias_k", "K"),
                Unknown::plain(Target::Bias(i), 0.0, 5.0 / 1.96),
                Some((0.0, accuracy.bias)),
                "a comparison at standstill, when all sensors have one temperature",
            );
        } else {
            add(
                "S2",
                "gain of the sensor",
                ("gain", "1"),
                Unknown::plain(Target::Gain(i), 1.0, 0.2 / 1.96),
                Some((1.0, accuracy.gain.max(1e-3))),
                "a second meter of the same quantity",
            );
        }
        if sensor.role == Role::Compare {
            add(
                "S4",
                "slow sensor",
                ("lag_s", "s"),
                Unknown::between(Target::Lag(i), 2.0, 180.0),
                None,
                "two flow rates: the lag of a sensor is the same in both",
            );
            add(
                "S7",
                "clock of the sensor",
                ("clock_s", "s"),
                Unknown::plain(Target::Clock(i), 0.0, 60.0 / 1.96),
                Some((0.0, clock_s(experiment, i))),
                "two flow rates: the shift of a clock is the same in both",
            );
        }
    }
}
