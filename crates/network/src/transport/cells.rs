//! The content of pipes whose water exchanges heat with what it passes: moving cells of water and, behind
//! the film, fixed cells of wall.
//!
//! **Equation** water `A rho cp (dT/dt + v dT/dx - D d2T/dx2) = h pi d (T_w - T)`, wall
//! `C_w' dT_w/dt = h pi d (T - T_w) - (T_w - T_b)/R`; without film the water loses `(T - T_b)/R` itself.
//!
//! **Numerics** the pipe is divided into [`CELLS`] stretches: the shape of a front depends on the length of
//! the pipe by its transfer units, not by metres. Cells of water move with the flow, so that advection is
//! exact; what enters mixes within the first of them, and a front is smeared over one cell whatever its
//! way. Exchange and movement alternate (half a step of exchange at both ends: second order), in at most
//! `MOVES` parts of a step: none shorter than needed for a sixteenth of the content or half a time
//! constant of the film. In each stretch the exchange of wall and water (two parts of cells) is the exact
//! exponential of its 2 x 2 matrix; it conserves heat. Dispersion is implicit between neighbouring cells: stable for
//! any step, and the variance of a front grows by exactly `2 D dt`; nothing is dispersed through the ends.
//! All of this is linear in the temperature of what enters, and is carried as a line over it
//! ([`Linear`]: value at 0 K and slope), so that nodes and pipes can be solved together.
//!
//! **Sources** `vanderheijde2017`, `danckwerts1953` (ends).

use crate::graph::{Edge, Network};
use crate::two_port::{EdgeThermal, PlugFlowPipe, Wall};
use anergy_core::linear::Linear;
use anergy_core::port::Port;
use serde::{Deserialize, Serialize};

/// Stretches of a pipe.
pub const CELLS: usize = 128;
/// Parts of a step, at most.
const MOVES: f64 = 64.0;
/// Share of the content that moves in one part.
const MOVED_SHARE: f64 = 1.0 / 16.0;
/// Time constants of the film that pass in one part.
const FILM_SHARE: f64 = 0.5;
/// Numbers of a pipe: the water of `CELLS + 1` moving cells (the first and the last are one together), the
/// wall of `CELLS` stretches.
const STRIDE: usize = 2 * CELLS + 1;
const NO_PIPE: u32 = u32::MAX;

/// The cells of all pipes that have them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cells {
    place_of_edge: Vec<u32>,
    /// Share of a cell that the cell of water at port a fills.
    first_share: Vec<f64>,
    t_k: Vec<f64>,
}

/// The cells of one pipe in the order from an end, as lines over the temperature of what enters there.
#[derive(Debug, Clone)]
pub(super) struct Content {
    water: [Linear; CELLS + 1],
    wall: [Linear; CELLS],
    first_share: f64,
}

/// A step of constant flow.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) m_flow_kg_s: f64,
    pub(super) surroundings_k: f64,
    pub(super) dt_s: f64,
}

impl Cells {
    /// Memory beside itself, in bytes.
    pub fn heap_bytes(&self) -> usize {
        self.place_of_edge.capacity() * size_of::<u32>()
            + (self.first_share.capacity() + self.t_k.capacity()) * size_of::<f64>()
    }

    /// All at `initial_k`.
    pub fn new(network: &Network, initial_k: f64) -> Self {
        let mut count = 0;
        let mut place = |edge: &Edge| match edge.element.thermal() {
            EdgeThermal::PlugFlow(pipe) if pipe.has_cells() => {
                count += 1;
                count - 1
            }
            _ => NO_PIPE,
        };
        let place_of_edge = network.edges.iter().map(&mut place).collect();
        Self {
            place_of_edge,
            first_share: vec![0.0; count as usize],
            t_k: vec![initial_k; count as usize * STRIDE],
        }
    }

    /// Whether the other cells belong to the same pipes.
    pub fn fits(&self, other: &Self) -> bool {
        self.place_of_edge == other.place_of_edge
            && self.first_share.len() == other.first_share.len()
            && self.t_k.len() == other.t_k.len()
            && other.first_share.iter().all(|share| (0.0..=1.0).contains(share))
    }

    fn place(&self, edge: usize) -> Option<usize> {
        let place = self.place_of_edge[edge];
        (place != NO_PIPE).then_some(place as usize)
    }

    fn numbers(&self, edge: usize) -> Option<(f64, &[f64], &[f64])> {
        let place = self.place(edge)?;
        let (water, wall) = self.t_k[place * STRIDE..][..STRIDE].split_at(CELLS + 1);
        Some((self.first_share[place], water, wall))
    }

