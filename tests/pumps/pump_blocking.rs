//! SC-01: pump blocking of three houses, its threshold, its relief and its variants.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::workspace;
use serde_json::json;

fn model() -> Model {
    let dir = workspace().join("examples/three-houses");
    let text = std::fs::read_to_string(dir.join("model.toml")).unwrap();
    Model::from_toml(&text, &dir).unwrap_or_else(|problems| panic!("{}", problems.render(&text)))
}

fn set(parameter: &str, value: impl Into<serde_json::Value>) -> Change {
    Change::Set { parameter: parameter.into(), value: value.into() }
}

/// Speeds of both feeders instead of the schedule.
fn at_speeds(model: &Model, u1: f64, u2: f64) -> Model {
    let changes = [set("sf1.feed_in_pump.speed", u1), set("sf2.feed_in_pump.speed", u2)];
    let mut model = model.with(&changes).unwrap();
    model.drivers.clear();
    model
}

fn ideal_check_valves(model: &Model) -> Model {
    let of = |site: &str| {
        let name = |field: &str| format!("{site}.feed_in_check_valve.{field}");
        [set(&name("kvs_m3_h"), 1000.0), set(&name("leakage"), 1e-6), set(&name("delta_m"), 1e-5)]
    };
    model.with(&[of("sf1"), of("sf2")].concat()).unwrap()
}

/// Flows of SF1 and SF2 in l/min and the pressure difference at SF2 in hPa.
fn flows(model: &Model) -> (f64, f64, f64) {
    let steady = steady::solve(model).unwrap();
    let flow = |edge: &str| steady.edge(edge).unwrap().m_flow_kg_s * 60.0;
    let p = |node: &str| steady.node(node).unwrap().p_pa;
    (flow("sf1.feed_in_pump"), flow("sf2.feed_in_pump"), (p("sf2.hot") - p("sf2.cold")) / 100.0)
}

/// 1 % or 0.01 l/min.
#[track_caller]
fn close(what: &str, value: f64, expected: f64) {
    let tolerance = (0.01 * expected.abs()).max(0.01);
    assert!((value - expected).abs() <= tolerance, "{what}: {value}, expected {expected}");
}

#[test]
fn all_six_rows_with_ideal_and_with_real_check_valves() {
    // u1, u2, ideal V1, V2, dp, real V1, V2, dp
    let rows = [
        (0.95, 1.00, (0.702, 8.010, 359.22), (0.781, 7.920, 358.31)),
        (0.95, 0.90, (2.712, 5.338, 306.70), (2.723, 5.317, 306.00)),
        (0.95, 0.85, (3.332, 4.332, 278.02), (3.335, 4.322, 277.52)),
        (0.95, 0.80, (3.849, 3.413, 249.61), (3.847, 3.410, 249.28)),
        (1.00, 1.00, (2.021, 6.832, 370.94), (2.050, 6.791, 369.93)),
        (0.90, 1.00, (0.0, 8.628, 352.33), (-0.029, 8.629, 350.10)),
    ];
    let model = model();
    let ideal_model = ideal_check_valves(&model);
    for (u1, u2, ideal, real) in rows {
        for (what, model, (v1, v2, dp)) in [("ideal", &ideal_model, ideal), ("real", &model, real)]
        {
            let found = flows(&at_speeds(model, u1, u2));
            close(&format!("{what} {u1} {u2} V1"), found.0, v1);
            close(&format!("{what} {u1} {u2} V2"), found.1, v2);
            close(&format!("{what} {u1} {u2} dp"), found.2, dp);
        }
    }
}

#[test]
fn blocking_threshold() {
    let model = model();
    for (what, model, expected) in
        [("ideal", &ideal_check_valves(&model), 0.936), ("real", &model, 0.933)]
    {
        let (mut low, mut high) = (0.85, 1.0);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if flows(&at_speeds(model, middle, 1.0)).0 > 0.0 { high = middle } else { low = middle }
        }
        let threshold = 0.5 * (low + high);
        assert!((threshold - expected).abs() <= 0.002, "{what}: {threshold}");
    }
}

