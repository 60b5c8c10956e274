//! Where a network has feeders.

use crate::elements::Element;
use crate::graph::{Network, NodeKind};
use anergy_core::ids::EdgeId;

/// A pump in series with a check valve that lets its flow pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Feeder {
    /// The pump.
    pub pump: EdgeId,
    /// The check valve.
    pub check_valve: EdgeId,
}

/// The feeders of a network, in the order of their pumps.
pub fn feeders(network: &Network) -> Vec<Feeder> {
    let mut incident: Vec<Vec<usize>> = vec![Vec::new(); network.nodes.len()];
    for (i, edge) in network.edges.iter().enumerate() {
        incident[edge.from.index()].push(i);
        incident[edge.to.index()].push(i);
    }
    let pumps = network.edges.iter().enumerate();
    pumps
        .filter(|(_, edge)| matches!(edge.element, Element::Pump(_)))
        .filter_map(|(pump, _)| {
            let check_valve = check_valve_of(network, &incident, pump)?;
            let (pump, check_valve) = (EdgeId::from_index(pump), EdgeId::from_index(check_valve));
            Some(Feeder { pump, check_valve })
        })
        .collect()
}

/// The nearest check valve that all water of the pump passes, in its direction.
fn check_valve_of(network: &Network, incident: &[Vec<usize>], pump: usize) -> Option<usize> {
    let ends = &network.edges[pump];
    for downstream in [true, false] {
        let (mut at, mut last) = (if downstream { ends.to } else { ends.from }, pump);
        // Walks away from the pump as long as there is one way on.
        for _ in 0..network.edges.len() {
            let [a, b] = incident[at.index()][..] else { break };
            if network.nodes[at.index()].kind != NodeKind::Junction || a == b {
                break;
            }
            let next = if a == last { b } else { a };
            let edge = &network.edges[next];
            let forward = (edge.from == at) == downstream;
            match edge.element {
                Element::CheckValve(_) if forward => return Some(next),
                // Against it nothing flows; a second pump has its own margin.
                Element::CheckValve(_) | Element::Pump(_) => break,
                _ => {}
            }
            (at, last) = (if edge.from == at { edge.to } else { edge.from }, next);
        }
    }
    None
}
