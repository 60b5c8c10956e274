//! A controller at rest as a linear law, found by differences of its own update.
//!
//! **Equation** sampled: `x' = A x + B y`, `u = C x + D y` (and the same with B_r, D_r for the set points), x' the state after an update; continuous:
//! `dx/dt = A x + B y` from short updates, `C` and `D` from updates that take no time. **Assumptions** the
//! update is smooth near rest; within a dead band nothing happens, so the law is taken beside it, where
//! something does.

use crate::plan::{Plan, PlannedController};
use crate::state::State;
use anergy_control::controller::{Balance, Inputs};
use nalgebra::{Complex, DMatrix, DVector};

/// An update this short is a continuous one, s.
const SHORT_S: f64 = 1e-2;
/// Differences relative to the scale of a measured value, to a state.
const DIFFERENCE: f64 = 1e-5;
const STATE_DIFFERENCE: f64 = 1e-6;
/// Rounding of a difference quotient of a state.
const ROUNDING: f64 = 1e-8;
/// An output this close to its limit, relative to its range, is at it.
const AT_LIMIT: f64 = 1e-9;
/// How far from rest a law without effect is looked for, in scales.
const BESIDE: [f64; 4] = [0.0, 1e-3, 1e-2, 1e-1];

/// The linear law of a controller.
#[derive(Debug, Clone)]
pub(super) struct Law {
    pub a: DMatrix<f64>,
    pub b: DMatrix<f64>,
    pub c: DMatrix<f64>,
    pub d: DMatrix<f64>,
    /// Over set points.
    pub b_set: DMatrix<f64>,
    pub d_set: DMatrix<f64>,
    /// Outputs that are at a limit, and stay there.
    pub held: Vec<bool>,
}

/// A controller with what it sees at rest.
struct Bench<'a> {
    planned: &'a PlannedController,
    measured: Vec<f64>,
    set_points: Vec<f64>,
    state: Vec<f64>,
    outputs: Vec<f64>,
}

/// What is moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Moved {
    State(usize),
    Measured(usize),
    SetPoint(usize),
}

impl Bench<'_> {
    /// State and outputs after an update with something moved by a step.
    fn update(&self, dt_s: f64, moved: Moved, step: f64) -> (Vec<f64>, Vec<f64>) {
        let (mut state, mut outputs) = (self.state.clone(), self.outputs.clone());
        let (mut measured, mut set_points) = (self.measured.clone(), self.set_points.clone());
        match moved {
            Moved::State(i) => state[i] += step,
            Moved::Measured(i) => measured[i] += step,
            Moved::SetPoint(i) => set_points[i] += step,
        }
        let (measured, set_points) = (&measured[..], &set_points[..]);
        let inputs = Inputs { measured, set_points, limits: &self.planned.limits };
        // What cannot answer has no law.
        let _ = self.planned.controller.update(dt_s, &inputs, &mut state, &mut outputs);
        (state, outputs)
    }

    /// Central differences of state and outputs.
    fn slopes(&self, dt_s: f64, moved: Moved, step: f64) -> (Vec<f64>, Vec<f64>) {
        let ((x1, u1), (x0, u0)) =
            (self.update(dt_s, moved, step), self.update(dt_s, moved, -step));
        let slope = |high: Vec<f64>, low: Vec<f64>| -> Vec<f64> {
            high.iter().zip(low).map(|(high, low)| (high - low) / (2.0 * step)).collect()
        };
        (slope(x1, x0), slope(u1, u0))
    }
}

impl Law {
    /// The law of a controller that rests at the present state; `interval_s` 0 for a continuous one.
    pub fn of(plan: &Plan, state: &State, planned: &PlannedController, interval_s: f64) -> Self {
        let mut measured = Vec::new();
        let inputs = planned.inputs(plan, state, &mut measured);
        let mut outputs = Vec::new();
        planned.outputs(state, &mut outputs);
        let mut balance = vec![Balance::default(); outputs.len()];
        planned.controller.balance(&inputs, &outputs, &mut balance);
        let mut own = planned.controller.initial_state();
        planned.controller.rest(&inputs, &outputs, &mut own);
        let set_points = state.signals[planned.set_points.clone()].to_vec();
        let held = (0..outputs.len()).map(|k| {
            let (min, max) = planned.controller.output_limits(k, planned.limits[k]);
            let range = if (max - min).is_finite() { max - min } else { 1.0 };
            outputs[k] - min <= AT_LIMIT * range || max - outputs[k] <= AT_LIMIT * range
        });
        let held: Vec<bool> = held.collect();
        let mut bench = Bench { planned, measured, set_points, state: own, outputs };
        let scale = balance.first().map_or(1.0, |balance| balance.scale);
        let rest = bench.measured.clone();
        let mut law = bench.law(interval_s, scale);
        for beside in BESIDE {
            for (value, rest) in bench.measured.iter_mut().zip(&rest) {
                *value = rest - beside * scale;
            }
            law = bench.law(interval_s, scale);
            if law.b.iter().chain(law.d.iter()).any(|entry| *entry != 0.0) {
                break;
            }
        }
        for (k, _) in held.iter().enumerate().filter(|(_, held)| **held) {
            law.c.row_mut(k).fill(0.0);
            law.d.row_mut(k).fill(0.0);
            law.d_set.row_mut(k).fill(0.0);
        }
        Self { held, ..law }
    }

