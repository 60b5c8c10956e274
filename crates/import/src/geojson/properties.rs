//! Which properties of a feature are fields of the model.

use anergy_core::units::{Unit, split_suffix};
use serde_json::Value;
use std::collections::BTreeMap;

/// Fields of the model file that a feature without `kind` may give, besides its name, ends and length: their
/// names without unit.
const OF_NODES: [&str; 1] = ["elevation"];
const OF_PIPES: [&str; 11] = [
    "inner_diameter",
    "outer_diameter",
    "casing_diameter",
    "casing_thickness",
    "roughness",
    "insulation_resistance",
    "insulation_thickness",
    "insulation_conductivity",
    "wall_conductivity",
    "depth",
    "spacing",
];
/// Texts and numbers without unit of pipes.
const WORDS_OF_PIPES: [&str; 3] = ["pipe", "zeta", "friction"];

/// Fields as the model file has them.
pub(super) type Fields = Vec<(String, Value)>;

/// The properties that were not taken: their name and the number of features.
pub(super) type Unknown = BTreeMap<String, usize>;

/// A length in m that is written with its unit; `None` for other properties.
pub(super) fn length_m(name: &str, value: &Value) -> Option<f64> {
    let ("length", suffix) = split_suffix(name)? else { return None };
    let number = value.as_f64()?;
    match suffix {
        "m" => Some(number),
        other => Unit::find(other).filter(|unit| unit.si == "m").map(|unit| unit.to_si(number)),
    }
}

/// The fields of a node or pipe among its properties; `taken` are those that are read otherwise.
///
/// A feature with `kind` is one of a model: all of its properties are fields, and the model says which are
/// wrong. Of others only what is known is taken.
pub(super) fn fields<'a>(
    properties: impl Iterator<Item = (&'a String, &'a Value)>,
    taken: &[&str],
    of_node: bool,
    unknown: &mut Unknown,
) -> Fields {
    let properties: Vec<_> = properties.collect();
    let modelled = properties.iter().any(|(name, _)| *name == "kind");
    let mut fields = Fields::new();
    for (name, value) in properties {
        if taken.contains(&name.as_str()) || value.is_null() {
            continue;
        }
        let field = if modelled { Some(name.clone()) } else { known(name, value, of_node) };
        match field {
            Some(field) if fields.iter().all(|(other, _)| *other != field) => {
                fields.push((field, value.clone()));
            }
            _ => *unknown.entry(name.clone()).or_insert(0) += 1,
        }
    }
    fields
}

/// The field that a property of another program stands for.
fn known(name: &str, value: &Value, of_node: bool) -> Option<String> {
    if !of_node && WORDS_OF_PIPES.contains(&name) {
        return Some(name.to_owned());
    }
    value.as_f64()?;
    let (stem, suffix) = split_suffix(name)?;
    let stems: &[&str] = if of_node { &OF_NODES } else { &OF_PIPES };
    if stems.contains(&stem) {
        Some(name.to_owned())
    } else if !of_node && stem == "diameter" {
        Some(format!("inner_diameter_{suffix}"))
    } else {
        None
    }
}

/// A value as TOML; `None` for what TOML has no word for.
pub(super) fn toml(value: &Value) -> Option<String> {
    match value {
        Value::Null => None,
        Value::Bool(flag) => Some(flag.to_string()),
        Value::Number(number) => Some(match (number.as_i64(), number.as_f64()) {
            (Some(whole), _) => whole.to_string(),
            (None, Some(value)) => format!("{value:?}"),
            (None, None) => return None,
        }),
        Value::String(text) => Some(crate::model_text::quoted(text)),
        Value::Array(items) => {
            let items: Option<Vec<String>> = items.iter().map(toml).collect();
            Some(format!("[{}]", items?.join(", ")))
        }
        Value::Object(entries) => {
            let entries: Option<Vec<String>> = entries
                .iter()
                .map(|(key, value)| {
                    Some(format!("{} = {}", crate::model_text::quoted(key), toml(value)?))
                })
                .collect();
            Some(format!("{{ {} }}", entries?.join(", ")))
        }
    }
}
