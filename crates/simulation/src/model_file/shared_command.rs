//! Valves that share a command: the two ways of a three-way valve, the four of a four-way mixer.
//!
//! ```text
//! a --ID.a-- ab --ID.b-- b        source_supply --ID.supply-- load_supply
//!                                       |                         |
//!                                   ID.bypass              ID.recirculation
//!                                       |                         |
//!                                 source_return --ID.return-- load_return
//! ```
//! The command `ID.opening` = x opens `ID.a` by x and `ID.b` by 1 - x. Mixing, both have port b at `ab`;
//! diverting, port a. The direction of the water is a result either way. A four-way mixer is a mixing and a
//! diverting valve back to back: x opens supply and return, 1 - x recirculation and bypass.

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

/// The own fields of a `[[four_way_mixer]]`; the others are those of a valve, of all ways.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FourWayMixerEntry {
    /// Name; the ways are the edges `ID.supply`, `ID.return`, `ID.recirculation` and `ID.bypass`.
    pub id: String,
    /// Node from which the source's supply comes.
    pub source_supply: String,
    /// Node at which water goes back to the source.
    pub source_return: String,
    /// Node at which the mixed water goes to the load.
    pub load_supply: String,
    /// Node from which the load's return comes.
    pub load_return: String,
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

/// An entry that stands for several valves with one command.
pub(super) trait SharedCommand {
    /// Its section.
    const SECTION: &'static str;
    /// The fields that are not those of a valve.
    const OWN_FIELDS: &'static [&'static str];
    /// What it does, as a hint.
    const HINT: &'static str;

    /// Its name.
    fn id(&self) -> &str;
    /// Its ways.
    fn ways(&self) -> Vec<Way<'_>>;
}

/// One way: a valve between two nodes, each with the field that names it.
pub(super) struct Way<'a> {
    name: &'static str,
    from: (&'static str, &'a str),
    to: (&'static str, &'a str),
    /// Whether the command closes it.
    inverse: bool,
    /// Its flow coefficient over that of the entry, and its own characteristic.
    kvs_ratio: f64,
    characteristic: Option<&'a str>,
}

impl SharedCommand for ThreeWayValveEntry {
    const SECTION: &'static str = "three_way_valve";
    const OWN_FIELDS: &'static [&'static str] =
        &["id", "a", "b", "ab", "mode", "kvs_ratio", "characteristic_b"];
    const HINT: &'static str =
        "a three-way valve joins a and b to ab, and its ways share one command";

    fn id(&self) -> &str {
        &self.id
    }

    fn ways(&self) -> Vec<Way<'_>> {
        let common = ("ab", self.ab.as_str());
        let way = |name, node, inverse| {
            let (from, to) = match self.mode {
                ThreeWayMode::Mixing => ((name, node), common),
                ThreeWayMode::Diverting => (common, (name, node)),
            };
            Way { name, from, to, inverse, kvs_ratio: 1.0, characteristic: None }
        };
        let characteristic = self.characteristic_b.as_deref();
        let b =
            Way { kvs_ratio: self.kvs_ratio, characteristic, ..way("b", self.b.as_str(), true) };
        vec![way("a", &self.a, false), b]
    }
}

impl SharedCommand for FourWayMixerEntry {
    const SECTION: &'static str = "four_way_mixer";
    const OWN_FIELDS: &'static [&'static str] =
        &["id", "source_supply", "source_return", "load_supply", "load_return"];
    const HINT: &'static str = "a four-way mixer joins the supply and return of a source to those of a load, and its ways share one command";

    fn id(&self) -> &str {
        &self.id
    }

    fn ways(&self) -> Vec<Way<'_>> {
        let source_supply = ("source_supply", self.source_supply.as_str());
        let source_return = ("source_return", self.source_return.as_str());
        let load_supply = ("load_supply", self.load_supply.as_str());
        let load_return = ("load_return", self.load_return.as_str());
        let way = |name, from, to, inverse| Way {
            name,
            from,
            to,
            inverse,
            kvs_ratio: 1.0,
            characteristic: None,
        };
        vec![
            way("supply", source_supply, load_supply, false),
            way("return", load_return, source_return, false),
            way("recirculation", load_return, load_supply, true),
            way("bypass", source_supply, source_return, true),
        ]
    }
}

/// Its valves; `own` has the places of the entry's own fields, `fields` are those of a valve.
pub(super) fn valves<E: SharedCommand>(entry: &E, own: &Tree, fields: &Tree) -> Vec<Plain> {
    let what = format!("{} \"{}\"", E::SECTION, entry.id());
    let valve = |way: Way<'_>| {
        let mut tree = Tree::table(
            fields.span,
            vec![
                ("id", json!(format!("{}.{}", entry.id(), way.name))),
                ("kind", json!("valve")),
                ("command_of", json!(entry.id())),
                ("inverse", json!(way.inverse)),
            ],
        );
        for (end, (field, node)) in [("from", way.from), ("to", way.to)] {
            let place = own.get(field).map_or(Span::NONE, |tree| tree.span);
            push(&mut tree, end, &json!(node), place);
        }
        if let Some(characteristic) = way.characteristic {
            let place = own.get("characteristic_b").map_or(Span::NONE, |tree| tree.span);
            push(&mut tree, "characteristic", &json!(characteristic), place);
        }
        tree.fill_from(fields);
        if tree.get("characteristic").is_none() {
            push(&mut tree, "characteristic", &json!("linear"), fields.span);
        }
        scale_kvs(&mut tree, way.kvs_ratio);
        Plain { tree, owner: "".into(), entry: (&what).into() }
    };
    entry.ways().into_iter().map(valve).collect()
}

fn push(tree: &mut Tree, name: &str, value: &Value, span: Span) {
    let value = Tree::from_json(value, span);
    if let TreeKind::Table(entries) = &mut tree.kind {
        entries.push((Key { name: name.into(), span }, value));
    }
}

fn scale_kvs(tree: &mut Tree, ratio: f64) {
    let TreeKind::Table(entries) = &mut tree.kind else { return };
    for (key, value) in entries.iter_mut().filter(|_| ratio != 1.0) {
        let number = match &value.kind {
            TreeKind::Scalar(Scalar::Number(number)) if key.name.starts_with("kvs_") => {
                number.as_f64()
            }
            _ => None,
        };
        if let Some(number) = number {
            value.kind = TreeKind::Scalar((&json!(number * ratio)).into());
        }
    }
}
