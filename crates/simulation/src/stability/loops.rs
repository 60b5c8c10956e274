//! The closed loops of a group of controllers as one matrix of a complex frequency.
//!
//! **Equation** outputs `u = C(s) y`, readings `y = P(s) u`, `P_ij = S_i(s) G_ij A_j(s)` with the gains G of the
//! network, the lags A of the actuators and the sensors S (`chains.rs`); the loops have a mode wherever
//! `det(1 + k L(s)) = 0`, `L = -C P`, k = 1; with k all controllers of the group are scaled together. Sampled
//! controllers of one interval h: the same in `z = exp(s h)`, exact at the samples. Water with inertia: G in parts
//! behind lags (`water.rs`). An output u_j that is the set point of another controller: that answers with `F(s) u_j`,
//! `L = -C P - F`; sampled, one that updates later sees it at once, one that updates earlier an interval later.
//! **Sources** `skogestad2005`.

use super::answers::Link;
use super::chains::{Chains, Seen};
use super::elimination::{Eliminated, Rows};
use super::lanes::more;
use super::law::Law;
use super::response::StepResponse;
use super::water::Late;
use nalgebra::{Complex, DMatrix, DVector};

/// What lies between the outputs and the measured values of some controllers, in their order.
#[derive(Debug, Clone)]
pub(super) struct Between {
    /// Gains of measured values (rows) over outputs, settled.
    pub gains: DMatrix<f64>,
    /// What of them comes behind a lag of the water.
    pub late: Vec<Late>,
    /// Responses in which temperatures take part, in place of gains: value, output.
    pub slow: Vec<(usize, usize, StepResponse)>,
    /// Sensor of each measured value.
    pub seen: Vec<Seen>,
    /// Time constant of each of the two lags of each actuator, s.
    pub lags_s: Vec<f64>,
    /// Outputs that are set points.
    pub links: Vec<Link>,
}

/// Gains with the chains that they have.
struct Way {
    chains: Chains,
    /// Of outputs (rows) on measured values (columns), so that those on one value lie together.
    gains: DMatrix<f64>,
}

/// The loops of a group.
pub(super) struct Loops {
    pub laws: Vec<Law>,
    /// Gains of measured values (rows) over outputs, in the order of the controllers.
    pub gains: DMatrix<f64>,
    /// What comes at once, then what comes behind the water.
    ways: Vec<Way>,
    links: Vec<Link>,
    /// Interval of all controllers, s; 0 where they are continuous.
    pub interval_s: f64,
    /// Responses in which temperatures take part, in place of gains: value, output.
    slow: Vec<(usize, usize, StepResponse)>,
    /// Controller of each output.
    pub owner: Vec<usize>,
    /// All loops have the same law, chain and timing but for their gains: these.
    pub uniform: Option<Vec<f64>>,
}

impl Loops {
    /// Loops of `laws` with what lies between; the interval is 0 where they are continuous.
    pub fn new(laws: Vec<Law>, between: Between, interval_s: f64) -> Self {
        let Between { gains, late, slow, seen, lags_s, links } = between;
        let owner = laws.iter().enumerate().flat_map(|(i, law)| vec![i; law.c.nrows()]).collect();
        let chains = |water_lag_s| Chains::new(&lags_s, &seen, water_lag_s, interval_s);
        let at_once = late.iter().fold(gains.clone(), |rest, late| rest - &late.gains);
        let way =
            |lag_s, gains: DMatrix<f64>| Way { chains: chains(lag_s), gains: gains.transpose() };
        let mut ways = vec![way(0.0, at_once)];
        ways.extend(late.into_iter().map(|late| way(late.lag_s, late.gains)));
        let mut loops = Self { laws, gains, ways, links, interval_s, slow, owner, uniform: None };
        loops.uniform = loops.uniform_gains();
        loops
    }

    /// Number of outputs.
    pub fn len(&self) -> usize {
        self.owner.len()
    }

