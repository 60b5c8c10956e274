//! The phases of a heat pump, what is remembered of them, and when one follows another.

use super::{Command, Compressor};

/// Times closer than this are the same, s.
pub(super) const SAME_S: f64 = 1e-9;
/// So long is a unit off that was never on, s.
const NEVER_ON_S: f64 = 1e9;
/// More changes of phase cannot follow each other without time in between.
const MOST_CHANGES: usize = 6;

/// What the unit does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// Nothing runs.
    Off,
    /// The compressor stops, the pump runs on.
    Stopping,
    /// Through the table of the start.
    Starting,
    /// Steady.
    Running,
    /// The cycle is reversed.
    Defrosting,
    /// Back to the steady heat.
    Recovering,
}

const PHASES: [Phase; 6] = [
    Phase::Off,
    Phase::Stopping,
    Phase::Starting,
    Phase::Running,
    Phase::Defrosting,
    Phase::Recovering,
];

impl Phase {
    /// Number in recordings: 0 off, 1 stopping, 2 starting, 3 running, 4 defrosting, 5 recovering.
    pub fn number(self) -> f64 {
        self as u8 as f64
    }

    /// Whether the compressor runs.
    pub fn on(self) -> bool {
        self >= Self::Starting
    }
}

/// What is remembered from step to step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompressorState {
    /// What the unit does.
    pub phase: Phase,
    /// Time in this phase, s.
    pub phase_s: f64,
    /// Factor on the times of the table of the start.
    pub stretch: f64,
    /// Speed as a share of the full one.
    pub modulation: f64,
    /// Share of the wanted flow.
    pub flow: f64,
    /// Time since the compressor stopped, s.
    pub off_s: f64,
    /// Time since it started, s.
    pub run_s: f64,
    /// Frost counter, s of operation in cold air.
    pub frost_s: f64,
    /// Heat factor when the stop began.
    pub heat_at_stop: f64,
    /// Power factor when the stop began.
    pub power_at_stop: f64,
    /// Whether it cools.
    pub cooling: bool,
    /// Starts so far.
    pub starts: f64,
    /// Operation of the compressor so far, s.
    pub operating_s: f64,
    /// Defrosting so far, s.
    pub defrosting_s: f64,
}

impl CompressorState {
    /// Numbers it takes in the state of a unit.
    pub const LEN: usize = 14;

    /// A unit that was never on.
    pub fn new() -> Self {
        Self {
            phase: Phase::Off,
            phase_s: 0.0,
            stretch: 1.0,
            modulation: 0.0,
            flow: 0.0,
            off_s: NEVER_ON_S,
            run_s: 0.0,
            frost_s: 0.0,
            heat_at_stop: 0.0,
            power_at_stop: 0.0,
            cooling: false,
            starts: 0.0,
            operating_s: 0.0,
            defrosting_s: 0.0,
        }
    }

    /// From the first numbers of a state.
    pub fn read(state: &[f64]) -> Self {
        Self {
            phase: PHASES[(state[0] as usize).min(PHASES.len() - 1)],
            phase_s: state[1],
            stretch: state[2],
            modulation: state[3],
            flow: state[4],
            off_s: state[5],
            run_s: state[6],
            frost_s: state[7],
            heat_at_stop: state[8],
            power_at_stop: state[9],
            cooling: state[10] != 0.0,
            starts: state[11],
            operating_s: state[12],
            defrosting_s: state[13],
        }
    }

    /// Into the first numbers of a state.
    pub fn write(&self, state: &mut [f64]) {
        let numbers = [
            self.phase.number(),
            self.phase_s,
            self.stretch,
            self.modulation,
            self.flow,
            self.off_s,
            self.run_s,
            self.frost_s,
            self.heat_at_stop,
            self.power_at_stop,
            f64::from(u8::from(self.cooling)),
            self.starts,
            self.operating_s,
            self.defrosting_s,
        ];
        state[..Self::LEN].copy_from_slice(&numbers);
    }

    pub(super) fn enter(&mut self, phase: Phase) {
        (self.phase, self.phase_s) = (phase, 0.0);
    }
}

impl Default for CompressorState {
    fn default() -> Self {
        Self::new()
    }
}

impl Compressor {
    /// The speed that a command comes to.
    pub(super) fn target(&self, command: &Command) -> f64 {
        let wanted = if command.on { command.modulation } else { 0.0 };
        wanted.clamp(self.modulation_min, 1.0)
    }

    /// Length of the start of a state, s.
    pub(super) fn start_s(&self, state: &CompressorState) -> f64 {
        self.start.last().map_or(0.0, |point| point.time_s) * state.stretch
    }

    /// Factors of heat and electricity at a time in the phase of a state.
    pub(super) fn factors(&self, state: &CompressorState, phase_s: f64) -> (f64, f64) {
        match state.phase {
            Phase::Off | Phase::Defrosting => (0.0, 0.0),
            Phase::Running => (1.0, 1.0),
            Phase::Recovering => {
                let length_s = self.defrost.map_or(0.0, |defrost| defrost.recovery_s);
                let share = if length_s > 0.0 { (phase_s / length_s).min(1.0) } else { 1.0 };
                (share, share)
            }
            Phase::Stopping => {
                let left =
                    if self.stop_s > 0.0 { (1.0 - phase_s / self.stop_s).max(0.0) } else { 0.0 };
                (left * state.heat_at_stop, left * state.power_at_stop)
            }
            Phase::Starting => self.started(phase_s / state.stretch),
        }
    }

