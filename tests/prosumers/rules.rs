//! The tables of rules of the laboratory, row by row: what the library of houses says against the tables written again by hand,
//! over all sides of all thresholds, from on and from off. Backup and lock in a run.

#![allow(clippy::unwrap_used)]

use anergy_control::controller::{Controller, Inputs};
use anergy_control::controllers::rule::RuleParams;
use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::model_file::house_library;
use anergy_simulation::simulation::Simulation;
use anergy_tests::running::{self, get};

/// Values around all thresholds, degC.
const DEGC: [f64; 18] = [
    20.0, 34.0, 36.0, 39.0, 41.0, 42.0, 44.0, 46.0, 49.0, 51.0, 54.0, 56.0, 59.0, 61.0, 64.0, 66.0,
    69.0, 71.0,
];
const SOC: [f64; 9] = [0.40, 0.49, 0.51, 0.59, 0.61, 0.64, 0.66, 0.94, 0.96];
const WATT: [f64; 4] = [-5000.0, -501.0, -499.0, 800.0];

/// What is measured, by the name within the house; temperatures in degC.
struct Seen<'a>(&'a [(String, f64)]);

impl Seen<'_> {
    fn of(&self, name: &str) -> f64 {
        self.0.iter().find(|(known, _)| known == name).unwrap_or_else(|| panic!("{name}")).1
    }
    /// Temperature of a layer of the storage.
    fn t(&self, layer: usize) -> f64 {
        self.of(&format!("storage.t_{layer}_k"))
    }
    fn soc(&self) -> f64 {
        self.of("storage.soc")
    }
    fn on(&self, rule: &str) -> bool {
        self.of(&format!("{rule}.on")) > 0.5
    }
}

