//! Where steps end: events, and the automatic step.

use super::Simulation;
use crate::automatic_step::{AutomaticStep, Limit, Quantity, Ratios, Step, StepMemory};
use crate::error::RunError;
use crate::plan::Plan;
use crate::state::State;
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
use std::collections::BTreeMap;

/// Flows count relative to this share of the nominal flow at least.
const LEAST_SHARE: f64 = 0.1;
/// Outputs without limits count relative to this at least.
const LEAST_RANGE: f64 = 1.0;

/// What the automatic step follows, and its work space; holds nothing that a result depends on.
#[derive(Debug)]
pub(super) struct Stepper {
    /// Smallest flow that the tolerance of each edge refers to, kg/s.
    least_kg_s: Vec<f64>,
    /// Edges whose position lags behind its command.
    lagging: Vec<usize>,
    /// Outputs of continuous controllers; those of controllers with an integral first.
    outputs: Vec<Output>,
    integrating: usize,
    /// Positions and lags at the start of the step.
    positions: Vec<f64>,
    lags: Vec<f64>,
    /// Of the step that is being done.
    ratios: Ratios,
    ended: Limit,
}

/// An output of a controller.
#[derive(Debug)]
struct Output {
    signal: SignalId,
    /// From its least to its largest value.
    range: f64,
    /// Edge that it moves.
    edge: Option<usize>,
}

impl Stepper {
    pub(super) fn new(plan: &Plan) -> Self {
        let edges = &plan.network.edges;
        let least = |element: &anergy_network::elements::Element| {
            LEAST_SHARE * element.m_flow_nominal_kg_s()
        };
        let lags = |edge: usize| {
            edges[edge].element.actuator().is_none_or(|actuator| actuator.rise_time_s > 0.0)
        };
        let moved: BTreeMap<SignalId, usize> =
            (0..edges.len()).filter_map(|edge| Some((plan.commands[edge]?, edge))).collect();
        let continuous = |tracks: bool| {
            let controllers = plan.controllers.iter().filter(move |controller| {
                controller.interval == Time::ZERO && controller.controller.tracks() == tracks
            });
            controllers.flat_map(|controller| {
                controller.acts_on.iter().zip(&controller.limits).map(|(signal, (min, max))| {
                    let range = max - min;
                    let range = if range.is_finite() && range > 0.0 { range } else { LEAST_RANGE };
                    Output { signal: *signal, range, edge: moved.get(signal).copied() }
                })
            })
        };
        let integrating = continuous(true).count();
        Self {
            least_kg_s: edges.iter().map(|edge| least(&edge.element)).collect(),
            lagging: (0..edges.len()).filter(|edge| lags(*edge)).collect(),
            outputs: continuous(true).chain(continuous(false)).collect(),
            integrating,
            positions: Vec::with_capacity(edges.len()),
            lags: Vec::with_capacity(edges.len()),
            ratios: Ratios::default(),
            ended: Limit::default(),
        }
    }

    /// Flows, relative to which those of each edge count, kg/s.
    fn sizes<'a>(&'a self, state: &'a State) -> impl Iterator<Item = f64> + 'a {
        let flows = state.network.m_flow_kg_s.iter().zip(&self.least_kg_s);
        flows.map(|(m, least)| m.abs().max(*least))
    }

    /// The largest of them.
    fn largest_kg_s(&self, state: &State) -> f64 {
        self.sizes(state).fold(0.0, f64::max)
    }

