//! A plate exchanger between the grid and a house without a heat pump: direct cooling from the cold pipe, or heating
//! from a grid that is warm enough.
//!
//! **Equation** see [`crate::direct_exchange`]; it works where the grid is warmer (in cooling colder)
//! than the return of the house by more than the approach, and goes on until that is missed by 1 K. The flow of the
//! house, and a constant flow of the grid, are the modulation times their full flow; otherwise the flow of the grid
//! holds the change of its temperature.
//!
//! **Assumptions** and **Numerics** those of the exchange. **Validity** both flows steady over a step. **Signs** in
//! heating from the hot to the cold line; in cooling from the cold to the hot line if `reversed_for_cold`.
//!
//! With `house_flow = "given"` another unit of the circuit sets the flow, of which the modulation is the share that passes.
//!
//! **Sources** `angelidis2023` (priority of direct cooling); UA assumed.

use crate::direct_exchange;
use crate::heat_pump::FlowControl;
use crate::performance_map::Stream;
use crate::thermal_unit::{
    Exchange, ThermalUnit, UnitError, UnitInput, UnitOutput, UnitPort, capacity_w_k, not_negative,
    positive, share,
};
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The approach may be missed by this before the exchanger stops, K.
const HYSTERESIS_K: f64 = 1.0;

/// A direct exchanger as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DirectExchangerParams {
    /// Share of the full flows while nothing drives it; 0 is off.
    pub modulation: f64,
    /// 0 heating, 1 cooling, while nothing drives it.
    pub mode: f64,
    /// Conductance, W/K.
    pub ua_w_k: f64,
    /// It works where grid and return of the house differ by more than this in the right sense, K.
    pub approach_difference_k: f64,
    /// Full flow of the house, m3/s.
    pub house_v_flow_m3_s: f64,
    /// Whether the house side has its own pump, or takes the flow of its circuit.
    pub house_flow: HouseFlow,
    /// How the flow of the grid is set.
    pub grid_flow_control: FlowControl,
    /// Change of the grid water with `constant_temperature_difference`, K.
    pub grid_temperature_difference_k: f64,
    /// Smallest flow of the grid with `constant_temperature_difference`, m3/s.
    pub grid_v_flow_min_m3_s: f64,
    /// Largest flow of the grid with `constant_temperature_difference`, m3/s.
    pub grid_v_flow_max_m3_s: f64,
    /// Full flow of the grid with `constant_flow`, m3/s.
    pub grid_v_flow_m3_s: f64,
    /// Whether the grid water flows from the cold to the hot line while the house is cooled.
    pub reversed_for_cold: bool,
}

/// What sets the flow of the house through an exchanger.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HouseFlow {
    /// Its own pump: the modulation times the full flow.
    #[default]
    Own,
    /// Another unit of the circuit.
    Given,
}

impl Default for DirectExchangerParams {
    fn default() -> Self {
        Self {
            modulation: 0.0,
            mode: 1.0,
            ua_w_k: 3000.0,
            approach_difference_k: 2.0,
            house_v_flow_m3_s: 30.0 / 60_000.0,
            house_flow: HouseFlow::Own,
            grid_flow_control: FlowControl::ConstantTemperatureDifference,
            grid_temperature_difference_k: 5.0,
            grid_v_flow_min_m3_s: 2.0 / 60_000.0,
            grid_v_flow_max_m3_s: 25.0 / 60_000.0,
            grid_v_flow_m3_s: 12.0 / 60_000.0,
            reversed_for_cold: true,
        }
    }
}

/// A direct exchanger ready to run. State: inlets of grid and house, K; whether it works; heat into the house so far,
/// J.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectExchanger {
    modulation: f64,
    mode: f64,
    ua_w_k: f64,
    approach_k: f64,
    house_w_k: f64,
    house_flow: HouseFlow,
    grid: Stream,
    reversed_for_cold: bool,
    medium: Medium,
}

const GRID_K: usize = 0;
const HOUSE_K: usize = 1;
const WORKS: usize = 2;
const HEAT_J: usize = 3;

const GRID: usize = 0;
const HOUSE: usize = 1;

