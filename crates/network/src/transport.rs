//! Temperatures of the whole network during one step of constant flow.
//!
//! Every edge states its mean outlet temperature as a linear function of its inlet temperature (pipes
//! usually as a constant: what leaves was inside already); every node mixes what flows in. The nodes
//! are swept in flow direction; where a thermally closed loop remains, the node temperatures are one
//! sparse linear system. Flows of heat are means over the step, so energy closes to rounding.
//!
//! **Equation** node with mass M: `M dT/dt = sum m_in (T_in - T)`, solved exactly over the step:
//! with `a = sum m_in dt/M` the mean outflow temperature is `g T_old + (1-g) T_mix`,
//! `g = (1 - e^-a)/a`. Standing nodes without volume relax to the ambient in [`NODE_RELAXATION_S`].
//!
//! **Sources** specification 9 and 10; `vanderheijde2017`.

pub mod parcels;
mod plug_flow;

use crate::effectiveness::inlet_conductance_w_k;
use crate::graph::{Network, NodeKind};
use crate::state::NetworkState;
use crate::two_port::{EdgeThermal, Exchanger};
use anergy_core::error::FactorError;
use anergy_core::numerics::sparse::SparseLu;
use anergy_core::port::{Outlet, Port};

/// Time constant with which the water of a node without flow takes the temperature around it, s.
pub const NODE_RELAXATION_S: f64 = 3600.0;
const NONE: u32 = u32::MAX;

/// Mean outlet temperature of an edge: `constant_k + of_inlet T_in + of_partner T_in(partner)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Relation {
    constant_k: f64,
    of_inlet: f64,
    of_partner: f64,
}

impl Relation {
    const PASS: Self = Self { constant_k: 0.0, of_inlet: 1.0, of_partner: 0.0 };

    fn constant(t_k: f64) -> Self {
        Self { constant_k: t_k, of_inlet: 0.0, of_partner: 0.0 }
    }

    /// Behind a mixed volume of temperature `t_k` that keeps the share `kept`.
    fn through_volume(self, t_k: f64, kept: f64) -> Self {
        Self {
            constant_k: kept * t_k + (1.0 - kept) * self.constant_k,
            of_inlet: (1.0 - kept) * self.of_inlet,
            of_partner: (1.0 - kept) * self.of_partner,
        }
    }
}

/// Share of its temperature that a volume keeps in its mean outflow, `(1 - e^-a)/a`, and at the end of
/// the step, `e^-a`; `a` is the throughput over the content.
fn volume_shares(throughput_kg: f64, content_kg: f64) -> (f64, f64) {
    if content_kg <= 0.0 {
        return (0.0, 0.0);
    }
    let a = throughput_kg / content_kg;
    if a < 1e-9 { (1.0 - 0.5 * a, 1.0 - a) } else { (-(-a).exp_m1() / a, (-a).exp()) }
}

/// Work space of the thermal sweep; holds no state of the network.
pub struct Transport {
    relation: Vec<Relation>,
    /// Edge of each port and port of each edge.
    port_of_edge: Vec<u32>,
    /// Edges at each node: `incident[first[n]..first[n + 1]]`.
    first: Vec<u32>,
    incident: Vec<u32>,
    /// Nodes in flow direction; shorter than the number of nodes when a loop remains.
    order: Vec<u32>,
    waiting: Vec<u32>,
    /// What the order depends on: direction of flow and dependence of each edge.
    key: Vec<u8>,
    inflow_kg_s: Vec<f64>,
    inflow_heat: Vec<f64>,
    /// Mean temperature of the water that leaves each node, K.
    t_mean_k: Vec<f64>,
    lu: SparseLu,
}

