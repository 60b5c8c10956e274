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

use crate::elements::Element;
use crate::elements::pump::Pump;
use crate::graph::{Network, NodeKind};
use crate::hydraulics::HydraulicError;
use crate::linearize::{Cause, Linearization, Response};
use crate::state::NetworkState;
use anergy_core::ids::EdgeId;

/// A threshold is found within this of the speed.
const SPEED: f64 = 1e-7;
const MAX_ROUNDS: usize = 60;

/// A pump in series with a check valve that lets its flow pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Feeder {
    /// The pump.
    pub pump: EdgeId,
    /// The check valve.
    pub check_valve: EdgeId,
}

/// How far a feeder is from where its check valve shuts.
#[derive(Debug, Clone, PartialEq)]
pub struct Margin {
    /// Present relative speed of the pump.
    pub speed: f64,
    /// Largest one.
    pub speed_max: f64,
    /// Present flow, kg/s; not positive when it is blocked.
    pub m_flow_kg_s: f64,
    /// The relative speed below which the check valve is shut; above the largest one where none opens it.
    pub threshold_speed: f64,
    /// Pressure difference that the rest of the network puts across the pump without its flow, Pa.
    pub opposing_dp_pa: f64,
    /// Head of the pump at its present speed without flow, Pa.
    pub head_without_flow_pa: f64,
    /// What the other actuators do to the opposing pressure difference.
    pub influences: Vec<Influence>,
    /// The one among them that holds the feeder back most, if any does.
    pub culprit: Option<EdgeId>,
}

impl Margin {
    /// Present speed above the threshold; negative when the feeder is blocked.
    pub fn speed_margin(&self) -> f64 {
        self.speed - self.threshold_speed
    }

