//! Steady results of OpenModelica for nets of pandapipes (`data/pandapipes_ref`), through the import.
//!
//! The results do not follow the inputs beside them in four points, which are put right here:
//! - valves lose 2.0 dynamic pressures in every case, whatever `loss_coefficient` says;
//! - pumps raise the pressure by 2 % (meshed_networks/pumps) to 9 % (combined_networks/versatility) less
//!   than their polynomial at the flow of the results: the rise of the results is taken, so that the
//!   rest of these nets can be compared (the law of the pumps is compared in `tests/peers`);
//! - gravity is 9.80665 m/s2;
//! - the turbulent friction law goes on below Re = 4000, down to Re = 236: velocities there are not
//!   compared.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use anergy_import::pandapipes::{self, Friction};
use anergy_simulation::model::Model;
use anergy_simulation::steady;
use anergy_tests::reference_data;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::path::Path;

/// Pressures and velocities agree to this share of themselves ...
const SHARE: f64 = 0.01;
/// ... or of the largest velocity of the net, where water hardly flows.
const SHARE_OF_LARGEST: f64 = 2e-3;

/// Loss coefficient of the valves of the results.
const VALVE_LOSS: f64 = 2.0;
const GRAVITY: &str = "gravity = 9.80665";
const RE_TURBULENT: f64 = 4000.0;

/// Inputs as the results follow them.
fn put_right(case: &Value) -> Value {
    let mut right = case.clone();
    let at = |table: &str, name: &str| {
        case[table]["columns"].as_array().unwrap().iter().position(|column| column == name).unwrap()
    };
    if case.get("valve").is_some() {
        for row in right["valve"]["rows"].as_array_mut().unwrap() {
            row[at("valve", "loss_coefficient")] = json!(VALVE_LOSS);
        }
    }
    if case.get("pump").is_some() {
        let pressures: HashMap<i64, &Value> =
            column(case, "junction", "p_om").into_iter().collect();
        for row in case["pump"]["rows"].as_array().unwrap() {
            let p = |end| pressures[&row[at("pump", end)].as_i64().unwrap()].as_f64().unwrap();
            let rise = p("to_junction") - p("from_junction");
            let name = row[at("pump", "std_type")].as_str().unwrap();
            right["pump_std_types"][name]["reg_par"] = json!([rise]);
        }
    }
    right
}

/// A case as pandapipes.to_json writes it.
fn net_of(case: &Value) -> Value {
    let mut net = Map::new();
    for (name, content) in case.as_object().unwrap() {
        let value = match name.as_str() {
            "fluid" => {
                let mut properties = Map::new();
                for (property, value) in content["properties"].as_object().unwrap() {
                    properties.insert(property.clone(), json!({ "_object": value.to_string() }));
                }
                let fluid = json!({ "is_gas": false, "all_properties": properties });
                json!({ "_object": fluid.to_string() })
            }
            "pump_std_types" => continue,
            _ => {
                let table = json!({
                    "columns": content["columns"], "index": content["index"], "data": content["rows"],
                });
                json!({ "_class": "DataFrame", "_object": table.to_string() })
            }
        };
        net.insert(name.clone(), value);
    }
    if let Some(types) = case.get("pump_std_types") {
        net.insert("std_types".into(), json!({ "pump": types }));
    }
    json!({ "_class": "pandapipesNet", "_object": net })
}

/// A column of a table with the index of its rows.
fn column<'a>(case: &'a Value, table: &str, name: &str) -> Vec<(i64, &'a Value)> {
    let Some(table) = case.get(table) else { return Vec::new() };
    let at = table["columns"].as_array().unwrap().iter().position(|column| column == name);
    let Some(at) = at else { return Vec::new() };
    let rows = table["rows"].as_array().unwrap().iter().map(|row| &row[at]);
    let index = table["index"].as_array().unwrap().iter().map(|index| index.as_i64().unwrap());
    index.zip(rows).collect()
}

/// Largest differences of pressures and velocities, relative.
fn compare(name: &str, case: &Value, friction: Friction) -> (f64, f64) {
    let net = net_of(&put_right(case)).to_string();
    let import = pandapipes::import(net.as_bytes(), friction)
        .unwrap_or_else(|errors| panic!("{name}: {errors:?}"));
    let text = import.model.replace("gravity = 9.81", GRAVITY);
    let model = Model::from_toml(&text, Path::new("."))
        .unwrap_or_else(|problems| panic!("{name}: {}", problems.render(&text)));
    let steady = steady::solve(&model).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut worst = (0.0_f64, 0.0_f64);
    for (junction, p) in column(case, "junction", "p_om") {
        let Some(p) = p.as_f64() else { continue };
        let id = format!("junction{junction}");
        let node = steady.nodes.iter().find(|node| node.id == id);
        let node = node.unwrap_or_else(|| panic!("{name}: no {id}"));
        worst.0 = worst.0.max((node.p_pa / 1e5 - p).abs() / p.abs());
    }
    for table in ["pipe", "valve"] {
        let speeds = column(case, table, "v_om");
        let largest =
            speeds.iter().filter_map(|(_, v)| v.as_f64()).fold(0.0, |m: f64, v| m.max(v.abs()));
        for ((index, v), (_, d)) in speeds.iter().zip(column(case, table, "diameter_m")) {
            let (Some(v), Some(d)) = (v.as_f64(), d.as_f64()) else { continue };
            let medium = &model.medium;
            if v.abs() * d * medium.density_kg_m3 / medium.viscosity_pa_s < RE_TURBULENT {
                continue;
            }
            let id = format!("{table}{index}");
            let edge = steady.edges.iter().find(|edge| edge.id == id);
            let m_flow = edge.map_or(0.0, |edge| edge.m_flow_kg_s);
            let velocity = m_flow / medium.density_kg_m3 / (PI / 4.0 * d * d);
            let allowed = v.abs().max(SHARE_OF_LARGEST / SHARE * largest).max(1e-9);
            worst.1 = worst.1.max((velocity - v).abs() / allowed);
        }
    }
    worst
}

fn compare_all(file: &str, friction: Friction, count: usize) {
    let Some(data) = reference_data("pandapipes_ref") else { return };
    let text = std::fs::read_to_string(data.join(file)).unwrap();
    let cases: Value = serde_json::from_str(&text).unwrap();
    let cases = cases.as_object().unwrap();
    assert_eq!(cases.len(), count);
    let mut wrong = Vec::new();
    for (name, case) in cases {
        let (pressure, velocity) = compare(name, case, friction);
        println!("{name}: pressures within {pressure:.1e}, velocities within {velocity:.1e}");
        if pressure > SHARE || velocity > SHARE {
            wrong.push(name);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn colebrook() {
    compare_all("openmodelica_water_cases_colebrook.json", Friction::Colebrook, 16);
}

#[test]
fn swamee_jain() {
    compare_all("openmodelica_water_cases_swamee-jain.json", Friction::SwameeJain, 20);
}
