//! The JSON Schema of the model file, assembled from the entries and the registries.

use super::*;
use crate::effects::EffectParams;
use anergy_control::controllers::{ControllerParams, ports};
use anergy_control::sensor::SensorEntry;
use anergy_core::units::alternatives;
use anergy_network::elements::ElementParams;
use anergy_network::elements::pipe::PipeParams;
use anergy_prosumer::equipment::EquipmentParams;
use anergy_prosumer::performance_map::params::PerformanceMapParams;
use schemars::{Schema, schema_for};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// The JSON Schema (2020-12) of a model file, with every unit a field can be written in.
pub fn schema() -> Value {
    let list = |items: Value| json!({ "type": "array", "items": items });
    let edge_ends = [
        ("id", text("Name of the edge")),
        ("from", text("Node at port a")),
        ("to", text("Node at port b")),
    ];
    let trench = {
        let own = [
            ("id", text("Name; default from-to")),
            ("from", text("Site at port a")),
            ("to", text("Site at port b")),
            ("pipe", text("Name of a pipe_type, or of a pipe of the catalogue")),
        ];
        let mut trench = entry(&schema_for!(PipeParams), &own);
        trench["required"] = json!(["from", "to"]);
        for field in ["companion", "companion_reversed"] {
            trench["properties"].as_object_mut().and_then(|fields| fields.remove(field));
        }
        trench
    };
    let on = [("pipe", text("Name of a pipe of the catalogue on which it builds"))];
    let mut pipe_type = entry(&schema_for!(PipeParams), &on);
    if let Some(object) = pipe_type.as_object_mut() {
        object.remove("required");
    }
    // Several valves with one command: its own fields and those of a valve.
    let valves = |own: &schemars::Schema, required: &[&str]| {
        let own = entry(own, &[]);
        let properties = own["properties"].as_object().into_iter().flatten();
        let own: Vec<(&str, Value)> =
            properties.map(|(name, schema)| (name.as_str(), schema.clone())).collect();
        let mut valve =
            ElementParams::schema("valve").map_or(json!({}), |valve| entry(&valve, &own));
        for field in ["command_of", "inverse"] {
            valve["properties"].as_object_mut().and_then(|fields| fields.remove(field));
        }
        valve["required"] = json!(required);
        valve
    };
    let three_way_valve = valves(&schema_for!(ThreeWayValveEntry), &["id", "a", "b", "ab"]);
    let four_way_mixer = valves(
        &schema_for!(FourWayMixerEntry),
        &["id", "source_supply", "source_return", "load_supply", "load_return"],
    );
    let station = station_schema();
    let mut station_type = station.clone();
    for schema in station_type["oneOf"].as_array_mut().into_iter().flatten() {
        schema["required"] = json!(["kind"]);
    }
    let reference = entry(&schema_for!(PressureReferenceEntry), &[]);
    let properties = json!({
        "format": { "const": 1, "description": "Version of the file format" },
        "model": entry(&schema_for!(ModelEntry), &[]),
        "run": entry(&schema_for!(RunEntry), &[]),
        "fluid": entry(&schema_for!(FluidEntry), &[]),
        "ground": entry(&schema_for!(GroundEntry), &[]),
        "weather": entry(&schema_for!(WeatherEntry), &[]),
        "tolerance": entry(&schema_for!(ToleranceEntry), &[]),
        "pipe_type": { "type": "object", "additionalProperties": pipe_type },
        "heat_pump_map": {
            "type": "object",
            "additionalProperties": entry(&schema_for!(PerformanceMapParams), &[]),
        },
        "network": entry(&schema_for!(NetworkEntry), &[]),
        "station_type": { "type": "object", "additionalProperties": station_type },
        "house_type": { "type": "object", "additionalProperties": house_schema(&[]) },
        "house": list(house_schema(&["site", "type", "connection", "set", "without"])),
        "site": list(entry(&schema_for!(SiteEntry), &[])),
        "trench": list(trench),
        "station": list(station),
        "node": list(entry(&schema_for!(NodeEntry), &[])),
        "edge": list(kinds("kind", ElementParams::KINDS, ElementParams::schema, &edge_ends, &["id", "from", "to"])),
        "three_way_valve": list(three_way_valve),
        "four_way_mixer": list(four_way_mixer),
        "interface": list(entry(&schema_for!(InterfaceEntry), &[])),
        "unit": list(kinds(
            "kind",
            EquipmentParams::KINDS,
            EquipmentParams::schema,
            &[
                ("site", text("Site whose station it stands behind, or whose circuits it is part of")),
                ("name", text("Name within its site; default unit")),
                ("station", text("Name of the station; default station")),
                ("id", text("Name, where no site is given")),
                ("port", text("Edge it stands on, where no site is given and not all its ports are in circuits")),
            ],
            &[],
        )),
        "circuit": list(entry(&schema_for!(CircuitEntry), &[])),
        "sensor": list(entry(&schema_for!(SensorEntry), &[])),
        "controller": list(controllers()),
        "worst_point": list(entry(&schema_for!(WorstPointEntry), &[])),
        "prescribed": list(entry(&schema_for!(PrescribedEntry), &[])),
        "schedule": list(entry(&schema_for!(ScheduleEntry), &[])),
        "series": list(entry(&schema_for!(SeriesEntry), &[])),
        "pressure_reference": { "oneOf": [reference.clone(), list(reference)] },
        "effect": list(kinds(
            "id",
            EffectParams::KINDS,
            EffectParams::schema,
            &[
                ("component", text("Component it belongs to")),
                ("because", text("Why it is here; changes nothing")),
                ("ci95", json!({ "description": "Interval of the value; changes nothing" })),
            ],
            &["component"],
        )),
    });
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "anergy model file",
        "type": "object",
        "properties": properties,
        "required": ["format"],
        "additionalProperties": false,
    })
}

