//! Networks from tables: the rows mean the same as the entries of the model file.
#![allow(clippy::unwrap_used)]

use anergy_simulation::model::Model;
use anergy_simulation::steady;
use std::path::Path;

const HEAD: &str = r#"
format = 1
[pipe_type.dn25]
inner_diameter_mm = 28.5
[pipe_type.dn32]
inner_diameter_mm = 37.2
[pressure_reference]
node = "1.warm"
"#;

const TABLES: &str = r#"
[network]
nodes = "nodes.csv"
pipes = "data/pipes.csv"
lines = ["warm", "cold"]
separator = ";"
[station_type.house]
kind = "consumer"
stub = { pipe = "dn25", length_m = 5 }
extraction_valve = { kvs_m3_h = 2.5, opening = 0.7 }
unit = { kind = "heat_load", load_kw = 8, temperature_difference_k = 10 }
[station_type.plant]
kind = "producer"
feed_in_pump = { speed = 1.0, initial_speed = 1.0 }
requested_flow_l_min = 20
unit = { kind = "prescribed_source", supply_degc = 20, v_flow_l_min = 20 }
"#;

const NODES: &str = "\u{feff}id; x_m; y_km; elevation_m; station; unit.load_w; stub.length_m; \
    extraction_valve.opening; extraction_valve.kvs_m3_h
1; 0; 0; 0; plant;;;;
# a junction
2; 60; 0; 1.5;;;;;
3; 90; 0.01; 2; house; 12500; 7;;
house 4; 60; 0.04; -1; house;;; 0.5; 1.6
";

const PIPES: &str = "id;from;to;length_km;pipe;zeta
;1;2;0.06;dn32;2
;2;3;0.0316;dn25;
last;2;house 4;0.04;dn25;
";

const ENTRIES: &str = r#"
[[site]]
id = "1"
lines = ["warm", "cold"]
x_m = 0
y_m = 0
[[site]]
id = "2"
lines = ["warm", "cold"]
x_m = 60
y_m = 0
elevation_m = 1.5
[[site]]
id = "3"
lines = ["warm", "cold"]
x_m = 90
y_m = 10
elevation_m = 2
[[site]]
id = "house 4"
lines = ["warm", "cold"]
x_m = 60
y_m = 40
elevation_m = -1
[[trench]]
from = "1"
to = "2"
length_m = 60
pipe = "dn32"
zeta = 2
[[trench]]
from = "2"
to = "3"
length_m = 31.6
pipe = "dn25"
[[trench]]
id = "last"
from = "2"
to = "house 4"
length_m = 40
pipe = "dn25"
[[station]]
site = "1"
kind = "producer"
feed_in_pump = { speed = 1.0, initial_speed = 1.0 }
requested_flow_l_min = 20
[[station]]
site = "3"
kind = "consumer"
stub = { pipe = "dn25", length_m = 7 }
extraction_valve = { kvs_m3_h = 2.5, opening = 0.7 }
[[station]]
site = "house 4"
kind = "consumer"
stub = { pipe = "dn25", length_m = 5 }
extraction_valve = { kvs_m3_h = 1.6, opening = 0.5 }
[[unit]]
site = "1"
kind = "prescribed_source"
supply_degc = 20
v_flow_l_min = 20
[[unit]]
site = "3"
kind = "heat_load"
load_kw = 12.5
temperature_difference_k = 10
[[unit]]
site = "house 4"
kind = "heat_load"
load_kw = 8
temperature_difference_k = 10
"#;

fn model(text: &str, dir: &Path) -> Model {
    Model::from_toml(text, dir).unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

/// A folder with the two tables.
fn folder(nodes: &str, pipes: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    std::fs::write(folder.path().join("nodes.csv"), nodes).unwrap();
    std::fs::write(folder.path().join("data/pipes.csv"), pipes).unwrap();
    folder
}

#[test]
fn rows_mean_the_same_as_entries() {
    let folder = folder(NODES, PIPES);
    let of_tables = model(&format!("{HEAD}{TABLES}"), folder.path());
    let of_entries = model(&format!("{HEAD}{ENTRIES}"), folder.path());
    assert_eq!(of_tables.to_plain_toml().unwrap(), of_entries.to_plain_toml().unwrap());
    let [first, second] = [&of_tables, &of_entries].map(|model| steady::solve(model).unwrap());
    assert_eq!(first, second);
    assert!(first.edge("last.warm").unwrap().m_flow_kg_s > 0.0);
    // The plain model stands alone: no table is needed to read it.
    let plain = of_tables.to_plain_toml().unwrap();
    assert_eq!(model(&plain, Path::new("/")).nodes.len(), of_tables.nodes.len());
}

#[test]
fn rows_and_entries_can_be_mixed() {
    let folder = folder(NODES, PIPES);
    let more = r#"
[[site]]
id = "new"
lines = ["warm", "cold"]
[[trench]]
from = "house 4"
to = "new"
length_m = 30
pipe = "dn25"
[[station]]
site = "new"
type = "house"
name = "flat"
unit = { load_kw = 3 }
"#;
    let model = model(&format!("{HEAD}{TABLES}{more}"), folder.path());
    let unit = model.units.iter().find(|unit| unit.id == "new.flat.unit").unwrap();
    assert_eq!(unit.port, "new.flat.heat_exchanger");
    assert_eq!(unit.params.to_value()["load_w"], 3000.0);
    assert!(steady::solve(&model).unwrap().edge("new.flat.extraction_valve").is_some());
}

#[test]
fn problems_found_while_building_name_the_cell() {
    let folder = folder(NODES, &PIPES.replace("0.0316", "-31.6"));
    let text = format!("{HEAD}{TABLES}");
    let problems = anergy_simulation::build::build(&model(&text, folder.path())).unwrap_err();
    let said = problems.render(&text);
    assert!(
        said.contains("data/pipes.csv line 3, column length_km: trench \"2-3\": length_km = -31.6"),
        "{said}"
    );
    // The place in the model file is where it names the table.
    assert!(said.starts_with("12:9: "), "{said}");
    assert_eq!(problems.0.len(), 1, "{said}");
}
