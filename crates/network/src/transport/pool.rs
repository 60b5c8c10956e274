//! Storage of parcels: one arena for all pipes, in it a ring buffer for each.
//!
//! **Numerics** a pipe begins with room for [`CAPACITIES`]`[0]` parcels. Where more are needed, its ring
//! moves to a range of the next capacity; ranges that are left are used again by other pipes. Memory follows
//! what is used, at most [`PARCELS_PER_PIPE`] parcels and the ranges left behind by each pipe; a step
//! allocates only while the arena itself grows, which the space reserved at the start makes rare.

use super::parcels::{PARCELS_PER_PIPE, Parcel};
use anergy_core::port::Port;
use serde::{Deserialize, Serialize};

/// Numbers of parcels a range can hold.
const CAPACITIES: [u32; 7] = [3, 6, 12, 25, 50, 100, PARCELS_PER_PIPE as u32];
/// Parcels by which an arena can grow, from its start or from a snapshot on, before a step allocates.
const ROOM: usize = 4096;

/// Where a pipe's parcels are in the arena: a ring buffer in a range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Ring {
    start: u32,
    first: u32,
    len: u32,
    /// Index of its capacity.
    class: u32,
}

impl Ring {
    #[inline]
    fn capacity(&self) -> u32 {
        CAPACITIES[self.class as usize]
    }
}

/// The arena and its rings.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Pool {
    arena: Vec<Parcel>,
    rings: Vec<Ring>,
    /// Starts of the ranges of each capacity that no pipe uses.
    free: [Vec<u32>; CAPACITIES.len()],
}

/// A copy has the same room to grow: the state of a run is the copy of another.
impl Clone for Pool {
    fn clone(&self) -> Self {
        let mut arena = Vec::with_capacity(self.arena.len() + ROOM);
        arena.extend_from_slice(&self.arena);
        Self { arena, rings: self.rings.clone(), free: self.free.clone() }
    }
}

impl Pool {
    /// One parcel in each of the rings.
    pub(super) fn new(parcels: &[Parcel]) -> Self {
        let mut arena = Vec::with_capacity(CAPACITIES[0] as usize * parcels.len() + ROOM);
        let rings = parcels.iter().map(|parcel| {
            let start = arena.len() as u32;
            arena.resize(arena.len() + CAPACITIES[0] as usize, Parcel::default());
            arena[start as usize] = *parcel;
            Ring { start, first: 0, len: 1, class: 0 }
        });
        let rings = rings.collect();
        Self { arena, rings, free: Default::default() }
    }

    /// Memory beside itself, in bytes.
    pub(super) fn heap_bytes(&self) -> usize {
        let free: usize = self.free.iter().map(Vec::capacity).sum();
        self.arena.capacity() * size_of::<Parcel>()
            + self.rings.capacity() * size_of::<Ring>()
            + free * size_of::<u32>()
    }

    /// Whether the numbers of the other pool are those of a pool with as many rings.
    pub(super) fn fits(&self, other: &Self) -> bool {
        let ends_within = |start: u32, capacity: u32| {
            (start as usize).saturating_add(capacity as usize) <= other.arena.len()
        };
        let ring_fits = |ring: &Ring| {
            (ring.class as usize) < CAPACITIES.len()
                && ends_within(ring.start, ring.capacity())
                && ring.first < ring.capacity()
                && (1..=ring.capacity()).contains(&ring.len)
        };
        self.rings.len() == other.rings.len()
            && other.rings.iter().all(ring_fits)
            && other
                .free
                .iter()
                .zip(CAPACITIES)
                .all(|(starts, capacity)| starts.iter().all(|start| ends_within(*start, capacity)))
    }

    #[inline]
    pub(super) fn len(&self, ring: usize) -> usize {
        self.rings[ring].len as usize
    }

    /// Place in the arena of the i-th parcel, counted from port a.
    #[inline]
    fn at(&self, ring: usize, i: usize) -> usize {
        let ring = &self.rings[ring];
        let (mut slot, capacity) = (ring.first as usize + i, ring.capacity() as usize);
        if slot >= capacity {
            slot -= capacity;
        }
        ring.start as usize + slot
    }

    /// The i-th parcel, counted from port a.
    #[inline]
    pub(super) fn get(&self, ring: usize, i: usize) -> Parcel {
        self.arena[self.at(ring, i)]
    }

    #[inline]
    pub(super) fn get_mut(&mut self, ring: usize, i: usize) -> &mut Parcel {
        let at = self.at(ring, i);
        &mut self.arena[at]
    }

    /// Number from port a of the i-th parcel counted from a port.
    #[inline]
    pub(super) fn nth_from(&self, ring: usize, port: Port, i: usize) -> usize {
        match port {
            Port::A => i,
            Port::B => self.rings[ring].len as usize - 1 - i,
        }
    }

    /// One parcel in place of all.
    pub(super) fn replace(&mut self, ring: usize, parcel: Parcel) {
        (self.rings[ring].first, self.rings[ring].len) = (0, 1);
        *self.get_mut(ring, 0) = parcel;
    }

