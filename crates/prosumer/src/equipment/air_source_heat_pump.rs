//! An air-source heat pump with its internal control: heats or cools the water of one circuit.
//!
//! **Equation** heat and electricity of a [performance map](crate::performance_map) times what time does to the
//! [compressor](crate::compressor); the flow either keeps the difference of supply and return, `m = Q/(cp dT)`, or is
//! constant. The electric heater stands behind the condenser: `T_supply = T_return + (Q + Q_aux)/(m cp)`; the
//! flow follows the heat of the compressor, so the heater lifts the supply further. While the heater is wanted, the
//! compressor is driven at full speed. The water in the unit mixes with what passes,
//! `M dT/dt = m (T_in - T) + Q/cp`, which is also the flush after the return was switched elsewhere. Heat from
//! the air follows, `Q_air = Q - eta_int P`; it is the refrigerant's own heat during a start and that of melting ice
//! in a defrost.
//!
//! **Internal control** a limit of the return temperature, of the supply behind the condenser and of the air stops
//! the unit; it may start again when the return is inside by the restart difference. Frost counts in air colder
//! than its limit, faster in damp air: `min(2, RH/0.8)`; in warmer air it melts at the rate it grew.
//!
//! **Assumptions** the whole unit stands still when the limits trip, its heater too. Where a circuit gives less flow
//! than wanted, heat and electricity shrink in proportion (the cut-out acts within the step). **Validity** that of
//! the map. **Numerics** map and limits take the return temperature of the step before; the outlet is the
//! exact mean over the step of the mixed content, so energy closes to rounding at any step.
//!
//! **Sources** `zinsmeister2024`, `zinsmeister2022`; values without a source are marked assumed in
//! `docs/src/heat-pumps.md`.

pub mod params;

use crate::compressor::{Command, Compressor, CompressorState, Means};
use crate::efficiency_factor::EfficiencyFactor;
use crate::heat_pump::{AuxHeater, Limits};
use crate::performance_map::{Performance, PerformanceMap, Sides, Stream};
use crate::thermal_unit::{Exchange, ThermalUnit, UnitInput, UnitOutput, UnitPort, capacity_w_k};
use anergy_core::medium::{Medium, ZERO_CELSIUS_K};
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
pub use params::AirSourceHeatPumpParams;

/// When frost grows.
#[derive(Debug, Clone, Copy, PartialEq)]
struct DefrostRule {
    below_k: f64,
}

impl DefrostRule {
    /// Humidity at which the counter runs as the clock does, and its largest rate.
    const NORMAL_HUMIDITY: f64 = 0.8;
    const LARGEST_RATE: f64 = 2.0;

    fn rate(&self, air_k: f64, humidity: f64) -> f64 {
        if air_k < self.below_k {
            (humidity / Self::NORMAL_HUMIDITY).clamp(0.0, Self::LARGEST_RATE)
        } else {
            -1.0
        }
    }
}

/// An air-source heat pump ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct AirSourceHeatPump {
    heating: PerformanceMap,
    cooling: Option<PerformanceMap>,
    compressor: Compressor,
    size: f64,
    /// Of a unit of size 1.
    water: Stream,
    limits: Limits,
    frost: DefrostRule,
    aux: AuxHeater,
    factor: EfficiencyFactor,
    idle_w: f64,
    heat_share: f64,
    content_kg: f64,
    initial: [f64; 6],
    medium: Medium,
}

/// State behind that of the compressor: length of the step, s; return and condenser temperature, K; whether a limit
/// tripped; heat of the content, J above 0 degC; heat, cold and electricity so far, J.
const STEP_S: usize = CompressorState::LEN;
const RETURN_K: usize = STEP_S + 1;
const CONDENSER_K: usize = STEP_S + 2;
const TRIPPED: usize = STEP_S + 3;
const CONTENT_J: usize = STEP_S + 4;
const HEAT_J: usize = STEP_S + 5;
const COLD_J: usize = STEP_S + 6;
const ELECTRIC_J: usize = STEP_S + 7;
pub(super) const STATE_LEN: usize = STEP_S + 8;

const MODULATION: usize = 0;
const MODE: usize = 1;
const AUX: usize = 2;
const ENABLE: usize = 3;
const T_OUTDOOR: usize = 4;
const HUMIDITY: usize = 5;

