//! Loops whose controllers do not update together: different intervals, offsets, or continuous beside sampled.
//!
//! **Method** between two ticks of the greatest common interval everything is linear and known exactly; the
//! product of these steps over the common period is one matrix, the modes are its eigenvalues z:
//! `growth = ln|z|/period`. Frequencies follow from how far a mode turns within the period. Continuous
//! controllers count as sampled at the step of the run. **Validity** water only: no temperatures in the loops.
//! **Sources** `astrom2011` (lifting of multirate systems).

use super::answers::Link;
use super::chains::Seen;
use super::law::Law;
use super::modes::{Found, Limit, Root};
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;

type C64 = Complex<f64>;

/// More states or ticks than this are not worked through.
const MOST_STATES: usize = 400;
const MOST_TICKS: i64 = 20_000;
const MODES: usize = 6;
/// Growth of a mode within a period that is none.
const NONE: f64 = 1e-9;

/// When a controller updates, in ticks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ticks {
    pub every: i64,
    pub first: i64,
}

/// Loops with their timing.
pub(super) struct PeriodicLoops {
    pub laws: Vec<Law>,
    pub ticks: Vec<Ticks>,
    pub gains: DMatrix<f64>,
    pub seen: Vec<Seen>,
    pub actuator_lags_s: Vec<f64>,
    /// Outputs that are set points.
    pub links: Vec<Link>,
    /// Common interval, s.
    pub tick_s: f64,
}

/// Places of the parts of the state.
struct Layout {
    /// Of each output: command, then the two lags.
    outputs: usize,
    /// Of each sensor: its lag, then what it has seen, the last first.
    sensors: Vec<usize>,
    controllers: Vec<usize>,
    len: usize,
}

impl PeriodicLoops {
    /// Ticks after which all controllers are where they were.
    pub fn period(&self) -> i64 {
        self.ticks.iter().fold(1, |all, ticks| all / gcd(all, ticks.every) * ticks.every)
    }

    fn late(&self, i: usize) -> f64 {
        self.seen[i].dead_s / self.tick_s
    }

    fn layout(&self) -> Layout {
        let mut len = 3 * self.actuator_lags_s.len();
        let mut sensors = Vec::new();
        for i in 0..self.seen.len() {
            sensors.push(len);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let kept = self.late(i).ceil() as usize + 2;
            len += 1 + kept;
        }
        let mut controllers = Vec::new();
        for law in &self.laws {
            controllers.push(len);
            len += law.a.nrows();
        }
        Layout { outputs: 0, sensors, controllers, len }
    }

    /// Analyses them; `None` where they are too many or their period too long.
    pub fn analyse(&self) -> Option<Found> {
        let layout = self.layout();
        if layout.len > MOST_STATES || self.period() > MOST_TICKS {
            return None;
        }
        let matrix = self.period_matrix(&layout, 1.0);
        #[allow(clippy::cast_precision_loss)]
        let period_s = self.period() as f64 * self.tick_s;
        let mut values: Vec<C64> = matrix.complex_eigenvalues().iter().copied().collect();
        values.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        let growing = values.iter().filter(|z| z.norm() > 1.0 + NONE).count();
        let mut roots: Vec<Root> = Vec::new();
        for z in values.into_iter().filter(|z| z.norm() > 1e-6) {
            let Some(turn) = self.turn(&layout, &matrix, z) else { continue };
            let s = C64::new(z.norm().ln() / period_s, turn.abs() / period_s);
            let known = roots.iter().any(|root| (root.s - s).norm() < 1e-6 * s.norm());
            if s.im > 1e-3 * s.re.abs() && !known {
                roots.push(Root { s, times: 1 });
            }
            if roots.len() == MODES {
                break;
            }
        }
        let limit = self.limit(&layout, period_s);
        Some(Found { roots, limit, growing: i64::try_from(growing).unwrap_or(i64::MAX) })
    }

    /// Scale of all gains at which the largest eigenvalue leaves the unit circle.
    fn limit(&self, layout: &Layout, period_s: f64) -> Option<Limit> {
        let grows = |factor: f64| {
            let values = self.period_matrix(layout, factor).complex_eigenvalues();
            values.iter().any(|z| z.norm() > 1.0 + NONE)
        };
        let (mut low, mut high) = (1.0, 1.0);
        if grows(1.0) {
            while grows(low) {
                low *= 0.5;
                if low < 1e-6 {
                    return Some(Limit { factor: 0.0, omega_rad_s: 0.0 });
                }
            }
        } else {
            while !grows(high) {
                high *= 2.0;
                if high > 1e6 {
                    return None;
                }
            }
        }
        while high / low > 1.0 + 1e-5 {
            let middle = (low * high).sqrt();
            if grows(middle) { high = middle } else { low = middle }
        }
        let matrix = self.period_matrix(layout, high);
        let values = matrix.complex_eigenvalues();
        let z = values.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
        let turn = self.turn(layout, &matrix, z).unwrap_or(0.0);
        Some(Limit { factor: high, omega_rad_s: turn.abs() / period_s })
    }

