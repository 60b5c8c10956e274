//! The content of one pipe during a step of constant flow.

use super::CELLS;
use crate::two_port::{PlugFlowPipe, Wall};
use pulp::{Arch, NullaryFnOnce};

/// Parts of a step, at most.
const MOVES: f64 = 64.0;
/// Share of the content that moves in one part.
const MOVED_SHARE: f64 = 1.0 / 16.0;
/// Time constants of the film that pass in one part.
const FILM_SHARE: f64 = 0.5;
/// The last place where two cells touch.
const LAST: usize = CELLS - 1;

/// The cells of one pipe in the order from the end where water enters, K above the surroundings.
#[derive(Debug, Clone)]
pub(in crate::transport) struct Content {
    pub(super) water: [f64; CELLS + 1],
    pub(super) wall: [f64; CELLS],
    /// Share of a cell that the first cell of water fills.
    pub(super) first_share: f64,
    /// Cells of water from the first on beyond which water and wall are at the surroundings.
    reached: usize,
}

/// A step of constant flow.
#[derive(Debug, Clone, Copy)]
pub(in crate::transport) struct Step {
    pub(in crate::transport) m_flow_kg_s: f64,
    pub(in crate::transport) dt_s: f64,
}

/// Heat that passed in a step over the heat capacity, above the surroundings, kg K.
#[derive(Debug, Clone, Copy)]
pub(in crate::transport) struct Passed {
    /// With the water that left.
    pub(in crate::transport) left: f64,
    /// To the surroundings.
    pub(in crate::transport) lost: f64,
}

/// Exchange in one stretch over some time: matrix of water and wall (above the surroundings), and
/// what remains of a difference between two parts of the water.
struct Exchange {
    of_water: [f64; 2],
    of_wall: [f64; 2],
    parts: f64,
    cell_kg: f64,
    wall_kg: f64,
}

impl Exchange {
    fn new(pipe: &PlugFlowPipe, step: &Step, time_s: f64) -> Self {
        let cell_kg = pipe.content_kg / CELLS as f64;
        let m = step.m_flow_kg_s;
        let Wall::Film(film) = pipe.wall else {
            let kept = (-pipe.loss_kg_s(m) / pipe.content_kg * time_s).exp();
            return Self {
                of_water: [kept, 0.0],
                of_wall: [0.0, 1.0],
                parts: kept,
                cell_kg,
                wall_kg: 0.0,
            };
        };
        // x' = A x with A = [-a a; b -b-c]; its eigenvalues are real and not positive.
        let conductance = film.conductance_kg_s(m);
        let (a, b) = (conductance / pipe.water_kg, conductance / pipe.wall_kg);
        let outer = pipe.capacity_kg() / pipe.loss_time_constant_s(m);
        let c = outer / pipe.wall_kg;
        let half = 0.5 * (a + b + c);
        let fast = -half - (half * half - a * c).max(0.0).sqrt();
        let slow = a * c / fast;
        // e^(At) = (e^(slow t) (A - fast) - e^(fast t) (A - slow))/(slow - fast)
        let (kept, lost) = ((slow * time_s).exp(), (fast * time_s).exp());
        let entry = |value: f64, diagonal: f64| {
            (kept * (value - diagonal * fast) - lost * (value - diagonal * slow)) / (slow - fast)
        };
        Self {
            of_water: [entry(-a, 1.0), entry(a, 0.0)],
            of_wall: [entry(b, 0.0), entry(-b - c, 1.0)],
            parts: (-a * time_s).exp(),
            cell_kg,
            wall_kg: pipe.wall_kg / CELLS as f64,
        }
    }
}

/// What is inlined here works on the vectors of the processor that there are; products and additions are
/// rounded apart on each.
struct Pass<'a> {
    content: &'a mut Content,
    pipe: &'a PlugFlowPipe,
    step: &'a Step,
    entering_k: f64,
}

