//! Where entries and their fields stand in the model text, and how they are written there: kept small,
//! because a large network has a million of them.

use crate::document::Span;
use crate::grammar::Spelling;
use serde_json::{Number, Value};
use smol_str::SmolStr;
use std::ops::Range;

/// A field as it was written.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenField {
    spelling: &'static Spelling,
    value: Written,
    /// The place of the value.
    pub span: Span,
}

/// What messages repeat of a value.
#[derive(Debug, Clone, PartialEq)]
enum Written {
    Number(Number),
    List(Box<Value>),
    Other,
}

impl WrittenField {
    /// A field with its value in the file.
    pub fn new(spelling: &'static Spelling, value: Value, span: Span) -> Self {
        let value = match value {
            Value::Number(number) => Written::Number(number),
            Value::Array(_) => Written::List(Box::new(value)),
            _ => Written::Other,
        };
        Self { spelling, value, span }
    }

    /// Its SI name.
    pub fn si(&self) -> &'static str {
        &self.spelling.si
    }

    /// Its name in the file.
    pub fn name(&self) -> &'static str {
        &self.spelling.name
    }

    /// Its value in the file, where that is a number or an array; else `Null`.
    pub fn value(&self) -> Value {
        match &self.value {
            Written::Number(number) => Value::Number(number.clone()),
            Written::List(list) => (**list).clone(),
            Written::Other => Value::Null,
        }
    }

    /// The same in SI.
    pub fn si_value(&self) -> Value {
        let value = self.value();
        match self.spelling.unit {
            Some(unit) => crate::fields::converted(&value, unit).unwrap_or_default(),
            None => value,
        }
    }
}

/// Where an entry and its fields stand in the model text, and how they are written there.
#[derive(Debug, Clone, Default)]
pub struct Place {
    /// What the user wrote, in words: `edge "p1" (pipe)`, or the composite it comes from, such as
    /// `trench "a-b"`. Empty for what does not come from a file.
    pub entry: SmolStr,
    /// The whole entry.
    pub span: Span,
    /// The fields that were given.
    pub fields: Box<[WrittenField]>,
}

/// Two entries are the same wherever they stand.
impl PartialEq for Place {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}

impl Place {
    /// The place of a field, or of the entry.
    pub fn of(&self, field: &str) -> Option<Range<usize>> {
        self.fields
            .iter()
            .find(|written| written.si() == field)
            .map_or(self.span, |written| written.span.or(self.span))
            .range()
    }

    /// What the user wrote, or `otherwise` where there is no file.
    pub fn entry_or<'a>(&'a self, otherwise: &'a str) -> &'a str {
        if self.entry.is_empty() { otherwise } else { &self.entry }
    }

    /// Whether a field was given.
    pub fn has(&self, field: &str) -> bool {
        self.fields.iter().any(|written| written.si() == field)
    }
}
