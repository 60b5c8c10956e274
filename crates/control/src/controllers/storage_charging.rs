//! Charging of a stratified storage by a heat pump: its top first, then its middle.
//!
//! **Equation** the valve turns to the top when the layer there falls below `valve_on_k` and back above
//! `valve_off_k`; the modulation is the factor of [`crate::modulation`] with the reference layer and the band of
//! the segment that is charged. **Assumptions** the heat pump raises what it cannot do. **Numerics** none: an
//! algebraic answer with two memories. **Sources** `angelidis2023`.

use crate::controller::{
    Balance, ControlError, Controller, Inputs, Ports, SetPoint, Timing, not_negative,
};
use crate::modulation::Band;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Layers and signals.
pub const PORTS: Ports = Ports {
    measures: &["measures_top", "measures_middle", "measures_valve"],
    acts_on: &["acts_on_modulation", "acts_on_valve"],
};

/// Charging as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StorageChargingParams {
    /// Full power for the top at this temperature of its reference layer, K.
    #[serde(default = "top_start")]
    pub top_start_k: f64,
    /// No power for the top from this temperature on, K.
    #[serde(default = "top_stop")]
    pub top_stop_k: f64,
    /// Full power for the middle at this temperature of its reference layer, K.
    #[serde(default = "middle_start")]
    pub middle_start_k: f64,
    /// No power for the middle from this temperature on, K.
    #[serde(default = "middle_stop")]
    pub middle_stop_k: f64,
    /// The valve turns to the top below this temperature, K.
    #[serde(default = "valve_on")]
    pub valve_on_k: f64,
    /// The valve turns to the middle above this temperature, K.
    #[serde(default = "valve_off")]
    pub valve_off_k: f64,
    /// Position of the valve for the top.
    #[serde(default)]
    pub valve_top: f64,
    /// Position of the valve for the middle.
    #[serde(default = "one")]
    pub valve_middle: f64,
    /// Whether the power follows the factor, or is on or off.
    #[serde(default = "yes")]
    pub modulating: bool,
    /// Time between two updates, s; 0 updates at every step.
    #[serde(default)]
    pub interval_s: f64,
    /// Time of the first update, s.
    #[serde(default)]
    pub offset_s: f64,
}

fn top_start() -> f64 {
    325.15
}

fn top_stop() -> f64 {
    331.15
}

fn middle_start() -> f64 {
    307.15
}

fn middle_stop() -> f64 {
    313.15
}

fn valve_on() -> f64 {
    328.15
}

fn valve_off() -> f64 {
    331.15
}

fn one() -> f64 {
    1.0
}

fn yes() -> bool {
    true
}

/// Charging ready to run. State: 1 while it charges the top; 1 while the heat pump runs.
#[derive(Debug, Clone, PartialEq)]
pub struct StorageCharging {
    params: StorageChargingParams,
}

impl StorageChargingParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _context: &()) -> Result<StorageCharging, ControlError> {
        not_negative("interval_s", self.interval_s)?;
        not_negative("offset_s", self.offset_s)?;
        for (field, low, high, other) in [
            ("top_start_k", self.top_start_k, self.top_stop_k, "must be below top_stop"),
            (
                "middle_start_k",
                self.middle_start_k,
                self.middle_stop_k,
                "must be below middle_stop",
            ),
            ("valve_on_k", self.valve_on_k, self.valve_off_k, "must be below valve_off"),
        ] {
            if low.is_nan() || high.is_nan() || low >= high {
                return Err(ControlError::OutOfRange { field, value: low, requirement: other });
            }
        }
        Ok(StorageCharging { params: self.clone() })
    }
}

impl StorageCharging {
    /// Modulation and whether the top is charged, given the memories.
    fn answer(&self, inputs: &Inputs, top: bool, running: bool) -> (f64, bool) {
        let [top_start_k, top_stop_k, middle_start_k, middle_stop_k, on_k, off_k] =
            [0, 1, 2, 3, 4, 5].map(|point| inputs.set_points[point]);
        let valve_k = inputs.measured[2];
        let top = if top { valve_k < off_k } else { valve_k < on_k };
        let (band, t_k) = if top {
            (Band { start_k: top_start_k, stop_k: top_stop_k }, inputs.measured[0])
        } else {
            (Band { start_k: middle_start_k, stop_k: middle_stop_k }, inputs.measured[1])
        };
        (band.modulation(t_k, running, self.params.modulating), top)
    }

