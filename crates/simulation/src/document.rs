//! A model text as a tree of values that remember their place; TOML or JSON.

mod pieces;
mod span;

pub use span::Span;

use crate::diagnostic::{Diagnostic, Diagnostics};
use serde_json::{Map, Number, Value};
use smol_str::SmolStr;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// A value with its place in the text.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    /// Where it stands in the text.
    pub span: Span,
    /// What it is.
    pub kind: TreeKind,
}

/// A table, an array or a single value.
#[derive(Debug, Clone, PartialEq)]
pub enum TreeKind {
    /// Keys in the order of the text.
    Table(Vec<(Key, Tree)>),
    /// Elements in order.
    Array(Vec<Tree>),
    /// A single value.
    Scalar(Scalar),
}

/// A single value.
#[derive(Debug, Clone, PartialEq)]
pub enum Scalar {
    /// A string.
    Text(SmolStr),
    /// A number.
    Number(Number),
    /// A boolean.
    Flag(bool),
    /// None of these: it has been reported.
    Nothing,
}

impl From<&Value> for Scalar {
    fn from(value: &Value) -> Self {
        match value {
            Value::String(text) => Self::Text(text.into()),
            Value::Number(number) => Self::Number(number.clone()),
            Value::Bool(flag) => Self::Flag(*flag),
            _ => Self::Nothing,
        }
    }
}

impl From<&Scalar> for Value {
    fn from(scalar: &Scalar) -> Self {
        match scalar {
            Scalar::Text(text) => Self::String(text.to_string()),
            Scalar::Number(number) => Self::Number(number.clone()),
            Scalar::Flag(flag) => Self::Bool(*flag),
            Scalar::Nothing => Self::Null,
        }
    }
}

/// A key with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// The word.
    pub name: SmolStr,
    /// Where it stands in the text.
    pub span: Span,
}

impl Tree {
    /// A table made by the program, at the place of what it was made from.
    pub fn table(span: Span, entries: Vec<(&str, Value)>) -> Self {
        let entries = entries
            .into_iter()
            .map(|(name, value)| (Key { name: name.into(), span }, Self::from_json(&value, span)))
            .collect();
        Self { span, kind: TreeKind::Table(entries) }
    }

    /// A JSON value; every part gets the same place.
    pub fn from_json(value: &Value, span: Span) -> Self {
        let kind = match value {
            Value::Object(map) => TreeKind::Table(
                map.iter()
                    .map(|(name, value)| {
                        let key = Key { name: name.into(), span };
                        (key, Self::from_json(value, span))
                    })
                    .collect(),
            ),
            Value::Array(items) => {
                TreeKind::Array(items.iter().map(|item| Self::from_json(item, span)).collect())
            }
            scalar => TreeKind::Scalar(scalar.into()),
        };
        Self { span, kind }
    }

    /// The value without places.
    pub fn to_json(&self) -> Value {
        match &self.kind {
            TreeKind::Table(entries) => Value::Object(
                entries.iter().map(|(key, tree)| (key.name.to_string(), tree.to_json())).collect(),
            ),
            TreeKind::Array(items) => Value::Array(items.iter().map(Self::to_json).collect()),
            TreeKind::Scalar(scalar) => scalar.into(),
        }
    }

    /// The entries of a table; nothing for other kinds.
    pub fn entries(&self) -> &[(Key, Tree)] {
        match &self.kind {
            TreeKind::Table(entries) => entries,
            _ => &[],
        }
    }

    /// The value of a key.
    pub fn get(&self, name: &str) -> Option<&Self> {
        self.entries().iter().find(|(key, _)| key.name == name).map(|(_, tree)| tree)
    }

    /// The string value of a key.
    pub fn text(&self, name: &str) -> Option<&str> {
        match &self.get(name)?.kind {
            TreeKind::Scalar(Scalar::Text(text)) => Some(text),
            _ => None,
        }
    }

    /// Takes a key out of a table.
    pub fn take(&mut self, name: &str) -> Option<(Key, Tree)> {
        let TreeKind::Table(entries) = &mut self.kind else { return None };
        let at = entries.iter().position(|(key, _)| key.name == name)?;
        Some(entries.remove(at))
    }

    /// Adds the entries of `defaults` whose keys are not there.
    pub fn fill_from(&mut self, defaults: &Self) {
        if let TreeKind::Table(entries) = &mut self.kind {
            for (key, tree) in defaults.entries() {
                if !entries.iter().any(|(own, _)| own.name == key.name) {
                    entries.push((key.clone(), tree.clone()));
                }
            }
        }
    }

