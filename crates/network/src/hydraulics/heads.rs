//! The unknown heads of free edges, found in the same Newton iteration as the flows.
//!
//! **Equation** what is given is linear in pressures and flows: after a Newton step with the heads kept, the
//! change of the heads `C dh = target - quantity` meets all of it at once, `C = d quantity/d h` from the
//! factor of this iteration. With the new heads the step is the Newton step of the content of these heads,
//! so the line search stays what it is.
//!
//! **Numerics** quadratic convergence of flows and heads together. Since the content moves with the heads,
//! descent alone proves nothing: the first steps are full ones, and what has not converged after
//! [`MAX_TOGETHER`] iterations is begun again with the heads outside (`prescribed.rs`).
//!
//! **Sources** `todini1988` (nodal step); the heads are the Schur complement of the bordered system.

use super::position::{present, tolerance};
use super::prescribed::Stand;
use super::{HydraulicError, HydraulicReport, HydraulicSolver};
use crate::graph::{Network, Quantity};
use crate::state::{Hold, NetworkState};
use anergy_core::ids::EdgeId;
use anergy_core::numerics::dense::DenseSystem;

/// Iterations with heads and flows together.
const MAX_TOGETHER: u32 = 15;
/// The first of them, without a line search.
pub(super) const FULL_TOGETHER: u32 = 8;

/// Responses to so many heads are kept, so that their change needs no further solution.
const KEPT: usize = 4;

/// Work space for the heads of the free edges and for what changes between solves.
#[derive(Debug, Default)]
pub(super) struct Heads {
    /// Whether they are sought in the iteration of the flows.
    pub(super) together: bool,
    /// The prescriptions whose head is sought.
    pub(super) sought: Vec<usize>,
    /// What they miss, in tolerances; then the change of their heads, Pa.
    pub(super) change: Vec<f64>,
    /// The last change, Pa.
    pub(super) last_change: Vec<f64>,
    system: DenseSystem,
    /// Responses of all unknowns to 1 Pa of each head sought, where these are few; otherwise empty.
    responses: Vec<f64>,
    /// Prescriptions that change between held and limit, with how much they miss.
    pub(super) changes: Vec<(f64, usize, Hold)>,
    /// Flows and pressures before the heads were sought.
    m_before_kg_s: Vec<f64>,
    p_before_pa: Vec<f64>,
}

impl Heads {
    pub(super) fn new(network: &Network) -> Self {
        let n = network.prescriptions.len();
        let of = |count: usize| vec![0.0; if n == 0 { 0 } else { count }];
        Self {
            together: false,
            sought: Vec::with_capacity(n),
            change: Vec::with_capacity(n),
            last_change: Vec::with_capacity(n),
            system: DenseSystem::with_room(n),
            responses: Vec::with_capacity(n.min(KEPT) * (network.nodes.len() + 1)),
            changes: Vec::with_capacity(n),
            m_before_kg_s: of(network.edges.len()),
            p_before_pa: of(network.nodes.len()),
        }
    }
}

impl HydraulicSolver {
    /// Flows and heads together; none, with the flows and pressures from before, where that leads nowhere.
    pub(super) fn solve_together(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        iterations: &mut u32,
    ) -> Option<HydraulicReport> {
        self.heads.m_before_kg_s.copy_from_slice(&state.m_flow_kg_s);
        self.heads.p_before_pa.copy_from_slice(&state.p_pa);
        self.heads.together = true;
        let found = self.iterate(network, state, MAX_TOGETHER);
        self.heads.together = false;
        if let Ok(Some(report)) = found
            && self.check_floating(network).is_ok()
        {
            *iterations += report.iterations;
            return Some(report);
        }
        *iterations += MAX_TOGETHER;
        state.m_flow_kg_s.copy_from_slice(&self.heads.m_before_kg_s);
        state.p_pa.copy_from_slice(&self.heads.p_before_pa);
        None
    }

