//! Hot water of a house: draws, what heats them, circulation, and whether the tap is warm enough.
//!
//! **Equation** with the flow `m` at the taps, cold water `T_c` and the set temperature `T_s`:
//! - `heated_by = "exchanger"`, a fresh-water station: water of the storage gives `Q = m cp (T_s - T_c)` in a counter-flow
//!   exchanger; its pump runs as fast as that needs, `Q = UA LMTD(T_in - T_s, T_out - T_c)`, up to its largest flow.
//!   Beyond, the tap gets what comes.
//! - `heated_by = "passing"`, a coil in a storage or the storage itself: the water of the taps passes it,
//!   `m_hot = m (T_s - T_c)/(T_hot - T_c)` where a mixer adds cold water, all of it where it is colder than the set.
//!
//! Circulation loses `Q_z` all the time and brings its water back by `CIRCULATION_K` colder. A draw with less than
//! `T_s` minus the tolerance is discomfort, `V (T_s - T_tap)`; with `missing = "postponed"` its missing energy is drawn
//! later.
//!
//! **Assumptions** the pump is controlled perfectly; the exchanger holds no water; a step with draws works with their
//! mean flow while they last, the rest of it with circulation alone. Cold water `T_m + A cos(2 pi (d - d_0)/365)`.
//! **Validity** means over a step. **Numerics** flows follow from the temperature that arrived in the step before;
//! heat is booked as the water had it. **Sources** `zinsmeister2023`; values assumed (`docs/src/domestic-hot-water.md`).

mod exchanger;
mod params;

pub use params::{DomesticHotWaterParams, HeatedBy, MissingHeat};

use crate::calendar::{DAY_S, Moment, season};
use crate::hot_water_draws::{Drawn, Draws};
use crate::thermal_unit::{
    Exchange, Flag, START_UNIX, ThermalUnit, UnitInput, UnitOutput, UnitPort, capacity_w_k,
};
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use exchanger::Exchanger;

/// The water of a circulation comes back colder by this, K.
const CIRCULATION_K: f64 = 5.0;
/// Water that is warmer than the cold one by less cannot be told from it, K.
const LEAST_K: f64 = 0.1;
/// Less than this is not owed, J.
const LEAST_J: f64 = 1.0;
/// Flow with which missing energy is made up for, m3/s: 8 l/min.
const MAKING_UP_M3_S: f64 = 8.0 / 60_000.0;
/// Day of the year with the warmest cold water.
const WARMEST_DAY: f64 = 227.0;

/// Hot water of a house, ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct DomesticHotWater {
    params: DomesticHotWaterParams,
    draws: Option<Draws>,
    exchanger: Exchanger,
    medium: Medium,
}

/// State: time since the start and length of the step, s; what arrived, K; missing energy that is postponed, heat and
/// electricity so far, J; water drawn, m3; discomfort, K m3; whether the tap was too cold in the last draw; its last
/// temperature, K; what pump or mixer owe because the water changed within a step, J; then the draws of the day.
const ELAPSED_S: usize = 0;
const STEP_S: usize = 1;
const ARRIVES_K: usize = 2;
const POSTPONED_J: usize = 3;
const HEAT_J: usize = 4;
const ELECTRIC_J: usize = 5;
const DRAWN_M3: usize = 6;
const DISCOMFORT_K_M3: usize = 7;
const TOO_COLD: usize = 8;
const TAP_K: usize = 9;
const OWED_J: usize = 10;
const DRAWS: usize = 11;

const START: usize = 0;
const TAP_SET: usize = 1;
const CIRCULATION: usize = 2;
const DRIVEN_M3_S: usize = 3;

/// What a step needs.
struct Plan {
    /// Mean flow at the taps, kg/s, and share of the time with draws.
    tap_kg_s: f64,
    share: f64,
    cold_k: f64,
    set_k: f64,
    /// Heat that the circulation loses, W.
    circulation_w: f64,
    /// Mean flow at the port, kg/s.
    m_flow_kg_s: f64,
    outlet: Outlet,
}

