//! The network as a directed multigraph, and what can be wrong with it.
//!
//! A *circuit* is a connected component at water level; heat exchangers connect circuits thermally
//! only. Each circuit needs exactly one pressure reference (pressure holding, exchanges no water) or
//! (or an expansion vessel, which takes up and gives what sources bring and take) or at least one
//! pressure boundary (open ends, reservoirs), not both.

use crate::elements::Element;
use crate::soil::SoilRings;
use crate::two_port::{Characteristic, EdgeState, Pieces, TwoPort};
use crate::well_posed::{Equation, Unknown};
use anergy_core::ids::{EdgeId, NodeId};
use anergy_core::medium::Medium;

/// Standard gravity of the specification, m/s2.
pub const GRAVITY_M_S2: f64 = 9.81;

/// What is known at a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NodeKind {
    /// Nothing: pressure and temperature are results.
    Junction,
    /// The pressure is held, no water is exchanged.
    PressureReference,
    /// The pressure is that of the gas in an expansion vessel, which takes water up and gives it back.
    ExpansionVessel,
    /// The pressure is given, water enters (with a given temperature) or leaves.
    PressureBoundary,
    /// A flow enters (positive, with a given temperature) or leaves the network.
    Source,
}

/// A node: one pressure, one temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// What is known.
    pub kind: NodeKind,
    /// Elevation, m.
    pub elevation_m: f64,
    /// Mixed water volume, m3; 0 mixes at once.
    pub volume_m3: f64,
    /// Heat loss of this volume to the ambient, W/K.
    pub ua_w_k: f64,
}

/// An edge: one mass flow, positive from `from` (port a) to `to` (port b).
#[derive(Debug, Clone)]
pub struct Edge {
    /// Node at port a.
    pub from: NodeId,
    /// Node at port b.
    pub to: NodeId,
    /// The component.
    pub element: Element,
    /// Multiplies the pressure loss of the component: 1 leaves its law alone.
    pub loss_factor: f64,
    /// The other heat-exchanger side, in another circuit.
    pub partner: Option<EdgeId>,
    /// Whether the pair's UA is this edge's (and not its partner's).
    pub leads_partner: bool,
}

impl Edge {
    /// What the edge imposes between its ports.
    #[inline]
    pub fn characteristic(&self, m_flow_kg_s: f64, state: &EdgeState) -> Characteristic {
        let own = match &self.element {
            // Nearly all edges are pipes: no call through a table, and inlined.
            Element::Pipe(pipe) => pipe.characteristic(m_flow_kg_s, state),
            element => element.characteristic(m_flow_kg_s, state),
        };
        match own {
            Characteristic::PressureLoss(loss) if self.loss_factor != 1.0 => {
                Characteristic::PressureLoss(loss.scaled(self.loss_factor))
            }
            other => other,
        }
    }

    /// Change of the pressure loss with the position at a given flow, Pa per unit of the position.
    pub fn loss_by_position(&self, m_flow_kg_s: f64, state: &EdgeState) -> f64 {
        self.loss_factor * self.element.loss_by_position(m_flow_kg_s, state)
    }

    /// The pieces of a law with corners.
    pub fn pieces(&self, m_flow_kg_s: f64, state: &EdgeState) -> Option<Pieces> {
        let factor = self.loss_factor;
        self.element.pieces(m_flow_kg_s, state).map(|Pieces { lower, line, upper }| Pieces {
            lower: lower.scaled(factor),
            line: line.scaled(factor),
            upper: upper.scaled(factor),
        })
    }

    /// Flow from which a first solve begins, kg/s.
    pub fn start_m_flow_kg_s(&self) -> f64 {
        0.1 * self.element.m_flow_nominal_kg_s()
    }

    /// The node at the end the water leaves through.
    #[inline]
    pub fn downstream(&self, m_flow_kg_s: f64) -> NodeId {
        if m_flow_kg_s < 0.0 { self.from } else { self.to }
    }

    /// The node at the end the water enters through.
    #[inline]
    pub fn upstream(&self, m_flow_kg_s: f64) -> NodeId {
        if m_flow_kg_s < 0.0 { self.to } else { self.from }
    }
}

/// The network: everything that does not change during a run.
#[derive(Debug, Clone)]
pub struct Network {
    /// The water.
    pub medium: Medium,
    /// Gravity, m/s2.
    pub gravity_m_s2: f64,
    /// Nodes.
    pub nodes: Vec<Node>,
    /// Edges.
    pub edges: Vec<Edge>,
    /// Edges with a thermal unit on them; the index is the port of the unit.
    pub ports: Vec<EdgeId>,
    /// Quantities that are given while an actuator is left free.
    pub prescriptions: Vec<Prescription>,
    /// Pipes that lie side by side and exchange heat.
    pub couplings: Vec<Coupling>,
    /// Soil around pipes that stores heat.
    pub soil: Vec<SoilRings>,
    /// Self-acting valves.
    pub regulators: Vec<Regulator>,
}

/// Two pipes side by side and the heat conductance between their contents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling {
    /// The two pipes; positions are shares of the length from port a.
    pub edges: [EdgeId; 2],
    /// Whether port a of the second pipe lies at port b of the first.
    pub reversed: bool,
    /// Heat conductance between the two over the whole length, W/K.
    pub conductance_w_k: f64,
}

/// How a self-acting valve answers to the pressure it senses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regulation {
    /// Name of the set value, in SI.
    pub name: &'static str,
    /// Set value while nothing drives it, Pa: it begins to close (or to open) here.
    pub set_pa: f64,
    /// Rise of the pressure over which it closes (or opens), Pa.
    pub band_pa: f64,
    /// Whether it opens as the pressure rises, and does not close.
    pub opens: bool,
    /// Time constant, s.
    pub lag_s: f64,
}

