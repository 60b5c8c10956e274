//! Hydraulic interfaces: where a thermal-only prosumer meets the network.
//!
//! A [`Station`] watches one flow (positive in feed-in) and the pump that is to deliver it, and raises
//! the flag `blocked` when the network does not let it.
//!
//! **Equation** the flag is set when the pump has been on, at its upper limit or at its commanded fixed
//! speed, for more than 60 s with `V_act < 0.5 V_set`; cleared when `V_act > 0.6 V_set` or the pump is
//! off. Interlock: the extraction valve opens only when the feed-in pump has run down below 2 % speed. **Sources** specification 11 (`angelidis2023`).

use crate::graph::Network;
use crate::state::NetworkState;
use anergy_core::ids::EdgeId;
use serde::{Deserialize, Serialize};

/// A flow below this share of the wanted one counts as held back.
pub const BLOCKED_BELOW: f64 = 0.5;
/// A flow above this share clears the flag.
pub const CLEARED_ABOVE: f64 = 0.6;
/// A pump must have been held back this long, s.
pub const BLOCKED_AFTER_S: f64 = 60.0;
/// Below this speed a pump has run down (interlock of a bidirectional station).
const RUN_DOWN: f64 = 0.02;
/// A speed this close to its limit or command has arrived there.
const ARRIVED: f64 = 1e-3;

/// A hydraulic interface in the network.
#[derive(Debug, Clone, PartialEq)]
pub struct Station {
    /// The edge whose flow from a to b is the station's feed-in.
    pub edge: EdgeId,
    /// The pump that feeds in.
    pub pump: Option<EdgeId>,
    /// The valve that extracts; it stays closed until the pump has run down.
    pub valve: Option<EdgeId>,
    /// The pump that extracts.
    pub extraction_pump: Option<EdgeId>,
    /// Flow the pump means to deliver, kg/s; decides the flag.
    pub requested_m_flow_kg_s: Option<f64>,
}

/// Delivers what a unit asks for in its direction, with a pause between the directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Length of the pause, s; without one the direction changes within a step.
    pub dead_time_s: f64,
}

/// What is asked of a station, kg/s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Demand {
    /// Flow of feed-in.
    pub feed_in_kg_s: f64,
    /// Flow of extraction.
    pub extraction_kg_s: f64,
}

impl Demand {
    /// Flow with its sign: positive in feed-in.
    pub fn m_flow_kg_s(&self) -> f64 {
        self.feed_in_kg_s - self.extraction_kg_s
    }
}

impl Drive {
    /// What the pumps are told in a step, given what the unit wants (positive in feed-in).
    pub fn demand(&self, wanted_kg_s: f64, memory: &StationState) -> Demand {
        let against = wanted_kg_s * memory.direction < 0.0 && self.dead_time_s > 0.0;
        if against || memory.pause_s > 0.0 {
            return Demand::default();
        }
        Demand { feed_in_kg_s: wanted_kg_s.max(0.0), extraction_kg_s: (-wanted_kg_s).max(0.0) }
    }

    /// Remembers the direction after a step.
    pub fn remember(&self, wanted_kg_s: f64, dt_s: f64, memory: &mut StationState) {
        if wanted_kg_s == 0.0 {
            memory.pause_s = (memory.pause_s - dt_s).max(0.0);
        } else if wanted_kg_s * memory.direction < 0.0 {
            // The step itself was a part of the pause.
            memory.pause_s = (self.dead_time_s - dt_s).max(0.0);
            memory.direction = wanted_kg_s.signum();
        } else {
            memory.direction = wanted_kg_s.signum();
            memory.pause_s = (memory.pause_s - dt_s).max(0.0);
        }
    }
}

/// What a station remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct StationState {
    /// Whether the network holds the pump back.
    pub blocked: bool,
    /// How long the pump has been held back, s.
    pub held_back_s: f64,
    /// How long the flag has been set in this run, s.
    pub blocked_s: f64,
    /// Direction in which it delivered last: 1 feed-in, -1 extraction, 0 none yet.
    direction: f64,
    /// What is left of the pause between two directions, s.
    pub pause_s: f64,
    /// What the unit behind a driven station asked of it in the last step.
    pub demand: Demand,
}

impl Station {
    /// Flow of the station, kg/s; positive in feed-in.
    #[inline]
    pub fn m_flow_kg_s(&self, state: &NetworkState) -> f64 {
        state.m_flow_kg_s[self.edge.index()]
    }

    /// Whether the extraction valve may open: a running feed-in pump beside it would only pump in a
    /// circle.
    pub fn valve_may_open(&self, state: &NetworkState) -> bool {
        self.pump.is_none_or(|pump| state.position[pump.index()] < RUN_DOWN)
    }

    /// The pump or valve that delivers now, the flow that is wanted of it, kg/s, and its direction.
    pub fn delivery(&self, memory: &StationState) -> Option<(EdgeId, f64, f64)> {
        let Demand { feed_in_kg_s, extraction_kg_s } = memory.demand;
        if extraction_kg_s > 0.0 {
            return Some((self.extraction_pump.or(self.valve)?, extraction_kg_s, -1.0));
        }
        let wanted =
            if feed_in_kg_s > 0.0 { Some(feed_in_kg_s) } else { self.requested_m_flow_kg_s };
        Some((self.pump?, wanted?, 1.0))
    }

    /// Updates the flag after a step; `command` is the command of what delivers. Returns the new flag
    /// when it changed.
    pub fn watch(
        &self,
        network: &Network,
        state: &NetworkState,
        command: f64,
        dt_s: f64,
        memory: &mut StationState,
    ) -> Option<bool> {
        let Some((pump, wanted, direction)) = self.delivery(memory) else {
            memory.held_back_s = 0.0;
            return std::mem::take(&mut memory.blocked).then_some(false);
        };
        let element = &network.edges[pump.index()].element;
        let speed = state.position[pump.index()];
        let limit = element.actuator().map_or(1.0, |actuator| actuator.max);
        let target = element.target_at_flow(command, state.m_flow_kg_s[pump.index()]);
        let flow = direction * self.m_flow_kg_s(state);
        let was_blocked = memory.blocked;
        if memory.blocked {
            memory.blocked_s += dt_s;
        }
        if target <= 0.0 || flow > CLEARED_ABOVE * wanted {
            (memory.blocked, memory.held_back_s) = (false, 0.0);
        } else if flow < BLOCKED_BELOW * wanted
            && ((speed - target).abs() < ARRIVED || speed > limit - ARRIVED)
        {
            memory.held_back_s += dt_s;
            memory.blocked |= memory.held_back_s > BLOCKED_AFTER_S;
        } else {
            memory.held_back_s = 0.0;
        }
        (memory.blocked != was_blocked).then_some(memory.blocked)
    }
}