    /// The gain of each controller where they differ in nothing else.
    fn uniform_gains(&self) -> Option<Vec<f64>> {
        let single = |law: &Law| law.single(one()).is_some();
        let plain = self.ways.len() == 1 && self.links.is_empty() && self.slow.is_empty();
        if !plain || !self.chains().alike() || !self.laws.iter().all(single) {
            return None;
        }
        let parts = |law: &Law| (law.a[(0, 0)], law.c[(0, 0)] * law.b[(0, 0)], law.d[(0, 0)]);
        let (a, cb, d) = parts(&self.laws[0]);
        let gain = |(own_cb, own_d): (f64, f64)| {
            if d.abs() > 0.0 { own_d / d } else { own_cb / cb }
        };
        let near = |x: f64, y: f64| (x - y).abs() <= 1e-6 * x.abs().max(y.abs());
        let same = self.laws.iter().all(|law| {
            let (own_a, own_cb, own_d) = parts(law);
            let k = gain((own_cb, own_d));
            (own_a - a).abs() < 1e-9 && near(own_cb, k * cb) && near(own_d, k * d) && k.is_finite()
        });
        same.then(|| self.laws.iter().map(parts).map(|(_, cb, d)| gain((cb, d))).collect())
    }

    /// The law and chain that all loops have where they are uniform, without gains.
    pub fn common(&self, s: Complex<f64>) -> Complex<f64> {
        let answer = self.laws[0].single(self.chains().variable(s)).unwrap_or_default();
        -answer * self.chains().one(0, 0, s)
    }

    /// The chains of what comes at once.
    fn chains(&self) -> &Chains {
        &self.ways[0].chains
    }

    /// `L(s)`.
    pub fn matrix(&self, s: Complex<f64>) -> Rows {
        let n = self.len();
        let mut plant = self.chains().plant(s, &self.ways[0].gains);
        for way in &self.ways[1..] {
            let late = way.chains.plant(s, &way.gains);
            (0..late.rows()).for_each(|i| more(one(), late.row(i), plant.row_mut(i)));
        }
        for (i, j, response) in &self.slow {
            plant.set(*i, *j, self.slow_answer(*i, *j, response, s));
        }
        let variable = self.chains().variable(s);
        let (mut row, mut seen) = (0, 0);
        let mut matrix = Rows::zeros(n, n);
        for law in &self.laws {
            if let Some(entry) = law.single(variable) {
                more(-entry, plant.row(seen), matrix.row_mut(row));
                (row, seen) = (row + 1, seen + 1);
                continue;
            }
            let transfer = law.transfer(variable);
            for (value, column) in transfer.column_iter().enumerate() {
                for (output, entry) in column.iter().enumerate() {
                    more(-entry, plant.row(seen + value), matrix.row_mut(row + output));
                }
            }
            row += transfer.nrows();
            seen += transfer.ncols();
        }
        for link in &self.links {
            let answer = self.laws[link.to].follows(variable, link.set_point);
            let late = if self.interval_s > 0.0 && link.from > link.to { variable } else { one() };
            let first = self.owner.iter().position(|owner| *owner == link.to).unwrap_or(0);
            for (k, entry) in answer.iter().enumerate() {
                let (i, j) = (first + k, link.output);
                matrix.set(i, j, matrix.at(i, j) - entry / late);
            }
        }
        matrix
    }

    /// `L_ii(s)`: the loop of one output with all others open.
    pub fn own(&self, i: usize, s: Complex<f64>) -> Complex<f64> {
        let law = self.owner[i];
        let before = &self.laws[..law];
        let first: usize = before.iter().map(|law| law.c.nrows()).sum();
        let seen: usize = before.iter().map(|law| law.b.ncols()).sum();
        let variable = self.chains().variable(s);
        let answer = |value: usize| {
            let slow = self.slow.iter().find(|(of, to, _)| (*of, *to) == (value, i));
            match slow {
                Some((_, _, response)) => self.slow_answer(value, i, response, s),
                None => {
                    let ways = self.ways.iter();
                    ways.map(|way| way.chains.one(value, i, s) * way.gains[(i, value)]).sum()
                }
            }
        };
        if let Some(entry) = self.laws[law].single(variable) {
            return -entry * answer(seen);
        }
        let transfer = self.laws[law].transfer(variable);
        let row = transfer.row(i - first);
        -row.iter().enumerate().map(|(k, entry)| entry * answer(seen + k)).sum::<Complex<f64>>()
    }

