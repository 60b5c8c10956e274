//! A simulation: an immutable plan, a state that is plain data, and the step.

mod access;
mod actuators;
mod control;
mod houses;
mod hunting;
mod meters;
mod pipes;
mod pressure;
mod pulses;
mod saturation;
mod site;
mod stations;
mod stepping;
mod users;
mod validity;
mod words;

use crate::automatic_step::{AutomaticStep, Limit};
use crate::error::RunError;
use crate::kpi;
use crate::plan::Plan;
use crate::state::State;
use crate::weather::Interval;
use anergy_core::clock::Time;
use anergy_core::error::FactorError;
use anergy_core::ids::SignalId;
use anergy_core::port::PortRequest;
use anergy_core::recorder::Event;
use anergy_network::graph::NodeKind;
use anergy_network::hydraulics::{HydraulicReport, HydraulicSolver};
use anergy_network::state::Hold;
use anergy_network::transport::Transport;
use control::Desk;
pub(crate) use hunting::{Said, SwingState, watches};
pub(crate) use pipes::stored_j;
pub use pressure::Crossing;
pub(crate) use pressure::crossings;
pub(crate) use saturation::{Missed, missed_now};
pub(crate) use stations::BlockedSpan;
use std::sync::Arc;
use stepping::Stepper;
use users::AddedController;
pub use words::Unreached;
pub(crate) use words::named;
use words::prescribed_event;

/// A simulation that can be stepped.
pub struct Simulation {
    plan: Arc<Plan>,
    state: State,
    solver: HydraulicSolver,
    transport: Transport,
    /// Events since they were last taken.
    events: Vec<Event>,
    /// What the ports of the units want in the present step.
    wanted: Vec<PortRequest>,
    /// What the prescriptions were before the last solve.
    holds: Vec<Hold>,
    /// Where each driver was found last; results do not depend on it.
    near: Vec<usize>,
    /// The interval of the weather that was looked at last; results do not depend on it.
    outdoors: Option<Interval>,
    desk: Desk,
    stepper: Stepper,
    /// Controllers of the user, in the order in which they were added.
    users: Vec<AddedController>,
}

impl Simulation {
    /// A simulation at the start of its run.
    ///
    /// # Errors
    /// When the hydraulics at the start cannot be solved.
    pub fn new(plan: Arc<Plan>) -> Result<Self, RunError> {
        let singular = |source: FactorError| RunError::Singular { time: "start".into(), source };
        let solver = HydraulicSolver::new(&plan.network)
            .map_err(|error| named(&plan, Time::ZERO, &error))?;
        let transport = Transport::new(&plan.network).map_err(singular)?;
        let state = plan.initial_state();
        let mut simulation = Self {
            solver,
            transport,
            events: Vec::with_capacity(64),
            wanted: vec![PortRequest::default(); state.unit_ports.len()],
            state,
            holds: vec![Hold::Held; plan.prescriptions.len()],
            near: vec![0; plan.drivers.len()],
            outdoors: None,
            desk: Desk::new(&plan),
            stepper: Stepper::new(&plan),
            users: Vec::new(),
            plan,
        };
        simulation.begin()?;
        Ok(simulation)
    }

    /// Back to the start of the run: inputs at t = 0, actuators at their initial positions,
    /// hydraulics solved, all water at its initial temperature.
    ///
    /// # Errors
    /// As [`Self::new`]; those of controllers of the user when they begin anew.
    pub fn reset(&mut self) -> Result<(), RunError> {
        self.state = self.plan.initial_state();
        self.events.clear();
        self.begin()?;
        self.start_users()
    }

    /// From the initial state to the start of the run.
    fn begin(&mut self) -> Result<(), RunError> {
        for driver in &self.plan.drivers {
            self.state.signals[driver.signal.index()] = driver.value_at(Time::ZERO);
        }
        self.follow_seasons(Time::ZERO);
        self.follow_weather(Time::ZERO)?;
        self.follow_signals();
        self.request_units(0.0);
        self.drive_stations();
        self.apply_inputs();
        self.state.network.rest_soil(&self.plan.network.soil);
        self.fill_vessels();
        self.solve_hydraulics()?;
        self.settle_heads()?;
        self.rest_sensors();
        if self.plan.starts_settled {
            crate::steady::settle(self)?;
            self.rest_sensors();
            self.rest_controllers();
        }
        self.watch_pressures(Time::ZERO);
        self.fill_pipes();
        self.state.initial_stored_j = self.state.network.stored_j(&self.plan.network);
        self.state.units_initial_j = self.units_stored_j();
        self.state.initial_kinetic_j = self.state.network.kinetic_j(&self.plan.network);
        self.show_units();
        Ok(())
    }

