//! Modes of closed loops and the scale of all gains at which the first of them stops decaying.
//!
//! **Method** where all loops are alike but for their gains, `L = K G l(s)`, each eigenvalue of `K G` gives a
//! scalar equation `1 + k lambda l(s) = 0`, exactly. Otherwise these equations, with l weighted by the
//! participation of the loops in the eigenvector, and those of each loop alone give the starts for secant steps on
//! `1/(c^H (1 + k L)^-1 b)`, which vanishes at the modes only, with c and b that the mode of the start answers. The number of growing modes is counted with the
//! argument principle, so that none is missed; where the count differs, modes are looked for from more
//! starts. **Validity** poles of the controllers at zero (integrators) or in the left half plane. **Sources**
//! `skogestad2005` (generalised Nyquist criterion).

use super::count::{Case, count_growing};
use super::limit::first_limit;
use super::loops::Loops;
use super::secant::secant;
use nalgebra::{Complex, DMatrix, DVector};

type C64 = Complex<f64>;

/// Frequencies that are looked at for crossings, per factor of ten.
const PER_DECADE: usize = 40;
/// The same where crossings are starts only.
const PER_DECADE_OF_STARTS: usize = 16;
/// Modes that are refined where loops differ, and all that grow.
const REFINED: usize = 8;
/// Modes closer than this, relative, are one.
const SAME: f64 = 1e-6;
/// A mode that moves less than this between growing and decaying has no period.
const NO_PERIOD: f64 = 1e-3;
/// Steps of the scale from the limit to the present gains, each by this factor at most.
pub(super) const SCALE_STEP: f64 = 1.15;

/// A scale at which loops of the right sign rest.
const NO_GAIN: f64 = 1e-6;

/// A mode of the loops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Root {
    /// Growth and frequency, 1/s.
    pub s: C64,
    /// How many modes are this one.
    pub times: usize,
}

/// Where the first mode stops decaying.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limit {
    /// Scale of all gains; above it there is a mode that grows.
    pub factor: f64,
    /// Frequency of that mode, rad/s.
    pub omega_rad_s: f64,
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    /// Oscillating modes, the fastest growing first.
    pub roots: Vec<Root>,
    pub limit: Option<Limit>,
    /// Growing modes by the argument principle (a pair counts twice).
    pub growing: i64,
}

/// Shapes of what is put in and looked at: c and b of `1/(c^H (1 + k L)^-1 b)`.
pub(super) type Probes = (DVector<C64>, DVector<C64>);

/// A scalar equation `1 + k f(s) = 0`.
pub(super) struct Scalar<'a> {
    f: Box<dyn Fn(C64) -> C64 + 'a>,
    times: usize,
    /// Its values at the frequencies looked at.
    values: Vec<C64>,
    /// Whether crossings are wanted to the last digit.
    exact: bool,
    /// Those that its mode answers more than the others.
    pub(super) probes: Probes,
    /// Whether it is that of one loop with all others open.
    alone: bool,
}

/// Analyses a group of loops.
pub(super) fn analyse(loops: &Loops) -> Found {
    let n = loops.len();
    let lambdas = loops.uniform.as_ref().map(|k| {
        let scaled = DMatrix::from_fn(n, n, |i, j| k[i] * loops.gains[(i, j)]);
        scaled.complex_eigenvalues().iter().copied().collect()
    });
    let case = Case { loops, lambdas };
    let exact = case.lambdas.is_some();
    let growing = count_growing(&case, 1.0);
    let omegas = frequencies(loops, if exact { PER_DECADE } else { PER_DECADE_OF_STARTS });
    let scalars = scalars(&case, &omegas);
    let mut starts: Vec<(Limit, &Scalar)> = Vec::new();
    for scalar in &scalars {
        starts.extend(crossing(scalar, &omegas).map(|limit| (limit, scalar)));
    }
    starts.sort_by(|(a, of), (b, other)| {
        of.alone.cmp(&other.alone).then(a.factor.total_cmp(&b.factor))
    });
    let mut roots: Vec<Root> = Vec::new();
    let mut found: Vec<(C64, &Scalar)> = Vec::new();
    for (k, (limit, scalar)) in starts.iter().enumerate() {
        if !exact && k >= REFINED && counted(&roots) >= growing {
            break;
        }
        let start = follow(scalar, *limit);
        if exact {
            start.into_iter().for_each(|s| keep(&mut roots, s, scalar.times));
        } else {
            let answer = |s| resolvent(loops, s, 1.0, &scalar.probes);
            let root = start.and_then(|start| secant(answer, start));
            root.into_iter().for_each(|s| keep(&mut roots, s, 1));
            found.extend(root.map(|s| (s, *scalar)));
        }
    }
    if counted(&roots) < growing {
        for s in search(loops, &frequencies(loops, PER_DECADE)) {
            keep(&mut roots, s, 1);
        }
    }
    roots.sort_by(|a, b| b.s.re.total_cmp(&a.s.re));
    // What grows with hardly any gain has the wrong sign.
    let limit = if count_growing(&case, NO_GAIN) > 0 {
        Some(Limit { factor: 0.0, omega_rad_s: 0.0 })
    } else if exact {
        starts.first().map(|(limit, _)| *limit)
    } else {
        found.sort_by(|a, b| b.0.re.total_cmp(&a.0.re));
        found.dedup_by(|a, b| (a.0 - b.0).norm() < SAME * b.0.norm());
        first_limit(&case, &found, &omegas)
    };
    Found { roots, limit, growing }
}

