//! Units advance in turns, so that those that sum up their site see what the others did in the same step; outputs that
//! say that something is wrong become events.

use super::Simulation;
use crate::plan::OfSite;
use anergy_core::clock::Time;
use anergy_core::recorder::{Event, Severity};
use anergy_core::signal::Signals;
use anergy_prosumer::thermal_unit::Exchange;

/// Turns of the units that follow their site: see `build/site_inputs.rs`.
const LAST_TURN: usize = 3;

impl Simulation {
    /// Units take what their ports got.
    pub(super) fn advance_in_turn(&mut self, dt_s: f64) {
        if self.plan.site_inputs.is_empty() {
            (0..self.plan.units.len()).for_each(|unit| self.advance_unit(unit, dt_s));
            return;
        }
        // Electricity of those that have not had their turn counts nothing.
        for (unit, exchange) in self.plan.units.iter().zip(&mut self.state.unit_exchange) {
            if unit.turn >= 2 {
                *exchange = Exchange::default();
            }
        }
        for turn in 0..=LAST_TURN {
            for unit in 0..self.plan.units.len() {
                if self.plan.units[unit].turn == turn {
                    self.follow_site(unit);
                    self.advance_unit(unit, dt_s);
                }
            }
        }
    }

    fn advance_unit(&mut self, i: usize, dt_s: f64) {
        let (unit, state) = (&self.plan.units[i], &mut self.state);
        state.unit_exchange[i] = unit.equipment.advance(
            dt_s,
            &Signals(&state.signals[unit.inputs.clone()]),
            &state.unit_ports[unit.slots.clone()],
            &mut state.unit_states[unit.state.clone()],
            &mut state.unit_outputs[unit.outputs.clone()],
        );
    }

    /// Sums up the site of a unit for those of its inputs that follow it.
    fn follow_site(&mut self, unit: usize) {
        let (plan, state) = (&self.plan, &mut self.state);
        // In the order of the units.
        let first = plan.site_inputs.partition_point(|input| input.unit < unit);
        for input in plan.site_inputs[first..].iter().take_while(|input| input.unit == unit) {
            if state.taken_over[input.signal.index()] {
                continue;
            }
            let value: f64 = match &input.of {
                OfSite::Outputs(places) => places.iter().map(|i| state.unit_outputs[*i]).sum(),
                OfSite::Mean(places) => {
                    let sum: f64 = places.iter().map(|i| state.unit_outputs[*i]).sum();
                    sum / places.len() as f64
                }
                OfSite::Electricity { units, pumps } => {
                    let units_w: f64 =
                        units.iter().map(|unit| state.unit_exchange[*unit].electric_w).sum();
                    let pump_w = |pump: &usize| plan.electric_w(&state.network, *pump);
                    units_w + pumps.iter().map(pump_w).sum::<f64>()
                }
                OfSite::Reactive { units, pumps } => {
                    let unit_w = |unit: usize| state.unit_exchange[unit].electric_w;
                    let units = units.iter().map(|(unit, share)| share * unit_w(*unit));
                    let pump_w = |pump: usize| plan.electric_w(&state.network, pump);
                    let pumps = pumps.iter().map(|(pump, share)| share * pump_w(*pump));
                    units.chain(pumps).sum()
                }
            };
            let spec = plan.signals.spec(input.signal);
            state.signals[input.signal.index()] = value.clamp(spec.min, spec.max);
        }
    }

    /// Events of flags of units that went up in a step that ended at `end`.
    pub(super) fn watch_flags(&mut self, end: Time) {
        for i in 0..self.plan.flags.len() {
            let planned = self.plan.flags[i];
            let up = self.state.unit_outputs[planned.output] != 0.0;
            if up && !self.state.unit_flags[i] {
                let component = self.plan.units[planned.unit].name.to_string();
                self.events.push(Event {
                    time: end,
                    severity: Severity::Warning,
                    kind: planned.flag.output.into(),
                    message: format!("{component}: {}", planned.flag.meaning),
                    component,
                });
            }
            self.state.unit_flags[i] = up;
        }
    }

    /// Warnings of units about how they were parametrised.
    pub(crate) fn unit_remarks(&self) -> Vec<Event> {
        let remarks = self.plan.units.iter().flat_map(|unit| {
            let event = |remark: String| Event {
                time: self.state.time,
                severity: Severity::Warning,
                kind: "remark".into(),
                message: format!("{}: {remark}", unit.name),
                component: unit.name.to_string(),
            };
            unit.equipment.remarks().into_iter().map(event)
        });
        remarks.collect()
    }
}
