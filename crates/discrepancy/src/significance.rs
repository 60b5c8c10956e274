//! Whether residuals are more than chance, although each resembles the one before.
//!
//! **Equation** intervals of a mean by the stationary bootstrap: blocks of geometrically distributed length, with the mean
//! length of Politis and White, `DRAWS` series drawn. Many sensors and regimes are tested at once: Holm's correction.
//! A sensor *differs* where the root mean square of `r/sigma` exceeds 1.3 with p < 0.01, *agrees* where the interval of its mean
//! residual lies within the standard deviation of its offset, and otherwise *cannot be told*; the smallest mean deviation that
//! would be seen is `(1.96 + 1.64)` standard errors (5 % and 95 %).
//!
//! **Sources** Politis and Romano 1994 (key `politis1994`), Politis and White 2004 (key `politis2004`), Holm 1979 (key `holm1979`).

use crate::experiment::Experiment;
use crate::search::DIFFERS;
use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg32;
use serde::Serialize;

/// Series drawn.
const DRAWS: usize = 2000;
/// What is called chance.
const CHANCE: f64 = 0.01;
/// Fewer samples say nothing.
const FEWEST: usize = 8;
/// A residual that lies further off than those beside it counts as so many standard deviations.
const ALONE: f64 = 3.0;

/// What a sensor says about the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// More than chance and tolerances.
    Differs,
    /// Within the accuracy of the sensor.
    Agrees,
    /// Neither is shown.
    CannotTell,
}

/// Mean length of blocks after Politis and White.
fn block_length(x: &[f64]) -> f64 {
    let n = x.len();
    let mean = x.iter().sum::<f64>() / n as f64;
    let covariance = |lag: usize| -> f64 {
        x.iter().zip(&x[lag.min(n)..]).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / n as f64
    };
    let variance = covariance(0);
    let longest = (3.0 * (n as f64).sqrt()).min(n as f64 / 3.0).max(1.0);
    if variance <= 0.0 {
        return 1.0;
    }
    let small = 2.0 * ((n as f64).log10() / n as f64).sqrt();
    let quiet = |m: usize| (m + 1..=m + 5).all(|k| (covariance(k) / variance).abs() < small);
    let last = (n / 4).max(1);
    let m = 2 * (1..last).find(|&m| quiet(m)).unwrap_or(last);
    let window = |k: usize| (2.0 * (1.0 - k as f64 / m as f64)).clamp(0.0, 1.0);
    let (mut slope, mut level) = (0.0, variance);
    for k in 1..=m {
        let term = 2.0 * window(k) * covariance(k);
        (slope, level) = (slope + term * k as f64, level + term);
    }
    if level <= 0.0 {
        return longest;
    }
    (slope * slope / (level * level) * n as f64).cbrt().clamp(1.0, longest)
}

/// Means of series drawn from this one, rising.
fn drawn_means(x: &[f64], seed: u64) -> Vec<f64> {
    let n = x.len();
    let go_on = 1.0 - 1.0 / block_length(x);
    let mut random = Pcg32::new(seed, 1);
    let mut uniform = || -> f64 { StandardUniform.sample(&mut random) };
    // Sums from the beginning, twice around: a block is a difference.
    let mut sums = vec![0.0];
    for i in 0..2 * n {
        sums.push(sums[i] + x[i % n]);
    }
    let draw = |_| {
        let (mut count, mut sum) = (0, 0.0);
        while count < n {
            let start = ((uniform() * n as f64) as usize).min(n - 1);
            let length = if go_on <= 0.0 {
                1
            } else {
                1 + ((1.0 - uniform()).ln() / go_on.ln()).min(n as f64) as usize
            };
            let length = length.min(n - count);
            sum += sums[start + length] - sums[start];
            count += length;
        }
        sum / n as f64
    };
    let mut means: Vec<f64> = (0..DRAWS).map(draw).collect();
    means.sort_by(f64::total_cmp);
    means
}

fn quantile(sorted: &[f64], share: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

/// What is known about the residuals of some samples in the order of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tested {
    /// Root mean square of `r/sigma`.
    pub z: f64,
    /// 95 % interval of it.
    pub z_interval: (f64, f64),
    /// Probability that it exceeds 1.3 by chance.
    pub p: f64,
    /// Mean residual and its 95 % interval, SI.
    pub mean: (f64, f64, f64),
}

/// Squares of residuals over sigma in the order of time. One that lies far off alone, as a switch between two readings may leave it,
/// counts no more than those beside it, or than three.
pub fn squares(z: &[f64]) -> Vec<f64> {
    let size = |k: Option<usize>| k.and_then(|k| z.get(k)).map_or(0.0, |z| z.abs());
    let of = |(k, z): (usize, &f64)| {
        let beside = size(k.checked_sub(1)).max(size(Some(k + 1)));
        z.abs().min(beside.max(ALONE)).powi(2)
    };
    z.iter().enumerate().map(of).collect()
}

