//! A heat pump between the grid and a house, alone or beside a plate exchanger: the transfer station of ambient grids.
//!
//! **Equation** heat and electricity of a [performance map](crate::performance_map) times what time does to the
//! [compressor](crate::compressor); the grid gives `Q_grid = Q - eta_int P` in heating and takes `Q + eta_int P` in
//! cooling. On either side the flow keeps a temperature difference, `m = Q/(cp dT)` within its limits, or is constant.
//! With an exchanger: where the grid is warmer than the return of the house by more than the approach (colder, in
//! cooling), the [exchanger](crate::direct_exchange) serves the house and the compressor rests; a rod stands behind
//! both.
//!
//! **Internal control** the grid water is not cooled below its coldest temperature: a drop that is held shrinks, then
//! the speed falls, and water that is hardly warmer stops the unit; limits of the return and of the supply as every
//! heat pump. The exchanger takes over when the compressor and its pumps have stopped.
//!
//! **Signs** in heating the water goes from the hot to the cold line (negative flow). In cooling it goes from the cold
//! to the hot line if `reversed_for_cold`, else from hot to cold as well, which a grid with pressure needs.
//!
//! **Assumptions** no content; heat and electricity of a start on the same ramp. **Numerics** map and limits take the
//! temperatures of the step before. The grid is asked first: what it really gave or took scales heat and electricity,
//! so energy is exact when the unit is blocked; where it got less flow than it wanted, the map takes that flow in the
//! next step.
//!
//! **Sources** `zinsmeister2023` (station, rated powers), `angelidis2023` (flow modes); map and times assumed.

pub mod params;
mod plan;

use crate::compressor::{Compressor, CompressorState};
use crate::direct_exchange;
use crate::heat_pump::{AuxHeater, Limits};
use crate::performance_map::{PerformanceMap, Stream};
use crate::thermal_unit::{Exchange, ThermalUnit, UnitInput, UnitOutput, UnitPort, capacity_w_k};
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
pub use params::{BoosterHeatPumpParams, BoosterTransferStationParams};

/// Less than this share of a wanted flow is less flow.
const WHOLE_FLOW: f64 = 0.99;

/// A booster heat pump ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct BoosterHeatPump {
    compressor: Compressor,
    heating: PerformanceMap,
    cooling: Option<PerformanceMap>,
    grid: Stream,
    house: Stream,
    /// Capacity flow of the house through the exchanger, W/K.
    house_w_k: f64,
    coldest_k: f64,
    reversed_for_cold: bool,
    limits: Limits,
    exchanger_ua_w_k: f64,
    exchanger_approach_k: f64,
    aux: AuxHeater,
    idle_w: f64,
    heat_share: f64,
    initial: [f64; 5],
    medium: Medium,
}

/// State behind that of the compressor: length of the step, s; inlets of grid and house and condenser temperature, K;
/// capacity flow that the grid gave where it was less than wanted, W/K (0: all that was wanted); whether a limit
/// tripped; whether the exchanger serves the house; its time so far, s; heat, cold and electricity so far, J.
const STEP_S: usize = CompressorState::LEN;
const GRID_K: usize = STEP_S + 1;
const HOUSE_K: usize = STEP_S + 2;
const CONDENSER_K: usize = STEP_S + 3;
const SCARCE_W_K: usize = STEP_S + 4;
const TRIPPED: usize = STEP_S + 5;
const EXCHANGER: usize = STEP_S + 6;
const EXCHANGER_S: usize = STEP_S + 7;
const HEAT_J: usize = STEP_S + 8;
const COLD_J: usize = STEP_S + 9;
const ELECTRIC_J: usize = STEP_S + 10;
const STATE_LEN: usize = STEP_S + 11;

const MODULATION: usize = 0;
const MODE: usize = 1;
const AUX: usize = 2;
const ENABLE: usize = 3;
const T_OUTDOOR: usize = 4;

const GRID: usize = 0;
const HOUSE: usize = 1;

impl ThermalUnit for BoosterHeatPump {
    fn ports(&self) -> Vec<UnitPort> {
        vec![
            UnitPort { name: "grid".into(), sets_flow: true, leads: true },
            UnitPort { name: "house".into(), sets_flow: true, leads: false },
        ]
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let ratio = |i: usize, name| UnitInput {
            name,
            unit: "",
            initial: self.initial[i],
            min: 0.0,
            max: 1.0,
            follows: None,
        };
        vec![
            ratio(MODULATION, "modulation"),
            ratio(MODE, "mode"),
            ratio(AUX, "aux_modulation"),
            ratio(ENABLE, "enable"),
            UnitInput {
                unit: "k",
                max: f64::INFINITY,
                follows: Some("weather.t_outdoor_k"),
                ..ratio(T_OUTDOOR, "t_outdoor_k")
            },
        ]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![
            UnitOutput::new("q_flow_w", "W"),
            UnitOutput::new("electric_w", "W"),
            UnitOutput::new("aux_w", "W"),
            UnitOutput::new("cop", "1"),
            UnitOutput::new("speed", "1"),
            UnitOutput::new("phase", "1"),
            UnitOutput::new("exchanger", "1"),
            UnitOutput::new("tripped", "1"),
            UnitOutput::new("starts", "1"),
            UnitOutput::new("operating_s", "s"),
            UnitOutput::new("exchanger_s", "s"),
            UnitOutput::new("heat_j", "J"),
            UnitOutput::new("cold_j", "J"),
            UnitOutput::new("electric_j", "J"),
            UnitOutput::new("cop_so_far", "1"),
        ]
    }

