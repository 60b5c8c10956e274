//! Balancing of a grid: the heat pump of a balancing unit heats or cools its storage, as the flow through it says.
//!
//! **Equation** a flow from the cold to the hot line above the dead band (heating dominates) is the heating mode, one below
//! its negative the cooling mode, in between the unit idles; the modulation is the factor of [`crate::modulation`] with
//! the reference layer and the band of the mode. A mode lasts for `mode_time_s` at least. **Assumptions** the ports
//! of the storage are switched by the valve. **Sources** `angelidis2023`.

use crate::controller::{
    Balance, ControlError, Controller, Inputs, Ports, SetPoint, Timing, not_negative,
};
use crate::modulation::Band;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Flow, layers and signals.
pub const PORTS: Ports = Ports {
    measures: &["measures_flow", "measures_heating", "measures_cooling"],
    acts_on: &["acts_on_modulation", "acts_on_mode", "acts_on_valve"],
};

/// Balancing as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BalancingParams {
    /// Full heating at this temperature of its reference layer, K.
    #[serde(default = "heating_start")]
    pub heating_start_k: f64,
    /// No heating from this temperature on, K.
    #[serde(default = "heating_stop")]
    pub heating_stop_k: f64,
    /// Full cooling at this temperature of its reference layer, K.
    #[serde(default = "cooling_start")]
    pub cooling_start_k: f64,
    /// No cooling from this temperature down, K.
    #[serde(default = "cooling_stop")]
    pub cooling_stop_k: f64,
    /// Flows up to this one, either way, are no demand, kg/s.
    #[serde(default = "dead_band")]
    pub dead_band_kg_s: f64,
    /// Time for which a mode lasts at least, s.
    #[serde(default = "mode_time")]
    pub mode_time_s: f64,
    /// Position of the valve for heating.
    #[serde(default)]
    pub valve_heating: f64,
    /// Position of the valve for cooling.
    #[serde(default = "one")]
    pub valve_cooling: f64,
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

fn heating_start() -> f64 {
    289.65
}

fn heating_stop() -> f64 {
    292.65
}

fn cooling_start() -> f64 {
    291.15
}

fn cooling_stop() -> f64 {
    288.15
}

fn dead_band() -> f64 {
    // 0.5 l/min
    0.5 / 60.0
}

fn mode_time() -> f64 {
    300.0
}

fn one() -> f64 {
    1.0
}

fn yes() -> bool {
    true
}

/// Balancing ready to run. State: the mode (1 heating, -1 cooling, 0 idle), since when, s, and 1 while the heat pump
/// runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Balancing {
    params: BalancingParams,
}

impl BalancingParams {
    /// The runtime controller.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _context: &()) -> Result<Balancing, ControlError> {
        for (field, value) in [
            ("dead_band_kg_s", self.dead_band_kg_s),
            ("mode_time_s", self.mode_time_s),
            ("interval_s", self.interval_s),
            ("offset_s", self.offset_s),
        ] {
            not_negative(field, value)?;
        }
        for (field, low, high, requirement) in [
            (
                "heating_start_k",
                self.heating_start_k,
                self.heating_stop_k,
                "must be below heating_stop",
            ),
            (
                "cooling_stop_k",
                self.cooling_stop_k,
                self.cooling_start_k,
                "must be below cooling_start",
            ),
        ] {
            if low.is_nan() || high.is_nan() || low >= high {
                return Err(ControlError::OutOfRange { field, value: low, requirement });
            }
        }
        Ok(Balancing { params: self.clone() })
    }
}

impl Balancing {
    fn wanted_mode(&self, inputs: &Inputs) -> f64 {
        let flow_kg_s = inputs.measured[0];
        if flow_kg_s.abs() > self.params.dead_band_kg_s { flow_kg_s.signum() } else { 0.0 }
    }

    /// Modulation, mode of the heat pump (0 heating, 1 cooling) and valve in a mode; `None` leaves the last two.
    fn answer(&self, inputs: &Inputs, mode: f64, running: bool) -> (f64, Option<(f64, f64)>) {
        let [heating_start_k, heating_stop_k, cooling_start_k, cooling_stop_k] =
            [0, 1, 2, 3].map(|point| inputs.set_points[point]);
        let (band, t_k, setting) = if mode > 0.0 {
            let band = Band { start_k: heating_start_k, stop_k: heating_stop_k };
            (band, inputs.measured[1], (0.0, self.params.valve_heating))
        } else if mode < 0.0 {
            let band = Band { start_k: cooling_start_k, stop_k: cooling_stop_k };
            (band, inputs.measured[2], (1.0, self.params.valve_cooling))
        } else {
            return (0.0, None);
        };
        (band.modulation(t_k, running, self.params.modulating), Some(setting))
    }
}

