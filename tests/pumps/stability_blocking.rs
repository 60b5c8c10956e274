//! Blocking margins without simulating (SC-01), against steady states found again and again.
#![allow(clippy::unwrap_used)]

use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::stability::blocking::{Analysis, FeederMargin, blocking};
use anergy_simulation::steady;
use anergy_tests::workspace;
use std::fmt::Write;

/// What a threshold may differ from that found by solving again and again.
const THRESHOLD: f64 = 1e-5;

fn three_houses() -> Model {
    let dir = workspace().join("examples/three-houses");
    let text = std::fs::read_to_string(dir.join("model.toml")).unwrap();
    let mut model = Model::from_toml(&text, &dir).unwrap();
    model.drivers.clear();
    model
}

fn model(text: &str) -> Model {
    Model::from_toml(text, &workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn set(parameter: &str, value: impl Into<serde_json::Value>) -> Change {
    Change::Set { parameter: parameter.into(), value: value.into() }
}

fn at_speeds(model: &Model, speeds: &[(&str, f64)]) -> Model {
    let changes: Vec<Change> =
        speeds.iter().map(|(site, u)| set(&format!("{site}.feed_in_pump.speed"), *u)).collect();
    model.with(&changes).unwrap()
}

fn ideal_check_valves(model: &Model) -> Model {
    let of = |site: &str| {
        let name = |field: &str| format!("{site}.feed_in_check_valve.{field}");
        [set(&name("kvs_m3_h"), 1000.0), set(&name("leakage"), 1e-6), set(&name("delta_m"), 1e-5)]
    };
    model.with(&[of("sf1"), of("sf2")].concat()).unwrap()
}

fn settled(model: &Model) -> Simulation {
    let mut simulation = Simulation::new(build(model).unwrap()).unwrap();
    steady::settle(&mut simulation).unwrap();
    simulation
}

fn margins(model: &Model) -> Vec<FeederMargin> {
    blocking(&settled(model)).unwrap()
}

fn flow(model: &Model, edge: &str) -> f64 {
    steady::solve(model).unwrap().edge(edge).unwrap().m_flow_kg_s
}

/// The value of a parameter between two others at which the flow of an edge changes its sign.
fn zero_of_flow(model: &Model, edge: &str, parameter: &str, low: f64, high: f64) -> f64 {
    let at = |value: f64| flow(&model.with(&[set(parameter, value)]).unwrap(), edge);
    let (mut low, mut high, positive) = (low, high, at(low) > 0.0);
    assert_ne!(positive, at(high) > 0.0, "{edge} over {parameter}");
    for _ in 0..22 {
        let middle = 0.5 * (low + high);
        if (at(middle) > 0.0) == positive { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[test]
fn thresholds_of_the_three_houses() {
    let houses = at_speeds(&three_houses(), &[("sf1", 0.95), ("sf2", 1.0)]);
    for (what, model, expected) in
        [("ideal", ideal_check_valves(&houses), 0.936), ("real", houses, 0.933)]
    {
        let found = &margins(&model)[0];
        assert_eq!(
            (found.id.as_str(), found.station.as_deref()),
            ("sf1.feed_in_pump", Some("sf1.station"))
        );
        let threshold = found.threshold_speed.unwrap();
        assert!((threshold - expected).abs() <= 0.002, "{what}: {threshold}");
        assert!((found.margin_speed.unwrap() - (0.95 - threshold)).abs() < 1e-12);
        let simulated =
            zero_of_flow(&model, "sf1.feed_in_pump", "sf1.feed_in_pump.speed", 0.85, 1.0);
        assert!((threshold - simulated).abs() < THRESHOLD, "{what}: {threshold}, {simulated}");
        // u^2 H0 over what SF2 and SF4 put across the pump: the margin in Pa.
        let margin_pa = (0.95 * 0.95 - threshold * threshold) * 40_221.0;
        assert!((found.margin_dp_pa.unwrap() - margin_pa).abs() < 1e-6);
    }
}

#[test]
fn who_blocks_whom() {
    let houses = three_houses();
    let at = |u1: f64, u2: f64| margins(&at_speeds(&houses, &[("sf1", u1), ("sf2", u2)]));
    // Speeds, blocked, held back.
    for (u1, u2, blocked, held_back) in [
        (0.95, 1.0, false, true),
        (0.90, 1.0, true, true),
        (0.95, 0.85, false, false),
        (0.0, 1.0, false, false),
    ] {
        let found = at(u1, u2);
        let (sf1, sf2) = (&found[0], &found[1]);
        assert_eq!((sf1.blocked, sf1.held_back), (blocked, held_back), "{u1}, {u2}: {sf1:?}");
        assert_eq!(sf1.margin_speed.unwrap() < 0.0, sf1.m_flow_kg_s <= 1e-9, "{u1}, {u2}");
        let culprit = (blocked || held_back).then_some("sf2.feed_in_pump");
        assert_eq!(sf1.blocked_by.as_deref(), culprit, "{u1}, {u2}");
        assert!(!sf2.blocked && !sf2.held_back && sf2.blocked_by.is_none(), "{sf2:?}");
        assert_eq!(sf1.opponents[0].id, "sf2.feed_in_pump");
        assert_eq!(sf1.opponents[0].quantity, "speed");
    }
    // (b) SF1 nearer than SF2: none is blocked, though SF2 is the slower one to be held back then.
    let text =
        houses.text.replacen("from = \"sf2\"\nto = \"sf4\"", "from = \"sf1\"\nto = \"sf4\"", 1);
    assert_ne!(text, *houses.text);
    for found in margins(&at_speeds(&model(&text), &[("sf1", 0.95), ("sf2", 1.0)])) {
        assert!(
            !found.blocked && !found.held_back && found.margin_speed.unwrap() > 0.02,
            "{found:?}"
        );
    }
}

#[test]
fn where_the_others_begin_to_block() {
    let houses = at_speeds(&three_houses(), &[("sf1", 0.90), ("sf2", 1.0)]);
    let simulation = settled(&houses);
    let mut analysis = Analysis::new(&simulation).unwrap();
    let limits = analysis.limits().unwrap();
    // SF1 is blocked by SF2 above a speed of it, and by the valve of SF4 when that is less open.
    let found = &limits[0].opponents[0];
    assert_eq!((found.id.as_str(), found.quantity.as_str()), ("sf2.feed_in_pump", "speed"));
    let simulated = zero_of_flow(&houses, "sf1.feed_in_pump", "sf2.feed_in_pump.speed", 0.5, 1.0);
    assert!((found.position.unwrap() - simulated).abs() < THRESHOLD, "{found:?}, {simulated}");
    let there = at_speeds(&houses, &[("sf2", simulated)]);
    let m = flow(&there, "sf2.feed_in_pump");
    assert!((found.m_flow_kg_s.unwrap() / m - 1.0).abs() < 1e-4, "{found:?}, {m}");
    // SF2 is never blocked by SF1, which at full speed leaves it 6.8 l/min.
    assert_eq!(limits[1].opponents[0].position, None);
    // Threshold of SF1 over the speed of SF2.
    let speeds = [0.0, 0.5, 0.8, 0.9, 1.0];
    let thresholds = analysis.thresholds("sf1.feed_in_pump", "sf2.feed_in_pump", &speeds).unwrap();
    assert_eq!(thresholds[0], Some(0.0));
    for (u2, threshold) in speeds.iter().zip(&thresholds).skip(1) {
        let there = at_speeds(&houses, &[("sf2", *u2)]);
        let simulated =
            zero_of_flow(&there, "sf1.feed_in_pump", "sf1.feed_in_pump.speed", 0.0, 1.0);
        assert!(
            (threshold.unwrap() - simulated).abs() < THRESHOLD,
            "{u2}: {threshold:?}, {simulated}"
        );
    }
    let unknown = analysis.thresholds("sf4.extraction_valve", "sf2.feed_in_pump", &speeds);
    assert!(unknown.unwrap_err().to_string().contains("a pump in series with a check valve"));
}

#[test]
fn a_valve_that_closes_blocks() {
    let houses = at_speeds(&three_houses(), &[("sf1", 0.95), ("sf2", 1.0)]);
    let simulation = settled(&houses);
    let limits = Analysis::new(&simulation).unwrap().limits().unwrap();
    let opening = steady_position(&simulation, "sf4.extraction_valve");
    let houses = houses
        .with(&[
            set("sf4.extraction_valve.command", "opening"),
            set("sf4.extraction_valve.kappa", serde_json::Value::Null),
        ])
        .unwrap();
    let simulated =
        zero_of_flow(&houses, "sf1.feed_in_pump", "sf4.extraction_valve.opening", 0.3, opening);
    let factor = limits[0].valves_factor.unwrap();
    assert!((factor * opening - simulated).abs() < THRESHOLD, "{factor} of {opening}, {simulated}");
    // At 0.95 SF2 has to be faster than it can to block SF1.
    assert_eq!(limits[0].opponents[0].position, None);
}

fn steady_position(simulation: &Simulation, edge: &str) -> f64 {
    simulation.get(simulation.channel(&format!("{edge}.opening")).unwrap())
}

#[test]
fn map_of_two_speeds() {
    let houses = three_houses();
    let simulation = settled(&houses);
    let mut analysis = Analysis::new(&simulation).unwrap();
    let speeds = [0.6, 0.8, 0.9, 1.0];
    let points = analysis.map("sf1.feed_in_pump", "sf2.feed_in_pump", &speeds).unwrap();
    assert_eq!(points.len(), 16);
    let mut seen = [0, 0, 0];
    for point in &points {
        let there = at_speeds(&houses, &[("sf1", point.first), ("sf2", point.second)]);
        let flows = ["sf1.feed_in_pump", "sf2.feed_in_pump"].map(|pump| flow(&there, pump));
        for (found, m) in point.m_flow_kg_s.iter().zip(flows) {
            assert!((found - m).abs() < 1e-9, "{point:?}, {m}");
        }
        let blocked: Vec<String> = margins(&there)
            .into_iter()
            .filter(|margin| margin.blocked)
            .map(|margin| margin.id)
            .collect();
        assert_eq!(point.blocked, blocked, "{point:?}");
        seen[if blocked.is_empty() {
            0
        } else if blocked[0].starts_with("sf1") {
            1
        } else {
            2
        }] += 1;
    }
    assert!(seen.iter().all(|seen| *seen > 0), "{seen:?}");
}

/// A ring of sites, with a producer at each speed and a consumer after every second of them.
fn ring(speeds: &[f64], real: bool) -> String {
    let kvs = if real { 11 } else { 1000 };
    let mut text = String::from("format = 1\n[pipe_type.p]\ninner_diameter_mm = 22\nzeta = 10\n");
    let n = speeds.len() + speeds.len() / 2;
    let (mut speed, mut consumers) = (speeds.iter(), 0);
    for i in 0..n {
        let _ = write!(
            text,
            "[[site]]\nid = \"s{i}\"\n[[trench]]\nfrom = \"s{i}\"\nto = \"s{}\"\nlength_m = {}\npipe = \"p\"\n",
            (i + 1) % n,
            30 + 25 * (i % 4)
        );
        if i % 3 == 2 {
            consumers += 1;
            let _ = write!(
                text,
                "[[station]]\nsite = \"s{i}\"\nkind = \"consumer\"\n\
                 extraction_valve = {{ opening = 0.8 }}\n"
            );
        } else {
            let _ = write!(
                text,
                "[[station]]\nsite = \"s{i}\"\nkind = \"producer\"\nrequested_flow_l_min = 1\n\
                 feed_in_pump = {{ speed = {} }}\nfeed_in_check_valve = {{ kvs_m3_h = {kvs} }}\n",
                speed.next().unwrap()
            );
        }
    }
    assert!(consumers > 0);
    text + "[pressure_reference]\nnode = \"s2.cold\"\npressure_bar = 1.5\n"
}

#[test]
fn feeders_of_a_ring_agree_with_steady_states() {
    let speeds = [0.9, 0.55, 1.0, 0.7, 0.95, 0.62, 0.8, 1.0];
    let ring = model(&ring(&speeds, true));
    let found = margins(&ring);
    assert_eq!(found.len(), speeds.len());
    const STEP: f64 = 1e-5;
    let mut blocked = 0;
    for (margin, speed) in found.iter().zip(speeds) {
        assert!((margin.speed - speed).abs() < 1e-12);
        let parameter = format!("{}.speed", margin.id);
        let simulated = zero_of_flow(&ring, &margin.id, &parameter, 0.0, 1.0);
        let threshold = margin.threshold_speed.unwrap();
        assert!(
            (threshold - simulated).abs() < THRESHOLD,
            "{}: {threshold}, {simulated}",
            margin.id
        );
        assert_eq!(margin.blocked, margin.m_flow_kg_s <= 0.0, "{margin:?}");
        blocked += usize::from(margin.blocked);
        // The influence of each other one, and so the culprit: by slowing each down a little (s9 is near the
        // kink of its own check valve, where the influence changes by 1 % within this step).
        let mut worst = (0.0, String::new());
        for other in found.iter().filter(|other| other.id != margin.id) {
            let parameter = format!("{}.speed", other.id);
            let slower = ring.with(&[set(&parameter, other.speed - STEP)]).unwrap();
            let dp = margins(&slower).into_iter().find(|m| m.id == margin.id).unwrap();
            let change = (margin.opposing_dp_pa.unwrap() - dp.opposing_dp_pa.unwrap()) / STEP;
            let influence = margin.opponents.iter().find(|o| o.id == other.id).unwrap();
            let error = (influence.opposing_dp_by_position_pa - change).abs();
            assert!(
                error < 0.02 * change.abs() + 5.0,
                "{}, {}: {influence:?}, {change}",
                margin.id,
                other.id
            );
            if change * other.speed > worst.0 {
                worst = (change * other.speed, other.id.clone());
            }
        }
        assert_eq!(margin.opponents[0].id, worst.1, "{}", margin.id);
    }
    assert!((1..speeds.len()).contains(&blocked), "{blocked}");
}

#[test]
fn what_follows_by_itself_follows() {
    // The flow of SF4 is prescribed and its valve free.
    let text = three_houses()
        .text
        .replacen("{ speed = 1.0 }", "{ speed = 1.0, initial_speed = 1.0 }", 1)
        .replacen("{ speed = 0.95 }", "{ speed = 0.95, initial_speed = 0.95 }", 1);
    let text = text.split("[[schedule]]").next().unwrap().to_owned()
        + "[pressure_reference]\nnode = \"sf4.cold\"\npressure_bar = 1.5\n\
           [[prescribed]]\nid = \"given\"\nquantity = \"sf4.extraction_valve.m_flow_kg_s\"\nvalue = 7\nunit = \"kg_min\"\nfree = \"sf4.extraction_valve.kappa\"\n";
    let model = model(&text);
    let found = &margins(&model)[0];
    let simulated = zero_of_flow(&model, "sf1.feed_in_pump", "sf1.feed_in_pump.speed", 0.1, 1.0);
    let threshold = found.threshold_speed.unwrap();
    assert!((threshold - simulated).abs() < THRESHOLD, "{threshold}, {simulated}");
    let slower = margins(&at_speeds(&model, &[("sf2", 1.0 - 1e-5)]));
    let change = (found.opposing_dp_pa.unwrap() - slower[0].opposing_dp_pa.unwrap()) / 1e-5;
    let influence = found.opponents[0].opposing_dp_by_position_pa;
    assert!((influence / change - 1.0).abs() < 1e-2, "{influence}, {change}");
    // Without SF2 the prescribed flow is out of reach: the valve is open, and SF1 delivers what it can.
    let alone = steady::solve(&at_speeds(&model, &[("sf2", 0.0)])).unwrap();
    assert_eq!(alone.unreached.len(), 1);
    assert_eq!(alone.unreached[0].position, 1.0);
}

#[test]
fn a_feeder_whose_flow_is_prescribed_has_the_threshold_of_its_speed() {
    let houses = at_speeds(&three_houses(), &[("sf1", 0.95), ("sf2", 1.0)]);
    let text = houses.text.split("[[schedule]]").next().unwrap().to_owned()
        + "[pressure_reference]\nnode = \"sf4.cold\"\npressure_bar = 1.5\n\
           [[prescribed]]\nid = \"given\"\nquantity = \"sf1.feed_in_pump.m_flow_kg_s\"\nvalue = 1\n\
           unit = \"kg_min\"\nfree = \"sf1.feed_in_pump.speed\"\n";
    let given = model(&text);
    let simulation = settled(&given);
    let mut analysis = Analysis::new(&simulation).unwrap();
    let found = analysis.margins().unwrap();
    // Without SF1 the two networks are one.
    let (own, plain) = (&found[0], &margins(&houses)[0]);
    let difference = own.threshold_speed.unwrap() - plain.threshold_speed.unwrap();
    assert!(difference.abs() < 1e-9, "{difference}");
    assert!(own.speed > own.threshold_speed.unwrap() && own.speed < 0.96, "{own:?}");
    // SF2 works against a flow that stays, and not against a speed.
    let limits = analysis.limits().unwrap();
    assert_eq!(limits[0].opponents.len(), 1);
    assert!(limits[1].opponents.is_empty(), "{limits:?}");
    let without = found[1].threshold_speed;
    assert!(without.is_some_and(|threshold| threshold < 0.7), "{without:?}");
}

#[test]
fn only_pumps_with_a_check_valve_in_their_direction_are_feeders() {
    // A plant without check valve, a pump against its check valve, one with a pipe between both.
    let edge = |id: &str, kind: &str, from: &str, to: &str, rest: &str| {
        format!(
            "[[edge]]\nid = \"{id}\"\nkind = \"{kind}\"\nfrom = \"{from}\"\nto = \"{to}\"\n{rest}\n"
        )
    };
    let pump = "head_max_hpa = 402.21\nfree_flow_l_min = 55.33\nspeed = 0.8";
    let check = "kvs_m3_h = 11\nleakage = 1e-6";
    let load = "dp_nominal_hpa = 100.0\nm_flow_nominal_kg_min = 10.0";
    let mut text = String::from("format = 1\n");
    for node in ["hot", "cold", "a", "b", "c"] {
        let _ = write!(text, "[[node]]\nid = \"{node}\"\n");
    }
    text += &edge("plant", "pump", "cold", "hot", pump);
    text += &edge("load", "resistance", "hot", "cold", load);
    text += &edge("against", "pump", "cold", "a", pump);
    text += &edge("against_check", "check_valve", "hot", "a", check);
    text += &edge("with_check", "check_valve", "cold", "b", check);
    text += &edge("with_pipe", "resistance", "c", "b", load);
    text += &edge("with", "pump", "c", "hot", pump);
    text += "[pressure_reference]\nnode = \"cold\"\n";
    let simulation = settled(&model(&text));
    let found = blocking(&simulation).unwrap();
    let ids: Vec<&str> = found.iter().map(|margin| margin.id.as_str()).collect();
    assert_eq!(ids, ["with"]);
    // At equal speeds the plant alone lifts the heads of both below theirs: sqrt(K/(a + K)) of 0.8 with
    // K = 1, a = 0.131381 hPa/(l/min)^2: 0.752112. The pump without check valve counts as a culprit too.
    let threshold = found[0].threshold_speed.unwrap();
    assert!((threshold - 0.8 * (1.0_f64 / 1.131_381).sqrt()).abs() < 1e-4, "{threshold}");
    assert_eq!(found[0].opponents[0].id, "plant");
    assert!(found[0].blocked_by.is_none() && found[0].requested_m_flow_kg_s.is_none());
}

#[test]
fn self_acting_valves_follow_to_their_steady_openings() {
    // Two feeders, and a load behind a controller of the pressure difference between hot and cold.
    let text = r#"format = 1
[[node]]
id = "hot"
[[node]]
id = "cold"
[[node]]
id = "a"
[[node]]
id = "b"
[[node]]
id = "behind"
[[edge]]
id = "one"
kind = "pump"
from = "cold"
to = "a"
head_max_hpa = 402.21
free_flow_l_min = 55.33
speed = 0.8
[[edge]]
id = "one_check"
kind = "check_valve"
from = "a"
to = "hot"
kvs_m3_h = 11
[[edge]]
id = "two"
kind = "pump"
from = "cold"
to = "b"
head_max_hpa = 402.21
free_flow_l_min = 55.33
speed = 0.78
[[edge]]
id = "two_check"
kind = "check_valve"
from = "b"
to = "hot"
kvs_m3_h = 1.5
[[edge]]
id = "controller"
kind = "dp_controller"
from = "hot"
to = "behind"
kvs_m3_h = 2
high_node = "behind"
low_node = "cold"
dp_set_hpa = 80
[[edge]]
id = "load"
kind = "resistance"
from = "behind"
to = "cold"
dp_nominal_hpa = 100
m_flow_nominal_kg_min = 12
[pressure_reference]
node = "cold"
"#;
    let model = model(text);
    // Within its band of 8 hPa.
    let steady = steady::solve(&model).unwrap();
    let sensed_pa = steady.node("behind").unwrap().p_pa - steady.node("cold").unwrap().p_pa;
    assert!((8100.0..8700.0).contains(&sensed_pa), "{sensed_pa}");
    for (margin, other) in margins(&model).iter().zip(["two", "one"]) {
        let speed = format!("{}.speed", margin.id);
        let simulated = zero_of_flow(&model, &margin.id, &speed, 0.3, 1.0);
        let threshold = margin.threshold_speed.unwrap();
        assert!((threshold - simulated).abs() < THRESHOLD, "{threshold}, {simulated}");
        // The influence with the valve following, by differences.
        let slower = set(&format!("{other}.speed"), margin_of(&model, other).speed - 1e-4);
        let slower = margin_of(&model.with(&[slower]).unwrap(), &margin.id);
        let change = (margin.opposing_dp_pa.unwrap() - slower.opposing_dp_pa.unwrap()) / 1e-4;
        let influence = margin.opponents[0].opposing_dp_by_position_pa;
        assert!((influence / change - 1.0).abs() < 1e-3, "{other}: {influence}, {change}");
    }
}

fn margin_of(model: &Model, id: &str) -> FeederMargin {
    margins(model).into_iter().find(|margin| margin.id == id).unwrap()
}
