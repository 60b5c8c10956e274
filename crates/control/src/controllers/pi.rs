//! Proportional-integral control of one signal by one actuator.
//!
//! **Equation** `u = sat(K e + I)`, `dI/dt = K e/T_i + (u - u_unlimited)/T_i` (back-calculation),
//! `e = set point - measured`. **Assumptions** the output is held between updates. **Numerics** the
//! back-calculation never overshoots, whatever the interval. **Sources** `astrom2006`.

use crate::controller::{ControlError, Controller};
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
        let out_of_range =
            |field, value, requirement| Err(ControlError::OutOfRange { field, value, requirement });
        if !self.gain.is_finite() || self.gain == 0.0 {
            return out_of_range("gain", self.gain, "must not be zero");
        }
        if !self.integral_time_s.is_finite() || self.integral_time_s <= 0.0 {
            return out_of_range("integral_time_s", self.integral_time_s, "must be positive");
        }
        if !self.interval_s.is_finite() || self.interval_s < 0.0 {
            return out_of_range("interval_s", self.interval_s, "must not be negative");
        }
        if let (Some(min), Some(max)) = (self.output_min, self.output_max)
            && min >= max
        {
            return out_of_range("output_min", min, "must be below output_max");
        }
        Ok(Pi { params: self.clone() })
    }
}

impl Controller for Pi {
    fn interval_s(&self) -> f64 {
        self.params.interval_s
    }

    fn initial_state(&self) -> Vec<f64> {
        vec![self.params.initial_output]
    }

    fn output_limits(&self, (min, max): (f64, f64)) -> (f64, f64) {
        // Within what the actuator can do, also when the file asks for more.
        let low = self.params.output_min.map_or(min, |low| low.clamp(min, max));
        let high = self.params.output_max.map_or(max, |high| high.clamp(min, max));
        (low, high.max(low))
    }

    fn direction(&self) -> f64 {
        self.params.gain.signum()
    }

    fn set_point(&self) -> f64 {
        self.params.set_point
    }

    fn update(
        &self,
        dt_s: f64,
        measured: f64,
        set_point: f64,
        limits: (f64, f64),
        state: &mut [f64],
    ) -> Result<f64, ControlError> {
        if !measured.is_finite() {
            return Err(ControlError::Measured { measured });
        }
        let (min, max) = self.output_limits(limits);
        let error = set_point - measured;
        let share = dt_s / self.params.integral_time_s;
        let integral = &mut state[0];
        *integral += self.params.gain * error * share;
        let unlimited = *integral + self.params.gain * error;
        let limited = unlimited.clamp(min, max);
        *integral += (limited - unlimited) * share.min(1.0);
        Ok(limited)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pi() -> Pi {
        PiParams {
            set_point: 2.0,
            gain: 0.1,
            integral_time_s: 8.0,
            interval_s: 0.0,
            initial_output: 0.0,
            output_min: None,
            output_max: None,
        }
        .build(&())
        .unwrap()
    }

    #[test]
    fn integrates_a_constant_error() {
        // e = 1: after 8 s of 0.1 s updates I = 0.1, u = 0.2
        let (pi, mut state, mut output) = (pi(), vec![0.0], 0.0);
        for _ in 0..80 {
            output = pi.update(0.1, 1.0, 2.0, (0.0, 1.0), &mut state).unwrap();
        }
        assert!((output - 0.2).abs() < 1e-12);
    }

    #[test]
    fn leaves_its_limit_at_once_when_the_error_turns() {
        let (pi, mut state) = (pi(), vec![0.0]);
        for _ in 0..10_000 {
            assert!(pi.update(1.0, -100.0, 2.0, (0.0, 1.0), &mut state).unwrap() <= 1.0);
        }
        // Without anti-windup the integral would be thousands; now the output falls within seconds.
        let mut output = 1.0;
        for _ in 0..20 {
            output = pi.update(1.0, 4.0, 2.0, (0.0, 1.0), &mut state).unwrap();
        }
        assert!(output < 0.5, "{output} {state:?}");
        assert!(pi.update(1.0, f64::NAN, 2.0, (0.0, 1.0), &mut state).is_err());
    }
}
