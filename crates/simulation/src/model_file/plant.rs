//! The plant: a circulation pump and a heat source between the lines of a site.
//!
//! ```text
//! cold -- circulation_pump -- generator_inlet -- generator -- hot
//! ```
//! The `generator` carries the unit that gives its water the supply temperature. The pump holds its head
//! (`dp_at = "plant"`), or a controller moves that head until the smallest pressure difference over the
//! consumers is the wanted one (`dp_at = "worst_consumer"`).

use super::expand::{Part, Plain};
use super::{InterfaceEntry, SiteEntry, StationKind, is_null, station_name};
use crate::document::{Key, Tree, TreeKind};
use anergy_core::units::split_suffix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use smol_str::format_smolstr;

/// Flow in m3/h at 1 bar of a generator of which nothing is said: practically no pressure loss.
const GENERATOR_KV_M3_H: f64 = 1e4;
/// Proportional gain of the head on the pressure difference at the worst consumer.
const GAIN: f64 = 0.2;

/// `[[station]]` with `kind = "plant"`: gives water of a supply temperature to the hot line and holds a
/// pressure difference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlantEntry {
    /// The site it stands at.
    pub site: String,
    /// `plant`.
    pub kind: StationKind,
    /// Name within its site; another name than "station" also prefixes its parts.
    #[serde(default = "station_name")]
    pub name: String,
    /// Temperature of the water it supplies, K; also the signal `SITE.unit.supply_k`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supply_k: Option<f64>,
    /// Instead: points of outdoor and supply temperature, K.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outdoor_curve_k: Vec<(f64, f64)>,
    /// Outdoor temperature while nothing drives the signal `SITE.unit.outdoor_k`, K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outdoor_k: Option<f64>,
    /// Pressure difference that is held, Pa. Absent: the pump runs at its own `speed`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dp_pa: Option<f64>,
    /// Where it is held.
    #[serde(default)]
    pub dp_at: DpAt,
    /// Stations of which the worst is held, for example "c12.station". Absent: all consumers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub consumers: Option<Vec<String>>,
    /// Time in which the head follows a constant deviation at the worst consumer by as much, s.
    #[serde(default = "one_minute")]
    pub dp_integral_time_s: f64,
    /// Pressure held at its cold side, above the atmosphere, Pa. Absent: it holds none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub return_pressure_pa: Option<f64>,
    /// The circulation pump: fields of a pump.
    #[serde(default, skip_serializing_if = "is_null")]
    pub circulation_pump: Value,
    /// The passage through the generator: fields of a resistance.
    #[serde(default, skip_serializing_if = "is_null")]
    pub generator: Value,
}

fn one_minute() -> f64 {
    60.0
}

/// Where a plant holds its pressure difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DpAt {
    /// Between its own hot and cold side.
    #[default]
    Plant,
    /// Between the hot and cold line at the consumer that has least.
    WorstConsumer,
}

/// `[[worst_point]]`: the smallest of several pressure differences, a channel `ID.dp_pa`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WorstPointEntry {
    /// Name.
    pub id: String,
    /// Pairs of nodes; each difference is that of the first against the second.
    pub between: Vec<(String, String)>,
}

/// What a plant is made of; the trees are entries of other sections.
pub(super) struct Plant {
    pub nodes: Vec<Plain>,
    pub edges: Vec<Plain>,
    pub interface: InterfaceEntry,
    pub unit: Tree,
    pub reference: Option<Tree>,
}

fn prefix(plant: &PlantEntry) -> String {
    match plant.name.as_str() {
        "station" => plant.site.clone(),
        name => format!("{}.{name}", plant.site),
    }
}

