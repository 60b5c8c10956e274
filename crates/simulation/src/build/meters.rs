//! What a model measures beside its parts: heat meters with their second sensors, worst points.

use super::Builder;
use crate::diagnostic::did_you_mean;
use crate::plan::{PlannedMeter, WorstPoint};
use crate::wording::refused;
use anergy_network::elements::ElementParams;
use std::collections::HashMap;

impl Builder<'_> {
    /// The heat meters, in the order of their edges.
    pub(super) fn meters(&mut self, node_ids: &HashMap<&str, usize>) -> Vec<PlannedMeter> {
        let mut meters = Vec::new();
        for (edge, spec) in self.model.edges.iter().enumerate() {
            let ElementParams::HeatMeter(params) = &spec.params else { continue };
            let what = format!("edge \"{}\" (heat_meter)", spec.id);
            let (field, name) = match (&params.return_node, &params.supply_node) {
                (Some(name), None) => ("return_node", name),
                (None, Some(name)) => ("supply_node", name),
                (given, _) => {
                    let field = given.is_some().then_some("supply_node");
                    let message = "give either return_node (flow sensor in the supply) or supply_node \
                                   (flow sensor in the return)";
                    self.problems.push(refused(&what, &spec.place, field, message));
                    continue;
                }
            };
            let Some(&other_node) = node_ids.get(name.as_str()) else {
                let hint = did_you_mean(name, node_ids.keys().copied());
                let message = format!("{what}: {field} names no node: \"{name}\"");
                self.report(message, spec.place.of(field), hint);
                continue;
            };
            meters.push(PlannedMeter { edge, other_node, in_supply: field == "return_node" });
        }
        meters
    }

    /// The pairs of nodes whose smallest pressure difference is of interest.
    pub(super) fn worst_points(&mut self, node_ids: &HashMap<&str, usize>) -> Vec<WorstPoint> {
        let mut points = Vec::new();
        for spec in &self.model.worst_points {
            let mut find = |name: &str| {
                let found = node_ids.get(name).copied();
                if found.is_none() {
                    let what = format!("worst_point \"{}\"", spec.entry.id);
                    let hint = did_you_mean(name, node_ids.keys().copied());
                    let message = format!("{what}: between names no node: \"{name}\"");
                    self.report(message, spec.place.of("between"), hint);
                }
                found
            };
            let pairs = spec.entry.between.iter();
            let between = pairs.filter_map(|(a, b)| find(a).zip(find(b))).collect();
            points.push(WorstPoint { name: spec.entry.id.clone(), between });
        }
        points
    }
}
