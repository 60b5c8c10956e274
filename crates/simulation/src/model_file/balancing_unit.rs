//! The station of a balancing unit: it stands between the lines and is passive.
//!
//! ```text
//! cold --stub_cold-- port_cold --interface-- port_hot --stub_hot-- hot
//! ```
//! Positive flow is feed-in, from the cold to the hot line. `port_hot` and `port_cold` hold the water of the
//! interface.

use super::station_parts::{Expanded, Names, RESISTANCE, default_volume, stub};
use super::{InterfaceEntry, SiteEntry, StationKind, is_null, station_name};
use crate::document::Tree;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// `[[station]]` with `kind = "balancing_unit"`: the unit stands between the lines and takes what comes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BalancingUnitEntry {
    /// The site it stands at.
    pub site: String,
    /// `balancing_unit`.
    pub kind: StationKind,
    /// Name within its site; another name than "station" also prefixes its parts.
    #[serde(default = "station_name")]
    pub name: String,
    /// Mixed water on either side of the unit, m3.
    #[serde(default = "default_volume")]
    pub volume_m3: f64,
    /// Heat conductance of the water on either side to the surroundings, W/K.
    #[serde(default)]
    pub ua_w_k: f64,
    /// Both connection pipes, each: fields of a pipe, or `pipe` for a named type.
    #[serde(default, skip_serializing_if = "is_null")]
    pub stub: Value,
    /// The passage through the unit: fields of a resistance.
    #[serde(default, skip_serializing_if = "is_null")]
    pub interface: Value,
}

impl BalancingUnitEntry {
    /// The parts of the station.
    pub(super) fn expand(&self, site: &SiteEntry, tree: &Tree, what: &str) -> Expanded {
        let names = Names::new(&self.name, site, tree, what);
        let water = Some((self.volume_m3, self.ua_w_k));
        let resistance = json!({ "dp_nominal_pa": 500.0, "m_flow_nominal_kg_s": 1.0 });
        let ends = |from: &str, to: String| (names.inner(from), to);
        let edges = vec![
            names.part("stub_hot", "pipe", ends("port_hot", names.line(0)), stub()),
            names.part(
                "interface",
                "resistance",
                ends("port_cold", names.inner("port_hot")),
                names.unless("interface", RESISTANCE, resistance),
            ),
            names.part("stub_cold", "pipe", ends("port_cold", names.line(1)), stub()),
        ];
        let interface = InterfaceEntry {
            edge: names.inner("interface"),
            ..InterfaceEntry::watching(names.id.clone())
        };
        let nodes = vec![names.node("port_hot", water), names.node("port_cold", water)];
        Expanded { nodes, edges, interface, controllers: Vec::new() }
    }
}
