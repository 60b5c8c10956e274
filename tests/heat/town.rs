//! The town of the examples: 500 houses from tables.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::workspace;
use std::collections::HashMap;

fn town() -> Model {
    let dir = workspace().join("examples/town");
    let text = std::fs::read_to_string(dir.join("model.toml")).unwrap();
    Model::from_toml(&text, &dir).unwrap_or_else(|problems| panic!("{}", problems.render(&text)))
}

/// Design flow of the houses in kg/s: their load over 30 K.
fn design() -> HashMap<String, f64> {
    let mut reader = csv::Reader::from_path(workspace().join("examples/town/nodes.csv")).unwrap();
    let headers = reader.headers().unwrap().clone();
    let column = |name: &str| headers.iter().position(|header| header == name).unwrap();
    let (id, station, load) = (column("id"), column("station"), column("unit.load_kw"));
    reader
        .records()
        .map(Result::unwrap)
        .filter(|row| &row[station] == "house")
        .map(|row| (row[id].to_owned(), row[load].parse::<f64>().unwrap() / (4.18 * 30.0)))
        .collect()
}

#[test]
fn every_house_gets_its_share() {
    let (model, design) = (town(), design());
    assert_eq!(design.len(), 500);
    let steady = steady::solve(&model).unwrap();
    let flow = |id: &str| steady.edge(id).unwrap().m_flow_kg_s;
    let dp_pa = |house: &str| {
        let p_pa = |line: &str| steady.node(&format!("{house}.{line}")).unwrap().p_pa;
        p_pa("hot") - p_pa("cold")
    };
    for (house, design_kg_s) in &design {
        let share = -flow(&format!("{house}.heat_exchanger")) / design_kg_s;
        assert!((1.0..1.3).contains(&share), "{house} gets {share} of its design flow");
        assert!(dp_pa(house) > 49_999.0, "{house} has {} Pa", dp_pa(house));
        let hot_k = steady.node(&format!("{house}.hot")).unwrap().t_k;
        // 80 degC at the plant
        assert!((343.15..353.15).contains(&hot_k), "{house}: {hot_k} K");
    }
    let least = design.keys().map(|house| dp_pa(house)).fold(f64::INFINITY, f64::min);
    assert!((least / 50_000.0 - 1.0).abs() < 1e-6, "{least} Pa");
    // What the plant sends is what the houses take, and every node passes on what it gets.
    let taken: f64 = design.keys().map(|house| -flow(&format!("{house}.heat_exchanger"))).sum();
    assert!((flow("plant.generator") / taken - 1.0).abs() < 1e-12);
    let mut sums: HashMap<&str, f64> = HashMap::new();
    for (edge, found) in model.edges.iter().zip(&steady.edges) {
        *sums.entry(&edge.from).or_default() -= found.m_flow_kg_s;
        *sums.entry(&edge.to).or_default() += found.m_flow_kg_s;
    }
    assert!(sums.values().all(|sum| sum.abs() < 1e-10), "a node gains or loses water");
}

#[test]
fn heat_and_work_of_the_town_close() {
    let mut simulation = Simulation::new(build(&town()).unwrap()).unwrap();
    steady::settle(&mut simulation).unwrap();
    let get = |simulation: &Simulation, channel: &str| {
        simulation.get(simulation.channel(channel).unwrap())
    };
    let power = |quantity: &str| get(&simulation, &format!("network.{quantity}"));
    // Settled, all heat of the units is lost by the pipes. The units are the plant and the houses.
    assert!((power("units_w") / power("loss_w") - 1.0).abs() < 1e-6, "{}", power("units_w"));
    let plant_w = get(&simulation, "plant.station.q_flow_w");
    assert!(plant_w > 7.9e6 && power("loss_w") / plant_w < 0.1, "{plant_w} W");
    let (end, step) = (Time::from_s(300.0).unwrap(), Time::from_s(30.0).unwrap());
    simulation.reset().unwrap();
    simulation.advance_to(end, step).unwrap();
    let balances = Balances::of(&simulation);
    assert!(balances.heat_error() < 1e-9 && balances.hydraulic_error() < 1e-9, "{balances:?}");
}

#[test]
fn the_plain_model_is_the_same_town() {
    let model = town();
    let text = model.to_plain_toml().unwrap();
    let plain = Model::from_toml(&text, std::path::Path::new("/"));
    let plain = plain.unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
    assert_eq!(plain.edges.len(), model.edges.len());
    let head = |model: &Model| {
        let steady = steady::solve(model).unwrap();
        steady.edge("plant.circulation_pump").unwrap().dp_pa
    };
    assert!((head(&plain) / head(&model) - 1.0).abs() < 1e-9);
}
