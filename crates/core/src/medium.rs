//! The water in the network: properties used by every component.
//!
//! **Assumptions**: incompressible; one medium in the whole model. **Sources**: constant values of
//! the model file; defaults are liquid water at 20 degC. Density over temperature, for what only that
//! moves (expansion, buoyancy): `kell1975`.

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

/// Density of liquid water at atmospheric pressure, kg/m3; 0 to 150 degC, the nearest end beyond.
///
/// `rho = (a0 + a1 t + ... + a5 t^5)/(1 + b t)` with t in degC (Kell 1975, key `kell1975`).
#[inline]
pub fn water_density_kg_m3(t_k: f64) -> f64 {
    let t = (t_k - ZERO_CELSIUS_K).clamp(0.0, 150.0);
    let numerator = 999.839_52
        + t * (16.945_176
            + t * (-7.987_040_1e-3
                + t * (-46.170_461e-6 + t * (105.563_02e-9 - t * 280.542_53e-12))));
    numerator / (1.0 + 16.879_850e-3 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn density_of_water() {
        // CRC Handbook: 0.99984, 0.99997, 0.99821, 0.98320, 0.95837 g/cm3.
        for (t_degc, rho) in
            [(0.0, 999.84), (4.0, 999.97), (20.0, 998.21), (60.0, 983.20), (99.974, 958.37)]
        {
            let found = water_density_kg_m3(ZERO_CELSIUS_K + t_degc);
            assert!((found - rho).abs() < 0.02, "{found} kg/m3 at {t_degc} degC");
        }
    }
}
