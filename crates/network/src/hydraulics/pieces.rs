//! Laws with corners, of pumps that hold their flow: which piece of each holds.
//!
//! **Numerics** over the line of such a law, a thousand times steeper than its other pieces, Newton jumps from
//! one side to the other, and many such laws change sides one at a time. So each is replaced by one of its
//! pieces, continued beyond its ends; Newton solves the rest, and then pressures and flows say which piece
//! holds: a line that needs more than a limit gives way to that limit, a limit that gives more than the line
//! asks for gives way to the line. The laws are monotone, so few rounds find pieces that agree. The laws
//! themselves are solved from there; where the pieces do not settle they are, too, from what was reached.

use super::prescribed::Stand;
use super::{HydraulicError, HydraulicSolver};
use crate::graph::{Edge, Network};
use crate::state::NetworkState;
use crate::two_port::{Characteristic, EdgeState};
use anergy_core::ids::EdgeId;

/// Rounds in which pieces are chosen.
const ROUNDS: u32 = 20;
/// Iterations of a round.
pub(super) const ITERATIONS: u32 = 40;
/// A round is done when no pressure misses more than this share of the largest.
pub(super) const RESIDUAL: f64 = 1e-4;

/// The piece that stands for a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece {
    Lower,
    Line,
    Upper,
}

/// Which edges have corners, and their pieces.
pub(super) struct Corners {
    edges: Vec<EdgeId>,
    /// Of every edge; empty without corners.
    piece: Vec<Piece>,
    /// Whether pieces stand for the laws.
    pub(super) open: bool,
}

impl Corners {
    pub(super) fn new(network: &Network) -> Self {
        let edges: Vec<_> = (0..network.edges.len())
            .filter(|&i| network.edges[i].element.has_corners())
            .map(EdgeId::from_index)
            .collect();
        let piece = if edges.is_empty() { 0 } else { network.edges.len() };
        Self { edges, piece: vec![Piece::Line; piece], open: false }
    }

    /// What stands for the law of an edge, while pieces do.
    pub(super) fn characteristic(
        &self,
        edge: &Edge,
        i: usize,
        m: f64,
        state: &EdgeState,
    ) -> Option<Characteristic> {
        let pieces = edge.pieces(m, state)?;
        Some(Characteristic::PressureLoss(match self.piece[i] {
            Piece::Lower => pieces.lower,
            Piece::Line => pieces.line,
            Piece::Upper => pieces.upper,
        }))
    }
}

impl HydraulicSolver {
    /// Flows near those of laws with corners, from the flows and pressures of the state. Iterations.
    pub(super) fn choose_pieces(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<u32, HydraulicError> {
        if self.corners.edges.is_empty() {
            return Ok(0);
        }
        self.begin_pieces(network, state);
        self.corners.open = true;
        let done = self.settle_pieces(network, state);
        self.corners.open = false;
        self.known = false;
        done
    }

    fn settle_pieces(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<u32, HydraulicError> {
        let mut iterations = 0;
        for _ in 0..ROUNDS {
            self.known = false;
            let round = self.iterate(network, state, ITERATIONS)?;
            iterations += round.map_or(ITERATIONS, |report| report.iterations);
            if !self.change_pieces(network, state) {
                break;
            }
        }
        Ok(iterations)
    }

    /// The pieces that answer the pressures of the state, whatever its flows: what is set may have changed.
    fn begin_pieces(&mut self, network: &Network, state: &NetworkState) {
        for k in 0..self.corners.edges.len() {
            let i = self.corners.edges[k].index();
            let (edge, at) = (&network.edges[i], state.edge_state(network, i));
            let driving_pa = state.driving_pa(network, i);
            let m = state.m_flow_kg_s[i];
            let Some(pieces) = edge.pieces(m, &at) else { continue };
            let m_on_line = m + (driving_pa - pieces.line.value) / pieces.line.slope;
            self.corners.piece[i] = match edge.pieces(m_on_line, &at) {
                Some(there) if driving_pa < there.lower.value => Piece::Lower,
                Some(there) if driving_pa > there.upper.value => Piece::Upper,
                _ => Piece::Line,
            };
        }
    }

    /// Chooses the pieces by the flows and pressures of the state; whether any changed.
    fn change_pieces(&mut self, network: &Network, state: &NetworkState) -> bool {
        let mut changed = false;
        for k in 0..self.corners.edges.len() {
            let i = self.corners.edges[k].index();
            if self.stand.get(i).is_some_and(|stand| *stand != Stand::Own) {
                continue;
            }
            let m = state.m_flow_kg_s[i];
            let Some(pieces) = network.edges[i].pieces(m, &state.edge_state(network, i)) else {
                continue;
            };
            let driving_pa = self.system.driving_pa(state, i);
            let piece = self.corners.piece[i];
            let next = match piece {
                Piece::Line if driving_pa < pieces.lower.value => Piece::Lower,
                Piece::Line if driving_pa > pieces.upper.value => Piece::Upper,
                Piece::Lower if pieces.line.value > pieces.lower.value => Piece::Line,
                Piece::Upper if pieces.line.value < pieces.upper.value => Piece::Line,
                kept => kept,
            };
            changed |= next != piece;
            self.corners.piece[i] = next;
        }
        changed
    }
}
