//! Gains of a network: how flows and pressures change with a small change of anything that is given.
//!
//! **Equation** at the operating point, with the slopes `D = d phi/d m` of the edges, `w = 1/D`, and a head
//! `h_e = -d phi_e/d position` per unit of a position: `(A w A^T) dp = A w h + inflow`,
//! `dm = w (dp_a - dp_b + h)`. One factorisation serves all causes; each costs one substitution. The matrix
//! is symmetric, so the gains of flows over heads are reciprocal: `dm_i/dh_j = dm_j/dh_i`.
//!
//! What follows by itself is closed around that: openings of self-acting valves
//! (`dy = -(dp_high - dp_low - d set)/X_p`), and heads of free actuators whose prescribed quantity is held.
//! With what follows as unknowns z and their factorised conditions `C z = -c`, where c is what the cause
//! alone makes them miss, the answer is that of cause and z together.
//!
//! **Assumptions** nothing moves but water: temperatures, densities and the commands of controllers stay.
//! **Validity** as long as no law leaves the branch it is on: a check valve changes its slope at zero flow
//! by orders of magnitude ([`Linearization::closing`] says how far that is), a self-acting valve stops
//! following at its ends, a held prescription at the limits of its actuator. At a kink the gain is that of
//! one side: a self-acting valve at an end stays there; a tight valve that is closed does not open.
//!
//! **Numerics** slopes and effects of positions in closed form, no differences; nothing is allocated but in
//! [`Linearization::new`]. Slopes within 1e-9 and 1e16 Pa s/kg as in the solver.
//!
//! **Sources** Todini and Pilati 1988 (key `todini1988`).

use super::assemble::Disturbance;
use super::prescribed::Stand;
use super::{HydraulicError, HydraulicSolver, Kind};
use crate::elements::Element;
use crate::graph::{Network, Quantity};
use crate::state::{Hold, NetworkState};
use anergy_core::ids::{EdgeId, NodeId};
use anergy_core::numerics::dense::DenseSystem;

/// What changes by one unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The position of the actuator of an edge, in its unit: speed, opening, flow or head to be held. One
    /// that follows is displaced against where it would be: no change where a prescription holds.
    Position(EdgeId),
    /// 1 Pa of head in an edge, from a to b; none where its flow is given.
    Head(EdgeId),
    /// 1 kg/s more through an edge whose flow is given; none where it is not.
    ImposedFlow(EdgeId),
    /// 1 Pa more at a node whose pressure is given; none elsewhere.
    NodePressure(NodeId),
    /// 1 kg/s that enters at a node; leaves where the pressure is given.
    NodeInflow(NodeId),
    /// The value of a prescription, SI; none while its actuator is at a limit.
    Prescribed(usize),
    /// 1 Pa more set value of a self-acting valve; none while it is at an end.
    Regulator(usize),
}

/// The answer to a cause, per unit of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Response {
    /// Change of the flow of each edge, kg/s.
    pub m_flow_kg_s: Vec<f64>,
    /// Change of the pressure of each node, Pa.
    pub p_pa: Vec<f64>,
}

impl Response {
    /// Room for the answers of a network.
    pub fn new(network: &Network) -> Self {
        Self { m_flow_kg_s: vec![0.0; network.edges.len()], p_pa: vec![0.0; network.nodes.len()] }
    }

    /// Change of `p_a - p_b` of an edge, Pa.
    pub fn dp_pa(&self, network: &Network, edge: EdgeId) -> f64 {
        let edge = &network.edges[edge.index()];
        self.p_pa[edge.from.index()] - self.p_pa[edge.to.index()]
    }
}

/// Whether self-acting valves follow the pressures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Valves {
    /// They follow to the end: gains of steady states.
    #[default]
    Follow,
    /// Their openings stay: gains of the first moment.
    Stay,
}

/// What follows a change by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Follower {
    /// The opening of a self-acting valve.
    Opening(usize),
    /// The head of the free edge of a prescription.
    Head(usize),
}