    /// Factors of heat and electricity at a time of the table.
    fn started(&self, time_s: f64) -> (f64, f64) {
        let right = self.start.partition_point(|point| point.time_s <= time_s);
        match (right.checked_sub(1).map(|left| self.start[left]), self.start.get(right)) {
            (Some(left), Some(right)) => {
                let share = (time_s - left.time_s) / (right.time_s - left.time_s);
                (
                    left.heat + share * (right.heat - left.heat),
                    left.power + share * (right.power - left.power),
                )
            }
            (Some(last), None) => (last.heat, last.power),
            (None, _) => (0.0, 0.0),
        }
    }

    /// Changes of phase that are due now.
    pub(super) fn switch(&self, command: &Command, state: &mut CompressorState) {
        for _ in 0..MOST_CHANGES {
            let before = (state.phase, state.phase_s, state.cooling);
            self.switch_once(command, state);
            if before == (state.phase, state.phase_s, state.cooling) {
                break;
            }
        }
        if state.phase.on() {
            // Down at once, and up where no time is needed.
            let target = self.target(command);
            if target - state.modulation <= self.slew_per_s * SAME_S {
                state.modulation = target;
            }
        }
    }

    fn switch_once(&self, command: &Command, state: &mut CompressorState) {
        let phase_s = state.phase_s;
        let due = move |length_s: f64| phase_s >= length_s - SAME_S;
        match state.phase {
            Phase::Off | Phase::Stopping => {
                if command.on && !command.tripped && state.off_s >= self.off_min_s - SAME_S {
                    self.begin(command, state);
                } else if state.phase == Phase::Stopping && due(self.stop_s.max(self.overrun_s)) {
                    state.enter(Phase::Off);
                    state.flow = 0.0;
                }
                return;
            }
            _ if command.tripped => return self.stop(state),
            // A change of the mode starts again.
            _ if command.on && command.cooling != state.cooling => {
                state.cooling = command.cooling;
                state.stretch = 1.0;
                return state.enter(Phase::Starting);
            }
            Phase::Defrosting => {}
            _ if !command.on && state.run_s >= self.run_min_s - SAME_S => return self.stop(state),
            _ => {}
        }
        match (state.phase, self.defrost) {
            (Phase::Starting, _) if due(self.start_s(state)) => state.enter(Phase::Running),
            (Phase::Running, Some(defrost))
                if command.frost_rate > 0.0
                    && !state.cooling
                    && state.frost_s >= defrost.after_s - SAME_S =>
            {
                state.enter(Phase::Defrosting);
            }
            (Phase::Defrosting, Some(defrost)) if due(defrost.duration_s) => {
                state.frost_s = 0.0;
                state.enter(Phase::Recovering);
            }
            (Phase::Recovering, Some(defrost)) if due(defrost.recovery_s) => {
                state.enter(Phase::Running);
            }
            _ => {}
        }
    }

    fn begin(&self, command: &Command, state: &mut CompressorState) {
        state.stretch = if state.off_s < self.warm_within_s { self.warm_scale } else { 1.0 };
        state.enter(Phase::Starting);
        state.modulation = self.modulation_min;
        state.cooling = command.cooling;
        state.run_s = 0.0;
        state.starts += 1.0;
    }

    fn stop(&self, state: &mut CompressorState) {
        (state.heat_at_stop, state.power_at_stop) = self.factors(state, state.phase_s);
        state.enter(Phase::Stopping);
        state.off_s = 0.0;
    }

    /// Time to the next event of a state, s.
    pub(super) fn next_event_s(&self, command: &Command, state: &CompressorState) -> f64 {
        let mut next_s = f64::INFINITY;
        let mut at = |time_s: f64| {
            if time_s > SAME_S {
                next_s = next_s.min(time_s);
            }
        };
        let phase_s = state.phase_s;
        if state.phase.on() {
            at((self.target(command) - state.modulation) / self.slew_per_s);
            if !command.on {
                at(self.run_min_s - state.run_s);
            }
        } else if command.on {
            at(self.off_min_s - state.off_s);
        }
        if state.phase != Phase::Off {
            at((1.0 - state.flow) * self.flow_rise_s);
        }
        match state.phase {
            Phase::Off => {}
            Phase::Stopping => {
                at(self.stop_s - phase_s);
                at(self.overrun_s - phase_s);
            }
            Phase::Starting => {
                self.start.iter().for_each(|point| at(point.time_s * state.stretch - phase_s));
            }
            Phase::Running => {}
            Phase::Defrosting => {
                if let Some(defrost) = self.defrost {
                    at(defrost.duration_s - phase_s);
                    at((defrost.least_modulation - state.modulation) / self.slew_per_s);
                }
            }
            Phase::Recovering => at(self.defrost.map_or(0.0, |it| it.recovery_s) - phase_s),
        }
        if let (Some(defrost), true) = (self.defrost, state.phase.on() && command.frost_rate > 0.0)
        {
            at((defrost.after_s - state.frost_s) / command.frost_rate);
        }
        next_s
    }
}
