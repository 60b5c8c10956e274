//! Plants, and what they hold.

use super::{ModelReader, Stations, place};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::Tree;
use crate::model::{InterfaceSpec, Place, WorstPointSpec};
use crate::model_file::plant::{self, DpAt, PlantEntry};
use crate::model_file::{StationKind, WorstPointEntry};
use crate::wording::refused;

impl ModelReader<'_> {
    /// Expands a plant; `None` after a report.
    pub(super) fn plant(
        &mut self,
        tree: &Tree,
        what: &str,
        stations: &mut Stations,
        interfaces: &mut Vec<InterfaceSpec>,
    ) -> Option<()> {
        let (entry, table) = self.reader.read::<PlantEntry>(what, tree)?;
        let site = self.site_with_two_lines(what, tree)?;
        self.check_parts(what, StationKind::Plant, tree)?;
        let place = place(what, tree, &table);
        self.check_plant(&entry, what, tree, &place)?;
        let plant = plant::plant(&entry, &site, tree, what);
        stations.add(self, &plant.interface, what, tree)?;
        self.add_nodes(plant.nodes);
        self.add_edges(plant.edges);
        interfaces.push(InterfaceSpec { entry: plant.interface, place: place.clone() });
        self.rows.entry("unit").or_default().push(plant.unit);
        self.rows.entry("pressure_reference").or_default().extend(plant.reference);
        if let (DpAt::WorstConsumer, Some(dp_pa)) = (entry.dp_at, entry.dp_pa) {
            self.holding.push((entry, dp_pa, tree.clone(), place));
        }
        Some(())
    }

    /// What the plant says must not contradict itself.
    fn check_plant(
        &mut self,
        entry: &PlantEntry,
        what: &str,
        tree: &Tree,
        place: &Place,
    ) -> Option<()> {
        let before = self.reader.problems.len();
        let mut wrong = |field: &str, message: String, hint: &str| {
            self.reader.report(refused(what, place, Some(field), &message).with_hint(hint));
        };
        match entry.dp_pa {
            Some(dp_pa) if dp_pa <= 0.0 => {
                let hint = "leave it out for a pump that runs at its own speed";
                wrong("dp_pa", format!("dp_pa = {dp_pa} must be positive"), hint);
            }
            Some(_) => {
                let pump = tree.get("circulation_pump").into_iter().flat_map(Tree::entries);
                let own = pump.map(|(key, _)| key).find(|key| {
                    let name = key.name.as_str();
                    ["mode", "speed", "initial_speed", "speed_min"].contains(&name)
                        || (name.starts_with("head_") && !name.starts_with("head_max_"))
                        || name.starts_with("m_flow_set_")
                });
                if let Some(key) = own {
                    let message = format!(
                        "{what}, circulation_pump: {} is given beside the plant's pressure difference",
                        key.name
                    );
                    let problem = Diagnostic::new(message, key.span.range());
                    self.reader.report(
                        problem.with_hint("take it out: the pump holds what the plant needs"),
                    );
                }
            }
            None => {
                for (field, given) in [
                    ("dp_at", entry.dp_at == DpAt::WorstConsumer),
                    ("consumers", entry.consumers.is_some()),
                ] {
                    if given {
                        let hint = "say how much with dp_bar (dp_pa)";
                        wrong(field, format!("{field} is given, but no pressure difference"), hint);
                    }
                }
            }
        }
        let mut wrong = |field: &str, message: String, hint: &str| {
            self.reader.report(refused(what, place, Some(field), &message).with_hint(hint));
        };
        if entry.consumers.is_some() && entry.dp_pa.is_some() && entry.dp_at == DpAt::Plant {
            let hint = "write dp_at = \"worst_consumer\", or take the list out";
            wrong("consumers", "consumers has no effect at dp_at = \"plant\"".into(), hint);
        }
        match (entry.supply_k.is_some(), !entry.outdoor_curve_k.is_empty()) {
            (false, false) => {
                let hint = "write supply_degc = 80, or outdoor_curve_degc = [[-12, 90], [15, 70]]";
                wrong("kind", "the supply temperature is missing".into(), hint);
            }
            (true, true) => {
                let message = "a fixed supply temperature and an outdoor curve are both given";
                wrong("outdoor_curve_k", message.into(), "take one of the two out");
            }
            _ => {}
        }
        if entry.dp_integral_time_s <= 0.0 {
            let message =
                format!("dp_integral_time_s = {} must be positive", entry.dp_integral_time_s);
            wrong("dp_integral_time_s", message, "60 s suit most networks");
        }
        (self.reader.problems.len() == before).then_some(())
    }

    /// The worst points of the plants that hold one, now that all stations are known.
    pub(super) fn hold_worst_consumers(&mut self, stations: &Stations) {
        for (i, (entry, dp_pa, tree, place)) in
            std::mem::take(&mut self.holding).into_iter().enumerate()
        {
            let what = place.entry.clone();
            if i > 0 {
                let message = "dp_at: another plant holds the worst consumer already";
                let problem = refused(&what, &place, Some("dp_at"), message);
                self.reader
                    .report(problem.with_hint("let all plants but one hold dp_at = \"plant\""));
                continue;
            }
            let ids: Vec<String> = match &entry.consumers {
                Some(ids) => ids.clone(),
                None => stations.consumers.iter().map(|(id, _)| id.clone()).collect(),
            };
            let mut between = Vec::with_capacity(ids.len());
            for id in &ids {
                if let Some((_, ends)) = stations.consumers.iter().find(|(known, _)| known == id) {
                    between.push(ends.clone());
                } else if !stations.wrong.contains(id) {
                    let known = stations.consumers.iter().map(|(id, _)| id.as_str());
                    let hint = did_you_mean(id, known)
                        .unwrap_or_else(|| "consumers are named like \"c12.station\"".into());
                    let message = format!("consumers: there is no consumer station \"{id}\"");
                    let problem = refused(&what, &place, Some("consumers"), &message);
                    self.reader.report(problem.with_hint(hint));
                }
            }
            if between.is_empty() && ids.is_empty() {
                let message = "dp_at: there is no consumer whose pressure difference could be held";
                let problem = refused(&what, &place, Some("dp_at"), message);
                self.reader.report(problem.with_hint("add a [[station]] with kind = \"consumer\""));
                continue;
            }
            if between.len() < ids.len() {
                continue;
            }
            let (point, controller) = plant::worst_point(&entry, dp_pa, &between, &tree);
            self.rows.entry("worst_point").or_default().push(point);
            self.rows.entry("controller").or_default().push(controller);
        }
    }

    pub(super) fn worst_points(&mut self) -> Vec<WorstPointSpec> {
        let items = self.items("worst_point");
        items
            .iter()
            .filter_map(|tree| {
                let what = format!("worst_point \"{}\"", tree.text("id").unwrap_or("?"));
                let (entry, table) = self.reader.read::<WorstPointEntry>(&what, tree)?;
                let place = place(&what, tree, &table);
                for (field, empty) in
                    [("id", entry.id.is_empty()), ("between", entry.between.is_empty())]
                {
                    if empty {
                        let message = format!("{field} is empty");
                        self.reader.report(refused(&what, &place, Some(field), &message));
                    }
                }
                Some(WorstPointSpec { entry, place })
            })
            .collect()
    }
}
