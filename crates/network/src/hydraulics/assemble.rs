//! The nodal system: which node is which unknown, the matrix, the right-hand side, the residuals.

mod linear;

pub(super) use linear::Disturbance;

use super::ideal::{IdealLink, ideal_forest};
use super::islands::Islands;
use crate::graph::{Network, NodeKind, UnionFind};
use crate::hydraulics::{HydraulicError, Kind, Laws};
use crate::state::NetworkState;
use anergy_core::ids::NodeId;
use anergy_core::numerics::sparse::ConductanceSolver;

/// No unknown or no slot.
const NONE: u32 = u32::MAX;

/// Where an edge enters the matrix.
#[derive(Debug, Clone, Copy)]
struct EdgeSlots {
    node_a: u32,
    node_b: u32,
    /// Where the balances of its ends are kept; the place behind those of the unknowns where the pressure is fixed.
    balance_a: u32,
    balance_b: u32,
    /// Between the unknowns, or from one to a fixed pressure.
    conductance: u32,
}

pub(super) struct NodalSystem {
    conductances: ConductanceSolver,
    slots: Vec<EdgeSlots>,
    /// Unknown of each node; NONE where the pressure is fixed.
    unknown_of_node: Vec<u32>,
    /// Conductance of each unknown to fixed pressures.
    to_fixed: Vec<u32>,
    gravity_pa: Vec<f64>,
    ideal_links: Vec<IdealLink>,
    /// Net inflow of each unknown, then its increment; one place more for what leaves at fixed pressures.
    increment: Vec<f64>,
    /// Conductance of each edge in the matrix, kg/(s Pa).
    edge_conductance: Vec<f64>,
    net_inflow: Vec<f64>,
    /// Nodes with a given flow.
    sources: Vec<u32>,
    /// What the rounding of each pressure has left out since the beginning of the solve, Pa.
    p_rest_pa: Vec<f64>,
    largest_p_pa: f64,
    islands: Islands,
}

impl NodalSystem {
    pub(super) fn new(network: &Network) -> Result<Self, HydraulicError> {
        let (n, edges) = (network.nodes.len(), network.edges.len());
        let mut merged = UnionFind::new(n);
        for edge in network.edges.iter().filter(|edge| network.is_ideal(edge)) {
            merged.union(edge.from.index(), edge.to.index());
        }
        let mut fixed = vec![false; n];
        for (i, node) in network.nodes.iter().enumerate() {
            fixed[merged.find(i)] |= node.has_fixed_pressure();
        }
        let mut unknown_of_root = vec![NONE; n];
        let mut count = 0_u32;
        for i in 0..n {
            let root = merged.find(i);
            if !fixed[root] && unknown_of_root[root] == NONE {
                unknown_of_root[root] = count;
                count += 1;
            }
        }
        let mut unknown_of_node: Vec<u32> =
            (0..n).map(|i| unknown_of_root[merged.find(i)]).collect();
        let ends = |i: usize| {
            let edge = &network.edges[i];
            (unknown_of_node[edge.from.index()], unknown_of_node[edge.to.index()])
        };
        let pairs: Vec<(usize, usize)> = (0..edges)
            .map(ends)
            .filter(|&(a, b)| a != NONE && b != NONE && a != b)
            .map(|(a, b)| (a as usize, b as usize))
            .collect();
        let mut conductances = ConductanceSolver::analyze(count as usize, &pairs)?;
        let order = conductances.count_in_order();
        if !order.is_empty() {
            for unknown in unknown_of_node.iter_mut().filter(|unknown| **unknown != NONE) {
                *unknown = order[*unknown as usize];
            }
        }
        let ends = |i: usize| {
            let edge = &network.edges[i];
            (unknown_of_node[edge.from.index()], unknown_of_node[edge.to.index()])
        };
        let slot = |a: u32, b: u32| {
            let (a, b) = if a == NONE {
                (b, b)
            } else if b == NONE {
                (a, a)
            } else {
                (a, b)
            };
            if a == NONE {
                return NONE;
            }
            conductances.slot(a as usize, b as usize).map_or(NONE, |slot| slot as u32)
        };
        let slots = (0..edges)
            .map(|i| (i, ends(i)))
            .map(|(i, (a, b))| EdgeSlots {
                node_a: network.edges[i].from.0,
                node_b: network.edges[i].to.0,
                balance_a: a.min(count),
                balance_b: b.min(count),
                conductance: if a == b { NONE } else { slot(a, b) },
            })
            .collect();
        let to_fixed = (0..count).map(|i| slot(i, i)).collect();
        let density = network.medium.density_kg_m3;
        let gravity_pa = network
            .edges
            .iter()
            .map(|edge| {
                let z = |id: NodeId| network.nodes[id.index()].elevation_m;
                density * network.gravity_m_s2 * (z(edge.to) - z(edge.from))
            })
            .collect();
        Ok(Self {
            conductances,
            slots,
            unknown_of_node,
            to_fixed,
            gravity_pa,
            ideal_links: ideal_forest(network),
            increment: vec![0.0; count as usize + 1],
            edge_conductance: vec![0.0; edges],
            net_inflow: vec![0.0; n],
            sources: (0..n as u32)
                .filter(|&i| network.nodes[i as usize].kind == NodeKind::Source)
                .collect(),
            p_rest_pa: vec![0.0; n],
            largest_p_pa: 0.0,
            islands: Islands::new(n, edges),
        })
    }

