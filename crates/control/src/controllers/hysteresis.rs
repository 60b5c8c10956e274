//! On and off with a band in between.
//!
//! **Equation** on when the measured value falls below `set point - band/2`, off when it rises above
//! `set point + band/2` (`on_above` turns it round); in between it stays. **Sources** `astrom2006`.

use crate::controller::{
    Balance, ControlError, Controller, Inputs, SetPoint, Timing, not_negative,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An on-off controller as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HysteresisParams {
    /// Middle of the band, in the SI unit of the measured signal.
    pub set_point: f64,
    /// Width of the band, in the same unit.
    pub band: f64,
    /// Output while on.
    #[serde(default = "one")]
    pub on_output: f64,
    /// Output while off.
    #[serde(default)]
    pub off_output: f64,
    /// On above the band instead of below it.
    #[serde(default)]
    pub on_above: bool,
    /// On at the start of a run.
    #[serde(default)]
    pub initially_on: bool,
    /// Time between two updates, s; 0 updates at every step.
    #[serde(default)]
    pub interval_s: f64,
    /// Time of the first update, s.
    #[serde(default)]
    pub offset_s: f64,
}

fn one() -> f64 {
    1.0
}

/// An on-off controller ready to run. State: 1 while on.
#[derive(Debug, Clone, PartialEq)]
pub struct Hysteresis {
    params: HysteresisParams,
}

impl HysteresisParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _context: &()) -> Result<Hysteresis, ControlError> {
        not_negative("band", self.band)?;
        not_negative("interval_s", self.interval_s)?;
        not_negative("offset_s", self.offset_s)?;
        if self.on_output == self.off_output {
            let (field, value) = ("on_output", self.on_output);
            let requirement = "must differ from off_output";
            return Err(ControlError::OutOfRange { field, value, requirement });
        }
        Ok(Hysteresis { params: self.clone() })
    }
}

impl Hysteresis {
    fn output(&self, on: bool) -> f64 {
        if on { self.params.on_output } else { self.params.off_output }
    }
}

impl Controller for Hysteresis {
    fn timing(&self) -> Timing {
        Timing { interval_s: self.params.interval_s, offset_s: self.params.offset_s }
    }

    fn set_points(&self) -> Vec<SetPoint> {
        vec![SetPoint { name: "set_point", unit: "", value: self.params.set_point }]
    }

    fn initial_state(&self) -> Vec<f64> {
        vec![f64::from(u8::from(self.params.initially_on))]
    }

    fn output_limits(&self, _output: usize, actuator: (f64, f64)) -> (f64, f64) {
        actuator
    }

    fn update(
        &self,
        _dt_s: f64,
        inputs: &Inputs,
        state: &mut [f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError> {
        let inputs = inputs.checked()?;
        let sign = if self.params.on_above { 1.0 } else { -1.0 };
        let away = sign * (inputs.measured[0] - inputs.set_points[0]);
        if away > 0.5 * self.params.band {
            state[0] = 1.0;
        } else if away < -0.5 * self.params.band {
            state[0] = 0.0;
        }
        outputs[0] = self.output(state[0] > 0.5);
        Ok(())
    }

    fn balance(&self, _inputs: &Inputs, outputs: &[f64], balance: &mut [Balance]) {
        // It has no steady state: it stays as it starts.
        let miss = self.output(self.params.initially_on) - outputs[0];
        balance[0] = Balance { miss, scale: 1.0 };
    }

    fn rest(&self, _inputs: &Inputs, outputs: &[f64], state: &mut [f64]) {
        state[0] = f64::from(u8::from(outputs[0] == self.params.on_output));
    }

    fn tracks(&self) -> bool {
        false
    }

    fn gain(&self) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn switches_at_both_ends_of_its_band() {
        let on_off = |on_above| {
            HysteresisParams {
                set_point: 50.0,
                band: 10.0,
                on_output: 0.8,
                off_output: 0.1,
                on_above,
                initially_on: false,
                interval_s: 0.0,
                offset_s: 0.0,
            }
            .build(&())
            .unwrap()
        };
        for (on_above, outputs) in
            [(false, [0.1, 0.8, 0.8, 0.1, 0.1]), (true, [0.1, 0.1, 0.1, 0.8, 0.8])]
        {
            let (on_off, mut state) = (on_off(on_above), vec![0.0]);
            for (measured, expected) in [50.0, 44.0, 54.0, 56.0, 46.0].into_iter().zip(outputs) {
                let inputs =
                    Inputs { measured: &[measured], set_points: &[50.0], limits: &[(0.0, 1.0)] };
                let mut output = [f64::NAN];
                on_off.update(1.0, &inputs, &mut state, &mut output).unwrap();
                assert_eq!(output[0], expected, "{measured}");
            }
        }
    }
}
