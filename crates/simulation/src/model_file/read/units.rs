//! Units, and the circuits through their ports.

use super::components::Words;
use super::{ModelReader, Stations, place};
use crate::diagnostic::Diagnostic;
use crate::document::Tree;
use crate::model::{BranchSpec, CircuitSpec, UnitSpec};
use crate::model_file::CircuitEntry;
use anergy_prosumer::equipment::{EquipmentParams, WITHOUT_PORTS};
use smol_str::{SmolStr, format_smolstr};

/// Whether a circuit passes a unit.
fn in_circuit(circuits: &[CircuitSpec], unit: &str) -> bool {
    let passes = |member: &SmolStr| {
        member.strip_prefix(unit).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    circuits.iter().any(|circuit| circuit.through.iter().any(passes))
}

impl ModelReader<'_> {
    pub(super) fn circuits(&mut self) -> Vec<CircuitSpec> {
        let items = self.items("circuit");
        let read = items.iter().filter_map(|tree| {
            let what = format!("circuit \"{}\"", tree.text("id").unwrap_or("?"));
            let (entry, table) = self.reader.read::<CircuitEntry>(&what, tree)?;
            let place = place(&what, tree, &table);
            if entry.id.is_empty() {
                let problem = Diagnostic::new("circuit: id is empty", place.of("id"));
                self.reader.report(problem.with_hint("give it a name"));
                return None;
            }
            if let Some(field) = entry.misplaced() {
                let message = format!("{what}: `{field}` is of a branch between two points");
                let hint = "give both from and to, such as from = \"return\" and to = \"supply\"";
                let problem = Diagnostic::new(message, place.of(field));
                self.reader.report(problem.with_hint(hint));
            }
            let whole = |name: &str| match &entry.site {
                Some(site) => format_smolstr!("{site}.{name}"),
                None => name.into(),
            };
            Some(CircuitSpec {
                id: whole(&entry.id),
                through: entry.through.iter().map(|name| whole(name)).collect(),
                v_flow_m3_s: entry.v_flow_m3_s,
                branch: entry.from.as_deref().zip(entry.to.as_deref()).map(|(from, to)| {
                    BranchSpec {
                        from: whole(from),
                        to: whole(to),
                        resistance: entry.resistance,
                        idle_opening: entry.idle_opening.unwrap_or(0.0),
                        suction: entry.suction.unwrap_or(0.0),
                        throttled: entry.throttled.unwrap_or(true),
                        check_valve: entry.check_valve.unwrap_or(false),
                    }
                }),
                place,
            })
        });
        read.collect()
    }

    pub(super) fn units(&mut self, stations: &Stations, circuits: &[CircuitSpec]) -> Vec<UnitSpec> {
        self.maps = self.heat_pump_maps();
        let items = self.items("unit");
        items.into_iter().filter_map(|tree| self.unit(tree, stations, circuits)).collect()
    }

    fn unit(
        &mut self,
        tree: Tree,
        stations: &Stations,
        circuits: &[CircuitSpec],
    ) -> Option<UnitSpec> {
        let mut words = Words::new("unit", tree);
        let given = |name: &str| words.tree.get(name).is_some();
        let nowhere = !given("site") && !given("id") && !given("port");
        let of_site = given("site");
        if nowhere {
            let hint = "write site = \"...\" to stand behind the station of a site, or id and port \
                        (a heat_exchanger or flow_source) to stand on an edge";
            let problem =
                Diagnostic::new("unit: it is not said where it stands", words.tree.span.range());
            self.reader.report(problem.with_hint(hint));
            return None;
        }
        if let Some(field) = ["id", "port"].into_iter().find(|field| of_site && given(field)) {
            let span = words.tree.get(field).and_then(|tree| tree.span.range());
            let problem = Diagnostic::new(format!("unit: site and {field} are both given"), span);
            let hint = "a unit of a site is told from others by `name`; id and port are for a unit \
                        that stands on an edge";
            self.reader.report(problem.with_hint(hint));
            return None;
        }
        // No water passes it: it needs neither circuit nor station.
        let dry = words.tree.text("kind").is_some_and(|kind| WITHOUT_PORTS.contains(&kind));
        let (id, port) = if of_site {
            let site = self.required_text(&mut words, "site")?;
            let name = self.text_or(&mut words, "name", "unit");
            let named = words.tree.get("station").is_some();
            let station = self.text_or(&mut words, "station", "station");
            let wanted = format!("{site}.{station}");
            let id = format!("{site}.{name}");
            let edge = stations.edges.get(&wanted).filter(|_| !dry || named).cloned();
            // A unit of circuits only needs no station.
            let inside =
                !named && (dry || !stations.wrong.contains(&wanted) && in_circuit(circuits, &id));
            let Some(edge) = edge.or_else(|| inside.then(String::new)) else {
                // Its station may be there, and wrong.
                if !stations.wrong.contains(&wanted) {
                    let message = format!("unit: there is no station \"{wanted}\"");
                    let field = if station == "station" { "site" } else { "station" };
                    let place = words.taken.iter().find(|taken| taken.si() == field);
                    let span = place.map_or(words.tree.span.range(), |taken| taken.span.range());
                    let hint = "add a [[station]] at that site, or name it with `station`";
                    self.reader.report(Diagnostic::new(message, span).with_hint(hint));
                }
                return None;
            };
            (id, edge)
        } else {
            let id = self.required_text(&mut words, "id");
            let inside = dry || id.as_deref().is_some_and(|id| in_circuit(circuits, id));
            let port = match inside && words.tree.get("port").is_none() {
                true => Some(String::new()),
                false => self.required_text(&mut words, "port"),
            };
            (id?, port?)
        };
        words.what = format!("unit \"{id}\"");
        let kind = self.kind::<EquipmentParams>(&mut words)?;
        words.what = format!("unit \"{id}\" ({kind})");
        self.place_maps(&mut words, &kind)?;
        let (params, place) = self.parameters(words, &kind)?;
        Some(UnitSpec { id: id.into(), port: port.into(), params, place })
    }
}
