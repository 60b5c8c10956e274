//! Fewer rounds to the steady temperatures of units, and an end where the rounds swing.
//!
//! **Equation** a round makes `f(x)` of what units and the water behind their exchangers carry.
//! - Where little primary water flows it nears its end like `x = x_end + c r^k`: `1 - r` is about the ratio of the two
//!   flows, 1e-5 behind a closed valve. Aitken's extrapolation of each number, `x + d r/(1 - r)` with its last change `d`
//!   and the ratio `r` of its last two changes, jumps to that end.
//! - Where the flow that a unit asks for falls steeply with the temperature of its supply, and that rises with the flow (a
//!   circulation at the end of a long pipe), `f` falls with a slope below -1 and the rounds swing for ever. Each number
//!   goes the share `s` of its way, `x + s (f(x) - x)`: half as much after each swing, `2^(1/n)` as
//!   much after two changes in one direction, at most all of it; `n` counts the swings, so that no number of rounds in one direction
//!   between two swings undoes them for ever. That ends where `f` falls continuously, however steep.
//!
//! **Numerics** only slow numbers (`r` above one half) that go all of their way jump, and only to temperatures at which the water is liquid.
//! Where a jump makes the next change larger than the last one before, the following jumps come half as
//! often: in the limit these are the plain rounds. **Sources** `aitken1926`.

use crate::simulation::Simulation;
use crate::state::State;

/// Rounds from jump to jump, at least: the changes after a jump must have found their ratio.
const LEAST_ROUNDS: u32 = 6;
/// Ratios of changes that are extrapolated.
const RATIOS: std::ops::Range<f64> = 0.5..1.0;
/// Ratios of changes below this are swings that take long to die, or do not.
const SWINGS: f64 = -0.5;
/// Least share of the way.
const LEAST_SHARE: f64 = 1e-6;
/// A number that goes a share of its way has settled when the whole way is no longer, relative to it: 3e-9 K.
const SETTLED: f64 = 1e-11;

/// The last rounds.
#[derive(Debug, Default)]
pub(super) struct Acceleration {
    /// What was carried two rounds ago, one round ago.
    before: Vec<f64>,
    last: Vec<f64>,
    /// Whole way of each number in the last round, and the share of it that it goes.
    ways: Vec<f64>,
    shares: Vec<f64>,
    /// Swings of each number.
    swings: Vec<u32>,
    rounds: u32,
    wait: u32,
    /// Largest change before the last jump, until that jump is judged.
    change_before_jump: Option<f64>,
}

/// What goes from round to round: temperatures behind exchangers, what units heard of their ports, and their states.
fn carried(state: &mut State) -> impl Iterator<Item = &mut f64> {
    let heard = state.unit_ports.iter_mut().map(|port| &mut port.t_in_k);
    state.network.t_secondary_k.iter_mut().chain(heard).chain(&mut state.unit_states)
}

impl Acceleration {
    /// Whether a number that goes a share of its way has more to go after the round that was just done.
    pub(super) fn far(&self, simulation: &mut Simulation) -> bool {
        let now = carried(simulation.state_mut());
        let numbers = now.zip(&self.last).zip(&self.shares);
        numbers.into_iter().any(|((x, last), share)| {
            *share < 1.0 && (*x - last).abs() > SETTLED * (1.0 + last.abs())
        })
    }

    /// Looks at the round that was just done, goes a share of its way, and now and then jumps ahead.
    pub(super) fn after_round(&mut self, simulation: &mut Simulation) {
        let mut now: Vec<f64> = carried(simulation.state_mut()).map(|x| *x).collect();
        let largest = self.last.iter().zip(&now).map(|(x, y)| (y - x).abs()).fold(0.0, f64::max);
        self.go(&mut now);
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
                if self.shares[i] == 1.0
                    && RATIOS.contains(&ratio)
                    && medium.is_liquid(end)
                    && end != *x
                {
                    *x = end;
                    jumped = true;
                }
            }
            if jumped {
                self.change_before_jump = Some(largest);
                self.rounds = 0;
            }
        }
        carried(simulation.state_mut()).zip(&now).for_each(|(carried, x)| *carried = *x);
        std::mem::swap(&mut self.before, &mut self.last);
        self.last = now;
    }

    /// Each number goes its share of the way from the last round.
    fn go(&mut self, now: &mut [f64]) {
        if self.last.len() != now.len() {
            self.ways = vec![0.0; now.len()];
            self.shares = vec![1.0; now.len()];
            self.swings = vec![0; now.len()];
            return;
        }
        for (i, x) in now.iter_mut().enumerate() {
            let way = *x - self.last[i];
            let (share, before) = (&mut self.shares[i], self.ways[i]);
            if way * before > 0.0 && *share < 1.0 {
                *share = (*share * (1.0 / f64::from(self.swings[i])).exp2()).min(1.0);
            } else if before != 0.0 && way / before < SWINGS {
                *share = (0.5 * *share).max(LEAST_SHARE);
                self.swings[i] += 1;
            }
            self.ways[i] = way;
            if *share < 1.0 {
                *x = self.last[i] + *share * way;
            }
        }
    }
}
