//! The water in the network: properties used by every component.
//!
//! **Assumptions**: incompressible; one medium in the whole model. **Sources**: constant values of
//! the model file; defaults are liquid water at 20 degC.

use serde::{Deserialize, Serialize};

/// Water with constant properties: exact energy conservation, hydraulics independent of temperature.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Medium {
    /// Density, kg/m3.
    pub density_kg_m3: f64,
    /// Specific heat capacity, J/(kg K).
    pub heat_capacity_j_kg_k: f64,
    /// Dynamic viscosity, Pa s.
    pub viscosity_pa_s: f64,
    /// Thermal conductivity, W/(m K).
    pub conductivity_w_m_k: f64,
}

impl Default for Medium {
    fn default() -> Self {
        Self {
            density_kg_m3: 1000.0,
            heat_capacity_j_kg_k: 4180.0,
            viscosity_pa_s: 1.0016e-3,
            conductivity_w_m_k: 0.60,
        }
    }
}

/// 0 degC in kelvin; specific enthalpy is counted from here.
pub const ZERO_CELSIUS_K: f64 = 273.15;

impl Medium {
    /// Specific enthalpy above liquid water of 0 degC, J/kg.
    #[inline]
    pub fn enthalpy_j_kg(&self, t_k: f64) -> f64 {
        self.heat_capacity_j_kg_k * (t_k - ZERO_CELSIUS_K)
    }
}