/// The stations with parts, the plant, and the stations in the grid water.
fn station_schema() -> Value {
    let own = [
        ("type", json!({ "type": "string", "description": "Name of a station_type" })),
        ("unit", json!({ "type": "object", "description": "The unit behind it, like a [[unit]]" })),
    ];
    let with_parts = |schema: &Schema, own: &[(&str, Value)], kinds: &[StationKind]| {
        let mut station = entry(schema, own);
        // A type may say what it is.
        station["required"] = json!(["site"]);
        station["properties"]["kind"] = json!({ "enum": kinds, "description": "What it can do" });
        let parts: BTreeSet<&str> =
            kinds.iter().flat_map(|kind| expand::parts_of(*kind)).copied().collect();
        for part in parts {
            station["properties"][part] = part_schema(part);
        }
        station
    };
    let stations = [
        StationKind::Bidirectional,
        StationKind::Consumer,
        StationKind::Producer,
        StationKind::PrescribedFlow,
    ];
    let station = with_parts(&schema_for!(StationEntry), &own, &stations);
    let plant = with_parts(&schema_for!(PlantEntry), &own[..1], &[StationKind::Plant]);
    let prosumer = schema_for!(ProsumerEntry);
    let prosumer = with_parts(&prosumer, &own, &[StationKind::Prosumer]);
    let balancing = schema_for!(BalancingUnitEntry);
    let balancing = with_parts(&balancing, &own, &[StationKind::BalancingUnit]);
    json!({ "oneOf": [station, plant, prosumer, balancing] })
}

/// A house or its type: entries of other sections, within the house.
fn house_schema(own: &[&str]) -> Value {
    let mut properties = Map::new();
    for part in ["station", "unit", "circuit", "sensor", "controller", "schedule", "series"] {
        let one_or_more = json!({
            "description": format!("As [[{part}]], with names within the house"),
            "anyOf": [{ "type": "object" }, { "type": "array", "items": { "type": "object" } }],
        });
        properties.insert(part.into(), one_or_more);
    }
    for field in own {
        let schema = match *field {
            "site" => text("Site that it stands at"),
            "type" => json!({
                "type": ["string", "array"],
                "items": { "type": "string" },
                "description": "Name of a house_type or of a house of the library (SF1, SF2, SF3, SF4, MF5), or a list of them",
            }),
            "connection" => json!({
                "type": "string",
                "enum": ["four_pipe", "two_pipe"],
                "description": "two_pipe: ports of a storage of its type at the same two heights become one pair of pipes that takes the difference",
            }),
            "without" => json!({
                "type": "array",
                "items": { "type": "string" },
                "description": "Parts of its type that are left out",
            }),
            _ => {
                json!({ "type": "object", "description": "Single fields: \"storage.volume_l\" = 500" })
            }
        };
        properties.insert((*field).into(), schema);
    }
    let required: Vec<&str> = own.iter().copied().filter(|field| *field == "site").collect();
    json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false })
}

fn part_schema(part: &str) -> Value {
    let schema = expand::part_kind(part).and_then(ElementParams::schema);
    let mut schema = schema.map_or(json!({}), |schema| entry(&schema, &[]));
    if let Some(object) = schema.as_object_mut() {
        object.remove("required");
    }
    if part == "stub" {
        schema["properties"]["pipe"] = json!({ "type": "string", "description": "Name of a pipe_type, or of a pipe of the catalogue" });
    }
    schema
}

fn text(description: &str) -> Value {
    json!({ "type": "string", "description": description })
}

