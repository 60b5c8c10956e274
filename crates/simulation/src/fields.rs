//! From a spanned table to a typed entry: known fields, units, types - every error with its place.
//!
//! A field of an entry ends in its SI unit; a file may write the same field with another unit
//! (`inner_diameter_mm` for `inner_diameter_m`). The conversion happens here, once, for all entries.

use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::{Tree, TreeKind};
use crate::grammar::{Grammar, Registered};
use crate::model::WrittenField;
use crate::wording::{named, type_error};
use anergy_core::units::{Unit, alternatives};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use serde_path_to_error::{Path, Segment};
use std::ops::Range;

/// A table with SI fields only, and how each was written.
#[derive(Debug, Clone, Default)]
pub struct SiTable {
    /// The values.
    pub values: Map<String, Value>,
    /// Their spelling and place.
    pub fields: Vec<WrittenField>,
}

/// Collects problems while entries are read.
#[derive(Debug, Default)]
pub struct Reader {
    /// What was found so far.
    pub problems: Vec<Diagnostic>,
}

type TypeError = serde_path_to_error::Error<serde_json::Error>;

impl Reader {
    /// Adds a problem.
    pub fn report(&mut self, problem: Diagnostic) {
        self.problems.push(problem);
    }

    /// Reads a table as `T`; `what` names the entry in messages, for example `edge "p1" (pipe)`.
    pub fn read<T: DeserializeOwned + JsonSchema + 'static>(
        &mut self,
        what: &str,
        tree: &Tree,
    ) -> Option<(T, SiTable)> {
        let grammar = Grammar::of::<T>();
        self.read_with(what, tree, &grammar, &[], |value| serde_path_to_error::deserialize(value))
    }

    /// Reads a table as parameters of a kind; `also` are words that have been taken out already.
    pub fn read_kind<P: Registered>(
        &mut self,
        what: &str,
        tree: &Tree,
        kind: &str,
        also: &[&str],
    ) -> Option<(P, SiTable)> {
        let grammar = Grammar::of_kind::<P>(kind)?;
        self.read_with(what, tree, &grammar, also, |value| {
            let mut track = serde_path_to_error::Track::new();
            let deserializer = serde_path_to_error::Deserializer::new(value, &mut track);
            // The grammar is that of a known kind, so there always is a result.
            let result = P::deserialize(kind, deserializer).unwrap_or_else(|| {
                Err(<serde_json::Error as serde::de::Error>::custom("the kind is not known"))
            });
            result.map_err(|error| TypeError::new(track.path(), error))
        })
    }

    /// Reads a table with a given grammar and deserialisation.
    pub fn read_with<T>(
        &mut self,
        what: &str,
        tree: &Tree,
        grammar: &Grammar,
        also: &[&str],
        deserialize: impl FnOnce(Value) -> Result<T, TypeError>,
    ) -> Option<(T, SiTable)> {
        let before = self.problems.len();
        let table = self.si_table(what, tree, grammar, also);
        if self.problems.len() > before {
            return None;
        }
        match deserialize(Value::Object(table.values.clone())) {
            Ok(entry) => Some((entry, table)),
            Err(error) => {
                self.report_type_error(what, tree, &table, &error);
                None
            }
        }
    }

    /// Renames and converts all fields to SI; reports unknown, doubled and missing ones.
    fn si_table(&mut self, what: &str, tree: &Tree, grammar: &Grammar, also: &[&str]) -> SiTable {
        let mut table = SiTable::default();
        if !matches!(tree.kind, TreeKind::Table(_)) {
            let message = format!("{what} must be a table, not {}", tree.type_name());
            let problem = Diagnostic::new(message, tree.span.range());
            self.report(match &tree.kind {
                TreeKind::Array(_) => problem.with_hint(format!("write {what} in single brackets")),
                _ => problem.with_hint("a table is a section of its own or { field = value, ... }"),
            });
            return table;
        }
        let mut meant = Vec::new();
        for (key, value) in tree.entries() {
            let Some(spelling) = grammar.spelling(&key.name) else {
                meant.extend(self.report_unknown(what, &key.name, key.span.range(), grammar, also));
                continue;
            };
            let si = spelling.si.as_str();
            if let Some(other) = table.fields.iter().find(|other| other.si() == si) {
                let message =
                    format!("{what}: {} and {} are the same field", key.name, other.name());
                self.report(Diagnostic::new(message, key.span.range()).with_hint("give only one"));
                continue;
            }
            let written = value.to_json();
            let si_value = match (spelling.unit, grammar.nested(si)) {
                (None, None) => Some(written.clone()),
                (None, Some(nested)) => nested.in_si(&written),
                (Some(unit), _) => converted(&written, unit),
            };
            let Some(si_value) = si_value else {
                meant.push(si.to_owned());
                let message =
                    format!("{what}: {} is too large a number", named(&key.name, &written));
                self.report(Diagnostic::new(message, value.span.range()));
                continue;
            };
            table.values.insert(si.to_owned(), si_value);
            table.fields.push(WrittenField::new(spelling, written, value.span));
        }
        for name in &grammar.required {
            let tried = meant.contains(name) || table.values.contains_key(name);
            if !tried {
                self.report_missing(what, name, tree.span.range());
            }
        }
        table
    }

    /// Reports a field that an entry needs, with the units it can be given in.
    pub fn report_missing(&mut self, what: &str, field: &str, span: Option<Range<usize>>) {
        let problem = Diagnostic::new(format!("{what}: {field} is missing"), span);
        let others = Grammar::spellings(field);
        self.report(match &others[1..] {
            [] => problem,
            others => problem.with_hint(format!("also possible: {}", others.join(", "))),
        });
    }

    /// Reports a field that an entry does not have; returns the one that was probably meant.
    fn report_unknown(
        &mut self,
        what: &str,
        name: &str,
        span: Option<Range<usize>>,
        grammar: &Grammar,
        also: &[&str],
    ) -> Option<String> {
        let problem = Diagnostic::new(format!("{what}: unknown field `{name}`"), span);
        let spellings = |field: &String| Grammar::spellings(field);
        let all: Vec<String> = grammar
            .fields
            .iter()
            .flat_map(spellings)
            .chain(also.iter().map(|word| (*word).to_owned()))
            .collect();
        // A known unit of another quantity, or an unknown unit, before a word that looks alike.
        if let Some(field) = grammar.same_quantity(name) {
            let possible = Grammar::spellings(field);
            let hint = match possible.as_slice() {
                [only] => format!("write {only}: it has no other unit"),
                _ => format!("wrong unit? possible are {}", possible.join(", ")),
            };
            self.report(problem.with_hint(hint));
            return Some(field.to_owned());
        }
        if let Some(hint) = did_you_mean(name, all.iter().map(String::as_str)) {
            let meant = hint.split('`').nth(1).and_then(|name| grammar.field(name));
            self.report(problem.with_hint(hint));
            return meant.map(|(field, _)| field.to_owned());
        }
        let known = grammar.fields.iter().map(String::as_str).chain(also.iter().copied());
        let known: Vec<&str> = known.collect();
        self.report(problem.with_hint(format!("known fields: {}", known.join(", "))));
        None
    }

    fn report_type_error(&mut self, what: &str, tree: &Tree, table: &SiTable, error: &TypeError) {
        // serde_json appends a position in its own text, which means nothing here.
        let reason = error.inner().to_string();
        let reason = reason.split(" at line ").next().unwrap_or_default();
        let Some((name, found, whole)) = part_of(tree, table, error.path()) else {
            self.report(Diagnostic::new(format!("{what}: {reason}"), tree.span.range()));
            return;
        };
        let value = found.to_json();
        let subject = if whole { named(name, &value) } else { format!("{name}: {value}") };
        let (message, hint) = type_error(&subject, &value, reason);
        let problem = Diagnostic::new(format!("{what}: {message}"), found.span.range());
        self.report(match hint {
            Some(hint) => problem.with_hint(hint),
            None => problem,
        });
    }
}

