//! From the command of an actuator to the reading of a sensor: lags and a dead time, without their gain.
//!
//! **Equation** `exp(-s theta)/((1 + s T)^2 (1 + s tau_w) (1 + s tau))`, tau_w a lag of the water; sampled at the interval h with the command held in
//! between, `theta = n h + delta`: `z^-(n+1) (Phi(h - delta) (z - Phi(h))^-1 Gamma(h) + Gamma(h - delta))`, exact.
//! **Sources** `astrom2011`.

use nalgebra::{Complex, DMatrix};

type C64 = Complex<f64>;

/// Lags in a row: those of an actuator, that of the water, that of a sensor.
const MOST: usize = 4;
/// Norm below which so many terms of the series of an exponential are all: 0.25^12/12! is 1e-16.
const SMALL: f64 = 0.25;
const TERMS: i32 = 12;

/// A chain of lags with a dead time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chain {
    /// Time constants, s; without those that are zero.
    lags_s: Vec<f64>,
    /// How many of them are those of actuator and water.
    ahead: usize,
    dead_s: f64,
}

/// A chain sampled at an interval.
#[derive(Debug, Clone)]
pub(super) struct SampledChain {
    n: usize,
    /// Lags of actuator and water; one more is that of the sensor.
    ahead: usize,
    /// Whole samples of the dead time.
    late: i32,
    phi: [[f64; MOST]; MOST],
    gamma: [f64; MOST],
    reading: Reading,
}

/// How the last lag of a sampled chain, the reading, follows the ones before it.
#[derive(Debug, Clone, Copy)]
struct Reading {
    /// Over a whole interval, from each lag and from the command.
    by_ahead: [f64; MOST - 1],
    by_command: f64,
    /// Over the rest of an interval, from each lag, from the command, and from the lag of the sensor itself.
    by_ahead_rest: [f64; MOST - 1],
    by_command_rest: f64,
    by_itself_rest: f64,
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
        Self { lags_s: all.into_iter().filter(|lag| *lag > 0.0).collect(), ahead, dead_s }
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
        let (n, ahead) = (self.lags_s.len(), self.ahead);
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
        let n = self.lags_s.len();
        let mut rates = [[0.0; MOST + 1]; MOST + 1];
        for (i, lag_s) in self.lags_s.iter().enumerate() {
            rates[i][i] = -time_s / lag_s;
            let driver = if i == 0 { n } else { i - 1 };
            rates[i][driver] = time_s / lag_s;
        }
        let step = exponential(&rates);
        let (mut phi, mut gamma) = ([[0.0; MOST]; MOST], [0.0; MOST]);
        for ((phi, gamma), step) in phi.iter_mut().zip(&mut gamma).zip(&step).take(n) {
            *gamma = step[n];
            phi[..n].copy_from_slice(&step[..n]);
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
    fn late(&self, z: C64) -> C64 {
        z.powi(-self.late)
    }

    /// Lags of actuator and water, which all chains behind them have: `(z - Phi) v = Gamma`, Phi lower triangular.
    fn ahead(&self, z: C64) -> [C64; MOST - 1] {
        let mut v = [Complex::new(0.0, 0.0); MOST - 1];
        for i in 0..self.ahead {
            let before: C64 = (0..i).map(|k| v[k] * self.phi[i][k]).sum();
            v[i] = (before + self.gamma[i]) / (z - self.phi[i][i]);
        }
        v
    }

    /// The lag of the sensor alone, which all its chains have.
    fn behind(&self, z: C64) -> C64 {
        if self.n > self.ahead { (z - self.phi[self.n - 1][self.n - 1]).inv() } else { z }
    }
}

/// The chains from all outputs to all measured values; what they share is worked out once.
pub(super) struct Chains {
    /// Actuators and sensors, each kind once.
    actuator_lags_s: Vec<f64>,
    sensors: Vec<Seen>,
    actuator_of: Vec<usize>,
    sensor_of: Vec<usize>,
    /// Sensor by sensor; empty where the controllers are continuous.
    sampled: Vec<SampledChain>,
    /// Their readings: all that differs from pair to pair.
    readings: Vec<Reading>,
    /// Lag of the water in all of them, s.
    water_lag_s: f64,
    interval_s: f64,
}

/// A sensor of a measured value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    pub lag_s: f64,
    pub dead_s: f64,
}

