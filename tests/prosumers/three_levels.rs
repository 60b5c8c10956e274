//! Three temperature levels: what one house gives back heats the floors of another, whose second circuit heats its taps.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::workspace;

/// Means over the day after its first hour.
#[derive(Debug, Default)]
struct Day {
    flow_kg_s: f64,
    /// Of what comes back to the plant, by flow, K.
    return_k: f64,
    warm_k: f64,
    surplus_kg_s: f64,
    admixed_kg_s: f64,
    least_tap_k: f64,
    taps_j: f64,
    taken_j: f64,
    floors_j: f64,
}

fn day(levels: u32) -> Day {
    let path = workspace().join("examples/three-levels/model.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let text = match levels {
        3 => text,
        _ => {
            assert!(
                text.contains("cold = \"old.warm\" #") && text.contains("hot = \"new.warm\" #")
            );
            text.replace("\"old.warm\" #", "\"old.cold\" #")
                .replace("\"new.warm\" #", "\"new.hot\" #")
        }
    };
    let model = Model::from_toml(&text, &workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
    let plan = build(&model).unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
    let mut simulation = Simulation::new(plan).unwrap();
    let get = |simulation: &Simulation, channel: &str| {
        simulation.get(simulation.channel(channel).unwrap())
    };
    let step = Time::from_s(10.0).unwrap();
    let mut day = Day { least_tap_k: f64::INFINITY, ..Day::default() };
    let (from, until) = (360, 8640);
    let each = 1.0 / f64::from(until - from);
    for k in 1..=until {
        simulation.advance_to(Time::from_s(10.0 * f64::from(k)).unwrap(), step).unwrap();
        day.floors_j -= 10.0 * get(&simulation, "new.floors.q_flow_w");
        if k <= from {
            continue;
        }
        let flow = get(&simulation, "plant.circulation_pump.m_flow_kg_s");
        day.flow_kg_s += each * flow;
        day.return_k += each * flow * get(&simulation, "plant.generator_inlet.t_k");
        day.warm_k += each * get(&simulation, "plant.warm.t_k");
        day.surplus_kg_s += each * get(&simulation, "surplus.m_flow_kg_s");
        day.admixed_kg_s += each * get(&simulation, "admixing.m_flow_kg_s");
        day.least_tap_k = day.least_tap_k.min(get(&simulation, "new.taps.t_tap_k"));
    }
    day.return_k /= day.flow_kg_s;
    day.taps_j = -get(&simulation, "new.second.heat_j");
    day.taken_j = get(&simulation, "new.taps.taken_j");
    let balances = Balances::of(&simulation);
    assert!(balances.heat_error() < 1e-9 && balances.units_error() < 1e-9);
    day
}

#[test]
fn a_second_circuit_uses_a_third_level() {
    let (three, two) = (day(3), day(2));
    // The warm line lives on what the radiators give back, 45 degC less what its pipe loses, and nothing is mixed in but
    // the leak of the valve: 24 to 14 kW over 24 K are more water than 9 to 5 kW over 16 K.
    assert!((three.warm_k - 273.15 - 43.2).abs() < 0.5, "{three:?}");
    assert!(three.admixed_kg_s < 1e-3 && three.surplus_kg_s > 0.03, "{three:?}");
    // Every draw is warm; what the second circuit takes is what the taps need, and the same in both grids.
    for day in [&three, &two] {
        assert!((day.least_tap_k - 318.15).abs() < 1e-6, "{day:?}");
        assert!((day.taps_j / day.taken_j - 1.0).abs() < 1e-3, "{day:?}");
        // 7 to 9, to 5, to 6, to 7 kW: 25.2e3 * 8 + 25.2e3 * 7 + 14.4e3 * 5.5 + 21.6e3 * 6.5 = 597.6 MJ
        assert!((day.floors_j / 597.6e6 - 1.0).abs() < 1e-3, "{day:?}");
    }
    assert!((three.taken_j / two.taken_j - 1.0).abs() < 1e-3, "{three:?} {two:?}");
    // Water that is used twice: a fifth less flow, 7 K colder at the plant.
    assert!(three.flow_kg_s < 0.85 * two.flow_kg_s, "{three:?} {two:?}");
    assert!(two.return_k - three.return_k > 6.0, "{three:?} {two:?}");
}
