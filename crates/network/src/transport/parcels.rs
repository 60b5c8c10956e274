//! The content of pipes as moving parcels.
//!
//! A parcel is a stretch of water, its temperature linear from end to end; the parcels of a pipe are
//! ordered from port a to port b and their masses sum to the content of the pipe. Water that enters
//! pushes the others on: no numerical diffusion, an exact front.
//!
//! **Numerics** neighbours are merged, conserving enthalpy exactly, when one straight line describes
//! both and the changes by all their merges stay within [`MERGE_TOLERANCE_K`]; when a pipe is full, the
//! pair that loses least is merged.

mod stretches;

use super::pool::Pool;
use crate::graph::Network;
use crate::two_port::EdgeThermal;
use anergy_core::medium::Medium;
use anergy_core::port::Port;
use serde::{Deserialize, Serialize};

/// Largest change of a temperature by all merges since the water entered, K.
pub const MERGE_TOLERANCE_K: f64 = 5e-4;
/// Water that enters in a step with less than this share of the content (standing water, rounding of
/// flows) is absorbed by its neighbour instead of becoming a parcel.
const ABSORBED_SHARE: f64 = 1e-9;
/// Largest number of parcels in a pipe.
pub const PARCELS_PER_PIPE: usize = 200;

/// A stretch of water with a linear temperature.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Parcel {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Temperature at the end towards port a, K.
    pub t_a_k: f64,
    /// Temperature at the end towards port b, K.
    pub t_b_k: f64,
    /// Bound of what merges have changed so far, K.
    pub merged_k: f64,
}

impl Parcel {
    fn new(mass_kg: f64, t_a_k: f64, t_b_k: f64) -> Self {
        Self { mass_kg, t_a_k, t_b_k, merged_k: 0.0 }
    }

    /// Mean temperature, K.
    #[inline]
    pub fn mean_k(&self) -> f64 {
        0.5 * (self.t_a_k + self.t_b_k)
    }

    /// Temperature at the end towards a port, K.
    #[inline]
    pub fn end_k(&self, port: Port) -> f64 {
        match port {
            Port::A => self.t_a_k,
            Port::B => self.t_b_k,
        }
    }
}

const NO_PIPE: u32 = u32::MAX;

/// The parcels of all pipes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parcels {
    pool: Pool,
    ring_of_edge: Vec<u32>,
}

impl Parcels {
    /// One parcel at `initial_k` in every pipe without cells.
    pub fn new(network: &Network, initial_k: f64) -> Self {
        let (mut first, mut ring_of_edge) = (Vec::new(), Vec::new());
        for edge in &network.edges {
            if let EdgeThermal::PlugFlow(pipe) = edge.element.thermal()
                && !pipe.has_cells()
            {
                ring_of_edge.push(first.len() as u32);
                first.push(Parcel::new(pipe.content_kg, initial_k, initial_k));
            } else {
                ring_of_edge.push(NO_PIPE);
            }
        }
        Self { pool: Pool::new(&first), ring_of_edge }
    }

    /// Memory beside itself, in bytes.
    pub fn heap_bytes(&self) -> usize {
        self.pool.heap_bytes() + self.ring_of_edge.capacity() * size_of::<u32>()
    }

    /// Whether the other parcels belong to the same pipes.
    pub fn fits(&self, other: &Self) -> bool {
        self.pool.fits(&other.pool) && self.ring_of_edge == other.ring_of_edge
    }

    fn ring(&self, edge: usize) -> Option<usize> {
        let ring = self.ring_of_edge[edge];
        (ring != NO_PIPE).then_some(ring as usize)
    }

    /// Number of parcels in the pipe of an edge; 0 for others.
    pub fn count(&self, edge: usize) -> usize {
        self.ring(edge).map_or(0, |ring| self.pool.len(ring))
    }

