//! What closed links cut off from every given head.

use super::network::{LinkKind, Network, NodeKind};
use super::translate::is_open;
use super::units::Options;
use crate::NoteKind;
use crate::model_text::ModelText;

/// Names in a message, at most.
const NAMES: usize = 8;

/// Which nodes and links a model keeps.
pub(super) struct Reach {
    pub nodes: Vec<bool>,
    pub links: Vec<bool>,
    links_of: Vec<Vec<(usize, usize)>>,
}

impl Reach {
    /// Follows open links from the given heads.
    pub fn of(network: &Network) -> Self {
        let open: Vec<bool> = network
            .links
            .iter()
            .map(|link| is_open(link) && !into_full_tank(network, link))
            .collect();
        let mut links_of = vec![Vec::new(); network.nodes.len()];
        for (i, link) in network.links.iter().enumerate().filter(|(i, _)| open[*i]) {
            links_of[link.from].push((i, link.to));
            links_of[link.to].push((i, link.from));
        }
        let mut nodes: Vec<bool> =
            network.nodes.iter().map(|node| node.head_m().is_some()).collect();
        let mut next: Vec<usize> = (0..nodes.len()).filter(|i| nodes[*i]).collect();
        while let Some(node) = next.pop() {
            for &(_, other) in &links_of[node] {
                if !std::mem::replace(&mut nodes[other], true) {
                    next.push(other);
                }
            }
        }
        let links: Vec<bool> =
            network.links.iter().zip(open).map(|(link, open)| open && nodes[link.from]).collect();
        // A given head from which nothing leads away is no part of the model.
        for (node, links) in links_of.iter().enumerate() {
            nodes[node] &= !links.is_empty();
        }
        Self { nodes, links, links_of }
    }

    /// Whether no water can flow through a link: behind one of its ends is neither a given head nor a
    /// demand.
    pub fn leads_nowhere(&self, network: &Network, options: &Options, link: usize) -> bool {
        let ends = [network.links[link].from, network.links[link].to];
        ends.iter().any(|&end| {
            let mut seen = vec![false; network.nodes.len()];
            seen[end] = true;
            let mut next = vec![end];
            while let Some(node) = next.pop() {
                let exchanges = match &network.nodes[node].kind {
                    NodeKind::Junction { demands, emitter } => {
                        *emitter > 0.0 || demands.iter().any(|demand| demand.base_m3_s != 0.0)
                    }
                    _ => true,
                };
                if exchanges && options.demand_multiplier > 0.0 {
                    return false;
                }
                for &(through, other) in &self.links_of[node] {
                    if through != link && !std::mem::replace(&mut seen[other], true) {
                        next.push(other);
                    }
                }
            }
            true
        })
    }

    /// Links that are closed at the start.
    pub fn note_closed(&self, network: &Network, text: &mut ModelText) {
        for link in &network.links {
            if !is_open(link) {
                let what = "left out, as it is closed at t = 0";
                link.note(text, NoteKind::Changed, what);
            } else if into_full_tank(network, link) {
                let what = "left out: it would pump into a full tank or out of an empty one";
                link.note(text, NoteKind::Changed, what);
            }
        }
    }

    /// Nodes without a way to a given head.
    pub fn note_cut_off(&self, network: &Network, options: &Options, text: &mut ModelText) {
        for (node, _) in network.nodes.iter().zip(&self.nodes).filter(|(_, reached)| !**reached) {
            if node.head_m().is_some() {
                let what = format!("left out: nothing open leads to \"{}\" at t = 0", node.id);
                text.note(NoteKind::NotTranslated, node.line, what);
            }
        }
        let cut_off = |thirsty: bool| {
            let nodes = network.nodes.iter().zip(&self.nodes).filter(|(_, reached)| !**reached);
            nodes.map(|(node, _)| node).filter(move |node| match &node.kind {
                NodeKind::Junction { demands, .. } => {
                    let takes = network.demand_m3_s(demands, options, 0) != 0.0;
                    takes == thirsty
                }
                _ => false,
            })
        };
        for (thirsty, kind, what) in [
            (true, NoteKind::Problem, "take or give water, but nothing open leads to a given head"),
            (false, NoteKind::NotTranslated, "are cut off by closed links, no water flows there"),
        ] {
            let mut nodes = cut_off(thirsty).peekable();
            let line = nodes.peek().map(|node| node.line);
            let names: Vec<String> = nodes.map(|node| format!("\"{}\"", node.id)).collect();
            if names.is_empty() {
                continue;
            }
            let shown = names[..names.len().min(NAMES)].join(", ");
            let more = match names.len().saturating_sub(NAMES) {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            text.note(kind, line, format!("left out: junctions {shown}{more} {what}"));
        }
    }
}

/// Whether a pump is stopped by the tank at its end.
fn into_full_tank(network: &Network, link: &super::network::Link) -> bool {
    if !matches!(link.kind, LinkKind::Pump { .. }) {
        return false;
    }
    let tank = |node: usize| match network.nodes[node].kind {
        NodeKind::Tank { level_m, min_m, max_m, overflows } => {
            Some((level_m <= min_m, level_m >= max_m && !overflows))
        }
        _ => None,
    };
    tank(link.to).is_some_and(|(_, full)| full) || tank(link.from).is_some_and(|(empty, _)| empty)
}
