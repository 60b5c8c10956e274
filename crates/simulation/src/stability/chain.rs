//! From the command of an actuator to the reading of a sensor: lags and a dead time, without their gain.
//!
//! **Equation** `exp(-s theta)/((1 + s T)^2 (1 + s tau))`; sampled at the interval h with the command held in
//! between, `theta = n h + delta`: `z^-(n+1) (Phi(h - delta) (z - Phi(h))^-1 Gamma(h) + Gamma(h - delta))`, exact.
//! **Sources** `astrom2011`.

use nalgebra::{Complex, DMatrix};

/// Lags in a row: those of an actuator, that of a sensor.
const MOST: usize = 3;

/// A chain of lags with a dead time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chain {
    /// Time constants, s; without those that are zero.
    lags_s: Vec<f64>,
    dead_s: f64,
}

/// A chain sampled at an interval.
#[derive(Debug, Clone)]
pub(super) struct SampledChain {
    n: usize,
    /// Whole samples of the dead time.
    late: i32,
    phi: [[f64; MOST]; MOST],
    gamma: [f64; MOST],
    phi_rest: [[f64; MOST]; MOST],
    gamma_rest: [f64; MOST],
}

impl Chain {
    pub fn new(actuator_lag_s: f64, sensor_lag_s: f64, dead_s: f64) -> Self {
        let all = [actuator_lag_s, actuator_lag_s, sensor_lag_s];
        Self { lags_s: all.into_iter().filter(|lag| *lag > 0.0).collect(), dead_s }
    }

    /// The answer to a command at a complex frequency, 1/s.
    pub fn at(&self, s: Complex<f64>) -> Complex<f64> {
        let lags: Complex<f64> = self.lags_s.iter().map(|lag| s * *lag + 1.0).product();
        (-s * self.dead_s).exp() / lags
    }

    /// All its times added up, s.
    pub fn total_s(&self) -> f64 {
        self.lags_s.iter().sum::<f64>() + self.dead_s
    }

    pub fn sampled(&self, interval_s: f64) -> SampledChain {
        // A dead time that is a whole number of samples but for rounding is one.
        let samples = self.dead_s / interval_s;
        let whole = if (samples - samples.round()).abs() < 1e-9 {
            samples.round()
        } else {
            samples.floor()
        };
        let rest_s = interval_s - (self.dead_s - whole * interval_s).max(0.0);
        let ((phi, gamma), (phi_rest, gamma_rest)) = (self.step(interval_s), self.step(rest_s));
        #[allow(clippy::cast_possible_truncation)]
        let late = whole as i32 + 1;
        SampledChain { n: self.lags_s.len(), late, phi, gamma, phi_rest, gamma_rest }
    }

    /// State after a time over the state before it, and over a command held meanwhile.
    fn step(&self, time_s: f64) -> ([[f64; MOST]; MOST], [f64; MOST]) {
        let n = self.lags_s.len();
        let mut rates = DMatrix::zeros(n + 1, n + 1);
        for (i, lag_s) in self.lags_s.iter().enumerate() {
            rates[(i, i)] = -time_s / lag_s;
            let driver = if i == 0 { n } else { i - 1 };
            rates[(i, driver)] = time_s / lag_s;
        }
        let step = rates.exp();
        let (mut phi, mut gamma) = ([[0.0; MOST]; MOST], [0.0; MOST]);
        for i in 0..n {
            gamma[i] = step[(i, n)];
            (0..n).for_each(|k| phi[i][k] = step[(i, k)]);
        }
        (phi, gamma)
    }
}

impl SampledChain {
    /// The answer to a held command at a value of z.
    pub fn at(&self, z: Complex<f64>) -> Complex<f64> {
        let late = z.powi(-self.late);
        if self.n == 0 {
            return late;
        }
        // (z - Phi) v = Gamma, Phi lower triangular
        let mut v = [Complex::new(0.0, 0.0); MOST];
        for i in 0..self.n {
            let before: Complex<f64> = (0..i).map(|k| v[k] * self.phi[i][k]).sum();
            v[i] = (before + self.gamma[i]) / (z - self.phi[i][i]);
        }
        let last = self.n - 1;
        let rest: Complex<f64> = (0..self.n).map(|k| v[k] * self.phi_rest[last][k]).sum();
        late * (rest + self.gamma_rest[last])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sampled_chain_answers_like_the_chain_when_sampled_often() {
        let chain = Chain::new(2.0, 1.0, 1.03);
        for omega in [0.05, 0.6, 2.0] {
            let s = Complex::new(0.01, omega);
            let h = 1e-3;
            let hold = (1.0 - (-s * h).exp()) / (s * h);
            let sampled = chain.sampled(h).at((s * h).exp());
            assert!((sampled - chain.at(s) * hold).norm() < 1e-5, "{omega}");
        }
        // One lag of 1 s every second: (1 - 1/e)/(z - 1/e), by hand
        let one = Chain::new(0.0, 1.0, 0.0);
        let (z, e) = (Complex::new(0.3, 0.8), (-1.0_f64).exp());
        assert!((one.sampled(1.0).at(z) - (1.0 - e) / (z - e)).norm() < 1e-12);
        // 0.4 s late: z^-1 of what the lag is after 0.6 s
        let late = Chain::new(0.0, 1.0, 0.4).sampled(1.0).at(z);
        let rest = (-0.6_f64).exp();
        let by_hand = (rest * (1.0 - e) / (z - e) + (1.0 - rest)) / z;
        assert!((late - by_hand).norm() < 1e-12);
    }
}
