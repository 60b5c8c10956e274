//! Nodes during a step: mixing in flow direction, and loops that have to be solved together.

use super::{JOINT_RELAXATION_S, NODE_RELAXATION_S, Relation, Transport, volume_shares};
use crate::graph::{Network, NodeKind};
use crate::state::{LEAST_WATER_KG, NetworkState};
use anergy_core::error::FactorError;
use anergy_core::port::Port;

/// Share of the ambient temperature at a node in the steady state, at least: more than rounding.
const LEAST_RELAXATION: f64 = 1e-12;
/// Rounds in which coldest temperatures are held in a loop; one cooled edge may warm the next.
const MOST_HELD: usize = 8;
/// Water this much colder than a coldest temperature passes as it is, K.
const COLDEST_ROUNDING_K: f64 = 1e-6;

impl Transport {
    /// Water and heat that enter the nodes: from all edges, and the heat that boundaries bring. A volume that
    /// loses heat mixes with `UA/cp` of water of the ambient's temperature.
    pub(super) fn collect_inflows(&mut self, network: &Network, state: &NetworkState) {
        self.inflow_kg_s.fill(0.0);
        self.inflow_heat.fill(0.0);
        for (i, edge) in network.edges.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            if m != 0.0 {
                self.inflow_kg_s[edge.downstream(m).index()] += m.abs();
            }
        }
        for (i, node) in network.nodes.iter().enumerate() {
            let exchange = state.exchange_kg_s[i];
            if exchange > 0.0 && node.kind != NodeKind::PressureReference {
                self.inflow_kg_s[i] += exchange;
                self.inflow_heat[i] += exchange * state.given_t_k[i];
            }
            if node.ua_w_k > 0.0 {
                let like_kg_s = node.ua_w_k / network.medium.heat_capacity_j_kg_k;
                self.inflow_kg_s[i] += like_kg_s;
                self.inflow_heat[i] += like_kg_s * state.ambient_k;
            }
        }
    }

    /// Water of nodes without volume and without flow mixes with what stands at the ends of the pipes there, or
    /// slowly takes the temperature around it where there are none.
    pub(super) fn relax_nodes(&mut self, network: &Network, state: &mut NetworkState, dt_s: f64) {
        let alone = -(-dt_s / NODE_RELAXATION_S).exp_m1();
        let between_pipes = -(-dt_s / JOINT_RELAXATION_S).exp_m1();
        let medium = &network.medium;
        let mut lost = 0.0;
        for (i, node) in network.nodes.iter().enumerate() {
            let water_kg = node.water_kg(medium.density_kg_m3);
            if node.volume_m3 == 0.0 && self.inflow_kg_s[i] * dt_s < water_kg {
                let (target_k, share) = match self.ends_of_pipes_k(network, state, i) {
                    Some(t_k) => (t_k, between_pipes),
                    None => (state.ambient_k, alone),
                };
                let drop = (state.t_node_k[i] - target_k) * share;
                state.t_node_k[i] -= drop;
                lost += water_kg * medium.heat_capacity_j_kg_k * drop;
            }
        }
        state.q_loss_nodes_w = lost / dt_s;
    }

    /// Mean temperature of what stands at a node in the ends of its pipes.
    fn ends_of_pipes_k(&self, network: &Network, state: &NetworkState, node: usize) -> Option<f64> {
        let (mut sum_k, mut ends) = (0.0, 0.0);
        for &i in &self.incident[self.first[node] as usize..self.first[node + 1] as usize] {
            let edge = i as usize;
            let port = if network.edges[edge].from.index() == node { Port::A } else { Port::B };
            if let Some(t_k) = state.pipe_end_k(network, edge, port) {
                (sum_k, ends) = (sum_k + t_k, ends + 1.0);
            }
        }
        (ends > 0.0).then(|| sum_k / ends)
    }

    /// Heat that node volumes lose to the ambient, W.
    pub(super) fn volume_losses_w(&self, network: &Network, state: &NetworkState) -> f64 {
        let nodes = network.nodes.iter().zip(&self.t_mean_k).filter(|(node, _)| node.ua_w_k > 0.0);
        nodes.map(|(node, t_k)| node.ua_w_k * (t_k - state.ambient_k)).sum()
    }

    /// Mean temperatures of the water that leaves the nodes.
    pub(super) fn node_temperatures(
        &mut self,
        network: &Network,
        state: &NetworkState,
        dt_s: Option<f64>,
    ) -> Result<(), FactorError> {
        self.sort_nodes(network, state);
        if self.order.len() == network.nodes.len() {
            for k in 0..self.order.len() {
                let node = self.order[k] as usize;
                self.t_mean_k[node] = self.mixed_node(network, state, node, dt_s);
            }
            return Ok(());
        }
        self.in_loops.copy_from_slice(&self.relation);
        self.solve_loops(network, state, dt_s)?;
        for _ in 0..MOST_HELD {
            if !self.hold_coldest(network, state) {
                break;
            }
            self.solve_loops(network, state, dt_s)?;
        }
        Ok(())
    }

    /// Temperature of a node whose upstream nodes are known.
    pub(super) fn mixed_node(
        &self,
        network: &Network,
        state: &NetworkState,
        node: usize,
        dt_s: Option<f64>,
    ) -> f64 {
        let mut heat = self.inflow_heat[node];
        for &i in &self.incident[self.first[node] as usize..self.first[node + 1] as usize] {
            let (i, m) = (i as usize, state.m_flow_kg_s[i as usize]);
            if m != 0.0 && network.edges[i].downstream(m).index() == node {
                heat += m.abs() * self.outlet_k(network, state, i);
            }
        }
        let kept = self.kept_share(network, node, dt_s);
        let inflow = self.inflow_kg_s[node];
        let (old_k, mixed_k) = (
            if dt_s.is_some() { state.t_node_k[node] } else { state.ambient_k },
            if inflow > 0.0 { heat / inflow } else { 0.0 },
        );
        kept * old_k + (1.0 - kept) * mixed_k
    }

    /// Entropy that mixing in the nodes produced in the last step, W/K: `cp sum m (ln T_mixed - ln T)` over what arrives,
    /// never negative. What a volume held does not count.
    pub fn mixing_w_k(&self, network: &Network, state: &NetworkState) -> f64 {
        let mut sum_kg_s = 0.0;
        for node in 0..network.nodes.len() {
            let incident = &self.incident[self.first[node] as usize..self.first[node + 1] as usize];
            let from_edges = incident.iter().filter_map(|&i| {
                let (i, m) = (i as usize, state.m_flow_kg_s[i as usize]);
                let arrives = m != 0.0 && network.edges[i].downstream(m).index() == node;
                arrives.then(|| (m.abs(), self.outlet_k(network, state, i)))
            });
            let given = (state.exchange_kg_s[node], state.given_t_k[node]);
            let is_given = given.0 > 0.0 && network.nodes[node].kind != NodeKind::PressureReference;
            let streams = || from_edges.clone().chain(is_given.then_some(given));
            if streams().nth(1).is_none() {
                continue;
            }
            let (water, heat) =
                streams().fold((0.0, 0.0), |sum, (m, t_k)| (sum.0 + m, sum.1 + m * t_k));
            let mixed_k = heat / water;
            sum_kg_s += streams().map(|(m, t_k)| m * (mixed_k / t_k).ln()).sum::<f64>();
        }
        network.medium.heat_capacity_j_kg_k * sum_kg_s
    }

    /// Share of the old (or, in the steady state, the ambient) temperature in a node's mean outflow.
    pub(super) fn kept_share(&self, network: &Network, node: usize, dt_s: Option<f64>) -> f64 {
        let inflow = self.inflow_kg_s[node];
        if inflow == 0.0 {
            return 1.0;
        }
        match dt_s {
            Some(dt_s) => {
                let water_kg = network.nodes[node].water_kg(network.medium.density_kg_m3);
                volume_shares(inflow * dt_s, water_kg).0
            }
            // Some relaxation also where water flows (some 1e-7 K), so that a loop without any other
            // exchange of heat has a temperature: T (m + M/t_relax) = m T_mix + M/t_relax T_ambient.
            // Volumes keep their heat, as in a run, but for their loss.
            None => {
                let relaxing = LEAST_WATER_KG / NODE_RELAXATION_S;
                (relaxing / (relaxing + inflow)).max(LEAST_RELAXATION)
            }
        }
    }

    /// Mean temperature of the water that leaves an edge, its upstream node being known.
    #[inline]
    pub(super) fn outlet_k(&self, network: &Network, state: &NetworkState, i: usize) -> f64 {
        let edge = &network.edges[i];
        let relation = self.relation[i];
        let mut t_k = relation.constant_k;
        if relation.of_inlet != 0.0 {
            t_k += relation.of_inlet * self.t_mean_k[edge.upstream(state.m_flow_kg_s[i]).index()];
        }
        if let Some(partner) = edge.partner.filter(|_| relation.of_partner != 0.0) {
            let other = partner.index();
            let inlet = network.edges[other].upstream(state.m_flow_kg_s[other]).index();
            t_k += relation.of_partner * self.t_mean_k[inlet];
        }
        if t_k < relation.coldest_k {
            let t_in_k = self.t_mean_k[edge.upstream(state.m_flow_kg_s[i]).index()];
            t_k = t_k.max(relation.coldest_k.min(t_in_k));
        }
        t_k
    }

    /// Loops are linear: what would be cooled too far at the temperatures just found gets its coldest
    /// temperature there, all else its own relation. False when nothing changed by that.
    fn hold_coldest(&mut self, network: &Network, state: &NetworkState) -> bool {
        let mut changed = false;
        for (i, own) in self.relation.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            if m == 0.0 || own.coldest_k == f64::NEG_INFINITY {
                continue;
            }
            let t_in_k = self.t_mean_k[network.edges[i].upstream(m).index()];
            let held = if own.constant_k + t_in_k >= own.coldest_k {
                *own
            } else if t_in_k < own.coldest_k - COLDEST_ROUNDING_K && self.in_loops[i] != *own {
                Relation::PASS
            } else {
                // At first also where colder water arrives: that may be what it cooled too far itself.
                Relation::constant(own.coldest_k)
            };
            changed |= self.in_loops[i] != held;
            self.in_loops[i] = held;
        }
        changed
    }

    /// Orders the nodes so that each comes after those it depends on; kept while nothing turns.
    pub(super) fn sort_nodes(&mut self, network: &Network, state: &NetworkState) {
        let mut same = true;
        for (i, relation) in self.relation.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            let key = u8::from(m > 0.0)
                | u8::from(m < 0.0) << 1
                | u8::from(relation.of_inlet != 0.0) << 2
                | u8::from(relation.of_partner != 0.0) << 3;
            same &= self.key[i] == key;
            self.key[i] = key;
        }
        if same {
            return;
        }
        self.waiting.fill(0);
        for (i, edge) in network.edges.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            if m != 0.0 {
                let relation = self.relation[i];
                self.waiting[edge.downstream(m).index()] +=
                    u32::from(relation.of_inlet != 0.0) + u32::from(relation.of_partner != 0.0);
            }
        }
        self.order.clear();
        self.order.extend(
            self.waiting.iter().enumerate().filter(|(_, w)| **w == 0).map(|(i, _)| i as u32),
        );
        let mut done = 0;
        while done < self.order.len() {
            let node = self.order[done] as usize;
            done += 1;
            for k in self.first[node] as usize..self.first[node + 1] as usize {
                let i = self.incident[k] as usize;
                let (edge, m) = (&network.edges[i], state.m_flow_kg_s[i]);
                if m == 0.0 || edge.upstream(m).index() != node {
                    continue;
                }
                if self.relation[i].of_inlet != 0.0 {
                    self.release(edge.downstream(m).index());
                }
                if let Some(partner) = edge.partner {
                    let (other, m_other) = (partner.index(), state.m_flow_kg_s[partner.index()]);
                    if m_other != 0.0 && self.relation[other].of_partner != 0.0 {
                        self.release(network.edges[other].downstream(m_other).index());
                    }
                }
            }
        }
    }

    pub(super) fn release(&mut self, node: usize) {
        self.waiting[node] -= 1;
        if self.waiting[node] == 0 {
            self.order.push(node as u32);
        }
    }

    /// All node temperatures as one linear system.
    pub(super) fn solve_loops(
        &mut self,
        network: &Network,
        state: &NetworkState,
        dt_s: Option<f64>,
    ) -> Result<(), FactorError> {
        self.lu.values_mut().fill(0.0);
        for node in 0..network.nodes.len() {
            self.add_entry(node, node, 1.0);
            let kept = self.kept_share(network, node, dt_s);
            let old_k = if dt_s.is_some() { state.t_node_k[node] } else { state.ambient_k };
            let inflow = self.inflow_kg_s[node];
            let mixed = if inflow > 0.0 { (1.0 - kept) / inflow } else { 0.0 };
            self.t_mean_k[node] = kept * old_k + mixed * self.inflow_heat[node];
        }
        for (i, edge) in network.edges.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            if m == 0.0 {
                continue;
            }
            let (from, to) = (edge.upstream(m).index(), edge.downstream(m).index());
            let weight =
                (1.0 - self.kept_share(network, to, dt_s)) * m.abs() / self.inflow_kg_s[to];
            let relation = self.in_loops[i];
            self.t_mean_k[to] += weight * relation.constant_k;
            self.add_entry(to, from, -weight * relation.of_inlet);
            if let Some(partner) = edge.partner {
                let other = partner.index();
                let inlet = network.edges[other].upstream(state.m_flow_kg_s[other]).index();
                self.add_entry(to, inlet, -weight * relation.of_partner);
            }
        }
        self.lu.solve_in_place(&mut self.t_mean_k)
    }

    pub(super) fn add_entry(&mut self, row: usize, column: usize, value: f64) {
        if let Some(slot) = self.lu.slot(row, column) {
            self.lu.values_mut()[slot] += value;
        }
    }

    /// Moves the node temperatures to the end of the step; books what crosses the boundary.
    pub(super) fn advance_nodes(&mut self, network: &Network, state: &mut NetworkState, dt_s: f64) {
        for (i, edge) in network.edges.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            if m != 0.0 {
                self.inflow_heat[edge.downstream(m).index()] +=
                    m.abs() * self.outlet_k(network, state, i);
            }
        }
        for (i, node) in network.nodes.iter().enumerate() {
            let inflow = self.inflow_kg_s[i];
            if inflow > 0.0 {
                let water_kg = node.water_kg(network.medium.density_kg_m3);
                let (_, end) = volume_shares(inflow * dt_s, water_kg);
                let mixed_k = self.inflow_heat[i] / inflow;
                state.t_node_k[i] = mixed_k + (state.t_node_k[i] - mixed_k) * end;
            }
        }
        state.boundary_w = self.boundary_w(network, state);
    }

    /// Enthalpy flow into the network through boundaries and sources, W.
    pub(super) fn boundary_w(&self, network: &Network, state: &NetworkState) -> f64 {
        let mut heat_w = 0.0;
        for (i, node) in network.nodes.iter().enumerate() {
            let exchange = state.exchange_kg_s[i];
            if node.kind != NodeKind::PressureReference && exchange != 0.0 {
                let t_k = if exchange > 0.0 { state.given_t_k[i] } else { self.t_mean_k[i] };
                heat_w += exchange * network.medium.enthalpy_j_kg(t_k);
            }
        }
        heat_w
    }
}
