//! The five houses of the laboratory (`examples/laboratory-*`): a cold week each, for itself, and a day in a ring; balances close,
//! rooms and taps are warm. `LABORATORY=all` also runs a year of each house and the ring in steps of 1 s (`make validate`).

#![allow(clippy::unwrap_used)]

use anergy_core::recorder::Event;
use anergy_simulation::balance::{Balances, summary};
use anergy_simulation::simulation::Simulation;
use anergy_tests::pages::write_table;
use anergy_tests::running::{advance, get, simulation};
use std::fmt::Write;

const HOUSES: [&str; 5] = ["sf1", "sf2", "sf3", "sf4", "mf5"];

fn text(house: &str) -> String {
    let path = anergy_tests::workspace().join(format!("examples/laboratory-{house}/model.toml"));
    std::fs::read_to_string(path).unwrap()
}

/// Electric units of a house.
fn electric(house: &str) -> &'static [&'static str] {
    match house {
        "sf1" => &["chp", "boiler", "collector", "mixer", "water", "people"],
        "sf2" => &["heat_pump", "boiler", "collector", "mixer", "water", "people", "roof"],
        "sf3" => &["heat_pump", "collector", "mixer", "water", "people", "roof"],
        "sf4" => &["stirling", "mixer", "water", "people", "roof"],
        _ => &[
            "small_chp",
            "large_chp",
            "boiler",
            "mixer",
            "water",
            "flat_1",
            "flat_2",
            "flat_3",
            "flat_4",
        ],
    }
}

/// Heat into the room and the taps that was missing: K h and K l.
fn discomfort(simulation: &Simulation, house: &str) -> (f64, f64) {
    let of = |name: &str| get(simulation, &format!("{house}.{name}"));
    (of("building.dc_heat_k_s") / 3600.0, 1e3 * of("water.dc_water_k_m3"))
}

fn electric_w(simulation: &Simulation, house: &str) -> f64 {
    let of = |name: &str| get(simulation, &format!("{house}.{name}"));
    let units = electric(house).iter().map(|unit| of(&format!("{unit}.electric_w")));
    let rod_w = if house == "sf4" { of("storage.rod_w") } else { 0.0 };
    units.sum::<f64>() + rod_w
}

/// A run of a house alone: heat and electricity close, what burns is within its efficiency, rooms and taps are warm.
fn runs_alone(house: &str, days: f64) -> Simulation {
    let mut simulation = simulation(&text(house));
    let (mut sum_j, mut grid_j) = (0.0, 0.0);
    for _ in 0..(days * 1440.0) as u32 {
        advance(&mut simulation, 60.0, 60.0);
        sum_j += 60.0 * electric_w(&simulation, house);
        grid_j += 60.0 * get(&simulation, &format!("{house}.grid.grid_w"));
    }
    let balances = Balances::of(&simulation);
    assert!(balances.units_error() < 1e-9, "{house}: {balances:?}");
    assert!((grid_j - sum_j).abs() < 1e-9 * grid_j.abs().max(3.6e6), "{house}: {grid_j} {sum_j}");
    assert_eq!(discomfort(&simulation, house), (0.0, 0.0), "{house}");
    for unit in electric(house) {
        let of = |name: &str| {
            let channel = simulation.channel(&format!("{house}.{unit}.{name}")).ok()?;
            Some(simulation.get(channel) / 3.6e6)
        };
        let (Some(fuel), Some(heat)) = (of("fuel_j"), of("heat_j")) else { continue };
        let useful = heat + of("generated_j").unwrap_or(0.0);
        assert!(
            useful <= 1.06 * fuel && useful >= 0.7 * fuel,
            "{house} {unit}: {useful} of {fuel} kWh"
        );
    }
    let troubles: Vec<Event> = simulation
        .take_events()
        .filter(|event| ["tripped", "too_cold", "locked"].contains(&event.kind.as_str()))
        .collect();
    assert!(troubles.is_empty(), "{house}: {troubles:?}");
    simulation
}

/// The sum of an output over the units of a house that have it, in units of `scale`.
fn sum(simulation: &Simulation, house: &str, units: &[&str], output: &str, scale: f64) -> f64 {
    let of = |unit: &&str| {
        let channel = simulation.channel(&format!("{house}.{unit}.{output}")).ok()?;
        Some(simulation.get(channel) / scale)
    };
    units.iter().filter_map(of).sum()
}

const MWH: f64 = 3.6e9;
const KWH: f64 = 3.6e6;