impl Transport {
    /// Prepares the sweep of a network.
    ///
    /// # Errors
    /// [`FactorError::Symbolic`] when the pattern of the node temperatures cannot be analysed.
    pub fn new(network: &Network) -> Result<Self, FactorError> {
        let (n, edges) = (network.nodes.len(), network.edges.len());
        let mut port_of_edge = vec![NONE; edges];
        for (port, edge) in network.ports.iter().enumerate() {
            port_of_edge[edge.index()] = port as u32;
        }
        let mut first = vec![0_u32; n + 1];
        for edge in &network.edges {
            first[edge.from.index() + 1] += 1;
            first[edge.to.index() + 1] += 1;
        }
        for i in 0..n {
            first[i + 1] += first[i];
        }
        let mut fill = first.clone();
        let mut incident = vec![0_u32; 2 * edges];
        let mut pattern = Vec::with_capacity(4 * edges);
        for (i, edge) in network.edges.iter().enumerate() {
            let (a, b) = (edge.from.index(), edge.to.index());
            for node in [a, b] {
                incident[fill[node] as usize] = i as u32;
                fill[node] += 1;
            }
            pattern.extend([(a, b), (b, a)]);
            if let Some(partner) = edge.partner {
                let other = &network.edges[partner.index()];
                for row in [a, b] {
                    pattern.extend([(row, other.from.index()), (row, other.to.index())]);
                }
            }
        }
        Ok(Self {
            relation: vec![Relation::PASS; edges],
            port_of_edge,
            first,
            incident,
            order: Vec::with_capacity(n),
            waiting: vec![0; n],
            key: vec![u8::MAX; edges],
            inflow_kg_s: vec![0.0; n],
            inflow_heat: vec![0.0; n],
            t_mean_k: vec![0.0; n],
            lu: SparseLu::analyze(n, &pattern)?,
        })
    }

    /// Advances all temperatures by `dt_s` with the flows of the state.
    ///
    /// # Errors
    /// [`FactorError::Singular`] when a closed loop of nodes has no defined temperature.
    pub fn advance(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        dt_s: f64,
    ) -> Result<(), FactorError> {
        self.collect_inflows(network, state);
        self.relax_nodes(network, state, dt_s);
        for edge in 0..network.edges.len() {
            self.relation[edge] = self.edge_relation(network, state, edge, Some(dt_s));
        }
        self.node_temperatures(network, state, Some(dt_s))?;
        self.advance_edges(network, state, dt_s);
        self.advance_nodes(network, state, dt_s);
        Ok(())
    }

