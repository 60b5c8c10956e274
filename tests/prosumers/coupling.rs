//! Two-pipe connections: generators, heating and storage meet in two points, the storage takes the difference.

#![allow(clippy::unwrap_used)]

use allocation_counter::measure;
use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use anergy_simulation::simulation::Simulation;
use anergy_tests::running::get;
use serde_json::json;
use std::path::Path;

/// Water that goes round beside the house; engine, boiler and radiators around a storage.
const HOUSE: &str = r#"format = 1
[run]
until = "24h"
step = "60s"
initial_degc = 45
[[edge]]
id = "pump"
kind = "pump"
from = "h.cold"
to = "h.hot"
head_max_bar = 0.4
free_flow_l_min = 55
[[edge]]
id = "pipe"
kind = "pipe"
from = "h.hot"
to = "h.cold"
length_m = 100
inner_diameter_mm = 22
[[site]]
id = "h"
[pressure_reference]
node = "h.cold"
pressure_bar = 1
[[unit]]
site = "h"
name = "chp"
kind = "chp"
[[unit]]
site = "h"
name = "boiler"
kind = "condensing_boiler"
nominal_kw = 20
flow_control = "constant_supply"
supply_set_degc = 70
[[unit]]
site = "h"
name = "load"
kind = "heat_load"
load_kw = 8
temperature_difference_k = 15
[[unit]]
site = "h"
name = "storage"
kind = "storage"
volume_l = 800
height_m = 1.63
initial_bottom_degc = 45
initial_top_degc = 65
ports = { charge = { inlet_layer = 10, outlet_layer = 1 } }
[[circuit]]
site = "h"
id = "storage_pipes"
through = ["storage.charge"]
from = "supply"
to = "return"
[[circuit]]
site = "h"
id = "heating"
through = ["load"]
from = "supply"
to = "return"
[[circuit]]
site = "h"
id = "engine"
through = ["chp"]
from = "return"
to = "supply"
[[circuit]]
site = "h"
id = "burner"
through = ["boiler"]
from = "return"
to = "supply"
[[controller]]
id = "h.chp_control"
kind = "two_sensors"
measures_on = "h.storage.t_9_k"
measures_off = "h.storage.t_2_k"
acts_on = "h.chp.modulation"
on_below_degc = 60
off_above_degc = 62
[[controller]]
id = "h.boiler_control"
kind = "two_sensors"
measures_on = "h.storage.t_9_k"
measures_off = "h.storage.t_5_k"
acts_on = "h.boiler.modulation"
on_below_degc = 55
off_above_degc = 62
"#;

fn house(changes: &[(&str, serde_json::Value)]) -> Model {
    let model = Model::from_toml(HOUSE, Path::new("."))
        .unwrap_or_else(|problems| panic!("{}", problems.render(HOUSE)));
    let changes: Vec<Change> = changes
        .iter()
        .map(|(parameter, value)| Change::Set {
            parameter: (*parameter).to_owned(),
            value: value.clone(),
        })
        .collect();
    model.with(&changes).unwrap()
}

fn advance(simulation: &mut Simulation, until_s: f64) {
    simulation.advance_to(Time::from_s(until_s).unwrap(), Time::from_s(60.0).unwrap()).unwrap();
}

/// Open while off, drawn along by the boiler.
fn open() -> Model {
    house(&[("h.engine.idle_opening", json!(1.0)), ("h.engine.suction", json!(0.15))])
}

#[test]
fn heat_and_water_close_at_the_points() {
    for model in [house(&[]), open()] {
        let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
        let mut seen = [false; 3];
        for minute in 1..=24 * 60 {
            advance(&mut simulation, 60.0 * f64::from(minute));
            let [storage, chp, boiler] = ["storage.charge", "chp.water", "boiler.water"]
                .map(|port| get(&simulation, &format!("h.{port}.m_flow_kg_s")));
            // The heating takes 8 kW over 15 K: 0.1276 kg/s.
            let heating = chp + boiler - storage;
            assert!((heating - 8000.0 / (4180.0 * 15.0)).abs() < 1e-4, "{minute}: {heating}");
            seen = [seen[0] || storage > 0.0, seen[1] || storage < 0.0, seen[2] || boiler > 0.0];
        }
        assert_eq!(seen, [true; 3], "the storage is charged and discharged, the boiler runs");
        assert!(Balances::of(&simulation).units_error() < 1e-9);
    }
}

#[test]
fn a_coupling_goes_on_from_a_snapshot_and_allocates_nothing() {
    let mut simulation = Simulation::new(build(&open()).unwrap()).unwrap();
    advance(&mut simulation, 6.0 * 3600.0);
    let here = simulation.snapshot();
    let bits = |simulation: &mut Simulation| {
        advance(simulation, 12.0 * 3600.0);
        ["h.storage.t_8_k", "h.boiler.fuel_j", "h.chp.water.m_flow_kg_s"]
            .map(|channel| get(simulation, channel).to_bits())
    };
    let first = bits(&mut simulation);
    simulation.restore(&here).unwrap();
    assert_eq!(first, bits(&mut simulation));
    simulation.take_events();
    let found = measure(|| advance(&mut simulation, 13.0 * 3600.0));
    assert_eq!((found.count_total, found.bytes_total), (0, 0));
}

#[test]
fn a_coupling_survives_the_plain_form() {
    let text = open().to_plain_toml().unwrap();
    let again = Model::from_toml(&text, Path::new(".")).unwrap();
    assert_eq!(again.circuits.len(), 4);
    for (circuit, before) in again.circuits.iter().zip(open().circuits) {
        assert_eq!((&circuit.id, &circuit.branch), (&before.id, &before.branch));
    }
}

#[test]
fn water_passes_the_engine_only_where_nothing_closes_it() {
    let passed = |model: &Model| {
        let mut simulation = Simulation::new(build(model).unwrap()).unwrap();
        for unit in ["chp", "boiler"] {
            let enable = simulation.signal(&format!("h.{unit}.enable")).unwrap();
            simulation.set(enable, 0.0).unwrap();
        }
        advance(&mut simulation, 600.0);
        ["chp.water", "storage.charge"]
            .map(|port| get(&simulation, &format!("h.{port}.m_flow_kg_s")))
    };
    let [chp, storage] = passed(&house(&[]));
    assert!(chp == 0.0 && storage < -0.1, "{chp} {storage}");
    // A sixth of what the heating takes: the rest comes from the storage.
    let [chp, storage] = passed(&open());
    assert!((chp / (chp - storage) - 1.0 / 6.0).abs() < 1e-12, "{chp} {storage}");
}
