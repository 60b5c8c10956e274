//! Sensors and controllers: names of channels and signals to ids.

use super::Builder;
use super::signals::{Writer, free_signal, range, ratio_hint};
use crate::channels::{self, Source};
use crate::diagnostic::did_you_mean;
use crate::model::{ControllerSpec, Place};
use crate::plan::{Plan, PlannedController, PlannedSensor};
use crate::wording::refused;
use anergy_control::controllers::{LocalController, ports};
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
use anergy_core::medium::ZERO_CELSIUS_K;
use anergy_core::signal::{SignalSpec, SignalTable};
use std::collections::HashMap;
use std::ops::Range;

impl Builder<'_> {
    /// A signal for each set point of each controller; those of one controller are neighbours.
    pub(super) fn set_points(&mut self, signals: &mut SignalTable) -> Vec<Range<usize>> {
        let mut all = Vec::new();
        for spec in &self.model.controllers {
            let first = signals.specs().len();
            // A controller that cannot be built is reported later.
            for point in spec.params.build(&()).map(|built| built.set_points()).unwrap_or_default()
            {
                let name = format!("{}.{}", spec.id, point.name);
                let signal = free_signal(&name, point.unit, point.value);
                self.add_signal(signals, signal, &spec.place);
            }
            all.push(first..signals.specs().len());
        }
        all
    }

    /// The source and unit of a channel, or a report.
    fn channel(
        &mut self,
        plan: &Plan,
        what: &str,
        field: &str,
        name: &str,
        place: &Place,
    ) -> Option<usize> {
        let found = plan.channels.iter().position(|channel| channel.name == name);
        let of_sensor = name.strip_suffix(".value");
        let of_sensor = self.model.sensors.iter().find(|s| Some(s.entry.id.as_str()) == of_sensor);
        if found.is_none() && of_sensor.is_some() {
            // A controller's sensor is there, and wrong.
            if what.starts_with("sensor") {
                let message = format!("{what} measures \"{name}\", the reading of a sensor");
                let hint = "a sensor measures what is there: name the channel of that sensor";
                self.report(message, place.of(field), Some(hint.into()));
            }
        } else if found.is_none() {
            let hint = did_you_mean(name, plan.channels.iter().map(|c| c.name.as_str()));
            let message = format!("{what} measures \"{name}\", which does not exist");
            let hint = hint.or_else(|| {
                Some("a channel is for example \"EDGE.m_flow_kg_s\" or \"NODE.t_k\"".into())
            });
            self.report(message, place.of(field), hint);
        }
        found
    }

    pub(super) fn sensors(&mut self, plan: &mut Plan) {
        // A sensor measures what is there, not what another one shows.
        for spec in &self.model.sensors {
            let entry = &spec.entry;
            let what = format!("sensor \"{}\"", entry.id);
            let sensor = entry.build();
            if let Err(error) = &sensor {
                let problem = refused(&what, &spec.place, error.field(), &error.to_string());
                self.problems.push(problem);
            }
            let measures = self.channel(plan, &what, "measures", &entry.measures, &spec.place);
            let minus = entry
                .minus
                .as_ref()
                .map(|name| self.channel(plan, &what, "minus", name, &spec.place));
            let (Ok(sensor), Some(measures)) = (sensor, measures) else { continue };
            let mut unit = plan.channels[measures].unit.clone();
            let minus = match minus {
                Some(None) => continue,
                Some(Some(minus)) => {
                    if plan.channels[minus].unit != unit {
                        let message = format!(
                            "{what} subtracts \"{}\" in {} from \"{}\" in {unit}",
                            plan.channels[minus].name, plan.channels[minus].unit, entry.measures
                        );
                        self.report(message, spec.place.of("minus"), None);
                    }
                    if unit == "K" {
                        // A difference does not count from 0 degC.
                        unit = channels::DIFFERENCE_K.to_owned();
                    }
                    Some(plan.sources[minus])
                }
                None => None,
            };
            plan.initial.sensors.push(sensor.resting(0.0));
            let measures = plan.sources[measures];
            plan.sensors.push(PlannedSensor {
                name: entry.id.clone(),
                unit,
                sensor,
                measures,
                minus,
            });
        }
        channels::add_sensors(plan);
    }

    /// The output at the start is a value of the signal, where the file gives it.
    fn check_initial_output(&mut self, spec: &ControllerSpec, signal: &SignalSpec) {
        let field = "initial_output";
        let value = spec.params.to_value().get(field).and_then(serde_json::Value::as_f64);
        let Some(value) = value.filter(|_| spec.place.has(field)) else { return };
        if (signal.min..=signal.max).contains(&value) {
            return;
        }
        let (name, range) = (&signal.name, range(signal, None));
        let message = format!("{field} = {value} is outside the range of \"{name}\": {range}");
        let what = format!("controller \"{}\"", spec.id);
        let mut problem = refused(&what, &spec.place, Some(field), &message);
        problem.hint = ratio_hint(signal, value);
        self.problems.push(problem);
    }

    pub(super) fn controllers(
        &mut self,
        plan: &mut Plan,
        set_points: &[Range<usize>],
        writers: &mut HashMap<SignalId, Writer>,
    ) {
        self.show_controllers(plan);
        let mut state_len = 0;
        for (spec, set_points) in self.model.controllers.iter().zip(set_points) {
            let what = format!("controller \"{}\"", spec.id);
            let controller = spec.params.build(&());
            if let Err(error) = &controller {
                let problem = refused(&what, &spec.place, error.field(), &error.to_string());
                self.problems.push(problem);
            }
            let ports = ports(spec.params.kind());
            let measured: Vec<Option<usize>> = spec
                .measured()
                .into_iter()
                .map(|(field, name)| self.channel(plan, &what, field, name, &spec.place))
                .collect();
            let mut acts_on = Vec::new();
            for (field, name) in ports.acts_on.iter().zip(&spec.acts_on) {
                let Some(signal) = plan.signals.find(name) else {
                    let names = plan.signals.specs().iter().map(|signal| signal.name.as_str());
                    let hint = did_you_mean(name, names);
                    let message = format!("{what} acts on \"{name}\", which does not exist");
                    let hint =
                        hint.or_else(|| Some("`anergy check --signals` lists all signals".into()));
                    self.report(message, spec.place.of(field), hint);
                    continue;
                };
                self.check_initial_output(spec, plan.signals.spec(signal));
                self.claim(writers, signal, &plan.signals, &what, spec.place.of(field));
                acts_on.push(signal);
            }
            let measured: Option<Vec<usize>> = measured.into_iter().collect();
            let (Ok(controller), Some(measured)) = (controller, measured) else { continue };
            if acts_on.len() < spec.acts_on.len() {
                continue;
            }
            if let LocalController::Rule(rule) = &controller {
                self.check_conditions(plan, spec, rule, &measured);
            }
            let state = controller.initial_state();
            let timing = controller.timing();
            let time = |s| Time::from_s(s).unwrap_or(Time::ZERO);
            let limits = acts_on.iter().map(|signal| {
                let spec = plan.signals.spec(*signal);
                (spec.min, spec.max)
            });
            let counts_from_zero_celsius = measured.first().is_some_and(|first| {
                plan.channels[*first].unit == "K"
                    && !matches!(plan.sources[*first], Source::Sensor(i) if plan.sensors[i].minus.is_some())
            });
            let planned = PlannedController {
                name: spec.id.clone(),
                measures: measured.iter().map(|&i| plan.sources[i]).collect(),
                measured_names: spec.measures.clone(),
                zero: if counts_from_zero_celsius { ZERO_CELSIUS_K } else { 0.0 },
                set_points: set_points.clone(),
                limits: limits.collect(),
                acts_on,
                interval: time(timing.interval_s),
                state: state_len..state_len + state.len(),
                controller,
            };
            plan.controllers.push(planned);
            state_len += state.len();
            plan.initial.controller_states.extend(state);
            plan.initial.next_tick.push(time(timing.offset_s));
            plan.initial.last_tick.push(time(timing.offset_s));
        }
    }
}
