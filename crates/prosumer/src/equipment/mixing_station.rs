//! A mixing station between a storage and the heating of a house: three-way mixer, heating curve.
//!
//! **Equation** the share `y` of the water comes from the storage, the rest is the return: `T_mix = y T_in + (1 - y) T_return`,
//! so never warmer than `T_in`. The mixer turns to the share that gives the set temperature, `y = (T_set - T_return)/(T_in -
//! T_return)` within 0 and 1, in `stroke_s` from one end to the other. The set temperature is that of the heating curve,
//! ```text
//! T_set = T_room + (T_nominal - T_room) ((T_room - T_out)/(T_room - T_design))^(1/n)
//! ```
//! within its limits, or a signal.
//!
//! **Assumptions** the flow is that of the heating (its thermostats); its pump draws a constant power while water
//! flows; the mixer is controlled perfectly, so it does not swing as the laboratory's does. **Validity** means over a
//! step. **Numerics** storage and return of the step before set the mixer and the flow from the storage; the outlet is linear
//! in the return. Where they change within a step the storage gives a little more or less than the heating gets: the unit
//! holds that heat and evens it out in the next step; water goes back no colder than the return. **Sources** `zinsmeister2023`, `prohmo`; design temperature assumed.

use crate::equipment::liquid;
use crate::thermal_unit::{
    Exchange, ThermalUnit, UnitError, UnitInput, UnitOutput, UnitPort, capacity_w_k, not_negative,
};
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Storage and return that differ by less cannot be told apart, K.
const LEAST_K: f64 = 0.01;

/// What is held flows within so many times the flow of the heating.
const EVENING_OUT: f64 = 3.0;

/// Where the set temperature comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SupplySet {
    /// The heating curve.
    #[default]
    Curve,
    /// The signal `supply_set_k`.
    Signal,
}

/// A mixing station as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MixingStationParams {
    /// Where the set temperature comes from.
    pub set_by: SupplySet,
    /// Set temperature with `set_by = "signal"` while nothing drives it, K.
    pub supply_set_k: f64,
    /// Supply at the design outdoor temperature, K.
    pub nominal_supply_k: f64,
    /// Room temperature of the curve, K.
    pub room_k: f64,
    /// Outdoor temperature of the design, K.
    pub design_outdoor_k: f64,
    /// Exponent of the emitters: 1.3 of radiators, 1.1 of floors.
    pub exponent: f64,
    /// The supply is not set colder, K.
    pub supply_min_k: f64,
    /// The supply is not set warmer, K.
    pub supply_max_k: f64,
    /// Time in which the mixer turns from one end to the other, s; 0 at once.
    pub stroke_s: f64,
    /// Electricity of the pump while water flows, W.
    pub pump_w: f64,
    /// Outdoor temperature while neither weather nor anything else drives it, K.
    pub t_outdoor_k: f64,
}

impl Default for MixingStationParams {
    fn default() -> Self {
        Self {
            set_by: SupplySet::Curve,
            supply_set_k: 313.15,
            nominal_supply_k: 333.15,
            room_k: 294.15,
            design_outdoor_k: 259.15,
            exponent: 1.3,
            supply_min_k: 293.15,
            supply_max_k: 353.15,
            stroke_s: 60.0,
            pump_w: 30.0,
            t_outdoor_k: 275.15,
        }
    }
}

/// A mixing station ready to run. State: share of the mixer; length of the step, s; inlets of storage and heating, K;
/// heat and electricity so far, J; heat held, J.
#[derive(Debug, Clone, PartialEq)]
pub struct MixingStation {
    params: MixingStationParams,
    medium: Medium,
}

const SHARE: usize = 0;
const STEP_S: usize = 1;
const STORAGE_K: usize = 2;
const RETURN_K: usize = 3;
const HEAT_J: usize = 4;
const ELECTRIC_J: usize = 5;
const HELD_J: usize = 6;

const STORAGE: usize = 0;
const HEATING: usize = 1;

