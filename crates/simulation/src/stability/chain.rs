//! From the command of an actuator to the reading of a sensor: lags and a dead time, without their gain.
//!
//! **Equation** `exp(-s theta)/((1 + s T)^2 (1 + s tau_w) (1 + s tau))`, tau_w a lag of the water; sampled at the interval h with the command held in
//! between, `theta = n h + delta`: `z^-(n+1) (Phi(h - delta) (z - Phi(h))^-1 Gamma(h) + Gamma(h - delta))`, exact.
//! **Sources** `astrom2011`.

use nalgebra::Complex;

type C64 = Complex<f64>;

/// Lags in a row: those of an actuator, that of the water, that of a sensor.
pub(super) const MOST: usize = 4;
/// Norm below which four times so many terms of the series of an exponential are all: 0.5^16/16! is 1e-18.
const SMALL: f64 = 0.5;
const BLOCKS: usize = 4;

/// A chain of lags with a dead time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chain {
    /// Time constants, s; without those that are zero, which are behind.
    all_s: [f64; MOST],
    n: usize,
    /// How many of them are those of actuator and water.
    ahead: usize,
    dead_s: f64,
}

/// A chain sampled at an interval.
#[derive(Debug, Clone)]
pub(super) struct SampledChain {
    n: usize,
    /// Lags of actuator and water; one more is that of the sensor.
    pub ahead: usize,
    /// Whole samples of the dead time.
    late: i32,
    phi: [[f64; MOST]; MOST],
    gamma: [f64; MOST],
    pub reading: Reading,
}

/// How the last lag of a sampled chain, the reading, follows the ones before it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading {
    /// Over a whole interval, from each lag and from the command.
    pub by_ahead: [f64; MOST - 1],
    pub by_command: f64,
    /// Over the rest of an interval, from each lag, from the command, and from the lag of the sensor itself.
    pub by_ahead_rest: [f64; MOST - 1],
    pub by_command_rest: f64,
    pub by_itself_rest: f64,
}

impl Reading {
    /// The answer, from what it shares with other chains.
    #[inline]
    fn through(&self, ahead: &[C64; MOST - 1], behind: C64, late: C64) -> C64 {
        let mut before = C64::new(self.by_command, 0.0);
        let mut rest = C64::new(self.by_command_rest, 0.0);
        for ((v, now), later) in ahead.iter().zip(&self.by_ahead).zip(&self.by_ahead_rest) {
            before += v * now;
            rest += v * later;
        }
        late * (rest + before * behind * self.by_itself_rest)
    }
}

impl Chain {
    pub fn new(actuator_lag_s: f64, water_lag_s: f64, sensor_lag_s: f64, dead_s: f64) -> Self {
        let all = [actuator_lag_s, actuator_lag_s, water_lag_s, sensor_lag_s];
        let ahead = all[..3].iter().filter(|lag| **lag > 0.0).count();
        let (mut all_s, mut n) = ([0.0; MOST], 0);
        for lag_s in all.into_iter().filter(|lag_s| *lag_s > 0.0) {
            (all_s[n], n) = (lag_s, n + 1);
        }
        Self { all_s, n, ahead, dead_s }
    }

    fn lags_s(&self) -> &[f64] {
        &self.all_s[..self.n]
    }

    /// The answer to a command at a complex frequency, 1/s.
    pub fn at(&self, s: Complex<f64>) -> Complex<f64> {
        let lags: Complex<f64> = self.lags_s().iter().map(|lag| s * *lag + 1.0).product();
        (-s * self.dead_s).exp() / lags
    }

    /// All its times added up, s.
    pub fn total_s(&self) -> f64 {
        self.lags_s().iter().sum::<f64>() + self.dead_s
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
        let (n, ahead) = (self.n, self.ahead);
        let mut reading = Reading {
            by_ahead: [0.0; MOST - 1],
            by_command: 0.0,
            by_ahead_rest: [0.0; MOST - 1],
            // Without any lag the reading is the command.
            by_command_rest: 1.0,
            by_itself_rest: 0.0,
        };
        if let Some(last) = n.checked_sub(1) {
            reading.by_ahead[..ahead].copy_from_slice(&phi[last][..ahead]);
            reading.by_ahead_rest[..ahead].copy_from_slice(&phi_rest[last][..ahead]);
            (reading.by_command, reading.by_command_rest) = (gamma[last], gamma_rest[last]);
            if n > ahead {
                reading.by_itself_rest = phi_rest[last][last];
            }
        }
        SampledChain { n, ahead, late, phi, gamma, reading }
    }