/// Growing modes among the roots.
fn counted(roots: &[Root]) -> i64 {
    let pairs = roots.iter().filter(|root| root.s.re > 0.0).map(|root| 2 * root.times);
    i64::try_from(pairs.sum::<usize>()).unwrap_or(i64::MAX)
}

fn keep(roots: &mut Vec<Root>, s: C64, times: usize) {
    let s = C64::new(s.re, s.im.abs());
    if s.im < NO_PERIOD * s.re.abs() || !s.re.is_finite() {
        return;
    }
    match roots.iter_mut().find(|known| (known.s - s).norm() < SAME * s.norm()) {
        Some(known) => known.times = known.times.max(times),
        None => roots.push(Root { s, times }),
    }
}

/// The scalar equations: exact for uniform loops, otherwise starts.
fn scalars<'a>(case: &'a Case, omegas: &[f64]) -> Vec<Scalar<'a>> {
    let loops = case.loops;
    let n = loops.len();
    if let Some(lambdas) = &case.lambdas {
        let mut all: Vec<(C64, usize)> = Vec::new();
        for lambda in lambdas.iter().filter(|lambda| lambda.im >= 0.0 && lambda.norm() > 0.0) {
            match all.iter_mut().find(|(known, _)| (known - lambda).norm() < SAME * lambda.norm()) {
                Some((_, times)) => *times += 1,
                None => all.push((*lambda, 1)),
            }
        }
        let common: Vec<C64> =
            omegas.iter().map(|omega| loops.common(C64::new(0.0, *omega))).collect();
        let scalar = |(lambda, times): (C64, usize)| Scalar {
            f: Box::new(move |s| lambda * loops.common(s)),
            times,
            values: common.iter().map(|value| lambda * value).collect(),
            exact: true,
            probes: (DVector::zeros(0), DVector::zeros(0)),
            alone: false,
        };
        return all.into_iter().map(scalar).collect();
    }
    // The eigenvectors at the frequency of the chains, each with the loops that take part.
    let (_, slowest) = loops.times_s();
    let at = C64::new(0.0, 2.0 / slowest);
    let matrix = loops.matrix(at);
    let eigenvalues = matrix.clone().eigenvalues().unwrap_or_else(|| DVector::zeros(0));
    let on_grid: Vec<DMatrix<C64>> =
        omegas.iter().map(|omega| loops.matrix(C64::new(0.0, *omega))).collect();
    let mut scalars = Vec::new();
    for lambda in eigenvalues.iter().filter(|lambda| lambda.norm() > 0.0) {
        let shift = *lambda * C64::new(1.0 + 1e-7, 1e-7);
        let moved = &matrix - DMatrix::from_diagonal_element(n, n, shift);
        let right = inverse_iteration(&moved);
        let left = inverse_iteration(&moved.adjoint());
        let norm = left.dotc(&right);
        if norm.norm() < 1e-12 {
            continue;
        }
        let through = |matrix: &DMatrix<C64>| left.dotc(&(matrix * &right)) / norm;
        let values = on_grid.iter().map(through).collect();
        let probes = (left.clone(), right.clone());
        let f = move |s: C64| left.dotc(&(loops.matrix(s) * &right)) / norm;
        scalars.push(Scalar {
            f: Box::new(f),
            times: 1,
            values,
            exact: false,
            probes,
            alone: false,
        });
    }
    // And each loop by itself: where lags differ much, modes are mostly those of one loop.
    for i in 0..n {
        let values = on_grid.iter().map(|matrix| matrix[(i, i)]).collect();
        let f = move |s: C64| loops.matrix(s)[(i, i)];
        let mut own = DVector::zeros(n);
        own[i] = C64::new(1.0, 0.0);
        let probes = (own.clone(), own);
        scalars.push(Scalar {
            f: Box::new(f),
            times: 1,
            values,
            exact: false,
            probes,
            alone: true,
        });
    }
    scalars
}

fn inverse_iteration(matrix: &DMatrix<C64>) -> DVector<C64> {
    let n = matrix.nrows();
    let lu = matrix.clone().lu();
    let mut vector = probe(n, 1);
    for _ in 0..3 {
        if let Some(next) = lu.solve(&vector) {
            let norm = next.norm();
            if norm.is_finite() && norm > 0.0 {
                vector = next.unscale(norm);
            }
        }
    }
    vector
}

