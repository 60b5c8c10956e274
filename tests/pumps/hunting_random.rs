//! Random grids with 2 to 20 flow-controlled feeders: whether the loops are stable by the analysis, and whether
//! a small push grows in simulation. `HUNTING=500` for the whole set.

#![allow(clippy::unwrap_used)]

use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::model_file::{Duration, StepEntry};
use anergy_simulation::simulation::Simulation;
use anergy_simulation::stability::hunting::hunting;
use anergy_tests::Random;
use anergy_tests::pages::write_table;
use std::fmt::Write;
use std::path::Path;

/// Grids in a plain run.
const GRIDS: u64 = 12;
/// A swing this large has grown out of the push, kg/s.
const LARGE_KG_S: f64 = 1e-3;
/// Outside of this band around the limit analysis and simulation must agree.
const BAND: f64 = 0.03;
const AGREE: f64 = 0.99;

/// A tree of sites with feeders and consumers; `gain` scales all controllers, `push` moves the first one.
struct Grid {
    text: String,
    feeders: Vec<Feeder>,
    interval_s: f64,
}

struct Feeder {
    name: String,
    flow_kg_s: f64,
    weight: f64,
    integral_time_s: f64,
}

fn grid(seed: u64) -> Grid {
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9) + 77);
    let n = 2 + random.below(19);
    let sites = 2 + random.below(5);
    // Some sets are of one make, others of many.
    let alike = random.below(3) == 0;
    let interval_s = *random.choose(&[0.0, 0.1, 0.2, 0.5]);
    let mut text = String::from(
        "format = 1\n[run]\nuntil = \"1h\"\nstep = \"STEPs\"\nrecord = \"10s\"\ninitial = \"steady\"\n\
         [fluid]\nkind = \"constant_water\"\ndensity_kg_m3 = 1000\n\
         [pipe_type.p]\ninner_diameter_mm = 40\nroughness_mm = 0.05\ndelta_m = 0.01\n",
    );
    for site in 0..sites {
        let _ = write!(text, "[[site]]\nid = \"s{site}\"\n");
    }
    for site in 1..sites {
        let to = random.below(site);
        let length = random.between(20.0, 200.0);
        let _ = write!(
            text,
            "[[trench]]\nfrom = \"s{site}\"\nto = \"s{to}\"\nlength_m = {length}\npipe = \"p\"\n"
        );
    }
    // A consumer at the root, perhaps more.
    for site in 0..sites {
        if site == 0 || random.below(3) == 0 {
            let kappa = random.between(0.3, 1.0);
            let kvs = if site == 0 { 6.0 } else { 1.5 };
            let _ = write!(
                text,
                "[[station]]\nsite = \"s{site}\"\nname = \"use\"\nkind = \"consumer\"\n\
                 stub = {{ pipe = \"p\", length_m = 5 }}\n\
                 extraction_valve = {{ kvs_m3_h = {kvs}, command = \"kappa\", kappa = {kappa}, delta_m = 0.01 }}\n"
            );
        }
    }
    let mut feeders = Vec::new();
    let common = (
        random.between(4.0, 20.0),
        random.between(5.0, 30.0),
        random.between(0.3, 3.0),
        random.between(0.0, 2.0),
    );
    for i in 0..n {
        let site = random.below(sites);
        let own = (
            random.between(4.0, 20.0),
            random.between(5.0, 30.0),
            random.between(0.3, 3.0),
            random.between(0.0, 2.0),
        );
        let (rise, integral_time_s, lag, dead) = if alike { common } else { own };
        let head = random.between(300.0, 600.0);
        let free = random.between(30.0, 90.0);
        let name = format!("f{i}");
        let _ = write!(
            text,
            "[[station]]\nsite = \"s{site}\"\nname = \"{name}\"\nkind = \"producer\"\n\
             stub = {{ pipe = \"p\", length_m = 5 }}\nheat_exchanger = {{ delta_m = 0.01 }}\n\
             feed_in_pump = {{ head_max_hpa = {head}, free_flow_l_min = {free}, rise_time_s = {rise}, delta_m = 0.001 }}\n\
             feed_in_check_valve = {{ kvs_m3_h = 20, leakage = 1e-3, delta_m = 0.01 }}\n\
             [[sensor]]\nid = \"m{i}\"\nmeasures = \"s{site}.{name}.feed_in_pump.m_flow_kg_s\"\n\
             time_constant_s = {lag}\ndead_time_s = {dead}\n"
        );
        feeders.push(Feeder {
            name: format!("s{site}.{name}"),
            flow_kg_s: random.between(1.5, 4.0) / 60.0,
            weight: if alike { 1.0 } else { random.between(0.3, 1.5) },
            integral_time_s,
        });
    }
    text.push_str("[pressure_reference]\nnode = \"s0.cold\"\n");
    Grid { text, feeders, interval_s }
}

impl Grid {
    fn model(&self, gain: f64, push: f64) -> Model {
        // Short enough that sensors see flows as they are between two samples.
        let step_s = 0.1;
        let mut text = self.text.replace("STEP", &step_s.to_string());
        for (i, feeder) in self.feeders.iter().enumerate() {
            let Feeder { name, flow_kg_s, weight, integral_time_s } = feeder;
            let _ = write!(
                text,
                "[[controller]]\nid = \"c{i}\"\nkind = \"pi\"\nmeasures = \"m{i}.value\"\n\
                 acts_on = \"{name}.feed_in_pump.speed\"\nset_point = {flow_kg_s}\ngain = {}\n\
                 integral_time_s = {integral_time_s}\ninterval_s = {}\n",
                gain * weight,
                self.interval_s
            );
        }
        // Each feeder is pushed by another part of it: one mode or the other is met.
        for (i, feeder) in self.feeders.iter().enumerate() {
            let part = push * (1.0 + (2.4 * i as f64).sin());
            let _ = write!(
                text,
                "[[schedule]]\nsignal = \"c{i}.set_point\"\ninterpolation = \"hold\"\n\
                 points = [[0, {0}], [10, {1}]]\n",
                feeder.flow_kg_s,
                feeder.flow_kg_s * (1.0 + part)
            );
        }
        Model::from_toml(&text, Path::new(".")).unwrap()
    }

