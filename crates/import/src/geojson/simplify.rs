//! Leaves out the nodes that only join two equal pipes; their lengths add up.
//!
//! With the same flow in both, the pressure loss of Darcy's law is in proportion to the length: the pressures of
//! the nodes that remain do not change. Loss coefficients `zeta` add up as well.

use super::features::{Line, Network};
use super::properties::Fields;
use crate::{Note, NoteKind};
use serde_json::Value;
use std::collections::{HashMap, HashSet};

/// Merges until nothing is left to merge.
pub(super) fn simplify(network: &mut Network, notes: &mut Vec<Note>) {
    let before = network.points.len();
    // Fields of nodes besides their height make them more than a joint.
    let plain: HashSet<String> = network
        .points
        .iter()
        .filter(|point| {
            point.fields.iter().all(|(name, value)| {
                name.starts_with("elevation_")
                    || (name == "kind" && value == "junction")
                    || value.as_f64() == Some(0.0)
            })
        })
        .map(|point| point.id.clone())
        .collect();
    let companions: HashSet<String> =
        network.lines.iter().filter_map(|line| companion(line)).map(str::to_owned).collect();
    let fixed =
        |line: &Line| !line.is_pipe() || companion(line).is_some() || companions.contains(&line.id);
    let mut at: HashMap<String, Vec<usize>> = HashMap::new();
    for (i, line) in network.lines.iter().enumerate() {
        for end in line.ends.iter().flatten() {
            at.entry(end.clone()).or_default().push(i);
        }
    }
    let mut gone = HashSet::new();
    let mut merged = vec![false; network.lines.len()];
    let order: Vec<String> = network.points.iter().map(|point| point.id.clone()).collect();
    for id in order.into_iter().filter(|id| plain.contains(id)) {
        let Some(&[first, second]) = at.get(&id).map(Vec::as_slice) else { continue };
        let (a, b) = (first.min(second), first.max(second));
        let [one, other] = [&network.lines[a], &network.lines[b]];
        if fixed(one) || fixed(other) || !alike(&one.fields, &other.fields) {
            continue;
        }
        let far = |line: &Line| line.ends.iter().flatten().find(|end| **end != id).cloned();
        let (Some(start), Some(end)) = (far(one), far(other)) else { continue };
        if start == end {
            continue;
        }
        let length_m = one.length_m.unwrap_or(0.0) + other.length_m.unwrap_or(0.0);
        let zeta = zeta(&one.fields) + zeta(&other.fields);
        // The direction of the first of the file stays.
        let forward = one.ends[1].as_ref() == Some(&id);
        let ends =
            if forward { [start.clone(), end.clone()] } else { [end.clone(), start.clone()] };
        let kept = &mut network.lines[a];
        kept.ends = ends.map(Some);
        kept.length_m = Some(length_m);
        kept.path.clear();
        if let Some((_, value)) = kept.fields.iter_mut().find(|(name, _)| name == "zeta") {
            *value = zeta.into();
        } else if zeta != 0.0 {
            kept.fields.push(("zeta".to_owned(), zeta.into()));
        }
        merged[b] = true;
        gone.insert(id);
        if let Some(lines) = at.get_mut(&end) {
            lines.iter_mut().filter(|line| **line == b).for_each(|line| *line = a);
        }
    }
    let mut position = 0..;
    network.lines.retain(|_| !merged[position.next().unwrap_or(0)]);
    network.points.retain(|point| !gone.contains(&point.id));
    let text = format!(
        "{} of {before} nodes joined two equal pipes and are left out; the pipes have the sum of their lengths",
        gone.len()
    );
    notes.push(Note { kind: NoteKind::Changed, line: None, text });
}

fn companion(line: &Line) -> Option<&str> {
    line.fields.iter().find(|(name, _)| name == "companion").and_then(|(_, name)| name.as_str())
}

fn zeta(fields: &Fields) -> f64 {
    fields
        .iter()
        .find(|(name, _)| name == "zeta")
        .and_then(|(_, zeta)| zeta.as_f64())
        .unwrap_or(0.0)
}

/// Whether two pipes differ in nothing but their length and losses of fittings.
fn alike(one: &Fields, other: &Fields) -> bool {
    let of = |fields: &Fields| -> HashMap<String, Value> {
        fields.iter().filter(|(name, _)| name != "zeta").cloned().collect()
    };
    of(one) == of(other)
}
