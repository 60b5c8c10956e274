//! The gap between simulation and measurement before and after, by sensor, use and regime.

use crate::experiment::Experiment;
use crate::find::regimes::changing;
use crate::significance::squares;
use crate::split::Use;
use serde::Serialize;

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
    /// The same over the uncertainty of the samples, with what lies far off alone counted less ([`squares`]).
    pub z_before: f64,
    /// With the effects.
    pub z_after: f64,
    /// With the effects, and offsets, clocks and tolerances as they were fitted: what is left when all is said.
    pub z_fitted: f64,
}

/// All gaps that have samples: readings `before` and `after` the effects, and with everything as it was `fitted`.
pub fn gaps(
    experiment: &Experiment,
    uses: &[Option<Use>],
    sigma: &[f64],
    before: &[f64],
    after: &[f64],
    fitted: &[f64],
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
                let mean = |squares: f64| (squares / of.len() as f64).sqrt();
                let missed = |readings: &[f64], i: usize| readings[i] - experiment.samples[i].value;
                let rmse = |readings: &[f64]| {
                    let sum = of.iter().map(|&i| missed(readings, i).powi(2)).sum();
                    sensor.difference_of_si(mean(sum)).abs()
                };
                let z = |readings: &[f64]| {
                    let z: Vec<f64> = of.iter().map(|&i| missed(readings, i) / sigma[i]).collect();
                    mean(squares(&z).iter().sum())
                };
                gaps.push(Gap {
                    column: sensor.column.clone(),
                    unit: sensor.unit.clone(),
                    part,
                    regime,
                    samples: of.len(),
                    rmse_before: rmse(before),
                    rmse_after: rmse(after),
                    z_before: z(before),
                    z_after: z(after),
                    z_fitted: z(fitted),
                });
            }
        }
    }
    gaps
}