    /// The cells of water from port a on: share of the content and temperature, K.
    pub fn water(&self, edge: usize) -> Option<impl Iterator<Item = (f64, f64)> + '_> {
        let (first, water, _) = self.numbers(edge)?;
        let share = move |i: usize| match i {
            0 => first,
            CELLS => 1.0 - first,
            _ => 1.0,
        };
        Some(water.iter().enumerate().map(move |(i, t_k)| (share(i) / CELLS as f64, *t_k)))
    }

    /// Mean temperature of the wall, K.
    pub(super) fn wall_k(&self, edge: usize) -> Option<f64> {
        let (_, _, wall) = self.numbers(edge)?;
        Some(wall.iter().sum::<f64>() / CELLS as f64)
    }

    /// Temperature of the water at an end, K.
    pub(super) fn end_k(&self, edge: usize, port: Port) -> Option<f64> {
        let (first, water, _) = self.numbers(edge)?;
        Some(match port {
            Port::A if first > 0.0 => water[0],
            Port::A => water[1],
            Port::B if first < 1.0 => water[CELLS],
            Port::B => water[CELLS - 1],
        })
    }

    /// Mean temperature of the water between two shares of the length, from port a, K.
    pub(super) fn mean_k(&self, edge: usize, from: f64, to: f64) -> Option<f64> {
        let (mut end, mut sum) = (0.0, 0.0);
        for (share, t_k) in self.water(edge)? {
            let begin = end;
            end += share;
            sum += (to.min(end) - from.max(begin)).max(0.0) * t_k;
        }
        Some(sum / (to - from))
    }

    /// Adds heat to the water between two shares of the length, over its capacity: share times K.
    pub(super) fn warm(&mut self, edge: usize, from: f64, to: f64, heat: f64) {
        let Some(place) = self.place(edge) else { return };
        let (first, cells) = (self.first_share[place], CELLS as f64);
        let (mut begin, rise_k) = (0.0, heat / (to - from));
        for (i, t_k) in self.t_k[place * STRIDE..][..=CELLS].iter_mut().enumerate() {
            let end = (i as f64 + first).min(cells) / cells;
            let within = (to.min(end) - from.max(begin)).max(0.0);
            if within > 0.0 {
                *t_k += rise_k * within / (end - begin);
            }
            begin = end;
        }
    }

    /// Fills the pipe: temperatures of water and wall, K, at a share of the length from port a.
    pub(super) fn fill(&mut self, edge: usize, t_k: impl Fn(f64) -> (f64, f64)) {
        let Some(place) = self.place(edge) else { return };
        self.first_share[place] = 0.0;
        let (water, wall) = self.t_k[place * STRIDE..][..STRIDE].split_at_mut(CELLS + 1);
        for i in 0..CELLS {
            (water[i + 1], wall[i]) = t_k((i as f64 + 0.5) / CELLS as f64);
        }
        water[0] = water[1];
    }

    /// The cells in the order from an end.
    pub(super) fn seen_from(&self, edge: usize, port: Port) -> Option<Content> {
        let (first, water, wall) = self.numbers(edge)?;
        let line = |t_k: f64| Linear::new(t_k, 0.0);
        let order = |i: usize, last: usize| if port == Port::A { i } else { last - i };
        Some(Content {
            water: std::array::from_fn(|i| line(water[order(i, CELLS)])),
            wall: std::array::from_fn(|i| line(wall[order(i, CELLS - 1)])),
            first_share: if port == Port::A { first } else { 1.0 - first },
        })
    }

    /// Puts the cells back, now that it is known what entered.
    pub(super) fn put(&mut self, edge: usize, port: Port, content: &Content, t_in_k: f64) {
        let Some(place) = self.place(edge) else { return };
        let order = |i: usize, last: usize| if port == Port::A { i } else { last - i };
        self.first_share[place] =
            if port == Port::A { content.first_share } else { 1.0 - content.first_share };
        let (water, wall) = self.t_k[place * STRIDE..][..STRIDE].split_at_mut(CELLS + 1);
        for (i, line) in content.water.iter().enumerate() {
            water[order(i, CELLS)] = line.value + line.slope * t_in_k;
        }
        for (i, line) in content.wall.iter().enumerate() {
            wall[order(i, CELLS - 1)] = line.value + line.slope * t_in_k;
        }
    }
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

/// `a x + b y`.
#[inline]
fn blend(a: f64, x: Linear, b: f64, y: Linear) -> Linear {
    Linear::new(a * x.value + b * y.value, a * x.slope + b * y.slope)
}

