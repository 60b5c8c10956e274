//! Three-way valves.

use super::{ModelReader, place};
use crate::document::{Tree, TreeKind};
use crate::model_file::ThreeWayValveEntry;
use crate::model_file::three_way_valve::{OWN_FIELDS, valves};
use crate::wording::refused;

impl ModelReader<'_> {
    pub(super) fn three_way_valves(&mut self) {
        for tree in self.items("three_way_valve") {
            let what = format!("three_way_valve \"{}\"", tree.text("id").unwrap_or("?"));
            // What is no table is reported as an entry of its own.
            let (mut own, mut rest) = (tree.clone(), tree.clone());
            if let (TreeKind::Table(own), TreeKind::Table(rest)) = (&mut own.kind, &mut rest.kind) {
                own.retain(|(key, _)| OWN_FIELDS.contains(&key.name.as_str()));
                rest.retain(|(key, _)| !OWN_FIELDS.contains(&key.name.as_str()));
            }
            let read = self.reader.read::<ThreeWayValveEntry>(&what, &own);
            let Some((entry, table)) = read else { continue };
            let place = place(&what, &tree, &table);
            let before = self.reader.problems.len();
            if entry.id.is_empty() {
                self.reader.report(refused(&what, &place, Some("id"), "id is empty"));
            }
            if entry.kvs_ratio <= 0.0 {
                let message = format!("kvs_ratio = {} must be positive", entry.kvs_ratio);
                self.reader.report(refused(&what, &place, Some("kvs_ratio"), &message));
            }
            self.only_fields_of_a_valve(&what, &rest);
            if self.reader.problems.len() == before {
                self.add_edges(valves(&entry, &own, &rest));
            }
        }
    }

    /// What the entry says of its two valves must leave them what makes them one.
    fn only_fields_of_a_valve(&mut self, what: &str, rest: &Tree) {
        for (key, _) in rest.entries() {
            if ["kind", "from", "to", "command_of", "inverse"].contains(&key.name.as_str()) {
                let message = format!("{what}: unknown field `{}`", key.name);
                let problem = crate::diagnostic::Diagnostic::new(message, key.span.range());
                let hint = "a three-way valve joins a and b to ab, and its ways share one command";
                self.reader.report(problem.with_hint(hint));
            }
        }
    }
}
