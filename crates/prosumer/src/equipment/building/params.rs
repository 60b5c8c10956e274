//! A building as written in a model file.

use crate::building::envelope::{Construction, Layout};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What gives heat to the rooms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EmitterKind {
    /// 60/45 degC, exponent 1.3, 60 kJ/K per kW, 30 % radiation.
    Radiator,
    /// 40/30 degC, exponent 1.1, 40 kJ/(m2 K), 50 % radiation; can cool.
    #[default]
    Floor,
}

/// A house of three zones with its heat emission and thermostats.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BuildingParams {
    /// Heated area, m2.
    pub living_area_m2: f64,
    /// Heated floors; 1.5 for half an attic.
    pub floors: f64,
    /// Clear height of a floor, m.
    pub clear_height_m: f64,
    /// When it was built: sets the U-values.
    pub construction: Construction,
    /// Shape of the footprint.
    pub layout: Layout,
    /// Buildings attached to its short sides: 0, 1 or 2.
    pub attached_buildings: u32,
    /// Windows per heated area.
    pub window_share: f64,
    /// Share of the sun on the windows that comes in: glass.
    pub window_g: f64,
    /// Share of it that frames and shades leave.
    pub window_shading: f64,
    /// Whether the roof has dormers.
    pub dormers: bool,
    /// Where the main front looks, from south, west positive, rad.
    pub azimuth_rad: f64,
    /// Insulation added to the walls (0.035 W/(m K)), m.
    pub wall_insulation_m: f64,
    /// Share of the walls that has it.
    pub wall_insulated_share: f64,
    /// Insulation added to the top ceiling, m.
    pub ceiling_insulation_m: f64,
    /// Share of the top ceiling that has it.
    pub ceiling_insulated_share: f64,
    /// Insulation added to the floor above the cellar, m.
    pub floor_insulation_m: f64,
    /// U-value of the walls instead of that of the construction, W/(m2 K).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall_w_m2_k: Option<f64>,
    /// U-value of the top ceiling instead of that of the construction, W/(m2 K).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ceiling_w_m2_k: Option<f64>,
    /// U-value of the floor above the cellar instead of that of the construction, W/(m2 K).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_w_m2_k: Option<f64>,
    /// U-value of the windows instead of that of the construction, W/(m2 K).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_w_m2_k: Option<f64>,
    /// Heat capacity of air and furniture per heated area, J/(m2 K).
    pub air_j_m2_k: f64,
    /// Heat capacity of inner walls per heated area, J/(m2 K).
    pub inner_j_m2_k: f64,
    /// Air changes while nobody is there, 1/s.
    pub air_change_absent_1_s: f64,
    /// Air changes while everybody is there, 1/s.
    pub air_change_present_1_s: f64,
    /// People who live there.
    pub inhabitants: f64,
    /// Heat of a person who is there with what it uses, W.
    pub person_w: f64,
    /// What gives heat to the rooms.
    pub emitter: EmitterKind,
    /// Nominal heat of the emitter per heated area, W/m2.
    pub heating_w_m2: f64,
    /// Nominal supply temperature, K; default by the emitter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nominal_supply_k: Option<f64>,
    /// Nominal return temperature, K; default by the emitter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nominal_return_k: Option<f64>,
    /// Room temperature of the nominal point, K.
    pub nominal_room_k: f64,
    /// Exponent of the emitter; default by the emitter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emitter_exponent: Option<f64>,
    /// Heat capacity of the emitter, J/K; default by the emitter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emitter_capacity_j_k: Option<f64>,
    /// Whether it has the port `heating`.
    pub heating: bool,
    /// Whether it has the port `cooling`: cold water through the same emitter.
    pub cooling: bool,
    /// Emission of a floor that is colder than the room, per heated area, W/(m2 K).
    pub cooling_w_m2_k: f64,
    /// Largest flow through the emitter, m3/s.
    pub v_flow_max_m3_s: f64,
    /// Set point of heating while nothing drives it, K.
    pub room_set_k: f64,
    /// Set point of cooling while nothing drives it, K.
    pub cooling_set_k: f64,
    /// Difference of room temperatures between thermostat shut and open, K.
    pub thermostat_difference_k: f64,
    /// Reset time of the thermostats, s; 0: proportional only.
    pub thermostat_reset_s: f64,
    /// Set point that is not exceeded at night, K; without it there is no night reduction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub night_set_k: Option<f64>,
    /// When the night begins, s after midnight.
    pub night_from_s: f64,
    /// When the night ends, s after midnight.
    pub night_until_s: f64,
    /// When the night of Saturdays, Sundays and holidays begins, s after midnight. With it or `night_off_until_s` the days and
    /// the time of day are those of the calendar: `start` of the run and `utc_offset_s`; a night is that of the day it is in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub night_off_from_s: Option<f64>,
    /// When the night of these days ends, s after midnight.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub night_off_until_s: Option<f64>,
    /// Holidays of that calendar, `"2024-12-25"`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub holidays: Vec<String>,
    /// Local clock of that calendar ahead of the `start` of the run (UTC), s; no daylight saving time.
    pub utc_offset_s: f64,
    /// Time of day at which the run starts, s after midnight.
    pub start_time_s: f64,
    /// Set point while nobody is there, K; without it the set point does not follow the presence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub absent_set_k: Option<f64>,
    /// Heating season below this running mean of the outdoor temperature, K.
    pub heating_limit_k: f64,
    /// Temperature of the living area at the start, K.
    pub initial_living_k: f64,
    /// Temperature of the roof space at the start, K.
    pub initial_roof_k: f64,
    /// Temperature of the cellar at the start, K.
    pub initial_cellar_k: f64,
    /// Outdoor temperature while nothing drives it, K.
    pub outdoor_k: f64,
    /// Temperature of the ground while nothing drives it, K.
    pub ground_k: f64,
}