    /// What each law misses, Pa.
    pub(super) fn misses(&self, state: &NetworkState, laws: &Laws, miss_pa: &mut [f64]) {
        for (i, (miss, loss)) in miss_pa.iter_mut().zip(&laws.loss).enumerate() {
            *miss = self.driving_pa(state, i) - loss;
        }
    }

    /// Pressure difference of an edge without its hydrostatic part, Pa: what its law has to answer.
    #[inline]
    pub(super) fn driving_pa(&self, state: &NetworkState, edge: usize) -> f64 {
        driving_pa(&state.p_pa, &self.p_rest_pa, &self.slots[edge], self.gravity_pa[edge])
    }

    /// Largest absolute pressure after the last step, Pa.
    pub(super) fn largest_p_pa(&self) -> f64 {
        self.largest_p_pa
    }

    /// Puts given pressures and ideal heads into the state and finds floating islands.
    pub(super) fn begin(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        kind: &[Kind],
        laws: &Laws,
    ) -> Result<(), HydraulicError> {
        self.p_rest_pa.fill(0.0);
        // Buoyancy: what the water weighs at its temperature.
        for (i, density_kg_m3) in state.density_kg_m3.iter().enumerate() {
            let z_m = |id: NodeId| network.nodes[id.index()].elevation_m;
            let edge = &network.edges[i];
            self.gravity_pa[i] =
                density_kg_m3 * network.gravity_m_s2 * (z_m(edge.to) - z_m(edge.from));
        }
        for (i, node) in network.nodes.iter().enumerate() {
            if node.has_fixed_pressure() {
                state.p_pa[i] = state.given_p_pa[i];
            }
        }
        // Links are ordered from the root (a fixed node where there is one) to the leaves.
        for link in &self.ideal_links {
            let edge = &network.edges[link.edge as usize];
            // p_a - p_b = -head + rho g (z_b - z_a)
            let drop = self.gravity_pa[link.edge as usize] - state.position[link.edge as usize];
            let (parent, child) = (link.parent as usize, link.child as usize);
            state.p_pa[child] = if edge.from.index() == parent {
                state.p_pa[parent] - drop
            } else {
                state.p_pa[parent] + drop
            };
        }
        self.islands.update(network, kind);
        self.islands.check(network, state, kind, laws, &mut self.net_inflow)
    }