    /// Changes the heads, and the Newton step with them, so that it meets what is given.
    pub(super) fn meet(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<(), HydraulicError> {
        self.heads.change.clear();
        for &k in &self.heads.sought {
            let quantity = network.prescriptions[k].quantity;
            let mut value = present(network, state, quantity);
            if let Quantity::MassFlow(edge) = quantity {
                value += self.step[edge.index()];
            }
            let target = state.prescribed[k].value;
            self.heads.change.push((target - value) / tolerance(quantity, target));
        }
        self.solve_heads_system(network, state)?;
        self.take_heads(network);
        let Self { system, laws, step, heads, .. } = self;
        let pushes = heads.sought.iter().zip(&heads.change);
        let pushes = pushes.map(|(&k, &head)| (network.prescriptions[k].free.index(), head));
        system.push(state, laws, pushes, &heads.responses, step);
        Ok(())
    }

    /// Largest miss of what is given, in tolerances.
    pub(super) fn largest_miss(&self, network: &Network, state: &NetworkState) -> f64 {
        self.heads.sought.iter().fold(0.0, |largest, &k| largest.max(miss(network, state, k).abs()))
    }

    /// Adds the changes to the heads.
    pub(super) fn take_heads(&mut self, network: &Network) {
        for (&k, change) in self.heads.sought.iter().zip(&self.heads.change) {
            let free = network.prescriptions[k].free.index();
            if let Stand::Head { head, .. } = &mut self.stand[free] {
                *head += change;
            }
        }
    }

    /// Changes of the heads for what the prescriptions miss.
    pub(super) fn head_changes(
        &mut self,
        network: &Network,
        state: &NetworkState,
    ) -> Result<(), HydraulicError> {
        let Heads { change, sought, .. } = &mut self.heads;
        change.clear();
        change.extend(sought.iter().map(|&k| miss(network, state, k)));
        self.solve_heads_system(network, state)
    }

    /// Turns misses into changes of the heads, by the sensitivities at the last factorisation.
    fn solve_heads_system(
        &mut self,
        network: &Network,
        state: &NetworkState,
    ) -> Result<(), HydraulicError> {
        let n = self.heads.sought.len();
        self.heads.system.begin(n);
        self.heads.responses.clear();
        for column in 0..n {
            let free = network.prescriptions[self.heads.sought[column]].free;
            self.system.respond(free.index(), &self.laws);
            if n <= KEPT {
                self.heads.responses.extend_from_slice(self.system.responses());
            }
            let mut largest = 0.0_f64;
            for row in 0..n {
                let j = self.heads.sought[row];
                let quantity = network.prescriptions[j].quantity;
                let scale = tolerance(quantity, state.prescribed[j].value);
                let response = self.response(quantity, free) / scale;
                self.heads.system.set(row, column, response);
                largest = largest.max(response.abs());
            }
            if largest == 0.0 {
                return Err(HydraulicError::NoEffect { edge: free });
            }
        }
        if self.heads.system.solve(&mut self.heads.change) {
            Ok(())
        } else {
            let edge = network.prescriptions[self.heads.sought[0]].free;
            Err(HydraulicError::NoEffect { edge })
        }
    }

    /// Change of a quantity by 1 Pa of head of the edge that [`NodalSystem::respond`] was told.
    pub(super) fn response(&self, quantity: Quantity, free: EdgeId) -> f64 {
        match quantity {
            Quantity::Pressure(node) => self.system.response_pa(node.index()),
            Quantity::PressureDifference(edge) => self.system.response_dp_pa(edge.index()),
            Quantity::MassFlow(edge) => {
                let own = f64::from(u8::from(edge == free));
                (self.system.response_dp_pa(edge.index()) + own) / self.laws.slope[edge.index()]
            }
        }
    }
}

/// What a prescription misses, in tolerances.
fn miss(network: &Network, state: &NetworkState, k: usize) -> f64 {
    let quantity = network.prescriptions[k].quantity;
    let target = state.prescribed[k].value;
    (target - present(network, state, quantity)) / tolerance(quantity, target)
}
