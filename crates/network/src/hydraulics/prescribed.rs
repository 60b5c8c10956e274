//! Given quantities with free actuators: a flow, a pressure difference or a pressure is known, a pump
//! speed or valve opening follows.
//!
//! **Equation** a free edge has no law. If what is given is the flow of the edge itself, or of one in
//! series with it, that flow is imposed. Otherwise the edge becomes a straight law `R m - h` with an
//! unknown head h: the network stays a convex problem for any h, and Newton finds the heads from the
//! exact sensitivities `d quantity/d h` of the factorised matrix. The position is then the one whose law
//! has the flow and pressure difference found.
//!
//! **Numerics** the heads are sought in the iteration of the flows (`heads.rs`), and outside of it where that
//! does not converge. Where no position has what is given, the actuator stays at the limit that comes closer, with its
//! own law, until the given quantity is passed from there. A prescription changes so at most a few times
//! in a solve, the last times one at a time.

use super::heads::Heads;
use super::position::{Place, head_by_position, limits, own_law, place, present, tolerance};
use super::{HydraulicError, HydraulicReport, HydraulicSolver};
use crate::graph::{Edge, Network, NodeKind, Quantity};
use crate::state::{Hold, NetworkState, Prescribed};
use crate::two_port::Characteristic;
use anergy_core::ids::EdgeId;
use anergy_core::linear::Linear;

/// A prescribed flow and pressure are met within these.
pub(super) const FLOW_KG_S: f64 = 1e-8;
pub(super) const PRESSURE_PA: f64 = 1e-2;
pub(super) const RELATIVE: f64 = 1e-7;
const MAX_NEWTON: usize = 60;
/// Rounds in which all prescriptions may change between held and limit, and rounds with one change each.
const ROUNDS_TOGETHER: usize = 4;
const ROUNDS_EACH: usize = 4;
/// Slopes of the straight laws of free edges, Pa s/kg.
const SLOPE_RANGE: (f64, f64) = (1e2, 1e8);

/// What stands for the law of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stand {
    /// Its own law.
    Own,
    /// A given flow, kg/s.
    Flow(f64),
    /// `dp = slope m - head`.
    Head { slope: f64, head: f64 },
}

impl Stand {
    /// The answer in place of the element's.
    #[inline]
    pub(super) fn characteristic(
        self,
        m: f64,
        own: impl FnOnce() -> Characteristic,
    ) -> Characteristic {
        match self {
            Self::Own => own(),
            Self::Flow(m_flow_kg_s) => Characteristic::ImposedFlow { m_flow_kg_s },
            Self::Head { slope, head } => {
                Characteristic::PressureLoss(Linear::new(slope * m - head, slope))
            }
        }
    }
}

/// For each prescription of a flow: +1 or -1 where the free edge carries that flow itself.
pub(super) fn carried(network: &Network) -> Vec<Option<f64>> {
    if network.prescriptions.is_empty() {
        return Vec::new();
    }
    let mut incident = vec![Vec::new(); network.nodes.len()];
    for (i, edge) in network.edges.iter().enumerate() {
        incident[edge.from.index()].push(i);
        incident[edge.to.index()].push(i);
    }
    let prescriptions = network.prescriptions.iter();
    prescriptions
        .map(|prescription| match prescription.quantity {
            Quantity::MassFlow(edge) => {
                series_sign(network, &incident, prescription.free.index(), edge.index())
            }
            _ => None,
        })
        .collect()
}

/// Sign of the flow of `other` against that of `edge` where all water of one passes the other.
fn series_sign(
    network: &Network,
    incident: &[Vec<usize>],
    edge: usize,
    other: usize,
) -> Option<f64> {
    if edge == other {
        return Some(1.0);
    }
    let Edge { from, to, .. } = network.edges[edge];
    for start in [from, to] {
        let (mut at, mut last) = (start, edge);
        // Walks away from the edge as long as there is one way on.
        for _ in 0..network.edges.len() {
            let [a, b] = incident[at.index()][..] else { break };
            if network.nodes[at.index()].kind != NodeKind::Junction {
                break;
            }
            let next = if a == last { b } else { a };
            let onwards = network.edges[next].from == at;
            if next == other {
                return Some(if onwards == (start == to) { 1.0 } else { -1.0 });
            }
            at = if onwards { network.edges[next].to } else { network.edges[next].from };
            last = next;
        }
    }
    None
}