impl Chains {
    /// Chains of outputs with actuators of these lags and of values with these sensors, with a lag of the water or none
    /// between them; the interval is 0 where the controllers are continuous.
    pub fn new(actuator_lags_s: &[f64], seen: &[Seen], water_lag_s: f64, interval_s: f64) -> Self {
        let (lags, actuator_of) = kinds(actuator_lags_s);
        let (sensors, sensor_of) = kinds(seen);
        let pairs = sensors.iter().flat_map(|seen| lags.iter().map(move |lag| (*lag, *seen)));
        let chain = |(lag_s, seen): (f64, Seen)| {
            Chain::new(lag_s, water_lag_s, seen.lag_s, seen.dead_s).sampled(interval_s)
        };
        let sampled: Vec<_> =
            if interval_s > 0.0 { pairs.map(chain).collect() } else { Vec::new() };
        let readings = sampled.iter().map(|chain| chain.reading).collect();
        Self {
            actuator_lags_s: lags,
            sensors,
            actuator_of,
            sensor_of,
            sampled,
            readings,
            water_lag_s,
            interval_s,
        }
    }

    /// Whether all chains are one.
    pub fn alike(&self) -> bool {
        self.actuator_lags_s.len() == 1 && self.sensors.len() == 1
    }

    /// z where the controllers are sampled, otherwise s itself.
    pub fn variable(&self, s: C64) -> C64 {
        if self.interval_s > 0.0 { (s * self.interval_s).exp() } else { s }
    }

    /// The answers of all measured values (rows) to all commands at a complex frequency, with their gains.
    pub fn plant(&self, s: C64, gains: &DMatrix<f64>) -> DMatrix<C64> {
        let (n, z) = (self.actuator_lags_s.len(), self.variable(s));
        let (of, to) = (&self.sensor_of, &self.actuator_of);
        if self.sampled.is_empty() {
            let ahead: Vec<C64> = self
                .actuator_lags_s
                .iter()
                .map(|lag| Chain::new(*lag, self.water_lag_s, 0.0, 0.0).at(s))
                .collect();
            let behind: Vec<C64> = self
                .sensors
                .iter()
                .map(|seen| Chain::new(0.0, 0.0, seen.lag_s, seen.dead_s).at(s))
                .collect();
            return gains.map_with_location(|i, j, gain| behind[of[i]] * (ahead[to[j]] * gain));
        }
        let ahead: Vec<_> = self.sampled[..n].iter().map(|chain| chain.ahead(z)).collect();
        let first = self.sampled.iter().step_by(n);
        let behind: Vec<_> = first.map(|chain| (chain.behind(z), chain.late(z))).collect();
        gains.map_with_location(|i, j, gain| {
            let (behind, late) = behind[of[i]];
            self.readings[of[i] * n + to[j]].through(&ahead[to[j]], behind, late) * gain
        })
    }

    /// The answer of one value to one command.
    pub fn one(&self, i: usize, j: usize, s: C64) -> C64 {
        let n = self.actuator_lags_s.len();
        match self.sampled.get(self.sensor_of[i] * n + self.actuator_of[j]) {
            Some(sampled) => sampled.at(self.variable(s)),
            None => self.continuous(i, j, s),
        }
    }

    /// The answer of one value to one command that changes without a pause.
    pub fn continuous(&self, i: usize, j: usize, s: C64) -> C64 {
        self.chain(i, j).at(s)
    }

    /// All times between an output and a value added up, s.
    pub fn total_s(&self, i: usize, j: usize) -> f64 {
        self.chain(i, j).total_s()
    }

    fn chain(&self, i: usize, j: usize) -> Chain {
        let seen = self.sensors[self.sensor_of[i]];
        let actuator_lag_s = self.actuator_lags_s[self.actuator_of[j]];
        Chain::new(actuator_lag_s, self.water_lag_s, seen.lag_s, seen.dead_s)
    }

