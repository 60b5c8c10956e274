//! The losses of pumps in the water: by hand over one pump, and in the balance of a whole run; and the
//! balances of networks in which nothing happens.

#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::workspace;

fn model(text: &str) -> Model {
    Model::from_toml(text, &workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn simulation(text: &str) -> Simulation {
    Simulation::new(build(&model(text)).unwrap()).unwrap()
}

fn advance(simulation: &mut Simulation, until_s: f64, step_s: f64) {
    simulation.advance_to(Time::from_s(until_s).unwrap(), Time::from_s(step_s).unwrap()).unwrap();
}

/// A pump at full speed that sends 0.4 kg/s through an open line.
fn line(pump: &str) -> String {
    format!(
        "format = 1
[[node]]
id = \"in\"
kind = \"pressure_boundary\"
pressure_bar = 1.0
temperature_degc = 40.0
[[node]]
id = \"mid\"
[[node]]
id = \"out\"
kind = \"source\"
m_flow_kg_s = -0.4
[[edge]]
id = \"pump\"
kind = \"pump\"
from = \"in\"
to = \"mid\"
head_max_hpa = 402.21
free_flow_l_min = 55.33
speed = 1.0
initial_speed = 1.0
{pump}
[[edge]]
id = \"load\"
kind = \"resistance\"
from = \"mid\"
to = \"out\"
dp_nominal_bar = 0.1
m_flow_nominal_kg_s = 0.4
"
    )
}

#[test]
fn the_water_behind_a_pump_is_warmer_by_its_losses() {
    // H(0.4 l/s) = 40221 - 0.16 a, a = 40221/0.922167^2 = 4.72972e4: 32653.4 Pa, V H = 13.06138 W.
    // Wet rotor: P = 13.06138/0.49 = 26.65588 W, Q = P - V H = 13.59450 W; over 0.4 kg/s and 4180
    // J/(kg K) that is 8.13068 mK. Dry motor, f = 0.7: 0.7 P - V H = 5.59774 W, 3.34793 mK.
    for (share, q_w, rise_k) in [("1.0", 13.594_50, 8.130_68e-3), ("0.7", 5.597_74, 3.347_93e-3)] {
        let text = line(&format!("heat_to_water = {share}"));
        let steady = steady::solve(&model(&text)).unwrap();
        let t = |node: &str| steady.node(node).unwrap().t_k;
        assert!((t("mid") - 313.15 - rise_k).abs() < 1e-6, "{}", t("mid") - 313.15);
        let mut simulation = simulation(&text);
        advance(&mut simulation, 60.0, 1.0);
        let value = |name: &str| simulation.get(simulation.channel(name).unwrap());
        assert!((value("mid.t_k") - 313.15 - rise_k).abs() < 1e-6);
        assert!((value("pump.q_flow_w") - q_w).abs() < 1e-3, "{}", value("pump.q_flow_w"));
        assert!((value("network.pump_heat_w") - q_w).abs() < 1e-3);
        assert!((value("network.pump_heat_j") - 60.0 * q_w).abs() < 0.06);
        let balances = Balances::of(&simulation);
        assert!(balances.heat_error() < 1e-9, "{balances:?}");
    }
    // Without the share nothing: not even the channel.
    let simulation = simulation(&line(""));
    assert!(simulation.channel("pump.q_flow_w").is_err());
    let steady = steady::solve(&model(&line(""))).unwrap();
    assert!((steady.node("mid").unwrap().t_k - 313.15).abs() < 1e-6);
}

/// Three pumps with losses, one of which reverses its branch, in pipes that lose heat.
const RING: &str = r#"
format = 1
[run]
initial_degc = 35.0
[ground]
temperature_degc = 10.0
[pressure_reference]
node = "a"
[[node]]
id = "a"
[[node]]
id = "b"
[[node]]
id = "c"
[[node]]
id = "d"
[[edge]]
id = "p1"
kind = "pump"
head_max_hpa = 402.21
free_flow_l_min = 55.33
from = "a"
to = "b"
speed = 0.9
heat_to_water = 1.0
[[edge]]
id = "p2"
kind = "pump"
head_max_hpa = 402.21
free_flow_l_min = 55.33
from = "a"
to = "b"
mode = "flow"
m_flow_set_kg_s = 0.1
heat_to_water = 0.9
efficiency_v_flow_l_min = [0.0, 20.0, 50.0]
efficiency = [0.0, 0.4, 0.2]
[[edge]]
id = "p3"
kind = "pump"
head_max_hpa = 402.21
free_flow_l_min = 55.33
from = "d"
to = "c"
heat_to_water = 1.0
[[edge]]
id = "ab"
kind = "pipe"
from = "b"
to = "c"
length_m = 20.0
inner_diameter_mm = 25.0
insulation_resistance_k_m_w = 3.0
[[edge]]
id = "cd"
kind = "pipe"
from = "c"
to = "d"
length_m = 30.0
inner_diameter_mm = 20.0
insulation_resistance_k_m_w = 2.0
[[edge]]
id = "da"
kind = "pipe"
from = "d"
to = "a"
length_m = 10.0
inner_diameter_mm = 25.0
[[schedule]]
signal = "p3.speed"
points = [[0, 0.0], [100, 1.0], [600, 0.0]]
"#;

#[test]
fn the_heat_of_several_pumps_closes_the_balance() {
    for step in [0.5, 1.0, 20.0] {
        let mut simulation = simulation(RING);
        advance(&mut simulation, 1800.0, step);
        let balances = Balances::of(&simulation);
        assert!(balances.pump_heat_j > 1e3, "{balances:?}");
        assert!(balances.loss_j > 1e4);
        assert!(balances.heat_error() < 1e-9, "step {step}: {balances:?}");
        assert!(balances.hydraulic_error() < 1e-6, "{balances:?}");
    }
}

#[test]
fn losses_that_cannot_get_out_have_no_steady_state() {
    let tight = RING.replace("insulation_resistance_k_m_w = 3.0", "");
    let tight = tight.replace("insulation_resistance_k_m_w = 2.0", "");
    let error = steady::solve(&model(&tight)).unwrap_err().to_string();
    assert!(error.starts_with("at steady state: the water at"), "{error}");
    assert!(steady::solve(&model(RING)).is_ok());
}

#[test]
fn where_nothing_is_moved_the_balances_close_to_rounding() {
    // One temperature everywhere, with and without flow; before this the error was 0/0.
    let cold = RING.replace("initial_degc = 35.0", "initial_degc = 10.0");
    let cold = cold.replace("heat_to_water = 1.0", "").replace("heat_to_water = 0.9", "");
    let still = cold.replace("speed = 0.9", "speed = 0.0").replace("m_flow_set_kg_s = 0.1", "");
    let still = still.replace("[100, 1.0]", "[100, 0.0]");
    // Two pumps and a resistance: 3 mg of water go round at 20 kg a minute, and cool down.
    let short = cold.replace("kind = \"pipe\"", "kind = \"resistance\"\nkv_m3_h = 2.0");
    let short: String = short
        .lines()
        .filter(|line| !["length", "inner", "insulation"].iter().any(|word| line.starts_with(word)))
        .map(|line| line.to_owned() + "\n")
        .collect();
    for text in [cold, still, short] {
        let mut simulation = simulation(&text);
        advance(&mut simulation, 3600.0, 1.0);
        let balances = Balances::of(&simulation);
        assert!(balances.heat_error() < 1e-9, "{:.1e} {balances:?}", balances.heat_error());
        assert!(balances.hydraulic_error() < 1e-9, "{balances:?}");
    }
    let mut open = simulation(&line(""));
    advance(&mut open, 3600.0, 1.0);
    let before = Balances::of(&open);
    advance(&mut open, 7200.0, 1.0);
    let after = Balances::of(&open);
    assert!(after.heat_error() < 1e-9 && before.heat_error() < 1e-9, "{after:?}");
}