    /// Whether the pump runs and the network holds its check valve shut.
    pub fn blocked(&self) -> bool {
        self.speed > 0.0 && self.speed_margin() < 0.0
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

/// The feeders of a network, in the order of their pumps.
pub fn feeders(network: &Network) -> Vec<Feeder> {
    let mut incident: Vec<Vec<usize>> = vec![Vec::new(); network.nodes.len()];
    for (i, edge) in network.edges.iter().enumerate() {
        incident[edge.from.index()].push(i);
        incident[edge.to.index()].push(i);
    }
    let pumps = network.edges.iter().enumerate();
    pumps
        .filter(|(_, edge)| matches!(edge.element, Element::Pump(_)))
        .filter_map(|(pump, _)| {
            let check_valve = check_valve_of(network, &incident, pump)?;
            let (pump, check_valve) = (EdgeId::from_index(pump), EdgeId::from_index(check_valve));
            Some(Feeder { pump, check_valve })
        })
        .collect()
}

/// The nearest check valve that all water of the pump passes, in its direction.
fn check_valve_of(network: &Network, incident: &[Vec<usize>], pump: usize) -> Option<usize> {
    let ends = &network.edges[pump];
    for downstream in [true, false] {
        let (mut at, mut last) = (if downstream { ends.to } else { ends.from }, pump);
        // Walks away from the pump as long as there is one way on.
        for _ in 0..network.edges.len() {
            let [a, b] = incident[at.index()][..] else { break };
            if network.nodes[at.index()].kind != NodeKind::Junction || a == b {
                break;
            }
            let next = if a == last { b } else { a };
            let edge = &network.edges[next];
            let forward = (edge.from == at) == downstream;
            match edge.element {
                Element::CheckValve(_) if forward => return Some(next),
                // Against it nothing flows; a second pump has its own margin.
                Element::CheckValve(_) | Element::Pump(_) => break,
                _ => {}
            }
            (at, last) = (if edge.from == at { edge.to } else { edge.from }, next);
        }
    }
    None
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
        })
    }

    /// The feeders of the network.
    pub fn feeders(&self) -> &[Feeder] {
        &self.feeders
    }

    /// How far a feeder is from where its check valve shuts. `None` where the network has no state without
    /// its flow: flows that are given elsewhere come through it.
    ///
    /// # Errors
    /// When the network without its flow cannot be solved for another reason.
    pub fn margin(
        &mut self,
        network: &Network,
        feeder: Feeder,
    ) -> Result<Option<Margin>, HydraulicError> {
        self.back(network);
        let Some(opposing_dp_pa) = self.opposing_dp_pa(network, feeder)? else { return Ok(None) };
        let Some((pump, head_pa)) = pump_of(network, feeder) else { return Ok(None) };
        let at = self.here.edge_state(network, feeder.pump.index());
        let m_flow_kg_s = self.here.m_flow_kg_s[feeder.pump.index()];
        let speed = pump.speed(m_flow_kg_s, &at);
        let threshold_speed = threshold(opposing_dp_pa, head_pa);
        let mut influences = Vec::with_capacity(self.drives.len());
        for k in 0..self.drives.len() {
            if self.drives[k] != feeder.pump {
                influences.push(self.influence(network, feeder, self.drives[k]));
            }
        }
        let worst = influences.iter().max_by(|a, b| a.weight_pa.total_cmp(&b.weight_pa));
        let rounding = 1e-9 * opposing_dp_pa.abs();
        let culprit = worst.filter(|worst| worst.weight_pa > rounding).map(|worst| worst.edge);
        Ok(Some(Margin {
            speed,
            speed_max: pump.speed_max(),
            m_flow_kg_s,
            threshold_speed,
            opposing_dp_pa,
            head_without_flow_pa: speed * speed * head_pa,
            influences,
            culprit,
        }))
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
        self.back(network);
        let Some((_, head_pa)) = pump_of(network, feeder) else { return Ok(Vec::new()) };
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
        self.back(network);
        let Some((pump, head_pa)) = pump_of(network, feeder) else { return Ok(None) };
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
        let speed = pump.speed(self.here.m_flow_kg_s[i], &at);
        // Threshold less speed, and its change with the factor.
        let miss = |this: &mut Self, factor: f64| -> Result<Option<(f64, f64)>, HydraulicError> {
            for (edge, whole) in edges.iter().zip(&whole) {
                this.state.place_actuator(edge.index(), factor * whole);
            }
            let Some(opposing) = this.opposing_dp_pa(network, feeder)? else { return Ok(None) };
            let threshold = threshold(opposing, head_pa);
            let by_factor: f64 = edges
                .iter()
                .zip(&whole)
                .map(|(e, whole)| {
                    whole * this.influence(network, feeder, *e).opposing_dp_by_position_pa
                })
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
    fn back(&mut self, network: &Network) {
        let Self { state, here, .. } = self;
        state.position.clone_from(&here.position);
        state.m_flow_kg_s.clone_from(&here.m_flow_kg_s);
        state.p_pa.clone_from(&here.p_pa);
        state.prescribed.clone_from(&here.prescribed);
        state.regulated.clone_from(&here.regulated);
        debug_assert_eq!(network.edges.len(), state.position.len());
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
            Err(HydraulicError::Unbalanced { .. } | HydraulicError::Absurd { .. }) => Ok(None),
            Err(error) => Err(error),
            Ok(()) if linearization.floats(network, feeder.pump) => Ok(None),
            Ok(()) => Ok(Some(-state.driving_pa(network, feeder.pump.index()))),
        }
    }

    /// Influence of an actuator at the last solve.
    fn influence(&mut self, network: &Network, feeder: Feeder, edge: EdgeId) -> Influence {
        self.linearization.respond(network, Cause::Position(edge), &mut self.response);
        let opposing_dp_by_position_pa = -self.response.dp_pa(network, feeder.pump);
        let weight_pa = opposing_dp_by_position_pa * self.state.position[edge.index()];
        Influence { edge, opposing_dp_by_position_pa, weight_pa }
    }
}

/// The pump of a feeder, and its head without flow at relative speed 1, Pa.
fn pump_of(network: &Network, feeder: Feeder) -> Option<(&Pump, f64)> {
    let edge = &network.edges[feeder.pump.index()];
    match &edge.element {
        Element::Pump(pump) => Some((pump, edge.loss_factor * pump.head_without_flow_pa())),
        _ => None,
    }
}

/// The relative speed at which a head without flow is that of a pump.
fn threshold(opposing_dp_pa: f64, head_pa: f64) -> f64 {
    (opposing_dp_pa / head_pa).max(0.0).sqrt()
}
