//! Controllers that a user adds to a simulation: after those of the model, in the order in which they were
//! added, each at its own interval. Steps end at their updates. Their signals are theirs: schedules and
//! controllers of the model leave them alone.

use super::Simulation;
use crate::channels::{self, Source};
use crate::error::RunError;
use anergy_control::controller::ControlError;
use anergy_control::user_controller::UserController;
use anergy_core::clock::Time;
use anergy_core::ids::{ChannelId, SignalId};

/// One of them with its ports.
pub(super) struct AddedController {
    name: String,
    controller: Box<dyn UserController>,
    measures: Vec<Source>,
    acts_on: Vec<SignalId>,
    pub(super) interval: Time,
    offset: Time,
}

impl AddedController {
    fn failed(&self, time: Time, source: ControlError) -> RunError {
        let controller = self.name.clone();
        RunError::Control { time: time.to_string(), controller, source }
    }
}

impl Simulation {
    /// Adds a controller that reads channels and writes signals from its first update on.
    ///
    /// ```
    /// use anergy_control::controller::{ControlError, Timing};
    /// use anergy_control::user_controller::UserController;
    /// # use anergy_core::clock::Time;
    /// # use anergy_simulation::{build::build, model::Model, simulation::Simulation};
    /// # let text = r#"
    /// # format = 1
    /// # [[site]]
    /// # id = "plant"
    /// # lines = ["supply", "return"]
    /// # [[edge]]
    /// # id = "pump"
    /// # kind = "pump"
    /// # from = "plant.return"
    /// # to = "plant.supply"
    /// # head_max_hpa = 402.21
    /// # free_flow_l_min = 55.33
    /// # [[edge]]
    /// # id = "load"
    /// # kind = "resistance"
    /// # from = "plant.supply"
    /// # to = "plant.return"
    /// # dp_nominal_hpa = 100.0
    /// # m_flow_nominal_kg_min = 10.0
    /// # [pressure_reference]
    /// # node = "plant.return"
    /// # "#;
    /// # let model = Model::from_toml(text, std::path::Path::new(".")).unwrap();
    /// /// Integrates towards 0.2 kg/s.
    /// struct Integral;
    ///
    /// impl UserController for Integral {
    ///     fn timing(&self) -> Timing {
    ///         Timing { interval_s: 5.0, offset_s: 0.0 }
    ///     }
    ///
    ///     fn update(&mut self, _time_s: f64, measured: &[f64], outputs: &mut [f64]) -> Result<(), ControlError> {
    ///         outputs[0] = (outputs[0] + (0.2 - measured[0])).clamp(0.0, 1.0);
    ///         Ok(())
    ///     }
    /// }
    ///
    /// let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
    /// let flow = simulation.channel("pump.m_flow_kg_s").unwrap();
    /// let speed = simulation.signal("pump.speed").unwrap();
    /// simulation.add_controller("integral", Box::new(Integral), &[flow], &[speed]).unwrap();
    /// simulation.advance_to(Time::from_s(600.0).unwrap(), Time::from_s(1.0).unwrap()).unwrap();
    /// assert!((simulation.get(flow) - 0.2).abs() < 1e-6);
    /// ```
    ///
    /// # Errors
    /// [`RunError::Control`] for an interval that is not positive, an offset below zero, no signal, a signal
    /// that another added controller acts on, and what the controller itself says at its start.
    pub fn add_controller(
        &mut self,
        name: &str,
        controller: Box<dyn UserController>,
        measures: &[ChannelId],
        acts_on: &[SignalId],
    ) -> Result<(), RunError> {
        let timing = controller.timing();
        let interval = Time::from_s(timing.interval_s).filter(|interval| *interval > Time::ZERO);
        let offset = Time::from_s(timing.offset_s).filter(|offset| *offset >= Time::ZERO);
        let mut added = AddedController {
            name: name.to_owned(),
            controller,
            measures: measures.iter().map(|id| self.plan.sources()[id.index()]).collect(),
            acts_on: acts_on.to_vec(),
            interval: interval.unwrap_or(Time::NEVER),
            offset: offset.unwrap_or(Time::ZERO),
        };
        let now = self.state.time;
        let range =
            |field, value, requirement| ControlError::OutOfRange { field, value, requirement };
        let fields = |problem: String| ControlError::Fields { field: "acts_on", problem };
        let problem = if interval.is_none() {
            Some(range("interval_s", timing.interval_s, "must be positive"))
        } else if offset.is_none() {
            Some(range("offset_s", timing.offset_s, "must not be negative"))
        } else if acts_on.is_empty() {
            Some(fields("it acts on no signal".to_owned()))
        } else {
            let doubled = |(i, id): &(usize, &SignalId)| {
                acts_on[..*i].contains(id)
                    || self.users.iter().any(|other| other.acts_on.contains(id))
            };
            acts_on.iter().enumerate().find(doubled).map(|(_, id)| {
                let signal = &self.plan.signals.spec(*id).name;
                let others = self.users.iter().find(|other| other.acts_on.contains(id));
                let other = others.map_or(name, |other| &other.name);
                fields(format!("\"{signal}\" is driven by controller \"{other}\" already"))
            })
        };
        if let Some(problem) = problem {
            return Err(added.failed(now, problem));
        }
        added.controller.start().map_err(|problem| added.failed(now, problem))?;
        self.desk.make_room(measures.len(), acts_on.len());
        self.state.user_ticks.push(added.offset.max(now));
        self.take_over(&added);
        self.users.push(added);
        Ok(())
    }