/// What the unit does in a step.
struct Plan {
    means: Means,
    next: CompressorState,
    tripped: bool,
    m_flow_kg_s: f64,
    aux_w: f64,
}

impl Plan {
    /// Heat into the water, W.
    fn heat_w(&self) -> f64 {
        self.means.water_w + self.aux_w
    }
}

impl AirSourceHeatPump {
    fn plan(&self, signals: &Signals<'_>, state: &[f64]) -> Plan {
        let air_k = signals.get(T_OUTDOOR);
        let cooling = signals.get(MODE) >= 0.5;
        let tripped = self.limits.trip(
            cooling,
            state[RETURN_K],
            state[CONDENSER_K],
            air_k,
            state[TRIPPED] != 0.0,
        );
        let can = !cooling || self.cooling.is_some();
        let aux_w = if cooling { 0.0 } else { self.aux.power_w(signals.get(AUX)) };
        let wanted = if aux_w > 0.0 { 1.0 } else { signals.get(MODULATION) };
        let command = Command {
            on: wanted > 0.0 && signals.get(ENABLE) >= 0.5 && can,
            modulation: wanted,
            cooling,
            tripped,
            frost_rate: self.frost.rate(air_k, signals.get(HUMIDITY)),
        };
        let mut next = CompressorState::read(state);
        let sides = |cooling| Sides {
            cooling,
            source_in_k: air_k,
            source: Stream::Unchanged,
            return_k: state[RETURN_K],
            useful: self.water,
            ambient_k: air_k,
            heat_share: self.heat_share,
        };
        let steady = |modulation, cooling| {
            let map = match (&self.cooling, cooling) {
                (Some(map), true) => map,
                _ => &self.heating,
            };
            let map = map.settled(&sides(cooling), modulation).0.scaled(self.size);
            Performance { electric_w: map.electric_w / self.factor.at(modulation), ..map }
        };
        let means = self.compressor.run(state[STEP_S], &command, &mut next, steady);
        let capacity_w_k = match self.water {
            Stream::Difference { difference_k, .. } => means.flow_useful_w / difference_k,
            Stream::Flow(capacity_w_k) => self.size * capacity_w_k * means.flow,
            Stream::Unchanged => 0.0,
        };
        let m_flow_kg_s = capacity_w_k / self.medium.heat_capacity_j_kg_k;
        Plan { means, next, tripped, m_flow_kg_s, aux_w: aux_w * means.flow_on }
    }

    /// The same unit with another source and map, that only heats.
    pub(super) fn with_map(self, heating: PerformanceMap) -> Self {
        Self { heating, cooling: None, ..self }
    }

    /// Mean share of the content at the begin of a step in what leaves during it.
    fn kept(&self, dt_s: f64, m_flow_kg_s: f64) -> f64 {
        if self.content_kg <= 0.0 || dt_s <= 0.0 {
            return 0.0;
        }
        let changes = m_flow_kg_s * dt_s / self.content_kg;
        if changes > 0.0 { -(-changes).exp_m1() / changes } else { 1.0 }
    }
}

impl ThermalUnit for AirSourceHeatPump {
    fn ports(&self) -> Vec<UnitPort> {
        vec![UnitPort { name: "water".into(), sets_flow: true, leads: false }]
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
        let air = |i, name, unit, max, follows| UnitInput {
            unit,
            max,
            follows: Some(follows),
            ..ratio(i, name)
        };
        vec![
            ratio(MODULATION, "modulation"),
            ratio(MODE, "mode"),
            ratio(AUX, "aux_modulation"),
            ratio(ENABLE, "enable"),
            air(T_OUTDOOR, "t_outdoor_k", "k", f64::INFINITY, "weather.t_outdoor_k"),
            air(HUMIDITY, "relative_humidity", "", 1.0, "weather.relative_humidity"),
        ]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![
            UnitOutput::new("q_flow_w", "W"),
            UnitOutput::new("electric_w", "W"),
            UnitOutput::new("aux_w", "W"),
            UnitOutput::new("air_w", "W"),
            UnitOutput::new("cop", "1"),
            UnitOutput::new("speed", "1"),
            UnitOutput::new("phase", "1"),
            UnitOutput::new("tripped", "1"),
            UnitOutput::new("starts", "1"),
            UnitOutput::new("operating_s", "s"),
            UnitOutput::new("defrosting_s", "s"),
            UnitOutput::new("heat_j", "J"),
            UnitOutput::new("cold_j", "J"),
            UnitOutput::new("electric_j", "J"),
            UnitOutput::new("cop_so_far", "1"),
        ]
    }

