//! Three-way valves and four-way mixers.

use super::{ModelReader, place};
use crate::document::{Tree, TreeKind};
use crate::model_file::shared_command::{SharedCommand, valves};
use crate::model_file::{FourWayMixerEntry, ThreeWayValveEntry};
use crate::wording::refused;
use schemars::JsonSchema;
use serde::de::DeserializeOwned;

impl ModelReader<'_> {
    pub(super) fn three_way_valves(&mut self) {
        self.shared_commands(|entry: &ThreeWayValveEntry| {
            let message = format!("kvs_ratio = {} must be positive", entry.kvs_ratio);
            (entry.kvs_ratio <= 0.0).then_some(("kvs_ratio", message))
        });
    }

    pub(super) fn four_way_mixers(&mut self) {
        self.shared_commands(|_: &FourWayMixerEntry| None);
    }

    /// Valves with one command; `wrong` says which field of an entry is out of its range.
    fn shared_commands<E: SharedCommand + DeserializeOwned + JsonSchema + 'static>(
        &mut self,
        wrong: impl Fn(&E) -> Option<(&'static str, String)>,
    ) {
        for tree in self.items(E::SECTION) {
            let what = format!("{} \"{}\"", E::SECTION, tree.text("id").unwrap_or("?"));
            // What is no table is reported as an entry of its own.
            let (mut own, mut rest) = (tree.clone(), tree.clone());
            if let (TreeKind::Table(own), TreeKind::Table(rest)) = (&mut own.kind, &mut rest.kind) {
                own.retain(|(key, _)| E::OWN_FIELDS.contains(&key.name.as_str()));
                rest.retain(|(key, _)| !E::OWN_FIELDS.contains(&key.name.as_str()));
            }
            let read = self.reader.read::<E>(&what, &own);
            let Some((entry, table)) = read else { continue };
            let place = place(&what, &tree, &table);
            let before = self.reader.problems.len();
            if entry.id().is_empty() {
                self.reader.report(refused(&what, &place, Some("id"), "id is empty"));
            }
            if let Some((field, message)) = wrong(&entry) {
                self.reader.report(refused(&what, &place, Some(field), &message));
            }
            self.only_fields_of_a_valve(&what, &rest, E::HINT);
            if self.reader.problems.len() == before {
                self.add_edges(valves(&entry, &own, &rest));
            }
        }
    }

    /// What the entry says of its valves must leave them what makes them one.
    fn only_fields_of_a_valve(&mut self, what: &str, rest: &Tree, hint: &str) {
        for (key, _) in rest.entries() {
            if ["kind", "from", "to", "command_of", "inverse"].contains(&key.name.as_str()) {
                let message = format!("{what}: unknown field `{}`", key.name);
                let problem = crate::diagnostic::Diagnostic::new(message, key.span.range());
                self.reader.report(problem.with_hint(hint));
            }
        }
    }
}
