//! Two PI controllers in a row: the outer one's output is the set point of the inner one, for example a
//! supply temperature held by the pressure difference that a pump is to keep.
//!
//! **Equation** `s = sat(K_o e_o + I_o; s_min, s_max)`, `u = sat(K_i (s - y_i) + I_i)`, both integrals with
//! back-calculation as in [`super::pi`]. **Assumptions** both update at the same interval. **Sources**
//! `rosemann2017` (pressure difference inside, supply temperature outside), `astrom2006`.

use super::pi::{Pi, PiParams};
use crate::controller::{Balance, ControlError, Controller, Inputs, Ports, SetPoint, Timing};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(super) const PORTS: Ports =
    Ports { measures: &["measures", "inner_measures"], acts_on: &["acts_on"] };

/// A cascade as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CascadeParams {
    /// Wanted value of the signal that the outer controller measures, in its SI unit.
    pub set_point: f64,
    /// Gain of the outer controller: inner unit per outer unit (Pa/K for a pressure difference that
    /// holds a temperature).
    pub gain: f64,
    /// Integral time of the outer controller, s.
    pub integral_time_s: f64,
    /// Smallest set point of the inner controller, in its SI unit.
    pub inner_set_min: f64,
    /// Largest set point of the inner controller.
    pub inner_set_max: f64,
    /// Set point of the inner controller at the start. Absent: the smallest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inner_set_initial: Option<f64>,
    /// Gain of the inner controller: actuator unit per inner unit.
    pub inner_gain: f64,
    /// Integral time of the inner controller, s.
    pub inner_integral_time_s: f64,
    /// Time between two updates, s; 0 updates at every step.
    #[serde(default)]
    pub interval_s: f64,
    /// Time of the first update, s.
    #[serde(default)]
    pub offset_s: f64,
    /// Output at the start of a run.
    #[serde(default)]
    pub initial_output: f64,
    /// Smallest output. Absent: the actuator's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_min: Option<f64>,
    /// Largest output. Absent: the actuator's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_max: Option<f64>,
}

/// A cascade ready to run. State: the outer integral, the inner one.
#[derive(Debug, Clone, PartialEq)]
pub struct Cascade {
    outer: Pi,
    inner: Pi,
    set_limits: (f64, f64),
    initial: [f64; 2],
    set_point: f64,
}

impl CascadeParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _context: &()) -> Result<Cascade, ControlError> {
        let (min, max) = (self.inner_set_min, self.inner_set_max);
        if !(min.is_finite() && max.is_finite() && min < max) {
            let requirement = "must be below inner_set_max";
            return Err(ControlError::OutOfRange {
                field: "inner_set_min",
                value: min,
                requirement,
            });
        }
        let initial_set = self.inner_set_initial.unwrap_or(min);
        if !(min..=max).contains(&initial_set) {
            return Err(ControlError::OutOfRange {
                field: "inner_set_initial",
                value: initial_set,
                requirement: "must lie between inner_set_min and inner_set_max",
            });
        }
        let pi = |set_point, gain, integral_time_s, initial_output| PiParams {
            off_at_zero: false,
            set_point,
            gain,
            integral_time_s,
            interval_s: self.interval_s,
            offset_s: self.offset_s,
            initial_output,
            output_min: self.output_min,
            output_max: self.output_max,
            dead_band: 0.0,
            schedule_output: Vec::new(),
            schedule_factor: Vec::new(),
        };
        let inner = |error: ControlError| match error {
            ControlError::OutOfRange { field: "gain", value, requirement } => {
                ControlError::OutOfRange { field: "inner_gain", value, requirement }
            }
            ControlError::OutOfRange { field: "integral_time_s", value, requirement } => {
                ControlError::OutOfRange { field: "inner_integral_time_s", value, requirement }
            }
            other => other,
        };
        let mut outer = pi(self.set_point, self.gain, self.integral_time_s, initial_set);
        (outer.output_min, outer.output_max) = (None, None);
        Ok(Cascade {
            outer: outer.build(&())?,
            inner: pi(0.0, self.inner_gain, self.inner_integral_time_s, self.initial_output)
                .build(&())
                .map_err(inner)?,
            set_limits: (min, max),
            initial: [initial_set, self.initial_output],
            set_point: self.set_point,
        })
    }
}

