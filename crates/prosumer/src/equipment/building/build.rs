//! A building as written becomes one that runs: ranges, areas, U-values, emission.

use super::Building;
use super::params::{BuildingParams, EmitterKind};
use super::sun::Sun;
use crate::building::comfort::{Comfort, DAY_S};
use crate::building::emitter::{Emitter, logarithmic_mean_k};
use crate::building::envelope::{Areas, Shape, UValues, insulated_w_m2_k};
use crate::building::house::{AIR_J_M3_K, House};
use crate::calendar::{DaysOff, day_of_date};
use crate::equipment::liquid;
use crate::thermal_unit::UnitError;
use anergy_core::medium::Medium;

/// Temperatures of air that can be meant, K: -60 to 60 degC.
const AIR_K: (f64, f64) = (213.15, 333.15);

fn within(
    field: &'static str,
    value: f64,
    (low, high): (f64, f64),
    requirement: &'static str,
) -> Result<(), UnitError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(UnitError::OutOfRange { field, value, requirement })
}

impl BuildingParams {
    fn check(&self) -> Result<(), UnitError> {
        let positive = (f64::MIN_POSITIVE, f64::MAX);
        for (field, value) in [
            ("living_area_m2", self.living_area_m2),
            ("floors", self.floors),
            ("clear_height_m", self.clear_height_m),
            ("air_j_m2_k", self.air_j_m2_k),
            ("inner_j_m2_k", self.inner_j_m2_k),
            ("heating_w_m2", self.heating_w_m2),
            ("cooling_w_m2_k", self.cooling_w_m2_k),
            ("v_flow_max_m3_s", self.v_flow_max_m3_s),
            ("thermostat_difference_k", self.thermostat_difference_k),
            ("wall_w_m2_k", self.wall_w_m2_k.unwrap_or(1.0)),
            ("ceiling_w_m2_k", self.ceiling_w_m2_k.unwrap_or(1.0)),
            ("floor_w_m2_k", self.floor_w_m2_k.unwrap_or(1.0)),
            ("window_w_m2_k", self.window_w_m2_k.unwrap_or(1.0)),
            ("emitter_capacity_j_k", self.emitter_capacity_j_k.unwrap_or(1.0)),
        ] {
            within(field, value, positive, "must be positive")?;
        }
        for (field, value) in [
            ("wall_insulation_m", self.wall_insulation_m),
            ("ceiling_insulation_m", self.ceiling_insulation_m),
            ("floor_insulation_m", self.floor_insulation_m),
            ("air_change_absent_1_s", self.air_change_absent_1_s),
            ("inhabitants", self.inhabitants),
            ("person_w", self.person_w),
            ("thermostat_reset_s", self.thermostat_reset_s),
        ] {
            within(field, value, (0.0, f64::MAX), "must not be negative")?;
        }
        for (field, value) in [
            ("window_share", self.window_share),
            ("window_g", self.window_g),
            ("window_shading", self.window_shading),
            ("wall_insulated_share", self.wall_insulated_share),
            ("ceiling_insulated_share", self.ceiling_insulated_share),
        ] {
            within(field, value, (0.0, 1.0), "must lie between 0 and 1")?;
        }
        for (field, value) in [
            ("night_from_s", self.night_from_s),
            ("night_until_s", self.night_until_s),
            ("night_off_from_s", self.night_off_from_s.unwrap_or(self.night_from_s)),
            ("night_off_until_s", self.night_off_until_s.unwrap_or(self.night_until_s)),
            ("start_time_s", self.start_time_s),
        ] {
            within(field, value, (0.0, DAY_S), "must lie between 0 and 24 h")?;
        }
        let given = |t_k: Option<f64>| t_k.unwrap_or(self.room_set_k);
        for (field, value) in [
            ("room_set_k", self.room_set_k),
            ("cooling_set_k", self.cooling_set_k),
            ("night_set_k", given(self.night_set_k)),
            ("absent_set_k", given(self.absent_set_k)),
            ("nominal_room_k", self.nominal_room_k),
            ("heating_limit_k", self.heating_limit_k),
            ("initial_living_k", self.initial_living_k),
            ("initial_roof_k", self.initial_roof_k),
            ("initial_cellar_k", self.initial_cellar_k),
            ("outdoor_k", self.outdoor_k),
            ("ground_k", self.ground_k),
        ] {
            within(field, value, AIR_K, "is no temperature of air or ground (-60 to 60 degC)")?;
        }
        within("utc_offset_s", self.utc_offset_s, (-DAY_S, DAY_S), "must lie within a day")?;
        within("azimuth_rad", self.azimuth_rad, (f64::MIN, f64::MAX), "must be finite")?;
        within(
            "air_change_present_1_s",
            self.air_change_present_1_s,
            (self.air_change_absent_1_s, f64::MAX),
            "must not be below air_change_absent_1_s",
        )?;
        within(
            "attached_buildings",
            f64::from(self.attached_buildings),
            (0.0, 2.0),
            "must be 0, 1 or 2",
        )?;
        within(
            "emitter_exponent",
            self.emitter_exponent.unwrap_or(1.0),
            (1.0, 2.0),
            "must lie between 1 and 2",
        )?;
        if self.cooling_set_k <= self.room_set_k {
            return Err(UnitError::OutOfRange {
                field: "cooling_set_k",
                value: self.cooling_set_k,
                requirement: "must be above room_set_k",
            });
        }
        if !self.heating && !self.cooling {
            let problem = "heating and cooling are both false: water passes nothing then; leave \
                           one of them out"
                .to_owned();
            return Err(UnitError::Fields { problem });
        }
        Ok(())
    }