    /// State after a time over the state before it, and over a command held meanwhile.
    fn step(&self, time_s: f64) -> ([[f64; MOST]; MOST], [f64; MOST]) {
        // The command first, then each lag behind the one that drives it: lower triangular.
        let mut rates = [[0.0; MOST + 1]; MOST + 1];
        for (i, lag_s) in self.lags_s().iter().enumerate() {
            rates[i + 1][i + 1] = -time_s / lag_s;
            rates[i + 1][i] = time_s / lag_s;
        }
        let step = exponential(&rates, self.n + 1);
        let (mut phi, mut gamma) = ([[0.0; MOST]; MOST], [0.0; MOST]);
        let own = step.iter().skip(1).take(self.n);
        for ((phi, gamma), step) in phi.iter_mut().zip(&mut gamma).zip(own) {
            *gamma = step[0];
            phi.copy_from_slice(&step[1..]);
        }
        (phi, gamma)
    }
}

impl SampledChain {
    /// The answer to a held command at a value of z.
    pub fn at(&self, z: C64) -> C64 {
        self.reading.through(&self.ahead(z), self.behind(z), self.late(z))
    }

    /// The dead time, which all chains of its sensor have.
    pub fn late(&self, z: C64) -> C64 {
        z.powi(-self.late)
    }

    /// Lags of actuator and water, which all chains behind them have: `(z - Phi) v = Gamma`, Phi lower triangular.
    pub fn ahead(&self, z: C64) -> [C64; MOST - 1] {
        let mut v = [Complex::new(0.0, 0.0); MOST - 1];
        for i in 0..self.ahead {
            let before: C64 = (0..i).map(|k| v[k] * self.phi[i][k]).sum();
            v[i] = (before + self.gamma[i]) / (z - self.phi[i][i]);
        }
        v
    }

    /// The lag of the sensor alone, which all its chains have.
    pub fn behind(&self, z: C64) -> C64 {
        if self.n > self.ahead { (z - self.phi[self.n - 1][self.n - 1]).inv() } else { z }
    }
}

type Square = [[f64; MOST + 1]; MOST + 1];

/// Exponential of a lower triangular matrix of some size, whose other entries are zero: its series for a part so small that it
/// ends, squared as often as that was halved.
fn exponential(matrix: &Square, size: usize) -> Square {
    let entries = || matrix.iter().flatten();
    let largest = entries().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    // Two entries in a row at most.
    let halvings = (2.0 * largest / SMALL).log2().ceil().max(0.0) as i32;
    let part = matrix.map(|row| row.map(|entry| entry * 0.5_f64.powi(halvings)));
    // The series in blocks of four terms, each block times the fourth power of the part (Paterson and Stockmeyer).
    let square = product(&part, &part, size);
    let (cube, fourth) = (product(&square, &part, size), product(&square, &square, size));
    let powers = [identity(), part, square, cube];
    let mut sum = [[0.0; MOST + 1]; MOST + 1];
    for block in (0..BLOCKS).rev() {
        if block + 1 < BLOCKS {
            sum = product(&sum, &fourth, size);
        }
        for (k, power) in powers.iter().enumerate() {
            let share = 1.0 / (1..=4 * block + k).map(|i| i as f64).product::<f64>();
            for (sum, entry) in sum.iter_mut().flatten().zip(power.iter().flatten()) {
                *sum += share * entry;
            }
        }
    }
    (0..halvings).fold(sum, |power, _| product(&power, &power, size))
}

fn identity() -> Square {
    std::array::from_fn(|i| std::array::from_fn(|k| if i == k { 1.0 } else { 0.0 }))
}

/// Product of lower triangular matrices of some size.
fn product(a: &Square, b: &Square, size: usize) -> Square {
    let mut product = [[0.0; MOST + 1]; MOST + 1];
    for (i, (row, a)) in product.iter_mut().zip(a).take(size).enumerate() {
        for (k, (share, b)) in a.iter().zip(b).take(i + 1).enumerate() {
            row[..=k].iter_mut().zip(b).for_each(|(entry, b)| *entry += share * b);
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sampled_chain_answers_like_the_chain_when_sampled_often() {
        let chain = Chain::new(2.0, 0.4, 1.0, 1.03);
        for omega in [0.05, 0.6, 2.0] {
            let s = Complex::new(0.01, omega);
            let h = 1e-3;
            let hold = (1.0 - (-s * h).exp()) / (s * h);
            let sampled = chain.sampled(h).at((s * h).exp());
            assert!((sampled - chain.at(s) * hold).norm() < 1e-5, "{omega}");
        }
        // One lag of 1 s every second: (1 - 1/e)/(z - 1/e), by hand
        let one = Chain::new(0.0, 0.0, 1.0, 0.0);
        let (z, e) = (Complex::new(0.3, 0.8), (-1.0_f64).exp());
        assert!((one.sampled(1.0).at(z) - (1.0 - e) / (z - e)).norm() < 1e-12);
        // 0.4 s late: z^-1 of what the lag is after 0.6 s
        let late = Chain::new(0.0, 0.0, 1.0, 0.4).sampled(1.0).at(z);
        let rest = (-0.6_f64).exp();
        let by_hand = (rest * (1.0 - e) / (z - e) + (1.0 - rest)) / z;
        assert!((late - by_hand).norm() < 1e-12);
    }
}
