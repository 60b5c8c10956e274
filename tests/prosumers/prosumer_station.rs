//! The station of a prosumer at run time: change of direction, pause, participation, blocking, heat across the
//! interface, snapshots.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::running::{get, simulation};
use std::path::Path;

/// A balancing unit and a house that feeds in 5 l/min at 60 degC, extracts 5 l/min from 600 s to 1200 s, then feeds in.
const GRID: &str = r#"
format = 1
[run]
initial_degc = 40
[fluid]
kind = "constant_water"
density_kg_m3 = 1000
heat_capacity_j_kg_k = 4180
[[site]]
id = "bu"
[[site]]
id = "house"
[[trench]]
from = "bu"
to = "house"
length_m = 50
inner_diameter_mm = 40
insulation_resistance_k_m_w = 5
[pressure_reference]
node = "bu.cold"
pressure_bar = 1.5
[[station]]
site = "bu"
kind = "balancing_unit"
unit = { kind = "heat_source", supply_degc = 50 }
[[unit]]
site = "house"
kind = "prescribed_source"
supply_degc = 60
v_flow_l_min = 5
[[schedule]]
signal = "house.unit.v_flow_m3_s"
unit = "l_min"
points = [[0, 5], [600, -5], [1200, 5]]
[[schedule]]
signal = "house.unit.supply_k"
unit = "degc"
points = [[0, 60], [600, 30], [1200, 60]]
[[station]]
site = "house"
kind = "prosumer"
"#;

fn advance(simulation: &mut Simulation, until_s: f64, step_s: f64) {
    let [until, step] = [until_s, step_s].map(|s| Time::from_s(s).unwrap());
    simulation.advance_to(until, step).unwrap();
}

fn set(simulation: &mut Simulation, signal: &str, value: f64) {
    let signal = simulation.signal(signal).unwrap();
    simulation.set(signal, value).unwrap();
}

/// Kg/s of 5 l/min.
const ASKED: f64 = 5.0 / 60.0;

#[test]
fn the_direction_changes_with_a_pause_and_never_in_a_circle() {
    let mut simulation = simulation(GRID);
    advance(&mut simulation, 600.0, 1.0);
    let flow = |simulation: &Simulation| get(simulation, "house.station.m_flow_kg_s");
    let set_point = |simulation: &Simulation, direction: &str| {
        get(simulation, &format!("house.{direction}_pump.flow_control.set_point_command"))
    };
    assert!((flow(&simulation) / ASKED - 1.0).abs() < 1e-3, "{}", flow(&simulation));
    let (mut paused, mut began) = (0, None);
    for second in 601..=1200 {
        advance(&mut simulation, f64::from(second), 1.0);
        let parts = |part: &str| get(&simulation, &format!("house.{part}.m_flow_kg_s"));
        // What leaves one line enters the other, through the unit.
        let through = parts("interface");
        assert!((parts("stub_hot") - through).abs() < 1e-12, "{second}");
        assert!((parts("stub_cold") + through).abs() < 1e-12, "{second}");
        // Both branches together carry it: what goes round through the idle one is what its closing valve leaks.
        let (feed_in, extraction) = (parts("feed_in_pump"), parts("extraction_pump"));
        assert!((feed_in - extraction - through).abs() < 1e-12, "{second}");
        assert!(
            feed_in.abs().min(extraction.abs()) < 1e-4 * ASKED,
            "{second}: {feed_in} {extraction}"
        );
        let (feed_in, extraction) =
            (set_point(&simulation, "feed_in"), set_point(&simulation, "extraction"));
        assert_eq!(feed_in, 0.0);
        if extraction == 0.0 {
            paused += 1;
            assert_eq!(get(&simulation, "house.extraction_pump.speed"), 0.0);
            assert!(through > -1e-9, "{second}: {through}");
        } else {
            began = began.or(Some(second));
        }
    }
    // The pause of 5 s, then the other direction.
    assert_eq!((paused, began), (5, Some(606)));
    assert!((flow(&simulation) / ASKED + 1.0).abs() < 1e-3, "{}", flow(&simulation));
    assert_eq!(get(&simulation, "house.extraction_shut_off.opening"), 1.0);
    assert!(get(&simulation, "house.feed_in_shut_off.opening") < 1e-9);
    advance(&mut simulation, 1800.0, 1.0);
    assert!((flow(&simulation) / ASKED - 1.0).abs() < 1e-3, "{}", flow(&simulation));
    assert!(get(&simulation, "house.extraction_pump.speed") < 1e-9);
}

