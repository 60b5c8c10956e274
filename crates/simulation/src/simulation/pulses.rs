//! Pulsing valves: open for a share of each period, exactly, whatever the step.
//!
//! **Equation** in the period that begins at `k T` with the command x the valve has the command 1 until
//! `k T + x T`, to the nanosecond, then 0. Both times end a step.

use super::Simulation;
use anergy_core::clock::Time;

impl Simulation {
    /// Takes the shares of the periods that begin now; the end of a step that would pass a switching.
    pub(super) fn begin_pulses(&mut self, now: Time, mut end: Time) -> Time {
        for (i, pulse) in self.plan.pulses.iter().enumerate() {
            let share = &mut self.state.pulse_shares[i];
            if now.is_multiple_of(pulse.period) {
                *share = self.state.signals[pulse.command.index()].clamp(0.0, 1.0);
            }
            let closes = closing_time(now, pulse.period, *share);
            let next = if now < closes { closes } else { now.next_multiple(pulse.period) };
            end = end.min(next);
        }
        end
    }

    /// Command of a pulsing valve during the step that begins now.
    pub(super) fn pulse_command(&self, pulse: usize) -> f64 {
        let now = self.state.time;
        let closes =
            closing_time(now, self.plan.pulses[pulse].period, self.state.pulse_shares[pulse]);
        if now < closes { 1.0 } else { 0.0 }
    }
}

/// When a valve closes in the period of `now`.
fn closing_time(now: Time, period: Time, share: f64) -> Time {
    let begin = Time(now.0 - now.0.rem_euclid(period.0));
    begin + Time((share * period.0 as f64).round() as i64)
}