    /// Angle by which a mode turns within the period, radians.
    fn turn(&self, layout: &Layout, matrix: &DMatrix<f64>, z: C64) -> Option<f64> {
        let n = layout.len;
        let shift = z * C64::new(1.0 + 1e-9, 1e-9);
        let moved =
            matrix.map(|entry| C64::new(entry, 0.0)) - DMatrix::from_diagonal_element(n, n, shift);
        let lu = moved.lu();
        let mut vector = DVector::from_fn(n, |i, _| C64::from_polar(1.0, 2.399_963 * i as f64));
        for _ in 0..3 {
            vector = lu.solve(&vector)?;
            vector.unscale_mut(vector.norm());
        }
        // Followed in its largest position.
        let positions = (0..self.actuator_lags_s.len()).map(|j| layout.outputs + 3 * j + 2);
        let place = positions.max_by(|a, b| vector[*a].norm().total_cmp(&vector[*b].norm()))?;
        let (mut re, mut im): (Vec<f64>, Vec<f64>) = vector.iter().map(|x| (x.re, x.im)).unzip();
        let at = |re: &[f64], im: &[f64]| C64::new(re[place], im[place]);
        let (mut angle, mut before) = (0.0, at(&re, &im));
        for tick in 0..self.period() {
            self.step(layout, tick, 1.0, &mut re);
            self.step(layout, tick, 1.0, &mut im);
            let now = at(&re, &im);
            if before.norm() > 0.0 {
                angle += (now / before).arg();
            }
            before = now;
        }
        // The whole turns are those followed, the rest is that of the eigenvalue.
        let rest = z.arg();
        Some(rest + TAU * ((angle - rest) / TAU).round())
    }

    fn period_matrix(&self, layout: &Layout, factor: f64) -> DMatrix<f64> {
        let n = layout.len;
        let mut matrix = DMatrix::zeros(n, n);
        let mut state = vec![0.0; n];
        for column in 0..n {
            state.fill(0.0);
            state[column] = 1.0;
            for tick in 0..self.period() {
                self.step(layout, tick, factor, &mut state);
            }
            matrix.column_mut(column).copy_from_slice(&state);
        }
        matrix
    }

    /// One tick.
    fn step(&self, layout: &Layout, tick: i64, factor: f64, state: &mut [f64]) {
        let reading = |state: &[f64], i: usize| {
            let late = self.late(i);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let whole = (late + 1e-9).floor() as usize;
            let part = (late - whole as f64).max(0.0);
            let first = layout.sensors[i] + 1 + whole;
            state[first] + part * (state[first + 1] - state[first])
        };
        // Controllers that are due.
        let (mut seen, mut out) = (0, 0);
        for (c, law) in self.laws.iter().enumerate() {
            let (n, n_in, n_out) = (law.a.nrows(), law.b.ncols(), law.c.nrows());
            let ticks = self.ticks[c];
            if (tick - ticks.first).rem_euclid(ticks.every) == 0 {
                let x = DVector::from_column_slice(
                    &state[layout.controllers[c]..layout.controllers[c] + n],
                );
                let y = DVector::from_fn(n_in, |k, _| reading(state, seen + k));
                let mut u = &law.c * &x + &law.d * &y;
                let mut x = &law.a * x + &law.b * y;
                for link in self.links.iter().filter(|link| link.to == c) {
                    let given = state[layout.outputs + 3 * link.output];
                    u += law.d_set.column(link.set_point) * given;
                    x += law.b_set.column(link.set_point) * given;
                }
                for k in 0..n {
                    state[layout.controllers[c] + k] = x[k];
                }
                for k in 0..n_out {
                    state[layout.outputs + 3 * (out + k)] = factor * u[k];
                }
            }
            seen += n_in;
            out += n_out;
        }
        let position = |state: &[f64], j: usize| state[layout.outputs + 3 * j + 2];
        let raw = |state: &[f64]| -> Vec<f64> {
            let row = |i: usize| (0..out).map(|j| self.gains[(i, j)] * position(state, j)).sum();
            (0..self.seen.len()).map(row).collect()
        };
        let before = raw(state);
        for (j, lag_s) in self.actuator_lags_s.iter().enumerate() {
            let at = layout.outputs + 3 * j;
            let (u, x1, x2) = (state[at], state[at + 1], state[at + 2]);
            if *lag_s > 0.0 {
                let x = self.tick_s / lag_s;
                let decay = (-x).exp();
                state[at + 1] = u + (x1 - u) * decay;
                state[at + 2] = u + (x2 - u) * decay + (x1 - u) * x * decay;
            } else {
                (state[at + 1], state[at + 2]) = (u, u);
            }
        }
        let now = raw(state);
        for (i, seen) in self.seen.iter().enumerate() {
            let at = layout.sensors[i];
            let lagged = if seen.lag_s > 0.0 {
                let behind = (now[i] - before[i]) * seen.lag_s / self.tick_s;
                let decay = (-self.tick_s / seen.lag_s).exp();
                now[i] - behind + (state[at] - before[i] + behind) * decay
            } else {
                now[i]
            };
            let end = layout
                .sensors
                .get(i + 1)
                .copied()
                .unwrap_or_else(|| layout.controllers.first().copied().unwrap_or(layout.len));
            state[at + 1..end].rotate_right(1);
            state[at] = lagged;
            state[at + 1] = lagged;
        }
    }
}

/// Greatest common divisor.
pub(super) fn gcd(a: i64, b: i64) -> i64 {
    if b == 0 { a } else { gcd(b, a % b) }
}
