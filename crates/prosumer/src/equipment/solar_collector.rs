//! Solar thermal collectors with their pump: flat plates or tubes in the circuit of a coil.
//!
//! **Equation** quasi-dynamic, per area, in `CELLS` cells one behind the other:
//! ```text
//! c5 dT/dt = eta0 (K_b G_b + K_d G_d) - a1 (T - T_air) - a2 (T - T_air)^2 - q_use,   q_use = m cp (T - T_before) n/A
//! K_b = 1 - b0 (1/cos theta - 1), 0 beyond 80 deg
//! ```
//! **Internal control** the pump starts where the collector is warmer than the water that would come back by
//! `start_difference_k`, and stops below `stop_difference_k`. Its flow rises from nothing to the full one while that
//! difference goes from `flow_from_difference_k` to `flow_full_difference_k`, at least `LEAST_SHARE` of it and what
//! keeps the collector below `collector_max_k`; or it holds the supply: `supply_set_k`, where the storage is warmer
//! `supply_high_k`. It rests while the water comes back above `return_max_k`, and while the collector is hotter than
//! `collector_max_k` (it stagnates, and cools down first).
//!
//! **Assumptions** the brine counts as water of the same capacity flow (glycol of 40 %: 13 % more litres); the pipes to
//! the roof hold nothing and lose nothing. **Validity** efficiency curves of ISO 9806; no steam. **Numerics** implicit
//! in time, so exact when steady and stable at any step; the slope of the quadratic loss is that of the step before.
//! The outlet is linear in the inlet; heat is booked as the water had it.
//!
//! **Sources** `iso9806`, `prohmo` (tubes, control); flat plate assumed (`docs/src/generators.md`).

mod params;

use params::Coefficients;
pub use params::{CollectorFlow, CollectorType, SolarCollectorParams};

use crate::equipment::pv::{on_plane, weather_inputs};
use crate::thermal_unit::{Exchange, ThermalUnit, UnitInput, UnitOutput, UnitPort, capacity_w_k};
use anergy_core::medium::{Medium, ZERO_CELSIUS_K};
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use anergy_core::solar::Plane;

/// Cells along the flow.
const CELLS: usize = 4;
/// Beyond this angle the beam counts nothing: its cosine, of 80 deg.
const LEAST_COSINE: f64 = 0.173_648_177_666_930_3;
/// Longer steps see the flow that the control has come to, s.
const SETTLES_S: f64 = 300.0;
/// The pump does not run slower.
const LEAST_SHARE: f64 = 0.1;

/// A collector field ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct SolarCollector {
    params: SolarCollectorParams,
    coefficients: Coefficients,
    plane: Plane,
    /// Heat capacity of a cell, J/K.
    cell_j_k: f64,
    /// Area of a cell, m2.
    cell_m2: f64,
    most_kg_s: f64,
    medium: Medium,
}

/// State: temperatures of the cells, K; length of the step, s; what arrived, K; whether the pump runs; heat to the
/// water, sun on the collectors and electricity so far, J; starts; time of operation and of stagnation, s.
const STEP_S: usize = CELLS;
const ARRIVES_K: usize = CELLS + 1;
const RUNS: usize = CELLS + 2;
const HEAT_J: usize = CELLS + 3;
const SUN_J: usize = CELLS + 4;
const ELECTRIC_J: usize = CELLS + 5;
const STARTS: usize = CELLS + 6;
const OPERATING_S: usize = CELLS + 7;
const STAGNATING_S: usize = CELLS + 8;
const STATE_LEN: usize = CELLS + 9;

const T_OUTDOOR: usize = 0;
/// Behind the weather.
const ENABLE: usize = 6;

/// What a cell ends a step with, over the inlet of the field: `constant + of_inlet T_in`.
type Line = (f64, f64);

/// Sun and surroundings in a step.
#[derive(Debug, Clone, Copy)]
struct Weather {
    /// On the plane, W/m2.
    total_w_m2: f64,
    /// What becomes heat in the absorber, W/m2.
    absorbed_w_m2: f64,
    air_k: f64,
}

impl SolarCollector {
    fn weather(&self, signals: &Signals<'_>) -> Weather {
        let (p, c) = (&self.params, &self.coefficients);
        let on_plane = on_plane(&self.plane, p.sky.sky(), signals);
        let cosine = on_plane.incidence_cosine;
        let of_beam =
            if cosine > LEAST_COSINE { (1.0 - c.b0 * (1.0 / cosine - 1.0)).max(0.0) } else { 0.0 };
        let diffuse_w_m2 = on_plane.sky_w_m2 + on_plane.ground_w_m2;
        Weather {
            total_w_m2: on_plane.total_w_m2(),
            absorbed_w_m2: c.eta0 * (of_beam * on_plane.beam_w_m2 + p.k_diffuse * diffuse_w_m2),
            air_k: signals.get(T_OUTDOOR),
        }
    }

