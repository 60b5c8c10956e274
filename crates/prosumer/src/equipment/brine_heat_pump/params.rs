//! A brine heat pump as written in a model file; the defaults are those of the reference unit of 10.8 kW.

use super::BrineHeatPump;
use crate::equipment::air_source_heat_pump::AirSourceHeatPumpParams;
use crate::ground_source::{Ground, GroundSource};
use crate::heat_pump::{FlowControl, map_of};
use crate::performance_map::brine::BrineFit;
use crate::performance_map::params::MapChoice;
use crate::performance_map::{PerformanceMap, Stream};
use crate::thermal_unit::{UnitError, not_negative, positive, share};
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Heat of the unit whose map this is, W.
const MEASURED_W: f64 = 10_800.0;
/// Temperatures of the ground that can be meant, K.
const GROUND_K: (f64, f64) = (253.15, 323.15);

/// What a brine heat pump takes its heat from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BrineSource {
    /// Boreholes.
    #[default]
    Boreholes,
    /// Pipes laid flat in the ground.
    Pipes,
    /// Brine of the temperature `ground_k`, whatever is taken.
    Given,
}

/// A brine heat pump as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BrineHeatPumpParams {
    /// Above 0 the unit runs, while nothing drives it.
    pub modulation: f64,
    /// Wanted power of the electric heater as a share of its rated one while nothing drives it.
    pub aux_modulation: f64,
    /// 1 releases the unit, 0 keeps it off, while nothing drives it.
    pub enable: f64,
    /// Map of heating; the reference unit where none is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<MapChoice>,
    /// Heat of the reference unit at brine of 0 and water of 35 degC, W: its size.
    pub heat_nominal_w: f64,
    /// COP of the reference unit there.
    pub cop_nominal: f64,
    /// What it takes its heat from.
    pub source: BrineSource,
    /// Undisturbed ground, or the brine itself, while nothing drives it, K; with `pipes` and `given` it follows the
    /// ground of the weather.
    pub ground_k: f64,
    /// Length of all boreholes or pipes, m.
    pub length_m: f64,
    /// Radius of a borehole, or of a pipe, m; 0.075 and 0.016 where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius_m: Option<f64>,
    /// Resistance from the brine to the wall of the hole or pipe, K m/W.
    pub wall_resistance_k_m_w: f64,
    /// Distance between pipes, m.
    pub spacing_m: f64,
    /// Depth of pipes, m.
    pub depth_m: f64,
    /// Conductivity of the ground, W/(m K).
    pub conductivity_w_m_k: f64,
    /// Heat capacity of the ground, J/(m3 K).
    pub capacity_j_m3_k: f64,
    /// By how much the ground warms the brine, K.
    pub brine_difference_k: f64,
    /// The unit stops where the brine arrives colder, K.
    pub source_min_k: f64,
    /// How the flow of the water is set.
    pub flow_control: FlowControl,
    /// Difference of supply and return with `constant_temperature_difference`, K.
    pub temperature_difference_k: f64,
    /// Flow with `constant_flow`, m3/s.
    pub v_flow_m3_s: f64,
    /// The unit stops where the water arrives colder, K.
    pub return_min_k: f64,
    /// The unit stops where the water arrives warmer, K.
    pub return_max_k: f64,
    /// How far inside its limits the temperature must be to start again, K.
    pub restart_difference_k: f64,
    /// High-pressure cut-out: water that leaves the condenser warmer stops the unit, K.
    pub supply_max_k: f64,
    /// Smallest time of a run, s.
    pub run_min_s: f64,
    /// Smallest time between a stop and the next start, s.
    pub off_min_s: f64,
    /// Length of a start, s.
    pub start_s: f64,
    /// How long the pump runs after the command to stop, s.
    pub pump_overrun_s: f64,
    /// Rated power of the electric heater behind the condenser, W; 0 for none.
    pub aux_rated_w: f64,
    /// Steps of the electric heater; 0 for any power.
    pub aux_steps: u8,
    /// Electricity while the unit is off, W.
    pub idle_w: f64,
    /// Share of the electricity of the compressor that becomes heat of the refrigerant; the rest warms the room.
    pub heat_share: f64,
    /// false: the steady map at once, without start, pump overrun, least times and content.
    pub dynamics: bool,
}

impl Default for BrineHeatPumpParams {
    fn default() -> Self {
        Self {
            modulation: 0.0,
            aux_modulation: 0.0,
            enable: 1.0,
            map: None,
            heat_nominal_w: MEASURED_W,
            cop_nominal: 4.7,
            source: BrineSource::Boreholes,
            ground_k: 283.15,
            length_m: 200.0,
            radius_m: None,
            wall_resistance_k_m_w: 0.1,
            spacing_m: 0.6,
            depth_m: 1.5,
            conductivity_w_m_k: 2.0,
            capacity_j_m3_k: 2.2e6,
            brine_difference_k: 5.0,
            source_min_k: 268.15,
            flow_control: FlowControl::ConstantTemperatureDifference,
            temperature_difference_k: 5.0,
            v_flow_m3_s: 30.0 / 60_000.0,
            return_min_k: 293.15,
            return_max_k: 341.15,
            restart_difference_k: 2.0,
            supply_max_k: 343.15,
            run_min_s: 300.0,
            off_min_s: 300.0,
            start_s: 300.0,
            pump_overrun_s: 80.0,
            aux_rated_w: 6000.0,
            aux_steps: 3,
            idle_w: 15.0,
            heat_share: 0.95,
            dynamics: true,
        }
    }
}