impl DomesticHotWater {
    /// What is drawn in a step from its begin on; the state remembers the draws of the day.
    fn drawn(&self, signals: &Signals<'_>, dt_s: f64, state: &mut [f64]) -> (Drawn, f64) {
        let p = &self.params;
        let moment = |after_s: f64| {
            Moment::after(signals.get(START), p.utc_offset_s, state[ELAPSED_S] + after_s)
        };
        let day = moment(0.0).day;
        let cold_k = p.cold_k + p.cold_amplitude_difference_k * season(day, WARMEST_DAY);
        let Some(draws) = &self.draws else {
            let volume_m3 = signals.get(DRIVEN_M3_S) * dt_s;
            let drawing_s = if volume_m3 > 0.0 { dt_s } else { 0.0 };
            return (Drawn { volume_m3, drawing_s, ..Drawn::default() }, cold_k);
        };
        let mut sum = Drawn::default();
        let mut done_s = 0.0;
        for _ in 0..2 + (dt_s / DAY_S) as usize {
            let Moment { day, time_s } =
                Moment::after(signals.get(START), p.utc_offset_s, state[ELAPSED_S] + done_s);
            let piece_s = (dt_s - done_s).min((DAY_S - time_s).max(1e-6));
            let part = draws.drawn(day, time_s, piece_s, &mut state[DRAWS..]);
            sum.volume_m3 += part.volume_m3;
            sum.drawing_s += part.drawing_s;
            done_s += piece_s;
            if done_s >= dt_s {
                break;
            }
        }
        (sum, cold_k)
    }

    fn plan(&self, signals: &Signals<'_>, state: &mut [f64]) -> Plan {
        let p = &self.params;
        let dt_s = state[STEP_S];
        let (set_k, arrives_k) = (signals.get(TAP_SET), state[ARRIVES_K]);
        let span_s = if dt_s > 0.0 { dt_s } else { 1.0 };
        let (drawn, cold_k) = self.drawn(signals, span_s, state);
        let cp = self.medium.heat_capacity_j_kg_k;
        let density = self.medium.density_kg_m3;
        let (mut volume_m3, mut drawing_s) = (drawn.volume_m3, drawn.drawing_s);
        let lift_k = set_k - cold_k;
        if state[POSTPONED_J] > 0.0 && lift_k > LEAST_K && arrives_k >= set_k {
            let more_m3 = state[POSTPONED_J] / (density * cp * lift_k);
            let more_m3 = more_m3.min(MAKING_UP_M3_S * span_s);
            volume_m3 += more_m3;
            drawing_s = drawing_s.max(more_m3 / MAKING_UP_M3_S).min(span_s);
        }
        let tap_kg_s = volume_m3 * density / span_s;
        let share = drawing_s / span_s;
        // Water that arrives colder than the circulation comes back has nothing to give.
        let back_k = match p.heated_by {
            HeatedBy::Exchanger => set_k - CIRCULATION_K,
            HeatedBy::Passing => cold_k,
        };
        let able = ((arrives_k - back_k) / CIRCULATION_K).clamp(0.0, 1.0);
        let runs = signals.get(CIRCULATION).clamp(0.0, 1.0);
        let circulation_w = p.circulation_loss_w * runs * able;
        let mut plan = Plan {
            tap_kg_s,
            share,
            cold_k,
            set_k,
            circulation_w,
            m_flow_kg_s: 0.0,
            outlet: Outlet::HeatFlow(0.0),
        };
        let circulation_kg_s = circulation_w / (cp * CIRCULATION_K);
        match p.heated_by {
            HeatedBy::Exchanger => {
                // While water is drawn, and while it is not.
                let drawing_kg_s = if share > 0.0 { tap_kg_s / share } else { 0.0 };
                let (mut flow_w_k, mut heat_w) = (0.0, 0.0);
                for (part, tap_kg_s) in [(share, drawing_kg_s), (1.0 - share, 0.0)] {
                    let (w_k, w, _) = self.served(&plan, tap_kg_s, arrives_k);
                    flow_w_k += part * w_k;
                    heat_w += part * w;
                }
                if able <= 0.0 {
                    // What keeps the circulation warm draws on until warm water comes.
                    let asked_w_k = p.circulation_loss_w * runs / CIRCULATION_K;
                    flow_w_k = flow_w_k.max(asked_w_k.min(self.exchanger.most_w_k));
                }
                if state[OWED_J].abs() > LEAST_J && arrives_k > cold_k + CIRCULATION_K {
                    // The pump gives no more than it can; the rest stays owed.
                    let most_w = self.exchanger.most_w_k * (arrives_k - cold_k);
                    let owed_w =
                        (state[OWED_J] / span_s).clamp(-heat_w, (most_w - heat_w).max(0.0));
                    heat_w += owed_w;
                    flow_w_k = (flow_w_k + owed_w / (arrives_k - cold_k)).max(0.0);
                }
                plan.m_flow_kg_s = flow_w_k / cp;
                plan.outlet = Outlet::Cooled { wanted_w: heat_w, coldest_k: cold_k };
            }
            HeatedBy::Passing => {
                let warmer_k = arrives_k - cold_k;
                let hot_share = if warmer_k > lift_k { lift_k / warmer_k } else { 1.0 };
                let mut hot_kg_s = tap_kg_s * hot_share.max(0.0);
                if state[OWED_J].abs() > LEAST_J && warmer_k > lift_k {
                    let owed_kg_s = state[OWED_J] / (span_s * cp * warmer_k);
                    hot_kg_s += owed_kg_s.min(MAKING_UP_M3_S * density);
                    hot_kg_s = hot_kg_s.max(0.0);
                }
                plan.m_flow_kg_s = hot_kg_s + circulation_kg_s;
                if plan.m_flow_kg_s > 0.0 {
                    plan.outlet = Outlet::Linear {
                        constant_k: (hot_kg_s * cold_k - circulation_w / cp) / plan.m_flow_kg_s,
                        of_inlet: circulation_kg_s / plan.m_flow_kg_s,
                    };
                }
            }
        }
        plan
    }
}

