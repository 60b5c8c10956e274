//! SC-14: the balancing unit of the ambient day (`examples/5gdhc-day`) as system A, its storage between the lines, and as
//! system B, parted from them by an exchanger with a pump that turns both ways. The first day warms floors and
//! walls; the second one is judged.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::workspace;

const DAY_S: u32 = 86_400;
/// A flow of no direction, kg/s.
const STILL_KG_S: f64 = 1e-3;

fn system_a() -> String {
    let file = workspace().join("examples/5gdhc-day/model.toml");
    with(&std::fs::read_to_string(file).unwrap(), "step = \"60s\"", "step = \"1s\"")
}

/// The block of the README in place of that of the model.
fn system_b() -> String {
    let readme = workspace().join("examples/5gdhc-day/README.md");
    let readme = std::fs::read_to_string(readme).unwrap();
    let block = |after: &str| {
        let from = readme.split_once(after).unwrap().1.split_once("```toml\n").unwrap().1;
        from.split_once("```").unwrap().0.to_owned()
    };
    let station = "station = { kind = \"balancing_unit\", stub = { pipe = \"PE100 SDR11 50\", length_m = 2 } }\n";
    let text = with(&system_a(), station, &block("The station gets a pump"));
    let port = "[house.unit.ports.grid] # cold water enters at the bottom, the top supplies the hot line\n\
                inlet_layer = 1\noutlet_layer = 10\n";
    let text = with(&text, port, &block("The storage is drawn from either end"));
    format!("{text}{}", block("Behind the station stands the exchanger"))
}

fn with(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old}");
    text.replace(old, new)
}

#[derive(Debug)]
struct Day {
    balancing_pump_kwh: f64,
    pumps_kwh: f64,
    /// Changes of the direction of the balancing flow, those of less than a minute left out.
    switches: usize,
    /// How far the line that the unit supplies is from the end of the storage that supplies it, in the hour after a
    /// change of direction, less the first minutes in which the water of the stubs comes: mean, K.
    excursion_k: f64,
    imbalance_kg_s: f64,
    /// Largest pressure difference of the lines, 95 % of the time below, Pa.
    difference_pa: f64,
    electric_kwh: f64,
}

fn day(text: &str) -> Day {
    let model = Model::from_toml(text, &workspace().join("examples/5gdhc-day"))
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)));
    let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
    let time = |s: u32| Time::from_s(f64::from(s)).unwrap();
    let step = Time::from_s(1.0).unwrap();
    simulation.advance_to(time(DAY_S), step).unwrap();
    let get = |s: &Simulation, name: &str| s.get(s.channel(name).unwrap());
    let pump = simulation.channel("bu.pump.power_w").is_ok();
    let energy = |s: &Simulation| {
        let names = ["network.electric_j", "bu.heat_pump.electric_j", "heat.heat_pump.electric_j"];
        names.map(|name| get(s, name) / 3.6e6)
    };
    let before = energy(&simulation);
    let mut day = Day {
        balancing_pump_kwh: 0.0,
        pumps_kwh: 0.0,
        switches: 0,
        excursion_k: 0.0,
        imbalance_kg_s: 0.0,
        difference_pa: 0.0,
        electric_kwh: 0.0,
    };
    let (mut direction, mut held_s, mut differences) = (0.0, 0, Vec::new());
    let (mut since_s, mut apart) = (f64::INFINITY, (0.0, 0.0));
    for s in (10..=DAY_S).step_by(10) {
        simulation.advance_to(time(DAY_S + s), step).unwrap();
        let of = |name: &str| get(&simulation, name);
        let m_kg_s = of("bu.station.m_flow_kg_s");
        let houses = of("heat.station.m_flow_kg_s") + of("cool.station.m_flow_kg_s");
        day.imbalance_kg_s = day.imbalance_kg_s.max((m_kg_s + houses).abs());
        differences.push((of("bu.hot.p_pa") - of("bu.cold.p_pa")).abs());
        if pump {
            day.balancing_pump_kwh += of("bu.pump.power_w") * 10.0 / 3.6e6;
        }
        let now = if m_kg_s.abs() < STILL_KG_S { direction } else { m_kg_s.signum() };
        held_s = if now == direction { 0 } else { held_s + 10 };
        if held_s >= 60 {
            day.switches += usize::from(direction != 0.0);
            (direction, held_s) = (now, 0);
            since_s = if day.switches > 0 { 0.0 } else { f64::INFINITY };
        }
        since_s += 10.0;
        if (300.0..=3600.0).contains(&since_s) && m_kg_s.abs() > 0.02 {
            let (line, end) = if m_kg_s > 0.0 { ("hot", "10") } else { ("cold", "1") };
            let gap_k = of(&format!("bu.port_{line}.t_k")) - of(&format!("bu.storage.t_{end}_k"));
            apart = (apart.0 + gap_k.abs(), apart.1 + 1.0);
        }
    }
    day.excursion_k = apart.0 / apart.1;
    differences.sort_by(f64::total_cmp);
    day.difference_pa = differences[differences.len() * 95 / 100];
    let used: Vec<f64> = energy(&simulation).iter().zip(before).map(|(a, b)| a - b).collect();
    day.pumps_kwh = used[0];
    day.electric_kwh = used.iter().sum();
    let balances = Balances::of(&simulation);
    assert!(balances.heat_error() < 1e-6 && balances.units_error() < 1e-6, "{balances:?}");
    day
}

#[test]
fn system_b_costs_pumping_and_temperature() {
    let (a, b) = std::thread::scope(|scope| {
        let b = scope.spawn(|| day(&system_b()));
        (day(&system_a()), b.join().unwrap())
    });
    println!("A {a:?}\nB {b:?}");
    // Nothing is lost: without a pump by construction, with it because water is not compressed.
    assert!(a.imbalance_kg_s < 1e-6 && b.imbalance_kg_s < 1e-6);
    assert!(b.balancing_pump_kwh > 0.0 && b.balancing_pump_kwh < b.pumps_kwh);
    assert!(b.pumps_kwh > a.pumps_kwh && b.electric_kwh > a.electric_kwh);
    // Both turn with the houses, in B the pump with them.
    assert!(a.switches >= 2 && b.switches >= 2);
    // Behind the exchanger the lines are further from the storage.
    assert!(b.excursion_k > 1.5 * a.excursion_k);
    // The pump keeps the lines nearer to each other than the bare exchanger would: 0.25 kg/s of Kv 4 are 51 hPa.
    assert!(b.difference_pa < 250.0);
}