impl BrineHeatPumpParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<BrineHeatPump, UnitError> {
        positive("heat_nominal_w", self.heat_nominal_w)?;
        positive("cop_nominal", self.cop_nominal)?;
        not_negative("brine_difference_k", self.brine_difference_k)?;
        positive("start_s", self.start_s)?;
        share("heat_share", self.heat_share)?;
        if !(GROUND_K.0..=GROUND_K.1).contains(&self.ground_k) {
            let (value, requirement) =
                (self.ground_k, "is no temperature of ground (-20 to 50 degC)");
            return Err(UnitError::OutOfRange { field: "ground_k", value, requirement });
        }
        let size = if self.map.is_some() { 1.0 } else { self.heat_nominal_w / MEASURED_W };
        let map = match &self.map {
            Some(choice) => map_of("map", choice, false)?,
            None => {
                PerformanceMap::Brine(BrineFit { nominal_w: MEASURED_W, cop: self.cop_nominal })
            }
        };
        let defaults = AirSourceHeatPumpParams::default();
        let longest_s = defaults.start_times_s.last().copied().unwrap_or(1.0);
        let stretch = self.start_s / longest_s;
        let inner = AirSourceHeatPumpParams {
            modulation: self.modulation,
            aux_modulation: self.aux_modulation,
            enable: self.enable,
            size_factor: size,
            modulation_min: 1.0,
            flow_control: self.flow_control,
            temperature_difference_k: self.temperature_difference_k,
            v_flow_m3_s: self.v_flow_m3_s,
            heating_return_min_k: self.return_min_k,
            heating_return_max_k: self.return_max_k,
            restart_difference_k: self.restart_difference_k,
            supply_max_k: self.supply_max_k,
            source_min_k: self.source_min_k,
            run_min_s: self.run_min_s,
            off_min_s: self.off_min_s,
            start_times_s: defaults.start_times_s.iter().map(|t_s| stretch * t_s).collect(),
            pump_overrun_s: self.pump_overrun_s,
            defrost: false,
            aux_rated_w: self.aux_rated_w,
            aux_steps: self.aux_steps,
            idle_w: self.idle_w,
            heat_share: self.heat_share,
            dynamics: self.dynamics,
            ..defaults
        };
        // The words of this file for what the other one calls otherwise.
        let inner = inner.build(medium).map_err(|error| match error {
            UnitError::OutOfRange { field, value, requirement } => {
                UnitError::OutOfRange { field: own_name(field), value, requirement }
            }
            UnitError::NotLiquid { field, value, what, min_degc, max_degc } => {
                UnitError::NotLiquid { field: own_name(field), value, what, min_degc, max_degc }
            }
            other => other,
        })?;
        let capacity_w_k = self.v_flow_m3_s * medium.density_kg_m3 * medium.heat_capacity_j_kg_k;
        Ok(BrineHeatPump {
            inner: inner.with_map(map.clone()),
            map,
            useful: match self.flow_control {
                FlowControl::ConstantTemperatureDifference => Stream::Difference {
                    difference_k: self.temperature_difference_k,
                    least_w_k: 0.0,
                    most_w_k: f64::INFINITY,
                },
                FlowControl::ConstantFlow => Stream::Flow(capacity_w_k / size),
            },
            size,
            heat_share: self.heat_share,
            ground: self.ground()?,
            seasonal: self.source != BrineSource::Boreholes,
            warmed_k: self.brine_difference_k,
            initial: [self.modulation, self.aux_modulation, self.enable, self.ground_k],
        })
    }

    fn ground(&self) -> Result<Option<GroundSource>, UnitError> {
        let holes = self.source == BrineSource::Boreholes;
        let radius_m = self.radius_m.unwrap_or(if holes { 0.075 } else { 0.016 });
        for (field, value) in [
            ("length_m", self.length_m),
            ("radius_m", radius_m),
            ("spacing_m", self.spacing_m),
            ("depth_m", self.depth_m),
            ("conductivity_w_m_k", self.conductivity_w_m_k),
            ("capacity_j_m3_k", self.capacity_j_m3_k),
        ] {
            positive(field, value)?;
        }
        let resistance_k_m_w = not_negative("wall_resistance_k_m_w", self.wall_resistance_k_m_w)?;
        let widest_m = if holes { 1.0 } else { 0.4 * self.spacing_m };
        if radius_m > widest_m {
            let requirement = "must be below 1 m, of pipes below 0.4 of their spacing";
            return Err(UnitError::OutOfRange { field: "radius_m", value: radius_m, requirement });
        }
        let ground = Ground {
            conductivity_w_m_k: self.conductivity_w_m_k,
            capacity_j_m3_k: self.capacity_j_m3_k,
        };
        let laid = (self.spacing_m, self.depth_m);
        Ok(match self.source {
            BrineSource::Given => None,
            BrineSource::Boreholes => {
                let length_m = self.length_m;
                Some(GroundSource::boreholes(ground, length_m, radius_m, resistance_k_m_w))
            }
            BrineSource::Pipes => {
                let length_m = self.length_m;
                Some(GroundSource::pipes(ground, length_m, radius_m, resistance_k_m_w, laid))
            }
        })
    }
}

fn own_name(field: &'static str) -> &'static str {
    match field {
        "heating_return_min_k" => "return_min_k",
        "heating_return_max_k" => "return_max_k",
        "size_factor" => "heat_nominal_w",
        other => other,
    }
}
