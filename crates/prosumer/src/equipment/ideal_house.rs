//! A house that gives or takes whatever is asked: its circulation follows a commanded flow in either
//! direction, and the water it sends has a given temperature.
//!
//! **Equation** `tau dT/dt = T_set - T` of the water that leaves the house; `V` follows its command through
//! two equal lags (99.6 % after the rise time, as the pumps of the network). A positive flow feeds in: the
//! house sends hot water. A negative flow extracts: it sends its cold return. **Assumptions** the water of
//! the house is mixed and its temperature is forced, whatever heat that takes; the pumps of the two
//! directions are equal, and the one that stops overlaps with the one that starts. **Validity** steps up to
//! the rise time of the pump. **Numerics** both lags are exact over a step in which the command is constant.
//!
//! **Sources** the ideal house behind a bidirectional station, `licklederer2024`.

use crate::thermal_unit::{Exchange, ThermalUnit, UnitError, UnitInput, UnitOutput, capacity_w_k};
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An ideal house as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IdealHouseParams {
    /// Temperature of the water the house sends, K: hot while it feeds in, its return while it extracts.
    pub sent_k: f64,
    /// Flow of its circulation while nothing drives it, m3/s: positive feeds in, negative extracts.
    #[serde(default)]
    pub v_flow_m3_s: f64,
    /// Time constant of the temperature of the water it sends, s.
    #[serde(default = "default_time_constant")]
    pub time_constant_s: f64,
    /// Time in which the circulation follows a step by 99.6 %, s.
    #[serde(default = "default_rise_time")]
    pub rise_time_s: f64,
}

fn default_time_constant() -> f64 {
    10.0
}

fn default_rise_time() -> f64 {
    8.0
}

impl Default for IdealHouseParams {
    fn default() -> Self {
        Self {
            sent_k: 328.15,
            v_flow_m3_s: 0.0,
            time_constant_s: default_time_constant(),
            rise_time_s: default_rise_time(),
        }
    }
}

/// An ideal house ready to run. State: temperature sent, K; flow behind the first lag and behind both, m3/s.
#[derive(Debug, Clone, PartialEq)]
pub struct IdealHouse {
    params: IdealHouseParams,
    medium: Medium,
}

impl IdealHouseParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<IdealHouse, UnitError> {
        super::liquid(medium, "sent_k", self.sent_k)?;
        let out_of_range =
            |field, value, requirement| Err(UnitError::OutOfRange { field, value, requirement });
        if !self.v_flow_m3_s.is_finite() {
            return out_of_range("v_flow_m3_s", self.v_flow_m3_s, "must be finite");
        }
        for (field, value) in
            [("time_constant_s", self.time_constant_s), ("rise_time_s", self.rise_time_s)]
        {
            if !value.is_finite() || value < 0.0 {
                return out_of_range(field, value, "must not be negative");
            }
        }
        Ok(IdealHouse { params: self.clone(), medium: *medium })
    }
}

/// What is left of a difference after `dt_s`; nothing without a lag or in a steady state (`dt_s` = 0).
fn decay(dt_s: f64, lag_s: f64) -> f64 {
    if lag_s > 0.0 && dt_s > 0.0 { (-dt_s / lag_s).exp() } else { 0.0 }
}

