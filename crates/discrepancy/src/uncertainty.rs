//! How far a reading may lie from the right model: sigma of every sample.
//!
//! **Equation** `sigma^2 = noise^2 + lsb^2/12 + (jitter dy/dt)^2 + sigma_num^2 + sigma_in^2 + sigma_0^2`. `sigma_num` is the
//! difference to half the step, and what storages of three times as many layers show of the error of the grid. `sigma_in` is what noise, resolution and jitter of the measured inputs, and what they did in
//! their gaps, make of the reading: the mean square over `DRAWS` simulations with inputs drawn anew (the Monte Carlo method
//! of GUM supplement 1; between two readings nearly as far from the straight line as those beside it are from theirs; commands and flows
//! read late by a lag that nobody knows), and at least what their noise alone makes of it in as many, and what commands that
//! are switched as early or as late as they may be make of it, over root 3; smoothed over neighbouring samples. `sigma_0` is what the temperature of the water at
//! the start makes of it, by as much as the first readings differ beyond what the sensors' classes allow (their middle is an
//! unknown of the fit).
//!
//! **Assumptions** what an input does in a gap is a bridge between the readings at its ends; its middle is as uncertain as half of
//! the change that the input usually makes in such a time, and a third of the one it made. One that is off at one end and on at the other
//! was switched at any moment of it.
//!
//! All of these are simulated with the effects that were fitted: they carry on what inputs leave open.
//! Offsets and gains of sensors are not in sigma: they are the same in all samples, and fitted.

use crate::catalogue::LAG_S;
use crate::data::Track;
use crate::experiment::{Experiment, Sample, Simulated};
use crate::grid;
use crate::sensors::{Role, Sensor};
use crate::unknown::{Target, Unknown};
use anergy_core::cores::on_all_cores;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg32;

/// Simulations with inputs drawn anew.
const DRAWS: usize = 12;
/// Samples before and after, over which what they show is smoothed.
const BESIDE: usize = 1;
/// An interval so many times the usual one is a gap.
const GAP: f64 = 2.5;
/// ... and one so many times is a pause of a sensor that reads now and then.
const PAUSE: f64 = 8.0;
/// The earliest and the latest moment of a switch, from the middle between two readings, over their interval.
const LATEST: f64 = 0.45;
/// Seed of the first draw: the same data, the same answer.
const SEED: u64 = 0x5eed;
/// Least and largest jitter, s, the largest that of a moment anywhere within a second before and after; between them it is equally
/// distributed over an interval of the readings.
const JITTER_S: (f64, f64) = (0.5, 0.577);
/// A reading that is further than this share of a change from either end of it was taken on its way.
const PASSES: f64 = 0.1;
/// What lies between two readings over how far they lie from the line between their neighbours: of a flow, which changes in
/// steps, and of a temperature, which is known better (with ramps of 30 to 80 s 0.10 to 0.17 of it, at a reading every 10 to 30 s).
const BENT: (f64, f64) = (0.4, 0.15);

/// Usual interval of the readings of a track, s.
pub(crate) fn interval_s(track: &Track) -> f64 {
    let mut steps: Vec<f64> = track.time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(1.0)
}

/// A sensor that does not read for so long, s, pauses: its block of time ends, and its curve.
pub(crate) fn pause_s(track: &Track) -> f64 {
    PAUSE * interval_s(track)
}

/// Standard deviation of the moment at which a reading was taken, s.
pub(crate) fn jitter_s(track: &Track) -> f64 {
    (interval_s(track) / 12.0_f64.sqrt()).clamp(JITTER_S.0, JITTER_S.1)
}

/// Standard deviations of all samples, SI.
#[derive(Debug, Clone)]
pub struct Uncertainties {
    /// In all.
    pub sigma: Vec<f64>,
    /// Of it what is known well: the noise of the sensor and of the inputs, and the moments of switches. (The rest is a guess of what inputs
    /// do between their readings.)
    pub known: Vec<f64>,
}

