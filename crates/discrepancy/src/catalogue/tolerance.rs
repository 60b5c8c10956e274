//! How well the numbers of a model are known: what it declares in `[tolerance]`, else what is usual.
//!
//! **Equation** a quantity that lies anywhere within `+-h` has the standard deviation `h/root 3`; of one whose coordinate is the
//! logarithm of a factor, `ln(1 + h)/root 3`.

use crate::experiment::Experiment;
use crate::unknown::ROOT3;
use anergy_prosumer::equipment::storage::StorageParams;
use anergy_simulation::model_file::ToleranceEntry;

/// Water in layers is 0.1 to 0.2 K off after some charges, without an error of sensor or model, in cases of development: as a
/// standard deviation of what a storage seems to lose in a record.
const LAYERS_K: f64 = 0.06;
/// Water of a storage, J/(m3 K), and how much warmer than its surroundings it usually is, K.
const WATER_J_M3_K: f64 = 4.1e6;
const WARMER_K: f64 = 30.0;

/// Standard deviations of what is always uncertain, in the coordinates of their unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Known {
    /// Length of a pipe, relative: the largest one of 1 %, over the root of 3 as that of a sensor.
    pub length: f64,
    /// Heat loss of a pipe, relative: at most 8 %.
    pub loss: f64,
    /// Temperature around a pipe, K: at most 0.5 K.
    pub surroundings_k: f64,
    /// Pressure loss of a pipe, relative: at most 2 %.
    pub friction: f64,
    /// Heat transfer between water and wall, relative: laws of turbulent flow are right to 10 %. With a wall of
    /// capacity `R C` for water of capacity `C` it disperses by `u^2 R tau/(1 + R)^3` (the time of the film `tau`); at 0.8 m/s,
    /// `R = 0.3` and 2 s a tenth of 0.2 m2/s: as much as weak dispersion (P7), in which its flaws look like one.
    pub film: f64,
    /// Head of a pump, relative.
    pub pump_head: f64,
    /// Conductance of a heat exchanger, relative.
    pub exchanger: f64,
    /// Heat loss of a storage, relative.
    pub storage_loss: f64,
    /// Conduction along the height of a storage, whose layers are a model of it: logarithm of its factor.
    pub storage_mixing: f64,
    /// Efficiency, relative.
    pub efficiency: f64,
    /// What the map of a heat pump is off at 20, 40 and 60 % of the load, relative, each for itself: it has a few loads and is
    /// straight between them.
    pub part_load: f64,
    /// Time that a start takes, relative.
    pub start: f64,
    /// Time constant of metal and water in a generator, of which models of generators know only what starts and stops show, s: 0.5
    /// to 1 kJ/K per kW of its heat (a wall-hung boiler of 20 kW: 2 to 3 l of water, 10 to 20 kg of metal) over the heat capacity
    /// flow of 20 K at this heat, `1 kW / 20 K = 0.05 kW/K`: 10 to 20 s.
    pub outlet_lag_s: f64,
    /// What the model declares: limits. What is usual of pumps, exchangers, storages and generators has none.
    pub declared: ToleranceEntry,
}

impl Known {
    /// Of the model of an experiment.
    pub(super) fn of(experiment: &Experiment) -> Self {
        Self::declared(&experiment.model.tolerance)
    }

    /// Heat loss of a storage, relative: of one in layers with what these are off, over what its water loses in the longest run.
    pub(super) fn loss_of(&self, storage: &StorageParams, longest_s: f64) -> f64 {
        if storage.layers < 2 {
            return self.storage_loss;
        }
        let lost_k = storage.loss_w_k() * WARMER_K * longest_s / (WATER_J_M3_K * storage.volume_m3);
        self.storage_loss.hypot((LAYERS_K / lost_k.max(LAYERS_K)).min(1.0))
    }

    fn declared(given: &ToleranceEntry) -> Self {
        let plain = |half: Option<f64>, usual: f64| half.map_or(usual, |half| half / ROOT3);
        let factor =
            |half: Option<f64>, usual: f64| half.map_or(usual, |half| half.ln_1p() / ROOT3);
        Self {
            length: plain(given.length, 0.01 / ROOT3),
            loss: factor(given.loss, 0.08 / ROOT3),
            surroundings_k: plain(given.surroundings_difference_k, 0.5 / ROOT3),
            friction: factor(given.friction, 0.02 / ROOT3),
            film: factor(given.film, 0.1),
            pump_head: factor(given.pump_head, 0.02),
            exchanger: factor(given.exchanger, 0.05),
            storage_loss: factor(given.storage_loss, 0.08),
            storage_mixing: factor(given.storage_mixing, 0.7),
            efficiency: factor(given.efficiency, 0.02),
            part_load: factor(given.part_load, 0.01),
            start: factor(given.start, 0.1),
            outlet_lag_s: plain(given.outlet_lag_s, 15.0),
            declared: *given,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_declared_is_as_usual() {
        let given = ToleranceEntry { storage_loss: Some(0.05), ..ToleranceEntry::default() };
        let (known, usual) = (Known::declared(&given), Known::declared(&ToleranceEntry::default()));
        // ln 1.05/root 3 = 0.04879/1.73205 = 0.028169. In 4 h 10 W/K 30 K 14 400 s/(4.1e6 J/(m3 K) 0.6 m3) = 1.7561 K are lost, of
        // which 0.06 K are 0.034167: together 0.044282. In a day 0.0056945, together 0.028739.
        let of = |layers, longest_s| {
            let (volume_m3, height_m, ua_w_k) = (0.6, 1.8, Some(10.0));
            let storage =
                StorageParams { volume_m3, height_m, ua_w_k, layers, ..StorageParams::default() };
            known.loss_of(&storage, longest_s)
        };
        for (layers, longest_s, expected) in
            [(1, 14_400.0, 0.028_169), (10, 14_400.0, 0.044_282), (10, 86_400.0, 0.028_739)]
        {
            assert!((of(layers, longest_s) - expected).abs() < 1e-6, "{}", of(layers, longest_s));
        }
        let (storage_loss, declared) = (usual.storage_loss, usual.declared);
        assert_eq!(Known { storage_loss, declared, ..known }, usual);
        assert!((usual.length - 0.005_773_5).abs() < 1e-7);
    }
}
