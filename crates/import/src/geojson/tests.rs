#![allow(clippy::needless_pass_by_value, reason = "values of json! are used once")]

use super::{GeojsonOptions, export, import};
use crate::{Import, NoteKind};
use serde_json::{Value, json};

fn point(id: &str, at: [f64; 2], more: Value) -> Value {
    let mut properties = json!({ "id": id });
    properties.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    json!({"type": "Feature", "geometry": {"type": "Point", "coordinates": at}, "properties": properties})
}

fn line(path: &[[f64; 2]], properties: Value) -> Value {
    json!({"type": "Feature", "geometry": {"type": "LineString", "coordinates": path}, "properties": properties})
}

fn read(features: Vec<Value>, options: &GeojsonOptions) -> Result<Import, String> {
    let file = json!({"type": "FeatureCollection", "features": features}).to_string();
    import(file.as_bytes(), options).map_err(|errors| errors[0].to_string())
}

fn pipes(import: &Import) -> Vec<String> {
    import.model.split("[[edge]]\n").skip(1).map(|edge| edge.trim().replace('\n', "; ")).collect()
}

fn said(import: &Import, kind: NoteKind, text: &str) -> bool {
    import.notes.iter().any(|note| note.kind == kind && note.text.contains(text))
}

#[test]
fn given_lengths_are_kept_and_others_computed_and_told() {
    let features = vec![
        point(
            "plant",
            [11.58, 48.14],
            json!({"kind": "pressure_boundary", "pressure_bar": 3, "OBJECTID": 7}),
        ),
        line(
            &[[11.58, 48.14], [11.59, 48.14]],
            json!({"id": "a", "length_km": 0.8, "diameter_mm": 54.5, "to": "x"}),
        ),
        // 0.01 deg of the meridian at 48.145 deg: 1112.0 m. Its start is 0.2 m from x.
        line(
            &[[11.590_002_7, 48.14], [11.59, 48.15]],
            json!({"id": 2, "pipe": "steel DN25", "owner": "city"}),
        ),
        line(
            &[[11.58, 48.14], [11.58, 48.14]],
            json!({"id": "dot", "length_m": 1, "pipe": "steel DN25"}),
        ),
        json!({"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [[[0,0],[0,1],[1,1],[0,0]]]},
               "properties": {}}),
    ];
    let import = read(features, &GeojsonOptions::default()).unwrap();
    let pipes = pipes(&import);
    assert_eq!(
        pipes[0],
        "id = \"a\"; kind = \"pipe\"; from = \"plant\"; to = \"x\"; length_m = 800.0; inner_diameter_mm = 54.5"
    );
    assert!(
        pipes[1].starts_with(
            "id = \"2\"; kind = \"pipe\"; from = \"x\"; to = \"node1\"; length_m = 111"
        ),
        "{}",
        pipes[1]
    );
    assert_eq!((import.nodes, import.edges), (3, 2));
    assert!(import.model.contains("OBJECTID = 7"), "a feature with kind is one of a model");
    assert!(said(
        &import,
        NoteKind::Changed,
        "1 pipes without `length_m` have the length of their lines"
    ));
    // Drawn with 744.6 m.
    assert!(said(
        &import,
        NoteKind::Changed,
        "1 differ by more than 5 % from the lines, most that of pipe \"a\", 800 m given, 744."
    ));
    assert!(said(&import, NoteKind::NotTranslated, "property \"owner\" of 1 features"));
    assert!(said(&import, NoteKind::NotTranslated, "1 features: Polygon"));
    assert!(said(&import, NoteKind::NotTranslated, "\"dot\" begins and ends at node \"plant\""));
    assert!(
        import.model.contains("latitude_deg = 48.145\nlongitude_deg = 11.585\n"),
        "{}",
        import.model
    );
}