    /// Flows, kg/s.
    fn flows<'a>(
        &'a self,
        state: &'a State,
        limits: &'a AutomaticStep,
    ) -> impl Iterator<Item = Quantity> + 'a {
        let flows = state.network.m_flow_kg_s.iter().zip(self.sizes(state));
        flows.map(|(value, size)| Quantity {
            value: *value,
            tolerance: limits.tolerance_flow * size,
            m_flow_kg_s: size,
        })
    }

    /// Outputs; those that move no edge belong to all of the flow.
    fn outputs<'a>(
        &'a self,
        state: &'a State,
        limits: &'a AutomaticStep,
        largest_kg_s: f64,
    ) -> impl Iterator<Item = Quantity> + 'a {
        let flows = &state.network.m_flow_kg_s;
        let size = move |edge: usize| flows[edge].abs().max(self.least_kg_s[edge]);
        self.outputs.iter().map(move |output| Quantity {
            value: state.signals[output.signal.index()],
            tolerance: limits.tolerance_flow * output.range,
            m_flow_kg_s: output.edge.map_or(largest_kg_s, size),
        })
    }

    /// Whether something moves on its own that flows depend on.
    fn moves(&self, state: &State) -> bool {
        let positions = &state.network.position;
        !self.outputs.is_empty()
            || state.network.flows_move()
            || self.lagging.iter().any(|edge| positions[*edge] != self.positions[*edge])
    }
}

/// Temperatures at the ports of units, K.
fn temperatures<'a>(
    state: &'a State,
    limits: &'a AutomaticStep,
) -> impl Iterator<Item = Quantity> + 'a {
    state.network.port_flows.iter().flat_map(|port| {
        [port.t_in_k, port.t_out_k].map(|value| Quantity {
            value,
            tolerance: limits.tolerance_k,
            m_flow_kg_s: port.m_flow_kg_s.abs(),
        })
    })
}

impl Simulation {
    /// Advances to `target`, as many steps as schedules, controllers and `step` ask for.
    ///
    /// # Errors
    /// [`RunError`] names the component that failed; the state is that of the last good step.
    pub fn advance_to(&mut self, target: Time, step: impl Into<Step>) -> Result<(), RunError> {
        let step = step.into();
        while self.state.time < target {
            self.advance_once(target, &step)?;
        }
        Ok(())
    }

    /// One step, to `target` at most.
    ///
    /// # Errors
    /// As [`Self::advance_to`].
    pub fn advance_once(&mut self, target: Time, step: &Step) -> Result<(), RunError> {
        let event = self.next_event(target);
        match step {
            Step::Fixed(largest) => {
                let end = event.0.min(self.state.time.next_multiple(*largest));
                self.step_to((end, Limit::Longest), None)?;
            }
            Step::Automatic(limits) => {
                self.begin_automatic(limits);
                self.step_to(event, Some(limits))?;
            }
        }
        let end = self.state.time;
        self.check_temperatures(&end)
    }

    /// The first time after now at which a step has to end, and why.
    fn next_event(&mut self, target: Time) -> (Time, Limit) {
        let now = self.state.time;
        let mut end = (target, Limit::Row);
        let mut limit = |time: Time, limit: Limit| {
            if time < end.0 {
                end = (time, limit);
            }
        };
        if let Some(longest) = self.plan.soil_step {
            limit(now + longest, Limit::Soil);
        }
        for (driver, near) in self.plan.drivers.iter().zip(&mut self.near) {
            limit(driver.next_breakpoint(now, near), Limit::Schedule);
        }
        for (controller, next) in self.plan.controllers.iter().zip(&self.state.next_tick) {
            if controller.interval > Time::ZERO {
                // One that is due now ticks in this step; the next one bounds it.
                let next = if *next <= now { *next + controller.interval } else { *next };
                limit(next.max(Time(now.0 + 1)), Limit::Update);
            }
        }
        for (user, next) in self.users.iter().zip(&self.state.user_ticks) {
            limit(if *next <= now { *next + user.interval } else { *next }, Limit::Update);
        }
        end
    }

    /// The first automatic step, or the first after others, begins with what there is.
    fn begin_automatic(&mut self, limits: &AutomaticStep) {
        let mut memory = std::mem::take(&mut self.state.stepping);
        let fresh = memory.flows.last().is_empty();
        if fresh || memory.until != self.state.time {
            memory.begin(limits, self.state.time);
            memory.flows.rest(self.stepper.flows(&self.state, limits));
            memory.outputs.rest(self.stepper.outputs(&self.state, limits, 0.0));
            memory.temperatures.rest(temperatures(&self.state, limits));
        }
        if self.driven_anew() {
            memory.restart(limits);
        }
        self.state.stepping = memory;
    }

