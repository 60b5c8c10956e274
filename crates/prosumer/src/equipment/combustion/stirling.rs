//! A Stirling engine with an auxiliary boiler and an electric rod as written in a model file.

use super::boiler::measured_stage;
use super::flow::flow_rule;
use super::map::SteadyMap;
use super::{Combustion, GeneratorCommand, GeneratorFlow, Limits, Stage};
use crate::burner::{Burner, TablePoint, WarmUp};
use crate::efficiency_factor::EfficiencyFactor;
use crate::equipment::liquid;
use crate::thermal_unit::{UnitError, not_negative, positive, share};
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Its start: time, shares of heat, fuel, electricity, flow. It draws 100 W for two minutes; heat comes from 60 s on.
const START: [[f64; 5]; 4] = [
    [0.0, 0.0, 1.0, -0.1, 0.0],
    [60.0, 0.0, 1.0, -0.1, 0.0],
    [120.0, 0.111, 1.0, -0.1, 0.111],
    [600.0, 1.0, 1.0, 1.0, 1.0],
];

/// Its stop: the heat of the engine is recovered.
const STOP: [[f64; 5]; 3] =
    [[0.0, 1.0, 0.0, 1.0, 1.0], [60.0, 0.9, 0.0, 0.0, 0.9], [600.0, 0.0, 0.0, 0.0, 0.0]];

/// A Stirling engine with an auxiliary boiler and an electric rod, in one unit with one circuit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct StirlingChpParams {
    /// Above 0 the engine runs, at full load, while nothing drives it.
    pub modulation: f64,
    /// Wanted load of the auxiliary boiler while nothing drives it; 0 is off.
    pub aux_modulation: f64,
    /// Wanted power of the rod as a share of its rated one while nothing drives it.
    pub rod_modulation: f64,
    /// 1 releases the unit, 0 keeps it off, while nothing drives it.
    pub enable: f64,
    /// Set supply temperature with `constant_supply` while nothing drives it, K.
    pub supply_set_k: f64,
    /// Electricity of the engine, W.
    pub electric_max_w: f64,
    /// Electric efficiency of the engine.
    pub electric_efficiency: f64,
    /// Efficiency of its heat and electricity at a return of 30 degC; 0.2 % less per kelvin above.
    pub total_efficiency: f64,
    /// Nominal heat of the auxiliary boiler, W: that of a `condensing_boiler`.
    pub aux_nominal_w: f64,
    /// Rated power of the rod, W; 0 for none.
    pub rod_rated_w: f64,
    /// How the flow of the water is set.
    pub flow_control: GeneratorFlow,
    /// Difference of supply and return with a constant temperature difference, K.
    pub temperature_difference_k: f64,
    /// Flow with `constant_flow`, m3/s.
    pub v_flow_m3_s: f64,
    /// Largest flow with `constant_supply`, m3/s.
    pub v_flow_max_m3_s: f64,
    /// The unit stops where the water arrives warmer, K.
    pub return_max_k: f64,
    /// The unit stops where the water leaves warmer, K.
    pub supply_max_k: f64,
    /// How far below its limits the water must be to start again, K.
    pub restart_difference_k: f64,
    /// Smallest time of a run of the engine, s.
    pub run_min_s: f64,
    /// Smallest time between a stop and the next start of the engine, s.
    pub off_min_s: f64,
    /// Efficiency over what the map says, at all loads.
    pub efficiency_factor: f64,
    /// The same at 20, 40 and 60 % of the load besides; 1 at full load. Empty: 1 everywhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub part_load_factor: Vec<f64>,
    /// Electricity while the unit is off, W.
    pub idle_w: f64,
    /// false: the steady maps at once, without start, stop and least times.
    pub dynamics: bool,
}