    /// Whether a small push grows within a time that a mode of this growth takes to prevail.
    fn grows(&self, gain: f64, period_s: f64, growth_per_s: f64) -> bool {
        let model = self.model(gain, 1e-4);
        let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
        let flows: Vec<_> = self
            .feeders
            .iter()
            .map(|f| simulation.channel(&format!("{}.feed_in_pump.m_flow_kg_s", f.name)).unwrap())
            .collect();
        let StepEntry::Fixed(Duration(step)) = model.run.step else { panic!("automatic") };
        let half = ((0.5 * period_s / step.as_s()).round() as usize).max(1);
        let periods = |n: f64| (n * period_s / step.as_s()) as usize;
        let longest = (12.0 / (growth_per_s.abs() * period_s)).clamp(60.0, 1000.0);
        let (skip, window, pause) = (periods(8.0), periods(4.0), periods(longest));
        let mut series: Vec<Vec<f64>> = vec![Vec::new(); flows.len()];
        for _ in 0..skip + pause + 2 * window + half {
            let end = simulation.time() + step;
            simulation.advance_to(end, step).unwrap();
            series
                .iter_mut()
                .zip(&flows)
                .for_each(|(series, flow)| series.push(simulation.get(*flow)));
        }
        // Half a period apart: what drifts slowly cancels.
        let size = |from: usize| {
            let moved = |series: &Vec<f64>| {
                (from..from + window)
                    .map(|i| (series[i + half] - series[i]).abs())
                    .fold(0.0, f64::max)
            };
            series.iter().map(moved).fold(0.0, f64::max)
        };
        // What has reached its limit cycle grows no more.
        let late = size(skip + pause + window);
        late > size(skip) || late > LARGE_KG_S
    }
}

#[test]
fn analysis_and_simulation_agree_on_what_grows() {
    let grids = std::env::var("HUNTING").ok().and_then(|n| n.parse().ok()).unwrap_or(GRIDS);
    let (mut judged, mut disagree, mut unsolved, mut within) = (0_u32, Vec::new(), 0, 0);
    for seed in 0..grids {
        let grid = grid(seed);
        let mut simulation = match Simulation::new(build(&grid.model(1.0, 0.0)).unwrap()) {
            Ok(simulation) => simulation,
            Err(error) => {
                println!("seed {seed}, {} feeders: {error}", grid.feeders.len());
                unsolved += 1;
                continue;
            }
        };
        let found = hunting(&mut simulation).unwrap();
        let critical: Vec<f64> = found
            .controllers
            .iter()
            .filter_map(|c| c.critical_gain.map(|critical| critical / c.gain))
            .collect();
        // Feeders that cannot deliver what is wanted have open loops; the others are still judged.
        let Some(limit) = critical.iter().copied().reduce(f64::min) else {
            unsolved += 1;
            continue;
        };
        let period_s =
            found.controllers.iter().filter_map(|c| c.critical_period_s).fold(0.0, f64::max);
        let mut random = Random(seed + 5);
        let factor = 2.0_f64.powf(random.between(-1.0, 1.0));
        if (factor - 1.0).abs() < BAND {
            within += 1;
            continue;
        }
        judged += 1;
        let gain = limit * factor;
        let mut simulation = Simulation::new(build(&grid.model(gain, 0.0)).unwrap()).unwrap();
        let found = hunting(&mut simulation).unwrap();
        let stable = found.controllers.iter().all(|c| c.stable);
        let growth_per_s = found.modes.first().map_or(f64::NAN, |mode| mode.growth_per_s);
        // A continuous controller is sampled at 0.1 s in the run: later by half of it.
        let grows = grid.grows(gain, period_s, growth_per_s);
        if stable != (factor < 1.0) || grows == stable {
            disagree.push(format!(
                "seed {seed}: {} feeders, gain {factor:.3} of the limit, interval {} s: {} by analysis ({growth_per_s:.5} 1/s, period {period_s:.1} s), push {}",
                grid.feeders.len(),
                grid.interval_s,
                if stable { "stable" } else { "growing" },
                if grows { "grows" } else { "decays" },
            ));
        }
    }
    let share = 1.0 - disagree.len() as f64 / f64::from(judged);
    let table = format!(
        "| | grids |\n|---|---|\n| judged | {judged} |\n\
         | analysis and simulation agree | {} ({:.1} %) |\n\
         | within {:.0} % of the limit, not judged | {within} |\n\
         | without an operating point or a limit | {unsolved} |\n",
        judged as usize - disagree.len(),
        100.0 * share,
        100.0 * BAND
    );
    if grids >= 500 {
        let command = "HUNTING=500 cargo test --workspace --test pumps hunting_random::";
        write_table("hunting", "random grids", command, &table);
    } else {
        println!("{table}");
    }
    disagree.iter().for_each(|line| println!("{line}"));
    assert!(judged * 2 > u32::try_from(grids).unwrap(), "too few grids could be judged");
    assert!(share >= AGREE, "{disagree:#?}");
}