/// What the model might have given: every compared quantity before the sensors.
pub struct Spread {
    /// With the inputs as they were read.
    model: Simulated,
    /// In half the step; from water that begins otherwise; of more layers; with commands switched early, and late.
    others: [Option<Simulated>; 5],
    /// With inputs drawn anew.
    draws: Vec<Simulated>,
    /// With no more than the noise of the inputs drawn anew.
    noisy: Vec<Simulated>,
}

impl Spread {
    /// From simulations with these effects, which carry on what inputs leave open; `model` is the one of the inputs as they were read.
    pub fn new(
        experiment: &Experiment,
        model: Simulated,
        unknowns: &[Unknown],
        at: &[f64],
    ) -> Self {
        // Warmer, or where the model does not run so, colder.
        let started = |sign: f64| {
            let (mut unknowns, mut at) = (unknowns.to_vec(), at.to_vec());
            for run in 0..experiment.runs.len() {
                let Some(first) = experiment.first(run) else { continue };
                let target = Target::Initial(run);
                let i = unknowns.iter().position(|u| u.target == target).unwrap_or_else(|| {
                    unknowns.push(Unknown::plain(target, 0.0, 1.0));
                    at.push(0.0);
                    at.len() - 1
                });
                at[i] += sign * first.uneven_k;
            }
            experiment.simulated(&unknowns, &at, 1)
        };
        let plain = |other: Experiment| other.simulated(unknowns, at, 1).ok();
        // What was drawn and does not run is not what was.
        let all = on_all_cores(5 + 2 * DRAWS, |k| match k {
            0 => experiment.simulated(unknowns, at, 2).ok(),
            1 => started(1.0).or_else(|_| started(-1.0)).ok(),
            2 => grid::finer(experiment).and_then(plain),
            3 => switched_at(experiment, -LATEST).and_then(plain),
            4 => switched_at(experiment, LATEST).and_then(plain),
            _ => plain(drawn(experiment, k as u64, k >= 5 + DRAWS)),
        });
        let mut all = all.into_iter();
        let others = [(); 5].map(|()| all.next().flatten());
        let draws = all.by_ref().take(DRAWS).flatten().collect();
        Self { model, others, draws, noisy: all.flatten().collect() }
    }

    /// Standard deviations of all samples as these flaws of their sensors show what might have been: a slow one keeps for a
    /// while what a moment has left open.
    pub fn seen(&self, experiment: &Experiment, unknowns: &[Unknown], at: &[f64]) -> Uncertainties {
        let observed = |simulated: &Simulated| experiment.observed(simulated, unknowns, at);
        let readings = observed(&self.model);
        let others = self.others.each_ref().map(|other| other.as_ref().map(observed));
        let [draws, noisy] = [&self.draws, &self.noisy].map(|all| {
            let all: Vec<Vec<f64>> = all.iter().map(observed).collect();
            mean_squares(&all, &readings)
        });
        uncertainties(experiment, &readings, &others, &draws, &noisy)
    }
}

/// Mean squares of how far these draws lie from the readings.
fn mean_squares(draws: &[Vec<f64>], readings: &[f64]) -> Vec<f64> {
    let of = |(i, y): (usize, &f64)| draws.iter().map(|draw| (draw[i] - y).powi(2)).sum::<f64>();
    readings.iter().enumerate().map(of).map(|sum| sum / draws.len().max(1) as f64).collect()
}

