//! The station of a prosumer with one pump for both directions, between two three-way valves:
//!
//! ```text
//! port_cold ---+-- extraction_way_in ---+                             +--- feed_in_way_out ----+--- port_cold
//!              |                        pump_inlet -- pump -- pump_outlet -- check_valve -- valve_inlet
//! branch_cold -+--- feed_in_way_in -----+                             +-- extraction_way_out --+--- branch_cold
//! ```
//! The pump always gives a positive flow; the valves before and behind it choose between `port_cold` and `branch_cold`.
//!
//! **Assumptions** each three-way valve is two valves at a node of the pump that switch in the dead time; both are shut
//! while nothing is asked for, so that an idle house is shut off as with two pumps. Two ways in series resist by default
//! as one shut-off valve of the station with two pumps, `k_vs = 11 sqrt(2)`. **Sources** `zinsmeister2023`.

use super::prosumer_station::{FlowControl, ProsumerEntry};
use super::station_parts::{Expanded, Names};
use super::{InterfaceEntry, expand::Plain};
use serde_json::{Value, json};

impl ProsumerEntry {
    /// The station whose nodes and edges outside of the pump are given; `pump` and `check_valve` are defaults.
    pub(super) fn with_one_pump(
        &self,
        names: &Names<'_>,
        control: FlowControl,
        (mut nodes, mut edges): (Vec<Plain>, Vec<Plain>),
        (pump, check_valve): (Value, Value),
    ) -> Expanded {
        nodes.extend(
            ["pump_inlet", "pump_outlet", "valve_inlet"].map(|name| names.node(name, None)),
        );
        let stroke_time_s = if control == FlowControl::Pi { self.dead_time_s } else { 0.0 };
        for (name, command, from, to) in [
            ("feed_in_way_in", "feed_in_way", "branch_cold", "pump_inlet"),
            ("feed_in_way_out", "feed_in_way", "valve_inlet", "port_cold"),
            ("extraction_way_in", "extraction_way", "port_cold", "pump_inlet"),
            ("extraction_way_out", "extraction_way", "valve_inlet", "branch_cold"),
        ] {
            let defaults = json!({
                "kvs_m3_h": 11.0 * std::f64::consts::SQRT_2, "leakage": 1e-4, "opening": 0.0,
                "characteristic": "linear", "command_of": names.inner(command),
                "switch_at": 0.5, "stroke_time_s": stroke_time_s
            });
            edges.push(names.part(name, "valve", (names.inner(from), names.inner(to)), defaults));
        }
        let ends = (names.inner("pump_inlet"), names.inner("pump_outlet"));
        edges.push(names.part("pump", "pump", ends, pump));
        let ends = (names.inner("pump_outlet"), names.inner("valve_inlet"));
        edges.push(names.part("check_valve", "check_valve", ends, check_valve));
        let (set, controller) = self.flow_set(names, control, "pump", "speed");
        let interface = InterfaceEntry {
            edge: names.inner("interface"),
            pump: Some(names.inner("pump")),
            extraction_pump: Some(names.inner("pump")),
            feed_in_set: Some(set.clone()),
            extraction_set: Some(set),
            feed_in_open: Some(names.inner("feed_in_way.opening")),
            extraction_open: Some(names.inner("extraction_way.opening")),
            dead_time_s: stroke_time_s,
            longest_step_s: self.longest_step_s(control),
            ..InterfaceEntry::watching(names.id.clone())
        };
        Expanded {
            nodes,
            edges,
            interface,
            controllers: controller.into_iter().collect(),
            sensors: Vec::new(),
        }
    }
}
