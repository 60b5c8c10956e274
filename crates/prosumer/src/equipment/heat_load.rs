//! A heat demand given as a series: takes the flow it needs and returns cooler water.
//!
//! **Equation** `m = Q/(cp (T_in - T_return))` with a given return temperature, or `m = Q/(cp dT)` with
//! a given temperature difference; at least the by-pass flow, at most `v_flow_max_m3_s`. The water
//! gives off `Q`, but is not cooled below `coldest_return_k`; what is missing is `unmet_w`. The emulator of a
//! laboratory takes no more than `load_max_w`: 30 kW of heat at houses SF1 to SF4, 60 kW at MF5 (`zinsmeister2024`).
//! With `supply_needed_k` it counts the shortfall of its supply, `sum max(T_needed - T_in, 0) dt` while heat is demanded.
//!
//! **Assumptions** no storage, no room: the load does not react. **Numerics** the flow follows from the
//! temperature that arrived in the step before; the heat is exact with the flow of the present step, and the
//! coldest return holds with the temperature of the present step.
//!
//! **Sources** ideal substation of the DESTEST definition (`destest2019`).

use crate::thermal_unit::{Exchange, ThermalUnit, UnitError, UnitInput, UnitOutput, capacity_w_k};
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Below this difference of supply and return a load with given return temperature takes its largest
/// flow, K.
const SMALLEST_DIFFERENCE_K: f64 = 1.0;

/// A heat load as written in a model file: with `return_k` or `temperature_difference_k`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeatLoadParams {
    /// Heat demand while no series drives it, W.
    #[serde(default)]
    pub load_w: f64,
    /// The largest power that an emulated load can take, W; what is demanded beyond is `unmet_w`. Absent: no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load_max_w: Option<f64>,
    /// Temperature of the returned water, K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub return_k: Option<f64>,
    /// Difference of supplied and returned water, K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature_difference_k: Option<f64>,
    /// By-pass: the smallest flow, m3/s.
    #[serde(default)]
    pub v_flow_min_m3_s: f64,
    /// The largest flow, m3/s.
    #[serde(default = "default_v_flow_max")]
    pub v_flow_max_m3_s: f64,
    /// The water is not cooled below this, K.
    #[serde(default = "default_coldest_return")]
    pub coldest_return_k: f64,
    /// Supply that the consumer needs, K: colder water while heat is demanded is counted as `shortfall_k_s` (indicator
    /// `shortfall_k_h`). Absent: not counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supply_needed_k: Option<f64>,
}

fn default_v_flow_max() -> f64 {
    1e-3
}

fn default_coldest_return() -> f64 {
    278.15
}

impl Default for HeatLoadParams {
    fn default() -> Self {
        Self {
            load_w: 10_000.0,
            load_max_w: None,
            return_k: None,
            temperature_difference_k: Some(30.0),
            v_flow_min_m3_s: 0.0,
            v_flow_max_m3_s: default_v_flow_max(),
            coldest_return_k: default_coldest_return(),
            supply_needed_k: None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum ReturnWater {
    Temperature(f64),
    Difference(f64),
}

/// A heat load ready to run. State: temperature that arrived last, K; shortfall of the supply so far, K s, where it is counted.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatLoad {
    load_w: f64,
    load_max_w: f64,
    return_water: ReturnWater,
    m_flow_min_kg_s: f64,
    m_flow_max_kg_s: f64,
    coldest_return_k: f64,
    supply_needed_k: Option<f64>,
    medium: Medium,
}

impl HeatLoadParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range or missing.
    pub fn build(&self, medium: &Medium) -> Result<HeatLoad, UnitError> {
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
        Ok(HeatLoad {
            load_w: self.load_w,
            load_max_w,
            return_water,
            m_flow_min_kg_s: self.v_flow_min_m3_s * medium.density_kg_m3,
            m_flow_max_kg_s: self.v_flow_max_m3_s * medium.density_kg_m3,
            coldest_return_k: super::liquid(medium, "coldest_return_k", self.coldest_return_k)?,
            supply_needed_k: self
                .supply_needed_k
                .map(|t_k| super::liquid(medium, "supply_needed_k", t_k))
                .transpose()?,
            medium: *medium,
        })
    }
}

impl HeatLoad {
    /// Flow for a load when water of `t_in_k` arrives, kg/s.
    fn m_flow_kg_s(&self, load_w: f64, t_in_k: f64) -> f64 {
        let difference_k = match self.return_water {
            ReturnWater::Difference(difference_k) => difference_k,
            ReturnWater::Temperature(t_k) => (t_in_k - t_k).max(SMALLEST_DIFFERENCE_K),
        };
        (load_w / (self.medium.heat_capacity_j_kg_k * difference_k))
            .clamp(self.m_flow_min_kg_s, self.m_flow_max_kg_s)
    }
}

impl ThermalUnit for HeatLoad {
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
        let mut outputs = vec![
            UnitOutput::new("q_flow_w", "W"),
            UnitOutput::new("m_flow_kg_s", "kg s-1"),
            UnitOutput::new("t_in_k", "K"),
            UnitOutput::new("t_out_k", "K"),
            UnitOutput::new("unmet_w", "W"),
        ];
        outputs.extend(self.supply_needed_k.map(|_| UnitOutput::new("shortfall_k_s", "K s")));
        outputs
    }

    fn initial_state(&self, initial_k: f64) -> Vec<f64> {
        let mut state = vec![initial_k];
        state.extend(self.supply_needed_k.map(|_| 0.0));
        state
    }

