//! SC-02: a cold plug, its remedy, and the same with heat loss (`examples/cold-plug`).
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::stability::advise::{Advice, Outcome, advise};
use anergy_simulation::stability::analyse;
use anergy_tests::workspace;

/// SF1 starts.
const START_S: f64 = 600.0;
/// Until the plug is at SF4: 19.0 l at 8 l/min.
const ARRIVAL_S: f64 = 142.5;
/// It lasts: 38.0 l at 4 l/min.
const PLUG_S: f64 = 570.2;

fn text(file: &str) -> String {
    std::fs::read_to_string(workspace().join("examples/cold-plug").join(file)).unwrap()
}

fn with_column(text: &str, column: &str) -> String {
    assert!(text.contains("\"swinging_degc\""));
    text.replace("\"swinging_degc\"", &format!("\"{column}\""))
}

fn flushed(text: &str) -> String {
    assert!(text.contains("initial_degc = 15"));
    text.replace("initial_degc = 15", "initial_degc = 60")
}

fn model(text: &str) -> Model {
    Model::from_toml(text, &workspace().join("examples/cold-plug"))
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn simulation(text: &str) -> Simulation {
    Simulation::new(build(&model(text)).unwrap()).unwrap()
}

/// Temperatures of a node at the ends of the steps, degC, by time.
struct Trace {
    times_s: Vec<f64>,
    sf2_degc: Vec<f64>,
    sf4_degc: Vec<f64>,
}

impl Trace {
    fn of(text: &str, until_s: f64, step_s: f64) -> Self {
        let mut simulation = simulation(text);
        let degc = |simulation: &Simulation, node: &str| {
            simulation.get(simulation.channel(node).unwrap()) - 273.15
        };
        let step = Time::from_s(step_s).unwrap();
        let mut trace = Self { times_s: vec![], sf2_degc: vec![], sf4_degc: vec![] };
        while simulation.time().as_s() < until_s {
            let next = simulation.time() + step;
            simulation.advance_to(next, step).unwrap();
            trace.times_s.push(simulation.time().as_s());
            trace.sf2_degc.push(degc(&simulation, "sf2.hot.t_k"));
            trace.sf4_degc.push(degc(&simulation, "sf4.hot.t_k"));
        }
        let balances = Balances::of(&simulation);
        assert!(balances.heat_error() < 1e-6, "{balances:?}");
        trace
    }

    fn sf4_at(&self, time_s: f64) -> f64 {
        self.sf4_degc[self.times_s.iter().position(|t| *t >= time_s).unwrap()]
    }

    fn sf4_between(&self, from_s: f64, to_s: f64) -> impl Iterator<Item = f64> + '_ {
        let rows = self.times_s.iter().zip(&self.sf4_degc);
        rows.filter(move |(t, _)| (from_s..to_s).contains(*t)).map(|(_, degc)| *degc)
    }

    /// First and last time that SF4 is below a temperature, and for how long, s.
    fn below(&self, degc: f64) -> (f64, f64, f64) {
        let rows = || self.times_s.iter().zip(&self.sf4_degc).filter(|(_, t)| **t < degc);
        let times = || rows().map(|(time, _)| *time);
        let (first, last) =
            (times().next().unwrap_or(f64::NAN), times().next_back().unwrap_or(f64::NAN));
        (first, last, times().count() as f64 * (self.times_s[1] - self.times_s[0]))
    }
}

#[test]
fn a_cold_pipe_gives_a_plug() {
    let trace = Trace::of(&text("model.toml"), 2400.0, 1.0);
    // Before SF1 starts.
    assert!(trace.sf4_between(0.0, START_S).all(|degc| (degc - 60.0).abs() < 0.1));
    // 4 l/min of 15 and 4 l/min of 60 degC, at SF2 at once.
    let just_after = trace.times_s.iter().position(|t| *t >= START_S + 2.0).unwrap();
    assert!((trace.sf2_degc[just_after] - 37.5).abs() < 0.7, "{}", trace.sf2_degc[just_after]);
    // At SF4 within a step of 142.5 s.
    let (first, last, below_s) = trace.below(50.0);
    assert!((first - START_S - ARRIVAL_S).abs() <= 1.5, "{first}");
    let in_plug: Vec<f64> =
        trace.sf4_between(first + 2.0, START_S + ARRIVAL_S + PLUG_S - 2.0).collect();
    assert!(in_plug.iter().all(|degc| (degc - 37.5).abs() < 0.7));
    // 570 s of plug, then the rise of SF1: at least 9 min; 3 min after that SF4 is served again.
    let (_, _, cold_s) = trace.below(38.2);
    assert!((cold_s / PLUG_S - 1.0).abs() < 0.05, "{cold_s}");
    assert!(below_s >= 540.0, "{below_s}");
    assert!(trace.sf4_between(last + 180.0, 2400.0).all(|degc| degc > 57.0));
    // Without the swings of SF1: 60 - 20 e^(-t/60) = 50 after 41.6 s, 611.8 s together.
    let smooth = Trace::of(&with_column(&text("model.toml"), "smooth_degc"), 2400.0, 1.0);
    let (_, _, below_s) = smooth.below(50.0);
    assert!((below_s - 611.8).abs() < 3.0, "{below_s}");
}

