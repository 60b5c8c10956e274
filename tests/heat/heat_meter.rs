//! Heat meters in the supply and in the return count what a part of the network took, to the joule.

#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::workspace;

fn model(text: &str) -> Model {
    Model::from_toml(text, &workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn value(simulation: &Simulation, channel: &str) -> f64 {
    simulation.get(simulation.channel(channel).unwrap())
}

/// Water of 70 degC through a meter, a pipe that loses heat, and a second meter.
const LINE: &str = r#"
format = 1
[run]
initial_degc = 30.0
[ground]
temperature_degc = 10.0
[[node]]
id = "in"
kind = "source"
m_flow_kg_s = 0.2
temperature_degc = 70.0
[[node]]
id = "a"
[[node]]
id = "b"
[[node]]
id = "out"
kind = "pressure_boundary"
pressure_bar = 1.0
temperature_degc = 40.0
[[edge]]
id = "supply"
kind = "heat_meter"
from = "in"
to = "a"
return_node = "out"
m_flow_nominal_kg_h = 1500.0
[[edge]]
id = "house"
kind = "pipe"
from = "a"
to = "b"
length_m = 100.0
inner_diameter_mm = 20.0
insulation_resistance_k_m_w = 0.5
[[edge]]
id = "return"
kind = "heat_meter"
from = "b"
to = "out"
supply_node = "in"
m_flow_nominal_kg_s = 0.4
dp_nominal_bar = 0.1
"#;

#[test]
fn what_the_meters_count_is_what_was_lost_and_stored() {
    // 100 m at 0.5 K m/W: T_out = 10 + 60 exp(-100/(0.5 * 0.2 * 4180)) =
    // 10 + 60 exp(-0.239234) = 57.2336 degC; 0.2 * 4180 * 12.7664 = 10672.7 W.
    let steady = steady::solve(&model(LINE)).unwrap();
    assert!((steady.node("out").unwrap().t_k - 273.15 - 57.2336).abs() < 1e-3);
    // 0.25 bar at 1.5 m3/h: at 0.72 m3/h 5760 Pa.
    assert!((steady.edge("supply").unwrap().dp_pa - 5_760.0).abs() < 0.01);
    let mut simulation = Simulation::new(build(&model(LINE)).unwrap()).unwrap();
    let stored = |simulation: &Simulation| value(simulation, "network.stored_j");
    let before_j = stored(&simulation);
    for step_s in [1.0, 7.0, 400.0] {
        let end = simulation.time() + Time::from_s(2800.0).unwrap();
        simulation.advance_to(end, Time::from_s(step_s).unwrap()).unwrap();
        let taken_j = value(&simulation, "network.loss_j") + stored(&simulation) - before_j;
        for meter in ["supply", "return"] {
            let counted_j = value(&simulation, &format!("{meter}.heat_j"));
            // The drops at "in" and "out", 1 mg each, are before or behind a sensor.
            assert!((counted_j - taken_j).abs() < 0.5, "{meter}: {counted_j} J of {taken_j} J");
            let q_flow_w = value(&simulation, &format!("{meter}.q_flow_w"));
            assert!((q_flow_w - 10_672.7).abs() < 1.0, "{meter}: {q_flow_w} W");
        }
    }
    assert!((value(&simulation, "supply.volume_m3") - 0.2e-3 * 8400.0).abs() < 1e-9);
    // Turned round, both count backwards: water of 40 degC comes in at "out".
    let signal = simulation.signal("in.m_flow_kg_s").unwrap();
    simulation.set(signal, -0.2).unwrap();
    let end = simulation.time() + Time::from_s(3600.0).unwrap();
    simulation.advance_to(end, Time::from_s(1.0).unwrap()).unwrap();
    let flows = ["supply.q_flow_w", "return.q_flow_w"].map(|name| value(&simulation, name));
    // 10 + 30 exp(-0.239234) = 33.6168 degC: -0.2 * 4180 (33.6168 - 40) = 5336.4 W into the surroundings.
    assert!(flows.iter().all(|q| (q - 5_336.4).abs() < 1.0), "{flows:?}");
    // Standing water counts nothing.
    let (heat_j, volume_m3) =
        (value(&simulation, "supply.heat_j"), value(&simulation, "supply.volume_m3"));
    simulation.set(signal, 0.0).unwrap();
    let end = simulation.time() + Time::from_s(60.0).unwrap();
    simulation.advance_to(end, Time::from_s(1.0).unwrap()).unwrap();
    assert!((value(&simulation, "supply.heat_j") - heat_j).abs() < 1e-3);
    assert!((value(&simulation, "supply.volume_m3") - volume_m3).abs() < 1e-12);
    // A snapshot keeps the readings.
    let snapshot = simulation.snapshot();
    simulation.set(signal, 0.2).unwrap();
    let end = simulation.time() + Time::from_s(60.0).unwrap();
    simulation.advance_to(end, Time::from_s(1.0).unwrap()).unwrap();
    simulation.restore(&snapshot).unwrap();
    assert!((value(&simulation, "supply.heat_j") - heat_j).abs() < 1e-3);
}
