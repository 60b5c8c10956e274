//! Heat pumps in a model: `examples/heat-pumps` in steps of any length, with its balances, from a snapshot.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::{NS_PER_S, Time};
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::running::get;
use anergy_tests::workspace;

fn simulation() -> Simulation {
    let folder = workspace().join("examples/heat-pumps");
    let text = std::fs::read_to_string(folder.join("model.toml")).unwrap();
    let model = Model::from_toml(&text, &folder)
        .unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
    Simulation::new(build(&model).unwrap()).unwrap()
}

fn advance(simulation: &mut Simulation, until_s: i64, step_s: i64) {
    simulation.advance_to(Time(until_s * NS_PER_S), Time(step_s * NS_PER_S)).unwrap();
}

/// Heat, electricity and starts of the units after six hours.
fn totals(step_s: i64) -> [[f64; 3]; 3] {
    let mut simulation = simulation();
    advance(&mut simulation, 21_600, step_s);
    let balances = Balances::of(&simulation);
    assert!(balances.heat_error() < 1e-9, "step {step_s}: {balances:?}");
    ["h1.booster", "h2.bhpts", "h3.heat_pump"].map(|unit| {
        ["heat_j", "electric_j", "starts"]
            .map(|quantity| get(&simulation, &format!("{unit}.{quantity}")))
    })
}

#[test]
fn energies_do_not_depend_on_the_step() {
    let fine = totals(10);
    for unit in fine {
        assert!(unit[0] > 20e6 && unit[1] > 5e6, "{fine:?}");
    }
    // Air source: four starts would be one too many; one at the begin, one at 4 h.
    assert_eq!(fine[2][2], 2.0);
    for (step_s, booster, air) in [(60, 5e-3, 1e-3), (300, 2e-2, 5e-3)] {
        for (unit, (coarse, fine)) in totals(step_s).iter().zip(&fine).enumerate() {
            let tolerance = if unit == 2 { air } else { booster };
            for quantity in 0..2 {
                let ratio = coarse[quantity] / fine[quantity];
                assert!(
                    (ratio - 1.0).abs() < tolerance,
                    "{step_s} s, unit {unit}: {coarse:?} {fine:?}"
                );
            }
            assert_eq!(coarse[2], fine[2]);
        }
    }
}

#[test]
fn the_grid_gives_what_the_houses_do_not_buy() {
    let mut simulation = simulation();
    advance(&mut simulation, 9000, 60);
    for unit in ["h1.booster", "h2.bhpts"] {
        let heat = |port: &str| get(&simulation, &format!("{unit}.{port}.q_flow_w"));
        let electric_w = get(&simulation, &format!("{unit}.electric_w"));
        let room_w = heat("house") + heat("grid") - electric_w;
        // 5 % of the electricity of the compressor warm the room.
        assert!(
            (room_w + 0.05 * electric_w).abs() < 1e-6 * electric_w,
            "{unit}: {room_w} {electric_w}"
        );
        assert!(get(&simulation, &format!("{unit}.grid.m_flow_kg_s")) < 0.0);
    }
    // The table of the booster at 0.6 of the speed, grid 18 degC, supply 35: 7 + 2.5 * 13/15 = 9.17 kW.
    let heat_w = get(&simulation, "h1.booster.q_flow_w");
    assert!((heat_w / 9166.7 - 1.0).abs() < 0.01, "{heat_w}");
    // The third house takes nothing of the grid, and its heater drives the compressor.
    assert!((get(&simulation, "h3.heat_pump.speed") - 1.0).abs() < 1e-9);
    assert_eq!(get(&simulation, "h3.heat_pump.aux_w"), 3000.0);
    // Cooling at the end: the grid of 18 degC cools 30 degC directly.
    advance(&mut simulation, 21_600, 60);
    assert_eq!(get(&simulation, "h2.bhpts.exchanger"), 1.0);
    assert!(get(&simulation, "h2.bhpts.q_flow_w") < -5000.0);
    assert!(get(&simulation, "h2.bhpts.grid.m_flow_kg_s") < 0.0);
}

#[test]
fn a_snapshot_continues_bit_for_bit() {
    let mut whole = simulation();
    advance(&mut whole, 2000, 20);
    let bytes = whole.snapshot().to_bytes().unwrap();
    let mut restored = simulation();
    restored.restore_bytes(&bytes).unwrap();
    for simulation in [&mut whole, &mut restored] {
        advance(simulation, 9000, 20);
    }
    assert_eq!(whole.snapshot().to_bytes().unwrap(), restored.snapshot().to_bytes().unwrap());
}
