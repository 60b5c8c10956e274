//! Composites become plain nodes and edges: sites, trenches, stations.
//!
//! A trench gives a pipe per line that its two sites share. A station gives its published hydraulics
//! between the hot and the cold node of its site:
//!
//! ```text
//! hot --stub_hot-- exchanger_hot --heat_exchanger-- exchanger_cold --+-- extraction_valve --+
//!                                                                    |                      |
//!                                          feed_in_check_valve -- pump_outlet -- feed_in_pump
//!                                                                                           |
//! cold --------------------------------------stub_cold------------------------------ branch_cold
//! ```
//! An `extraction_check_valve` stands between the extraction valve and `branch_cold` where it is asked for.
//! `stub_hot`, `heat_exchanger`, `feed_in_pump` and `feed_in_check_valve` have port a towards the cold
//! side (positive flow is feed-in), `extraction_valve` and `stub_cold` towards the hot side.

use super::{InterfaceEntry, SiteEntry, StationEntry, StationKind};
use crate::document::Span;
use crate::document::{Key, Tree, TreeKind};
use serde_json::{Value, json};
use smol_str::{SmolStr, format_smolstr};

/// A node or edge to be read, and what it belongs to.
#[derive(Debug, Clone)]
pub(super) struct Plain {
    /// The entry as a table.
    pub tree: Tree,
    /// Its site (nodes) or station (edges); empty for none.
    pub owner: SmolStr,
    /// What the user wrote where that is a composite, for messages: `trench "a-b"`; empty for others.
    pub entry: SmolStr,
}

impl Plain {
    /// The composite, or `otherwise` where the user wrote this entry.
    pub(super) fn entry_or<'a>(&'a self, otherwise: &'a str) -> &'a str {
        if self.entry.is_empty() { otherwise } else { &self.entry }
    }
}

/// The nodes of a site.
pub(super) fn site_nodes(site: &SiteEntry, span: Span) -> Vec<Plain> {
    site.lines
        .iter()
        .map(|line| {
            let mut entries = vec![
                ("id", json!(format!("{}.{line}", site.id))),
                ("elevation_m", json!(site.elevation_m)),
            ];
            entries.extend(site.x_m.map(|x| ("x_m", json!(x))));
            entries.extend(site.y_m.map(|y| ("y_m", json!(y))));
            Plain {
                tree: Tree::table(span, entries),
                owner: (&site.id).into(),
                entry: format_smolstr!("site \"{}\"", site.id),
            }
        })
        .collect()
}

/// The pipes of a trench; `fields` are those of a pipe, with their places. Two pipes are companions, which
/// holds where they have a spacing.
pub(super) fn trench_pipes(
    id: &str,
    (from, to): (&SiteEntry, &SiteEntry),
    fields: &Tree,
) -> Vec<Plain> {
    let lines: Vec<&String> = from.lines.iter().filter(|line| to.lines.contains(line)).collect();
    lines
        .iter()
        .map(|line| {
            let mut entries = vec![
                ("id", json!(format!("{id}.{line}"))),
                ("kind", json!("pipe")),
                ("from", json!(format!("{}.{line}", from.id))),
                ("to", json!(format!("{}.{line}", to.id))),
            ];
            if let [first, second] = lines.as_slice()
                && line == first
            {
                entries.push(("companion", json!(format!("{id}.{second}"))));
            }
            let mut tree = Tree::table(fields.span, entries);
            tree.fill_from(fields);
            Plain { tree, owner: SmolStr::default(), entry: format_smolstr!("trench \"{id}\"") }
        })
        .collect()
}

/// The parts that a station can have, and how each is written.
pub(super) const PARTS: &[(&str, &str)] = &[
    ("stub", "{ length_m = 5, inner_diameter_mm = 22 }"),
    ("heat_exchanger", "{ ua_w_k = 3000 }"),
    ("feed_in_pump", "{ speed = 1.0 }"),
    ("feed_in_check_valve", "{ kvs_m3_h = 11 }"),
    ("extraction_valve", "{ opening = 0.5 }"),
    ("extraction_check_valve", "{ kvs_m3_h = 11 }"),
    ("extraction_pump", "{ head_max_bar = 0.4, free_flow_l_min = 55 }"),
    ("pump", "{ head_max_bar = 0.4, free_flow_l_min = 55 }"),
    ("check_valve", "{ kvs_m3_h = 11 }"),
    ("way", "{ kvs_m3_h = 15 }"),
    ("interface", "{ kv_m3_h = 4 }"),
    ("shut_off", "{ kvs_m3_h = 11 }"),
    ("circulation_pump", "{ head_max_bar = 5, free_flow_m3_h = 60 }"),
    ("generator", "{ dp_nominal_bar = 0.2, m_flow_nominal_kg_s = 10 }"),
];

