//! A performance map as written in a model file: a table, or a fit of the database hplib.

use super::PerformanceMap;
use super::hplib::HplibFit;
use super::table::{MapTable, Water};
use crate::thermal_unit::UnitError;
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// The map of a heat pump: the name of a `[heat_pump_map.NAME]`, or the map itself in SI.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum MapChoice {
    /// Name of a `[heat_pump_map.NAME]`.
    Named(String),
    /// The map.
    Given(Box<PerformanceMapParams>),
}

impl<'de> Deserialize<'de> for MapChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Choice;
        impl<'de> Visitor<'de> for Choice {
            type Value = MapChoice;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a heat_pump_map")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<MapChoice, E> {
                Ok(MapChoice::Named(name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<MapChoice, A::Error> {
                PerformanceMapParams::deserialize(MapAccessDeserializer::new(map))
                    .map(|map| MapChoice::Given(Box::new(map)))
            }
        }
        deserializer.deserialize_any(Choice)
    }
}

/// A performance map: a table (`source_k`, `return_k` or `supply_k`, `heat_w` and `electric_w` or `cop`), given here
/// or in a CSV file, or a row of the database hplib.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PerformanceMapParams {
    /// CSV file relative to the model file: a table with a row per point and columns named like the fields of a
    /// map, or `hplib_database.csv`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Row of the database: its column `Model`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hplib_model: Option<String>,
    /// Row of the database where several have the model: its column `Titel`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hplib_title: Option<String>,
    /// Group of the database: 1 air, 2 brine, 3 water, regulated; 4 air, 5 brine, 6 water, on/off. Needed for the
    /// model `Generic`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hplib_group: Option<u8>,
    /// Heat at the reference point of the database (air -7, brine 0, water 10 degC; supply 52 degC), W: scales the
    /// unit; needed for the model `Generic`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hplib_heat_w: Option<f64>,
    /// Electricity at the reference point, W; read from the database.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hplib_electric_w: Option<f64>,
    /// Coefficients of the relative electricity: of source, supply (1/K), constant, outdoor air (1/K), temperatures
    /// in degC; read from the database.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hplib_power_coefficients: Option<[f64; 4]>,
    /// The same of the COP, or of the EER.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hplib_ratio_coefficients: Option<[f64; 4]>,
    /// Whether this is a map of cooling: the cold is in `heat_w`, the EER in `cop`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub cooling: bool,
    /// Shares of the full speed, rising; one (or none) means that heat and electricity scale with the speed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub modulation: Vec<f64>,
    /// Temperatures of the source that arrives (of air, brine or water), K, rising.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub source_k: Vec<f64>,
    /// Temperatures of the water that arrives, K, rising.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub return_k: Vec<f64>,
    /// Temperatures of the water that leaves, K, rising.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub supply_k: Vec<f64>,
    /// Heat, W: a row per source temperature (per modulation all of them), a number per water temperature.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub heat_w: Vec<Vec<f64>>,
    /// Electricity, W, in the same order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub electric_w: Vec<Vec<f64>>,
    /// Heat per electricity, in the same order, instead of the electricity.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cop: Vec<Vec<f64>>,
}

fn wrong(problem: impl Into<String>) -> UnitError {
    UnitError::Fields { problem: problem.into() }
}

fn rising(name: &str, axis: &[f64]) -> Result<(), UnitError> {
    for (i, pair) in axis.windows(2).enumerate() {
        if pair[1] <= pair[0] {
            let (at, value, before) = (i + 2, pair[1], pair[0]);
            return Err(wrong(format!(
                "{name} must rise: its number {at} is {value}, the one before {before}"
            )));
        }
    }
    match axis.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(wrong(format!("{name}: its number {} is not finite", at + 1))),
        None => Ok(()),
    }
}

impl PerformanceMapParams {
    /// The map, ready to be asked.
    ///
    /// # Errors
    /// A sentence that names the field, the row and the number.
    pub fn build(&self) -> Result<PerformanceMap, UnitError> {
        let hplib = self.hplib_group.is_some() || self.hplib_power_coefficients.is_some();
        match (hplib, self.source_k.is_empty() && self.heat_w.is_empty()) {
            (true, true) => self.fit().map(PerformanceMap::Hplib),
            (false, false) => self.table().map(PerformanceMap::Table),
            (true, false) => Err(wrong(
                "the map has a table and fields of hplib: give either heat_w (heat_kw) or hplib_model",
            )),
            (false, true) => Err(wrong(
                "the map is empty: give a table (source_degc, return_degc or supply_degc, heat_kw, electric_kw or \
                 cop), a file, or a file and hplib_model",
            )),
        }
    }