impl Controller for Cascade {
    fn timing(&self) -> Timing {
        self.inner.timing()
    }

    fn set_points(&self) -> Vec<SetPoint> {
        vec![SetPoint { name: "set_point", unit: "", value: self.set_point }]
    }

    fn initial_state(&self) -> Vec<f64> {
        self.initial.to_vec()
    }

    fn output_limits(&self, output: usize, actuator: (f64, f64)) -> (f64, f64) {
        self.inner.output_limits(output, actuator)
    }

    fn update(
        &self,
        dt_s: f64,
        inputs: &Inputs,
        state: &mut [f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError> {
        let (outer_state, inner_state) = state.split_at_mut(1);
        let mut set = [0.0];
        let outer = Inputs {
            measured: &inputs.measured[..1],
            set_points: inputs.set_points,
            limits: &[self.set_limits],
        };
        self.outer.update(dt_s, &outer, outer_state, &mut set)?;
        let inner =
            Inputs { measured: &inputs.measured[1..], set_points: &set, limits: inputs.limits };
        self.inner.update(dt_s, &inner, inner_state, outputs)
    }

    fn balance(&self, inputs: &Inputs, _outputs: &[f64], balance: &mut [Balance]) {
        // The outer value is held as long as the inner one stays within its limits.
        let (min, max) = self.set_limits;
        let inner = self.inner.gain().signum();
        let scale = (max - min).abs();
        let outer_scale = inputs.set_points[0].abs().max(1e-3);
        let at = |set: f64| inner * (set - inputs.measured[1]) / scale;
        let error = inputs.set_points[0] - inputs.measured[0];
        let follow = inner * self.outer.gain().signum() * error / outer_scale;
        let (low, high) = (at(min).min(at(max)), at(min).max(at(max)));
        balance[0] = Balance { miss: follow.clamp(low, high), scale: 1.0 };
    }

    fn rest(&self, inputs: &Inputs, outputs: &[f64], state: &mut [f64]) {
        state[0] = inputs.measured[1].clamp(self.set_limits.0, self.set_limits.1);
        state[1] = outputs[0];
    }

    fn tracks(&self) -> bool {
        true
    }

    fn gain(&self) -> f64 {
        self.inner.gain()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outer_controller_moves_the_set_point_of_the_inner_one() {
        let cascade = CascadeParams {
            set_point: 330.0,
            gain: 500.0,
            integral_time_s: 60.0,
            inner_set_min: 1e4,
            inner_set_max: 5e4,
            inner_set_initial: Some(2e4),
            inner_gain: 2e-6,
            inner_integral_time_s: 5.0,
            interval_s: 0.0,
            offset_s: 0.0,
            initial_output: 0.5,
            output_min: None,
            output_max: None,
        }
        .build(&())
        .unwrap();
        let mut state = cascade.initial_state();
        let mut outputs = [0.0];
        let mut at = |measured: &[f64]| {
            let inputs = Inputs { measured, set_points: &[330.0], limits: &[(0.0, 1.0)] };
            cascade.update(6.0, &inputs, &mut state, &mut outputs).unwrap();
            outputs[0]
        };
        // e_o = 2 K: s = 20 000 + 1000 (1 + 6/60) = 21 100 Pa, 1100 Pa more than measured:
        // u = 0.5 + 2e-6 1100 (1 + 6/5)
        assert!((at(&[328.0, 2e4]) - 0.504_84).abs() < 1e-9);
        // Far too cold: the pressure difference stops at its limit.
        for _ in 0..1000 {
            at(&[300.0, 5e4]);
        }
        assert!((state[0] - 5e4).abs() < 1.6e4, "{state:?}");
        let mut balance = [Balance::default()];
        let inputs =
            Inputs { measured: &[300.0, 5e4], set_points: &[330.0], limits: &[(0.0, 1.0)] };
        cascade.balance(&inputs, &[0.7], &mut balance);
        assert_eq!(balance[0].miss, 0.0, "cold, but at the largest pressure difference");
    }
}