    /// Outputs over measured values at a value of `s`, or of `z` where it is sampled.
    pub fn transfer(&self, p: Complex<f64>) -> DMatrix<Complex<f64>> {
        let complex = |matrix: &DMatrix<f64>| matrix.map(|entry| Complex::new(entry, 0.0));
        if let Some(value) = self.single(p) {
            return DMatrix::from_element(1, 1, value);
        }
        let n = self.a.nrows();
        let resolvent = DMatrix::from_diagonal_element(n, n, p) - complex(&self.a);
        let answer = resolvent.lu().solve(&complex(&self.b));
        let through = answer.map(|answer| complex(&self.c) * answer);
        through.map_or_else(|| complex(&self.d), |through| through + complex(&self.d))
    }

    /// The same of a law with one state that holds one output by one measured value.
    pub fn single(&self, p: Complex<f64>) -> Option<Complex<f64>> {
        let single = self.a.nrows() == 1 && self.c.nrows() == 1 && self.b.ncols() == 1;
        single.then(|| self.c[(0, 0)] * self.b[(0, 0)] / (p - self.a[(0, 0)]) + self.d[(0, 0)])
    }

    /// Outputs over a set point at a value of `s`, or of `z` where it is sampled.
    pub fn follows(&self, p: Complex<f64>, set_point: usize) -> DVector<Complex<f64>> {
        let complex = |matrix: &DMatrix<f64>| matrix.map(|entry| Complex::new(entry, 0.0));
        let column = |matrix: &DMatrix<f64>| matrix.column(set_point).map(|x| Complex::new(x, 0.0));
        let n = self.a.nrows();
        let resolvent = DMatrix::from_diagonal_element(n, n, p) - complex(&self.a);
        let answer = resolvent.lu().solve(&column(&self.b_set));
        let through = answer.map(|answer| complex(&self.c) * answer);
        through.map_or_else(|| column(&self.d_set), |through| through + column(&self.d_set))
    }

    /// Whether nothing of it reaches its outputs.
    pub fn is_idle(&self) -> bool {
        self.c.iter().chain(self.d.iter()).all(|entry| *entry == 0.0)
            || self.b.iter().chain(self.d.iter()).all(|entry| *entry == 0.0)
    }
}

impl Bench<'_> {
    fn law(&self, interval_s: f64, scale: f64) -> Law {
        let (n, n_in, n_out) = (self.state.len(), self.measured.len(), self.outputs.len());
        let n_set = self.set_points.len();
        let mut law = Law {
            a: DMatrix::zeros(n, n),
            b: DMatrix::zeros(n, n_in),
            c: DMatrix::zeros(n_out, n),
            d: DMatrix::zeros(n_out, n_in),
            b_set: DMatrix::zeros(n, n_set),
            d_set: DMatrix::zeros(n_out, n_set),
            held: Vec::new(),
        };
        let continuous = interval_s <= 0.0;
        let all = (0..n).map(Moved::State).chain((0..n_in).map(Moved::Measured));
        for moved in all.chain((0..n_set).map(Moved::SetPoint)) {
            let step = match moved {
                Moved::State(i) => STATE_DIFFERENCE * self.state[i].abs().clamp(1e-2, 1e6),
                Moved::Measured(_) | Moved::SetPoint(_) => DIFFERENCE * scale,
            };
            let (mut x, mut u) =
                self.slopes(if continuous { SHORT_S } else { interval_s }, moved, step);
            if continuous {
                u = self.slopes(0.0, moved, step).1;
                if let Moved::State(i) = moved {
                    x[i] = exact(x[i], 1.0) - 1.0;
                }
                x.iter_mut().for_each(|slope| *slope /= SHORT_S);
            } else if let Moved::State(i) = moved {
                // An integrator keeps its state whole.
                x[i] = exact(x[i], 1.0);
            }
            // What a state that is no number remembers says nothing.
            let (x, u) = (x.into_iter().map(number), u.into_iter().map(number));
            let (left, right, i) = match moved {
                Moved::State(i) => (&mut law.a, &mut law.c, i),
                Moved::Measured(i) => (&mut law.b, &mut law.d, i),
                Moved::SetPoint(i) => (&mut law.b_set, &mut law.d_set, i),
            };
            x.enumerate().for_each(|(row, slope)| left[(row, i)] = slope);
            u.enumerate().for_each(|(row, slope)| right[(row, i)] = slope);
        }
        law
    }
}

/// `value`, or what it is but for the rounding of its difference quotient.
fn exact(value: f64, wanted: f64) -> f64 {
    if (value - wanted).abs() < ROUNDING { wanted } else { value }
}

fn number(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}
