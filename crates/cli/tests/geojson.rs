//! Networks to GeoJSON and back: lengths, pressures, what is left out of chains of pipes.
#![allow(clippy::unwrap_used)]

use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Stdio};

const TOWN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/town/model.toml");

/// Runs the program; what it prints.
fn anergy(arguments: &[&str], dir: &Path) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_anergy"))
        .args(arguments)
        .current_dir(dir)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Streets of a town, 6 by 5 crossings, each street of four pipes in a row; water enters at one corner and
/// is taken at the crossings.
fn streets() -> String {
    let mut text = String::from(
        "format = 1\n[model]\nname = \"streets\"\nlatitude_deg = 48.14\nlongitude_deg = 11.58\n",
    );
    let mut node = |id: &str, x: f64, y: f64, more: &str| {
        let _ = write!(text, "[[node]]\nid = \"{id}\"\nx_m = {x:?}\ny_m = {y:?}\n{more}");
    };
    let mut pipes = Vec::new();
    for i in 0..6 {
        for j in 0..5 {
            let more = match (i, j) {
                (0, 0) => "kind = \"pressure_boundary\"\npressure_bar = 5\n".to_owned(),
                _ => format!(
                    "kind = \"source\"\nm_flow_kg_s = {:?}\n",
                    -0.15 - 0.03 * f64::from((3 * i + 5 * j) % 7)
                ),
            };
            let (x, y) = (90.0 * f64::from(i), 70.0 * f64::from(j));
            let crossing = format!("c{i}{j}");
            node(&crossing, x, y, &more);
            for (di, dj) in [(1, 0), (0, 1)] {
                if i + di > 5 || j + dj > 4 {
                    continue;
                }
                let mut from = crossing.clone();
                for piece in 1..=4 {
                    let to = if piece == 4 {
                        format!("c{}{}", i + di, j + dj)
                    } else {
                        let id = format!("{crossing}.{di}{dj}.{piece}");
                        let share = f64::from(piece) / 4.0;
                        node(
                            &id,
                            x + 90.0 * share * f64::from(di),
                            y + 70.0 * share * f64::from(dj),
                            "",
                        );
                        id
                    };
                    let length_m = 20.1 + 0.37 * f64::from((i + 2 * j + piece) % 5);
                    // Some pipes are drawn against their street.
                    let ends = if piece == 3 { (&to, &from) } else { (&from, &to) };
                    pipes.push(format!(
                        "[[edge]]\nid = \"p{crossing}{di}{piece}\"\nkind = \"pipe\"\nfrom = \"{}\"\nto = \"{}\"\nlength_m = {length_m:?}\ninner_diameter_mm = {:?}\n",
                        ends.0, ends.1, 54.5 - 4.0 * f64::from(i)
                    ));
                    from = to;
                }
            }
        }
    }
    text + &pipes.concat()
}

fn solved(model: &str, dir: &Path) -> BTreeMap<String, f64> {
    anergy(&["solve", model, "--json", "steady.json"], dir);
    let steady: Value =
        serde_json::from_slice(&std::fs::read(dir.join("steady.json")).unwrap()).unwrap();
    let node =
        |node: &Value| (node["id"].as_str().unwrap().to_owned(), node["p_pa"].as_f64().unwrap());
    steady["nodes"].as_array().unwrap().iter().map(node).collect()
}

/// Lengths of the pipes of a model in m, by name.
fn lengths(model: &str, dir: &Path) -> BTreeMap<String, f64> {
    of_pipes(&anergy(&["check", model, "--expand"], dir))
}

fn of_pipes(plain: &str) -> BTreeMap<String, f64> {
    let plain: Value = toml::from_str(plain).unwrap();
    let pipes = plain["edge"].as_array().unwrap().iter().filter(|edge| edge["kind"] == "pipe");
    pipes
        .map(|edge| (edge["id"].as_str().unwrap().to_owned(), edge["length_m"].as_f64().unwrap()))
        .collect()
}

