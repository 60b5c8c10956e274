//! The parameters that an overlay can set or scale: fields of edges, units, circuits between points, controllers, sensors, ground and weather.

use super::OverlayError;
use crate::model::{BranchSpec, Model};
use crate::model_file::{GroundEntry, WeatherEntry, WeatherKind};
use anergy_control::controllers::ControllerParams;
use anergy_control::sensor::SensorEntry;
use anergy_network::elements::ElementParams;
use anergy_prosumer::equipment::EquipmentParams;
use serde_json::{Value, json};
use std::sync::Arc;

/// Fields of a sensor that say what it is, not how good.
const NAMES_OF_SENSORS: [&str; 3] = ["id", "measures", "minus"];

impl Model {
    /// Every parameter that can be set, `component.field`, and its value in SI; null where it follows from others.
    pub fn parameters(&self) -> Vec<(String, Value)> {
        let edges = self.edges.iter().map(|edge| (edge.id.as_str(), edge.params.to_value()));
        let units = self.units.iter().map(|unit| (unit.id.as_str(), unit.params.to_value()));
        let branches = self.circuits.iter().filter_map(|circuit| {
            circuit.branch.as_ref().map(|branch| (circuit.id.as_str(), json!(branch)))
        });
        let controllers = self.controllers.iter().map(|c| (c.id.as_str(), c.params.to_value()));
        let sensors = self.sensors.iter().map(|s| (s.entry.id.as_str(), json!(s.entry)));
        let weather = self.weather.iter().map(|weather| ("weather", json!(weather.entry)));
        let of_weather =
            |field: &str| self.weather.as_ref().is_some_and(|w| changes(&w.entry, field));
        let mut known: Vec<(String, Value)> = Vec::new();
        let ground = std::iter::once(("ground", json!(self.ground)));
        for (id, values) in ground.chain(edges).chain(units).chain(branches) {
            let Value::Object(values) = values else { continue };
            let own = |field: &str| id != "ground" || (field != "kind" && self.ground.has(field));
            known.extend(
                values
                    .into_iter()
                    .filter(|(field, _)| own(field))
                    .map(|(f, v)| (format!("{id}.{f}"), v)),
            );
        }
        for (id, values) in controllers.chain(sensors).chain(weather) {
            let Value::Object(values) = values else { continue };
            let own = |field: &str| match id {
                "weather" => of_weather(field),
                _ => !NAMES_OF_SENSORS.contains(&field),
            };
            known.extend(
                values
                    .into_iter()
                    .filter(|(field, _)| own(field))
                    .map(|(f, v)| (format!("{id}.{f}"), v)),
            );
        }
        known
    }

    /// Changes a field of an edge, a unit, a circuit between points, a controller, a sensor, the ground or the weather.
    pub(super) fn change_parameter(
        &mut self,
        parameter: &str,
        new: impl Fn(&Value) -> Option<Value>,
    ) -> Result<(), OverlayError> {
        let unknown = || OverlayError::UnknownParameter { parameter: parameter.to_owned() };
        let (component, field) = parameter.rsplit_once('.').ok_or_else(unknown)?;
        if let Some(edge) = self.edges.iter_mut().find(|edge| edge.id == component) {
            let schema = ElementParams::schema(edge.params.kind());
            let value = changed(parameter, field, edge.params.to_value(), schema.as_ref(), new)?;
            edge.params =
                deserialized(parameter, ElementParams::deserialize(edge.params.kind(), value))?;
            return Ok(());
        }
        if let Some(unit) = self.units.iter_mut().find(|unit| unit.id == component) {
            let schema = EquipmentParams::schema(unit.params.kind());
            let value = changed(parameter, field, unit.params.to_value(), schema.as_ref(), new)?;
            unit.params =
                deserialized(parameter, EquipmentParams::deserialize(unit.params.kind(), value))?;
            return Ok(());
        }
        if let Some(controller) = self.controllers.iter_mut().find(|c| c.id == component) {
            let kind = controller.params.kind();
            let schema = ControllerParams::schema(kind);
            let value =
                changed(parameter, field, controller.params.to_value(), schema.as_ref(), new)?;
            controller.params =
                deserialized(parameter, ControllerParams::deserialize(kind, value))?;
            return Ok(());
        }
        if let Some(circuit) = self.circuits.iter_mut().find(|circuit| circuit.id == component) {
            let schema = schemars::schema_for!(BranchSpec);
            let branch = circuit.branch.as_mut().ok_or_else(unknown)?;
            let value = changed(parameter, field, json!(branch), Some(&schema), new)?;
            *branch = deserialized(parameter, Some(serde_json::from_value(value)))?;
            return Ok(());
        }
        let sensor = self.sensors.iter_mut().find(|sensor| sensor.entry.id == component);
        if let Some(sensor) = sensor.filter(|_| !NAMES_OF_SENSORS.contains(&field)) {
            let schema = schemars::schema_for!(SensorEntry);
            let value = changed(parameter, field, json!(sensor.entry), Some(&schema), new)?;
            sensor.entry = deserialized(parameter, Some(serde_json::from_value(value)))?;
            return Ok(());
        }
        if component == "ground" && self.ground.has(field) {
            let schema = schemars::schema_for!(GroundEntry);
            let value = changed(parameter, field, json!(self.ground), Some(&schema), new)?;
            self.ground = deserialized(parameter, Some(serde_json::from_value(value)))?;
            return Ok(());
        }
        if component == "weather" {
            return self.change_weather(parameter, field, new);
        }
        Err(unknown())
    }