    fn initial_state(&self, initial_k: f64) -> Vec<f64> {
        let mut state = vec![0.0; STATE_LEN];
        CompressorState::new().write(&mut state);
        state[GRID_K] = initial_k;
        state[HOUSE_K] = initial_k;
        state[CONDENSER_K] = initial_k;
        state
    }

    fn begin(&self, dt_s: f64, state: &mut [f64]) {
        state[STEP_S] = dt_s;
    }

    fn request(
        &self,
        signals: &Signals<'_>,
        got: &[PortFlow],
        state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        if let [grid, house] = got {
            state[GRID_K] = grid.t_in_k;
            state[HOUSE_K] = house.t_in_k;
        }
        let plan = self.plan(signals, state);
        let grid = if plan.exchanger {
            let ua_w_k = self.exchanger_ua_w_k;
            direct_exchange::outlet(ua_w_k, plan.grid_w_k, plan.house_w_k, state[HOUSE_K])
        } else if plan.grid_w < 0.0 {
            Outlet::Cooled { wanted_w: -plan.grid_w, coldest_k: self.coldest_k }
        } else {
            Outlet::HeatFlow(plan.grid_w)
        };
        let sign = if plan.cooling && self.reversed_for_cold { 1.0 } else { -1.0 };
        wanted[GRID] =
            PortRequest { m_flow_kg_s: sign * self.m_flow_kg_s(plan.grid_w_k), outlet: grid };
        let planned_w = if plan.exchanger { 0.0 } else { plan.grid_w };
        wanted[HOUSE] = PortRequest {
            m_flow_kg_s: self.m_flow_kg_s(plan.house_w_k),
            outlet: Outlet::HeatFlow(plan.house_w(planned_w)),
        };
    }

    fn respond(
        &self,
        _port: usize,
        signals: &Signals<'_>,
        got: &[PortFlow],
        state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        let plan = self.plan(signals, state);
        wanted[HOUSE].outlet = Outlet::HeatFlow(plan.house_w(self.heat_w(&got[GRID])));
    }

    fn advance(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        state[STEP_S] = dt_s;
        let plan = self.plan(signals, state);
        let (grid, house) = (&ports[GRID], &ports[HOUSE]);
        let (grid_w, house_w) = (self.heat_w(grid), self.heat_w(house));
        let share = if plan.exchanger { 0.0 } else { plan.share(grid_w) };
        let idle_w = self.idle_w * (1.0 - plan.means.on);
        let compressor_w = share * plan.means.electric_w;
        let electric_w = compressor_w + plan.aux_w + idle_w;
        plan.next.write(state);
        state[TRIPPED] = f64::from(u8::from(plan.tripped));
        state[EXCHANGER] = f64::from(u8::from(plan.exchanger));
        state[EXCHANGER_S] += dt_s * state[EXCHANGER];
        state[GRID_K] = grid.t_in_k;
        state[HOUSE_K] = house.t_in_k;
        let house_capacity_w_k = capacity_w_k(&self.medium, house.m_flow_kg_s);
        let condenser_w = (house_w - plan.aux_w).max(0.0);
        let warmed_k =
            if house_capacity_w_k > 0.0 { condenser_w / house_capacity_w_k } else { 0.0 };
        state[CONDENSER_K] = house.t_in_k + warmed_k;
        let grid_capacity_w_k = capacity_w_k(&self.medium, grid.m_flow_kg_s);
        let scarce = grid_capacity_w_k < WHOLE_FLOW * plan.grid_w_k;
        state[SCARCE_W_K] = if scarce && dt_s > 0.0 { grid_capacity_w_k } else { 0.0 };
        if plan.cooling {
            state[COLD_J] -= dt_s * house_w;
        } else {
            state[HEAT_J] += dt_s * house_w;
        }
        state[ELECTRIC_J] += dt_s * electric_w;
        let per = |heat: f64, electric: f64| if electric > 0.0 { heat / electric } else { 0.0 };
        let useful_w = if plan.cooling { -house_w } else { house_w };
        out.copy_from_slice(&[
            house_w,
            electric_w,
            plan.aux_w,
            per(useful_w, electric_w - idle_w),
            plan.means.modulation * plan.means.on,
            plan.next.phase.number(),
            state[EXCHANGER],
            state[TRIPPED],
            plan.next.starts,
            plan.next.operating_s,
            state[EXCHANGER_S],
            state[HEAT_J],
            state[COLD_J],
            state[ELECTRIC_J],
            per(state[HEAT_J] + state[COLD_J], state[ELECTRIC_J]),
        ]);
        Exchange { electric_w, external_w: grid_w + house_w - electric_w }
    }
}

impl BoosterHeatPump {
    /// Heat into the water of a port, W.
    fn heat_w(&self, port: &PortFlow) -> f64 {
        capacity_w_k(&self.medium, port.m_flow_kg_s) * (port.t_out_k - port.t_in_k)
    }
}

#[cfg(test)]
mod tests;