impl DirectExchangerParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<DirectExchanger, UnitError> {
        let capacity_w_k =
            |v_flow_m3_s: f64| v_flow_m3_s * medium.density_kg_m3 * medium.heat_capacity_j_kg_k;
        let (least, most) = (self.grid_v_flow_min_m3_s, self.grid_v_flow_max_m3_s);
        let difference_k =
            positive("grid_temperature_difference_k", self.grid_temperature_difference_k)?;
        positive("grid_v_flow_max_m3_s", most)?;
        if not_negative("grid_v_flow_min_m3_s", least)? > most {
            return Err(UnitError::OutOfRange {
                field: "grid_v_flow_min_m3_s",
                value: least,
                requirement: "must not be larger than grid_v_flow_max_m3_s",
            });
        }
        let v_flow = positive("grid_v_flow_m3_s", self.grid_v_flow_m3_s)?;
        Ok(DirectExchanger {
            modulation: share("modulation", self.modulation)?,
            mode: share("mode", self.mode)?,
            ua_w_k: positive("ua_w_k", self.ua_w_k)?,
            approach_k: not_negative("approach_difference_k", self.approach_difference_k)?,
            house_flow: self.house_flow,
            house_w_k: capacity_w_k(positive("house_v_flow_m3_s", self.house_v_flow_m3_s)?),
            grid: match self.grid_flow_control {
                FlowControl::ConstantTemperatureDifference => Stream::Difference {
                    difference_k,
                    least_w_k: capacity_w_k(least),
                    most_w_k: capacity_w_k(most),
                },
                FlowControl::ConstantFlow => Stream::Flow(capacity_w_k(v_flow)),
            },
            reversed_for_cold: self.reversed_for_cold,
            medium: *medium,
        })
    }
}

impl DirectExchanger {
    fn works(&self, signals: &Signals<'_>, state: &[f64]) -> bool {
        let ahead_k = state[GRID_K] - state[HOUSE_K];
        let ahead_k = if signals.get(1) >= 0.5 { -ahead_k } else { ahead_k };
        let kept_k = if state[WORKS] != 0.0 { HYSTERESIS_K } else { 0.0 };
        signals.get(0) > 0.0 && ahead_k > self.approach_k - kept_k
    }

    fn heat_w(&self, port: &PortFlow) -> f64 {
        capacity_w_k(&self.medium, port.m_flow_kg_s) * (port.t_out_k - port.t_in_k)
    }
}

impl ThermalUnit for DirectExchanger {
    fn ports(&self) -> Vec<UnitPort> {
        vec![
            UnitPort { name: "grid".into(), sets_flow: true, leads: true },
            UnitPort {
                name: "house".into(),
                sets_flow: self.house_flow == HouseFlow::Own,
                leads: false,
            },
        ]
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let ratio = |name, initial| UnitInput {
            name,
            unit: "",
            initial,
            min: 0.0,
            max: 1.0,
            follows: None,
        };
        vec![ratio("modulation", self.modulation), ratio("mode", self.mode)]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![
            UnitOutput::new("q_flow_w", "W"),
            UnitOutput::new("works", "1"),
            UnitOutput::new("heat_j", "J"),
        ]
    }

    fn initial_state(&self, initial_k: f64) -> Vec<f64> {
        vec![initial_k, initial_k, 0.0, 0.0]
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
        wanted.fill(PortRequest::default());
        if !self.works(signals, state) {
            return;
        }
        let modulation = signals.get(0);
        let house_w_k = match (self.house_flow, got) {
            (HouseFlow::Given, [_, house]) => {
                modulation * capacity_w_k(&self.medium, house.m_flow_kg_s)
            }
            _ => modulation * self.house_w_k,
        };
        if house_w_k <= 0.0 {
            return;
        }
        let inlets_k = (state[GRID_K] - state[HOUSE_K]).abs();
        let grid_w_k = match self.grid {
            Stream::Flow(w_k) => modulation * w_k,
            ref stream => direct_exchange::flow_w_k(stream, self.ua_w_k, house_w_k, inlets_k),
        };
        let cp = self.medium.heat_capacity_j_kg_k;
        let sign = if signals.get(1) >= 0.5 && self.reversed_for_cold { 1.0 } else { -1.0 };
        wanted[GRID] = PortRequest {
            m_flow_kg_s: sign * grid_w_k / cp,
            outlet: direct_exchange::outlet(self.ua_w_k, grid_w_k, house_w_k, state[HOUSE_K]),
        };
        wanted[HOUSE].m_flow_kg_s = house_w_k / cp;
    }

    fn respond(
        &self,
        _port: usize,
        _signals: &Signals<'_>,
        got: &[PortFlow],
        _state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        wanted[HOUSE].outlet = Outlet::HeatFlow(-self.heat_w(&got[GRID]));
    }

