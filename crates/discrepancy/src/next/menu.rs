//! What could be measured beside: programs of the inputs, further sensors, sensors exchanged.

use super::{AGAIN, Rivals, of_new};
use crate::data::{Run, Track};
use crate::experiment::Experiment;
use crate::sensors::{Accuracy, Class, Role, Sensor, SensorFile};
use crate::trial::Tried;
use crate::uncertainty::interval_s;
use crate::unknown::{Target, Unknown};
use nalgebra::DMatrix;

/// Time without flow, s.
const HOLD_S: f64 = 1200.0;
/// Step of a temperature, K; over a time, s; and the temperature beyond which it goes down, K.
const STEP: (f64, f64, f64) = (15.0, 60.0, 358.15);
/// The share of the flow that is the second level.
const SECOND_LEVEL: f64 = 0.5;
/// Further sensors, at most.
const MOST_SENSORS: usize = 12;

/// An addition that can be simulated.
pub(super) struct Menu {
    pub(super) what: String,
    pub(super) experiment: Experiment,
    /// A sensor that another one replaces.
    exchanged: Option<usize>,
    /// Sensors from here on are new.
    first_new: usize,
}

#[derive(Clone, Copy, PartialEq)]
enum Program {
    Again,
    TwoFlows,
    Hold,
    Warmer,
}

/// The menu of a class.
pub(super) fn menu(rivals: &Rivals<'_>) -> Vec<Menu> {
    let experiment = rivals.experiment;
    let first_new = experiment.sensors.sensor.len();
    let entry = |what: &str, changed: Option<Experiment>, exchanged| {
        changed.map(|experiment| Menu { what: what.to_owned(), experiment, exchanged, first_new })
    };
    let program = |program| {
        let runs: Option<Vec<Run>> =
            experiment.runs.iter().map(|run| changed(experiment, run, program)).collect();
        Experiment::new(experiment.model.clone(), experiment.sensors.clone(), runs?).ok()
    };
    let mut menu = vec![
        entry(AGAIN, with_sensors(rivals), None),
        entry(
            "the same with half of the flow in its second half",
            program(Program::TwoFlows),
            None,
        ),
        entry("the same with 20 min without flow in its middle", program(Program::Hold), None),
        entry("the same, 15 K warmer or colder in its second half", program(Program::Warmer), None),
    ];
    let mut seen = Vec::new();
    for tried in &rivals.members {
        let candidate = &rivals.all[tried.candidates[0]];
        if let Some(sensor) = candidate.unknown.target.sensor().filter(|k| !seen.contains(k)) {
            seen.push(sensor);
            let what =
                format!("the same with another sensor in the place of {}", candidate.component);
            menu.push(entry(&what, program(Program::Again), Some(sensor)));
        }
    }
    menu.into_iter().flatten().collect()
}

impl Menu {
    /// New sensors and what it is to add them.
    pub(super) fn new_sensors(&self) -> impl Iterator<Item = (usize, String)> {
        let sensors = &self.experiment.sensors.sensor;
        (self.first_new..sensors.len()).map(|k| (k, format!("a sensor of {}", sensors[k].signal)))
    }

    /// The unknowns of a member and their values; those of new sensors in the middle of their class.
    pub(super) fn exchanged(
        &self,
        tried: &Tried,
        accuracy: &[Accuracy],
    ) -> (Vec<Unknown>, Vec<f64>) {
        let mut unknowns = Vec::new();
        let mut values = Vec::new();
        for (unknown, at) in tried.unknowns.iter().zip(&tried.fit.at) {
            match unknown.target.sensor().filter(|k| Some(*k) == self.exchanged) {
                None => {
                    unknowns.push(unknown.clone());
                    values.push(*at);
                }
                Some(k) => {
                    if let Some((mean, sd)) = of_new(&unknown.target, unknown, &accuracy[k]) {
                        unknowns.push(Unknown {
                            mean,
                            sd,
                            start: mean,
                            logarithmic: false,
                            ..unknown.clone()
                        });
                        values.push(mean);
                    }
                }
            }
        }
        for k in self.first_new..self.experiment.sensors.sensor.len() {
            let accuracy = &self.experiment.accuracy[k];
            for (target, mean, sd) in
                [(Target::Bias(k), 0.0, accuracy.bias), (Target::Gain(k), 1.0, accuracy.gain)]
            {
                if sd > 0.0 {
                    unknowns.push(Unknown::plain(target, mean, sd));
                    values.push(mean);
                }
            }
        }
        (unknowns, values)
    }

