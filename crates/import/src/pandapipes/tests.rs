use super::*;
use crate::NoteKind;
use serde_json::json;

fn table(columns: &[&str], rows: &[Value]) -> Value {
    let index: Vec<usize> = (0..rows.len()).collect();
    let table = json!({ "columns": columns, "index": index, "data": rows });
    json!({ "_class": "DataFrame", "_object": table.to_string() })
}

fn fluid(is_gas: bool) -> Value {
    let constant = |value: f64| json!({ "_object": json!({ "value": value }).to_string() });
    let numpy = |values: [f64; 2]| {
        let values = values.map(|value| json!({ "_class": "float64", "_object": value }));
        json!({ "_class": "array", "_object": values })
    };
    let density = json!({ "x": numpy([280.0, 300.0]), "y": numpy([1000.0, 990.0]) });
    let properties = json!({
        "density": { "_object": density.to_string() },
        "heat_capacity": constant(4200.0),
        "viscosity": constant(1e-3),
    });
    json!({ "_object": json!({ "is_gas": is_gas, "all_properties": properties }).to_string() })
}

/// Four junctions in a row: grid, pipe, valve, pump; one more out of service.
fn net() -> Value {
    let junction = |height: f64, used: bool| json!([null, 290.0, height, used]);
    json!({ "_module": "pandapipes.pandapipes_net", "_class": "pandapipesNet", "_object": {
        "name": "a net",
        "fluid": fluid(false),
        "junction": table(&["name", "tfluid_k", "height_m", "in_service"], &[
            junction(0.0, true), junction(5.0, true), junction(0.0, true), junction(0.0, true),
            junction(0.0, false),
        ]),
        "ext_grid": table(&["junction", "p_bar", "t_k", "type"], &[json!([0, 5.0, 350.0, "pt"])]),
        "pipe": table(
            &["from_junction", "to_junction", "length_km", "inner_diameter_mm", "k_mm",
              "loss_coefficient", "u_w_per_m2k", "text_k"],
            &[json!([0, 1, 0.5, 100.0, 0.1, 2.0, 10.0, 283.0])],
        ),
        "valve": table(
            &["junction", "element", "et", "inner_diameter_mm", "opened", "loss_coefficient"],
            &[json!([1, 2, "ju", 100.0, true, 4.0]), json!([0, 3, "ju", 100.0, false, 4.0]),
              json!([1, 0, "pi", 100.0, true, 0.0])],
        ),
        "pump": table(&["from_junction", "to_junction", "std_type"], &[json!([2, 3, "P"])]),
        "sink": table(&["junction", "mdot_kg_per_s", "scaling"],
            &[json!([3, 2.0, 0.5]), json!([3, 0.25, 1.0]), json!([4, 1.0, 1.0])]),
        "heat_consumer": table(
            &["from_junction", "to_junction", "qext_w", "controlled_mdot_kg_per_s", "deltat_k",
              "treturn_k"],
            &[json!([1, 2, 42_000.0, 0.5, null, null])],
        ),
        "heat_exchanger": table(
            &["from_junction", "to_junction", "qext_w", "inner_diameter_mm", "loss_coefficient"],
            &[json!([2, 3, 3000.0, 50.0, 1.0]), json!([2, 3, 0.0, 50.0, 1.0])],
        ),
        "compressor": table(&["from_junction"], &[json!([0])]),
        "std_types": { "pump": { "P": { "_object": "{\"reg_par\": [-0.5, -1.0, 6.0]}" } } },
    }})
}

fn of(net: &Value) -> Import {
    import(net.to_string().as_bytes(), Friction::Colebrook).unwrap()
}

#[track_caller]
fn has(import: &Import, id: &str, lines: &[&str]) {
    let wanted = format!("id = \"{id}\"");
    let entry = import.model.split("\n\n").find(|entry| entry.lines().any(|l| l == wanted));
    let entry = entry.unwrap_or_else(|| panic!("no {id} in\n{}", import.model));
    for line in lines {
        assert!(entry.lines().any(|l| l == *line), "{line} is not in\n{entry}");
    }
}

