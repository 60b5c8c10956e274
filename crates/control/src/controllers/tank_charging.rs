//! On and off by two sensors: a generator by the top and the bottom of its storage, the pump that charges a tank.
//!
//! **Equation** on where the first measured value falls below `on_below`, off where the second rises above `off_above`;
//! with `warmer_by_difference_k` also off, and not on, where the second is not warmer than the first by that much.
//! `two_sensors`: first the top, second the bottom of a storage. `tank_charging`: first the top of the tank, second
//! the storage that charges it; off where the tank is above `off_above`.
//!
//! **Validity** one command. **Sources** `zinsmeister2022` (rules of the laboratory houses).

use crate::controller::{
    Balance, ControlError, Controller, Inputs, Ports, SetPoint, Timing, not_negative,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(super) const TWO_SENSORS: Ports =
    Ports { measures: &["measures_on", "measures_off"], acts_on: &["acts_on"] };
pub(super) const TANK: Ports =
    Ports { measures: &["measures_tank", "measures_source"], acts_on: &["acts_on"] };

fn one() -> f64 {
    1.0
}

fn fifty() -> f64 {
    323.15
}

fn sixty_five() -> f64 {
    338.15
}

/// On by one sensor, off by another, as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TwoSensorsParams {
    /// On where `measures_on` is below this, K.
    pub on_below_k: f64,
    /// Off where `measures_off` is above this, K.
    pub off_above_k: f64,
    /// Output while on.
    #[serde(default = "one")]
    pub on_output: f64,
    /// Output while off.
    #[serde(default)]
    pub off_output: f64,
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

/// The charging of a tank of hot water as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TankChargingParams {
    /// On where the top of the tank is below this, K.
    #[serde(default = "fifty")]
    pub on_below_k: f64,
    /// Off where the top of the tank is above this, K.
    #[serde(default = "sixty_five")]
    pub off_above_k: f64,
    /// The storage must be warmer than the tank by more than this, K.
    #[serde(default)]
    pub warmer_by_difference_k: f64,
    /// Output while on: of the flow of a circuit, m3/s.
    #[serde(default = "one")]
    pub on_output: f64,
    /// Output while off.
    #[serde(default)]
    pub off_output: f64,
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

/// Either, ready to run. State: 1 while on.
#[derive(Debug, Clone, PartialEq)]
pub struct TankCharging {
    on_below_k: f64,
    off_above_k: f64,
    /// For tanks: how much warmer the storage must be.
    warmer_by_k: Option<f64>,
    outputs: (f64, f64),
    initially_on: bool,
    timing: Timing,
}

impl TankCharging {
    fn checked(self) -> Result<Self, ControlError> {
        not_negative("interval_s", self.timing.interval_s)?;
        not_negative("offset_s", self.timing.offset_s)?;
        if self.outputs.0 == self.outputs.1 {
            let (field, value) = ("on_output", self.outputs.0);
            let requirement = "must differ from off_output";
            return Err(ControlError::OutOfRange { field, value, requirement });
        }
        if self.warmer_by_k.is_some() && self.on_below_k >= self.off_above_k {
            let (field, value) = ("on_below_k", self.on_below_k);
            let requirement = "must be below off_above_k";
            return Err(ControlError::OutOfRange { field, value, requirement });
        }
        Ok(self)
    }

    /// Whether it is on after having been on or off.
    fn on(&self, was_on: bool, measured: &[f64], set_points: &[f64]) -> bool {
        let (first, second) = (measured[0], measured[1]);
        let (on_below_k, off_above_k) = (set_points[0], set_points[1]);
        let (off, can) = match self.warmer_by_k {
            Some(warmer_k) => (first > off_above_k, second - first > warmer_k),
            None => (second > off_above_k, true),
        };
        can && !off && (was_on || first < on_below_k)
    }

    fn output(&self, on: bool) -> f64 {
        if on { self.outputs.0 } else { self.outputs.1 }
    }
}

impl TwoSensorsParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _context: &()) -> Result<TankCharging, ControlError> {
        let controller = TankCharging {
            on_below_k: self.on_below_k,
            off_above_k: self.off_above_k,
            warmer_by_k: None,
            outputs: (self.on_output, self.off_output),
            initially_on: self.initially_on,
            timing: Timing { interval_s: self.interval_s, offset_s: self.offset_s },
        };
        controller.checked()
    }
}

