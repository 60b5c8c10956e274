//! Weighted PI control of a bidirectional station: two actuators, three objectives.
//!
//! **Equation** the sign of the set heat `Q_set` is the mode: feed-in (positive) acts on the pump speed `u`,
//! extraction (negative) on the flow coefficient `kappa` of the valve, both on the secondary flow `V`. Each of
//! the two loops of a mode is a PI controller of one weighted, normalised error
//!
//! `e = alpha (|Q_set| - Q)/dQ_n + (1 - alpha) s (T_set - T)/dT_n`, `y = sat(K e + I)`,
//! `dI/dt = K e/T_i + (y - y_unlimited)/T_i`,
//!
//! with `Q` the heat in the direction of the mode and `T` one temperature or difference:
//!
//! | loop | crossover (s = +1) | same side (s = -1) |
//! |---|---|---|
//! | extraction, primary (kappa) | T of the hot secondary | difference of the primary |
//! | extraction, secondary (V) | difference of the primary | T of the hot secondary |
//! | feed-in, primary (u) | difference of the secondary | T of the hot primary |
//! | feed-in, secondary (V) | T of the hot primary | difference of the secondary |
//!
//! In the crossover pairing a larger actuator value raises the loop's temperature as it raises the heat; on
//! its own side it lowers it, hence the sign. `mixed_1` extracts as crossover and feeds in as same side,
//! `mixed_2` the other way round. **Assumptions** the temperatures of an idle station do not matter: within
//! the idle band of the set heat all outputs are zero. **Validity** the equilibrium is `e = 0` for each loop
//! within its limits, in general with neither error zero. The published source takes `|Q|`; here heat in
//! the wrong direction counts as negative, so that a loop does not push it further. **Numerics** the
//! back-calculation is that of [`super::pi`]; the publication's library lets it act with 0.9 of the integral
//! time. Both integrals start anew with a mode. **Sources** `licklederer2024`.

use crate::controller::{ControlError, Ports, not_negative, positive};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

mod mode;

pub(super) const PORTS: Ports = Ports {
    measures: &[
        "measures_heat",
        "measures_primary_hot",
        "measures_primary_cold",
        "measures_secondary_hot",
        "measures_secondary_cold",
    ],
    acts_on: &["acts_on_pump", "acts_on_valve", "acts_on_secondary"],
};

/// Which temperature each side looks after.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Pairing {
    /// Each side that of the other side.
    #[default]
    Crossover,
    /// Each side its own.
    SameSide,
    /// Extraction as crossover, feed-in as same side.
    #[serde(rename = "mixed_1")]
    Mixed1,
    /// Extraction as same side, feed-in as crossover.
    #[serde(rename = "mixed_2")]
    Mixed2,
}

