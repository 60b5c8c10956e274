//! Proportional-integral control of one signal by one actuator.
//!
//! **Equation** `u = sat(f K e + I)`, `dI/dt = f K e/T_i + (u - u_unlimited)/T_i` (back-calculation),
//! `e = set point - measured`, less the dead band on either side of zero; `f` is the scheduled factor at
//! the present integral, 1 without a schedule. **Assumptions** the output is held between updates.
//! **Numerics** the back-calculation never overshoots, whatever the interval. **Sources** `astrom2006`.

use crate::controller::{
    Balance, ControlError, Controller, Inputs, SetPoint, Timing, narrowed, not_negative, not_zero,
    ordered, positive,
};
use anergy_core::numerics::interpolate::between_points;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A PI controller as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PiParams {
    /// Wanted value of the measured signal, in its SI unit.
    pub set_point: f64,
    /// Proportional gain: actuator unit per SI unit of the measured signal. Negative when a larger
    /// actuator value lowers the measured one.
    pub gain: f64,
    /// Integral time, s.
    pub integral_time_s: f64,
    /// Time between two updates, s; 0 updates at every step.
    #[serde(default)]
    pub interval_s: f64,
    /// Time of the first update, s: controllers of one interval and different offsets take turns.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub offset_s: f64,
    /// Errors up to this size, in the unit of the measured signal, are left alone.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub dead_band: f64,
    /// Outputs at which the gain is scheduled, rising.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub schedule_output: Vec<f64>,
    /// Factors of the gain at those outputs; straight in between.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub schedule_factor: Vec<f64>,
    /// Whether a set point of zero switches off: the smallest output, from which it begins anew.
    #[serde(default, skip_serializing_if = "is_false")]
    pub off_at_zero: bool,
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

#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_false(value: &bool) -> bool {
    !*value
}

/// A PI controller ready to run. State: the integral part.
#[derive(Debug, Clone, PartialEq)]
pub struct Pi {
    params: PiParams,
}

impl PiParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _context: &()) -> Result<Pi, ControlError> {
        not_zero("gain", self.gain)?;
        positive("integral_time_s", self.integral_time_s)?;
        not_negative("interval_s", self.interval_s)?;
        not_negative("offset_s", self.offset_s)?;
        not_negative("dead_band", self.dead_band)?;
        ordered(self.output_min, self.output_max)?;
        let problem =
            |field, problem: &str| Err(ControlError::Fields { field, problem: problem.to_owned() });
        if self.schedule_output.len() != self.schedule_factor.len() {
            let lengths = format!(
                "schedule_output has {} values and schedule_factor {}",
                self.schedule_output.len(),
                self.schedule_factor.len()
            );
            return problem("schedule_output", &lengths);
        }
        if !self.schedule_output.windows(2).all(|pair| pair[0] < pair[1]) {
            return problem("schedule_output", "schedule_output must rise");
        }
        for factor in &self.schedule_factor {
            positive("schedule_factor", *factor)?;
        }
        Ok(Pi { params: self.clone() })
    }
}

impl Pi {
    /// The error outside of the dead band.
    fn error(&self, inputs: &Inputs) -> f64 {
        let error = inputs.set_points[0] - inputs.measured[0];
        error.signum() * (error.abs() - self.params.dead_band).max(0.0)
    }

    fn gain_at(&self, output: f64) -> f64 {
        let params = &self.params;
        if params.schedule_output.is_empty() {
            params.gain
        } else {
            params.gain * between_points(&params.schedule_output, &params.schedule_factor, output)
        }
    }
}

impl Controller for Pi {
    fn timing(&self) -> Timing {
        Timing { interval_s: self.params.interval_s, offset_s: self.params.offset_s }
    }

    fn set_points(&self) -> Vec<SetPoint> {
        vec![SetPoint { name: "set_point", unit: "", value: self.params.set_point }]
    }

    fn initial_state(&self) -> Vec<f64> {
        vec![self.params.initial_output]
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
        if self.is_off(inputs.set_points) {
            state[0] = self.params.initial_output;
            outputs[0] = min;
            return Ok(());
        }
        let push = self.gain_at(state[0]) * self.error(inputs);
        let share = dt_s / self.params.integral_time_s;
        let integral = &mut state[0];
        *integral += push * share;
        let unlimited = *integral + push;
        let limited = unlimited.clamp(min, max);
        *integral += (limited - unlimited) * share.min(1.0);
        outputs[0] = limited;
        Ok(())
    }

    fn is_off(&self, set_points: &[f64]) -> bool {
        self.params.off_at_zero && set_points[0] == 0.0
    }