/// The controllers: each kind names its own channels and signals.
fn controllers() -> Value {
    let of_kind = |kind: &&str| {
        let ports = ports(kind);
        let mut own =
            vec![("id", text("Name; default that of the first signal, with .controller"))];
        own.extend(ports.measures.iter().map(|field| (*field, text("Channel it measures"))));
        own.extend(ports.acts_on.iter().map(|field| (*field, text("Signal it drives"))));
        let mut required: Vec<&str> = ports.measures.iter().chain(ports.acts_on).copied().collect();
        if *kind == "rule" {
            required = vec!["on"];
        }
        if *kind == "weighted_pi" {
            let meaning =
                "Station whose channels and signals it takes where they are not named one by one";
            own.push(("station", text(meaning)));
            required.clear();
        }
        let schema = |_: &str| ControllerParams::schema(kind);
        let mut one = kinds("kind", &[kind], schema, &own, &required);
        one["oneOf"].take().as_array_mut().and_then(Vec::pop)
    };
    json!({ "oneOf": ControllerParams::KINDS.iter().filter_map(of_kind).collect::<Vec<_>>() })
}

/// One schema per kind, chosen by the word of `field`.
fn kinds(
    field: &str,
    words: &[&str],
    schema: impl Fn(&str) -> Option<Schema>,
    own: &[(&str, Value)],
    required: &[&str],
) -> Value {
    let variants: Vec<Value> = words
        .iter()
        .filter_map(|word| {
            let mut own = own.to_vec();
            own.insert(0, (field, json!({ "const": word })));
            if *word == "pipe" {
                own.push((
                    "pipe",
                    json!({ "type": "string", "description": "Name of a pipe_type, or of a pipe of the catalogue" }),
                ));
            }
            let mut variant = entry(&schema(word)?, &own);
            let mut all: Vec<Value> = vec![json!(field)];
            all.extend(required.iter().map(|name| json!(name)));
            // A pipe may take its dimensions from a type; fields with units have alternatives.
            variant["required"] = Value::Array(all);
            Some(variant)
        })
        .collect();
    json!({ "oneOf": variants })
}

/// An entry's schema: local definitions resolved, own fields first, all units of every field.
fn entry(schema: &Schema, own: &[(&str, Value)]) -> Value {
    let mut value = schema.as_value().clone();
    let definitions = value.get("$defs").cloned().unwrap_or(Value::Null);
    resolve(&mut value, &definitions);
    let Some(object) = value.as_object_mut() else { return value };
    object.remove("$defs");
    object.remove("$schema");
    object.remove("title");
    let mut properties: Map<String, Value> =
        own.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
    let known = object.get("properties").and_then(Value::as_object).cloned().unwrap_or_default();
    let mut required: Vec<Value> = Vec::new();
    for (name, property) in &known {
        let mut property = property.clone();
        nested_units(&mut property);
        properties.insert(name.clone(), property.clone());
        properties.extend(other_units(name, &property));
        let needed = object
            .get("required")
            .and_then(Value::as_array)
            .is_some_and(|all| all.iter().any(|required| required == name));
        if needed && alternatives(name).next().is_none() {
            required.push(json!(name));
        }
    }
    object.insert("properties".into(), Value::Object(properties));
    object.insert("required".into(), Value::Array(required));
    object.insert("additionalProperties".into(), json!(false));
    value
}

/// A property in its other units.
fn other_units(name: &str, property: &Value) -> Vec<(String, Value)> {
    let other = alternatives(name).map(|(alternative, unit)| {
        let mut converted = property.clone();
        if let Some(object) = converted.as_object_mut() {
            object.remove("default");
            let description = format!("{name} in {}", unit.suffix.replace('_', "/"));
            object.insert("description".into(), json!(description));
        }
        (alternative, converted)
    });
    other.collect()
}

/// All units of the fields of tables within a property.
fn nested_units(property: &mut Value) {
    match property {
        Value::Object(object) => {
            object.values_mut().for_each(nested_units);
            let Some(known) = object.get("properties").and_then(Value::as_object).cloned() else {
                return;
            };
            let mut all = known.clone();
            all.extend(known.iter().flat_map(|(name, property)| other_units(name, property)));
            object.insert("properties".into(), Value::Object(all));
            if let Some(required) = object.get_mut("required").and_then(Value::as_array_mut) {
                // A field with units has alternatives.
                required.retain(|name| {
                    name.as_str().is_none_or(|name| alternatives(name).next().is_none())
                });
            }
        }
        Value::Array(items) => items.iter_mut().for_each(nested_units),
        _ => {}
    }
}

/// Replaces references to local definitions by the definitions.
fn resolve(value: &mut Value, definitions: &Value) {
    match value {
        Value::Object(object) => {
            let target = object
                .get("$ref")
                .and_then(Value::as_str)
                .and_then(|path| path.strip_prefix("#/$defs/"))
                .and_then(|name| definitions.get(name))
                .cloned();
            if let Some(Value::Object(mut target)) = target {
                object.remove("$ref");
                for (key, value) in std::mem::take(object) {
                    target.insert(key, value);
                }
                *object = target;
            }
            for child in object.values_mut() {
                resolve(child, definitions);
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| resolve(item, definitions)),
        _ => {}
    }
}
