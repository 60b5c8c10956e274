//! What heat pumps have in common besides their compressor: limits, electric heater, flow control, maps.

use crate::compressor::StartPoint;
use crate::performance_map::PerformanceMap;
use crate::performance_map::params::MapChoice;
use crate::thermal_unit::UnitError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the pump of a heat pump sets its flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FlowControl {
    /// Supply and return differ by a given temperature.
    ConstantTemperatureDifference,
    /// The flow is given, the temperature difference floats.
    ConstantFlow,
}

/// Where the unit stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limits {
    pub heating_k: (f64, f64),
    pub cooling_k: (f64, f64),
    pub restart_k: f64,
    pub supply_max_k: f64,
    pub source_min_k: f64,
}

impl Limits {
    /// Whether a limit keeps the unit off; `tripped` is whether one did before.
    pub fn trip(
        &self,
        cooling: bool,
        return_k: f64,
        condenser_k: f64,
        air_k: f64,
        tripped: bool,
    ) -> bool {
        let (min_k, max_k) = if cooling { self.cooling_k } else { self.heating_k };
        let inside_k = if tripped { self.restart_k } else { 0.0 };
        return_k < min_k + inside_k
            || return_k > max_k - inside_k
            || (!cooling && (condenser_k > self.supply_max_k || air_k < self.source_min_k))
    }
}

/// The electric heater behind the condenser.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AuxHeater {
    pub rated_w: f64,
    pub steps: u8,
}

impl AuxHeater {
    /// Power for a command: the next step that reaches it, W.
    pub(crate) fn power_w(&self, command: f64) -> f64 {
        let command = command.clamp(0.0, 1.0);
        let steps = f64::from(self.steps);
        // A third written with a few digits is a third.
        let share =
            if steps > 0.0 { ((command * steps - 1e-6).ceil().max(0.0)) / steps } else { command };
        share * self.rated_w
    }
}

fn inside(field: &'static str, problem: String) -> UnitError {
    UnitError::Within { field, problem }
}

/// The map of a choice, `field` naming it.
///
/// # Errors
/// Names the map, and what is wrong with it.
pub(crate) fn map_of(
    field: &'static str,
    choice: &MapChoice,
    cooling: bool,
) -> Result<PerformanceMap, UnitError> {
    match choice {
        MapChoice::Named(name) => {
            Err(inside(field, format!("{field}: there is no heat_pump_map \"{name}\"")))
        }
        MapChoice::Given(map) if map.cooling != cooling => {
            let (is, needed) = if cooling { ("heating", "true") } else { ("cooling", "false") };
            let problem = format!("{field} is a map of {is}: it needs cooling = {needed}");
            Err(inside(field, problem))
        }
        MapChoice::Given(map) => {
            map.build().map_err(|error| inside(field, format!("{field}: {error}")))
        }
    }
}

/// The rows of a table over time: the time, and the values of its columns.
///
/// # Errors
/// Names the field of the table that is wrong.
pub(crate) fn rows_over_time<const N: usize>(
    times_field: &'static str,
    times_s: &[f64],
    columns: [(&'static str, &[f64]); N],
) -> Result<Vec<(f64, [f64; N])>, UnitError> {
    for (field, column) in columns {
        let (points, times) = (column.len(), times_s.len());
        if points != times {
            let problem =
                format!("{field} has {points} points, {times_field} {times}: they must be as many");
            return Err(inside(field, problem));
        }
        if column.iter().any(|value| !value.is_finite()) {
            return Err(inside(field, format!("{field} must be finite numbers")));
        }
    }
    if times_s.first().is_some_and(|first| *first != 0.0)
        || times_s.windows(2).any(|pair| pair[1] <= pair[0] || !pair[1].is_finite())
    {
        return Err(inside(times_field, format!("{times_field} must rise from 0")));
    }
    let row = |(i, time_s): (usize, &f64)| (*time_s, columns.map(|(_, column)| column[i]));
    Ok(times_s.iter().enumerate().map(row).collect())
}

/// The table of a start.
///
/// # Errors
/// Names the field of the table that is wrong.
pub(crate) fn start_table(
    times_s: &[f64],
    heat: &[f64],
    power: &[f64],
) -> Result<Vec<StartPoint>, UnitError> {
    let columns = [("start_heat", heat), ("start_power", power)];
    let rows = rows_over_time("start_times_s", times_s, columns)?;
    if let Some(value) = power.iter().find(|value| **value < 0.0) {
        let problem = format!("start_power: {value} must not be negative");
        return Err(inside("start_power", problem));
    }
    let point = |(time_s, [heat, power]): (f64, [f64; 2])| StartPoint { time_s, heat, power };
    Ok(rows.into_iter().map(point).collect())
}
