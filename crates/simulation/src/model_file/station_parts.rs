//! The parts of stations in which the water of the grid passes the unit.

use super::expand::{Part, Plain};
use super::{InterfaceEntry, SiteEntry};
use crate::document::Tree;
use serde_json::{Value, json};
use smol_str::format_smolstr;

/// What such a station is made of; the trees are entries of other sections.
pub(super) struct Expanded {
    pub nodes: Vec<Plain>,
    pub edges: Vec<Plain>,
    pub interface: InterfaceEntry,
    pub controllers: Vec<Tree>,
    pub sensors: Vec<Tree>,
}

/// Names of the station and what it stands between.
pub(super) struct Names<'a> {
    pub id: String,
    prefix: String,
    site: &'a SiteEntry,
    tree: &'a Tree,
    what: &'a str,
}

impl<'a> Names<'a> {
    pub(super) fn new(name: &str, site: &'a SiteEntry, tree: &'a Tree, what: &'a str) -> Self {
        let id = format!("{}.{name}", site.id);
        let prefix = if name == "station" { site.id.clone() } else { id.clone() };
        Self { id, prefix, site, tree, what }
    }

    pub(super) fn inner(&self, name: &str) -> String {
        format!("{}.{name}", self.prefix)
    }

    pub(super) fn line(&self, line: usize) -> String {
        format!("{}.{}", self.site.id, self.site.lines[line])
    }

    pub(super) fn node(&self, name: &str, water: Option<(f64, f64)>) -> Plain {
        let mut entries =
            vec![("id", json!(self.inner(name))), ("elevation_m", json!(self.site.elevation_m))];
        if let Some((volume_m3, ua_w_k)) = water {
            entries.extend([("volume_m3", json!(volume_m3)), ("ua_w_k", json!(ua_w_k))]);
        }
        Plain {
            tree: Tree::table(self.tree.span, entries),
            owner: (&self.site.id).into(),
            entry: self.what.into(),
        }
    }

    pub(super) fn part(
        &self,
        name: &'static str,
        kind: &'static str,
        ends: (String, String),
        defaults: Value,
    ) -> Plain {
        let fields = match name {
            "stub_hot" | "stub_cold" => "stub",
            "feed_in_shut_off" | "extraction_shut_off" => "shut_off",
            "feed_in_way_in" | "feed_in_way_out" | "extraction_way_in" | "extraction_way_out" => {
                "way"
            }
            own => own,
        };
        let part = Part { name, kind, fields, ends, defaults };
        Plain {
            tree: part.tree(self.tree, &self.prefix),
            owner: (&self.id).into(),
            entry: format_smolstr!("{}, {fields}", self.what),
        }
    }

    /// A table at the place of the station.
    pub(super) fn table(&self, entries: Vec<(&str, Value)>) -> Tree {
        Tree::table(self.tree.span, entries)
    }

    /// The defaults of a part unless the user describes it in another way.
    pub(super) fn unless(&self, part: &str, own: &[&str], defaults: Value) -> Value {
        let fields = self.tree.get(part).into_iter().flat_map(Tree::entries);
        let mut names = fields.map(|(key, _)| key.name.as_str());
        let described = names.any(|name| own.iter().any(|start| name.starts_with(start)));
        if described { json!({}) } else { defaults }
    }
}

/// The published house connection.
pub(super) fn stub() -> Value {
    json!({
        "length_m": 5.0, "inner_diameter_mm": 22.0, "roughness_mm": 0.011, "zeta": 1.75,
        "insulation_resistance_k_m_w": 3.78
    })
}

/// A PI controller follows its station in steps of this share of its integral time at most.
pub(super) const LONGEST_STEP: f64 = 0.25;

/// How a pump can be described otherwise.
pub(super) const PUMP: &[&str] = &["head_max_", "free_flow_", "curve_"];

/// How a passage can be described otherwise.
pub(super) const RESISTANCE: &[&str] = &["kv_", "dp_nominal_", "m_flow_nominal_", "curve_"];

/// Mixed water on either side of a unit, m3.
pub(super) fn default_volume() -> f64 {
    0.005
}
