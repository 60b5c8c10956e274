//! Weighted PI control of bidirectional stations: the 36 published cases (`licklederer2024`).
//!
//! Every second of the last ten minutes of each slot the weighted errors are worked out from the present
//! temperatures and heats. A loop whose mean error is below 0.01 is in equilibrium; one that is not is at a
//! limit, hunts, belongs to a station that is blocked, or still creeps towards its equilibrium.
//!
//! A sample runs here; with `WEIGHTED_PI=all` (`make validate`) all 36 run, and with `TABLE_DATE` they are written
//! to `docs/src/validation/weighted-pi.md`.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::prosnet::{Case, SET_KW, SLOT_S, SLOTS_S, WANTED};
use anergy_tests::workspace;
use std::fmt::Write as _;

/// A weighted error below this is an equilibrium.
const EQUILIBRIUM: f64 = 0.01;
/// Over this time at the end of a slot, s.
const WINDOW_S: f64 = 600.0;
/// A station hunts where its heat moves by more than this share of the set value within the window,
const HUNTS: f64 = 0.05;
/// and goes up and down through the middle of its range this often: a passing front does not.
const CROSSINGS: usize = 6;
/// A gain of the pump that stands a shared network.
const SAFE_GAIN: f64 = 0.03;
/// Step that follows the published gains, s: a pump that rises in 8 s, a gain that takes it from end to end.
const FINE_STEP_S: f64 = 0.25;

/// The end of a slot at one station.
#[derive(Debug, Clone)]
struct End {
    case: String,
    slot: usize,
    station: usize,
    /// Mean errors: heat, kW, then the temperature of the primary and of the secondary objective, K.
    heat_kw: f64,
    sides_k: [f64; 2],
    /// Mean weighted errors of the primary and secondary loop.
    weighted: [f64; 2],
    /// Whether the loops' outputs are at a limit: smallest -1, largest 1.
    limit: [i8; 2],
    /// Peak to peak of the heat, kW, and of the primary command.
    swing_kw: f64,
    crossings: usize,
    swing_command: f64,
}

/// How a loop ends a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Loop {
    Equilibrium,
    AtLimit,
    Hunting,
    Blocked,
    Creeping,
}

impl End {
    fn set_kw(&self) -> f64 {
        SET_KW[self.station][self.slot]
    }

    fn hunts(&self) -> bool {
        self.swing_kw > HUNTS * self.set_kw().abs() && self.crossings >= CROSSINGS
    }

    /// A feeder that delivers less than half of what it is to.
    fn blocked(&self) -> bool {
        self.set_kw() > 0.0 && self.set_kw() - self.heat_kw < 0.5 * self.set_kw()
    }

    /// The state of the primary (0) or secondary (1) loop.
    fn state(&self, side: usize) -> Loop {
        if self.blocked() {
            Loop::Blocked
        } else if self.hunts() {
            Loop::Hunting
        } else if self.limit[side] != 0 {
            Loop::AtLimit
        } else if self.weighted[side].abs() < EQUILIBRIUM {
            Loop::Equilibrium
        } else {
            Loop::Creeping
        }
    }
}

/// What a case gives.
struct Outcome {
    ends: Vec<End>,
    /// Heat that is not accounted for over all that is moved.
    unaccounted: f64,
    mass_kg_s: f64,
}

#[derive(Default)]
struct Window {
    samples: f64,
    sums: [f64; 5],
    heat_kw: Vec<f64>,
    command: Option<(f64, f64)>,
    at: [[f64; 2]; 2],
}

fn widen(range: &mut Option<(f64, f64)>, value: f64) {
    let (low, high) = range.unwrap_or((value, value));
    *range = Some((low.min(value), high.max(value)));
}

