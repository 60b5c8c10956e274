//! A model file while it is written: entries with their fields, ids that are unique, notes.

use crate::{Import, Note, NoteKind};
use std::collections::HashSet;
use std::fmt::Write;

/// A model file being written.
#[derive(Debug, Default)]
pub(crate) struct ModelText {
    body: String,
    notes: Vec<Note>,
    node_ids: HashSet<String>,
    edge_ids: HashSet<String>,
    schedules: usize,
}

impl ModelText {
    /// Something that is left out or said otherwise.
    pub fn note(&mut self, kind: NoteKind, line: impl Into<Option<usize>>, text: String) {
        self.notes.push(Note { kind, line: line.into(), text });
    }

    /// A section that occurs once.
    pub fn section(&mut self, name: &str) -> Entry<'_> {
        self.start(&format!("[{name}]"))
    }

    /// A node; `id` must be its own.
    pub fn node(&mut self, id: &str) -> Entry<'_> {
        self.node_ids.insert(id.to_owned());
        self.start("[[node]]").text("id", id)
    }

    /// An edge; `id` must be its own.
    pub fn edge(&mut self, id: &str, kind: &str, from: &str, to: &str) -> Entry<'_> {
        self.edge_ids.insert(id.to_owned());
        let entry = self.start("[[edge]]").text("id", id).text("kind", kind);
        entry.text("from", from).text("to", to)
    }

    /// A schedule that holds its values.
    pub fn schedule(&mut self, signal: &str, points: &[(f64, f64)]) {
        self.schedules += 1;
        let points: Vec<String> = points.iter().map(|(t, v)| format!("[{t:?}, {v:?}]")).collect();
        self.start("[[schedule]]").text("signal", signal).raw("points", &list(&points));
    }

    /// Another entry that occurs several times.
    pub fn entry(&mut self, name: &str) -> Entry<'_> {
        self.start(&format!("[[{name}]]"))
    }

    /// An id for a node that the original does not have.
    pub fn new_node_id(&mut self, wanted: &str) -> String {
        unused(&self.node_ids, wanted)
    }

    /// An id for an edge that the original does not have.
    pub fn new_edge_id(&mut self, wanted: &str) -> String {
        unused(&self.edge_ids, wanted)
    }

    /// Keeps ids of the original from being taken by new ones.
    pub fn reserve<'a>(
        &mut self,
        nodes: impl Iterator<Item = &'a str>,
        edges: impl Iterator<Item = &'a str>,
    ) {
        self.node_ids.extend(nodes.map(str::to_owned));
        self.edge_ids.extend(edges.map(str::to_owned));
    }

    fn start(&mut self, header: &str) -> Entry<'_> {
        self.body.push('\n');
        self.body.push_str(header);
        self.body.push('\n');
        Entry { text: &mut self.body }
    }

    /// The file, with the notes as comments below its title.
    pub fn finish(mut self, title: &str) -> Import {
        self.notes.sort_by_key(|note| note.kind);
        let mut model = format!("# {}\n", one_line(title));
        for note in &self.notes {
            model.push_str(&format!("# {}\n", one_line(&note.to_string())));
        }
        model.push_str("format = 1\n");
        model.push_str(&self.body);
        let count = |header: &str| self.body.matches(header).count();
        Import {
            nodes: count("\n[[node]]\n") + count("\n[[site]]\n"),
            edges: count("\n[[edge]]\n") + count("\n[[trench]]\n"),
            schedules: self.schedules,
            model,
            notes: self.notes,
        }
    }
}

/// An entry that takes fields.
pub(crate) struct Entry<'a> {
    text: &'a mut String,
}

impl Entry<'_> {
    /// A field with a text.
    pub fn text(self, key: &str, value: &str) -> Self {
        self.raw(key, &quoted(value))
    }

    /// A field with a number, which must be finite.
    pub fn number(self, key: &str, value: f64) -> Self {
        self.raw(key, &format!("{value:?}"))
    }

    /// A number that is left out where it is the default.
    pub fn number_unless(self, default: f64, key: &str, value: f64) -> Self {
        if value == default { self } else { self.number(key, value) }
    }

    /// A number that may be absent.
    pub fn maybe(self, key: &str, value: Option<f64>) -> Self {
        match value {
            Some(value) => self.number(key, value),
            None => self,
        }
    }

    /// A field with a list of numbers.
    pub fn numbers(self, key: &str, values: &[f64]) -> Self {
        let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
        self.raw(key, &list(&values))
    }

    /// A field with a value as TOML writes it.
    pub fn raw(self, key: &str, value: &str) -> Self {
        // Writing to a string does not fail.
        let _ = writeln!(self.text, "{key} = {value}");
        self
    }
}

/// Items of an array, broken into lines.
fn list(items: &[String]) -> String {
    let mut text = String::from("[");
    let mut width = 0;
    for (i, item) in items.iter().enumerate() {
        if i > 0 {
            text.push(',');
            if width > 90 {
                text.push_str("\n  ");
                width = 0;
            } else {
                text.push(' ');
            }
        }
        text.push_str(item);
        width += item.len() + 2;
    }
    text.push(']');
    text
}

pub(crate) fn unused(taken: &HashSet<String>, wanted: &str) -> String {
    let numbered = (2..).map(|i| format!("{wanted}_{i}"));
    let mut candidates = std::iter::once(wanted.to_owned()).chain(numbered);
    candidates.find(|id| !taken.contains(id)).unwrap_or_default()
}

/// A basic string of TOML.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// A text that fits into a comment.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_and_notes() {
        let mut text = ModelText::default();
        text.note(NoteKind::Changed, 3, "a\nb".into());
        text.note(NoteKind::Problem, None, "first".into());
        text.node("a \"b\" \\").number("x_m", 1e-9).number_unless(0.0, "elevation_m", 0.0);
        text.schedule("a.b", &[(0.0, 1.0), (3600.0, -2.0)]);
        assert_eq!(text.new_node_id("a \"b\" \\"), "a \"b\" \\_2");
        assert_eq!(text.new_edge_id("e"), "e");
        let import = text.finish("title");
        assert_eq!(
            import.model,
            "# title\n# problem: first\n# changed: line 3: a b\nformat = 1\n\n[[node]]\n\
             id = \"a \\\"b\\\" \\\\\"\nx_m = 1e-9\n\n[[schedule]]\nsignal = \"a.b\"\n\
             points = [[0.0, 1.0], [3600.0, -2.0]]\n"
        );
        assert_eq!((import.nodes, import.edges, import.schedules), (1, 0, 1));
    }
}