#[test]
fn what_is_not_connected_is_told() {
    let pipe = |path: &[[f64; 2]]| line(path, json!({"pipe": "steel DN25"}));
    let features =
        vec![pipe(&[[11.58, 48.14], [11.60, 48.14]]), pipe(&[[11.59, 48.14], [11.59, 48.15]])];
    let import = read(features, &GeojsonOptions::default()).unwrap();
    assert!(said(&import, NoteKind::Problem, "\"pipe2\" ends on pipe \"pipe1\""));
    assert!(said(&import, NoteKind::Problem, "2 networks that are not connected"));
    assert!(said(&import, NoteKind::NotTranslated, "no node gives a pressure"));
}

#[test]
fn names_of_ends_that_no_point_has_are_told() {
    let pipe = |from: Value, to: Value| {
        let path = [[11.58, 48.14], [11.59, 48.14]];
        line(&path, json!({"pipe": "steel DN25", "from": from, "to": to}))
    };
    let one = |id: Value| {
        json!({"type": "Feature", "geometry": {"type": "Point", "coordinates": [11.58, 48.14]},
               "properties": {"id": id}})
    };
    let told = "names node \"statoin\", which no point is; it ends at point \"station\"";
    let features = vec![one(json!("station")), pipe(json!("statoin"), json!("b"))];
    let import = read(features, &GeojsonOptions::default()).unwrap();
    assert!(said(&import, NoteKind::Problem, told), "{:?}", import.notes);
    assert!(!said(&import, NoteKind::Problem, "node \"b\""), "no point lies there");
    // Columns of floating point.
    for (id, from) in [(json!(1), json!(1.0)), (json!("1"), json!(1.0)), (json!(1.0), json!("1"))] {
        let features = vec![one(id), pipe(from, json!(2))];
        let import = read(features, &GeojsonOptions::default()).unwrap();
        assert!(pipes(&import)[0].contains("from = \"1\"; to = \"2\""), "{}", pipes(&import)[0]);
        assert_eq!(import.nodes, 2);
        assert!(!said(&import, NoteKind::Problem, "names node"), "{:?}", import.notes);
    }
}

#[test]
fn files_that_cannot_be_meant_are_refused() {
    let refused = |features, text: &str| {
        let message = read(features, &GeojsonOptions::default()).unwrap_err();
        assert!(message.contains(text), "{message}");
    };
    let metres = line(&[[4_468_000.0, 5_334_000.0], [4_468_100.0, 5_334_000.0]], json!({}));
    refused(vec![metres], "ogr2ogr");
    refused(vec![point("a", [1.0, 2.0], json!({}))], "no lines");
    let pipe = |properties| vec![line(&[[1.0, 2.0], [1.0, 2.1]], properties)];
    refused(pipe(json!({"id": "p"})), "the first is \"p\"");
    refused(pipe(json!({"id": "p", "length_m": -3})), "(\"p\"): a length of -3 m");
    let unplaced = json!({"type": "Feature", "geometry": null, "properties": {"id": "p", "from": "a", "to": "b"}});
    refused(vec![unplaced], "pipe \"p\" has no length");
    assert!(
        import(b"{", &GeojsonOptions::default()).unwrap_err()[0].to_string().contains("no GeoJSON")
    );
    let old = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::25832"}},"features":[]}"#;
    let message = import(old.as_bytes(), &GeojsonOptions::default()).unwrap_err()[0].to_string();
    assert!(message.contains("EPSG::25832"), "{message}");
}

