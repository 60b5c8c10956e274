//! Self-acting valves: openings that follow the pressures they make.
//!
//! **Equation** for each valve `r = y - y_0 - s (y_end(p(y)) - y_0) = 0`, with the share `s` of the way that
//! it goes in the step (1 in the steady state). Where `y_end` is neither open nor shut that is the line
//! `G = p(y) - p_set - X_p (1 - y_0 - (y - y_0)/s) = 0` (for a valve that closes), which stays informative where `y_end` is flat: Newton
//! on G within the ends of the way, `y_0 (1 - s)` and `y_0 + s (1 - y_0)`; a valve at an end that G would push
//! beyond it stays there. Sensitivities from the factorised matrix: `dp/dy_k = dp/dh_k (-d loss_k/dy_k)`, h a
//! head in the valve.
//!
//! **Numerics** the step is implicit, so that a valve with a small band is calm in long steps. The pressure is
//! flat over a wide and steep over a narrow opening: an opening is at most divided by 5 in one iteration, and
//! grows by 0.3. A step is halved until the largest miss of G falls, or the
//! valve that misses most goes alone. A single valve has one solution (G rises
//! with the opening); several nearly always.

use super::position::loss_at;
use super::{HydraulicError, HydraulicReport, HydraulicSolver};
use crate::graph::Network;
use crate::state::{NetworkState, REGULATED, Regulated};
use anergy_core::ids::NodeId;
use anergy_core::numerics::dense::DenseSystem;

const MAX_ROUNDS: u32 = 200;
/// A step of all valves is halved at most so often; then the worst one goes alone.
const MAX_HALVINGS: u32 = 4;
/// The largest miss must fall by this share of the step.
const FALL: f64 = 1e-3;
/// Change of the opening for the difference quotient of the valve's law.
const DIFFERENCE: f64 = 1e-6;
/// An opening falls at most to this share of itself, or by this; it rises at most by this.
const LEAST_SHARE: f64 = 0.2;
const SMALLEST_FALL: f64 = 1e-3;
const LARGEST_RISE: f64 = 0.3;

/// Work space for the openings.
#[derive(Debug, Default)]
pub(super) struct Openings {
    system: DenseSystem,
    miss: Vec<f64>,
    step: Vec<f64>,
    before: Vec<f64>,
    /// Whether each valve stays at an end of its way.
    held: Vec<bool>,
    /// Change of each miss by the own opening.
    diagonal: Vec<f64>,
}

impl Openings {
    pub(super) fn new(network: &Network) -> Self {
        let n = network.regulators.len();
        Self {
            system: DenseSystem::with_room(n),
            miss: vec![0.0; n],
            step: vec![0.0; n],
            before: vec![0.0; n],
            held: vec![false; n],
            diagonal: vec![1.0; n],
        }
    }
}