    fn limits_now(&self, output: usize, inputs: &Inputs) -> (f64, f64) {
        let (min, max) = self.output_limits(output, inputs.limits[output]);
        if self.is_off(inputs.set_points) { (min, min) } else { (min, max) }
    }

    fn balance(&self, inputs: &Inputs, _outputs: &[f64], balance: &mut [Balance]) {
        // In the middle of the dead band.
        let miss = self.params.gain.signum() * (inputs.set_points[0] - inputs.measured[0]);
        balance[0] = Balance { miss, scale: inputs.set_points[0].abs().max(1e-3) };
    }

    fn rest(&self, _inputs: &Inputs, outputs: &[f64], state: &mut [f64]) {
        state[0] = outputs[0];
    }

    fn tracks(&self) -> bool {
        true
    }

    fn gain(&self) -> f64 {
        self.params.gain
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn params() -> PiParams {
        PiParams {
            set_point: 2.0,
            gain: 0.1,
            integral_time_s: 8.0,
            interval_s: 0.0,
            offset_s: 0.0,
            dead_band: 0.0,
            off_at_zero: false,
            schedule_output: Vec::new(),
            schedule_factor: Vec::new(),
            initial_output: 0.0,
            output_min: None,
            output_max: None,
        }
    }

    fn update(pi: &Pi, dt_s: f64, measured: f64, state: &mut [f64]) -> Result<f64, ControlError> {
        let inputs = Inputs { measured: &[measured], set_points: &[2.0], limits: &[(0.0, 1.0)] };
        let mut outputs = [f64::NAN];
        pi.update(dt_s, &inputs, state, &mut outputs)?;
        Ok(outputs[0])
    }

    #[test]
    fn integrates_a_constant_error() {
        // e = 1: after 8 s of 0.1 s updates I = 0.1, u = 0.2
        let (pi, mut state, mut output) = (params().build(&()).unwrap(), vec![0.0], 0.0);
        for _ in 0..80 {
            output = update(&pi, 0.1, 1.0, &mut state).unwrap();
        }
        assert!((output - 0.2).abs() < 1e-12);
    }

    #[test]
    fn leaves_its_limit_at_once_when_the_error_turns() {
        let (pi, mut state) = (params().build(&()).unwrap(), vec![0.0]);
        for _ in 0..10_000 {
            assert!(update(&pi, 1.0, -100.0, &mut state).unwrap() <= 1.0);
        }
        // Without anti-windup the integral would be thousands; now the output falls within seconds.
        let mut output = 1.0;
        for _ in 0..20 {
            output = update(&pi, 1.0, 4.0, &mut state).unwrap();
        }
        assert!(output < 0.5, "{output} {state:?}");
        assert!(update(&pi, 1.0, f64::NAN, &mut state).is_err());
    }

    #[test]
    fn a_set_point_of_zero_switches_off() {
        let pi = PiParams { off_at_zero: true, ..params() }.build(&()).unwrap();
        let mut state = vec![0.7];
        let mut outputs = [f64::NAN];
        let off = Inputs { measured: &[0.3], set_points: &[0.0], limits: &[(0.1, 1.0)] };
        pi.update(1.0, &off, &mut state, &mut outputs).unwrap();
        assert_eq!((outputs[0], state[0], pi.limits_now(0, &off)), (0.1, 0.0, (0.1, 0.1)));
        // From there as from the start: e = 1, u = 0.1 (1 + 1/8)
        assert!((update(&pi, 1.0, 1.0, &mut state).unwrap() - 0.1125).abs() < 1e-12);
    }

    #[test]
    fn small_errors_rest_in_the_dead_band_and_the_gain_follows_its_schedule() {
        let pi = PiParams { dead_band: 0.3, ..params() }.build(&()).unwrap();
        let mut state = vec![0.4];
        assert_eq!(update(&pi, 1.0, 1.75, &mut state), Ok(0.4));
        // e = 0.5 - 0.3: u = 0.4 + 0.1 0.2 (1 + 1/8)
        assert!((update(&pi, 1.0, 1.5, &mut state).unwrap() - 0.4225).abs() < 1e-12);
        let scheduled = PiParams {
            schedule_output: vec![0.0, 1.0],
            schedule_factor: vec![1.0, 3.0],
            ..params()
        };
        // At I = 0.5 the factor is 2: u = 0.5 + 0.2 (1 + 1/8)
        let pi = scheduled.build(&()).unwrap();
        assert!((update(&pi, 1.0, 1.0, &mut [0.5]).unwrap() - 0.725).abs() < 1e-12);
        let falling = PiParams { schedule_output: vec![1.0, 0.0], ..scheduled };
        assert_eq!(falling.build(&()).unwrap_err().field(), Some("schedule_output"));
    }
}
