//! Patterns of an EPANET network as schedules.

use super::network::{LinkKind, NodeKind};
use super::reach::Reach;
use super::translate::Writer;
use crate::NoteKind;

/// Periods of a schedule, at most.
const LONGEST: f64 = 100_000.0;

impl Writer<'_> {
    /// A schedule for each demand, reservoir and pump that changes until the end.
    pub(super) fn schedules(&mut self, reach: &Reach) {
        let (network, options) = (self.network, self.options);
        if options.duration_s <= 0.0 {
            return;
        }
        if options.duration_s / options.pattern_step_s > LONGEST {
            let what = format!("patterns: there are more than {LONGEST} periods");
            self.text.note(NoteKind::Problem, None, what);
            return;
        }
        let (pa_m, density) = (options.pa_m(), options.density_kg_m3());
        for (node, _) in network.nodes.iter().zip(&reach.nodes).filter(|(_, kept)| **kept) {
            match &node.kind {
                NodeKind::Junction { demands, .. } => {
                    self.schedule(&format!("{}.m_flow_kg_s", node.id), |period| {
                        0.0 - density * network.demand_m3_s(demands, options, period)
                    });
                }
                NodeKind::Reservoir { pattern } => {
                    let factor = |period| network.factor(pattern.as_ref(), options, period);
                    self.schedule(&format!("{}.pressure_pa", node.id), |period| {
                        (factor(period) - factor(0)) * node.elevation_m * pa_m
                    });
                }
                NodeKind::Tank { .. } => {}
            }
        }
        for (link, _) in network.links.iter().zip(&reach.links).filter(|(_, kept)| **kept) {
            if let LinkKind::Pump { pattern: pattern @ Some(_), head_times_flow_m4_s, .. } =
                &link.kind
            {
                if head_times_flow_m4_s.is_some() {
                    let what = "its pattern, as a constant power does not depend on the speed";
                    link.note(self.text, NoteKind::NotTranslated, what);
                    continue;
                }
                let rests = self.schedule(&format!("{}.speed", link.id), |period| {
                    network.factor(pattern.as_ref(), options, period).max(0.0)
                });
                if rests {
                    let what = "where its pattern is zero it stands still and lets water pass";
                    link.note(self.text, NoteKind::Changed, what);
                }
            }
        }
    }

    /// Writes the values of all periods that differ from the one before, if any does; whether one is
    /// zero.
    fn schedule(&mut self, signal: &str, value: impl Fn(usize) -> f64) -> bool {
        let options = self.options;
        let step = options.pattern_step_s;
        let offset = options.pattern_start_s % step;
        let periods = (options.duration_s / step).ceil() as usize;
        let mut points = vec![(0.0, value(0))];
        for period in 1..=periods {
            let (time, now) = (period as f64 * step - offset, value(period));
            if time < options.duration_s && points.last().is_some_and(|last| last.1 != now) {
                points.push((time, now));
            }
        }
        if points.len() > 1 {
            self.text.schedule(signal, &points);
        }
        points.iter().any(|point| point.1 == 0.0)
    }
}