    /// Removes the parcel at an end.
    pub(super) fn pop(&mut self, ring: usize, port: Port) {
        let ring = &mut self.rings[ring];
        if port == Port::A {
            ring.first = if ring.first + 1 == ring.capacity() { 0 } else { ring.first + 1 };
        }
        ring.len -= 1;
    }

    /// Adds a parcel at an end of a ring with less than [`PARCELS_PER_PIPE`].
    pub(super) fn push(&mut self, ring: usize, port: Port, parcel: Parcel) {
        if self.rings[ring].len == self.rings[ring].capacity() {
            self.enlarge(ring);
        }
        let place = &mut self.rings[ring];
        if port == Port::A {
            place.first = if place.first == 0 { place.capacity() } else { place.first } - 1;
        }
        place.len += 1;
        let i = self.nth_from(ring, port, 0);
        *self.get_mut(ring, i) = parcel;
    }

    /// Puts a parcel before the i-th of a ring with less than [`PARCELS_PER_PIPE`].
    pub(super) fn insert(&mut self, ring: usize, i: usize, parcel: Parcel) {
        self.push(ring, Port::B, parcel);
        for k in (i + 1..self.len(ring)).rev() {
            *self.get_mut(ring, k) = self.get(ring, k - 1);
        }
        *self.get_mut(ring, i) = parcel;
    }

    /// Removes the i-th parcel.
    pub(super) fn remove(&mut self, ring: usize, i: usize) {
        for k in i..self.len(ring) - 1 {
            *self.get_mut(ring, k) = self.get(ring, k + 1);
        }
        self.rings[ring].len -= 1;
    }

    /// Moves a ring to a range of the next capacity.
    fn enlarge(&mut self, ring: usize) {
        let old = self.rings[ring];
        let class = old.class + 1;
        let capacity = CAPACITIES[class as usize] as usize;
        let start = self.free[class as usize].pop().unwrap_or_else(|| {
            let start = self.arena.len() as u32;
            self.arena.resize(self.arena.len() + capacity, Parcel::default());
            start
        });
        for i in 0..old.len as usize {
            self.arena[start as usize + i] = self.get(ring, i);
        }
        self.free[old.class as usize].push(old.start);
        self.rings[ring] = Ring { start, first: 0, len: old.len, class };
    }

    /// Memory in use, bytes.
    #[cfg(test)]
    pub(super) fn used_bytes(&self) -> usize {
        self.arena.len() * size_of::<Parcel>()
            + self.rings.len() * size_of::<Ring>()
            + self.free.iter().map(|starts| starts.len() * size_of::<u32>()).sum::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parcel(number: usize) -> Parcel {
        Parcel { mass_kg: number as f64, ..Parcel::default() }
    }

    fn numbers(pool: &Pool, ring: usize) -> Vec<usize> {
        (0..pool.len(ring)).map(|i| pool.get(ring, i).mass_kg as usize).collect()
    }

    #[test]
    fn a_ring_keeps_its_order_while_it_moves_to_larger_ranges() {
        let mut pool = Pool::new(&[parcel(0), parcel(1000)]);
        let mut expected = std::collections::VecDeque::from([0]);
        for k in 1..PARCELS_PER_PIPE {
            if k % 3 == 0 {
                pool.push(0, Port::A, parcel(k));
                expected.push_front(k);
            } else {
                pool.push(0, Port::B, parcel(k));
                expected.push_back(k);
            }
            if k % 5 == 0 {
                pool.pop(0, Port::A);
                expected.pop_front();
            }
            assert_eq!(numbers(&pool, 0), Vec::from(expected.clone()));
        }
        assert_eq!(numbers(&pool, 1), [1000]);
        pool.remove(0, 2);
        expected.remove(2);
        pool.insert(0, 4, parcel(77));
        expected.insert(4, 77);
        assert_eq!(numbers(&pool, 0), Vec::from(expected));
    }

    #[test]
    fn ranges_that_are_left_are_used_again() {
        let mut pool = Pool::new(&[parcel(0); 4]);
        for ring in 0..4 {
            for k in 1..20 {
                pool.push(ring, Port::A, parcel(k));
            }
        }
        // 4 * 3 at the start. The first ring leaves 6 and 12 for the second and takes 25; each later one
        // finds 6 and 12 free and takes another 25: 12 + 6 + 12 + 4 * 25.
        assert_eq!(pool.arena.len(), 130);
        assert!(pool.fits(&pool.clone()));
        // 32 bytes a parcel, 16 a ring: 112 for a pipe at the start.
        assert_eq!(Pool::new(&[parcel(0); 4]).used_bytes(), 4 * (3 * 32 + 16));
        assert_eq!(
            pool.used_bytes(),
            130 * 32 + 4 * 16 + 4 * (pool.free.iter().map(Vec::len).sum::<usize>())
        );
        let mut broken = pool.clone();
        broken.rings[2].first = 25;
        assert!(!pool.fits(&broken));
    }
}