    /// Settles all temperatures to the steady state of the present flows and requests: pipes get
    /// their steady profile, volumes their inlet temperature. One pass; units whose outlet depends
    /// on what they get need several.
    ///
    /// # Errors
    /// [`FactorError::Singular`] when a closed loop of nodes has no defined temperature.
    pub fn settle(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<(), FactorError> {
        self.collect_inflows(network, state);
        for edge in 0..network.edges.len() {
            self.relation[edge] = self.edge_relation(network, state, edge, None);
        }
        self.node_temperatures(network, state, None)?;
        for edge in 0..network.edges.len() {
            self.settle_edge(network, state, edge);
        }
        state.t_node_k.copy_from_slice(&self.t_mean_k);
        Ok(())
    }

    /// What leaves an edge as a function of what enters; `None` for `dt_s` is the steady state.
    fn edge_relation(
        &self,
        network: &Network,
        state: &NetworkState,
        i: usize,
        dt_s: Option<f64>,
    ) -> Relation {
        let m = state.m_flow_kg_s[i];
        if m == 0.0 {
            return Relation::PASS;
        }
        let edge = &network.edges[i];
        let cp = network.medium.heat_capacity_j_kg_k;
        match edge.element.thermal() {
            EdgeThermal::Pass => match self.port_of_edge[i] {
                NONE => Relation::PASS,
                port => match state.requests[port as usize].outlet {
                    Outlet::Temperature(t_k) => Relation::constant(t_k),
                    Outlet::HeatFlow(q_w) => {
                        Relation { constant_k: q_w / (m.abs() * cp), ..Relation::PASS }
                    }
                },
            },
            EdgeThermal::PlugFlow(pipe) => match dt_s {
                Some(dt_s) => {
                    plug_flow::relation(&state.parcels, i, &pipe, m, state.surroundings_k[i], dt_s)
                }
                None => plug_flow::steady_relation(&pipe, m, state.surroundings_k[i]),
            },
            EdgeThermal::Exchanger(exchanger) => {
                let (kept, _) = match dt_s {
                    Some(dt_s) => volume_shares(m.abs() * dt_s, exchanger.volume_kg),
                    None => (0.0, 0.0),
                };
                let share = self.conductance_w_k(network, state, i, &exchanger) / (m.abs() * cp);
                let mut relation = Relation { of_inlet: 1.0 - share, ..Relation::PASS };
                if edge.partner.is_some() {
                    relation.of_partner = share;
                } else {
                    relation.constant_k = share * self.secondary_inlet_k(network, state, i);
                }
                relation.through_volume(state.t_edge_k[i], kept)
            }
        }
    }

    /// Heat conductance between the inlet temperatures of the two streams of an exchanger edge, W/K.
    fn conductance_w_k(
        &self,
        network: &Network,
        state: &NetworkState,
        i: usize,
        exchanger: &Exchanger,
    ) -> f64 {
        let edge = &network.edges[i];
        let cp = network.medium.heat_capacity_j_kg_k;
        let m1 = state.m_flow_kg_s[i];
        if let Some(partner) = edge.partner {
            let m2 = state.m_flow_kg_s[partner.index()];
            let as_nominal = (m1 < 0.0) == (m2 < 0.0);
            if edge.leads_partner {
                return inlet_conductance_w_k(exchanger, m1, m2, cp, as_nominal);
            }
            return match network.edges[partner.index()].element.thermal() {
                EdgeThermal::Exchanger(lead) => {
                    inlet_conductance_w_k(&lead, m2, m1, cp, as_nominal)
                }
                _ => 0.0,
            };
        }
        match self.port_of_edge[i] {
            NONE => 0.0,
            // The station keeps its exchanger in counter-flow in both modes.
            port => {
                let m2 = state.requests[port as usize].m_flow_kg_s;
                inlet_conductance_w_k(exchanger, m1, m2, cp, true)
            }
        }
    }

    /// Temperature at which the unit sends its water into the exchanger of edge i, K.
    fn secondary_inlet_k(&self, network: &Network, state: &NetworkState, i: usize) -> f64 {
        let port = self.port_of_edge[i];
        if port == NONE {
            return state.t_edge_k[i];
        }
        let request = &state.requests[port as usize];
        match request.outlet {
            Outlet::Temperature(t_k) => t_k,
            Outlet::HeatFlow(q_w) => {
                let capacity = request.m_flow_kg_s.abs() * network.medium.heat_capacity_j_kg_k;
                let rise_k = if capacity > 0.0 { q_w / capacity } else { 0.0 };
                state.t_secondary_k[port as usize] + rise_k
            }
        }
    }

    /// Water of nodes without volume and without flow slowly takes the temperature around it.
    fn relax_nodes(&mut self, network: &Network, state: &mut NetworkState, dt_s: f64) {
        let share = -(-dt_s / NODE_RELAXATION_S).exp_m1();
        let medium = &network.medium;
        let mut lost = 0.0;
        for (i, node) in network.nodes.iter().enumerate() {
            let water_kg = node.water_kg(medium.density_kg_m3);
            if node.volume_m3 == 0.0 && self.inflow_kg_s[i] * dt_s < water_kg {
                let drop = (state.t_node_k[i] - state.ambient_k) * share;
                state.t_node_k[i] -= drop;
                lost += water_kg * medium.heat_capacity_j_kg_k * drop;
            }
        }
        state.q_loss_nodes_w = lost / dt_s;
    }

    /// Water and heat that enter the nodes: from all edges, and the heat that boundaries bring.
    fn collect_inflows(&mut self, network: &Network, state: &NetworkState) {
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
        }
    }

    /// Mean temperatures of the water that leaves the nodes.
    fn node_temperatures(
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
        self.solve_loops(network, state, dt_s)
    }

