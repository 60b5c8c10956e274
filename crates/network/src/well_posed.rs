//! Whether what is prescribed and what is left free make as many independent equations as unknowns.
//!
//! **Equation** unknowns are the flow of each edge and the pressure of each node that is not fixed;
//! equations the mass balance of each such node, the law of each edge that is not free, and each
//! prescription. A maximum matching of equations to unknowns exists with nobody left over, or else the
//! Dulmage-Mendelsohn decomposition gives the parts: what alternating paths reach from an equation
//! without unknown is over-determined, from an unknown without equation under-determined. Besides, given
//! flows must not enclose a part of the network: their sum is its mass balance.
//!
//! **Sources** `dulmage1958`.

use crate::elements::Element;
use crate::graph::{GraphProblem, Network, NodeKind, Quantity, UnionFind};
use anergy_core::ids::{EdgeId, NodeId};

/// An equation of the network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Equation {
    /// What flows in flows out.
    MassBalance(NodeId),
    /// The law of an edge.
    Law(EdgeId),
    /// A prescription, by its index.
    Prescription(usize),
}

/// An unknown of the network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// The flow of an edge.
    Flow(EdgeId),
    /// The pressure of a node.
    Pressure(NodeId),
}

/// The parts that are not well posed; none without prescriptions.
pub(crate) fn problems(network: &Network) -> Vec<GraphProblem> {
    let mut problems = Vec::new();
    if network.prescriptions.is_empty() {
        return problems;
    }
    if let Some(problem) = enclosed(network) {
        return vec![problem];
    }
    let system = System::new(network);
    let matching = Matching::new(&system.unknowns_of, system.unknowns.len());
    let equations: Vec<Equation> =
        matching.over(&system.unknowns_of).into_iter().map(|row| system.equations[row]).collect();
    if !equations.is_empty() {
        problems.push(GraphProblem::OverDetermined { equations });
    }
    let unknowns: Vec<Unknown> = matching
        .under(&system.unknowns_of)
        .into_iter()
        .map(|column| system.unknowns[column])
        .collect();
    if !unknowns.is_empty() {
        problems.push(GraphProblem::UnderDetermined { unknowns });
    }
    problems
}

/// A part of the network that given flows alone connect with the rest: they determine each other. The
/// matching does not see it, for it looks at who occurs where and not at the signs.
fn enclosed(network: &Network) -> Option<GraphProblem> {
    let mut given = vec![None; network.edges.len()];
    for (k, prescription) in network.prescriptions.iter().enumerate() {
        if let Quantity::MassFlow(edge) = prescription.quantity {
            given[edge.index()] = Some(k);
        }
    }
    let boundary = network.nodes.len();
    let mut parts = UnionFind::new(boundary + 1);
    let open =
        |kind: NodeKind| matches!(kind, NodeKind::PressureBoundary | NodeKind::ExpansionVessel);
    for (i, _) in network.nodes.iter().enumerate().filter(|(_, n)| open(n.kind)) {
        parts.union(i, boundary);
    }
    for (i, edge) in network.edges.iter().enumerate() {
        if given[i].is_none() && !matches!(edge.element, Element::FlowSource(_)) {
            parts.union(edge.from.index(), edge.to.index());
        }
    }
    let outside = parts.find(boundary);
    for (_, edge) in network.edges.iter().enumerate().filter(|(i, _)| given[*i].is_some()) {
        let (a, b) = (parts.find(edge.from.index()), parts.find(edge.to.index()));
        if a == b {
            continue;
        }
        let part = if a == outside { b } else { a };
        let mut equations: Vec<Equation> = (0..network.edges.len())
            .filter(|&j| {
                let ends = [network.edges[j].from, network.edges[j].to];
                ends.into_iter().filter(|end| parts.find(end.index()) == part).count() == 1
            })
            .map(|j| given[j].map_or(Equation::Law(EdgeId::from_index(j)), Equation::Prescription))
            .collect();
        let nodes = (0..boundary).filter(|&node| parts.find(node) == part);
        equations.extend(nodes.map(|node| Equation::MassBalance(NodeId::from_index(node))));
        return Some(GraphProblem::OverDetermined { equations });
    }
    None
}

/// Which unknown occurs in which equation.
struct System {
    equations: Vec<Equation>,
    unknowns: Vec<Unknown>,
    unknowns_of: Vec<Vec<usize>>,
}

