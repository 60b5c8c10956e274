//! What time does to a heat pump: start, speed, frost, stop, pump overrun - one compressor for all units.
//!
//! **Equation** the unit is in one phase at a time,
//!
//! ```text
//! off -> starting -> running -> defrosting -> recovering -> running
//!  ^        |           |                         |
//!  '----- stopping <----'-------------------------'
//! ```
//!
//! and gives the heat and electricity of its steady map times a factor of the phase: a table over time while it
//! starts (first it draws heat from the water), 1 while it runs, a ramp after a defrost and at the stop. The speed
//! follows its command at a limited rate while it rises, at once while it falls. A command above zero but below the
//! smallest speed becomes the smallest speed. Frost is counted while the compressor runs in cold air; full, the cycle
//! is reversed for some minutes and heat is taken from the water.
//!
//! **Assumptions** factors, times and the frost counter stand for the refrigerant circuit; a start within the warm
//! time runs through the table faster. A defrost that has begun is finished, and a run lasts at least its smallest
//! time, unless a limit trips. **Validity** steps of any length.
//!
//! **Numerics** a step is cut at every event (points of the table, end of a phase, speed reached, frost full, smallest
//! times over) and integrated in between by Gauss' rule with three points, which is exact for a linear factor times
//! a cubic map: means over a step do not depend on how a stretch of time is cut into steps.
//!
//! **Sources** `zinsmeister2022`, `zinsmeister2024` (shape of start and defrost); the numbers of the tables are
//! assumed.

mod phase;
mod run;

pub use phase::{CompressorState, Phase};
pub use run::Means;

/// A point of the table of a start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartPoint {
    /// Time since the start, s.
    pub time_s: f64,
    /// Heat as a share of the steady heat; negative while it is drawn from the water.
    pub heat: f64,
    /// Electricity as a share of the steady one.
    pub power: f64,
}

/// How frost is removed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Defrost {
    /// Operation in cold air of normal humidity after which it begins, s.
    pub after_s: f64,
    /// How long it lasts, s.
    pub duration_s: f64,
    /// Heat taken from the water at full speed, W.
    pub heat_w: f64,
    /// Smallest speed that counts for it.
    pub least_modulation: f64,
    /// Electricity meanwhile, W.
    pub electric_w: f64,
    /// Ramp back to the steady heat, s.
    pub recovery_s: f64,
}

/// The internal control of a heat pump.
#[derive(Debug, Clone, PartialEq)]
pub struct Compressor {
    /// Smallest speed as a share of the full one.
    pub modulation_min: f64,
    /// Rate at which the speed rises, 1/s.
    pub slew_per_s: f64,
    /// The start, by rising time from 0; the last point is the steady state.
    pub start: Vec<StartPoint>,
    /// Time in which the flow rises, s.
    pub flow_rise_s: f64,
    /// Off times shorter than this make a warm start, s.
    pub warm_within_s: f64,
    /// Share of the times of the table in a warm start.
    pub warm_scale: f64,
    /// Time in which the compressor stops, s.
    pub stop_s: f64,
    /// How long the pump runs after the stop began, s.
    pub overrun_s: f64,
    /// Smallest time of a run, s.
    pub run_min_s: f64,
    /// Smallest time between a stop and a start, s.
    pub off_min_s: f64,
    /// Defrosting, if its source is air.
    pub defrost: Option<Defrost>,
    /// Without dynamics the steady map holds at once, whatever was before.
    pub dynamics: bool,
}

/// What the unit is asked to do during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// Whether it shall run.
    pub on: bool,
    /// Wanted speed as a share of the full one.
    pub modulation: f64,
    /// Whether it cools.
    pub cooling: bool,
    /// A limit stops it at once and keeps it off.
    pub tripped: bool,
    /// Rate of the frost counter, s/s: 1 in cold air of normal humidity, negative where frost melts.
    pub frost_rate: f64,
}

#[cfg(test)]
mod tests;
