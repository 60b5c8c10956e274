//! Feed-forward control of a heat flow: the flow that carries it at a known temperature difference, trimmed.
//!
//! **Equation** `m = sat(|Q_set|/(cp dT) + K e + I)`, `e = |Q_set| - |Q|`, with back-calculation as in
//! [`super::pi`]. **Assumptions** the difference is about known, for example that of a house's own circuit;
//! the trim takes what it is off. **Validity** the actuator is one of a flow: the set flow of a pump with
//! `mode = "flow"` or of a flow limiter. **Sources** `astrom2006`.

use crate::controller::{
    Balance, ControlError, Controller, Inputs, SetPoint, Timing, narrowed, not_negative, ordered,
    positive,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A feed-forward controller as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FeedForwardParams {
    /// Wanted heat, W, of either sign; the signal `ID.q_flow_w`.
    pub q_flow_w: f64,
    /// Temperature difference that is expected of the water, K.
    pub temperature_difference_k: f64,
    /// Heat capacity of the water, J/(kg K).
    #[serde(default = "water")]
    pub heat_capacity_j_kg_k: f64,
    /// Gain of the trim, kg/s per W.
    #[serde(default = "gain")]
    pub gain: f64,
    /// Integral time of the trim, s.
    #[serde(default = "integral_time")]
    pub integral_time_s: f64,
    /// Time between two updates, s; 0 updates at every step.
    #[serde(default)]
    pub interval_s: f64,
    /// Time of the first update, s.
    #[serde(default)]
    pub offset_s: f64,
    /// Smallest flow, kg/s. Absent: the actuator's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_min: Option<f64>,
    /// Largest flow, kg/s. Absent: the actuator's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_max: Option<f64>,
}

fn water() -> f64 {
    4180.0
}

fn gain() -> f64 {
    2e-6
}

fn integral_time() -> f64 {
    60.0
}

/// A feed-forward controller ready to run. State: the integral of the trim, kg/s.
#[derive(Debug, Clone, PartialEq)]
pub struct FeedForward {
    params: FeedForwardParams,
}

impl FeedForwardParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _context: &()) -> Result<FeedForward, ControlError> {
        positive("temperature_difference_k", self.temperature_difference_k)?;
        positive("heat_capacity_j_kg_k", self.heat_capacity_j_kg_k)?;
        positive("gain", self.gain)?;
        positive("integral_time_s", self.integral_time_s)?;
        not_negative("interval_s", self.interval_s)?;
        not_negative("offset_s", self.offset_s)?;
        ordered(self.output_min, self.output_max)?;
        Ok(FeedForward { params: self.clone() })
    }
}

impl FeedForward {
    /// The flow that carries the wanted heat, kg/s.
    fn expected_kg_s(&self, inputs: &Inputs) -> f64 {
        let per_kg = self.params.heat_capacity_j_kg_k * self.params.temperature_difference_k;
        inputs.set_points[0].abs() / per_kg
    }

    fn error_w(inputs: &Inputs) -> f64 {
        inputs.set_points[0].abs() - inputs.measured[0].abs()
    }
}

impl Controller for FeedForward {
    fn timing(&self) -> Timing {
        Timing { interval_s: self.params.interval_s, offset_s: self.params.offset_s }
    }

    fn set_points(&self) -> Vec<SetPoint> {
        vec![SetPoint { name: "q_flow_w", unit: "w", value: self.params.q_flow_w }]
    }

    fn initial_state(&self) -> Vec<f64> {
        vec![0.0]
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
        let push = self.params.gain * Self::error_w(inputs);
        let share = dt_s / self.params.integral_time_s;
        let trim = &mut state[0];
        *trim += push * share;
        let unlimited = self.expected_kg_s(inputs) + *trim + push;
        let limited = unlimited.clamp(min, max);
        *trim += (limited - unlimited) * share.min(1.0);
        outputs[0] = limited;
        Ok(())
    }

    fn balance(&self, inputs: &Inputs, _outputs: &[f64], balance: &mut [Balance]) {
        let scale = inputs.set_points[0].abs().max(1.0);
        balance[0] = Balance { miss: Self::error_w(inputs), scale };
    }

    fn rest(&self, inputs: &Inputs, outputs: &[f64], state: &mut [f64]) {
        state[0] = outputs[0] - self.expected_kg_s(inputs);
    }

    fn tracks(&self) -> bool {
        false
    }

    fn gain(&self) -> f64 {
        self.params.gain
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flow_is_there_at_once_and_the_trim_takes_the_rest() {
        let controller: FeedForwardParams = serde_json::from_value(serde_json::json!(
            { "q_flow_w": -10_000.0, "temperature_difference_k": 20.0, "heat_capacity_j_kg_k": 4200.0 }
        ))
        .unwrap();
        let controller = controller.build(&()).unwrap();
        let (mut state, mut outputs) = (controller.initial_state(), [0.0]);
        let mut at = |q_w: f64, dt_s: f64| {
            let inputs =
                Inputs { measured: &[q_w], set_points: &[-10_000.0], limits: &[(0.0, 0.3)] };
            controller.update(dt_s, &inputs, &mut state, &mut outputs).unwrap();
            outputs[0]
        };
        // 10 kW/(4.2 kJ/(kg K) 20 K) = 0.119048 kg/s
        assert!((at(-10_000.0, 0.0) - 0.119_048).abs() < 1e-6);
        // 1 kW missing for 6 s of 60: 2e-6 1000 (1 + 0.1) = 0.0022 more
        assert!((at(-9_000.0, 6.0) - 0.121_248).abs() < 1e-6);
        // The trim stays when nothing is missing: 2e-6 1000 0.1
        assert!((at(-10_000.0, 6.0) - 0.119_248).abs() < 1e-6);
    }
}
