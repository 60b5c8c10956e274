//! What a booster heat pump does in a step: exchanger or compressor, speed, flows.

use super::*;
use crate::compressor::{Command, CompressorState, Means, Phase};
use crate::direct_exchange;
use crate::performance_map::{Sides, Stream};

/// The unit stops where the grid water could be cooled by less than this, K.
pub(super) const LEAST_DROP_K: f64 = 1.0;
/// The exchanger goes on until the approach is missed by this, K.
const EXCHANGER_HYSTERESIS_K: f64 = 1.0;
/// Rounds in which the speed is fitted to what the grid can give.
const ROUNDS: usize = 4;

/// What the unit does in a step.
pub(super) struct Plan {
    pub means: Means,
    pub next: CompressorState,
    pub cooling: bool,
    pub tripped: bool,
    pub exchanger: bool,
    /// Capacity flows, W/K.
    pub grid_w_k: f64,
    pub house_w_k: f64,
    /// Heat into the water of the grid by the heat pump, W.
    pub grid_w: f64,
    /// Power of the rod, W.
    pub aux_w: f64,
}

impl Plan {
    /// Share of the planned heat that the grid really gave or took.
    pub fn share(&self, grid_w: f64) -> f64 {
        if self.grid_w == 0.0 { 1.0 } else { (grid_w / self.grid_w).clamp(0.0, 1.0) }
    }

    /// Heat into the water of the house, given what went into the grid, W.
    pub fn house_w(&self, grid_w: f64) -> f64 {
        let useful_w =
            if self.exchanger { -grid_w } else { self.share(grid_w) * self.means.water_w };
        useful_w + self.aux_w
    }
}

impl BoosterHeatPump {
    /// The sides of the heat pump with the temperatures of the step before.
    fn sides(&self, signals: &Signals<'_>, state: &[f64], cooling: bool) -> Sides {
        let most_drop_k = state[GRID_K] - self.coldest_k;
        let scarce_w_k = state[SCARCE_W_K];
        let source = match self.grid {
            _ if scarce_w_k > 0.0 => Stream::Flow(scarce_w_k),
            Stream::Difference { difference_k, least_w_k, most_w_k } if !cooling => {
                // A drop that would be too cold shrinks.
                let difference_k = difference_k.min(most_drop_k).max(LEAST_DROP_K);
                Stream::Difference { difference_k, least_w_k, most_w_k }
            }
            stream => stream,
        };
        Sides {
            cooling,
            source_in_k: state[GRID_K],
            source,
            return_k: state[HOUSE_K],
            useful: self.house,
            ambient_k: signals.get(T_OUTDOOR),
            heat_share: self.heat_share,
        }
    }

    /// The speed at which the grid is not cooled below its coldest temperature, at most `wanted`.
    fn bearable(&self, sides: &Sides, wanted: f64) -> f64 {
        let most_w_k = match sides.source {
            Stream::Difference { most_w_k, .. } => most_w_k,
            stream => stream.capacity_w_k(0.0),
        };
        let available_w = most_w_k * (sides.source_in_k - self.coldest_k).max(0.0);
        let mut modulation = wanted.clamp(self.compressor.modulation_min, 1.0);
        for _ in 0..ROUNDS {
            let (performance, _) = self.heating.settled(sides, modulation);
            let taken_w = performance.other_side_w(false, self.heat_share);
            if taken_w <= available_w || modulation <= self.compressor.modulation_min {
                break;
            }
            modulation = (modulation * available_w / taken_w).max(self.compressor.modulation_min);
        }
        modulation.min(wanted)
    }

    /// Whether the exchanger can serve the house.
    fn exchanger_fits(&self, cooling: bool, state: &[f64]) -> bool {
        let ahead_k =
            if cooling { state[HOUSE_K] - state[GRID_K] } else { state[GRID_K] - state[HOUSE_K] };
        let kept_k = if state[EXCHANGER] != 0.0 { EXCHANGER_HYSTERESIS_K } else { 0.0 };
        self.exchanger_ua_w_k > 0.0 && ahead_k > self.exchanger_approach_k - kept_k
    }

