//! Inertia of the water in pipes: flows need time to change. Off unless asked for.
//!
//! **Equation** `(L/A) dm/dt = p_a - p_b - rho g (z_b - z_a) - phi(m)`. By backward Euler over a step dt the pressure loss
//! of a pipe becomes `phi(m) + L/(A dt) (m - m_0)`, m_0 being the flow at the start of the step: another monotone law, which
//! the solver takes like any other. The kinetic energy of the water is `L/A m^2/(2 rho)`; of the work that accelerates it
//! in a step `L/A (m - m_0)^2/(2 rho)` is not found in it: the step damps that much.
//!
//! **Assumptions** water moves as one body along a pipe: pressure waves (about 1 km/s) pass at once. Other elements are
//! short. A given flow that jumps takes the pressure that this needs within one step, which no real network bears.
//! **Validity** changes over more than some milliseconds per metre of pipe. Near a flow m with a quadratic loss `K m|m|`
//! the time constant is `L/(A 2 K |m|)`; of a pipe alone `d/(f v)`, whatever its length: 2.5 s for 50 mm at 1 m/s and a
//! friction factor of 0.02. Valves and pumps in series shorten it.
//!
//! **Numerics** first order in dt, damped at any step; a long step gives the flow at rest. Flows that no longer change are
//! kept without a solve. Nothing is allocated in a step.
//!
//! **Sources** specification 5.10; `wylie1993` (rigid column).

use crate::graph::Network;
use crate::state::NetworkState;
use serde::{Deserialize, Serialize};

/// What the inertia of a network remembers.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Inertia {
    /// Flow of each edge at the start of the step, kg/s; empty where water has no inertia.
    before_kg_s: Vec<f64>,
    /// One over the step, 1/s; 0 in a steady state.
    per_step_1_s: f64,
}

impl Inertia {
    /// Memory beside itself, in bytes.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.before_kg_s.capacity() * size_of::<f64>()
    }
}

impl NetworkState {
    /// From now on water has inertia.
    pub fn count_inertia(&mut self) {
        self.inertia.before_kg_s.clone_from(&self.m_flow_kg_s);
    }

    /// Whether it has.
    pub fn counts_inertia(&self) -> bool {
        !self.inertia.before_kg_s.is_empty()
    }

    /// Begins a step from the present flows; infinite `dt_s`: the steady state, in which inertia has no part.
    pub fn begin_flow_step(&mut self, dt_s: f64) {
        if self.counts_inertia() {
            self.inertia.before_kg_s.copy_from_slice(&self.m_flow_kg_s);
            self.inertia.per_step_1_s = 1.0 / dt_s;
        }
    }

    /// Whether flows go on changing by themselves.
    pub fn flows_move(&self) -> bool {
        self.counts_inertia() && !self.hydraulics_valid
    }

    /// Pressure that accelerated the water of an edge in the step, Pa from a to b.
    pub fn accelerating_pa(&self, network: &Network, edge: usize) -> f64 {
        let Some(before) = self.inertia.before_kg_s.get(edge) else { return 0.0 };
        let change_kg_s = self.m_flow_kg_s[edge] - before;
        network.edges[edge].element.inertance_1_m() * self.inertia.per_step_1_s * change_kg_s
    }

    /// Work that accelerated the water of all pipes in a step, J, and how much of it the step damps.
    pub fn acceleration_j(&self, network: &Network, dt_s: f64) -> (f64, f64) {
        let density = network.medium.density_kg_m3;
        let (mut work_j, mut damped_j) = (0.0, 0.0);
        for (i, before) in self.inertia.before_kg_s.iter().enumerate() {
            let m = self.m_flow_kg_s[i];
            let impulse = self.accelerating_pa(network, i) * dt_s / density;
            work_j += impulse * m;
            damped_j += 0.5 * impulse * (m - before);
        }
        (work_j, damped_j)
    }

    /// Kinetic energy of the water in all pipes, J; 0 where water has no inertia.
    pub fn kinetic_j(&self, network: &Network) -> f64 {
        if !self.counts_inertia() {
            return 0.0;
        }
        let flows = network.edges.iter().zip(&self.m_flow_kg_s);
        let sum: f64 = flows.map(|(edge, m)| edge.element.inertance_1_m() * m * m).sum();
        sum / (2.0 * network.medium.density_kg_m3)
    }
}

/// What the pipes oppose to a change of flow in a solve: work space.
pub(crate) struct Opposition {
    /// For each edge `L/(A dt)`, Pa s/kg, and the flow at the start of the step, kg/s; empty in steady states.
    of_edge: Vec<(f64, f64)>,
}

impl Opposition {
    pub(crate) fn new() -> Self {
        Self { of_edge: Vec::new() }
    }

    /// Takes that of the step of a state. Whether the laws are others than those without it.
    pub(crate) fn take(&mut self, network: &Network, state: &NetworkState) -> bool {
        let Inertia { before_kg_s, per_step_1_s } = &state.inertia;
        let had = !self.of_edge.is_empty();
        self.of_edge.clear();
        self.of_edge.reserve(before_kg_s.len());
        if *per_step_1_s > 0.0 {
            let resistance = |i: usize| network.edges[i].element.inertance_1_m() * per_step_1_s;
            self.of_edge.extend(before_kg_s.iter().enumerate().map(|(i, m)| (resistance(i), *m)));
        }
        had || !self.of_edge.is_empty()
    }

    /// Resistance, Pa s/kg, and the flow from which it counts, kg/s, of an edge.
    #[inline]
    pub(crate) fn get(&self, edge: usize) -> Option<(f64, f64)> {
        self.of_edge.get(edge).copied()
    }
}
