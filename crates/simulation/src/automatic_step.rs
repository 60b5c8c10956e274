//! The automatic step: as long as flows, outputs of controllers and temperatures allow.
//!
//! **Equation** each followed quantity is predicted along the straight line of its last two values. What it
//! misses over a step of length h after one of length g, times `h/(h + g)`, is the local error of the step,
//! `h^2/2 |y''|` of a method of first order. Its ratio r to the tolerance, one for all quantities (`followed.rs`), decides:
//! above 1 the next step is
//! `0.8/sqrt(r)` times as long, below 1/8 twice, below 1/64 four times as long, between them nothing changes.
//! **Assumptions** flows count while actuators with a lag move or controllers act at every step; otherwise they
//! are functions of what drives them, which a step of any length meets at its end. **Numerics** the flows are
//! known before the water moves: a step whose flows are beyond the tolerance is tried again shorter from the
//! positions at its start, without a copy of the state; where shortening does not help it is a jump, and the
//! shortest step follows it. Outputs and temperatures shorten the next step. A continuous controller with an
//! integral is unstable in steps much longer than its integral time: where what its output misses grows from
//! step to step, the growth of the next two steps is taken into account, before the output has moved. It also
//! begins with the shortest step after every point of a schedule, other continuous controllers after jumps. All
//! memory is in the state. **Sources** `hairer1993` (II.4), `gustafsson1991`.

mod followed;

use crate::model_file::{RunEntry, StepEntry};
use anergy_core::clock::Time;
pub(crate) use followed::{Followed, Quantity};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// Share of the step that would just meet the tolerance.
const SAFETY: f64 = 0.8;
/// Smallest factor from step to step.
const SHORTEN: f64 = 1.0 / 16.0;
/// Below this ratio a step becomes twice, below the other four times as long.
const CALM: f64 = 1.0 / 8.0;
const STILL: f64 = 1.0 / 64.0;
/// A quantity beyond this ratio has jumped: the line through its last values says nothing.
const JUMP: f64 = 4.0;
/// Shortening by four that does not bring the ratio below this share of it does not help.
const HELPS: f64 = 0.5;
/// Ratios below this are rounding.
const NOISE: f64 = 1e-7;

/// How steps are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// At most so long, ending at its multiples.
    Fixed(Time),
    /// By what happens.
    Automatic(AutomaticStep),
}

impl Step {
    /// As the model file says.
    pub(crate) fn of(run: &RunEntry) -> Self {
        match run.step {
            StepEntry::Fixed(step) => Self::Fixed(step.0),
            StepEntry::Automatic => Self::Automatic(AutomaticStep::of(run)),
        }
    }

    /// The fixed step, or the longest automatic one.
    pub(crate) fn longest(&self) -> Time {
        match self {
            Self::Fixed(step) => *step,
            Self::Automatic(limits) => limits.max,
        }
    }

    /// Largest fixed step, or shortest automatic one.
    pub(crate) fn shortest(&self) -> Time {
        match self {
            Self::Fixed(step) => *step,
            Self::Automatic(limits) => limits.min,
        }
    }
}

impl From<Time> for Step {
    fn from(step: Time) -> Self {
        Self::Fixed(step)
    }
}

impl From<AutomaticStep> for Step {
    fn from(step: AutomaticStep) -> Self {
        Self::Automatic(step)
    }
}

impl std::fmt::Display for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Fixed(step) => step.fmt(f),
            Self::Automatic(step) => write!(f, "auto ({} to {})", step.min, step.max),
        }
    }
}

/// Limits and tolerances of the automatic step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AutomaticStep {
    /// Shortest step (events may make one shorter).
    pub min: Time,
    /// Longest step.
    pub max: Time,
    /// Local error of a temperature, K.
    pub tolerance_k: f64,
    /// Local error of a flow, relative to the flow and at least to a tenth of its nominal one; of an output,
    /// relative to its range.
    pub tolerance_flow: f64,
}

