//! Modes of closed loops and the scale of all gains at which the first of them stops decaying.
//!
//! **Method** where all loops are alike but for their gains, `L = K G l(s)`, each eigenvalue of `K G` gives a
//! scalar equation `1 + k lambda l(s) = 0`, exactly. Otherwise the same equation of each loop with all others open gives
//! the start for secant steps on `1/(c^H (1 + k L)^-1 b)`, which vanishes at the modes only, with c and b that the mode of
//! the start answers more than others; where modes are missing, l is weighted by the participation of the loops in
//! the eigenvectors. The number of growing modes is counted with the argument principle, so that none is missed; where
//! the count differs still, modes are looked for from many starts. **Validity** poles of the controllers at zero
//! (integrators) or in the left half plane. **Sources** `skogestad2005` (generalised Nyquist criterion).

use super::count::{Case, count_growing};
use super::elimination::{Eliminated, Rows};
use super::in_pieces;
use super::limit::{limit_by_counting, limit_of_modes};
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
/// Starts that are followed before it is asked whether that is enough.
const AT_ONCE: usize = 4;
/// Modes closer than this, relative, are one.
pub(super) const SAME: f64 = 1e-6;
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
struct Scalar<'a> {
    f: Box<dyn Fn(C64) -> C64 + Send + Sync + 'a>,
    times: usize,
    /// Its values at the frequencies looked at.
    values: Vec<C64>,
    /// Whether crossings are wanted to the last digit.
    exact: bool,
    /// Those that its mode answers more than the others.
    probes: Probes,
}

/// Analyses a group of loops.
pub(super) fn analyse(loops: &Loops) -> Found {
    let n = loops.len();
    let lambdas = loops.uniform.as_ref().map(|k| {
        let scaled = DMatrix::from_fn(n, n, |i, j| k[i] * loops.gains[(i, j)]);
        scaled.complex_eigenvalues().iter().copied().collect()
    });
    let case = Case { loops, lambdas };
    // What grows with hardly any gain has the wrong sign.
    let counts = in_pieces(n, 2, |k| count_growing(&case, [1.0, NO_GAIN][k]));
    let (growing, wrong) = (counts[0], counts[1] > 0);
    let (mut roots, limit) = match &case.lambdas {
        Some(lambdas) => exact(loops, lambdas, growing),
        None => sought(&case, growing, !wrong),
    };
    roots.sort_by(|a, b| b.s.re.total_cmp(&a.s.re));
    let limit = if wrong { Some(Limit { factor: 0.0, omega_rad_s: 0.0 }) } else { limit };
    Found { roots, limit, growing }
}

/// Modes and limit of uniform loops with the eigenvalues of their gains.
fn exact(loops: &Loops, lambdas: &[C64], growing: i64) -> (Vec<Root>, Option<Limit>) {
    let omegas = frequencies(loops, PER_DECADE);
    let scalars = uniform(loops, lambdas, &omegas);
    let starts = starts(&scalars, &omegas);
    let mut roots = Vec::new();
    for (limit, scalar) in &starts {
        let root = follow(scalar, *limit);
        root.into_iter().for_each(|s| keep(&mut roots, s, scalar.times));
    }
    look_further(loops, growing, &mut roots);
    (roots, starts.first().map(|(limit, _)| *limit))
}

/// Modes of other loops, and their limit where there can be one.
fn sought(case: &Case, growing: i64, limited: bool) -> (Vec<Root>, Option<Limit>) {
    let loops = case.loops;
    let omegas = frequencies(loops, PER_DECADE_OF_STARTS);
    let mut roots = Vec::new();
    let mut found = refined(loops, &alone(loops, &omegas), &omegas, growing, &mut roots);
    // Loops that are nearly alike have modes of all of them together.
    let few = counted(&roots) < growing || roots.len() < REFINED.min(loops.len());
    if few {
        found.extend(refined(loops, &together(loops, &omegas), &omegas, growing, &mut roots));
    }
    look_further(loops, growing, &mut roots);
    let mut limit = if limited { limit_of_modes(case, found) } else { None };
    if limited && limit.is_none() && !few {
        let more = refined(loops, &together(loops, &omegas), &omegas, growing, &mut roots);
        limit = limit_of_modes(case, more);
    }
    if limited && limit.is_none() {
        limit = limit_by_counting(case, &omegas);
    }
    (roots, limit)
}

