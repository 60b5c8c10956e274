//! What a nearly right model leaves behind, by sensor and run: noise that is new in every sample, and a slow error.
//!
//! **Equation** `r_i = x_i + s sigma_i e_i`, `x` an autoregressive process of first order in time:
//! `x(t + dt) = x(t) exp(-dt/theta) + ...`, of standard deviation `tau`. Residuals are whitened by the Kalman filter:
//! `e_i = (r_i - m_i)/sqrt(P_i + s^2 sigma_i^2)`, `m` and `P` what is known of `x` from the samples before. `tau`, `theta` and `s`
//! maximise the likelihood of the residuals of the best fit, on a grid; each must gain half of `ln n` per parameter (BIC).
//!
//! Before, what sigma holds beside what is known well (`sigma_i^2 = n_i^2 + u_i^2`: `n` the noise of the sensor and the moments of
//! switches, `u` the moment of a reading, the step, what the inputs did between two readings) is scaled: `n_i^2 + b^2 u_i^2`, `b` the most probable one where `b^2` is known beforehand as by
//! `KNOWN` samples (inverse gamma distribution around 1). It was predicted from a few simulations, and is often half or twice as much.
//!
//! What is new is normally distributed, or after Student with four degrees of freedom where that gains half of `ln n`: of a switch
//! between two readings a sample or two may lie ten sigma off, and would speak louder than all others.
//!
//! **Assumptions** a slow error (surroundings that drift, an offset that wanders) is of one size at all times; a front, where
//! sigma is large, is not taken for slow. As if each sample were new, small slow flaws would speak far too loudly. The noise is
//! at least what the sensors promise: `s >= 1`. The prediction of what is beside it is right to a factor of two upwards.
//!
//! **Sources** Kalman 1960 (key `kalman1960`), Lange, Little, Taylor 1989 (key `lange1989`).

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
    /// How what is new is distributed.
    pub tails: Tails,
}

/// Distribution of what is new in a sample, over its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tails {
    /// Normal.
    Normal,
    /// Student's with four degrees of freedom: now and then a sample lies far off.
    Heavy,
}

impl Tails {
    const FREEDOM: f64 = 4.0;

    /// Twice the fall of the logarithm of the density from its top.
    fn fall(self, e: f64) -> f64 {
        match self {
            Self::Normal => e * e,
            Self::Heavy => (Self::FREEDOM + 1.0) * (e * e / Self::FREEDOM).ln_1p(),
        }
    }

    /// Logarithm of the density at its top over that of the normal distribution.
    fn top(self) -> f64 {
        match self {
            Self::Normal => 0.0,
            // 3/8 over 1/sqrt(2 pi).
            Self::Heavy => (0.375 * std::f64::consts::TAU.sqrt()).ln(),
        }
    }

    /// What has the fall as its square, and its slope: residuals as a least-squares fit has to see them.
    pub fn counted(self, e: f64) -> (f64, f64) {
        let value = self.fall(e).sqrt().copysign(e);
        let at_zero = ((Self::FREEDOM + 1.0) / Self::FREEDOM).sqrt();
        let slope = match self {
            Self::Normal => 1.0,
            Self::Heavy if e.abs() < 1e-4 => at_zero,
            Self::Heavy => at_zero * at_zero * e / (1.0 + e * e / Self::FREEDOM) / value,
        };
        (value, slope)
    }
}

/// One sample of the filter: what is kept of the error known so far, how much a sample says of it, and one over the
/// standard deviation of what is new, with its distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    decay: f64,
    gain: f64,
    inverse: f64,
    /// How what is new is distributed.
    pub tails: Tails,
}

impl Noise {
    /// As the sensors promise: every sample is new.
    pub const WHITE: Self = Self { slow: 0.0, time_s: 1.0, scale: 1.0, tails: Tails::Normal };

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
                for (score, tails) in noise.log_likelihoods(residuals) {
                    let more = if tails == Tails::Heavy { 1.0 } else { 0.0 };
                    let score = score - (parameters + more) * price;
                    if score > best.0 {
                        best = (score, Self { tails, ..noise });
                    }
                }
            };
            let scaled = if scale > 1.0 { 1.0 } else { 0.0 };
            consider(Self { scale, ..Self::WHITE }, scaled);
            for slow in SLOW {
                for time in TIMES {
                    let (slow, time_s) = (slow * sigma, time * interval_s);
                    let noise = Self { slow, time_s, scale, ..Self::WHITE };
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
            Gain { decay, gain, inverse: 1.0 / total.sqrt(), tails: self.tails }
        };
        residuals.iter().map(one).collect()
    }

    /// Logarithms of the likelihood with normal and with heavy tails, but for the same constant.
    fn log_likelihoods(&self, residuals: &[Residual]) -> [(f64, Tails); 2] {
        let gains = self.gains(residuals);
        let scales: f64 = gains.iter().map(|gain| gain.inverse.ln()).sum();
        let new: Vec<f64> = whitened(&gains, residuals.iter().map(|r| r.value)).collect();
        [Tails::Normal, Tails::Heavy].map(|tails| {
            let terms = new.iter().map(|e| tails.top() - 0.5 * tails.fall(*e));
            (scales + terms.sum::<f64>(), tails)
        })
    }
}

