//! The liquid in the network: properties used by every component.
//!
//! **Equation** a model has one set of constants: those of its file, or those of a [`Liquid`] at the
//! reference temperature. Specific enthalpy is `h = cp (T - 0 degC)`.
//!
//! **Assumptions** incompressible; one medium in the whole model. The heat capacity is constant, so that
//! temperatures mix linearly and energy is conserved exactly; what only pressures or volumes depend on
//! (viscosity and density in the laws of pipes, buoyancy, expansion) can follow the temperature.
//!
//! **Validity** of the constant heat capacity of water taken at 50 degC: the heat between any two
//! temperatures within 10..=90 degC at least 10 K apart is met within 0.5 %, within 0.5..=99 degC within
//! 0.9 % (worst at the ends of the range); checked by `heat_between_two_temperatures`. Water is liquid from
//! 0.5 to 99 degC, a glycol mixture from 0.5 K above freezing to 99 degC.
//!
//! **Sources** `kell1975`, `iapws2011`, `melinder2010`; see [`water`] and [`glycol`].

pub mod glycol;
pub mod water;

use glycol::Glycol;
use serde::{Deserialize, Serialize};

/// 0 degC in kelvin; specific enthalpy is counted from here.
pub const ZERO_CELSIUS_K: f64 = 273.15;
/// Temperature at which constants are taken where a file does not say it, K: 50 degC, between supply and
/// return of a heating grid.
pub const REFERENCE_K: f64 = 323.15;
/// Water freezes below, boils above, with a margin, K.
const WATER_K: (f64, f64) = (273.65, 372.15);

/// What a medium is made of.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum Liquid {
    /// Water with constants of the model file.
    #[default]
    ConstantWater,
    /// Water.
    Water {
        /// Where its constants are taken, K.
        reference_k: f64,
    },
    /// Water with an antifreeze.
    Glycol {
        /// The antifreeze.
        glycol: Glycol,
        /// Its share of the mass.
        share: f64,
        /// Where its constants are taken, K.
        reference_k: f64,
    },
    /// Anything else, with constants of the model file.
    Brine {
        /// Lowest temperature at which it is liquid, K.
        min_k: f64,
        /// Highest, K.
        max_k: f64,
    },
}

/// A liquid with constant properties: exact energy conservation.
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
    /// What it is made of: properties over temperature, and where it is liquid.
    pub liquid: Liquid,
}

/// Liquid water of 20 degC with rounded numbers.
impl Default for Medium {
    fn default() -> Self {
        Self {
            density_kg_m3: 1000.0,
            heat_capacity_j_kg_k: 4180.0,
            viscosity_pa_s: 1.0016e-3,
            conductivity_w_m_k: 0.60,
            liquid: Liquid::ConstantWater,
        }
    }
}

impl Medium {
    /// Water with its properties at a temperature.
    pub fn water(reference_k: f64) -> Self {
        Self {
            density_kg_m3: water::density_kg_m3(reference_k),
            heat_capacity_j_kg_k: water::heat_capacity_j_kg_k(reference_k),
            viscosity_pa_s: water::viscosity_pa_s(reference_k),
            conductivity_w_m_k: water::conductivity_w_m_k(reference_k),
            liquid: Liquid::Water { reference_k },
        }
    }

    /// A mixture of water and an antifreeze, `share` of the mass, with its properties at a temperature.
    pub fn glycol(glycol: Glycol, share: f64, reference_k: f64) -> Self {
        Self {
            density_kg_m3: glycol.density_kg_m3(share, reference_k),
            heat_capacity_j_kg_k: glycol.heat_capacity_j_kg_k(share, reference_k),
            viscosity_pa_s: glycol.viscosity_pa_s(share, reference_k),
            conductivity_w_m_k: glycol.conductivity_w_m_k(share, reference_k),
            liquid: Liquid::Glycol { glycol, share, reference_k },
        }
    }

    /// Specific enthalpy above liquid of 0 degC, J/kg.
    #[inline]
    pub fn enthalpy_j_kg(&self, t_k: f64) -> f64 {
        self.heat_capacity_j_kg_k * (t_k - ZERO_CELSIUS_K)
    }

