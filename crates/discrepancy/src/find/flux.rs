//! Missing flux: the heat that would have to enter at the outlet of a part to make its residual zero.
//!
//! **Equation** the heat `q(t)` minimises `sum ((r - q/(m c))/sigma)^2 + lambda sum (q_{i-1} - 2 q_i + q_{i+1})^2` (Tikhonov),
//! `r` the measured less the simulated outlet temperature; `lambda` so that what is left is as large as sigma (Morozov).
//! Against flow, temperature and its rate, the largest correlation is the clue.
//!
//! **Assumptions** the heat enters at the outlet: what enters upstream shows later and rounded. Averages of at most
//! `POINTS` intervals; runs one after the other.
//!
//! **Sources** Tikhonov and Arsenin 1977 (key `tikhonov1977`).

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Intervals over which is averaged, at most.
const POINTS: usize = 200;
/// Heat capacity of water, J/(kg K).
const WATER: f64 = 4186.0;
/// Largest residual that is left, standard deviations, root mean square.
const LEFT: f64 = 1.0;

/// Heat that a part would have to take up beside what the model gives it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Flux {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Heat, W; negative is lost.
    pub w: Vec<f64>,
    /// Mean, W.
    pub mean_w: f64,
    /// What it goes with, and the correlation.
    pub clues: Vec<(&'static str, f64)>,
}

/// Run, time in s, measured less simulated in K, sigma in K, flow that leaves in kg/s, temperature in K.
pub type Point = (usize, f64, f64, f64, f64, f64);

/// The flux that is missing at points.
pub fn missing(points: &[Point]) -> Option<Flux> {
    let every = points.len().div_ceil(POINTS).max(1);
    let bins: Vec<[f64; 5]> = points
        .chunks(every)
        .filter(|chunk| chunk[0].0 == chunk[chunk.len() - 1].0)
        .map(|chunk| {
            let n = chunk.len() as f64;
            let mean = |of: &dyn Fn(&Point) -> f64| chunk.iter().map(of).sum::<f64>() / n;
            [
                mean(&|p| p.1),
                mean(&|p| p.2),
                mean(&|p| p.3) / n.sqrt(),
                mean(&|p| p.4),
                mean(&|p| p.5),
            ]
        })
        .filter(|bin| bin[3] > 1e-9)
        .collect();
    let n = bins.len();
    if n < 8 {
        return None;
    }
    // Unknown is q in W over its scale.
    let gain: Vec<f64> = bins.iter().map(|bin| 1.0 / (bin[3] * WATER) / bin[2]).collect();
    let z = DVector::from_iterator(n, bins.iter().map(|bin| bin[1] / bin[2]));
    let mut smooth = DMatrix::zeros(n, n);
    for i in 1..n - 1 {
        for (a, x) in [(i - 1, 1.0), (i, -2.0), (i + 1, 1.0)] {
            for (b, y) in [(i - 1, 1.0), (i, -2.0), (i + 1, 1.0)] {
                smooth[(a, b)] += x * y;
            }
        }
    }
    let solved = |lambda: f64| {
        let mut matrix = &smooth * lambda;
        for i in 0..n {
            matrix[(i, i)] += gain[i] * gain[i];
        }
        let right = DVector::from_fn(n, |i, _| gain[i] * z[i]);
        let q = matrix.cholesky()?.solve(&right);
        let left = (0..n).map(|i| (z[i] - gain[i] * q[i]).powi(2)).sum::<f64>() / n as f64;
        Some((q, left.sqrt()))
    };
    let scale = gain.iter().map(|g| g * g).sum::<f64>() / n as f64;
    let (mut low, mut high) = (1e-6_f64.ln(), 1e6_f64.ln());
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        let (_, left) = solved(scale * middle.exp())?;
        if left < LEFT { low = middle } else { high = middle }
    }
    let (q, _) = solved(scale * low.exp())?;
    let w: Vec<f64> = q.iter().copied().collect();
    let rate = |i: usize| {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(n - 1));
        (bins[b][4] - bins[a][4]) / (bins[b][0] - bins[a][0]).abs().max(1.0)
    };
    let mut clues = vec![
        ("flow", correlation(&w, &bins.iter().map(|b| b[3]).collect::<Vec<_>>())),
        ("temperature", correlation(&w, &bins.iter().map(|b| b[4]).collect::<Vec<_>>())),
        ("rate of the temperature", correlation(&w, &(0..n).map(rate).collect::<Vec<_>>())),
        ("time", correlation(&w, &bins.iter().map(|b| b[0]).collect::<Vec<_>>())),
    ];
    clues.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let mean_w = w.iter().sum::<f64>() / n as f64;
    Some(Flux { time_s: bins.iter().map(|b| b[0]).collect(), w, mean_w, clues })
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let (ma, mb) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
    let cross: f64 = a.iter().zip(b).map(|(a, b)| (a - ma) * (b - mb)).sum();
    let own = |x: &[f64], m: f64| x.iter().map(|x| (x - m).powi(2)).sum::<f64>();
    cross / (own(a, ma) * own(b, mb)).sqrt().max(1e-300)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_loss_is_found_again() {
        // 0.1 kg/s leaves 2 K too cold: 0.1 * 4186 * 2 = 837 W are lost.
        let points: Vec<_> = (0..500)
            .map(|k| {
                let noise = if k % 2 == 0 { 0.05 } else { -0.05 };
                (0, f64::from(k) * 10.0, -2.0 + noise, 0.05, 0.1, 320.0)
            })
            .collect();
        let flux = missing(&points).unwrap();
        assert!((flux.mean_w + 837.2).abs() < 5.0, "{}", flux.mean_w);
        // One that follows the flow.
        let points: Vec<_> = (0..500)
            .map(|k| {
                let m = 0.1 + 0.05 * (f64::from(k) / 50.0).sin();
                (0, f64::from(k) * 10.0, -1.0, 0.05, m, 320.0)
            })
            .collect();
        let flux = missing(&points).unwrap();
        assert_eq!(flux.clues[0].0, "flow");
        assert!(flux.clues[0].1 < -0.9, "{:?}", flux.clues);
    }
}
