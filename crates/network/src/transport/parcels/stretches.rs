//! Stretches of a pipe as the parcels in them: what pipes side by side see of each other.
//!
//! **Numerics** heat conserved exactly: a stretch is warmed by its heat over the mass that the cuts at its ends
//! leave in it.

use super::{ABSORBED_SHARE, MERGE_TOLERANCE_K, Parcel, Parcels, merge};
use anergy_core::port::Port;

impl Parcels {
    /// Mean temperature between two shares of the length, from port a, K; `None` for other edges.
    pub(in crate::transport) fn mean_between_k(
        &self,
        edge: usize,
        from: f64,
        to: f64,
    ) -> Option<f64> {
        self.ring(edge)?;
        let content_kg: f64 = self.iter(edge).map(|parcel| parcel.mass_kg).sum();
        let (from_kg, to_kg) = (from * content_kg, to * content_kg);
        let (mut end, mut sum, mut within_kg) = (0.0, 0.0, 0.0);
        for parcel in self.iter(edge) {
            let begin = end;
            end += parcel.mass_kg;
            let (first, last) = (from_kg.max(begin), to_kg.min(end));
            if last > first {
                let middle = 0.5 * (first + last) - begin;
                let slope = (parcel.t_b_k - parcel.t_a_k) / parcel.mass_kg;
                sum += (last - first) * (parcel.t_a_k + slope * middle);
                within_kg += last - first;
            }
        }
        Some(sum / within_kg)
    }

    /// Fills a pipe with equal stretches, their temperatures at the ends towards ports a and b (and what
    /// they approach) in K.
    pub(in crate::transport) fn fill_stretches(&mut self, edge: usize, ends: &[(f64, f64, f64)]) {
        let mass_kg: f64 = self.iter(edge).map(|parcel| parcel.mass_kg).sum();
        let (Some(ring), [(t_a_k, t_b_k, _), rest @ ..]) = (self.ring(edge), ends) else { return };
        let part_kg = mass_kg / ends.len() as f64;
        self.pool.replace(ring, Parcel::new(part_kg, *t_a_k, *t_b_k));
        for (t_a_k, t_b_k, _) in rest {
            self.pool.push(ring, Port::B, Parcel::new(part_kg, *t_a_k, *t_b_k));
        }
    }

    /// Warms a range of a pipe (shares of its length from port a) evenly by some heat over the heat
    /// capacity, kg K.
    pub(in crate::transport) fn warm(
        &mut self,
        edge: usize,
        content_kg: f64,
        range: (f64, f64),
        heat: f64,
    ) {
        let Some(ring) = self.ring(edge) else { return };
        let (from_kg, to_kg) = (range.0 * content_kg, range.1 * content_kg);
        for at_kg in [from_kg, to_kg] {
            self.cut(ring, at_kg, ABSORBED_SHARE * content_kg);
        }
        // Parcels with their middle in the range: the cuts leave at least one.
        let mut within = |middle_kg: f64, half_kg: f64, rise_k: f64| {
            let (mut end, mut found_kg) = (0.0, 0.0);
            for i in 0..self.pool.len(ring) {
                let parcel = self.pool.get_mut(ring, i);
                let begin = end;
                end += parcel.mass_kg;
                if (0.5 * (begin + end) - middle_kg).abs() < half_kg {
                    parcel.t_a_k += rise_k;
                    parcel.t_b_k += rise_k;
                    found_kg += parcel.mass_kg;
                }
            }
            found_kg
        };
        let (middle_kg, half_kg) = (0.5 * (from_kg + to_kg), 0.5 * (to_kg - from_kg));
        let found_kg = within(middle_kg, half_kg, 0.0);
        within(middle_kg, half_kg, heat / found_kg);
    }

    /// Divides the parcel at a place, unless another begins within `trace_kg`.
    fn cut(&mut self, ring: usize, at_kg: f64, trace_kg: f64) {
        self.make_room(ring);
        let mut end = 0.0;
        for i in 0..self.pool.len(ring) {
            let parcel = self.pool.get(ring, i);
            let begin = end;
            end += parcel.mass_kg;
            if at_kg < end {
                if at_kg - begin > trace_kg && end - at_kg > trace_kg {
                    let share = (at_kg - begin) / parcel.mass_kg;
                    let t_k = parcel.t_a_k + share * (parcel.t_b_k - parcel.t_a_k);
                    let (first_kg, second_kg) = (at_kg - begin, parcel.mass_kg - (at_kg - begin));
                    *self.pool.get_mut(ring, i) =
                        Parcel { mass_kg: second_kg, t_a_k: t_k, ..parcel };
                    let first = Parcel { mass_kg: first_kg, t_b_k: t_k, ..parcel };
                    self.pool.insert(ring, i, first);
                }
                return;
            }
        }
    }

    /// Merges all neighbours that one straight line describes.
    pub(in crate::transport) fn tidy(&mut self, edge: usize) {
        let Some(ring) = self.ring(edge) else { return };
        let mut i = 0;
        while i + 1 < self.pool.len(ring) {
            let merged = merge(self.pool.get(ring, i), self.pool.get(ring, i + 1));
            if merged.merged_k <= MERGE_TOLERANCE_K {
                *self.pool.get_mut(ring, i) = merged;
                self.pool.remove(ring, i + 1);
            } else {
                i += 1;
            }
        }
    }
}
