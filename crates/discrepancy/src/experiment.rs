//! The model under the measured inputs: what every compared sensor should have read.
//!
//! Measured inputs drive their signals (`inputs`). What is a mean over a step belongs to its middle, a state to its end
//! ([`Moment`]); the water of a run begins at the median of the temperatures that are read first.

use crate::catalogue::Use;
use crate::data::{Run, Track};
use crate::error::ExplainError;
use crate::inputs::{Input, off_is_off};
use crate::response::{Response, lagged};
use crate::sensors::{Accuracy, Role, Sensor, SensorFile};
use crate::unknown::{Target, Unknown};
use anergy_core::clock::Time;
use anergy_core::ids::ChannelId;
use anergy_simulation::build::build;
use anergy_simulation::channels::Moment;
use anergy_simulation::effect::EffectSpec;
use anergy_simulation::effects::EffectParams;
use anergy_simulation::error::RunError;
use anergy_simulation::model::{Model, Place};
use anergy_simulation::simulation::Simulation;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Longest lag of an input over the shortest run.
const LONGEST_LAG: f64 = 0.25;

/// A reading that is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Run.
    pub run: usize,
    /// Sensor, by its place in the sensor file.
    pub sensor: usize,
    /// Time, s.
    pub time_s: f64,
    /// Reading, SI.
    pub value: f64,
}

/// Model, measurements and sensors together.
#[derive(Clone)]
pub struct Experiment {
    /// The model.
    pub model: Model,
    /// The sensors.
    pub sensors: SensorFile,
    /// The runs.
    pub runs: Vec<Run>,
    /// Accuracy of every sensor.
    pub accuracy: Vec<Accuracy>,
    /// Every compared reading, by run, sensor and time.
    pub samples: Vec<Sample>,
    /// Smallest and largest value of the signal of every input.
    pub(crate) ranges: Vec<(f64, f64)>,
    /// Flow meters that never read below zero.
    pub(crate) one_way: Vec<bool>,
    uses: OnceLock<BTreeMap<String, Use>>,
    pub(crate) step: Time,
}

