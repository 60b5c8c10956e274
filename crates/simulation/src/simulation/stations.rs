//! Watches the stations: raises and clears their flags, says who holds a blocked one back, keeps the spans.

use super::Simulation;
use super::words::{Delivery, blocked_event};
use anergy_core::clock::Time;
use anergy_core::ids::EdgeId;
use anergy_network::blocking::culprit;
use serde::{Deserialize, Serialize};

/// Spans that a run remembers; its events have all of them.
const MOST_SPANS: usize = 1000;

/// A time for which the flag of a station was up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct BlockedSpan {
    pub station: usize,
    pub from: Time,
    /// None while it is up.
    pub to: Option<Time>,
    /// The pump or source that held it back most when the flag went up.
    pub by: Option<EdgeId>,
}

impl Simulation {
    /// Stations raise and clear their flag.
    pub(super) fn watch_stations(&mut self, end: Time, dt_s: f64) {
        for (i, station) in self.plan.stations.iter().enumerate() {
            let (network, state) = (&self.plan.network, &self.state.network);
            let memory = &mut self.state.stations[i];
            let delivery = station.delivery(memory);
            let pump = delivery.map(|(pump, ..)| pump);
            let command = pump
                .and_then(|pump| self.plan.commands[pump.index()])
                .map_or(0.0, |id| self.state.signals[id.index()]);
            let Some(blocked) = station.watch(network, state, command, dt_s, memory) else {
                continue;
            };
            let by = pump.filter(|_| blocked);
            let by = by.and_then(|pump| culprit(network, state, pump));
            let delivery = Delivery {
                flow_kg_s: delivery.map_or(1.0, |d| d.2) * station.m_flow_kg_s(state),
                wanted_kg_s: delivery.map_or(0.0, |d| d.1),
                held_back_by: by,
            };
            self.events.push(blocked_event(&self.plan, i, end, blocked, delivery));
            let spans = &mut self.state.blocked_spans;
            if blocked && spans.len() < MOST_SPANS {
                spans.push(BlockedSpan { station: i, from: end, to: None, by });
            } else if let Some(span) =
                spans.iter_mut().rev().find(|span| span.station == i && span.to.is_none())
            {
                span.to = Some(end);
            }
        }
    }
}
