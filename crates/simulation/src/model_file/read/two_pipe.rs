//! `connection = "two_pipe"` of a `[[house]]`: ports of a storage at the same two heights become one pair of pipes.
//!
//! The library states every circuit with ports of its own (four pipes). Two-pipe, the storage has one port there, which
//! takes the difference; the circuits that passed the others become branches between its two points,
//! `STORAGE_supply` and `STORAGE_return`: from the return to the supply where their port charged (its inlet is the
//! higher end), the other way round where it was drawn on.

use crate::document::{Key, Scalar, Span, Tree, TreeKind};
use serde_json::Value;

/// The name of the port that is left, and the end of the name of its circuit.
const PORT: &str = "point";
const CIRCUIT: &str = "pipes";

/// A port with one pair of ends.
struct OwnPort {
    name: String,
    /// How its ends are said, `m` or `layer`, the lower and the higher one.
    ends: (String, f64, f64),
    /// Whether water enters at the higher end.
    charges: bool,
}

/// Connects the storages of a house by two pipes; whether there was one with ports at the same heights.
pub(super) fn connect(parts: &mut Vec<(Key, Tree)>) -> bool {
    let mut joined: Vec<(String, Vec<OwnPort>, Span)> = Vec::new();
    for unit in entries_of(parts, "unit") {
        let name = unit.text("name").unwrap_or("unit").to_owned();
        if unit.text("kind") == Some("storage")
            && let Some(ports) = join_ports(unit)
        {
            joined.push((name, ports, unit.span));
        }
    }
    for circuit in entries_of(parts, "circuit") {
        for (storage, ports, _) in &joined {
            ports.iter().for_each(|port| branch(circuit, storage, port));
        }
    }
    for (storage, _, span) in &joined {
        let [supply, back] = points(storage);
        let pipes = Tree::table(
            *span,
            vec![
                ("id", Value::from(format!("{storage}_{CIRCUIT}"))),
                ("through", Value::from(vec![format!("{storage}.{PORT}")])),
                ("from", Value::from(supply)),
                ("to", Value::from(back)),
            ],
        );
        let kind = TreeKind::Array(vec![pipes]);
        parts.push((Key { name: "circuit".into(), span: *span }, Tree { span: *span, kind }));
    }
    !joined.is_empty()
}

/// Supply and return of a storage.
fn points(storage: &str) -> [String; 2] {
    [format!("{storage}_supply"), format!("{storage}_return")]
}

/// All entries of a section.
fn entries_of<'a>(
    parts: &'a mut [(Key, Tree)],
    section: &'a str,
) -> impl Iterator<Item = &'a mut Tree> {
    let of_section = parts.iter_mut().filter(move |(key, _)| key.name == section);
    of_section.flat_map(|(_, value)| match value {
        Tree { kind: TreeKind::Array(items), .. } => items.iter_mut(),
        single => std::slice::from_mut(single).iter_mut(),
    })
}

/// Puts one port in the place of those at the same heights; these, where there are several.
fn join_ports(storage: &mut Tree) -> Option<Vec<OwnPort>> {
    let TreeKind::Table(fields) = &mut storage.kind else { return None };
    let (_, ports) = fields.iter_mut().find(|(key, _)| key.name == "ports")?;
    let own: Vec<OwnPort> =
        ports.entries().iter().filter_map(|(key, port)| own_port(&key.name, port)).collect();
    let shared = own.iter().find(|port| same(&own, port).count() > 1)?;
    let ends = shared.ends.clone();
    let (joined, _): (Vec<_>, Vec<_>) = own.into_iter().partition(|port| port.ends == ends);
    let span = ports.span;
    let TreeKind::Table(entries) = &mut ports.kind else { return None };
    entries.retain(|(key, _)| !joined.iter().any(|port| port.name == key.name));
    let (unit, low, high) = ends;
    let end = |name: &str, value: f64| match unit.as_str() {
        "layer" => (format!("{name}_{unit}"), Value::from(value as u64)),
        _ => (format!("{name}_{unit}"), Value::from(value)),
    };
    let point = Value::Object([end("inlet", high), end("outlet", low)].into_iter().collect());
    entries.push((Key { name: PORT.into(), span }, Tree::from_json(&point, span)));
    Some(joined)
}

fn same<'a>(own: &'a [OwnPort], port: &'a OwnPort) -> impl Iterator<Item = &'a OwnPort> {
    own.iter().filter(|other| other.ends == port.ends)
}

/// A port with one pair of ends, in the same unit.
fn own_port(name: &str, port: &Tree) -> Option<OwnPort> {
    let number = |of: &str| {
        port.entries().iter().find_map(|(key, value)| {
            let unit = key.name.strip_prefix(of)?;
            match &value.kind {
                TreeKind::Scalar(Scalar::Number(number)) => {
                    Some((unit.to_owned(), number.as_f64()?))
                }
                _ => None,
            }
        })
    };
    let ((unit, inlet), (other, outlet)) = (number("inlet_")?, number("outlet_")?);
    let ends = (unit, inlet.min(outlet), inlet.max(outlet));
    (ends.0 == other).then(|| OwnPort { name: name.to_owned(), ends, charges: inlet > outlet })
}

/// Makes a circuit that passes the port a branch without it.
fn branch(circuit: &mut Tree, storage: &str, port: &OwnPort) {
    let member = format!("{storage}.{}", port.name);
    let span = circuit.span;
    let TreeKind::Table(fields) = &mut circuit.kind else { return };
    let through = fields.iter_mut().find(|(key, _)| key.name == "through");
    let Some(TreeKind::Array(members)) = through.map(|(_, tree)| &mut tree.kind) else { return };
    let is_port =
        |tree: &Tree| matches!(&tree.kind, TreeKind::Scalar(Scalar::Text(name)) if *name == member);
    let Some(at) = members.iter().position(is_port) else { return };
    // What stood behind the storage comes first.
    members.rotate_left(at);
    members.remove(0);
    let [supply, back] = points(storage);
    let (from, to) = if port.charges { (back, supply) } else { (supply, back) };
    for (field, point) in [("from", from), ("to", to)] {
        fields.push((Key { name: field.into(), span }, Tree::from_json(&Value::from(point), span)));
    }
}