    fn areas(&self) -> Result<Areas, UnitError> {
        let shape = Shape {
            living_m2: self.living_area_m2,
            floors: self.floors,
            height_m: self.clear_height_m,
            layout: self.layout,
            attached: self.attached_buildings,
            window_share: self.window_share,
            dormers: self.dormers,
        };
        let areas = shape.areas();
        if areas.wall_m2 <= 0.0 {
            return Err(UnitError::OutOfRange {
                field: "window_share",
                value: self.window_share,
                requirement: "leaves no wall between the windows: it is the area of the windows \
                              per living_area_m2",
            });
        }
        Ok(areas)
    }

    fn u_values(&self) -> UValues {
        let typical = self.construction.u_values();
        let wall = self.wall_w_m2_k.unwrap_or(typical.wall_w_m2_k);
        let ceiling = self.ceiling_w_m2_k.unwrap_or(typical.ceiling_w_m2_k);
        let floor = self.floor_w_m2_k.unwrap_or(typical.floor_w_m2_k);
        UValues {
            wall_w_m2_k: insulated_w_m2_k(wall, self.wall_insulation_m, self.wall_insulated_share),
            ceiling_w_m2_k: insulated_w_m2_k(
                ceiling,
                self.ceiling_insulation_m,
                self.ceiling_insulated_share,
            ),
            floor_w_m2_k: insulated_w_m2_k(floor, self.floor_insulation_m, 1.0),
            window_w_m2_k: self.window_w_m2_k.unwrap_or(typical.window_w_m2_k),
        }
    }

    fn emission(&self, medium: &Medium) -> Result<(Emitter, f64), UnitError> {
        let nominal_w = self.heating_w_m2 * self.living_area_m2;
        let floor = self.emitter == EmitterKind::Floor;
        let (supply_k, return_k, exponent, capacity_j_k, radiative) = if floor {
            (313.15, 303.15, 1.1, 40e3 * self.living_area_m2, 0.5)
        } else {
            (333.15, 318.15, 1.3, 60.0 * nominal_w, 0.3)
        };
        let supply_k = self.nominal_supply_k.unwrap_or(supply_k);
        let return_k = self.nominal_return_k.unwrap_or(return_k);
        liquid(medium, "nominal_supply_k", supply_k)?;
        if return_k.is_nan() || return_k <= self.nominal_room_k || return_k >= supply_k {
            return Err(UnitError::OutOfRange {
                field: "nominal_return_k",
                value: return_k,
                requirement: "must lie between nominal_room_k and nominal_supply_k",
            });
        }
        let room_k = self.nominal_room_k;
        let emitter = Emitter {
            nominal_w,
            nominal_excess_k: logarithmic_mean_k(supply_k - room_k, return_k - room_k),
            exponent: self.emitter_exponent.unwrap_or(exponent),
            capacity_j_k: self.emitter_capacity_j_k.unwrap_or(capacity_j_k),
            cooling_w_k: floor.then_some(self.cooling_w_m2_k * self.living_area_m2),
        };
        Ok((emitter, radiative))
    }

    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<Building, UnitError> {
        self.check()?;
        let (emitter, emitter_radiative) = self.emission(medium)?;
        let house = House {
            areas: self.areas()?,
            living_m2: self.living_area_m2,
            u: self.u_values(),
            air_j_m2_k: self.air_j_m2_k,
            inner_j_m2_k: self.inner_j_m2_k,
            exchange_1_s: self.air_change_absent_1_s,
            emitter_radiative,
        };
        let model = house.model().map_err(|_| UnitError::OutOfRange {
            field: "wall_w_m2_k",
            value: house.u.wall_w_m2_k,
            requirement: "is above the films of air alone (5.5 W/(m2 K) or so)",
        })?;
        let night_off_s = (
            self.night_off_from_s.unwrap_or(self.night_from_s),
            self.night_off_until_s.unwrap_or(self.night_until_s),
        );
        let holiday = |date: &String| {
            day_of_date(date).ok_or_else(|| UnitError::Fields {
                problem: format!(
                    "holidays: \"{date}\" is no date, write for example \"2024-12-25\""
                ),
            })
        };
        let by_calendar = self.night_off_from_s.or(self.night_off_until_s).is_some();
        if !by_calendar && !self.holidays.is_empty() {
            let problem =
                "holidays act on night_off_from_s and night_off_until_s: give one of them".into();
            return Err(UnitError::Fields { problem });
        }
        let holidays = self.holidays.iter().map(holiday).collect::<Result<_, _>>()?;
        let days_off = by_calendar.then_some(DaysOff { utc_offset_s: self.utc_offset_s, holidays });
        let more_1_s = self.air_change_present_1_s - self.air_change_absent_1_s;
        Ok(Building {
            model: Box::new(model),
            emitter,
            comfort: Comfort {
                night_k: self.night_set_k,
                nights_s: [(self.night_from_s, self.night_until_s), night_off_s],
                absent_k: self.absent_set_k,
                band_k: self.thermostat_difference_k,
                reset_s: self.thermostat_reset_s,
                heating_limit_k: self.heating_limit_k,
            },
            days_off,
            sun: Sun::new(&house.areas, self.azimuth_rad, self.window_g * self.window_shading),
            more_exchange_w_k: more_1_s * house.areas.living_m3 * AIR_J_M3_K,
            people_w: self.inhabitants * self.person_w,
            m_flow_max_kg_s: self.v_flow_max_m3_s * medium.density_kg_m3,
            heat_capacity_j_kg_k: medium.heat_capacity_j_kg_k,
            params: self.clone(),
        })
    }
}