impl Default for StirlingChpParams {
    fn default() -> Self {
        Self {
            modulation: 0.0,
            aux_modulation: 0.0,
            rod_modulation: 0.0,
            enable: 1.0,
            supply_set_k: 333.15,
            electric_max_w: 1000.0,
            electric_efficiency: 0.13,
            total_efficiency: 0.93,
            aux_nominal_w: 20_000.0,
            rod_rated_w: 6000.0,
            flow_control: GeneratorFlow::ConstantTemperatureDifference,
            temperature_difference_k: 20.0,
            v_flow_m3_s: 10.0 / 60_000.0,
            v_flow_max_m3_s: 40.0 / 60_000.0,
            return_max_k: 348.15,
            supply_max_k: 366.15,
            restart_difference_k: 5.0,
            run_min_s: 0.0,
            off_min_s: 0.0,
            efficiency_factor: 1.0,
            part_load_factor: Vec::new(),
            idle_w: 35.0,
            dynamics: true,
        }
    }
}

impl StirlingChpParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<Combustion, UnitError> {
        for (field, value) in [
            ("modulation", self.modulation),
            ("aux_modulation", self.aux_modulation),
            ("rod_modulation", self.rod_modulation),
            ("enable", self.enable),
        ] {
            share(field, value)?;
        }
        for (field, value) in [
            ("electric_max_w", self.electric_max_w),
            ("electric_efficiency", self.electric_efficiency),
            ("aux_nominal_w", self.aux_nominal_w),
            ("temperature_difference_k", self.temperature_difference_k),
            ("v_flow_m3_s", self.v_flow_m3_s),
            ("v_flow_max_m3_s", self.v_flow_max_m3_s),
        ] {
            positive(field, value)?;
        }
        for (field, value) in [
            ("rod_rated_w", self.rod_rated_w),
            ("restart_difference_k", self.restart_difference_k),
            ("run_min_s", self.run_min_s),
            ("off_min_s", self.off_min_s),
            ("idle_w", self.idle_w),
        ] {
            not_negative(field, value)?;
        }
        let total = share("total_efficiency", self.total_efficiency)?;
        // A return of 75 degC costs 9 %.
        if total - 0.09 <= self.electric_efficiency {
            let requirement = "must be above the electric efficiency by more than 0.09";
            return Err(UnitError::OutOfRange {
                field: "total_efficiency",
                value: total,
                requirement,
            });
        }
        let liquid = |field, t_k| liquid(medium, field, t_k);
        let burner = Burner {
            modulation_min: 1.0,
            slew_per_s: f64::MAX,
            starts_full: true,
            start: START.map(TablePoint::new).into(),
            stop: STOP.map(TablePoint::new).into(),
            warm_within_s: 0.0,
            warm_scale: 1.0,
            warm_up: WarmUp::default(),
            run_min_s: self.run_min_s,
            off_min_s: self.off_min_s,
            dynamics: self.dynamics,
        };
        let map = SteadyMap::Stirling {
            power_w: self.electric_max_w,
            electric: self.electric_efficiency,
            total,
        };
        Ok(Combustion {
            main: Stage { burner, map },
            aux: Some(measured_stage(self.aux_nominal_w, self.dynamics)?),
            rod_rated_w: self.rod_rated_w,
            command: GeneratorCommand::Power,
            flow: flow_rule(
                medium,
                self.flow_control,
                self.temperature_difference_k,
                (self.v_flow_m3_s, self.v_flow_max_m3_s),
            ),
            limits: Limits {
                return_max_k: liquid("return_max_k", self.return_max_k)?,
                supply_max_k: liquid("supply_max_k", self.supply_max_k)?,
                restart_k: self.restart_difference_k,
            },
            engine: None,
            metal: None,
            factor: EfficiencyFactor::new(self.efficiency_factor, &self.part_load_factor)?,
            idle_w: self.idle_w,
            running_w: 0.0,
            size: self.electric_max_w / 1000.0,
            initial: [
                self.modulation,
                self.enable,
                liquid("supply_set_k", self.supply_set_k)?,
                self.aux_modulation,
                self.rod_modulation,
            ],
            medium: *medium,
        })
    }
}
