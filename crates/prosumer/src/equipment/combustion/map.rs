//! Steady operation of generators that burn gas, over load and return temperature.
//!
//! **Equation** with the load `m` and `t = (T_return - 35 degC)/10`:
//! ```text
//! boiler (fit):   Q = Q_nom (0.6232 - 2.1185 m + 6.6285 m^2 - 3.8519 m^3 - 0.0027 t + 0.0013 t^2 - 0.0192 m t)
//!                 eta = 1.05 (0.9618 + 0.0247 m - 0.0073 m^2 - 0.0076 m^3 - 0.0305 t + 0.0039 t^2 + 0.0080 m t)
//!                 dT = dT_set (0.6862 + 0.2653 m + 0.4284 m^2 - 0.4252 m^3 - 0.0681 t + 0.0094 t^2 - 0.0038 m t)
//! boiler (table): eta(T_return), Q = Q_min(T_return) + (m - m_min)/(1 - m_min) (Q_max(T_return) - Q_min(T_return))
//! engine:         P = m P_max, eta_el straight from the smallest load to full load, H = P/eta_el,
//!                 eta = f (0.8608 + 0.0057 m - 0.0951 t + 0.0255 m t + 0.0089 t^2), Q = H (eta - eta_el)
//! Stirling:       P = m P_max, H = P/eta_el, eta = eta_30 - 0.002 (T_return - 30 degC), Q = H (eta - eta_el)
//! ```
//! **Assumptions** heat and fuel by the lower heating value. **Validity** fits from 20 to 75 degC of return, tables
//! within their points; clamped beyond. **Sources** `prohmo` (published steady states that the fits follow).

use crate::burner::Steady;
use crate::thermal_unit::UnitError;
use anergy_core::medium::ZERO_CELSIUS_K;
use anergy_core::numerics::interpolate::between_points;

/// Range of the return temperature of the fits, degC.
const FITTED_DEGC: (f64, f64) = (20.0, 75.0);

/// By the lower heating value no boiler has more.
const EFFICIENCY_MAX: f64 = 1.2;

/// Return temperature over 35 degC, in 10 K.
fn t_10k(return_k: f64) -> f64 {
    let degc = (return_k - ZERO_CELSIUS_K).clamp(FITTED_DEGC.0, FITTED_DEGC.1);
    (degc - 35.0) / 10.0
}

/// Share of the way from the smallest load to full load; full where there is no way between.
fn above(m: f64, least: f64) -> f64 {
    if least < 1.0 { ((m - least) / (1.0 - least)).clamp(0.0, 1.0) } else { 1.0 }
}

/// The temperature difference of the reference boiler over the one that is set.
pub(super) fn measured_share(m: f64, return_k: f64) -> f64 {
    let t = t_10k(return_k);
    0.6862 + m * (0.2653 + m * (0.4284 - 0.4252 * m)) - 0.0681 * t + 0.0094 * t * t - 0.0038 * m * t
}

