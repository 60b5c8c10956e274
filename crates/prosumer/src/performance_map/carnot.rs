//! A heat pump between two waters as a share of Carnot: the booster of an ambient grid.
//!
//! **Equation** heating `COP = eta T_cond/(T_cond - T_evap)`, `Q = m Q_rated (1 + slope (T_source,in - 10 degC))`,
//! the bracket within its limits; cooling `EER = eta T_evap/(T_cond - T_evap)`, `Q = m Q_rated`. The refrigerant is
//! `approach` colder than the water that leaves the evaporator and warmer than that which leaves the condenser;
//! `eta = eta_full (1 + gain (1 - m))`.
//!
//! **Assumptions** no published map exists of the laboratory's booster; the values are assumed. **Validity** a lift
//! of the refrigerant above `lift_min_k`: below, the compressor cannot follow and the ratio stays that of the least
//! lift. **Sources** Carnot factor with a quality grade, e.g. `jesper2021`; rated powers of the laboratory,
//! `zinsmeister2023`.

use super::{Operation, Performance, degc};

/// Share of Carnot with its rated heat or cold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarnotShare {
    /// Whether the useful side is cooled.
    pub cooling: bool,
    /// Heat or cold at full speed and, in heating, source water of 10 degC, W.
    pub rated_w: f64,
    /// Share of Carnot at full speed.
    pub share: f64,
    /// How much it gains towards no speed, relative.
    pub part_load_gain: f64,
    /// Water to refrigerant on both sides, K.
    pub approach_k: f64,
    /// Least difference of condensing and evaporating temperature, K.
    pub lift_min_k: f64,
    /// Change of the heat with the temperature of the source, 1/K; 0 in cooling.
    pub slope_per_k: f64,
    /// Largest ratio of useful heat and electricity.
    pub ratio_max: f64,
}

/// Temperature of the source at which the rated heat holds, degC, and limits of its factor.
const RATED_SOURCE_DEGC: f64 = 10.0;
const SOURCE_FACTOR: (f64, f64) = (0.6, 1.3);

impl CarnotShare {
    /// Heat or cold and electricity.
    pub fn at(&self, operation: &Operation) -> Performance {
        let (warm_k, cold_k) = if self.cooling {
            (operation.source_out_k, operation.supply_k)
        } else {
            (operation.supply_k, operation.source_out_k)
        };
        let (condensing_k, evaporating_k) = (warm_k + self.approach_k, cold_k - self.approach_k);
        let lift_k = (condensing_k - evaporating_k).max(self.lift_min_k);
        let m = operation.modulation.clamp(0.0, 1.0);
        let share = self.share * (1.0 + self.part_load_gain * (1.0 - m));
        let useful_k = if self.cooling { evaporating_k } else { condensing_k };
        let ratio = (share * useful_k / lift_k).clamp(1.0, self.ratio_max.max(1.0));
        let source = self.slope_per_k * (degc(operation.source_in_k) - RATED_SOURCE_DEGC);
        let useful_w = m * self.rated_w * (1.0 + source).clamp(SOURCE_FACTOR.0, SOURCE_FACTOR.1);
        Performance { useful_w, electric_w: useful_w / ratio }
    }
}