impl ThermalUnit for DomesticHotWater {
    fn serves(&self) -> bool {
        true
    }

    fn ports(&self) -> Vec<UnitPort> {
        vec![UnitPort { name: "water".into(), sets_flow: true, leads: false }]
    }

    fn takes_heat(&self, _port: usize) -> bool {
        true
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let p = &self.params;
        let input = |name, unit, initial, min, max, follows| UnitInput {
            name,
            unit,
            initial,
            min,
            max,
            follows,
        };
        let infinity = f64::INFINITY;
        let mut inputs = vec![
            input("start_unix_s", "s", 0.0, -infinity, infinity, Some(START_UNIX)),
            input("tap_set_k", "k", p.tap_set_k, 0.0, infinity, None),
            input("circulation", "", p.circulation, 0.0, 1.0, None),
        ];
        if self.draws.is_none() {
            inputs.push(input("v_flow_m3_s", "m3_s", 0.0, 0.0, infinity, None));
        }
        inputs
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![
            UnitOutput::new("q_flow_w", "W"),
            UnitOutput::new("tap_m3_s", "m3 s-1"),
            UnitOutput::new("t_tap_k", "K"),
            UnitOutput::new("t_cold_k", "K"),
            UnitOutput::new("t_return_k", "K"),
            UnitOutput::new("too_cold", "1"),
            UnitOutput::new("electric_w", "W"),
            UnitOutput::new("drawn_m3", "m3"),
            UnitOutput::new("taken_j", "J"),
            UnitOutput::new("used_j", "J"),
            UnitOutput::new("postponed_j", "J"),
            UnitOutput::new("dc_water_k_m3", "K m3"),
        ]
    }

