//! `[fluid]`: what flows in the network.

use anergy_core::medium::{Liquid, Medium, REFERENCE_K, glycol::Glycol};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[fluid]`: the water.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FluidEntry {
    /// Property set.
    #[serde(default)]
    pub kind: FluidKind,
    /// Density, kg/m3 (constant_water, brine).
    #[serde(default = "density")]
    pub density_kg_m3: f64,
    /// Specific heat capacity, J/(kg K) (constant_water, brine).
    #[serde(default = "heat_capacity")]
    pub heat_capacity_j_kg_k: f64,
    /// Dynamic viscosity, Pa s (constant_water, brine).
    #[serde(default = "viscosity")]
    pub viscosity_pa_s: f64,
    /// Thermal conductivity, W/(m K) (constant_water, brine).
    #[serde(default = "conductivity")]
    pub conductivity_w_m_k: f64,
    /// Temperature at which density, heat capacity, viscosity and conductivity are taken, K (water,
    /// glycols); 50 degC suits heating grids, 15 degC ambient ones.
    #[serde(default = "reference")]
    pub reference_temperature_k: f64,
    /// Whether viscosity and density in the pressure losses of pipes follow the temperature of each
    /// (water, glycols).
    #[serde(default)]
    pub follow_temperature: bool,
    /// Share of the antifreeze in the mass, up to 0.6 (glycols).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// Lowest temperature at which it is liquid, K (brine).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_temperature_k: Option<f64>,
    /// Highest temperature, K (brine).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_temperature_k: Option<f64>,
}

/// Property sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FluidKind {
    /// Water with the constants given here.
    #[default]
    ConstantWater,
    /// Water with its properties at the reference temperature.
    Water,
    /// Water with ethylene glycol.
    EthyleneGlycol,
    /// Water with propylene glycol.
    PropyleneGlycol,
    /// Anything else, with the constants and limits given here.
    Brine,
}

fn density() -> f64 {
    Medium::default().density_kg_m3
}

fn heat_capacity() -> f64 {
    Medium::default().heat_capacity_j_kg_k
}

fn viscosity() -> f64 {
    Medium::default().viscosity_pa_s
}

fn conductivity() -> f64 {
    Medium::default().conductivity_w_m_k
}

fn reference() -> f64 {
    REFERENCE_K
}

impl FluidEntry {
    /// The entry that describes a medium.
    pub(crate) fn of(medium: &Medium, follow_temperature: bool) -> serde_json::Value {
        let own = match medium.liquid {
            Liquid::Water { reference_k } => {
                serde_json::json!({ "kind": FluidKind::Water, "reference_temperature_k": reference_k })
            }
            Liquid::Glycol { glycol, share, reference_k } => {
                let kind = match glycol {
                    Glycol::Ethylene => FluidKind::EthyleneGlycol,
                    Glycol::Propylene => FluidKind::PropyleneGlycol,
                };
                serde_json::json!({
                    "kind": kind, "share": share, "reference_temperature_k": reference_k
                })
            }
            Liquid::ConstantWater | Liquid::Brine { .. } => {
                let mut constants = serde_json::json!({
                    "kind": FluidKind::ConstantWater,
                    "density_kg_m3": medium.density_kg_m3,
                    "heat_capacity_j_kg_k": medium.heat_capacity_j_kg_k,
                    "viscosity_pa_s": medium.viscosity_pa_s,
                    "conductivity_w_m_k": medium.conductivity_w_m_k,
                });
                if let Liquid::Brine { min_k, max_k } = medium.liquid {
                    constants["kind"] = serde_json::json!(FluidKind::Brine);
                    constants["min_temperature_k"] = min_k.into();
                    constants["max_temperature_k"] = max_k.into();
                }
                return constants;
            }
        };
        let mut own = own;
        if follow_temperature {
            own["follow_temperature"] = true.into();
        }
        own
    }
}
