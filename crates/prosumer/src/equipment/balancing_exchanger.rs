//! A plate exchanger between the lines of the grid and the storage of a balancing unit that is parted from them: it
//! takes the flow that comes, in either direction, and draws as much from the storage.
//!
//! **Equation** see [`crate::direct_exchange`]; the flow of the storage side is `flow_ratio |m|`, up to the largest flow
//! of its pump. **Assumptions** those of the exchange. **Numerics** the storage side has the flow of the grid of the
//! step before, and the grid meets the water that came from the storage in the step before; what the grid gave is what
//! the storage gets, so energy is exact. **Validity** flows that change little within a step.
//!
//! From which end of the storage it draws is a matter of the storage (`positions` of its port).
//!
//! **Sources** balancing unit behind an exchanger (system B), `angelidis2023`; UA assumed.

use crate::direct_exchange;
use crate::thermal_unit::{
    Exchange, ThermalUnit, UnitError, UnitInput, UnitOutput, UnitPort, capacity_w_k, positive,
};
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An exchanger of a balancing unit as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BalancingExchangerParams {
    /// Conductance, W/K.
    pub ua_w_k: f64,
    /// Flow of the storage side over that of the grid.
    pub flow_ratio: f64,
    /// Largest flow of the storage side, m3/s.
    pub storage_v_flow_max_m3_s: f64,
}

impl Default for BalancingExchangerParams {
    fn default() -> Self {
        Self { ua_w_k: 6000.0, flow_ratio: 1.0, storage_v_flow_max_m3_s: 60.0 / 60_000.0 }
    }
}

/// An exchanger of a balancing unit ready to run. State: heat into the storage so far, J.
#[derive(Debug, Clone, PartialEq)]
pub struct BalancingExchanger {
    ua_w_k: f64,
    flow_ratio: f64,
    storage_max_kg_s: f64,
    medium: Medium,
}

const HEAT_J: usize = 0;

const GRID: usize = 0;
const STORAGE: usize = 1;

impl BalancingExchangerParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<BalancingExchanger, UnitError> {
        Ok(BalancingExchanger {
            ua_w_k: positive("ua_w_k", self.ua_w_k)?,
            flow_ratio: positive("flow_ratio", self.flow_ratio)?,
            storage_max_kg_s: medium.density_kg_m3
                * positive("storage_v_flow_max_m3_s", self.storage_v_flow_max_m3_s)?,
            medium: *medium,
        })
    }
}

impl BalancingExchanger {
    fn heat_w(&self, port: &PortFlow) -> f64 {
        capacity_w_k(&self.medium, port.m_flow_kg_s) * (port.t_out_k - port.t_in_k)
    }
}

impl ThermalUnit for BalancingExchanger {
    fn ports(&self) -> Vec<UnitPort> {
        vec![
            UnitPort { name: "grid".into(), sets_flow: false, leads: true },
            UnitPort { name: "storage".into(), sets_flow: true, leads: false },
        ]
    }

    fn inputs(&self) -> Vec<UnitInput> {
        Vec::new()
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![UnitOutput::new("q_flow_w", "W"), UnitOutput::new("heat_j", "J")]
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        vec![0.0]
    }

    fn request(
        &self,
        _signals: &Signals<'_>,
        got: &[PortFlow],
        _state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        wanted.fill(PortRequest::default());
        let [grid, storage] = got else { return };
        let m_kg_s = (self.flow_ratio * grid.m_flow_kg_s.abs()).min(self.storage_max_kg_s);
        let w_k = direct_exchange::conductance_w_k(
            self.ua_w_k,
            capacity_w_k(&self.medium, grid.m_flow_kg_s),
            capacity_w_k(&self.medium, m_kg_s),
        );
        wanted[GRID].outlet = Outlet::Exchange { w_k, other_k: storage.t_in_k };
        wanted[STORAGE].m_flow_kg_s = m_kg_s;
    }

    fn respond(
        &self,
        _port: usize,
        _signals: &Signals<'_>,
        got: &[PortFlow],
        _state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        wanted[STORAGE].outlet = Outlet::HeatFlow(-self.heat_w(&got[GRID]));
    }

    fn advance(
        &self,
        dt_s: f64,
        _signals: &Signals<'_>,
        ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        let (grid_w, storage_w) = (self.heat_w(&ports[GRID]), self.heat_w(&ports[STORAGE]));
        state[HEAT_J] += dt_s * storage_w;
        out.copy_from_slice(&[storage_w, state[HEAT_J]]);
        Exchange { electric_w: 0.0, external_w: grid_w + storage_w }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn requests(params: &BalancingExchangerParams, grid_kg_s: f64) -> [PortRequest; 2] {
        let unit = params.build(&Medium::default()).unwrap();
        let mut state = unit.initial_state(290.0);
        let grid = PortFlow { m_flow_kg_s: grid_kg_s, t_in_k: 288.15, t_out_k: 288.15 };
        let storage = PortFlow { m_flow_kg_s: 0.5, t_in_k: 293.15, t_out_k: 293.15 };
        let mut wanted = [PortRequest::default(); 2];
        unit.request(&Signals(&[]), &[grid, storage], &mut state, &mut wanted);
        wanted
    }

    #[test]
    fn it_follows_the_grid_in_either_direction() {
        let params = BalancingExchangerParams::default();
        // 0.5 kg/s on both sides: C = 2090 W/K, NTU = 6000/2090 = 2.87081, eps = NTU/(1 + NTU) = 0.741656
        for grid_kg_s in [0.5, -0.5] {
            let [grid, storage] = requests(&params, grid_kg_s);
            assert!((storage.m_flow_kg_s - 0.5).abs() < 1e-12);
            let Outlet::Exchange { w_k, other_k } = grid.outlet else { panic!("{grid:?}") };
            assert!((w_k - 0.741_656 * 2090.0).abs() < 1e-2 && other_k == 293.15, "{w_k}");
        }
        // The pump of the storage side has an end: 1 kg/s.
        assert!((requests(&params, 3.0)[STORAGE].m_flow_kg_s - 1.0).abs() < 1e-12);
        // Nothing flows, nothing is exchanged.
        let [grid, storage] = requests(&params, 0.0);
        assert_eq!(grid.outlet, Outlet::Exchange { w_k: 0.0, other_k: 293.15 });
        assert_eq!(storage.m_flow_kg_s, 0.0);
        let wrong = BalancingExchangerParams { flow_ratio: 0.0, ..params };
        assert!(wrong.build(&Medium::default()).is_err());
    }
}
