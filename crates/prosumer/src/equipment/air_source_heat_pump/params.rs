//! An air-source heat pump as written in a model file: every number has the value of the reference unit.

use super::{AirSourceHeatPump, DefrostRule};
use crate::compressor::{Compressor, Defrost};
use crate::efficiency_factor::EfficiencyFactor;
use crate::equipment::liquid;
use crate::heat_pump::{AuxHeater, FlowControl, Limits, map_of, start_table};
use crate::performance_map::params::MapChoice;
use crate::performance_map::reference::{ReferenceCooling, ReferenceHeating};
use crate::performance_map::{PerformanceMap, Stream};
use crate::thermal_unit::{UnitError, not_negative, positive, share};
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What of the reference map depends on the return temperature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReturnDependence {
    /// Both factors, as in the published model.
    Product,
    /// The factor of the modulation alone: the effect counts once.
    ModulationOnly,
}

/// An air-source heat pump as written in a model file; the defaults are those of the reference unit of 10 kW.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct AirSourceHeatPumpParams {
    /// Wanted speed as a share of the full one while nothing drives it; 0 is off.
    pub modulation: f64,
    /// 0 heating, 1 cooling, while nothing drives it.
    pub mode: f64,
    /// Wanted power of the electric heater as a share of its rated one while nothing drives it.
    pub aux_modulation: f64,
    /// 1 releases the unit, 0 keeps it off, while nothing drives it.
    pub enable: f64,
    /// Outdoor temperature while neither weather nor anything else drives it, K.
    pub t_outdoor_k: f64,
    /// Relative humidity of the air while neither weather nor anything else drives it, 0 to 1.
    pub relative_humidity: f64,
    /// Map of heating; the reference unit where none is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<MapChoice>,
    /// Map of cooling; without one a unit with a `map` only heats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cooling_map: Option<MapChoice>,
    /// Heat of the reference unit at air of 2 and water of 35 degC, W.
    pub heat_nominal_w: f64,
    /// COP of the reference unit there.
    pub cop_nominal: f64,
    /// The COP of the reference unit is capped here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cop_max: Option<f64>,
    /// What of the reference map depends on the return temperature.
    pub return_dependence: ReturnDependence,
    /// Cold of the reference unit at air of 35 and water of 18 degC, W.
    pub cold_nominal_w: f64,
    /// EER of the reference unit there.
    pub eer_nominal: f64,
    /// Factor on heat, cold and electricity: the size of the unit.
    pub size_factor: f64,
    /// Smallest speed as a share of the full one.
    pub modulation_min: f64,
    /// Time in which the speed would rise from nothing to full, s; 0 at once.
    pub speed_rise_s: f64,
    /// How the flow of the water is set.
    pub flow_control: FlowControl,
    /// Difference of supply and return with `constant_temperature_difference`, K.
    pub temperature_difference_k: f64,
    /// Flow with `constant_flow`, m3/s.
    pub v_flow_m3_s: f64,
    /// Heating stops where the water arrives colder, K.
    pub heating_return_min_k: f64,
    /// Heating stops where the water arrives warmer, K.
    pub heating_return_max_k: f64,
    /// Cooling stops where the water arrives colder, K.
    pub cooling_return_min_k: f64,
    /// Cooling stops where the water arrives warmer, K.
    pub cooling_return_max_k: f64,
    /// How far inside its limits the temperature must be to start again, K.
    pub restart_difference_k: f64,
    /// High-pressure cut-out: water that leaves the condenser warmer stops the unit, K.
    pub supply_max_k: f64,
    /// Heating stops where the air is colder, K.
    pub source_min_k: f64,
    /// Smallest time of a run, s.
    pub run_min_s: f64,
    /// Smallest time between a stop and the next start, s.
    pub off_min_s: f64,
    /// Start: times of its table, s, rising from 0.
    pub start_times_s: Vec<f64>,
    /// Start: heat at these times as a share of the steady one, negative where it is drawn from the water.
    pub start_heat: Vec<f64>,
    /// Start: electricity at these times as a share of the steady one.
    pub start_power: Vec<f64>,
    /// Time in which the flow rises after a start, s.
    pub flow_rise_s: f64,
    /// A start after a shorter pause is a warm one, s.
    pub warm_within_s: f64,
    /// Share of the times of the table in a warm start.
    pub warm_start_share: f64,
    /// Time in which the compressor stops, s.
    pub stop_s: f64,
    /// How long the pump runs after the command to stop, s.
    pub pump_overrun_s: f64,
    /// Whether the unit removes frost.
    pub defrost: bool,
    /// Air colder than this makes frost, K; warmer air melts it.
    pub frost_below_k: f64,
    /// Operation in such air of 80 % humidity until the frost is removed, s.
    pub frost_after_s: f64,
    /// Duration of a defrost, s.
    pub defrost_duration_s: f64,
    /// Heat taken from the water in a defrost at full speed, W; at least 60 % of it.
    pub defrost_heat_w: f64,
    /// Electricity in a defrost, W.
    pub defrost_electric_w: f64,
    /// Ramp back to the steady heat after a defrost, s.
    pub defrost_recovery_s: f64,
    /// Rated power of the electric heater behind the condenser, W; 0 for none.
    pub aux_rated_w: f64,
    /// Steps of the electric heater; 0 for any power.
    pub aux_steps: u8,
    /// Electricity while the unit is off, W.
    pub idle_w: f64,
    /// COP and EER over what the map says, at all loads.
    pub efficiency_factor: f64,
    /// The same at 20, 40 and 60 % of the load besides; 1 at full load. Empty: 1 everywhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub part_load_factor: Vec<f64>,
    /// Share of the electricity of the compressor that becomes heat of the refrigerant; the rest warms the room.
    pub heat_share: f64,
    /// Water in the unit and its pipes, mixed with what leaves, m3; 0 for none.
    pub content_m3: f64,
    /// false: the steady map at once, without start, speed limit, frost, pump overrun, least times and content.
    pub dynamics: bool,
}