#[test]
fn there_and_back_lengths_are_identical_and_pressures_the_same() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    std::fs::write(dir.join("streets.toml"), streets()).unwrap();
    anergy(&["export", "streets.toml", "--out", "streets.geojson"], dir);
    anergy(&["import", "geojson", "streets.geojson", "--out", "back.toml"], dir);
    let before = lengths("streets.toml", dir);
    assert_eq!(before.len(), 4 * 49);
    assert_eq!(before, lengths("back.toml", dir));
    let pressures = solved("streets.toml", dir);
    let lowest = pressures.values().copied().fold(f64::INFINITY, f64::min);
    assert!(lowest < 4.5e5, "the pipes have losses: {lowest}");
    for (id, p_pa) in solved("back.toml", dir) {
        assert!((p_pa / pressures[&id] - 1.0).abs() < 1e-9, "{id}: {p_pa} {}", pressures[&id]);
    }

    let said = anergy(
        &["import", "geojson", "streets.geojson", "--out", "simple.toml", "--simplify"],
        dir,
    );
    assert!(said.contains("147 of 177 nodes joined two equal pipes"), "{said}");
    let simple = lengths("simple.toml", dir);
    assert_eq!(simple.len(), 49);
    let total = |lengths: &BTreeMap<String, f64>| lengths.values().sum::<f64>();
    assert!((total(&simple) / total(&before) - 1.0).abs() < 1e-14);
    let again = solved("simple.toml", dir);
    assert_eq!(again.len(), 30);
    for (id, p_pa) in again {
        assert!((p_pa / pressures[&id] - 1.0).abs() < 1e-6, "{id}: {p_pa} {}", pressures[&id]);
    }
}

#[test]
fn lines_without_length_have_that_of_the_ellipsoid() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    std::fs::write(dir.join("streets.toml"), streets()).unwrap();
    anergy(&["export", "streets.toml", "--out", "streets.geojson"], dir);
    let file = std::fs::read_to_string(dir.join("streets.geojson")).unwrap();
    let bare: Value = serde_json::from_str(&file).unwrap();
    let mut bare = bare;
    for feature in bare["features"].as_array_mut().unwrap() {
        feature["properties"].as_object_mut().unwrap().remove("length_m");
    }
    std::fs::write(dir.join("bare.geojson"), bare.to_string()).unwrap();
    let said = anergy(&["import", "geojson", "bare.geojson", "--out", "bare.toml"], dir);
    assert!(said.contains("196 pipes without `length_m` have the length of their lines"), "{said}");
    // Pieces of 90 m / 4 and 70 m / 4 on the map; the map is true to 1e-4 this near to its origin.
    for (id, length_m) in lengths("bare.toml", dir) {
        let wanted = if id.as_bytes()[4] == b'1' { 22.5 } else { 17.5 };
        assert!((length_m / wanted - 1.0).abs() < 2e-4, "{id}: {length_m}");
    }
}

#[test]
fn a_town_goes_out_and_comes_back() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    let arguments = ["export", TOWN, "--out", "town.geojson"];
    let output = Command::new(env!("CARGO_BIN_EXE_anergy"))
        .args(arguments)
        .current_dir(dir)
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1));
    assert!(message.contains("`latitude_deg`") && message.contains("--origin"), "{message}");
    let said = anergy(&[&arguments[..], &["--origin", "48.14", "11.58"]].concat(), dir);
    assert!(
        said.contains("not written") && said.contains("500 unit") || said.contains("501 unit"),
        "{said}"
    );
    anergy(&["import", "geojson", "town.geojson", "--out", "back.toml"], dir);
    // Without its plant the town holds no pressure: its text is compared.
    let back = std::fs::read_to_string(dir.join("back.toml")).unwrap();
    assert_eq!(lengths(TOWN, dir), of_pipes(&back));
}
