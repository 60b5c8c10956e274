//! The water that a run begins with.

use anergy_network::graph::Network;
use anergy_network::state::NetworkState;

/// The water at the start of a run: made anew for each start, because it is as large as the state.
#[derive(Debug, Clone)]
pub(crate) struct InitialWater {
    pub t_k: f64,
    /// Pipes that begin with another temperature, K.
    pub pipes: Vec<(usize, f64)>,
    /// From where a cold solve starts.
    pub level_pa: f64,
    pub follows_densities: bool,
    pub counts_friction: bool,
    pub counts_inertia: bool,
    pub follows_temperatures: bool,
}

impl InitialWater {
    /// All water at rest at its initial temperatures.
    pub(super) fn state(&self, network: &Network) -> NetworkState {
        let mut state = NetworkState::new(network, self.t_k);
        for (pipe, t_k) in &self.pipes {
            state.fill_pipe(*pipe, *t_k);
        }
        state.p_pa.fill(self.level_pa);
        if self.follows_densities {
            state.follow_densities(network);
        }
        if self.counts_friction {
            state.count_friction();
        }
        if self.counts_inertia {
            state.count_inertia();
        }
        if self.follows_temperatures {
            state.follow_temperatures(network);
        }
        state
    }
}