/// What a part of a station is in the registry of elements.
pub(super) fn part_kind(part: &str) -> Option<&'static str> {
    match part {
        "stub" => Some("pipe"),
        "heat_exchanger" => Some("heat_exchanger"),
        "feed_in_pump" => Some("pump"),
        "feed_in_check_valve" | "extraction_check_valve" | "check_valve" => Some("check_valve"),
        "extraction_valve" | "way" => Some("valve"),
        "circulation_pump" | "extraction_pump" | "pump" => Some("pump"),
        "shut_off" => Some("ball_valve"),
        "generator" | "interface" => Some("resistance"),
        _ => None,
    }
}

/// The parts of a kind of station.
pub(super) fn parts_of(kind: StationKind) -> &'static [&'static str] {
    match kind {
        StationKind::Bidirectional => &[
            "stub",
            "heat_exchanger",
            "feed_in_pump",
            "feed_in_check_valve",
            "extraction_valve",
            "extraction_check_valve",
        ],
        StationKind::Consumer => &["stub", "heat_exchanger", "extraction_valve"],
        StationKind::Producer => &["stub", "heat_exchanger", "feed_in_pump", "feed_in_check_valve"],
        StationKind::PrescribedFlow => &[],
        StationKind::Plant => &["circulation_pump", "generator"],
        StationKind::Prosumer => &[
            "stub",
            "interface",
            "feed_in_pump",
            "feed_in_check_valve",
            "extraction_pump",
            "extraction_check_valve",
            "extraction_valve",
            "shut_off",
            "pump",
            "check_valve",
            "way",
        ],
        StationKind::BalancingUnit => &["stub", "interface", "pump"],
    }
}

/// A station's entry in messages.
pub(super) fn station_in_words(tree: &Tree) -> String {
    let site = tree.text("site").unwrap_or("?");
    match tree.text("name") {
        Some(name) if name != "station" => format!("station \"{name}\" at \"{site}\""),
        _ => format!("station at \"{site}\""),
    }
}

/// A part of a station: its name, kind, ends and the defaults of the published station.
pub(super) struct Part {
    pub name: &'static str,
    pub kind: &'static str,
    pub fields: &'static str,
    pub ends: (String, String),
    pub defaults: Value,
}

/// The nodes, edges and interface of a station; `tree` is its entry, with places.
pub(super) fn station(
    station: &StationEntry,
    site: &SiteEntry,
    tree: &Tree,
) -> (Vec<Plain>, Vec<Plain>, InterfaceEntry) {
    let id = format!("{}.{}", site.id, station.name);
    let prefix = if station.name == "station" { site.id.clone() } else { id.clone() };
    let inner = |name: &str| format!("{prefix}.{name}");
    let hot = format!("{}.{}", site.id, site.lines[0]);
    let cold = format!("{}.{}", site.id, site.lines[1]);
    let has = |part: &str| parts_of(station.kind).contains(&part);
    let (feeds_in, extracts) = (has("feed_in_pump"), has("extraction_valve"));
    let what = station_in_words(tree);
    let mut parts = Vec::new();
    let mut inner_nodes = Vec::new();
    if station.kind == StationKind::PrescribedFlow {
        parts.push(Part {
            name: "flow_source",
            kind: "flow_source",
            fields: "",
            ends: (cold, hot),
            defaults: json!({}),
        });
    } else {
        inner_nodes.extend(["exchanger_hot", "exchanger_cold", "branch_cold"]);
        let stub = json!({
            "length_m": 5.0, "inner_diameter_mm": 22.0, "roughness_mm": 0.011, "zeta": 1.75,
            "insulation_resistance_k_m_w": 3.78
        });
        parts.push(Part {
            name: "stub_hot",
            kind: "pipe",
            fields: "stub",
            ends: (inner("exchanger_hot"), hot),
            defaults: stub.clone(),
        });
        parts.push(Part {
            name: "heat_exchanger",
            kind: "heat_exchanger",
            fields: "heat_exchanger",
            ends: (inner("exchanger_cold"), inner("exchanger_hot")),
            defaults: json!({}),
        });
        if feeds_in {
            inner_nodes.push("pump_outlet");
            parts.push(Part {
                name: "feed_in_pump",
                kind: "pump",
                fields: "feed_in_pump",
                ends: (inner("branch_cold"), inner("pump_outlet")),
                defaults: if has_own_curve(tree) {
                    json!({})
                } else {
                    json!({ "head_max_hpa": 402.21, "free_flow_l_min": 55.33 })
                },
            });
            parts.push(Part {
                name: "feed_in_check_valve",
                kind: "check_valve",
                fields: "feed_in_check_valve",
                ends: (inner("pump_outlet"), inner("exchanger_cold")),
                defaults: json!({ "kvs_m3_h": 11.0, "leakage": 1e-3 }),
            });
        }
        if extracts {
            let commanded = ["opening", "kappa"]
                .iter()
                .any(|name| tree.get("extraction_valve").is_some_and(|v| v.get(name).is_some()));
            let by_kappa =
                tree.get("extraction_valve").and_then(|v| v.text("command")) == Some("kappa");
            let mut defaults = json!({ "kvs_m3_h": 2.5, "leakage": 2e-3 });
            if !commanded {
                // A feeder's extraction valve is closed until it is told otherwise.
                let start = if feeds_in { 0.0 } else { 1.0 };
                defaults[if by_kappa { "kappa" } else { "opening" }] = json!(start);
            }
            let checked = tree.get("extraction_check_valve").is_some();
            let behind = if checked { "valve_outlet" } else { "branch_cold" };
            parts.push(Part {
                name: "extraction_valve",
                kind: "valve",
                fields: "extraction_valve",
                ends: (inner("exchanger_cold"), inner(behind)),
                defaults,
            });
            if checked {
                inner_nodes.push(behind);
                parts.push(Part {
                    name: "extraction_check_valve",
                    kind: "check_valve",
                    fields: "extraction_check_valve",
                    ends: (inner(behind), inner("branch_cold")),
                    defaults: json!({ "kvs_m3_h": 11.0, "leakage": 1e-3 }),
                });
            }
        }
        parts.push(Part {
            name: "stub_cold",
            kind: "pipe",
            fields: "stub",
            ends: (inner("branch_cold"), cold),
            defaults: stub,
        });
    }
    let nodes = inner_nodes
        .iter()
        .map(|name| Plain {
            tree: Tree::table(
                tree.span,
                vec![("id", json!(inner(name))), ("elevation_m", json!(site.elevation_m))],
            ),
            owner: (&site.id).into(),
            entry: (&what).into(),
        })
        .collect();
    let edges = parts
        .iter()
        .map(|part| Plain {
            tree: part.tree(tree, &prefix),
            owner: (&id).into(),
            entry: match part.fields {
                "" => (&what).into(),
                fields => format_smolstr!("{what}, {fields}"),
            },
        })
        .collect();
    let interface = InterfaceEntry {
        edge: inner(if parts.len() == 1 { "flow_source" } else { "heat_exchanger" }),
        pump: feeds_in.then(|| inner("feed_in_pump")),
        valve: extracts.then(|| inner("extraction_valve")),
        requested_flow_m3_s: station.requested_flow_m3_s,
        ..InterfaceEntry::watching(id)
    };
    (nodes, edges, interface)
}

