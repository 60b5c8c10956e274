//! An edge with a given mass flow: ideal pump with flow control, prescribed consumer or feeder.
//!
//! **Equation** `m = m_set`; the pressure difference follows. **Assumptions** whatever head is needed
//! is there: check the pressures it leads to.

use crate::two_port::{Actuator, Characteristic, EdgeState, ElementError, TwoPort};
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A prescribed flow as written in a model file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlowSourceParams {
    /// Mass flow from a to b while nothing drives it, kg/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub m_flow_kg_s: Option<f64>,
    /// The same as a volume flow at the density of the medium, m3/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub v_flow_m3_s: Option<f64>,
}

/// A prescribed flow ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowSource {
    m_flow_kg_s: f64,
}

impl FlowSourceParams {
    /// The runtime source.
    ///
    /// # Errors
    /// When both flows are given or one is not finite.
    pub fn build(&self, medium: &Medium) -> Result<FlowSource, ElementError> {
        if self.m_flow_kg_s.is_some() && self.v_flow_m3_s.is_some() {
            return Err(ElementError::Fields {
                problem: "give either m_flow_kg_s or v_flow_m3_s, not both".into(),
            });
        }
        let m_flow_kg_s =
            self.m_flow_kg_s.or(self.v_flow_m3_s.map(|v| v * medium.density_kg_m3)).unwrap_or(0.0);
        if !m_flow_kg_s.is_finite() {
            return Err(ElementError::OutOfRange {
                field: "m_flow_kg_s",
                value: m_flow_kg_s,
                requirement: "must be finite",
            });
        }
        Ok(FlowSource { m_flow_kg_s })
    }
}

impl TwoPort for FlowSource {
    fn characteristic(&self, _m: f64, state: &EdgeState) -> Characteristic {
        Characteristic::ImposedFlow { m_flow_kg_s: state.position }
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.m_flow_kg_s.abs().max(0.01)
    }

    fn actuator(&self) -> Option<Actuator> {
        Some(Actuator {
            position: "m_flow_set_kg_s",
            command: "m_flow_set_kg_s",
            unit: "kg_s",
            initial_command: self.m_flow_kg_s,
            initial_position: self.m_flow_kg_s,
            rise_time_s: 0.0,
            min: f64::NEG_INFINITY,
            max: f64::INFINITY,
        })
    }
}
