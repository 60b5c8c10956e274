//! The heat of every pipe: what the flow brings, what is lost, what is stored.
//!
//! **Equation** `brought = lost + stored`, each since the start of the run; brought is
//! `sum |m| cp (T_in - T_out) dt` with the mean temperatures of each step, and what neighbours give.

use super::Simulation;
use crate::plan::Plan;
use crate::state::{PipeHeat, State};

impl Simulation {
    /// Notes what the pipes hold at the start.
    pub(super) fn fill_pipes(&mut self) {
        let (plan, network) = (&self.plan, &self.state.network);
        let stored_j = |&edge: &usize| network.pipe_holds_j(&plan.network, edge);
        let pipe = |edge| PipeHeat { at_start_j: stored_j(edge), ..PipeHeat::default() };
        self.state.pipes = plan.pipes.iter().map(pipe).collect();
    }

    /// Counts the heat of a step.
    pub(super) fn book_pipes(&mut self, dt_s: f64) {
        let (plan, network) = (&self.plan, &self.state.network);
        for (pipe, &edge) in self.state.pipes.iter_mut().zip(&plan.pipes) {
            let flow_w = self.transport.brought_w(&plan.network, network, edge);
            pipe.brought_j += (flow_w + network.q_flow_w[edge]) * dt_s;
            pipe.lost_j += network.q_loss_w[edge] * dt_s;
        }
    }
}

/// Change of what a pipe holds since the start, J.
pub(crate) fn stored_j(plan: &Plan, state: &State, pipe: usize) -> f64 {
    let now_j = state.network.pipe_holds_j(&plan.network, plan.pipes[pipe]);
    now_j - state.pipes.get(pipe).map_or(now_j, |pipe| pipe.at_start_j)
}