    /// Whether a controller that acts at every step has to follow what its inputs do from now on.
    fn driven_anew(&self) -> bool {
        let any = self.stepper.integrating > 0;
        !self.stepper.outputs.is_empty()
            && self.plan.drivers.iter().zip(&self.near).any(|(driver, near)| {
                driver.turns_at(self.state.time, *near) && (any || driver.jumps_at(*near))
            })
    }

    /// Inputs, actuators and flows of an automatic step; its end.
    pub(super) fn flow_within(
        &mut self,
        now: Time,
        event: (Time, Limit),
        limits: &AutomaticStep,
    ) -> Result<Time, RunError> {
        let mut memory = std::mem::take(&mut self.state.stepping);
        let outcome = self.try_flows(now, event, limits, &mut memory);
        self.state.stepping = memory;
        outcome
    }

    /// Solves the flows of a step that is as long as they allow.
    fn try_flows(
        &mut self,
        now: Time,
        event: (Time, Limit),
        limits: &AutomaticStep,
        memory: &mut StepMemory,
    ) -> Result<Time, RunError> {
        // The outputs moved after the last step, by what was measured at its end.
        let last_s = memory.flows.step_s();
        let largest_kg_s = self.stepper.largest_kg_s(&self.state);
        let outputs = || self.stepper.outputs(&self.state, limits, largest_kg_s);
        let integrating = outputs().take(self.stepper.integrating);
        let integrating = memory.outputs.miss(last_s, largest_kg_s, integrating);
        let moved = memory.outputs.miss(last_s, largest_kg_s, outputs());
        let moved = moved.max(memory.grown(integrating));
        memory.outputs.keep(last_s, outputs());
        memory.react(limits, moved);
        let (mut end, mut ended) = memory.end(limits, now, event);
        let stepper = &mut self.stepper;
        self.state.network.copy_actuators(&mut stepper.positions, &mut stepper.lags);
        let said = self.events.len();
        let mut before = None;
        let flows = loop {
            let latest = end;
            end = self.flow_until(now, latest)?;
            if end < latest {
                ended = Limit::Schedule;
            }
            let step = end - now;
            let ratio = if self.stepper.moves(&self.state) {
                let flows = self.stepper.flows(&self.state, limits);
                memory.flows.miss(step.as_s(), self.stepper.largest_kg_s(&self.state), flows)
            } else {
                0.0
            };
            let Some(shorter) = limits.try_again(step, ratio, before) else { break ratio };
            before = Some((step, ratio));
            (end, ended) = (now + shorter, Limit::Flow);
            memory.cut(shorter);
            self.events.truncate(said);
            let Stepper { positions, lags, .. } = &self.stepper;
            self.state.network.put_back(positions, lags, memory.flows.last());
        };
        memory.flows.keep((end - now).as_s(), self.stepper.flows(&self.state, limits));
        self.stepper.ratios = Ratios { flows, outputs: moved, temperatures: 0.0 };
        self.stepper.ended = ended;
        Ok(end)
    }

    /// Judges the step that ended now, and chooses the next one.
    pub(super) fn conclude_automatic(&mut self, dt_s: f64, limits: &AutomaticStep) {
        let mut memory = std::mem::take(&mut self.state.stepping);
        let now = || temperatures(&self.state, limits);
        let largest_kg_s = self.stepper.largest_kg_s(&self.state);
        let missed = memory.temperatures.miss(dt_s, largest_kg_s, now());
        let ratios = Ratios { temperatures: missed, ..self.stepper.ratios };
        memory.temperatures.keep(dt_s, now());
        memory.conclude(limits, self.state.time, self.stepper.ended, &ratios);
        self.state.stepping = memory;
    }
}
