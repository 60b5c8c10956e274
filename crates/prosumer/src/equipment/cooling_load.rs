//! A cooling demand given as a series: takes the cold water it needs and returns warmer water.
//!
//! **Equation** `m = Q/(cp (T_return - T_in))` with a given return temperature, or `m = Q/(cp dT)` with a given
//! temperature difference; at least the by-pass flow, at most `v_flow_max_m3_s`. The water takes up `Q`, but is not
//! warmed above `warmest_return_k`, nor by more than `load_max_w`; what is missing is `unmet_w`.
//!
//! **Assumptions** no storage, no room: the load does not react. On a station it feeds in: it draws from the cold line
//! and returns into the hot one. **Numerics** flow and limit follow from the temperature that arrived in the step
//! before; the heat is exact. **Sources** counterpart of `heat_load`, direct cooling of `prohmo`.

use crate::thermal_unit::{Exchange, ThermalUnit, UnitError, UnitInput, UnitOutput, capacity_w_k};
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Below this difference of return and supply a load with given return temperature takes its largest
/// flow, K.
const SMALLEST_DIFFERENCE_K: f64 = 1.0;

/// A cooling load as written in a model file: with `return_k` or `temperature_difference_k`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CoolingLoadParams {
    /// Cooling demand while no series drives it, W.
    #[serde(default)]
    pub load_w: f64,
    /// The largest power that an emulated load can take, W; what is demanded beyond is `unmet_w`. Absent: no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_max_w: Option<f64>,
    /// Temperature of the returned water, K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub return_k: Option<f64>,
    /// Difference of returned and supplied water, K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature_difference_k: Option<f64>,
    /// By-pass: the smallest flow, m3/s.
    #[serde(default)]
    pub v_flow_min_m3_s: f64,
    /// The largest flow, m3/s.
    #[serde(default = "default_v_flow_max")]
    pub v_flow_max_m3_s: f64,
    /// The water is not warmed above this, K.
    #[serde(default = "default_warmest_return")]
    pub warmest_return_k: f64,
}

fn default_v_flow_max() -> f64 {
    1e-3
}

fn default_warmest_return() -> f64 {
    298.15
}