    /// Density at a temperature, kg/m3: also with constants that of water, for buoyancy and expansion;
    /// constant for a brine.
    #[inline]
    pub fn density_at_kg_m3(&self, t_k: f64) -> f64 {
        match self.liquid {
            Liquid::ConstantWater | Liquid::Water { .. } => water::density_kg_m3(t_k),
            Liquid::Glycol { glycol, share, .. } => glycol.density_kg_m3(share, t_k),
            Liquid::Brine { .. } => self.density_kg_m3,
        }
    }

    /// Dynamic viscosity at a temperature, Pa s, where the liquid states it; the constant otherwise.
    #[inline]
    pub fn viscosity_at_pa_s(&self, t_k: f64) -> f64 {
        match self.liquid {
            Liquid::ConstantWater | Liquid::Brine { .. } => self.viscosity_pa_s,
            Liquid::Water { .. } => water::viscosity_pa_s(t_k),
            Liquid::Glycol { glycol, share, .. } => glycol.viscosity_pa_s(share, t_k),
        }
    }

    /// Lowest and highest temperature at which a model holds, K.
    pub fn range_k(&self) -> (f64, f64) {
        match self.liquid {
            Liquid::ConstantWater | Liquid::Water { .. } => WATER_K,
            // Half a kelvin above freezing, as for water, to hundredths of a kelvin.
            Liquid::Glycol { glycol, share, .. } => {
                let min_k = glycol.freezing_k(share) + 0.5;
                ((min_k * 100.0).ceil() / 100.0, WATER_K.1)
            }
            Liquid::Brine { min_k, max_k } => (min_k, max_k),
        }
    }

    /// [`Self::range_k`] in degC, to hundredths.
    pub fn range_degc(&self) -> (f64, f64) {
        let degc = |t_k: f64| ((t_k - ZERO_CELSIUS_K) * 100.0).round() / 100.0;
        let (min_k, max_k) = self.range_k();
        (degc(min_k), degc(max_k))
    }

    /// Whether a temperature lies in [`Self::range_k`].
    #[inline]
    pub fn is_liquid(&self, t_k: f64) -> bool {
        let (min_k, max_k) = self.range_k();
        (min_k..=max_k).contains(&t_k)
    }

    /// What it is called in messages.
    pub fn name(&self) -> &'static str {
        match self.liquid {
            Liquid::ConstantWater | Liquid::Water { .. } => "liquid water",
            Liquid::Glycol { .. } => "this glycol mixture",
            Liquid::Brine { .. } => "this brine",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_the_liquids() {
        assert_eq!(Medium::default().range_k(), (273.65, 372.15));
        assert!(
            Medium::water(REFERENCE_K).is_liquid(273.65) && !Medium::default().is_liquid(273.6)
        );
        // Ethylene glycol, 30 % of the mass, freezes at -14.6 degC.
        let glycol = Medium::glycol(Glycol::Ethylene, 0.3, REFERENCE_K);
        assert!((glycol.range_k().0 - (ZERO_CELSIUS_K - 14.08)).abs() < 0.02);
        assert!(glycol.is_liquid(260.0) && !glycol.is_liquid(258.0));
    }

    /// The documented bound of the constant heat capacity at the reference temperature.
    #[test]
    fn heat_between_two_temperatures() {
        let cp = Medium::water(REFERENCE_K).heat_capacity_j_kg_k;
        let worst = |low: i32, high: i32| {
            let pairs = (low..=high - 10).flat_map(|a| (a + 10..=high).map(move |b| (a, b)));
            pairs.fold(0.0_f64, |worst, (a, b)| {
                let h =
                    |t: i32| water::enthalpy_j_kg(ZERO_CELSIUS_K + f64::from(t).clamp(0.5, 99.0));
                let exact = h(b) - h(a);
                worst.max((cp * f64::from(b - a) / exact - 1.0).abs())
            })
        };
        let (usual, all) = (worst(10, 90), worst(1, 99));
        assert!(usual < 0.005, "{usual}");
        assert!((0.005..0.009).contains(&all), "{all}");
    }
}