    /// Advances towards `latest` in one step, which a pulsing valve or the automatic step may end earlier: sense,
    /// control, inputs, actuators, unit requests, hydraulics, transport, units, flags, balances.
    fn step_to(
        &mut self,
        latest: (Time, Limit),
        automatic: Option<&AutomaticStep>,
    ) -> Result<(), RunError> {
        let now = self.state.time;
        self.control(now)?;
        self.control_users(now)?;
        let end = match automatic {
            None => self.flow_until(now, latest.0)?,
            Some(limits) => self.flow_within(now, latest, limits)?,
        };
        let dt_s = (end - now).as_s();
        self.transport
            .advance(&self.plan.network, &mut self.state.network, dt_s)
            .map_err(|source| RunError::Singular { time: now.to_string(), source })?;
        self.state.network.advance_soil(&self.plan.network.soil, dt_s);
        self.advance_units(dt_s)?;
        self.watch_flags(end);
        self.watch_stations(end, dt_s);
        self.remember_directions(dt_s);
        self.watch_targets(end, dt_s);
        self.watch_swings(end, dt_s);
        self.book(dt_s);
        self.book_pipes(dt_s);
        kpi::book(&self.plan, &mut self.state, &self.transport, dt_s);
        self.read_meters(dt_s);
        self.watch_pressures(end);
        self.hold_pressures(dt_s);
        self.sense(end, dt_s);
        self.state.time = end;
        self.state.steps += 1;
        if let Some(limits) = automatic {
            self.conclude_automatic(dt_s, limits);
        }
        Ok(())
    }

    /// Inputs, actuators and flows of a step that ends at `latest`, or sooner: where a pulsing valve ends it, or where units do
    /// not follow longer.
    fn flow_until(&mut self, now: Time, latest: Time) -> Result<Time, RunError> {
        self.drive_inputs(latest)?;
        let mut end = self.begin_pulses(now, latest);
        if end < latest {
            self.drive_inputs(end)?;
        }
        self.request_units((end - now).as_s());
        let followed = self.followed_until(now, end);
        if followed < end {
            end = followed;
            self.drive_inputs(end)?;
            self.request_units((end - now).as_s());
        }
        self.drive_stations();
        self.apply_inputs();
        self.move_actuators((end - now).as_s());
        self.state.network.begin_flow_step((end - now).as_s());
        self.solve_hydraulics()?;
        Ok(end)
    }

    /// Schedules and series write their signals, after ground and weather.
    fn drive_inputs(&mut self, end: Time) -> Result<(), RunError> {
        self.follow_seasons(end);
        self.follow_weather(end)?;
        for (driver, near) in self.plan.drivers.iter().zip(&self.near) {
            if !self.state.taken_over[driver.signal.index()] {
                self.state.signals[driver.signal.index()] = driver.value_until(end, *near);
            }
        }
        self.follow_signals();
        Ok(())
    }

    /// Inputs of units that nothing else drives follow another signal.
    fn follow_signals(&mut self) {
        for (to, from) in &self.plan.follows {
            if !self.state.taken_over[to.index()] {
                self.state.signals[to.index()] = self.state.signals[from.index()];
            }
        }
    }

    /// The weather of a step that ends at a time.
    fn follow_weather(&mut self, end: Time) -> Result<(), RunError> {
        let Some(weather) = &self.plan.weather else { return Ok(()) };
        let step = (self.state.time, end);
        let values = weather
            .values(step, &mut self.outdoors)
            .ok_or_else(|| RunError::WeatherEnds { time: self.state.time.to_string() })?;
        for (signal, value) in weather.signals.iter().zip(values) {
            if let Some(signal) = signal.filter(|signal| !self.state.taken_over[signal.index()]) {
                self.state.signals[signal.index()] = value;
            }
        }
        Ok(())
    }

    /// The ground follows the year: evaluated once per step at its end, at each depth.
    fn follow_seasons(&mut self, time: Time) {
        let Some(ground) = &self.plan.seasonal_ground else { return };
        for (signal, depth_m) in &ground.at_depths {
            if !self.state.taken_over[signal.index()] {
                let new_year_s = ground.start_s + time.as_s();
                self.state.signals[signal.index()] =
                    ground.seasons.temperature_k(*depth_m, new_year_s);
            }
        }
    }

    /// Boundary values and temperatures around the network follow their signals.
    fn apply_inputs(&mut self) {
        let signals = &self.state.signals;
        let at = |id: Option<SignalId>, or: f64| id.map_or(or, |id| signals[id.index()]);
        for inputs in &self.plan.node_inputs {
            let network = &mut self.state.network;
            let i = inputs.node;
            network.set_boundary(
                i,
                at(inputs.p_pa, network.given_p_pa[i]),
                at(inputs.m_flow_kg_s, network.given_m_flow_kg_s[i]),
                at(inputs.t_k, network.given_t_k[i]),
            );
        }
        for (k, prescription) in self.plan.prescriptions.iter().enumerate() {
            self.state.network.prescribe(k, signals[prescription.signal.index()]);
        }
        for (k, signal) in self.plan.regulators.iter().enumerate() {
            self.state.network.set_regulator(k, signals[signal.index()]);
        }
        self.state.network.ambient_k = signals[self.plan.ground.index()];
        for (around, (id, difference_k)) in
            self.state.network.surroundings_k.iter_mut().zip(&self.plan.surroundings)
        {
            *around = signals[id.index()] + difference_k;
        }
        self.state.network.see_soil(&self.plan.network.soil);
    }

