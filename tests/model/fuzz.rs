//! Damaged model files: the three-house example with random damage, from a fixed seed. Nothing may
//! panic or hang, and whatever is refused says why.
//!
//! `FUZZ_VARIANTS=100000 cargo test -p anergy-tests --test model fuzz::` looks further.

#![allow(clippy::unwrap_used)]

use anergy_core::clock::{NS_PER_S, Time};
use anergy_simulation::build::build;
use anergy_simulation::error::RunError;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::{Random, workspace};
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::mpsc;
use std::time::Duration;

/// Damaged files in a usual run of the tests.
const VARIANTS: usize = 2000;
/// A single variant that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(30);
const SEED: u64 = 2024;

/// Numbers that break things, as they are written in TOML.
const EXTREMES: &[&str] = &[
    "1e308",
    "-1e308",
    "1e-308",
    "1e30",
    "1e-30",
    "-1",
    "0",
    "-0.0",
    "1",
    "0.5",
    "2",
    "1e6",
    "1e-9",
    "9223372036854775807",
    "nan",
    "inf",
    "-inf",
    "0x10",
    "\"0\"",
    "[1]",
    "true",
    "{}",
    "1979-05-27",
];

/// Characters that mean something in TOML, and some that do not.
const CHARACTERS: &[char] = &[
    '"', '\'', '[', ']', '{', '}', '=', '.', ',', '#', '\n', '\\', '-', '_', '0', '9', 'e', 'x',
    ' ', '\t', '\r', '\0', 'ß', '€', '😀',
];

/// Sections to splice in, so that more of the program is reached than the example uses.
const FRAGMENTS: &[&str] = &[
    "[[controller]]\nkind = \"pi\"\nmeasures = \"sf1.feed_in_pump.m_flow_kg_s\"\n\
     acts_on = \"sf1.feed_in_pump.speed\"\nset_point = 0.058\ngain = 0.6\nintegral_time_s = 8\n\
     output_min = 0.1\n",
    "[[edge]]\nid = \"by-pass\"\nkind = \"valve\"\nfrom = \"sf4.hot\"\nto = \"sf4.cold\"\n\
     kvs_m3_h = 1.0\nleakage = 0\nopening = 0.0\n",
    "[[edge]]\nid = \"leak\"\nkind = \"flow_source\"\nfrom = \"sf2.hot\"\nto = \"sf2.cold\"\n\
     v_flow_l_min = 1.5\n",
    "[[edge]]\nid = \"boost\"\nkind = \"pressure_source\"\nfrom = \"sf2.hot\"\nto = \"boost.out\"\n\
     head_bar = 0.1\n[[node]]\nid = \"boost.out\"\n[[edge]]\nid = \"boost.pipe\"\nkind = \"pipe\"\n\
     from = \"boost.out\"\nto = \"sf4.hot\"\npipe = \"dn20\"\nlength_m = 40\n",
    "[[site]]\nid = \"sf5\"\nelevation_m = 12\n[[trench]]\nfrom = \"sf4\"\nto = \"sf5\"\n\
     length_m = 30\npipe = \"dn20\"\n[[station]]\nsite = \"sf5\"\nkind = \"bidirectional\"\n\
     [[unit]]\nsite = \"sf5\"\nkind = \"heat_load\"\nload_kw = 3\nreturn_degc = 30\n",
    "[[site]]\nid = \"works\"\n[[trench]]\nfrom = \"works\"\nto = \"sf2\"\nlength_m = 30\n\
     pipe = \"dn20\"\n[[station]]\nsite = \"works\"\nkind = \"plant\"\ndp_bar = 0.2\n\
     dp_at = \"worst_consumer\"\noutdoor_curve_degc = [[-12, 90], [15, 70]]\n\
     circulation_pump = { head_max_bar = 1, free_flow_l_min = 60 }\n",
    "[[three_way_valve]]\nid = \"mixer\"\na = \"sf1.hot\"\nb = \"sf1.cold\"\nab = \"sf2.hot\"\n\
     kvs_m3_h = 1.0\nopening = 0.5\n",
    "[[four_way_mixer]]\nid = \"four\"\nsource_supply = \"sf1.hot\"\nsource_return = \"sf1.cold\"\n\
     load_supply = \"sf2.hot\"\nload_return = \"sf2.cold\"\nkvs_m3_h = 1.0\nopening = 0.5\n",
    "[station_type.house]\nkind = \"consumer\"\nstub = { pipe = \"dn20\" }\nunit = { kind = \"heat_load\", \
     load_kw = 2, return_degc = 30 }\n[[station]]\nsite = \"sf2\"\nname = \"flat\"\ntype = \"house\"\n",
    "[network]\nnodes = \"nodes.csv\"\npipes = 7\nlines = [\"hot\"]\n",
    "[pipe_type.house]\npipe = \"pre-insulated DN25 series 2\"\ndepth_m = 0.6\n[[edge]]\nid = \"hot\"\n\
     kind = \"pipe\"\nfrom = \"sf1.hot\"\nto = \"sf2.hot\"\nlength_m = 20\npipe = \"house\"\n\
     spacing_m = 0.3\ncompanion = \"cold\"\n[[edge]]\nid = \"cold\"\nkind = \"pipe\"\n\
     from = \"sf1.cold\"\nto = \"sf2.cold\"\nlength_m = 20\npipe = \"PE100 SDR11 40\"\n",
    "[[series]]\nfile = \"nowhere.csv\"\ncolumn = \"x\"\nsignal = \"ground.temperature_k\"\n",
];

