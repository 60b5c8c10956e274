//! The chains from all outputs of a group to all its measured values (`chain.rs`), with what they share worked out once.

use super::chain::{Chain, MOST, Reading, SampledChain};
use super::elimination::Rows;
use super::in_pieces;
use super::lanes::{RowMut, in_vectors};
use nalgebra::{Complex, DMatrix};

type C64 = Complex<f64>;

/// The chains from all outputs to all measured values; what they share is worked out once.
pub(super) struct Chains {
    /// Actuators and sensors, each kind once.
    actuator_lags_s: Vec<f64>,
    sensors: Vec<Seen>,
    actuator_of: Vec<usize>,
    sensor_of: Vec<usize>,
    /// Sensor by sensor; empty where the controllers are continuous.
    sampled: Vec<SampledChain>,
    /// The readings of each sensor: all that differs from pair to pair.
    readings: Vec<Readings>,
    /// Lag of the water in all of them, s.
    water_lag_s: f64,
    interval_s: f64,
}

/// How a sensor follows each of the outputs: [`Reading`] with its numbers side by side.
struct Readings {
    by_ahead: [Vec<f64>; MOST - 1],
    by_command: Vec<f64>,
    by_ahead_rest: [Vec<f64>; MOST - 1],
    by_command_rest: Vec<f64>,
    by_itself_rest: Vec<f64>,
}

impl Readings {
    /// Those of one sensor, from its chains behind each kind of actuator and the kind of each output.
    fn of(chains: &[SampledChain], kind: &[usize]) -> Self {
        let each = |number: &dyn Fn(&Reading) -> f64| -> Vec<f64> {
            kind.iter().map(|kind| number(&chains[*kind].reading)).collect()
        };
        Self {
            by_ahead: std::array::from_fn(|k| each(&|reading| reading.by_ahead[k])),
            by_command: each(&|reading| reading.by_command),
            by_ahead_rest: std::array::from_fn(|k| each(&|reading| reading.by_ahead_rest[k])),
            by_command_rest: each(&|reading| reading.by_command_rest),
            by_itself_rest: each(&|reading| reading.by_itself_rest),
        }
    }

    /// The readings for each output behind its lags, in `rest`, where `behind` is the lag of the sensor itself; `before`
    /// is work space.
    #[inline(always)]
    fn follow(
        &self,
        ahead: &[Apart],
        behind: C64,
        (before_re, before_im): RowMut,
        (rest_re, rest_im): RowMut,
    ) {
        let n = self.by_command.len();
        let (before_re, before_im) = (&mut before_re[..n], &mut before_im[..n]);
        let (rest_re, rest_im) = (&mut rest_re[..n], &mut rest_im[..n]);
        before_re.copy_from_slice(&self.by_command);
        rest_re.copy_from_slice(&self.by_command_rest);
        before_im.fill(0.0);
        rest_im.fill(0.0);
        for ((ahead, now), later) in ahead.iter().zip(&self.by_ahead).zip(&self.by_ahead_rest) {
            add_products(before_re, &ahead.re, now);
            add_products(before_im, &ahead.im, now);
            add_products(rest_re, &ahead.re, later);
            add_products(rest_im, &ahead.im, later);
        }
        let before = before_re.iter().zip(before_im.iter()).zip(&self.by_itself_rest);
        let rest = rest_re.iter_mut().zip(rest_im.iter_mut());
        for (((re, im), itself), (rest_re, rest_im)) in before.zip(rest) {
            *rest_re += (behind.re * re - behind.im * im) * itself;
            *rest_im += (behind.re * im + behind.im * re) * itself;
        }
    }
}

