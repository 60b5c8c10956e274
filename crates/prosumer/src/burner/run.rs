//! Means over a step: the walk from event to event.

use super::sequence::{BurnerState, Phase, SAME_S};
use super::{Burner, Command, Steady};
use anergy_core::numerics::quadrature::GAUSS;

/// What a generator did on average over a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Means {
    /// Heat into the water, W.
    pub heat_w: f64,
    /// Fuel, W.
    pub fuel_w: f64,
    /// Electricity generated, W.
    pub power_w: f64,
    /// Steady heat times the share of the flow, W: what a pump that holds a temperature goes by.
    pub flow_heat_w: f64,
    /// Share of the flow.
    pub flow: f64,
    /// Share of the time in which it burns.
    pub on: f64,
    /// Mean load while it burns; 0 where it does not.
    pub modulation: f64,
}

/// A step cannot have more events than this and an event per second.
const EVENTS: usize = 64;

impl Burner {
    /// Advances a state over a step; `steady` is the steady operation at a load. A step of no length is a steady
    /// state.
    pub fn run(
        &self,
        dt_s: f64,
        command: &Command,
        state: &mut BurnerState,
        steady: impl Fn(f64) -> Steady,
    ) -> Means {
        if dt_s <= 0.0 || !self.dynamics {
            return self.at_once(dt_s.max(0.0), command, state, steady);
        }
        let mut sums = Means::default();
        // The steady operation at a load that stays.
        let mut known: Option<(f64, Steady)> = None;
        let mut at = |modulation: f64| match known {
            Some((same, operation)) if same == modulation => operation,
            _ => {
                let operation = steady(modulation);
                known = Some((modulation, operation));
                operation
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

    /// The steady operation, with neither before nor after.
    fn at_once(
        &self,
        dt_s: f64,
        command: &Command,
        state: &mut BurnerState,
        steady: impl Fn(f64) -> Steady,
    ) -> Means {
        if command.modulation <= 0.0 || command.tripped {
            if state.phase != Phase::Off {
                state.enter(Phase::Off);
            }
            state.off_s += dt_s;
            return Means::default();
        }
        if !state.phase.on() {
            state.starts += f64::from(u8::from(dt_s > 0.0));
            (state.run_s, state.off_s, state.cold) = (0.0, 0.0, 0.0);
        }
        if state.phase != Phase::Running {
            state.enter(Phase::Running);
        }
        state.modulation = self.target(command, state);
        state.phase_s += dt_s;
        state.run_s += dt_s;
        state.operating_s += dt_s;
        let Steady { heat_w, fuel_w, power_w } = steady(state.modulation);
        Means {
            heat_w,
            fuel_w,
            power_w,
            flow_heat_w: heat_w,
            flow: 1.0,
            on: 1.0,
            modulation: state.modulation,
        }
    }

    /// A stretch of time without events: adds what it brings, moves the state on.
    fn piece(
        &self,
        piece_s: f64,
        command: &Command,
        state: &mut BurnerState,
        sums: &mut Means,
        steady: &mut impl FnMut(f64) -> Steady,
    ) {
        let end = self.moved(piece_s, command, state);
        if state.phase != Phase::Off {
            for (share, weight) in GAUSS {
                let seconds = weight * piece_s;
                let modulation = state.modulation + share * (end.modulation - state.modulation);
                let factors = self.factors(state, state.phase_s + share * piece_s);
                let operation = steady(modulation);
                let warming_w = match state.phase {
                    Phase::Stopping => 0.0,
                    _ => self.warming_w(state, state.run_s + share * piece_s),
                };
                let heat_w = (operation.heat_w - warming_w).max(0.0);
                sums.heat_w += seconds * factors.heat * heat_w;
                sums.fuel_w += seconds * factors.fuel * operation.fuel_w;
                sums.power_w += seconds * factors.power * operation.power_w;
                sums.flow_heat_w += seconds * factors.flow * heat_w;
                sums.flow += seconds * factors.flow;
                if state.phase.on() {
                    sums.on += seconds;
                    sums.modulation += seconds * modulation;
                }
            }
        }
        *state = end;
    }

    /// The state after a stretch of time without events.
    fn moved(&self, piece_s: f64, command: &Command, state: &BurnerState) -> BurnerState {
        let mut end = *state;
        end.phase_s += piece_s;
        if !state.phase.on() {
            end.off_s += piece_s;
            return end;
        }
        let target = self.target(command, state);
        let step = self.slew_per_s * piece_s;
        end.modulation += (target - state.modulation).clamp(-step, step);
        end.run_s += piece_s;
        end.operating_s += piece_s;
        end
    }
}

impl Means {
    fn over(self, dt_s: f64) -> Self {
        let modulation = if self.on > 0.0 { self.modulation / self.on } else { 0.0 };
        Self {
            heat_w: self.heat_w / dt_s,
            fuel_w: self.fuel_w / dt_s,
            power_w: self.power_w / dt_s,
            flow_heat_w: self.flow_heat_w / dt_s,
            flow: self.flow / dt_s,
            on: self.on / dt_s,
            modulation,
        }
    }
}