impl Controller for Balancing {
    fn timing(&self) -> Timing {
        Timing { interval_s: self.params.interval_s, offset_s: self.params.offset_s }
    }

    fn set_points(&self) -> Vec<SetPoint> {
        let params = &self.params;
        let point = |name, value| SetPoint { name, unit: "k", value };
        vec![
            point("heating_start_k", params.heating_start_k),
            point("heating_stop_k", params.heating_stop_k),
            point("cooling_start_k", params.cooling_start_k),
            point("cooling_stop_k", params.cooling_stop_k),
        ]
    }

    fn initial_state(&self) -> Vec<f64> {
        vec![0.0, self.params.mode_time_s, 0.0]
    }

    fn output_limits(&self, _output: usize, actuator: (f64, f64)) -> (f64, f64) {
        actuator
    }

    fn update(
        &self,
        dt_s: f64,
        inputs: &Inputs,
        state: &mut [f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError> {
        let inputs = inputs.checked()?;
        state[1] += dt_s;
        let wanted = self.wanted_mode(inputs);
        if wanted != state[0] && state[1] >= self.params.mode_time_s {
            (state[0], state[1], state[2]) = (wanted, 0.0, 0.0);
        }
        let (modulation, setting) = self.answer(inputs, state[0], state[2] > 0.5);
        state[2] = f64::from(modulation > 0.0);
        outputs[0] = modulation;
        if let Some(setting) = setting {
            (outputs[1], outputs[2]) = setting;
        }
        Ok(())
    }

    fn balance(&self, inputs: &Inputs, outputs: &[f64], balance: &mut [Balance]) {
        let (modulation, setting) = self.answer(inputs, self.wanted_mode(inputs), false);
        let (mode, valve) = setting.unwrap_or((outputs[1], outputs[2]));
        balance[0] = Balance { miss: modulation - outputs[0], scale: 1.0 };
        balance[1] = Balance { miss: mode - outputs[1], scale: 1.0 };
        balance[2] = Balance { miss: valve - outputs[2], scale: 1.0 };
    }

    fn rest(&self, inputs: &Inputs, outputs: &[f64], state: &mut [f64]) {
        state[0] = self.wanted_mode(inputs);
        state[1] = self.params.mode_time_s;
        state[2] = f64::from(outputs[0] > 0.0);
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
    fn the_flow_chooses_the_mode_and_the_layer_the_power() {
        let params: BalancingParams = serde_json::from_str("{}").unwrap();
        let balancing = params.build(&()).unwrap();
        let points: Vec<f64> = balancing.set_points().iter().map(|point| point.value).collect();
        let mut state = balancing.initial_state();
        let mut outputs = [0.0; 3];
        // Flow in l/min, layers 7 and 4 in degC; modulation, mode, valve; 100 s apart.
        for (flow, layers, expected) in [
            (0.4, [18.0, 17.0], [0.0, 0.0, 0.0]),
            // heating: 1 - (18 - 16.5)/3 = 0.5
            (5.0, [18.0, 17.0], [0.5, 0.0, 0.0]),
            // a mode lasts for 300 s
            (-5.0, [18.0, 17.0], [0.5, 0.0, 0.0]),
            (-5.0, [18.0, 17.0], [0.5, 0.0, 0.0]),
            // cooling: (17 - 15)/3
            (-5.0, [18.0, 17.0], [2.0 / 3.0, 1.0, 1.0]),
            (-5.0, [18.0, 15.0], [0.0, 1.0, 1.0]),
            (0.1, [18.0, 17.0], [2.0 / 3.0, 1.0, 1.0]),
            // idle: nothing is switched back
            (0.1, [18.0, 17.0], [0.0, 1.0, 1.0]),
        ] {
            let measured = [flow / 60.0, layers[0] + 273.15, layers[1] + 273.15];
            let inputs =
                Inputs { measured: &measured, set_points: &points, limits: &[(0.0, 1.0); 3] };
            balancing.update(100.0, &inputs, &mut state, &mut outputs).unwrap();
            for (output, expected) in outputs.iter().zip(expected) {
                assert!((output - expected).abs() < 1e-9, "{flow} {layers:?}: {outputs:?}");
            }
        }
        let wrong = BalancingParams { cooling_stop_k: 295.0, ..params };
        assert_eq!(wrong.build(&()).unwrap_err().field(), Some("cooling_stop_k"));
    }
}
