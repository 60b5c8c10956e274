//! Two-step control of a feed-in pump: it waits for hot water, then holds the temperature it feeds in.
//!
//! **Equation** released while `T_house > T_set + margin`, until `T_house < T_set + margin - band`. Not
//! released, the pump stands. Released, `u = sat(K e + I; u_0, u_max)` with `e = T_supply - T_set` (a faster
//! pump takes more water through the exchanger, which leaves it colder) and the floor
//! `u_0 = sqrt(dp/H_0)` (within `speed_min` and `speed_max`), the speed at which the head at zero flow beats the grid's
//! pressure difference; back-calculation as in [`super::pi`]. **Assumptions** the pump's head goes with the
//! square of its speed. **Validity** a house that can give more heat than is asked for: the flow follows
//! from the temperature, not from a set heat. **Sources** `lamaison`, `astrom2006`.

use crate::controller::{
    Balance, ControlError, Controller, Inputs, Ports, SetPoint, Timing, narrowed, not_negative,
    positive,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(super) const PORTS: Ports = Ports {
    measures: &[
        "measures_primary_hot",
        "measures_secondary_hot",
        "measures_hot_pressure",
        "measures_cold_pressure",
    ],
    acts_on: &["acts_on_pump"],
};

/// A two-step controller as written in a model file; with `station` it finds its channels and signal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TwoStepParams {
    /// Wanted temperature of the water fed in, K; the signal `ID.supply_k`.
    pub supply_k: f64,
    /// The house must be warmer than that by this much, K.
    #[serde(default = "five")]
    pub margin_difference_k: f64,
    /// By how much its temperature may fall again before the pump stops, K.
    #[serde(default = "two")]
    pub band_difference_k: f64,
    /// Head of the pump at zero flow and full speed, Pa.
    pub head_max_pa: f64,
    /// Gain: speed per K.
    #[serde(default = "gain")]
    pub gain: f64,
    /// Integral time, s.
    #[serde(default = "integral_time")]
    pub integral_time_s: f64,
    /// Time between two updates, s; 0 updates at every step.
    #[serde(default)]
    pub interval_s: f64,
    /// Time of the first update, s.
    #[serde(default)]
    pub offset_s: f64,
    /// Smallest speed while released, with which hot water reaches the sensor.
    #[serde(default = "tenth")]
    pub speed_min: f64,
    /// Largest speed.
    #[serde(default = "one")]
    pub speed_max: f64,
}

fn five() -> f64 {
    5.0
}

fn tenth() -> f64 {
    0.1
}

fn one() -> f64 {
    1.0
}

fn two() -> f64 {
    2.0
}

fn gain() -> f64 {
    0.01
}

fn integral_time() -> f64 {
    30.0
}

/// A two-step controller ready to run. State: the integral, 1 while released.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoStep {
    params: TwoStepParams,
}

impl TwoStepParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _context: &()) -> Result<TwoStep, ControlError> {
        positive("gain", self.gain)?;
        positive("integral_time_s", self.integral_time_s)?;
        positive("head_max_pa", self.head_max_pa)?;
        not_negative("margin_difference_k", self.margin_difference_k)?;
        not_negative("band_difference_k", self.band_difference_k)?;
        not_negative("interval_s", self.interval_s)?;
        not_negative("offset_s", self.offset_s)?;
        not_negative("speed_min", self.speed_min)?;
        if self.speed_min >= self.speed_max {
            let (field, value) = ("speed_min", self.speed_min);
            let requirement = "must be below speed_max";
            return Err(ControlError::OutOfRange { field, value, requirement });
        }
        Ok(TwoStep { params: self.clone() })
    }
}

impl TwoStep {
    /// The limits of the speed while released.
    fn released_limits(&self, inputs: &Inputs) -> (f64, f64) {
        let (min, max) =
            narrowed(inputs.limits[0], Some(self.params.speed_min), Some(self.params.speed_max));
        let dp_pa = inputs.measured[2] - inputs.measured[3];
        let floor = (dp_pa.max(0.0) / self.params.head_max_pa).sqrt();
        (floor.clamp(min, max), max)
    }

    /// Positive while the water fed in is too hot: the pump can be faster.
    fn error(inputs: &Inputs) -> f64 {
        inputs.measured[0] - inputs.set_points[0]
    }

