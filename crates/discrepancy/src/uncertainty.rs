//! How far a reading may lie from the right model: sigma of every sample.
//!
//! **Equation** `sigma^2 = noise^2 + lsb^2/12 + (jitter dy/dt)^2 + sigma_num^2 + sigma_in^2 + sigma_0^2`. `sigma_num` is the
//! difference to half the step, and what storages of three times as many layers show of the error of the grid. `sigma_in` is what noise, resolution and jitter of the measured inputs, and what they did in
//! their gaps, make of the reading: the mean square over `DRAWS` simulations with inputs drawn anew (the Monte Carlo method
//! of GUM supplement 1; between two readings nearly as far from the straight line as those beside it are from theirs), smoothed over neighbouring samples. `sigma_0` is what the temperature of the water at
//! the start makes of it, by as much as the first readings differ beyond what the sensors' classes allow (their middle is an
//! unknown of the fit).
//!
//! **Assumptions** what an input does in a gap is a bridge between the readings at its ends; its middle is as uncertain as half of
//! the change that the input usually makes in such a time, and a third of the one it made.
//!
//! Offsets and gains of sensors are not in sigma: they are the same in all samples, and fitted.

use crate::cores::on_all_cores;
use crate::data::Track;
use crate::experiment::Experiment;
use crate::grid;
use crate::sensors::Role;
use crate::unknown::{Target, Unknown};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg32;

/// Simulations with inputs drawn anew.
const DRAWS: usize = 6;
/// Samples before and after, over which what they show is smoothed.
const BESIDE: usize = 1;
/// An interval so many times the usual one is a gap.
const GAP: f64 = 2.5;
/// Seed of the first draw: the same data, the same answer.
const SEED: u64 = 0x5eed;
/// Least and largest jitter, s, the largest that of a moment anywhere within a second before and after; between them it is equally
/// distributed over an interval of the readings.
const JITTER_S: (f64, f64) = (0.5, 0.577);
/// What lies between two readings over how far they lie from the line between their neighbours.
const BENT: f64 = 0.4;

/// Usual interval of the readings of a track, s.
pub(crate) fn interval_s(track: &Track) -> f64 {
    let mut steps: Vec<f64> = track.time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(1.0)
}

/// Standard deviation of the moment at which a reading was taken, s.
pub(crate) fn jitter_s(track: &Track) -> f64 {
    (interval_s(track) / 12.0_f64.sqrt()).clamp(JITTER_S.0, JITTER_S.1)
}

/// Standard deviations of all samples, SI; `readings` are those of the model as it is.
pub fn uncertainties(experiment: &Experiment, readings: &[f64]) -> Vec<f64> {
    let starts: Vec<(Unknown, f64)> = (0..experiment.runs.len())
        .filter_map(|run| {
            let first = experiment.first(run)?;
            Some((Unknown::plain(Target::Initial(run), 0.0, 1.0), first.uneven_k))
        })
        .collect();
    let (unknowns, at): (Vec<_>, Vec<_>) = starts.into_iter().unzip();
    // Warmer, or where the model does not run so, colder.
    let started = |sign: f64| {
        let at: Vec<f64> = at.iter().map(|x| sign * x).collect();
        experiment.readings(&unknowns, &at)
    };
    let others = on_all_cores(DRAWS + 3, |k| match k {
        0 => experiment.simulated(&[], &[], 2).map(|finer| experiment.observed(&finer, &[], &[])),
        1 => started(1.0).or_else(|_| started(-1.0)),
        2 => grid::finer(experiment)
            .map_or_else(|| Ok(readings.to_vec()), |finer| finer.readings(&[], &[])),
        _ => drawn(experiment, k as u64).readings(&[], &[]),
    });
    // What was drawn and does not run is not what was.
    let mut others = others.into_iter().map(Result::ok);
    let [finer, start, layers] = [(); 3].map(|()| others.next().flatten());
    let draws: Vec<Vec<f64>> = others.flatten().collect();
    let away = |other: &Option<Vec<f64>>, i: usize| {
        other.as_ref().map_or(0.0, |other| other[i] - readings[i])
    };
    let square = |i: usize| {
        let squares = draws.iter().map(|draw| (draw[i] - readings[i]).powi(2));
        squares.sum::<f64>() / draws.len().max(1) as f64
    };
    let squares: Vec<f64> = (0..readings.len()).map(square).collect();
    let samples = &experiment.samples;
    let jitters: Vec<Vec<f64>> =
        experiment.runs.iter().map(|run| run.tracks.iter().map(jitter_s).collect()).collect();
    let sigma = samples.iter().enumerate().map(|(i, sample)| {
        let group = (sample.run, sample.sensor);
        let same = |j: &usize| samples.get(*j).is_some_and(|s| (s.run, s.sensor) == group);
        let before = i.checked_sub(1).filter(same).unwrap_or(i);
        let after = Some(i + 1).filter(same).unwrap_or(i);
        let dt_s = samples[after].time_s - samples[before].time_s;
        let rate =
            if dt_s > 0.0 { (samples[after].value - samples[before].value) / dt_s } else { 0.0 };
        let moved = rate * jitters[sample.run][sample.sensor];
        let beside = (i.saturating_sub(BESIDE)..=i + BESIDE).filter(same);
        let (sum, count) =
            beside.fold((0.0, 0.0), |(sum, count), j| (sum + squares[j], count + 1.0));
        let noise = experiment.accuracy[sample.sensor].noise;
        let layers = grid::WHOLE * away(&layers, i);
        let rest = away(&finer, i).powi(2) + away(&start, i).powi(2) + layers * layers;
        (noise * noise + moved * moved + rest + sum / count).sqrt()
    });
    sigma.collect()
}