    /// Loss per kelvin of a cell, W/(m2 K).
    fn loss_w_m2_k(&self, t_k: f64, air_k: f64) -> f64 {
        self.coefficients.a1_w_m2_k + self.coefficients.a2 * (t_k - air_k).abs()
    }

    /// The ends of the cells over the inlet after a step; a step of no length is a steady state.
    fn ends(
        &self,
        dt_s: f64,
        m_flow_kg_s: f64,
        weather: &Weather,
        cells_k: &[f64],
    ) -> [Line; CELLS] {
        let flow_w_k = capacity_w_k(&self.medium, m_flow_kg_s);
        let stored_w_k = if dt_s > 0.0 { self.cell_j_k / dt_s } else { 0.0 };
        let mut before: Line = (0.0, 1.0);
        let mut ends = [(0.0, 0.0); CELLS];
        for (end, t_k) in ends.iter_mut().zip(cells_k) {
            let loss_w_k = self.cell_m2 * self.loss_w_m2_k(*t_k, weather.air_k);
            let sum_w_k = stored_w_k + loss_w_k + flow_w_k;
            let own_w =
                stored_w_k * t_k + self.cell_m2 * weather.absorbed_w_m2 + loss_w_k * weather.air_k;
            *end = ((own_w + flow_w_k * before.0) / sum_w_k, flow_w_k * before.1 / sum_w_k);
            before = *end;
        }
        ends
    }

    /// Whether the pump runs in this step.
    fn runs(&self, signals: &Signals<'_>, state: &[f64]) -> bool {
        let p = &self.params;
        let (collector_k, back_k) = (state[CELLS - 1], state[ARRIVES_K]);
        let needed_k = if state[RUNS] != 0.0 { p.stop_difference_k } else { p.start_difference_k };
        signals.get(ENABLE) >= 0.5
            && collector_k - back_k > needed_k
            && back_k < p.return_max_k
            && collector_k < p.collector_max_k
    }

    /// Flow of the pump while it runs, kg/s.
    fn flow_kg_s(&self, state: &[f64], weather: &Weather) -> f64 {
        let (p, c) = (&self.params, &self.coefficients);
        let (collector_k, back_k) = (state[CELLS - 1], state[ARRIVES_K]);
        let share = match p.flow_control {
            CollectorFlow::Difference => {
                let (from_k, full_k) = (p.flow_from_difference_k, p.flow_full_difference_k);
                (collector_k - back_k - from_k) / (full_k - from_k)
            }
            CollectorFlow::Supply => {
                let set_k = if back_k > p.supply_set_k { p.supply_high_k } else { p.supply_set_k };
                let lift_k = (set_k - back_k).max(1.0);
                let mean_k = 0.5 * (set_k + back_k) - weather.air_k;
                let loss_w_m2 = mean_k * (c.a1_w_m2_k + c.a2 * mean_k.abs());
                let gain_w = (weather.absorbed_w_m2 - loss_w_m2) * p.area_m2;
                // A collector that is too cold waits for its sun.
                let warm = (1.0 + (collector_k - set_k) / lift_k).clamp(0.0, 2.0);
                warm * gain_w.max(0.0)
                    / (lift_k * self.medium.heat_capacity_j_kg_k * self.most_kg_s)
            }
        };
        // Within a long step the sun may rise: the flow carries off what it sends now; the longer the step, the smaller the
        // difference that the control would have come to within it.
        let room_k = (p.collector_max_k - back_k) / (state[STEP_S] / SETTLES_S).max(1.0);
        let room_k = room_k.max(1.0);
        let carried_kg_s =
            weather.absorbed_w_m2 * p.area_m2 / (room_k * self.medium.heat_capacity_j_kg_k);
        (self.most_kg_s * share.max(LEAST_SHARE)).max(carried_kg_s).min(self.most_kg_s)
    }
}

