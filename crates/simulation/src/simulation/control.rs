//! Sensors follow their quantities, controllers that are due act.

use super::Simulation;
use crate::channels;
use crate::error::RunError;
use crate::plan::{Plan, PlannedController, PlannedSensor};
use crate::state::State;
use anergy_control::controller::{Balance, Inputs};
use anergy_core::clock::Time;
use anergy_core::recorder::{Event, Severity};

/// Work space of the controllers; holds nothing that a result depends on.
#[derive(Debug, Default)]
pub(crate) struct Desk {
    pub(super) measured: Vec<f64>,
    pub(super) outputs: Vec<f64>,
    /// What a controller showed before its update.
    before: Vec<f64>,
}

impl Desk {
    pub(super) fn new(plan: &Plan) -> Self {
        let most = |len: fn(&PlannedController) -> usize| {
            vec![0.0; plan.controllers.iter().map(len).max().unwrap_or(0)]
        };
        Self {
            measured: most(|c| c.measures.len()),
            outputs: most(|c| c.acts_on.len()),
            before: most(|c| c.controller.channels().len()),
        }
    }

    /// Room for one more controller.
    pub(super) fn make_room(&mut self, measures: usize, acts_on: usize) {
        self.measured.reserve(measures);
        self.outputs.reserve(acts_on);
    }
}

impl PlannedController {
    /// What it sees now; `measured` is where the measured values are put.
    pub(crate) fn inputs<'a>(
        &'a self,
        plan: &Plan,
        state: &'a State,
        measured: &'a mut Vec<f64>,
    ) -> Inputs<'a> {
        measured.clear();
        measured.extend(self.measures.iter().map(|of| channels::value(plan, state, *of)));
        Inputs {
            measured,
            set_points: &state.signals[self.set_points.clone()],
            limits: &self.limits,
        }
    }

    /// Its outputs as they are now.
    pub(crate) fn outputs(&self, state: &State, outputs: &mut Vec<f64>) {
        outputs.clear();
        outputs.extend(self.acts_on.iter().map(|id| state.signals[id.index()]));
    }

    /// How far its outputs are from where they would stay.
    pub(crate) fn balance(&self, plan: &Plan, state: &State) -> Vec<Balance> {
        let (mut measured, mut outputs) = (Vec::new(), Vec::new());
        let inputs = self.inputs(plan, state, &mut measured);
        self.outputs(state, &mut outputs);
        let mut balance = vec![Balance::default(); outputs.len()];
        self.controller.balance(&inputs, &outputs, &mut balance);
        balance
    }
}

impl PlannedSensor {
    /// The quantity itself.
    pub(crate) fn raw(&self, plan: &Plan, state: &State) -> f64 {
        let value = |of| channels::value(plan, state, of);
        value(self.measures) - self.minus.map_or(0.0, value)
    }
}

impl Simulation {
    /// Controllers that are due read their channels and write their signals.
    pub(super) fn control(&mut self, now: Time) -> Result<(), RunError> {
        for (i, planned) in self.plan.controllers.iter().enumerate() {
            if self.state.next_tick[i] > now {
                continue;
            }
            let dt_s = (now - self.state.last_tick[i]).as_s();
            self.state.last_tick[i] = now;
            self.state.next_tick[i] = now + planned.interval;
            let Desk { measured, outputs, before } = &mut self.desk;
            planned.outputs(&self.state, outputs);
            planned.inputs(&self.plan, &self.state, measured);
            let inputs = Inputs {
                measured,
                set_points: &self.state.signals[planned.set_points.clone()],
                limits: &planned.limits,
            };
            let own = &mut self.state.controller_states[planned.state.clone()];
            let shown = planned.controller.channels();
            before.clear();
            before.extend(shown.iter().map(|channel| own[channel.place]));
            let done = planned.controller.update(dt_s, &inputs, own, outputs);
            for (channel, before) in shown.iter().zip(&*before) {
                if let Some(kinds) = channel.event
                    && own[channel.place] != *before
                {
                    let kind = kinds[usize::from(own[channel.place] == 0.0)];
                    let says = planned.controller.says(kind, &inputs, outputs);
                    self.events.push(Event {
                        time: now,
                        severity: Severity::Warning,
                        kind: kind.into(),
                        message: format!("{}: {says}", planned.name),
                        component: planned.name.clone(),
                    });
                }
            }
            done.map_err(|source| RunError::Control {
                time: now.to_string(),
                controller: planned.name.clone(),
                source,
            })?;
            for (signal, output) in planned.acts_on.iter().zip(&*outputs) {
                if !self.state.taken_over[signal.index()] {
                    self.state.signals[signal.index()] = *output;
                }
            }
        }
        Ok(())
    }

    /// Sensors follow what they measure over a step that ends at `end`.
    pub(super) fn sense(&mut self, end: Time, dt_s: f64) {
        for (i, planned) in self.plan.sensors.iter().enumerate() {
            let raw = planned.raw(&self.plan, &self.state);
            planned.sensor.advance(end.0, dt_s, raw, &mut self.state.sensors[i]);
        }
    }

    /// Sensors show what there is, as if it had always been so.
    pub(super) fn rest_sensors(&mut self) {
        for (i, planned) in self.plan.sensors.iter().enumerate() {
            let raw = planned.raw(&self.plan, &self.state);
            planned.sensor.rest(raw, &mut self.state.sensors[i]);
        }
    }

    /// Controllers are in the state in which their present outputs stay.
    pub(crate) fn rest_controllers(&mut self) {
        let (mut measured, mut outputs) = (Vec::new(), Vec::new());
        for planned in &self.plan.controllers {
            planned.outputs(&self.state, &mut outputs);
            planned.inputs(&self.plan, &self.state, &mut measured);
            let inputs = Inputs {
                measured: &measured,
                set_points: &self.state.signals[planned.set_points.clone()],
                limits: &planned.limits,
            };
            let own = &mut self.state.controller_states[planned.state.clone()];
            planned.controller.rest(&inputs, &outputs, own);
        }
    }
}