fn damaged(original: &str, random: &mut Random) -> String {
    let mut lines: Vec<String> = original.lines().map(str::to_owned).collect();
    for _ in 0..=random.below(3) {
        let at = random.below(lines.len());
        match random.below(8) {
            0 => {
                lines.remove(at);
            }
            1 => lines.insert(random.below(lines.len()), lines[at].clone()),
            2 => {
                let other = random.below(lines.len());
                lines.swap(at, other);
            }
            3 => {
                // A block, so that whole entries disappear or come twice.
                let end = (at + 1 + random.below(12)).min(lines.len());
                let block: Vec<String> = lines[at..end].to_vec();
                if random.below(2) == 0 && lines.len() > block.len() {
                    lines.drain(at..end);
                } else {
                    lines.splice(at..at, block);
                }
            }
            4 => lines[at] = with_character(&lines[at], random),
            5 => lines.extend(random.choose(FRAGMENTS).lines().map(str::to_owned)),
            _ => {
                // Most damage to numbers goes where numbers are.
                let with_numbers: Vec<usize> =
                    (0..lines.len()).filter(|&i| !numbers(&lines[i]).is_empty()).collect();
                if !with_numbers.is_empty() {
                    let at = *random.choose(&with_numbers);
                    lines[at] = with_number(&lines[at], random);
                }
            }
        }
        if lines.is_empty() {
            break;
        }
    }
    lines.join("\n")
}

/// A line with one character replaced, removed or added.
fn with_character(line: &str, random: &mut Random) -> String {
    let mut characters: Vec<char> = line.chars().collect();
    let new = *random.choose(CHARACTERS);
    if characters.is_empty() {
        return new.to_string();
    }
    let at = random.below(characters.len());
    match random.below(3) {
        0 => characters[at] = new,
        1 => characters.insert(at, new),
        _ => {
            characters.remove(at);
        }
    }
    characters.into_iter().collect()
}

/// Where the numbers of a line are: start and end, behind an equals sign or in brackets.
fn numbers(line: &str) -> Vec<(usize, usize)> {
    let code = line.split('#').next().unwrap_or_default();
    let mut found = Vec::new();
    let mut start = None;
    for (at, c) in code.char_indices().chain(std::iter::once((code.len(), ' '))) {
        let inside = c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e');
        match start {
            None if c.is_ascii_digit() || c == '-' => {
                let before = code[..at].chars().next_back();
                if before.is_none_or(|c| matches!(c, ' ' | '=' | '[' | ',')) {
                    start = Some(at);
                }
            }
            Some(from) if !inside => {
                if code[from..at].parse::<f64>().is_ok() {
                    found.push((from, at));
                }
                start = None;
            }
            _ => {}
        }
    }
    found
}

/// A line with one of its numbers replaced by an extreme one or by one of another size.
fn with_number(line: &str, random: &mut Random) -> String {
    let (from, to) = *random.choose(&numbers(line));
    let new = if random.below(2) == 0 {
        (*random.choose(EXTREMES)).to_owned()
    } else {
        let old: f64 = line[from..to].parse().unwrap_or(1.0);
        format!("{:e}", old * 10_f64.powf(random.between(-12.0, 12.0)))
    };
    format!("{}{new}{}", &line[..from], &line[to..])
}