impl Experiment {
    /// Checks that sensors, data and model belong together.
    ///
    /// # Errors
    /// A signal or channel that the model does not have, a unit that does not fit, a model that does not build.
    pub fn new(model: Model, sensors: SensorFile, runs: Vec<Run>) -> Result<Self, ExplainError> {
        let plan = build(&model).map_err(ExplainError::Model)?;
        let shortest_s = runs.iter().map(|r| r.span_s.1 - r.span_s.0).fold(f64::INFINITY, f64::min);
        for sensor in &sensors.sensor {
            let problem =
                |problem: String| ExplainError::Sensor { column: sensor.column.clone(), problem };
            let (si, name) = (sensor.si(), &sensor.signal);
            let (what, names): (_, Vec<(&str, String)>) = match sensor.role {
                Role::Input => (
                    "signal",
                    plan.signals()
                        .specs()
                        .iter()
                        .map(|s| (s.name.as_str(), s.unit.to_owned()))
                        .collect(),
                ),
                Role::Compare => (
                    "channel",
                    plan.channels()
                        .iter()
                        .map(|c| (c.name.as_str(), suffix(&c.quantity).to_owned()))
                        .collect(),
                ),
            };
            let Some((_, unit)) = names.iter().find(|(known, _)| known == name) else {
                let nearest =
                    names.iter().min_by_key(|(known, _)| strsim::levenshtein(known, name));
                let hint = nearest
                    .map_or(String::new(), |(known, _)| format!("; did you mean \"{known}\"?"));
                return Err(problem(format!("the model has no {what} \"{name}\"{hint}")));
            };
            if sensor.role == Role::Input && sensor.lag_s > LONGEST_LAG * shortest_s {
                return Err(problem(format!(
                    "lag_s = {} is more than a quarter of the shortest run, {shortest_s} s: what entered cannot be told from it",
                    sensor.lag_s
                )));
            }
            let fits = *unit == si || (unit.is_empty() && si == "1");
            if !fits {
                let (has, is) = (&sensor.unit, unit);
                return Err(problem(format!(
                    "its unit \"{has}\" is none of {name}, which is in \"{is}\""
                )));
            }
        }
        let accuracy = sensors.sensor.iter().enumerate().map(|(i, sensor)| {
            let all = || runs.iter().flat_map(|run| run.tracks[i].value.iter().copied());
            let count = all().count().max(1) as f64;
            let largest = all().fold(0.0_f64, |largest, y| largest.max(y.abs()));
            sensor.accuracy(all().sum::<f64>() / count, largest)
        });
        let accuracy: Vec<Accuracy> = accuracy.collect();
        let one_way = |(i, sensor): (usize, &Sensor)| {
            let mut readings = runs.iter().flat_map(|run| &run.tracks[i].value);
            matches!(sensor.si().as_str(), "kg_s" | "m3_s") && readings.all(|y| *y >= 0.0)
        };
        let one_way = sensors.sensor.iter().enumerate().map(one_way).collect();
        let mut samples = Vec::new();
        for (run, measured) in runs.iter().enumerate() {
            for (sensor, track) in measured.tracks.iter().enumerate() {
                if sensors.sensor[sensor].role == Role::Compare {
                    let readings = track.time_s.iter().zip(&track.value);
                    samples.extend(readings.map(|(&time_s, &value)| Sample {
                        run,
                        sensor,
                        time_s,
                        value,
                    }));
                }
            }
        }
        let range = |sensor: &Sensor| {
            let signal = plan.signals().find(&sensor.signal).filter(|_| sensor.role == Role::Input);
            let spec = signal.map(|signal| plan.signals().spec(signal));
            spec.map_or((f64::NEG_INFINITY, f64::INFINITY), |spec| (spec.min, spec.max))
        };
        let ranges: Vec<(f64, f64)> = sensors.sensor.iter().map(range).collect();
        let runs = off_is_off(runs, &sensors, &ranges, &accuracy);
        let step = plan.step();
        Ok(Self {
            model,
            sensors,
            runs,
            accuracy,
            samples,
            ranges,
            one_way,
            uses: OnceLock::new(),
            step,
        })
    }

    /// What the sensors should have read, with values for the unknowns.
    ///
    /// # Errors
    /// What keeps the model from running.
    pub fn readings(&self, unknowns: &[Unknown], at: &[f64]) -> Result<Vec<f64>, ExplainError> {
        Ok(self.observed(&self.simulated(unknowns, at, 1)?, unknowns, at))
    }

    /// Every compared quantity, before the sensors; in steps that are so many times shorter.
    ///
    /// # Errors
    /// What keeps the model from running.
    pub fn simulated(
        &self,
        unknowns: &[Unknown],
        at: &[f64],
        finer: i64,
    ) -> Result<Simulated, ExplainError> {
        let model = self.with_effects(unknowns, at);
        let step = Time(self.step.0 / finer);
        let run = |index| self.simulate(&model, index, step, unknowns, at);
        Ok(Simulated((0..self.runs.len()).map(run).collect::<Result<_, _>>()?))
    }

    /// What the sensors make of a simulation.
    pub fn observed(&self, simulated: &Simulated, unknowns: &[Unknown], at: &[f64]) -> Vec<f64> {
        let mut readings = vec![0.0; self.samples.len()];
        self.observe(simulated, unknowns, at, |_| true, &mut readings);
        readings
    }

    /// The same where only flaws of this sensor differ from those of `readings`.
    pub fn observed_beside(
        &self,
        readings: &[f64],
        sensor: usize,
        simulated: &Simulated,
        unknowns: &[Unknown],
        at: &[f64],
    ) -> Vec<f64> {
        let mut readings = readings.to_vec();
        self.observe(simulated, unknowns, at, |other| other == sensor, &mut readings);
        readings
    }

