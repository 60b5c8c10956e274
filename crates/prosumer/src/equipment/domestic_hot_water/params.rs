//! Hot water of a house as written in a model file.

use super::DomesticHotWater;
use super::exchanger::Exchanger;
use crate::calendar::DAY_S;
use crate::equipment::liquid;
use crate::hot_water_draws::Draws;
use crate::thermal_unit::{UnitError, not_negative, positive, share};
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What heats the water of the taps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HeatedBy {
    /// A plate exchanger with a pump on the side of the storage: a fresh-water station.
    #[default]
    Exchanger,
    /// It passes a coil in a storage, or a storage of hot water itself.
    Passing,
}

/// What becomes of the heat that a draw does not get.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MissingHeat {
    /// It is only counted.
    #[default]
    Logged,
    /// It is drawn later, when the water is warm.
    Postponed,
}

/// Hot water of a house as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DomesticHotWaterParams {
    /// What heats the water of the taps.
    pub heated_by: HeatedBy,
    /// Mean volume of a day at the set temperature, m3; without it the signal `v_flow_m3_s` drives the draws.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub daily_m3: Option<f64>,
    /// Number that chooses the sequence of draws, with the name of the unit.
    pub seed: u64,
    /// Volume of a day at the weekend over that of a workday.
    pub weekend_factor: f64,
    /// How much more is drawn in February than on average, relative.
    pub season_amplitude: f64,
    /// Local clock over UTC, s.
    pub utc_offset_s: f64,
    /// Set temperature of the taps while nothing drives it, K.
    pub tap_set_k: f64,
    /// A tap may be colder by this without discomfort, K.
    pub tolerance_difference_k: f64,
    /// Mean temperature of the cold water over the year, K.
    pub cold_k: f64,
    /// How much warmer the cold water is in August than on average, K.
    pub cold_amplitude_difference_k: f64,
    /// What becomes of heat that is missing.
    pub missing: MissingHeat,
    /// Conductance of the exchanger, W/K.
    pub ua_w_k: f64,
    /// Largest flow of the pump on the side of the storage, m3/s.
    pub v_flow_max_m3_s: f64,
    /// Electricity of that pump while water is drawn, W.
    pub pump_w: f64,
    /// 1: the circulation runs, while nothing drives it.
    pub circulation: f64,
    /// Heat that the pipes of the circulation lose, W; 0 without circulation.
    pub circulation_loss_w: f64,
    /// Electricity of the pump of the circulation, W.
    pub circulation_pump_w: f64,
}

impl Default for DomesticHotWaterParams {
    fn default() -> Self {
        Self {
            heated_by: HeatedBy::Exchanger,
            daily_m3: None,
            seed: 1,
            weekend_factor: 1.2,
            season_amplitude: 0.1,
            utc_offset_s: 3600.0,
            tap_set_k: 318.15,
            tolerance_difference_k: 1.0,
            cold_k: 283.15,
            cold_amplitude_difference_k: 3.0,
            missing: MissingHeat::Logged,
            ua_w_k: 6000.0,
            v_flow_max_m3_s: 40.0 / 60_000.0,
            pump_w: 40.0,
            circulation: 1.0,
            circulation_loss_w: 0.0,
            circulation_pump_w: 10.0,
        }
    }
}

/// A house does not draw more, m3 a day.
const MOST_DAILY_M3: f64 = 20.0;

impl DomesticHotWaterParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<DomesticHotWater, UnitError> {
        let out_of_range =
            |field, value, requirement| Err(UnitError::OutOfRange { field, value, requirement });
        if let Some(daily_m3) = self.daily_m3
            && positive("daily_m3", daily_m3)? > MOST_DAILY_M3
        {
            return out_of_range("daily_m3", daily_m3, "must be 20 or less: daily_l counts litres");
        }
        for (field, value) in [
            ("weekend_factor", self.weekend_factor),
            ("ua_w_k", self.ua_w_k),
            ("v_flow_max_m3_s", self.v_flow_max_m3_s),
        ] {
            positive(field, value)?;
        }
        for (field, value) in [
            ("tolerance_difference_k", self.tolerance_difference_k),
            ("pump_w", self.pump_w),
            ("circulation_loss_w", self.circulation_loss_w),
            ("circulation_pump_w", self.circulation_pump_w),
        ] {
            not_negative(field, value)?;
        }
        share("season_amplitude", self.season_amplitude)?;
        share("circulation", self.circulation)?;
        if self.weekend_factor > 5.0 {
            return out_of_range("weekend_factor", self.weekend_factor, "must be 5 or less");
        }
        if self.utc_offset_s.is_nan() || self.utc_offset_s.abs() > DAY_S {
            return out_of_range("utc_offset_s", self.utc_offset_s, "must lie within a day");
        }
        liquid(medium, "tap_set_k", self.tap_set_k)?;
        liquid(medium, "cold_k", self.cold_k - self.cold_amplitude_difference_k.abs())?;
        if self.tap_set_k <= self.cold_k + self.cold_amplitude_difference_k.abs() {
            return out_of_range("tap_set_k", self.tap_set_k, "must be above the cold water");
        }
        let draws = self.daily_m3.map(|daily_m3| {
            Draws::new(self.seed, daily_m3, self.weekend_factor, self.season_amplitude)
        });
        let capacity_j_m3_k = medium.density_kg_m3 * medium.heat_capacity_j_kg_k;
        Ok(DomesticHotWater {
            draws,
            exchanger: Exchanger {
                ua_w_k: self.ua_w_k,
                most_w_k: self.v_flow_max_m3_s * capacity_j_m3_k,
            },
            params: self.clone(),
            medium: *medium,
        })
    }
}
