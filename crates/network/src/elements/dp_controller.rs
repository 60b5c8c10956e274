//! A self-acting differential-pressure controller: a valve that limits the pressure difference between two
//! nodes, for example over a consumer and its control valve. The equations are in [`super::self_acting`].

use super::self_acting::{Fields, SelfActing, default_delta_m, default_lag, default_leakage};
use crate::two_port::ElementError;
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A differential-pressure controller as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DpControllerParams {
    /// Flow in m3/h at 1 bar when fully open.
    pub kvs_m3_h: f64,
    /// Node of the impulse line with the higher pressure.
    pub high_node: String,
    /// Node of the impulse line with the lower pressure.
    pub low_node: String,
    /// Pressure difference from which on it closes while nothing drives it, Pa.
    pub dp_set_pa: f64,
    /// Rise of the pressure difference over which it closes, Pa. Absent: a tenth of `dp_set_pa`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band_dp_pa: Option<f64>,
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

impl DpControllerParams {
    /// The runtime valve.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<SelfActing, ElementError> {
        let fields = Fields {
            kvs_m3_h: self.kvs_m3_h,
            leakage: self.leakage,
            delta_m: self.delta_m,
            set_field: "dp_set_pa",
            set_pa: self.dp_set_pa,
            band_field: "band_dp_pa",
            band_pa: self.band_dp_pa,
            opens: false,
            lag_s: self.lag_s,
        };
        fields.build(medium)
    }
}