impl System {
    fn new(network: &Network) -> Self {
        let edges = network.edges.len();
        let mut unknowns: Vec<Unknown> =
            (0..edges).map(|i| Unknown::Flow(EdgeId::from_index(i))).collect();
        let mut pressure = vec![None; network.nodes.len()];
        for (i, _) in network.nodes.iter().enumerate().filter(|(_, n)| !n.has_fixed_pressure()) {
            pressure[i] = Some(unknowns.len());
            unknowns.push(Unknown::Pressure(NodeId::from_index(i)));
        }
        let mut free = vec![false; edges];
        for prescription in &network.prescriptions {
            free[prescription.free.index()] = true;
        }
        let ends = |edge: EdgeId| {
            let edge = &network.edges[edge.index()];
            [edge.from, edge.to].into_iter().filter_map(|node| pressure[node.index()])
        };
        let (mut equations, mut unknowns_of) = (Vec::new(), Vec::new());
        for (k, prescription) in network.prescriptions.iter().enumerate() {
            equations.push(Equation::Prescription(k));
            unknowns_of.push(match prescription.quantity {
                Quantity::MassFlow(edge) => vec![edge.index()],
                Quantity::PressureDifference(edge) => ends(edge).collect(),
                Quantity::Pressure(node) => pressure[node.index()].into_iter().collect(),
            });
        }
        for (i, edge) in network.edges.iter().enumerate().filter(|(i, _)| !free[*i]) {
            let id = EdgeId::from_index(i);
            equations.push(Equation::Law(id));
            unknowns_of.push(match edge.element {
                Element::FlowSource(_) => vec![i],
                Element::PressureSource(_) => ends(id).collect(),
                _ => std::iter::once(i).chain(ends(id)).collect(),
            });
        }
        let mut balance = vec![usize::MAX; network.nodes.len()];
        for (i, _) in pressure.iter().enumerate().filter(|(_, pressure)| pressure.is_some()) {
            balance[i] = equations.len();
            equations.push(Equation::MassBalance(NodeId::from_index(i)));
            unknowns_of.push(Vec::new());
        }
        for (i, edge) in network.edges.iter().enumerate() {
            for node in [edge.from, edge.to] {
                let row = balance[node.index()];
                if row != usize::MAX {
                    unknowns_of[row].push(i);
                }
            }
        }
        Self { equations, unknowns, unknowns_of }
    }
}

/// A maximum matching of rows to columns.
struct Matching {
    column_of: Vec<Option<usize>>,
    row_of: Vec<Option<usize>>,
}

impl Matching {
    fn new(columns_of: &[Vec<usize>], columns: usize) -> Self {
        let mut matching =
            Self { column_of: vec![None; columns_of.len()], row_of: vec![None; columns] };
        for (row, candidates) in columns_of.iter().enumerate() {
            if let Some(&column) = candidates.iter().find(|&&c| matching.row_of[c].is_none()) {
                matching.join(row, column);
            }
        }
        let mut seen = vec![usize::MAX; columns];
        for row in 0..columns_of.len() {
            if matching.column_of[row].is_none() {
                matching.augment(row, columns_of, &mut seen);
            }
        }
        matching
    }

    fn join(&mut self, row: usize, column: usize) {
        self.column_of[row] = Some(column);
        self.row_of[column] = Some(row);
    }

    /// Looks for a column for a row, moving others along an alternating path (depth first).
    fn augment(&mut self, start: usize, columns_of: &[Vec<usize>], seen: &mut [usize]) {
        // Rows of the path with the place of the next candidate.
        let mut path = vec![(start, 0)];
        while let Some((row, next)) = path.last_mut() {
            let Some(&column) = columns_of[*row].get(*next) else {
                path.pop();
                continue;
            };
            *next += 1;
            if std::mem::replace(&mut seen[column], start) == start {
                continue;
            }
            match self.row_of[column] {
                Some(other) => path.push((other, 0)),
                None => {
                    for &(row, next) in &path {
                        self.join(row, columns_of[row][next - 1]);
                    }
                    return;
                }
            }
        }
    }

    /// Rows reached by alternating paths from the rows without column.
    fn over(&self, columns_of: &[Vec<usize>]) -> Vec<usize> {
        let mut reached = vec![false; columns_of.len()];
        let mut stack: Vec<usize> =
            (0..columns_of.len()).filter(|&row| self.column_of[row].is_none()).collect();
        while let Some(row) = stack.pop() {
            if !std::mem::replace(&mut reached[row], true) {
                stack.extend(columns_of[row].iter().filter_map(|&column| self.row_of[column]));
            }
        }
        (0..reached.len()).filter(|&row| reached[row]).collect()
    }

    /// Columns reached by alternating paths from the columns without row.
    fn under(&self, columns_of: &[Vec<usize>]) -> Vec<usize> {
        let mut rows_of = vec![Vec::new(); self.row_of.len()];
        for (row, columns) in columns_of.iter().enumerate() {
            for &column in columns {
                rows_of[column].push(row);
            }
        }
        let mut reached = vec![false; rows_of.len()];
        let mut stack: Vec<usize> =
            (0..rows_of.len()).filter(|&column| self.row_of[column].is_none()).collect();
        while let Some(column) = stack.pop() {
            if !std::mem::replace(&mut reached[column], true) {
                stack.extend(rows_of[column].iter().filter_map(|&row| self.column_of[row]));
            }
        }
        (0..reached.len()).filter(|&column| reached[column]).collect()
    }
}
