//! The heat of every pipe: what the flow brings, what is lost, what is stored.
//!
//! **Equation** `brought = lost + stored`, each since the start of the run; brought is
//! `sum |m| cp (T_in - T_out) dt` with the mean temperatures of each step.

use super::Simulation;
use crate::plan::Plan;
use crate::state::{PipeHeat, State};

impl Simulation {
    /// Notes what the pipes hold at the start.
    pub(super) fn fill_pipes(&mut self) {
        let (plan, network) = (&self.plan, &self.state.network);
        let stored_j = |&edge: &usize| network.parcels.stored_j(edge, &plan.network.medium);
        let pipe = |edge| PipeHeat { at_start_j: stored_j(edge), ..PipeHeat::default() };
        self.state.pipes = plan.pipes.iter().map(pipe).collect();
    }

    /// Counts the heat of a step.
    pub(super) fn book_pipes(&mut self, dt_s: f64) {
        let (plan, network) = (&self.plan, &self.state.network);
        for (pipe, &edge) in self.state.pipes.iter_mut().zip(&plan.pipes) {
            pipe.brought_j += self.transport.brought_w(&plan.network, network, edge) * dt_s;
            pipe.lost_j += network.q_loss_w[edge] * dt_s;
        }
    }
}

/// Change of what a pipe holds since the start, J.
pub(crate) fn stored_j(plan: &Plan, state: &State, pipe: usize) -> f64 {
    let medium = &plan.network.medium;
    let now_j = state.network.parcels.stored_j(plan.pipes[pipe], medium);
    now_j - state.pipes.get(pipe).map_or(now_j, |pipe| pipe.at_start_j)
}