    /// A response in which temperatures take part, with its chain.
    fn slow_answer(
        &self,
        i: usize,
        j: usize,
        response: &StepResponse,
        s: Complex<f64>,
    ) -> Complex<f64> {
        // Between two samples the command is held: late by half of the interval.
        let x = s * self.interval_s;
        let hold = if x.norm() < 1e-8 { Complex::new(1.0, 0.0) } else { (1.0 - (-x).exp()) / x };
        self.chains().continuous(i, j, s) * hold * response.at(s)
    }

    /// `1 + k L(s)`.
    pub fn closed(&self, s: Complex<f64>, factor: f64) -> Rows {
        self.matrix(s).closed(factor)
    }

    /// Times between which its frequencies lie, s: the sum of all lags of the slowest chain, the fastest.
    pub fn times_s(&self) -> (f64, f64) {
        let slow = self.slow.iter().map(|(i, j, response)| {
            let t = response.time_s() + self.chains().total_s(*i, *j);
            (t, t)
        });
        let all = self.ways.iter().map(|way| way.chains.times_s()).chain(slow);
        let (min, max) = all
            .fold((f64::INFINITY, 0.0), |(min, max): (f64, f64), t| (min.min(t.0), max.max(t.1)));
        if max > 0.0 { (min.max(1e-3 * max), max) } else { (1.0, 1.0) }
    }

    /// Longest time that passes before anything is answered, s.
    pub fn dead_s(&self) -> f64 {
        self.chains().dead_s()
    }

    /// Largest frequency that means something, rad/s.
    pub fn highest_rad_s(&self) -> f64 {
        let (shortest, _) = self.times_s();
        if self.interval_s > 0.0 {
            std::f64::consts::PI / self.interval_s
        } else {
            300.0 / shortest
        }
    }

    /// How much of a mode is in each controller, and the phase of each output, radians, at a root `s`.
    pub fn shape(&self, s: Complex<f64>) -> (Vec<f64>, Vec<f64>) {
        // Near a root the inverse is the residue over the distance: right times left vector.
        let beside = s + Complex::new(1e-5 * s.norm(), 0.0);
        let n = self.len();
        let Some(closed) = Eliminated::of(self.closed(beside, 1.0)) else {
            return (vec![0.0; self.laws.len()], vec![0.0; n]);
        };
        let inverse = closed.inverse();
        let mut shares = vec![0.0; self.laws.len()];
        let total: f64 = (0..n).map(|i| inverse.at(i, i).norm()).sum();
        for i in 0..n {
            shares[self.owner[i]] += inverse.at(i, i).norm() / total;
        }
        let column =
            (0..n).max_by(|i, k| inverse.at(*i, *i).norm().total_cmp(&inverse.at(*k, *k).norm()));
        let column = column.unwrap_or(0);
        let reference = inverse.at(column, column);
        let phases = (0..n).map(|i| (inverse.at(i, column) / reference).arg()).collect();
        (shares, phases)
    }

    /// Relative gain of each loop with itself at rest, where there are as many values as outputs.
    pub fn relative_gains(&self) -> Option<DVector<f64>> {
        if self.gains.nrows() != self.gains.ncols() {
            return None;
        }
        let inverse = self.gains.clone().try_inverse()?;
        Some(self.gains.component_mul(&inverse.transpose()).diagonal())
    }
}

fn one() -> Complex<f64> {
    Complex::new(1.0, 0.0)
}