impl MixingStationParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<MixingStation, UnitError> {
        let out_of_range =
            |field, value, requirement| Err(UnitError::OutOfRange { field, value, requirement });
        for (field, value) in [
            ("supply_set_k", self.supply_set_k),
            ("nominal_supply_k", self.nominal_supply_k),
            ("supply_min_k", self.supply_min_k),
            ("supply_max_k", self.supply_max_k),
        ] {
            liquid(medium, field, value)?;
        }
        not_negative("stroke_s", self.stroke_s)?;
        not_negative("pump_w", self.pump_w)?;
        if !(1.0..=2.0).contains(&self.exponent) {
            return out_of_range("exponent", self.exponent, "must lie between 1 and 2");
        }
        if !(213.15..=self.room_k - 1.0).contains(&self.design_outdoor_k) {
            let requirement = "must lie between -60 degC and the room";
            return out_of_range("design_outdoor_k", self.design_outdoor_k, requirement);
        }
        if self.room_k >= self.nominal_supply_k {
            return out_of_range("room_k", self.room_k, "must be below nominal_supply_k");
        }
        if self.supply_min_k > self.supply_max_k {
            return out_of_range("supply_min_k", self.supply_min_k, "is above supply_max_k");
        }
        Ok(MixingStation { params: self.clone(), medium: *medium })
    }
}

impl MixingStation {
    /// The set temperature, K.
    fn set_k(&self, signals: &Signals<'_>) -> f64 {
        let p = &self.params;
        let set_k = match p.set_by {
            SupplySet::Signal => signals.get(0),
            SupplySet::Curve => {
                let cold = (p.room_k - signals.get(0)) / (p.room_k - p.design_outdoor_k);
                let lift_k = p.nominal_supply_k - p.room_k;
                p.room_k + lift_k * cold.max(0.0).powf(1.0 / p.exponent)
            }
        };
        set_k.clamp(p.supply_min_k, p.supply_max_k)
    }

    /// Mean share over a step, and that at its end.
    fn turned(&self, signals: &Signals<'_>, state: &[f64]) -> (f64, f64) {
        let lift_k = state[STORAGE_K] - state[RETURN_K];
        let wanted_k = self.set_k(signals) - state[RETURN_K];
        let target = match lift_k {
            _ if wanted_k <= 0.0 => 0.0,
            _ if lift_k < LEAST_K => 1.0,
            _ => (wanted_k / lift_k).min(1.0),
        };
        let (from, dt_s, stroke_s) = (state[SHARE], state[STEP_S], self.params.stroke_s);
        let needed_s = (target - from).abs() * stroke_s;
        if dt_s <= 0.0 || needed_s <= 0.0 {
            return (target, target);
        }
        if dt_s >= needed_s {
            let turning = needed_s / dt_s;
            return (target - turning * 0.5 * (target - from), target);
        }
        let end = from + (target - from) * dt_s / needed_s;
        (0.5 * (from + end), end)
    }
}

/// Water of the storage and of the return.
fn mixed(share: f64, storage_k: f64) -> Outlet {
    Outlet::Linear { constant_k: share * storage_k, of_inlet: 1.0 - share }
}

impl ThermalUnit for MixingStation {
    fn ports(&self) -> Vec<UnitPort> {
        vec![
            UnitPort { name: "storage".into(), sets_flow: true, leads: true },
            UnitPort { name: "heating".into(), sets_flow: false, leads: false },
        ]
    }

    fn takes_heat(&self, port: usize) -> bool {
        port == 0
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let p = &self.params;
        let (name, initial, follows) = match p.set_by {
            SupplySet::Signal => ("supply_set_k", p.supply_set_k, None),
            SupplySet::Curve => ("t_outdoor_k", p.t_outdoor_k, Some("weather.t_outdoor_k")),
        };
        vec![UnitInput { name, unit: "k", initial, min: 0.0, max: f64::INFINITY, follows }]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![
            UnitOutput::new("q_flow_w", "W"),
            UnitOutput::new("set_k", "K"),
            UnitOutput::new("t_supply_k", "K"),
            UnitOutput::new("share", "1"),
            UnitOutput::new("electric_w", "W"),
            UnitOutput::new("passed_j", "J"),
            UnitOutput::new("used_j", "J"),
        ]
    }

