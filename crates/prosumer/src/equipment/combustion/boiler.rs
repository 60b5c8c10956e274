//! A condensing gas boiler as written in a model file: every number has the value of the reference unit of 14 kW.

use super::flow::flow_rule;
use super::map::{BoilerTable, SteadyMap};
use super::metal::Metal;
use super::{Combustion, GeneratorCommand, GeneratorFlow, Limits, Stage};
use crate::burner::{Burner, TablePoint, WarmUp};
use crate::efficiency_factor::EfficiencyFactor;
use crate::equipment::liquid;
use crate::heat_pump::rows_over_time;
use crate::thermal_unit::{UnitError, not_negative, positive, share};
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Nominal heat of the boiler whose data the fits follow, W.
pub(super) const MEASURED_W: f64 = 14_000.0;

/// Conductance between metal and water, W/K, assumed.
const METAL_W_K: f64 = 100.0;

/// A condensing gas boiler as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CondensingBoilerParams {
    /// Wanted load as a share of the full one while nothing drives it; 0 is off.
    pub modulation: f64,
    /// 1 releases the unit, 0 keeps it off, while nothing drives it.
    pub enable: f64,
    /// Set supply temperature while nothing drives it, K: with `constant_supply`, or `command = "supply_temperature"`.
    pub supply_set_k: f64,
    /// Nominal heat, W: 14, 20 or 50 kW are those of the series; the map of 14 kW is scaled.
    pub nominal_w: f64,
    /// Smallest load as a share of the full one.
    pub modulation_min: f64,
    /// Time in which the load would change from nothing to full, s; 0 at once.
    pub load_change_s: f64,
    /// What the command is.
    pub command: GeneratorCommand,
    /// How the flow of the water is set.
    pub flow_control: GeneratorFlow,
    /// Difference of supply and return with a constant or measured temperature difference, K.
    pub temperature_difference_k: f64,
    /// Flow with `constant_flow`, m3/s.
    pub v_flow_m3_s: f64,
    /// Largest flow with `constant_supply`, m3/s.
    pub v_flow_max_m3_s: f64,
    /// Another map: return temperatures, K, rising.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub table_return_k: Vec<f64>,
    /// Another map: efficiency by the lower heating value at these temperatures.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub table_efficiency: Vec<f64>,
    /// Another map: heat at the smallest load at these temperatures, W.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub table_heat_min_w: Vec<f64>,
    /// Another map: heat at full load at these temperatures, W.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub table_heat_max_w: Vec<f64>,
    /// The unit stops where the water arrives warmer, K.
    pub return_max_k: f64,
    /// The unit stops where the water leaves warmer, K.
    pub supply_max_k: f64,
    /// How far below its limits the water must be to start again, K.
    pub restart_difference_k: f64,
    /// Smallest time of a run, s.
    pub run_min_s: f64,
    /// Smallest time between a stop and the next start, s.
    pub off_min_s: f64,
    /// Start: times of its table, s, rising from 0.
    pub start_times_s: Vec<f64>,
    /// Start: heat at these times as a share of the steady one.
    pub start_heat: Vec<f64>,
    /// Start: flow at these times as a share of the steady one.
    pub start_flow: Vec<f64>,
    /// Stop: times of its table, s, rising from 0.
    pub stop_times_s: Vec<f64>,
    /// Stop: heat at these times as a share of that before; the flow goes on until the last one.
    pub stop_heat: Vec<f64>,
    /// Efficiency over what the map says, at all loads.
    pub efficiency_factor: f64,
    /// The same at 20, 40 and 60 % of the load besides; 1 at full load. Empty: 1 everywhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub part_load_factor: Vec<f64>,
    /// Heat capacity of metal that takes part beside what start and stop show, J/K; 0 for none.
    pub metal_capacity_j_k: f64,
    /// Conductance between this metal and the water, W/K.
    pub metal_conductance_w_k: f64,
    /// Electricity of control, fan and pump, W.
    pub idle_w: f64,
    /// false: the steady map at once, without start, stop, load changes and least times.
    pub dynamics: bool,
}

impl Default for CondensingBoilerParams {
    fn default() -> Self {
        Self {
            modulation: 0.0,
            enable: 1.0,
            supply_set_k: 333.15,
            nominal_w: MEASURED_W,
            modulation_min: 0.2,
            load_change_s: 0.0,
            command: GeneratorCommand::Power,
            flow_control: GeneratorFlow::ConstantTemperatureDifference,
            temperature_difference_k: 20.0,
            v_flow_m3_s: 20.0 / 60_000.0,
            v_flow_max_m3_s: 40.0 / 60_000.0,
            table_return_k: Vec::new(),
            table_efficiency: Vec::new(),
            table_heat_min_w: Vec::new(),
            table_heat_max_w: Vec::new(),
            return_max_k: 348.15,
            supply_max_k: 356.15,
            restart_difference_k: 5.0,
            run_min_s: 0.0,
            off_min_s: 0.0,
            start_times_s: vec![
                0.0, 9.0, 21.0, 33.0, 45.0, 57.0, 69.0, 93.0, 117.0, 141.0, 165.0, 189.0, 213.0,
                237.0, 273.0, 300.0,
            ],
            start_heat: vec![
                0.0, 0.16, 0.49, 0.51, 0.40, 0.42, 0.54, 0.74, 0.93, 1.07, 1.26, 1.16, 1.11, 1.05,
                1.0, 1.0,
            ],
            start_flow: vec![
                0.0, 0.72, 0.70, 0.67, 0.65, 0.63, 0.67, 0.79, 0.92, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0,
                1.0,
            ],
            stop_times_s: vec![0.0, 2.0, 3.0, 5.0, 8.0, 10.0, 15.0, 20.0, 30.0, 70.0],
            stop_heat: vec![1.0, 1.0, 0.97, 0.79, 0.47, 0.34, 0.17, 0.10, 0.05, 0.0],
            efficiency_factor: 1.0,
            part_load_factor: Vec::new(),
            metal_capacity_j_k: 0.0,
            metal_conductance_w_k: METAL_W_K,
            idle_w: 35.0,
            dynamics: true,
        }
    }
}

