//! Pressure holding of a model: expansion vessels and limits.

use super::Builder;
use super::network::below_vacuum;
use crate::model::Place;
use crate::plan::{Limit, PressureWatch};
use crate::wording::refused;
use anergy_core::ids::NodeId;
use anergy_network::graph::Network;
use anergy_network::holding::Vessel;
use std::collections::HashMap;

impl Builder<'_> {
    /// The vessels, in the order of the pressure references.
    pub(super) fn vessels(
        &mut self,
        network: &Network,
        node_ids: &HashMap<&str, usize>,
    ) -> Vec<Vessel> {
        let mut vessels = Vec::new();
        for spec in &self.model.references {
            let entry = &spec.entry;
            let (volume_m3, precharge_pa) =
                match (entry.vessel_volume_m3, entry.vessel_precharge_pa) {
                    (None, None) => continue,
                    (Some(volume), Some(precharge)) => (volume, precharge),
                    (given, _) => {
                        let (is, lacks) = if given.is_some() {
                            ("vessel_volume_m3", "vessel_precharge_pa")
                        } else {
                            ("vessel_precharge_pa", "vessel_volume_m3")
                        };
                        let message = format!("{is} is given, but not {lacks}");
                        self.refuse_reference(&spec.place, is, &message);
                        continue;
                    }
                };
            if volume_m3 <= 0.0 {
                let message = format!("vessel_volume_m3 = {volume_m3} must be positive");
                self.refuse_reference(&spec.place, "vessel_volume_m3", &message);
            }
            if !(-0.9e5..=entry.pressure_pa).contains(&precharge_pa) {
                let message = format!(
                    "vessel_precharge_pa = {precharge_pa} must be above a vacuum and not above the \
                     pressure at the start, else the vessel holds no water"
                );
                self.refuse_reference(&spec.place, "vessel_precharge_pa", &message);
            }
            if let Some(&node) = node_ids.get(entry.node.as_str()) {
                let node = NodeId::from_index(node);
                let start_pa = entry.pressure_pa;
                vessels.push(Vessel::new(network, node, volume_m3, precharge_pa, start_pa));
            }
        }
        vessels
    }

    fn refuse_reference(&mut self, place: &Place, field: &str, message: &str) {
        self.problems.push(refused("pressure_reference", place, Some(field), message));
    }

    /// What is watched: limits of nodes, of circuits, and vessels that may run empty.
    pub(super) fn pressure_watches(
        &mut self,
        network: &Network,
        node_ids: &HashMap<&str, usize>,
    ) -> Vec<PressureWatch> {
        let mut watches = Vec::new();
        for (i, spec) in self.model.nodes.iter().enumerate() {
            let limits = (spec.entry.min_pressure_pa, spec.entry.max_pressure_pa);
            let what = format!("node \"{}\"", spec.entry.id);
            self.watch(&mut watches, limits, || vec![i], (&what, &spec.place));
        }
        for spec in &self.model.references {
            let Some(&node) = node_ids.get(spec.entry.node.as_str()) else { continue };
            let limits = (spec.entry.min_pressure_pa, spec.entry.max_pressure_pa);
            let circuit = || {
                let here = NodeId::from_index(node);
                let circuit = network.circuits().into_iter().find(|nodes| nodes.contains(&here));
                circuit.unwrap_or_default().iter().map(|node| node.index()).collect()
            };
            self.watch(&mut watches, limits, circuit, ("pressure_reference", &spec.place));
            let vessel = spec.entry.vessel_volume_m3.and(spec.entry.vessel_precharge_pa);
            if let Some(limit_pa) = vessel {
                let limit = Limit::VesselEmpty;
                watches.push(PressureWatch { nodes: vec![node], limit_pa, limit });
            }
        }
        watches
    }

    fn watch(
        &mut self,
        watches: &mut Vec<PressureWatch>,
        (min, max): (Option<f64>, Option<f64>),
        nodes: impl Fn() -> Vec<usize>,
        (what, place): (&str, &Place),
    ) {
        if let Some(limit_pa) = min {
            let problem = below_vacuum(what, "min_pressure_pa", limit_pa, place);
            self.problems.extend(problem);
            watches.push(PressureWatch { nodes: nodes(), limit_pa, limit: Limit::Low });
        }
        if let Some(limit_pa) = max {
            watches.push(PressureWatch { nodes: nodes(), limit_pa, limit: Limit::High });
            if min.is_some_and(|min_pa| min_pa >= limit_pa) {
                let message =
                    format!("max_pressure_pa = {limit_pa} must be above the smallest one");
                self.problems.push(refused(what, place, Some("max_pressure_pa"), &message));
            }
        }
    }
}