impl NullaryFnOnce for Pass<'_> {
    type Output = Passed;

    #[inline(always)]
    fn call(self) -> Passed {
        let Self { content, pipe, step, entering_k } = self;
        let mut passed = Passed { left: 0.0, lost: 0.0 };
        let passed_kg = step.m_flow_kg_s.abs() * step.dt_s;
        let parts = parts(pipe, step, passed_kg);
        let part_s = step.dt_s / parts;
        let half = Exchange::new(pipe, step, 0.5 * part_s);
        let whole = Exchange::new(pipe, step, part_s);
        for part in 0..=parts as usize {
            let last = part == parts as usize;
            passed.lost += content.exchange(if part == 0 || last { &half } else { &whole });
            if last {
                break;
            }
            if pipe.dispersion_kg_s > 0.0 {
                content.disperse(pipe, part_s);
            }
            passed.left += content.advance(pipe.content_kg, passed_kg / parts, entering_k);
        }
        passed
    }
}

impl Content {
    /// Cells that are to be written.
    pub(super) fn full(first_share: f64) -> Self {
        Self { reached: CELLS + 1, ..Self::cold(first_share) }
    }

    /// All at the surroundings.
    fn cold(first_share: f64) -> Self {
        Self { water: [0.0; CELLS + 1], wall: [0.0; CELLS], first_share, reached: 0 }
    }

    /// The same pipe, all at the surroundings.
    pub(in crate::transport) fn cooled(&self) -> Self {
        Self::cold(self.first_share)
    }

    /// The same pipe from the other end.
    pub(super) fn turn(&mut self) {
        self.water.reverse();
        self.wall.reverse();
        self.first_share = 1.0 - self.first_share;
    }

    /// Lets a step pass, in which water of `entering_k` above the surroundings enters.
    pub(in crate::transport) fn pass(
        &mut self,
        pipe: &PlugFlowPipe,
        step: &Step,
        entering_k: f64,
    ) -> Passed {
        Arch::new().dispatch(Pass { content: self, pipe, step, entering_k })
    }

    /// Exchange between water, wall and surroundings; returns the heat lost.
    #[inline(always)]
    fn exchange(&mut self, exchange: &Exchange) -> f64 {
        let Exchange { of_water: [water, from_wall], of_wall, parts, cell_kg, wall_kg } = *exchange;
        let (first, rest) = (self.first_share, 1.0 - self.first_share);
        let n = self.reached.min(CELLS);
        if n == 0 {
            return 0.0;
        }
        // What each stretch adds to the water in it, parts of which keep their difference to its mean.
        let mut added = [0.0; CELLS];
        let of_stretches = sum(&self.water[1..n]) + first * self.water[0] + rest * self.water[n];
        let of_wall_k = sum(&self.wall[..n]);
        let stretches = added.iter_mut().zip(&mut self.wall[..n]);
        for ((added, t_w), (a, b)) in stretches.zip(self.water[..n].iter().zip(&self.water[1..])) {
            let t = first * a + rest * b;
            *added = (water - parts) * t + from_wall * *t_w;
            *t_w = of_wall[0] * t + of_wall[1] * *t_w;
        }
        self.water[0] = parts * self.water[0] + added[0];
        let pairs = added[..n - 1].iter().zip(&added[1..n]);
        for (t, (before, here)) in self.water[1..n].iter_mut().zip(pairs) {
            *t = parts * *t + (rest * before + first * here);
        }
        // The last stretch with water goes on into a cell that the one after it (at the surroundings) shares.
        let of_last = if n == CELLS { 1.0 } else { rest };
        self.water[n] = parts * self.water[n] + of_last * added[n - 1];
        self.reached = n + 1;
        of_stretches * (cell_kg * (1.0 - water) - wall_kg * of_wall[0])
            + of_wall_k * (wall_kg * (1.0 - of_wall[1]) - cell_kg * from_wall)
    }

