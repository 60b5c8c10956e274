//! Named types of pipes: those of the file, and those of the catalogue, on which the former may build.

use super::{ModelReader, place};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::Span;
use crate::document::{Scalar, Tree, TreeKind};
use crate::grammar::Grammar;
use crate::model::Place;
use crate::wording::refused;
use anergy_core::medium::Medium;
use anergy_core::units::split_suffix;
use anergy_network::elements::pipe::PipeParams;
use anergy_network::ground::Ground;
use anergy_network::pipe_catalogue;
use anergy_network::two_port::{ElementError, positive};
use serde_json::{Value, json};
use std::collections::HashMap;

/// The pipe types by name; `None` for those that are reported as wrong already.
pub(super) type PipeTypes = HashMap<String, Option<Tree>>;

/// A pipe of the catalogue as the fields of a type, all at the place of its name.
pub(super) fn bought(name: &str, span: Span) -> Option<Tree> {
    let pipe = pipe_catalogue::find(name)?;
    let mut fields = json!({
        "inner_diameter_m": pipe.inner_diameter_m,
        "outer_diameter_m": pipe.outer_diameter_m,
        "roughness_m": pipe.roughness_m,
    });
    let casing = pipe.casing_m;
    let more = [
        ("wall_conductivity_w_m_k", json!(pipe.wall_conductivity_w_m_k)),
        ("casing_diameter_m", json!(casing.map(|(diameter_m, _)| diameter_m))),
        ("casing_thickness_m", json!(casing.map(|(_, thickness_m)| thickness_m))),
        ("spacing_m", json!(pipe.spacing_m)),
        ("laying", json!(pipe.laying)),
    ];
    for (field, value) in more {
        if !value.is_null() {
            fields[field] = value;
        }
    }
    Some(Tree::from_json(&fields, span))
}

/// What to write instead of the name of a type that does not exist.
pub(super) fn hint(name: &str, types: &PipeTypes) -> String {
    let catalogue = pipe_catalogue::all();
    let bought = catalogue.iter().map(|pipe| pipe.name.as_str());
    did_you_mean(name, types.keys().map(String::as_str).chain(bought)).unwrap_or_else(|| {
        format!(
            "add a section [pipe_type.{name}], or take a pipe of the catalogue: pipe = \"pre-insulated DN25 \
             series 2\""
        )
    })
}

/// What says with `laying` how a pipe loses heat, by quantity.
const LAYERS: &[&str] = &[
    "laying",
    "wall_conductivity",
    "casing_diameter",
    "casing_thickness",
    "insulation_thickness",
    "insulation_conductivity",
    "film",
    "spacing",
    "wind",
    "outer_film",
];

/// Fills an entry from a type. A quantity of the entry wins over the same quantity of the type, whatever
/// its unit; so does the way in which it gives the heat loss.
pub(super) fn fill(entry: &mut Tree, pipe_type: &Tree) {
    let stem = |name: &str| split_suffix(name).map_or(name.to_owned(), |(stem, _)| stem.to_owned());
    let own: Vec<String> = entry.entries().iter().map(|(key, _)| stem(&key.name)).collect();
    let mut rest = pipe_type.clone();
    if let TreeKind::Table(entries) = &mut rest.kind {
        let own_has = |quantity: &str| own.iter().any(|own| own == quantity);
        let (resistance, laying) = (own_has("insulation_resistance"), own_has("laying"));
        entries.retain(|(key, _)| {
            let quantity = stem(&key.name);
            let other_way = (resistance && LAYERS.contains(&quantity.as_str()))
                || (laying && quantity == "insulation_resistance");
            !other_way && !own.contains(&quantity)
        });
    }
    entry.fill_from(&rest);
}

