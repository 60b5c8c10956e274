//! Ideal head sources: their nodes are one unknown, their flows follow from the mass balance.

use crate::graph::Network;

/// An ideal head source in the tree that merges nodes, leaves last.
#[derive(Debug, Clone, Copy)]
pub(super) struct IdealLink {
    pub edge: u32,
    pub parent: u32,
    pub child: u32,
}

/// Ideal head sources as trees, root (a fixed node where there is one) first.
pub(super) fn ideal_forest(network: &Network) -> Vec<IdealLink> {
    let n = network.nodes.len();
    let mut incident: Vec<Vec<u32>> = vec![Vec::new(); n];
    for (i, edge) in network.edges.iter().enumerate().filter(|(_, edge)| network.is_ideal(edge)) {
        incident[edge.from.index()].push(i as u32);
        incident[edge.to.index()].push(i as u32);
    }
    let mut seen = vec![false; n];
    let mut links = Vec::new();
    let fixed_first = (0..n)
        .filter(|&i| network.nodes[i].has_fixed_pressure())
        .chain((0..n).filter(|&i| !network.nodes[i].has_fixed_pressure()));
    for root in fixed_first {
        if std::mem::replace(&mut seen[root], true) {
            continue;
        }
        let mut stack = vec![root];
        while let Some(parent) = stack.pop() {
            for &edge in &incident[parent] {
                let ends = &network.edges[edge as usize];
                let child = if ends.from.index() == parent { ends.to } else { ends.from };
                if !std::mem::replace(&mut seen[child.index()], true) {
                    links.push(IdealLink { edge, parent: parent as u32, child: child.0 });
                    stack.push(child.index());
                }
            }
        }
    }
    links
}
