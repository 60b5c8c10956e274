//! A three-way valve: two valves that share a command and a node.
//!
//! ```text
//! a --ID.a-- ab --ID.b-- b
//! ```
//! The command `ID.opening` = x opens `ID.a` by x and `ID.b` by 1 - x. Mixing, both have port b at `ab`;
//! diverting, port a. The direction of the water is a result either way.

use super::expand::Plain;
use crate::document::Span;
use crate::document::{Key, Scalar, Tree, TreeKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// The own fields of a `[[three_way_valve]]`; the others are those of a valve, of both ways.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThreeWayValveEntry {
    /// Name; the two ways are the edges `ID.a` and `ID.b`.
    pub id: String,
    /// Node of the way that the command opens.
    pub a: String,
    /// Node of the way that the command closes.
    pub b: String,
    /// Node that the two ways share.
    pub ab: String,
    /// Which way is the positive flow.
    #[serde(default)]
    pub mode: ThreeWayMode,
    /// Flow coefficient of way b over that of way a.
    #[serde(default = "one")]
    pub kvs_ratio: f64,
    /// Characteristic of way b. Absent: that of way a.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub characteristic_b: Option<String>,
}

fn one() -> f64 {
    1.0
}

/// Orientation of a three-way valve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ThreeWayMode {
    /// Positive from a and b to ab.
    #[default]
    Mixing,
    /// Positive from ab to a and b.
    Diverting,
}

/// The fields that are not those of a valve.
pub(super) const OWN_FIELDS: &[&str] =
    &["id", "a", "b", "ab", "mode", "kvs_ratio", "characteristic_b"];

/// The two valves; `own` has the places of the entry's own fields, `fields` are those of a valve.
pub(super) fn valves(entry: &ThreeWayValveEntry, own: &Tree, fields: &Tree) -> Vec<Plain> {
    let what = format!("three_way_valve \"{}\"", entry.id);
    let way = |name: &'static str, node: &String, of_b: bool| {
        let ends = match entry.mode {
            ThreeWayMode::Mixing => [("from", name, node), ("to", "ab", &entry.ab)],
            ThreeWayMode::Diverting => [("from", "ab", &entry.ab), ("to", name, node)],
        };
        let mut tree = Tree::table(
            fields.span,
            vec![
                ("id", json!(format!("{}.{name}", entry.id))),
                ("kind", json!("valve")),
                ("command_of", json!(entry.id)),
                ("inverse", json!(of_b)),
            ],
        );
        for (end, field, node) in ends {
            let place = own.get(field).map_or(Span::NONE, |tree| tree.span);
            push(&mut tree, end, &json!(node), place);
        }
        if let (true, Some(characteristic)) = (of_b, &entry.characteristic_b) {
            let place = own.get("characteristic_b").map_or(Span::NONE, |tree| tree.span);
            push(&mut tree, "characteristic", &json!(characteristic), place);
        }
        tree.fill_from(fields);
        if tree.get("characteristic").is_none() {
            push(&mut tree, "characteristic", &json!("linear"), fields.span);
        }
        if of_b {
            scale_kvs(&mut tree, entry.kvs_ratio);
        }
        Plain { tree, owner: "".into(), entry: (&what).into() }
    };
    vec![way("a", &entry.a, false), way("b", &entry.b, true)]
}

fn push(tree: &mut Tree, name: &str, value: &Value, span: Span) {
    let value = Tree::from_json(value, span);
    if let TreeKind::Table(entries) = &mut tree.kind {
        entries.push((Key { name: name.into(), span }, value));
    }
}

fn scale_kvs(tree: &mut Tree, ratio: f64) {
    let TreeKind::Table(entries) = &mut tree.kind else { return };
    for (key, value) in entries {
        let number = match &value.kind {
            TreeKind::Scalar(Scalar::Number(number)) if key.name.starts_with("kvs_") => {
                number.as_f64()
            }
            _ => None,
        };
        if let Some(number) = number.filter(|_| ratio != 1.0) {
            value.kind = TreeKind::Scalar((&json!(number * ratio)).into());
        }
    }
}
