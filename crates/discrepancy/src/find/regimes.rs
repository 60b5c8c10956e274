//! What the plant was doing at every sample, by measured signals.

use crate::data::Track;
use crate::experiment::Experiment;
use crate::uncertainty::interval_s;

/// A flow below this share of its largest is none.
const OFF: f64 = 0.02;
/// After a start or before a stop, as many intervals of the readings, and at least so long, s.
const AROUND: (f64, f64) = (6.0, 120.0);
/// Colder than this outside is cold, K.
const COLD_K: f64 = 278.15;
/// A reading changes where its rate is more than this share of the largest one of its sensor in the run.
const CHANGING: f64 = 0.05;
/// A command that moves by this share of its range is switched.
const SWITCHED: f64 = 0.5;

/// A state of the plant, or of a sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct Regime {
    /// What it is called.
    pub name: String,
    /// Whether each sample was read in it.
    pub holds: Vec<bool>,
}

/// All regimes that occur.
pub fn regimes(experiment: &Experiment) -> Vec<Regime> {
    let mut all = Vec::new();
    let changing = changing(experiment);
    let steady = changing.iter().map(|c| !c).collect();
    all.push(Regime { name: "changing".into(), holds: changing });
    all.push(Regime { name: "steady".into(), holds: steady });
    for (k, sensor) in experiment.sensors.sensor.iter().enumerate() {
        let (si, column) = (sensor.si(), &sensor.column);
        match si.as_str() {
            "kg_s" | "m3_s" => of_flow(experiment, k, column, &mut all),
            "w" => terciles(experiment, k, column, &mut all),
            "k" if sensor.signal.contains("outdoor") => {
                let name = format!("{column} cold");
                all.push(Regime {
                    name,
                    holds: each(experiment, |run, t| reading(experiment, run, k, t) < COLD_K),
                });
            }
            "1" => of_command(experiment, k, column, &mut all),
            _ => {}
        }
    }
    all.retain(|regime| {
        let count = regime.holds.iter().filter(|h| **h).count();
        count > 0 && count < regime.holds.len()
    });
    all
}

fn reading(experiment: &Experiment, run: usize, sensor: usize, time_s: f64) -> f64 {
    experiment.runs[run].tracks[sensor].at(time_s)
}

fn each(experiment: &Experiment, holds: impl Fn(usize, f64) -> bool) -> Vec<bool> {
    experiment.samples.iter().map(|sample| holds(sample.run, sample.time_s)).collect()
}

/// Of every run the time that counts as shortly before or after, s.
fn around_s(experiment: &Experiment, sensor: usize) -> Vec<f64> {
    let of = |tracks: &[Track]| (AROUND.0 * interval_s(&tracks[sensor])).max(AROUND.1);
    experiment.runs.iter().map(|run| of(&run.tracks)).collect()
}

fn of_flow(experiment: &Experiment, k: usize, column: &str, all: &mut Vec<Regime>) {
    let values = || experiment.runs.iter().flat_map(|run| run.tracks[k].value.iter());
    let least = OFF * values().fold(0.0_f64, |most, y| most.max(y.abs()));
    let flow = |run: usize, t: f64| reading(experiment, run, k, t);
    let around_s = around_s(experiment, k);
    let off = |run: usize, t: f64| flow(run, t).abs() < least;
    let mut add =
        |name: &str, holds: Vec<bool>| all.push(Regime { name: format!("{column} {name}"), holds });
    add("off", each(experiment, off));
    // Some moment of the time before, or after, without flow.
    let near = |run: usize, t: f64, sign: f64| {
        !off(run, t) && (1..=12).any(|i| off(run, t + sign * around_s[run] * f64::from(i) / 12.0))
    };
    add("starting", each(experiment, |run, t| near(run, t, -1.0)));
    add("stopping", each(experiment, |run, t| near(run, t, 1.0)));
    add("reversed", each(experiment, |run, t| flow(run, t) < -least));
    terciles(experiment, k, column, all);
}

