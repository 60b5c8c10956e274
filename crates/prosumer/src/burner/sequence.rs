//! The phases of a generator, what is remembered of them, and when one follows another.

use super::{Burner, Command, Factors, table_at};

/// Times closer than this are the same, s.
pub(super) const SAME_S: f64 = 1e-9;
/// So long is a unit off that was never on, s.
const NEVER_ON_S: f64 = 1e9;
/// More changes of phase cannot follow each other without time in between.
const MOST_CHANGES: usize = 4;

/// What the unit does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// Nothing runs.
    Off,
    /// Through the table of the stop.
    Stopping,
    /// Through the table of the start.
    Starting,
    /// Steady.
    Running,
}

const PHASES: [Phase; 4] = [Phase::Off, Phase::Stopping, Phase::Starting, Phase::Running];

impl Phase {
    /// Number in recordings, that of heat pumps: 0 off, 1 stopping, 2 starting, 3 running.
    pub fn number(self) -> f64 {
        self as u8 as f64
    }

    /// Whether it burns.
    pub fn on(self) -> bool {
        self >= Self::Starting
    }
}

/// What is remembered from step to step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BurnerState {
    /// What the unit does.
    pub phase: Phase,
    /// Time in this phase, s.
    pub phase_s: f64,
    /// Factor on the times of the table of the start.
    pub stretch: f64,
    /// Load as a share of the full one.
    pub modulation: f64,
    /// Time since it stopped, s.
    pub off_s: f64,
    /// Time since it started, s.
    pub run_s: f64,
    /// How cold the engine was when it started, 0 to 1.
    pub cold: f64,
    /// Shares that were reached when the stop began.
    pub at_stop: Factors,
    /// Starts so far.
    pub starts: f64,
    /// Operation so far, s.
    pub operating_s: f64,
}

impl BurnerState {
    /// Numbers it takes in the state of a unit.
    pub const LEN: usize = 13;

    /// A unit that was never on.
    pub fn new() -> Self {
        Self {
            phase: Phase::Off,
            phase_s: 0.0,
            stretch: 1.0,
            modulation: 0.0,
            off_s: NEVER_ON_S,
            run_s: 0.0,
            cold: 0.0,
            at_stop: Factors::default(),
            starts: 0.0,
            operating_s: 0.0,
        }
    }

    /// From the first numbers of a state.
    pub fn read(state: &[f64]) -> Self {
        Self {
            phase: PHASES[(state[0] as usize).min(PHASES.len() - 1)],
            phase_s: state[1],
            stretch: state[2],
            modulation: state[3],
            off_s: state[4],
            run_s: state[5],
            cold: state[6],
            at_stop: Factors { heat: state[7], fuel: state[8], power: state[9], flow: state[10] },
            starts: state[11],
            operating_s: state[12],
        }
    }

    /// Into the first numbers of a state.
    pub fn write(&self, state: &mut [f64]) {
        let numbers = [
            self.phase.number(),
            self.phase_s,
            self.stretch,
            self.modulation,
            self.off_s,
            self.run_s,
            self.cold,
            self.at_stop.heat,
            self.at_stop.fuel,
            self.at_stop.power,
            self.at_stop.flow,
            self.starts,
            self.operating_s,
        ];
        state[..Self::LEN].copy_from_slice(&numbers);
    }

    pub(super) fn enter(&mut self, phase: Phase) {
        (self.phase, self.phase_s) = (phase, 0.0);
    }
}

impl Default for BurnerState {
    fn default() -> Self {
        Self::new()
    }
}

impl Burner {
    /// Whether a command asks for operation.
    fn wants(command: &Command) -> bool {
        command.modulation > 0.0
    }

    /// The load that a command comes to: one that starts at full load stays there until it has started.
    pub(super) fn target(&self, command: &Command, state: &BurnerState) -> f64 {
        if self.starts_full && state.phase == Phase::Starting {
            return 1.0;
        }
        command.modulation.clamp(self.modulation_min, 1.0)
    }

    /// Length of the start of a state, s.
    fn start_s(&self, state: &BurnerState) -> f64 {
        self.start.last().map_or(0.0, |point| point.time_s) * state.stretch
    }