/// Tests residuals (SI) with their standard deviations.
pub fn test(residuals: &[f64], sigma: &[f64]) -> Option<Tested> {
    if residuals.len() < FEWEST {
        return None;
    }
    let z: Vec<f64> = residuals.iter().zip(sigma).map(|(r, s)| r / s).collect();
    let squares = squares(&z);
    let z = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    let means = drawn_means(&squares, 7);
    let below = means.partition_point(|mean| *mean <= DIFFERS * DIFFERS);
    let of = |share| quantile(&means, share).max(0.0).sqrt();
    let drawn = drawn_means(residuals, 11);
    let mean = residuals.iter().sum::<f64>() / residuals.len() as f64;
    Some(Tested {
        z,
        z_interval: (of(0.025), of(0.975)),
        p: (below as f64 + 1.0) / (DRAWS as f64 + 1.0),
        mean: (mean, quantile(&drawn, 0.025), quantile(&drawn, 0.975)),
    })
}

/// Which of these probabilities are less than chance, all together.
pub fn holm(p: &[f64]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    let mut significant = vec![false; p.len()];
    for (rank, &i) in order.iter().enumerate() {
        if p[i] >= CHANCE / (p.len() - rank) as f64 {
            break;
        }
        significant[i] = true;
    }
    significant
}

/// The largest residual of a sensor, root mean square over sigma, that is more than chance; 0 where none is.
pub fn differs(experiment: &Experiment, sigma: &[f64], readings: &[f64], samples: &[usize]) -> f64 {
    let tested: Vec<Tested> = (0..experiment.sensors.sensor.len())
        .filter_map(|sensor| {
            let own = samples.iter().filter(|&&i| experiment.samples[i].sensor == sensor);
            let (r, s): (Vec<f64>, Vec<f64>) =
                own.map(|&i| (readings[i] - experiment.samples[i].value, sigma[i])).unzip();
            test(&r, &s)
        })
        .collect();
    let significant = holm(&tested.iter().map(|t| t.p).collect::<Vec<_>>());
    let own = tested.iter().zip(significant).filter(|(_, s)| *s);
    own.map(|(t, _)| t.z).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draws(count: usize, seed: u64) -> Vec<f64> {
        let mut random = Pcg32::new(seed, 3);
        let mut normal = || -> f64 { rand_distr::StandardNormal.sample(&mut random) };
        (0..count).map(|_| normal()).collect()
    }

    #[test]
    fn intervals_grow_with_correlation() {
        let white = draws(2000, 1);
        let mut slow = vec![0.0];
        for e in &white {
            slow.push(0.95 * slow[slow.len() - 1] + (1.0 - 0.95_f64 * 0.95).sqrt() * e);
        }
        let width = |x: &[f64]| {
            let t = test(x, &vec![1.0; x.len()]).unwrap();
            t.mean.2 - t.mean.1
        };
        // Standard error 1/sqrt(2000) = 0.0224 of the white one: 0.088 wide; correlated by 0.95 sqrt(39) = 6.2 times as wide.
        assert!((width(&white) - 0.088).abs() < 0.015, "{}", width(&white));
        assert!((0.3..0.9).contains(&width(&slow)), "{}", width(&slow));
        assert!(block_length(&slow) > 10.0 && block_length(&white) < 5.0);
    }

    #[test]
    fn one_alone_counts_no_more_than_three() {
        assert_eq!(squares(&[0.5, -38.0, 1.0, 4.0, 6.0, 2.0]), [0.25, 9.0, 1.0, 16.0, 16.0, 4.0]);
        assert_eq!(squares(&[-5.0]), [9.0]);
    }

    #[test]
    fn what_differs_and_what_does_not() {
        let quiet = draws(500, 2);
        let loud: Vec<f64> = quiet.iter().map(|x| 1.6 * x).collect();
        let sigma = vec![1.0; 500];
        let (quiet, loud) = (test(&quiet, &sigma).unwrap(), test(&loud, &sigma).unwrap());
        assert!(quiet.p > 0.9 && loud.p < 0.001, "{quiet:?} {loud:?}");
        assert!(loud.z_interval.0 < loud.z && loud.z < loud.z_interval.1);
        // 0.003 < 0.01/3; 0.006 >= 0.01/2: neither it nor what follows.
        assert_eq!(holm(&[0.006, 0.003, 0.009]), [false, true, false]);
    }
}