    /// What the value is called in an error message.
    pub fn type_name(&self) -> &'static str {
        match &self.kind {
            TreeKind::Table(_) => "a table",
            TreeKind::Array(_) => "an array",
            TreeKind::Scalar(Scalar::Text(_)) => "a string",
            TreeKind::Scalar(Scalar::Number(_)) => "a number",
            TreeKind::Scalar(Scalar::Flag(_)) => "a boolean",
            TreeKind::Scalar(Scalar::Nothing) => "nothing",
        }
    }
}

/// Parses TOML text.
///
/// # Errors
/// The syntax errors, or numbers that are not finite, with their places.
pub fn parse_toml(text: &str) -> Result<Tree, Diagnostics> {
    pieces::parse_large(text).map_or_else(|| parse(text, 0), Ok)
}

/// Parses a text that begins at a byte of another one.
fn parse(text: &str, first: usize) -> Result<Tree, Diagnostics> {
    let (table, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        let problems = errors.iter().map(|error| {
            Diagnostic::new(format!("not valid TOML: {}", error.message()), error.span())
        });
        return Err(Diagnostics(problems.collect()));
    }
    let mut converter = Converter { first, problems: Vec::new() };
    let tree = converter.table(table.get_ref(), table.span());
    let Converter { problems, .. } = converter;
    if problems.is_empty() { Ok(tree) } else { Err(Diagnostics(problems)) }
}

/// Turns what the parser says into a tree.
struct Converter {
    /// Where the text begins.
    first: usize,
    problems: Vec<Diagnostic>,
}

impl Converter {
    fn span(&self, range: Range<usize>) -> Span {
        (self.first + range.start..self.first + range.end).into()
    }

    fn table(&mut self, table: &DeTable<'_>, range: Range<usize>) -> Tree {
        let entries = table.iter().map(|(key, value)| {
            let name = SmolStr::new(key.get_ref());
            let tree = self.value(value.get_ref(), value.span(), &name);
            (Key { name, span: self.span(key.span()) }, tree)
        });
        let kind = TreeKind::Table(entries.collect());
        Tree { span: self.span(range), kind }
    }

    fn value(&mut self, value: &DeValue<'_>, range: Range<usize>, name: &str) -> Tree {
        let span = self.span(range.clone());
        let mut wrong = |what: String| {
            let problem = Diagnostic::new(format!("{name} = {what}"), span.range());
            self.problems.push(problem);
            Scalar::Nothing
        };
        let scalar = match value {
            DeValue::String(text) => Scalar::Text(text.as_ref().into()),
            DeValue::Boolean(flag) => Scalar::Flag(*flag),
            DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
                .map_or_else(
                    |_| wrong(format!("{integer} is too large a number")),
                    |integer| Scalar::Number(integer.into()),
                ),
            DeValue::Float(float) => {
                let number = float.as_str().parse::<f64>().ok().and_then(Number::from_f64);
                number.map_or_else(
                    || wrong(format!("{} is not a finite number", float.as_str())),
                    Scalar::Number,
                )
            }
            DeValue::Datetime(datetime) => Scalar::Text(datetime.to_string().into()),
            DeValue::Array(items) => {
                let items = items.iter().map(|item| self.value(item.get_ref(), item.span(), name));
                return Tree { kind: TreeKind::Array(items.collect()), span };
            }
            DeValue::Table(table) => return self.table(table, range),
        };
        Tree { span, kind: TreeKind::Scalar(scalar) }
    }
}

/// Writes a JSON object as TOML text.
///
/// # Errors
/// When the object has something TOML cannot hold (`null`).
pub fn to_toml(value: &Map<String, Value>) -> Result<String, Diagnostics> {
    toml::to_string(value).map_err(|error| {
        Diagnostics(vec![Diagnostic::new(format!("cannot be written as TOML: {error}"), None)])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_keep_their_places() {
        let text = "[run]\nstep = \"1s\"\n[[edge]]\nid = \"p\"\nlength_m = 2_00.5\n";
        let tree = parse_toml(text).unwrap();
        let edges = tree.get("edge").unwrap();
        let TreeKind::Array(items) = &edges.kind else { panic!() };
        let length = items[0].get("length_m").unwrap();
        assert_eq!(&text[length.span.range().unwrap()], "2_00.5");
        assert_eq!(length.to_json(), Value::from(200.5));
        assert_eq!(tree.get("run").unwrap().text("step"), Some("1s"));
    }

    #[test]
    fn nan_and_syntax_errors_have_a_place() {
        let error = parse_toml("a = 1\nb = nan\n").unwrap_err();
        assert_eq!(error.render("a = 1\nb = nan\n"), "2:5: b = nan is not a finite number\n");
        assert!(parse_toml("a = \n").unwrap_err().0[0].span.is_some());
    }
}
