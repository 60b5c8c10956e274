//! Columns that are exchanged: with each other's readings the model fits far better.

use super::misfit::{Column, columns};
use crate::data::Run;
use crate::experiment::Experiment;
use crate::sensors::Role;
use anergy_core::cores::on_all_cores;

/// Misfit from which on columns are suspected; by which an exchange must be better, and the share of it that it may leave.
const SUSPECT: f64 = 1.0;
const BETTER: f64 = 0.6;
const LEAVES: f64 = 0.5;
/// Misfit that an exchange of an input may leave: a pump that is driven by something else may take away the gap of another one, and fits nothing.
const FITS: f64 = 2.0;
/// Most exchanges of inputs that are simulated.
const MOST: usize = 24;

/// Pairs of columns that seem to be exchanged.
pub(super) fn exchanged(experiment: &Experiment, readings: &[f64]) -> Vec<String> {
    let columns = columns(experiment, readings);
    let Some(as_is) = mean(&columns) else { return Vec::new() };
    let of = |sensor: usize| columns.iter().filter(move |column| column.sensor == sensor);
    let misfit = |sensor: usize| of(sensor).filter_map(Column::misfit).fold(0.0, f64::max);
    let sensors = &experiment.sensors.sensor;
    let worst = (0..sensors.len()).map(misfit).fold(0.0, f64::max);
    if worst < SUSPECT {
        return Vec::new();
    }
    let role = |i: usize| sensors[i].role;
    let alike = |i: usize, j: usize| {
        sensors[i].si() == sensors[j].si() && sensors[i].column != sensors[j].column
    };
    let pairs = (0..sensors.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
    let (of_inputs, compared): (Vec<_>, Vec<_>) = pairs
        .filter(|&(i, j)| alike(i, j))
        .partition(|&(i, j)| role(i) == Role::Input || role(j) == Role::Input);
    let mut found: Vec<(f64, (usize, usize))> = Vec::new();
    for (i, j) in compared {
        let gains = of(i).zip(of(j)).map(|(a, b)| {
            let all = (f64::NEG_INFINITY, f64::INFINITY);
            let gain = |own: &Column, other: &Column| {
                let (before, after) = (own.misfit()?, own.beside(&other.simulated, all, 0.0)?);
                Some(if after < LEAVES * before { before - after } else { 0.0 })
            };
            Some(gain(a, b)?.min(gain(b, a)?))
        });
        let gain =
            gains.map(|gain| gain.unwrap_or(f64::NEG_INFINITY)).fold(f64::INFINITY, f64::min);
        if gain > BETTER && gain.is_finite() {
            found.push((gain, (i, j)));
        }
    }
    if found.is_empty() && as_is > SUSPECT {
        let mut suspects = of_inputs;
        suspects.sort_by(|a, b| {
            let of_pair = |pair: &(usize, usize)| misfit(pair.0).max(misfit(pair.1));
            of_pair(b).total_cmp(&of_pair(a))
        });
        suspects.truncate(MOST);
        let gains = on_all_cores(suspects.len(), |k| {
            let other = with_exchanged(experiment, suspects[k])?;
            let readings = other.readings(&[], &[]).ok()?;
            let left = mean(&self::columns(&other, &readings))?;
            (left < FITS.min(LEAVES * as_is)).then_some(as_is - left)
        });
        let far = suspects.iter().zip(gains).filter_map(|(pair, gain)| Some((gain?, *pair)));
        found.extend(far.filter(|(gain, _)| *gain > BETTER));
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let words = found.first().map(|(_, (i, j))| {
        let (a, b) = (&sensors[*i].column, &sensors[*j].column);
        format!("columns \"{a}\" and \"{b}\" seem to be exchanged: the model fits far better so")
    });
    words.into_iter().collect()
}

/// Mean misfit of all readings.
fn mean(columns: &[Column]) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for column in columns {
        if let Some(misfit) = column.misfit() {
            let n = column.measured.value.len() as f64;
            (sum, count) = (sum + n * misfit, count + n);
        }
    }
    (count > 0.0).then(|| sum / count)
}

/// Mean misfit of readings.
pub(super) fn misfit(experiment: &Experiment, readings: &[f64]) -> f64 {
    mean(&columns(experiment, readings)).unwrap_or(f64::INFINITY)
}

/// The experiment with two columns exchanged.
fn with_exchanged(experiment: &Experiment, (i, j): (usize, usize)) -> Option<Experiment> {
    let exchanged = |run: &Run| {
        let mut run = run.clone();
        run.tracks.swap(i, j);
        run
    };
    let runs = experiment.runs.iter().map(exchanged).collect();
    Experiment::new(experiment.model.clone(), experiment.sensors.clone(), runs).ok()
}