/// A vector that is orthogonal to no mode but by bad luck.
fn probe(n: usize, seed: u32) -> DVector<C64> {
    let angle = |i: usize| (1.0 + f64::from(seed)) * 2.399_963 * (i as f64 + 0.5);
    DVector::from_fn(n, |i, _| C64::from_polar(1.0 + 0.3 * (angle(i) * 1.7).sin(), angle(i)))
}

/// Probes of no mode in particular.
pub(super) fn general(loops: &Loops) -> Probes {
    (probe(loops.len(), 0), probe(loops.len(), 0))
}

fn frequencies(loops: &Loops, per_decade: usize) -> Vec<f64> {
    let (_, slowest) = loops.times_s();
    let (low, high) = (1e-3 / slowest, loops.highest_rad_s());
    let decades = (high / low).log10().max(1.0);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let n = (decades * per_decade as f64).ceil() as usize;
    (0..=n).map(|i| low * (high / low).powf(i as f64 / n as f64)).collect()
}

/// The smallest scale at which `1 + k f(i omega)` vanishes.
fn crossing(scalar: &Scalar, omegas: &[f64]) -> Option<Limit> {
    let f = |omega: f64| (scalar.f)(C64::new(0.0, omega));
    let mut best: Option<Limit> = None;
    let mut before = (omegas[0], scalar.values[0]);
    let consider = |omega: f64, value: C64, best: &mut Option<Limit>| {
        let factor = 1.0 / value.norm();
        if value.re < 0.0 && best.is_none_or(|best| factor < best.factor) {
            *best = Some(Limit { factor, omega_rad_s: omega });
        }
    };
    for (&omega, &value) in omegas.iter().zip(&scalar.values).skip(1) {
        let now = (omega, value);
        if before.1.im * now.1.im <= 0.0 && (before.1.re < 0.0 || now.1.re < 0.0) {
            let (mut low, mut high) = (before, now);
            if scalar.exact {
                for _ in 0..60 {
                    let middle = 0.5 * (low.0 + high.0);
                    let value = f(middle);
                    if low.1.im * value.im <= 0.0 {
                        high = (middle, value);
                    } else {
                        low = (middle, value);
                    }
                }
            } else {
                // A start only: straight between the two frequencies.
                let share = low.1.im / (low.1.im - high.1.im);
                let between = low.1 + (high.1 - low.1) * share;
                high = (low.0 + (high.0 - low.0) * share, between);
            }
            // Where the phase jumps, nothing crosses.
            if high.1.im.abs() <= 1e-6 * high.1.norm() {
                consider(high.0, high.1, &mut best);
            }
        }
        before = now;
    }
    // Sampled loops may swing from sample to sample.
    let (omega, last) = before;
    if last.im.abs() <= 1e-9 * last.norm() {
        consider(omega, last, &mut best);
    }
    best
}

/// The root of a scalar equation at the present gains that crosses at its limit.
fn follow(scalar: &Scalar, limit: Limit) -> Option<C64> {
    let mut s = C64::new(0.0, limit.omega_rad_s);
    let span = limit.factor.ln();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let steps = ((span.abs() / SCALE_STEP.ln()).ceil() as usize).clamp(1, 400);
    for step in 1..=steps {
        let factor = (span * (1.0 - step as f64 / steps as f64)).exp();
        s = secant(|s| (scalar.f)(s) * factor + 1.0, s)?;
        if s.im.abs() < NO_PERIOD * s.re.abs() {
            return None;
        }
    }
    Some(s)
}

/// `1/(c^H (1 + k L)^-1 b)`.
pub(super) fn resolvent(loops: &Loops, s: C64, factor: f64, (c, b): &Probes) -> C64 {
    match loops.closed(s, factor).lu().solve(b) {
        Some(answer) => c.dotc(&answer).inv(),
        None => C64::new(0.0, 0.0),
    }
}

/// Roots from many starts.
fn search(loops: &Loops, omegas: &[f64]) -> Vec<C64> {
    let mut found = Vec::new();
    for (i, &omega) in omegas.iter().enumerate().step_by(4) {
        let probe = probe(loops.len(), u32::try_from(i).unwrap_or(0));
        let probe = (probe.clone(), probe);
        for growth in [0.3, 0.0] {
            let start = C64::new(growth * omega, omega);
            found.extend(secant(|s| resolvent(loops, s, 1.0, &probe), start));
        }
    }
    // Zeros of the probe's answer only are not modes of the loops.
    let mode = |s: &C64| {
        let probe = probe(loops.len(), 987);
        let probe = (probe.clone(), probe);
        s.re > -s.im.abs() && resolvent(loops, *s, 1.0, &probe).norm() < 1e-6
    };
    found.into_iter().filter(mode).collect()
}