    fn take_over(&mut self, added: &AddedController) {
        for id in &added.acts_on {
            self.state.taken_over[id.index()] = true;
            self.state.user_overruled.push(false);
        }
    }

    /// They begin anew at the start of a run.
    pub(super) fn start_users(&mut self) -> Result<(), RunError> {
        let mut users = std::mem::take(&mut self.users);
        let mut done = Ok(());
        for added in &mut users {
            self.state.user_ticks.push(added.offset);
            self.take_over(added);
            let started = added.controller.start();
            done = done.and(started.map_err(|problem| added.failed(Time::ZERO, problem)));
        }
        self.users = users;
        done
    }

    /// Those that are due read their channels and write their signals. One that fails stays due.
    pub(super) fn control_users(&mut self, now: Time) -> Result<(), RunError> {
        let mut first = 0;
        for (i, added) in self.users.iter_mut().enumerate() {
            let outputs = first..first + added.acts_on.len();
            first = outputs.end;
            if self.state.user_ticks[i] > now {
                continue;
            }
            let desk = &mut self.desk;
            desk.measured.clear();
            let value = |of: &Source| channels::value(&self.plan, &self.state, *of);
            desk.measured.extend(added.measures.iter().map(value));
            desk.outputs.clear();
            let signals = &self.state.signals;
            desk.outputs.extend(added.acts_on.iter().map(|id| signals[id.index()]));
            let done = added.controller.update(now.as_s(), &desk.measured, &mut desk.outputs);
            done.map_err(|problem| added.failed(now, problem))?;
            for (id, value) in added.acts_on.iter().zip(&desk.outputs) {
                let spec = self.plan.signals.spec(*id);
                if !(spec.min..=spec.max).contains(value) || !value.is_finite() {
                    return Err(RunError::UserOutput {
                        time: now.to_string(),
                        controller: added.name.clone(),
                        signal: spec.name.to_string(),
                        value: *value,
                        min: spec.min,
                        max: spec.max,
                    });
                }
            }
            let overruled = &self.state.user_overruled[outputs];
            for ((id, value), overruled) in added.acts_on.iter().zip(&desk.outputs).zip(overruled) {
                if !overruled {
                    self.state.signals[id.index()] = *value;
                }
            }
            self.state.user_ticks[i] = now + added.interval;
        }
        Ok(())
    }

    /// Notes whether a signal was set by hand; whether a controller of the user acts on it.
    pub(super) fn overrule_user(&mut self, id: SignalId, overruled: bool) -> bool {
        let mut theirs = self.users.iter().flat_map(|added| &added.acts_on);
        let Some(place) = theirs.position(|signal| *signal == id) else { return false };
        self.state.user_overruled[place] = overruled;
        true
    }
}
