//! A gas engine with heat and power as written in a model file: sizes of 2, 5 and 18 kW of electricity.

use super::engine::EngineContent;
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

/// Electricity at full load of the engine whose start, stop and warm-up these are, W.
const MEASURED_W: f64 = 1900.0;
/// Total efficiency of its fit at full load and a return of 35 degC.
const FIT_TOTAL: f64 = 0.8665;
/// Heat that it takes for itself when it starts cold, W.
const WARM_UP_W: f64 = 1000.0;
/// Length of its start from cold, s.
const START_S: f64 = 825.0;

/// Its start: time, shares of heat, fuel, electricity, flow. The flow is what gives the published supply
/// temperatures (63, 58, 69, 73, 80 degC) at a return of 35 degC.
const START: [[f64; 5]; 13] = [
    [0.0, 0.0, 0.0, -0.05, 0.0],
    [54.0, 0.0, 0.37, 0.47, 0.0],
    [56.0, 0.0, 1.1, 0.49, 0.0],
    [180.0, 0.0, 1.25, 0.52, 0.0],
    [203.0, 0.0, 1.25, 0.93, 0.0],
    [224.0, 0.0, 1.375, 0.97, 0.0],
    [336.0, 0.0, 1.375, 1.0, 0.0],
    [724.0, 0.0, 1.36, 1.0, 0.0],
    [737.0, 0.92, 1.15, 1.0, 1.479],
    [741.0, 0.25, 1.07, 1.0, 0.489],
    [797.0, 0.21, 1.0, 1.0, 0.278],
    [811.0, 0.73, 1.0, 1.0, 0.864],
    [825.0, 1.0, 1.0, 1.0, 1.0],
];

/// Time of the start in which the fuel is lit, s.
const IGNITION_S: f64 = 56.0;

/// Its stop: the engine gives no electricity from 5 s on, its pump goes on with the heat of the engine.
const STOP: [[f64; 5]; 6] = [
    [0.0, 1.0, 0.0, 1.0, 1.0],
    [5.0, 1.0, 0.0, -0.05, 1.0],
    [42.0, 1.0, 0.0, -0.05, 1.0],
    [49.0, 0.43, 0.0, -0.05, 0.43],
    [76.0, 0.43, 0.0, -0.05, 0.43],
    [84.0, 0.0, 0.0, -0.05, 0.0],
];

/// Start of an engine with a content: its heat from ignition on; the pump follows the content.
fn into_content([time_s, _, fuel, power, _]: [f64; 5]) -> [f64; 5] {
    let burns = if time_s >= IGNITION_S { 1.0 } else { 0.0 };
    [time_s, burns, fuel, power, burns]
}

/// Stop of an engine with a content: nothing burns, the pump goes on.
fn from_content([time_s, _, fuel, power, flow]: [f64; 5]) -> [f64; 5] {
    [time_s, 0.0, fuel, power, flow]
}

/// Engines of the laboratory houses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ChpSize {
    /// 1.9 kW of electricity, 5.2 kW of heat; measured.
    #[serde(rename = "2kw")]
    Kw2,
    /// 5 kW of electricity, 11.9 kW of heat.
    #[serde(rename = "5kw")]
    Kw5,
    /// 18 kW of electricity, 34 kW of heat.
    #[serde(rename = "18kw")]
    Kw18,
}

impl ChpSize {
    /// Electricity at full load, W; smallest load; electric and total efficiency at full load.
    fn ratings(self) -> (f64, f64, f64, f64) {
        match self {
            Self::Kw2 => (1900.0, 0.55, 0.24, FIT_TOTAL),
            Self::Kw5 => (5000.0, 0.58, 0.27, 0.90),
            Self::Kw18 => (18_000.0, 0.55, 0.31, 0.90),
        }
    }
}

