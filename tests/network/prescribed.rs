//! What is given and what is free: prescribed flows and pressures find pump speeds and valve openings.
#![allow(clippy::unwrap_used)]

use anergy_benches::two_pipe_network;
use anergy_core::clock::{NS_PER_S, Time};
use anergy_network::elements::ElementParams;
use anergy_network::hydraulics::HydraulicSolver;
use anergy_network::state::NetworkState;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady::{self, Steady};
use std::fmt::Write;
use std::path::Path;

fn model(text: &str) -> Model {
    Model::from_toml(text, Path::new("."))
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn problems(text: &str) -> String {
    match Model::from_toml(text, Path::new(".")).map_err(|problems| problems.render(text)) {
        Err(problems) => problems,
        Ok(model) => build(&model).err().unwrap().render(text),
    }
}

fn solve(text: &str) -> Steady {
    steady::solve(&model(text)).unwrap_or_else(|error| panic!("{error}"))
}

fn value(simulation: &Simulation, channel: &str) -> f64 {
    let channels = simulation.plan().channels();
    let mut row = vec![0.0; channels.len()];
    simulation.fill_row(&mut row);
    row[channels.iter().position(|c| c.name == channel).unwrap()]
}

fn settled(text: &str) -> Simulation {
    let mut simulation = Simulation::new(build(&model(text)).unwrap()).unwrap();
    steady::settle(&mut simulation).unwrap();
    simulation
}

/// Reference a, pump a-b, resistance b-c, two parallel valves c-d, resistance d-a; k in
/// hPa/(l/min)^2 = 0.2 each, the pump 402.21 hPa and 55.33 l/min.
const LOOP: &str = r#"
format = 1
[[node]]
id = "a"
[[node]]
id = "b"
[[node]]
id = "c"
[[node]]
id = "d"
[pressure_reference]
node = "a"
pressure_bar = 1.5
[[edge]]
id = "pump"
kind = "pump"
from = "a"
to = "b"
head_max_hpa = 402.21
free_flow_l_min = 55.33
delta_m = 1e-4
[[edge]]
id = "supply"
kind = "resistance"
from = "b"
to = "c"
dp_nominal_hpa = 20
m_flow_nominal_kg_min = 10
delta_m = 1e-4
[[edge]]
id = "valve"
kind = "valve"
from = "c"
to = "d"
kvs_m3_h = 2.5
characteristic = "linear"
leakage = 0
opening = 1
delta_m = 1e-4
[[edge]]
id = "other"
kind = "valve"
from = "d"
to = "c"
kvs_m3_h = 1
characteristic = "linear"
opening = 0.5
delta_m = 1e-4
[[edge]]
id = "return"
kind = "resistance"
from = "d"
to = "a"
dp_nominal_hpa = 20
m_flow_nominal_kg_min = 10
delta_m = 1e-4
"#;

fn prescribed(quantity: &str, value: f64, unit: &str, free: &str) -> String {
    format!(
        "[[prescribed]]\nquantity = \"{quantity}\"\nvalue = {value}\nunit = \"{unit}\"\n\
         free = \"{free}\"\n"
    )
}

#[test]
fn a_flow_in_series_is_imposed_and_gives_the_speed() {
    // Return 8 l/min (its direction is that of the pump): dp of both resistances 0.2*64 = 12.8 hPa;
    // valves together kv = 2.5 + 0.5 (1e-3 + 0.999*0.5) = 3.0005 at 8 l/min = 0.48 m3/h:
    // (0.48/3.0005)^2 = 0.025592 bar = 25.592 hPa. Head 51.192 = 402.21 u^2 - 0.131381*64:
    // u^2 = 59.6003/402.21, u = 0.384942.
    let text = LOOP.to_owned() + &prescribed("return.m_flow_kg_s", 8.0, "kg_min", "pump.speed");
    let steady = solve(&text);
    assert!((steady.edge("pump").unwrap().m_flow_kg_s * 60.0 - 8.0).abs() < 1e-6);
    let phi = 1e-3 + 0.999 * 0.5;
    let valves = (0.48 / (2.5 + phi)) * (0.48 / (2.5 + phi)) * 1000.0;
    let head = 2.0 * 12.8 + valves + 402.21 / 55.33_f64.powi(2) * 64.0;
    let speed = value(&settled(&text), "pump.speed");
    assert!((speed - (head / 402.21).sqrt()).abs() < 1e-6, "{speed}");
    assert!((speed - 0.3849).abs() < 1e-3);
    assert!(steady.unreached.is_empty());
}

#[test]
fn two_quantities_two_actuators() {
    // Flow of the return 8 l/min by the valve, pressure at c 1.6 bar by the pump: c is 100 hPa above a;
    // d is 12.8 hPa above a; the valves take 87.2 hPa; the other passes
    // 0.5005*sqrt(0.0872) = 0.147797 m3/h = 2.46328 l/min, so the valve has 5.53672 l/min:
    // kv = 0.332203/sqrt(0.0872) = 1.124984, opening 0.449994.
    let text = LOOP.to_owned()
        + &prescribed("return.m_flow_kg_s", 8.0, "kg_min", "valve.opening")
        + &prescribed("c.p_pa", 1.6, "bar", "pump.speed");
    let steady = solve(&text);
    assert!((steady.node("c").unwrap().p_pa - 1.6e5).abs() < 0.02);
    assert!((steady.edge("return").unwrap().m_flow_kg_s * 60.0 - 8.0).abs() < 1e-5);
    let opening = value(&settled(&text), "valve.opening");
    assert!((opening - 0.449_994).abs() < 1e-5, "{opening}");
    // The difference along `other`, which is connected the other way round, has the other sign.
    let text = LOOP.to_owned() + &prescribed("other.dp_pa", -87.2, "hpa", "pump.speed");
    assert!((solve(&text).edge("valve").unwrap().dp_pa - 8720.0).abs() < 0.02);
}

#[test]
fn out_of_reach_is_said_with_the_nearest_value() {
    let free_running = solve(&LOOP.replace(
        "delta_m = 1e-4\n[[edge]]\nid = \"supply\"",
        "speed = 1\ndelta_m = 1e-4\n[[edge]]\nid = \"supply\"",
    ));
    let most = free_running.edge("return").unwrap().m_flow_kg_s;
    for (value, expected, limit) in [(100.0, most, 1.0), (-5.0, 0.0, 0.0)] {
        let text =
            LOOP.to_owned() + &prescribed("return.m_flow_kg_s", value, "kg_min", "pump.speed");
        let steady = solve(&text);
        let [unreached] = &steady.unreached[..] else { panic!("{:?}", steady.unreached) };
        assert!((unreached.reached - expected).abs() < 1e-6, "{unreached}");
        assert_eq!((unreached.position, unreached.free.as_str()), (limit, "pump.speed"));
        assert!((unreached.wanted * 60.0 - value).abs() < 1e-9);
    }
}

#[test]
fn a_schedule_passes_a_limit_and_a_snapshot_continues_bit_for_bit() {
    let text = LOOP.to_owned()
        + &prescribed("other.m_flow_kg_s", -2.0, "kg_min", "pump.speed")
        + "[[schedule]]\nsignal = \"pump.speed.prescribed.value\"\ninterpolation = \"linear\"\n\
           unit = \"kg_min\"\npoints = [[0, -1], [100, -20], [200, -1]]\n";
    let mut simulation = Simulation::new(build(&model(&text)).unwrap()).unwrap();
    let step = Time(NS_PER_S);
    simulation.advance_to(Time(90 * NS_PER_S), step).unwrap();
    let snapshot = simulation.snapshot();
    simulation.advance_to(Time(200 * NS_PER_S), step).unwrap();
    let first = simulation.state().clone();
    let kinds: Vec<String> = simulation.take_events().map(|event| event.kind).collect();
    assert_eq!(kinds, ["unreached", "reached"]);
    simulation.restore(&snapshot).unwrap();
    simulation.advance_to(Time(200 * NS_PER_S), step).unwrap();
    assert_eq!(simulation.state(), &first);
}

#[test]
fn what_is_not_well_posed_is_named() {
    let twice = LOOP.to_owned()
        + &prescribed("return.m_flow_kg_s", 8.0, "kg_min", "pump.speed")
        + &prescribed("supply.m_flow_kg_s", 8.0, "kg_min", "valve.opening");
    let message = problems(&twice);
    assert!(message.contains("too much is prescribed"), "{message}");
    assert!(message.contains("supply.m_flow_kg_s, return.m_flow_kg_s"), "{message}");
    let unknown = LOOP.to_owned() + &prescribed("retrun.m_flow_kg_s", 8.0, "kg_min", "pump.speed");
    assert!(problems(&unknown).contains("return.m_flow_kg_s"), "{}", problems(&unknown));
    let passive =
        LOOP.to_owned() + &prescribed("return.m_flow_kg_s", 8.0, "kg_min", "supply.speed");
    assert!(problems(&passive).contains("no actuator"), "{}", problems(&passive));
    let source = LOOP.to_owned()
        + "[[edge]]\nid = \"source\"\nkind = \"flow_source\"\nfrom = \"a\"\nto = \"b\"\nm_flow_kg_s = 0.1\n"
        + &prescribed("b.p_pa", 2.0, "bar", "source.m_flow_set_kg_s");
    assert!(problems(&source).contains("no actuator"), "{}", problems(&source));
    let driven = LOOP.to_owned()
        + &prescribed("return.m_flow_kg_s", 8.0, "kg_min", "pump.speed")
        + "[[schedule]]\nsignal = \"pump.speed\"\npoints = [[0, 1]]\n";
    assert!(problems(&driven).contains("is driven by"), "{}", problems(&driven));
}

/// Solves a town, then gives back its flows and its worst difference and frees the actuators: they must
/// return to where they were.
#[test]
fn a_town_finds_its_valves_and_its_pump_again() {
    for seed in 1..=3 {
        let text = two_pipe_network(40, seed);
        let solved = solve(&text);
        let mut inverse = text.replace("opening = 0.9", "opening = 0.3");
        for edge in solved.edges.iter().filter(|edge| edge.id.ends_with("extraction_valve")) {
            let (site, _) = edge.id.split_once('.').unwrap();
            let _ = write!(
                inverse,
                "[[prescribed]]\nquantity = \"{site}.station.m_flow_kg_s\"\nvalue = {:e}\n\
                 free = \"{}.opening\"\n",
                -edge.m_flow_kg_s, edge.id
            );
        }
        // A difference across a consumer that is not the plant's neighbour.
        let worst = solved
            .edges
            .iter()
            .filter(|edge| edge.id.ends_with("extraction_valve"))
            .min_by(|a, b| a.dp_pa.total_cmp(&b.dp_pa))
            .unwrap();
        let _ = write!(
            inverse,
            "[[prescribed]]\nquantity = \"{}.dp_pa\"\nvalue = {:e}\nfree = \"plant.feed_in_pump.speed\"\n",
            worst.id, worst.dp_pa
        );
        let simulation = settled(&inverse);
        for spec in &model(&inverse).edges {
            let (word, expected) = match &spec.params {
                ElementParams::Valve(_) => ("opening", 0.9),
                ElementParams::Pump(_) => ("speed", 1.0),
                _ => continue,
            };
            let position = value(&simulation, &format!("{}.{word}", spec.id));
            assert!((position - expected).abs() < 1e-4, "{}: {position}", spec.id);
        }
    }
}

/// A head is found with the flows: Newton from 5 % away misses by the square of the last miss, 5e-2, 1e-3,
/// 1e-6, 1e-12, so four iterations and one for the sharper corners; heads outside took two solves of three.
#[test]
fn heads_take_no_iterations_of_their_own() {
    let mut text = two_pipe_network(40, 1);
    let valves: Vec<_> = model(&text)
        .edges
        .iter()
        .filter(|edge| edge.id.ends_with("extraction_valve"))
        .map(|edge| edge.id.clone())
        .collect();
    let _ = write!(
        text,
        "[[prescribed]]\nquantity = \"{}.dp_pa\"\nvalue = 8000\nfree = \"plant.feed_in_pump.speed\"\n",
        valves[20]
    );
    let simulation = settled(&text);
    let network = simulation.plan().network();
    let dp_pa = |state: &NetworkState| {
        let edge = simulation.plan().edge_names().iter().position(|name| *name == valves[20]);
        state.dp_pa(network, edge.unwrap())
    };
    let mut state = simulation.network_state().clone();
    let mut solver = HydraulicSolver::new(network).unwrap();
    for value in [8400.0, 8000.0, 7600.0] {
        state.prescribed[0].value = value;
        state.invalidate_hydraulics();
        let report = solver.solve(network, &mut state).unwrap();
        assert!(report.iterations <= 5, "{value} Pa: {report:?}");
        assert!((dp_pa(&state) - value).abs() < 0.02, "{} for {value} Pa", dp_pa(&state));
    }
}
