//! Nodes and pipes of a network from CSV tables: a row means the same as an entry of the model file.
//!
//! A row of the nodes is a `[[site]]`, with a station type in its column `station` also a `[[station]]`
//! and its `[[unit]]`; a row of the pipes is a `[[trench]]`. A column is named like the field, or like
//! the way to it: `extraction_valve.kvs_m3_h`, `unit.load_kw`. An empty cell is a field not given.

mod columns;

use super::{comma, two_lines};
use crate::diagnostic::Diagnostic;
use crate::document::Span;
use crate::document::{Key, Tree, TreeKind};
use crate::table::{Table, Tables};
use anergy_core::units::split_suffix;
use columns::{guess, is_site_field, known};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;

/// `[network]`: tables with the nodes and pipes of a network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NetworkEntry {
    /// The file with a site per row, relative to the model file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nodes: Option<String>,
    /// The file with a trench per row, relative to the model file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pipes: Option<String>,
    /// Names of the lines of all sites of the table, the hot one first.
    #[serde(default = "two_lines")]
    pub lines: Vec<String>,
    /// Field separator of both files.
    #[serde(default = "comma")]
    pub separator: char,
}

/// What a table holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Content {
    Nodes,
    Pipes,
}

/// The separators that cannot be part of a number or a name.
pub(super) fn separator_byte(separator: char) -> Option<u8> {
    u8::try_from(separator).ok().filter(|byte| {
        byte.is_ascii() && !byte.is_ascii_alphanumeric() && !b".+-#\"\r\n".contains(byte)
    })
}

/// A column: the part of the station it belongs to, and the field.
struct Column {
    part: Option<String>,
    field: String,
}

/// The entries of a table by section.
pub(super) type Rows = HashMap<&'static str, Vec<Tree>>;

/// Reads a table; problems have the places of its cells.
pub(super) struct TableReader<'a> {
    /// Folder of the model file.
    pub dir: &'a Path,
    /// Length of the model text.
    pub text_end: usize,
    /// The `[network]` section.
    pub entry: &'a NetworkEntry,
    /// Where the places are kept.
    pub tables: &'a mut Tables,
    /// What is wrong.
    pub problems: &'a mut Vec<Diagnostic>,
}