    /// The parcels of a pipe from port a to port b.
    pub fn iter(&self, edge: usize) -> impl Iterator<Item = Parcel> + '_ {
        let ring = self.ring(edge);
        (0..self.count(edge)).filter_map(move |i| ring.map(|ring| self.pool.get(ring, i)))
    }

    /// Temperature of the water at an end of a pipe, K; `None` for other edges.
    pub fn end_k(&self, edge: usize, port: Port) -> Option<f64> {
        let ring = self.ring(edge)?;
        Some(self.near_end(ring, port))
    }

    /// Heat stored in a pipe above 0 degC, J.
    pub fn stored_j(&self, edge: usize, medium: &Medium) -> f64 {
        self.iter(edge).map(|parcel| parcel.mass_kg * medium.enthalpy_j_kg(parcel.mean_k())).sum()
    }

    /// Mean temperature of the content of a pipe, K; `None` for other edges.
    pub fn mean_k(&self, edge: usize) -> Option<f64> {
        self.ring(edge)?;
        let (mut content_kg, mut sum) = (0.0, 0.0);
        for parcel in self.iter(edge) {
            content_kg += parcel.mass_kg;
            sum += parcel.mass_kg * parcel.mean_k();
        }
        Some(sum / content_kg)
    }

    /// Fills a pipe with water of one temperature.
    pub fn fill(&mut self, edge: usize, t_k: f64) {
        self.fill_linear(edge, t_k, t_k);
    }

    /// Fills a pipe with one parcel, linear from port a to port b.
    pub fn fill_linear(&mut self, edge: usize, t_a_k: f64, t_b_k: f64) {
        let mass_kg = self.iter(edge).map(|parcel| parcel.mass_kg).sum();
        let Some(ring) = self.ring(edge) else { return };
        self.pool.replace(ring, Parcel::new(mass_kg, t_a_k, t_b_k));
    }

    /// Mean temperature of the `mass_kg` of water nearest to an end, K, when it leaves there: what is
    /// `x` kg from the end has relaxed towards `surroundings_k` by `exp(-x/decay_kg)` until then.
    /// An infinite `decay_kg` gives the mean temperature as it is.
    pub fn mean_leaving(
        &self,
        edge: usize,
        port: Port,
        mass_kg: f64,
        surroundings_k: f64,
        decay_kg: f64,
    ) -> f64 {
        let Some(ring) = self.ring(edge) else { return f64::NAN };
        let (mut rest, mut excess, mut last) = (mass_kg, 0.0, f64::NAN);
        let mut passed = 1.0;
        for i in 0..self.pool.len(ring) {
            let parcel = self.pool.get(ring, self.pool.nth_from(ring, port, i));
            let part_kg = parcel.mass_kg.min(rest);
            let (near, far) = (parcel.end_k(port), parcel.end_k(port.opposite()));
            last = near + (far - near) * part_kg / parcel.mass_kg;
            let (a, b) = (near - surroundings_k, last - surroundings_k);
            let ratio = part_kg / decay_kg;
            let (of_near, of_slope) = exponential_means(ratio);
            excess += passed * part_kg * (a * of_near + (b - a) * of_slope);
            passed *= (-ratio).exp();
            rest -= part_kg;
            if rest <= 0.0 {
                break;
            }
        }
        if mass_kg > 0.0 {
            // Rounding of the masses may leave a trace beyond the last parcel.
            let trace = rest.max(0.0) * passed * (last - surroundings_k);
            surroundings_k + (excess + trace) / mass_kg
        } else {
            self.near_end(ring, port)
        }
    }

    /// Mean temperature of the `mass_kg` of water nearest to an end, K.
    pub fn mean_near(&self, edge: usize, port: Port, mass_kg: f64) -> f64 {
        self.mean_leaving(edge, port, mass_kg, 0.0, f64::INFINITY)
    }

    fn near_end(&self, ring: usize, port: Port) -> f64 {
        self.pool.get(ring, self.pool.nth_from(ring, port, 0)).end_k(port)
    }

    /// Removes the `mass_kg` of water nearest to an end (less than the whole content).
    pub fn remove(&mut self, edge: usize, port: Port, mass_kg: f64) {
        let Some(ring) = self.ring(edge) else { return };
        let mut rest = mass_kg;
        while self.pool.len(ring) > 1 {
            let parcel = self.pool.get(ring, self.pool.nth_from(ring, port, 0));
            if parcel.mass_kg > rest {
                break;
            }
            rest -= parcel.mass_kg;
            self.pool.pop(ring, port);
        }
        let parcel = self.pool.get_mut(ring, self.pool.nth_from(ring, port, 0));
        let share = rest / parcel.mass_kg;
        let cut = parcel.end_k(port) + (parcel.end_k(port.opposite()) - parcel.end_k(port)) * share;
        parcel.mass_kg -= rest;
        match port {
            Port::A => parcel.t_a_k = cut,
            Port::B => parcel.t_b_k = cut,
        }
    }

    /// Adds water at an end of a pipe that holds `content_kg`; `outer_k` is the temperature at the end
    /// itself, `inner_k` where it meets the parcels that were there.
    pub fn add(
        &mut self,
        edge: usize,
        port: Port,
        (mass_kg, content_kg): (f64, f64),
        outer_k: f64,
        inner_k: f64,
    ) {
        let Some(ring) = self.ring(edge) else { return };
        let (t_a_k, t_b_k) = match port {
            Port::A => (outer_k, inner_k),
            Port::B => (inner_k, outer_k),
        };
        let new = Parcel::new(mass_kg, t_a_k, t_b_k);
        let neighbour = self.pool.nth_from(ring, port, 0);
        if mass_kg < ABSORBED_SHARE * content_kg {
            let beside = self.pool.get_mut(ring, neighbour);
            let total_kg = beside.mass_kg + mass_kg;
            let shift = mass_kg / total_kg * (new.mean_k() - beside.mean_k());
            *beside = Parcel {
                mass_kg: total_kg,
                t_a_k: beside.t_a_k + shift,
                t_b_k: beside.t_b_k + shift,
                merged_k: beside.merged_k,
            };
            return;
        }
        let (left, right) = match port {
            Port::A => (new, self.pool.get(ring, neighbour)),
            Port::B => (self.pool.get(ring, neighbour), new),
        };
        let merged = merge(left, right);
        if merged.merged_k <= MERGE_TOLERANCE_K {
            *self.pool.get_mut(ring, neighbour) = merged;
            return;
        }
        self.make_room(ring);
        self.pool.push(ring, port, new);
    }

    /// Replaces the whole content by one parcel.
    pub fn replace(&mut self, edge: usize, mass_kg: f64, t_a_k: f64, t_b_k: f64) {
        let Some(ring) = self.ring(edge) else { return };
        self.pool.replace(ring, Parcel::new(mass_kg, t_a_k, t_b_k));
    }

    /// Lets all parcels of a pipe relax towards `surroundings_k` by the factor `decay`; returns
    /// the sum of mass times lost temperature, kg K.
    pub fn relax(&mut self, edge: usize, surroundings_k: f64, decay: f64) -> f64 {
        let Some(ring) = self.ring(edge) else { return 0.0 };
        let mut lost = 0.0;
        for i in 0..self.pool.len(ring) {
            let parcel = self.pool.get_mut(ring, i);
            let before = parcel.mean_k();
            parcel.t_a_k = surroundings_k + (parcel.t_a_k - surroundings_k) * decay;
            parcel.t_b_k = surroundings_k + (parcel.t_b_k - surroundings_k) * decay;
            lost += parcel.mass_kg * (before - parcel.mean_k());
        }
        lost
    }

    /// Merges the pair of neighbours that changes least (error times mass) in a full pipe.
    fn make_room(&mut self, ring: usize) {
        let len = self.pool.len(ring);
        if len < PARCELS_PER_PIPE {
            return;
        }
        let pair = |i: usize| (self.pool.get(ring, i), self.pool.get(ring, i + 1));
        let cost = |i: usize| {
            let (left, right) = pair(i);
            merge(left, right).merged_k * (left.mass_kg + right.mass_kg)
        };
        let (mut best, mut best_cost) = (0, f64::INFINITY);
        for i in 0..len - 1 {
            let cost = cost(i);
            if cost < best_cost {
                (best, best_cost) = (i, cost);
            }
        }
        let (left, right) = pair(best);
        *self.pool.get_mut(ring, best) = merge(left, right);
        self.pool.remove(ring, best + 1);
    }
}