/// The parts of a plant; `tree` is its entry, with places.
pub(super) fn plant(plant: &PlantEntry, site: &SiteEntry, tree: &Tree, what: &str) -> Plant {
    let prefix = prefix(plant);
    let id = format!("{}.{}", site.id, plant.name);
    let inner = |name: &str| format!("{prefix}.{name}");
    let (hot, cold) =
        (format!("{}.{}", site.id, site.lines[0]), format!("{}.{}", site.id, site.lines[1]));
    let given = |part: &str, fields: &[&str]| {
        tree.get(part).is_some_and(|part| {
            let names = part.entries().iter().map(|(key, _)| key.name.as_str());
            names.map(stem).any(|name| fields.contains(&name))
        })
    };
    let pump = Part {
        name: "circulation_pump",
        kind: "pump",
        fields: "circulation_pump",
        ends: (cold.clone(), inner("generator_inlet")),
        defaults: match plant.dp_pa {
            Some(_) => json!({ "mode": "head" }),
            None if given("circulation_pump", &["mode", "speed"]) => json!({}),
            None => json!({ "speed": 1.0, "initial_speed": 1.0 }),
        },
    };
    let generator = Part {
        name: "generator",
        kind: "resistance",
        fields: "generator",
        ends: (inner("generator_inlet"), hot),
        defaults: if given("generator", &["kv", "dp_nominal", "m_flow_nominal"]) {
            json!({})
        } else {
            json!({ "kv_m3_h": GENERATOR_KV_M3_H })
        },
    };
    let mut pump_tree = pump.tree(tree, &prefix);
    // The head in the unit in which the pressure difference was written.
    push(&mut pump_tree, tree, "dp", "head");
    let edge = |part: &Part, tree: Tree| Plain {
        tree,
        owner: (&id).into(),
        entry: format_smolstr!("{what}, {}", part.fields),
    };
    let edges = vec![edge(&pump, pump_tree), edge(&generator, generator.tree(tree, &prefix))];
    let node =
        vec![("id", json!(inner("generator_inlet"))), ("elevation_m", json!(site.elevation_m))];
    let unit_id = inner("unit");
    let mut unit = Tree::table(
        tree.span,
        vec![
            ("id", json!(unit_id)),
            ("port", json!(inner("generator"))),
            ("kind", json!("heat_source")),
        ],
    );
    for field in ["supply", "outdoor_curve", "outdoor"] {
        push(&mut unit, tree, field, field);
    }
    let reference = plant.return_pressure_pa.map(|_| {
        let mut reference = Tree::table(tree.span, vec![("node", json!(cold))]);
        push(&mut reference, tree, "return_pressure", "pressure");
        reference
    });
    Plant {
        nodes: vec![Plain {
            tree: Tree::table(tree.span, node),
            owner: (&site.id).into(),
            entry: what.into(),
        }],
        edges,
        interface: InterfaceEntry {
            edge: inner("generator"),
            pump: Some(inner("circulation_pump")),
            ..InterfaceEntry::watching(id)
        },
        unit,
        reference,
    }
}

/// The worst point of a plant and the controller that holds it.
pub(super) fn worst_point(
    plant: &PlantEntry,
    dp_pa: f64,
    between: &[(String, String)],
    tree: &Tree,
) -> (Tree, Tree) {
    let prefix = prefix(plant);
    let id = format!("{prefix}.worst_consumer");
    let point = vec![("id", json!(id)), ("between", json!(between))];
    let controller = vec![
        ("id", json!(format!("{prefix}.dp_controller"))),
        ("kind", json!("pi")),
        ("measures", json!(format!("{id}.dp_pa"))),
        ("acts_on", json!(format!("{prefix}.circulation_pump.head_pa"))),
        ("set_point", json!(dp_pa)),
        ("gain", json!(GAIN)),
        ("integral_time_s", json!(GAIN * plant.dp_integral_time_s)),
        ("initial_output", json!(dp_pa)),
    ];
    (Tree::table(tree.span, point), Tree::table(tree.span, controller))
}

fn stem(name: &str) -> &str {
    split_suffix(name).map_or(name, |(stem, _)| stem)
}

/// Copies a quantity in the unit in which it was written, under another name.
fn push(to: &mut Tree, from: &Tree, quantity: &str, name: &str) {
    let written = from
        .entries()
        .iter()
        .find(|(key, _)| split_suffix(&key.name).is_some_and(|(stem, _)| stem == quantity));
    if let (Some((key, value)), TreeKind::Table(entries)) = (written, &mut to.kind) {
        let suffix = split_suffix(&key.name).map_or("", |(_, suffix)| suffix);
        let key = Key { name: format_smolstr!("{name}_{suffix}"), span: key.span };
        entries.push((key, value.clone()));
    }
}