/// The load from `least` to 1 at which the heat is what is wanted; the nearest where it is out of reach.
pub(super) fn solved(heat_w: impl Fn(f64) -> f64, wanted_w: f64, least: f64) -> f64 {
    let (mut low, mut high) = (least, 1.0);
    if heat_w(high) <= wanted_w {
        return high;
    }
    if heat_w(low) >= wanted_w {
        return low;
    }
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if heat_w(middle) < wanted_w { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// A boiler as a table over the return temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct BoilerTable {
    pub(super) modulation_min: f64,
    pub(super) return_k: Vec<f64>,
    pub(super) efficiency: Vec<f64>,
    pub(super) heat_min_w: Vec<f64>,
    pub(super) heat_max_w: Vec<f64>,
}

impl BoilerTable {
    /// Columns of equal length over rising temperatures.
    pub(super) fn checked(self) -> Result<Self, UnitError> {
        let within = |field, problem| Err(UnitError::Within { field, problem });
        let points = self.return_k.len();
        let columns = [
            ("table_efficiency", &self.efficiency),
            ("table_heat_min_w", &self.heat_min_w),
            ("table_heat_max_w", &self.heat_max_w),
        ];
        for (field, column) in columns {
            if column.len() != points {
                let problem = format!(
                    "{field} has {} numbers, table_return_k {points}: they must be as many",
                    column.len()
                );
                return within(field, problem);
            }
            if let Some(value) = column.iter().find(|value| !value.is_finite() || **value <= 0.0) {
                return within(field, format!("{field}: {value} must be positive"));
            }
        }
        if let Some(value) = self.efficiency.iter().find(|value| **value > EFFICIENCY_MAX) {
            let problem = format!("table_efficiency: {value} is no efficiency; 97 % is 0.97");
            return within("table_efficiency", problem);
        }
        if self.return_k.is_empty() {
            return within(
                "table_return_k",
                "the other columns of the table are missing their table_return_k".into(),
            );
        }
        if self.return_k.windows(2).any(|pair| pair[1] <= pair[0]) {
            return within("table_return_k", "table_return_k must rise".into());
        }
        let falls = self.heat_min_w.iter().zip(&self.heat_max_w).find(|(min, max)| min > max);
        if let Some((min, max)) = falls {
            let problem = format!("table_heat_min_w: {min} is above table_heat_max_w, {max}");
            return within("table_heat_min_w", problem);
        }
        Ok(self)
    }
}

/// Steady operation over load and return temperature.
#[derive(Debug, Clone, PartialEq)]
pub enum SteadyMap {
    /// The measured boiler, of another size.
    Boiler {
        /// Nominal heat, W.
        nominal_w: f64,
    },
    /// A boiler of a data sheet.
    Table(BoilerTable),
    /// A gas engine.
    Engine {
        /// Electricity at full load, W.
        power_w: f64,
        /// Smallest load.
        modulation_min: f64,
        /// Electric efficiency at the smallest and at full load.
        electric: (f64, f64),
        /// Total efficiency over that of the fit.
        total: f64,
    },
    /// A Stirling engine.
    Stirling {
        /// Electricity, W.
        power_w: f64,
        /// Electric efficiency.
        electric: f64,
        /// Total efficiency at a return of 30 degC.
        total: f64,
    },
}

impl SteadyMap {
    /// Heat, fuel and electricity at a load.
    pub fn at(&self, m: f64, return_k: f64) -> Steady {
        let t = t_10k(return_k);
        let engine = |power_w: f64, electric: f64, total: f64| {
            let fuel_w = power_w / electric;
            Steady { heat_w: fuel_w * (total - electric), fuel_w, power_w }
        };
        match self {
            Self::Boiler { nominal_w } => {
                let heat = 0.6232 + m * (-2.1185 + m * (6.6285 - 3.8519 * m)) - 0.0027 * t
                    + 0.0013 * t * t
                    - 0.0192 * m * t;
                let efficiency = 1.05
                    * (0.9618 + m * (0.0247 - m * (0.0073 + 0.0076 * m)) - 0.0305 * t
                        + 0.0039 * t * t
                        + 0.0080 * m * t);
                let heat_w = nominal_w * heat;
                Steady { heat_w, fuel_w: heat_w / efficiency, power_w: 0.0 }
            }
            Self::Table(table) => {
                let of = |column: &[f64]| between_points(&table.return_k, column, return_k);
                let (least_w, most_w) = (of(&table.heat_min_w), of(&table.heat_max_w));
                let heat_w = least_w + above(m, table.modulation_min) * (most_w - least_w);
                Steady { heat_w, fuel_w: heat_w / of(&table.efficiency), power_w: 0.0 }
            }
            Self::Engine { power_w, modulation_min, electric: (least, most), total } => {
                let above = above(m, *modulation_min);
                let fit = 0.8608 + 0.0057 * m + t * (-0.0951 + 0.0255 * m + 0.0089 * t);
                engine(m * power_w, least + above * (most - least), total * fit)
            }
            Self::Stirling { power_w, electric, total } => {
                let above_30 = 10.0 * t + 5.0;
                engine(m * power_w, *electric, total - 0.002 * above_30)
            }
        }
    }
}
