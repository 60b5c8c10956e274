//! An ideal head source: raises the pressure from a to b by a given head at any flow.
//!
//! **Equation** `p_b - p_a = head`; the flow follows. The solver merges its two nodes. A loop made
//! only of such edges is rejected.

use crate::two_port::{Actuator, Characteristic, EdgeState, ElementError, TwoPort};
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An ideal head source as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressureSourceParams {
    /// Pressure rise from a to b while nothing drives it, Pa.
    pub head_pa: f64,
}

impl Default for PressureSourceParams {
    fn default() -> Self {
        Self { head_pa: 10_000.0 }
    }
}

/// An ideal head source ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct PressureSource {
    head_pa: f64,
}

impl PressureSourceParams {
    /// The runtime source.
    ///
    /// # Errors
    /// When the head is not finite.
    pub fn build(&self, _medium: &Medium) -> Result<PressureSource, ElementError> {
        if self.head_pa.is_finite() {
            Ok(PressureSource { head_pa: self.head_pa })
        } else {
            Err(ElementError::OutOfRange {
                field: "head_pa",
                value: self.head_pa,
                requirement: "must be finite",
            })
        }
    }
}

impl TwoPort for PressureSource {
    fn characteristic(&self, _m: f64, state: &EdgeState) -> Characteristic {
        Characteristic::ImposedPressure { dp_pa: -state.position }
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        1.0
    }

    fn actuator(&self) -> Option<Actuator> {
        Some(Actuator {
            position: "head_pa",
            command: "head_pa",
            unit: "pa",
            initial_command: self.head_pa,
            initial_position: self.head_pa,
            rise_time_s: 0.0,
            min: f64::NEG_INFINITY,
            max: f64::INFINITY,
        })
    }
}