    /// Pressures of a first solve; parts without a pressure level keep theirs.
    pub(super) fn forget_pressures(&self, state: &mut NetworkState) {
        for (i, p) in state.p_pa.iter_mut().enumerate() {
            // In ascending order.
            if self.islands.floating().binary_search(&(i as u32)).is_err() {
                *p = 0.0;
            }
        }
    }

    /// Assembles and solves one Newton step: pressures are moved, `step` receives the flows' change.
    pub(super) fn newton_step(
        &mut self,
        state: &mut NetworkState,
        kind: &[Kind],
        laws: &Laws,
        miss_pa: &[f64],
        step: &mut [f64],
    ) -> Result<(), HydraulicError> {
        self.start_balance(state);
        let values = self.conductances.values_mut();
        values.fill(0.0);
        let mut largest_conductance = 0.0_f64;
        for (i, slots) in self.slots.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            let mut conductance = 0.0;
            step[i] = match kind[i] {
                Kind::Ideal => {
                    step[i] = 0.0;
                    continue;
                }
                Kind::Imposed => laws.loss[i] - m,
                Kind::Law => {
                    conductance = 1.0 / laws.slope[i];
                    largest_conductance = largest_conductance.max(conductance);
                    if slots.conductance != NONE {
                        values[slots.conductance as usize] += conductance;
                    }
                    conductance * miss_pa[i]
                }
            };
            self.edge_conductance[i] = conductance;
            balance(&mut self.increment, slots, m + step[i]);
        }
        self.tie_floating(largest_conductance);
        self.conductances.factor()?;
        self.solve();
        self.spread(state, step);
        Ok(())
    }

    /// Adds what heads in some edges, Pa, change in the pressures and the step, at the last factorisation; `responses`
    /// are those to 1 Pa in each of them one after another, or none.
    pub(super) fn push(
        &mut self,
        state: &mut NetworkState,
        laws: &mut Laws,
        heads: impl Iterator<Item = (usize, f64)>,
        responses: &[f64],
        step: &mut [f64],
    ) {
        self.increment.fill(0.0);
        let mut responses = responses.chunks_exact(self.increment.len());
        let known = responses.len() > 0;
        for (edge, head) in heads {
            laws.loss[edge] -= head;
            let flow = head / laws.slope[edge];
            step[edge] += flow;
            match responses.next() {
                Some(response) => {
                    self.increment.iter_mut().zip(response).for_each(|(x, by)| *x += head * by);
                }
                None => balance(&mut self.increment, &self.slots[edge], flow),
            }
        }
        if !known {
            self.solve();
        }
        self.spread(state, step);
    }

    /// Moves the pressures by their increment and the step by what that drives.
    fn spread(&mut self, state: &mut NetworkState, step: &mut [f64]) {
        self.largest_p_pa = 0.0;
        let pressures = state.p_pa.iter_mut().zip(&mut self.p_rest_pa);
        for ((p, rest), &unknown) in pressures.zip(&self.unknown_of_node) {
            if unknown != NONE {
                let before = *p;
                let increment = self.increment[unknown as usize] + *rest;
                *p += increment;
                let moved = *p - before;
                *rest = (before - (*p - moved)) + (increment - moved);
            }
            self.largest_p_pa = self.largest_p_pa.max(p.abs());
        }
        for ((slots, conductance), step) in self.slots.iter().zip(&self.edge_conductance).zip(step)
        {
            *step += conductance * difference(&self.increment, slots);
        }
    }

    /// Solves for the net inflow in `increment`; nothing changes where the pressure is fixed.
    fn solve(&mut self) {
        let unknowns = self.increment.len() - 1;
        self.increment[unknowns] = 0.0;
        self.conductances.solve_in_place(&mut self.increment[..unknowns]);
    }

    /// Whether an end of an edge lies in a part without a pressure level.
    pub(super) fn joins_floating(&mut self, network: &Network, edge: usize) -> bool {
        let edge = &network.edges[edge];
        [edge.from, edge.to].into_iter().any(|node| self.islands.floats(node.index()))
    }

    /// What sources bring to each unknown.
    fn start_balance(&mut self, state: &NetworkState) {
        self.increment.fill(0.0);
        for &node in &self.sources {
            let unknown = self.unknown_of_node[node as usize];
            if unknown != NONE {
                self.increment[unknown as usize] += state.given_m_flow_kg_s[node as usize];
            }
        }
    }

    /// Largest miss of the mass balances, kg/s, and a node where it is.
    pub(super) fn mass_residual(&mut self, state: &NetworkState) -> (f64, usize) {
        self.start_balance(state);
        for (slots, &m) in self.slots.iter().zip(&state.m_flow_kg_s) {
            balance(&mut self.increment, slots, m);
        }
        let mut worst = (0.0, 0);
        for (i, &unknown) in self.unknown_of_node.iter().enumerate() {
            if unknown != NONE {
                let miss = self.increment[unknown as usize].abs();
                if miss > worst.0 || miss.is_nan() {
                    worst = (miss, i);
                }
            }
        }
        worst
    }

    /// After convergence: flows of the ideal head sources and what fixed nodes exchange.
    pub(super) fn close(&mut self, network: &Network, state: &mut NetworkState) {
        self.net_inflow.fill(0.0);
        for (i, edge) in network.edges.iter().enumerate() {
            if !network.is_ideal(edge) {
                self.net_inflow[edge.from.index()] -= state.m_flow_kg_s[i];
                self.net_inflow[edge.to.index()] += state.m_flow_kg_s[i];
            }
        }
        for (i, node) in network.nodes.iter().enumerate() {
            if node.kind == NodeKind::Source {
                self.net_inflow[i] += state.given_m_flow_kg_s[i];
                state.exchange_kg_s[i] = state.given_m_flow_kg_s[i];
            }
        }
        // From the leaves to the root: what a leaf has too much goes to its parent.
        for link in self.ideal_links.iter().rev() {
            let surplus = self.net_inflow[link.child as usize];
            self.net_inflow[link.child as usize] = 0.0;
            self.net_inflow[link.parent as usize] += surplus;
            let edge = link.edge as usize;
            let towards_parent = network.edges[edge].to.0 == link.parent;
            state.m_flow_kg_s[edge] = if towards_parent { surplus } else { -surplus };
        }
        for (i, node) in network.nodes.iter().enumerate() {
            if node.has_fixed_pressure() {
                state.exchange_kg_s[i] = -self.net_inflow[i];
            }
        }
    }
}