/// What ended a step or kept it short.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Limit {
    /// The longest step that is allowed.
    #[default]
    Longest,
    /// Flows.
    Flow,
    /// Outputs of continuous controllers.
    Control,
    /// Temperatures.
    Temperature,
    /// A point of a schedule or series, or a switching of a pulsing valve.
    Schedule,
    /// The update of a sampled controller.
    Update,
    /// A recorded row, or the end.
    Row,
    /// The soil around the pipes.
    Soil,
}

impl Limit {
    /// All of them, in the order of the counts.
    pub const ALL: [Self; 8] = [
        Self::Longest,
        Self::Flow,
        Self::Control,
        Self::Temperature,
        Self::Schedule,
        Self::Update,
        Self::Row,
        Self::Soil,
    ];

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Longest => "longest step",
            Self::Flow => "flows",
            Self::Control => "outputs of controllers",
            Self::Temperature => "temperatures",
            Self::Schedule => "schedules and series",
            Self::Update => "updates of controllers",
            Self::Row => "recorded rows",
            Self::Soil => "soil",
        }
    }
}

/// What the automatic step remembers: part of the state. Empty until the first automatic step.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct StepMemory {
    /// Length of the next step, unless something ends it before.
    next: Time,
    /// End of the last automatic step; another step since then has to begin anew.
    pub until: Time,
    pub flows: Followed,
    pub outputs: Followed,
    pub temperatures: Followed,
    /// Ratio of the outputs with an integral at the last step.
    growing: f64,
    limited_by: Limit,
    pub steps: u64,
    pub tried_again: u64,
    pub smallest: Time,
    pub largest: Time,
    pub spanned: Time,
    pub limits: [u64; Limit::ALL.len()],
}

/// Ratios of the errors of a step to their tolerances.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Ratios {
    pub flows: f64,
    pub outputs: f64,
    pub temperatures: f64,
}

impl AutomaticStep {
    /// As the model file says.
    pub(crate) fn of(run: &RunEntry) -> Self {
        Self {
            min: run.step_min.0,
            max: run.step_max.0,
            tolerance_k: run.step_tolerance_difference_k,
            tolerance_flow: run.step_tolerance_flow,
        }
    }

    fn within(&self, step: Time) -> Time {
        step.max(self.min).min(self.max)
    }

    /// A step that meets the tolerance, from the ratio that one had.
    pub(crate) fn shorter(&self, step: Time, ratio: f64) -> Time {
        self.within(times(step, (SAFETY / ratio.sqrt()).max(SHORTEN)))
    }

    /// The next try for a step whose flows are beyond the tolerance; `None` when this one is kept. `before` is
    /// the last try and its ratio.
    pub(crate) fn try_again(
        &self,
        step: Time,
        ratio: f64,
        before: Option<(Time, f64)>,
    ) -> Option<Time> {
        if ratio <= 1.0 || step <= self.min {
            return None;
        }
        let helps = before.is_none_or(|(longer, more)| {
            step.0.saturating_mul(4) > longer.0 || ratio < HELPS * more
        });
        Some(if helps {
            self.shorter(step, ratio).min(Time(step.0 / 4)).max(self.min)
        } else {
            self.min
        })
    }
}

fn times(step: Time, factor: f64) -> Time {
    #[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss)]
    Time((step.0 as f64 * factor) as i64)
}

impl StepMemory {
    pub fn fits(&self, other: &Self) -> bool {
        self.flows.fits(&other.flows)
            && self.outputs.fits(&other.outputs)
            && self.temperatures.fits(&other.temperatures)
    }

    /// Memory beside itself, in bytes.
    pub fn heap_bytes(&self) -> usize {
        let followed = [&self.flows, &self.outputs, &self.temperatures];
        let numbers = |one: &&Followed| one.last.capacity() + one.rate.capacity();
        followed.iter().map(numbers).sum::<usize>() * size_of::<f64>()
    }

    /// Begins with the shortest step.
    pub fn begin(&mut self, limits: &AutomaticStep, now: Time) {
        self.next = limits.min;
        self.limited_by = Limit::Control;
        self.growing = 0.0;
        self.until = now;
    }

    /// The next automatic step begins anew.
    pub fn forget(&mut self) {
        self.until = Time(-1);
    }

    /// Goes on with the shortest step: what comes is not on the lines.
    pub fn restart(&mut self, limits: &AutomaticStep) {
        self.next = limits.min;
        self.limited_by = Limit::Schedule;
    }

