//! A booster heat pump, alone or as a transfer station with a plate exchanger and a rod, as written in a model file.

use super::BoosterHeatPump;
use crate::compressor::{Compressor, StartPoint};
use crate::equipment::liquid;
use crate::heat_pump::{AuxHeater, FlowControl, Limits, map_of};
use crate::performance_map::carnot::CarnotShare;
use crate::performance_map::params::MapChoice;
use crate::performance_map::{PerformanceMap, Stream};
use crate::thermal_unit::{UnitError, not_negative, positive, share};
use anergy_core::medium::Medium;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A booster heat pump as written in a model file; the defaults are those of the laboratory's (19 kW heat, 14 kW
/// cold).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BoosterHeatPumpParams {
    /// Wanted speed as a share of the full one while nothing drives it; 0 is off.
    pub modulation: f64,
    /// 0 heating, 1 cooling, while nothing drives it.
    pub mode: f64,
    /// Wanted power of the rod as a share of its rated one while nothing drives it.
    pub aux_modulation: f64,
    /// 1 releases the unit, 0 keeps it off, while nothing drives it.
    pub enable: f64,
    /// Outdoor temperature while neither weather nor anything else drives it, K: only maps of hplib ask for it.
    pub t_outdoor_k: f64,
    /// Map of heating; a share of Carnot where none is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<MapChoice>,
    /// Map of cooling; without one a unit with a `map` only heats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cooling_map: Option<MapChoice>,
    /// Heat at full speed and grid water of 10 degC, W.
    pub rated_heat_w: f64,
    /// Cold at full speed, W.
    pub rated_cold_w: f64,
    /// Share of Carnot at full speed.
    pub carnot_share: f64,
    /// How much the share gains towards no speed, relative.
    pub part_load_gain: f64,
    /// Water to refrigerant on both sides, K, as a difference.
    pub approach_difference_k: f64,
    /// Least difference of condensing and evaporating temperature, K.
    pub lift_min_difference_k: f64,
    /// Change of the heat with the temperature of the grid water, 1/K, relative: within 0.6 to 1.3.
    pub heat_slope: f64,
    /// COP and EER are capped here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cop_max: Option<f64>,
    /// Smallest speed as a share of the full one.
    pub modulation_min: f64,
    /// Time in which the speed would rise from nothing to full, s; 0 at once.
    pub speed_rise_s: f64,
    /// Ramp of heat and electricity after a start, s.
    pub start_s: f64,
    /// Time in which the flows rise after a start, s.
    pub flow_rise_s: f64,
    /// Time in which the compressor stops, s.
    pub stop_s: f64,
    /// How long the pumps run after the command to stop, s.
    pub pump_overrun_s: f64,
    /// Smallest time of a run, s.
    pub run_min_s: f64,
    /// Smallest time between a stop and the next start, s.
    pub off_min_s: f64,
    /// How the flow of the grid is set.
    pub grid_flow_control: FlowControl,
    /// Change of the grid water with `constant_temperature_difference`, K.
    pub grid_temperature_difference_k: f64,
    /// Smallest flow of the grid with `constant_temperature_difference`, m3/s.
    pub grid_v_flow_min_m3_s: f64,
    /// Largest flow of the grid with `constant_temperature_difference`, m3/s.
    pub grid_v_flow_max_m3_s: f64,
    /// Flow of the grid with `constant_flow`, m3/s.
    pub grid_v_flow_m3_s: f64,
    /// The grid water is not cooled below this, K: the speed is reduced first.
    pub grid_coldest_k: f64,
    /// How the flow of the house is set.
    pub house_flow_control: FlowControl,
    /// Difference of supply and return of the house with `constant_temperature_difference`, K.
    pub house_temperature_difference_k: f64,
    /// Flow of the house with `constant_flow`, and through the plate exchanger, m3/s.
    pub house_v_flow_m3_s: f64,
    /// Whether the grid water flows from the cold to the hot line while the house is cooled: true alone, false in a
    /// transfer station.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reversed_for_cold: Option<bool>,
    /// Heating stops where the water of the house arrives colder, K.
    pub heating_return_min_k: f64,
    /// Heating stops where the water of the house arrives warmer, K.
    pub heating_return_max_k: f64,
    /// Cooling stops where the water of the house arrives colder, K.
    pub cooling_return_min_k: f64,
    /// Cooling stops where the water of the house arrives warmer, K.
    pub cooling_return_max_k: f64,
    /// How far inside its limits the temperature must be to start again, K.
    pub restart_difference_k: f64,
    /// High-pressure cut-out: water that leaves the condenser warmer stops the unit, K.
    pub supply_max_k: f64,
    /// Conductance of a plate exchanger in parallel, W/K, 0 for none: 0 alone, 3000 in a transfer station.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exchanger_ua_w_k: Option<f64>,
    /// The exchanger heats where the grid is warmer than the return of the house by more than this, K; it cools where
    /// the grid is colder by more than this.
    pub exchanger_approach_difference_k: f64,
    /// Rated power of the electric rod behind both, W, 0 for none: 0 alone, 6000 in a transfer station.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aux_rated_w: Option<f64>,
    /// Steps of the rod; 0 for any power.
    pub aux_steps: u8,
    /// Electricity while the unit is off, W.
    pub idle_w: f64,
    /// Share of the electricity of the compressor that becomes heat of the refrigerant; the rest warms the room.
    pub heat_share: f64,
    /// false: the steady map at once, without start, speed limit, pump overrun and least times.
    pub dynamics: bool,
}

