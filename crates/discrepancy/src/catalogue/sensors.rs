//! Effects of sensors, and of what is known of a run at its beginning.

use super::Candidate;
use super::tolerance::Known;
use super::units::at_outlet;
use crate::experiment::Experiment;
use crate::sensors::{Class, Role, Sensor};
use crate::uncertainty::{interval_s, jitter_s};
use crate::unknown::{Target, Unknown};

/// A temperature may drift or jump by so much (95 %), K.
const DRIFT_K: f64 = 5.0;
/// A drift or a jump below this is rather one of the model: heat that is off by half a percent warms a storage by as much in hours, K.
const LEAST_DRIFT_K: f64 = 0.4;
/// Offset of a flow meter (95 %) and its least tolerance, over its largest reading.
const ZERO: (f64, f64) = (0.03, 0.001);
/// A meter may drop to zero in this share of its readings, whatever its offset.
const DROPS: f64 = 0.01;
/// What the first readings may say too little of the water at the start, at least, K.
const FIRST_K: f64 = 0.3;

/// Time constant of a sensor beyond the one that is known, s: small ones cannot be told from how a front is smeared.
pub(crate) const LAG_S: f64 = 1.5;
/// The time constant that is known is right to this share at most.
const LAG: f64 = 0.2;
/// Time constant beyond the one that is known, standard deviation, s; at the outlet of a generator with that of its metal and water.
fn unknown_lag_s(experiment: &Experiment, i: usize) -> f64 {
    let sensor = &experiment.sensors.sensor[i];
    let known_s = LAG * sensor.lag_s / 3.0_f64.sqrt();
    let more_s =
        if at_outlet(experiment, sensor) { Known::of(experiment).outlet_lag_s } else { 0.0 };
    LAG_S.hypot(known_s).hypot(more_s)
}

/// The slowest that a sensor of its kind may be, s: on a wall, in a pocket, in the stream.
fn slowest_s(sensor: &Sensor) -> f64 {
    match (sensor.class, sensor.si().as_str()) {
        (Class::Surface, _) => 180.0,
        (_, "k") => 90.0,
        _ => 60.0,
    }
}

/// The sensors of every clock but that of the (first of the) inputs, to which all others are relative.
fn loggers(experiment: &Experiment) -> Vec<Vec<usize>> {
    let sensors = &experiment.sensors.sensor;
    let reference = sensors.iter().find(|s| s.role == Role::Input).map(|s| s.clock.as_str());
    let mut loggers: Vec<Vec<usize>> = Vec::new();
    for (i, sensor) in sensors.iter().enumerate() {
        if reference == Some(sensor.clock.as_str()) {
            continue;
        }
        match loggers.iter_mut().find(|logger| experiment.share_clock(logger[0], i)) {
            Some(logger) => logger.push(i),
            None => loggers.push(vec![i]),
        }
    }
    loggers
}

/// Tolerance of a logger's clock, s: one interval, equally distributed.
fn logger_s(experiment: &Experiment, logger: &[usize]) -> f64 {
    let tracks = experiment.runs.iter().flat_map(|run| logger.iter().map(|&i| &run.tracks[i]));
    tracks.map(interval_s).fold(0.0, f64::max) / 3.0_f64.sqrt()
}

/// Tolerance of the moment at which a sensor is read, s, beside that of its logger; what happens within a step has no moment.
fn moment_s(experiment: &Experiment, sensor: usize) -> f64 {
    let jitters = experiment.runs.iter().map(|run| jitter_s(&run.tracks[sensor]));
    jitters.fold(0.0, f64::max).hypot(experiment.step.as_s() / 12.0_f64.sqrt())
}

pub(super) fn tolerances(experiment: &Experiment, all: &mut Vec<Unknown>) {
    for (i, accuracy) in experiment.accuracy.iter().enumerate() {
        // Only a class states limits.
        let is_classed = experiment.sensors.sensor[i].class != Class::Unknown;
        if accuracy.bias > 0.0 {
            all.push(Unknown::plain(Target::Bias(i), 0.0, accuracy.bias).limited(is_classed));
        }
        if accuracy.gain > 0.0 {
            all.push(Unknown::plain(Target::Gain(i), 1.0, accuracy.gain).limited(is_classed));
        }
        if experiment.sensors.sensor[i].role == Role::Compare {
            all.push(Unknown::plain(Target::Clock(i), 0.0, moment_s(experiment, i)));
            all.push(Unknown::plain(Target::Lag(i), 0.0, unknown_lag_s(experiment, i)));
        } else if experiment.sensors.sensor[i].si() == "k" {
            // So small a lag shifts fronts: those of two inputs against each other too.
            all.push(Unknown::plain(Target::Clock(i), 0.0, LAG_S));
        }
    }
    for logger in loggers(experiment) {
        let sd = logger_s(experiment, &logger);
        all.push(Unknown::plain(Target::Logger(logger[0]), 0.0, sd));
    }
    for run in 0..experiment.runs.len() {
        if let Some(first) = experiment.first(run) {
            all.push(Unknown::plain(Target::Initial(run), 0.0, first.far_k.max(FIRST_K)));
        }
    }
}

