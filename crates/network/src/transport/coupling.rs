//! Heat that pipes side by side exchange.
//!
//! **Equation** `q = G (T_1(x) - T_2(x))` with G of the whole length spread evenly along it.
//!
//! **Assumptions** the exchange acts on the content of the pipes, half of a step before it moves and half
//! after (second order).
//! **Numerics** stretches of at most [`STRETCH_M`] (of very long pipes a [`MOST`]-th), each with the mean
//! temperatures of both pipes; in each the exact exchange of two bodies over the step, which conserves heat
//! and never overshoots. Water is warmed evenly within a stretch. In the steady state every pipe sees
//! the profiles of its neighbours of the round before.
//!
//! **Validity** steps in which the two exchange a small part of their difference, or shorter than the
//! transit; the heat that water takes up while it passes through in one step is that of the content.
//!
//! **Sources** specification 9.7; `wallenten1991`.

use super::Transport;
use crate::graph::{Coupling, Network};
use crate::state::NetworkState;
use crate::two_port::EdgeThermal;
use anergy_core::ids::EdgeId;

/// Length of a stretch, m, at most.
const STRETCH_M: f64 = 20.0;
/// Stretches of a pipe, at most.
const MOST: f64 = 128.0;

/// The couplings of a network by pipe.
#[derive(Debug, Clone, Default)]
pub(super) struct Coupled {
    /// Stretches of each coupling.
    stretches: Vec<usize>,
    /// Couplings of each edge: `of[first[e]..first[e + 1]]`.
    first: Vec<u32>,
    of: Vec<u32>,
}

/// A range of shares seen from the other pipe.
fn across(coupling: &Coupling, (from, to): (f64, f64)) -> (f64, f64) {
    if coupling.reversed { (1.0 - to, 1.0 - from) } else { (from, to) }
}

impl Coupled {
    pub(super) fn new(network: &Network) -> Self {
        let length_m = |k: usize, side: usize| {
            network.edges[network.couplings[k].edges[side].index()].element.length_m()
        };
        let stretches = (0..network.couplings.len())
            .map(|k| {
                (length_m(k, 0).max(length_m(k, 1)) / STRETCH_M).ceil().clamp(1.0, MOST) as usize
            })
            .collect();
        let mut lists = vec![Vec::new(); network.edges.len()];
        for (k, coupling) in network.couplings.iter().enumerate() {
            for edge in coupling.edges {
                lists[edge.index()].push(k as u32);
            }
        }
        let mut first = vec![0];
        for list in &lists {
            first.push(first[first.len() - 1] + list.len() as u32);
        }
        Self { stretches, first, of: lists.concat() }
    }

    /// Numbers of the couplings of an edge.
    pub(super) fn of_edge(&self, edge: usize) -> &[u32] {
        &self.of[self.first[edge] as usize..self.first[edge + 1] as usize]
    }

    /// Stretches of a pipe in the steady state.
    pub(super) fn stretches(&self, edge: usize) -> usize {
        let all = self.of_edge(edge).iter().map(|k| self.stretches[*k as usize]);
        all.max().unwrap_or(1)
    }

    /// Conductance of a range of a pipe to its neighbours, kg/s, and that times their temperatures.
    pub(super) fn beside(
        &self,
        network: &Network,
        state: &NetworkState,
        edge: usize,
        range: (f64, f64),
    ) -> (f64, f64) {
        let cp = network.medium.heat_capacity_j_kg_k;
        let mut sum = (0.0, 0.0);
        for k in self.of_edge(edge) {
            let coupling = &network.couplings[*k as usize];
            let other = coupling.edges[usize::from(coupling.edges[0].index() == edge)].index();
            let (from, to) = across(coupling, range);
            if let Some(t_k) = state.pipe_mean_between_k(other, from, to) {
                let conductance = coupling.conductance_w_k / cp * (range.1 - range.0);
                sum = (sum.0 + conductance, sum.1 + conductance * t_k);
            }
        }
        sum
    }
}

impl Transport {
    /// Exchanges heat between all pipes side by side for `during_s`; books it as heat taken up by each, as
    /// a mean over a step of `dt_s`.
    pub(super) fn exchange_beside(
        &self,
        network: &Network,
        state: &mut NetworkState,
        during_s: f64,
        dt_s: f64,
    ) {
        let cp = network.medium.heat_capacity_j_kg_k;
        for (coupling, &n) in network.couplings.iter().zip(&self.coupled.stretches) {
            let [one, two] = coupling.edges.map(EdgeId::index);
            let thermal = |edge: usize| network.edges[edge].element.thermal();
            let (EdgeThermal::PlugFlow(pipe_1), EdgeThermal::PlugFlow(pipe_2)) =
                (thermal(one), thermal(two))
            else {
                continue;
            };
            let (c_1, c_2) = (pipe_1.content_kg / n as f64, pipe_2.content_kg / n as f64);
            let both = c_1 * c_2 / (c_1 + c_2);
            let conductance = coupling.conductance_w_k / cp / n as f64;
            let share = -(-conductance * during_s / both).exp_m1();
            let mut passed = 0.0;
            for k in 0..n {
                let range = (k as f64 / n as f64, (k as f64 + 1.0) / n as f64);
                let other = across(coupling, range);
                let means = (
                    state.pipe_mean_between_k(one, range.0, range.1),
                    state.pipe_mean_between_k(two, other.0, other.1),
                );
                if let (Some(t_1), Some(t_2)) = means {
                    let heat = both * share * (t_1 - t_2);
                    state.warm_pipe(one, &pipe_1, range, -heat);
                    state.warm_pipe(two, &pipe_2, other, heat);
                    passed += heat;
                }
            }
            state.parcels.tidy(one);
            state.parcels.tidy(two);
            state.q_flow_w[one] -= passed * cp / dt_s;
            state.q_flow_w[two] += passed * cp / dt_s;
        }
    }
}