/// The experiment with inputs as they might have been.
fn drawn(experiment: &Experiment, draw: u64) -> Experiment {
    let mut random = Pcg32::new(SEED, draw);
    let mut other = experiment.clone();
    for run in &mut other.runs {
        for (i, sensor) in experiment.sensors.sensor.iter().enumerate() {
            if sensor.role == Role::Input {
                let is_flow = ["kg_s", "m3_s"].contains(&sensor.si().as_str());
                let (track, noise) = (&run.tracks[i], experiment.accuracy[i].noise);
                let track =
                    if sensor.si() == "1" { switched(track, &mut random) } else { track.clone() };
                run.tracks[i] = redrawn(&track, noise, is_flow, &mut random);
            }
        }
    }
    other
}

/// A command, switched on and off at any moment of the intervals between its readings.
fn switched(track: &Track, random: &mut Pcg32) -> Track {
    let usual_s = interval_s(track);
    let mut drawn = track.clone();
    let is_off: Vec<bool> = track.value.iter().map(|y| *y == 0.0).collect();
    for i in 1..is_off.len() {
        let early: f64 = StandardNormal.sample(random);
        if is_off[i] != is_off[i - 1] && track.time_s[i] - track.time_s[i - 1] < GAP * usual_s {
            // Both readings beside it, by less than half of an interval: the order stays.
            let moved_s = usual_s * (early / 12.0_f64.sqrt()).clamp(-0.45, 0.45);
            drawn.time_s[i - 1] = track.time_s[i - 1] + moved_s;
            drawn.time_s[i] = track.time_s[i] + moved_s;
        }
    }
    drawn
}

fn redrawn(track: &Track, noise: f64, is_flow: bool, random: &mut Pcg32) -> Track {
    let mut normal = || -> f64 { StandardNormal.sample(random) };
    let usual_s = interval_s(track);
    // A flow changes in steps: at any moment of the interval.
    let jitter_s = if is_flow { usual_s / 12.0_f64.sqrt() } else { jitter_s(track) };
    let (t, y) = (&track.time_s, &track.value);
    let forward = y.iter().all(|y| *y >= 0.0);
    // How far a reading lies from the straight line between its neighbours: so much may lie between two readings.
    let bent = |i: usize| {
        let inner = i > 0 && i + 1 < t.len();
        if inner { (y[i] - between(t, y, i - 1, i + 1, t[i])).abs() } else { 0.0 }
    };
    let mut drawn = Track { time_s: Vec::new(), value: Vec::new() };
    for i in 0..t.len() {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(t.len() - 1));
        let rate = (y[after] - y[before]) / (t[after] - t[before]).max(1e-9);
        let moved = if t[after] - t[before] < GAP * 2.0 * usual_s { rate * jitter_s } else { 0.0 };
        let off = is_flow && y[i] == 0.0;
        let value = if off { 0.0 } else { y[i] + noise * normal() + moved * normal() };
        drawn.time_s.push(t[i]);
        drawn.value.push(if is_flow && forward { value.max(0.0) } else { value });
        let gap_s = t[after] - t[i];
        if gap_s > GAP * usual_s {
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
        } else if after > i && !off {
            let middle_s = 0.5 * (t[i] + t[after]);
            let middle = 0.5 * (y[i] + y[after]) + BENT * bent(i).max(bent(after)) * normal();
            drawn.time_s.push(middle_s);
            drawn.value.push(if is_flow && forward { middle.max(0.0) } else { middle });
        }
    }
    drawn
}

/// Linear between two readings.
fn between(t: &[f64], y: &[f64], i: usize, j: usize, time_s: f64) -> f64 {
    y[i] + (y[j] - y[i]) * (time_s - t[i]) / (t[j] - t[i])
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let drawn = redrawn(&track, 0.0, false, &mut Pcg32::new(1, draw));
            // Three points in the gap, one in every other interval.
            assert_eq!(drawn.time_s.len(), 2 * track.time_s.len() + 1);
            largest = largest.max((drawn.at(440.0) - track.at(440.0)).abs());
        }
        assert!(largest > 0.5, "{largest}");
        // Readings of nothing stay nothing.
        let still = Track { time_s: vec![0.0, 10.0, 20.0], value: vec![0.0; 3] };
        assert_eq!(redrawn(&still, 0.1, true, &mut Pcg32::new(1, 1)).value, [0.0; 3]);
    }
}
