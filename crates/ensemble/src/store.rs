//! A folder that keeps what has finished, also of an ensemble that is killed, and goes on from there.
//!
//! | file | content |
//! |---|---|
//! | `ensemble.json` | whose results these are: model, variations, version of the program |
//! | `journal.jsonl` | a line per finished member, appended as they finish |
//! | `members.csv` | a row per member in their order: values, error, indicators; written at the end and when stopped |
//! | `channels/member-N.csv` | chosen channels of a member |
//! | `ensemble.lock` | locked while one writes |
//!
//! The last line of a killed journal may be torn: its member runs again. Any other line that cannot be read was not left
//! by this program, and is told instead of being run again.

use crate::ensemble::Ensemble;
use crate::lock::FolderLock;
use crate::member::{Kept, Outcome, Series};
use anergy_simulation::diagnostic::Diagnostics;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, HashSet};
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a folder cannot be used.
#[derive(Debug, Error)]
pub enum StoreError {
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The results of another ensemble are there.
    #[error(
        "{} has the results of another ensemble (other {what}): name another folder, or delete it", folder.display()
    )]
    Other {
        /// The folder.
        folder: PathBuf,
        /// What differs.
        what: &'static str,
    },
    /// Another one writes into the folder.
    #[error("{} is written by another run: wait for it, or name another folder", folder.display())]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// A line of the journal is not one that this program has written.
    #[error(
        "{}:{line}: {reason}: restore the line, or delete it, and its member runs again", path.display()
    )]
    Line {
        /// The journal.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// The ensemble cannot be recognised.
    #[error("the model cannot be written, so its results could not be told from others: {0}")]
    Identity(Diagnostics),
}

fn file_error(path: &Path) -> impl Fn(io::Error) -> StoreError {
    move |source| StoreError::File { path: path.to_owned(), source }
}

/// A line of the journal.
#[derive(Debug, Serialize, Deserialize)]
struct Line {
    member: usize,
    values: Vec<Value>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    #[serde(default, skip_serializing_if = "Map::is_empty")]
    kpis: Map<String, Value>,
}

/// The folder of an ensemble.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    /// Names of variations and channels.
    names: Vec<String>,
    channels: Vec<String>,
    journal: File,
    /// Where the line of each member begins.
    lines: BTreeMap<usize, u64>,
    end: u64,
    failed: usize,
    /// Until the store is dropped.
    _lock: FolderLock,
}

/// Who writes such a folder.
const WRITER: &str = "anergy sweep";

impl Store {
    /// Makes the folder, or goes on with what is in it.
    ///
    /// # Errors
    /// Files that cannot be read or written; results of another ensemble.
    pub fn open(folder: &Path, ensemble: &Ensemble) -> Result<Self, StoreError> {
        let identity = ensemble.identity(WRITER, None).map_err(StoreError::Identity)?;
        let lock = FolderLock::take(folder)?;
        if !belongs(folder, &identity)? {
            let path = folder.join("ensemble.json");
            replace(&path, format!("{identity:#}\n").as_bytes()).map_err(file_error(&path))?;
        }
        let path = folder.join("journal.jsonl");
        let journal = OpenOptions::new().read(true).append(true).create(true).open(&path);
        let mut store = Self {
            folder: folder.to_owned(),
            names: ensemble.definition().variations.iter().map(|v| v.name.clone()).collect(),
            channels: ensemble.channels().to_vec(),
            journal: journal.map_err(file_error(&path))?,
            lines: BTreeMap::new(),
            end: 0,
            failed: 0,
            _lock: lock,
        };
        store.read_journal(ensemble.len(), &path)?;
        if !store.channels.is_empty() {
            let channels = folder.join("channels");
            std::fs::create_dir_all(&channels).map_err(file_error(&channels))?;
        }
        Ok(store)
    }

    /// Finds the lines; cuts off one that was not written to its end.
    fn read_journal(&mut self, members: usize, path: &Path) -> Result<(), StoreError> {
        let mut reader = BufReader::new(&self.journal);
        let mut text = Vec::new();
        for number in 1.. {
            text.clear();
            let length = reader.read_until(b'\n', &mut text).map_err(file_error(path))?;
            if !text.ends_with(b"\n") {
                break;
            }
            let wrong = |reason| StoreError::Line { path: path.to_owned(), line: number, reason };
            let line: Line =
                serde_json::from_slice(&text).map_err(|error| wrong(error.to_string()))?;
            if line.member >= members {
                return Err(wrong(format!("there is no member {}", line.member)));
            }
            if self.lines.insert(line.member, self.end).is_some() {
                return Err(wrong(format!("member {} is there twice", line.member)));
            }
            self.failed += usize::from(line.error.is_some());
            self.end += length as u64;
        }
        self.journal.set_len(self.end).map_err(file_error(path))
    }

    /// Members that have not finished.
    pub fn pending(&self, members: usize) -> Vec<usize> {
        (0..members).filter(|member| !self.lines.contains_key(member)).collect()
    }

    /// How many have finished, those that failed included.
    pub fn finished(&self) -> usize {
        self.lines.len()
    }

    /// How many have failed.
    pub fn failed(&self) -> usize {
        self.failed
    }

