//! Pump blocking: who holds whose check valve shut, and how far it is from there.
//!
//! A *feeder* is a pump in series with a check valve that lets its flow pass.
//!
//! **Equation** at zero flow a pump has the head `u^2 H0`, and the check valve takes nothing. The rest of the
//! network, solved without the flow of the feeder, puts the *opposing* pressure difference `dp_0` across the
//! pump. The check valve is shut below the threshold `u_0 = sqrt(dp_0/H0)`: the margin is `u - u_0`, negative
//! when the feeder is blocked. One solve, no iteration. The *influence* of another actuator is
//! `d dp_0/d position` there ([`crate::linearize`]); its *weight* is that times the position itself, the change
//! of `dp_0` per relative change of the position. The culprit is the other pump or source of largest
//! positive weight. Where another actuator blocks or frees the feeder is the root of `u_0(position) = u`:
//! Newton with that influence, kept within a bracket, each time from the last solution.
//!
//! **Assumptions** all else stays: speeds, openings, temperatures, what controllers command. What follows by
//! itself does so: self-acting valves to their steady openings, free actuators of prescriptions.
//! **Validity** a pump that holds a flow or a head has the speed that this takes at the moment; up to its full
//! speed it has the reserve `u_max - u_0` besides. A part without any way but the feeder has no `dp_0`.
//!
//! **Sources** specification SC-01 (`angelidis2023`).

mod feeders;

pub use feeders::{Feeder, feeders};

use crate::elements::Element;
use crate::elements::pump::Pump;
use crate::graph::Network;
use crate::hydraulics::HydraulicError;
use crate::linearize::{Linearization, Response};
use crate::state::NetworkState;
use anergy_core::ids::EdgeId;

/// A threshold is found within this of the speed.
const SPEED: f64 = 1e-7;
/// An influence below this share of the opposing pressure difference is none.
const ROUNDING: f64 = 1e-9;
const MAX_ROUNDS: usize = 60;

/// How far a feeder is from where its check valve shuts. There is no threshold where the network has no state
/// without its flow: flows that are given elsewhere come through it.
#[derive(Debug, Clone, PartialEq)]
pub struct Margin {
    /// Present relative speed of the pump.
    pub speed: f64,
    /// Largest one.
    pub speed_max: f64,
    /// Present flow, kg/s; not positive when it is blocked.
    pub m_flow_kg_s: f64,
    /// The relative speed below which the check valve is shut; above the largest one where none opens it.
    pub threshold_speed: Option<f64>,
    /// Pressure difference that the rest of the network puts across the pump without its flow, Pa.
    pub opposing_dp_pa: Option<f64>,
    /// Head of the pump at its present speed without flow, Pa.
    pub head_without_flow_pa: f64,
    /// What the other pumps and sources do to the opposing pressure difference.
    pub influences: Vec<Influence>,
    /// The one among them that holds the feeder back most, if any does.
    pub culprit: Option<EdgeId>,
}

impl Margin {
    /// Present speed above the threshold; negative when the feeder is blocked.
    pub fn speed_margin(&self) -> Option<f64> {
        self.threshold_speed.map(|threshold| self.speed - threshold)
    }

    /// Whether the pump runs and the network holds its check valve shut.
    pub fn blocked(&self) -> bool {
        self.speed > 0.0 && self.speed_margin().is_some_and(|margin| margin < 0.0)
    }
}

/// What the position of an actuator does to a feeder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Influence {
    /// The actuator.
    pub edge: EdgeId,
    /// Change of the opposing pressure difference, Pa per unit of the position.
    pub opposing_dp_by_position_pa: f64,
    /// The same per relative change of the position, Pa.
    pub weight_pa: f64,
}

/// Where other actuators shut or open the check valve of a feeder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Common factor of their positions.
    pub factor: f64,
    /// Position of the first of them.
    pub position: f64,
    /// Its flow there, kg/s.
    pub m_flow_kg_s: f64,
}

/// Finds margins at an operating point; keeps its memory between questions.
pub struct Blocking {
    feeders: Vec<Feeder>,
    /// What can hold a feeder back: pumps and sources of flow or head.
    drives: Vec<EdgeId>,
    linearization: Linearization,
    /// The operating point.
    here: NetworkState,
    /// The state of the last solve.
    state: NetworkState,
    response: Response,
    change_pa: Vec<f64>,
}

impl Blocking {
    /// Prepares for a network at a solved state.
    ///
    /// # Errors
    /// As [`Linearization::new`].
    pub fn new(network: &Network, state: &NetworkState) -> Result<Self, HydraulicError> {
        let drives = network.edges.iter().enumerate().filter(|(_, edge)| {
            matches!(
                edge.element,
                Element::Pump(_) | Element::FlowSource(_) | Element::PressureSource(_)
            )
        });
        let mut here = state.clone();
        // Self-acting valves go all their way.
        here.advance_regulators(network, f64::INFINITY);
        Ok(Self {
            feeders: feeders(network),
            drives: drives.map(|(i, _)| EdgeId::from_index(i)).collect(),
            linearization: Linearization::new(network, state)?,
            state: here.clone(),
            here,
            response: Response::new(network),
            change_pa: Vec::new(),
        })
    }