    /// Temperature of a node whose upstream nodes are known.
    fn mixed_node(
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

    /// Share of the old (or, in the steady state, the ambient) temperature in a node's mean outflow.
    fn kept_share(&self, network: &Network, node: usize, dt_s: Option<f64>) -> f64 {
        let inflow = self.inflow_kg_s[node];
        if inflow == 0.0 {
            return 1.0;
        }
        let water_kg = network.nodes[node].water_kg(network.medium.density_kg_m3);
        match dt_s {
            Some(dt_s) => volume_shares(inflow * dt_s, water_kg).0,
            // Some relaxation also where water flows (some 1e-7 K), so that a loop without any other
            // exchange of heat has a temperature: T (m + M/t_relax) = m T_mix + M/t_relax T_ambient.
            None => {
                let relaxing = water_kg / NODE_RELAXATION_S;
                relaxing / (relaxing + inflow)
            }
        }
    }

    /// Mean temperature of the water that leaves an edge, its upstream node being known.
    #[inline]
    fn outlet_k(&self, network: &Network, state: &NetworkState, i: usize) -> f64 {
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
        t_k
    }

    /// Orders the nodes so that each comes after those it depends on; kept while nothing turns.
    fn sort_nodes(&mut self, network: &Network, state: &NetworkState) {
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

    fn release(&mut self, node: usize) {
        self.waiting[node] -= 1;
        if self.waiting[node] == 0 {
            self.order.push(node as u32);
        }
    }

    /// All node temperatures as one linear system.
    fn solve_loops(
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
            let relation = self.relation[i];
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

    fn add_entry(&mut self, row: usize, column: usize, value: f64) {
        if let Some(slot) = self.lu.slot(row, column) {
            self.lu.values_mut()[slot] += value;
        }
    }

    /// Moves the content of the edges, their volumes and the secondary volumes; books the heat.
    fn advance_edges(&mut self, network: &Network, state: &mut NetworkState, dt_s: f64) {
        let cp = network.medium.heat_capacity_j_kg_k;
        for (i, edge) in network.edges.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            let t_in_k = self.t_mean_k[edge.upstream(m).index()];
            let t_out_k = if m == 0.0 { t_in_k } else { self.outlet_k(network, state, i) };
            (state.q_flow_w[i], state.q_loss_w[i]) = (0.0, 0.0);
            match edge.element.thermal() {
                EdgeThermal::Pass => {
                    if m != 0.0 {
                        state.t_edge_k[i] = t_out_k;
                        state.q_flow_w[i] = m.abs() * cp * (t_out_k - t_in_k);
                    }
                    self.direct_port(state, i, t_in_k, t_out_k);
                }
                EdgeThermal::PlugFlow(pipe) => {
                    let surroundings_k = state.surroundings_k[i];
                    let lost = plug_flow::advance(
                        &mut state.parcels,
                        i,
                        &pipe,
                        m,
                        t_in_k,
                        surroundings_k,
                        dt_s,
                    );
                    state.q_loss_w[i] = lost * cp / dt_s;
                }
                EdgeThermal::Exchanger(exchanger) => {
                    let q_w = self.exchanged_w(network, state, i, &exchanger, t_in_k);
                    state.q_flow_w[i] = q_w;
                    if m != 0.0 {
                        let (_, end) = volume_shares(m.abs() * dt_s, exchanger.volume_kg);
                        let into_k = t_in_k + q_w / (m.abs() * cp);
                        state.t_edge_k[i] = into_k + (state.t_edge_k[i] - into_k) * end;
                    }
                    self.secondary(network, state, i, &exchanger, q_w, dt_s);
                }
            }
        }
    }

    /// Heat into the water of an exchanger edge, W.
    fn exchanged_w(
        &self,
        network: &Network,
        state: &NetworkState,
        i: usize,
        exchanger: &Exchanger,
        t_in_k: f64,
    ) -> f64 {
        let other_k = match network.edges[i].partner {
            Some(partner) => {
                let other = partner.index();
                let m_other = state.m_flow_kg_s[other];
                self.t_mean_k[network.edges[other].upstream(m_other).index()]
            }
            None => self.secondary_inlet_k(network, state, i),
        };
        self.conductance_w_k(network, state, i, exchanger) * (other_k - t_in_k)
    }

    /// What the unit on an edge in the grid water got.
    fn direct_port(&self, state: &mut NetworkState, i: usize, t_in_k: f64, t_out_k: f64) {
        if self.port_of_edge[i] != NONE {
            let flow = &mut state.port_flows[self.port_of_edge[i] as usize];
            flow.m_flow_kg_s = state.m_flow_kg_s[i];
            (flow.t_in_k, flow.t_out_k) = (t_in_k, t_out_k);
        }
    }

    /// The unit's side of an exchanger: its water gives `q_w` and passes the secondary volume.
    fn secondary(
        &self,
        network: &Network,
        state: &mut NetworkState,
        i: usize,
        exchanger: &Exchanger,
        q_w: f64,
        dt_s: f64,
    ) {
        if self.port_of_edge[i] == NONE {
            return;
        }
        let port = self.port_of_edge[i] as usize;
        let m = state.requests[port].m_flow_kg_s;
        let sent_k = self.secondary_inlet_k(network, state, i);
        let before_k = state.t_secondary_k[port];
        let mut arriving_k = before_k;
        if m != 0.0 {
            let into_k = sent_k - q_w / (m.abs() * network.medium.heat_capacity_j_kg_k);
            let (kept, end) = volume_shares(m.abs() * dt_s, exchanger.volume_kg);
            state.t_secondary_k[port] = into_k + (before_k - into_k) * end;
            arriving_k = kept * before_k + (1.0 - kept) * into_k;
        }
        let flow = &mut state.port_flows[port];
        flow.m_flow_kg_s = m;
        (flow.t_in_k, flow.t_out_k) = (arriving_k, sent_k);
    }

    /// Moves the node temperatures to the end of the step; books what crosses the boundary.
    fn advance_nodes(&mut self, network: &Network, state: &mut NetworkState, dt_s: f64) {
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
    fn boundary_w(&self, network: &Network, state: &NetworkState) -> f64 {
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

    fn settle_edge(&mut self, network: &Network, state: &mut NetworkState, i: usize) {
        let edge = &network.edges[i];
        let cp = network.medium.heat_capacity_j_kg_k;
        let m = state.m_flow_kg_s[i];
        let t_in_k = self.t_mean_k[edge.upstream(m).index()];
        let t_out_k = if m == 0.0 { t_in_k } else { self.outlet_k(network, state, i) };
        (state.q_flow_w[i], state.q_loss_w[i]) = (0.0, 0.0);
        match edge.element.thermal() {
            EdgeThermal::Pass => {
                state.q_flow_w[i] = m.abs() * cp * (t_out_k - t_in_k);
                state.t_edge_k[i] = t_out_k;
                self.direct_port(state, i, t_in_k, t_out_k);
            }
            EdgeThermal::PlugFlow(pipe) => {
                if m == 0.0 {
                    if pipe.loss_time_constant_s.is_finite() {
                        let t_k = state.surroundings_k[i];
                        state.parcels.fill(i, t_k);
                    }
                } else {
                    let (t_a_k, t_b_k) = match Port::upstream(m) {
                        Port::A => (t_in_k, t_out_k),
                        Port::B => (t_out_k, t_in_k),
                    };
                    state.parcels.fill_linear(i, t_a_k, t_b_k);
                    state.q_loss_w[i] = m.abs() * cp * (t_in_k - t_out_k);
                }
            }
            EdgeThermal::Exchanger(exchanger) => {
                let q_w = self.exchanged_w(network, state, i, &exchanger, t_in_k);
                state.q_flow_w[i] = q_w;
                if m != 0.0 {
                    state.t_edge_k[i] = t_out_k;
                }
                // A very long step settles the secondary volume.
                self.secondary(network, state, i, &exchanger, q_w, 1e12);
            }
        }
    }
}
