//! What a nearly right model leaves behind, by sensor and run: noise that is new in every sample, and a slow error.
//!
//! **Equation** `r_i = x_i + s sigma_i e_i`, `x` an autoregressive process of first order in time:
//! `x(t + dt) = x(t) exp(-dt/theta) + ...`, of standard deviation `tau`. Residuals are whitened by the Kalman filter:
//! `e_i = (r_i - m_i)/sqrt(P_i + s^2 sigma_i^2)`, `m` and `P` what is known of `x` from the samples before. `tau`, `theta` and `s`
//! maximise the likelihood of the residuals of the best fit, on a grid; each must gain half of `ln n` per parameter (BIC).
//!
//! Before, what sigma holds beside the noise of the sensor (`sigma_i^2 = n^2 + u_i^2`: the moment of a reading, the step, what the
//! inputs did between two readings) is scaled: `n^2 + b^2 u_i^2`, `b` the most probable one where `b^2` is known beforehand as by
//! `KNOWN` samples (inverse gamma distribution around 1). It was predicted from a few simulations, and is often half or twice as much.
//!
//! **Assumptions** a slow error (surroundings that drift, an offset that wanders) is of one size at all times; a front, where
//! sigma is large, is not taken for slow. As if each sample were new, small slow flaws would speak far too loudly. The noise is
//! at least what the sensors promise: `s >= 1`. The prediction of what is beside it is right to a factor of two upwards.
//!
//! **Sources** Kalman 1960 (key `kalman1960`).

/// Standard deviations of the slow error over the median sigma.
const SLOW: [f64; 8] = [0.3, 0.5, 0.8, 1.2, 2.0, 4.0, 8.0, 16.0];
/// Its times over the interval of the samples.
const TIMES: [f64; 6] = [3.0, 6.0, 12.0, 30.0, 80.0, 250.0];
/// Noise over what the sensors promise.
const SCALES: [f64; 7] = [1.0, 1.3, 1.7, 2.3, 3.2, 5.0, 10.0];

/// What is beside the noise of a sensor, over what was predicted.
const BESIDE: [f64; 13] = [0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.4, 1.7, 2.0];
/// The prediction counts as much as so many samples.
const KNOWN: f64 = 10.0;

/// A residual: time in s, value and sigma in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Time, s.
    pub time_s: f64,
    /// Value, SI.
    pub value: f64,
    /// Standard deviation, SI.
    pub sigma: f64,
}

/// Noise and slow error of one sensor in one run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation of the slow error, SI.
    pub slow: f64,
    /// Its time, s.
    pub time_s: f64,
    /// Noise over sigma.
    pub scale: f64,
}

/// One sample of the filter: what is kept of the error known so far, how much a sample says of it, and one over the
/// standard deviation of what is new.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    decay: f64,
    gain: f64,
    inverse: f64,
}

impl Noise {
    /// As the sensors promise: every sample is new.
    pub const WHITE: Self = Self { slow: 0.0, time_s: 1.0, scale: 1.0 };

    /// Of the residuals of a run in the order of time.
    pub fn of(residuals: &[Residual]) -> Self {
        let n = residuals.len();
        if n < 10 {
            return Self::WHITE;
        }
        let mut sigmas: Vec<f64> = residuals.iter().map(|r| r.sigma).collect();
        sigmas.sort_by(f64::total_cmp);
        let mut intervals: Vec<f64> =
            residuals.windows(2).map(|p| p[1].time_s - p[0].time_s).collect();
        intervals.sort_by(f64::total_cmp);
        let (sigma, interval_s) = (sigmas[n / 2], intervals[n / 2].max(1e-9));
        let price = 0.5 * (n as f64).ln();
        let mut best = (f64::NEG_INFINITY, Self::WHITE);
        for scale in SCALES {
            let mut consider = |noise: Self, parameters: f64| {
                let score = noise.log_likelihood(residuals) - parameters * price;
                if score > best.0 {
                    best = (score, noise);
                }
            };
            let scaled = if scale > 1.0 { 1.0 } else { 0.0 };
            consider(Self { scale, ..Self::WHITE }, scaled);
            for slow in SLOW {
                for time in TIMES {
                    let noise = Self { slow: slow * sigma, time_s: time * interval_s, scale };
                    consider(noise, scaled + 2.0);
                }
            }
        }
        best.1
    }

    /// The filter for samples at these times with these sigmas.
    pub fn gains(&self, residuals: &[Residual]) -> Vec<Gain> {
        let variance = self.slow * self.slow;
        let mut known = variance;
        let mut last: Option<f64> = None;
        let one = |r: &Residual| {
            let decay = last.map_or(0.0, |last| (-(r.time_s - last) / self.time_s).exp());
            let before = decay * decay * known + (1.0 - decay * decay) * variance;
            let total = before + (self.scale * r.sigma).powi(2);
            let gain = before / total;
            known = (1.0 - gain) * before;
            last = Some(r.time_s);
            Gain { decay, gain, inverse: 1.0 / total.sqrt() }
        };
        residuals.iter().map(one).collect()
    }