#[test]
fn with_friction_that_depends_on_reynolds() {
    // Haaland, cubic transition, ideal check valves (specification SC-01)
    let rows = [
        (0.95, 1.00, 0.537, 8.424),
        (0.95, 0.90, 2.968, 5.317),
        (0.95, 0.85, 3.431, 4.424),
        (0.95, 0.80, 3.808, 3.609),
        (1.00, 1.00, 2.267, 6.888),
        (0.90, 1.00, 0.0, 8.894),
    ];
    let pipes = ["sf1-sf2.hot", "sf1-sf2.cold", "sf2-sf4.hot", "sf2-sf4.cold"].map(String::from);
    let stubs = ["sf1", "sf2", "sf4"]
        .iter()
        .flat_map(|site| [format!("{site}.stub_hot"), format!("{site}.stub_cold")]);
    let changes: Vec<Change> = pipes
        .into_iter()
        .chain(stubs)
        .flat_map(|pipe| {
            [
                set(&format!("{pipe}.fixed_velocity_m_s"), json!(null)),
                set(&format!("{pipe}.friction"), "haaland"),
                set(&format!("{pipe}.transition"), "cubic"),
            ]
        })
        .collect();
    let model = ideal_check_valves(&model()).with(&changes).unwrap();
    for (u1, u2, v1, v2) in rows {
        let found = flows(&at_speeds(&model, u1, u2));
        close(&format!("{u1} {u2} V1"), found.0, v1);
        close(&format!("{u1} {u2} V2"), found.1, v2);
    }
}

#[test]
fn the_flag_is_set_while_blocked_and_cleared_after_the_relief() {
    let mut simulation = Simulation::new(build(&model()).unwrap()).unwrap();
    let get = |simulation: &Simulation, name: &str| {
        simulation.get(simulation.channel(&format!("{name}.station.m_flow_kg_s")).unwrap()) * 60.0
    };
    let step = Time::from_s(1.0).unwrap();
    simulation.advance_to(Time::from_s(2200.0).unwrap(), step).unwrap();
    let blocked = simulation.channel("sf1.station.blocked").unwrap();
    assert_eq!(simulation.get(blocked), 1.0);
    let (before_1, before_2) = (get(&simulation, "sf1"), get(&simulation, "sf2"));
    let share = before_1 / (before_1 + before_2);
    assert!((0.08..0.10).contains(&share), "{share}");
    simulation.advance_to(Time::from_s(3600.0).unwrap(), step).unwrap();
    assert_eq!(simulation.get(blocked), 0.0);
    let (after_1, after_2) = (get(&simulation, "sf1"), get(&simulation, "sf2"));
    assert!(after_1 / (after_1 + after_2) > 0.40);
    let fall = 1.0 - (after_1 + after_2) / (before_1 + before_2);
    assert!((0.0..0.15).contains(&fall), "{fall}");
    let spans = &anergy_simulation::balance::summary(&simulation, false)["blocked"];
    assert_eq!(spans.as_array().unwrap().len(), 1, "{spans}");
    assert_eq!(spans[0]["station"], "sf1.station");
    assert_eq!(spans[0]["blocked_by"], "sf2.feed_in_pump");
    assert!((60.0..80.0).contains(&spans[0]["from_s"].as_f64().unwrap()), "{spans}");
    assert!((2230.0..2260.0).contains(&spans[0]["to_s"].as_f64().unwrap()), "{spans}");
    let (events, messages): (Vec<(f64, String)>, Vec<String>) = simulation
        .take_events()
        .map(|event| ((event.time.as_s(), event.kind), event.message))
        .unzip();
    assert!(
        messages[0].ends_with("wanted; most of all held back by sf2.feed_in_pump"),
        "{messages:?}"
    );
    assert!(messages[1].ends_with("wanted"), "{messages:?}");
    // The pump needs some 7 s to its speed, then 60 s pass; the relief is within the ramp.
    assert_eq!(events.len(), 2, "{events:?}");
    assert!((60.0..80.0).contains(&events[0].0) && events[0].1 == "blocked", "{events:?}");
    assert!((2230.0..2260.0).contains(&events[1].0) && events[1].1 == "unblocked", "{events:?}");
}

