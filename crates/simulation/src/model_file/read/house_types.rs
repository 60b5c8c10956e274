//! Houses: stations, units, circuits and their control, stated once for many sites.
//!
//! `[[house]]` furnishes a site with the entries of its `[house_type.NAME]` and its own. In them names are those within
//! the house: the site goes in front of the names of controllers, sensors, schedules and series, of what they measure,
//! act on and drive, and becomes the `site` of the others. `set` changes single fields: `{ "storage.volume_l" = 500 }`;
//! `without` leaves parts of the type out: `["boiler", "charging"]`; `connection = "two_pipe"` joins ports of storages
//! ([`two_pipe`]). A type that the file does not have may be one of the
//! library ([`super::super::house_library`]); a list of types adds up.

use super::ModelReader;
use super::station_types::spans;
use super::two_pipe;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::{Key, Scalar, Span, Tree, TreeKind, parse_toml};
use crate::model_file::house_library;
use anergy_control::condition::renamed;
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
        if let Some((_, names)) = tree.take("type") {
            let names = match names.kind {
                TreeKind::Array(names) => names,
                _ => vec![names],
            };
            for name in names {
                parts.extend(self.of_type(&what, &name)?);
            }
        }
        self.connect(&what, &mut tree, &mut parts)?;
        self.leave_out(&what, &mut tree, &mut parts)?;
        let mut changes = self.changes(&what, &mut tree)?;
        parts.extend(tree.entries().iter().cloned());
        for (key, value) in parts {
            let found = FURNITURE.iter().find(|(section, _)| *section == key.name);
            let Some((section, has_site)) = found else {
                let names: Vec<&str> = FURNITURE.iter().map(|(section, _)| *section).collect();
                let hint = did_you_mean(&key.name, names.iter().copied()).unwrap_or_else(|| {
                    format!(
                        "a house has site, type, connection, set, without, {}",
                        names.join(", ")
                    )
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

    /// The parts of a type.
    fn of_type(&mut self, what: &str, name: &Tree) -> Option<Vec<(Key, Tree)>> {
        let TreeKind::Scalar(Scalar::Text(word)) = &name.kind else {
            let message =
                format!("{what}: type must be the name of a house_type, or a list of them");
            self.reader.report(Diagnostic::new(message, name.span.range()));
            return None;
        };
        let types = self.tree.get("house_type");
        let own = types.and_then(|types| types.get(word)).cloned();
        if let Some(fields) = own.or_else(|| of_library(word, name.span)) {
            return Some(fields.entries().to_vec());
        }
        let known = types.into_iter().flat_map(Tree::entries).map(|(key, _)| key.name.as_str());
        let library = || house_library::HOUSES.iter().map(|(name, _)| *name);
        let hint = did_you_mean(word, known.chain(library())).unwrap_or_else(|| {
            let library: Vec<&str> = library().collect();
            let library = library.join(", ");
            format!(
                "add sections [[house_type.{word}.unit]], or take one of the library: {library}"
            )
        });
        let message = format!("{what}: there is no house_type \"{word}\"");
        self.reader.report(Diagnostic::new(message, name.span.range()).with_hint(hint));
        None
    }

    /// Connects the storages of the type as `connection` says.
    fn connect(&mut self, what: &str, tree: &mut Tree, parts: &mut Vec<(Key, Tree)>) -> Option<()> {
        let Some((_, word)) = tree.take("connection") else { return Some(()) };
        let (message, hint) = match &word.kind {
            TreeKind::Scalar(Scalar::Text(word)) if word == "four_pipe" => return Some(()),
            TreeKind::Scalar(Scalar::Text(word)) if word == "two_pipe" => {
                if two_pipe::connect(parts) {
                    return Some(());
                }
                let message =
                    format!("{what}: no storage of its type has two ports at the same two heights");
                (
                    message,
                    "two pipes join such ports; write the circuits with `from` and `to` instead",
                )
            }
            _ => {
                let message = format!("{what}: connection must be \"four_pipe\" or \"two_pipe\"");
                (
                    message,
                    "four_pipe: each circuit has its own ports of the storage, as the type says",
                )
            }
        };
        self.reader.report(Diagnostic::new(message, word.span.range()).with_hint(hint));
        None
    }

    /// Takes the parts that `without` names out of those of the type.
    fn leave_out(&mut self, what: &str, tree: &mut Tree, parts: &mut [(Key, Tree)]) -> Option<()> {
        let Some((key, names)) = tree.take("without") else { return Some(()) };
        let texts = match &names.kind {
            TreeKind::Array(items) => items
                .iter()
                .map(|item| match &item.kind {
                    TreeKind::Scalar(Scalar::Text(name)) => Some((name.to_string(), item.span)),
                    _ => None,
                })
                .collect::<Option<Vec<_>>>(),
            _ => None,
        };
        let Some(texts) = texts else {
            let message = format!("{what}: without must be a list of names");
            let hint = "write for example without = [\"boiler\", \"charging\"]";
            self.reader.report(Diagnostic::new(message, key.span.range()).with_hint(hint));
            return None;
        };
        for (name, span) in texts {
            let mut left_out = false;
            for (section, value) in parts.iter_mut() {
                match &mut value.kind {
                    TreeKind::Array(items) => {
                        let before = items.len();
                        items.retain(|item| part_name(&section.name, item) != name);
                        left_out |= items.len() < before;
                    }
                    // A single table: the station.
                    kind if section.name == name => {
                        *kind = TreeKind::Array(Vec::new());
                        left_out = true;
                    }
                    _ => {}
                }
            }
            if !left_out {
                let all = parts.iter().flat_map(|(section, value)| match &value.kind {
                    TreeKind::Array(items) => {
                        items.iter().map(|i| part_name(&section.name, i)).collect()
                    }
                    _ => vec![section.name.to_string()],
                });
                let all: Vec<String> = all.collect();
                let message = format!("{what}: its type has no \"{name}\" to be left out");
                let hint = did_you_mean(&name, all.iter().map(String::as_str))
                    .unwrap_or_else(|| format!("it has {}", all.join(", ")));
                self.reader.report(Diagnostic::new(message, span.range()).with_hint(hint));
            }
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

/// The fields of a house of the library; its places are where the type is named.
fn of_library(word: &str, span: Span) -> Option<Tree> {
    // The texts of the library are right: its tests read them.
    let document = parse_toml(house_library::text(word)?).ok()?.to_json();
    Some(Tree::from_json(document.get("house_type")?.get(word)?, span))
}

/// The name of a part within its house.
fn part_name(section: &str, item: &Tree) -> String {
    let name = match section {
        "station" | "unit" => item.text("name").unwrap_or(section),
        _ => item.text("id").unwrap_or_default(),
    };
    name.to_owned()
}

/// Changes the fields of an entry.
fn change(section: &str, item: &mut Tree, changes: &mut [Change]) {
    let name = part_name(section, item);
    for change in changes.iter_mut() {
        let within = match change.part.strip_prefix(&name) {
            Some("") => Some(&mut *item),
            // A table of the entry: "storage.ports.grid".
            Some(path) => path.strip_prefix('.').and_then(|path| table_at(item, path)),
            None => None,
        };
        if let Some(TreeKind::Table(entries)) = within.map(|tree| &mut tree.kind) {
            entries.retain(|(key, _)| stem(&key.name) != stem(&change.field));
            entries.push((change.key.clone(), change.value.clone()));
            change.used = true;
        }
    }
}

/// The table at a path of fields.
fn table_at<'a>(tree: &'a mut Tree, path: &str) -> Option<&'a mut Tree> {
    path.split('.').try_fold(tree, |tree, field| match &mut tree.kind {
        TreeKind::Table(entries) => {
            entries.iter_mut().find(|(key, _)| key.name == field).map(|(_, value)| value)
        }
        _ => None,
    })
}

/// Gives an entry its site.
fn place(item: &mut Tree, site: &Tree) {
    if let TreeKind::Table(entries) = &mut item.kind {
        entries.retain(|(key, _)| key.name != "site");
        entries.push((Key { name: "site".into(), span: site.span }, site.clone()));
    }
}

/// Whether a field of a rule is a condition.
fn is_condition(field: &str) -> bool {
    ["on", "off", "lock", "unlock"].contains(&field)
}

/// Puts the site in front of the names of an entry.
fn within(item: &mut Tree, site: &str) {
    let rule = item.text("kind") == Some("rule");
    let TreeKind::Table(entries) = &mut item.kind else { return };
    for (_, value) in entries.iter_mut().filter(|(key, _)| rule && is_condition(&key.name)) {
        // What is no condition is left to be refused.
        if let TreeKind::Scalar(Scalar::Text(text)) = &value.kind
            && let Ok(text) =
                renamed(text, |name| match COMMON.iter().any(|c| name.starts_with(c)) {
                    true => name.to_owned(),
                    false => format!("{site}.{name}"),
                })
        {
            *value = Tree::from_json(&Value::from(text), value.span);
        }
    }
    for (_, value) in entries.iter_mut().filter(|(key, _)| is_name(&key.name)) {
        if let TreeKind::Scalar(Scalar::Text(name)) = &value.kind
            && !COMMON.iter().any(|common| name.starts_with(common))
        {
            *value = Tree::from_json(&Value::from(format!("{site}.{name}")), value.span);
        }
    }
}