fn run(case: &Case, slots: usize) -> Outcome {
    let text = case.text();
    let model =
        Model::from_toml(&text, &workspace()).unwrap_or_else(|p| panic!("{}", p.render(&text)));
    let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
    let step = Time::from_s(case.step_s).unwrap();
    let mut ends = Vec::new();
    for (slot, start_s) in SLOTS_S.iter().enumerate().take(slots) {
        let end_s = start_s + SLOT_S;
        simulation.advance_to(Time::from_s(end_s - WINDOW_S).unwrap(), step).unwrap();
        let mut windows: [Window; 3] = Default::default();
        while simulation.time() < Time::from_s(end_s).unwrap() {
            let next = simulation.time() + Time::from_s(1.0).unwrap();
            simulation.advance_to(next, step).unwrap();
            for (station, window) in windows.iter_mut().enumerate() {
                sample(case, &simulation, slot, station, window);
            }
        }
        for (station, window) in windows.iter().enumerate() {
            let mean = |k: usize| window.sums[k] / window.samples;
            let share = |k: usize, at: usize| window.at[k][at] / window.samples > 0.9;
            let limit = |k: usize| i8::from(share(k, 1)) - i8::from(share(k, 0));
            let width = |range: Option<(f64, f64)>| range.map_or(0.0, |(low, high)| high - low);
            let heat = &window.heat_kw;
            let low = heat.iter().copied().fold(f64::INFINITY, f64::min);
            let high = heat.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let above: Vec<bool> = heat.iter().map(|q| *q > 0.5 * (low + high)).collect();
            ends.push(End {
                case: case.name(),
                slot,
                station,
                heat_kw: mean(0),
                sides_k: [mean(1), mean(2)],
                weighted: [mean(3), mean(4)],
                limit: [limit(0), limit(1)],
                swing_kw: high - low,
                crossings: above.windows(2).filter(|pair| pair[0] != pair[1]).count(),
                swing_command: width(window.command),
            });
        }
    }
    let balances = Balances::of(&simulation);
    Outcome { ends, unaccounted: balances.heat_error(), mass_kg_s: balances.mass_residual_kg_s }
}

/// Errors by the equations of the publication, from what is recorded.
fn sample(case: &Case, simulation: &Simulation, slot: usize, station: usize, window: &mut Window) {
    let site = format!("b{}", station + 1);
    let get = |name: &str| {
        let name = format!("{site}.{name}");
        simulation.get(simulation.channel(&name).unwrap_or_else(|_| panic!("{name}")))
    };
    let set_kw = SET_KW[station][slot];
    let feeds_in = set_kw > 0.0;
    let q_kw = get("station.q_flow_w") / 1000.0;
    let (hot_1, cold_1) = (get("exchanger_hot.t_k"), get("branch_cold.t_k"));
    let (hot_2, cold_2) = (get("unit.t_hot_k"), get("unit.t_cold_k"));
    let heat = set_kw.abs() - q_kw * set_kw.signum();
    let mode = usize::from(!feeds_in);
    let sides = if feeds_in {
        [WANTED[0] + 273.15 - hot_1, WANTED[3] - (hot_2 - cold_2)]
    } else {
        [WANTED[2] - (hot_1 - cold_1), WANTED[1] + 273.15 - hot_2]
    };
    let alpha = case.alpha()[mode];
    let across = case.crossover()[mode];
    let weighted = [0, 1].map(|side: usize| {
        let temperature = if across { sides[1 - side] } else { -sides[side] };
        alpha[side] * heat + (1.0 - alpha[side]) * temperature / 3.0
    });
    let primary = if feeds_in {
        get("feed_in_pump.speed_command")
    } else {
        get("extraction_valve.kappa_command")
    };
    let secondary_l_min = get("unit.v_flow_m3_s_command").abs() * 60_000.0;
    window.samples += 1.0;
    for (sum, value) in
        window.sums.iter_mut().zip([heat, sides[0], sides[1], weighted[0], weighted[1]])
    {
        *sum += value;
    }
    for (k, (value, low, high)) in
        [(primary, 0.25, 1.0), (secondary_l_min, 2.0, 8.5)].into_iter().enumerate()
    {
        window.at[k][0] += f64::from(u8::from(value <= low + 1e-6));
        window.at[k][1] += f64::from(u8::from(value >= high - 1e-6));
    }
    window.heat_kw.push(q_kw);
    widen(&mut window.command, primary);
}