    pub(super) fn plan(&self, signals: &Signals<'_>, state: &[f64]) -> Plan {
        let cooling = signals.get(MODE) >= 0.5;
        let aux_w = if cooling { 0.0 } else { self.aux.power_w(signals.get(AUX)) };
        let modulation = signals.get(MODULATION);
        let enabled = signals.get(ENABLE) >= 0.5;
        let on = modulation > 0.0 && enabled;
        let by_exchanger = on && self.exchanger_fits(cooling, state);
        let before = CompressorState::read(state);
        let settled = state[STEP_S] <= 0.0 || !self.compressor.dynamics;
        let exchanger = by_exchanger && (before.phase == Phase::Off || settled);
        let tripped = self.limits.trip(
            cooling,
            state[HOUSE_K],
            state[CONDENSER_K],
            state[GRID_K],
            state[TRIPPED] != 0.0,
        );
        let pumps_heat = on && !by_exchanger && (!cooling || self.cooling.is_some());
        let bearable = if pumps_heat && !cooling && !tripped {
            self.bearable(&self.sides(signals, state, false), modulation)
        } else {
            modulation
        };
        let command =
            Command { on: pumps_heat, modulation: bearable, cooling, tripped, frost_rate: -1.0 };
        let mut next = before;
        let steady = |modulation, cooling| {
            let map = match (&self.cooling, cooling) {
                (Some(map), true) => map,
                _ => &self.heating,
            };
            map.settled(&self.sides(signals, state, cooling), modulation).0
        };
        let means = self.compressor.run(state[STEP_S], &command, &mut next, steady);
        let mut plan = Plan {
            grid_w: -means.other_side_w(self.heat_share),
            means,
            next,
            cooling: if exchanger { cooling } else { next.cooling },
            tripped,
            exchanger,
            grid_w_k: 0.0,
            house_w_k: 0.0,
            aux_w: 0.0,
        };
        if exchanger {
            self.flows_of_exchanger(&mut plan, modulation, state);
        } else {
            self.flows_of_heat_pump(&mut plan, state);
        }
        // The rod is on while water passes it.
        let passes = if exchanger { 1.0 } else { means.flow_on };
        plan.aux_w = aux_w * if plan.house_w_k > 0.0 { passes } else { 0.0 };
        plan
    }

    fn flows_of_exchanger(&self, plan: &mut Plan, modulation: f64, state: &[f64]) {
        plan.house_w_k = modulation * self.house_w_k;
        let inlets_k = (state[GRID_K] - state[HOUSE_K]).abs();
        plan.grid_w_k = match self.grid {
            Stream::Flow(w_k) => modulation * w_k,
            ref stream => {
                direct_exchange::flow_w_k(stream, self.exchanger_ua_w_k, plan.house_w_k, inlets_k)
            }
        };
    }

    fn flows_of_heat_pump(&self, plan: &mut Plan, state: &[f64]) {
        let means = &plan.means;
        plan.house_w_k = match self.house {
            Stream::Difference { difference_k, .. } => means.flow_useful_w / difference_k,
            stream => means.flow * stream.capacity_w_k(0.0),
        };
        let inside_w = self.heat_share * means.flow_electric_w;
        plan.grid_w_k = match self.grid {
            Stream::Difference { difference_k, least_w_k, most_w_k } => {
                let (heat_w, difference_k) = if plan.cooling {
                    (means.flow_useful_w + inside_w, difference_k)
                } else {
                    let most_k = (state[GRID_K] - self.coldest_k).max(LEAST_DROP_K);
                    (means.flow_useful_w - inside_w, difference_k.min(most_k))
                };
                (heat_w / difference_k).clamp(means.flow * least_w_k, means.flow * most_w_k)
            }
            stream => means.flow * stream.capacity_w_k(0.0),
        };
    }

    pub(super) fn m_flow_kg_s(&self, capacity_w_k: f64) -> f64 {
        capacity_w_k / self.medium.heat_capacity_j_kg_k
    }
}