    fn initial_state(&self, initial_k: f64) -> Vec<f64> {
        vec![0.0, 0.0, initial_k, initial_k, 0.0, 0.0, 0.0]
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
        let mut flow_kg_s = 0.0;
        if let [storage, heating] = got {
            state[STORAGE_K] = storage.t_in_k;
            state[RETURN_K] = heating.t_in_k;
            flow_kg_s = heating.m_flow_kg_s.abs();
        }
        let (share, _) = self.turned(signals, state);
        let lift_k = state[STORAGE_K] - state[RETURN_K];
        let mixed_kg_s = share * flow_kg_s;
        let held_w = if state[STEP_S] > 0.0 { state[HELD_J] / state[STEP_S] } else { 0.0 };
        let heat_w = (capacity_w_k(&self.medium, mixed_kg_s) * lift_k - held_w).max(0.0);
        wanted[STORAGE] = if lift_k > LEAST_K {
            let m_flow_kg_s = heat_w / (lift_k * self.medium.heat_capacity_j_kg_k);
            // Not much more than the heating passes; what is still held is evened out later.
            PortRequest {
                m_flow_kg_s: m_flow_kg_s.min(EVENING_OUT * flow_kg_s),
                outlet: Outlet::Cooled { wanted_w: heat_w, coldest_k: state[RETURN_K] },
            }
        } else {
            // Water of a storage that is colder than the return: what leaves the heating goes into the storage.
            PortRequest { m_flow_kg_s: mixed_kg_s, outlet: Outlet::Temperature(state[RETURN_K]) }
        };
        wanted[HEATING].outlet = mixed(share, state[STORAGE_K]);
    }

    fn respond(
        &self,
        _port: usize,
        signals: &Signals<'_>,
        got: &[PortFlow],
        state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        let (share, _) = self.turned(signals, state);
        wanted[HEATING].outlet = mixed(share, got[STORAGE].t_in_k);
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
        let (_, end) = self.turned(signals, state);
        let heat_w = |port: &PortFlow| {
            capacity_w_k(&self.medium, port.m_flow_kg_s) * (port.t_out_k - port.t_in_k)
        };
        let (storage, heating) = (&ports[STORAGE], &ports[HEATING]);
        let q_w = heat_w(heating);
        let flows = heating.m_flow_kg_s != 0.0;
        let electric_w = if flows { self.params.pump_w } else { 0.0 };
        if dt_s > 0.0 {
            state[SHARE] = end;
        }
        state[STORAGE_K] = storage.t_in_k;
        state[RETURN_K] = heating.t_in_k;
        state[HEAT_J] += dt_s * q_w;
        state[HELD_J] -= dt_s * (q_w + heat_w(storage));
        state[ELECTRIC_J] += dt_s * electric_w;
        out.copy_from_slice(&[
            q_w,
            self.set_k(signals),
            heating.t_out_k,
            state[SHARE],
            electric_w,
            state[HEAT_J],
            state[ELECTRIC_J],
        ]);
        Exchange { electric_w, external_w: -electric_w }
    }