/// Where the scalar equations have their smallest scale, the smallest first.
fn starts<'a>(scalars: &'a [Scalar<'a>], omegas: &[f64]) -> Vec<(Limit, &'a Scalar<'a>)> {
    let start = |scalar: &'a Scalar<'a>| Some((crossing(scalar, omegas)?, scalar));
    let mut starts: Vec<_> = scalars.iter().filter_map(start).collect();
    starts.sort_by(|a, b| a.0.factor.total_cmp(&b.0.factor));
    starts
}

/// Modes from the starts of scalar equations, with the probes of each; all that grow, and some more.
fn refined(
    loops: &Loops,
    scalars: &[Scalar],
    omegas: &[f64],
    growing: i64,
    roots: &mut Vec<Root>,
) -> Vec<(C64, Probes)> {
    let starts = starts(scalars, omegas);
    let mode = |(limit, scalar): &(Limit, &Scalar)| {
        let answer = |s| resolvent(loops, s, 1.0, &scalar.probes);
        follow(scalar, *limit).and_then(|start| secant(answer, start))
    };
    let mut found = Vec::new();
    for (part, starts) in starts.chunks(AT_ONCE).enumerate() {
        if part * AT_ONCE >= REFINED && counted(roots) >= growing {
            break;
        }
        let modes = in_pieces(loops.len(), starts.len(), |i| mode(&starts[i]));
        for (s, (_, scalar)) in modes.into_iter().zip(starts) {
            if let Some(s) = s {
                keep(roots, s, 1);
                found.push((s, scalar.probes.clone()));
            }
        }
    }
    found
}

/// Looks from many starts where growing modes are still missing.
fn look_further(loops: &Loops, growing: i64, roots: &mut Vec<Root>) {
    if counted(roots) < growing {
        let found = search(loops, &frequencies(loops, PER_DECADE));
        found.into_iter().for_each(|s| keep(roots, s, 1));
    }
}

/// Growing modes among the roots.
fn counted(roots: &[Root]) -> i64 {
    let pairs = roots.iter().filter(|root| root.s.re > 0.0).map(|root| 2 * root.times);
    i64::try_from(pairs.sum::<usize>()).unwrap_or(i64::MAX)
}

/// Whether it swings.
pub(super) fn swings(s: C64) -> bool {
    s.im.abs() >= NO_PERIOD * s.re.abs() && s.re.is_finite()
}

fn keep(roots: &mut Vec<Root>, s: C64, times: usize) {
    let s = C64::new(s.re, s.im.abs());
    if !swings(s) {
        return;
    }
    match roots.iter_mut().find(|known| (known.s - s).norm() < SAME * s.norm()) {
        Some(known) => known.times = known.times.max(times),
        None => roots.push(Root { s, times }),
    }
}

/// The scalar equations of uniform loops, exact: one for each eigenvalue.
fn uniform<'a>(loops: &'a Loops, lambdas: &[C64], omegas: &[f64]) -> Vec<Scalar<'a>> {
    let mut all: Vec<(C64, usize)> = Vec::new();
    for lambda in lambdas.iter().filter(|lambda| lambda.im >= 0.0 && lambda.norm() > 0.0) {
        match all.iter_mut().find(|(known, _)| (known - lambda).norm() < SAME * lambda.norm()) {
            Some((_, times)) => *times += 1,
            None => all.push((*lambda, 1)),
        }
    }
    let common: Vec<C64> = omegas.iter().map(|omega| loops.common(C64::new(0.0, *omega))).collect();
    let scalar = |(lambda, times): (C64, usize)| Scalar {
        f: Box::new(move |s| lambda * loops.common(s)),
        times,
        values: common.iter().map(|value| lambda * value).collect(),
        exact: true,
        probes: (DVector::zeros(0), DVector::zeros(0)),
    };
    all.into_iter().map(scalar).collect()
}

