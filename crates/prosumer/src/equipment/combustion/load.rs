//! The load of a generator: what it is told, or what lifts a constant flow to the set supply.

use super::flow::FlowRule;
use super::{BAND_K, BURNERS, Combustion, GeneratorCommand, MODULATION, RETURN_K, SUPPLY_SET, map};
use crate::burner::BurnerState;
use anergy_core::signal::Signals;

impl Combustion {
    /// The load that is asked for, and whether its smallest one overshoots a set supply.
    pub(super) fn load(&self, signals: &Signals<'_>, state: &[f64]) -> (f64, bool) {
        let modulation = signals.get(MODULATION);
        let (GeneratorCommand::SupplyTemperature, FlowRule::Flow(capacity_w_k)) =
            (self.command, self.flow)
        else {
            return (modulation, false);
        };
        if modulation <= 0.0 {
            return (0.0, false);
        }
        let return_k = state[RETURN_K];
        let heat_w = |modulation| self.main.map.at(modulation, return_k).heat_w;
        let wanted_w = capacity_w_k * (signals.get(SUPPLY_SET) - return_k);
        let least = self.main.burner.modulation_min;
        let least_w = heat_w(least);
        let phase_on = BurnerState::read(&state[BURNERS..]).phase.on();
        let band_w = if phase_on { BAND_K * capacity_w_k } else { 0.0 };
        if least_w > wanted_w + band_w {
            return (0.0, true);
        }
        (map::solved(heat_w, wanted_w, least), false)
    }
}