type Condition = fn(&Seen<'_>) -> bool;

/// House, rule, when it goes on, when off.
const TABLE: [(&str, &str, Condition, Condition); 14] = [
    ("SF1", "chp_rule", |v| v.soc() < 0.60 && v.t(8) < 65.0, |v| v.soc() > 0.95 || v.t(3) > 70.0),
    (
        "SF1",
        "boiler_rule",
        |v| v.soc() < 0.50 && v.t(8) < 60.0,
        |v| v.soc() > 0.65 || v.t(3) > 70.0,
    ),
    (
        "SF1",
        "tank_rule",
        |v| v.of("tank.t_7_k") < 50.0 && v.t(8) > 60.0,
        |v| v.of("tank.t_7_k") > 60.0 || v.t(9) < v.of("tank.t_7_k"),
    ),
    (
        "MF5",
        "small_chp_rule",
        |v| v.soc() < 0.60 && v.t(8) < 65.0,
        |v| v.soc() > 0.95 || v.t(3) > 70.0,
    ),
    (
        "MF5",
        "large_chp_rule",
        |v| v.soc() < 0.60 && v.t(8) < 65.0,
        |v| v.soc() > 0.95 || v.t(3) > 70.0,
    ),
    (
        "MF5",
        "boiler_rule",
        |v| v.soc() < 0.50 && v.t(8) < 60.0,
        |v| v.soc() > 0.65 || v.t(3) > 70.0,
    ),
    ("SF2", "top_rule", |v| v.t(8) < 55.0, |v| v.t(7) > 60.0),
    (
        "SF2",
        "heat_pump_rule",
        |v| v.on("top_rule") || v.t(3) < 43.0,
        |v| !v.on("top_rule") && v.t(2) > 45.0,
    ),
    (
        "SF2",
        "aux_rule",
        |v| v.t(8) < 50.0 || v.t(3) < 35.0,
        |v| (v.t(7) > 55.0 || !v.on("top_rule")) && v.t(2) > 40.0 || !v.on("heat_pump_rule"),
    ),
    (
        "SF2",
        "boiler_rule",
        |v| v.t(10) < 55.0 || v.t(5) < v.of("mixer.set_k") - 5.0,
        |v| v.t(5) > 60.0,
    ),
    ("SF3", "top_rule", |v| v.t(8) < 55.0, |v| v.t(7) > 60.0),
    (
        "SF3",
        "heat_pump_rule",
        |v| v.on("top_rule") || v.t(3) < 43.0,
        |v| !v.on("top_rule") && v.t(2) > 45.0,
    ),
    (
        "SF3",
        "aux_rule",
        |v| v.t(8) < 50.0 || v.t(3) < 35.0,
        |v| (v.t(7) > 55.0 || !v.on("top_rule")) && v.t(2) > 40.0 || !v.on("heat_pump_rule"),
    ),
    (
        "SF4",
        "boiler_rule",
        |v| v.soc() < 0.50 && v.t(10) < 55.0,
        |v| v.soc() > 0.95 || v.t(3) > 70.0,
    ),
];

/// The rule of a house of the library, without its lock, which is no part of the table.
fn rule(house: &str, id: &str) -> RuleParams {
    let text = house_library::text(house).unwrap();
    let document: serde_json::Value =
        serde_json::to_value(toml::from_str::<toml::Table>(text).unwrap()).unwrap();
    let all = document["house_type"][house]["controller"].as_array().unwrap();
    let mut entry = all
        .iter()
        .find(|entry| entry["id"] == id)
        .unwrap_or_else(|| panic!("{house}: {id}"))
        .clone();
    let fields = entry.as_object_mut().unwrap();
    for field in ["id", "kind", "acts_on", "lock", "unlock"] {
        fields.remove(field);
    }
    serde_json::from_value(entry).unwrap()
}

/// Goes over all combinations of values around the thresholds, from on and from off, and compares; gives how often each
/// answer came.
fn compare(what: &str, params: &RuleParams, on: Condition, off: Option<Condition>) -> [usize; 2] {
    let built = params.build(&()).unwrap();
    let names: Vec<String> = params.measures().into_iter().map(|(_, name)| name).collect();
    let values: Vec<&[f64]> = names
        .iter()
        .map(|name| match name.as_str() {
            "storage.soc" => &SOC[..],
            "grid.grid_w" => &WATT[..],
            "mixer.set_k" => &[35.5, 64.5],
            name if name.ends_with(".on") => &[0.0, 1.0],
            _ => &DEGC[..],
        })
        .collect();
    let mut at = vec![0; names.len()];
    let mut came = [0; 2];
    let mut state = built.initial_state();
    loop {
        let seen: Vec<(String, f64)> = names
            .iter()
            .cloned()
            .zip(at.iter().zip(&values).map(|(i, values)| values[*i]))
            .collect();
        let si = |(name, value): &(String, f64)| {
            if name.ends_with("_k") { value + 273.15 } else { *value }
        };
        let measured: Vec<f64> = seen.iter().map(si).collect();
        let table = Seen(&seen);
        for was in [false, true] {
            state[0] = f64::from(u8::from(was));
            let inputs = Inputs { measured: &measured, set_points: &[], limits: &[(0.0, 1.0)] };
            let mut output = [f64::NAN];
            built.update(60.0, &inputs, &mut state, &mut output).unwrap();
            let expected = match off {
                Some(off) => !off(&table) && (was || on(&table)),
                None => on(&table),
            };
            let given = if expected { params.on_output } else { params.off_output };
            assert_eq!(output[0], given, "{what}: was {was}, {seen:?}");
            came[usize::from(expected)] += 1;
        }
        let Some(next) = (0..at.len()).find(|k| at[*k] + 1 < values[*k].len()) else { return came };
        at[next] += 1;
        at[..next].fill(0);
    }
}

#[test]
fn every_row_of_the_library() {
    for (house, id, on, off) in TABLE {
        let came = compare(&format!("{house} {id}"), &rule(house, id), on, Some(off));
        assert!(came[0] > 0 && came[1] > 0, "{house} {id}: {came:?}");
    }
}

/// Rules of the digital twin of house SF1, and the rows that units of the library keep themselves.
#[test]
fn every_row_that_is_no_rule_of_a_house() {
    let params = |on: &str, off: Option<&str>| -> RuleParams {
        let mut fields = serde_json::json!({ "on": on });
        if let Some(off) = off {
            fields["off"] = off.into();
        }
        serde_json::from_value(fields).unwrap()
    };
    let rows: [(&str, RuleParams, Condition, Option<Condition>); 5] = [
        (
            "twin: engine",
            params("storage.t_10_k < 65 degC", Some("storage.t_1_k > 70 degC")),
            |v| v.t(10) < 65.0,
            Some(|v| v.t(1) > 70.0),
        ),
        (
            "twin: boiler",
            params("storage.t_10_k < 60 degC", Some("storage.t_1_k > 70 degC")),
            |v| v.t(10) < 60.0,
            Some(|v| v.t(1) > 70.0),
        ),
        (
            "twin: tank",
            params(
                "tank.t_10_k < 50 degC and tank.t_10_k < storage.t_10_k",
                Some("tank.t_10_k > 65 degC"),
            ),
            |v| v.of("tank.t_10_k") < 50.0 && v.of("tank.t_10_k") < v.t(10),
            Some(|v| v.of("tank.t_10_k") > 65.0),
        ),
        (
            "solar pump",
            params(
                "collector.t_collector_k - storage.t_5_k > 3 K",
                Some("collector.t_collector_k - storage.t_5_k < 2 K"),
            ),
            |v| v.of("collector.t_collector_k") - v.t(5) > 3.0,
            Some(|v| v.of("collector.t_collector_k") - v.t(5) < 2.0),
        ),
        (
            "rod",
            params("grid.grid_w < -500 W and storage.t_7_k < 60 degC", None),
            |v| v.of("grid.grid_w") < -500.0 && v.t(7) < 60.0,
            None,
        ),
    ];
    for (what, params, on, off) in rows {
        let came = compare(what, &params, on, off);
        assert!(came[0] > 0 && came[1] > 0, "{what}: {came:?}");
    }
    // The pump of the collectors keeps these two numbers itself.
    let collector = anergy_prosumer::equipment::solar_collector::SolarCollectorParams::default();
    assert_eq!((collector.start_difference_k, collector.stop_difference_k), (3.0, 2.0));
}

fn simulation(house: &str) -> Simulation {
    let text = format!(
        "format = 1\n[run]\nuntil = \"1d\"\nstep = \"60s\"\nstart = \"2023-02-13T00:00:00Z\"\n\
         [weather]\nkind = \"synthetic\"\nseed = 4\nlatitude_deg = 48.1\nlongitude_deg = 11.6\n{house}"
    );
    running::simulation(&text)
}

fn advance(simulation: &mut Simulation, seconds: f64) {
    let end = simulation.time() + Time::from_s(seconds).unwrap();
    simulation.advance_to(end, Time::from_s(60.0).unwrap()).unwrap();
}

fn set(simulation: &mut Simulation, signal: &str, value: f64) {
    let signal = simulation.signal(signal).unwrap_or_else(|_| panic!("no signal {signal}"));
    simulation.set(signal, value).unwrap();
}

/// The rules of SF2 as a backup behind an energy management that wants nothing.
const BACKUP: &str = "[[house]]\nsite = \"h\"\ntype = \"SF2\"\nwithout = [\"boiler_rule\"]\n\
    set = { \"boiler.enable\" = 0, \"heat_pump_rule.role\" = \"backup\", \"aux_rule.role\" = \"backup\", \"top_rule.role\" = \"backup\", \
    \"heat_pump_rule.timeout_s\" = 3600 }\n";

#[test]
fn a_backup_keeps_the_house_warm_and_its_log_says_when() {
    let mut house = simulation(BACKUP);
    advance(&mut house, 86_400.0);
    assert!(Balances::of(&house).units_error() < 1e-9);
    let events: Vec<(String, String)> =
        house.take_events().map(|event| (event.kind, event.message)).collect();
    let begun = events
        .iter()
        .filter(|(kind, m)| kind == "overridden" && m.starts_with("h.heat_pump_rule"))
        .count();
    let ended = events
        .iter()
        .filter(|(kind, m)| kind == "override_ended" && m.starts_with("h.heat_pump_rule"))
        .count();
    assert!(begun > 2 && (begun == ended || begun == ended + 1), "{events:?}");
    assert_eq!(get(&house, "h.heat_pump_rule.override_count"), begun as f64);
    // Nothing else lets the heat pump run: but for its start and stop, it runs while it is overridden.
    let (overridden_s, operating_s) =
        (get(&house, "h.heat_pump_rule.overridden_s"), get(&house, "h.heat_pump.operating_s"));
    assert!(
        (overridden_s - operating_s).abs() < 360.0 * begun as f64,
        "{overridden_s} {operating_s}"
    );
    assert_eq!(get(&house, "h.water.dc_water_k_m3"), 0.0);
    // Nobody has renewed what is wanted: after an hour it counts no more, and that is said once.
    assert_eq!(
        events.iter().filter(|(kind, _)| kind == "connection_lost").count(),
        1,
        "{events:?}"
    );
    // The energy management wants full speed, and is heard while it renews that.
    for beat in 1..=30 {
        set(&mut house, "h.heat_pump_rule.wanted", 1.0);
        set(&mut house, "h.heat_pump_rule.heartbeat", f64::from(beat));
        advance(&mut house, 60.0);
    }
    assert_eq!(get(&house, "h.heat_pump.modulation_command"), 1.0);
    assert_eq!(get(&house, "h.heat_pump_rule.overrides"), 0.0);
    // Twice full speed cannot be wanted.
    house.take_events();
    set(&mut house, "h.heat_pump_rule.wanted", 2.0);
    set(&mut house, "h.heat_pump_rule.heartbeat", 31.0);
    advance(&mut house, 60.0);
    let refused: Vec<String> =
        house.take_events().filter(|e| e.kind == "set_point_refused").map(|e| e.message).collect();
    assert!(
        refused.len() == 1 && refused[0].contains("2 is wanted, which is outside 0 to 1"),
        "{refused:?}"
    );
    // Without backup it gets cold.
    let mut cold = simulation(BACKUP);
    for rule in ["heat_pump_rule", "aux_rule", "top_rule"] {
        set(&mut cold, &format!("h.{rule}.backup"), 0.0);
    }
    advance(&mut cold, 86_400.0);
    assert_eq!(get(&cold, "h.heat_pump.starts"), 0.0);
    assert!(get(&cold, "h.water.dc_water_k_m3") > 0.0);
}

#[test]
fn a_house_that_is_locked_is_told() {
    let house = "[[house]]\nsite = \"h\"\ntype = \"SF1\"\nset = { \"boiler_rule.lock\" = \"storage.t_10_k > 62 degC\", \
                 \"boiler_rule.unlock\" = \"storage.t_10_k < 61 degC\" }\n";
    let mut house = simulation(house);
    advance(&mut house, 86_400.0);
    let events: Vec<(String, String)> =
        house.take_events().map(|event| (event.kind, event.message)).collect();
    let locked = events.iter().find(|(kind, _)| kind == "locked").unwrap();
    assert_eq!(locked.1, "h.boiler_rule: locked by h.storage.t_10_k > 62 degC, its output is 0");
    assert!(events.iter().any(|(kind, _)| kind == "unlocked"));
}

#[test]
fn a_snapshot_keeps_what_a_rule_remembers() {
    let mut house = simulation(BACKUP);
    advance(&mut house, 6.0 * 3600.0);
    let here = house.snapshot();
    let bits = |house: &mut Simulation| {
        advance(house, 4.0 * 3600.0);
        ["h.heat_pump_rule.overridden_s", "h.heat_pump.electric_j", "h.storage.t_8_k"]
            .map(|channel| get(house, channel).to_bits())
    };
    let first = bits(&mut house);
    house.restore(&here).unwrap();
    assert_eq!(first, bits(&mut house));
}
