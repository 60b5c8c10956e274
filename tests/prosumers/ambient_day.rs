//! SC-04: a day in an ambient grid with a house that heats, one that cools, and a balancing unit
//! (`examples/5gdhc-day`). The first day of the run warms floors and walls; the second one is judged.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_core::error::RecordError;
use anergy_core::recorder::{Channel, Event, Recorder, RunHeader};
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::model_file::{Duration, StepEntry};
use anergy_simulation::run::{RunOptions, run};
use anergy_simulation::simulation::Simulation;
use anergy_tests::running::get;
use anergy_tests::workspace;

const DAY_S: f64 = 86_400.0;
const HEATING_DEGC: f64 = 21.0;
const COOLING_DEGC: f64 = 23.0;
const GROUND_DEGC: f64 = 12.0;
/// When the house that cools stops, s of its day.
const STOPS_S: f64 = 13.0 * 3600.0;

fn text() -> String {
    std::fs::read_to_string(workspace().join("examples/5gdhc-day/model.toml")).unwrap()
}

fn with(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old}");
    text.replace(old, new)
}

fn simulation(text: &str) -> Simulation {
    let model = Model::from_toml(text, &workspace().join("examples/5gdhc-day"))
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)));
    Simulation::new(build(&model).unwrap()).unwrap()
}

fn time(s: f64) -> Time {
    Time::from_s(s).unwrap()
}

fn degc(simulation: &Simulation, channel: &str) -> f64 {
    get(simulation, channel) - 273.15
}

/// Smallest and largest value so far.
#[derive(Debug, Clone, Copy)]
struct Range(f64, f64);

impl Range {
    const NONE: Self = Self(f64::INFINITY, f64::NEG_INFINITY);

    fn see(&mut self, value: f64) {
        *self = Self(self.0.min(value), self.1.max(value));
    }
}

/// What the second day showed.
#[derive(Debug)]
struct Day {
    heating_room_degc: Range,
    cooling_room_degc: Range,
    top_degc: Range,
    bottom_degc: Range,
    balancing_kg_s: Range,
    imbalance_kg_s: f64,
    starts: f64,
    cop: f64,
    electric_kwh: f64,
    heat_kwh: f64,
    cold_kwh: f64,
    /// Of the stub of the house that stopped, every hour.
    standing_degc: Vec<f64>,
}

fn day(text: &str, step_s: f64) -> Day {
    let mut simulation = simulation(text);
    simulation.advance_to(time(DAY_S), time(step_s)).unwrap();
    let of = |simulation: &Simulation| {
        [
            "heat.heat_pump.starts",
            "heat.heat_pump.electric_j",
            "heat.heat_pump.heat_j",
            "cool.rooms.cold_j",
        ]
        .map(|channel| get(simulation, channel))
    };
    let before = of(&simulation);
    let mut day = Day {
        heating_room_degc: Range::NONE,
        cooling_room_degc: Range::NONE,
        top_degc: Range::NONE,
        bottom_degc: Range::NONE,
        balancing_kg_s: Range::NONE,
        imbalance_kg_s: 0.0,
        starts: 0.0,
        cop: 0.0,
        electric_kwh: 0.0,
        heat_kwh: 0.0,
        cold_kwh: 0.0,
        standing_degc: Vec::new(),
    };
    for minute in 1..=1440_u32 {
        let at_s = f64::from(minute) * 60.0;
        simulation.advance_to(time(DAY_S + at_s), time(step_s)).unwrap();
        let s = &simulation;
        day.heating_room_degc.see(degc(s, "heat.rooms.t_room_k"));
        day.cooling_room_degc.see(degc(s, "cool.rooms.t_room_k"));
        day.top_degc.see(degc(s, "bu.storage.t_10_k"));
        day.bottom_degc.see(degc(s, "bu.storage.t_1_k"));
        let balancing = get(s, "bu.station.m_flow_kg_s");
        day.balancing_kg_s.see(balancing);
        let houses = get(s, "heat.station.m_flow_kg_s") + get(s, "cool.station.m_flow_kg_s");
        day.imbalance_kg_s = day.imbalance_kg_s.max((balancing + houses).abs());
        if at_s >= STOPS_S + 3600.0 && minute % 60 == 0 {
            day.standing_degc.push(degc(s, "cool.port_cold.t_k"));
        }
    }
    let after = of(&simulation);
    let used = |i: usize| after[i] - before[i];
    day.starts = used(0);
    day.cop = used(2) / used(1);
    (day.electric_kwh, day.heat_kwh, day.cold_kwh) =
        (used(1) / 3.6e6, used(2) / 3.6e6, used(3) / 3.6e6);
    let balances = Balances::of(&simulation);
    assert!(balances.heat_error() < 1e-6 && balances.units_error() < 1e-6, "{balances:?}");
    day
}

