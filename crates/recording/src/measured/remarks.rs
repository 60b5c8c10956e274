//! What is said about a table that was read: each kind once, with the first place and the number of places.

use std::collections::BTreeMap;
use std::fmt;

/// Something that was left out, changed or is doubtful.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remark {
    /// Line of the file where it occurs first; absent where it concerns all of it.
    pub line: Option<u64>,
    /// Number of places.
    pub count: usize,
    /// What, and what to do.
    pub text: String,
}

impl Remark {
    /// About the whole file.
    pub(super) fn of_file(text: String) -> Self {
        Self { line: None, count: 1, text }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.line, self.count) {
            (None, _) => f.write_str(&self.text),
            (Some(line), 1) => write!(f, "line {line}: {}", self.text),
            (Some(line), count) => {
                write!(f, "line {line}: {} (and {} more)", self.text, count - 1)
            }
        }
    }
}

/// Remarks while a file is read.
#[derive(Default)]
pub(super) struct Remarks(BTreeMap<(u8, String), Remark>);

impl Remarks {
    /// Adds a place to a kind; `what` tells kinds of the same rank apart, for example by column.
    pub fn add(&mut self, rank: u8, what: &str, line: Option<u64>, text: impl FnOnce() -> String) {
        let entry = self.0.entry((rank, what.to_owned()));
        let remark = entry.or_insert_with(|| Remark { line, count: 0, text: text() });
        remark.count += 1;
    }

    /// In the order of their rank.
    pub fn finish(self) -> Vec<Remark> {
        self.0.into_values().collect()
    }
}