    fn advance(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        let (grid_w, house_w) = (self.heat_w(&ports[GRID]), self.heat_w(&ports[HOUSE]));
        state[WORKS] = f64::from(u8::from(self.works(signals, state)));
        state[GRID_K] = ports[GRID].t_in_k;
        state[HOUSE_K] = ports[HOUSE].t_in_k;
        state[HEAT_J] += dt_s * house_w;
        out.copy_from_slice(&[house_w, state[WORKS], state[HEAT_J]]);
        Exchange { electric_w: 0.0, external_w: grid_w + house_w }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heat into the house and change of the grid's temperature after some steps.
    fn run(params: &DirectExchangerParams, grid_degc: f64, house_degc: f64) -> (f64, PortFlow) {
        let unit = params.build(&Medium::default()).unwrap();
        let signals = [params.modulation, params.mode];
        let signals = Signals(&signals);
        let (grid_k, house_k) = (grid_degc + 273.15, house_degc + 273.15);
        let mut state = unit.initial_state(290.0);
        let mut out = [0.0; 3];
        let arrives = |t_in_k| PortFlow { t_in_k, t_out_k: t_in_k, m_flow_kg_s: 0.0 };
        let mut ports = [arrives(grid_k), arrives(house_k)];
        for _ in 0..3 {
            let mut wanted = [PortRequest::default(); 2];
            unit.request(&signals, &ports, &mut state, &mut wanted);
            if let Outlet::Exchange { w_k, other_k } = wanted[GRID].outlet {
                let capacity = capacity_w_k(&Medium::default(), wanted[GRID].m_flow_kg_s);
                let (constant_k, of_inlet) = Outlet::of_exchange(w_k, other_k, capacity);
                let t_out_k = constant_k + of_inlet * grid_k;
                ports[GRID] =
                    PortFlow { m_flow_kg_s: wanted[GRID].m_flow_kg_s, t_in_k: grid_k, t_out_k };
            }
            unit.respond(GRID, &signals, &ports, &mut state, &mut wanted);
            let (m, q_w) = (wanted[HOUSE].m_flow_kg_s, wanted[HOUSE].outlet.heat_flow_w().unwrap());
            let t_out_k = if m > 0.0 { house_k + q_w / (m * 4180.0) } else { house_k };
            ports[HOUSE] = PortFlow { m_flow_kg_s: m, t_in_k: house_k, t_out_k };
            let exchange = unit.advance(60.0, &signals, &ports, &mut state, &mut out);
            assert!(exchange.external_w.abs() < 1e-6 && exchange.electric_w == 0.0, "{exchange:?}");
        }
        (out[0], ports[GRID])
    }

    #[test]
    fn cools_directly_where_the_grid_is_colder() {
        let on = DirectExchangerParams {
            modulation: 1.0,
            grid_flow_control: FlowControl::ConstantFlow,
            grid_v_flow_m3_s: 5e-4,
            ..DirectExchangerParams::default()
        };
        // 0.5 kg/s on both sides: NTU = 3000/2090 = 1.4354, eps = 0.58939; 18 and 12 degC: 7391 W
        let (heat_w, grid) = run(&on, 12.0, 18.0);
        assert!((heat_w + 0.589_391 * 2090.0 * 6.0).abs() < 0.1, "{heat_w}");
        assert!((grid.m_flow_kg_s - 0.5).abs() < 1e-12);
        // 2 K are needed; warmer grids do not cool.
        assert_eq!(run(&on, 16.5, 18.0).0, 0.0);
        assert_eq!(run(&on, 25.0, 18.0).0, 0.0);
        let heats = DirectExchangerParams { mode: 0.0, ..on.clone() };
        let (heat_w, grid) = run(&heats, 45.0, 35.0);
        assert!((heat_w - 0.589_391 * 2090.0 * 10.0).abs() < 0.2 && grid.m_flow_kg_s < 0.0);
        let held = DirectExchangerParams {
            grid_flow_control: FlowControl::ConstantTemperatureDifference,
            ..on
        };
        let (_, grid) = run(&held, 11.0, 18.0);
        assert!((grid.t_out_k - grid.t_in_k - 5.0).abs() < 1e-6, "{grid:?}");
    }

    #[test]
    fn numbers_that_cannot_be() {
        let wrong = DirectExchangerParams { ua_w_k: 0.0, ..DirectExchangerParams::default() };
        assert!(wrong.build(&Medium::default()).is_err());
    }
}