#[test]
fn houses_live_and_the_unit_balances() {
    let day = day(&text(), 60.0);
    println!("{day:?}");
    let Range(coldest, warmest) = day.heating_room_degc;
    assert!(coldest > HEATING_DEGC - 0.5 && warmest < HEATING_DEGC + 0.5, "{day:?}");
    let Range(coldest, warmest) = day.cooling_room_degc;
    assert!(coldest > COOLING_DEGC - 0.5 && warmest < COOLING_DEGC + 1.5, "{day:?}");
    // The demand that dominates changes, and with it the direction through the balancing unit.
    assert!(day.balancing_kg_s.0 < -0.05 && day.balancing_kg_s.1 > 0.05, "{day:?}");
    assert!(day.imbalance_kg_s < 1e-6, "{day:?}");
    assert!(day.starts <= 6.0, "{day:?}");
    assert!((4.0..6.0).contains(&day.cop), "{day:?}");
    assert!(day.top_degc.1 <= 22.5, "{day:?}");
    // Bare pipes in ground of 12 degC: the limit of 12.5 degC of the scenario was found without pipes.
    assert!(day.bottom_degc.0 >= 10.0, "{day:?}");
    // What stands goes to the temperature of the ground.
    let away = day.standing_degc.iter().map(|t| (t - GROUND_DEGC).abs()).collect::<Vec<_>>();
    assert!(away.windows(2).all(|pair| pair[1] <= pair[0] + 1e-9), "{:?}", day.standing_degc);
}

#[test]
fn insulated_pipes_and_a_higher_band_hold_the_limits_of_the_unit() {
    let insulated = with(
        &text(),
        "pipe = \"PE100 SDR11 50\" # not insulated\ndepth_m = 1\n",
        "inner_diameter_mm = 40.8\ninsulation_resistance_k_m_w = 5\n",
    );
    let valve = "acts_on_valve = \"storage.heat_pump_position\"\n";
    let band = format!("{valve}cooling_start_degc = 19.5\ncooling_stop_degc = 16.5\n");
    let day = day(&with(&insulated, valve, &band), 60.0);
    assert!(day.top_degc.1 <= 22.5 && day.bottom_degc.0 >= 12.5, "{day:?}");
}

#[test]
fn on_off_control_in_the_same_band_starts_more_often() {
    let valve = "acts_on_valve = \"storage.charge_position\"\n";
    let day = day(&with(&text(), valve, &format!("{valve}modulating = false\n")), 60.0);
    assert!(day.starts >= 12.0, "{day:?}");
}

#[test]
fn constant_flow_needs_less_electricity_and_spreads_temperatures() {
    // SC-13: what the grid gives in the mean, once with a constant difference and once with a constant flow.
    let fixed = day(&text(), 60.0);
    let floating = with(
        &text(),
        "kind = \"booster_heat_pump\"\n",
        "kind = \"booster_heat_pump\"\ngrid_flow_control = \"constant_flow\"\ngrid_v_flow_l_min = 12\n",
    );
    let floating = day(&floating, 60.0);
    println!(
        "electricity: {:.3} kWh fixed, {:.3} kWh floating",
        fixed.electric_kwh, floating.electric_kwh
    );
    let saved = 1.0 - floating.electric_kwh / fixed.electric_kwh;
    assert!((0.005..0.10).contains(&saved), "{saved}: {fixed:?} {floating:?}");
}

