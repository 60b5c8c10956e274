//! Stations: the edges they watch and drive.

use super::Builder;
use super::signals::Writer;
use super::units::Houses;
use crate::diagnostic::did_you_mean;
use crate::plan::PlannedDrive;
use crate::wording::refused;
use anergy_core::clock::Time;
use anergy_core::ids::{EdgeId, SignalId};
use anergy_core::signal::{SignalSpec, SignalTable};
use anergy_network::interface::{Drive, Station};
use smol_str::SmolStr;
use std::collections::HashMap;

impl Builder<'_> {
    pub(super) fn stations(&mut self, edge_ids: &HashMap<&str, usize>) -> Vec<Station> {
        let mut stations = Vec::new();
        for spec in &self.model.interfaces {
            let what = format!("interface \"{}\"", spec.entry.id);
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
            let edge = find("edge", &spec.entry.edge);
            let pump = spec.entry.pump.as_deref().and_then(|name| find("pump", name));
            let extraction = spec.entry.extraction_pump.as_deref();
            let extraction_pump = extraction.and_then(|name| find("extraction_pump", name));
            let valve = spec.entry.valve.as_deref().and_then(|name| find("valve", name));
            if let Some(flow) = spec.entry.requested_flow_m3_s.filter(|flow| *flow <= 0.0) {
                let field = "requested_flow_m3_s";
                let message = format!("{field} = {flow} must be positive");
                self.problems.push(refused(what, &spec.place, Some(field), &message));
            }
            if let Some(edge) = edge {
                stations.push(Station {
                    edge: EdgeId::from_index(edge),
                    pump: pump.map(EdgeId::from_index),
                    valve: valve.map(EdgeId::from_index),
                    extraction_pump: extraction_pump.map(EdgeId::from_index),
                    requested_m_flow_kg_s: spec
                        .entry
                        .requested_flow_m3_s
                        .map(|flow| flow * self.model.medium.density_kg_m3),
                });
            }
        }
        stations
    }

    /// Stations that are told what the unit on their edge wants.
    pub(super) fn drives(
        &mut self,
        houses: &Houses,
        stations: &[Station],
        signals: &mut SignalTable,
        writers: &mut HashMap<SignalId, Writer>,
    ) -> Vec<PlannedDrive> {
        let mut drives = Vec::new();
        let model = self.model;
        for (station, spec) in model.interfaces.iter().enumerate() {
            let entry = &spec.entry;
            let what = format!("interface \"{}\"", entry.id);
            let what = SmolStr::from(spec.place.entry_or(&what));
            if entry.feed_in_set.is_none() && entry.extraction_set.is_none() {
                continue;
            }
            if !(entry.dead_time_s.is_finite() && entry.dead_time_s >= 0.0) {
                let message = format!("dead_time_s = {} must not be negative", entry.dead_time_s);
                let problem = refused(&what, &spec.place, Some("dead_time_s"), &message);
                self.problems.push(problem);
            }
            let mut set = |field: &str, name: &Option<String>| {
                let name = name.as_deref()?;
                let Some(signal) = signals.find(name) else {
                    let names = signals.specs().iter().map(|signal| signal.name.as_str());
                    let hint = did_you_mean(name, names);
                    let message = format!("{what}: {field} names no signal: \"{name}\"");
                    self.report(message, spec.place.of(field), hint);
                    return None;
                };
                self.claim(writers, signal, signals, &what, spec.place.of(field));
                Some(signal)
            };
            let feed_in = set("feed_in_set", &entry.feed_in_set);
            // One pump for both directions has one signal.
            let shared = entry.feed_in_set.is_some() && entry.feed_in_set == entry.extraction_set;
            let extraction =
                if shared { feed_in } else { set("extraction_set", &entry.extraction_set) };
            let feed_in_open = set("feed_in_open", &entry.feed_in_open);
            let extraction_open = set("extraction_open", &entry.extraction_open);
            // Without all edges there are not all stations: what is missing has been reported.
            let Some(edge) = stations.get(station).map(|station| station.edge) else { continue };
            let Some(port) = houses.edges.iter().position(|port| *port == edge) else {
                if !houses.circuits_whole {
                    continue;
                }
                let message = format!("{what}: no unit asks it for a flow");
                let hint =
                    "add a [[unit]] at its site, for example a booster_heat_pump or a heat_load";
                self.report(message, spec.place.span.range(), Some(hint.into()));
                continue;
            };
            let participation = SignalSpec {
                name: format!("{}.participation", entry.id).into(),
                unit: "",
                initial: 1.0,
                min: 0.0,
                max: 1.0,
            };
            let participation = self.add_signal(signals, participation, &spec.place);
            let drive = Drive { dead_time_s: entry.dead_time_s };
            drives.push(PlannedDrive {
                station,
                port,
                feed_in,
                extraction,
                feed_in_open,
                extraction_open,
                participation,
                drive,
                longest_step: entry.longest_step_s.and_then(Time::from_s),
            });
        }
        drives
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