    /// The fastest and the slowest of all times added up, s.
    pub fn times_s(&self) -> (f64, f64) {
        let range = |all: &mut dyn Iterator<Item = f64>| {
            all.fold((f64::INFINITY, 0.0), |(min, max): (f64, f64), t| (min.min(t), max.max(t)))
        };
        let ahead = range(&mut self.actuator_lags_s.iter().map(|lag| 2.0 * lag));
        let behind = range(&mut self.sensors.iter().map(|seen| seen.lag_s + seen.dead_s));
        let water_s = self.water_lag_s;
        let least = (ahead.0 + water_s + behind.0).max(self.interval_s);
        (least, (ahead.1 + water_s + behind.1).max(self.interval_s))
    }

    /// The longest dead time, s.
    pub fn dead_s(&self) -> f64 {
        self.sensors.iter().fold(self.interval_s, |longest, seen| longest.max(seen.dead_s))
    }
}

type Square = [[f64; MOST + 1]; MOST + 1];

/// Exponential of a matrix: its series for a part so small that it ends, squared as often as that was halved.
fn exponential(matrix: &Square) -> Square {
    let entries = || matrix.iter().flatten();
    let largest = entries().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
    // Two entries in a row at most.
    let halvings = (2.0 * largest / SMALL).log2().ceil().max(0.0) as i32;
    let part = matrix.map(|row| row.map(|entry| entry * 0.5_f64.powi(halvings)));
    let mut sum = [[0.0; MOST + 1]; MOST + 1];
    (0..=MOST).for_each(|i| sum[i][i] = 1.0);
    let mut term = sum;
    for k in 1..=TERMS {
        term = product(&term, &part).map(|row| row.map(|entry| entry / f64::from(k)));
        for (sum, term) in sum.iter_mut().flatten().zip(term.iter().flatten()) {
            *sum += term;
        }
    }
    (0..halvings).fold(sum, |power, _| product(&power, &power))
}

fn product(a: &Square, b: &Square) -> Square {
    let mut product = [[0.0; MOST + 1]; MOST + 1];
    for (row, a) in product.iter_mut().zip(a) {
        for (share, b) in a.iter().zip(b) {
            row.iter_mut().zip(b).for_each(|(entry, b)| *entry += share * b);
        }
    }
    product
}

/// What is different in a list, and which of it each entry is.
fn kinds<T: Copy + PartialEq>(all: &[T]) -> (Vec<T>, Vec<usize>) {
    let mut kinds: Vec<T> = Vec::new();
    let of = all.iter().map(|one| {
        kinds.iter().position(|kind| kind == one).unwrap_or_else(|| {
            kinds.push(*one);
            kinds.len() - 1
        })
    });
    let of = of.collect();
    (kinds, of)
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
        // What chains share does not change them.
        let seen = [(0.0, 0.4), (0.7, 0.0), (0.7, 1.0), (0.7, 0.0)];
        let seen = seen.map(|(lag_s, dead_s)| Seen { lag_s, dead_s });
        let lags_s = [1.5, 0.0, 0.6];
        let s = Complex::new(-0.02, 0.9);
        for (interval_s, water_s) in [(0.0, 0.0), (0.5, 0.0), (0.0, 0.8), (0.5, 0.8)] {
            let chains = Chains::new(&lags_s, &seen, water_s, interval_s);
            let all = chains.plant(s, &DMatrix::from_element(4, 3, 1.0));
            for (i, seen) in seen.iter().enumerate() {
                for (j, lag_s) in lags_s.iter().enumerate() {
                    let chain = Chain::new(*lag_s, water_s, seen.lag_s, seen.dead_s);
                    let alone = match interval_s {
                        0.0 => chain.at(s),
                        h => chain.sampled(h).at((s * h).exp()),
                    };
                    assert!((all[(i, j)] - alone).norm() < 1e-13);
                    assert!((chains.one(i, j, s) - alone).norm() < 1e-13);
                }
            }
        }
    }
}