/// The command that writes the tables.
const COMMAND: &str = "LABORATORY=all cargo test --workspace --test prosumers laboratory_houses::";
/// What burns or pumps heat, the boilers behind it.
const FIRST: [&str; 4] = ["chp", "heat_pump", "stirling", "small_chp"];
const ENGINES: [&str; 5] = ["chp", "heat_pump", "stirling", "small_chp", "large_chp"];

/// The columns of a table of houses that have run.
fn balance_table(simulations: &[(&str, Simulation)], scale: f64, digits: usize) -> String {
    type Of = fn(&Simulation, &str, f64) -> f64;
    let rows: [(&str, Of); 11] = [
        ("gas", |s, house, scale| sum(s, house, electric(house), "fuel_j", scale)),
        ("heat of engines or heat pump", |s, h, scale| sum(s, h, &ENGINES, "heat_j", scale)),
        ("heat of the boiler", |s, house, scale| sum(s, house, &["boiler"], "heat_j", scale)),
        ("heat of the sun", |s, house, scale| sum(s, house, &["collector"], "heat_j", scale)),
        ("heat of rooms", |s, house, scale| sum(s, house, &["building"], "heat_j", scale)),
        ("hot water with circulation", |s, house, scale| {
            sum(s, house, &["water"], "taken_j", scale)
        }),
        ("electricity made: engines", |s, h, scale| sum(s, h, &ENGINES, "generated_j", scale)),
        ("electricity made: roof", |s, h, scale| sum(s, h, &["roof"], "generated_j", scale)),
        ("from the public grid", |s, house, scale| sum(s, house, &["grid"], "import_j", scale)),
        ("to the public grid", |s, house, scale| sum(s, house, &["grid"], "export_j", scale)),
        ("starts of the first generator", |s, house, _| sum(s, house, &FIRST, "starts", 1.0)),
    ];
    let names: Vec<String> = simulations.iter().map(|(house, _)| house.to_uppercase()).collect();
    let mut table = format!("| | {} |\n|---|{}\n", names.join(" | "), "--:|".repeat(names.len()));
    for (name, of) in rows {
        let digits = if name.starts_with("starts") { 0 } else { digits };
        let values = simulations.iter().map(|(house, s)| of(s, house, scale));
        let values: Vec<String> = values
            .map(|value| if value == 0.0 { "-".into() } else { format!("{value:.digits$}") })
            .collect();
        writeln!(table, "| {name} | {} |", values.join(" | ")).unwrap();
    }
    let errors = simulations.iter().map(|(_, s)| Balances::of(s).units_error());
    let errors: Vec<String> = errors.map(|error| format!("{error:.0e}")).collect();
    writeln!(table, "| heat left over, relative | {} |", errors.join(" | ")).unwrap();
    table
}

#[test]
fn a_cold_week_of_each_house() {
    // Starts of generators, kWh of heat that the documentation of the examples says.
    let said: [(&str, &str, f64, f64); 7] = [
        ("sf1", "chp", 3.0, 734.0),
        ("sf1", "boiler", 30.0, 358.0),
        ("sf2", "heat_pump", 88.0, 771.0),
        ("sf3", "heat_pump", 124.0, 810.0),
        ("sf4", "stirling", 7.0, 818.0),
        ("mf5", "small_chp", 28.0, 524.0),
        ("mf5", "large_chp", 28.0, 1532.0),
    ];
    let mut simulations = Vec::new();
    for house in HOUSES {
        let simulation = runs_alone(house, 7.0);
        for (_, unit, starts, heat_kwh) in said.iter().filter(|row| row.0 == house) {
            let of = |name: &str| get(&simulation, &format!("{house}.{unit}.{name}"));
            let found = (of("starts"), of("heat_j") / 3.6e6);
            assert!(
                (found.0 - starts).abs() <= 0.1 * starts + 1.0
                    && (found.1 - heat_kwh).abs() < 0.03 * heat_kwh,
                "{house} {unit}: {found:?}, documented {starts} starts, {heat_kwh} kWh"
            );
        }
        simulations.push((house, simulation));
    }
    write_table("laboratory", "week", COMMAND, &balance_table(&simulations, KWH, 0));
}

/// A run with closed balances without discomfort; heat of the rooms, J.
fn comfortable_j(text: &str, house: &str, days: f64, step_s: f64) -> f64 {
    warm_j(text, house, days, step_s, 1.0)
}