impl Default for AirSourceHeatPumpParams {
    fn default() -> Self {
        Self {
            modulation: 0.0,
            mode: 0.0,
            aux_modulation: 0.0,
            enable: 1.0,
            t_outdoor_k: 275.15,
            relative_humidity: 0.8,
            map: None,
            cooling_map: None,
            heat_nominal_w: 5750.0,
            cop_nominal: 4.65,
            cop_max: None,
            return_dependence: ReturnDependence::Product,
            cold_nominal_w: 6010.0,
            eer_nominal: 5.92,
            size_factor: 1.0,
            modulation_min: 0.2,
            speed_rise_s: 40.0,
            flow_control: FlowControl::ConstantTemperatureDifference,
            temperature_difference_k: 5.0,
            v_flow_m3_s: 4.8e-4,
            heating_return_min_k: 288.15,
            heating_return_max_k: 341.15,
            cooling_return_min_k: 280.15,
            cooling_return_max_k: 303.15,
            restart_difference_k: 5.0,
            supply_max_k: 343.15,
            source_min_k: 248.15,
            run_min_s: 300.0,
            off_min_s: 300.0,
            start_times_s: vec![0.0, 30.0, 60.0, 120.0, 240.0, 420.0, 600.0],
            start_heat: vec![0.0, -0.25, 0.0, 0.35, 0.7, 0.95, 1.0],
            start_power: vec![0.02, 0.05, 0.3, 0.8, 1.1, 1.05, 1.0],
            flow_rise_s: 10.0,
            warm_within_s: 600.0,
            warm_start_share: 0.4,
            stop_s: 10.0,
            pump_overrun_s: 60.0,
            defrost: true,
            frost_below_k: 278.15,
            frost_after_s: 2700.0,
            defrost_duration_s: 300.0,
            defrost_heat_w: 5000.0,
            defrost_electric_w: 1200.0,
            defrost_recovery_s: 120.0,
            aux_rated_w: 9000.0,
            aux_steps: 3,
            efficiency_factor: 1.0,
            part_load_factor: Vec::new(),
            idle_w: 15.0,
            heat_share: 0.95,
            content_m3: 0.004,
            dynamics: true,
        }
    }
}