    pub(crate) fn solve_hydraulics(&mut self) -> Result<HydraulicReport, RunError> {
        let prescribed = &self.state.network.prescribed;
        for (hold, prescribed) in self.holds.iter_mut().zip(prescribed) {
            *hold = prescribed.hold;
        }
        let report = self
            .solver
            .solve(&self.plan.network, &mut self.state.network)
            .map_err(|error| named(&self.plan, self.state.time, &error))?;
        for (k, before) in self.holds.iter().enumerate() {
            if self.state.network.prescribed[k].hold != *before {
                self.events.push(prescribed_event(&self.plan, &self.state, k));
            }
        }
        if report.iterations > 0 {
            self.state.solves += 1;
            self.state.iterations += u64::from(report.iterations);
            let worst = &mut self.state.largest_mass_residual_kg_s;
            *worst = worst.max(report.mass_residual_kg_s);
        }
        Ok(report)
    }

    /// Integrates heat, electricity and hydraulic work.
    fn book(&mut self, dt_s: f64) {
        let (plan, state) = (&self.plan, &mut self.state);
        state.electric_j += kpi::book_pumps(plan, state, dt_s) * dt_s;
        let network = &state.network;
        state.units_j += plan.total_units_w(network) * dt_s;
        for exchange in &state.unit_exchange {
            state.units_electric_j += exchange.electric_w * dt_s;
            state.units_external_j += exchange.external_w * dt_s;
        }
        state.pump_heat_j += plan.total_pump_heat_w(network) * dt_s;
        state.friction_j += network.q_friction_w * dt_s;
        state.loss_j += plan.total_loss_w(network) * dt_s;
        state.boundary_j += network.boundary_w * dt_s;
        for (heat, station) in state.station_heat_j.iter_mut().zip(&plan.stations) {
            *heat += network.q_flow_w[station.edge.index()] * dt_s;
        }
        let largest = network.m_flow_kg_s.iter().fold(0.0_f64, |largest, m| largest.max(m.abs()));
        state.passed_kg += largest * dt_s;
        let density = plan.network.medium.density_kg_m3;
        for (ends, m_flow_kg_s) in plan.ends.iter().zip(&network.m_flow_kg_s) {
            let dp_pa = network.p_pa[ends.from as usize] - network.p_pa[ends.to as usize];
            let work_j = m_flow_kg_s * dp_pa / density * dt_s;
            if ends.drives {
                state.pump_hydraulic_j -= work_j;
            } else {
                state.dissipated_j += work_j;
            }
        }
        if network.counts_inertia() {
            // What accelerates the water is not lost, but for what the step damps.
            let (work_j, damped_j) = network.acceleration_j(&plan.network, dt_s);
            state.dissipated_j -= work_j;
            state.step_damped_j += damped_j;
        }
        for (i, node) in plan.network.nodes.iter().enumerate() {
            if node.kind != NodeKind::Junction {
                state.pump_hydraulic_j +=
                    network.exchange_kg_s[i] * network.p_pa[i] / density * dt_s;
            }
        }
    }

    /// Settles actuators, flows and temperatures once with the present signals; used by the steady
    /// solve. Returns the hydraulic report.
    pub(crate) fn settle_once(&mut self) -> Result<HydraulicReport, RunError> {
        self.request_units(0.0);
        self.drive_stations();
        self.apply_inputs();
        self.move_actuators(f64::INFINITY);
        self.state.network.begin_flow_step(f64::INFINITY);
        let report = self.solve_hydraulics()?;
        self.transport
            .settle(&self.plan.network, &mut self.state.network)
            .map_err(|source| RunError::Singular { time: "steady state".into(), source })?;
        self.state.network.settle_soil(&self.plan.network.soil);
        self.advance_units(0.0)?;
        self.read_meters(0.0);
        self.hold_pressures(0.0);
        self.rest_sensors();
        Ok(report)
    }

    /// The plan.
    pub fn plan(&self) -> &Arc<Plan> {
        &self.plan
    }

    /// The state.
    pub fn state(&self) -> &State {
        &self.state
    }

    pub(crate) fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }

    /// Simulated time.
    pub fn time(&self) -> Time {
        self.state.time
    }

    /// Takes the events since the last call.
    pub fn take_events(&mut self) -> std::vec::Drain<'_, Event> {
        self.events.drain(..)
    }
}