impl ThermalUnit for SolarCollector {
    fn ports(&self) -> Vec<UnitPort> {
        vec![UnitPort { name: "water".into(), sets_flow: true, leads: false }]
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let mut inputs = weather_inputs(self.params.t_outdoor_k);
        inputs.push(UnitInput {
            name: "enable",
            unit: "",
            initial: self.params.enable,
            min: 0.0,
            max: 1.0,
            follows: None,
        });
        inputs
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![
            UnitOutput::new("q_flow_w", "W"),
            UnitOutput::state("t_collector_k", "K"),
            UnitOutput::new("irradiance_w_m2", "W m-2"),
            UnitOutput::new("efficiency", "1"),
            UnitOutput::new("pump", "1"),
            UnitOutput::new("stagnates", "1"),
            UnitOutput::new("electric_w", "W"),
            UnitOutput::new("starts", "1"),
            UnitOutput::new("operating_s", "s"),
            UnitOutput::new("stagnating_s", "s"),
            UnitOutput::new("heat_j", "J"),
            UnitOutput::new("sun_j", "J"),
        ]
    }

    fn initial_state(&self, initial_k: f64) -> Vec<f64> {
        let mut state = vec![0.0; STATE_LEN];
        state[..CELLS].fill(self.params.t_outdoor_k);
        state[ARRIVES_K] = initial_k;
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
            state[ARRIVES_K] = got.t_in_k;
        }
        wanted[0] = PortRequest::default();
        if self.runs(signals, state) {
            let weather = self.weather(signals);
            let m_flow_kg_s = self.flow_kg_s(state, &weather);
            let ends = self.ends(state[STEP_S], m_flow_kg_s, &weather, &state[..CELLS]);
            let (constant_k, of_inlet) = ends[CELLS - 1];
            wanted[0] =
                PortRequest { m_flow_kg_s, outlet: Outlet::Linear { constant_k, of_inlet } };
        }
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
        let weather = self.weather(signals);
        let runs = self.runs(signals, state);
        let PortFlow { m_flow_kg_s, t_in_k, t_out_k } = ports[0];
        let flow_w_k = capacity_w_k(&self.medium, m_flow_kg_s);
        let q_w = flow_w_k * (t_out_k - t_in_k);
        let ends = self.ends(dt_s, m_flow_kg_s, &weather, &state[..CELLS]);
        let mut gained_w = 0.0;
        let mut last_k = 0.0;
        for (i, (constant_k, of_inlet)) in ends.into_iter().enumerate() {
            let end_k = constant_k + of_inlet * t_in_k;
            let loss_w_m2 = self.loss_w_m2_k(state[i], weather.air_k) * (end_k - weather.air_k);
            gained_w += self.cell_m2 * (weather.absorbed_w_m2 - loss_w_m2);
            last_k = end_k;
            if dt_s > 0.0 {
                state[i] = end_k;
            }
        }
        if dt_s > 0.0 {
            // What the water had otherwise than foreseen is still in the last cell.
            state[CELLS - 1] += dt_s * flow_w_k * (last_k - t_out_k) / self.cell_j_k;
        } else {
            gained_w = q_w;
        }
        let p = &self.params;
        let (was, on) = (state[RUNS] != 0.0, f64::from(u8::from(runs)));
        let electric_w = p.pump_w * on;
        let stagnates = !runs && state[CELLS - 1] > p.collector_max_k;
        if dt_s > 0.0 {
            state[STARTS] += f64::from(u8::from(runs && !was));
            state[RUNS] = on;
        }
        state[ARRIVES_K] = t_in_k;
        state[HEAT_J] += dt_s * q_w;
        state[SUN_J] += dt_s * weather.total_w_m2 * p.area_m2;
        state[ELECTRIC_J] += dt_s * electric_w;
        state[OPERATING_S] += dt_s * on;
        state[STAGNATING_S] += dt_s * f64::from(u8::from(stagnates));
        let sun_w = weather.total_w_m2 * p.area_m2;
        out.copy_from_slice(&[
            q_w,
            if dt_s > 0.0 { state[CELLS - 1] } else { last_k },
            weather.total_w_m2,
            if sun_w > 0.0 { q_w / sun_w } else { 0.0 },
            on,
            f64::from(u8::from(stagnates)),
            electric_w,
            state[STARTS],
            state[OPERATING_S],
            state[STAGNATING_S],
            state[HEAT_J],
            state[SUN_J],
        ]);
        Exchange { electric_w, external_w: gained_w - electric_w }
    }

    fn stored_j(&self, state: &[f64]) -> f64 {
        state[..CELLS].iter().map(|t_k| self.cell_j_k * (t_k - ZERO_CELSIUS_K)).sum()
    }
}

#[cfg(test)]
mod tests;