/// What an edge's law has to answer, Pa, to far more digits than the pressures have: in a wide pipe at rest
/// 1e-9 Pa, the rounding of 1e7 Pa, move 1e-6 kg/s. Differences exact by Knuth's rule.
#[inline]
fn driving_pa(p_pa: &[f64], rest_pa: &[f64], slots: &EdgeSlots, gravity_pa: f64) -> f64 {
    let (a, b) = (slots.node_a as usize, slots.node_b as usize);
    let (p_a, p_b) = (p_pa[a], p_pa[b]);
    let difference = p_a - p_b;
    let taken = p_a - difference;
    let rest = (p_a - (difference + taken)) + (taken - p_b);
    (difference - gravity_pa) + (rest + (rest_pa[a] - rest_pa[b]))
}

/// Adds the flow of an edge to the balances of its ends.
#[inline]
fn balance(net_inflow: &mut [f64], slots: &EdgeSlots, m_flow_kg_s: f64) {
    net_inflow[slots.balance_a as usize] -= m_flow_kg_s;
    net_inflow[slots.balance_b as usize] += m_flow_kg_s;
}

/// What the increments of its ends differ by, Pa.
#[inline]
fn difference(increment: &[f64], slots: &EdgeSlots) -> f64 {
    increment[slots.balance_a as usize] - increment[slots.balance_b as usize]
}