    /// Inverse of the covariance of these unknowns before the addition.
    pub(super) fn precision(&self, tried: &Tried) -> Option<DMatrix<f64>> {
        let accuracy = &self.experiment.accuracy;
        let (unknowns, _) = self.exchanged(tried, accuracy);
        let n = unknowns.len();
        let place = |unknown: &Unknown| {
            let is_new = unknown.target.sensor().is_some_and(|k| Some(k) == self.exchanged);
            tried.unknowns.iter().position(|u| u.target == unknown.target).filter(|_| !is_new)
        };
        let places: Vec<Option<usize>> = unknowns.iter().map(place).collect();
        let covariance = DMatrix::from_fn(n, n, |i, j| match (places[i], places[j]) {
            (Some(a), Some(b)) => tried.fit.covariance[(a, b)],
            _ if i == j => unknowns[i].sd.powi(2),
            _ => 0.0,
        });
        // Scaled: coordinates are of very different size.
        let sd: Vec<f64> = (0..n).map(|i| covariance[(i, i)].max(1e-300).sqrt()).collect();
        let scaled = DMatrix::from_fn(n, n, |i, j| covariance[(i, j)] / (sd[i] * sd[j]));
        let inverse = scaled.cholesky()?.inverse();
        Some(DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (sd[i] * sd[j])))
    }
}

fn is_flow(sensor: &Sensor) -> bool {
    sensor.role == Role::Input && ["kg_s", "m3_s"].contains(&sensor.si().as_str())
}

fn is_water(sensor: &Sensor) -> bool {
    let around = ["ground.", "weather.", "outdoor"].iter().any(|word| sensor.signal.contains(word));
    sensor.role == Role::Input && sensor.si() == "k" && !around
}

/// A run under another program; none where nothing would change.
fn changed(experiment: &Experiment, run: &Run, program: Program) -> Option<Run> {
    let sensors = &experiment.sensors.sensor;
    let has = |of: fn(&Sensor) -> bool| sensors.iter().any(of);
    let possible = match program {
        Program::Again => true,
        Program::TwoFlows | Program::Hold => has(is_flow),
        Program::Warmer => has(is_water),
    };
    if !possible {
        return None;
    }
    let middle_s = 0.5 * (run.span_s.0 + run.span_s.1);
    let mut run = run.clone();
    for (track, sensor) in run.tracks.iter_mut().zip(sensors) {
        match program {
            Program::TwoFlows if is_flow(sensor) => {
                let later =
                    track.time_s.iter().zip(&mut track.value).filter(|(t, _)| **t > middle_s);
                later.for_each(|(_, y)| *y *= SECOND_LEVEL);
            }
            Program::Warmer if is_water(sensor) => {
                let (step_k, over_s, hottest_k) = STEP;
                let hottest = track.value.iter().copied().fold(0.0, f64::max);
                let step_k = if hottest + step_k > hottest_k { -step_k } else { step_k };
                for (t, y) in track.time_s.iter().zip(&mut track.value) {
                    *y += step_k * ((t - middle_s) / over_s).clamp(0.0, 1.0);
                }
            }
            Program::Hold => {
                *track = held(track, middle_s, is_flow(sensor), sensor.role == Role::Compare);
            }
            _ => {}
        }
    }
    if program == Program::Hold {
        run.span_s.1 += HOLD_S;
    }
    Some(run)
}

/// A track with a pause in it: a flow is zero, other inputs stay, nothing is compared.
fn held(track: &Track, middle_s: f64, stops: bool, compared: bool) -> Track {
    let mut out = Track { time_s: Vec::new(), value: Vec::new() };
    let mut add = |t: f64, y: f64| {
        out.time_s.push(t);
        out.value.push(y);
    };
    let split = track.time_s.partition_point(|t| *t <= middle_s);
    for i in 0..split {
        add(track.time_s[i], track.value[i]);
    }
    if !compared && split > 0 {
        let level = if stops { 0.0 } else { track.value[split - 1] };
        let from_s = track.time_s[split - 1];
        let every_s = interval_s(track);
        let first_s = from_s + 0.5 * every_s;
        let last_s = middle_s + HOLD_S;
        add(first_s, level);
        if last_s > first_s {
            add(last_s, level);
        }
    }
    for i in split..track.time_s.len() {
        add(track.time_s[i] + HOLD_S, track.value[i]);
    }
    out
}

