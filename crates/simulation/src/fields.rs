//! From a spanned table to a typed entry: known fields, units, types - every error with its place.
//!
//! A field of an entry ends in its SI unit; a file may write the same field with another unit
//! (`inner_diameter_mm` for `inner_diameter_m`). The conversion happens here, once, for all entries.

use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::{Tree, TreeKind};
use anergy_core::units::{Unit, alternatives};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::ops::Range;

/// A table with SI fields only, and where each came from.
#[derive(Debug, Clone, Default)]
pub struct SiTable {
    /// The values.
    pub values: Map<String, Value>,
    /// SI name, name in the file, place of the value.
    pub places: Vec<(String, String, Option<Range<usize>>)>,
}

impl SiTable {
    /// The place of a field's value.
    pub fn place(&self, si_name: &str) -> Option<Range<usize>> {
        self.places.iter().find(|(si, ..)| si == si_name).and_then(|(.., span)| span.clone())
    }
}

/// Collects problems while entries are read.
#[derive(Debug, Default)]
pub struct Reader {
    /// What was found so far.
    pub problems: Vec<Diagnostic>,
}

impl Reader {
    /// Adds a problem.
    pub fn report(&mut self, problem: Diagnostic) {
        self.problems.push(problem);
    }

    /// Reads a table as `T`; `what` names the entry in messages, for example `edge "p1" (pipe)`.
    pub fn read<T: DeserializeOwned + JsonSchema>(&mut self, what: &str, tree: &Tree) -> Option<T> {
        let schema = schemars::schema_for!(T);
        self.read_with(what, tree, &schema, |value| serde_path_to_error::deserialize(value))
            .map(|(entry, _)| entry)
    }

    /// Reads a table against a schema with a given deserialisation; also returns the SI table.
    pub fn read_with<T>(
        &mut self,
        what: &str,
        tree: &Tree,
        schema: &schemars::Schema,
        deserialize: impl FnOnce(Value) -> Result<T, serde_path_to_error::Error<serde_json::Error>>,
    ) -> Option<(T, SiTable)> {
        let before = self.problems.len();
        let table = self.si_table(what, tree, schema);
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
    fn si_table(&mut self, what: &str, tree: &Tree, schema: &schemars::Schema) -> SiTable {
        let mut table = SiTable::default();
        if !matches!(tree.kind, TreeKind::Table(_)) {
            self.report(Diagnostic::new(
                format!("{what} must be a table, not {}", tree.type_name()),
                tree.span.clone(),
            ));
            return table;
        }
        let known = property_names(schema);
        for (key, value) in tree.entries() {
            let Some((si_name, unit)) = si_field(&known, &key.name) else {
                self.report_unknown(what, &key.name, key.span.clone(), &known);
                continue;
            };
            if let Some((_, other, _)) = table.places.iter().find(|(si, ..)| *si == si_name) {
                let message = format!("{what}: {} and {other} are the same field", key.name);
                self.report(Diagnostic::new(message, key.span.clone()).with_hint("give only one"));
                continue;
            }
            let converted = match unit {
                None => value.to_json(),
                Some(unit) => convert(&value.to_json(), unit),
            };
            table.values.insert(si_name.clone(), converted);
            table.places.push((si_name, key.name.clone(), value.span.clone()));
        }
        let required = schema.get("required").and_then(Value::as_array);
        for name in required.into_iter().flatten().filter_map(Value::as_str) {
            let misspelt = self.problems.iter().any(|problem| {
                problem.message.starts_with(what)
                    && problem.hint.as_ref().is_some_and(|hint| hint.contains(name))
            });
            if !table.values.contains_key(name) && !misspelt {
                let message = format!("{what}: {name} is missing");
                let mut problem = Diagnostic::new(message, tree.span.clone());
                let others: Vec<String> = alternatives(name).map(|(name, _)| name).collect();
                if !others.is_empty() {
                    problem = problem.with_hint(format!("also possible: {}", others.join(", ")));
                }
                self.report(problem);
            }
        }
        table
    }

    fn report_unknown(
        &mut self,
        what: &str,
        name: &str,
        span: Option<Range<usize>>,
        known: &[String],
    ) {
        let all: Vec<String> = known
            .iter()
            .flat_map(|name| {
                std::iter::once(name.clone()).chain(alternatives(name).map(|(name, _)| name))
            })
            .collect();
        let stem = anergy_core::units::split_suffix(name).map(|(stem, _)| stem);
        let same_quantity = known.iter().find(|known| {
            stem.is_some() && anergy_core::units::split_suffix(known).map(|(stem, _)| stem) == stem
        });
        let hint = if let Some(field) = same_quantity {
            let units: Vec<String> = std::iter::once(field.clone())
                .chain(alternatives(field).map(|(name, _)| name))
                .collect();
            format!("wrong unit? possible are {}", units.join(", "))
        } else if let Some(hint) = did_you_mean(name, all.iter().map(String::as_str)) {
            hint
        } else {
            format!("known fields: {}", known.join(", "))
        };
        self.report(
            Diagnostic::new(format!("{what}: unknown field `{name}`"), span).with_hint(hint),
        );
    }

    fn report_type_error(
        &mut self,
        what: &str,
        tree: &Tree,
        table: &SiTable,
        error: &serde_path_to_error::Error<serde_json::Error>,
    ) {
        let path = error.path().to_string();
        let field = path.split(['.', '[']).next().unwrap_or_default();
        let place = table.places.iter().find(|(si, ..)| si == field);
        let (name, span) = match place {
            Some((_, name, span)) => (name.as_str(), span.clone()),
            None => ("", tree.span.clone()),
        };
        // serde_json appends a position in its own text, which means nothing here.
        let reason = error.inner().to_string();
        let reason = reason.split(" at line ").next().unwrap_or_default();
        let message = if name.is_empty() {
            format!("{what}: {reason}")
        } else {
            format!("{what}: {name}: {reason}")
        };
        let mut problem = Diagnostic::new(message, span);
        if reason.contains("string") && reason.contains("expected f64") {
            problem = problem
                .with_hint("write a number without unit; the unit is the end of the field's name");
        }
        self.report(problem);
    }
}

/// The names of the fields of an object schema.
pub fn property_names(schema: &schemars::Schema) -> Vec<String> {
    schema
        .get("properties")
        .and_then(Value::as_object)
        .map(|properties| properties.keys().cloned().collect())
        .unwrap_or_default()
}

/// The SI field that a name in the file means, and the unit to convert from.
fn si_field(known: &[String], name: &str) -> Option<(String, Option<Unit>)> {
    if known.iter().any(|field| field == name) {
        return Some((name.to_owned(), None));
    }
    known.iter().find_map(|field| {
        alternatives(field)
            .find(|(alternative, _)| alternative == name)
            .map(|(_, unit)| (field.clone(), Some(unit)))
    })
}

/// Converts a number, or all numbers of an array; leaves other values for the type check.
fn convert(value: &Value, unit: Unit) -> Value {
    match value {
        Value::Number(number) => {
            number.as_f64().map_or_else(|| value.clone(), |number| Value::from(unit.to_si(number)))
        }
        Value::Array(items) => items.iter().map(|item| convert(item, unit)).collect(),
        other => other.clone(),
    }
}