#[test]
fn a_small_net() {
    let import = of(&net());
    // Between 280 K and 300 K: 995 kg/m3.
    assert!(import.model.contains("density_kg_m3 = 995.0\n"));
    has(&import, "junction0", &["kind = \"pressure_boundary\"", "pressure_pa = 500000.0"]);
    has(&import, "junction1", &["elevation_m = 5.0"]);
    has(&import, "junction3", &["kind = \"source\"", "m_flow_kg_s = -1.25"]);
    // 1/(10 pi 0.1) K m/W; the valve at its end is a node further.
    has(&import, "pipe0", &["from = \"junction0\"", "to = \"valve2.pipe0\"", "length_m = 500.0"]);
    has(&import, "pipe0", &["zeta = 2.0", "friction = \"colebrook\"", "surroundings_k = 283.0"]);
    assert!(import.model.contains("insulation_resistance_k_m_w = 0.3183"));
    // 4 * 995/2 Pa at 1 m/s
    has(&import, "valve0", &["kind = \"resistance\"", "dp_nominal_pa = 1990.0"]);
    // 6 bar, -1 bar/(m3/h), -0.5 bar/(m3/h)^2
    let curve = "curve_polynomial = [600000.0, -360000000.0, -648000000000.0]";
    has(&import, "pump0", &["speed = 1.0", curve]);
    // The flow of a consumer is against its port: 42 kW/(4200 J/(kg K) 0.5 kg/s) = 20 K
    has(&import, "heat_consumer0", &["from = \"junction2\"", "to = \"junction1\""]);
    has(&import, "heat_consumer0.load", &["load_w = 42000.0", "temperature_difference_k = 20.0"]);
    // What an exchanger takes from the water is negative for the water.
    has(&import, "heat_exchanger0", &["kind = \"resistance\"", "dp_nominal_pa = 497.5"]);
    let heat = ["kind = \"heat_source\"", "port = \"heat_exchanger0\"", "heat_w = -3000.0"];
    has(&import, "heat_exchanger0.heat", &heat);
    assert!(!import.model.contains("heat_exchanger1.heat"));
    let says = |kind: NoteKind, part: &str| {
        assert!(
            import.notes.iter().any(|note| note.kind == kind && note.text.contains(part)),
            "{:#?}",
            import.notes
        );
    };
    says(NoteKind::Problem, "junction 4: out of service");
    says(NoteKind::Problem, "table compressor with 1 rows");
    says(NoteKind::Changed, "valve 1: left out");
}

#[test]
fn the_temperature_of_ice_is_that_of_the_coldest_water() {
    // 273.15 K is what nets for hydraulics alone are often given.
    let mut net = net();
    for row in 0..5 {
        let cold = net.to_string().replacen("290.0", "273.15", 1);
        net = serde_json::from_str(&cold).unwrap_or_else(|_| panic!("{row}"));
    }
    let import = of(&net);
    assert!(import.model.contains("initial_k = 273.65"), "{}", import.model);
    assert!(
        import.notes.iter().any(|note| note.to_string().contains("273.15 K")),
        "{:?}",
        import.notes
    );
}

#[test]
fn wrong_nets() {
    let error = |net: &Value| {
        import(net.to_string().as_bytes(), Friction::SwameeJain).unwrap_err()[0].message.clone()
    };
    assert!(error(&json!({})).contains("no net that pandapipes.to_json wrote"));
    let mut gas = net();
    gas["_object"]["fluid"] = fluid(true);
    assert_eq!(error(&gas), "fluid: a gas: anergy knows water only");
    let mut unknown = net();
    unknown["_object"]["std_types"] = json!({});
    assert_eq!(error(&unknown), "table pump, index 0: there is no pump type \"P\"");
    let mut short = net();
    short["_object"]["pipe"] = table(&["from_junction", "to_junction"], &[json!([0, 1])]);
    assert!(error(&short).starts_with("table pipe, index 0: "), "{}", error(&short));
    let text = import(b"{\n x", Friction::Colebrook).unwrap_err();
    assert_eq!(text[0].line, Some(2));
}

#[test]
fn numbers_that_json_does_not_have() {
    let value = tables::parse(r#"{"a": NaN, "b": [-Infinity, 1], "c\"NaN": "NaN é"}"#).unwrap();
    assert_eq!(value, json!({ "a": null, "b": [null, 1], "c\"NaN": "NaN é" }));
}

/// Whatever is missing or of another type, there is an answer.
#[test]
fn damaged_nets_never_panic() {
    let text = net().to_string();
    for end in (0..text.len()).filter(|end| text.is_char_boundary(*end)) {
        let _ = import(&text.as_bytes()[..end], Friction::Colebrook);
    }
    let names: Vec<String> = net()["_object"].as_object().unwrap().keys().cloned().collect();
    for name in names {
        for new in [
            Value::Null,
            json!(1),
            json!({ "_object": "{}" }),
            json!({ "_object": "x" }),
            json!([]),
        ] {
            let mut net = net();
            net["_object"][&name] = new;
            let _ = import(net.to_string().as_bytes(), Friction::Colebrook);
        }
        let mut wrong = net();
        let cells = wrong["_object"][&name]["_object"].as_str().unwrap_or_default().to_owned();
        for (old, new) in [("1", "-1"), ("0", "\"x\""), ("0.5", "0"), ("2", "99"), ("true", "null")]
        {
            wrong["_object"][&name] = json!({ "_object": cells.replace(old, new) });
            let _ = import(wrong.to_string().as_bytes(), Friction::Colebrook);
        }
    }
}