    /// The feeders of the network.
    pub fn feeders(&self) -> &[Feeder] {
        &self.feeders
    }

    /// How far a feeder is from where its check valve shuts.
    ///
    /// # Errors
    /// When the network without its flow cannot be solved, though it could be.
    pub fn margin(&mut self, network: &Network, feeder: Feeder) -> Result<Margin, HydraulicError> {
        let drives = std::mem::take(&mut self.drives);
        let influences = self.influences(network, feeder, &drives);
        self.drives = drives;
        let (opposing_dp_pa, influences) = influences?;
        let (pump, head_pa) = pump_of(network, feeder);
        let at = self.here.edge_state(network, feeder.pump.index());
        let m_flow_kg_s = self.here.m_flow_kg_s[feeder.pump.index()];
        let speed = pump.map_or(0.0, |pump| pump.speed(m_flow_kg_s, &at));
        let worst = influences.iter().max_by(|a, b| a.weight_pa.total_cmp(&b.weight_pa));
        let rounding = ROUNDING * opposing_dp_pa.unwrap_or(0.0).abs();
        let culprit = worst.filter(|worst| worst.weight_pa > rounding).map(|worst| worst.edge);
        Ok(Margin {
            speed,
            speed_max: pump.map_or(0.0, Pump::speed_max),
            m_flow_kg_s,
            threshold_speed: opposing_dp_pa.map(|dp| threshold(dp, head_pa)),
            opposing_dp_pa,
            head_without_flow_pa: speed * speed * head_pa,
            influences,
            culprit,
        })
    }

    /// The opposing pressure difference of a feeder, Pa, if there is one, and what some actuators do to it.
    ///
    /// # Errors
    /// As [`Self::margin`].
    pub fn influences(
        &mut self,
        network: &Network,
        feeder: Feeder,
        edges: &[EdgeId],
    ) -> Result<(Option<f64>, Vec<Influence>), HydraulicError> {
        self.back();
        let opposing_dp_pa = self.opposing_dp_pa(network, feeder)?;
        let mut influences = Vec::new();
        if opposing_dp_pa.is_some() {
            let all = self.influences_here(network, feeder, edges);
            influences.extend(all.filter(|influence| influence.edge != feeder.pump));
        }
        Ok((opposing_dp_pa, influences))
    }

    /// Thresholds of a feeder over positions of another actuator; `None` where there is none.
    ///
    /// # Errors
    /// As [`Self::margin`].
    pub fn thresholds(
        &mut self,
        network: &Network,
        feeder: Feeder,
        edge: EdgeId,
        positions: &[f64],
    ) -> Result<Vec<Option<f64>>, HydraulicError> {
        self.back();
        let (_, head_pa) = pump_of(network, feeder);
        let at = |this: &mut Self, position: &f64| {
            this.state.place_actuator(edge.index(), *position);
            let opposing_dp_pa = this.opposing_dp_pa(network, feeder)?;
            Ok(opposing_dp_pa.map(|dp| threshold(dp, head_pa)))
        };
        positions.iter().map(|position| at(self, position)).collect()
    }

    /// The common factor on the positions of other actuators at which the check valve of a feeder shuts or
    /// opens, within the ends of their ways; an actuator at zero counts as at its upper end. `None` where
    /// there is no such factor.
    ///
    /// # Errors
    /// As [`Self::margin`].
    pub fn limit(
        &mut self,
        network: &Network,
        feeder: Feeder,
        edges: &[EdgeId],
    ) -> Result<Option<Limit>, HydraulicError> {
        self.back();
        let (pump, head_pa) = pump_of(network, feeder);
        let max = |edge: EdgeId| {
            let actuator = network.edges[edge.index()].element.actuator();
            actuator.map_or(1.0, |actuator| actuator.max)
        };
        let whole: Vec<f64> = edges
            .iter()
            .map(|edge| match self.here.position[edge.index()] {
                here if here > 0.0 => here,
                _ => max(*edge),
            })
            .collect();
        let ends = edges.iter().zip(&whole).map(|(edge, whole)| max(*edge) / whole);
        let most = ends.fold(f64::INFINITY, f64::min);
        let i = feeder.pump.index();
        let at = self.here.edge_state(network, i);
        let speed = pump.map_or(0.0, |pump| pump.speed(self.here.m_flow_kg_s[i], &at));
        // Threshold less speed, and its change with the factor.
        let miss = |this: &mut Self, factor: f64| -> Result<Option<(f64, f64)>, HydraulicError> {
            for (edge, whole) in edges.iter().zip(&whole) {
                this.state.place_actuator(edge.index(), factor * whole);
            }
            let Some(opposing) = this.opposing_dp_pa(network, feeder)? else { return Ok(None) };
            let threshold = threshold(opposing, head_pa);
            let influences = this.influences_here(network, feeder, edges);
            let by_factor: f64 = influences
                .zip(&whole)
                .map(|(influence, whole)| whole * influence.opposing_dp_by_position_pa)
                .sum();
            // d sqrt(dp) = d dp sqrt(dp)/(2 dp)
            let slope = if opposing > 0.0 { 0.5 * threshold / opposing * by_factor } else { 0.0 };
            Ok(Some((threshold - speed, slope)))
        };
        let (mut low, mut high) = (0.0, if most.is_finite() { most } else { 1e3 });
        let (Some(at_low), Some(at_high)) = (miss(self, low)?, miss(self, high)?) else {
            return Ok(None);
        };
        if at_low.0.signum() == at_high.0.signum() {
            return Ok(None);
        }
        let rises = at_high.0 > 0.0;
        let mut factor = 1.0_f64.clamp(low, high);
        for _ in 0..MAX_ROUNDS {
            let Some((value, slope)) = miss(self, factor)? else { return Ok(None) };
            if value.abs() <= SPEED || high - low <= SPEED * high {
                break;
            }
            if (value > 0.0) == rises {
                high = factor;
            } else {
                low = factor;
            }
            let newton = factor - value / slope;
            factor = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        }
        let first = edges.first().map_or(0, |edge| edge.index());
        let (position, m_flow_kg_s) = (self.state.position[first], self.state.m_flow_kg_s[first]);
        Ok(Some(Limit { factor, position, m_flow_kg_s }))
    }