    /// Length of the next step.
    pub fn next(&self, limits: &AutomaticStep) -> Time {
        limits.within(self.next)
    }

    /// End of the next step, with what ends it, where `event` ends it at the latest: two equal steps rather
    /// than a long and a short one.
    pub fn end(&self, limits: &AutomaticStep, now: Time, event: (Time, Limit)) -> (Time, Limit) {
        let (next, left) = (self.next(limits), event.0 - now);
        if left <= next {
            return event;
        }
        let half = Time(left.0 / 2 + left.0 % 2);
        if half < limits.min {
            return event;
        }
        (now + half.min(next), self.limit(limits))
    }

    fn limit(&self, limits: &AutomaticStep) -> Limit {
        if self.next(limits) >= limits.max { Limit::Longest } else { self.limited_by }
    }

    /// The ratio of outputs with an integral, with the growth of two more steps.
    pub fn grown(&mut self, ratio: f64) -> f64 {
        let growth = ratio / self.growing.max(NOISE);
        self.growing = ratio;
        if ratio > NOISE && growth > 1.0 { ratio * growth * growth } else { ratio }
    }

    /// Outputs that moved much are followed at once.
    pub fn react(&mut self, limits: &AutomaticStep, ratio: f64) {
        if ratio > 1.0 {
            self.next = limits.shorter(self.next(limits), ratio);
            self.limited_by = Limit::Control;
        }
    }

    /// Counts the step that ended now, and chooses the next one. Outputs have shortened this one already.
    pub fn conclude(&mut self, limits: &AutomaticStep, now: Time, ended: Limit, ratios: &Ratios) {
        let step = now - self.until;
        let (ratio, limit) = if ratios.flows > ratios.temperatures {
            (ratios.flows, Limit::Flow)
        } else {
            (ratios.temperatures, Limit::Temperature)
        };
        if ratio > 1.0 {
            self.next = limits.shorter(step.min(self.next(limits)), ratio);
            self.limited_by = limit;
        } else {
            let worst = ratio.max(ratios.outputs);
            let factor = if worst < STILL {
                4.0
            } else if worst < CALM {
                2.0
            } else {
                1.0
            };
            self.next = limits.within(times(step, factor).max(self.next));
        }
        self.until = now;
        self.steps += 1;
        self.smallest = if self.steps == 1 { step } else { self.smallest.min(step) };
        self.largest = self.largest.max(step);
        self.spanned = self.spanned + step;
        let place = Limit::ALL.iter().position(|other| *other == ended).unwrap_or(0);
        self.limits[place] += 1;
    }

    /// The step was cut short by its flows.
    pub fn cut(&mut self, step: Time) {
        self.tried_again += 1;
        self.next = step;
        self.limited_by = Limit::Flow;
    }

    /// Number and lengths of the automatic steps, and how often what limited them; `None` where there were none.
    pub fn report(&self) -> Option<Value> {
        if self.steps == 0 {
            return None;
        }
        let limits: Map<String, Value> = Limit::ALL
            .iter()
            .zip(&self.limits)
            .map(|(limit, count)| (limit.words().to_owned(), json!(count)))
            .collect();
        #[allow(clippy::cast_precision_loss)]
        let mean_s = self.spanned.as_s() / self.steps as f64;
        Some(json!({
            "steps": self.steps,
            "smallest_s": self.smallest.as_s(),
            "mean_s": mean_s,
            "largest_s": self.largest.as_s(),
            "tried_again": self.tried_again,
            "limited_most_often_by": self.most_often().words(),
            "limits": limits,
        }))
    }

