//! Fewer rounds to the steady temperatures of units.
//!
//! **Equation** what a unit and the water behind its exchanger carry from round to round nears its end like
//! `x = x_end + c r^k` where little primary water flows: `1 - r` is about the ratio of the two flows, 1e-5
//! behind a closed valve. Aitken's extrapolation of each number, `x + d r/(1 - r)` with its last change `d` and
//! the ratio `r` of its last two changes, jumps to that end.
//!
//! **Numerics** only slow numbers (`r` above one half) are moved, and only to temperatures at which the water is liquid.
//! Where a jump makes the next change larger than the last one before, the following jumps come half as
//! often: in the limit these are the plain rounds. **Sources** `aitken1926`.

use crate::simulation::Simulation;

/// Rounds from jump to jump, at least: the changes after a jump must have found their ratio.
const LEAST_ROUNDS: u32 = 6;
/// Ratios of changes that are extrapolated.
const RATIOS: std::ops::Range<f64> = 0.5..1.0;

/// The last rounds.
#[derive(Debug, Default)]
pub(super) struct Acceleration {
    /// What was carried two rounds ago, one round ago.
    before: Vec<f64>,
    last: Vec<f64>,
    rounds: u32,
    wait: u32,
    /// Largest change before the last jump, until that jump is judged.
    change_before_jump: Option<f64>,
}

impl Acceleration {
    /// Looks at the round that was just done, and now and then jumps ahead.
    pub(super) fn after_round(&mut self, simulation: &mut Simulation) {
        let state = simulation.state_mut();
        let carried = state.network.t_secondary_k.iter_mut().chain(&mut state.unit_states);
        let mut now: Vec<f64> = carried.map(|x| *x).collect();
        let largest = self.last.iter().zip(&now).map(|(x, y)| (y - x).abs()).fold(0.0, f64::max);
        self.rounds += 1;
        if self.rounds == 1
            && let Some(before) = self.change_before_jump.take()
        {
            self.wait = if largest < before { LEAST_ROUNDS } else { self.wait.saturating_mul(2) };
        }
        if self.rounds >= self.wait.max(LEAST_ROUNDS) && self.before.len() == now.len() {
            let medium = simulation.plan().network().medium;
            let mut jumped = false;
            for (i, x) in now.iter_mut().enumerate() {
                let (first, second) = (self.last[i] - self.before[i], *x - self.last[i]);
                let ratio = second / first;
                let end = *x + second * ratio / (1.0 - ratio);
                if RATIOS.contains(&ratio) && medium.is_liquid(end) && end != *x {
                    *x = end;
                    jumped = true;
                }
            }
            if jumped {
                self.change_before_jump = Some(largest);
                self.rounds = 0;
                let state = simulation.state_mut();
                let carried = state.network.t_secondary_k.iter_mut().chain(&mut state.unit_states);
                carried.zip(&now).for_each(|(carried, x)| *carried = *x);
            }
        }
        std::mem::swap(&mut self.before, &mut self.last);
        self.last = now;
    }
}