/// A weighted PI controller as written in a model file; with `station` it finds its channels and signals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WeightedPiParams {
    /// Wanted heat, W: positive feeds in, negative extracts; the signal `ID.q_flow_w`.
    #[serde(default)]
    pub q_flow_w: f64,
    /// Which temperature each side looks after.
    #[serde(default)]
    pub variant: Pairing,
    /// Wanted temperature of the hot primary side, K (feed-in).
    #[serde(default = "primary_hot")]
    pub primary_hot_k: f64,
    /// Wanted temperature of the hot secondary side, K (extraction).
    #[serde(default = "secondary_hot")]
    pub secondary_hot_k: f64,
    /// Wanted difference of the primary temperatures, K (extraction).
    #[serde(default = "twenty")]
    pub primary_difference_k: f64,
    /// Wanted difference of the secondary temperatures, K (feed-in).
    #[serde(default = "twenty")]
    pub secondary_difference_k: f64,
    /// Gain of the pump: speed per weighted error.
    #[serde(default = "one_and_a_half")]
    pub feed_in_primary_gain: f64,
    /// Integral time of the pump, s.
    #[serde(default = "eight")]
    pub feed_in_primary_integral_time_s: f64,
    /// Weight of the heat for the pump. Absent: 2/3 in crossover, 1/3 on the same side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub feed_in_primary_alpha: Option<f64>,
    /// Gain of the secondary flow in feed-in, m3/s per weighted error.
    #[serde(default = "one_and_a_half_l_min")]
    pub feed_in_secondary_gain_m3_s: f64,
    /// Integral time of the secondary flow in feed-in, s.
    #[serde(default = "eight")]
    pub feed_in_secondary_integral_time_s: f64,
    /// Weight of the heat for the secondary flow in feed-in. Absent: what the pump's lacks to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub feed_in_secondary_alpha: Option<f64>,
    /// Gain of the valve: flow coefficient per weighted error.
    #[serde(default = "one")]
    pub extraction_primary_gain: f64,
    /// Integral time of the valve, s.
    #[serde(default = "thirty_five")]
    pub extraction_primary_integral_time_s: f64,
    /// Weight of the heat for the valve. Absent: 1/3 in crossover, 2/3 on the same side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extraction_primary_alpha: Option<f64>,
    /// Gain of the secondary flow in extraction, m3/s per weighted error.
    #[serde(default = "one_and_a_half_l_min")]
    pub extraction_secondary_gain_m3_s: f64,
    /// Integral time of the secondary flow in extraction, s.
    #[serde(default = "eight")]
    pub extraction_secondary_integral_time_s: f64,
    /// Weight of the heat for the secondary flow in extraction. Absent: what the valve's lacks to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extraction_secondary_alpha: Option<f64>,
    /// Error of the heat that counts as one, W.
    #[serde(default = "one_kw")]
    pub q_flow_norm_w: f64,
    /// Error of a temperature that counts as one, K.
    #[serde(default = "three")]
    pub norm_difference_k: f64,
    /// Set heats smaller than this are idleness, W.
    #[serde(default = "hundred_w")]
    pub idle_band_w: f64,
    /// Smallest speed of the pump while it feeds in.
    #[serde(default = "quarter")]
    pub speed_min: f64,
    /// Largest speed of the pump.
    #[serde(default = "one")]
    pub speed_max: f64,
    /// Smallest flow coefficient of the valve while it extracts.
    #[serde(default = "quarter")]
    pub kappa_min: f64,
    /// Largest flow coefficient of the valve.
    #[serde(default = "one")]
    pub kappa_max: f64,
    /// Smallest secondary flow while not idle, m3/s.
    #[serde(default = "two_l_min")]
    pub v_flow_min_m3_s: f64,
    /// Largest secondary flow, m3/s.
    #[serde(default = "most_l_min")]
    pub v_flow_max_m3_s: f64,
    /// Where both outputs of a mode start between their limits: 0 at the smallest, 1 at the largest.
    #[serde(default)]
    pub start_share: f64,
    /// Time between two updates, s; 0 updates at every step.
    #[serde(default)]
    pub interval_s: f64,
    /// Time of the first update, s.
    #[serde(default)]
    pub offset_s: f64,
}

macro_rules! defaults {
    ($($name:ident = $value:expr;)*) => { $(fn $name() -> f64 { $value })* };
}

defaults! {
    primary_hot = 326.65;
    secondary_hot = 323.15;
    twenty = 20.0;
    one_and_a_half = 1.5;
    one_and_a_half_l_min = 1.5 / 60_000.0;
    one = 1.0;
    eight = 8.0;
    thirty_five = 35.0;
    one_kw = 1000.0;
    three = 3.0;
    hundred_w = 100.0;
    quarter = 0.25;
    two_l_min = 2.0 / 60_000.0;
    most_l_min = 8.5 / 60_000.0;
}

/// One of the two loops of a mode.
#[derive(Debug, Clone, PartialEq)]
struct Loop {
    gain: f64,
    integral_time_s: f64,
    alpha: f64,
    /// Its temperature objective is that of the other side.
    crossover: bool,
    /// Limits of its output.
    min: f64,
    max: f64,
}

/// A weighted PI controller ready to run. State: the integral of the primary and of the secondary output,
/// the mode.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightedPi {
    params: WeightedPiParams,
    /// Primary and secondary loop of feed-in, then of extraction.
    loops: [[Loop; 2]; 2],
}