/// Runs cases side by side.
fn run_all(cases: &[Case], slots: usize) -> Vec<Outcome> {
    std::thread::scope(|scope| {
        let half = cases.len().div_ceil(2).max(1);
        let parts: Vec<_> = cases
            .chunks(half)
            .map(|part| {
                scope.spawn(move || part.iter().map(|case| run(case, slots)).collect::<Vec<_>>())
            })
            .collect();
        parts.into_iter().flat_map(|part| part.join().unwrap()).collect()
    })
}

fn safe(case: Case) -> Case {
    Case { pump_gain: SAFE_GAIN, ..case }
}

fn balances_close(case: &Case, outcome: &Outcome) {
    assert!(outcome.unaccounted < 1e-9, "{}: heat {:e}", case.name(), outcome.unaccounted);
    assert!(outcome.mass_kg_s < 1e-12, "{}: mass {:e}", case.name(), outcome.mass_kg_s);
}

#[test]
fn with_a_small_gain_of_the_pump_the_loops_end_in_their_equilibrium() {
    let cases = [('B', 2, 'b'), ('C', 1, 'c'), ('A', 1, 'b')];
    let cases =
        cases.map(|(pairing, network, weights)| safe(Case::published(pairing, network, weights)));
    for (case, outcome) in cases.iter().zip(run_all(&cases, 7)) {
        balances_close(case, &outcome);
        for end in &outcome.ends {
            assert!(!end.hunts() && !end.blocked(), "{end:?}");
            for side in 0..2 {
                // In crossover the difference of the secondary hardly answers to the pump once the primary
                // flow is above the secondary one: the pump creeps.
                let bound = if case.pairing == 'A' && side == 0 { 0.04 } else { EQUILIBRIUM };
                let rest = end.limit[side] != 0 || end.weighted[side].abs() < bound;
                assert!(rest || case.pairing == 'A' && end.weighted[side].abs() < 0.06, "{end:?}");
            }
        }
        let count = outcome.ends.iter().flat_map(|end| [end.state(0), end.state(1)]);
        let resting = count.filter(|state| *state == Loop::Equilibrium).count();
        assert!(resting > 20, "{}: {resting} loops in equilibrium", case.name());
    }
}

#[test]
fn with_the_published_gain_the_pumps_hunt() {
    let case = Case { step_s: FINE_STEP_S, ..Case::published('A', 1, 'b') };
    let outcome = run(&case, 1);
    balances_close(&case, &outcome);
    // Two feeders, 4 and 6 kW: the pumps go from limit to limit, the consumer sees little of it.
    for end in outcome.ends.iter().filter(|end| end.set_kw() > 0.0) {
        assert!(end.swing_kw > 1.0 && end.swing_command > 0.7, "{end:?}");
    }
    let consumer = outcome.ends.iter().find(|end| end.set_kw() < 0.0).unwrap();
    assert!(consumer.swing_kw < 0.5, "{consumer:?}");
}

fn flags(end: &End) -> String {
    let mut flags: Vec<String> = Vec::new();
    for (limit, word) in [(end.limit[0], ["u", "kappa"]), (end.limit[1], ["V", "V"])] {
        let word = word[usize::from(end.set_kw() < 0.0)];
        match limit {
            -1 => flags.push(format!("{word} min")),
            1 => flags.push(format!("{word} max")),
            _ => {}
        }
    }
    if end.hunts() {
        flags.push(format!("hunts {:.1} kW", end.swing_kw));
    }
    if end.blocked() {
        flags.push("blocked".to_owned());
    }
    flags.join(", ")
}

