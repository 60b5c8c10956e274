//! Find: where and when simulation and measurement differ, and whether it is more than chance.

pub mod flux;
pub mod isolation;
pub mod regimes;

use crate::error::ExplainError;
use crate::experiment::Experiment;
use crate::significance::{State, Tested, holm, test};
use crate::split::Use;
use isolation::{Part, parts};
use regimes::regimes;
use serde::Serialize;

/// Rows of the table of regimes.
const ROWS: usize = 40;
/// Standard errors between a deviation that is seen in 95 of 100 cases and none: 1.96 + 1.64.
const SEEN: f64 = 3.6;

/// A sensor, after the tolerances were fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OfSensor {
    /// Column.
    pub column: String,
    /// Unit of the column.
    pub unit: String,
    /// What it says.
    pub state: State,
    /// Root mean square of the residuals over sigma, and its 95 % interval.
    pub z: f64,
    /// Lower end.
    pub z_lo: f64,
    /// Upper end.
    pub z_hi: f64,
    /// Mean residual, in the unit of the column.
    pub mean: f64,
    /// The smallest mean deviation that would be seen, in the unit of the column.
    pub detectable: f64,
}

/// A sensor in a regime; the model as it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InRegime {
    /// Column.
    pub column: String,
    /// Regime.
    pub regime: String,
    /// Samples.
    pub samples: usize,
    /// Mean of the residuals over sigma.
    pub z_mean: f64,
    /// Root mean square of it.
    pub z: f64,
    /// Share of all squares.
    pub share: f64,
    /// This share over the share of the samples.
    pub concentration: f64,
    /// Whether it is more than chance.
    pub significant: bool,
}

/// Where and when they differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// Sensors.
    pub sensors: Vec<OfSensor>,
    /// Sensors in regimes, the largest share of squares first.
    pub regimes: Vec<InRegime>,
    /// Parts of the model that measured boundaries cut out, the most suspicious first.
    pub parts: Vec<Part>,
}

/// Compares: `before` are readings of the model as it is, `null` those with the tolerances fitted.
///
/// # Errors
/// What keeps a part from running.
pub fn find(
    experiment: &Experiment,
    uses: &[Option<Use>],
    sigma: &[f64],
    before: &[f64],
    null: &[f64],
) -> Result<Found, ExplainError> {
    // The samples to show are not looked at.
    let seen: Vec<usize> =
        (0..uses.len()).filter(|&i| uses[i].is_some_and(|u| u != Use::Show)).collect();
    Ok(Found {
        sensors: sensors(experiment, sigma, if null.is_empty() { before } else { null }, &seen),
        regimes: in_regimes(experiment, sigma, before, &seen),
        parts: parts(experiment, sigma, before, &seen),
    })
}

fn tested(
    experiment: &Experiment,
    sigma: &[f64],
    readings: &[f64],
    of: &[usize],
) -> Option<Tested> {
    let residuals: Vec<f64> =
        of.iter().map(|&i| readings[i] - experiment.samples[i].value).collect();
    test(&residuals, &of.iter().map(|&i| sigma[i]).collect::<Vec<_>>())
}

fn sensors(
    experiment: &Experiment,
    sigma: &[f64],
    readings: &[f64],
    seen: &[usize],
) -> Vec<OfSensor> {
    let each = experiment.sensors.sensor.iter().enumerate().filter_map(|(k, sensor)| {
        let own: Vec<usize> =
            seen.iter().copied().filter(|&i| experiment.samples[i].sensor == k).collect();
        Some((k, sensor, tested(experiment, sigma, readings, &own)?))
    });
    let each: Vec<_> = each.collect();
    let significant = holm(&each.iter().map(|(.., t)| t.p).collect::<Vec<_>>());
    let state = |k: usize, t: &Tested, significant: bool| {
        let bias = experiment.accuracy[k].bias.max(experiment.accuracy[k].noise);
        if significant {
            State::Differs
        } else if t.mean.1 > -bias && t.mean.2 < bias {
            State::Agrees
        } else {
            State::CannotTell
        }
    };
    let rows = each.iter().zip(significant).map(|((k, sensor, t), significant)| OfSensor {
        column: sensor.column.clone(),
        unit: sensor.unit.clone(),
        state: state(*k, t, significant),
        z: t.z,
        z_lo: t.z_interval.0,
        z_hi: t.z_interval.1,
        mean: sensor.difference_of_si(t.mean.0),
        detectable: sensor.difference_of_si(SEEN * (t.mean.2 - t.mean.1) / 3.92).abs(),
    });
    rows.collect()
}

fn in_regimes(
    experiment: &Experiment,
    sigma: &[f64],
    readings: &[f64],
    seen: &[usize],
) -> Vec<InRegime> {
    let z = |i: usize| (readings[i] - experiment.samples[i].value) / sigma[i];
    let total: f64 = seen.iter().map(|&i| z(i).powi(2)).sum::<f64>().max(1e-300);
    let mut rows = Vec::new();
    for regime in regimes(experiment) {
        for (k, sensor) in experiment.sensors.sensor.iter().enumerate() {
            let own: Vec<usize> = seen
                .iter()
                .copied()
                .filter(|&i| regime.holds[i] && experiment.samples[i].sensor == k)
                .collect();
            if own.is_empty() {
                continue;
            }
            let n = own.len() as f64;
            let squares: f64 = own.iter().map(|&i| z(i).powi(2)).sum();
            let share = squares / total;
            rows.push((
                own.clone(),
                InRegime {
                    column: sensor.column.clone(),
                    regime: regime.name.clone(),
                    samples: own.len(),
                    z_mean: own.iter().map(|&i| z(i)).sum::<f64>() / n,
                    z: (squares / n).sqrt(),
                    share,
                    concentration: share / (n / seen.len() as f64),
                    significant: false,
                },
            ));
        }
    }
    rows.sort_by(|a, b| b.1.share.total_cmp(&a.1.share));
    rows.truncate(ROWS);
    let p: Vec<f64> = rows
        .iter()
        .map(|(own, _)| tested(experiment, sigma, readings, own).map_or(1.0, |t| t.p))
        .collect();
    let significant = holm(&p);
    let mut rows: Vec<InRegime> = rows.into_iter().map(|(_, row)| row).collect();
    for (row, significant) in rows.iter_mut().zip(significant) {
        row.significant = significant;
    }
    rows
}
