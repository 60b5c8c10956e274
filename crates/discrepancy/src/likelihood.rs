//! What is fitted to: how uncertain every sample is, and what a nearly right model leaves behind ([`Noise`]).

use crate::experiment::Experiment;
use crate::noise::{Gain, Noise, Predicted, Residual, Tails, scale_beside, whitened};
use crate::significance::squares;
use crate::uncertainty::Uncertainties;
use nalgebra::DVector;
use std::collections::HashMap;

/// Uncertainty of every sample, and the samples that count.
pub struct Likelihood {
    /// Standard deviation of every sample, SI.
    pub sigma: Vec<f64>,
    /// The same as it was predicted.
    pub predicted: Vec<f64>,
    /// Of it what is known well.
    pub known: Vec<f64>,
    /// The samples that are fitted.
    pub fitted: Vec<usize>,
    /// What a nearly right model leaves behind, by sample; empty: every sample is new.
    pub filter: Vec<Gain>,
    /// The same by run and sensor.
    pub noises: HashMap<(usize, usize), Noise>,
    /// The likelihood is taken to the power of one over this.
    pub temperature: f64,
}

impl Likelihood {
    /// To these samples, every one new.
    pub fn new(sigma: Vec<f64>, fitted: Vec<usize>) -> Self {
        let (predicted, known) = (sigma.clone(), sigma.clone());
        let (filter, noises) = (Vec::new(), HashMap::new());
        Self { sigma, predicted, known, fitted, filter, noises, temperature: 1.0 }
    }

    /// Residuals over sigma of all samples.
    pub fn z(&self, experiment: &Experiment, readings: &[f64]) -> Vec<f64> {
        let samples = experiment.samples.iter().zip(readings).zip(&self.sigma);
        samples.map(|((sample, y), sigma)| (sample.value - y) / sigma).collect()
    }

    /// Root mean square of the residuals over sigma of some samples, with what lies far off alone counted less ([`squares`]).
    pub fn rms(&self, experiment: &Experiment, readings: &[f64], samples: &[usize]) -> f64 {
        let z = |&i: &usize| (experiment.samples[i].value - readings[i]) / self.sigma[i];
        let of_group = |own: &[usize]| -> f64 {
            squares(&own.iter().map(z).collect::<Vec<f64>>()).iter().sum()
        };
        let groups = samples.chunk_by(|&i, &j| beside(experiment, i, j));
        (groups.map(of_group).sum::<f64>() / samples.len().max(1) as f64).sqrt()
    }

    /// Residuals over sigma, or their sensitivities, of all fitted samples, whitened.
    pub fn whitened(&self, z: impl Fn(usize) -> f64) -> DVector<f64> {
        let values = self.fitted.iter().map(|&i| z(i));
        if self.filter.is_empty() {
            return DVector::from_iterator(self.fitted.len(), values);
        }
        let values = self.fitted.iter().map(|&i| z(i) * self.sigma[i]);
        DVector::from_iterator(self.fitted.len(), whitened(&self.filter, values))
    }

    /// Whitened residuals as their squares count, and the slopes of these by the residuals.
    pub fn counted(&self, e: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
        let cold = 1.0 / self.temperature.sqrt();
        let tails = |k: usize| self.filter.get(k).map_or(Tails::Normal, |gain| gain.tails);
        let both = e.iter().enumerate().map(|(k, &e)| tails(k).counted(e));
        let (values, slopes): (Vec<f64>, Vec<f64>) =
            both.map(|(y, s)| (cold * y, cold * s)).unzip();
        (DVector::from_vec(values), DVector::from_vec(slopes))
    }

    /// Goes by another prediction.
    pub fn predict(&mut self, Uncertainties { sigma, known }: Uncertainties) {
        (self.predicted, self.known) = (sigma, known);
        self.forget();
    }

    /// Scales what is predicted of each sensor beside what is known well by what these readings leave behind.
    pub fn rescale(&mut self, experiment: &Experiment, readings: &[f64]) {
        for sensor in 0..experiment.sensors.sensor.len() {
            let own = |i: &usize| experiment.samples[*i].sensor == sensor;
            let of = |i: usize| Predicted {
                value: experiment.samples[i].value - readings[i],
                sigma: self.predicted[i],
                known: self.known[i],
            };
            let fitted = self.fitted.iter().copied().filter(own);
            let scale = scale_beside(&fitted.map(of).collect::<Vec<_>>());
            for i in (0..experiment.samples.len()).filter(own) {
                self.sigma[i] = of(i).scaled(scale);
            }
        }
    }

    /// Takes what lies far off alone for as uncertain as its square counts ([`squares`]), until something is learned: a moment that was
    /// missed by a second would draw the wrong effect to it.
    pub fn temper(&mut self, experiment: &Experiment, readings: &[f64]) {
        let z = self.z(experiment, readings);
        let all: Vec<usize> = (0..z.len()).collect();
        for own in all.chunk_by(|&i, &j| beside(experiment, i, j)) {
            let counted = squares(&z[own[0]..=own[own.len() - 1]]);
            for (&i, counted) in own.iter().zip(counted) {
                self.sigma[i] *= (z[i].abs() / counted.sqrt().max(1e-300)).max(1.0);
            }
        }
    }

    /// Takes what these readings leave behind for what every nearly right model does.
    pub fn learn(&mut self, experiment: &Experiment, readings: &[f64]) {
        self.forget();
        self.rescale(experiment, readings);
        let of = |&i: &usize| {
            let sample = &experiment.samples[i];
            let (value, sigma) = (sample.value - readings[i], self.sigma[i]);
            ((sample.run, sample.sensor), Residual { time_s: sample.time_s, value, sigma })
        };
        let all: Vec<_> = self.fitted.iter().map(of).collect();
        for group in all.chunk_by(|a, b| a.0 == b.0) {
            let residuals: Vec<Residual> = group.iter().map(|(_, r)| *r).collect();
            let noise = Noise::of(&residuals);
            self.filter.extend(noise.gains(&residuals));
            self.noises.insert(group[0].0, noise);
        }
    }

    /// Takes every sample for new again, and for as uncertain as was predicted.
    pub fn forget(&mut self) {
        self.sigma.clone_from(&self.predicted);
        self.filter.clear();
        self.noises.clear();
        self.temperature = 1.0;
    }
}

/// Whether two samples are of one sensor in one run.
fn beside(experiment: &Experiment, i: usize, j: usize) -> bool {
    let of = |k: usize| (experiment.samples[k].run, experiment.samples[k].sensor);
    of(i) == of(j)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench;

    #[test]
    fn what_lies_far_off_alone_counts_as_three() {
        let experiment = bench::experiment(&[]);
        let n = experiment.samples.len();
        let mut readings: Vec<f64> = experiment.samples.iter().map(|s| s.value).collect();
        // One reading 12 sigma off; three in a row 9, 12 and 15, as the best of two beside each other.
        for (i, z) in [(20, 12.0), (100, 9.0), (101, 12.0), (102, 15.0)] {
            readings[i] -= 0.1 * z;
        }
        let mut likelihood = Likelihood::new(vec![0.1; n], (0..n).collect());
        likelihood.temper(&experiment, &readings);
        let z = likelihood.z(&experiment, &readings);
        for (i, expected) in [(20, 3.0), (100, 9.0), (101, 12.0), (102, 12.0), (50, 0.0)] {
            assert!((z[i] - expected).abs() < 1e-6, "{i}: {}", z[i]);
        }
        // What is learned later begins with what was predicted.
        likelihood.forget();
        assert_eq!(likelihood.sigma, vec![0.1; n]);
    }
}