    /// Constant and made-up weather can be changed; a made-up year is made again.
    fn change_weather(
        &mut self,
        parameter: &str,
        field: &str,
        new: impl Fn(&Value) -> Option<Value>,
    ) -> Result<(), OverlayError> {
        let weather = self.weather.as_mut().filter(|weather| changes(&weather.entry, field));
        let Some(weather) = weather else {
            return Err(OverlayError::UnknownParameter { parameter: parameter.to_owned() });
        };
        let refused =
            |reason: String| OverlayError::Value { parameter: parameter.to_owned(), reason };
        let schema = schemars::schema_for!(WeatherEntry);
        let value = changed(parameter, field, json!(weather.entry), Some(&schema), new)?;
        let entry: WeatherEntry = deserialized(parameter, Some(serde_json::from_value(value)))?;
        if let Some((_, problem)) = entry.problems().into_iter().next() {
            return Err(refused(problem));
        }
        if entry.kind == WeatherKind::Synthetic && entry != weather.entry {
            let year =
                entry.synthetic().records().map_err(|problem| refused(problem.to_owned()))?;
            weather.records = Some(Arc::new(year));
        }
        weather.entry = entry;
        Ok(())
    }
}

/// Whether a field of the weather can be changed: numbers of constant and of made-up weather.
fn changes(weather: &WeatherEntry, field: &str) -> bool {
    let fixed = ["kind", "file", "means", "time_column", "separator"].contains(&field);
    weather.kind != WeatherKind::File && !fixed && weather.has(field)
}

/// The object with one field changed.
fn changed(
    parameter: &str,
    field: &str,
    mut object: Value,
    schema: Option<&schemars::Schema>,
    new: impl Fn(&Value) -> Option<Value>,
) -> Result<Value, OverlayError> {
    let known = schema.map(crate::grammar::property_names).unwrap_or_default();
    if !known.iter().any(|name| name == field) {
        return Err(OverlayError::UnknownParameter { parameter: parameter.to_owned() });
    }
    let old = object.get(field).cloned().unwrap_or(Value::Null);
    let value = new(&old).ok_or_else(|| OverlayError::Value {
        parameter: parameter.to_owned(),
        reason: format!("{old} is not a number that can be scaled"),
    })?;
    object[field] = value;
    Ok(object)
}

fn deserialized<T>(
    parameter: &str,
    result: Option<Result<T, serde_json::Error>>,
) -> Result<T, OverlayError> {
    match result {
        Some(Ok(params)) => Ok(params),
        Some(Err(error)) => {
            Err(OverlayError::Value { parameter: parameter.to_owned(), reason: error.to_string() })
        }
        None => Err(OverlayError::UnknownParameter { parameter: parameter.to_owned() }),
    }
}