/// Standard deviations of all samples from readings of the model as it is, and as it might have been (see [`Spread`]): mean squares with the
/// inputs drawn anew, and with their noise alone.
fn uncertainties(
    experiment: &Experiment,
    readings: &[f64],
    [finer, start, layers, early, late]: &[Option<Vec<f64>>; 5],
    draws: &[f64],
    noisy: &[f64],
) -> Uncertainties {
    let away = |other: &Option<Vec<f64>>, i: usize| {
        other.as_ref().map_or(0.0, |other| other[i] - readings[i])
    };
    // The moment of a switch: equally distributed between its earliest and its latest.
    let switched = |i: usize| away(early, i).powi(2).max(away(late, i).powi(2)) / 3.0;
    let known: Vec<f64> = (0..readings.len()).map(|i| noisy[i].max(switched(i))).collect();
    // Few draws may miss it.
    let squares: Vec<f64> =
        draws.iter().zip(&known).map(|(drawn, known)| drawn.max(*known)).collect();
    let samples = &experiment.samples;
    let unknown_mixing = grid::unknown_share(experiment);
    let jitters: Vec<Vec<f64>> =
        experiment.runs.iter().map(|run| run.tracks.iter().map(jitter_s).collect()).collect();
    let of = |(i, sample): (usize, &Sample)| {
        let group = (sample.run, sample.sensor);
        let same = |j: &usize| samples.get(*j).is_some_and(|s| (s.run, s.sensor) == group);
        let before = i.checked_sub(1).filter(same).unwrap_or(i);
        let after = Some(i + 1).filter(same).unwrap_or(i);
        let dt_s = samples[after].time_s - samples[before].time_s;
        let rate =
            if dt_s > 0.0 { (samples[after].value - samples[before].value) / dt_s } else { 0.0 };
        let moved = rate * jitters[sample.run][sample.sensor];
        let beside = (i.saturating_sub(BESIDE)..=i + BESIDE).filter(same);
        let (sum, of_known, count) = beside.fold((0.0, 0.0, 0.0), |(sum, of, count), j| {
            (sum + squares[j], of + known[j], count + 1.0)
        });
        let noise = experiment.accuracy[sample.sensor].noise;
        let layers = unknown_mixing * grid::WHOLE * away(layers, i);
        let rest = away(finer, i).powi(2) + away(start, i).powi(2) + layers * layers;
        let all = noise * noise + moved * moved + rest + sum / count;
        (all.sqrt(), (noise * noise + of_known / count).sqrt())
    };
    let (sigma, known) = samples.iter().enumerate().map(of).unzip();
    Uncertainties { sigma, known }
}

/// The experiment with inputs as they might have been, or with their noise alone.
fn drawn(experiment: &Experiment, draw: u64, only_noise: bool) -> Experiment {
    let mut random = Pcg32::new(SEED, draw);
    let mut other = experiment.clone();
    for (i, sensor) in experiment.sensors.sensor.iter().enumerate() {
        if sensor.role == Role::Compare {
            continue;
        }
        let (noise, kind) = (experiment.accuracy[i].noise, Kind::of(sensor));
        let late: f64 = StandardNormal.sample(&mut random);
        for run in &mut other.runs {
            let track = &mut run.tracks[i];
            if only_noise {
                *track = noisy(track, noise, kind, &mut random);
                continue;
            }
            if kind.switches() {
                *track = switched(track, kind, || {
                    let x: f64 = StandardNormal.sample(&mut random);
                    (x / 12.0_f64.sqrt()).clamp(-LATEST, LATEST)
                });
            }
            *track = redrawn(track, noise, kind, &mut random);
            // That of a temperature is fitted.
            if kind != Kind::Temperature {
                track.time_s.iter_mut().for_each(|t| *t -= LAG_S * late);
            }
        }
    }
    other
}

/// The experiment with all commands switched by a share of the interval of their readings later; none without commands.
fn switched_at(experiment: &Experiment, later: f64) -> Option<Experiment> {
    let sensors = experiment.sensors.sensor.iter().enumerate();
    let of_command = |(_, s): &(usize, &Sensor)| s.role == Role::Input && s.si() == "1";
    let commands: Vec<usize> = sensors.filter(of_command).map(|(i, _)| i).collect();
    let mut other = experiment.clone();
    for run in &mut other.runs {
        for &i in &commands {
            run.tracks[i] = switched(&run.tracks[i], Kind::Command, || later);
        }
    }
    (!commands.is_empty()).then_some(other)
}

/// A command or a flow, switched on and off later than in the middle between two readings, by these shares of the time between them; a flow
/// that was read on its way moved when it was read.
fn switched(track: &Track, kind: Kind, mut later: impl FnMut() -> f64) -> Track {
    let usual_s = interval_s(track);
    let mut moved = track.clone();
    for i in 1..track.value.len() {
        let is_on_its_way = kind == Kind::Flow && on_its_way(&track.value, i);
        let switches = (track.value[i] == 0.0) != (track.value[i - 1] == 0.0) && !is_on_its_way;
        if switches && track.time_s[i] - track.time_s[i - 1] < GAP * usual_s {
            // Both readings beside it: the order stays.
            let moved_s = (track.time_s[i] - track.time_s[i - 1]) * later();
            moved.time_s[i - 1] = track.time_s[i - 1] + moved_s;
            moved.time_s[i] = track.time_s[i] + moved_s;
        }
    }
    moved
}