/// The linear answers of a network at an operating point.
pub struct Linearization {
    pub(super) solver: HydraulicSolver,
    valves: Valves,
    /// Effect of the position on the head of each edge, Pa per unit.
    head_by_position_pa: Vec<f64>,
    followers: Vec<Follower>,
    conditions: DenseSystem,
    /// What the followers miss; then how far they go.
    follow: Vec<f64>,
    disturbance: Disturbance,
    work: Response,
}

impl Linearization {
    /// Analyses the network and linearises it at a solved state.
    ///
    /// # Errors
    /// As [`Self::update`].
    pub fn new(network: &Network, state: &NetworkState) -> Result<Self, HydraulicError> {
        Self::with_valves(network, state, Valves::Follow)
    }

    /// The same, with self-acting valves that follow or stay.
    ///
    /// # Errors
    /// As [`Self::update`].
    pub fn with_valves(
        network: &Network,
        state: &NetworkState,
        valves: Valves,
    ) -> Result<Self, HydraulicError> {
        let most = network.prescriptions.len() + network.regulators.len();
        let mut linearization = Self {
            solver: HydraulicSolver::new(network)?,
            valves,
            head_by_position_pa: vec![0.0; network.edges.len()],
            followers: Vec::with_capacity(most),
            conditions: DenseSystem::with_room(most),
            follow: Vec::with_capacity(most),
            disturbance: Disturbance::new(network),
            work: Response::new(network),
        };
        linearization.update(network, state)?;
        Ok(linearization)
    }

    /// Linearises the same network at another solved state. Allocates nothing.
    ///
    /// # Errors
    /// [`HydraulicError::Factor`] or [`HydraulicError::NotFinite`] at a state that is none of this network,
    /// [`HydraulicError::NoEffect`] where what follows is not determined.
    pub fn update(
        &mut self,
        network: &Network,
        state: &NetworkState,
    ) -> Result<(), HydraulicError> {
        let solver = &mut self.solver;
        solver.known = false;
        solver.clear_stands();
        for (k, prescription) in network.prescriptions.iter().enumerate() {
            let free = prescription.free.index();
            if !solver.is_shut(free) {
                solver.stand[free] = solver.stand_of(network, state, k);
            }
        }
        solver.evaluate(network, state)?;
        solver.system.factorise(network, &solver.kind, &solver.laws)?;
        for (i, edge) in network.edges.iter().enumerate() {
            let at = state.edge_state(network, i);
            let by_position = edge.loss_by_position(state.m_flow_kg_s[i], &at);
            self.head_by_position_pa[i] = -by_position;
        }
        self.find_followers(network, state);
        let mut work = std::mem::take(&mut self.work);
        let found = self.find_conditions(network, &mut work);
        self.work = work;
        found
    }

    /// Whether something follows by itself: self-acting valves, free actuators.
    pub fn follows(&self) -> bool {
        !self.followers.is_empty()
    }

    /// Answer of the network to one unit of a cause. Allocates nothing.
    pub fn respond(&mut self, network: &Network, cause: Cause, response: &mut Response) {
        self.disturbance.clear();
        self.disturb(network, cause, 1.0);
        self.answer(network, response);
        if self.followers.is_empty() {
            return;
        }
        self.follow.clear();
        for k in 0..self.followers.len() {
            let miss = self.given(network, cause, k) - self.condition(network, k, response);
            self.follow.push(miss);
        }
        if self.conditions.solve_factored(&mut self.follow) {
            for k in 0..self.followers.len() {
                self.disturb_by_follower(network, k, self.follow[k]);
            }
            self.answer(network, response);
        }
    }

