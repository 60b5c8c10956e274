//! The fields that an entry can have, and every unit they can be written in.

use crate::effects::EffectParams;
use crate::nested::Nested;
use anergy_control::controllers::ControllerParams;
use anergy_core::units::{Unit, alternatives, split_suffix};
use anergy_network::elements::ElementParams;
use anergy_prosumer::equipment::EquipmentParams;
use schemars::{JsonSchema, Schema};
use serde_json::{Map, Value};
use std::any::TypeId;
use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

/// The fields of one entry, from its JSON Schema.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Grammar {
    /// SI names in the order of the schema.
    pub fields: Vec<String>,
    /// Those without a default.
    pub required: Vec<String>,
    /// Every name a field can be written with.
    spellings: HashMap<&'static str, &'static Spelling>,
    /// Fields that hold fields.
    nested: HashMap<String, Nested>,
}

/// A name that a field can be written with.
#[derive(Debug, PartialEq)]
pub struct Spelling {
    /// The SI name of the field.
    pub si: String,
    /// The name in the file.
    pub name: String,
    /// The unit to convert from; `None` for SI.
    pub unit: Option<Unit>,
}

impl Spelling {
    /// A spelling for the rest of the process: those of the grammars, which are made once.
    fn kept(si: &str, name: &str, unit: Option<Unit>) -> &'static Self {
        Box::leak(Box::new(Self { si: si.to_owned(), name: name.to_owned(), unit }))
    }

    /// A word that is written in one way only, such as `id`.
    pub fn word(word: &'static str) -> &'static Self {
        static WORDS: Mutex<BTreeMap<&'static str, &'static Spelling>> =
            Mutex::new(BTreeMap::new());
        let mut words = WORDS.lock().unwrap_or_else(PoisonError::into_inner);
        words.entry(word).or_insert_with(|| Self::kept(word, word, None))
    }
}

/// The parameters of a registry: one kind of entry per word of `kind`.
pub trait Registered: Sized + 'static {
    /// The words.
    const KINDS: &'static [&'static str];

    /// JSON Schema of a kind.
    fn schema(kind: &str) -> Option<Schema>;

    /// Parameters of a kind.
    ///
    /// # Errors
    /// What the deserializer says.
    fn deserialize<'de, D: serde::Deserializer<'de>>(
        kind: &str,
        deserializer: D,
    ) -> Option<Result<Self, D::Error>>;
}

macro_rules! registered {
    ($($params:ty),+) => {$(
        impl Registered for $params {
            const KINDS: &'static [&'static str] = <$params>::KINDS;

            fn schema(kind: &str) -> Option<Schema> {
                <$params>::schema(kind)
            }

            fn deserialize<'de, D: serde::Deserializer<'de>>(
                kind: &str,
                deserializer: D,
            ) -> Option<Result<Self, D::Error>> {
                <$params>::deserialize(kind, deserializer)
            }
        }
    )+};
}

registered!(ElementParams, EquipmentParams, ControllerParams, EffectParams);

