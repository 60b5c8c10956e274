//! The plant: a supply temperature, and a pressure difference held at the plant or at the worst consumer.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady::{self, Steady};
use std::path::Path;

/// A plant, a near and a far consumer in a line.
const LINE: &str = r#"
format = 1
[run]
initial_degc = 60
[pipe_type.dn25]
inner_diameter_mm = 28.5
insulation_resistance_k_m_w = 3.4
[[site]]
id = "plant"
[[site]]
id = "near"
[[site]]
id = "far"
[[trench]]
from = "plant"
to = "near"
length_m = 50
pipe = "dn25"
[[trench]]
from = "near"
to = "far"
length_m = 200
pipe = "dn25"
[station_type.house]
kind = "consumer"
extraction_valve = { kvs_m3_h = 1.0, characteristic = "linear", opening = 0.5 }
heat_exchanger = { m_flow_nominal_kg_s = 0.1 }
unit = { kind = "prescribed_source", supply_degc = 40, v_flow_l_min = 5 }
[[station]]
site = "near"
type = "house"
[[station]]
site = "far"
type = "house"
"#;

const PUMP: &str = "circulation_pump = { head_max_bar = 3, free_flow_m3_h = 6 }";

fn plant(fields: &str) -> String {
    format!("{LINE}[[station]]\nsite = \"plant\"\nkind = \"plant\"\n{fields}\n")
}

