//! What a generator does in a step.

use super::flow::FlowWish;
use super::{
    AUX, BURNERS, Combustion, ENABLE, RETURN_K, ROD, STEP_S, SUPPLY_K, SUPPLY_SET, Stage, TRIPPED,
};
use crate::burner::{BurnerState, Command, Means, Steady};
use anergy_core::signal::Signals;

/// What the unit does in a step.
pub(super) struct Plan {
    pub(super) main: Means,
    pub(super) aux: Means,
    pub(super) rod_w: f64,
    pub(super) next_main: BurnerState,
    pub(super) next_aux: BurnerState,
    pub(super) tripped: bool,
    pub(super) overshot: bool,
    /// Whether the pump of an engine with a content runs.
    pub(super) pump: bool,
    pub(super) m_flow_kg_s: f64,
    /// Heat from the metal into the water over the difference of their temperatures, W/K.
    pub(super) metal_w_k: f64,
    /// That heat, W.
    pub(super) metal_w: f64,
}

impl Plan {
    /// Heat of fuel and electricity, W.
    pub(super) fn heat_w(&self) -> f64 {
        self.main.heat_w + self.aux.heat_w + self.rod_w
    }
}

impl Combustion {
    pub(super) fn plan(&self, signals: &Signals<'_>, state: &[f64]) -> Plan {
        let return_k = state[RETURN_K];
        let limits = &self.limits;
        let inside_k = if state[TRIPPED] != 0.0 { limits.restart_k } else { 0.0 };
        let enabled = signals.get(ENABLE) >= 0.5;
        let (modulation, overshot) = self.load(signals, state);
        // One that is off and not asked for does not trip, however warm its water is.
        let on = BurnerState::read(&state[BURNERS..]).phase.on();
        let aux = self.aux.is_some() && signals.get(AUX).max(signals.get(ROD)) > 0.0;
        let asked = enabled && (modulation > 0.0 || on || aux);
        let tripped = (asked || state[TRIPPED] != 0.0)
            && (return_k > limits.return_max_k - inside_k
                || state[SUPPLY_K] > limits.supply_max_k - inside_k);
        let run = |stage: &Stage, at: usize, modulation: f64| {
            let mut next = BurnerState::read(&state[at..]);
            let modulation = if enabled { modulation } else { 0.0 };
            let command = Command { modulation, tripped };
            let steady = |modulation| {
                let map = stage.map.at(modulation, return_k);
                Steady { fuel_w: map.fuel_w / self.factor.at(modulation), ..map }
            };
            let means = stage.burner.run(state[STEP_S], &command, &mut next, steady);
            (means, next)
        };
        let (main, next_main) = run(&self.main, BURNERS, modulation);
        let (aux, next_aux) = match &self.aux {
            Some(aux) => run(aux, BURNERS + BurnerState::LEN, signals.get(AUX)),
            None => (Means::default(), BurnerState::new()),
        };
        let rod_w = if self.aux.is_some() && enabled && !tripped {
            self.rod_rated_w * signals.get(ROD).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let flow_heat_w = main.flow_heat_w + aux.flow_heat_w + rod_w;
        let wish = FlowWish {
            heat_w: flow_heat_w,
            modulation: main.modulation,
            return_k,
            supply_set_k: signals.get(SUPPLY_SET),
            flow: main.flow.max(aux.flow).max(f64::from(u8::from(rod_w > 0.0))),
        };
        let pump = self.engine.is_none_or(|engine| {
            engine.pump(state[self.engine_at()], state[self.engine_at() + 1] != 0.0, &main)
        });
        let capacity_w_k = if pump { self.flow.capacity_w_k(&wish) } else { 0.0 };
        let m_flow_kg_s = capacity_w_k / self.medium.heat_capacity_j_kg_k;
        let metal_w_k = self.metal.map_or(0.0, |metal| {
            let passed = state[self.engine_at() + 1];
            let m_flow_kg_s = if m_flow_kg_s > 0.0 { m_flow_kg_s } else { passed };
            let capacity_w_k = self.medium.heat_capacity_j_kg_k * m_flow_kg_s.abs();
            metal.w_k(capacity_w_k, state[STEP_S])
        });
        let metal_k = self.metal.map_or(return_k, |_| state[self.engine_at()]);
        Plan {
            main,
            aux,
            rod_w,
            next_main,
            next_aux,
            tripped,
            overshot,
            pump,
            m_flow_kg_s,
            metal_w_k,
            metal_w: metal_w_k * (metal_k - return_k),
        }
    }
}
