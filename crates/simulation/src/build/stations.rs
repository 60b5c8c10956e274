//! Stations: the edges they watch and drive.

use super::Builder;
use crate::diagnostic::did_you_mean;
use crate::wording::refused;
use anergy_core::ids::EdgeId;
use anergy_network::interface::Station;
use std::collections::HashMap;

impl Builder<'_> {
    pub(super) fn stations(&mut self, edge_ids: &HashMap<&str, usize>) -> Vec<Station> {
        let mut stations = Vec::new();
        for spec in &self.model.interfaces {
            let what = format!("interface \"{}\"", spec.id);
            let what = spec.place.entry_or(&what);
            let mut find = |field: &str, name: &str| {
                let found = edge_ids.get(name).copied();
                if found.is_none() {
                    let hint = did_you_mean(name, edge_ids.keys().copied());
                    let message = format!("{what}: {field} names no edge: \"{name}\"");
                    self.report(message, spec.place.of(field), hint);
                }
                found
            };
            let edge = find("edge", &spec.edge);
            let pump = spec.pump.as_deref().and_then(|name| find("pump", name));
            let valve = spec.valve.as_deref().and_then(|name| find("valve", name));
            if let Some(flow) = spec.requested_flow_m3_s.filter(|flow| *flow <= 0.0) {
                let field = "requested_flow_m3_s";
                let message = format!("{field} = {flow} must be positive");
                self.problems.push(refused(what, &spec.place, Some(field), &message));
            }
            if let Some(edge) = edge {
                stations.push(Station {
                    edge: EdgeId::from_index(edge),
                    pump: pump.map(EdgeId::from_index),
                    valve: valve.map(EdgeId::from_index),
                    requested_m_flow_kg_s: spec
                        .requested_flow_m3_s
                        .map(|flow| flow * self.model.medium.density_kg_m3),
                });
            }
        }
        stations
    }
}

/// Which edges wait for the pump of which station.
pub(super) fn interlocks(edges: usize, stations: &[Station]) -> Vec<Option<usize>> {
    let mut station_of_valve = vec![None; edges];
    for (i, station) in stations.iter().enumerate() {
        if let (Some(_), Some(valve)) = (station.pump, station.valve) {
            station_of_valve[valve.index()] = Some(i);
        }
    }
    station_of_valve
}