impl Default for CoolingLoadParams {
    fn default() -> Self {
        Self {
            load_w: 4000.0,
            load_max_w: None,
            return_k: None,
            temperature_difference_k: Some(5.0),
            v_flow_min_m3_s: 0.0,
            v_flow_max_m3_s: default_v_flow_max(),
            warmest_return_k: default_warmest_return(),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum ReturnWater {
    Temperature(f64),
    Difference(f64),
}

/// A cooling load ready to run. State: temperature that arrived last, K; cumulated heat, J.
#[derive(Debug, Clone, PartialEq)]
pub struct CoolingLoad {
    load_w: f64,
    load_max_w: f64,
    return_water: ReturnWater,
    m_flow_min_kg_s: f64,
    m_flow_max_kg_s: f64,
    warmest_return_k: f64,
    medium: Medium,
}

impl CoolingLoadParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range or missing.
    pub fn build(&self, medium: &Medium) -> Result<CoolingLoad, UnitError> {
        let out_of_range =
            |field, value, requirement| Err(UnitError::OutOfRange { field, value, requirement });
        let return_water = match (self.return_k, self.temperature_difference_k) {
            (Some(t_k), None) => ReturnWater::Temperature(super::liquid(medium, "return_k", t_k)?),
            (None, Some(difference)) if difference > 0.0 => ReturnWater::Difference(difference),
            (None, Some(difference)) => {
                return out_of_range("temperature_difference_k", difference, "must be positive");
            }
            _ => {
                return Err(UnitError::Fields {
                    problem: "give either return_k (return_degc) or temperature_difference_k"
                        .into(),
                });
            }
        };
        if !self.load_w.is_finite() || self.load_w < 0.0 {
            return out_of_range("load_w", self.load_w, "must not be negative");
        }
        let load_max_w = self.load_max_w.unwrap_or(f64::INFINITY);
        if load_max_w.is_nan() || load_max_w <= 0.0 {
            return out_of_range("load_max_w", load_max_w, "must be positive");
        }
        if self.v_flow_min_m3_s.is_nan() || self.v_flow_min_m3_s < 0.0 {
            return out_of_range("v_flow_min_m3_s", self.v_flow_min_m3_s, "must not be negative");
        }
        if self.v_flow_max_m3_s.is_nan() || self.v_flow_max_m3_s <= self.v_flow_min_m3_s {
            return out_of_range(
                "v_flow_max_m3_s",
                self.v_flow_max_m3_s,
                "must be larger than v_flow_min_m3_s",
            );
        }
        Ok(CoolingLoad {
            load_w: self.load_w,
            load_max_w,
            return_water,
            m_flow_min_kg_s: self.v_flow_min_m3_s * medium.density_kg_m3,
            m_flow_max_kg_s: self.v_flow_max_m3_s * medium.density_kg_m3,
            warmest_return_k: super::liquid(medium, "warmest_return_k", self.warmest_return_k)?,
            medium: *medium,
        })
    }
}

impl ThermalUnit for CoolingLoad {
    fn serves(&self) -> bool {
        true
    }

    fn inputs(&self) -> Vec<UnitInput> {
        vec![UnitInput {
            name: "load_w",
            unit: "w",
            initial: self.load_w,
            min: 0.0,
            max: f64::INFINITY,
            follows: None,
        }]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![
            UnitOutput::new("q_flow_w", "W"),
            UnitOutput::new("m_flow_kg_s", "kg s-1"),
            UnitOutput::new("t_in_k", "K"),
            UnitOutput::new("t_out_k", "K"),
            UnitOutput::new("unmet_w", "W"),
            UnitOutput::new("cold_j", "J"),
        ]
    }

    fn initial_state(&self, initial_k: f64) -> Vec<f64> {
        vec![initial_k, 0.0]
    }

    fn request(
        &self,
        signals: &Signals<'_>,
        _got: &[PortFlow],
        state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        let (load_w, t_in_k) = (signals.get(0).clamp(0.0, self.load_max_w), state[0]);
        let (difference_k, limit_k) = match self.return_water {
            ReturnWater::Difference(difference_k) => (difference_k, self.warmest_return_k),
            ReturnWater::Temperature(t_k) => {
                ((t_k - t_in_k).max(SMALLEST_DIFFERENCE_K), t_k.min(self.warmest_return_k))
            }
        };
        let m_flow_kg_s = (load_w / (self.medium.heat_capacity_j_kg_k * difference_k))
            .clamp(self.m_flow_min_kg_s, self.m_flow_max_kg_s);
        let room_w = capacity_w_k(&self.medium, m_flow_kg_s) * (limit_k - t_in_k).max(0.0);
        wanted[0] = PortRequest { m_flow_kg_s, outlet: Outlet::HeatFlow(load_w.min(room_w)) };
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
        let q_w = capacity_w_k(&self.medium, m_flow_kg_s) * (t_out_k - t_in_k);
        state[0] = t_in_k;
        state[1] += dt_s * q_w;
        out[0] = q_w;
        out[1] = m_flow_kg_s;
        out[2] = t_in_k;
        out[3] = t_out_k;
        out[4] = (signals.get(0) - q_w).max(0.0);
        out[5] = state[1];
        Exchange { external_w: q_w, ..Exchange::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(unit: &CoolingLoad, t_in_k: f64, load_w: f64) -> PortRequest {
        let mut wanted = [PortRequest::default()];
        unit.request(&Signals(&[load_w]), &[], &mut [t_in_k, 0.0], &mut wanted);
        wanted[0]
    }

    #[test]
    fn flow_from_load() {
        // 4 kW over 5 K: 4000/(4180 * 5) = 0.191388 kg/s. Water of 23 degC takes 0.191388 * 4180 * 2 = 1600 W before
        // it is at 25 degC, water of 26 degC nothing.
        let unit = CoolingLoadParams::default().build(&Medium::default()).unwrap();
        let wanted = request(&unit, 288.15, 4000.0);
        assert!((wanted.m_flow_kg_s - 0.191_388).abs() < 1e-6);
        assert_eq!(wanted.outlet, Outlet::HeatFlow(4000.0));
        let q_w = request(&unit, 296.15, 4000.0).outlet.heat_flow_w().unwrap();
        assert!((q_w - 1600.0).abs() < 1e-6, "{q_w}");
        assert_eq!(request(&unit, 299.15, 4000.0).outlet, Outlet::HeatFlow(0.0));
        assert_eq!(request(&unit, 288.15, 0.0).m_flow_kg_s, 0.0);
    }

    #[test]
    fn an_emulator_takes_no_more_than_it_can() {
        // 9 kW over 5 K: 0.430622 kg/s
        let params = CoolingLoadParams { load_max_w: Some(9000.0), ..CoolingLoadParams::default() };
        let unit = params.build(&Medium::default()).unwrap();
        let wanted = request(&unit, 288.15, 12_000.0);
        assert_eq!(wanted.outlet, Outlet::HeatFlow(9000.0));
        assert!((wanted.m_flow_kg_s - 0.430_622).abs() < 1e-6);
        let params = CoolingLoadParams { load_max_w: Some(f64::NAN), ..params };
        assert!(params.build(&Medium::default()).is_err());
    }

    #[test]
    fn return_temperature_and_what_is_missing() {
        let params = CoolingLoadParams {
            return_k: Some(293.15),
            temperature_difference_k: None,
            ..CoolingLoadParams::default()
        };
        let unit = params.build(&Medium::default()).unwrap();
        // 15 to 20 degC as above; supply of 21 degC: largest flow, no heat.
        assert!((request(&unit, 288.15, 4000.0).m_flow_kg_s - 0.191_388).abs() < 1e-6);
        let warm = request(&unit, 294.15, 1e6);
        assert_eq!((warm.m_flow_kg_s, warm.outlet), (1.0, Outlet::HeatFlow(0.0)));
        // 0.1 kg/s from 15 to 20 degC: 2090 W of 4000, for 10 s.
        let got = PortFlow { m_flow_kg_s: 0.1, t_in_k: 288.15, t_out_k: 293.15 };
        let (mut state, mut out) = ([300.0, 0.0], [0.0; 6]);
        let exchange = unit.advance(10.0, &Signals(&[4000.0]), &[got], &mut state, &mut out);
        assert!((out[0] - 2090.0).abs() < 1e-9 && (out[4] - 1910.0).abs() < 1e-9);
        assert!((exchange.external_w - out[0]).abs() < 1e-9 && (state[1] - 20_900.0).abs() < 1e-6);
        for wrong in [
            CoolingLoadParams { load_w: -1.0, ..params.clone() },
            CoolingLoadParams { warmest_return_k: 20.0, ..params.clone() },
            CoolingLoadParams { return_k: None, ..params },
        ] {
            assert!(wrong.build(&Medium::default()).is_err());
        }
    }
}