impl TankChargingParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _context: &()) -> Result<TankCharging, ControlError> {
        let controller = TankCharging {
            on_below_k: self.on_below_k,
            off_above_k: self.off_above_k,
            warmer_by_k: Some(not_negative("warmer_by_difference_k", self.warmer_by_difference_k)?),
            outputs: (self.on_output, self.off_output),
            initially_on: self.initially_on,
            timing: Timing { interval_s: self.interval_s, offset_s: self.offset_s },
        };
        controller.checked()
    }
}

impl Controller for TankCharging {
    fn timing(&self) -> Timing {
        self.timing
    }

    fn set_points(&self) -> Vec<SetPoint> {
        vec![
            SetPoint { name: "on_below_k", unit: "k", value: self.on_below_k },
            SetPoint { name: "off_above_k", unit: "k", value: self.off_above_k },
        ]
    }

    fn initial_state(&self) -> Vec<f64> {
        vec![f64::from(u8::from(self.initially_on))]
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
        let on = self.on(state[0] > 0.5, inputs.measured, inputs.set_points);
        state[0] = f64::from(u8::from(on));
        outputs[0] = self.output(on);
        Ok(())
    }

    fn balance(&self, _inputs: &Inputs, outputs: &[f64], balance: &mut [Balance]) {
        // It has no steady state: it stays as it starts.
        let miss = self.output(self.initially_on) - outputs[0];
        balance[0] = Balance { miss, scale: 1.0 };
    }

    fn rest(&self, _inputs: &Inputs, outputs: &[f64], state: &mut [f64]) {
        state[0] = f64::from(u8::from(outputs[0] == self.outputs.0));
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

    fn outputs(controller: &TankCharging, measured: &[[f64; 2]]) -> Vec<f64> {
        let mut state = controller.initial_state();
        let set_points = [controller.on_below_k, controller.off_above_k];
        let update = |measured: &[f64; 2]| {
            let inputs =
                Inputs { measured, set_points: &set_points, limits: &[(0.0, f64::INFINITY)] };
            let mut output = [f64::NAN];
            controller.update(1.0, &inputs, &mut state, &mut output).unwrap();
            output[0]
        };
        measured.iter().map(update).collect()
    }

    #[test]
    fn a_generator_by_top_and_bottom() {
        let params = serde_json::json!({ "on_below_k": 333.0, "off_above_k": 343.0 });
        let params: TwoSensorsParams = serde_json::from_value(params).unwrap();
        let boiler = params.build(&()).unwrap();
        // Off while the top is warm; on below; stays on until the bottom is hot.
        let measured =
            [[340.0, 310.0], [332.0, 310.0], [350.0, 342.0], [350.0, 344.0], [334.0, 320.0]];
        assert_eq!(outputs(&boiler, &measured), [0.0, 1.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_tank_is_charged_where_the_storage_is_warmer() {
        let params = serde_json::json!({ "on_output": 3e-4 });
        let params: TankChargingParams = serde_json::from_value(params).unwrap();
        let pump = params.build(&()).unwrap();
        // Tank, storage: below 50 degC and storage warmer: on; until 65 degC, or the storage is colder.
        let degc = |pair: [f64; 2]| pair.map(|t| t + 273.15);
        let measured = [
            [55.0, 70.0],
            [49.0, 48.0],
            [49.0, 60.0],
            [60.0, 70.0],
            [66.0, 75.0],
            [49.0, 60.0],
            [58.0, 57.0],
        ];
        let expected = [0.0, 0.0, 3e-4, 3e-4, 0.0, 3e-4, 0.0];
        assert_eq!(outputs(&pump, &measured.map(degc)), expected);
        let wrong = TankChargingParams { on_below_k: 340.0, ..params };
        assert!(wrong.build(&()).is_err());
    }
}