impl HydraulicSolver {
    /// Solves with every prescription held or at a limit of its actuator.
    pub(super) fn solve_prescribed(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<HydraulicReport, HydraulicError> {
        let count = network.prescriptions.len();
        // A snapshot continues bit for bit: the stands begin from the state alone.
        self.clear_stands();
        self.opened.fill(false);
        let mut iterations = 0;
        for round in 0..ROUNDS_TOGETHER + ROUNDS_EACH * count {
            for k in 0..count {
                self.take_stand(network, state, k);
            }
            let report = match self.solve_heads(network, state, &mut iterations) {
                Err(HydraulicError::Unbalanced { .. }) if self.reopen(network, state) => continue,
                other => other?,
            };
            self.find_changes(network, state);
            if self.heads.changes.is_empty() {
                return Ok(HydraulicReport { iterations, ..report });
            }
            let together = if round >= ROUNDS_TOGETHER { 1 } else { count };
            for &(_, k, hold) in self.heads.changes.iter().take(together) {
                state.prescribed[k].hold = hold;
            }
        }
        self.find_changes(network, state);
        let culprit = self.heads.changes.first().map_or(0, |change| change.1);
        Err(HydraulicError::Undecided { edge: network.prescriptions[culprit].free })
    }

    /// Puts what stands for the law of the free edge of a prescription in its place.
    fn take_stand(&mut self, network: &Network, state: &mut NetworkState, k: usize) {
        let edge = network.prescriptions[k].free.index();
        if self.is_shut(edge) {
            return;
        }
        let (min, max) = limits(network, edge);
        match state.prescribed[k].hold {
            Hold::AtMin => state.place_actuator(edge, min),
            Hold::AtMax => state.place_actuator(edge, max),
            Hold::Held => {}
        }
        self.stand[edge] = self.stand_of(network, state, k);
    }

    /// What stands for the law of the free edge of a prescription.
    pub(super) fn stand_of(&self, network: &Network, state: &NetworkState, k: usize) -> Stand {
        let edge = network.prescriptions[k].free.index();
        let prescribed = state.prescribed[k];
        match (prescribed.hold, self.carried[k]) {
            (Hold::AtMin | Hold::AtMax, _) => Stand::Own,
            (Hold::Held, Some(sign)) => Stand::Flow(sign * prescribed.value),
            (Hold::Held, None) => {
                let m = state.m_flow_kg_s[edge];
                match (self.stand[edge], own_law(network, edge, m, state.edge_state(network, edge)))
                {
                    (head @ Stand::Head { .. }, _) => head,
                    (_, Some(law)) => {
                        let slope = law.slope.clamp(SLOPE_RANGE.0, SLOPE_RANGE.1);
                        Stand::Head { slope, head: slope * m - law.value }
                    }
                    (_, None) => Stand::Head { slope: SLOPE_RANGE.1, head: 0.0 },
                }
            }
        }
    }

    /// Heads of the free edges with the flows; one hydraulic solve where there is none.
    fn solve_heads(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        iterations: &mut u32,
    ) -> Result<HydraulicReport, HydraulicError> {
        self.heads.sought.clear();
        for (k, prescription) in network.prescriptions.iter().enumerate() {
            if matches!(self.stand[prescription.free.index()], Stand::Head { .. }) {
                self.heads.sought.push(k);
            }
        }
        if !self.heads.sought.is_empty() {
            if let Some(report) = self.solve_together(network, state, iterations) {
                return Ok(report);
            }
            for k in 0..network.prescriptions.len() {
                let edge = network.prescriptions[k].free.index();
                if matches!(self.stand[edge], Stand::Head { .. }) {
                    self.stand[edge] = Stand::Own;
                    self.stand[edge] = self.stand_of(network, state, k);
                }
            }
        }
        self.solve_nested(network, state, iterations)
    }

    /// Newton on the heads of the free edges around that of the flows.
    fn solve_nested(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        iterations: &mut u32,
    ) -> Result<HydraulicReport, HydraulicError> {
        // How much the heads missed before their last change.
        let mut before: Option<f64> = None;
        for _ in 0..MAX_NEWTON {
            let report = self.solve_laws(network, state)?;
            *iterations += report.iterations;
            self.check_floating(network)?;
            let norm = self.largest_miss(network, state);
            if norm <= 1.0 {
                return Ok(report);
            }
            match before {
                // Overshot: half the way back.
                Some(last) if norm > last => {
                    let Heads { change, last_change, .. } = &mut self.heads;
                    last_change.iter_mut().for_each(|last| *last *= 0.5);
                    change.clear();
                    change.extend(last_change.iter().map(|last| -last));
                }
                _ => {
                    self.head_changes(network, state)?;
                    let Heads { change, last_change, .. } = &mut self.heads;
                    last_change.clone_from(change);
                    before = Some(norm);
                }
            }
            self.take_heads(network);
            state.invalidate_hydraulics();
        }
        let free = self.heads.sought.first();
        let free = free.map_or(0, |&k| network.prescriptions[k].free.index());
        Err(HydraulicError::Undecided { edge: EdgeId::from_index(free) })
    }

    /// Places the actuators that are free; says which prescriptions turn out to be at a limit, and which
    /// leave theirs, the worst first.
    fn find_changes(&mut self, network: &Network, state: &mut NetworkState) {
        self.heads.changes.clear();
        for (k, prescription) in network.prescriptions.iter().enumerate() {
            let edge = prescription.free.index();
            if self.is_shut(edge) {
                continue;
            }
            let Prescribed { value, hold } = state.prescribed[k];
            let error = (value - present(network, state, prescription.quantity))
                / tolerance(prescription.quantity, value);
            if hold == Hold::Held {
                let dp = self.system.driving_pa(state, edge);
                match place(network, state, edge, dp) {
                    Place::At(position) => state.place_actuator(edge, position),
                    Place::Below => self.heads.changes.push((f64::INFINITY, k, Hold::AtMin)),
                    Place::Above => self.heads.changes.push((f64::INFINITY, k, Hold::AtMax)),
                    Place::Driven => {
                        // More is wanted than comes by itself: open; less: shut; unless that was wrong.
                        // A flow that the edge carries itself has no law here, but rises with its head.
                        self.system.respond(edge, &self.laws);
                        let by_head = self.carried[k].unwrap_or_else(|| {
                            self.response(prescription.quantity, prescription.free)
                        });
                        let open = (state.m_flow_kg_s[edge] * by_head > 0.0) != self.opened[k];
                        self.opened[k] |= open;
                        let hold = if open { Hold::AtMax } else { Hold::AtMin };
                        self.heads.changes.push((f64::INFINITY, k, hold));
                    }
                }
                continue;
            }
            // Would moving the actuator away from its limit bring the quantity closer?
            self.system.respond(edge, &self.laws);
            let by_head = self.response(prescription.quantity, prescription.free);
            let dp = self.system.driving_pa(state, edge);
            let wanted = error * by_head * head_by_position(network, state, edge, dp);
            let inwards = if hold == Hold::AtMin { wanted > 0.0 } else { wanted < 0.0 };
            if inwards && error.abs() > 1.0 {
                self.heads.changes.push((error.abs(), k, Hold::Held));
            }
        }
        self.heads.changes.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    }

    /// A part got cut off because free edges around it were shut: opens them. False when there is none.
    fn reopen(&mut self, network: &Network, state: &mut NetworkState) -> bool {
        let mut any = false;
        for (k, prescription) in network.prescriptions.iter().enumerate() {
            let shut = state.prescribed[k].hold == Hold::AtMin && !self.opened[k];
            if shut && self.system.joins_floating(network, prescription.free.index()) {
                state.prescribed[k].hold = Hold::AtMax;
                self.opened[k] = true;
                any = true;
            }
        }
        state.invalidate_hydraulics();
        any
    }

    /// A free edge between parts of which one has no pressure level has no defined position.
    pub(super) fn check_floating(&mut self, network: &Network) -> Result<(), HydraulicError> {
        for prescription in &network.prescriptions {
            let edge = prescription.free.index();
            if matches!(self.stand[edge], Stand::Flow(_))
                && !self.is_shut(edge)
                && self.system.joins_floating(network, edge)
            {
                return Err(HydraulicError::Undetermined { edge: prescription.free });
            }
        }
        Ok(())
    }
}
