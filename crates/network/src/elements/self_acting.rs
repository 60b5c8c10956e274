//! A self-acting valve: a spring and a membrane hold a pressure or a pressure difference elsewhere.
//!
//! **Equation** the valve closes as the pressure p it senses rises, over a proportional band:
//! `y_end = clamp((p_set + X_p - p)/X_p, 0, 1)`, and follows with a lag, `T dy/dt = y_end - y`; the flow is
//! that of a linear valve, `m = k_vs phi(y) sqrt(dp)`, `phi = l + (1 - l) y`. So p lies between `p_set` (open)
//! and `p_set + X_p` (shut) wherever the valve can hold it. A valve that opens instead has
//! `y_end = clamp((p - p_set)/X_p, 0, 1)`. Over a step, exact for a constant `y_end`:
//! `y = y_0 + (1 - exp(-dt/T)) (y_end - y_0)`, with `y_end` of the pressures at the *end* of the step, found
//! by Newton together with the hydraulics (`hydraulics/regulated.rs`); in the steady state `y = y_end`.
//!
//! **Assumptions** no friction of the stem, an impulse line without delay. **Validity** valves that hunt in
//! reality are calm here: the step is implicit. **Numerics** as a linear valve; a leakage is necessary, so
//! that what lies behind a shut valve keeps its pressure.
//!
//! **Sources** specification 5.8 (proportional band 0.1 of the set value, lag 5 s).

use super::valve::{Valve, ValveCharacteristic, ValveParams};
use crate::graph::Regulation;
use crate::two_port::{Characteristic, EdgeState, ElementError, TwoPort, not_negative, positive};
use anergy_core::medium::Medium;

/// Proportional band relative to the set value, where none is given.
const BAND: f64 = 0.1;

/// A self-acting valve ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfActing {
    valve: Valve,
    regulation: Regulation,
}

/// What the self-acting valves have in common; fields by the names in their entries.
pub(super) struct Fields {
    pub kvs_m3_h: f64,
    pub leakage: f64,
    pub delta_m: f64,
    pub set_field: &'static str,
    pub set_pa: f64,
    pub band_field: &'static str,
    pub band_pa: Option<f64>,
    pub opens: bool,
    pub lag_s: f64,
}

impl Fields {
    pub(super) fn build(self, medium: &Medium) -> Result<SelfActing, ElementError> {
        if !(1e-6..0.5).contains(&self.leakage) {
            let requirement = "must lie between 1e-6 and 0.5";
            return Err(ElementError::OutOfRange {
                field: "leakage",
                value: self.leakage,
                requirement,
            });
        }
        let set_pa = positive(self.set_field, self.set_pa)?;
        let valve = ValveParams {
            kvs_m3_h: self.kvs_m3_h,
            characteristic: ValveCharacteristic::Linear,
            leakage: self.leakage,
            delta_m: self.delta_m,
            ..ValveParams::default()
        };
        Ok(SelfActing {
            valve: valve.build(medium)?,
            regulation: Regulation {
                name: self.set_field,
                set_pa,
                band_pa: positive(self.band_field, self.band_pa.unwrap_or(BAND * set_pa))?,
                opens: self.opens,
                lag_s: not_negative("lag_s", self.lag_s)?,
            },
        })
    }
}

impl TwoPort for SelfActing {
    fn characteristic(&self, m: f64, state: &EdgeState) -> Characteristic {
        self.valve.characteristic(m, state)
    }

    fn loss_by_position(&self, m: f64, state: &EdgeState) -> f64 {
        self.valve.loss_by_position(m, state)
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.valve.m_flow_nominal_kg_s()
    }

    fn regulation(&self) -> Option<Regulation> {
        Some(self.regulation)
    }
}

pub(super) fn default_leakage() -> f64 {
    1e-3
}

pub(super) fn default_delta_m() -> f64 {
    0.02
}

pub(super) fn default_lag() -> f64 {
    5.0
}
