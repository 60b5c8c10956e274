//! Fields within fields: tables and lists of an entry whose numbers have units of their own.

use crate::fields::converted;
use crate::grammar::Grammar;
use serde_json::{Map, Value};

/// Levels of tables within tables.
const DEEPEST: usize = 4;

/// A field that holds fields.
#[derive(Debug, Clone, PartialEq)]
pub enum Nested {
    /// A table with given fields.
    Table(Box<Grammar>),
    /// A list of these, or a table of these by name.
    Each(Box<Nested>),
}

impl Nested {
    /// What the schema of a field describes; `None` for a plain value.
    pub fn of_property(property: &Value, definitions: &Value, depth: usize) -> Option<Self> {
        if depth > DEEPEST {
            return None;
        }
        let of = |schema: &Value| Self::of_property(schema, definitions, depth + 1);
        let reference = property.get("$ref").and_then(Value::as_str);
        if let Some(name) = reference.and_then(|path| path.strip_prefix("#/$defs/")) {
            return of(definitions.get(name)?);
        }
        if let Some(properties) = property.get("properties").and_then(Value::as_object) {
            let grammar = Grammar::of_properties(properties, Vec::new(), definitions, depth);
            return Some(Self::Table(Box::new(grammar)));
        }
        let each =
            ["items", "additionalProperties"].into_iter().find_map(|key| of(property.get(key)?));
        if let Some(each) = each {
            return Some(Self::Each(Box::new(each)));
        }
        // A field that may be absent.
        property.get("anyOf").and_then(Value::as_array)?.iter().find_map(of)
    }

    /// The value with SI fields only; what is not known stays as it is. `None` when a number is infinite in SI.
    pub fn in_si(&self, value: &Value) -> Option<Value> {
        match (self, value) {
            (Self::Table(grammar), Value::Object(fields)) => {
                let mut si = Map::new();
                for (name, value) in fields {
                    let spelling = grammar.spelling(name);
                    // The same field twice is left to be refused.
                    let spelling = spelling
                        .filter(|known| known.si == *name || !fields.contains_key(&known.si));
                    let value = match spelling.map(|known| (known.unit, grammar.nested(&known.si)))
                    {
                        Some((Some(unit), _)) => converted(value, unit)?,
                        Some((None, Some(nested))) => nested.in_si(value)?,
                        _ => value.clone(),
                    };
                    si.insert(
                        spelling.map_or_else(|| name.clone(), |known| known.si.clone()),
                        value,
                    );
                }
                Some(Value::Object(si))
            }
            (Self::Each(each), Value::Array(items)) => {
                items.iter().map(|item| each.in_si(item)).collect()
            }
            (Self::Each(each), Value::Object(named)) => {
                let named =
                    named.iter().map(|(name, value)| Some((name.clone(), each.in_si(value)?)));
                Some(Value::Object(named.collect::<Option<Map<String, Value>>>()?))
            }
            _ => Some(value.clone()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anergy_prosumer::equipment::EquipmentParams;
    use serde_json::json;

    #[test]
    fn units_within_tables() {
        let storage = Grammar::of_kind::<EquipmentParams>("storage").unwrap();
        let si = |field: &str, value: Value| storage.nested(field).unwrap().in_si(&value).unwrap();
        assert_eq!(
            si(
                "coils",
                json!({ "solar": { "area_cm2": 25000, "volume_l": 16.5, "inlet_layer": 5 } })
            ),
            json!({ "solar": { "area_m2": 2.5, "volume_m3": 0.0165, "inlet_layer": 5 } })
        );
        assert_eq!(
            si("rod", json!({ "power_kw": 6, "t_max_degc": 95.0, "layer": 7 })),
            json!({ "power_w": 6000.0, "t_max_k": 368.15, "layer": 7 })
        );
        assert_eq!(
            si("ports", json!({ "a": { "positions": [{ "inlet_cm": 160, "outlet_m": 0.2 }] } })),
            json!({ "a": { "positions": [{ "inlet_m": 1.6, "outlet_m": 0.2 }] } })
        );
        // What is unknown or given twice is left for the type to refuse.
        for left in [json!({ "power_hp": 1 }), json!({ "power_kw": 1, "power_w": 2 })] {
            assert_eq!(si("rod", left.clone()), left);
        }
        assert!(storage.nested("volume_m3").is_none());
    }
}