    /// Change of `p_a - p_b` of the edge that is shut ([`Self::solve_without`]) per unit of the position of each of
    /// some other edges, Pa. By reciprocity one answer has them all: that to 1 kg/s through the shut edge; where
    /// something follows by itself, each edge has its own.
    pub(crate) fn across_shut(
        &mut self,
        network: &Network,
        shut: EdgeId,
        edges: &[EdgeId],
        response: &mut Response,
        change_pa: &mut Vec<f64>,
    ) {
        change_pa.clear();
        if !self.followers.is_empty() {
            for edge in edges {
                self.respond(network, Cause::Position(*edge), response);
                change_pa.push(response.dp_pa(network, shut));
            }
            return;
        }
        self.disturbance.clear();
        self.disturbance.pushed_kg_s[shut.index()] = 1.0;
        self.answer(network, response);
        change_pa.extend(edges.iter().map(|edge| {
            match (&network.edges[edge.index()].element, self.solver.kind[edge.index()]) {
                (Element::FlowSource(_), _) => response.dp_pa(network, *edge),
                (_, Kind::Imposed) => 0.0,
                _ => self.head_by_position(network, *edge) * response.m_flow_kg_s[edge.index()],
            }
        }));
    }

    /// How far a check valve is from where the answers lose their meaning: the check valve that would open
    /// or close first by the linear answer to a cause, and the change of the cause at which it would.
    /// `None` where no check valve changes its flow.
    pub fn closing(
        network: &Network,
        state: &NetworkState,
        response: &Response,
    ) -> Option<(EdgeId, f64)> {
        let check_valves = network
            .edges
            .iter()
            .enumerate()
            .filter(|(_, edge)| matches!(edge.element, Element::CheckValve(_)));
        check_valves
            .map(|(i, _)| (i, -state.m_flow_kg_s[i] / response.m_flow_kg_s[i]))
            .filter(|(_, change)| change.is_finite())
            .min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
            .map(|(i, change)| (EdgeId::from_index(i), change))
    }

    fn answer(&mut self, network: &Network, response: &mut Response) {
        let HydraulicSolver { system, kind, laws, .. } = &mut self.solver;
        let Response { m_flow_kg_s, p_pa } = response;
        system.answer(network, kind, laws, &self.disturbance, m_flow_kg_s, p_pa);
    }

    /// Adds what a cause does by itself.
    fn disturb(&mut self, network: &Network, cause: Cause, by: f64) {
        match cause {
            Cause::Position(edge) => match network.edges[edge.index()].element {
                Element::FlowSource(_) => self.push(edge, by),
                _ => self.disturb_head(network, edge, by * self.head_by_position(network, edge)),
            },
            Cause::Head(edge) => self.disturb_head(network, edge, by),
            Cause::ImposedFlow(edge) => self.push(edge, by),
            Cause::NodePressure(node) => {
                if network.nodes[node.index()].has_fixed_pressure() {
                    let shift = &mut self.disturbance.shift_pa;
                    self.solver.system.shift_tree(node.index(), by, shift);
                }
            }
            Cause::NodeInflow(node) => self.disturbance.inflow_kg_s[node.index()] += by,
            Cause::Prescribed(k) => {
                let prescription = network.prescriptions[k];
                if let (Stand::Flow(_), Some(sign)) =
                    (self.solver.stand[prescription.free.index()], self.solver.carried[k])
                {
                    self.push(prescription.free, sign * by);
                }
            }
            Cause::Regulator(_) => {}
        }
    }

    /// Head of an edge per unit of its position, Pa.
    fn head_by_position(&self, network: &Network, edge: EdgeId) -> f64 {
        // The position of an ideal head source is its head.
        let ideal = network.is_ideal(&network.edges[edge.index()]);
        if ideal { 1.0 } else { self.head_by_position_pa[edge.index()] }
    }

    fn push(&mut self, edge: EdgeId, by_kg_s: f64) {
        let i = edge.index();
        if self.solver.kind[i] == Kind::Imposed && !self.solver.is_shut(i) {
            self.disturbance.pushed_kg_s[i] += by_kg_s;
        }
    }

