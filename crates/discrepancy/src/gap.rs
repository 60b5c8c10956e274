//! The gap between simulation and measurement before and after, by sensor, use and regime.

use crate::experiment::Experiment;
use crate::split::Use;
use serde::Serialize;
use std::collections::HashMap;

/// A reading changes where its rate is more than this share of the largest one of its sensor in the run.
const CHANGING: f64 = 0.05;

/// Root mean squares over some samples of a sensor, in the unit of its column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gap {
    /// Column.
    pub column: String,
    /// Unit of the column.
    pub unit: String,
    /// Which samples: `identify`, `validate`, `show`.
    pub part: Use,
    /// `all`, `changing` or `steady`.
    pub regime: &'static str,
    /// How many.
    pub samples: usize,
    /// Root mean square of the residuals of the model as it is.
    pub rmse_before: f64,
    /// With the effects.
    pub rmse_after: f64,
    /// The same over the uncertainty of the samples.
    pub z_before: f64,
    /// With the effects.
    pub z_after: f64,
}

/// All gaps that have samples.
pub fn gaps(
    experiment: &Experiment,
    uses: &[Option<Use>],
    sigma: &[f64],
    before: &[f64],
    after: &[f64],
) -> Vec<Gap> {
    let changing = changing(experiment);
    let mut gaps = Vec::new();
    for (k, sensor) in experiment.sensors.sensor.iter().enumerate() {
        for part in [Use::Identify, Use::Validate, Use::Show] {
            for regime in ["all", "changing", "steady"] {
                let of: Vec<usize> = (0..uses.len())
                    .filter(|&i| experiment.samples[i].sensor == k && uses[i] == Some(part))
                    .filter(|&i| regime == "all" || changing[i] == (regime == "changing"))
                    .collect();
                if of.is_empty() {
                    continue;
                }
                let rms = |readings: &[f64], over: &dyn Fn(usize) -> f64| {
                    let square = |&i: &usize| {
                        ((readings[i] - experiment.samples[i].value) / over(i)).powi(2)
                    };
                    (of.iter().map(square).sum::<f64>() / of.len() as f64).sqrt()
                };
                let reading = |rms: f64| sensor.difference_of_si(rms).abs();
                gaps.push(Gap {
                    column: sensor.column.clone(),
                    unit: sensor.unit.clone(),
                    part,
                    regime,
                    samples: of.len(),
                    rmse_before: reading(rms(before, &|_| 1.0)),
                    rmse_after: reading(rms(after, &|_| 1.0)),
                    z_before: rms(before, &|i| sigma[i]),
                    z_after: rms(after, &|i| sigma[i]),
                });
            }
        }
    }
    gaps
}

/// Whether each sample is read while its quantity changes.
fn changing(experiment: &Experiment) -> Vec<bool> {
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
    let mut largest: HashMap<(usize, usize), f64> = HashMap::new();
    for (sample, rate) in samples.iter().zip(&rates) {
        let of = largest.entry((sample.run, sample.sensor)).or_default();
        *of = of.max(*rate);
    }
    let own = samples.iter().zip(&rates);
    own.map(|(sample, rate)| *rate > CHANGING * largest[&(sample.run, sample.sensor)]).collect()
}