    fn fit(&self) -> Result<HplibFit, UnitError> {
        let needed =
            |name: &str| wrong(format!("{name} is missing: it comes from hplib_database.csv"));
        let group = self.hplib_group.ok_or_else(|| needed("hplib_group"))?;
        if !(1..=6).contains(&group) {
            return Err(wrong(format!(
                "hplib_group = {group} must be 1 to 6: air, brine, water, regulated; the same, on/off"
            )));
        }
        if self.cooling && group != 1 {
            return Err(wrong(format!(
                "hplib_group = {group} cannot cool: the database has cooling for group 1 only"
            )));
        }
        let power = |name: &str, value: Option<f64>| match value {
            Some(value) if value.is_finite() && value > 0.0 => Ok(value),
            Some(value) => Err(wrong(format!("{name} = {value} must be positive"))),
            None => Err(needed(name)),
        };
        let coefficients = |name: &str, value: Option<[f64; 4]>| match value {
            Some(value) if value.iter().all(|value| value.is_finite()) => Ok(value),
            Some(_) => Err(wrong(format!("{name} must be four finite numbers"))),
            None => Err(needed(name)),
        };
        Ok(HplibFit {
            group,
            reference_heat_w: power("hplib_heat_w", self.hplib_heat_w)?,
            reference_electric_w: power("hplib_electric_w", self.hplib_electric_w)?,
            electric: coefficients("hplib_power_coefficients", self.hplib_power_coefficients)?,
            ratio: coefficients("hplib_ratio_coefficients", self.hplib_ratio_coefficients)?,
            cooling: self.cooling,
        })
    }

    fn table(&self) -> Result<MapTable, UnitError> {
        let (water_k, water, water_name) = match (
            self.return_k.as_slice(),
            self.supply_k.as_slice(),
        ) {
            ([_, ..], []) => (&self.return_k, Water::Return, "return_k"),
            ([], [_, ..]) => (&self.supply_k, Water::Supply, "supply_k"),
            _ => {
                return Err(wrong(
                    "the map needs the water temperatures: either return_k (return_degc) or supply_k (supply_degc)",
                ));
            }
        };
        let modulation =
            if self.modulation.is_empty() { vec![1.0] } else { self.modulation.clone() };
        rising("modulation", &modulation)?;
        if modulation[0] < 0.0 || modulation[modulation.len() - 1] > 1.0 {
            return Err(wrong("modulation must lie between 0 and 1"));
        }
        if self.source_k.is_empty() {
            return Err(wrong("the map needs source_k (source_degc)"));
        }
        rising("source_k", &self.source_k)?;
        rising(water_name, water_k)?;
        let (name, divisor) = match (self.electric_w.is_empty(), self.cop.is_empty()) {
            (false, true) => ("electric_w", &self.electric_w),
            (true, false) => ("cop", &self.cop),
            _ => return Err(wrong("the map needs either electric_w (electric_kw) or cop")),
        };
        let rows = modulation.len() * self.source_k.len();
        let whole = |name: &str, values: &[Vec<f64>]| {
            if values.len() != rows {
                return Err(wrong(format!(
                    "{name} has {} rows, but {} modulations of {} source temperatures need {rows}",
                    values.len(),
                    modulation.len(),
                    self.source_k.len()
                )));
            }
            for (row, values) in values.iter().enumerate() {
                if values.len() != water_k.len() {
                    return Err(wrong(format!(
                        "{name} row {} has {} numbers for {} water temperatures: the map has a hole",
                        row + 1,
                        values.len(),
                        water_k.len()
                    )));
                }
                for (column, value) in values.iter().enumerate() {
                    if !value.is_finite() || *value < 0.0 {
                        return Err(wrong(format!(
                            "{name} row {}, number {}: {value} must be a number of at least 0",
                            row + 1,
                            column + 1
                        )));
                    }
                }
            }
            Ok(())
        };
        whole("heat_w", &self.heat_w)?;
        whole(name, divisor)?;
        let (mut useful_w, mut electric_w) = (Vec::new(), Vec::new());
        for (row, (heat, divisor)) in self.heat_w.iter().zip(divisor).enumerate() {
            for (column, (heat, divisor)) in heat.iter().zip(divisor).enumerate() {
                let electric = if self.cop.is_empty() { *divisor } else { heat / divisor };
                let ratio = if self.cop.is_empty() { heat / divisor } else { *divisor };
                // Nothing at all is a point beyond the limits of a unit.
                let nothing = *heat == 0.0 && self.cop.is_empty() && electric == 0.0;
                if !nothing && (!electric.is_finite() || (!self.cooling && ratio < 1.0)) {
                    return Err(wrong(format!(
                        "row {}, number {}: heat {heat} W of a COP of {ratio:.3} is less heat than electricity",
                        row + 1,
                        column + 1
                    )));
                }
                useful_w.push(*heat);
                electric_w.push(if nothing { 0.0 } else { electric });
            }
        }
        Ok(MapTable {
            modulation,
            source_k: self.source_k.clone(),
            water_k: water_k.clone(),
            water,
            useful_w,
            electric_w,
        })
    }
}
