//! What a fit leaves of the residuals.

use super::Search;
use crate::significance::differs;

impl Search<'_> {
    /// Residuals on samples that choose, standard deviations (root mean square).
    pub(super) fn z(&self, readings: &[f64]) -> f64 {
        self.likelihood.rms(self.experiment, readings, &self.validated)
    }

    /// Residuals of the worst sensor that are more than chance, over all samples but those to show; 0 where none are.
    pub(super) fn worst(&self, readings: &[f64]) -> f64 {
        differs(self.experiment, &self.likelihood.sigma, readings, &self.likelihood.fitted)
    }

    /// The largest reduction of the error of a sensor on samples that were not fitted, relative.
    pub(super) fn reduction(&self, before: &[f64], after: &[f64]) -> f64 {
        let of = |sensor: usize| {
            let own =
                self.validated.iter().filter(|&&i| self.experiment.samples[i].sensor == sensor);
            let own: Vec<usize> = own.copied().collect();
            let rms = |readings| self.likelihood.rms(self.experiment, readings, &own);
            if own.is_empty() { 0.0 } else { 1.0 - rms(after) / rms(before).max(1e-300) }
        };
        (0..self.experiment.sensors.sensor.len()).map(of).fold(0.0, f64::max)
    }
}