/// The start of a boiler: its fuel burns as in steady operation.
fn start(times_s: &[f64], heat: &[f64], flow: &[f64]) -> Result<Vec<TablePoint>, UnitError> {
    let columns = [("start_heat", heat), ("start_flow", flow)];
    let rows = rows_over_time("start_times_s", times_s, columns)?;
    let point = |(time_s, [heat, flow]): (f64, [f64; 2])| [time_s, heat, 1.0, 0.0, flow];
    Ok(rows.into_iter().map(point).map(TablePoint::new).collect())
}

/// The stop of a boiler: no fuel, the flow goes on.
fn stop(times_s: &[f64], heat: &[f64]) -> Result<Vec<TablePoint>, UnitError> {
    let rows = rows_over_time("stop_times_s", times_s, [("stop_heat", heat)])?;
    let point = |(time_s, [heat]): (f64, [f64; 1])| [time_s, heat, 0.0, 0.0, 1.0];
    Ok(rows.into_iter().map(point).map(TablePoint::new).collect())
}

/// The measured boiler with its start and stop.
pub(super) fn measured_stage(nominal_w: f64, dynamics: bool) -> Result<Stage, UnitError> {
    CondensingBoilerParams { nominal_w, dynamics, ..CondensingBoilerParams::default() }.stage()
}

impl CondensingBoilerParams {
    fn stage(&self) -> Result<Stage, UnitError> {
        let columns = [
            &self.table_return_k,
            &self.table_efficiency,
            &self.table_heat_min_w,
            &self.table_heat_max_w,
        ];
        let map = if columns.iter().all(|column| column.is_empty()) {
            SteadyMap::Boiler { nominal_w: self.nominal_w }
        } else {
            let table = BoilerTable {
                modulation_min: self.modulation_min,
                return_k: self.table_return_k.clone(),
                efficiency: self.table_efficiency.clone(),
                heat_min_w: self.table_heat_min_w.clone(),
                heat_max_w: self.table_heat_max_w.clone(),
            };
            SteadyMap::Table(table.checked()?)
        };
        let burner = Burner {
            modulation_min: self.modulation_min,
            slew_per_s: if self.load_change_s > 0.0 { 1.0 / self.load_change_s } else { f64::MAX },
            starts_full: false,
            start: start(&self.start_times_s, &self.start_heat, &self.start_flow)?,
            stop: stop(&self.stop_times_s, &self.stop_heat)?,
            warm_within_s: 0.0,
            warm_scale: 1.0,
            warm_up: WarmUp::default(),
            run_min_s: self.run_min_s,
            off_min_s: self.off_min_s,
            dynamics: self.dynamics,
        };
        Ok(Stage { burner, map })
    }

    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<Combustion, UnitError> {
        for (field, value) in [
            ("modulation", self.modulation),
            ("enable", self.enable),
            ("modulation_min", self.modulation_min),
        ] {
            share(field, value)?;
        }
        for (field, value) in [
            ("nominal_w", self.nominal_w),
            ("temperature_difference_k", self.temperature_difference_k),
            ("v_flow_m3_s", self.v_flow_m3_s),
            ("v_flow_max_m3_s", self.v_flow_max_m3_s),
            ("metal_conductance_w_k", self.metal_conductance_w_k),
        ] {
            positive(field, value)?;
        }
        for (field, value) in [
            ("load_change_s", self.load_change_s),
            ("restart_difference_k", self.restart_difference_k),
            ("run_min_s", self.run_min_s),
            ("off_min_s", self.off_min_s),
            ("metal_capacity_j_k", self.metal_capacity_j_k),
            ("idle_w", self.idle_w),
        ] {
            not_negative(field, value)?;
        }
        let liquid = |field, t_k| liquid(medium, field, t_k);
        if self.command == GeneratorCommand::SupplyTemperature
            && self.flow_control != GeneratorFlow::ConstantFlow
        {
            let problem = "command = \"supply_temperature\" needs flow_control = \"constant_flow\": with the \
                           others the load does not set the supply temperature";
            return Err(UnitError::Within { field: "command", problem: problem.into() });
        }
        let table = !self.table_return_k.is_empty();
        Ok(Combustion {
            main: self.stage()?,
            aux: None,
            rod_rated_w: 0.0,
            command: self.command,
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
            metal: Metal::new(self.metal_capacity_j_k, self.metal_conductance_w_k),
            factor: EfficiencyFactor::new(self.efficiency_factor, &self.part_load_factor)?,
            idle_w: self.idle_w,
            running_w: self.idle_w,
            size: if table { 1.0 } else { self.nominal_w / MEASURED_W },
            initial: [
                self.modulation,
                self.enable,
                liquid("supply_set_k", self.supply_set_k)?,
                0.0,
                0.0,
            ],
            medium: *medium,
        })
    }
}