#[test]
fn chains_of_equal_pipes_become_one() {
    // p - a - b - c - q with a change of type at b and a source at c.
    let at = |i: i32| [11.58 + 0.001 * f64::from(i), 48.14];
    let pipe = |id: &str, i: i32, kind: &str, m: f64, zeta: f64| {
        line(&[at(i), at(i + 1)], json!({"id": id, "pipe": kind, "length_m": m, "zeta": zeta}))
    };
    let features = vec![
        point("c", at(3), json!({"kind": "source", "m_flow_kg_s": -0.1})),
        pipe("1", 0, "steel DN50", 70.1, 1.0),
        line(
            &[at(2), at(1)],
            json!({"id": "2", "pipe": "steel DN50", "length_m": 80.2, "zeta": 0.5}),
        ),
        pipe("3", 2, "steel DN25", 75.3, 0.0),
        pipe("4", 3, "steel DN25", 74.4, 0.0),
    ];
    let options = GeojsonOptions { simplify: true, ..GeojsonOptions::default() };
    let import = read(features, &options).unwrap();
    let pipes = pipes(&import);
    assert_eq!(pipes.len(), 3);
    assert!(pipes[0].contains(&format!("length_m = {:?}", 70.1 + 80.2)), "{}", pipes[0]);
    assert!(pipes[0].contains("zeta = 1.5"), "{}", pipes[0]);
    assert!(said(&import, NoteKind::Changed, "1 of 5 nodes joined two equal pipes"));
}

#[test]
fn types_follow_from_properties() {
    let pipe = |properties: Value| line(&[[1.0, 2.0], [1.0, 2.001]], properties);
    let options = GeojsonOptions { pipe: Some("steel DN{DN}".into()), ..GeojsonOptions::default() };
    let import =
        read(vec![pipe(json!({"DN": 65})), pipe(json!({"pipe": "steel DN20"}))], &options).unwrap();
    assert!(pipes(&import)[0].ends_with("pipe = \"steel DN65\""), "{}", pipes(&import)[0]);
    assert!(pipes(&import)[1].ends_with("pipe = \"steel DN20\""));
    assert!(said(
        &import,
        NoteKind::Changed,
        "1 pipes without type and diameter are \"steel DN{DN}\""
    ));
    assert!(!said(&import, NoteKind::NotTranslated, "property"), "{:?}", import.notes);
    let message = read(vec![pipe(json!({"id": "p", "dn": 65}))], &options).unwrap_err();
    assert!(
        message.contains("(\"p\"): its type \"steel DN{DN}\" asks for a property \"DN\""),
        "{message}"
    );
}

#[test]
fn trenches_have_sites_at_their_ends() {
    let options = GeojsonOptions {
        trenches: true,
        pipe: Some("steel DN50".into()),
        ..GeojsonOptions::default()
    };
    let import =
        read(vec![line(&[[1.0, 2.0], [1.0, 2.001]], json!({"length_m": 110}))], &options).unwrap();
    assert!(import.model.contains("[[site]]\nid = \"node1\"\nx_m = 0.0\n"), "{}", import.model);
    assert!(import.model.contains("[[trench]]\nid = \"pipe1\"\nfrom = \"node1\"\nto = \"node2\"\nlength_m = 110.0\npipe = \"steel DN50\""));
    assert_eq!((import.nodes, import.edges), (2, 1));
}

#[test]
fn exported_networks_have_positions_of_the_earth_or_none() {
    let node = |entry: Value| entry.as_object().unwrap().clone();
    let nodes = [node(json!({"id": "a", "x_m": 1000.0, "y_m": 0.0})), node(json!({"id": "b"}))];
    let edges = [node(json!({"id": "p", "kind": "pipe", "from": "a", "to": "b", "length_m": 0.1}))];
    assert!(export("x", &nodes, &edges, None).is_err());
    let text = export("a \"b\"", &nodes, &edges, Some([11.58, 48.14])).unwrap();
    let file: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(file["name"], "a \"b\"");
    // 1000 m / (111 320 m cos 48.14 deg) = 0.01346 deg.
    let longitude = file["features"][0]["geometry"]["coordinates"][0].as_f64().unwrap();
    assert!((longitude - 11.593_44).abs() < 5e-5, "{longitude}");
    assert!(file["features"][1]["geometry"].is_null() && file["features"][2]["geometry"].is_null());
    assert_eq!(file["features"][2]["properties"]["length_m"], 0.1);
}
