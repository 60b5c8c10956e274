//! Station types, and the tables of `[network]` that use them.

use super::{ModelReader, place};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::{Key, Scalar, Tree, TreeKind};
use crate::model_file::NetworkEntry;
use crate::model_file::tables::{Content, TableReader, separator_byte};
use crate::wording::refused;
use anergy_core::units::split_suffix;
use serde_json::Value;

impl ModelReader<'_> {
    /// Reads the tables of `[network]`; their rows are entries like those of the model file.
    pub(super) fn network(&mut self, text: &str) {
        let Some(tree) = self.tree.get("network") else { return };
        let Some((entry, table)) = self.reader.read::<NetworkEntry>("[network]", tree) else {
            self.sites_unread = true;
            return;
        };
        if separator_byte(entry.separator).is_none() {
            let place = place("[network]", tree, &table);
            let message = format!("separator = {:?} cannot separate numbers", entry.separator);
            let problem = refused("[network]", &place, Some("separator"), &message);
            self.reader.report(problem.with_hint("usual are \",\", \";\" and \"\\t\""));
            self.sites_unread = true;
            return;
        }
        let mut tables = TableReader {
            dir: self.dir,
            text_end: text.len(),
            entry: &entry,
            tables: &mut self.tables,
            problems: &mut self.reader.problems,
        };
        let files =
            [("nodes", &entry.nodes, Content::Nodes), ("pipes", &entry.pipes, Content::Pipes)];
        for (field, file, content) in files {
            if let (Some(file), Some(named)) = (file, tree.get(field)) {
                let whole = tables.read(content, file, named, &mut self.rows);
                self.sites_unread |= content == Content::Nodes && !whole;
            }
        }
    }

    /// Notes where the station types stand; one that is no table, or has no kind, is reported.
    pub(super) fn station_types(&mut self) {
        let Some(tree) = self.tree.get("station_type") else { return };
        let mut wrong = |message: String, tree: &Tree, hint: &str| {
            self.reader.report(Diagnostic::new(message, tree.span.range()).with_hint(hint));
        };
        if !matches!(tree.kind, TreeKind::Table(_)) {
            let message =
                format!("station_type must be a table of named types, not {}", tree.type_name());
            wrong(message, tree, "write [station_type.house] with the fields of a station");
        }
        for (key, fields) in tree.entries() {
            let what = format!("station_type \"{}\"", key.name);
            if !matches!(fields.kind, TreeKind::Table(_)) {
                let message = format!("{what} must be a table, not {}", fields.type_name());
                wrong(message, fields, "write [station_type.house] with the fields of a station");
            }
            for name in ["site", "name", "type"] {
                if let Some(value) = fields.get(name) {
                    let message = format!("{what}: {name} belongs to the single station");
                    wrong(message, value, "a type is what many stations have in common");
                }
            }
            self.tables.shared.extend(spans(fields));
        }
    }

    /// A station's entry with the fields of its type; its `unit` becomes an entry of its own.
    pub(super) fn typed_station(&mut self, mut tree: Tree) -> Option<Tree> {
        if let Some((_, name)) = tree.take("type") {
            let what = super::expand::station_in_words(&tree);
            let TreeKind::Scalar(Scalar::Text(word)) = &name.kind else {
                let message = format!(
                    "{what}: type must be the name of a station_type, not {}",
                    name.type_name()
                );
                let hint =
                    "write for example type = \"house\", with a section [station_type.house]";
                self.reader.report(Diagnostic::new(message, name.span.range()).with_hint(hint));
                return None;
            };
            let types = self.tree.get("station_type");
            let Some(fields) = types.and_then(|types| types.get(word)) else {
                let known = types.into_iter().flat_map(Tree::entries);
                let hint = did_you_mean(word, known.map(|(key, _)| key.name.as_str()))
                    .unwrap_or_else(|| format!("add a section [station_type.{word}]"));
                let message = format!("{what}: there is no station_type \"{word}\"");
                self.reader.report(Diagnostic::new(message, name.span.range()).with_hint(hint));
                return None;
            };
            fill(&mut tree, fields);
        }
        let Some((_, mut unit)) = tree.take("unit") else { return Some(tree) };
        if !matches!(unit.kind, TreeKind::Table(_)) {
            let what = super::expand::station_in_words(&tree);
            let message = format!("{what}: unit must be a table, not {}", unit.type_name());
            let hint = "write for example unit = { kind = \"heat_load\", load_kw = 8 }";
            self.reader.report(Diagnostic::new(message, unit.span.range()).with_hint(hint));
            return Some(tree);
        }
        let is_named = unit.get("name").is_some();
        let mut add = |name: &str, value: Tree| {
            let key = Key { name: name.into(), span: value.span };
            if let TreeKind::Table(entries) = &mut unit.kind {
                entries.retain(|(own, _)| own.name != name);
                entries.push((key, value));
            }
        };
        if let Some(site) = tree.get("site") {
            add("site", site.clone());
        }
        if let Some(name) = tree.get("name").filter(|_| tree.text("name") != Some("station")) {
            add("station", name.clone());
            if !is_named {
                let own = format!("{}.unit", tree.text("name").unwrap_or_default());
                add("name", Tree::from_json(&Value::from(own), name.span));
            }
        }
        self.rows.entry("unit").or_default().push(unit);
        Some(tree)
    }
}

/// Adds what an entry does not give in any unit; tables within it likewise.
fn fill(tree: &mut Tree, defaults: &Tree) {
    let stem = |name: &str| split_suffix(name).map_or(name.to_owned(), |(stem, _)| stem.to_owned());
    let TreeKind::Table(entries) = &mut tree.kind else { return };
    for (key, value) in defaults.entries() {
        match entries.iter_mut().find(|(own, _)| stem(&own.name) == stem(&key.name)) {
            Some((_, own)) => {
                if matches!(value.kind, TreeKind::Table(_)) {
                    fill(own, value);
                }
            }
            None => entries.push((key.clone(), value.clone())),
        }
    }
}

/// The places of all values of a type and of its parts.
pub(super) fn spans(tree: &Tree) -> Vec<std::ops::Range<usize>> {
    let own = tree.entries().iter().flat_map(|(key, value)| {
        [key.span.range(), value.span.range()].into_iter().flatten().chain(spans(value))
    });
    let items = match &tree.kind {
        TreeKind::Array(items) => items.as_slice(),
        _ => &[],
    };
    let own = own.chain(items.iter().flat_map(spans));
    tree.span.range().into_iter().chain(own).collect()
}