fn model(text: &str) -> Model {
    let model = Model::from_toml(text, Path::new("."));
    model.unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn simulation(text: &str) -> Simulation {
    let plan = build(&model(text)).unwrap_or_else(|problems| panic!("{}", problems.render(text)));
    Simulation::new(plan).unwrap()
}

fn solved(fields: &str) -> Steady {
    steady::solve(&model(&plant(fields))).unwrap_or_else(|error| panic!("{error}"))
}

/// Pressure difference between the lines of a site, Pa.
fn dp_pa(steady: &Steady, site: &str) -> f64 {
    let p_pa = |line: &str| steady.node(&format!("{site}.{line}")).unwrap().p_pa;
    p_pa("hot") - p_pa("cold")
}

fn get(simulation: &Simulation, channel: &str) -> f64 {
    simulation.get(simulation.channel(channel).unwrap_or_else(|error| panic!("{error}")))
}

fn advance(simulation: &mut Simulation, until_s: f64) {
    simulation.advance_to(Time::from_s(until_s).unwrap(), Time::from_s(5.0).unwrap()).unwrap();
}

#[test]
fn constant_pressure_difference_and_supply_temperature() {
    let steady =
        solved(&format!("dp_bar = 0.6\nsupply_degc = 80\nreturn_pressure_bar = 2\n{PUMP}"));
    // 0.6 bar but for the droop of the pump, 0.1 % at its nominal flow.
    assert!((dp_pa(&steady, "plant") / 60_000.0 - 1.0).abs() < 1e-3);
    assert!((steady.node("plant.hot").unwrap().t_k - 353.15).abs() < 1e-6);
    assert!((steady.node("plant.cold").unwrap().p_pa - 2e5).abs() < 1e-6);
    assert!(steady.edge("plant.generator").unwrap().m_flow_kg_s > 0.05);
    assert!(dp_pa(&steady, "far") < dp_pa(&steady, "near"));
}

#[test]
fn the_worst_consumer_has_what_it_needs() {
    let fields = format!(
        "dp_bar = 0.3\ndp_at = \"worst_consumer\"\nsupply_degc = 80\nreturn_pressure_bar = 2\n{PUMP}"
    );
    let steady = solved(&fields);
    assert!((dp_pa(&steady, "far") / 30_000.0 - 1.0).abs() < 1e-6, "{}", dp_pa(&steady, "far"));
    assert!(dp_pa(&steady, "near") > 31_000.0);
    // Uphill the whole water column counts in both lines, so nothing changes.
    let hilly = plant(&fields).replace("id = \"far\"", "id = \"far\"\nelevation_m = 30");
    let hilly = steady::solve(&model(&hilly)).unwrap();
    assert!((dp_pa(&hilly, "far") / 30_000.0 - 1.0).abs() < 1e-6);
    // Of the near one alone, the far one has less.
    let near = solved(&format!("{fields}\nconsumers = [\"near.station\"]"));
    assert!((dp_pa(&near, "near") / 30_000.0 - 1.0).abs() < 1e-6);
    assert!(dp_pa(&near, "far") < 29_000.0);
    // A pump that is too weak does what it can: it stays at full head.
    let weak = solved(&fields.replace("head_max_bar = 3", "head_max_bar = 0.31"));
    assert!(dp_pa(&weak, "far") < 29_000.0);
    // The plain model has the same solution.
    let plain = model(&plant(&fields)).to_plain_toml().unwrap();
    let again = steady::solve(&model(&plain)).unwrap();
    assert!((dp_pa(&again, "far") - dp_pa(&steady, "far")).abs() < 1e-3);
}

#[test]
fn the_head_follows_the_worst_consumer_in_a_run() {
    let text = plant(&format!(
        "dp_bar = 0.3\ndp_at = \"worst_consumer\"\nsupply_degc = 80\nreturn_pressure_bar = 2\n{PUMP}"
    )) + "[[schedule]]\nsignal = \"far.extraction_valve.opening\"\npoints = [[0, 0.5], [1800, 0.9]]\n";
    let mut simulation = simulation(&text);
    let worst = |simulation: &Simulation| get(simulation, "plant.worst_consumer.dp_pa");
    advance(&mut simulation, 1800.0);
    assert!((worst(&simulation) / 30_000.0 - 1.0).abs() < 1e-3, "{}", worst(&simulation));
    let before = get(&simulation, "plant.circulation_pump.head_pa_command");
    // The far house opens its valve: at first it gets less pressure, then the head rises.
    advance(&mut simulation, 1830.0);
    assert!(worst(&simulation) < 29_000.0, "{}", worst(&simulation));
    advance(&mut simulation, 3600.0);
    assert!((worst(&simulation) / 30_000.0 - 1.0).abs() < 1e-3, "{}", worst(&simulation));
    assert!(get(&simulation, "plant.circulation_pump.head_pa_command") > 1.05 * before);
    // The run ends where the steady state is.
    let end = steady::solve(&model(&text.replace("[0, 0.5]", "[0, 0.9]"))).unwrap();
    let flow = get(&simulation, "plant.generator.m_flow_kg_s");
    assert!((end.edge("plant.generator").unwrap().m_flow_kg_s / flow - 1.0).abs() < 1e-3);
    let balances = Balances::of(&simulation);
    assert!(balances.heat_error() < 1e-9 && balances.hydraulic_error() < 1e-9, "{balances:?}");
}

#[test]
fn the_supply_follows_the_outdoor_temperature() {
    let text = plant(&format!(
        "dp_bar = 0.6\noutdoor_curve_degc = [[-12, 90], [15, 70]]\noutdoor_degc = -20\n\
         return_pressure_bar = 2\n{PUMP}"
    )) + "[[schedule]]\nsignal = \"plant.unit.outdoor_k\"\nunit = \"degC\"\n\
          interpolation = \"linear\"\npoints = [[0, -12], [600, 15]]\n";
    let mut simulation = simulation(&text);
    // 90 - 20/27 * (T + 12): at 300 s T = 1.5 degC and the supply 80 degC
    for (time_s, supply_degc) in [(5.0, 89.833_333), (300.0, 80.0), (600.0, 70.0), (900.0, 70.0)] {
        advance(&mut simulation, time_s);
        let t_degc = get(&simulation, "plant.unit.t_out_k") - 273.15;
        assert!((t_degc - supply_degc).abs() < 1e-5, "{time_s}: {t_degc}");
    }
    let steady = solved(&format!(
        "dp_bar = 0.6\noutdoor_curve_degc = [[-12, 90], [15, 70]]\noutdoor_degc = -20\n\
         return_pressure_bar = 2\n{PUMP}"
    ));
    assert!((steady.node("plant.hot").unwrap().t_k - 363.15).abs() < 1e-6);
}

#[test]
fn without_a_pressure_difference_the_pump_runs_at_its_speed() {
    let full = solved(&format!("supply_degc = 80\nreturn_pressure_bar = 2\n{PUMP}"));
    let half = PUMP.replace("head_max", "speed = 0.5, head_max");
    let half = solved(&format!("supply_degc = 80\nreturn_pressure_bar = 2\n{half}"));
    // H = u^2 H0 - a V^2 and losses that are nearly square: at half the speed a quarter of the head.
    let head = |steady: &Steady| dp_pa(steady, "plant");
    assert!(head(&full) > 2.7e5 && head(&full) < 3e5, "{}", head(&full));
    assert!((head(&half) / head(&full) - 0.25).abs() < 0.005);
}