impl TableReader<'_> {
    /// The entries of a file; `named` is where the model text names it. False when a problem leaves
    /// some of them unknown.
    pub(super) fn read(
        &mut self,
        content: Content,
        file: &str,
        named: &Tree,
        rows: &mut Rows,
    ) -> bool {
        let before = self.problems.len();
        self.try_read(content, file, named, rows);
        self.problems.len() == before
    }

    fn try_read(&mut self, content: Content, file: &str, named: &Tree, rows: &mut Rows) {
        let refused = |message: String| Diagnostic::new(message, named.span.range());
        let Some(separator) = separator_byte(self.entry.separator) else { return };
        let bytes = match std::fs::read(self.dir.join(file)) {
            Ok(bytes) => bytes,
            Err(error) => {
                let hint = "the path is relative to the folder of the model file";
                let message = format!("network: cannot read {file}: {error}");
                return self.problems.push(refused(message).with_hint(hint));
            }
        };
        let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes);
        let reader = || {
            csv::ReaderBuilder::new()
                .delimiter(separator)
                .comment(Some(b'#'))
                .trim(csv::Trim::All)
                .flexible(true)
                .has_headers(false)
                .from_reader(text)
        };
        // Twice: first the lines, which all places count on, then row by row.
        let (mut header, mut lines) = (csv::StringRecord::new(), Vec::new());
        for record in reader().records() {
            match record {
                Ok(record) => {
                    lines.push(record.position().map_or(0, csv::Position::line));
                    if lines.len() == 1 {
                        header = record;
                    }
                }
                Err(error) => {
                    let hint = "the file must be a table of text in UTF-8";
                    let problem = refused(format!("network: {file}: {error}")).with_hint(hint);
                    return self.problems.push(problem);
                }
            }
        }
        if lines.is_empty() {
            let hint =
                "the first line names the columns, for example ".to_owned() + example(content);
            return self
                .problems
                .push(refused(format!("network: {file} is empty")).with_hint(hint));
        }
        if lines.len() == 1 {
            self.problems.push(refused(format!("network: {file} has no rows below its header")));
        }
        let names: Vec<String> = header.iter().map(str::to_owned).collect();
        let table = self.tables.add(self.text_end, file, names.clone(), lines, named.span.range());
        let before = self.problems.len();
        let columns = self.columns(content, &names, &table);
        if self.problems.len() > before {
            // Without its columns a table says nothing: every row would be reported.
            return;
        }
        for (row, record) in reader().records().enumerate().skip(1) {
            // It was read before.
            let Ok(record) = &record else { return };
            if record.len() != names.len() {
                let message = format!("{} values for {} columns", record.len(), names.len());
                let hint = format!(
                    "separate the values by {:?}, and put those that contain it in double quotes",
                    self.entry.separator
                );
                let problem = Diagnostic::new(message, Some(table.row(row)));
                self.problems.push(problem.with_hint(hint));
                continue;
            }
            let Some(cells) = self.cells(&columns, record, &table, row) else { continue };
            match content {
                Content::Nodes => self.node(cells, table.row(row), rows),
                Content::Pipes => {
                    let entries =
                        cells.into_iter().map(|(column, cell)| entry(&column.field, cell));
                    let kind = TreeKind::Table(entries.collect());
                    let tree = Tree { span: table.row(row).into(), kind };
                    rows.entry("trench").or_default().push(tree);
                }
            }
        }
    }

    /// The columns of a table; every unknown, doubled or missing one is reported.
    fn columns(&mut self, content: Content, names: &[String], table: &Table) -> Vec<Column> {
        let mut columns: Vec<Column> = Vec::new();
        let mut quantities: Vec<(Option<String>, String)> = Vec::new();
        for (i, name) in names.iter().enumerate() {
            let (part, field) = match name.split_once('.') {
                Some((part, field)) => (Some(part.to_owned()), field.to_owned()),
                None => (None, name.clone()),
            };
            let at = Some(table.cell(0, i));
            if !known(content, part.as_deref(), &field) {
                let problem = if name.is_empty() {
                    Diagnostic::new("a column has no name", at).with_hint("name it, or take it out")
                } else {
                    let message =
                        format!("there is no field `{name}` in a table of {}", content.word());
                    Diagnostic::new(message, at).with_hint(guess(content, name))
                };
                self.problems.push(problem);
                continue;
            }
            let stem = split_suffix(&field).map_or(field.as_str(), |(stem, _)| stem).to_owned();
            let quantity = (part.clone(), stem);
            if quantities.contains(&quantity) {
                let problem = Diagnostic::new("the table has this quantity twice", at);
                self.problems.push(problem.with_hint("take one of the two columns out"));
            }
            quantities.push(quantity);
            columns.push(Column { part, field });
        }
        for needed in content.needed() {
            let unreadable = columns.len() < names.len();
            if !unreadable && !quantities.contains(&(None, (*needed).to_owned())) {
                let name = if *needed == "length" { "length_m" } else { needed };
                let problem =
                    Diagnostic::new(format!("column {name} is missing"), Some(table.row(0)));
                let hint = format!("the first line is for example {}", example(content));
                self.problems.push(problem.with_hint(hint));
            }
        }
        columns
    }

    /// The cells of a row that are not empty; `None` after a report.
    fn cells<'c>(
        &mut self,
        columns: &'c [Column],
        record: &csv::StringRecord,
        table: &Table,
        row: usize,
    ) -> Option<Vec<(&'c Column, Tree)>> {
        let before = self.problems.len();
        let mut cells = Vec::new();
        for (i, (column, text)) in columns.iter().zip(record).enumerate() {
            if text.is_empty() {
                continue;
            }
            let value = value(&column.field, text);
            if split_suffix(&column.field).is_some() && !value.is_number() {
                let message = format!("\"{text}\" is not a finite number");
                let hint = if text.contains(',') {
                    "write a decimal point"
                } else {
                    "write the number alone: the unit is the end of the column's name"
                };
                let problem = Diagnostic::new(message, Some(table.cell(row, i)));
                self.problems.push(problem.with_hint(hint));
                continue;
            }
            cells.push((column, Tree::from_json(&value, table.cell(row, i).into())));
        }
        (self.problems.len() == before).then_some(cells)
    }

    /// The site of a row, and its station where the row names a type.
    fn node(&mut self, cells: Vec<(&Column, Tree)>, span: std::ops::Range<usize>, rows: &mut Rows) {
        let (mut site, mut station) = (Vec::new(), Vec::new());
        let mut parts: Vec<(String, Vec<(Key, Tree)>)> = Vec::new();
        for (column, cell) in cells {
            let entry = entry(&column.field, cell);
            match &column.part {
                Some(part) => match parts.iter_mut().find(|(name, _)| name == part) {
                    Some((_, entries)) => entries.push(entry),
                    None => parts.push((part.clone(), vec![entry])),
                },
                None if is_site_field(&column.field) => {
                    if column.field == "id" {
                        let key = Key { name: "site".into(), span: entry.0.span };
                        station.push((key, entry.1.clone()));
                    }
                    site.push(entry);
                }
                None => station.push(entry),
            }
        }
        let spanned = Span::from(span);
        let key = |name: &str| Key { name: name.into(), span: spanned };
        let table = |entries| Tree { span: spanned, kind: TreeKind::Table(entries) };
        site.push((key("lines"), Tree::from_json(&json!(self.entry.lines), spanned)));
        site.shrink_to_fit();
        rows.entry("site").or_default().push(table(site));
        let with_station = station.iter().any(|(key, _)| key.name == "type");
        let given = station.iter().find(|(key, _)| !["type", "site"].contains(&key.name.as_str()));
        let alone = given.map(|(_, tree)| tree.span.range());
        let alone = alone.or_else(|| parts.first().map(|(_, cells)| cells[0].1.span.range()));
        station.extend(parts.into_iter().map(|(name, cells)| (key(&name), table(cells))));
        if with_station {
            station.shrink_to_fit();
            rows.entry("station").or_default().push(table(station));
        } else if let Some(span) = alone {
            let problem = Diagnostic::new("this belongs to a station, and the row has none", span);
            let hint = "name a [station_type.NAME] in the column station, or leave the cell empty";
            self.problems.push(problem.with_hint(hint));
        }
    }
}

