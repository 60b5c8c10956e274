//! The content of an engine: its metal and the water in it, which its pump empties of heat.
//!
//! **Equation** `C dT/dt = Q - UA (T - T_around) - m cp (T - T_in)`; the water leaves with `T`. The pump runs from `pump_on_k` on and
//! stops below `pump_off_k`: where more water passes than the engine can heat, it stops until the engine is hot again.
//! With a content the start gives the heat of the fuel to the engine from ignition on, instead of the measured table:
//! 60 kJ/K take 12 minutes from 20 to 82 degC, as the table says. A stop gives what the content holds.
//!
//! **Assumptions** stirred; heat to the surroundings as at the start of a step. **Validity** steps shorter than what the pump
//! needs to empty it, about a minute; a run makes steps shorter in which full load would heat it from where the pump starts to the limit of the supply. **Numerics** exact over a step ([`Outlet::Stirred`]), whatever the flow; what the water
//! took is booked. **Sources** behaviour `zinsmeister2022`; capacity, loss and temperatures assumed.

use crate::burner::Means;
use anergy_core::port::Outlet;

/// Steps are not made shorter than what heats the content by this, K.
const LEAST_ROOM_K: f64 = 5.0;

/// The content of an engine, ready to run. Its state: temperature, K; whether its pump runs; heat lost so far, J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EngineContent {
    /// Heat capacity, J/K.
    pub heat_capacity_j_k: f64,
    /// Heat to the surroundings, W/K.
    pub loss_w_k: f64,
    /// Temperature of the surroundings, K.
    pub ambient_k: f64,
    /// The pump starts above, K.
    pub pump_on_k: f64,
    /// The pump stops below, K.
    pub pump_off_k: f64,
    /// Temperature at the start of a run, K; that of the run without it.
    pub initial_k: Option<f64>,
}

impl EngineContent {
    /// Whether the pump runs in a step.
    pub(super) fn pump(&self, t_k: f64, ran: bool, burner: &Means) -> bool {
        if burner.on > 0.0 {
            return t_k >= if ran { self.pump_off_k } else { self.pump_on_k };
        }
        // It runs on with the stop, where it ran.
        ran && burner.flow > 0.0
    }

    /// Mean loss over a step, W.
    pub(super) fn lost_w(&self, t_k: f64, dt_s: f64) -> f64 {
        let full_w = self.loss_w_k * (t_k - self.ambient_k);
        let x = self.loss_w_k * dt_s / self.heat_capacity_j_k;
        if x > 1e-9 { -full_w * (-x).exp_m1() / x } else { full_w }
    }

    /// The longest step in which heat does not bring it above the hottest supply before its pump has a turn, s.
    pub(super) fn longest_step_s(&self, t_k: f64, heat_w: f64, hottest_k: f64) -> f64 {
        let room_k = (hottest_k - t_k.min(self.pump_on_k)).max(LEAST_ROOM_K);
        if heat_w > 0.0 { room_k * self.heat_capacity_j_k / heat_w } else { f64::INFINITY }
    }

    /// What happens to the water.
    pub(super) fn outlet(&self, t_k: f64, heat_w: f64, dt_s: f64) -> Outlet {
        Outlet::Stirred {
            t_k,
            heat_w: heat_w - self.lost_w(t_k, dt_s),
            heat_capacity_j_k: self.heat_capacity_j_k,
            dt_s,
        }
    }
}