impl Default for BoosterHeatPumpParams {
    fn default() -> Self {
        Self {
            modulation: 0.0,
            mode: 0.0,
            aux_modulation: 0.0,
            enable: 1.0,
            t_outdoor_k: 275.15,
            map: None,
            cooling_map: None,
            rated_heat_w: 19_000.0,
            rated_cold_w: 14_000.0,
            carnot_share: 0.5,
            part_load_gain: 0.12,
            approach_difference_k: 3.0,
            lift_min_difference_k: 10.0,
            heat_slope: 0.025,
            cop_max: None,
            modulation_min: 0.25,
            speed_rise_s: 40.0,
            start_s: 120.0,
            flow_rise_s: 10.0,
            stop_s: 10.0,
            pump_overrun_s: 60.0,
            run_min_s: 300.0,
            off_min_s: 300.0,
            grid_flow_control: FlowControl::ConstantTemperatureDifference,
            grid_temperature_difference_k: 5.0,
            grid_v_flow_min_m3_s: 2.0 / 60_000.0,
            grid_v_flow_max_m3_s: 25.0 / 60_000.0,
            grid_v_flow_m3_s: 12.0 / 60_000.0,
            grid_coldest_k: 277.15,
            house_flow_control: FlowControl::ConstantTemperatureDifference,
            house_temperature_difference_k: 5.0,
            house_v_flow_m3_s: 30.0 / 60_000.0,
            reversed_for_cold: None,
            heating_return_min_k: 278.15,
            heating_return_max_k: 338.15,
            cooling_return_min_k: 279.15,
            cooling_return_max_k: 303.15,
            restart_difference_k: 5.0,
            supply_max_k: 343.15,
            exchanger_ua_w_k: None,
            exchanger_approach_difference_k: 2.0,
            aux_rated_w: None,
            aux_steps: 0,
            idle_w: 15.0,
            heat_share: 0.95,
            dynamics: true,
        }
    }
}

/// What a heat pump has beside it where the file does not say it.
struct Beside {
    exchanger_ua_w_k: f64,
    aux_rated_w: f64,
    reversed_for_cold: bool,
}

/// Nothing.
const ALONE: Beside = Beside { exchanger_ua_w_k: 0.0, aux_rated_w: 0.0, reversed_for_cold: true };
/// The transfer station of the laboratory.
const STATION: Beside =
    Beside { exchanger_ua_w_k: 3000.0, aux_rated_w: 6000.0, reversed_for_cold: false };