    /// Flows of all feeders, kg/s, with the actuators of some edges at other positions.
    ///
    /// # Errors
    /// When the network cannot be solved there.
    pub fn flows(
        &mut self,
        network: &Network,
        positions: &[(EdgeId, f64)],
        m_flow_kg_s: &mut Vec<f64>,
    ) -> Result<(), HydraulicError> {
        self.state.position.clone_from(&self.here.position);
        for (edge, position) in positions {
            self.state.place_actuator(edge.index(), *position);
        }
        self.linearization.solve_without(network, &mut self.state, None)?;
        m_flow_kg_s.clear();
        let flow = |feeder: &Feeder| self.state.m_flow_kg_s[feeder.pump.index()];
        m_flow_kg_s.extend(self.feeders.iter().map(flow));
        Ok(())
    }

    /// Back to the operating point.
    fn back(&mut self) {
        let Self { state, here, .. } = self;
        state.position.clone_from(&here.position);
        state.m_flow_kg_s.clone_from(&here.m_flow_kg_s);
        state.p_pa.clone_from(&here.p_pa);
        state.prescribed.clone_from(&here.prescribed);
        state.regulated.clone_from(&here.regulated);
    }

    /// What the rest of the network puts across the pump of a feeder without its flow, Pa; `None` where it
    /// has no such state.
    fn opposing_dp_pa(
        &mut self,
        network: &Network,
        feeder: Feeder,
    ) -> Result<Option<f64>, HydraulicError> {
        let Self { linearization, state, .. } = self;
        match linearization.solve_without(network, state, Some(feeder.pump)) {
            Err(
                HydraulicError::Unbalanced { .. }
                | HydraulicError::Absurd { .. }
                | HydraulicError::NoEffect { .. }
                | HydraulicError::Undetermined { .. }
                | HydraulicError::Undecided { .. },
            ) => Ok(None),
            Err(error) => Err(error),
            Ok(()) if linearization.floats(network, feeder.pump) => Ok(None),
            Ok(()) => Ok(Some(-state.driving_pa(network, feeder.pump.index()))),
        }
    }

    /// Influences of actuators at the last solve.
    fn influences_here(
        &mut self,
        network: &Network,
        feeder: Feeder,
        edges: &[EdgeId],
    ) -> impl Iterator<Item = Influence> {
        let Self { linearization, response, change_pa, state, .. } = self;
        linearization.across_shut(network, feeder.pump, edges, response, change_pa);
        edges.iter().zip(change_pa).map(|(&edge, change_pa)| {
            let opposing_dp_by_position_pa = -*change_pa;
            let weight_pa = opposing_dp_by_position_pa * state.position[edge.index()];
            Influence { edge, opposing_dp_by_position_pa, weight_pa }
        })
    }
}

/// The other pump or source that holds a pump back most at a solved state; `None` where none does, or where the
/// network has no state without the pump.
pub fn culprit(network: &Network, state: &NetworkState, pump: EdgeId) -> Option<EdgeId> {
    let mut blocking = Blocking::new(network, state).ok()?;
    blocking.margin(network, Feeder { pump, check_valve: pump }).ok()?.culprit
}

/// The pump of a feeder, and its head without flow at relative speed 1, Pa.
fn pump_of(network: &Network, feeder: Feeder) -> (Option<&Pump>, f64) {
    let edge = &network.edges[feeder.pump.index()];
    match &edge.element {
        Element::Pump(pump) => (Some(pump), edge.loss_factor * pump.head_without_flow_pa()),
        _ => (None, 0.0),
    }
}

/// The relative speed at which a head without flow is that of a pump.
fn threshold(opposing_dp_pa: f64, head_pa: f64) -> f64 {
    (opposing_dp_pa / head_pa).max(0.0).sqrt()
}