/// Means over 0..1 of `e^(-r s)` and of `s e^(-r s)`.
#[inline]
fn exponential_means(r: f64) -> (f64, f64) {
    if r < 1e-3 {
        // Series, where the closed form cancels.
        return (1.0 - r / 2.0 + r * r / 6.0, 0.5 - r / 3.0 + r * r / 8.0);
    }
    let of_one = -(-r).exp_m1() / r;
    (of_one, (of_one - (-r).exp()) / r)
}

/// One parcel for two neighbours (left towards port a) with the same enthalpy; its `merged_k` grows by
/// the largest change of a temperature at the ends and where they meet.
fn merge(left: Parcel, right: Parcel) -> Parcel {
    let mass_kg = left.mass_kg + right.mass_kg;
    let mean = (left.mass_kg * left.mean_k() + right.mass_kg * right.mean_k()) / mass_kg;
    let shift = mean - 0.5 * (left.t_a_k + right.t_b_k);
    let (t_a_k, t_b_k) = (left.t_a_k + shift, right.t_b_k + shift);
    let joint = t_a_k + (t_b_k - t_a_k) * left.mass_kg / mass_kg;
    let change = shift.abs().max((joint - left.t_b_k).abs()).max((joint - right.t_a_k).abs());
    Parcel { mass_kg, t_a_k, t_b_k, merged_k: left.merged_k.max(right.merged_k) + change }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parcels() -> Parcels {
        Parcels { pool: Pool::new(&[Parcel::new(1.0, 300.0, 300.0)]), ring_of_edge: vec![0] }
    }

    fn content(parcels: &Parcels) -> (f64, f64) {
        parcels.iter(0).fold((0.0, 0.0), |(mass, heat), parcel| {
            (mass + parcel.mass_kg, heat + parcel.mass_kg * parcel.mean_k())
        })
    }

    #[test]
    fn a_front_stays_sharp_in_both_directions() {
        let mut pipe = parcels();
        pipe.replace(0, 10.0, 300.0, 300.0);
        // 4 kg of 350 K from a, then everything back by 1 kg: 3 kg of 350 K remain at a.
        pipe.remove(0, Port::B, 4.0);
        pipe.add(0, Port::A, (4.0, 10.0), 350.0, 350.0);
        pipe.remove(0, Port::A, 1.0);
        pipe.add(0, Port::B, (1.0, 10.0), 280.0, 280.0);
        assert!((pipe.mean_near(0, Port::A, 3.0) - 350.0).abs() < 1e-12);
        assert!((pipe.mean_near(0, Port::A, 4.0) - (3.0 * 350.0 + 300.0) / 4.0).abs() < 1e-12);
        assert!((pipe.mean_near(0, Port::B, 1.0) - 280.0).abs() < 1e-12);
        assert_eq!(pipe.count(0), 3);
        assert!((content(&pipe).0 - 10.0).abs() < 1e-12);
    }

    #[test]
    fn merging_conserves_enthalpy_and_memory_is_bounded() {
        let mut pipe = parcels();
        pipe.replace(0, 100.0, 300.0, 300.0);
        let mut heat = 100.0 * 300.0;
        for i in 0..2000_u32 {
            // Reversing now and then, temperatures without any pattern.
            let (into, from) =
                if i / 37 % 2 == 0 { (Port::A, Port::B) } else { (Port::B, Port::A) };
            let t = 300.0 + f64::from(i.wrapping_mul(2_654_435_761) % 1000) / 20.0;
            let mass = 0.05 + f64::from(i % 7) * 0.03;
            heat -= mass * pipe.mean_near(0, from, mass);
            pipe.remove(0, from, mass);
            pipe.add(0, into, (mass, 100.0), t, t - 0.1);
            heat += mass * (t - 0.05);
            assert!(pipe.count(0) <= PARCELS_PER_PIPE);
        }
        let (mass, stored) = content(&pipe);
        assert!((mass - 100.0).abs() < 1e-9);
        assert!((stored / heat - 1.0).abs() < 1e-12, "{stored} {heat}");
    }

    #[test]
    fn a_linear_profile_needs_one_parcel() {
        let mut pipe = parcels();
        pipe.replace(0, 100.0, 300.0, 300.0);
        for i in 0..100 {
            let t = 300.0 + f64::from(i) * 0.01;
            pipe.remove(0, Port::B, 1.0);
            pipe.add(0, Port::A, (1.0, 100.0), t + 0.01, t);
        }
        assert_eq!(pipe.count(0), 1);
        assert!((pipe.mean_near(0, Port::B, 100.0) - 300.5).abs() < 1e-9);
    }
}