/// The largest zero offset that readings allow, SI: a meter that shows no flow backward reads no less than it, but for [`DROPS`]. Of a
/// compared one they say themselves what they allow.
fn largest_offset(experiment: &Experiment, i: usize) -> f64 {
    if experiment.sensors.sensor[i].role == Role::Compare || !experiment.one_way[i] {
        return f64::INFINITY;
    }
    let readings = experiment.runs.iter().flat_map(|run| &run.tracks[i].value);
    let mut readings: Vec<f64> = readings.copied().collect();
    readings.sort_by(f64::total_cmp);
    let least = readings.get((DROPS * readings.len() as f64) as usize);
    least.map_or(f64::INFINITY, |least| least + experiment.accuracy[i].noise)
}

pub(super) fn candidates(experiment: &Experiment, all: &mut Vec<Candidate>) {
    let loggers = loggers(experiment);
    for (i, sensor) in experiment.sensors.sensor.iter().enumerate() {
        let accuracy = experiment.accuracy[i];
        let mut with = |id, words, parameter, unknown, beside, tolerance, separates| {
            let component = sensor.column.clone();
            all.push(Candidate {
                id,
                component,
                words,
                parameter,
                unknown,
                beside,
                tolerance,
                most: if id == "S8" { largest_offset(experiment, i) } else { f64::INFINITY },
                separates,
            });
        };
        let flow = match sensor.si().as_str() {
            "kg_s" => Some("offset_kg_s"),
            "m3_s" => Some("offset_m3_s"),
            _ => None,
        };
        if sensor.si() == "k" {
            // Two of these are what its class permits (root of 3 times the standard deviation of its offset).
            let permitted_k = 3.0_f64.sqrt() * accuracy.bias;
            let known = Some((0.0, 0.5 * permitted_k.max(LEAST_DRIFT_K)));
            let reference = "a reference beside the sensor";
            let drift = Unknown::plain(Target::Drift(i), 0.0, DRIFT_K / 1.96);
            with(
                "S3",
                "drift of the sensor",
                ("drift_k", "K"),
                drift,
                Vec::new(),
                known,
                reference,
            );
            // A jump may be anywhere: three beginnings.
            for share in [0.25, 0.5, 0.75] {
                let jump = Unknown::plain(Target::Step(i), 0.0, DRIFT_K / 1.96);
                let moment = Unknown::plain(Target::StepShare(i), 0.5, 0.3).starting_at(share);
                let words = "jump of the sensor";
                with("S3", words, ("step_k", "K"), jump, vec![moment], known, reference);
            }
        }
        if let Some(field) = flow {
            let readings = experiment.runs.iter().flat_map(|run| &run.tracks[i].value);
            let largest = readings.fold(0.0_f64, |most, y| most.max(y.abs()));
            let unit = if field == "offset_kg_s" { "kg/s" } else { "m3/s" };
            let offset = Unknown::plain(Target::Bias(i), 0.0, ZERO.0 * largest / 1.96);
            let known = Some((0.0, accuracy.bias.max(ZERO.1 * largest)));
            let separates = "the reading behind a closed valve";
            let words = "zero offset of the flow meter";
            with("S8", words, (field, unit), offset, Vec::new(), known, separates);
        }
        let mut add = |id, words, parameter, unknown, tolerance, separates| {
            with(id, words, parameter, unknown, Vec::new(), tolerance, separates);
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
            let logger = loggers.iter().find(|logger| logger.contains(&i));
            let of_logger = logger.map_or(0.0, |logger| logger_s(experiment, logger));
            let clock_s = of_logger.hypot(moment_s(experiment, i));
            add(
                "S4",
                "slow sensor",
                ("lag_s", "s"),
                Unknown::between(Target::Lag(i), 2.0, slowest_s(sensor)),
                None,
                "two flow rates: the lag of a sensor is the same in both",
            );
            add(
                "S7",
                "clock of the sensor",
                ("clock_s", "s"),
                Unknown::plain(Target::Clock(i), 0.0, 60.0 / 1.96),
                Some((0.0, clock_s)),
                "two flow rates: the shift of a clock is the same in both",
            );
        }
    }
}
