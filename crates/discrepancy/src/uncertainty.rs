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
//! They are simulated with the effects that are given, which carry on what inputs leave open.
//! Offsets and gains of sensors are not in sigma: they are the same in all samples, and fitted.

mod drawn;

use crate::data::Track;
use crate::experiment::{Experiment, Sample, Simulated};
use crate::grid;
use crate::unknown::{Target, Unknown};
use anergy_core::cores::on_all_cores;
pub(crate) use drawn::on_its_way;
use drawn::{LATEST, drawn, switched_at};

/// Simulations with inputs drawn anew.
const DRAWS: usize = 12;
/// Samples before and after, over which what they show is smoothed.
const BESIDE: usize = 1;
/// An interval so many times the usual one is a pause of a sensor that reads now and then.
const PAUSE: f64 = 8.0;
/// Least and largest jitter, s, the largest that of a moment anywhere within a second before and after; between them it is equally
/// distributed over an interval of the readings.
const JITTER_S: (f64, f64) = (0.5, 0.577);

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

#[cfg(test)]
mod tests {
    use super::*;

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
    }
}