#[test]
fn without_dynamics_the_direction_changes_within_a_step() {
    for step_s in [1.0, 60.0] {
        let mut simulation = simulation(&format!("{GRID}flow_control = \"quasi_steady\"\n"));
        for (until_s, sign) in [(600.0, 1.0), (600.0 + step_s, -1.0), (1200.0 + step_s, 1.0)] {
            advance(&mut simulation, until_s, step_s);
            let ratio = sign * get(&simulation, "house.station.m_flow_kg_s") / ASKED;
            assert!((ratio - 1.0).abs() < 2e-3, "{step_s} s, {until_s}: {ratio}");
        }
    }
}

#[test]
fn the_heat_of_the_unit_is_what_the_grid_gets() {
    for (flow_control, step_s) in [("pi", 1.0), ("quasi_steady", 10.0), ("quasi_steady", 60.0)] {
        let mut simulation =
            simulation(&format!("{GRID}ua_w_k = 3\nflow_control = \"{flow_control}\"\n"));
        let mut of_unit_j = 0.0;
        while simulation.time() < Time::from_s(1800.0).unwrap() {
            let until_s = simulation.time().as_s() + step_s;
            advance(&mut simulation, until_s, step_s);
            of_unit_j += step_s * get(&simulation, "house.unit.q_flow_w");
        }
        // What the unit gave is what the station counted,
        let heat_j = get(&simulation, "house.station.heat_j");
        assert!(
            heat_j.abs() > 1e6 && (of_unit_j / heat_j - 1.0).abs() < 1e-12,
            "{of_unit_j} {heat_j}"
        );
        // that of both stations is all that the water got,
        let balances = Balances::of(&simulation);
        let both_j = heat_j + get(&simulation, "bu.station.heat_j");
        assert!((both_j / balances.units_j - 1.0).abs() < 1e-12, "{both_j} {balances:?}");
        // and the water of pipes and volumes holds it or has lost it.
        assert!(balances.heat_error() < 1e-9, "{flow_control}: {balances:?}");
        assert!(balances.units_error() < 1e-9, "{flow_control}: {balances:?}");
    }
}

#[test]
fn participation_takes_the_house_off_and_on_again_during_a_run() {
    for (flow_control, step_s) in [("pi", 1.0), ("quasi_steady", 60.0)] {
        let mut simulation = simulation(&format!("{GRID}flow_control = \"{flow_control}\"\n"));
        let flow = |simulation: &Simulation| get(simulation, "house.station.m_flow_kg_s") / ASKED;
        advance(&mut simulation, 300.0, step_s);
        assert!(flow(&simulation) > 0.99);
        set(&mut simulation, "house.station.participation", 0.0);
        advance(&mut simulation, 420.0, step_s);
        assert!(flow(&simulation).abs() < 1e-6, "{}", flow(&simulation));
        assert_eq!(get(&simulation, "house.unit.v_flow_m3_s_command"), 5.0 / 60_000.0);
        // It stays off when the house wants the other direction, and is not blocked.
        advance(&mut simulation, 900.0, step_s);
        assert!(flow(&simulation).abs() < 1e-6, "{}", flow(&simulation));
        assert_eq!(get(&simulation, "house.station.blocked"), 0.0);
        set(&mut simulation, "house.station.participation", 0.5);
        advance(&mut simulation, 1200.0, step_s);
        assert!((flow(&simulation) + 0.5).abs() < 5e-3, "{}", flow(&simulation));
        set(&mut simulation, "house.station.participation", 1.0);
        advance(&mut simulation, 1800.0, step_s);
        assert!((flow(&simulation) - 1.0).abs() < 5e-3, "{}", flow(&simulation));
        let balances = Balances::of(&simulation);
        assert!(balances.heat_error() < 1e-9, "{balances:?}");
    }
}