/// What a measured input is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A flow: off, or on.
    Flow,
    /// A command: off, or on, with nothing between; half of a load between two readings would be a run before the run.
    Command,
    /// A temperature: no steps.
    Temperature,
    /// Anything else.
    Other,
}

impl Kind {
    fn of(sensor: &Sensor) -> Self {
        match sensor.si().as_str() {
            "kg_s" | "m3_s" => Self::Flow,
            "1" => Self::Command,
            "k" => Self::Temperature,
            _ => Self::Other,
        }
    }

    /// Whether it is off at times: nothing, without noise.
    fn switches(self) -> bool {
        [Self::Flow, Self::Command].contains(&self)
    }
}

/// A measured input with no more than its noise drawn anew.
fn noisy(track: &Track, noise: f64, kind: Kind, random: &mut Pcg32) -> Track {
    let forward = kind == Kind::Flow && track.value.iter().all(|y| *y >= 0.0);
    let mut of = |y: f64| {
        let x: f64 = StandardNormal.sample(random);
        let value = if kind.switches() && y == 0.0 { 0.0 } else { y + noise * x };
        if forward { value.max(0.0) } else { value }
    };
    let value = track.value.iter().map(|y| of(*y)).collect();
    Track { value, time_s: track.time_s.clone() }
}

/// A measured input as it may have been between its readings, in its gaps, and but for its noise.
fn redrawn(track: &Track, noise: f64, kind: Kind, random: &mut Pcg32) -> Track {
    let is_flow = kind == Kind::Flow;
    let mut normal = || -> f64 { StandardNormal.sample(random) };
    let (usual_s, usually) = (interval_s(track), track.usual_bend());
    let (t, y) = (&track.time_s, &track.value);
    // A flow changes in steps, at any moment of the interval, unless it was read on its way.
    let moment_s = |i: usize| {
        if is_flow && !on_its_way(y, i) { usual_s / 12.0_f64.sqrt() } else { jitter_s(track) }
    };
    let forward = y.iter().all(|y| *y >= 0.0);
    let is_off = |k: usize| kind.switches() && y[k] == 0.0;
    // Whether a command is switched beside a reading.
    let switches = |i: usize| {
        kind == Kind::Command && (i.saturating_sub(1)..=(i + 1).min(y.len() - 1)).any(is_off)
    };
    // Whether it is off at one of a reading and the next, from one moment to the other.
    let jumps = |i: usize| {
        let next = (i + 1).min(y.len() - 1);
        is_off(i) != is_off(next) && (kind == Kind::Command || !on_its_way(y, next))
    };
    // How far a reading lies from the straight line between its neighbours: so much may lie between two readings.
    let bent = |i: usize| {
        let inner = i > 0 && i + 1 < t.len() && !switches(i);
        if inner { (y[i] - between(t, y, i - 1, i + 1, t[i])).abs() } else { 0.0 }
    };
    let mut drawn = Track { time_s: Vec::new(), value: Vec::new() };
    for i in 0..t.len() {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(t.len() - 1));
        let rate = (y[after] - y[before]) / (t[after] - t[before]).max(1e-9);
        let moved =
            if t[after] - t[before] < GAP * 2.0 * usual_s { rate * moment_s(i) } else { 0.0 };
        let moved = if switches(i) { 0.0 } else { moved };
        let off = is_off(i);
        let value = if off { 0.0 } else { y[i] + noise * normal() + moved * normal() };
        drawn.time_s.push(t[i]);
        drawn.value.push(if is_flow && forward { value.max(0.0) } else { value });
        let gap_s = t[after] - t[i];
        if gap_s > GAP * usual_s && jumps(i) {
            // At any moment of the gap.
            let share = 0.5 + (normal() / 12.0_f64.sqrt()).clamp(-LATEST, LATEST);
            let beside_s = (0.5 - LATEST) * usual_s;
            drawn.time_s.extend([-beside_s, beside_s].map(|dt| t[i] + share * gap_s + dt));
            drawn.value.extend([y[i], y[after]]);
        } else if gap_s > GAP * usual_s {
            let lag = ((gap_s / usual_s).round() as usize).clamp(1, t.len() - 1);
            let changes = (lag..t.len()).map(|k| (y[k] - y[k - lag]).powi(2));
            let usual = (changes.sum::<f64>() / (t.len() - lag) as f64).sqrt();
            let middle = (0.5 * usual).hypot((y[after] - y[i]) / 3.0) * normal();
            for share in [0.25, 0.5, 0.75] {
                let bridge =
                    y[i] + share * (y[after] - y[i]) + 4.0 * share * (1.0 - share) * middle;
                drawn.time_s.push(t[i] + share * gap_s);
                drawn.value.push(if is_flow && forward { bridge.max(0.0) } else { bridge });
            }
        } else if after > i && is_flow && off != is_off(after) && !jumps(i) {
            // Between nothing and a reading on its way it may be one or the other for most of the time.
            let middle = 0.5 + normal() / 12.0_f64.sqrt();
            drawn.time_s.push(0.5 * (t[i] + t[after]));
            drawn.value.push(middle.clamp(0.0, 1.0) * (y[i] + y[after]));
        } else if after > i && !off && !jumps(i) {
            let middle_s = 0.5 * (t[i] + t[after]);
            let (middle, share) = if kind == Kind::Temperature {
                (track.smooth_at(middle_s, usually), BENT.1)
            } else {
                (0.5 * (y[i] + y[after]), BENT.0)
            };
            let middle = middle + share * bent(i).max(bent(after)) * normal();
            drawn.time_s.push(middle_s);
            drawn.value.push(if is_flow && forward { middle.max(0.0) } else { middle });
        }
    }
    drawn
}

