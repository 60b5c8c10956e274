//! A ball valve: open or shut, with the time it takes to turn and a small leak.
//!
//! **Equation** `m = k_vs phi(y) sqrt(dp)`, `phi = l + (1 - l) y` with the opening y and the leakage
//! `l = k(0)/k(1)`. A command of at least 0.5 opens it, a smaller one shuts it; the opening follows with
//! the stroke time.
//!
//! **Assumptions** fully turbulent; linear while it turns. **Numerics** the square law is regularised
//! below `delta_m` times the nominal flow; a leakage is necessary, so that what lies behind a shut valve
//! keeps its pressure.
//!
//! **Sources** specification 5.6 (leakage 1e-4, 5 s); `wetter2014` (regularised law).

use super::valve::{Valve, ValveCharacteristic, ValveParams};
use crate::two_port::{Actuator, Characteristic, EdgeState, ElementError, TwoPort};
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A command from here on opens.
const OPENS: f64 = 0.5;

/// A ball valve as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BallValveParams {
    /// Flow in m3/h at 1 bar when open.
    pub kvs_m3_h: f64,
    /// Flow coefficient of the shut valve over that of the open one.
    #[serde(default = "default_leakage")]
    pub leakage: f64,
    /// Whether it is open while nothing drives it: 1 or 0.
    #[serde(default = "one")]
    pub open: f64,
    /// Opening at the start of a run. Absent: where the first command leads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_opening: Option<f64>,
    /// Time in which it turns by 99.6 %, s.
    #[serde(default = "default_stroke_time")]
    pub stroke_time_s: f64,
    /// Nominal flow for the regularisation, kg/s. Absent: flow at 0.1 bar when open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub m_flow_nominal_kg_s: Option<f64>,
    /// Regularised below this share of the nominal flow.
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
}

fn one() -> f64 {
    1.0
}

fn default_leakage() -> f64 {
    1e-4
}

fn default_stroke_time() -> f64 {
    5.0
}

fn default_delta_m() -> f64 {
    0.02
}

impl Default for BallValveParams {
    fn default() -> Self {
        Self {
            kvs_m3_h: 20.0,
            leakage: default_leakage(),
            open: one(),
            initial_opening: None,
            stroke_time_s: default_stroke_time(),
            m_flow_nominal_kg_s: None,
            delta_m: default_delta_m(),
        }
    }
}

/// A ball valve ready to be solved: a switching linear valve with its own words for the command.
#[derive(Debug, Clone, PartialEq)]
pub struct BallValve {
    valve: Valve,
}

impl BallValveParams {
    /// The runtime ball valve.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<BallValve, ElementError> {
        let out_of_range =
            |field, value, requirement| Err(ElementError::OutOfRange { field, value, requirement });
        if !(1e-6..1.0).contains(&self.leakage) {
            return out_of_range("leakage", self.leakage, "must lie between 1e-6 and 1");
        }
        if self.open != 0.0 && self.open != 1.0 {
            return out_of_range("open", self.open, "must be 0 or 1");
        }
        let valve = ValveParams {
            kvs_m3_h: self.kvs_m3_h,
            characteristic: ValveCharacteristic::Linear,
            leakage: self.leakage,
            switch_at: Some(OPENS),
            opening: Some(self.open),
            initial_opening: self.initial_opening,
            stroke_time_s: self.stroke_time_s,
            m_flow_nominal_kg_s: self.m_flow_nominal_kg_s,
            delta_m: self.delta_m,
            ..ValveParams::default()
        };
        Ok(BallValve { valve: valve.build(medium)? })
    }
}

impl TwoPort for BallValve {
    fn characteristic(&self, m: f64, state: &EdgeState) -> Characteristic {
        self.valve.characteristic(m, state)
    }

    fn loss_by_position(&self, m: f64, state: &EdgeState) -> f64 {
        self.valve.loss_by_position(m, state)
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.valve.m_flow_nominal_kg_s()
    }

    fn actuator(&self) -> Option<Actuator> {
        Some(Actuator { command: "open", ..self.valve.own_actuator() })
    }

    fn target_position(&self, command: f64) -> f64 {
        self.valve.target_position(command)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opens_and_shuts() {
        // Kvs 3.6 m3/h: 1 kg/s at 1 bar; half way 0.50005 kg/s; the leak is 1e-4 kg/s at 1 bar.
        let params = BallValveParams { kvs_m3_h: 3.6, ..BallValveParams::default() };
        let valve = params.build(&Medium::default()).unwrap();
        let loss = |valve: &BallValve, m: f64, position: f64| {
            let state = EdgeState { position, density_kg_m3: 1000.0, viscosity_pa_s: 1e-3 };
            match valve.characteristic(m, &state) {
                Characteristic::PressureLoss(loss) => loss.value,
                other => panic!("{other:?}"),
            }
        };
        assert!((loss(&valve, 1.0, 1.0) - 1e5).abs() < 1e-6);
        assert!((loss(&valve, -0.500_05, 0.5) + 1e5).abs() < 1e-6);
        let turbulent = BallValveParams { delta_m: 1e-8, ..params.clone() };
        let turbulent = turbulent.build(&Medium::default()).unwrap();
        assert!((loss(&turbulent, 1e-4, 0.0) - 1e5).abs() < 1e-6);
        assert_eq!([0.0, 0.4, 0.5, 1.0].map(|y| valve.target_position(y)), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(valve.actuator().unwrap().initial_position, 1.0);
        let half = BallValveParams { open: 0.5, ..BallValveParams::default() };
        assert_eq!(half.build(&Medium::default()).unwrap_err().field(), Some("open"));
    }
}
