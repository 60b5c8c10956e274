//! The fields of the model file as a page: the JSON Schema, read out.

use serde_json::{Map, Value};
use std::fmt::Write as _;

const HEAD: &str = "\
# Every field of the model file

Written by `anergy schema --markdown`; [The model file](model-file.md) explains what belongs together. A field with units can be
written in each of them: the unit is the end of its name.
";

/// Sections that take entries of another section.
const SAME: &[(&str, &str)] = &[("station_type", "station"), ("house_type", "house")];
/// Sections whose parts are elements of `[[edge]]`.
const OF_PARTS: &[&str] = &["station", "house", "trench"];

/// The page.
pub fn page(schema: &Value) -> String {
    let mut page = HEAD.to_owned();
    for (section, whole) in object(&schema["properties"]) {
        if section == "format" {
            let _ = write!(page, "\n## `format`\n\n{}: `format = 1`.\n", about(whole));
            continue;
        }
        let (title, each) = match (&whole["items"], &whole["additionalProperties"]) {
            (each @ Value::Object(_), _) => (format!("[[{section}]]"), each),
            (_, each @ Value::Object(_)) => (format!("[{section}.NAME]"), each),
            _ if whole["oneOf"].is_array() => (format!("[{section}]"), &whole["oneOf"][0]),
            _ => (format!("[{section}]"), whole),
        };
        let _ = write!(page, "\n## `{title}`\n");
        if let Some((_, of)) = SAME.iter().find(|(same, _)| same == section) {
            let _ =
                write!(page, "\nThe fields of `[[{of}]]`, without those that name one place.\n");
            continue;
        }
        match each["oneOf"].as_array() {
            None => entry(&mut page, section, each),
            Some(kinds) => {
                for kind in kinds {
                    let _ = write!(page, "\n### {}\n", kinds_of(kind));
                    entry(&mut page, section, kind);
                }
            }
        }
    }
    page
}

/// The words that choose an entry, as `kind = "pipe"`.
fn kinds_of(entry: &Value) -> String {
    let named = object(&entry["properties"]);
    let mut fields = named.iter().filter(|(name, _)| ["kind", "id"].contains(&name.as_str()));
    let words = fields.find_map(|(name, field)| match (&field["const"], &field["enum"]) {
        (Value::String(word), _) => Some((name, vec![word.clone()])),
        (_, Value::Array(words)) => {
            Some((name, words.iter().filter_map(|word| Some(word.as_str()?.to_owned())).collect()))
        }
        _ => None,
    });
    let Some((name, words)) = words else { return "otherwise".to_owned() };
    words.iter().map(|word| format!("`{name} = \"{word}\"`")).collect::<Vec<_>>().join(", ")
}

fn entry(page: &mut String, section: &str, entry: &Value) {
    let text = about(entry);
    if !text.is_empty() {
        let _ = write!(page, "\n{text}\n");
    }
    table(page, &entry["properties"], &entry["required"], (section, ""));
}

/// A table of fields, and after it those of the tables among them.
fn table(page: &mut String, fields: &Value, required: &Value, (section, path): (&str, &str)) {
    let fields = object(fields);
    let rows = fields.iter().filter(|(name, field)| {
        field["const"].is_null() && si_of(field, fields).is_none_or(|si| si == name.as_str())
    });
    let rows: Vec<(&String, &Value)> = rows.collect();
    if rows.is_empty() {
        return;
    }
    page.push_str("\n| field | type | default | meaning |\n|---|---|---|---|\n");
    for (name, field) in &rows {
        let units = fields.iter().filter(|(_, other)| si_of(other, fields) == Some(name.as_str()));
        let units: String = units.map(|(other, _)| format!("<br>`{other}`")).collect();
        // A number may be given in any of its units, so the schema cannot require one name.
        let must = ["number", "integer"].iter().any(|kind| field["type"] == *kind)
            || required.as_array().is_some_and(|all| all.iter().any(|one| one == *name));
        let default = match &field["default"] {
            Value::Null if must => "required".to_owned(),
            Value::Null => "optional".to_owned(),
            value => format!("`{value}`"),
        };
        let _ =
            writeln!(page, "| `{name}`{units} | {} | {default} | {} |", kind(field), about(field));
    }
    if OF_PARTS.contains(&section) {
        return;
    }
    for (name, field) in rows {
        for inner in tables(field) {
            let of = format!("{path}{name}{}", if is_named(field) { ".NAME" } else { "" });
            let _ = write!(page, "\nIn `{of}`:\n");
            table(page, &inner["properties"], &inner["required"], (section, &format!("{of}.")));
        }
    }
}