/// A gas engine with heat and power as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ChpParams {
    /// Wanted electricity as a share of the largest while nothing drives it; 0 is off.
    pub modulation: f64,
    /// 1 releases the unit, 0 keeps it off, while nothing drives it.
    pub enable: f64,
    /// Set supply temperature with `constant_supply` while nothing drives it, K.
    pub supply_set_k: f64,
    /// Size: gives what is not stated below.
    pub size: ChpSize,
    /// Electricity at full load, W.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub electric_max_w: Option<f64>,
    /// Smallest load as a share of the full one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modulation_min: Option<f64>,
    /// Electric efficiency at full load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub electric_efficiency: Option<f64>,
    /// Electric efficiency at the smallest load; three quarters of that at full load without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub electric_efficiency_min: Option<f64>,
    /// Efficiency of heat and electricity at full load and a return of 35 degC.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub total_efficiency: Option<f64>,
    /// Time in which the load would change from nothing to full, s; 0 at once.
    pub load_change_s: f64,
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
    /// Smallest time of a run, s.
    pub run_min_s: f64,
    /// Smallest time between a stop and the next start, s.
    pub off_min_s: f64,
    /// Length of a start of the cold engine, s; no heat in its first 88 %.
    pub start_s: f64,
    /// Length of a start of the warm engine, s.
    pub warm_start_s: f64,
    /// Standstill after which the engine is cold, s.
    pub cold_after_s: f64,
    /// Heat that the cold engine takes for itself when it starts, W per 1.9 kW of electricity; it ends in `warm_up_s`.
    /// 1000 W without this; nothing with a content, which takes that heat itself: what is given counts besides.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warm_up_w: Option<f64>,
    /// Time in which the engine warms up, s.
    pub warm_up_s: f64,
    /// Efficiency over what the map says, at all loads.
    pub efficiency_factor: f64,
    /// The same at 20, 40 and 60 % of the load besides; 1 at full load. Empty: 1 everywhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub part_load_factor: Vec<f64>,
    /// Electricity while the unit is off, W.
    pub idle_w: f64,
    /// Heat capacity of the engine with its water, J/K: 60 kJ/K; 0 (default) for the measured start without a content.
    pub content_j_k: f64,
    /// Heat of that content to its surroundings, W/K.
    pub content_loss_w_k: f64,
    /// Temperature around the engine, K.
    pub ambient_k: f64,
    /// The pump starts where the content is hotter, K.
    pub pump_on_k: f64,
    /// The pump stops where the content is colder, K.
    pub pump_off_k: f64,
    /// Temperature of the content at the start of the run, K; that of the run without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial_content_k: Option<f64>,
    /// false: the steady map at once, without start, warm-up, stop, load changes and least times.
    pub dynamics: bool,
}

impl Default for ChpParams {
    fn default() -> Self {
        Self {
            modulation: 0.0,
            enable: 1.0,
            supply_set_k: 353.15,
            size: ChpSize::Kw2,
            electric_max_w: None,
            modulation_min: None,
            electric_efficiency: None,
            electric_efficiency_min: None,
            total_efficiency: None,
            load_change_s: 40.0,
            flow_control: GeneratorFlow::ConstantSupply,
            temperature_difference_k: 20.0,
            v_flow_m3_s: 4.0 / 60_000.0,
            v_flow_max_m3_s: 40.0 / 60_000.0,
            return_max_k: 348.15,
            supply_max_k: 366.15,
            restart_difference_k: 5.0,
            run_min_s: 0.0,
            off_min_s: 0.0,
            start_s: START_S,
            warm_start_s: 200.0,
            cold_after_s: 36_000.0,
            warm_up_w: None,
            warm_up_s: 2400.0,
            efficiency_factor: 1.0,
            part_load_factor: Vec::new(),
            idle_w: 35.0,
            content_j_k: 0.0,
            content_loss_w_k: 5.0,
            ambient_k: 291.15,
            pump_on_k: 355.15,
            pump_off_k: 348.15,
            initial_content_k: None,
            dynamics: true,
        }
    }
}

