//! Places in the tables of a model: rows and cells of CSV files, beside the bytes of the model text.
//!
//! A span is a range of bytes of the model text. Cells of tables are numbered on behind its end, so that
//! everything that keeps a span keeps the place of a cell as well; `Tables::located` turns such a span
//! back into file, line and column.

use crate::diagnostic::{Diagnostic, Diagnostics};
use std::collections::HashSet;
use std::ops::Range;

/// The tables a model was read from, and what many of their rows share.
#[derive(Debug, Clone, Default)]
pub struct Tables {
    tables: Vec<Table>,
    /// Parts of the model text that many entries are made from (`[station_type.NAME]`).
    pub(crate) shared: Vec<Range<usize>>,
}

/// Two models are the same wherever they stand.
impl PartialEq for Tables {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}

/// The places of one table: for every line a number per cell, and one for the whole line.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    file: String,
    columns: Vec<String>,
    /// Line of the file of each row, the header first.
    lines: Vec<u64>,
    first: usize,
    /// Where the model text names the file.
    named_at: Option<Range<usize>>,
}

impl Table {
    /// The place of a cell; row 0 is the header.
    pub(crate) fn cell(&self, row: usize, column: usize) -> Range<usize> {
        let at = self.first + row * (self.columns.len() + 1) + column;
        at..at + 1
    }

    /// The place of a whole row.
    pub(crate) fn row(&self, row: usize) -> Range<usize> {
        self.cell(row, self.columns.len())
    }

    fn end(&self) -> usize {
        self.first + self.lines.len() * (self.columns.len() + 1)
    }

    /// `nodes.csv line 3, column x_m`.
    fn in_words(&self, at: usize) -> String {
        let width = self.columns.len() + 1;
        let (row, column) = ((at - self.first) / width, (at - self.first) % width);
        let place = format!("{} line {}", self.file, self.lines[row]);
        match self.columns.get(column) {
            Some(name) => format!("{place}, column {name}"),
            None => place,
        }
    }
}

impl Tables {
    /// Adds a table; `text_end` is the length of the model text.
    pub(crate) fn add(
        &mut self,
        text_end: usize,
        file: &str,
        columns: Vec<String>,
        lines: Vec<u64>,
        named_at: Option<Range<usize>>,
    ) -> Table {
        // Behind the end of the text, where TOML has its last places.
        let first = self.tables.last().map_or(text_end + 1, Table::end);
        let table = Table { file: file.to_owned(), columns, lines, first, named_at };
        self.tables.push(table.clone());
        table
    }

    /// Problems with places in the model text: those of a cell name it, those of what many rows share
    /// are told once.
    pub(crate) fn located(&self, problems: Vec<Diagnostic>) -> Diagnostics {
        let mut told = HashSet::new();
        let mut found = Vec::with_capacity(problems.len());
        for mut problem in problems {
            if let Some(span) = problem.span.clone() {
                let inside = |table: &&Table| (table.first..table.end()).contains(&span.start);
                let shared = |range: &Range<usize>| range.contains(&span.start);
                if let Some(table) = self.tables.iter().find(inside) {
                    problem.message =
                        format!("{}: {}", table.in_words(span.start), problem.message);
                    problem.span.clone_from(&table.named_at);
                } else if self.shared.iter().any(shared)
                    && !told.insert((span.start, span.end, problem.hint.clone()))
                {
                    continue;
                }
            }
            found.push(problem);
        }
        Diagnostics(found).without_repetition()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_behind_the_text_are_cells() {
        let mut tables = Tables::default();
        let columns = || vec!["id".to_owned(), "x_m".to_owned()];
        let nodes = tables.add(100, "nodes.csv", columns(), vec![1, 2, 4], Some(10..20));
        let pipes = tables.add(100, "pipes.csv", columns(), vec![1, 2], Some(30..40));
        let said = |span: Range<usize>| {
            let problems = tables.located(vec![Diagnostic::new("wrong", Some(span))]);
            (problems.0[0].message.clone(), problems.0[0].span.clone())
        };
        assert_eq!(
            said(nodes.cell(2, 1)),
            ("nodes.csv line 4, column x_m: wrong".into(), Some(10..20))
        );
        assert_eq!(said(nodes.row(1)), ("nodes.csv line 2: wrong".into(), Some(10..20)));
        assert_eq!(
            said(pipes.cell(0, 0)),
            ("pipes.csv line 1, column id: wrong".into(), Some(30..40))
        );
        assert_eq!(said(5..6), ("wrong".into(), Some(5..6)));
    }

    #[test]
    fn what_many_rows_share_is_told_once() {
        let tables = Tables { shared: vec![Range { start: 50, end: 90 }], ..Tables::default() };
        let problem = |what: &str, at: usize| Diagnostic::new(what, Some(at..at + 2));
        let problems = vec![problem("c1: wrong", 60), problem("c2: wrong", 60), problem("c3", 20)];
        assert_eq!(tables.located(problems).0.len(), 2);
    }
}
