//! Feed-in types and network types: `examples/feed-in-types` with one plant, one producer, one consumer.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::{NS_PER_S, Time};
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::workspace;

const TYPES: [&str; 3] = ["return_to_supply", "return_to_return", "supply_to_supply"];

/// The text of the example with other types of its three stations.
fn text(plant: &str, producer: &str, consumer: &str) -> String {
    let path = workspace().join("examples/feed-in-types/model.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let choose = |text: String, default: &str, chosen: &str| {
        let default = format!("type = \"{default}\" #");
        assert_eq!(text.matches(&default).count(), 1);
        text.replace(&default, &format!("type = \"{chosen}\" #"))
    };
    let text = choose(text, "pressurised", plant);
    let text = choose(text, "return_to_supply", producer);
    choose(text, "extraction_by_valve", consumer)
}

fn model(text: &str) -> Model {
    Model::from_toml(text, &workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

/// What the steady state says of a producer of 10 kW that warms its water by `rise_k`.
#[derive(Debug)]
struct Fed {
    head_pa: f64,
    flow_kg_s: f64,
    /// Of the producer's pump.
    hydraulic_w: f64,
    /// What comes back to the plant, K.
    return_k: f64,
    consumer_head_pa: f64,
    plant_w: f64,
}

fn fed(plant: &str, producer: &str, rise_k: f64) -> Fed {
    let consumer =
        if plant == "pressurised" { "extraction_by_valve" } else { "extraction_by_pump" };
    let text = text(plant, producer, consumer);
    let own = if producer == "return_to_supply" { 30 } else { 10 };
    let own = format!("difference_k = {own}, warmest");
    assert!(text.contains(&own));
    let text = text.replace(&own, &format!("difference_k = {rise_k}, warmest"));
    let steady = steady::solve(&model(&text)).unwrap();
    let edge = |id: &str| steady.edge(id).unwrap();
    let t_k = |id: &str| steady.node(id).unwrap().t_k;
    let pump = edge("far.feed_in_pump");
    // The heat is the same whatever the type.
    let heat_w = 4180.0 * pump.m_flow_kg_s * (t_k("far.port_hot") - t_k("far.port_cold"));
    assert!((heat_w / 10_000.0 - 1.0).abs() < 1e-6, "{heat_w}");
    let through = if plant == "pressurised" { "plant.generator" } else { "plant.interface" };
    let through = edge(through).m_flow_kg_s;
    assert!(through > 0.0);
    Fed {
        head_pa: -pump.dp_pa,
        flow_kg_s: pump.m_flow_kg_s,
        hydraulic_w: -pump.dp_pa * pump.m_flow_kg_s / 988.0,
        return_k: t_k("plant.cold"),
        consumer_head_pa: match plant {
            "pressurised" => 0.0,
            _ => -edge("consumer.extraction_pump").dp_pa,
        },
        plant_w: 4180.0 * through * (t_k("plant.hot") - t_k("plant.cold")),
    }
}

/// Heads within a rounding of the stations' own loss, Pa.
const SAME_PA: f64 = 2.0;

#[test]
fn return_to_supply_needs_the_largest_head_in_a_pressurised_grid() {
    for rise_k in [30.0, 10.0] {
        let supply = fed("pressurised", "return_to_supply", 30.0);
        // 0.30 bar of the plant less two pipes of 120 m, and the station itself.
        assert!((28_000.0..30_500.0).contains(&supply.head_pa), "{supply:?}");
        for producer in ["return_to_return", "supply_to_supply"] {
            let local = fed("pressurised", producer, rise_k);
            assert!(local.head_pa > 0.0 && supply.head_pa > 3.0 * local.head_pa, "{local:?}");
            // A third of the warming takes three times the flow, and nearly all of the advantage is gone.
            assert!(supply.hydraulic_w > local.hydraulic_w, "{supply:?} {local:?}");
            if rise_k == 30.0 {
                assert!((local.flow_kg_s / supply.flow_kg_s - 1.0).abs() < 1e-3);
                assert!(supply.hydraulic_w > 25.0 * local.hydraulic_w, "{supply:?} {local:?}");
            }
        }
    }
}

#[test]
fn without_pressure_the_pump_of_the_consumer_does_the_work_of_return_to_supply() {
    // The consumer's pump draws the supply below the return: the producer's pump stands, and more flows through it
    // than it is asked for. Taps of one line do not see that.
    let supply = fed("non_pressurised", "return_to_supply", 30.0);
    assert!((-1000.0..0.0).contains(&supply.head_pa), "{supply:?}");
    assert!(supply.flow_kg_s > 1.05 * 10_000.0 / (4180.0 * 30.0), "{supply:?}");
    for producer in ["return_to_return", "supply_to_supply"] {
        let local = fed("non_pressurised", producer, 30.0);
        assert!(local.head_pa > 500.0, "{local:?}");
    }
}

#[test]
fn return_to_return_warms_what_comes_back_to_the_plant() {
    for plant in ["pressurised", "non_pressurised"] {
        let [supply, back, reheat] = TYPES.map(|producer| fed(plant, producer, 30.0));
        // By hand: 10 kW warm the 0.27 kg/s of the return by 8.9 K.
        let warmer_k = back.return_k - supply.return_k;
        assert!((8.5..10.0).contains(&warmer_k), "{warmer_k}");
        assert!((reheat.return_k - supply.return_k).abs() < 0.5, "{reheat:?}");
        // The pipes lose more where they are warmer, which the plant gives.
        assert!(back.plant_w > supply.plant_w && reheat.plant_w > supply.plant_w);
    }
}

#[test]
fn a_pressurised_supply_needs_larger_heads_between_the_lines_only() {
    let pairs = TYPES.map(|producer| {
        (fed("pressurised", producer, 30.0), fed("non_pressurised", producer, 30.0))
    });
    let [supply, back, reheat] = &pairs;
    assert!(supply.0.head_pa > supply.1.head_pa + 25_000.0);
    for (with, without) in [back, reheat] {
        assert!(with.head_pa > without.head_pa, "{with:?} {without:?}");
        assert!(with.head_pa < without.head_pa + SAME_PA, "{with:?} {without:?}");
    }
    // What extracts pumps for itself.
    assert!(pairs.iter().all(|(_, without)| without.consumer_head_pa > 5000.0));
}

/// Flow of the consumer, l/min, and whether it is blocked, after ten minutes and after an hour of a run.
fn run(plant: &str, producer: &str, consumer: &str) -> [(f64, f64); 2] {
    let mut simulation =
        Simulation::new(build(&model(&text(plant, producer, consumer))).unwrap()).unwrap();
    let after = [600, 3600].map(|until_s| {
        simulation.advance_to(Time(until_s * NS_PER_S), Time(60 * NS_PER_S)).unwrap();
        let get = |channel: &str| simulation.get(simulation.channel(channel).unwrap());
        let flow_kg_s = -get("consumer.station.m_flow_kg_s");
        (flow_kg_s * 60.0 / 0.988, get("consumer.station.blocked"))
    });
    let balances = Balances::of(&simulation);
    assert!(balances.heat_error() < 1e-9 && balances.hydraulic_error() < 1e-9, "{balances:?}");
    after
}

#[test]
fn a_valve_extracts_from_a_pressurised_supply_only() {
    for producer in TYPES {
        for (flow, blocked) in run("pressurised", producer, "extraction_by_valve") {
            assert!(flow > 10.0 && blocked == 0.0, "{producer}: {flow} l/min");
        }
        for (flow, blocked) in run("non_pressurised", producer, "extraction_by_valve") {
            assert!(flow < 5.0 && blocked == 1.0, "{producer}: {flow} l/min, {blocked}");
        }
        for (flow, blocked) in run("non_pressurised", producer, "extraction_by_pump") {
            assert!(flow > 10.0 && blocked == 0.0, "{producer}: {flow} l/min");
        }
    }
}
