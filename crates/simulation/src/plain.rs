//! A model as plain entries (`anergy check --expand`) and the defaults it uses
//! (`anergy check --explain-defaults`).

use crate::diagnostic::Diagnostics;
use crate::document::Span;
use crate::document::to_toml;
use crate::model::{Model, Place};
use crate::model_file::{FluidEntry, GroundEntry, ToleranceEntry, WeatherEntry};
use anergy_network::elements::ElementParams;
use serde_json::{Map, Value, json};

impl Model {
    /// The model as a file of plain nodes and edges, in SI: reads back as the same model.
    ///
    /// # Errors
    /// When a value cannot be written as TOML.
    pub fn to_plain_toml(&self) -> Result<String, Diagnostics> {
        let mut file = Map::new();
        file.insert("format".into(), json!(1));
        let mut about = json!({ "name": self.name, "gravity": self.gravity_m_s2 });
        if self.thermosiphon {
            about["thermosiphon"] = json!(true);
        }
        if self.dissipation {
            about["dissipation"] = json!(true);
        }
        if self.fluid_inertia {
            about["fluid_inertia"] = json!(true);
        }
        if let Some([latitude, longitude]) = self.origin_rad {
            about["latitude_rad"] = json!(latitude);
            about["longitude_rad"] = json!(longitude);
        }
        file.insert("model".into(), about);
        file.insert("run".into(), without_nulls(json!(self.run)));
        file.insert("fluid".into(), FluidEntry::of(&self.medium, self.follow_temperature));
        file.insert("ground".into(), self.plain_ground());
        if let Some(weather) = &self.weather {
            file.insert("weather".into(), plain_weather(&weather.entry));
        }
        if self.tolerance != ToleranceEntry::default() {
            file.insert("tolerance".into(), json!(self.tolerance));
        }
        let mut section = |name: &str, entries: Vec<Value>| {
            if !entries.is_empty() {
                file.insert(name.into(), entries.into_iter().map(without_nulls).collect());
            }
        };
        section(
            "pressure_reference",
            self.references.iter().map(|reference| json!(reference.entry)).collect(),
        );
        section("node", self.nodes.iter().map(|node| json!(node.entry)).collect());
        section(
            "edge",
            self.edges
                .iter()
                .map(|edge| {
                    let head = json!({
                        "id": edge.id, "kind": edge.params.kind(), "from": edge.from, "to": edge.to
                    });
                    joined(head, edge.params.to_value())
                })
                .collect(),
        );
        section(
            "interface",
            self.interfaces.iter().map(|interface| without_nulls(json!(interface.entry))).collect(),
        );
        section(
            "unit",
            self.units
                .iter()
                .map(|unit| {
                    let mut head = json!({ "id": unit.id, "kind": unit.params.kind() });
                    if !unit.port.is_empty() {
                        head["port"] = json!(unit.port);
                    }
                    joined(head, unit.params.to_value())
                })
                .collect(),
        );
        section(
            "circuit",
            self.circuits
                .iter()
                .map(|circuit| {
                    let whole = json!({
                        "id": circuit.id,
                        "through": circuit.through,
                        "v_flow_m3_s": circuit.v_flow_m3_s,
                    });
                    without_nulls(match &circuit.branch {
                        Some(branch) => joined(whole, json!(branch)),
                        None => whole,
                    })
                })
                .collect(),
        );
        section(
            "sensor",
            self.sensors.iter().map(|sensor| without_nulls(json!(sensor.entry))).collect(),
        );
        section(
            "controller",
            self.controllers
                .iter()
                .map(|controller| {
                    let mut head = json!({ "id": controller.id, "kind": controller.params.kind() });
                    for (field, name) in controller.named() {
                        head[field] = json!(name);
                    }
                    joined(head, controller.params.to_value())
                })
                .collect(),
        );
        section("worst_point", self.worst_points.iter().map(|point| json!(point.entry)).collect());
        section(
            "prescribed",
            self.prescriptions
                .iter()
                .map(|spec| joined(json!({ "id": spec.id }), without_nulls(json!(spec.entry))))
                .collect(),
        );
        section(
            "schedule",
            self.drivers
                .iter()
                .map(|driver| {
                    let points: Vec<(f64, f64)> =
                        driver.times_s.iter().copied().zip(driver.values.iter().copied()).collect();
                    json!({
                        "signal": driver.signal,
                        "unit": driver.unit,
                        "interpolation": driver.interpolation,
                        "points": points,
                    })
                })
                .collect(),
        );
        section(
            "effect",
            self.effects
                .iter()
                .map(|spec| {
                    let head = json!({ "id": spec.params.kind(), "component": spec.component });
                    let told = Value::Object(spec.provenance.clone());
                    joined(joined(head, spec.params.to_value()), told)
                })
                .collect(),
        );
        to_toml(&file)
    }