/// The same where taps may lack so many K l.
fn warm_j(text: &str, house: &str, days: f64, step_s: f64, water_max_k_l: f64) -> f64 {
    let mut simulation = simulation(text);
    advance(&mut simulation, days * 86_400.0, step_s);
    assert!(Balances::of(&simulation).units_error() < 1e-9, "{house}: {step_s} s");
    let (room_k_h, water_k_l) = discomfort(&simulation, house);
    assert!(
        room_k_h < 0.5 && water_k_l < water_max_k_l,
        "{house}, {step_s} s: {room_k_h} K h, {water_k_l} K l"
    );
    assert!(
        !simulation.take_events().any(|event| event.kind == "unsettled"),
        "{house}, {step_s} s: circuits settle"
    );
    get(&simulation, &format!("{house}.building.heat_j"))
}

/// The houses of the library, and the one stated in a model file of its own.
const MODELS: [(&str, &str); 6] = [
    ("sf1", "sf1"),
    ("sf2", "sf2"),
    ("sf3", "sf3"),
    ("sf4", "sf4"),
    ("mf5", "mf5"),
    ("house", "sf1"),
];

#[test]
fn steps_of_seconds_to_hours_work() {
    // With steps of 1 s a week with `LABORATORY=all`, else half a day.
    let all = std::env::var("LABORATORY").is_ok();
    let days = if all { 7.0 } else { 0.5 };
    let mut table = "| model | 1 s | 60 s | 15 min | 1 h |\n|---|--:|--:|--:|--:|\n".to_owned();
    for (model, house) in MODELS {
        let text = text(model);
        let close = |days: f64, step_s: f64, fine_j: f64| {
            let coarse_j = comfortable_j(&text, house, days, step_s);
            assert!(
                (coarse_j - fine_j).abs() < 0.05 * fine_j,
                "{model}, {step_s} s: {coarse_j} of {fine_j} J"
            );
            coarse_j
        };
        let second_j = close(days, 1.0, comfortable_j(&text, house, days, 60.0));
        let fine_j = comfortable_j(&text, house, 7.0, 60.0);
        let coarse_j = [900.0, 3600.0].map(|step_s| close(7.0, step_s, fine_j));
        let kwh = [second_j, fine_j, coarse_j[0], coarse_j[1]].map(|j| format!("{:.1}", j / KWH));
        writeln!(table, "| laboratory-{model} | {} |", kwh.join(" | ")).unwrap();
    }
    if all {
        write_table("laboratory", "steps", COMMAND, &table);
    }
}

/// A house of the library with two pipes to its storage.
fn two_pipe(house: &str, set: &str) -> String {
    text(house) + &format!("connection = \"two_pipe\"\nset = {{ {set} }}\n")
}

#[test]
fn houses_with_two_pipes() {
    // Nothing closes the engine that is off, and the boiler draws on it; or all is closed while it is off.
    let open = r#""engine.idle_opening" = 1, "engine.suction" = 0.15, "engine.check_valve" = true"#;
    let open_5 = r#""small_engine.idle_opening" = 1, "small_engine.suction" = 0.15, "small_engine.check_valve" = true,
        "large_engine.idle_opening" = 1, "large_engine.suction" = 0.15, "large_engine.check_valve" = true"#;
    let open_5 = open_5.replace('\n', " ");
    let content = r#", "chp.content_kj_k" = 60"#;
    // Return water that passes the idle engines of MF5 gets into the fresh-water station: some draws of 5 250 l are too cold.
    for (house, set, water_max_k_l) in [
        ("sf1", String::new(), 1.0),
        ("sf1", open.to_owned(), 1.0),
        ("sf1", open.to_owned() + content, 1.0),
        ("sf4", String::new(), 1.0),
        ("mf5", String::new(), 1.0),
        ("mf5", open_5, 50.0),
    ] {
        let four_j = comfortable_j(&text(house), house, 7.0, 60.0);
        let text = two_pipe(house, &set);
        for step_s in [60.0, 900.0, 3600.0] {
            let two_j = warm_j(&text, house, 7.0, step_s, water_max_k_l);
            assert!(
                (two_j - four_j).abs() < 0.05 * four_j,
                "{house}, {set}, {step_s} s: {two_j} of {four_j} J"
            );
        }
    }
    // The storage takes the difference: what the engine and the boiler give less what heating and tank take.
    let mut simulation = simulation(&two_pipe("sf1", ""));
    let mut seen = [false; 2];
    for _ in 0..600 {
        advance(&mut simulation, 60.0, 60.0);
        let of = |port: &str| get(&simulation, &format!("sf1.{port}.m_flow_kg_s"));
        let rest = of("chp.water") + of("boiler.water") - of("mixer.storage") - of("tank.heating");
        assert!((of("storage.point") - rest).abs() < 1e-9, "{rest}");
        seen = [seen[0] || rest > 0.0, seen[1] || rest < 0.0];
    }
    assert_eq!(seen, [true; 2], "charged and discharged");
}