/// Each loop with all others open: where lags differ much, modes are mostly those of one loop.
fn alone<'a>(loops: &'a Loops, omegas: &[f64]) -> Vec<Scalar<'a>> {
    let scalar = |i: usize| {
        let mut own = DVector::zeros(loops.len());
        own[i] = C64::new(1.0, 0.0);
        let values = omegas.iter().map(|omega| loops.own(i, C64::new(0.0, *omega))).collect();
        let f = Box::new(move |s: C64| loops.own(i, s));
        Scalar { f, times: 1, values, exact: false, probes: (own.clone(), own) }
    };
    (0..loops.len()).map(scalar).collect()
}

/// The loops as they take part in the eigenvectors at the frequency of the chains.
fn together<'a>(loops: &'a Loops, omegas: &[f64]) -> Vec<Scalar<'a>> {
    let n = loops.len();
    let (_, slowest) = loops.times_s();
    let at = C64::new(0.0, 2.0 / slowest);
    let matrix = loops.matrix(at);
    let eigenvalues = matrix.dense().eigenvalues().unwrap_or_else(|| DVector::zeros(0));
    let on_grid = in_pieces(n, omegas.len(), |k| loops.matrix(C64::new(0.0, omegas[k])));
    let scalar = |lambda: C64| {
        let shift = lambda * C64::new(1.0 + 1e-7, 1e-7);
        let mut moved = matrix.clone();
        (0..n).for_each(|i| moved.set(i, i, moved.at(i, i) - shift));
        let (left, right) = inverse_iteration(moved);
        let norm = left.dotc(&right);
        if norm.norm() < 1e-12 {
            return None;
        }
        let through = |matrix: &Rows| matrix.between(&left, &right) / norm;
        let values = on_grid.iter().map(through).collect();
        let probes = (left.clone(), right.clone());
        let f = Box::new(move |s: C64| loops.matrix(s).between(&left, &right) / norm);
        Some(Scalar { f, times: 1, values, exact: false, probes })
    };
    let lambdas: Vec<C64> =
        eigenvalues.iter().copied().filter(|lambda| lambda.norm() > 0.0).collect();
    in_pieces(n, lambdas.len(), |k| scalar(lambdas[k])).into_iter().flatten().collect()
}

/// The left and the right vector that a nearly singular matrix answers most.
fn inverse_iteration(matrix: Rows) -> Probes {
    let start = probe(matrix.columns(), 1);
    let Some(eliminated) = Eliminated::of(matrix) else { return (start.clone(), start) };
    let most = |solve: &dyn Fn(&DVector<C64>) -> DVector<C64>| {
        let mut vector = start.clone();
        for _ in 0..3 {
            let next = solve(&vector);
            let norm = next.norm();
            if norm.is_finite() && norm > 0.0 {
                vector = next.unscale(norm);
            }
        }
        vector
    };
    (most(&|vector| eliminated.solve_adjoint(vector)), most(&|vector| eliminated.solve(vector)))
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
    match Eliminated::of(loops.closed(s, factor)) {
        Some(closed) => c.dotc(&closed.solve(b)).inv(),
        None => C64::new(0.0, 0.0),
    }
}

/// Roots from many starts.
fn search(loops: &Loops, omegas: &[f64]) -> Vec<C64> {
    let from = |k: usize| {
        let (i, omega) = (4 * k, omegas[4 * k]);
        let probe = probe(loops.len(), u32::try_from(i).unwrap_or(0));
        let probe = (probe.clone(), probe);
        [0.3, 0.0].map(|growth| {
            let start = C64::new(growth * omega, omega);
            secant(|s| resolvent(loops, s, 1.0, &probe), start)
        })
    };
    let found = in_pieces(loops.len(), omegas.len().div_ceil(4), from);
    // Zeros of the probe's answer only are not modes of the loops.
    let mode = |s: &C64| {
        let probe = probe(loops.len(), 987);
        let probe = (probe.clone(), probe);
        s.re > -s.im.abs() && resolvent(loops, *s, 1.0, &probe).norm() < 1e-6
    };
    found.into_iter().flatten().flatten().filter(mode).collect()
}
