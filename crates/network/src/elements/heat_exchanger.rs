//! One side of a plate heat exchanger: a fixed hydraulic coefficient and effectiveness-NTU heat.
//!
//! The other side is a thermal unit on this edge's port, or another `heat_exchanger` edge named as
//! `partner` (two circuits, thermally coupled only). Heat: [`crate::effectiveness`].
//!
//! **Equation** `dp = dp_nominal (m/m_nominal)^2`, regularised below `delta_m` times the nominal flow. Each
//! side is a mixed volume behind the steady exchange: `(V rho cp + C_wall/2) dT/dt = m cp (T_steady - T)`.
//!
//! **Assumptions** the wall has the temperatures of the water beside it: half of it that of each side.
//!
//! **Sources** `elizarov2021` (15.5 kPa at 21.504 l/min), `licklederer2021` (UA 5955 W/K).

use crate::two_port::{
    Characteristic, EdgeState, EdgeThermal, ElementError, Exchanger, TwoPort, not_negative,
    positive,
};
use anergy_core::medium::Medium;
use anergy_core::numerics::regularize::quadratic;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Arrangement of the two streams at nominal directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Arrangement {
    /// Counter-flow.
    #[default]
    CounterFlow,
    /// Parallel flow.
    ParallelFlow,
}

/// A heat-exchanger side as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeatExchangerParams {
    /// Pressure loss at the nominal flow, Pa.
    #[serde(default = "default_dp_nominal")]
    pub dp_nominal_pa: f64,
    /// Nominal flow of this side, kg/s.
    #[serde(default = "default_m_flow_nominal")]
    pub m_flow_nominal_kg_s: f64,
    /// Nominal flow of the other side, kg/s. Absent: as this side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub m_flow_nominal_secondary_kg_s: Option<f64>,
    /// UA at nominal flows, W/K.
    #[serde(default = "default_ua")]
    pub ua_w_k: f64,
    /// Exponent of the film coefficients over the flow; 0 keeps UA constant.
    #[serde(default = "default_flow_exponent")]
    pub flow_exponent: f64,
    /// Arrangement at nominal directions.
    #[serde(default)]
    pub arrangement: Arrangement,
    /// Where `|1 - Cmin/Cmax|` is below this, NTU/(1 + NTU) is used.
    #[serde(default = "default_band")]
    pub equal_capacity_band: f64,
    /// Mixed water volume of each side, m3.
    #[serde(default = "default_volume")]
    pub volume_m3: f64,
    /// Heat capacity of the metal between the two sides, J/K: each side carries half of it. Absent: none.
    #[serde(default)]
    pub wall_capacity_j_k: f64,
    /// Regularised below this share of the nominal flow.
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
    /// The edge that is the other side, in another circuit; then its UA counts and this one's not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub partner: Option<String>,
}

fn default_dp_nominal() -> f64 {
    15_500.0
}

fn default_m_flow_nominal() -> f64 {
    0.3584
}

fn default_ua() -> f64 {
    5955.1
}

fn default_flow_exponent() -> f64 {
    0.7
}

fn default_band() -> f64 {
    1e-6
}

fn default_volume() -> f64 {
    0.003
}

fn default_delta_m() -> f64 {
    0.3
}

impl Default for HeatExchangerParams {
    fn default() -> Self {
        Self {
            dp_nominal_pa: default_dp_nominal(),
            m_flow_nominal_kg_s: default_m_flow_nominal(),
            m_flow_nominal_secondary_kg_s: None,
            ua_w_k: default_ua(),
            flow_exponent: default_flow_exponent(),
            arrangement: Arrangement::default(),
            equal_capacity_band: default_band(),
            volume_m3: default_volume(),
            wall_capacity_j_k: 0.0,
            delta_m: default_delta_m(),
            partner: None,
        }
    }
}

/// A heat-exchanger side ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatExchanger {
    coefficient: f64,
    m_turbulent_kg_s: f64,
    exchanger: Exchanger,
}

impl HeatExchangerParams {
    /// The runtime heat-exchanger side.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<HeatExchanger, ElementError> {
        let m_nominal = positive("m_flow_nominal_kg_s", self.m_flow_nominal_kg_s)?;
        let wall_j_k = not_negative("wall_capacity_j_k", self.wall_capacity_j_k)?;
        let wall_kg = 0.5 * wall_j_k / medium.heat_capacity_j_kg_k;
        let m_secondary = self.m_flow_nominal_secondary_kg_s.unwrap_or(m_nominal);
        Ok(HeatExchanger {
            coefficient: positive("dp_nominal_pa", self.dp_nominal_pa)? / (m_nominal * m_nominal),
            m_turbulent_kg_s: positive("delta_m", self.delta_m)? * m_nominal,
            exchanger: Exchanger {
                ua_nominal_w_k: positive("ua_w_k", self.ua_w_k)?,
                flow_exponent: not_negative("flow_exponent", self.flow_exponent)?,
                m_flow_nominal_kg_s: m_nominal,
                m_flow_nominal_secondary_kg_s: positive(
                    "m_flow_nominal_secondary_kg_s",
                    m_secondary,
                )?,
                counter_flow: self.arrangement == Arrangement::CounterFlow,
                equal_capacity_band: not_negative("equal_capacity_band", self.equal_capacity_band)?,
                volume_kg: not_negative("volume_m3", self.volume_m3)? * medium.density_kg_m3
                    + wall_kg,
                wall_kg,
            },
        })
    }
}

impl TwoPort for HeatExchanger {
    fn characteristic(&self, m: f64, _state: &EdgeState) -> Characteristic {
        Characteristic::PressureLoss(quadratic(m, self.coefficient, self.m_turbulent_kg_s))
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.exchanger.m_flow_nominal_kg_s
    }

    fn thermal(&self) -> EdgeThermal {
        EdgeThermal::Exchanger(self.exchanger)
    }
}
