//! A brine heat pump with what it takes its heat from: boreholes, pipes in the ground or a given temperature.
//!
//! **Equation** the water side is that of [`super::air_source_heat_pump`] with brine instead of air; the heat it takes,
//! `Q - eta_int P`, cools the ground ([`crate::ground_source`]), and the brine arrives as that says.
//!
//! **Assumptions** the brine is warmed by a constant difference and its flow is what that needs; its pump is part of the map. On or off; no defrosting. **Validity** that of map and ground. **Numerics** the brine of a step
//! follows from the ground at its begin and the heat that the unit takes in steady operation, found in
//! `ROUNDS` rounds.
//!
//! **Sources** `prohmo`; values without a source are marked assumed in `docs/src/heat-pumps.md`.

mod params;

pub use params::{BrineHeatPumpParams, BrineSource};

use super::air_source_heat_pump::{self, AirSourceHeatPump};
use crate::ground_source::{CELLS, GroundSource};
use crate::performance_map::{PerformanceMap, Sides, Stream};
use crate::thermal_unit::{Exchange, ThermalUnit, UnitInput, UnitOutput, UnitPort};
use anergy_core::port::{PortFlow, PortRequest};
use anergy_core::signal::Signals;

/// Rounds in which the brine and the heat taken from it are found: the heat changes by 3 % per kelvin.
const ROUNDS: usize = 3;
/// State of the ground, behind that of the heat pump: rings, K; heat taken so far, J; return of the water, K.
const TAKEN_J: usize = CELLS;
const RETURN_K: usize = CELLS + 1;
const GROUND_LEN: usize = CELLS + 2;

const MODULATION: usize = 0;
const AUX: usize = 1;
const ENABLE: usize = 2;
const SOURCE_K: usize = 3;
/// Where the inner unit has its heat from the source among its outputs.
const SOURCE_W: usize = 3;

/// A brine heat pump ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct BrineHeatPump {
    inner: AirSourceHeatPump,
    /// Its map once more, to know the heat it takes.
    map: PerformanceMap,
    /// Flow of the water of a unit of size 1.
    useful: Stream,
    size: f64,
    heat_share: f64,
    ground: Option<GroundSource>,
    /// Whether the undisturbed ground follows that of the weather.
    seasonal: bool,
    warmed_k: f64,
    initial: [f64; 4],
}

impl BrineHeatPump {
    /// Temperature with which the brine arrives while the unit runs, K.
    fn brine_k(&self, signals: &Signals<'_>, return_k: f64, ground: &[f64]) -> f64 {
        let Some(source) = &self.ground else { return signals.get(SOURCE_K) };
        let mut brine_k = source.brine_k(0.0, self.warmed_k, ground);
        for _ in 0..ROUNDS {
            let sides = Sides {
                cooling: false,
                source_in_k: brine_k,
                source: Stream::Unchanged,
                return_k,
                useful: self.useful,
                ambient_k: brine_k,
                heat_share: self.heat_share,
            };
            let performance = self.map.settled(&sides, 1.0).0.scaled(self.size);
            let taken_w = performance.other_side_w(false, self.heat_share);
            brine_k = source.brine_k(taken_w, self.warmed_k, ground);
        }
        brine_k
    }

    /// Signals of the inner unit.
    fn inner_signals(&self, signals: &Signals<'_>, return_k: f64, ground: &[f64]) -> [f64; 6] {
        let brine_k = self.brine_k(signals, return_k, ground);
        [signals.get(MODULATION), 0.0, signals.get(AUX), signals.get(ENABLE), brine_k, 0.0]
    }
}

impl ThermalUnit for BrineHeatPump {
    fn ports(&self) -> Vec<UnitPort> {
        self.inner.ports()
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
            ratio(AUX, "aux_modulation"),
            ratio(ENABLE, "enable"),
            UnitInput {
                unit: "k",
                max: f64::INFINITY,
                follows: self.seasonal.then_some("weather.t_ground_k"),
                ..ratio(SOURCE_K, "ground_k")
            },
        ]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        let mut outputs = self.inner.outputs();
        outputs[SOURCE_W] = UnitOutput::new("ground_w", "W");
        outputs.push(UnitOutput::new("t_brine_k", "K"));
        outputs.push(UnitOutput::new("taken_j", "J"));
        outputs
    }

    fn initial_state(&self, initial_k: f64) -> Vec<f64> {
        let mut state = self.inner.initial_state(initial_k);
        let mut ground = vec![self.initial[SOURCE_K]; GROUND_LEN];
        ground[TAKEN_J] = 0.0;
        state.extend(ground);
        state
    }

    fn begin(&self, dt_s: f64, state: &mut [f64]) {
        self.inner.begin(dt_s, state);
    }

    fn request(
        &self,
        signals: &Signals<'_>,
        got: &[PortFlow],
        state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        let (inner, ground) = state.split_at_mut(air_source_heat_pump::STATE_LEN);
        if let Some(got) = got.first() {
            ground[RETURN_K] = got.t_in_k;
        }
        let signals = self.inner_signals(signals, ground[RETURN_K], ground);
        self.inner.request(&Signals(&signals), got, inner, wanted);
    }

    fn advance(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        let (inner, ground) = state.split_at_mut(air_source_heat_pump::STATE_LEN);
        let (own, more) = out.split_at_mut(out.len() - 2);
        let of_inner = self.inner_signals(signals, ground[RETURN_K], ground);
        let exchange = self.inner.advance(dt_s, &Signals(&of_inner), ports, inner, own);
        let taken_w = own[SOURCE_W];
        if dt_s > 0.0 {
            if let Some(source) = &self.ground {
                let undisturbed_k = signals.get(SOURCE_K);
                source.advance(dt_s, taken_w, undisturbed_k, &mut ground[..CELLS]);
            }
            ground[TAKEN_J] += dt_s * taken_w;
        }
        more.copy_from_slice(&[of_inner[4], ground[TAKEN_J]]);
        exchange
    }

    fn stored_j(&self, state: &[f64]) -> f64 {
        self.inner.stored_j(&state[..air_source_heat_pump::STATE_LEN])
    }

    fn remarks(&self) -> Vec<String> {
        crate::thermal_unit::scaled_far(self.size)
    }
}

#[cfg(test)]
mod tests;