    /// Moves the water on; returns the heat that left.
    #[inline(always)]
    fn advance(&mut self, content_kg: f64, passed_kg: f64, entering_k: f64) -> f64 {
        let cell_kg = content_kg / CELLS as f64;
        // What is more than the content passes through.
        let mut left = entering_k * (passed_kg - content_kg).max(0.0);
        let mut rest = passed_kg.min(content_kg) / cell_kg;
        while rest > 0.0 {
            let room = 1.0 - self.first_share;
            let moved = rest.min(room);
            let filled = self.first_share + moved;
            if filled > 0.0 {
                self.water[0] = (self.first_share * self.water[0] + moved * entering_k) / filled;
                self.reached = self.reached.max(1);
            }
            left += moved * cell_kg * self.water[CELLS];
            rest -= moved;
            self.first_share = filled;
            if moved >= room {
                self.water.copy_within(0..CELLS, 1);
                self.water[0] = entering_k;
                self.first_share = 0.0;
                self.reached = (self.reached + 1).min(CELLS + 1);
            }
        }
        left
    }

    /// Dispersion between neighbouring cells, implicit.
    #[inline(always)]
    fn disperse(&mut self, pipe: &PlugFlowPipe, time_s: f64) {
        if self.reached == 0 {
            return;
        }
        // Shares of a cell that are exchanged: g dt/M of a cell with D/dx^2.
        let cells = CELLS as f64;
        let number = pipe.dispersion_kg_s * cells * time_s / (pipe.content_kg / cells);
        let first = self.first_share;
        let mass = |i: usize| match i {
            0 => first,
            CELLS => 1.0 - first,
            _ => 1.0,
        };
        // Between cell i and i + 1: their middles are closer at the ends.
        let between = |i: usize| match i {
            0 | LAST => number * 2.0 / (mass(i) + mass(i + 1)),
            _ => number,
        };
        // Elimination: what goes on to the next cell, and one over the pivot. From cell to cell within
        // the pipe only the former changes, and once it does not, nothing does.
        let (mut upper, mut scale) = ([0.0; CELLS + 1], [0.0; CELLS + 1]);
        let mut settled = false;
        for i in 0..=CELLS {
            if settled && i < LAST {
                (upper[i], scale[i]) = (upper[i - 1], scale[i - 1]);
                continue;
            }
            let below = if i > 0 { between(i - 1) } else { 0.0 };
            let above = if i < CELLS { between(i) } else { 0.0 };
            let eliminated = if i > 0 { below * upper[i - 1] } else { 0.0 };
            scale[i] = 1.0 / (mass(i) + below + above - eliminated);
            upper[i] = above * scale[i];
            settled = i > 1 && upper[i] == upper[i - 1];
        }
        let mut before = 0.0;
        for (i, (t, scale)) in self.water.iter_mut().zip(&scale).enumerate() {
            let below = if i > 0 { between(i - 1) } else { 0.0 };
            before = (mass(i) * *t) * scale + (below * scale) * before;
            *t = before;
        }
        for i in (0..CELLS).rev() {
            before = self.water[i] + upper[i] * before;
            self.water[i] = before;
        }
        self.reached = CELLS + 1;
    }
}
/// Sum in four parts that do not wait for each other.
#[inline(always)]
pub(super) fn sum(values: &[f64]) -> f64 {
    let (blocks, rest) = values.as_chunks::<4>();
    let (mut a, mut b, mut c, mut d) = (0.0, 0.0, 0.0, 0.0);
    for block in blocks {
        a += block[0];
        b += block[1];
        c += block[2];
        d += block[3];
    }
    (a + b) + (c + d) + rest.iter().sum::<f64>()
}

/// Number of parts of a step.
fn parts(pipe: &PlugFlowPipe, step: &Step, passed_kg: f64) -> f64 {
    if passed_kg == 0.0 {
        return 1.0;
    }
    let moved = passed_kg / (MOVED_SHARE * pipe.content_kg);
    let exchanged = match pipe.wall {
        Wall::Film(film) => {
            let conductance = film.conductance_kg_s(step.m_flow_kg_s);
            conductance * step.dt_s * (1.0 / pipe.water_kg + 1.0 / pipe.wall_kg) / FILM_SHARE
        }
        _ => 0.0,
    };
    moved.max(exchanged).ceil().clamp(1.0, MOVES)
}
