//! A storage in models: in the circuits of a house, and on the network between the hot and the cold line.

#![allow(clippy::unwrap_used)]

use allocation_counter::measure;
use anergy_simulation::simulation::Simulation;
use anergy_tests::running::{advance, get, simulation};

/// A boiler charges a storage from which a load is served; the network beside it only circulates.
fn house(scheme: &str) -> String {
    format!(
        r#"format = 1
[run]
until = "6h"
step = "60s"
initial_degc = 30

[[node]]
id = "cold"
[[node]]
id = "hot"
[[edge]]
id = "pump"
kind = "pump"
from = "cold"
to = "hot"
head_max_bar = 0.4
free_flow_l_min = 55
[[edge]]
id = "pipe"
kind = "pipe"
from = "hot"
to = "cold"
length_m = 100
inner_diameter_mm = 22
[pressure_reference]
node = "cold"

[[unit]]
id = "boiler"
kind = "heat_source"
supply_degc = 70
[[unit]]
id = "load"
kind = "heat_load"
load_kw = 6
return_degc = 35
[[unit]]
id = "storage"
kind = "storage"
scheme = "{scheme}"
volume_l = 785
height_m = 1.755
ua_w_k = 7
ambient_degc = 18
soc_empty_degc = 30
soc_full_degc = 70
ports = {{ charge = {{ inlet_m = 1.6, outlet_m = 0.26 }}, heating = {{ positions = [{{ inlet_m = 0.1, outlet_m = 1.7 }}, {{ inlet_m = 0.1, outlet_m = 1.0 }}] }} }}
coils = {{ solar = {{ area_m2 = 2.5, volume_l = 16.5, inlet_layer = 5, outlet_layer = 1 }} }}
rod = {{ power_kw = 6, layer = 7, steps = 3 }}
[[unit]]
id = "collector"
kind = "prescribed_source"
supply_degc = 80
v_flow_l_min = 3

[[circuit]]
id = "charging"
through = ["boiler", "storage.charge"]
v_flow_l_min = 8
[[circuit]]
id = "heating"
through = ["load", "storage.heating"]
[[circuit]]
id = "solar"
through = ["collector", "storage.solar"]
"#
    )
}

fn set(simulation: &mut Simulation, signal: &str, value: f64) {
    let id = simulation.signal(signal).unwrap_or_else(|_| panic!("no signal {signal}"));
    simulation.set(id, value).unwrap();
}

#[test]
fn a_storage_between_boiler_and_load() {
    for scheme in ["mixed_layers", "plug_flow"] {
        for step_s in [10.0, 60.0, 600.0] {
            let mut simulation = simulation(&house(scheme));
            set(&mut simulation, "storage.rod", 0.7);
            advance(&mut simulation, 6.0 * 3600.0, step_s);
            // 8 l/min of 70 degC and 6 kW: the storage is full of what the boiler sends.
            let t = |layer: usize| get(&simulation, &format!("storage.t_{layer}_k")) - 273.15;
            assert!(t(10) > 60.0 && t(1) < t(10), "{scheme} {step_s}: {} {}", t(1), t(10));
            // Steps of 0.7 of three: two thirds of 6 kW, until its layer is at 95 degC.
            assert!(get(&simulation, "storage.rod_j") > 4000.0 * 3600.0 * 0.5);
            // What charged, heated, was drawn and lost is what is stored: 785 kg and 16.5 kg from 30 degC on.
            let parts = ["charged_j", "rod_j", "discharged_j", "loss_j", "energy_j"]
                .map(|name| get(&simulation, &format!("storage.{name}")));
            let [charged, rod, drawn, lost, stored] = parts;
            let open = charged + rod - drawn - lost - stored;
            assert!(open.abs() < 1e-9 * charged, "{scheme} {step_s}: {open} of {parts:?}");
        }
    }
}

#[test]
fn a_position_chooses_the_height() {
    let mut simulation = simulation(&house("mixed_layers"));
    advance(&mut simulation, 3600.0, 60.0);
    set(&mut simulation, "storage.heating_position", 1.0);
    advance(&mut simulation, 60.0, 60.0);
    let outlet = get(&simulation, "storage.heating_t_out_k");
    let layer = get(&simulation, "storage.t_6_k");
    assert!((outlet - layer).abs() < 1.5, "{outlet} {layer}");
}

#[test]
fn a_snapshot_continues_bit_for_bit_and_no_step_allocates() {
    for scheme in ["mixed_layers", "plug_flow"] {
        let mut simulation = simulation(&house(scheme));
        advance(&mut simulation, 1800.0, 60.0);
        let here = simulation.snapshot();
        let run = |simulation: &mut Simulation| {
            advance(simulation, 1800.0, 60.0);
            (1..=10)
                .map(|l| get(simulation, &format!("storage.t_{l}_k")).to_bits())
                .collect::<Vec<_>>()
        };
        let first = run(&mut simulation);
        simulation.restore(&here).unwrap();
        assert_eq!(first, run(&mut simulation));
        let found = measure(|| advance(&mut simulation, 1800.0, 60.0));
        assert_eq!((found.count_total, found.bytes_total), (0, 0), "{scheme}");
    }
}

/// A storage is the balancing unit between a warm and a cold line: it passes what houses take more or less.
const BALANCING: &str = r#"format = 1
[run]
until = "6h"
step = "60s"
initial_degc = 18
[[node]]
id = "cold"
[[node]]
id = "warm"
[[edge]]
id = "balance"
kind = "resistance"
from = "cold"
to = "warm"
dp_nominal_pa = 500
m_flow_nominal_kg_s = 1
[[edge]]
id = "houses"
kind = "flow_source"
from = "warm"
to = "cold"
[pressure_reference]
node = "cold"
[[unit]]
id = "storage"
kind = "storage"
port = "balance"
volume_m3 = 2
height_m = 2.5
ua_w_k = 0
initial_bottom_degc = 15
initial_top_degc = 20
ports = { grid = { inlet_m = 0.05, outlet_m = 2.45 } }
[[unit]]
id = "houses_unit"
kind = "prescribed_source"
port = "houses"
supply_degc = 12
v_flow_l_min = 6
"#;

#[test]
fn a_storage_balances_two_lines() {
    let mut simulation = simulation(BALANCING);
    advance(&mut simulation, 3600.0, 60.0);
    // Houses take 0.1 kg/s from the warm line: it leaves the top, and what they return enters the bottom.
    let flow = get(&simulation, "storage.grid_m_flow_kg_s");
    assert!((flow - 0.1).abs() < 1e-3, "{flow}");
    assert!(get(&simulation, "storage.t_1_k") < 288.15 - 1.0);
    let before = get(&simulation, "storage.energy_j");
    // They give: the storage takes water of the houses at its top.
    set(&mut simulation, "houses_unit.v_flow_m3_s", -1e-4);
    set(&mut simulation, "houses_unit.supply_k", 296.15);
    advance(&mut simulation, 3600.0, 60.0);
    assert!((get(&simulation, "storage.grid_m_flow_kg_s") + 0.1).abs() < 1e-3);
    assert!(get(&simulation, "storage.energy_j") > before);
    assert!(get(&simulation, "storage.t_10_k") > 294.0);
}