#[test]
fn a_flow_that_the_pump_cannot_give_is_blocked_until_less_is_asked_for() {
    for (flow_control, step_s) in [("pi", 1.0), ("quasi_steady", 10.0)] {
        for direction in [1.0, -1.0] {
            let mut simulation = simulation(&format!("{GRID}flow_control = \"{flow_control}\"\n"));
            let blocked = |simulation: &Simulation| get(simulation, "house.station.blocked");
            let ask = |simulation: &mut Simulation, l_min: f64| {
                set(simulation, "house.unit.v_flow_m3_s", direction * l_min / 60_000.0);
            };
            // The pump ends at 55 l/min without any resistance.
            ask(&mut simulation, 100.0);
            advance(&mut simulation, 50.0, step_s);
            assert_eq!(blocked(&simulation), 0.0);
            advance(&mut simulation, 150.0, step_s);
            assert_eq!(blocked(&simulation), 1.0, "{flow_control} {direction}");
            ask(&mut simulation, 10.0);
            advance(&mut simulation, 300.0, step_s);
            assert_eq!(blocked(&simulation), 0.0, "{flow_control} {direction}");
            let events: Vec<_> = simulation.take_events().map(|event| event.kind).collect();
            let told = |kind: &str| events.iter().filter(|event| *event == kind).count();
            assert_eq!((told("blocked"), told("unblocked")), (1, 1), "{events:?}");
        }
    }
}

#[test]
fn a_snapshot_in_the_pause_continues_bit_for_bit() {
    let mut whole = simulation(GRID);
    advance(&mut whole, 603.0, 1.0);
    // Neither direction is asked for, and the pump runs down.
    for direction in ["feed_in", "extraction"] {
        let set_point = format!("house.{direction}_pump.flow_control.set_point_command");
        assert_eq!(get(&whole, &set_point), 0.0);
    }
    assert!(get(&whole, "house.feed_in_pump.speed") > 0.05);
    let bytes = whole.snapshot().to_bytes().unwrap();
    let mut restored = simulation(GRID);
    restored.restore_bytes(&bytes).unwrap();
    for until_s in [605.0, 607.0, 1500.0] {
        for simulation in [&mut whole, &mut restored] {
            advance(simulation, until_s, 1.0);
        }
        let [first, second] = [&whole, &restored].map(|it| it.snapshot().to_bytes().unwrap());
        assert_eq!(first, second, "{until_s} s");
    }
}