    /// Readings of these sensors, each in its place.
    fn observe(
        &self,
        simulated: &Simulated,
        unknowns: &[Unknown],
        at: &[f64],
        wanted: impl Fn(usize) -> bool,
        readings: &mut [f64],
    ) {
        let mut place = 0;
        for (run, tracks) in self.runs.iter().zip(&simulated.0) {
            for (sensor, track) in
                tracks.iter().enumerate().filter(|(_, track)| !track.time_s.is_empty())
            {
                let times = &run.tracks[sensor].time_s;
                let own = &mut readings[place..place + times.len()];
                place += times.len();
                if !wanted(sensor) {
                    continue;
                }
                let response = self.response(sensor, unknowns, at);
                let behind = lagged(track, self.sensors.sensor[sensor].lag_s + response.lag_s);
                for (y, t) in own.iter_mut().zip(times) {
                    *y = response.of(behind.at(t + response.clock_s), *t, run.span_s);
                }
            }
        }
    }

    /// Whether another value of it needs another simulation.
    pub fn is_simulated(&self, target: &Target) -> bool {
        let is_input = |i: usize| self.sensors.sensor[i].role == Role::Input;
        match target {
            Target::Logger(i) => {
                (0..self.sensors.sensor.len()).any(|k| is_input(k) && self.share_clock(*i, k))
            }
            other => other.sensor().is_none_or(is_input),
        }
    }

    /// Whether two sensors have the same clock.
    pub(crate) fn share_clock(&self, one: usize, other: usize) -> bool {
        self.sensors.sensor[one].clock == self.sensors.sensor[other].clock
    }