    fn disturb_head(&mut self, network: &Network, edge: EdgeId, head_pa: f64) {
        let i = edge.index();
        match self.solver.kind[i] {
            Kind::Law => self.disturbance.pushed_kg_s[i] += head_pa / self.solver.laws.slope[i],
            Kind::Imposed => {}
            Kind::Ideal => {
                let (node, sign) = self.solver.system.set_by_head(network, i);
                let shift = &mut self.disturbance.shift_pa;
                self.solver.system.shift_tree(node, sign * head_pa, shift);
            }
        }
    }

    /// Adds what a follower does when it goes so far.
    fn disturb_by_follower(&mut self, network: &Network, k: usize, by: f64) {
        match self.followers[k] {
            Follower::Opening(r) => {
                let edge = network.regulators[r].edge;
                self.disturb_head(network, edge, by * self.head_by_position(network, edge));
            }
            Follower::Head(p) => self.disturb_head(network, network.prescriptions[p].free, by),
        }
    }

    /// The change of what a follower keeps, besides that by its own way.
    fn condition(&self, network: &Network, k: usize, response: &Response) -> f64 {
        let p = |node: NodeId| response.p_pa[node.index()];
        match self.followers[k] {
            Follower::Opening(r) => {
                let regulator = network.regulators[r];
                let sensed_pa = p(regulator.high) - regulator.low.map_or(0.0, p);
                let closes = sensed_pa / regulator.regulation.band_pa;
                if regulator.regulation.opens { -closes } else { closes }
            }
            Follower::Head(i) => match network.prescriptions[i].quantity {
                Quantity::MassFlow(edge) => response.m_flow_kg_s[edge.index()],
                Quantity::PressureDifference(edge) => response.dp_pa(network, edge),
                Quantity::Pressure(node) => p(node),
            },
        }
    }

    /// What a cause gives a follower to keep.
    fn given(&self, network: &Network, cause: Cause, k: usize) -> f64 {
        match (self.followers[k], cause) {
            (Follower::Opening(r), Cause::Regulator(given)) if r == given => {
                let regulation = network.regulators[r].regulation;
                let opens = 1.0 / regulation.band_pa;
                if regulation.opens { -opens } else { opens }
            }
            (Follower::Head(p), Cause::Prescribed(given)) if p == given => 1.0,
            _ => 0.0,
        }
    }

    /// What follows by itself: self-acting valves within their band, heads of held prescriptions.
    fn find_followers(&mut self, network: &Network, state: &NetworkState) {
        self.followers.clear();
        for (k, regulator) in network.regulators.iter().enumerate() {
            let wanted = state.wanted_beyond(regulator, state.regulated[k].set_pa);
            if self.valves == Valves::Follow && wanted > 0.0 && wanted < 1.0 {
                self.followers.push(Follower::Opening(k));
            }
        }
        for (k, prescribed) in state.prescribed.iter().enumerate() {
            let free = network.prescriptions[k].free.index();
            let by_head = matches!(self.solver.stand[free], Stand::Head { .. });
            if prescribed.hold == Hold::Held && by_head {
                self.followers.push(Follower::Head(k));
            }
        }
    }

    /// Factorises the conditions of the followers.
    fn find_conditions(
        &mut self,
        network: &Network,
        work: &mut Response,
    ) -> Result<(), HydraulicError> {
        let n = self.followers.len();
        self.conditions.begin(n);
        for column in 0..n {
            self.disturbance.clear();
            self.disturb_by_follower(network, column, 1.0);
            self.answer(network, work);
            for row in 0..n {
                let opening = matches!(self.followers[row], Follower::Opening(_));
                let own = if row == column && opening { 1.0 } else { 0.0 };
                let entry = own + self.condition(network, row, work);
                self.conditions.set(row, column, entry);
            }
        }
        if self.conditions.factor() {
            return Ok(());
        }
        let edge = match self.followers[0] {
            Follower::Opening(k) => network.regulators[k].edge,
            Follower::Head(k) => network.prescriptions[k].free,
        };
        Err(HydraulicError::NoEffect { edge })
    }
}
