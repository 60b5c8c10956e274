//! Networks of other programs as model files: EPANET input files, pandapipes nets, GeoJSON of geographic
//! information systems (also out again).
//!
//! An import reads text and gives text, a valid model file, together with the list of everything in the
//! original that the model does not say or says otherwise. Nothing is dropped without an entry in it.

pub mod epanet;
pub mod geojson;
mod model_text;
pub mod pandapipes;

use std::fmt;
use thiserror::Error;

/// A model file and what it leaves out.
#[derive(Debug, Clone, PartialEq)]
pub struct Import {
    /// The model file, with the list as comments at its head.
    pub model: String,
    /// What was not translated, or otherwise than a reader may expect.
    pub notes: Vec<Note>,
    /// Nodes written.
    pub nodes: usize,
    /// Edges written.
    pub edges: usize,
    /// Schedules written.
    pub schedules: usize,
}

/// How much a note matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoteKind {
    /// The results of the model are wrong in a part of the network.
    Problem,
    /// The original says something that the model does not.
    NotTranslated,
    /// The model says it with other means.
    Changed,
}

impl fmt::Display for NoteKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Problem => "problem",
            Self::NotTranslated => "not translated",
            Self::Changed => "changed",
        })
    }
}

/// Something in the original that the model leaves out or says otherwise.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// How much it matters.
    pub kind: NoteKind,
    /// Line of the original.
    pub line: Option<usize>,
    /// What, and why.
    pub text: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}: line {line}: {}", self.kind, self.text),
            None => write!(f, "{}: {}", self.kind, self.text),
        }
    }
}

/// Why a file cannot be imported.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{message}")]
pub struct ImportError {
    /// Line of the original.
    pub line: Option<usize>,
    /// What is wrong there.
    pub message: String,
}

impl ImportError {
    fn new(line: impl Into<Option<usize>>, message: impl Into<String>) -> Self {
        Self { line: line.into(), message: message.into() }
    }
}

/// Text of a file: UTF-8, else each byte a character (Latin-1).
fn text_of(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.trim_start_matches('\u{feff}').to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}