#[test]
fn flushing_the_pipe_removes_the_plug() {
    // What remains is SF1 itself: 60 - 20 e^(-t/60) is below 55 degC for 60 ln 4 = 83.2 s, at least 40 degC.
    let text = flushed(&text("model.toml"));
    let trace = Trace::of(&with_column(&text, "smooth_degc"), 2400.0, 0.5);
    let (first, _, below_s) = trace.below(55.0);
    assert!((first - START_S - ARRIVAL_S - PLUG_S).abs() < 3.0, "{first}");
    assert!((below_s / 83.2 - 1.0).abs() < 0.1, "{below_s}");
    let least = trace.sf4_degc.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((least - 40.0).abs() < 0.5, "{least}");
    // Hot at once, it is never felt.
    let hot = Trace::of(&with_column(&text, "hot_degc"), 2400.0, 1.0);
    assert!(hot.sf4_degc.iter().all(|degc| *degc >= 55.0));
}

#[test]
fn standstill_cools_the_pipe_into_a_plug() {
    const STANDSTILL_S: f64 = 16_668.0;
    let text = text("real.toml");
    // tau_R = 3.78 * 0.38013 * 4180 = 6006 s: 12 + 48 e^(-16668/6006) = 15.0 degC.
    let mut standing = simulation(&text);
    let degc = |simulation: &Simulation, channel: &str| {
        simulation.get(simulation.channel(channel).unwrap()) - 273.15
    };
    let minute = Time::from_s(60.0).unwrap();
    standing.advance_to(Time::from_s(STANDSTILL_S).unwrap(), minute).unwrap();
    assert!((degc(&standing, "sf1-sf2.hot.t_a_k") - 15.0).abs() < 0.05);
    // With SF1 off for 12 h: 12.04 degC.
    let mut longer = simulation(&text.replace("[16668, 4]", "[50000, 4]"));
    longer.advance_to(Time::from_s(43_200.0).unwrap(), minute).unwrap();
    assert!((degc(&longer, "sf1-sf2.hot.t_a_k") - 12.04).abs() < 0.005);
    // Steps of 2 s up to an hour after the start of SF1, then before, in and behind the plug.
    let trace = Trace::of(&text, STANDSTILL_S + 3000.0, 2.0);
    let before = trace.sf4_at(STANDSTILL_S);
    assert!((before - 57.8).abs() < 0.3, "{before}");
    for degc in trace.sf4_between(STANDSTILL_S + 150.0, STANDSTILL_S + 700.0) {
        assert!((degc - 36.8).abs() < 0.3, "{degc}");
    }
    let after = trace.sf4_at(STANDSTILL_S + 2400.0);
    assert!((after - 56.8).abs() < 0.3, "{after}");
}

/// What is advised, and what it is of the plain flush and of that with more flow of SF2.
fn advice(text: &str) -> (Outcome, Option<Advice>, Option<Advice>) {
    let model = model(text);
    let (before, advice) = advise(&model, &analyse(&model).unwrap()).unwrap();
    let of = |remedy: &str| advice.iter().find(|one| one.remedy == remedy).cloned();
    (before, of("flush"), of("fed_flush"))
}

/// For how long SF4 has cold water, s.
fn cold_s(outcome: &Outcome) -> f64 {
    outcome.cold_s["sf4.station"]
}

#[test]
fn a_flush_is_advised_where_there_is_time_for_it() {
    // Below 55 degC in the plug and while SF1 warms up, 60 ln 4 = 83.2 s.
    let smooth = with_column(&text("model.toml"), "smooth_degc");
    let (before, shared, fed) = advice(&smooth);
    assert!((cold_s(&before) - PLUG_S - 83.2).abs() < 5.0, "{before:?}");
    // SF2 gives 4 l/min more for 38.0 l and a twentieth, 599 s: what remains is SF1 itself, as of a pipe that was hot.
    let fed = fed.unwrap();
    assert!(fed.helps, "{fed:?}");
    let left_s = cold_s(fed.outcome.as_ref().unwrap());
    assert!((left_s / 83.2 - 1.0).abs() < 0.1, "{left_s}");
    // Half of the 4 l/min of SF4 flush 20 l in the 600 s that there are: 18.0 l of plug are left, 270 s.
    let shared = shared.unwrap();
    let left_s = cold_s(shared.outcome.as_ref().unwrap());
    assert!((left_s - PLUG_S * 18.0 / 38.0 - 83.2).abs() < 8.0, "{left_s}");
    assert!(!shared.helps && shared.verdict.starts_with("helps in part"), "{shared:?}");
}

#[test]
fn a_flush_that_comes_too_late_does_not_help() {
    // 60 s at 4 l/min are 4 l of 38: nine tenths of the plug are left.
    let early = text("model.toml").replace("[600, 4]", "[60, 4]");
    let (before, shared, fed) = advice(&with_column(&early, "hot_degc"));
    assert!((cold_s(&before) / PLUG_S - 1.0).abs() < 0.02, "{before:?}");
    for (tried, litres) in [(shared.unwrap(), 2.0), (fed.unwrap(), 4.0)] {
        let left_s = cold_s(tried.outcome.as_ref().unwrap());
        assert!((left_s - PLUG_S * (1.0 - litres / 38.0)).abs() < 8.0, "{left_s}");
        assert!(!tried.helps && tried.verdict.starts_with("does not help"), "{tried:?}");
    }
}

#[test]
fn nothing_is_flushed_where_no_plug_comes() {
    let (before, shared, fed) = advice(&with_column(&flushed(&text("model.toml")), "hot_degc"));
    assert!(before.cold_s.is_empty() && shared.is_none() && fed.is_none());
}