impl Content {
    fn word(self) -> &'static str {
        match self {
            Self::Nodes => "nodes",
            Self::Pipes => "pipes",
        }
    }

    /// The columns without which a table says nothing.
    fn needed(self) -> &'static [&'static str] {
        match self {
            Self::Nodes => &["id"],
            Self::Pipes => &["from", "to", "length"],
        }
    }
}

fn example(content: Content) -> &'static str {
    match content {
        Content::Nodes => "id,x_m,y_m,elevation_m,station,unit.load_kw",
        Content::Pipes => "from,to,length_m,pipe",
    }
}

fn entry(field: &str, cell: Tree) -> (Key, Tree) {
    let name = if field == "station" { "type" } else { field };
    (Key { name: name.into(), span: cell.span }, cell)
}

/// Names are texts, whatever they look like.
fn value(field: &str, text: &str) -> Value {
    if ["id", "from", "to", "pipe", "station", "kind"].contains(&field) {
        return Value::from(text);
    }
    let whole = text.parse::<i64>().ok().map(Value::from);
    let number = || text.parse::<f64>().ok().and_then(serde_json::Number::from_f64);
    let flag = || text.parse::<bool>().ok().map(Value::from);
    whole.or_else(|| number().map(Value::Number)).or_else(flag).unwrap_or_else(|| text.into())
}
