//! Steady snapshots of EPANET (`data/epanet`): Darcy-Weisbach with EPANET's friction law and gravity,
//! read into the model format and solved as `anergy solve` does.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use anergy_simulation::model::Model;
use anergy_simulation::steady;
use anergy_tests::reference_data;
use serde_json::Value;
use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

/// Heads agree within this share of the span of all heads.
const HEAD_SHARE: f64 = 1e-5;
/// Flows agree within this share of the largest flow ...
const FLOW_SHARE: f64 = 1e-5;
/// ... or within what EPANET lets through a closed link, m3/s.
const CLOSED_LINK_M3_S: f64 = 2e-7;
/// Heads for which the curve of a pump of constant power is written, m, and the ratio of neighbours.
const POWER_HEADS_M: (f64, f64) = (1000.0, 1.0);
const POWER_STEP: f64 = 1.02;

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} of {value}"))
}

fn quoted(text: &Value) -> String {
    text.to_string()
}

/// The model file of a snapshot. Closed links are left out, and nodes to which nothing else leads.
fn model_of(case: &Value) -> String {
    let (density, gravity) =
        (number(&case["fluid"], "density_kg_m3"), number(&case["fluid"], "gravity_m_s2"));
    let viscosity = number(&case["fluid"], "kinematic_viscosity_m2_s") * density;
    let mut text = format!(
        "format = 1\n[model]\ngravity = {gravity:?}\n[fluid]\ndensity_kg_m3 = {density:?}\n\
         viscosity_pa_s = {viscosity:?}\n"
    );
    let open = |edge: &&Value| edge["initial_status"] != "closed";
    let edges: Vec<&Value> = case["edges"].as_array().unwrap().iter().filter(open).collect();
    let has_edge = |node: &&Value| {
        edges.iter().any(|edge| edge["from"] == node["id"] || edge["to"] == node["id"])
    };
    for node in case["nodes"].as_array().unwrap().iter().filter(has_edge) {
        let id = quoted(&node["id"]);
        let rest = if node["kind"] == "junction" {
            let m_flow = -density * number(node, "demand_m3_s");
            let elevation = number(node, "elevation_m");
            format!("kind = \"source\"\nm_flow_kg_s = {m_flow:?}\nelevation_m = {elevation:?}")
        } else {
            let head = number(node, "head_m");
            format!("kind = \"pressure_boundary\"\npressure_pa = 0.0\nelevation_m = {head:?}")
        };
        writeln!(text, "[[node]]\nid = {id}\n{rest}").unwrap();
    }
    for edge in edges {
        let rest = match edge["kind"].as_str().unwrap() {
            "pipe" => format!(
                "kind = \"pipe\"\nlength_m = {:?}\ninner_diameter_m = {:?}\nroughness_m = {:?}\n\
                 zeta = {:?}\nfriction = \"swamee_jain\"\ntransition = \"dunlop\"",
                number(edge, "length_m"),
                number(edge, "diameter_m"),
                number(edge, "roughness_m"),
                number(edge, "minor_loss_k"),
            ),
            "pump" => pump(edge, density * gravity),
            other => panic!("{other} is not in the snapshots"),
        };
        let (id, from, to) = (quoted(&edge["id"]), quoted(&edge["from"]), quoted(&edge["to"]));
        writeln!(text, "[[edge]]\nid = {id}\nfrom = {from}\nto = {to}\n{rest}").unwrap();
    }
    text
}

fn pump(edge: &Value, pa_m: f64) -> String {
    let (curve, speed) = (&edge["curve"], number(edge, "speed"));
    let curve = if curve["type"] == "const_power" {
        let head_times_flow = number(curve, "head_times_flow_m4_s");
        let (highest, lowest) = POWER_HEADS_M;
        let steps = ((highest / lowest).ln() / POWER_STEP.ln()).ceil() as i32;
        let heads: Vec<f64> = (0..=steps).map(|i| highest * POWER_STEP.powi(-i)).collect();
        let flows: Vec<f64> = heads.iter().map(|head| head_times_flow / head).collect();
        // A curve begins at zero flow: the hyperbola is left along its tangent.
        let flows: Vec<f64> = std::iter::once(0.0).chain(flows).collect();
        let heads: Vec<f64> =
            std::iter::once(2.0 * highest).chain(heads).map(|head| head * pa_m).collect();
        format!("curve_v_flow_m3_s = {flows:?}\ncurve_head_pa = {heads:?}")
    } else {
        let (h0, r, n) = (number(curve, "h0_m"), number(curve, "r"), number(curve, "n"));
        format!(
            "head_max_pa = {:?}\nfree_flow_m3_s = {:?}\ncurve_exponent = {n:?}",
            h0 * pa_m,
            (h0 / r).powf(1.0 / n)
        )
    };
    format!("kind = \"pump\"\nspeed = {speed:?}\ninitial_speed = {speed:?}\n{curve}")
}