    /// By how much the house is warmer than it must be to start.
    fn surplus_k(&self, inputs: &Inputs) -> f64 {
        inputs.measured[1] - inputs.set_points[0] - self.params.margin_difference_k
    }
}

impl Controller for TwoStep {
    fn timing(&self) -> Timing {
        Timing { interval_s: self.params.interval_s, offset_s: self.params.offset_s }
    }

    fn set_points(&self) -> Vec<SetPoint> {
        vec![SetPoint { name: "supply_k", unit: "k", value: self.params.supply_k }]
    }

    fn initial_state(&self) -> Vec<f64> {
        vec![0.0; 2]
    }

    fn output_limits(&self, _output: usize, actuator: (f64, f64)) -> (f64, f64) {
        narrowed(actuator, Some(0.0), Some(self.params.speed_max))
    }

    fn update(
        &self,
        dt_s: f64,
        inputs: &Inputs,
        state: &mut [f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError> {
        let inputs = inputs.checked()?;
        let surplus_k = self.surplus_k(inputs);
        let (floor, max) = self.released_limits(inputs);
        let before = state[1] > 0.5;
        let released = surplus_k > 0.0 || (before && surplus_k > -self.params.band_difference_k);
        state[1] = f64::from(u8::from(released));
        if !released {
            outputs[0] = 0.0;
            return Ok(());
        }
        if !before {
            state[0] = floor;
        }
        let push = self.params.gain * Self::error(inputs);
        let share = if before { dt_s / self.params.integral_time_s } else { 0.0 };
        let integral = &mut state[0];
        *integral += push * share;
        let unlimited = *integral + push;
        let limited = unlimited.clamp(floor, max);
        *integral += (limited - unlimited) * share.min(1.0);
        outputs[0] = limited;
        Ok(())
    }

    fn balance(&self, inputs: &Inputs, outputs: &[f64], balance: &mut [Balance]) {
        let (floor, max) = self.released_limits(inputs);
        let miss = if self.surplus_k(inputs) > 0.0 {
            (self.params.gain * Self::error(inputs)).clamp(floor - outputs[0], max - outputs[0])
        } else {
            -outputs[0]
        };
        balance[0] = Balance { miss, scale: 1.0 };
    }

    fn rest(&self, inputs: &Inputs, outputs: &[f64], state: &mut [f64]) {
        state[0] = outputs[0];
        state[1] = f64::from(u8::from(self.surplus_k(inputs) > 0.0));
    }

    fn tracks(&self) -> bool {
        false
    }

    fn gain(&self) -> f64 {
        // A larger speed lowers the temperature.
        -self.params.gain
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_waits_starts_above_the_grid_and_stops_with_its_band() {
        let controller: TwoStepParams = serde_json::from_value(
            serde_json::json!({ "supply_k": 333.15, "head_max_pa": 40_000.0 }),
        )
        .unwrap();
        let controller = controller.build(&()).unwrap();
        let (mut state, mut outputs) = (controller.initial_state(), [0.5]);
        let mut at = |supply_k: f64, house_k: f64, dp_pa: f64| {
            let measured = [supply_k, house_k, 150_000.0 + dp_pa, 150_000.0];
            let inputs =
                Inputs { measured: &measured, set_points: &[333.15], limits: &[(0.0, 1.0)] };
            controller.update(3.0, &inputs, &mut state, &mut outputs).unwrap();
            outputs[0]
        };
        // 64 degC are not more than 60 + 5.
        assert_eq!(at(333.15, 337.15, 10_000.0), 0.0);
        // 66 degC: starts at sqrt(10/40) = 0.5 with water at its set temperature.
        assert!((at(333.15, 339.15, 10_000.0) - 0.5).abs() < 1e-12);
        // 4 K too hot: 0.5 + 0.04 (1 + 3/30) = 0.544
        assert!((at(337.15, 339.15, 10_000.0) - 0.544).abs() < 1e-12);
        // 20 K too cold: the floor, now that of 22.5 kPa: 0.75
        assert!((at(313.15, 339.15, 22_500.0) - 0.75).abs() < 1e-12);
        // The house at 64 degC: within the band; at 62 degC it stops.
        assert!(at(333.15, 337.15, 10_000.0) > 0.0);
        assert_eq!(at(333.15, 335.15, 10_000.0), 0.0);
    }
}