    fn with_effects(&self, unknowns: &[Unknown], at: &[f64]) -> Model {
        let mut fields: Vec<(&'static str, &str, Map<String, Value>)> = Vec::new();
        for (unknown, coordinate) in unknowns.iter().zip(at) {
            let Target::Effect { id, component, field } = &unknown.target else { continue };
            let value = Value::from(unknown.value(*coordinate));
            match fields.iter_mut().find(|(i, c, _)| i == id && c == component) {
                Some((.., map)) => drop(map.insert((*field).to_owned(), value)),
                None => {
                    fields.push((id, component, Map::from_iter([((*field).to_owned(), value)])));
                }
            }
        }
        let mut model = self.model.clone();
        for (id, component, map) in fields {
            if let Some(Ok(params)) = EffectParams::deserialize(id, Value::Object(map)) {
                let (component, place) = (component.to_owned(), Place::default());
                model.effects.push(EffectSpec { component, params, provenance: Map::new(), place });
            }
        }
        model
    }

    /// The simulation of a run with its measured inputs, and its steps.
    fn driven(
        &self,
        model: &Model,
        index: usize,
        step: Time,
        unknowns: &[Unknown],
        at: &[f64],
    ) -> Result<(Simulation, usize), ExplainError> {
        let (mut model, run) = (model.clone(), &self.runs[index]);
        let begin_s = run.span_s.0;
        let rows = ((run.span_s.1 - begin_s) / step.as_s()).ceil() as usize + 1;
        for (i, sensor) in self.sensors.sensor.iter().enumerate() {
            let track = &run.tracks[i];
            if sensor.role == Role::Input && !track.value.is_empty() {
                let (range, response) = (self.ranges[i], &self.response(i, unknowns, at));
                let noise = self.accuracy[i].noise;
                let input = Input { sensor, track, response, range, noise };
                model.drivers.retain(|driver| driver.signal != sensor.signal);
                model.drivers.push(input.driver(run.span_s, step, rows));
            }
        }
        if let Some(first) = self.first(index) {
            let offset = |(unknown, at): (&Unknown, &f64)| match unknown.target {
                Target::Initial(of) if of == index => unknown.value(*at),
                _ => 0.0,
            };
            model.run.initial_k = first.middle_k + unknowns.iter().zip(at).map(offset).sum::<f64>();
        }
        Ok((Simulation::new(build(&model).map_err(ExplainError::Model)?)?, rows))
    }

    /// What the water of every edge does in the model as it is; empty where it does not run.
    pub(crate) fn uses(&self) -> &BTreeMap<String, Use> {
        self.uses.get_or_init(|| self.observe_uses().unwrap_or_default())
    }

    fn observe_uses(&self) -> Result<BTreeMap<String, Use>, ExplainError> {
        let edges: Vec<&str> = self.model.edges.iter().map(|edge| edge.id.as_str()).collect();
        let (mut flows, mut losses) = (vec![Vec::new(); edges.len()], vec![0.0; edges.len()]);
        for index in 0..self.runs.len() {
            let (mut simulation, rows) = self.driven(&self.model, index, self.step, &[], &[])?;
            let channel = |edge: &&str, quantity: &str| {
                simulation.channel(&format!("{edge}.{quantity}")).ok()
            };
            let of_flow: Vec<_> = edges.iter().map(|edge| channel(edge, "m_flow_kg_s")).collect();
            let of_loss: Vec<_> = edges.iter().map(|edge| channel(edge, "q_loss_w")).collect();
            for k in 1..=rows {
                simulation.advance_to(Time(self.step.0 * k as i64), self.step)?;
                for (i, (flow, loss)) in of_flow.iter().zip(&of_loss).enumerate() {
                    flows[i].push(flow.map_or(0.0, |id| simulation.get(id)));
                    losses[i] += loss.map_or(0.0, |id| simulation.get(id));
                }
            }
        }
        let of = |((edge, flows), loss): ((&&str, &Vec<f64>), &f64)| {
            ((*edge).to_owned(), Use::of(flows, *loss))
        };
        Ok(edges.iter().zip(&flows).zip(&losses).map(of).collect())
    }

    /// Every compared quantity over a run; empty for inputs.
    fn simulate(
        &self,
        model: &Model,
        index: usize,
        step: Time,
        unknowns: &[Unknown],
        at: &[f64],
    ) -> Result<Vec<Track>, ExplainError> {
        let begin_s = self.runs[index].span_s.0;
        let (mut simulation, rows) = self.driven(model, index, step, unknowns, at)?;
        let channels = self.sensors.sensor.iter().map(|sensor| match sensor.role {
            Role::Compare => {
                simulation.channel(&sensor.signal).map(|id| Some((id, simulation.moment(id))))
            }
            Role::Input => Ok(None),
        });
        let channels: Vec<Option<(ChannelId, Moment)>> =
            channels.collect::<Result<_, RunError>>()?;
        let none = Track { time_s: Vec::new(), value: Vec::new() };
        let mut tracks = vec![none; channels.len()];
        for k in 0..=rows {
            if k > 0 {
                simulation.advance_to(Time(step.0 * k as i64), step)?;
            }
            for (track, channel) in tracks.iter_mut().zip(&channels) {
                let Some((channel, moment)) = channel else { continue };
                let ago_s = match moment {
                    Moment::Middle if k > 0 => 0.5 * step.as_s(),
                    _ => 0.0,
                };
                track.time_s.push(begin_s + step.as_s() * k as f64 - ago_s);
                track.value.push(simulation.get(*channel));
            }
        }
        Ok(tracks)
    }

    fn response(&self, sensor: usize, unknowns: &[Unknown], at: &[f64]) -> Response {
        let mut response = Response::default();
        response.one_way = self.one_way[sensor];
        let column = &self.sensors.sensor[sensor].column;
        for effect in self.sensors.effect.iter().filter(|effect| effect.component == *column) {
            for (flaw, value) in effect.flaws(sensor) {
                response.take(&flaw, value);
            }
        }
        for (unknown, coordinate) in unknowns.iter().zip(at) {
            let of_logger =
                matches!(unknown.target, Target::Logger(i) if self.share_clock(i, sensor));
            if of_logger || unknown.target.sensor() == Some(sensor) {
                response.take(&unknown.target, unknown.value(*coordinate));
            }
        }
        response
    }
}

/// Compared quantities of every run and sensor, before the sensors.
#[derive(Debug, Clone, Default)]
pub struct Simulated(Vec<Vec<Track>>);

/// The SI suffix of a quantity's name.
fn suffix(quantity: &str) -> &str {
    let ends = |si: &&&str| quantity.strip_suffix(**si).is_some_and(|rest| rest.ends_with('_'));
    anergy_core::units::SI_SUFFIXES.iter().find(ends).copied().unwrap_or("")
}