#[test]
fn one_pump_between_three_way_valves_delivers_as_two_pumps() {
    for (flow_control, step_s) in [("pi", 1.0), ("quasi_steady", 60.0)] {
        let with = |hydraulics: &str| {
            let text =
                format!("{GRID}flow_control = \"{flow_control}\"\nhydraulics = \"{hydraulics}\"\n");
            let mut simulation = simulation(&text);
            [600.0, 1200.0, 1800.0].map(|until_s| {
                advance(&mut simulation, until_s, step_s);
                let balances = Balances::of(&simulation);
                assert!(balances.heat_error() < 1e-9, "{hydraulics}: {balances:?}");
                assert!(balances.hydraulic_error() < 1e-9, "{hydraulics}: {balances:?}");
                let p_pa = |node: &str| get(&simulation, &format!("house.{node}.p_pa"));
                [
                    get(&simulation, "house.station.m_flow_kg_s") / ASKED,
                    get(&simulation, "house.unit.q_flow_w") / 10_000.0,
                    // What the pump overcomes between the two sides of the station.
                    (p_pa("port_cold") - p_pa("branch_cold")) / 1000.0,
                    get(&simulation, "bu.hot.t_k") / 300.0,
                    get(&simulation, "bu.cold.t_k") / 300.0,
                ]
            })
        };
        let (two, one) = (with("two_pumps"), with("one_pump"));
        for (two, one) in two.iter().zip(&one) {
            assert!(two[0].abs() > 0.99 && two[2] * two[0] > 0.0, "{two:?}");
            for (two, one) in two.iter().zip(one) {
                assert!((one / two - 1.0).abs() < 0.01, "{flow_control}: {one} {two}");
            }
        }
        assert!(one[1][0] < 0.0 && one[0][0] > 0.0);
    }
}

#[test]
fn one_pump_runs_down_before_its_valves_let_it_run_the_other_way() {
    let text = format!("{GRID}hydraulics = \"one_pump\"\n");
    let mut whole = simulation(&text);
    advance(&mut whole, 600.0, 1.0);
    let opening =
        |simulation: &Simulation, way: &str| get(simulation, &format!("house.{way}.opening"));
    assert_eq!(opening(&whole, "feed_in_way_in"), 1.0);
    assert!(opening(&whole, "extraction_way_in") < 1e-9);
    advance(&mut whole, 603.0, 1.0);
    assert!(get(&whole, "house.pump.speed") > 0.05);
    // In the pause both three-way valves are shut or on their way.
    assert!(
        opening(&whole, "feed_in_way_out") < 0.1 && opening(&whole, "extraction_way_out") < 0.1
    );
    let mut restored = simulation(&text);
    restored.restore_bytes(&whole.snapshot().to_bytes().unwrap()).unwrap();
    for until_s in [605.0, 1500.0] {
        for simulation in [&mut whole, &mut restored] {
            advance(simulation, until_s, 1.0);
        }
        let [first, second] = [&whole, &restored].map(|it| it.snapshot().to_bytes().unwrap());
        assert_eq!(first, second, "{until_s} s");
        if until_s == 605.0 {
            assert!(get(&whole, "house.pump.speed") < 0.05);
            assert!(get(&whole, "house.station.m_flow_kg_s").abs() < 1e-4);
        }
    }
    // Blocked also while it extracts.
    set(&mut whole, "house.unit.v_flow_m3_s", -100.0 / 60_000.0);
    advance(&mut whole, 1700.0, 1.0);
    assert_eq!(get(&whole, "house.station.blocked"), 1.0);
    assert!(get(&whole, "house.station.m_flow_kg_s") < -ASKED);
}

#[test]
fn one_pump_has_a_steady_state() {
    for flow_control in ["pi", "quasi_steady"] {
        for (l_min, sign) in [("5", 1.0), ("-5", -1.0)] {
            let flow = |hydraulics: &str| {
                let text = format!(
                    "{}flow_control = \"{flow_control}\"\nhydraulics = \"{hydraulics}\"\n",
                    GRID.replace("v_flow_l_min = 5", &format!("v_flow_l_min = {l_min}"))
                        .replace("points = [[0, 5]", &format!("points = [[0, {l_min}]"))
                );
                let model = Model::from_toml(&text, Path::new(".")).unwrap();
                let steady = anergy_simulation::steady::solve(&model).unwrap();
                steady.edge("house.interface").unwrap().m_flow_kg_s
            };
            let (two, one) = (flow("two_pumps"), flow("one_pump"));
            assert!((sign * two / ASKED - 1.0).abs() < 2e-3, "{flow_control} {l_min}: {two}");
            assert!((one / two - 1.0).abs() < 0.01, "{flow_control} {l_min}: {one} {two}");
        }
    }
}