    fn request(
        &self,
        signals: &Signals<'_>,
        _got: &[PortFlow],
        state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        let (load_w, t_in_k) = (signals.get(0).clamp(0.0, self.load_max_w), state[0]);
        let m = self.m_flow_kg_s(load_w, t_in_k);
        let limit_k = match self.return_water {
            ReturnWater::Temperature(t_k) => t_k.max(self.coldest_return_k),
            ReturnWater::Difference(_) => self.coldest_return_k,
        };
        let available_w = capacity_w_k(&self.medium, m) * (t_in_k - limit_k).max(0.0);
        // The temperature may have fallen since it was known.
        let outlet =
            Outlet::Cooled { wanted_w: load_w.min(available_w), coldest_k: self.coldest_return_k };
        wanted[0] = PortRequest { m_flow_kg_s: -m, outlet };
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
        state[0] = t_in_k;
        out[0] = capacity_w_k(&self.medium, m_flow_kg_s) * (t_out_k - t_in_k);
        out[1] = m_flow_kg_s;
        out[2] = t_in_k;
        out[3] = t_out_k;
        out[4] = (signals.get(0) + out[0]).max(0.0);
        if let Some(needed_k) = self.supply_needed_k {
            if signals.get(0) > 0.0 {
                state[1] += (needed_k - t_in_k).max(0.0) * dt_s;
            }
            out[5] = state[1];
        }
        Exchange { external_w: out[0], ..Exchange::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(unit: &HeatLoad, t_in_k: f64, load_w: f64) -> PortRequest {
        let mut wanted = [PortRequest::default()];
        unit.request(&Signals(&[load_w]), &[], &mut [t_in_k], &mut wanted);
        wanted[0]
    }

    #[test]
    fn flow_from_load() {
        // 10 kW over 30 K: 10000/(4180 * 30) = 0.079745 kg/s
        let unit = HeatLoadParams::default().build(&Medium::default()).unwrap();
        let wanted = request(&unit, 340.0, 10_000.0);
        assert!((wanted.m_flow_kg_s + 0.079_745).abs() < 1e-6);
        assert_eq!(wanted.outlet.heat_flow_w(), Some(-10_000.0));
        // Water of 283.15 K can give 0.079745 * 4180 * 5 = 1666.7 W before it is at 5 degC.
        let q_w = request(&unit, 283.15, 10_000.0).outlet.heat_flow_w().unwrap();
        assert!((q_w + 1666.7).abs() < 0.1, "{q_w}");
    }

    #[test]
    fn a_supply_that_is_too_cold_is_counted() {
        let params = HeatLoadParams { supply_needed_k: Some(333.15), ..HeatLoadParams::default() };
        let unit = params.build(&Medium::default()).unwrap();
        let (mut state, mut out) = (unit.initial_state(340.0), vec![0.0; unit.outputs().len()]);
        // An hour 2 K short, an hour 5 K short without demand, an hour 1 K above: 2 K h.
        for (t_in_k, load_w) in [(331.15, 1000.0), (328.15, 0.0), (334.15, 1000.0)] {
            let got = PortFlow { m_flow_kg_s: -0.1, t_in_k, t_out_k: t_in_k - 2.0 };
            unit.advance(3600.0, &Signals(&[load_w]), &[got], &mut state, &mut out);
        }
        assert!((out[5] / 3600.0 - 2.0).abs() < 1e-12, "{}", out[5]);
        let boiling = HeatLoadParams { supply_needed_k: Some(600.0), ..params };
        assert!(boiling.build(&Medium::default()).is_err());
    }

    #[test]
    fn an_emulator_takes_no_more_than_it_can() {
        let params = HeatLoadParams { load_max_w: Some(30_000.0), ..HeatLoadParams::default() };
        let unit = params.build(&Medium::default()).unwrap();
        assert_eq!(request(&unit, 340.0, 29_000.0).outlet.heat_flow_w(), Some(-29_000.0));
        let wanted = request(&unit, 340.0, 42_000.0);
        assert_eq!(wanted.outlet.heat_flow_w(), Some(-30_000.0));
        // 30 kW over 30 K: 0.239234 kg/s; 12 kW are told as missing.
        assert!((wanted.m_flow_kg_s + 0.239_234).abs() < 1e-6);
        let got = PortFlow { m_flow_kg_s: wanted.m_flow_kg_s, t_in_k: 340.0, t_out_k: 310.0 };
        let mut out = [0.0; 5];
        unit.advance(1.0, &Signals(&[42_000.0]), &[got], &mut [340.0], &mut out);
        assert!((out[4] - 12_000.0).abs() < 1e-6, "{}", out[4]);
        assert!(
            HeatLoadParams { load_max_w: Some(0.0), ..params }.build(&Medium::default()).is_err()
        );
    }

    #[test]
    fn by_pass_and_return_temperature() {
        let params = HeatLoadParams {
            return_k: Some(313.15),
            temperature_difference_k: None,
            v_flow_min_m3_s: 1e-5,
            ..HeatLoadParams::default()
        };
        let unit = params.build(&Medium::default()).unwrap();
        assert_eq!(request(&unit, 338.15, 0.0).m_flow_kg_s, -0.01);
        // 65/40 degC: 10000/(4180 * 25)
        assert!((request(&unit, 338.15, 10_000.0).m_flow_kg_s + 0.095_694).abs() < 1e-6);
        // Cold supply: largest flow, no heat.
        let cold = request(&unit, 300.0, 1e6);
        assert_eq!((cold.m_flow_kg_s, cold.outlet.heat_flow_w()), (-1.0, Some(-0.0)));
        assert!(HeatLoadParams { return_k: None, ..params }.build(&Medium::default()).is_err());
    }
}