/// A residual and what was predicted of it, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    /// Value.
    pub value: f64,
    /// Standard deviation.
    pub sigma: f64,
    /// Of it what is known well.
    pub known: f64,
}

impl Predicted {
    /// Standard deviation with what is beside the known part scaled.
    pub fn scaled(&self, scale: f64) -> f64 {
        let beside = (self.sigma * self.sigma - self.known * self.known).max(0.0);
        (self.known * self.known + scale * scale * beside).sqrt()
    }
}

/// The most probable scale of what was predicted beside what is known well; a few samples far off say little of it.
pub fn scale_beside(residuals: &[Predicted]) -> f64 {
    let score = |scale: f64, tails: Tails| {
        let of = |r: &Predicted| {
            let sigma = r.scaled(scale);
            tails.top() - sigma.ln() - 0.5 * tails.fall(r.value / sigma)
        };
        let square = scale * scale;
        residuals.iter().map(of).sum::<f64>() - 0.5 * KNOWN * (square.ln() + 1.0 / square)
    };
    let both = |scale: f64| score(scale, Tails::Normal).max(score(scale, Tails::Heavy));
    let better = |a: &f64, b: &f64| both(*a).total_cmp(&both(*b));
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

    /// Of which 3 are predicted beside a known 1.
    fn predicted(value: f64) -> Predicted {
        Predicted { value, sigma: 10.0_f64.sqrt(), known: 1.0 }
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
    fn samples_far_off_are_tails_and_not_noise() {
        // Every fiftieth lies 12 sigma off.
        let mut r = residuals(0.0, 0.0, 1.0);
        r.iter_mut().step_by(50).for_each(|r| r.value += 12.0);
        let found = Noise::of(&r);
        assert_eq!((found.slow, found.scale, found.tails), (0.0, 1.0, Tails::Heavy));
        let of = |r: &Residual| Predicted { known: 0.1, value: r.value, sigma: r.sigma };
        let scale = scale_beside(&r.iter().map(of).collect::<Vec<_>>());
        assert!((0.8..=1.0).contains(&scale), "{scale}");
    }

    #[test]
    fn what_counts_squares_to_the_fall_of_the_density() {
        // Student, four degrees of freedom: (1 + e^2/4)^-2.5, at 2 sigma 2^-2.5: -2 ln = 5 ln 2.
        let (value, slope) = Tails::Heavy.counted(-2.0);
        assert!((value + (5.0 * 2.0_f64.ln()).sqrt()).abs() < 1e-12, "{value}");
        for e in [-30.0, -2.0, -1e-3, 1e-9, 0.5, 3.0] {
            let h = 1e-6;
            let difference =
                (Tails::Heavy.counted(e + h).0 - Tails::Heavy.counted(e - h).0) / (2.0 * h);
            let (_, slope) = Tails::Heavy.counted(e);
            assert!((slope - difference).abs() < 1e-5, "{e}: {slope} {difference}");
        }
        assert!(slope > 0.0);
        assert_eq!(Tails::Normal.counted(-3.0), (-3.0, 1.0));
        // The density of either is one when summed up: exp(top) over sqrt(2 pi) times the fall.
        for tails in [Tails::Normal, Tails::Heavy] {
            let density =
                |e: f64| (tails.top() - 0.5 * tails.fall(e)).exp() / std::f64::consts::TAU.sqrt();
            let sum: f64 = (-40_000..40_000).map(|k| 0.01 * density(0.01 * f64::from(k))).sum();
            assert!((sum - 1.0).abs() < 1e-6, "{sum}");
        }
    }

    #[test]
    fn what_is_beside_the_noise_is_as_large_as_the_data_say() {
        // Fronts of which 3 K were foretold beside a noise of 1 K, that leave 1.2 K: sqrt(1 + 0.16 * 9) = 1.56 K, b = 0.4.
        let of = |count: usize, size: f64| {
            let all = residuals(0.0, 0.0, size).into_iter().take(count);
            let foretold: Vec<Predicted> = all.map(|r| predicted(r.value)).collect();
            scale_beside(&foretold)
        };
        assert!((of(3000, 1.562) - 0.4).abs() < 0.11, "{}", of(3000, 1.562));
        assert_eq!(of(0, 1.0), 1.0);
        // Four samples change little of what is known as by ten; twice is the most.
        assert!(of(4, 1.562) >= 0.7, "{}", of(4, 1.562));
        assert_eq!(of(3000, 20.0), 2.0);
        // The noise of the sensor stays.
        assert_eq!(predicted(0.0).scaled(0.0), 1.0);
    }

    #[test]
    fn what_is_new_is_white_and_of_variance_one() {
        let r = residuals(2.0, 0.967, 1.0);
        let noise = Noise { slow: 2.0, time_s: 300.0, ..Noise::WHITE };
        let gains = noise.gains(&r);
        let e: Vec<f64> = whitened(&gains, r.iter().map(|r| r.value)).collect();
        let n = e.len() as f64;
        let square = e.iter().map(|e| e * e).sum::<f64>() / n;
        let beside = e.windows(2).map(|p| p[0] * p[1]).sum::<f64>() / n;
        assert!((square - 1.0).abs() < 0.08 && beside.abs() < 0.06, "{square} {beside}");
    }
}