#[test]
fn variant_b_no_blocking_when_sf1_is_the_near_feeder() {
    // 50 m from SF1 to SF2 and SF4 at SF1: SF1 is nearer to the consumer than SF2.
    let text = model().text;
    let nearer = text
        .replacen(
            "from = \"sf1\"\nto = \"sf2\"\nlength_m = 200",
            "from = \"sf2\"\nto = \"sf1\"\nlength_m = 200",
            1,
        )
        .replacen(
            "from = \"sf2\"\nto = \"sf4\"\nlength_m = 50",
            "from = \"sf1\"\nto = \"sf4\"\nlength_m = 50",
            1,
        );
    assert_ne!(*text, nearer);
    let model = Model::from_toml(&nearer, &workspace()).unwrap();
    let (v1, v2, _) = flows(&at_speeds(&model, 0.95, 1.0));
    assert!(v1 > 3.5 * 0.6, "SF1 delivers {v1} l/min");
    assert!(v2 > 0.0, "SF2 delivers {v2} l/min");
}

#[test]
fn variant_c_no_blocking_in_a_non_pressurised_network() {
    // A decoupler of 500 Pa at 1 kg/s joins both lines at SF4.
    let decoupler = anergy_network::elements::ElementParams::deserialize(
        "resistance",
        json!({ "dp_nominal_pa": 500.0, "m_flow_nominal_kg_s": 1.0 }),
    );
    let change = Change::InsertEdge {
        id: "sf4.decoupler".into(),
        from: "sf4.hot".into(),
        to: "sf4.cold".into(),
        params: decoupler.unwrap().unwrap(),
    };
    let model = model().with(&[change]).unwrap();
    // At the speeds of SC-01 SF1 is free; at 0.90, where it delivers nothing in the pressurised network,
    // it still delivers, less only by what both share of the last pipe.
    let (free, _, _) = flows(&at_speeds(&model, 0.95, 1.0));
    assert!(free > 3.5 * 0.6, "SF1 delivers {free} l/min");
    let (slow, _, _) = flows(&at_speeds(&model, 0.90, 1.0));
    assert!(slow > 1.0, "SF1 delivers {slow} l/min");
}

#[test]
fn editing_the_file_changes_the_result_as_physics_says() {
    let base = flows(&at_speeds(&model(), 0.95, 1.0));
    let longer = [set("sf1-sf2.hot.length_m", 400.0), set("sf1-sf2.cold.length_m", 400.0)];
    let far = flows(&at_speeds(&model().with(&longer).unwrap(), 0.95, 1.0));
    assert!(far.0 < base.0, "a longer pipe lowers the flow of SF1: {far:?} {base:?}");
    let faster = flows(&at_speeds(&model(), 1.0, 1.0));
    assert!(faster.0 > base.0 && faster.1 < base.1, "{faster:?} {base:?}");
}

#[test]
fn a_bidirectional_station_changes_from_feed_in_to_extraction_behind_its_interlock() {
    // SF1 feeds in until 300 s, then takes heat from what SF2 delivers.
    let text = model().text.replacen("kind = \"producer\"", "kind = \"bidirectional\"", 1)
        + "[[schedule]]\nsignal = \"sf1.feed_in_pump.speed\"\npoints = [[0, 1.0], [300, 0.0]]\n\
           [[schedule]]\nsignal = \"sf1.extraction_valve.opening\"\npoints = [[0, 0.0], [300, 1.0]]\n";
    let model = Model::from_toml(&text, &workspace()).unwrap();
    let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
    let get =
        |simulation: &Simulation, name: &str| simulation.get(simulation.channel(name).unwrap());
    let mut opened_at = None;
    for second in 1..=900_i32 {
        let time = Time::from_s(f64::from(second)).unwrap();
        simulation.advance_to(time, Time::from_s(1.0).unwrap()).unwrap();
        let speed = get(&simulation, "sf1.feed_in_pump.speed");
        let opening = get(&simulation, "sf1.extraction_valve.opening");
        if opening > 0.0 && opened_at.is_none() {
            opened_at = Some(second);
            assert!(speed < 0.02, "the valve opens while the pump runs at {speed}");
        }
        if second == 300 {
            assert!(get(&simulation, "sf1.station.m_flow_kg_s") > 0.0);
        }
    }
    // 0.02 = (1 + x) e^-x at x = 5.83: the pump runs down in 5.83 * 1.03 s = 6 s.
    assert!((305..=308).contains(&opened_at.unwrap()), "{opened_at:?}");
    assert!(get(&simulation, "sf1.station.m_flow_kg_s") < -0.01);
    assert!(get(&simulation, "sf1.feed_in_check_valve.m_flow_kg_s") > -2e-3, "only its leak");
}