impl Content {
    /// Lets a step pass. Returns the heat that left with the water and the heat lost, both over the heat
    /// capacity, kg K, as lines over the temperature of what enters.
    pub(super) fn pass(&mut self, pipe: &PlugFlowPipe, step: &Step) -> (Linear, Linear) {
        let zero = Linear::new(0.0, 0.0);
        let (mut left, mut lost) = (zero, zero);
        let passed_kg = step.m_flow_kg_s.abs() * step.dt_s;
        let parts = parts(pipe, step, passed_kg);
        let part_s = step.dt_s / parts;
        let half = Exchange::new(pipe, step, 0.5 * part_s);
        let whole = Exchange::new(pipe, step, part_s);
        for part in 0..parts as usize {
            lost = lost + self.exchange(if part == 0 { &half } else { &whole }, step);
            if pipe.dispersion_kg_s > 0.0 {
                self.disperse(pipe, part_s);
            }
            left = left + self.advance(pipe.content_kg, passed_kg / parts);
        }
        lost = lost + self.exchange(&half, step);
        (left, lost)
    }

    /// Exchange between water, wall and surroundings.
    fn exchange(&mut self, exchange: &Exchange, step: &Step) -> Linear {
        let around = Linear::new(step.surroundings_k, 0.0);
        let above = |line: Linear| blend(1.0, line, -1.0, around);
        let first = self.first_share;
        let mut lost = Linear::new(0.0, 0.0);
        // What each stretch adds to the water in it, parts of which keep their difference to its mean.
        let mut before = Linear::new(0.0, 0.0);
        for i in 0..CELLS {
            let t = above(blend(first, self.water[i], 1.0 - first, self.water[i + 1]));
            let t_w = above(self.wall[i]);
            let new = blend(exchange.of_water[0], t, exchange.of_water[1], t_w);
            let new_w = blend(exchange.of_wall[0], t, exchange.of_wall[1], t_w);
            let drop = blend(exchange.cell_kg, t, -exchange.cell_kg, new);
            let drop_w = blend(exchange.wall_kg, t_w, -exchange.wall_kg, new_w);
            lost = lost + drop + drop_w;
            self.wall[i] = new_w + around;
            let added = blend(1.0, new, -exchange.parts, t);
            let here = if i == 0 { added } else { blend(1.0 - first, before, first, added) };
            self.water[i] = blend(exchange.parts, above(self.water[i]), 1.0, here) + around;
            before = added;
        }
        self.water[CELLS] = blend(exchange.parts, above(self.water[CELLS]), 1.0, before) + around;
        lost
    }

    /// Moves the water on; returns the heat that left.
    fn advance(&mut self, content_kg: f64, passed_kg: f64) -> Linear {
        let cell_kg = content_kg / CELLS as f64;
        let entering = Linear::new(0.0, 1.0);
        // What is more than the content passes through.
        let mut left = entering.scaled((passed_kg - content_kg).max(0.0));
        let mut rest = passed_kg.min(content_kg) / cell_kg;
        while rest > 0.0 {
            let room = 1.0 - self.first_share;
            let moved = rest.min(room);
            let filled = self.first_share + moved;
            if filled > 0.0 {
                self.water[0] =
                    blend(self.first_share / filled, self.water[0], moved / filled, entering);
            }
            left = blend(1.0, left, moved * cell_kg, self.water[CELLS]);
            rest -= moved;
            self.first_share = filled;
            if moved >= room {
                self.water.copy_within(0..CELLS, 1);
                self.water[0] = entering;
                self.first_share = 0.0;
            }
        }
        left
    }

    /// Dispersion between neighbouring cells, implicit.
    fn disperse(&mut self, pipe: &PlugFlowPipe, time_s: f64) {
        // Shares of a cell that are exchanged: g dt/M of a cell with D/dx^2.
        let cells = CELLS as f64;
        let number = pipe.dispersion_kg_s * cells * time_s / (pipe.content_kg / cells);
        let mass = |i: usize| match i {
            0 => self.first_share,
            CELLS => 1.0 - self.first_share,
            _ => 1.0,
        };
        // Between cell i and i + 1: their middles are closer at the ends.
        let between = |i: usize| number * 2.0 / (mass(i) + mass(i + 1));
        let mut upper = [0.0; CELLS + 1];
        let mut solution = self.water;
        let mut coupled = 0.0;
        for i in 0..=CELLS {
            let (below, above) = (coupled, if i < CELLS { between(i) } else { 0.0 });
            let diagonal = mass(i) + below + above;
            let (pivot, right) = if i == 0 {
                (diagonal, self.water[0].scaled(mass(0)))
            } else {
                let right = blend(mass(i), self.water[i], below, solution[i - 1]);
                (diagonal - below * upper[i - 1], right)
            };
            upper[i] = above / pivot;
            solution[i] = right.scaled(1.0 / pivot);
            coupled = above;
        }
        for i in (0..CELLS).rev() {
            solution[i] = blend(1.0, solution[i], upper[i], solution[i + 1]);
        }
        self.water = solution;
    }
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