/// The name of the field that a path leads into, the innermost value on it, and whether that is the
/// whole field.
fn part_of<'t>(tree: &'t Tree, table: &SiTable, path: &Path) -> Option<(&'t str, &'t Tree, bool)> {
    let mut segments = path.iter();
    let Some(Segment::Map { key }) = segments.next() else { return None };
    let written = table.fields.iter().find(|written| written.si() == key)?;
    let (key, value) = tree.entries().iter().find(|(key, _)| key.name == written.name())?;
    let (mut found, mut whole) = (value, true);
    for segment in segments {
        found = match (segment, &found.kind) {
            (Segment::Seq { index }, TreeKind::Array(items)) => items.get(*index)?,
            (Segment::Map { key }, TreeKind::Table(_)) => {
                let other = || alternatives(key).find_map(|(name, _)| found.get(&name));
                found.get(key).or_else(other)?
            }
            _ => break,
        };
        whole = false;
    }
    Some((&key.name, found, whole))
}

/// Converts a number, or all numbers of an array; leaves other values for the type check. `None` when a
/// number is infinite in SI.
pub fn converted(value: &Value, unit: Unit) -> Option<Value> {
    match value {
        Value::Number(number) => {
            let si = unit.to_si(number.as_f64()?);
            si.is_finite().then(|| Value::from(si))
        }
        Value::Array(items) => items.iter().map(|item| converted(item, unit)).collect(),
        other => Some(other.clone()),
    }
}