/// Whether the station's pump brings its own curve, so that the published one is not its default.
fn has_own_curve(tree: &Tree) -> bool {
    tree.get("feed_in_pump").is_some_and(|pump| {
        pump.entries().iter().any(|(key, _)| {
            ["head_max_", "free_flow_", "curve_"].iter().any(|start| key.name.starts_with(start))
        })
    })
}

impl Part {
    /// The part as an edge entry: what the station's entry says, then the defaults.
    pub(super) fn tree(&self, station: &Tree, prefix: &str) -> Tree {
        let mut tree = Tree::table(
            station.span,
            vec![
                ("id", json!(format!("{prefix}.{}", self.name))),
                ("kind", json!(self.kind)),
                ("from", json!(self.ends.0)),
                ("to", json!(self.ends.1)),
            ],
        );
        if self.name == "stub_hot"
            && let TreeKind::Table(entries) = &mut tree.kind
        {
            let stub_cold = Tree::from_json(&json!(format!("{prefix}.stub_cold")), Span::NONE);
            let key = Key { name: "companion".into(), span: Span::NONE };
            entries.push((key, stub_cold));
        }
        let own = station.get(self.fields);
        // What is no table has been reported.
        if let Some(own) = own {
            tree.fill_from(own);
        }
        let defaults = Tree::from_json(&self.defaults, station.span);
        fill_quantities(&mut tree, &defaults, own.is_some_and(|own| own.get("pipe").is_some()));
        tree
    }
}

/// Adds defaults for quantities that are not given in any unit. With a named pipe type only the length
/// and the fittings of the published stub remain.
fn fill_quantities(tree: &mut Tree, defaults: &Tree, typed: bool) {
    let stem = |name: &str| {
        anergy_core::units::split_suffix(name).map_or(name.to_owned(), |(stem, _)| stem.to_owned())
    };
    let given: Vec<String> = tree.entries().iter().map(|(key, _)| stem(&key.name)).collect();
    if let TreeKind::Table(entries) = &mut tree.kind {
        for (key, value) in defaults.entries() {
            let quantity = stem(&key.name);
            let layered =
                quantity == "insulation_resistance" && given.iter().any(|q| q == "laying");
            let kept = (!typed && !layered) || quantity == "length" || quantity == "zeta";
            if kept && !given.contains(&quantity) {
                entries.push((key.clone(), value.clone()));
            }
        }
    }
}