/// A self-acting valve in its network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Regulator {
    /// The valve.
    pub edge: EdgeId,
    /// Node whose pressure counts.
    pub high: NodeId,
    /// Node whose pressure is taken off; the atmosphere where there is none.
    pub low: Option<NodeId>,
    /// How it answers.
    pub regulation: Regulation,
}

/// A quantity that is given, and the actuator that is free in its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Prescription {
    /// What is given.
    pub quantity: Quantity,
    /// The edge whose pump speed or valve opening follows, within its limits.
    pub free: EdgeId,
}

/// What can be given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Flow of an edge, kg/s.
    MassFlow(EdgeId),
    /// `p_a - p_b` of an edge, Pa.
    PressureDifference(EdgeId),
    /// Pressure of a node, Pa.
    Pressure(NodeId),
}

/// Something that makes a network unsolvable; ids, so that the caller can name them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum GraphProblem {
    /// A circuit whose pressure level nothing fixes.
    NoPressureReference {
        /// All nodes of the circuit.
        circuit: Vec<NodeId>,
    },
    /// A circuit with more than one pressure reference.
    SeveralReferences {
        /// The references.
        references: Vec<NodeId>,
    },
    /// A circuit with a reference, which exchanges no water, and a boundary, which does.
    ReferenceAndBoundary {
        /// One of the references.
        reference: NodeId,
        /// One of the boundaries.
        boundary: NodeId,
    },
    /// A loop of ideal head sources alone, or two fixed pressures joined by them.
    IdealLoop {
        /// The edge that closes the loop.
        edge: EdgeId,
    },
    /// More equations than unknowns in a part of the network.
    OverDetermined {
        /// The equations of the part.
        equations: Vec<Equation>,
    },
    /// Fewer equations than unknowns in a part of the network.
    UnderDetermined {
        /// The unknowns of the part.
        unknowns: Vec<Unknown>,
    },
}

/// Disjoint sets with path halving.
#[derive(Debug, Clone)]
pub(crate) struct UnionFind(Vec<u32>);

impl UnionFind {
    pub(crate) fn new(n: usize) -> Self {
        Self((0..n as u32).collect())
    }

    pub(crate) fn reset(&mut self) {
        for (i, parent) in self.0.iter_mut().enumerate() {
            *parent = i as u32;
        }
    }

    pub(crate) fn find(&mut self, i: usize) -> usize {
        let mut i = i as u32;
        while self.0[i as usize] != i {
            let grandparent = self.0[self.0[i as usize] as usize];
            self.0[i as usize] = grandparent;
            i = grandparent;
        }
        i as usize
    }

    /// Joins two sets; false when they were one already.
    pub(crate) fn union(&mut self, i: usize, j: usize) -> bool {
        let (i, j) = (self.find(i), self.find(j));
        // The smaller root wins, so that the result does not depend on the order of joining.
        let (low, high) = (i.min(j), i.max(j));
        self.0[high] = low as u32;
        low != high
    }
}

impl Network {
    /// Whether the edge is an ideal head source.
    pub fn is_ideal(&self, edge: &Edge) -> bool {
        matches!(edge.element, Element::PressureSource(_))
    }

    /// The circuits as lists of nodes, in the order of their first node.
    pub fn circuits(&self) -> Vec<Vec<NodeId>> {
        let mut sets = UnionFind::new(self.nodes.len());
        for edge in &self.edges {
            sets.union(edge.from.index(), edge.to.index());
        }
        let mut circuits: Vec<Vec<NodeId>> = vec![Vec::new(); self.nodes.len()];
        for i in 0..self.nodes.len() {
            circuits[sets.find(i)].push(NodeId::from_index(i));
        }
        circuits.retain(|circuit| !circuit.is_empty());
        circuits
    }

    /// All structural problems of the network.
    pub fn problems(&self) -> Vec<GraphProblem> {
        let mut problems = Vec::new();
        for circuit in self.circuits() {
            let of_kind = |kind: NodeKind| -> Vec<NodeId> {
                circuit.iter().copied().filter(|id| self.nodes[id.index()].kind == kind).collect()
            };
            let mut references = of_kind(NodeKind::PressureReference);
            references.extend(of_kind(NodeKind::ExpansionVessel));
            let boundaries = of_kind(NodeKind::PressureBoundary);
            match (references.as_slice(), boundaries.as_slice()) {
                ([], []) => problems.push(GraphProblem::NoPressureReference { circuit }),
                ([reference, ..], [boundary, ..]) => {
                    problems.push(GraphProblem::ReferenceAndBoundary {
                        reference: *reference,
                        boundary: *boundary,
                    });
                }
                ([_, _, ..], []) => problems.push(GraphProblem::SeveralReferences { references }),
                _ => {}
            }
        }
        // Ideal head sources must form a forest with at most one fixed pressure per tree.
        let mut merged = UnionFind::new(self.nodes.len() + 1);
        let ground = self.nodes.len();
        for (i, node) in self.nodes.iter().enumerate() {
            if node.has_fixed_pressure() {
                merged.union(i, ground);
            }
        }
        for (i, edge) in self.edges.iter().enumerate() {
            if self.is_ideal(edge) && !merged.union(edge.from.index(), edge.to.index()) {
                problems.push(GraphProblem::IdealLoop { edge: EdgeId::from_index(i) });
            }
        }
        problems.extend(crate::well_posed::problems(self));
        problems
    }
}
