//! Advection without mixing: parcels of water that move, with fronts between them.
//!
//! **Equation** the tank is a stack of parcels of any mass. In a part of a step the water that enters is put
//! into the stack at the height of its port; then the stack is built again from the bottom: up to the height
//! of each outlet, where the mass that leaves is taken out. **Assumptions** water that enters pushes, and
//! does not mix with, what is there. **Numerics** exact for one port and any step; with several, exact as
//! parts become short (they are at most [`super::tank::COURANT`] of a layer). At most two parcels per layer
//! are kept: beyond that the two neighbours that lose least by mixing are merged, `m1 m2/(m1 + m2) (T1 -
//! T2)^2`, among those that are together no more than a layer. As `2 n + 1` parcels always contain such a
//! pair, a front is never blurred over more than a layer.
//!
//! **Sources** variable segments of fluid: `kuhn1980` (the plug-flow tank of TRNSYS, type 38).

use super::layers::Cells;
use super::ports::{MAX_PORTS, Openings};
use anergy_core::port::PortFlow;

/// What left through each port in a part of a step: mass, kg, and its `m T`, kg K.
pub(super) type Left = [(f64, f64); MAX_PORTS];

/// The water in the order of the height, with what enters put in.
struct Stack<'a, const N: usize> {
    cells: &'a Cells<N>,
    openings: &'a Openings,
    streams: &'a [PortFlow],
    positions: &'a [f64; MAX_PORTS],
    dt_s: f64,
    /// The cell on top of what has been taken, what is left of it, and the water below, kg.
    cell: usize,
    left_kg: f64,
    below_kg: f64,
    /// The next opening, and what still enters there.
    next: usize,
    entering: Option<(f64, f64)>,
}

impl<const N: usize> Stack<'_, N> {
    /// Takes up to a mass from the lowest water that is left: mass and temperature; `None` at the end.
    fn take(&mut self, wanted_kg: f64) -> Option<(f64, f64)> {
        if let Some((left_kg, t_k)) = self.entering {
            let taken = left_kg.min(wanted_kg);
            self.entering = (taken < left_kg).then_some((left_kg - taken, t_k));
            return Some((taken, t_k));
        }
        while let Some(opening) = self.openings.0.get(self.next) {
            if self.cell < self.cells.count && opening.below_kg > self.below_kg {
                break;
            }
            self.next += 1;
            let stream = &self.streams[opening.port];
            let flow = opening.entering_tank_kg_s(stream.m_flow_kg_s, self.positions[opening.port]);
            if flow > 0.0 {
                self.entering = Some((flow * self.dt_s, stream.t_in_k));
                return self.take(wanted_kg);
            }
        }
        if self.cell >= self.cells.count {
            return None;
        }
        let to_opening = match self.openings.0.get(self.next) {
            Some(opening) => opening.below_kg - self.below_kg,
            None => f64::INFINITY,
        };
        let taken = self.left_kg.min(wanted_kg).min(to_opening);
        let t_k = self.cells.t_k[self.cell];
        self.below_kg = match self.openings.0.get(self.next) {
            Some(opening) if taken == to_opening => opening.below_kg,
            _ => self.below_kg + taken,
        };
        if taken < self.left_kg {
            self.left_kg -= taken;
        } else {
            self.cell += 1;
            self.left_kg =
                if self.cell < self.cells.count { self.cells.mass_kg[self.cell] } else { 0.0 };
        }
        Some((taken, t_k))
    }
}

/// Moves the water for a part of a step; returns what left.
pub(super) fn displace<const N: usize>(
    cells: &mut Cells<N>,
    openings: &Openings,
    streams: &[PortFlow],
    positions: &[f64; MAX_PORTS],
    dt_s: f64,
    layer_kg: f64,
) -> Left {
    let mut left: Left = [(0.0, 0.0); MAX_PORTS];
    let mut built = Cells::<N>::empty();
    let mut built_kg = 0.0;
    let before = cells.clone();
    let mut stack = Stack {
        cells: &before,
        openings,
        streams,
        positions,
        dt_s,
        cell: 0,
        left_kg: before.mass_kg[0],
        below_kg: 0.0,
        next: 0,
        entering: None,
    };
    let mut keep = |mass_kg: f64, t_k: f64| {
        let top = built.count.wrapping_sub(1);
        // Pieces of one parcel stay one; so does water that enters with a steady temperature, layer by layer.
        if built.count > 0 && built.t_k[top] == t_k && built.mass_kg[top] + mass_kg <= layer_kg {
            built.mass_kg[top] += mass_kg;
        } else if mass_kg > 0.0 {
            built.push(mass_kg, t_k);
        }
    };
    for opening in &openings.0 {
        let stream = &streams[opening.port];
        let flow = opening.entering_tank_kg_s(stream.m_flow_kg_s, positions[opening.port]);
        if flow >= 0.0 {
            continue;
        }
        while built_kg < opening.below_kg {
            let Some((mass_kg, t_k)) = stack.take(opening.below_kg - built_kg) else { break };
            keep(mass_kg, t_k);
            built_kg += mass_kg;
        }
        let mut leaving_kg = -flow * dt_s;
        while leaving_kg > 0.0 {
            let Some((mass_kg, t_k)) = stack.take(leaving_kg) else { break };
            let gone = &mut left[opening.port];
            *gone = (gone.0 + mass_kg, gone.1 + mass_kg * t_k);
            leaving_kg -= mass_kg;
        }
    }
    while let Some((mass_kg, t_k)) = stack.take(f64::INFINITY) {
        keep(mass_kg, t_k);
    }
    *cells = built;
    left
}

/// Merges neighbours until no more than `most` parcels are left, none of them larger than a layer unless it
/// was.
pub(super) fn merge<const N: usize>(cells: &mut Cells<N>, most: usize, layer_kg: f64) {
    // Rounding may make two halves of a layer larger than a layer.
    let largest_kg = layer_kg * (1.0 + 1e-9);
    while cells.count > most {
        let mut best = (f64::INFINITY, 0);
        for i in 1..cells.count {
            let (m1, m2) = (cells.mass_kg[i - 1], cells.mass_kg[i]);
            let difference = cells.t_k[i] - cells.t_k[i - 1];
            let cost = m1 * m2 / (m1 + m2) * difference * difference;
            if m1 + m2 <= largest_kg && cost < best.0 {
                best = (cost, i);
            }
        }
        let Some(below) = best.1.checked_sub(1) else { return };
        let whole = cells.mass_kg[below] + cells.mass_kg[best.1];
        cells.t_k[below] += (cells.t_k[best.1] - cells.t_k[below]) * cells.mass_kg[best.1] / whole;
        cells.mass_kg[below] = whole;
        cells.mass_kg.copy_within(best.1 + 1..cells.count, best.1);
        cells.t_k.copy_within(best.1 + 1..cells.count, best.1);
        cells.count -= 1;
    }
}