impl ChpParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<Combustion, UnitError> {
        let (power_w, least, electric, total) = self.size.ratings();
        let power_w = positive("electric_max_w", self.electric_max_w.unwrap_or(power_w))?;
        let modulation_min = share("modulation_min", self.modulation_min.unwrap_or(least))?;
        let electric =
            positive("electric_efficiency", self.electric_efficiency.unwrap_or(electric))?;
        let electric_min = self.electric_efficiency_min.unwrap_or(0.75 * electric);
        let electric_min = positive("electric_efficiency_min", electric_min)?;
        let total = share("total_efficiency", self.total_efficiency.unwrap_or(total))?;
        if total <= electric.max(electric_min) {
            let requirement = "must be above the electric efficiency";
            return Err(UnitError::OutOfRange {
                field: "total_efficiency",
                value: total,
                requirement,
            });
        }
        share("modulation", self.modulation)?;
        share("enable", self.enable)?;
        for (field, value) in [
            ("temperature_difference_k", self.temperature_difference_k),
            ("v_flow_m3_s", self.v_flow_m3_s),
            ("v_flow_max_m3_s", self.v_flow_max_m3_s),
            ("start_s", self.start_s),
            ("warm_start_s", self.warm_start_s),
            ("cold_after_s", self.cold_after_s),
            ("warm_up_s", self.warm_up_s),
        ] {
            positive(field, value)?;
        }
        for (field, value) in [
            ("load_change_s", self.load_change_s),
            ("restart_difference_k", self.restart_difference_k),
            ("run_min_s", self.run_min_s),
            ("off_min_s", self.off_min_s),
            ("warm_up_w", self.warm_up_w()),
            ("idle_w", self.idle_w),
            ("content_j_k", self.content_j_k),
            ("content_loss_w_k", self.content_loss_w_k),
        ] {
            not_negative(field, value)?;
        }
        let liquid = |field, t_k| liquid(medium, field, t_k);
        let size = power_w / MEASURED_W;
        let longer = self.start_s / START_S;
        let engine = self.engine(medium)?;
        let start = START.map(|point| {
            let point = if engine.is_some() { into_content(point) } else { point };
            let [time_s, factors @ ..] = point;
            let [heat, fuel, power, flow] = factors;
            TablePoint::new([time_s * longer, heat, fuel, power, flow])
        });
        let stop = STOP.map(|point| {
            TablePoint::new(if engine.is_some() { from_content(point) } else { point })
        });
        let burner = Burner {
            modulation_min,
            slew_per_s: if self.load_change_s > 0.0 { 1.0 / self.load_change_s } else { f64::MAX },
            starts_full: true,
            start: start.into(),
            stop: stop.into(),
            warm_within_s: self.cold_after_s,
            warm_scale: self.warm_start_s / self.start_s,
            warm_up: WarmUp {
                heat_w: size * self.warm_up_w(),
                lasts_s: self.warm_up_s,
                cold_after_s: self.cold_after_s,
            },
            run_min_s: self.run_min_s,
            off_min_s: self.off_min_s,
            dynamics: self.dynamics,
        };
        let map = SteadyMap::Engine {
            power_w,
            modulation_min,
            electric: (electric_min, electric),
            total: total / FIT_TOTAL,
        };
        Ok(Combustion {
            main: Stage { burner, map },
            aux: None,
            rod_rated_w: 0.0,
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
            metal: None,
            engine,
            factor: EfficiencyFactor::new(self.efficiency_factor, &self.part_load_factor)?,
            idle_w: self.idle_w,
            running_w: 0.0,
            size,
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

    /// Heat that the cold engine takes for itself when it starts, W per 1.9 kW: that of the measured one unless its
    /// content takes it.
    pub fn warm_up_w(&self) -> f64 {
        self.warm_up_w.unwrap_or(if self.content_j_k > 0.0 { 0.0 } else { WARM_UP_W })
    }

    /// Its size over that of the measured engine.
    pub fn size_of_measured(&self) -> f64 {
        self.electric_max_w.unwrap_or(self.size.ratings().0) / MEASURED_W
    }

    /// The content, where there is one.
    fn engine(&self, medium: &Medium) -> Result<Option<EngineContent>, UnitError> {
        let liquid = |field, t_k| liquid(medium, field, t_k);
        let content = EngineContent {
            heat_capacity_j_k: self.content_j_k,
            loss_w_k: self.content_loss_w_k,
            ambient_k: positive("ambient_k", self.ambient_k)?,
            pump_on_k: liquid("pump_on_k", self.pump_on_k)?,
            pump_off_k: liquid("pump_off_k", self.pump_off_k)?,
            initial_k: self
                .initial_content_k
                .map(|t_k| liquid("initial_content_k", t_k))
                .transpose()?,
        };
        if content.pump_off_k > content.pump_on_k {
            let requirement = "must not be above pump_on_k";
            let (field, value) = ("pump_off_k", self.pump_off_k);
            return Err(UnitError::OutOfRange { field, value, requirement });
        }
        Ok((self.content_j_k > 0.0).then_some(content))
    }
}
