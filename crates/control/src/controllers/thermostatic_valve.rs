//! A thermostatic valve: proportional, self-acting, slow.
//!
//! **Equation** `dx/dt = (x_T - x)/tau`, `x_T = sat(1/2 - (T - T_set)/X_p)`: half open at the set point,
//! closed half a proportional band above it (`opens_with_heat` turns it round). **Assumptions** sensor and
//! stem are one lag. **Numerics** linearly implicit: the answer of the measured temperature to the opening,
//! learned from the last moves, divides the move, so that steps much longer than the lag end at the
//! opening that belongs to its own temperature instead of swinging around it. **Sources** EN 215 (lag and
//! proportional band of thermostatic valves).

use crate::controller::{
    Balance, ControlError, Controller, Inputs, SetPoint, Timing, narrowed, not_negative, ordered,
    positive,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Moves smaller than this say nothing about the answer of the temperature.
const SAYING: f64 = 1e-5;
/// What is remembered of the answer from one update to the next.
const MEMORY: f64 = 0.7;

/// A thermostatic valve as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThermostaticValveParams {
    /// Temperature at which it is half open, K.
    pub set_point_k: f64,
    /// Change of temperature from closed to open, K.
    #[serde(default = "default_band")]
    pub proportional_band_difference_k: f64,
    /// Time constant of sensor and stem, s.
    #[serde(default = "default_time_constant")]
    pub time_constant_s: f64,
    /// Whether it opens with rising temperature, as for cooling; otherwise it closes.
    #[serde(default)]
    pub opens_with_heat: bool,
    /// Opening at the start of a run.
    #[serde(default = "half")]
    pub initial_output: f64,
    /// Smallest opening, for example a by-pass. Absent: the valve's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_min: Option<f64>,
    /// Largest opening. Absent: the valve's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_max: Option<f64>,
}

fn default_band() -> f64 {
    10.0
}

fn default_time_constant() -> f64 {
    60.0
}

fn half() -> f64 {
    0.5
}

/// A thermostatic valve ready to run. State: opening; temperature and opening of the last update; answer
/// of the temperature-led opening to the opening, not negative.
#[derive(Debug, Clone, PartialEq)]
pub struct ThermostaticValve {
    params: ThermostaticValveParams,
}

impl ThermostaticValveParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _context: &()) -> Result<ThermostaticValve, ControlError> {
        positive("set_point_k", self.set_point_k)?;
        positive("proportional_band_difference_k", self.proportional_band_difference_k)?;
        not_negative("time_constant_s", self.time_constant_s)?;
        ordered(self.output_min, self.output_max)?;
        Ok(ThermostaticValve { params: self.clone() })
    }
}

impl ThermostaticValve {
    /// Opening that a temperature leads to, without limits, per width of the limits.
    fn led(&self, inputs: &Inputs) -> f64 {
        let away = inputs.measured[0] - inputs.set_points[0];
        0.5 + self.gain() * away
    }
}

impl Controller for ThermostaticValve {
    fn timing(&self) -> Timing {
        Timing { interval_s: 0.0, offset_s: 0.0 }
    }

    fn set_points(&self) -> Vec<SetPoint> {
        vec![SetPoint { name: "set_point_k", unit: "k", value: self.params.set_point_k }]
    }

    fn initial_state(&self) -> Vec<f64> {
        vec![self.params.initial_output, f64::NAN, self.params.initial_output, 0.0]
    }

    fn output_limits(&self, _output: usize, actuator: (f64, f64)) -> (f64, f64) {
        narrowed(actuator, self.params.output_min, self.params.output_max)
    }

    fn update(
        &self,
        dt_s: f64,
        inputs: &Inputs,
        state: &mut [f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError> {
        let inputs = inputs.checked()?;
        let (min, max) = self.output_limits(0, inputs.limits[0]);
        let led = self.led(inputs).clamp(min, max);
        let [x, last_led, last_x, answer] = state else { return Ok(()) };
        if (*x - *last_x).abs() > SAYING && last_led.is_finite() {
            let learned = -(led - *last_led) / (*x - *last_x);
            *answer = learned.max(MEMORY * *answer);
        }
        (*last_led, *last_x) = (led, *x);
        let share = if self.params.time_constant_s > 0.0 {
            let steps = dt_s / self.params.time_constant_s;
            steps / (1.0 + steps * (1.0 + *answer))
        } else if dt_s > 0.0 {
            1.0 / (1.0 + *answer)
        } else {
            0.0
        };
        *x = (*x + share * (led - *x)).clamp(min, max);
        outputs[0] = *x;
        Ok(())
    }

    fn balance(&self, inputs: &Inputs, outputs: &[f64], balance: &mut [Balance]) {
        let (min, max) = self.output_limits(0, inputs.limits[0]);
        let miss = self.led(inputs).clamp(min, max) - outputs[0];
        balance[0] = Balance { miss, scale: 1.0 };
    }

    fn rest(&self, inputs: &Inputs, outputs: &[f64], state: &mut [f64]) {
        let (min, max) = self.output_limits(0, inputs.limits[0]);
        let led = self.led(inputs).clamp(min, max);
        state.copy_from_slice(&[outputs[0], led, outputs[0], 0.0]);
    }

    fn tracks(&self) -> bool {
        false
    }

    fn gain(&self) -> f64 {
        let gain = 1.0 / self.params.proportional_band_difference_k;
        if self.params.opens_with_heat { gain } else { -gain }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn valve(time_constant_s: f64) -> ThermostaticValve {
        ThermostaticValveParams {
            set_point_k: 313.15,
            proportional_band_difference_k: 10.0,
            time_constant_s,
            opens_with_heat: false,
            initial_output: 0.5,
            output_min: None,
            output_max: None,
        }
        .build(&())
        .unwrap()
    }

    /// Opening after steps against water that becomes warmer with the opening.
    fn after(steps: usize, dt_s: f64, k_per_opening: f64) -> f64 {
        let valve = valve(60.0);
        let (mut state, mut outputs) = (valve.initial_state(), [0.5]);
        for _ in 0..steps {
            let t = 303.15 + k_per_opening * outputs[0];
            let inputs = Inputs { measured: &[t], set_points: &[313.15], limits: &[(0.0, 1.0)] };
            valve.update(dt_s, &inputs, &mut state, &mut outputs).unwrap();
        }
        outputs[0]
    }

    #[test]
    fn a_step_much_longer_than_its_lag_does_not_swing() {
        // x = 0.5 - (303.15 + 40 x - 313.15)/10: 5 x = 1.5
        for (steps, dt_s) in [(20_000, 0.1), (2000, 1.0), (30, 900.0), (10, 1e5)] {
            let x = after(steps, dt_s, 40.0);
            assert!((x - 0.3).abs() < 1e-4, "{dt_s} s: {x}");
        }
    }

    #[test]
    fn short_steps_follow_the_lag() {
        // Loop gain 0 (the temperature stays): x - x_T decays with 60 s. T = set point + 2 K: x_T = 0.3
        let valve = valve(60.0);
        let (mut state, mut outputs) = (valve.initial_state(), [0.5]);
        for _ in 0..6000 {
            let inputs =
                Inputs { measured: &[315.15], set_points: &[313.15], limits: &[(0.0, 1.0)] };
            valve.update(0.01, &inputs, &mut state, &mut outputs).unwrap();
        }
        assert!((outputs[0] - (0.3 + 0.2 * (-1.0f64).exp())).abs() < 1e-4, "{outputs:?}");
    }
}