/// What can be said of the thermal resistance of a pipe type, whose entries may give the rest.
fn resistance(params: &PipeParams, place: &Place) -> Result<(), ElementError> {
    let whole = ["inner_diameter_m", "outer_diameter_m"].iter().all(|field| place.has(field));
    if params.laying.is_some() && whole {
        return params.resistance(&Ground::default()).map(|_| ());
    }
    match params.insulation_resistance_k_m_w {
        Some(resistance) => positive("insulation_resistance_k_m_w", resistance).map(|_| ()),
        None => Ok(()),
    }
}

impl ModelReader<'_> {
    /// The fields of a type, with those of the catalogue's pipe that it builds on; `None` after a report.
    fn built_on(&mut self, what: &str, fields: &Tree) -> Option<Tree> {
        let mut fields = fields.clone();
        let Some((_, name)) = fields.take("pipe") else { return Some(fields) };
        let word = match &name.kind {
            TreeKind::Scalar(Scalar::Text(word)) => word.to_string(),
            _ => name.to_json().to_string(),
        };
        let Some(base) = bought(&word, name.span) else {
            let message = format!("{what}: there is no pipe \"{word}\" in the catalogue");
            let hint = hint(&word, &PipeTypes::new());
            self.reader.report(Diagnostic::new(message, name.span.range()).with_hint(hint));
            return None;
        };
        fill(&mut fields, &base);
        Some(fields)
    }

    /// The pipe types; what is wrong with one is reported here and not where it is used.
    pub(super) fn pipe_types(&mut self) -> PipeTypes {
        let Some(tree) = self.tree.get("pipe_type") else { return PipeTypes::new() };
        if !matches!(tree.kind, TreeKind::Table(_)) {
            let message =
                format!("pipe_type must be a table of named types, not {}", tree.type_name());
            self.reader.report(Diagnostic::new(message, tree.span.range()).with_hint(
                "write [pipe_type.dn20] with its fields, and pipe = \"dn20\" to use it",
            ));
            // The types are there, only not by name.
            return self.pipe_types_named_anywhere();
        }
        let whole = Grammar::of::<PipeParams>();
        let grammar = whole.all_optional();
        let mut types = PipeTypes::new();
        for (key, fields) in tree.entries() {
            let what = format!("pipe_type \"{}\"", key.name);
            let before = self.reader.problems.len();
            let Some(fields) = self.built_on(&what, fields) else {
                types.insert(key.name.to_string(), None);
                continue;
            };
            let fields = &fields;
            let read = self.reader.read_with(&what, fields, &grammar, &["pipe"], |mut value| {
                // The entry that uses the type gives the rest; here it is a wide pipe of 1 m.
                if let Value::Object(values) = &mut value {
                    for name in &whole.required {
                        values.entry(name.clone()).or_insert(Value::from(1.0));
                    }
                }
                serde_path_to_error::deserialize::<_, PipeParams>(value)
            });
            if let Some((params, table)) = read {
                let place = place(&what, fields, &table);
                let built = params.build_with(&Medium::default(), None);
                if let Err(error) = built.map(|_| ()).and_then(|()| resistance(&params, &place)) {
                    self.reader.report(refused(&what, &place, error.field(), &error.to_string()));
                }
                self.reader.problems.extend(crate::build::pipe_temperatures(
                    &self.water(),
                    &what,
                    &params,
                    &place,
                ));
            }
            let sound = self.reader.problems.len() == before;
            types.insert(key.name.to_string(), sound.then(|| fields.clone()));
        }
        types
    }

    /// All names of pipe types that entries use, as reported.
    fn pipe_types_named_anywhere(&self) -> PipeTypes {
        fn names(tree: &Tree, found: &mut PipeTypes) {
            if let Some(name) = tree.text("pipe") {
                found.insert(name.to_owned(), None);
            }
            tree.entries().iter().for_each(|(_, value)| names(value, found));
            if let TreeKind::Array(items) = &tree.kind {
                items.iter().for_each(|item| names(item, found));
            }
        }
        let mut found = PipeTypes::new();
        names(self.tree, &mut found);
        self.rows.values().flatten().for_each(|entry| names(entry, &mut found));
        found
    }
}