/// Making a schema takes longer than reading an entry with it, so each is made once in a process.
static KNOWN: Mutex<BTreeMap<(TypeId, &'static str), Arc<Grammar>>> = Mutex::new(BTreeMap::new());

fn known(key: (TypeId, &'static str), make: impl FnOnce() -> Option<Schema>) -> Arc<Grammar> {
    // A grammar is inserted whole: one that panicked elsewhere has left nothing half done.
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let grammar = known.entry(key).or_insert_with(|| {
        Arc::new(make().map_or_else(Grammar::default, |schema| Grammar::of_schema(&schema)))
    });
    Arc::clone(grammar)
}

impl Grammar {
    /// The grammar of an entry that has one kind.
    pub fn of<T: JsonSchema + 'static>() -> Arc<Self> {
        known((TypeId::of::<T>(), ""), || Some(schemars::schema_for!(T)))
    }

    /// The grammar of a kind of a registry; `None` for an unknown word.
    pub fn of_kind<P: Registered>(kind: &str) -> Option<Arc<Self>> {
        let word = P::KINDS.iter().find(|word| **word == kind)?;
        Some(known((TypeId::of::<P>(), word), || P::schema(word)))
    }

    /// The grammar that a schema describes.
    fn of_schema(schema: &Schema) -> Self {
        let required = schema.get("required").and_then(Value::as_array);
        let required = required.into_iter().flatten().filter_map(Value::as_str);
        let properties = schema.get("properties").and_then(Value::as_object).cloned();
        let definitions = schema.get("$defs").cloned().unwrap_or_default();
        let required = required.map(str::to_owned).collect();
        Self::of_properties(&properties.unwrap_or_default(), required, &definitions, 0)
    }

    /// The grammar of the properties of a schema.
    pub(crate) fn of_properties(
        properties: &Map<String, Value>,
        required: Vec<String>,
        definitions: &Value,
        depth: usize,
    ) -> Self {
        let nested = properties.iter().filter_map(|(name, property)| {
            Some((name.clone(), Nested::of_property(property, definitions, depth)?))
        });
        let nested = nested.collect();
        Self { nested, ..Self::new(properties.keys().cloned().collect(), required) }
    }

    /// What a field holds that has fields of its own.
    pub fn nested(&self, field: &str) -> Option<&Nested> {
        self.nested.get(field)
    }

    fn new(fields: Vec<String>, required: Vec<String>) -> Self {
        let mut spellings: HashMap<&str, &Spelling> = HashMap::new();
        // A field's own name is no other field in another unit.
        for field in &fields {
            let own = Spelling::kept(field, field, None);
            spellings.insert(&own.name, own);
        }
        for field in &fields {
            for (name, unit) in alternatives(field) {
                if !spellings.contains_key(name.as_str()) {
                    let other = Spelling::kept(field, &name, Some(unit));
                    spellings.insert(&other.name, other);
                }
            }
        }
        Self { fields, required, spellings, nested: HashMap::new() }
    }

    /// The same fields, all of which may be absent.
    #[must_use]
    pub fn all_optional(&self) -> Self {
        Self { required: Vec::new(), ..self.clone() }
    }

    /// The SI field that a name in the file means, and the unit to convert from.
    pub fn field(&self, name: &str) -> Option<(&'static str, Option<Unit>)> {
        self.spelling(name).map(|spelling| (spelling.si.as_str(), spelling.unit))
    }

    /// The spelling of a field that a name in the file is.
    pub fn spelling(&self, name: &str) -> Option<&'static Spelling> {
        self.spellings.get(name).copied()
    }

    /// All names a field can be written with, SI first.
    pub fn spellings(field: &str) -> Vec<String> {
        std::iter::once(field.to_owned()).chain(alternatives(field).map(|(name, _)| name)).collect()
    }

    /// The field of the same quantity as a name whose unit does not fit, or is none at all.
    pub fn same_quantity(&self, name: &str) -> Option<&str> {
        let quantity = |field: &str| split_suffix(field).map(|(stem, _)| stem.to_owned());
        let is_unit = |rest: &str| rest.starts_with('_');
        self.fields
            .iter()
            .find(|field| quantity(name).is_some() && quantity(field) == quantity(name))
            .or_else(|| {
                let starts = |field: &&String| {
                    quantity(field).is_some_and(|stem| {
                        name == stem || name.strip_prefix(&stem).is_some_and(is_unit)
                    })
                };
                // The longest quantity wins: `head_max_x` is no `head`.
                self.fields
                    .iter()
                    .filter(starts)
                    .max_by_key(|field| quantity(field).map(|q| q.len()))
            })
            .map(String::as_str)
    }
}

/// The names of the fields of an object schema.
pub fn property_names(schema: &Schema) -> Vec<String> {
    schema
        .get("properties")
        .and_then(Value::as_object)
        .map(|properties| properties.keys().cloned().collect())
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grammar_is_made_once() {
        let first = Grammar::of_kind::<ElementParams>("pipe").unwrap();
        let again = Grammar::of_kind::<ElementParams>("pipe").unwrap();
        assert!(Arc::ptr_eq(&first, &again));
        assert!(first.required.contains(&"length_m".to_owned()));
        assert!(Grammar::of_kind::<ElementParams>("turbine").is_none());
        let pump = Grammar::of_kind::<ElementParams>("pump").unwrap();
        assert_ne!(first, pump);
    }

    #[test]
    fn a_wrong_unit_shows_the_quantity() {
        let pipe = Grammar::of_kind::<ElementParams>("pipe").unwrap();
        for name in ["inner_diameter_inch", "inner_diameter_bar", "inner_diameter"] {
            assert_eq!(pipe.same_quantity(name), Some("inner_diameter_m"), "{name}");
        }
        assert_eq!(pipe.same_quantity("colour"), None);
        assert_eq!(pipe.field("length_km").unwrap().0, "length_m");
    }
}