/// Complex numbers of the outputs, real and imaginary parts apart.
struct Apart {
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Apart {
    fn of(values: impl Iterator<Item = C64>) -> Self {
        let (re, im) = values.map(|value| (value.re, value.im)).unzip();
        Self { re, im }
    }
}

/// `sum += a b`, one by one.
#[inline(always)]
fn add_products(sum: &mut [f64], a: &[f64], b: &[f64]) {
    sum.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
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
        let behind = |seen: &Seen| -> Vec<SampledChain> {
            let chain = |lag_s: &f64| Chain::new(*lag_s, water_lag_s, seen.lag_s, seen.dead_s);
            lags.iter().map(|lag_s| chain(lag_s).sampled(interval_s)).collect()
        };
        let count = if interval_s > 0.0 { sensors.len() } else { 0 };
        let sampled = in_pieces(count, count, |i| behind(&sensors[i])).concat();
        let of_sensor = sampled.chunks(lags.len().max(1));
        let readings = of_sensor.map(|chains| Readings::of(chains, &actuator_of)).collect();
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

    /// The answers of all measured values (rows) to all commands (columns) at a complex frequency, with their gains: of
    /// commands (rows) on values (columns).
    pub fn plant(&self, s: C64, gains: &DMatrix<f64>) -> Rows {
        let (n, of) = (self.actuator_of.len(), &self.sensor_of);
        let mut plant = Rows::zeros(of.len(), n);
        if n == 0 {
            return plant;
        }
        if self.sampled.is_empty() {
            let lag = |kind: &usize| self.actuator_lags_s[*kind];
            let chain = |lag_s| Chain::new(lag_s, self.water_lag_s, 0.0, 0.0).at(s);
            let ahead = Apart::of(self.actuator_of.iter().map(|kind| chain(lag(kind))));
            in_vectors(
                #[inline(always)]
                || {
                    let gains = gains.as_slice().chunks_exact(n);
                    for ((i, kind), gains) in of.iter().enumerate().zip(gains) {
                        let seen = self.sensors[*kind];
                        let behind = Chain::new(0.0, 0.0, seen.lag_s, seen.dead_s).at(s);
                        with_gains(behind, (&ahead.re, &ahead.im), gains, plant.row_mut(i));
                    }
                },
            );
            return plant;
        }
        let (z, kinds) = (self.variable(s), self.actuator_lags_s.len());
        let ahead: Vec<_> = self.sampled[..kinds].iter().map(|chain| chain.ahead(z)).collect();
        let most = self.sampled[..kinds].iter().map(|chain| chain.ahead).max().unwrap_or(0);
        let lag = |k: usize| Apart::of(self.actuator_of.iter().map(|kind| ahead[*kind][k]));
        let ahead: Vec<Apart> = (0..most).map(lag).collect();
        let (mut before, mut rest) = (Rows::zeros(1, n), Rows::zeros(1, n));
        in_vectors(
            #[inline(always)]
            || {
                for ((i, kind), gains) in
                    of.iter().enumerate().zip(gains.as_slice().chunks_exact(n))
                {
                    let chain = &self.sampled[kind * kinds];
                    let readings = &self.readings[*kind];
                    readings.follow(&ahead, chain.behind(z), before.row_mut(0), rest.row_mut(0));
                    with_gains(chain.late(z), rest.row(0), gains, plant.row_mut(i));
                }
            },
        );
        plant
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

/// `own = share other gains`, one by one.
#[inline(always)]
fn with_gains(
    share: C64,
    (other_re, other_im): (&[f64], &[f64]),
    gains: &[f64],
    own: (&mut [f64], &mut [f64]),
) {
    let other = other_re.iter().zip(other_im).zip(gains);
    for ((re, im), ((a, b), gain)) in own.0.iter_mut().zip(own.1).zip(other) {
        *re = (share.re * a - share.im * b) * gain;
        *im = (share.re * b + share.im * a) * gain;
    }
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
    fn what_chains_share_does_not_change_them() {
        let seen = [(0.0, 0.4), (0.7, 0.0), (0.7, 1.0), (0.7, 0.0)];
        let seen = seen.map(|(lag_s, dead_s)| Seen { lag_s, dead_s });
        let lags_s = [1.5, 0.0, 0.6];
        let s = Complex::new(-0.02, 0.9);
        for (interval_s, water_s) in [(0.0, 0.0), (0.5, 0.0), (0.0, 0.8), (0.5, 0.8)] {
            let chains = Chains::new(&lags_s, &seen, water_s, interval_s);
            let all = chains.plant(s, &DMatrix::from_element(3, 4, 1.0));
            for (i, seen) in seen.iter().enumerate() {
                for (j, lag_s) in lags_s.iter().enumerate() {
                    let chain = Chain::new(*lag_s, water_s, seen.lag_s, seen.dead_s);
                    let alone = match interval_s {
                        0.0 => chain.at(s),
                        h => chain.sampled(h).at((s * h).exp()),
                    };
                    assert!((all.at(i, j) - alone).norm() < 1e-13);
                    assert!((chains.one(i, j, s) - alone).norm() < 1e-13);
                }
            }
        }
    }
}