fn row(ends: &[End]) -> String {
    let cells = |of: &dyn Fn(&End) -> String| ends.iter().map(of).collect::<Vec<_>>().join(" / ");
    // High priority: the temperature of the hot side that the mode cares for; low: the difference.
    let hot = |end: &End| end.sides_k[usize::from(end.set_kw() < 0.0)];
    let difference = |end: &End| end.sides_k[usize::from(end.set_kw() > 0.0)];
    format!(
        "| {} | {} | {} | {} | {} | {} | {} | {} | {} |",
        ends[0].case,
        ends[0].slot + 1,
        cells(&|end| format!("{:+.0}", end.set_kw())),
        cells(&|end| format!("{:+.2}", end.heat_kw)),
        cells(&|end| format!("{:+.1}", hot(end))),
        cells(&|end| format!("{:+.1}", difference(end))),
        cells(&|end| format!("{:+.3}", end.weighted[0])),
        cells(&|end| format!("{:+.3}", end.weighted[1])),
        cells(&|end| {
            let flags = flags(end);
            if flags.is_empty() { "-".into() } else { flags }
        }),
    )
}

const HEAD: &str = "| case | slot | set kW | error of Q, kW | error of the hot side, K | error of the difference, K | e primary | e secondary | flags |\n|---|---|---|---|---|---|---|---|---|\n";

/// Counts of the loops of a case by how they end their slots, and the largest error of one that creeps.
fn summary(outcome: &Outcome) -> String {
    let states: Vec<(Loop, f64)> = outcome
        .ends
        .iter()
        .flat_map(|end| [0, 1].map(|side| (end.state(side), end.weighted[side].abs())))
        .collect();
    let count = |wanted: Loop| states.iter().filter(|(state, _)| *state == wanted).count();
    let creeping = states.iter().filter(|(state, _)| *state == Loop::Creeping);
    let worst = creeping.map(|(_, error)| *error).fold(0.0, f64::max);
    let heat =
        outcome.ends.iter().map(|end| end.heat_kw.abs()).sum::<f64>() / outcome.ends.len() as f64;
    format!(
        "{} | {} | {} | {} | {} | {worst:.3} | {heat:.2}",
        count(Loop::Equilibrium),
        count(Loop::AtLimit),
        count(Loop::Hunting),
        count(Loop::Blocked),
        count(Loop::Creeping),
    )
}

#[test]
fn all_published_cases() {
    if std::env::var_os("WEIGHTED_PI").is_none() {
        return;
    }
    let published: Vec<Case> =
        Case::all().into_iter().map(|case| Case { step_s: FINE_STEP_S, ..case }).collect();
    let halved: Vec<Case> = published.iter().map(|case| Case { halved: true, ..*case }).collect();
    let small: Vec<Case> = published.iter().copied().map(safe).collect();
    let mut overview = String::new();
    let mut tables = String::new();
    for (title, cases, whole) in [
        ("Published gains", &published, true),
        (
            "Published gains, halves of the station's pipe with half the diameter (11 mm)",
            &halved,
            false,
        ),
        ("Gain of the pump 0.03", &small, true),
    ] {
        let outcomes = run_all(cases, 7);
        let _ = write!(
            overview,
            "\n### {title}\n| case | equilibrium | at a limit | hunting | blocked | creeping | largest e of these | mean error of Q, kW |\n|---|---|---|---|---|---|---|---|\n"
        );
        if whole {
            let _ = write!(tables, "\n## {title}: every slot\n{HEAD}");
        }
        for (case, outcome) in cases.iter().zip(&outcomes) {
            balances_close(case, outcome);
            let _ = writeln!(overview, "| {} | {} |", case.name(), summary(outcome));
            if whole {
                for slot in outcome.ends.chunks(3) {
                    let _ = writeln!(tables, "{}", row(slot));
                }
            }
        }
    }
    println!("{overview}");
    if let Ok(date) = std::env::var("TABLE_DATE") {
        let file = workspace().join("docs/src/validation/weighted-pi.md");
        let text = std::fs::read_to_string(&file).unwrap();
        let start = text.find("## Overview").unwrap();
        let command = "`WEIGHTED_PI=all cargo test --release -p anergy-tests --test pumps weighted_pi::` (`make validate`)";
        let text = format!(
            "{}## Overview\n{command}, {date}. Loops by how they end their slots, of 42 (7 slots, 3 stations, 2 loops).\n{overview}{tables}",
            &text[..start]
        );
        std::fs::write(&file, text).unwrap();
    }
}
