//! A house that sends water of a given temperature with a given flow: the ideal producer, or an ideal
//! consumer when the temperature is that of its return.
//!
//! **Equation** `T_out = T_supply`, `m = rho V`. **Assumptions** any heat is available at once.
//! **Sources** the published secondary side of `licklederer2021`.

use crate::thermal_unit::{Exchange, ThermalUnit, UnitError, UnitInput, UnitOutput, capacity_w_k};
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A prescribed source as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PrescribedSourceParams {
    /// Temperature of the water the house sends, K.
    pub supply_k: f64,
    /// Flow of that water, m3/s; behind an exchanger the flow of the house's circulation.
    pub v_flow_m3_s: f64,
}

impl Default for PrescribedSourceParams {
    fn default() -> Self {
        Self { supply_k: 338.15, v_flow_m3_s: 8.0 / 60_000.0 }
    }
}

/// A prescribed source ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct PrescribedSource {
    params: PrescribedSourceParams,
    medium: Medium,
}

impl PrescribedSourceParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<PrescribedSource, UnitError> {
        super::liquid(medium, "supply_k", self.supply_k)?;
        if !self.v_flow_m3_s.is_finite() {
            return Err(UnitError::OutOfRange {
                field: "v_flow_m3_s",
                value: self.v_flow_m3_s,
                requirement: "must be finite",
            });
        }
        Ok(PrescribedSource { params: self.clone(), medium: *medium })
    }
}

impl ThermalUnit for PrescribedSource {
    fn inputs(&self) -> Vec<UnitInput> {
        vec![
            UnitInput {
                name: "supply_k",
                unit: "k",
                initial: self.params.supply_k,
                min: 0.0,
                max: f64::INFINITY,
                follows: None,
            },
            UnitInput {
                name: "v_flow_m3_s",
                unit: "m3_s",
                initial: self.params.v_flow_m3_s,
                min: f64::NEG_INFINITY,
                max: f64::INFINITY,
                follows: None,
            },
        ]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![
            UnitOutput::new("q_flow_w", "W"),
            UnitOutput::new("m_flow_kg_s", "kg s-1"),
            UnitOutput::new("t_in_k", "K"),
            UnitOutput::new("t_out_k", "K"),
        ]
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        Vec::new()
    }

    fn request(
        &self,
        signals: &Signals<'_>,
        _got: &[PortFlow],
        _state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        wanted[0] = PortRequest {
            m_flow_kg_s: signals.get(1) * self.medium.density_kg_m3,
            outlet: Outlet::Temperature(signals.get(0)),
        };
    }

    fn advance(
        &self,
        _dt_s: f64,
        _signals: &Signals<'_>,
        ports: &[PortFlow],
        _state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        let PortFlow { m_flow_kg_s, t_in_k, t_out_k } = ports[0];
        out[0] = capacity_w_k(&self.medium, m_flow_kg_s) * (t_out_k - t_in_k);
        out[1] = m_flow_kg_s;
        out[2] = t_in_k;
        out[3] = t_out_k;
        Exchange { external_w: out[0], ..Exchange::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_of_the_published_producer() {
        // 5 l/min from 51.2745 to 65 degC with cp 4200: 5/60 * 4200 * 13.7255 = 4803.9 W
        let medium = Medium { heat_capacity_j_kg_k: 4200.0, ..Medium::default() };
        let unit = PrescribedSourceParams { supply_k: 338.15, v_flow_m3_s: 5.0 / 60_000.0 };
        let unit = unit.build(&medium).unwrap();
        let inputs: Vec<f64> = unit.inputs().iter().map(|input| input.initial).collect();
        let mut wanted = [PortRequest::default()];
        unit.request(&Signals(&inputs), &[], &mut [], &mut wanted);
        assert!((wanted[0].m_flow_kg_s - 5.0 / 60.0).abs() < 1e-15);
        let flow = PortFlow { m_flow_kg_s: 5.0 / 60.0, t_in_k: 324.4245, t_out_k: 338.15 };
        let mut out = [0.0; 4];
        unit.advance(1.0, &Signals(&inputs), &[flow], &mut [], &mut out);
        assert!((out[0] - 4803.9).abs() < 0.1);
    }
}