    /// Keeps what became of a member.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn keep(&mut self, outcome: &Outcome) -> Result<(), StoreError> {
        let (error, kpis) = match &outcome.result {
            Ok(Kept { kpis, series }) => {
                if !self.channels.is_empty() {
                    let path = self.channel_file(outcome.member);
                    let table = self.table(series);
                    let written = table.and_then(|table| replace(&path, &table));
                    written.map_err(file_error(&path))?;
                }
                (None, kpis.clone())
            }
            Err(message) => (Some(message.clone()), Map::new()),
        };
        let failed = error.is_some();
        let line = Line { member: outcome.member, values: outcome.values.clone(), error, kpis };
        let mut text = serde_json::to_string(&line).unwrap_or_default();
        text.push('\n');
        let path = self.folder.join("journal.jsonl");
        self.journal.write_all(text.as_bytes()).map_err(file_error(&path))?;
        self.lines.insert(outcome.member, self.end);
        self.end += text.len() as u64;
        self.failed += usize::from(failed);
        Ok(())
    }

    /// The file with the channels of a member.
    pub fn channel_file(&self, member: usize) -> PathBuf {
        self.folder.join("channels").join(format!("member-{member:06}.csv"))
    }

    fn table(&self, series: &Series) -> io::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let head = std::iter::once("time_s").chain(self.channels.iter().map(String::as_str));
        writer.write_record(head)?;
        for (row, time_s) in series.time_s.iter().enumerate() {
            let values = series.columns.iter().map(|column| column[row]);
            writer.write_record(std::iter::once(*time_s).chain(values).map(number))?;
        }
        writer.into_inner().map_err(|error| io::Error::other(error.to_string()))
    }

    fn line(&self, at: u64) -> io::Result<Line> {
        let mut journal = &self.journal;
        journal.seek(SeekFrom::Start(at))?;
        let mut text = String::new();
        BufReader::new(journal.take(self.end - at)).read_line(&mut text)?;
        Ok(serde_json::from_str(&text)?)
    }

    /// Messages of members that failed, the first few of them.
    ///
    /// # Errors
    /// When the journal cannot be read.
    pub fn failures(&self, most: usize) -> Result<Vec<(usize, String)>, StoreError> {
        let path = self.folder.join("journal.jsonl");
        let mut found = Vec::new();
        for at in self.lines.values() {
            if found.len() == most.min(self.failed) {
                break;
            }
            let line = self.line(*at).map_err(file_error(&path))?;
            found.extend(line.error.map(|error| (line.member, error)));
        }
        Ok(found)
    }

    /// Writes `members.csv`; gives the names of the indicators.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_table(&self) -> Result<Vec<String>, StoreError> {
        let path = self.folder.join("members.csv");
        self.write_members(&path).map_err(file_error(&path))
    }

    fn write_members(&self, path: &Path) -> io::Result<Vec<String>> {
        let (mut columns, mut seen) = (Vec::new(), HashSet::new());
        for at in self.lines.values() {
            for name in self.line(*at)?.kpis.keys() {
                if seen.insert(name.clone()) {
                    columns.push(name.clone());
                }
            }
        }
        let part = path.with_extension("csv.part");
        let mut writer = csv::Writer::from_path(&part)?;
        let names = self.names.iter().map(String::as_str);
        let head = std::iter::once("member").chain(names).chain(["error"]);
        writer.write_record(head.chain(columns.iter().map(String::as_str)))?;
        for at in self.lines.values() {
            let line = self.line(*at)?;
            let kpis =
                columns.iter().map(|name| line.kpis.get(name).map_or_else(String::new, told));
            let values = line.values.iter().map(told);
            let error = std::iter::once(line.error.clone().unwrap_or_default());
            let first = std::iter::once(line.member.to_string());
            writer.write_record(first.chain(values).chain(error).chain(kpis))?;
        }
        writer.flush()?;
        drop(writer);
        std::fs::rename(part, path)?;
        Ok(columns)
    }
}

/// Whether a folder has results of this ensemble; `false` where it has none at all.
///
/// # Errors
/// Results of another ensemble; files that cannot be read.
pub fn is_folder_of(folder: &Path, ensemble: &Ensemble) -> Result<bool, StoreError> {
    belongs(folder, &ensemble.identity(WRITER, None).map_err(StoreError::Identity)?)
}

fn belongs(folder: &Path, identity: &Value) -> Result<bool, StoreError> {
    let path = folder.join("ensemble.json");
    match std::fs::read_to_string(&path) {
        Ok(text) => match difference(identity, &text) {
            Some(what) => Err(StoreError::Other { folder: folder.to_owned(), what }),
            None => Ok(true),
        },
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(file_error(&path)(error)),
    }
}

/// What differs between the identity of an ensemble and the text of `ensemble.json`; `None` where nothing does.
pub fn difference(identity: &Value, text: &str) -> Option<&'static str> {
    let there: Value = serde_json::from_str(text).unwrap_or_default();
    let parts = [
        ("writer", "writer: `anergy sweep` and `anergy.ensemble` keep different files"),
        ("program", "version"),
        ("model_sha256", "model"),
        ("controllers", "controllers"),
        ("variations", "variations"),
        ("members", "members"),
    ];
    let differs = |(key, _): &(&str, &str)| there[*key] != identity[*key];
    parts.into_iter().find(differs).map(|(_, what)| what)
}

/// Writes a file as a whole: it is the old one or the new one whenever the program is killed.
fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    std::fs::write(&part, content)?;
    std::fs::rename(&part, path)
}

/// A number in the shortest form that reads back to the same bits; empty where it is none.
fn number(value: f64) -> String {
    if value.is_finite() { format!("{value}") } else { String::new() }
}

fn told(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => String::new(),
        Value::Number(n) => n.as_f64().map_or_else(|| n.to_string(), number),
        other => other.to_string(),
    }
}
