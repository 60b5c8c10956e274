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
//! All of this is linear in the temperature of what enters, so that nodes and pipes can be solved together:
//! what leaves is found once for the content and once for the water that enters alone.
//!
//! **Sources** `vanderheijde2017`, `danckwerts1953` (ends).

mod pass;

use crate::graph::{Edge, Network};
use crate::two_port::EdgeThermal;
use anergy_core::port::Port;
use pass::sum;
pub(super) use pass::{Content, Step};
use serde::{Deserialize, Serialize};

/// Stretches of a pipe.
pub const CELLS: usize = 128;
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
        Some(sum(wall) / CELLS as f64)
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

    /// Mean temperature of the water, K.
    pub(super) fn whole_mean_k(&self, edge: usize) -> Option<f64> {
        let (first, water, _) = self.numbers(edge)?;
        Some(
            (sum(&water[1..CELLS]) + first * water[0] + (1.0 - first) * water[CELLS])
                / CELLS as f64,
        )
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

    /// The cells in the order from an end, above a temperature.
    pub(super) fn seen_from(&self, edge: usize, port: Port, around_k: f64) -> Option<Content> {
        let (first, water, wall) = self.numbers(edge)?;
        let mut content = Content::full(first);
        let above = |to: &mut [f64], from: &[f64]| {
            to.iter_mut().zip(from).for_each(|(to, t_k)| *to = t_k - around_k);
        };
        above(&mut content.water, water);
        above(&mut content.wall, wall);
        if port == Port::B {
            content.turn();
        }
        Some(content)
    }

    /// Puts the cells back.
    pub(super) fn put(&mut self, edge: usize, port: Port, mut content: Content, around_k: f64) {
        let Some(place) = self.place(edge) else { return };
        if port == Port::B {
            content.turn();
        }
        self.first_share[place] = content.first_share;
        let cells = content.water.iter().chain(&content.wall);
        for (t_k, above_k) in self.t_k[place * STRIDE..][..STRIDE].iter_mut().zip(cells) {
            *t_k = above_k + around_k;
        }
    }
}
