//! A heat meter: the loss of its flow sensor; the heat is reckoned with the temperature at a second place.
//!
//! **Equation** `dp = dp_nominal (m/m_nominal)^2`, regularised below `delta_m` times the nominal flow. Heat
//! `Q = m cp (T_supply - T_return)`, where one of the two is that of the water passing and the other that of
//! the water leaving the node of the second sensor, both means of the step: what a meter with the flow sensor
//! in the supply (`return_node`) or in the return (`supply_node`) counts, its sign with that of the flow.
//!
//! **Assumptions** no error of the meter, no delay between its sensors. **Sources** `wetter2014`; default
//! loss: the limit of EN 1434 at the permanent flow.

use super::resistance::{Resistance, ResistanceParams};
use crate::two_port::{Characteristic, EdgeState, ElementError, TwoPort};
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A heat meter as written in a model file: with `return_node` or `supply_node`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeatMeterParams {
    /// Node of the return sensor, where the flow sensor is in the supply.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub return_node: Option<String>,
    /// Node of the supply sensor, where the flow sensor is in the return.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supply_node: Option<String>,
    /// Nominal (permanent) flow, kg/s.
    pub m_flow_nominal_kg_s: f64,
    /// Pressure loss at the nominal flow, Pa.
    #[serde(default = "default_dp_nominal")]
    pub dp_nominal_pa: f64,
    /// Regularised below this share of the nominal flow.
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
}

fn default_dp_nominal() -> f64 {
    25_000.0
}

fn default_delta_m() -> f64 {
    0.3
}

impl Default for HeatMeterParams {
    fn default() -> Self {
        Self {
            return_node: None,
            supply_node: None,
            m_flow_nominal_kg_s: 1.5 / 3.6,
            dp_nominal_pa: default_dp_nominal(),
            delta_m: default_delta_m(),
        }
    }
}

/// A heat meter ready to be solved: hydraulically a resistance.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMeter(Resistance);

impl HeatMeterParams {
    /// The runtime meter.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<HeatMeter, ElementError> {
        let resistance = ResistanceParams {
            dp_nominal_pa: Some(self.dp_nominal_pa),
            m_flow_nominal_kg_s: Some(self.m_flow_nominal_kg_s),
            delta_m: self.delta_m,
            ..ResistanceParams::default()
        };
        Ok(HeatMeter(resistance.build(medium)?))
    }
}

impl TwoPort for HeatMeter {
    fn characteristic(&self, m: f64, state: &EdgeState) -> Characteristic {
        self.0.characteristic(m, state)
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.0.m_flow_nominal_kg_s()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_at_the_permanent_flow() {
        // qp 1.5 m3/h: 0.25 bar, a quarter of it at half the flow.
        let meter = HeatMeterParams::default().build(&Medium::default()).unwrap();
        let state = EdgeState { position: 0.0, density_kg_m3: 1000.0, viscosity_pa_s: 1e-3 };
        for (share, dp_pa) in [(1.0, 25_000.0), (0.5, 6_250.0), (-1.0, -25_000.0)] {
            let found = meter.characteristic(share * 1.5 / 3.6, &state);
            let Characteristic::PressureLoss(law) = found else { panic!("a loss") };
            assert!((law.value - dp_pa).abs() < 1e-9, "{law:?}");
        }
    }
}