/// The same with further sensors near what the members are at.
fn with_sensors(rivals: &Rivals<'_>) -> Option<Experiment> {
    let experiment = rivals.experiment;
    let model = &experiment.model;
    let known = &experiment.sensors.sensor;
    let of = |signal: &str| signal.rsplit_once('.').map_or("", |(of, _)| of).to_owned();
    let mut near: Vec<String> = Vec::new();
    for tried in &rivals.members {
        let candidate = &rivals.all[tried.candidates[0]];
        near.push(match candidate.unknown.target.sensor() {
            Some(k) => of(&known[k].signal),
            None => candidate.component.clone(),
        });
    }
    let edges: Vec<_> = model
        .edges
        .iter()
        .filter(|e| {
            [e.id.as_str(), &e.from, &e.to].iter().any(|name| near.iter().any(|n| n == name))
        })
        .collect();
    let mut signals: Vec<(String, &str, Class)> = Vec::new();
    for edge in &edges {
        for node in [&edge.from, &edge.to] {
            signals.push((format!("{node}.t_k"), "K", Class::Pt100A));
        }
        signals.push((format!("{}.dp_pa", edge.id), "Pa", Class::Dp025));
        signals.push((format!("{}.m_flow_kg_s", edge.id), "kg_s", Class::Mid));
    }
    // What is measured already, also as an input of a node.
    let measured = |signal: &str| {
        known.iter().any(|s| s.signal == signal)
            || known.iter().any(|s| is_water(s) && signal == format!("{}.t_k", of(&s.signal)))
    };
    let mut wanted: Vec<(String, &str, Class)> = Vec::new();
    for signal in signals {
        if !measured(&signal.0) && !wanted.iter().any(|w| w.0 == signal.0) {
            wanted.push(signal);
        }
    }
    wanted.truncate(MOST_SENSORS);
    let clock =
        known.iter().find(|s| s.role == Role::Input).map_or(String::new(), |s| s.clock.clone());
    let new = wanted.into_iter().map(|(signal, unit, class)| Sensor {
        column: signal.clone(),
        signal,
        unit: unit.to_owned(),
        role: Role::Compare,
        class,
        lag_s: 0.0,
        quantisation: 0.0,
        clock: clock.clone(),
    });
    let mut sensors =
        SensorFile { sensor: known.clone(), effect: experiment.sensors.effect.clone() };
    sensors.sensor.extend(new);
    let mut runs = experiment.runs.clone();
    for (index, run) in runs.iter_mut().enumerate() {
        // Water begins at the mean of the temperatures that are read first.
        let first_k = experiment.first(index).map_or(300.0, |first| first.middle_k);
        let compared = run.tracks.iter().zip(known).filter(|(_, s)| s.role == Role::Compare);
        let densest = compared.max_by_key(|(track, _)| track.time_s.len())?.0.time_s.clone();
        for sensor in &sensors.sensor[known.len()..] {
            let value = vec![if sensor.si() == "k" { first_k } else { 1.0 }; densest.len()];
            run.tracks.push(Track { time_s: densest.clone(), value });
        }
    }
    // How accurate a sensor is depends on what it reads.
    let first = rivals.members[0];
    let blank = Experiment::new(model.clone(), sensors, runs).ok()?;
    let readings = blank.readings(&first.unknowns, &first.fit.at).ok()?;
    let mut filled = blank.clone();
    for (k, sensor) in blank.sensors.sensor.iter().enumerate().skip(known.len()) {
        let own =
            || (0..readings.len()).filter(|&i| blank.samples[i].sensor == k).map(|i| readings[i]);
        let largest = own().fold(0.0_f64, |most, y| most.max(y.abs()));
        filled.accuracy[k] =
            sensor.accuracy(own().sum::<f64>() / own().count().max(1) as f64, largest);
    }
    Some(filled)
}
