//! A self-acting pressure-sustaining valve: it opens only as far as the pressure before it lasts. The equations
//! are in [`super::self_acting`].

use super::self_acting::{Fields, SelfActing, default_delta_m, default_lag, default_leakage};
use crate::two_port::ElementError;
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A pressure-sustaining valve as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressureSustainingValveParams {
    /// Flow in m3/h at 1 bar when fully open.
    pub kvs_m3_h: f64,
    /// Pressure above the atmosphere from which on it opens while nothing drives it, Pa.
    pub pressure_set_pa: f64,
    /// Node whose pressure it senses. Absent: that before it, `from`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensed_node: Option<String>,
    /// Rise of the pressure over which it opens, Pa. Absent: a tenth of `pressure_set_pa`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band_pressure_pa: Option<f64>,
    /// Time constant with which it follows, s.
    #[serde(default = "default_lag")]
    pub lag_s: f64,
    /// Flow coefficient of the shut valve over that of the open one.
    #[serde(default = "default_leakage")]
    pub leakage: f64,
    /// Regularised below this share of the flow at 0.1 bar.
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
}

impl PressureSustainingValveParams {
    /// The runtime valve.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<SelfActing, ElementError> {
        let fields = Fields {
            kvs_m3_h: self.kvs_m3_h,
            leakage: self.leakage,
            delta_m: self.delta_m,
            set_field: "pressure_set_pa",
            set_pa: self.pressure_set_pa,
            band_field: "band_pressure_pa",
            band_pa: self.band_pressure_pa,
            opens: true,
            lag_s: self.lag_s,
        };
        fields.build(medium)
    }
}
