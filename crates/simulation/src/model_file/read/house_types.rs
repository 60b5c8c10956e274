//! Houses: stations, units, circuits and their control, stated once for many sites.
//!
//! `[[house]]` furnishes a site with the entries of its `[house_type.NAME]` and its own. In them names are those within
//! the house: the site goes in front of the names of controllers, sensors, schedules and series, of what they measure,
//! act on and drive, and becomes the `site` of the others. `set` changes single fields: `{ "storage.volume_l" = 500 }`.

use super::ModelReader;
use super::station_types::spans;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::{Key, Scalar, Tree, TreeKind};
use anergy_core::units::split_suffix;
use serde_json::Value;

/// What a house can have, and whether the site is a field of it.
const FURNITURE: [(&str, bool); 7] = [
    ("station", true),
    ("unit", true),
    ("circuit", true),
    ("sensor", false),
    ("controller", false),
    ("schedule", false),
    ("series", false),
];

/// Signals and channels of the whole model, which are the same in every house.
const COMMON: [&str; 2] = ["weather.", "ground."];

/// A change of a field by `set`.
struct Change {
    part: String,
    field: String,
    key: Key,
    value: Tree,
    used: bool,
}

fn stem(name: &str) -> &str {
    split_suffix(name).map_or(name, |(stem, _)| stem)
}

/// Whether a field names something within the house.
fn is_name(field: &str) -> bool {
    ["measures", "acts_on"].iter().any(|start| field.starts_with(start))
        || ["id", "station", "signal"].contains(&field)
}

impl ModelReader<'_> {
    /// Puts the entries of all houses beside those that the user wrote one by one.
    pub(super) fn furnish_houses(&mut self) {
        if let Some(types) = self.tree.get("house_type") {
            for (_, fields) in types.entries() {
                self.tables.shared.extend(spans(fields));
            }
        }
        for tree in self.items("house") {
            self.house(tree);
        }
    }

    fn house(&mut self, mut tree: Tree) -> Option<()> {
        let Some(site) = tree.text("site").map(str::to_owned) else {
            let problem = Diagnostic::new("house: site is missing", tree.span.range());
            self.reader.report(problem.with_hint("name the site that it stands at"));
            return None;
        };
        let what = format!("house at \"{site}\"");
        let (_, site_tree) = tree.take("site")?;
        let mut parts = Vec::new();
        if let Some((_, name)) = tree.take("type") {
            let TreeKind::Scalar(Scalar::Text(word)) = &name.kind else {
                let message = format!("{what}: type must be the name of a house_type");
                self.reader.report(Diagnostic::new(message, name.span.range()));
                return None;
            };
            let types = self.tree.get("house_type");
            let Some(fields) = types.and_then(|types| types.get(word)) else {
                let known = types.into_iter().flat_map(Tree::entries);
                let hint = did_you_mean(word, known.map(|(key, _)| key.name.as_str()))
                    .unwrap_or_else(|| format!("add sections [[house_type.{word}.unit]]"));
                let message = format!("{what}: there is no house_type \"{word}\"");
                self.reader.report(Diagnostic::new(message, name.span.range()).with_hint(hint));
                return None;
            };
            parts.extend(fields.entries().iter().cloned());
        }
        let mut changes = self.changes(&what, &mut tree)?;
        parts.extend(tree.entries().iter().cloned());
        for (key, value) in parts {
            let found = FURNITURE.iter().find(|(section, _)| *section == key.name);
            let Some((section, has_site)) = found else {
                let names: Vec<&str> = FURNITURE.iter().map(|(section, _)| *section).collect();
                let hint = did_you_mean(&key.name, names.iter().copied()).unwrap_or_else(|| {
                    format!("a house has site, type, set, {}", names.join(", "))
                });
                let message = format!("{what}: unknown field `{}`", key.name);
                self.reader.report(Diagnostic::new(message, key.span.range()).with_hint(hint));
                continue;
            };
            let items = match value.kind {
                TreeKind::Array(items) => items,
                _ => vec![value],
            };
            for mut item in items {
                if !matches!(item.kind, TreeKind::Table(_)) {
                    let message =
                        format!("{what}: {section} must be a table, not {}", item.type_name());
                    self.reader.report(Diagnostic::new(message, item.span.range()));
                    continue;
                }
                change(section, &mut item, &mut changes);
                if *has_site {
                    place(&mut item, &site_tree);
                } else {
                    within(&mut item, &site);
                }
                self.rows.entry(section).or_default().push(item);
            }
        }
        for change in changes.iter().filter(|change| !change.used) {
            let message = format!("{what}: it has no \"{}\" to be set", change.part);
            let hint = "write for example set = { \"storage.volume_l\" = 500 }, with the name of a unit or `station`";
            self.reader.report(Diagnostic::new(message, change.key.span.range()).with_hint(hint));
        }
        Some(())
    }

    /// The changes that `set` asks for.
    fn changes(&mut self, what: &str, tree: &mut Tree) -> Option<Vec<Change>> {
        let Some((key, set)) = tree.take("set") else { return Some(Vec::new()) };
        if !matches!(set.kind, TreeKind::Table(_)) {
            let message = format!("{what}: set must be a table, not {}", set.type_name());
            let hint = "write for example set = { \"storage.volume_l\" = 500 }";
            self.reader.report(Diagnostic::new(message, key.span.range()).with_hint(hint));
            return None;
        }
        let mut changes = Vec::new();
        for (key, value) in set.entries() {
            let Some((part, field)) = key.name.rsplit_once('.') else {
                let message = format!("{what}: set: \"{}\" names no field", key.name);
                let hint = "write the part and the field, in quotes: \"storage.volume_l\"";
                self.reader.report(Diagnostic::new(message, key.span.range()).with_hint(hint));
                return None;
            };
            let field = Key { name: field.into(), span: key.span };
            changes.push(Change {
                part: part.to_owned(),
                field: field.name.to_string(),
                key: field,
                value: value.clone(),
                used: false,
            });
        }
        Some(changes)
    }
}

/// Changes the fields of an entry.
fn change(section: &str, item: &mut Tree, changes: &mut [Change]) {
    let name = match section {
        "station" | "unit" => item.text("name").unwrap_or(section),
        _ => item.text("id").unwrap_or_default(),
    };
    let name = name.to_owned();
    let TreeKind::Table(entries) = &mut item.kind else { return };
    for change in changes.iter_mut().filter(|change| change.part == name) {
        entries.retain(|(key, _)| stem(&key.name) != stem(&change.field));
        entries.push((change.key.clone(), change.value.clone()));
        change.used = true;
    }
}

/// Gives an entry its site.
fn place(item: &mut Tree, site: &Tree) {
    if let TreeKind::Table(entries) = &mut item.kind {
        entries.retain(|(key, _)| key.name != "site");
        entries.push((Key { name: "site".into(), span: site.span }, site.clone()));
    }
}

/// Puts the site in front of the names of an entry.
fn within(item: &mut Tree, site: &str) {
    let TreeKind::Table(entries) = &mut item.kind else { return };
    for (_, value) in entries.iter_mut().filter(|(key, _)| is_name(&key.name)) {
        if let TreeKind::Scalar(Scalar::Text(name)) = &value.kind
            && !COMMON.iter().any(|common| name.starts_with(common))
        {
            *value = Tree::from_json(&Value::from(format!("{site}.{name}")), value.span);
        }
    }
}