/// The field that a name is another unit of.
fn si_of<'a>(field: &'a Value, fields: &Map<String, Value>) -> Option<&'a str> {
    let (si, unit) = field["description"].as_str()?.split_once(" in ")?;
    (!unit.contains(' ') && fields.contains_key(si)).then_some(si)
}

fn is_named(field: &Value) -> bool {
    field["additionalProperties"].is_object()
}

/// The tables that a field is, holds or lists.
fn tables(field: &Value) -> Vec<&Value> {
    if field["properties"].is_object() {
        return vec![field];
    }
    let options = ["anyOf", "oneOf"].iter().filter_map(|key| field[key].as_array()).flatten();
    let inner = ["items", "additionalProperties"].iter().map(|key| &field[key]);
    options.chain(inner.filter(|inner| inner.is_object())).flat_map(tables).collect()
}

/// The type in words.
fn kind(field: &Value) -> String {
    let words = |all: &[Value]| {
        let words = all.iter().filter_map(|one| one["const"].as_str().or(one.as_str()));
        words.map(|word| format!("`\"{word}\"`")).collect::<Vec<_>>().join(", ")
    };
    if let Some(all) = field["enum"].as_array() {
        return words(all);
    }
    for key in ["oneOf", "anyOf"] {
        if let Some(all) = field[key].as_array() {
            let mut kinds = Vec::new();
            for one in all.iter().filter(|one| one["type"] != "null") {
                let one = one["const"].as_str().map_or_else(|| kind(one), |w| format!("`\"{w}\"`"));
                if !kinds.contains(&one) {
                    kinds.push(one);
                }
            }
            return kinds.join(", ");
        }
    }
    let one = |name: &str| match name {
        "array" if field["items"]["prefixItems"].is_array() => "list of pairs".to_owned(),
        "array" if field["items"].is_object() => format!("list of {}", kind(&field["items"])),
        "array" => "list".to_owned(),
        "object" => "table".to_owned(),
        "integer" => "whole number".to_owned(),
        "string" => "text".to_owned(),
        other => other.to_owned(),
    };
    match &field["type"] {
        Value::String(name) => one(name),
        Value::Array(names) => {
            let names = names.iter().filter_map(Value::as_str).filter(|name| *name != "null");
            names.map(one).collect::<Vec<_>>().join(" or ")
        }
        _ => "any".to_owned(),
    }
}

/// The description on one line, safe within a table.
fn about(field: &Value) -> String {
    let text = field["description"].as_str().unwrap_or_default();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    text.replace('|', "\\|")
}

fn object(value: &Value) -> &Map<String, Value> {
    static NONE: std::sync::LazyLock<Map<String, Value>> = std::sync::LazyLock::new(Map::new);
    value.as_object().unwrap_or(&NONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_page_is_that_of_the_schema() {
        let written = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/reference.md");
        let written = std::fs::read_to_string(written).unwrap_or_default();
        let page = page(&anergy_simulation::model_file::schema::schema());
        assert!(
            page == written,
            "the grammar has changed: anergy schema --markdown > docs/src/reference.md"
        );
    }

    #[test]
    fn units_choices_and_tables_are_read_out() {
        let schema = serde_json::json!({ "properties": { "edge": { "items": { "oneOf": [{
            "description": "A pipe\nwith a | in it.",
            "properties": {
                "kind": { "const": "pipe" },
                "length_m": { "type": "number", "description": "Length, m." },
                "length_km": { "type": "number", "description": "length_m in km" },
                "wall": { "oneOf": [{ "const": "none" }, { "const": "mixed" }], "default": "none" },
                "layers": { "type": "array", "items": { "type": "object", "properties": {
                    "t_m": { "type": ["number", "null"] }
                } } }
            }
        }] } } } });
        let page = page(&schema);
        assert!(
            page.contains("## `[[edge]]`\n\n### `kind = \"pipe\"`\n\nA pipe with a \\| in it.\n")
        );
        assert!(page.contains("| `length_m`<br>`length_km` | number | required | Length, m. |"));
        assert!(page.contains("| `wall` | `\"none\"`, `\"mixed\"` | `\"none\"` |  |"));
        assert!(page.contains("| `layers` | list of table | optional |  |"));
        assert!(page.contains("In `layers`:\n\n| field |") && page.contains("| `t_m` | number |"));
    }
}