impl HydraulicSolver {
    /// Solves with every self-acting valve where it has to be at the end of the step.
    pub(super) fn solve_regulated(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<HydraulicReport, HydraulicError> {
        for (k, regulator) in network.regulators.iter().enumerate() {
            let edge = regulator.edge.index();
            let (low, high) = ends(state.regulated[k]);
            state.place_actuator(edge, state.position[edge].clamp(low, high));
        }
        let mut report = self.solve_given(network, state)?;
        let mut missed = self.misses(network, state);
        for _ in 0..MAX_ROUNDS {
            if missed.opening <= REGULATED {
                return Ok(report);
            }
            self.opening_steps(network, state);
            let before = missed;
            let mut share = 1.0;
            let mut fell = false;
            for _ in 0..=MAX_HALVINGS {
                self.place_openings(network, state, share);
                report = self.solve_again(network, state, &report)?;
                missed = self.misses(network, state);
                fell = missed.bands <= (1.0 - FALL * share) * before.bands;
                if fell || missed.opening <= REGULATED {
                    break;
                }
                share *= 0.5;
            }
            if !fell && missed.opening > REGULATED {
                self.place_openings(network, state, 0.0);
                report = self.solve_again(network, state, &report)?;
                self.misses(network, state);
                self.step_of_worst();
                self.place_openings(network, state, 1.0);
                report = self.solve_again(network, state, &report)?;
                missed = self.misses(network, state);
            }
        }
        let worst = (0..network.regulators.len())
            .max_by(|&i, &k| self.openings.miss[i].abs().total_cmp(&self.openings.miss[k].abs()));
        Err(HydraulicError::Hunting {
            edge: network.regulators[worst.unwrap_or(0)].edge,
            miss: missed.opening,
        })
    }

    /// Puts the valves on this share of their steps, within the ends of their ways.
    fn place_openings(&self, network: &Network, state: &mut NetworkState, share: f64) {
        for (k, regulator) in network.regulators.iter().enumerate() {
            let (low, high) = ends(state.regulated[k]);
            let opening = self.openings.before[k] + share * self.openings.step[k];
            state.place_actuator(regulator.edge.index(), opening.clamp(low, high));
        }
        state.invalidate_hydraulics();
    }

    /// Solves at the openings just placed; the iterations add up.
    fn solve_again(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        last: &HydraulicReport,
    ) -> Result<HydraulicReport, HydraulicError> {
        let report = self.solve_given(network, state)?;
        Ok(HydraulicReport { iterations: last.iterations + report.iterations, ..report })
    }

    /// Only the valve that misses most goes, as if the others stayed where they are.
    fn step_of_worst(&mut self) {
        let Openings { step, miss, before, held, diagonal, .. } = &mut self.openings;
        let free = (0..miss.len()).filter(|&k| !held[k]);
        let worst = free.max_by(|&i, &k| miss[i].abs().total_cmp(&miss[k].abs()));
        step.fill(0.0);
        if let Some(k) = worst {
            step[k] = bounded(-miss[k] / diagonal[k].max(1.0), before[k]);
        }
    }

    /// How far the valves are from where they have to be.
    fn misses(&mut self, network: &Network, state: &NetworkState) -> Missed {
        let mut missed = Missed { opening: 0.0, bands: 0.0 };
        for (k, regulator) in network.regulators.iter().enumerate() {
            let regulated = state.regulated[k];
            let y = state.position[regulator.edge.index()];
            let way = state.wanted_opening(regulator, regulated.set_pa) - regulated.from;
            let end = regulated.from + regulated.share * way;
            missed.opening = missed.opening.max((y - end).abs());
            // G over the band: where the pressures want the valve, without an end, against where it goes.
            let wanted = state.wanted_beyond(regulator, regulated.set_pa);
            let line = (y - regulated.from) / regulated.share + regulated.from - wanted;
            self.openings.miss[k] = line;
            let (low, high) = ends(regulated);
            let stays = (y <= low && line > 0.0) || (y >= high && line < 0.0);
            self.openings.held[k] = stays;
            if !stays {
                missed.bands = missed.bands.max(line.abs());
            }
        }
        missed
    }

    /// Newton step of the openings that are not held at an end.
    fn opening_steps(&mut self, network: &Network, state: &NetworkState) {
        self.openings.system.begin(network.regulators.len());
        for (column, regulator) in network.regulators.iter().enumerate() {
            let edge = regulator.edge.index();
            let (m, y) = (state.m_flow_kg_s[edge], state.position[edge]);
            self.openings.before[column] = y;
            self.openings.step[column] = -self.openings.miss[column];
            if self.openings.held[column] {
                self.openings.system.set(column, column, 1.0);
                self.openings.step[column] = 0.0;
                continue;
            }
            let other = if y > 0.5 { y - DIFFERENCE } else { y + DIFFERENCE };
            let loss = |position| loss_at(network, state, edge, m, position);
            let head_by_opening = -(loss(other) - loss(y)) / (other - y);
            self.system.respond(edge, &self.laws);
            for (row, sensing) in network.regulators.iter().enumerate() {
                if self.openings.held[row] {
                    continue;
                }
                let at = |node: NodeId| self.system.response_pa(node.index());
                let by_head = at(sensing.high) - sensing.low.map_or(0.0, at);
                let by_opening = by_head * head_by_opening / sensing.regulation.band_pa;
                let by_opening = if sensing.regulation.opens { -by_opening } else { by_opening };
                let own = if row == column { 1.0 / state.regulated[row].share } else { 0.0 };
                self.openings.system.set(row, column, own + by_opening);
                if row == column {
                    self.openings.diagonal[row] = own + by_opening;
                }
            }
        }
        let Openings { system, step, miss, before, held, .. } = &mut self.openings;
        if !system.solve(step) {
            // As if the pressures did not depend on the openings.
            for ((step, miss), held) in step.iter_mut().zip(&*miss).zip(&*held) {
                *step = if *held { 0.0 } else { -miss };
            }
        }
        for (step, y) in step.iter_mut().zip(&*before) {
            *step = bounded(*step, *y);
        }
    }
}

/// A step that does not leave where the slopes of the law mean something.
fn bounded(step: f64, y: f64) -> f64 {
    let fall = ((1.0 - LEAST_SHARE) * y).max(SMALLEST_FALL);
    step.clamp(-fall, LARGEST_RISE)
}

/// The largest misses.
#[derive(Debug, Clone, Copy)]
struct Missed {
    /// Of an opening.
    opening: f64,
    /// Of G over the band, of a valve that is not held at an end.
    bands: f64,
}

/// Where a valve can be at the end of the step.
fn ends(regulated: Regulated) -> (f64, f64) {
    let Regulated { from, share, .. } = regulated;
    (from * (1.0 - share), from + share * (1.0 - from))
}