    fn initial_state(&self, initial_k: f64) -> Vec<f64> {
        let draws = self.draws.as_ref().map_or(0, Draws::state_len);
        let mut state = vec![0.0; DRAWS + draws];
        state[ARRIVES_K] = initial_k;
        state[TAP_K] = self.params.tap_set_k;
        if let Some(draws) = &self.draws {
            draws.initial(&mut state[DRAWS..]);
        }
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
        let plan = self.plan(signals, state);
        wanted[0] = PortRequest { m_flow_kg_s: plan.m_flow_kg_s, outlet: plan.outlet };
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
        let cp = self.medium.heat_capacity_j_kg_k;
        let taken_w = capacity_w_k(&self.medium, m_flow_kg_s) * (t_in_k - t_out_k);
        // What the circulation does not lose warms the taps.
        let tap_w = taken_w - plan.circulation_w;
        let drawn_m3 = plan.tap_kg_s / self.medium.density_kg_m3 * dt_s;
        if plan.tap_kg_s <= 0.0 {
            // What was owed and came.
            state[OWED_J] -= dt_s * tap_w;
        } else {
            let tap_w_k = plan.tap_kg_s * cp;
            // Pump and mixer follow what arrives within the step; what they took too much or too little they owe.
            state[TAP_K] = match self.params.heated_by {
                HeatedBy::Exchanger => self.tap_k(&plan, t_in_k),
                HeatedBy::Passing => t_in_k.min(plan.set_k),
            };
            let got_w = tap_w_k * (state[TAP_K] - plan.cold_k);
            state[OWED_J] += dt_s * (got_w - tap_w);
            let below_k = plan.set_k - state[TAP_K];
            let cold = below_k > self.params.tolerance_difference_k;
            state[TOO_COLD] = f64::from(u8::from(cold));
            if cold {
                state[DISCOMFORT_K_M3] += drawn_m3 * below_k;
            }
            if self.params.missing == MissingHeat::Postponed && dt_s > 0.0 {
                // What is made up for is part of what was planned.
                let wanted_w = tap_w_k * (plan.set_k - plan.cold_k);
                let draws_w = self.drawn_w(signals, dt_s, plan.set_k - plan.cold_k, state);
                let missing_w = if cold { wanted_w - got_w } else { 0.0 };
                let more_w = missing_w - (wanted_w - draws_w).max(0.0);
                state[POSTPONED_J] = (state[POSTPONED_J] + dt_s * more_w).max(0.0);
            }
        }
        let pumps = [(plan.circulation_w > 0.0, self.params.circulation_pump_w), {
            let exchanger = self.params.heated_by == HeatedBy::Exchanger;
            (exchanger && m_flow_kg_s > 0.0, self.params.pump_w * plan.share)
        }];
        let electric_w = pumps.iter().filter(|(runs, _)| *runs).map(|(_, w)| w).sum();
        state[ARRIVES_K] = t_in_k;
        state[HEAT_J] += dt_s * taken_w;
        state[ELECTRIC_J] += dt_s * electric_w;
        state[DRAWN_M3] += drawn_m3;
        state[ELAPSED_S] += dt_s;
        out.copy_from_slice(&[
            -taken_w,
            plan.tap_kg_s / self.medium.density_kg_m3,
            state[TAP_K],
            plan.cold_k,
            t_out_k,
            state[TOO_COLD],
            electric_w,
            state[DRAWN_M3],
            state[HEAT_J],
            state[ELECTRIC_J],
            state[POSTPONED_J],
            state[DISCOMFORT_K_M3],
        ]);
        Exchange { electric_w, external_w: -taken_w - electric_w }
    }

    fn flags(&self) -> &'static [Flag] {
        &[Flag {
            output: "too_cold",
            meaning: "a draw gets water below the set temperature and its tolerance",
        }]
    }
}

impl DomesticHotWater {
    /// Capacity flow of the pump, W/K, heat, W, and the temperature that the water of the taps and of the circulation
    /// gets, K.
    fn served(&self, plan: &Plan, tap_kg_s: f64, arrives_k: f64) -> (f64, f64, f64) {
        let cp = self.medium.heat_capacity_j_kg_k;
        let circulation_kg_s = plan.circulation_w / (cp * CIRCULATION_K);
        let secondary_kg_s = tap_kg_s + circulation_kg_s;
        if secondary_kg_s <= 0.0 {
            return (0.0, 0.0, plan.set_k);
        }
        let back_k = plan.set_k - CIRCULATION_K;
        let inlet_k = (tap_kg_s * plan.cold_k + circulation_kg_s * back_k) / secondary_kg_s;
        let (w_k, w) = self.exchanger.serve(secondary_kg_s * cp, inlet_k, plan.set_k, arrives_k);
        (w_k, w, inlet_k + w / (secondary_kg_s * cp))
    }

    /// Temperature of the taps while water is drawn and arrives with a temperature, K.
    fn tap_k(&self, plan: &Plan, arrives_k: f64) -> f64 {
        let drawing_kg_s = if plan.share > 0.0 { plan.tap_kg_s / plan.share } else { 0.0 };
        self.served(plan, drawing_kg_s, arrives_k).2
    }

    /// Heat of the draws alone at the set temperature, W.
    fn drawn_w(&self, signals: &Signals<'_>, dt_s: f64, lift_k: f64, state: &mut [f64]) -> f64 {
        let (drawn, _) = self.drawn(signals, dt_s, state);
        drawn.volume_m3 / dt_s
            * self.medium.density_kg_m3
            * self.medium.heat_capacity_j_kg_k
            * lift_k
    }
}

#[cfg(test)]
mod tests;