#[test]
fn sf1_with_its_booster_station() {
    // The numbers of the README, kWh of the week; 20 degC of the grid become up to 68 degC in the storage.
    let path = anergy_tests::workspace().join("examples/laboratory-sf1/booster.toml");
    let mut simulation = simulation(&std::fs::read_to_string(path).unwrap());
    advance(&mut simulation, 7.0 * 86_400.0, 60.0);
    let balances = Balances::of(&simulation);
    assert!(balances.units_error() < 1e-9, "{balances:?}");
    assert_eq!(discomfort(&simulation, "sf1"), (0.0, 0.0));
    for (output, kwh) in [
        ("chp.heat_j", 723.0),
        ("boiler.heat_j", 186.0),
        ("bhpts.heat_j", 183.0),
        ("bhpts.electric_j", 67.5),
    ] {
        let value = get(&simulation, &format!("sf1.{output}")) / KWH;
        assert!((value - kwh).abs() < 0.02 * kwh, "{output}: {value}, not {kwh}");
    }
    let tripped = simulation.take_events().filter(|event| event.kind == "tripped").count();
    assert_eq!(tripped, 0);
    assert_eq!(get(&simulation, "sf1.bhpts.exchanger_s"), 0.0);
}

fn ring(file: &str, step_s: f64) -> Simulation {
    let path = anergy_tests::workspace().join("examples/laboratory-ring").join(file);
    let text = std::fs::read_to_string(path).unwrap();
    // The step decides how the flow of a station is held.
    let text = text.replace("step = \"1s\"", &format!("step = \"{step_s}s\""));
    let mut simulation = simulation(&text);
    advance(&mut simulation, 86_400.0, step_s);
    let balances = Balances::of(&simulation);
    assert!(balances.units_error() < 1e-9 && balances.heat_error() < 1e-6, "{file}: {balances:?}");
    simulation
}

#[test]
fn a_winter_day_in_the_ring() {
    for file in ["model.toml", "island.toml"] {
        let simulation = ring(file, 60.0);
        for house in HOUSES {
            assert_eq!(discomfort(&simulation, house), (0.0, 0.0), "{file} {house}");
        }
    }
}

/// `LABORATORY=all`: a year of each house in steps of a minute, and the ring in steps of 1 s.
#[test]
fn a_year_of_each_house_and_the_ring_in_seconds() {
    if std::env::var("LABORATORY").is_err() {
        println!("LABORATORY is not set: years are not run");
        return;
    }
    let mut simulations = Vec::new();
    for house in HOUSES {
        let begin = std::time::Instant::now();
        let simulation = runs_alone(house, 365.0);
        println!("{house}: a year in {:.1} s, read every step", begin.elapsed().as_secs_f64());
        simulations.push((house, simulation));
    }
    write_table("laboratory", "year", COMMAND, &balance_table(&simulations, MWH, 1));
    let mut table = "| | SF1 | SF2 | SF3 | SF4 | MF5 | grid station | heat left over, relative |\n\
                     |---|--:|--:|--:|--:|--:|--:|--:|\n"
        .to_owned();
    for (file, name) in [("model.toml", "with a grid station"), ("island.toml", "island")] {
        let begin = std::time::Instant::now();
        let simulation = ring(file, 1.0);
        println!("{file}: a day in {:.1} s", begin.elapsed().as_secs_f64());
        for house in HOUSES {
            assert_eq!(discomfort(&simulation, house), (0.0, 0.0), "{file} {house}");
        }
        let stations = summary(&simulation, false)["kpis"]["stations"].clone();
        let cells = HOUSES.iter().chain(&["plant"]).map(|site| {
            let of = |name: &str| stations[format!("{site}.station")][name].as_f64();
            let kwh = [of("heat_given_kwh"), of("heat_taken_kwh")];
            match kwh {
                [Some(given), Some(taken)] => format!("{given:.0}, {taken:.0}"),
                _ => "-".to_owned(),
            }
        });
        let cells: Vec<String> = cells.collect();
        let error = Balances::of(&simulation).heat_error();
        writeln!(table, "| {name} | {} | {error:.0e} |", cells.join(" | ")).unwrap();
    }
    write_table("laboratory", "ring", COMMAND, &table);
}