    fn stored_j(&self, state: &[f64]) -> f64 {
        state[HELD_J]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn station(params: &MixingStationParams) -> MixingStation {
        params.build(&Medium::default()).unwrap()
    }

    fn port(m_flow_kg_s: f64, t_in_degc: f64) -> PortFlow {
        PortFlow { m_flow_kg_s, t_in_k: t_in_degc + 273.15, t_out_k: t_in_degc + 273.15 }
    }

    /// Temperature to the heating and flow from the storage after some steps.
    fn mixed(unit: &MixingStation, outdoor_degc: f64, storage_degc: f64, dt_s: f64) -> (f64, f64) {
        let signals = [outdoor_degc + 273.15];
        let signals = Signals(&signals);
        let mut state = unit.initial_state(300.0);
        let mut ports = [port(0.0, storage_degc), port(0.2, 30.0)];
        let mut out = [0.0; 7];
        for _ in 0..(600.0 / dt_s) as usize {
            let mut wanted = [PortRequest::default(); 2];
            unit.begin(dt_s, &mut state);
            unit.request(&signals, &ports, &mut state, &mut wanted);
            let m_flow_kg_s = wanted[0].m_flow_kg_s;
            let q_w = match wanted[0].outlet {
                Outlet::Cooled { wanted_w, .. } => -wanted_w,
                Outlet::Temperature(t_k) => m_flow_kg_s * 4180.0 * (t_k - ports[0].t_in_k),
                _ => 0.0,
            };
            ports[0].m_flow_kg_s = m_flow_kg_s;
            ports[0].t_out_k = ports[0].t_in_k
                + if m_flow_kg_s > 0.0 { q_w / (m_flow_kg_s * 4180.0) } else { 0.0 };
            unit.respond(0, &signals, &ports, &mut state, &mut wanted);
            let Outlet::Linear { constant_k, of_inlet } = wanted[1].outlet else { panic!() };
            ports[1].t_out_k = constant_k + of_inlet * ports[1].t_in_k;
            let before_j = unit.stored_j(&state);
            let exchange = unit.advance(dt_s, &signals, &ports, &mut state, &mut out);
            assert!((exchange.electric_w + exchange.external_w).abs() < 1e-9);
            let held_w = (unit.stored_j(&state) - before_j) / dt_s;
            let heating_w = 0.2 * 4180.0 * (ports[1].t_out_k - ports[1].t_in_k);
            assert!((held_w + q_w + heating_w).abs() < 1e-6, "{held_w} {q_w} {heating_w}");
            let most_j = 0.2 * 4180.0 * 45.0 * dt_s;
            assert!(unit.stored_j(&state).abs() < most_j, "no store: {} J", unit.stored_j(&state));
            let warmest_k = ports[0].t_in_k.max(ports[1].t_in_k);
            assert!(ports[1].t_out_k <= warmest_k + 1e-9, "never warmer than storage and return");
        }
        (ports[1].t_out_k - 273.15, ports[0].m_flow_kg_s)
    }

    #[test]
    fn a_curve_by_hand() {
        let unit = station(&MixingStationParams::default());
        let set = |outdoor_degc: f64| unit.set_k(&Signals(&[outdoor_degc + 273.15])) - 273.15;
        // -14 degC: 60; 2 degC: 21 + 39 (19/35)^(1/1.3) = 21 + 39 * 0.62504 = 45.38; 30 degC: the room, 21.
        assert!((set(-14.0) - 60.0).abs() < 1e-9);
        assert!((set(2.0) - 45.38).abs() < 0.01, "{}", set(2.0));
        assert!((set(21.0) - 21.0).abs() < 1e-9 && (set(30.0) - 21.0).abs() < 1e-9);
    }

    #[test]
    fn mixes_to_the_curve_and_never_above_the_storage() {
        let unit = station(&MixingStationParams::default());
        for dt_s in [1.0, 60.0, 300.0] {
            // 45.38 degC of 70 and 30: share 0.38446 of 0.2 kg/s.
            let (supply, flow) = mixed(&unit, 2.0, 70.0, dt_s);
            assert!((supply - 45.38).abs() < 0.01, "{supply}");
            assert!((flow - 0.2 * 0.3845).abs() < 1e-4, "{flow}");
            let (supply, flow) = mixed(&unit, 2.0, 40.0, dt_s);
            assert!((supply - 40.0).abs() < 1e-9 && (flow - 0.2).abs() < 1e-12);
            // A storage colder than the return: its water heats nothing, and nothing is held.
            let (supply, flow) = mixed(&unit, 2.0, 25.0, dt_s);
            assert!((supply - 25.0).abs() < 1e-9 && (flow - 0.2).abs() < 1e-12);
            // A return that is warmer than the set: only the return.
            let (supply, flow) = mixed(&unit, 19.0, 70.0, dt_s);
            assert!((supply - 30.0).abs() < 1e-9 && flow == 0.0);
        }
    }

    #[test]
    fn the_mixer_takes_its_time() {
        let params = MixingStationParams { set_by: SupplySet::Signal, ..Default::default() };
        let unit = station(&params);
        let mut state = unit.initial_state(303.15);
        state[STORAGE_K] = 323.15;
        state[STEP_S] = 15.0;
        // 40 degC of 50 and 30: half; after 15 s it is at a quarter, on average at an eighth.
        let (mean, end) = unit.turned(&Signals(&[313.15]), &state);
        assert!((mean - 0.125).abs() < 1e-12 && (end - 0.25).abs() < 1e-12);
        // 60 s: 30 s on the way (a quarter), 30 s there: 0.375.
        state[STEP_S] = 60.0;
        let (mean, end) = unit.turned(&Signals(&[313.15]), &state);
        assert!((mean - 0.375).abs() < 1e-12 && (end - 0.5).abs() < 1e-12);
        let wrong = MixingStationParams { room_k: 340.0, ..Default::default() };
        assert_eq!(wrong.build(&Medium::default()).unwrap_err().field(), Some("room_k"));
    }
}