    /// Length of a stop, s.
    fn stop_s(&self) -> f64 {
        self.stop.last().map_or(0.0, |point| point.time_s)
    }

    /// Shares of the steady values at a time in the phase of a state.
    pub(super) fn factors(&self, state: &BurnerState, phase_s: f64) -> Factors {
        match state.phase {
            Phase::Off => Factors::default(),
            Phase::Running => Factors::STEADY,
            Phase::Stopping => table_at(&self.stop, phase_s).times(state.at_stop),
            Phase::Starting => table_at(&self.start, phase_s / state.stretch),
        }
    }

    /// Heat that a cold engine takes for itself some time after the start, W.
    pub(super) fn warming_w(&self, state: &BurnerState, run_s: f64) -> f64 {
        let warm_up = &self.warm_up;
        if warm_up.heat_w <= 0.0 {
            return 0.0;
        }
        warm_up.heat_w * (state.cold - run_s / warm_up.lasts_s).max(0.0)
    }

    /// Changes of phase that are due now.
    pub(super) fn switch(&self, command: &Command, state: &mut BurnerState) {
        for _ in 0..MOST_CHANGES {
            let before = (state.phase, state.phase_s);
            self.switch_once(command, state);
            if before == (state.phase, state.phase_s) {
                break;
            }
        }
        if state.phase.on() {
            let target = self.target(command, state);
            if (target - state.modulation).abs() <= self.slew_per_s * SAME_S {
                state.modulation = target;
            }
        }
    }

    fn switch_once(&self, command: &Command, state: &mut BurnerState) {
        let phase_s = state.phase_s;
        let due = move |length_s: f64| phase_s >= length_s - SAME_S;
        match state.phase {
            Phase::Off | Phase::Stopping => {
                let rested = state.off_s >= self.off_min_s - SAME_S;
                if Self::wants(command) && !command.tripped && rested {
                    self.begin(command, state);
                } else if state.phase == Phase::Stopping && due(self.stop_s()) {
                    state.enter(Phase::Off);
                }
            }
            _ if command.tripped => self.end(state),
            _ if !Self::wants(command) && state.run_s >= self.run_min_s - SAME_S => {
                self.end(state);
            }
            Phase::Starting if due(self.start_s(state)) => state.enter(Phase::Running),
            _ => {}
        }
    }

    fn begin(&self, command: &Command, state: &mut BurnerState) {
        state.stretch = if state.off_s < self.warm_within_s { self.warm_scale } else { 1.0 };
        state.cold = (state.off_s / self.warm_up.cold_after_s.max(SAME_S)).min(1.0);
        state.enter(Phase::Starting);
        state.modulation = self.target(command, state);
        state.run_s = 0.0;
        state.starts += 1.0;
    }

    fn end(&self, state: &mut BurnerState) {
        state.at_stop = self.factors(state, state.phase_s);
        state.enter(Phase::Stopping);
        state.off_s = 0.0;
    }

    /// Time to the next event of a state, s.
    pub(super) fn next_event_s(&self, command: &Command, state: &BurnerState) -> f64 {
        let mut next_s = f64::INFINITY;
        let mut at = |time_s: f64| {
            if time_s > SAME_S {
                next_s = next_s.min(time_s);
            }
        };
        if state.phase.on() {
            at((self.target(command, state) - state.modulation).abs() / self.slew_per_s);
            if !Self::wants(command) {
                at(self.run_min_s - state.run_s);
            }
            if self.warm_up.heat_w > 0.0 {
                at(state.cold * self.warm_up.lasts_s - state.run_s);
            }
        } else if Self::wants(command) && !command.tripped {
            at(self.off_min_s - state.off_s);
        }
        match state.phase {
            Phase::Off | Phase::Running => {}
            Phase::Stopping => self.stop.iter().for_each(|p| at(p.time_s - state.phase_s)),
            Phase::Starting => {
                self.start.iter().for_each(|p| at(p.time_s * state.stretch - state.phase_s));
            }
        }
        next_s
    }
}
