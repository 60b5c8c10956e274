//! Means over a step: the walk from event to event.

use super::phase::{CompressorState, Phase, SAME_S};
use super::{Command, Compressor};
use crate::performance_map::Performance;
use anergy_core::numerics::quadrature::GAUSS;

/// What a compressor did on average over a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Means {
    /// Heat into the water, W: negative in cooling, and while heat is drawn from water that should be heated.
    pub water_w: f64,
    /// Electricity of the compressor and its unit, W.
    pub electric_w: f64,
    /// Steady heat or cold times the share of the flow, W: what a pump that holds a difference goes by.
    pub flow_useful_w: f64,
    /// The same of the steady electricity, W.
    pub flow_electric_w: f64,
    /// Share of the flow.
    pub flow: f64,
    /// Share of the flow while the compressor is on.
    pub flow_on: f64,
    /// Share of the time in which the compressor is on.
    pub on: f64,
    /// Share of the time in which it defrosts.
    pub defrosting: f64,
    /// Mean speed while it is on, as a share of the full one; 0 where it is off.
    pub modulation: f64,
}

/// A step cannot have more events than this and an event per second.
const EVENTS: usize = 64;

impl Compressor {
    /// Advances a state over a step; `steady` is the map at a speed in
    /// heating or cooling. A step of no length is a steady state.
    pub fn run(
        &self,
        dt_s: f64,
        command: &Command,
        state: &mut CompressorState,
        mut steady: impl FnMut(f64, bool) -> Performance,
    ) -> Means {
        if dt_s <= 0.0 || !self.dynamics {
            return self.at_once(dt_s.max(0.0), command, state, steady);
        }
        let mut sums = Means::default();
        // The map at a speed that stays.
        let mut known: Option<((f64, bool), Performance)> = None;
        let mut at = |modulation: f64, cooling: bool| match known {
            Some((same, performance)) if same == (modulation, cooling) => performance,
            _ => {
                let performance = steady(modulation, cooling);
                known = Some(((modulation, cooling), performance));
                performance
            }
        };
        let mut left_s = dt_s;
        for _ in 0..EVENTS + dt_s as usize {
            self.switch(command, state);
            let piece_s = self.next_event_s(command, state).min(left_s);
            self.piece(piece_s, command, state, &mut sums, &mut at);
            left_s -= piece_s;
            if left_s <= SAME_S {
                break;
            }
        }
        self.switch(command, state);
        sums.over(dt_s)
    }

    /// The steady map, with neither before nor after.
    fn at_once(
        &self,
        dt_s: f64,
        command: &Command,
        state: &mut CompressorState,
        mut steady: impl FnMut(f64, bool) -> Performance,
    ) -> Means {
        if !command.on || command.tripped {
            state.enter(Phase::Off);
            state.flow = 0.0;
            state.off_s += dt_s;
            return Means::default();
        }
        if !state.phase.on() {
            state.starts += f64::from(u8::from(dt_s > 0.0));
            state.run_s = 0.0;
            state.off_s = 0.0;
        }
        if state.phase != Phase::Running {
            state.enter(Phase::Running);
        }
        state.cooling = command.cooling;
        state.modulation = self.target(command);
        state.flow = 1.0;
        state.phase_s += dt_s;
        state.run_s += dt_s;
        state.operating_s += dt_s;
        let Performance { useful_w, electric_w } = steady(state.modulation, state.cooling);
        Means {
            water_w: sign(state.cooling) * useful_w,
            electric_w,
            flow_useful_w: useful_w,
            flow_electric_w: electric_w,
            flow: 1.0,
            flow_on: 1.0,
            on: 1.0,
            defrosting: 0.0,
            modulation: state.modulation,
        }
    }

    /// A stretch of time without events: adds what it brings, moves the state on.
    fn piece(
        &self,
        piece_s: f64,
        command: &Command,
        state: &mut CompressorState,
        sums: &mut Means,
        steady: &mut impl FnMut(f64, bool) -> Performance,
    ) {
        let end = self.moved(piece_s, command, state);
        if state.phase != Phase::Off {
            for (share, weight) in GAUSS {
                let seconds = weight * piece_s;
                let between = |a: f64, b: f64| a + share * (b - a);
                let modulation = between(state.modulation, end.modulation);
                let flow = between(state.flow, end.flow);
                let (heat, power) = self.factors(state, state.phase_s + share * piece_s);
                let performance = steady(modulation, state.cooling);
                sums.flow += seconds * flow;
                sums.flow_useful_w += seconds * flow * performance.useful_w;
                sums.flow_electric_w += seconds * flow * performance.electric_w;
                match (state.phase, self.defrost) {
                    (Phase::Defrosting, Some(defrost)) => {
                        let speed = modulation.max(defrost.least_modulation);
                        sums.water_w -= seconds * defrost.heat_w * speed;
                        sums.electric_w += seconds * defrost.electric_w;
                        sums.defrosting += seconds;
                    }
                    _ => {
                        sums.water_w += sign(state.cooling) * seconds * heat * performance.useful_w;
                        sums.electric_w += seconds * power * performance.electric_w;
                    }
                }
                if state.phase.on() {
                    sums.on += seconds;
                    sums.flow_on += seconds * flow;
                    sums.modulation += seconds * modulation;
                }
            }
        }
        *state = end;
    }

    /// The state after a stretch of time without events.
    fn moved(&self, piece_s: f64, command: &Command, state: &CompressorState) -> CompressorState {
        let mut end = *state;
        end.phase_s += piece_s;
        if state.phase != Phase::Off {
            end.flow = if self.flow_rise_s > 0.0 {
                (state.flow + piece_s / self.flow_rise_s).min(1.0)
            } else {
                1.0
            };
        }
        if !state.phase.on() {
            end.off_s += piece_s;
            end.frost_s = (state.frost_s + piece_s * command.frost_rate.min(0.0)).max(0.0);
            return end;
        }
        let target = self.target(command);
        end.modulation = (state.modulation + self.slew_per_s * piece_s).min(target);
        end.run_s += piece_s;
        end.operating_s += piece_s;
        if state.phase == Phase::Defrosting {
            end.defrosting_s += piece_s;
        } else if !state.cooling {
            end.frost_s = (state.frost_s + piece_s * command.frost_rate).max(0.0);
        }
        end
    }
}

/// Heating warms the water, cooling cools it.
fn sign(cooling: bool) -> f64 {
    if cooling { -1.0 } else { 1.0 }
}

impl Means {
    /// Heat that the other side gives, W: negative where it takes.
    pub fn other_side_w(&self, heat_share: f64) -> f64 {
        self.water_w - heat_share * self.electric_w
    }

    fn over(self, dt_s: f64) -> Self {
        let modulation = if self.on > 0.0 { self.modulation / self.on } else { 0.0 };
        Self {
            water_w: self.water_w / dt_s,
            electric_w: self.electric_w / dt_s,
            flow_useful_w: self.flow_useful_w / dt_s,
            flow_electric_w: self.flow_electric_w / dt_s,
            flow: self.flow / dt_s,
            flow_on: self.flow_on / dt_s,
            on: self.on / dt_s,
            defrosting: self.defrosting / dt_s,
            modulation,
        }
    }
}
