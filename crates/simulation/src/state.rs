//! The state of a simulation: plain data, so that a clone or its bytes are a snapshot.

use crate::automatic_step::StepMemory;
use crate::error::RunError;
use crate::kpi;
use crate::simulation::{BlockedSpan, Missed, SwingState};
use anergy_control::sensor::SensorState;
use anergy_core::clock::Time;
use anergy_core::port::PortFlow;
use anergy_network::holding::VesselState;
use anergy_network::interface::StationState;
use anergy_network::state::NetworkState;
use anergy_prosumer::thermal_unit::Exchange;
use serde::{Deserialize, Serialize};

/// What a heat meter shows.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Reading {
    /// Heat, W (mean of the step).
    pub q_flow_w: f64,
    /// Heat since the start, J.
    pub heat_j: f64,
    /// Water since the start, m3.
    pub volume_m3: f64,
}

/// Heat of a pipe since the start of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct PipeHeat {
    /// What the flow has brought and left there, J.
    pub brought_j: f64,
    /// What was lost to the surroundings, J.
    pub lost_j: f64,
    /// What its content held at the start, J above 0 degC.
    pub at_start_j: f64,
}

/// Everything that changes during a run: plain data. A clone, or its bytes, is a snapshot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    pub(crate) time: Time,
    pub(crate) network: NetworkState,
    pub(crate) signals: Vec<f64>,
    /// Signals that the user has taken over from schedules and controllers.
    pub(crate) taken_over: Vec<bool>,
    pub(crate) unit_states: Vec<f64>,
    pub(crate) unit_outputs: Vec<f64>,
    /// What the ports of the units got in the last step.
    pub(crate) unit_ports: Vec<PortFlow>,
    /// Electricity and other heat of each unit in the last step.
    pub(crate) unit_exchange: Vec<Exchange>,
    /// Steps in which flows or temperatures of each circuit, then of each coupling, did not settle.
    pub(crate) unsettled: Vec<u64>,
    /// Whether each watched output of a unit was up at the end of the last step.
    pub(crate) unit_flags: Vec<bool>,
    pub(crate) stations: Vec<StationState>,
    /// When their flags were up, in the order in which they went up.
    pub(crate) blocked_spans: Vec<BlockedSpan>,
    pub(crate) station_heat_j: Vec<f64>,
    pub(crate) meters: Vec<Reading>,
    pub(crate) kpis: kpi::Sums,
    /// Share of the present period for which each pulsing valve is open.
    pub(crate) pulse_shares: Vec<f64>,
    pub(crate) vessels: Vec<VesselState>,
    /// Whether each watched limit is crossed.
    pub(crate) crossed: Vec<bool>,
    /// What is remembered of each target.
    pub(crate) missed: Vec<Missed>,
    pub(crate) sensors: Vec<SensorState>,
    /// What is known of each watched pump.
    pub(crate) swings: Vec<SwingState>,
    pub(crate) controller_states: Vec<f64>,
    pub(crate) next_tick: Vec<Time>,
    pub(crate) last_tick: Vec<Time>,
    /// Next update of each controller of the user.
    pub(crate) user_ticks: Vec<Time>,
    /// Signals of those controllers that were set by hand since, one after the other.
    pub(crate) user_overruled: Vec<bool>,
    pub(crate) electric_j: f64,
    pub(crate) units_j: f64,
    /// Electricity that the units drew.
    pub(crate) units_electric_j: f64,
    /// All other heat that they took up from outside.
    pub(crate) units_external_j: f64,
    /// What they held at the start.
    pub(crate) units_initial_j: f64,
    pub(crate) pump_heat_j: f64,
    pub(crate) friction_j: f64,
    /// Heat of each pipe, in the order of the edges.
    pub(crate) pipes: Vec<PipeHeat>,
    pub(crate) loss_j: f64,
    pub(crate) boundary_j: f64,
    /// Water that the largest flow has moved.
    pub(crate) passed_kg: f64,
    pub(crate) pump_hydraulic_j: f64,
    pub(crate) dissipated_j: f64,
    /// Work that accelerated water and is not found in its motion.
    pub(crate) step_damped_j: f64,
    /// Kinetic energy of the water at the start.
    pub(crate) initial_kinetic_j: f64,
    pub(crate) initial_stored_j: f64,
    pub(crate) largest_mass_residual_kg_s: f64,
    /// What the automatic step remembers.
    pub(crate) stepping: StepMemory,
    pub(crate) steps: u64,
    pub(crate) solves: u64,
    pub(crate) iterations: u64,
}

impl State {
    /// Memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        fn heap<T>(values: &Vec<T>) -> usize {
            values.capacity() * size_of::<T>()
        }
        size_of::<Self>()
            + self.network.heap_bytes()
            + heap(&self.signals)
            + heap(&self.taken_over)
            + heap(&self.unit_states)
            + heap(&self.unit_outputs)
            + heap(&self.unit_ports)
            + heap(&self.unit_exchange)
            + heap(&self.unsettled)
            + heap(&self.unit_flags)
            + heap(&self.stations)
            + heap(&self.station_heat_j)
            + heap(&self.meters)
            + self.kpis.heap_bytes()
            + heap(&self.pulse_shares)
            + heap(&self.vessels)
            + heap(&self.crossed)
            + heap(&self.missed)
            + heap(&self.sensors)
            + heap(&self.swings)
            + heap(&self.controller_states)
            + heap(&self.next_tick)
            + heap(&self.last_tick)
            + heap(&self.user_ticks)
            + heap(&self.user_overruled)
            + heap(&self.pipes)
            + self.stepping.heap_bytes()
    }

    /// The state as bytes.
    ///
    /// # Errors
    /// [`RunError::Snapshot`] when it cannot be encoded.
    pub fn to_bytes(&self) -> Result<Vec<u8>, RunError> {
        postcard::to_allocvec(self)
            .map_err(|error| RunError::Snapshot { problem: error.to_string() })
    }
}