impl WeightedPiParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _context: &()) -> Result<WeightedPi, ControlError> {
        positive("q_flow_norm_w", self.q_flow_norm_w)?;
        positive("norm_difference_k", self.norm_difference_k)?;
        positive("idle_band_w", self.idle_band_w)?;
        not_negative("interval_s", self.interval_s)?;
        not_negative("offset_s", self.offset_s)?;
        share("start_share", self.start_share)?;
        let limits = |low: (&'static str, f64), max: f64, requirement: &'static str| {
            let (field, value) = low;
            not_negative(field, value)?;
            if value < max {
                Ok((value, max))
            } else {
                Err(ControlError::OutOfRange { field, value, requirement })
            }
        };
        let speed =
            limits(("speed_min", self.speed_min), self.speed_max, "must be below speed_max")?;
        let kappa =
            limits(("kappa_min", self.kappa_min), self.kappa_max, "must be below kappa_max")?;
        let flow = limits(
            ("v_flow_min_m3_s", self.v_flow_min_m3_s),
            self.v_flow_max_m3_s,
            "must be below v_flow_max_m3_s",
        )?;
        let (fed_across, drawn_across) = match self.variant {
            Pairing::Crossover => (true, true),
            Pairing::SameSide => (false, false),
            Pairing::Mixed1 => (false, true),
            Pairing::Mixed2 => (true, false),
        };
        let one =
            |gain: (&'static str, f64), time: (&'static str, f64), alpha, crossover, range| {
                let (min, max) = range;
                Ok(Loop {
                    gain: positive(gain.0, gain.1)?,
                    integral_time_s: positive(time.0, time.1)?,
                    alpha,
                    crossover,
                    min,
                    max,
                })
            };
        let weight = |field, given: Option<f64>, otherwise| match given {
            Some(alpha) => share(field, alpha),
            None => Ok(otherwise),
        };
        let third = |large: bool| if large { 2.0 / 3.0 } else { 1.0 / 3.0 };
        let pump = weight("feed_in_primary_alpha", self.feed_in_primary_alpha, third(fed_across))?;
        let valve = weight(
            "extraction_primary_alpha",
            self.extraction_primary_alpha,
            third(!drawn_across),
        )?;
        let fed = weight("feed_in_secondary_alpha", self.feed_in_secondary_alpha, 1.0 - pump)?;
        let drawn =
            weight("extraction_secondary_alpha", self.extraction_secondary_alpha, 1.0 - valve)?;
        Ok(WeightedPi {
            params: self.clone(),
            loops: [
                [
                    one(
                        ("feed_in_primary_gain", self.feed_in_primary_gain),
                        ("feed_in_primary_integral_time_s", self.feed_in_primary_integral_time_s),
                        pump,
                        fed_across,
                        speed,
                    )?,
                    one(
                        ("feed_in_secondary_gain_m3_s", self.feed_in_secondary_gain_m3_s),
                        (
                            "feed_in_secondary_integral_time_s",
                            self.feed_in_secondary_integral_time_s,
                        ),
                        fed,
                        fed_across,
                        flow,
                    )?,
                ],
                [
                    one(
                        ("extraction_primary_gain", self.extraction_primary_gain),
                        (
                            "extraction_primary_integral_time_s",
                            self.extraction_primary_integral_time_s,
                        ),
                        valve,
                        drawn_across,
                        kappa,
                    )?,
                    one(
                        ("extraction_secondary_gain_m3_s", self.extraction_secondary_gain_m3_s),
                        (
                            "extraction_secondary_integral_time_s",
                            self.extraction_secondary_integral_time_s,
                        ),
                        drawn,
                        drawn_across,
                        flow,
                    )?,
                ],
            ],
        })
    }
}

fn share(field: &'static str, value: f64) -> Result<f64, ControlError> {
    if (0.0..=1.0).contains(&value) {
        Ok(value)
    } else {
        Err(ControlError::OutOfRange { field, value, requirement: "must lie between 0 and 1" })
    }
}

#[cfg(test)]
mod tests;