    fn initial_state(&self, initial_k: f64) -> Vec<f64> {
        let mut state = vec![0.0; STATE_LEN];
        CompressorState::new().write(&mut state);
        state[RETURN_K] = initial_k;
        state[CONDENSER_K] = initial_k;
        state[CONTENT_J] =
            self.content_kg * self.medium.heat_capacity_j_kg_k * (initial_k - ZERO_CELSIUS_K);
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
        if let Some(got) = got.first() {
            state[RETURN_K] = got.t_in_k;
        }
        let plan = self.plan(signals, state);
        let (m_flow_kg_s, heat_w) = (plan.m_flow_kg_s, plan.heat_w());
        let kept = self.kept(state[STEP_S], m_flow_kg_s);
        let outlet = if kept > 0.0 && m_flow_kg_s > 0.0 {
            let capacity_j_k = self.content_kg * self.medium.heat_capacity_j_kg_k;
            let content_k = ZERO_CELSIUS_K + state[CONTENT_J] / capacity_j_k;
            let warmed_k = heat_w / capacity_w_k(&self.medium, m_flow_kg_s);
            let constant_k = (1.0 - kept) * warmed_k + kept * content_k;
            Outlet::Linear { constant_k, of_inlet: 1.0 - kept }
        } else {
            Outlet::HeatFlow(heat_w)
        };
        wanted[0] = PortRequest { m_flow_kg_s, outlet };
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
        let PortFlow { m_flow_kg_s, t_in_k, t_out_k } = ports[0];
        let capacity_w_k = capacity_w_k(&self.medium, m_flow_kg_s);
        let q_w = capacity_w_k * (t_out_k - t_in_k);
        // What the flow could take of what was planned.
        let share = if plan.m_flow_kg_s > 0.0 {
            (m_flow_kg_s.abs() / plan.m_flow_kg_s).min(1.0)
        } else {
            1.0
        };
        // Without a content the water has just what the unit gave.
        let inside_w =
            if self.kept(dt_s, plan.m_flow_kg_s) > 0.0 { share * plan.heat_w() } else { q_w };
        let aux_w = share * plan.aux_w;
        let idle_w = self.idle_w * (1.0 - plan.means.on);
        let electric_w = share * plan.means.electric_w + aux_w + idle_w;
        plan.next.write(state);
        state[TRIPPED] = f64::from(u8::from(plan.tripped));
        state[RETURN_K] = t_in_k;
        let condenser_w = (share * plan.means.water_w).max(0.0);
        let warmed_k = if capacity_w_k > 0.0 { condenser_w / capacity_w_k } else { 0.0 };
        state[CONDENSER_K] = t_in_k + warmed_k;
        state[CONTENT_J] += dt_s * (inside_w - q_w);
        if plan.next.cooling {
            state[COLD_J] -= dt_s * q_w;
        } else {
            state[HEAT_J] += dt_s * q_w;
        }
        state[ELECTRIC_J] += dt_s * electric_w;
        let per = |heat: f64, electric: f64| if electric > 0.0 { heat / electric } else { 0.0 };
        let running_w = electric_w - idle_w;
        let values = [
            q_w,
            electric_w,
            aux_w,
            inside_w - aux_w - self.heat_share * share * plan.means.electric_w,
            per(if plan.next.cooling { -inside_w } else { inside_w }, running_w),
            plan.means.modulation * plan.means.on,
            plan.next.phase.number(),
            state[TRIPPED],
            plan.next.starts,
            plan.next.operating_s,
            plan.next.defrosting_s,
            state[HEAT_J],
            state[COLD_J],
            state[ELECTRIC_J],
            per(state[HEAT_J] + state[COLD_J], state[ELECTRIC_J]),
        ];
        out.copy_from_slice(&values);
        Exchange { electric_w, external_w: inside_w - electric_w }
    }

    fn remarks(&self) -> Vec<String> {
        crate::thermal_unit::scaled_far(self.size)
    }

    fn stored_j(&self, state: &[f64]) -> f64 {
        state[CONTENT_J]
    }
}

#[cfg(test)]
mod tests;