    fn log_likelihood(&self, residuals: &[Residual]) -> f64 {
        let gains = self.gains(residuals);
        let new = whitened(&gains, residuals.iter().map(|r| r.value));
        let terms = new.zip(&gains).map(|(e, gain)| gain.inverse.ln() - 0.5 * e * e);
        terms.sum()
    }
}

/// Standard deviation of a sample of which the sensor promises `noise`, with what is beside it scaled.
pub fn scaled(sigma: f64, noise: f64, scale: f64) -> f64 {
    let beside = (sigma * sigma - noise * noise).max(0.0);
    (noise * noise + scale * scale * beside).sqrt()
}

/// The most probable scale of what sigma holds beside the noise of the sensor.
pub fn scale_beside(residuals: &[Residual], noise: f64) -> f64 {
    let score = |scale: f64| {
        let of = |r: &Residual| {
            let sigma = scaled(r.sigma, noise, scale);
            -sigma.ln() - 0.5 * (r.value / sigma).powi(2)
        };
        let square = scale * scale;
        residuals.iter().map(of).sum::<f64>() - 0.5 * KNOWN * (square.ln() + 1.0 / square)
    };
    let better = |a: &f64, b: &f64| score(*a).total_cmp(&score(*b));
    BESIDE.into_iter().max_by(better).unwrap_or(1.0)
}

/// What is new in values, over its standard deviation.
pub fn whitened<'a>(
    gains: &'a [Gain],
    values: impl Iterator<Item = f64> + 'a,
) -> impl Iterator<Item = f64> + 'a {
    let mut known = 0.0;
    gains.iter().zip(values).map(move |(gain, value)| {
        let expected = gain.decay * known;
        known = expected + gain.gain * (value - expected);
        (value - expected) * gain.inverse
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg32;

    fn residuals(slow: f64, decay: f64, noise: f64) -> Vec<Residual> {
        let mut random = Pcg32::new(3, 5);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let mut x = 0.0;
        let one = |i| {
            x = decay * x + slow * (1.0 - decay * decay).sqrt() * normal();
            Residual { time_s: 10.0 * f64::from(i), value: x + noise * normal(), sigma: 1.0 }
        };
        (0..3000).map(one).collect()
    }

    #[test]
    fn noise_and_slow_error_are_told_apart() {
        let white = Noise::of(&residuals(0.0, 0.0, 1.0));
        assert_eq!(white, Noise::WHITE);
        assert_eq!(Noise::of(&residuals(0.0, 0.0, 0.3)), Noise::WHITE);
        let loud = Noise::of(&residuals(0.0, 0.0, 2.3));
        assert_eq!((loud.slow, loud.scale), (0.0, 2.3));
        // exp(-10/300) = 0.967.
        let slow = Noise::of(&residuals(2.0, 0.967, 1.0));
        assert_eq!(slow.scale, 1.0);
        assert!(
            (1.0..4.1).contains(&slow.slow) && (100.0..900.0).contains(&slow.time_s),
            "{slow:?}"
        );
    }

    #[test]
    fn what_is_beside_the_noise_is_as_large_as_the_data_say() {
        // Fronts of which 3 K were foretold beside a noise of 1 K, that leave 1.2 K: sqrt(1 + 0.16 * 9) = 1.56 K, b = 0.4.
        let of = |count: usize, size: f64| {
            let all = residuals(0.0, 0.0, size).into_iter().take(count);
            let foretold: Vec<Residual> =
                all.map(|r| Residual { sigma: 10.0_f64.sqrt(), ..r }).collect();
            scale_beside(&foretold, 1.0)
        };
        assert!((of(3000, 1.562) - 0.4).abs() < 0.11, "{}", of(3000, 1.562));
        assert_eq!(of(0, 1.0), 1.0);
        // Four samples change little of what is known as by ten; twice is the most.
        assert!(of(4, 1.562) >= 0.7, "{}", of(4, 1.562));
        assert_eq!(of(3000, 20.0), 2.0);
        // The noise of the sensor stays.
        assert_eq!(scaled(10.0_f64.sqrt(), 1.0, 0.0), 1.0);
    }

    #[test]
    fn what_is_new_is_white_and_of_variance_one() {
        let r = residuals(2.0, 0.967, 1.0);
        let noise = Noise { slow: 2.0, time_s: 300.0, scale: 1.0 };
        let gains = noise.gains(&r);
        let e: Vec<f64> = whitened(&gains, r.iter().map(|r| r.value)).collect();
        let n = e.len() as f64;
        let square = e.iter().map(|e| e * e).sum::<f64>() / n;
        let beside = e.windows(2).map(|p| p[0] * p[1]).sum::<f64>() / n;
        assert!((square - 1.0).abs() < 0.08 && beside.abs() < 0.06, "{square} {beside}");
    }
}
