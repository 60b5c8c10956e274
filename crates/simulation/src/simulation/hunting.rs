//! Watches the pumps that controllers drive: one that swings alone oscillates, pumps that swing against each
//! other hunt.
//!
//! **Equation** a pump swings when its flow does (`control/swing.rs`) by more than 20 % of its set flow, or of
//! its mean flow where its controller holds something else, and by 0.2 l/min at least, with a period of 4 to
//! 60 s (20 min where a temperature is held) over three periods. It hunts when its correlation with another
//! such pump is below -0.5. **Sources** specification 4.3.

use super::Simulation;
use crate::channels::Source;
use crate::gains::measured;
use crate::plan::{Plan, SwingWatch};
use crate::state::State;
use anergy_control::swing::{Criterion, Swing};
use anergy_core::clock::Time;
use anergy_core::recorder::{Event, Severity};
use anergy_core::units::l_min;
use anergy_network::elements::Element;
use serde::{Deserialize, Serialize};

/// Least swing relative to the flow that is wanted.
const LEAST_SHARE: f64 = 0.2;
/// Least swing, m3/s: 0.2 l/min.
const LEAST_M3_S: f64 = 0.2 / 60_000.0;
const SHORTEST_S: f64 = 4.0;
const LONGEST_FLOW_S: f64 = 60.0;
const LONGEST_TEMPERATURE_S: f64 = 1200.0;
const AGAINST: f64 = -0.5;

/// What is known of a watched pump.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(crate) enum Said {
    #[default]
    Quiet,
    Oscillating,
    Hunting,
}

/// A watched pump.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct SwingState {
    pub swing: Swing,
    pub said: Said,
    /// Time spent swinging alone, s, and against others, s.
    pub oscillating_s: f64,
    pub hunting_s: f64,
    /// Largest swing, kg/s, and its period, s.
    pub largest_kg_s: f64,
    pub period_s: f64,
}

/// The pumps that controllers drive, with the set flow where the controller holds the flow.
pub(crate) fn watches(plan: &Plan) -> Vec<SwingWatch> {
    let mut watches = Vec::new();
    for (controller, planned) in plan.controllers.iter().enumerate() {
        for signal in &planned.acts_on {
            let driven = plan.commands.iter().position(|command| *command == Some(*signal));
            let Some(edge) = driven else { continue };
            if !matches!(plan.network.edges[edge].element, Element::Pump(_)) {
                continue;
            }
            let (of, _) = measured(plan, planned.measures[0]);
            let holds_flow = matches!(of, Source::EdgeFlow(_) | Source::StationFlow(_))
                && planned.controller.tracks();
            let slow = planned.measures.iter().any(|source| {
                !matches!(
                    measured(plan, *source).0,
                    Source::EdgeFlow(_)
                        | Source::StationFlow(_)
                        | Source::EdgePressure(_)
                        | Source::NodePressure(_)
                        | Source::WorstPoint(_)
                )
            });
            watches.push(SwingWatch { controller, edge, holds_flow, slow });
        }
    }
    watches
}

impl Simulation {
    /// Follows the flows of the watched pumps and says what begins and ends.
    pub(super) fn watch_swings(&mut self, end: Time, dt_s: f64) {
        let density = self.plan.network.medium.density_kg_m3;
        for (i, watch) in self.plan.swing_watches.iter().enumerate() {
            let flow = self.state.network.m_flow_kg_s[watch.edge];
            let wanted = if watch.holds_flow {
                self.state.signals[self.plan.controllers[watch.controller].set_points.start]
            } else {
                self.state.swings[i].swing.middle()
            };
            let least = (LEAST_SHARE * wanted.abs()).max(LEAST_M3_S * density);
            let longest_s = if watch.slow { LONGEST_TEMPERATURE_S } else { LONGEST_FLOW_S };
            let criterion = Criterion { shortest_s: SHORTEST_S, longest_s };
            self.state.swings[i].swing.follow(end.as_s(), flow, least, criterion);
        }
        for i in 0..self.plan.swing_watches.len() {
            let swing = &self.state.swings[i].swing;
            let partner = if swing.swinging() { partner(&self.state, i) } else { None };
            let now = match (swing.swinging(), &partner) {
                (false, _) => Said::Quiet,
                (true, None) => Said::Oscillating,
                (true, Some(_)) => Said::Hunting,
            };
            let before = self.state.swings[i].said;
            // What hunts goes on hunting while it swings: correlation may be lost near the end.
            let now =
                if before == Said::Hunting && now == Said::Oscillating { before } else { now };
            if now != before {
                let event = swing_event(&self.plan, &self.state, i, end, now, partner);
                self.events.push(event);
            }
            let own = &mut self.state.swings[i];
            own.said = now;
            match now {
                Said::Quiet => {}
                Said::Oscillating => own.oscillating_s += dt_s,
                Said::Hunting => own.hunting_s += dt_s,
            }
            let size = own.swing.peak_to_peak();
            if now != Said::Quiet && size > own.largest_kg_s {
                (own.largest_kg_s, own.period_s) = (size, own.swing.period_s());
            }
        }
    }
}

/// The pump that swings most clearly against this one.
fn partner(state: &State, i: usize) -> Option<(usize, f64)> {
    let own = &state.swings[i].swing;
    let others = state.swings.iter().enumerate().filter(|(k, _)| *k != i);
    others
        .filter_map(|(k, other)| Some((k, own.correlation(&other.swing)?)))
        .filter(|(_, correlation)| *correlation < AGAINST)
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

fn swing_event(
    plan: &Plan,
    state: &State,
    i: usize,
    time: Time,
    now: Said,
    partner: Option<(usize, f64)>,
) -> Event {
    let name = |i: usize| plan.edge_names[plan.swing_watches[i].edge].clone();
    let component = name(i);
    let swing = &state.swings[i].swing;
    let density = plan.network.medium.density_kg_m3;
    let size = l_min(swing.peak_to_peak(), density);
    let how = format!("{size:.2} l/min peak to peak, period {:.1} s", swing.period_s());
    let before = state.swings[i].said;
    let (severity, kind, message) = match (now, partner) {
        (Said::Hunting, Some((other, correlation))) => (
            Severity::Warning,
            "hunting",
            format!(
                "{component} hunts against {}: {how}, correlation {correlation:.2}",
                name(other)
            ),
        ),
        (Said::Quiet, _) if before == Said::Hunting => {
            (Severity::Info, "hunting_ended", format!("{component} hunts no more"))
        }
        (Said::Quiet, _) => {
            (Severity::Info, "oscillating_ended", format!("{component} oscillates no more"))
        }
        _ => (Severity::Warning, "oscillating", format!("{component} oscillates: {how}")),
    };
    Event { time, severity, component: component.into(), kind: kind.into(), message }
}