/// Low, middle and high thirds of what a sensor reads while it reads something.
fn terciles(experiment: &Experiment, k: usize, column: &str, all: &mut Vec<Regime>) {
    let mut sizes: Vec<f64> = experiment
        .runs
        .iter()
        .flat_map(|run| run.tracks[k].value.iter().map(|y| y.abs()))
        .collect();
    let most = sizes.iter().copied().fold(0.0, f64::max);
    sizes.retain(|y| *y > OFF * most);
    sizes.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (sizes.first(), sizes.last()) else { return };
    // What hardly changes has no thirds.
    if last - first < 0.1 * last {
        return;
    }
    let (low, high) = (sizes[sizes.len() / 3], sizes[2 * sizes.len() / 3]);
    let size = |run: usize, t: f64| reading(experiment, run, k, t).abs();
    for (name, from, until) in
        [("low", OFF * most, low), ("middle", low, high), ("high", high, f64::INFINITY)]
    {
        let holds = each(experiment, |run, t| (from..until).contains(&size(run, t)));
        all.push(Regime { name: format!("{column} {name}"), holds });
    }
}

fn of_command(experiment: &Experiment, k: usize, column: &str, all: &mut Vec<Regime>) {
    let values = || experiment.runs.iter().flat_map(|run| run.tracks[k].value.iter().copied());
    let (low, high) =
        (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    if high - low < 1e-9 {
        return;
    }
    let share = |run: usize, t: f64| (reading(experiment, run, k, t) - low) / (high - low);
    let around_s = around_s(experiment, k);
    let switched =
        |run: usize, t: f64| (share(run, t) - share(run, t - around_s[run])).abs() > SWITCHED;
    let mut add = |name: &str, holds| all.push(Regime { name: format!("{column} {name}"), holds });
    add("switched", each(experiment, switched));
    add("at its upper end", each(experiment, |run, t| share(run, t) > 0.99));
    add("at its lower end", each(experiment, |run, t| share(run, t) < 0.01));
}

/// Whether each sample is read while its quantity changes.
pub(crate) fn changing(experiment: &Experiment) -> Vec<bool> {
    let samples = &experiment.samples;
    let rate = |i: usize| -> f64 {
        let sample = &samples[i];
        let same =
            |j: usize| samples.get(j).filter(|s| (s.run, s.sensor) == (sample.run, sample.sensor));
        let before = i.checked_sub(1).and_then(same).unwrap_or(sample);
        let after = same(i + 1).unwrap_or(sample);
        let dt = after.time_s - before.time_s;
        if dt > 0.0 { (after.value - before.value).abs() / dt } else { 0.0 }
    };
    let rates: Vec<f64> = (0..samples.len()).map(rate).collect();
    let mut largest = std::collections::HashMap::new();
    for (sample, rate) in samples.iter().zip(&rates) {
        let of: &mut f64 = largest.entry((sample.run, sample.sensor)).or_default();
        *of = of.max(*rate);
    }
    let own = samples.iter().zip(&rates);
    own.map(|(sample, rate)| *rate > CHANGING * largest[&(sample.run, sample.sensor)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench;

    #[test]
    fn regimes_of_the_bench_by_hand() {
        let experiment = bench::experiment(&[]);
        let all = regimes(&experiment);
        let times = |name: &str| -> Vec<f64> {
            let regime = all.iter().find(|r| r.name == name).unwrap();
            let own = experiment.samples.iter().zip(&regime.holds);
            own.filter(|(s, holds)| **holds && s.sensor == 2).map(|(s, _)| s.time_s).collect()
        };
        let span = |name: &str| {
            let times = times(name);
            (times[0], times[times.len() - 1], times.len())
        };
        // Nothing flows from 3490 s on; a stop is 6 intervals, at least 120 s, before.
        assert_eq!(span("flow off"), (3490.0, 3600.0, 12));
        assert_eq!(span("flow stopping"), (3370.0, 3480.0, 12));
        assert!(all.iter().all(|r| r.name != "flow starting" && r.name != "flow reversed"));
        // 0.1 kg/s from 1810 to 2700 s is the lowest third.
        let low = times("flow low");
        assert!(low.iter().all(|t| (1800.0..=2710.0).contains(t)) && low.len() >= 90, "{low:?}");
        // The front of 1800 to 1920 s has passed the first pipe (11.6 l, 0.1 kg/s) 115 s later.
        let changing = times("changing");
        assert!((1940..2020).step_by(10).all(|t| changing.contains(&f64::from(t))), "{changing:?}");
        assert!(!changing.iter().any(|t| (600.0..1700.0).contains(t)), "{changing:?}");
        let steady = times("steady");
        assert_eq!(changing.len() + steady.len(), 361);
    }
}