    /// The ground, with the fields of its kind.
    fn plain_ground(&self) -> Value {
        let mut ground = json!(self.ground);
        if let Some(fields) = ground.as_object_mut() {
            fields.retain(|field, _| self.ground.has(field));
        }
        ground
    }

    /// Every value that was not given: component, field, value and where it comes from.
    pub fn defaults(&self) -> Vec<DefaultValue> {
        let mut defaults = Vec::new();
        let schema = schemars::schema_for!(GroundEntry);
        collect(&mut defaults, "ground", &self.plain_ground(), Some(schema), &self.ground_place);
        defaults.retain(|default| self.ground.has(&default.field));
        for default in &mut defaults {
            default.source = GroundEntry::source(&default.field);
        }
        if let Some(weather) = &self.weather {
            let (schema, values) =
                (schemars::schema_for!(WeatherEntry), plain_weather(&weather.entry));
            let first = defaults.len();
            collect(&mut defaults, "weather", &values, Some(schema), &weather.place);
            let mut own = defaults.split_off(first);
            own.retain(|default| weather.entry.has(&default.field) && !default.value.is_null());
            defaults.extend(own);
        }
        for edge in &self.edges {
            let schema = ElementParams::schema(edge.params.kind());
            let first = defaults.len();
            collect(&mut defaults, &edge.id, &edge.params.to_value(), schema, &edge.place);
            if let ElementParams::Pipe(pipe) = &edge.params {
                for (field, value, source) in pipe.layer_defaults(&self.ground.ground()) {
                    let own = defaults[first..].iter_mut().find(|default| default.field == field);
                    if let Some(default) = own {
                        (default.value, default.source) = (json!(value), source);
                    }
                }
            }
        }
        for unit in &self.units {
            let schema = anergy_prosumer::equipment::EquipmentParams::schema(unit.params.kind());
            collect(&mut defaults, &unit.id, &unit.params.to_value(), schema, &unit.place);
        }
        for controller in &self.controllers {
            let params = &controller.params;
            let schema = anergy_control::controllers::ControllerParams::schema(params.kind());
            collect(&mut defaults, &controller.id, &params.to_value(), schema, &controller.place);
        }
        for sensor in &self.sensors {
            let schema = Some(schemars::schema_for!(anergy_control::sensor::SensorEntry));
            let values = json!(sensor.entry);
            collect(&mut defaults, &sensor.entry.id, &values, schema, &sensor.place);
        }
        for effect in &self.effects {
            let schema = crate::effects::EffectParams::schema(effect.params.kind());
            let name = format!("effect {} of {}", effect.params.kind(), effect.component);
            collect(&mut defaults, &name, &effect.params.to_value(), schema, &effect.place);
        }
        defaults
    }
}

/// The weather, with the fields of its kind.
fn plain_weather(entry: &WeatherEntry) -> Value {
    let mut weather = json!(entry);
    if let Some(fields) = weather.as_object_mut() {
        fields.retain(|field, _| entry.has(field));
    }
    weather
}

/// A value that the model file did not give.
#[derive(Debug, Clone, PartialEq)]
pub struct DefaultValue {
    /// The component.
    pub component: String,
    /// The field, in SI.
    pub field: String,
    /// Its value; `null` where it follows from something else.
    pub value: Value,
    /// Where it comes from.
    pub source: &'static str,
    /// What the field means.
    pub meaning: String,
}

fn collect(
    defaults: &mut Vec<DefaultValue>,
    component: &str,
    values: &Value,
    schema: Option<schemars::Schema>,
    place: &Place,
) {
    let Some(schema) = schema else { return };
    let properties = schema.get("properties").and_then(Value::as_object);
    for (field, property) in properties.into_iter().flatten() {
        // What a composite filled in stands at the place of the whole entry.
        let given = place.fields.iter().find(|written| written.si() == field);
        let source = match given {
            Some(written) if written.span != Span::NONE && written.span == place.span => {
                let others = [", circulation_pump", ", generator"];
                if others.iter().any(|part| place.entry.ends_with(part))
                    || ["three_way_valve", "four_way_mixer"]
                        .iter()
                        .any(|section| place.entry.starts_with(section))
                {
                    "the composite's default"
                } else {
                    "the published station of the laboratory"
                }
            }
            Some(_) => continue,
            None => "the component's default",
        };
        let meaning = property.get("description").and_then(Value::as_str).unwrap_or_default();
        defaults.push(DefaultValue {
            component: component.to_owned(),
            field: field.clone(),
            value: values.get(field).cloned().unwrap_or(Value::Null),
            source,
            meaning: meaning.to_owned(),
        });
    }
}

fn joined(mut head: Value, tail: Value) -> Value {
    if let (Some(head), Value::Object(tail)) = (head.as_object_mut(), tail) {
        head.extend(tail);
    }
    head
}

fn without_nulls(mut value: Value) -> Value {
    if let Some(object) = value.as_object_mut() {
        object.retain(|_, value| !value.is_null());
    }
    value
}