impl Default for BuildingParams {
    fn default() -> Self {
        Self {
            living_area_m2: 300.0,
            floors: 2.0,
            clear_height_m: 2.6,
            construction: Construction::default(),
            layout: Layout::default(),
            attached_buildings: 0,
            window_share: 0.15,
            window_g: 0.6,
            window_shading: 0.7,
            dormers: false,
            azimuth_rad: 0.0,
            wall_insulation_m: 0.0,
            wall_insulated_share: 1.0,
            ceiling_insulation_m: 0.0,
            ceiling_insulated_share: 1.0,
            floor_insulation_m: 0.0,
            wall_w_m2_k: None,
            ceiling_w_m2_k: None,
            floor_w_m2_k: None,
            window_w_m2_k: None,
            air_j_m2_k: 216e3,
            inner_j_m2_k: 324e3,
            air_change_absent_1_s: 0.3 / 3600.0,
            air_change_present_1_s: 0.6 / 3600.0,
            inhabitants: 6.0,
            person_w: 110.0,
            emitter: EmitterKind::default(),
            heating_w_m2: 15.0,
            nominal_supply_k: None,
            nominal_return_k: None,
            nominal_room_k: 294.15,
            emitter_exponent: None,
            emitter_capacity_j_k: None,
            heating: true,
            cooling: false,
            cooling_w_m2_k: 5.5,
            v_flow_max_m3_s: 2.5e-4,
            room_set_k: 294.15,
            cooling_set_k: 296.15,
            thermostat_difference_k: 1.0,
            thermostat_reset_s: 0.0,
            night_set_k: None,
            night_from_s: 82_800.0,
            night_until_s: 21_600.0,
            night_off_from_s: None,
            night_off_until_s: None,
            holidays: Vec::new(),
            utc_offset_s: 3600.0,
            start_time_s: 0.0,
            absent_set_k: None,
            heating_limit_k: 287.15,
            initial_living_k: 294.15,
            initial_roof_k: 274.65,
            initial_cellar_k: 280.15,
            outdoor_k: 278.15,
            ground_k: 283.15,
        }
    }
}