#[test]
fn units_show_what_they_hold_before_the_first_step() {
    let simulation = simulation(&text());
    assert!((degc(&simulation, "bu.storage.t_1_k") - 15.0).abs() < 1e-9);
    assert!((degc(&simulation, "bu.storage.t_10_k") - 20.0).abs() < 1e-9);
    assert!((degc(&simulation, "heat.rooms.t_room_k") - 21.0).abs() < 0.1);
}

#[test]
fn a_snapshot_continues_bit_for_bit() {
    let mut simulation = simulation(&text());
    simulation.advance_to(time(8.0 * 3600.0), time(60.0)).unwrap();
    let snapshot = simulation.snapshot();
    let bytes = snapshot.to_bytes().unwrap();
    simulation.advance_to(time(16.0 * 3600.0), time(60.0)).unwrap();
    let first = simulation.snapshot();
    simulation.restore_bytes(&bytes).unwrap();
    simulation.advance_to(time(16.0 * 3600.0), time(60.0)).unwrap();
    assert!(simulation.snapshot() == first);
}

/// A day at steps of 1 s, with the PI control of the pumps; for `make validate`.
#[test]
fn steps_of_a_second_agree_with_steps_of_a_minute() {
    if std::env::var_os("AMBIENT_DAY").is_none() {
        println!("skipped: set AMBIENT_DAY=1, as make validate does");
        return;
    }
    let coarse = day(&text(), 60.0);
    let fine = day(&with(&text(), "step = \"60s\"", "step = \"1s\""), 1.0);
    for (what, coarse, fine) in [
        ("electricity of the heat pump", coarse.electric_kwh, fine.electric_kwh),
        ("heat of the heat pump", coarse.heat_kwh, fine.heat_kwh),
        ("cold of the rooms", coarse.cold_kwh, fine.cold_kwh),
    ] {
        println!("| {what} | {coarse:.3} | {fine:.3} | {:.2} % |", 100.0 * (coarse / fine - 1.0));
        assert!((coarse / fine - 1.0).abs() < 0.01, "{what}: {coarse} and {fine}");
    }
}

#[test]
fn a_run_with_steps_too_long_for_its_control_warns() {
    #[derive(Default)]
    struct Events(Vec<Event>);
    impl Recorder for &mut Events {
        fn start(&mut self, _header: &RunHeader, _channels: &[Channel]) -> Result<(), RecordError> {
            Ok(())
        }
        fn row(&mut self, _time: Time, _values: &[f64]) -> Result<(), RecordError> {
            Ok(())
        }
        fn event(&mut self, event: &Event) -> Result<(), RecordError> {
            self.0.push(event.clone());
            Ok(())
        }
        fn finish(self: Box<Self>, _summary: &serde_json::Value) -> Result<(), RecordError> {
            Ok(())
        }
    }
    let fine = with(&text(), "step = \"60s\"", "step = \"1s\"");
    for (step_s, warnings) in [(1.0, 0), (2.0, 0), (60.0, 2)] {
        let mut events = Events::default();
        let options = RunOptions {
            until: Some(time(600.0)),
            step: Some(StepEntry::Fixed(Duration(time(step_s)))),
            record: None,
        };
        run(&mut simulation(&fine), options, Box::new(&mut events), &mut |_, _| true).unwrap();
        let coarse = events.0.iter().filter(|event| event.kind == "coarse_step").count();
        assert_eq!(coarse, warnings, "{step_s} s: {:?}", events.0);
    }
}