/// A booster heat pump with plate exchanger and rod as written in a model file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct BoosterTransferStationParams(pub BoosterHeatPumpParams);

impl JsonSchema for BoosterTransferStationParams {
    fn schema_name() -> Cow<'static, str> {
        "BoosterTransferStationParams".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        BoosterHeatPumpParams::json_schema(generator)
    }
}

impl BoosterTransferStationParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<BoosterHeatPump, UnitError> {
        self.0.build_beside(&STATION, medium)
    }
}

impl BoosterHeatPumpParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<BoosterHeatPump, UnitError> {
        self.build_beside(&ALONE, medium)
    }

    fn build_beside(&self, beside: &Beside, medium: &Medium) -> Result<BoosterHeatPump, UnitError> {
        let exchanger_ua_w_k = self.exchanger_ua_w_k.unwrap_or(beside.exchanger_ua_w_k);
        let aux_rated_w = self.aux_rated_w.unwrap_or(beside.aux_rated_w);
        for (field, value) in [
            ("modulation", self.modulation),
            ("mode", self.mode),
            ("aux_modulation", self.aux_modulation),
            ("enable", self.enable),
            ("carnot_share", self.carnot_share),
            ("modulation_min", self.modulation_min),
            ("heat_share", self.heat_share),
        ] {
            share(field, value)?;
        }
        for (field, value) in [
            ("rated_heat_w", self.rated_heat_w),
            ("rated_cold_w", self.rated_cold_w),
            ("carnot_share", self.carnot_share),
            ("lift_min_difference_k", self.lift_min_difference_k),
            ("t_outdoor_k", self.t_outdoor_k),
            ("grid_temperature_difference_k", self.grid_temperature_difference_k),
            ("grid_v_flow_max_m3_s", self.grid_v_flow_max_m3_s),
            ("grid_v_flow_m3_s", self.grid_v_flow_m3_s),
            ("house_temperature_difference_k", self.house_temperature_difference_k),
            ("house_v_flow_m3_s", self.house_v_flow_m3_s),
        ] {
            positive(field, value)?;
        }
        for (field, value) in [
            ("part_load_gain", self.part_load_gain),
            ("approach_difference_k", self.approach_difference_k),
            ("heat_slope", self.heat_slope),
            ("speed_rise_s", self.speed_rise_s),
            ("start_s", self.start_s),
            ("flow_rise_s", self.flow_rise_s),
            ("stop_s", self.stop_s),
            ("pump_overrun_s", self.pump_overrun_s),
            ("run_min_s", self.run_min_s),
            ("off_min_s", self.off_min_s),
            ("grid_v_flow_min_m3_s", self.grid_v_flow_min_m3_s),
            ("restart_difference_k", self.restart_difference_k),
            ("exchanger_ua_w_k", exchanger_ua_w_k),
            ("exchanger_approach_difference_k", self.exchanger_approach_difference_k),
            ("aux_rated_w", aux_rated_w),
            ("idle_w", self.idle_w),
        ] {
            not_negative(field, value)?;
        }
        let out_of_range =
            |field, value, requirement| Err(UnitError::OutOfRange { field, value, requirement });
        if let Some(cop_max) = self.cop_max
            && (cop_max.is_nan() || cop_max < 1.0)
        {
            return out_of_range("cop_max", cop_max, "must be at least 1");
        }
        if self.grid_v_flow_min_m3_s > self.grid_v_flow_max_m3_s {
            let requirement = "must not be larger than grid_v_flow_max_m3_s";
            return out_of_range("grid_v_flow_min_m3_s", self.grid_v_flow_min_m3_s, requirement);
        }
        let (heating, cooling) = self.maps()?;
        let liquid = |field, t_k| liquid(medium, field, t_k);
        let capacity_w_k =
            |v_flow_m3_s: f64| v_flow_m3_s * medium.density_kg_m3 * medium.heat_capacity_j_kg_k;
        let ramp = |time_s, share| StartPoint { time_s, heat: share, power: share };
        Ok(BoosterHeatPump {
            compressor: Compressor {
                modulation_min: self.modulation_min.max(heating.modulation_min()),
                slew_per_s: if self.speed_rise_s > 0.0 {
                    1.0 / self.speed_rise_s
                } else {
                    f64::MAX
                },
                start: match self.start_s {
                    0.0 => Vec::new(),
                    start_s => vec![ramp(0.0, 0.0), ramp(start_s, 1.0)],
                },
                flow_rise_s: self.flow_rise_s,
                warm_within_s: 0.0,
                warm_scale: 1.0,
                stop_s: self.stop_s,
                overrun_s: self.pump_overrun_s,
                run_min_s: self.run_min_s,
                off_min_s: self.off_min_s,
                defrost: None,
                dynamics: self.dynamics,
            },
            heating,
            cooling,
            grid: match self.grid_flow_control {
                FlowControl::ConstantTemperatureDifference => Stream::Difference {
                    difference_k: self.grid_temperature_difference_k,
                    least_w_k: capacity_w_k(self.grid_v_flow_min_m3_s),
                    most_w_k: capacity_w_k(self.grid_v_flow_max_m3_s),
                },
                FlowControl::ConstantFlow => Stream::Flow(capacity_w_k(self.grid_v_flow_m3_s)),
            },
            house: match self.house_flow_control {
                FlowControl::ConstantTemperatureDifference => Stream::Difference {
                    difference_k: self.house_temperature_difference_k,
                    least_w_k: 0.0,
                    most_w_k: f64::INFINITY,
                },
                FlowControl::ConstantFlow => Stream::Flow(capacity_w_k(self.house_v_flow_m3_s)),
            },
            house_w_k: capacity_w_k(self.house_v_flow_m3_s),
            coldest_k: liquid("grid_coldest_k", self.grid_coldest_k)?,
            reversed_for_cold: self.reversed_for_cold.unwrap_or(beside.reversed_for_cold),
            limits: Limits {
                heating_k: (
                    liquid("heating_return_min_k", self.heating_return_min_k)?,
                    liquid("heating_return_max_k", self.heating_return_max_k)?,
                ),
                cooling_k: (
                    liquid("cooling_return_min_k", self.cooling_return_min_k)?,
                    liquid("cooling_return_max_k", self.cooling_return_max_k)?,
                ),
                restart_k: self.restart_difference_k,
                supply_max_k: liquid("supply_max_k", self.supply_max_k)?,
                source_min_k: self.grid_coldest_k + super::plan::LEAST_DROP_K,
            },
            exchanger_ua_w_k,
            exchanger_approach_k: self.exchanger_approach_difference_k,
            aux: AuxHeater { rated_w: aux_rated_w, steps: self.aux_steps },
            idle_w: self.idle_w,
            heat_share: self.heat_share,
            initial: [
                self.modulation,
                self.mode,
                self.aux_modulation,
                self.enable,
                self.t_outdoor_k,
            ],
            medium: *medium,
        })
    }

    /// Maps of heating and, where it can, of cooling.
    fn maps(&self) -> Result<(PerformanceMap, Option<PerformanceMap>), UnitError> {
        let carnot = |cooling| {
            PerformanceMap::Carnot(CarnotShare {
                cooling,
                rated_w: if cooling { self.rated_cold_w } else { self.rated_heat_w },
                share: self.carnot_share,
                part_load_gain: self.part_load_gain,
                approach_k: self.approach_difference_k,
                lift_min_k: self.lift_min_difference_k,
                slope_per_k: if cooling { 0.0 } else { self.heat_slope },
                ratio_max: self.cop_max.unwrap_or(f64::INFINITY),
            })
        };
        let heating = match &self.map {
            Some(choice) => map_of("map", choice, false)?,
            None => carnot(false),
        };
        let cooling = match (&self.cooling_map, &self.map) {
            (Some(choice), _) => Some(map_of("cooling_map", choice, true)?),
            (None, Some(_)) => None,
            (None, None) => Some(carnot(true)),
        };
        Ok((heating, cooling))
    }
}
