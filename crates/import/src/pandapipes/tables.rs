//! The tables of a pandapipes net as `to_json` writes them: objects within strings within objects.

use crate::ImportError;
use serde_json::{Map, Value};
use std::borrow::Cow;

/// A net: its tables, fluid and pump types.
pub(super) struct Tables {
    net: Map<String, Value>,
}

/// A table with named columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Table {
    pub name: String,
    columns: Vec<String>,
    pub rows: Vec<Row>,
}

/// A row of a table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    pub index: i64,
    cells: Vec<Value>,
}

/// JSON of Python: numbers that JSON does not have become null.
pub(super) fn parse(text: &str) -> Result<Value, serde_json::Error> {
    const NO_NUMBERS: [&str; 3] = ["NaN", "-Infinity", "Infinity"];
    let mut out = String::with_capacity(text.len());
    let (mut rest, mut in_string) = (text, false);
    while let Some(c) = rest.chars().next() {
        let no_number = NO_NUMBERS.iter().find(|word| !in_string && rest.starts_with(**word));
        let length = match (c, no_number) {
            (_, Some(word)) => word.len(),
            // What follows a backslash does not end the string.
            ('\\', None) => 1 + rest[1..].chars().next().map_or(0, char::len_utf8),
            _ => c.len_utf8(),
        };
        in_string ^= c == '"';
        out.push_str(if no_number.is_some() { "null" } else { &rest[..length] });
        rest = &rest[length..];
    }
    serde_json::from_str(&out)
}

/// What is inside an `{"_object": ...}`, which may be a string of JSON.
pub(super) fn inside(value: &Value) -> Cow<'_, Value> {
    let Some(object) = value.get("_object") else { return Cow::Borrowed(value) };
    match object {
        Value::String(text) => match parse(text) {
            Ok(parsed) => Cow::Owned(parsed),
            Err(_) => Cow::Borrowed(object),
        },
        other => Cow::Borrowed(other),
    }
}

/// A number, also of numpy's.
pub(super) fn number(value: &Value) -> Option<f64> {
    inside(value).as_f64().filter(|value| value.is_finite())
}

/// Numbers of an array, also of numpy's.
pub(super) fn numbers(value: &Value) -> Option<Vec<f64>> {
    inside(value).as_array()?.iter().map(number).collect()
}

impl Tables {
    pub fn of(value: &Value) -> Result<Self, ImportError> {
        let error = || ImportError::new(None, "this is no net that pandapipes.to_json wrote");
        let class = value.get("_class").and_then(Value::as_str).unwrap_or_default();
        if class != "pandapipesNet" {
            return Err(error());
        }
        let net = inside(value).as_object().cloned().ok_or_else(error)?;
        if net.get("junction").is_none() {
            return Err(error());
        }
        Ok(Self { net })
    }

    /// Something that is no table.
    pub fn get(&self, name: &str) -> Option<Cow<'_, Value>> {
        self.net.get(name).map(inside)
    }

    /// Names of all tables with rows.
    pub fn filled(&self) -> Vec<(&str, usize)> {
        let of = |(name, _): (&'_ String, &Value)| self.table(name).map_or(0, |t| t.rows.len());
        let all = self.net.iter().map(|(name, value)| (name.as_str(), of((name, value))));
        all.filter(|(_, rows)| *rows > 0).collect()
    }

    /// A table; one that the net does not have is empty.
    pub fn table(&self, name: &str) -> Result<Table, ImportError> {
        let Some(value) = self.net.get(name) else { return Ok(Table::default()) };
        let table = inside(value);
        let wrong = || ImportError::new(None, format!("table {name}: it is no table"));
        let list = |key: &str| table.get(key).and_then(Value::as_array).ok_or_else(wrong);
        let columns: Vec<String> =
            list("columns")?.iter().filter_map(Value::as_str).map(str::to_owned).collect();
        let mut rows = Vec::new();
        for (index, cells) in list("index")?.iter().zip(list("data")?) {
            let index = index.as_i64().ok_or_else(wrong)?;
            let cells = cells.as_array().ok_or_else(wrong)?.clone();
            if cells.len() != columns.len() {
                return Err(wrong());
            }
            rows.push(Row { index, cells });
        }
        Ok(Table { name: name.into(), columns, rows })
    }
}

impl Table {
    fn cell<'a>(&self, row: &'a Row, column: &str) -> Option<&'a Value> {
        let at = self.columns.iter().position(|name| name == column)?;
        row.cells.get(at).filter(|cell| !cell.is_null())
    }

    pub fn error(&self, row: &Row, message: &str) -> ImportError {
        ImportError::new(None, format!("table {}, index {}: {message}", self.name, row.index))
    }

    pub fn maybe(&self, row: &Row, column: &str) -> Option<f64> {
        self.cell(row, column).and_then(number)
    }

    pub fn number(&self, row: &Row, column: &str) -> Result<f64, ImportError> {
        self.maybe(row, column)
            .ok_or_else(|| self.error(row, &format!("{column} is missing or no number")))
    }

    pub fn positive(&self, row: &Row, column: &str) -> Result<f64, ImportError> {
        match self.number(row, column)? {
            value if value > 0.0 => Ok(value),
            value => Err(self.error(row, &format!("{column} = {value} must be positive"))),
        }
    }

    pub fn integer(&self, row: &Row, column: &str) -> Result<i64, ImportError> {
        self.cell(row, column)
            .and_then(Value::as_i64)
            .ok_or_else(|| self.error(row, &format!("{column} is missing or no integer")))
    }

    pub fn text<'a>(&self, row: &'a Row, column: &str) -> Option<&'a str> {
        self.cell(row, column).and_then(Value::as_str)
    }

    /// A flag; absent is yes.
    pub fn flag(&self, row: &Row, column: &str) -> bool {
        self.cell(row, column).and_then(Value::as_bool).unwrap_or(true)
    }

    /// Inner diameter in m: `inner_diameter_mm` since pandapipes 0.13, `diameter_m` before.
    pub fn diameter_m(&self, row: &Row) -> Result<f64, ImportError> {
        if self.cell(row, "inner_diameter_mm").is_some() {
            Ok(1e-3 * self.positive(row, "inner_diameter_mm")?)
        } else {
            self.positive(row, "diameter_m")
        }
    }

    /// Rows that are in service.
    pub fn in_service(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| self.flag(row, "in_service"))
    }
}
