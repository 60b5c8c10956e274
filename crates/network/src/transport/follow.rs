//! Viscosity and density in the pressure losses of pipes, where they follow the temperature.
//!
//! **Equation** `mu_e = mu(T_e)`, `rho_e = rho(T_e)` with the mean temperature of the content of a pipe; the
//! laws of all other elements hold at the properties of the medium.
//!
//! **Assumptions** one value a pipe. The hydraulics of a step see the properties at its start.
//!
//! **Numerics** during a run the properties of a pipe stay until its viscosity has changed by
//! [`CHANGE`], so that the hydraulics are not solved anew for changes that nobody sees: the friction of
//! turbulent flow goes with about the fourth root of the viscosity. The steady state follows exactly.
//!
//! **Sources** specification 2.

use super::Transport;
use crate::graph::Network;
use crate::state::{LawWater, NetworkState};
use crate::two_port::EdgeThermal;
use anergy_core::medium::Medium;

/// Viscosity that is followed in a run, as a share of it (0.05 K).
const CHANGE: f64 = 1e-3;
/// The same in the steady state: more than rounding.
const SETTLED: f64 = 1e-12;

fn water(medium: &Medium, t_k: f64) -> LawWater {
    LawWater {
        density_kg_m3: medium.density_at_kg_m3(t_k),
        viscosity_pa_s: medium.viscosity_at_pa_s(t_k),
    }
}

fn is_pipe(network: &Network, edge: usize) -> bool {
    matches!(network.edges[edge].element.thermal(), EdgeThermal::PlugFlow(_))
}

impl NetworkState {
    /// From now on the water in the laws of pipes is what it is at its temperature.
    pub fn follow_temperatures(&mut self, network: &Network) {
        let medium = &network.medium;
        let all = (0..network.edges.len()).map(|i| match is_pipe(network, i) {
            true => water(medium, self.content_k(network, i)),
            false => LawWater {
                density_kg_m3: medium.density_kg_m3,
                viscosity_pa_s: medium.viscosity_pa_s,
            },
        });
        self.law_water = all.collect();
        self.hydraulics_valid = false;
    }

    fn follow_edge(&mut self, i: usize, water: LawWater, change: f64) {
        let before = self.law_water[i].viscosity_pa_s;
        if (water.viscosity_pa_s - before).abs() > change * before {
            self.law_water[i] = water;
            self.hydraulics_valid = false;
        }
    }
}

impl Transport {
    /// The water of pipes is what it is at the temperatures of the end of a step.
    pub(super) fn follow(&self, network: &Network, state: &mut NetworkState) {
        for i in 0..state.law_water.len() {
            if is_pipe(network, i) {
                let t_k = state.content_k(network, i);
                state.follow_edge(i, water(&network.medium, t_k), CHANGE);
            }
        }
    }

    /// The same in the steady state.
    pub(super) fn follow_settled(&self, network: &Network, state: &mut NetworkState) {
        for i in 0..state.law_water.len() {
            if let Some(t_k) = self.settled_k(network, state, i).filter(|_| is_pipe(network, i)) {
                state.follow_edge(i, water(&network.medium, t_k), SETTLED);
            }
        }
    }
}