impl AirSourceHeatPumpParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<AirSourceHeatPump, UnitError> {
        for (field, value) in [
            ("modulation", self.modulation),
            ("mode", self.mode),
            ("aux_modulation", self.aux_modulation),
            ("enable", self.enable),
            ("relative_humidity", self.relative_humidity),
            ("modulation_min", self.modulation_min),
            ("heat_share", self.heat_share),
        ] {
            share(field, value)?;
        }
        for (field, value) in [
            ("heat_nominal_w", self.heat_nominal_w),
            ("cop_nominal", self.cop_nominal),
            ("cold_nominal_w", self.cold_nominal_w),
            ("eer_nominal", self.eer_nominal),
            ("size_factor", self.size_factor),
            ("temperature_difference_k", self.temperature_difference_k),
            ("v_flow_m3_s", self.v_flow_m3_s),
            ("t_outdoor_k", self.t_outdoor_k),
            ("warm_start_share", self.warm_start_share),
            ("frost_after_s", self.frost_after_s),
            ("defrost_duration_s", self.defrost_duration_s),
        ] {
            positive(field, value)?;
        }
        for (field, value) in [
            ("speed_rise_s", self.speed_rise_s),
            ("restart_difference_k", self.restart_difference_k),
            ("run_min_s", self.run_min_s),
            ("off_min_s", self.off_min_s),
            ("flow_rise_s", self.flow_rise_s),
            ("warm_within_s", self.warm_within_s),
            ("stop_s", self.stop_s),
            ("pump_overrun_s", self.pump_overrun_s),
            ("defrost_heat_w", self.defrost_heat_w),
            ("defrost_electric_w", self.defrost_electric_w),
            ("defrost_recovery_s", self.defrost_recovery_s),
            ("aux_rated_w", self.aux_rated_w),
            ("idle_w", self.idle_w),
            ("content_m3", self.content_m3),
        ] {
            not_negative(field, value)?;
        }
        if let Some(cop_max) = self.cop_max
            && (cop_max.is_nan() || cop_max < 1.0)
        {
            return Err(UnitError::OutOfRange {
                field: "cop_max",
                value: cop_max,
                requirement: "must be at least 1",
            });
        }
        let (heating, cooling) = self.maps()?;
        let modulation_min = self.modulation_min.max(heating.modulation_min());
        let compressor = Compressor {
            modulation_min,
            slew_per_s: if self.speed_rise_s > 0.0 { 1.0 / self.speed_rise_s } else { f64::MAX },
            start: start_table(&self.start_times_s, &self.start_heat, &self.start_power)?,
            flow_rise_s: self.flow_rise_s,
            warm_within_s: self.warm_within_s,
            warm_scale: self.warm_start_share,
            stop_s: self.stop_s,
            overrun_s: self.pump_overrun_s,
            run_min_s: self.run_min_s,
            off_min_s: self.off_min_s,
            defrost: self.defrost.then_some(Defrost {
                after_s: self.frost_after_s,
                duration_s: self.defrost_duration_s,
                heat_w: self.defrost_heat_w * self.size_factor,
                least_modulation: 0.6,
                electric_w: self.defrost_electric_w * self.size_factor,
                recovery_s: self.defrost_recovery_s,
            }),
            dynamics: self.dynamics,
        };
        let liquid = |field, t_k| liquid(medium, field, t_k);
        let capacity_w_k = self.v_flow_m3_s * medium.density_kg_m3 * medium.heat_capacity_j_kg_k;
        Ok(AirSourceHeatPump {
            heating,
            cooling,
            compressor,
            size: self.size_factor,
            water: match self.flow_control {
                FlowControl::ConstantTemperatureDifference => Stream::Difference {
                    difference_k: self.temperature_difference_k,
                    least_w_k: 0.0,
                    most_w_k: f64::INFINITY,
                },
                FlowControl::ConstantFlow => Stream::Flow(capacity_w_k / self.size_factor),
            },
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
                source_min_k: self.source_min_k,
            },
            frost: DefrostRule { below_k: self.frost_below_k },
            aux: AuxHeater { rated_w: self.aux_rated_w, steps: self.aux_steps },
            factor: EfficiencyFactor::new(self.efficiency_factor, &self.part_load_factor)?,
            idle_w: self.idle_w,
            heat_share: self.heat_share,
            content_kg: if self.dynamics { self.content_m3 * medium.density_kg_m3 } else { 0.0 },
            initial: [
                self.modulation,
                self.mode,
                self.aux_modulation,
                self.enable,
                self.t_outdoor_k,
                self.relative_humidity,
            ],
            medium: *medium,
        })
    }

    /// Maps of heating and, where it can, of cooling.
    fn maps(&self) -> Result<(PerformanceMap, Option<PerformanceMap>), UnitError> {
        let heating = match &self.map {
            Some(choice) => map_of("map", choice, false)?,
            None => PerformanceMap::Reference(ReferenceHeating {
                nominal_w: self.heat_nominal_w,
                cop: self.cop_nominal,
                cop_max: self.cop_max.unwrap_or(f64::INFINITY),
                return_counts_twice: self.return_dependence == ReturnDependence::Product,
            }),
        };
        let cooling = match (&self.cooling_map, &self.map) {
            (Some(choice), _) => Some(map_of("cooling_map", choice, true)?),
            (None, Some(_)) => None,
            (None, None) => Some(PerformanceMap::ReferenceCooling(ReferenceCooling {
                nominal_w: self.cold_nominal_w,
                eer: self.eer_nominal,
            })),
        };
        Ok((heating, cooling))
    }
}