/// What became of a variant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Refused,
    NotSolved,
    Solved,
}

/// Reads, builds, solves and runs a few steps; an empty message is an error of its own.
fn outcome(text: &str, dir: &Path) -> Result<Outcome, String> {
    let model = match Model::from_toml(text, dir).and_then(|model| build(&model).map(|_| model)) {
        Ok(model) => model,
        Err(problems) => {
            let said = problems.0.iter().all(|problem| !problem.message.trim().is_empty());
            let shown = problems.render(text);
            return if said && !problems.0.is_empty() && !shown.trim().is_empty() {
                Ok(Outcome::Refused)
            } else {
                Err(format!("refused without a reason: {shown:?}"))
            };
        }
    };
    let failure = match steady::solve(&model) {
        Ok(steady) => {
            let finite = steady
                .nodes
                .iter()
                .all(|node| node.p_pa.is_finite() && node.t_k.is_finite())
                && steady.edges.iter().all(|e| e.m_flow_kg_s.is_finite() && e.dp_pa.is_finite());
            if !finite {
                return Err("solved with numbers that are not finite".into());
            }
            run(&model).err()
        }
        Err(error) => Some(error),
    };
    match failure {
        None => Ok(Outcome::Solved),
        Some(RunError::Model(_)) => Err("refused while solving, but built before".into()),
        Some(error) if error.to_string().trim().is_empty() => Err("an empty message".into()),
        Some(_) => Ok(Outcome::NotSolved),
    }
}

/// The first three seconds of a run.
fn run(model: &Model) -> Result<(), RunError> {
    let mut simulation = Simulation::new(build(model)?)?;
    simulation.advance_to(Time(3 * NS_PER_S), Time(NS_PER_S))
}

/// What the worker says before and after each variant.
enum News {
    Begins(String),
    Ends(Result<Outcome, String>),
}

#[test]
fn damaged_models_never_panic_or_hang() {
    let folder = workspace().join("examples/three-houses");
    let original = std::fs::read_to_string(folder.join("model.toml")).unwrap();
    let variants =
        std::env::var("FUZZ_VARIANTS").ok().and_then(|n| n.parse().ok()).unwrap_or(VARIANTS);
    let (send, receive) = mpsc::channel();
    let worker = std::thread::spawn(move || {
        let mut random = Random(SEED);
        for _ in 0..variants {
            let text = damaged(&original, &mut random);
            if send.send(News::Begins(text.clone())).is_err() {
                return;
            }
            let result = catch_unwind(AssertUnwindSafe(|| outcome(&text, &folder)));
            let result = result.unwrap_or_else(|panic| {
                let said = panic.downcast_ref::<String>().map(String::as_str);
                Err(format!("panics: {}", said.or(panic.downcast_ref().copied()).unwrap_or("?")))
            });
            if send.send(News::Ends(result)).is_err() {
                return;
            }
        }
    });
    let (mut present, mut failures, mut counts) = (String::new(), Vec::new(), [0_usize; 3]);
    loop {
        match receive.recv_timeout(PATIENCE) {
            Ok(News::Begins(text)) => present = text,
            Ok(News::Ends(Ok(outcome))) => counts[outcome as usize] += 1,
            Ok(News::Ends(Err(problem))) => failures.push((problem, present.clone())),
            Err(mpsc::RecvTimeoutError::Timeout) => panic!("hangs:\n{present}"),
            Err(mpsc::RecvTimeoutError::Disconnected) => break,
        }
    }
    worker.join().unwrap();
    println!("refused, not solved, solved: {counts:?}");
    if let Some((_, text)) = failures.first() {
        let problems: BTreeSet<&str> =
            failures.iter().map(|(problem, _)| problem.as_str()).collect();
        panic!("{} of {variants} variants fail: {problems:#?}; the first:\n{text}", failures.len());
    }
    // The damage is neither too small nor too large to find anything; few sound models have no solution.
    assert!(counts[0] > variants / 50 && counts[2] > variants / 50 && counts[1] > 0, "{counts:?}");
}