fn compare(case: &Value) {
    let name = case["name"].as_str().unwrap();
    let text = model_of(case);
    let model = Model::from_toml(&text, Path::new("."))
        .unwrap_or_else(|problems| panic!("{name}: {}", problems.render(&text)));
    let steady = steady::solve(&model).unwrap_or_else(|error| panic!("{name}: {error}"));
    let density = number(&case["fluid"], "density_kg_m3");
    let pa_m = density * number(&case["fluid"], "gravity_m_s2");

    let expected = &case["expected"]["node_head_m"];
    let heads: Vec<f64> = expected.as_object().unwrap().values().flat_map(Value::as_f64).collect();
    let span = heads.iter().fold(f64::MIN, |a, b| a.max(*b))
        - heads.iter().fold(f64::MAX, |a, b| a.min(*b));
    let mut worst_head = 0.0_f64;
    for node in &steady.nodes {
        let head = node.elevation_m + node.p_pa / pa_m;
        let difference = (head - number(expected, &node.id)).abs();
        worst_head = worst_head.max(difference / span);
    }
    let expected = &case["expected"]["edge_flow_m3_s"];
    let flows: HashMap<&str, f64> =
        steady.edges.iter().map(|edge| (edge.id.as_str(), edge.m_flow_kg_s / density)).collect();
    let largest = expected.as_object().unwrap().values().flat_map(Value::as_f64);
    let largest = largest.fold(0.0, |most: f64, flow| most.max(flow.abs()));
    let mut worst_flow = (0.0_f64, String::new());
    for edge in case["edges"].as_array().unwrap() {
        let id = edge["id"].as_str().unwrap();
        let flow = flows.get(id).copied().unwrap_or(0.0);
        let difference = (flow - number(expected, id)).abs();
        if difference > worst_flow.0 {
            worst_flow = (difference, id.to_owned());
        }
    }
    println!(
        "{name}: {} nodes, {} edges, heads within {worst_head:.1e} of their span, flows within {:.1e} \
         m3/s ({:.1e} of the largest) at {}, {} iterations",
        steady.nodes.len(),
        steady.edges.len(),
        worst_flow.0,
        worst_flow.0 / largest,
        worst_flow.1,
        steady.iterations
    );
    assert!(heads.len() <= steady.nodes.len() + 1, "{name}");
    assert!(worst_head <= HEAD_SHARE, "{name}: heads differ by {worst_head:e} of their span");
    let allowed = (FLOW_SHARE * largest).max(CLOSED_LINK_M3_S);
    assert!(
        worst_flow.0 <= allowed,
        "{name}: flow of {} differs by {:e}",
        worst_flow.1,
        worst_flow.0
    );
}

/// A pump into a network with all kinds of pipes and a throttle, in litres per second.
fn input_file(law: &str, roughness: &str) -> String {
    format!(
        "[JUNCTIONS]\nA 10 5\nB 5 3\nC 0 2\n[RESERVOIRS]\nR 20\n[TANKS]\nT 55 5 0 9 10 0\n\
         [PUMPS]\nU R A HEAD c\n[PIPES]\nP A B 500 150 {roughness} 1\nQ B C 300 100 {roughness}\n\
         S B T 400 100 {roughness} 0 CV\n[VALVES]\nV A C 100 TCV 200\n[CURVES]\nc 20 60\n\
         [OPTIONS]\nUnits LPS\nHeadloss {law}\n[TIMES]\nDuration 2\n[PATTERNS]\n1 1 2\n"
    )
}

#[test]
fn an_imported_file_is_a_model_that_solves() {
    for (law, roughness) in [("H-W", "110"), ("D-W", "0.1"), ("C-M", "0.012")] {
        let text = input_file(law, roughness);
        let import = anergy_import::epanet::import(text.as_bytes(), Default::default())
            .unwrap_or_else(|errors| panic!("{errors:?}"));
        let model = Model::from_toml(&import.model, Path::new("."))
            .unwrap_or_else(|problems| panic!("{}", problems.render(&import.model)));
        let steady = steady::solve(&model).unwrap_or_else(|error| panic!("{law}: {error}"));
        let flow = |id: &str| steady.edges.iter().find(|edge| edge.id == id).unwrap().m_flow_kg_s;
        // All that the pump gives is taken or stored: 5 + 3 + 2 l/s.
        assert!((flow("U") - flow("S") - 10.0).abs() < 1e-6, "{law}: {}", flow("U"));
        assert!((flow("P") + flow("V") + 5.0 - flow("U")).abs() < 1e-6);
        // h = 80.0004 - r q^n with h(20 l/s) = 60.
        let dp = steady.edges.iter().find(|edge| edge.id == "U").unwrap().dp_pa;
        let gravity = if law == "D-W" { 9.81456 } else { 9.81 };
        let expected = 80.0004 - 20.0004 * (flow("U") / 20.0).powf(1.999_978);
        // A lies 10 m below the reservoir.
        let head = -dp / 1000.0 / gravity - 10.0;
        assert!((head - expected).abs() < 1e-3, "{law}: {head} m, expected {expected} m");
    }
}

#[test]
fn snapshots_agree() {
    let Some(data) = reference_data("epanet") else { return };
    for name in ["Net1", "Net2", "Net3", "ky4"] {
        let text = std::fs::read_to_string(data.join(format!("{name}.json"))).unwrap();
        compare(&serde_json::from_str(&text).unwrap());
    }
}