    fn valve(&self, top: bool) -> f64 {
        if top { self.params.valve_top } else { self.params.valve_middle }
    }
}

impl Controller for StorageCharging {
    fn timing(&self) -> Timing {
        Timing { interval_s: self.params.interval_s, offset_s: self.params.offset_s }
    }

    fn set_points(&self) -> Vec<SetPoint> {
        let params = &self.params;
        let point = |name, value| SetPoint { name, unit: "k", value };
        vec![
            point("top_start_k", params.top_start_k),
            point("top_stop_k", params.top_stop_k),
            point("middle_start_k", params.middle_start_k),
            point("middle_stop_k", params.middle_stop_k),
            point("valve_on_k", params.valve_on_k),
            point("valve_off_k", params.valve_off_k),
        ]
    }

    fn initial_state(&self) -> Vec<f64> {
        vec![0.0, 0.0]
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
        let (modulation, top) = self.answer(inputs, state[0] > 0.5, state[1] > 0.5);
        (state[0], state[1]) = (f64::from(top), f64::from(modulation > 0.0));
        (outputs[0], outputs[1]) = (modulation, self.valve(top));
        Ok(())
    }

    fn balance(&self, inputs: &Inputs, outputs: &[f64], balance: &mut [Balance]) {
        // It answers what it measures; in the steady state of a storage that is its start.
        let (modulation, top) = self.answer(inputs, false, false);
        balance[0] = Balance { miss: modulation - outputs[0], scale: 1.0 };
        balance[1] = Balance { miss: self.valve(top) - outputs[1], scale: 1.0 };
    }

    fn rest(&self, _inputs: &Inputs, outputs: &[f64], state: &mut [f64]) {
        state[0] = f64::from(outputs[1] == self.params.valve_top);
        state[1] = f64::from(outputs[0] > 0.0);
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
    fn charges_the_top_first() {
        let params: StorageChargingParams = serde_json::from_str("{}").unwrap();
        let charging = params.build(&()).unwrap();
        let points: Vec<f64> = charging.set_points().iter().map(|point| point.value).collect();
        let mut state = charging.initial_state();
        let mut outputs = [f64::NAN; 2];
        // Temperatures of layers 7, 4 and 9 in degC; modulation, position of the valve.
        for (layers, expected) in [
            // 54.9 degC is below 55: to the top, 1 - (53.5 - 52)/6 = 0.75
            ([53.5, 36.0, 54.9], [0.75, 0.0]),
            // until 58 degC
            ([57.0, 36.0, 57.9], [1.0 / 6.0, 0.0]),
            // then the middle: 1 - (36 - 34)/6, and it still runs
            ([58.0, 36.0, 58.1], [2.0 / 3.0, 1.0]),
            ([58.0, 39.0, 56.0], [1.0 / 6.0, 1.0]),
            ([58.0, 40.0, 56.0], [0.0, 1.0]),
            // stays off until 0.3
            ([58.0, 39.0, 56.0], [0.0, 1.0]),
            ([58.0, 38.0, 56.0], [1.0 / 3.0, 1.0]),
        ] {
            let measured = layers.map(|t| t + 273.15);
            let inputs =
                Inputs { measured: &measured, set_points: &points, limits: &[(0.0, 1.0); 2] };
            charging.update(1.0, &inputs, &mut state, &mut outputs).unwrap();
            for (output, expected) in outputs.iter().zip(expected) {
                assert!((output - expected).abs() < 1e-9, "{layers:?}: {outputs:?}");
            }
        }
        let wrong = StorageChargingParams { top_stop_k: 320.0, ..params };
        assert_eq!(wrong.build(&()).unwrap_err().field(), Some("top_start_k"));
    }
}