    /// What limited most steps.
    pub fn most_often(&self) -> Limit {
        let most = Limit::ALL.iter().zip(&self.limits).max_by_key(|(_, count)| **count);
        most.map_or(Limit::Longest, |(limit, _)| *limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: AutomaticStep = AutomaticStep {
        min: Time(100_000_000),
        max: Time(900_000_000_000),
        tolerance_k: 0.5,
        tolerance_flow: 0.01,
    };

    #[test]
    fn what_a_line_misses_is_the_local_error() {
        // y = t^2 at 0, 1, 3: line from (0, 0) through (1, 1) gives 3 at t = 3, which misses 6;
        // times 2/(2 + 1) is 4 = h^2/2 y'' = 2^2/2 2.
        let at = |value| [Quantity { value, tolerance: 1.0, m_flow_kg_s: 2.0 }].into_iter();
        let mut followed = Followed::default();
        followed.rest(at(0.0));
        followed.keep(1.0, at(1.0));
        assert!((followed.miss(2.0, 2.0, at(9.0)) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn few_loops_count_whole_and_one_of_many_by_its_share() {
        let miss = |all: &[(f64, f64)]| {
            let at = |value: f64| {
                let quantity = move |(miss, m_flow_kg_s): &(f64, f64)| Quantity {
                    value: value * miss,
                    tolerance: 1.0,
                    m_flow_kg_s: *m_flow_kg_s,
                };
                all.iter().map(quantity)
            };
            let mut followed = Followed::default();
            followed.rest(at(0.0));
            followed.miss(1.0, 4.0, at(1.0))
        };
        // All of the flow passes it.
        assert_eq!(miss(&[(3.0, 4.0), (0.0, 4.0), (0.0, 4.0)]), 3.0);
        // A quarter of the flow, alone: sqrt(1/4) 3. All quarters: 3.
        assert_eq!(miss(&[(3.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0)]), 1.5);
        assert_eq!(miss(&[(3.0, 1.0); 4]), 3.0);
        // 1 of 16 misses 8, the others 2: sqrt((64 + 15 4)/16) is above sqrt(1/16) 8.
        let mut many = [(2.0, 0.25); 16];
        many[0].0 = 8.0;
        assert!((miss(&many) - 7.75_f64.sqrt()).abs() < 1e-12);
        // What does not flow moves nothing.
        assert_eq!(miss(&[(9.0, 0.0), (0.5, 4.0)]), 0.5);
    }

    #[test]
    fn quiet_steps_grow_to_the_longest_and_stay() {
        let mut memory = StepMemory::default();
        memory.begin(&LIMITS, Time::ZERO);
        let mut now = Time::ZERO;
        for _ in 0..8 {
            let (end, ended) = memory.end(&LIMITS, now, (Time::NEVER, Limit::Row));
            memory.conclude(&LIMITS, end, ended, &Ratios::default());
            now = end;
        }
        // 0.1 s times 4^7 is above 900 s
        assert_eq!(memory.next(&LIMITS), LIMITS.max);
        // 4 times the tolerance: 0.8/2 of the step
        let ratios = Ratios { temperatures: 4.0, ..Ratios::default() };
        memory.conclude(&LIMITS, now + LIMITS.max, Limit::Longest, &ratios);
        assert_eq!(memory.next(&LIMITS), Time(360_000_000_000));
        // Between 1/8 and 1 nothing changes.
        let ratios = Ratios { temperatures: 0.5, ..Ratios::default() };
        let now = now + LIMITS.max + Time(360_000_000_000);
        memory.conclude(&LIMITS, now, Limit::Temperature, &ratios);
        assert_eq!(memory.next(&LIMITS), Time(360_000_000_000));
    }

    #[test]
    fn a_jump_leads_to_the_shortest_step_soon() {
        let second = Time(100_000_000_000);
        let first = LIMITS.try_again(second, 30.0, None).unwrap();
        assert!(first.0 * 4 <= second.0);
        assert_eq!(LIMITS.try_again(first, 29.0, Some((second, 30.0))), Some(LIMITS.min));
        assert_eq!(LIMITS.try_again(LIMITS.min, 29.0, Some((first, 29.0))), None);
    }

    #[test]
    fn no_sliver_before_an_event() {
        let mut memory = StepMemory::default();
        memory.begin(&LIMITS, Time::ZERO);
        memory.next = Time(60);
        let limits = AutomaticStep { min: Time(1), ..LIMITS };
        let end = |event| memory.end(&limits, Time(0), (Time(event), Limit::Row)).0;
        assert_eq!(
            (end(60), end(61), end(119), end(121)),
            (Time(60), Time(31), Time(60), Time(60))
        );
    }
}
