//! What measured inputs might have been: drawn anew between their readings, in their gaps, and when they were switched.
//!
//! **Assumptions** what an input does in a gap is a bridge between the readings at its ends; its middle is as uncertain as half of
//! the change that the input usually makes in such a time, and a third of the one it made. One that is off at one end and on at the other
//! was switched at any moment of it.

use super::{interval_s, jitter_s};
use crate::catalogue::LAG_S;
use crate::data::Track;
use crate::experiment::Experiment;
use crate::sensors::{Role, Sensor};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg32;

/// An interval so many times the usual one is a gap.
const GAP: f64 = 2.5;
/// The earliest and the latest moment of a switch, from the middle between two readings, over their interval.
pub(super) const LATEST: f64 = 0.45;
/// Seed of the first draw: the same data, the same answer.
const SEED: u64 = 0x5eed;
/// A reading that is further than this share of a change from either end of it was taken on its way.
const PASSES: f64 = 0.1;
/// What lies between two readings over how far they lie from the line between their neighbours: of a flow, which changes in
/// steps, and of a temperature, which is known better (with ramps of 30 to 80 s 0.10 to 0.17 of it, at a reading every 10 to 30 s).
const BENT: (f64, f64) = (0.4, 0.15);

/// The experiment with inputs as they might have been, or with their noise alone.
pub(super) fn drawn(experiment: &Experiment, draw: u64, only_noise: bool) -> Experiment {
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
                *track = switched(track, kind, || later(StandardNormal.sample(&mut random)));
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
pub(super) fn switched_at(experiment: &Experiment, later: f64) -> Option<Experiment> {
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

/// How far the moment of a switch is from the middle between two readings, over their interval, where a normal number is `x`.
fn later(x: f64) -> f64 {
    (x / 12.0_f64.sqrt()).clamp(-LATEST, LATEST)
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
            let share = 0.5 + later(normal());
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
    #[test]
    fn noise_leaves_nothing_as_nothing() {
        // Nothing stays nothing, and a meter for one direction shows nothing below it.
        let track = Track { time_s: vec![0.0, 10.0, 20.0, 30.0], value: vec![0.0, 0.0, 0.01, 1.0] };
        let mut random = Pcg32::new(1, 1);
        for _ in 0..50 {
            let drawn = noisy(&track, 0.1, Kind::Flow, &mut random);
            assert_eq!((&drawn.time_s, drawn.value[0], drawn.value[1]), (&track.time_s, 0.0, 0.0));
            assert!(drawn.value[2] >= 0.0 && drawn.value[3] != 1.0);
        }
    }
}
