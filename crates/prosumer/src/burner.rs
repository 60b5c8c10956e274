//! What time does to a generator that burns fuel: start, load changes, stop - one sequence for boilers and engines.
//!
//! **Equation** the unit is off, starting, running or stopping; it gives the heat, electricity and flow of its steady
//! state and takes its fuel times factors of the phase: tables over the time since the start or the stop, 1 while it
//! runs. The load follows its command at a limited rate, in both directions; a command above zero but below the
//! smallest load becomes the smallest load. An engine that is cold takes heat for itself,
//! `Q = f_Q (Q_steady - Q_warm w)`, `w = max(0, s - t_run/t_warm)` with `s = min(1, t_off/t_cold)` when it started.
//!
//! **Assumptions** the tables stand for metal, water and flame; a start within the warm time runs through its table
//! faster. A stop holds the factors that were reached and follows its own table from there. A run lasts at least its
//! smallest time, unless a limit trips. **Validity** steps of any length.
//!
//! **Numerics** a step is cut at every event (points of the tables, load reached, engine warm, smallest times over)
//! and integrated in between by Gauss' rule with three points, which is exact for a linear factor times a map up to
//! the fourth degree in the load: means do not depend on how a stretch of time is cut into steps.
//!
//! **Sources** `zinsmeister2022`, `prohmo`; each generator names its tables.

mod run;
mod sequence;

pub use run::Means;
pub use sequence::{BurnerState, Phase};

/// Shares of the steady values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Factors {
    /// Of the heat.
    pub heat: f64,
    /// Of the fuel.
    pub fuel: f64,
    /// Of the electricity that is generated; negative where it is drawn.
    pub power: f64,
    /// Of the flow.
    pub flow: f64,
}

impl Factors {
    /// The steady state.
    pub const STEADY: Self = Self { heat: 1.0, fuel: 1.0, power: 1.0, flow: 1.0 };

    fn times(self, other: Self) -> Self {
        Self {
            heat: self.heat * other.heat,
            fuel: self.fuel * other.fuel,
            power: self.power * other.power,
            flow: self.flow * other.flow,
        }
    }
}

/// A point of the table of a start or a stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TablePoint {
    /// Time since the start or the stop, s.
    pub time_s: f64,
    /// Shares there; straight in between.
    pub factors: Factors,
}

impl TablePoint {
    /// A point from time, heat, fuel, power and flow.
    pub const fn new([time_s, heat, fuel, power, flow]: [f64; 5]) -> Self {
        Self { time_s, factors: Factors { heat, fuel, power, flow } }
    }
}

/// The value of a table at a time, the end values beyond it.
fn table_at(table: &[TablePoint], time_s: f64) -> Factors {
    let right = table.partition_point(|point| point.time_s <= time_s);
    match (right.checked_sub(1).map(|left| table[left]), table.get(right)) {
        (Some(left), Some(right)) => {
            let share = (time_s - left.time_s) / (right.time_s - left.time_s);
            let between = |a: f64, b: f64| a + share * (b - a);
            let (a, b) = (left.factors, right.factors);
            Factors {
                heat: between(a.heat, b.heat),
                fuel: between(a.fuel, b.fuel),
                power: between(a.power, b.power),
                flow: between(a.flow, b.flow),
            }
        }
        (Some(last), None) => last.factors,
        (None, Some(first)) => first.factors,
        (None, None) => Factors::STEADY,
    }
}

/// Heat that a cold engine takes for itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WarmUp {
    /// At the start of a cold engine, W; 0 for none.
    pub heat_w: f64,
    /// Time in which it ends, s.
    pub lasts_s: f64,
    /// Off time after which the engine is cold, s.
    pub cold_after_s: f64,
}

/// What a generator does in steady operation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Steady {
    /// Heat into the water, W.
    pub heat_w: f64,
    /// Fuel by its lower heating value, W.
    pub fuel_w: f64,
    /// Electricity that is generated, W.
    pub power_w: f64,
}

/// The internal control of a generator.
#[derive(Debug, Clone, PartialEq)]
pub struct Burner {
    /// Smallest load as a share of the full one.
    pub modulation_min: f64,
    /// Rate at which the load changes, 1/s.
    pub slew_per_s: f64,
    /// Whether it starts at full load, or at the load that is asked for.
    pub starts_full: bool,
    /// The start, by rising time from 0; the last point is the steady state.
    pub start: Vec<TablePoint>,
    /// The stop, by rising time from 0; the unit is off behind the last point.
    pub stop: Vec<TablePoint>,
    /// Off times shorter than this make a warm start, s.
    pub warm_within_s: f64,
    /// Share of the times of the table in a warm start.
    pub warm_scale: f64,
    /// What a cold engine takes for itself.
    pub warm_up: WarmUp,
    /// Smallest time of a run, s.
    pub run_min_s: f64,
    /// Smallest time between a stop and a start, s.
    pub off_min_s: f64,
    /// Without dynamics the steady state holds at once, whatever was before.
    pub dynamics: bool,
}

/// What the unit is asked to do during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// Wanted load as a share of the full one; 0 is off.
    pub modulation: f64,
    /// A limit stops it at once and keeps it off.
    pub tripped: bool,
}

#[cfg(test)]
mod tests;