/// Whether a reading, or one beside it, lies between two levels: the change takes longer than an interval, and its moment is read.
pub(crate) fn on_its_way(y: &[f64], i: usize) -> bool {
    let passes = |k: usize| {
        let (Some(before), Some(after)) = (k.checked_sub(1).map(|k| y[k]), y.get(k + 1)) else {
            return false;
        };
        let (first, second) =
            ((y[k] - before) / (after - before), (after - y[k]) / (after - before));
        first > PASSES && second > PASSES
    };
    (i.saturating_sub(1)..=(i + 1).min(y.len() - 1)).any(passes)
}

/// Linear between two readings.
fn between(t: &[f64], y: &[f64], i: usize, j: usize, time_s: f64) -> f64 {
    y[i] + (y[j] - y[i]) * (time_s - t[i]) / (t[j] - t[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flow_that_is_read_on_its_way_changes_when_it_was_read() {
        let step = [0.0, 0.0, 8.0, 8.0, 8.0];
        assert!((0..5).all(|i| !on_its_way(&step, i)));
        let ramp = [0.0, 0.0, 3.0, 8.0, 8.0, 8.0];
        assert_eq!(
            [0, 1, 2, 3, 4, 5].map(|i| on_its_way(&ramp, i)),
            [false, true, true, true, false, false]
        );
        // Of a steady flow nothing changes.
        assert!(!on_its_way(&[8.0; 3], 1));
    }

    #[test]
    fn a_command_is_off_or_on_and_nothing_between() {
        let track = Track {
            time_s: (0..6).map(|k| 10.0 * f64::from(k)).collect(),
            value: vec![0.0, 0.0, 0.6, 0.6, 0.0, 0.0],
        };
        // 4.5 s later: both readings beside each switch, which lies between them.
        let late = switched(&track, Kind::Command, || LATEST);
        assert_eq!(late.time_s, [0.0, 14.5, 24.5, 34.5, 44.5, 50.0]);
        let drawn = redrawn(&late, 0.01, Kind::Command, &mut Pcg32::new(1, 1));
        // One more reading within the run; a load of nothing stays nothing, and there is none between.
        assert_eq!(drawn.time_s, [0.0, 14.5, 24.5, 29.5, 34.5, 44.5, 50.0]);
        let off: Vec<bool> = drawn.value.iter().map(|y| *y == 0.0).collect();
        assert_eq!(off, [true, true, false, false, false, true, true]);
        assert!((drawn.value[2] - 0.6).abs() < 0.05 && drawn.value[2] != 0.6);
        // A start that was read while the speed rose, at 20 s, was somewhen since 10 s; of a flow its moment is known.
        let rising =
            Track { value: vec![0.0, 0.0, 0.5, 0.6, 0.6, 0.6], time_s: track.time_s.clone() };
        let moved = |kind| switched(&rising, kind, || LATEST).time_s[2] - 20.0;
        assert_eq!((moved(Kind::Command), moved(Kind::Flow)), (4.5, 0.0));
    }

    #[test]
    fn a_gap_is_as_uncertain_as_the_input_is_restless() {
        // Readings every 10 s that swing by 2; one gap of 100 s, readings alike at its ends.
        let mut track = Track { time_s: Vec::new(), value: Vec::new() };
        for k in (0..100).filter(|k| !(40..49).contains(k)) {
            track.time_s.push(f64::from(k) * 10.0);
            track.value.push((f64::from(k) * 0.7).sin());
        }
        let mut largest = 0.0_f64;
        for draw in 0..50 {
            let drawn = redrawn(&track, 0.0, Kind::Temperature, &mut Pcg32::new(1, draw));
            // Three points in the gap, one in every other interval.
            assert_eq!(drawn.time_s.len(), 2 * track.time_s.len() + 1);
            largest = largest.max((drawn.at(440.0) - track.at(440.0)).abs());
        }
        assert!(largest > 0.5, "{largest}");
        // What is on in front of a gap of 40 s and off behind it is switched at any moment of it, at once.
        let command = Track {
            time_s: vec![0.0, 10.0, 20.0, 30.0, 70.0, 80.0],
            value: vec![0.6, 0.6, 0.6, 0.6, 0.0, 0.0],
        };
        let moments = (0..50).map(|draw| {
            let drawn = redrawn(&command, 0.0, Kind::Command, &mut Pcg32::new(1, draw));
            let i = drawn.value.iter().position(|y| *y == 0.0).unwrap();
            assert_eq!(drawn.value[i - 1], 0.6);
            assert!(drawn.time_s.is_sorted() && drawn.time_s[i] - drawn.time_s[i - 1] < 1.01);
            drawn.time_s[i]
        });
        let (least, most) = moments.fold((70.0_f64, 30.0_f64), |(a, b), t| (a.min(t), b.max(t)));
        assert!((32.0..36.0).contains(&least) && (64.0..69.0).contains(&most), "{least} {most}");
        // Readings of nothing stay nothing.
        let still = Track { time_s: vec![0.0, 10.0, 20.0], value: vec![0.0; 3] };
        assert_eq!(redrawn(&still, 0.1, Kind::Flow, &mut Pcg32::new(1, 1)).value, [0.0; 3]);
    }

    #[test]
    fn a_slow_sensor_keeps_what_a_moment_has_left_open() {
        use crate::bench;
        let experiment = bench::experiment(&[]);
        let spread = Spread::new(&experiment, experiment.simulated(&[], &[], 1).unwrap(), &[], &[]);
        let slow = [Unknown::plain(Target::Lag(2), 0.0, 1.0)];
        let [fast, slow] = [0.0, 40.0].map(|lag_s| spread.seen(&experiment, &slow, &[lag_s]).sigma);
        // The front passes the middle until some 2 min after 1800 s; at 2060 s it is over, but not for a sensor of 40 s.
        let at = |time_s: f64, sensor: usize| {
            let mut samples = experiment.samples.iter();
            samples.position(|s| s.sensor == sensor && s.time_s == time_s).unwrap()
        };
        let before = at(1500.0, 2);
        assert!(slow[before] < 1.01 * fast[before], "{} {}", slow[before], fast[before]);
        let (during, after) = (at(1900.0, 2), at(2060.0, 2));
        assert!(slow[after] > 1.3 * fast[after], "{} {}", slow[after], fast[after]);
        assert!(slow[during] < fast[during], "{} {}", slow[during], fast[during]);
        // Others are as they were.
        let house = at(2060.0, 3);
        assert_eq!(slow[house], fast[house]);
    }

    #[test]
    fn an_effect_carries_on_what_inputs_leave_open() {
        use crate::{bench, catalogue::effect_target};
        let experiment = bench::experiment(&[]);
        let blur = effect_target("P7", "near", "dispersion_m2_s");
        let blur = [Unknown::plain(blur, 0.0, 1.0)];
        let [sharp, blurred] = [0.0, 1.0].map(|at| {
            let model = experiment.simulated(&blur, &[at], 1).unwrap();
            Spread::new(&experiment, model, &blur, &[at]).seen(&experiment, &blur, &[at]).sigma
        });
        // The front leaves at 1800 s, and its middle arrives after some 2 min; blurred it is there a minute earlier, and less sharp.
        let at = |time_s: f64| {
            let mut samples = experiment.samples.iter();
            samples.position(|s| s.sensor == 2 && s.time_s == time_s).unwrap()
        };
        let (before, during) = (at(1860.0), at(1910.0));
        assert!(blurred[before] > 1.3 * sharp[before], "{} {}", blurred[before], sharp[before]);
        assert!(blurred[during] < 0.5 * sharp[during], "{} {}", blurred[during], sharp[during]);
    }

    #[test]
    fn the_noise_of_inputs_is_known() {
        use crate::bench;
        let experiment = bench::experiment(&[]);
        let spread = Spread::new(&experiment, experiment.simulated(&[], &[], 1).unwrap(), &[], &[]);
        let Uncertainties { sigma, known } = spread.seen(&experiment, &[], &[]);
        assert!(known.iter().zip(&sigma).all(|(known, sigma)| known <= sigma));
        // Long before the front: the noise of the inlet arrives at the middle, blurred by steps between its readings.
        let mut samples = experiment.samples.iter();
        let i = samples.position(|s| s.sensor == 2 && s.time_s == 1500.0).unwrap();
        let [inlet, own] = [0, 2].map(|k| experiment.accuracy[k].noise);
        let of_inputs = (known[i] * known[i] - own * own).sqrt();
        assert!((0.3..1.3).contains(&(of_inputs / inlet)), "{of_inputs} {inlet}");
        // Nothing stays nothing, and a meter for one direction shows nothing below it.
        let track = Track { time_s: vec![0.0, 10.0, 20.0, 30.0], value: vec![0.0, 0.0, 0.01, 1.0] };
        let mut random = Pcg32::new(1, 1);
        for _ in 0..50 {
            let drawn = noisy(&track, 0.1, Kind::Flow, &mut random);
            assert_eq!((&drawn.time_s, drawn.value[0], drawn.value[1]), (&track.time_s, 0.0, 0.0));
            assert!(drawn.value[2] >= 0.0 && drawn.value[3] != 1.0);
        }
    }

    #[test]
    fn beside_a_pause_a_flow_read_on_its_way_may_have_been_either() {
        // Read on its way at 20 s: what flowed between 10 and 20 s is anything from nothing to twice as much as the line says.
        let track = Track {
            time_s: (0..6).map(|k| 10.0 * f64::from(k)).collect(),
            value: vec![0.0, 0.0, 0.3, 1.0, 1.0, 1.0],
        };
        let middle = |draw| {
            let drawn = redrawn(&track, 0.0, Kind::Flow, &mut Pcg32::new(1, draw));
            drawn.at(15.0)
        };
        let all: Vec<f64> = (0..200).map(middle).collect();
        let mean = all.iter().sum::<f64>() / 200.0;
        let sd = (all.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / 200.0).sqrt();
        // (0.5 +- 1/root 12) of 0.3.
        assert!((mean - 0.15).abs() < 0.02 && (sd - 0.087).abs() < 0.02, "{mean} {sd}");
    }
}