impl ThermalUnit for IdealHouse {
    fn inputs(&self) -> Vec<UnitInput> {
        vec![
            UnitInput {
                name: "sent_k",
                unit: "k",
                initial: self.params.sent_k,
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
            UnitOutput::new("t_hot_k", "K"),
            UnitOutput::new("t_cold_k", "K"),
        ]
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        vec![self.params.sent_k, self.params.v_flow_m3_s, self.params.v_flow_m3_s]
    }

    fn request(
        &self,
        _signals: &Signals<'_>,
        _got: &[PortFlow],
        state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        wanted[0] = PortRequest {
            m_flow_kg_s: state[2] * self.medium.density_kg_m3,
            outlet: Outlet::Temperature(state[0]),
        };
    }

    fn advance(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        let PortFlow { m_flow_kg_s, t_in_k, t_out_k } = ports[0];
        let feeds_in = state[2] > 0.0 || (state[2] == 0.0 && signals.get(1) >= 0.0);
        out[0] = capacity_w_k(&self.medium, m_flow_kg_s) * (t_out_k - t_in_k);
        out[1] = m_flow_kg_s;
        out[2] = t_in_k;
        out[3] = t_out_k;
        (out[4], out[5]) = if feeds_in { (t_out_k, t_in_k) } else { (t_in_k, t_out_k) };
        let kept = decay(dt_s, self.params.time_constant_s);
        state[0] = signals.get(0) + (state[0] - signals.get(0)) * kept;
        let lag_s = self.params.rise_time_s / LAGS_PER_RISE;
        let kept = decay(dt_s, lag_s);
        let (first, second) = (state[1] - signals.get(1), state[2] - signals.get(1));
        let passing = if kept > 0.0 { first * dt_s / lag_s * kept } else { 0.0 };
        state[1] = signals.get(1) + first * kept;
        state[2] = signals.get(1) + second * kept + passing;
        Exchange { external_w: out[0], ..Exchange::default() }
    }
}

/// Two equal lags in a rise time: a second-order filter whose power is halved at `5/(2 pi rise time)`.
const LAGS_PER_RISE: f64 = 7.768_87;

#[cfg(test)]
mod tests {
    use super::*;

    fn house() -> IdealHouse {
        let params = IdealHouseParams { v_flow_m3_s: 1e-4, ..IdealHouseParams::default() };
        params.build(&Medium { heat_capacity_j_kg_k: 4200.0, ..Medium::default() }).unwrap()
    }

    #[test]
    fn flow_and_temperature_follow_their_commands() {
        // From 1e-4 to -1e-4 m3/s within 8 s: 1 - (1 + 7.76887) exp(-7.76887) = 0.996293 of the way (the
        // response of two equal lags to a step); 55 to 30 degC in 10 s: 30 + 25/e = 39.197 degC.
        let house = house();
        for dt_s in [8.0, 1.0, 0.05] {
            let mut state = house.initial_state(300.0);
            let mut out = [0.0; 6];
            let flow = PortFlow { m_flow_kg_s: 0.1, t_in_k: 310.0, t_out_k: 328.15 };
            let mut t_s = 0.0;
            while t_s < 8.0 - 1e-9 {
                house.advance(dt_s, &Signals(&[303.15, -1e-4]), &[flow], &mut state, &mut out);
                t_s += dt_s;
            }
            assert!((state[2] - (1e-4 - 2e-4 * 0.996293)).abs() < 1e-9, "{dt_s}: {state:?}");
            let expected = 303.15 + 25.0 * (-0.8_f64).exp();
            assert!((state[0] - expected).abs() < 1e-9, "{dt_s}: {state:?}");
        }
    }

    #[test]
    fn hot_is_what_it_sends_while_it_feeds_in_and_what_it_gets_while_it_extracts() {
        let house = house();
        let mut out = [0.0; 6];
        let flow = PortFlow { m_flow_kg_s: 0.1, t_in_k: 310.0, t_out_k: 328.15 };
        let mut state = house.initial_state(300.0);
        house.advance(1.0, &Signals(&[328.15, 1e-4]), &[flow], &mut state, &mut out);
        // 0.1 kg/s 4200 J/(kg K) 18.15 K = 7623 W
        assert!((out[0] - 7623.0).abs() < 1e-6 && out[4] == 328.15 && out[5] == 310.0, "{out:?}");
        let mut state = [303.15, -1e-4, -1e-4];
        let flow = PortFlow { m_flow_kg_s: 0.1, t_in_k: 323.15, t_out_k: 303.15 };
        house.advance(1.0, &Signals(&[303.15, -1e-4]), &[flow], &mut state, &mut out);
        assert!(out[4] == 323.15 && out[5] == 303.15, "{out:?}");
        let mut wanted = [PortRequest::default()];
        house.request(&Signals(&[303.15, -1e-4]), &[], &mut state, &mut wanted);
        assert!((wanted[0].m_flow_kg_s + 0.1).abs() < 1e-3, "{wanted:?}");
    }
}
