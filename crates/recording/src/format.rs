//! What writer and reader agree on besides the messages of the rows: names of the records, the
//! header document, and the form of events.

use anergy_core::clock::{NS_PER_S, Time};
use anergy_core::recorder::{Channel, Event, Severity};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::borrow::Cow;

/// Version of the file layout; readers refuse higher ones.
pub(crate) const VERSION: u32 = 1;
/// Name of the metadata record by which a recording is recognised.
pub(crate) const METADATA: &str = "anergy";
/// Attachment with the [`HeaderDocument`].
pub(crate) const HEADER: &str = "header.json";
/// Attachment with the model text.
pub(crate) const MODEL: &str = "model.toml";
/// Attachment with the geometry.
pub(crate) const NETWORK: &str = "network.json";
/// Attachment with the key results.
pub(crate) const SUMMARY: &str = "summary.json";
/// Topic of the events.
pub(crate) const EVENTS: &str = "/events";

/// SHA-256 of a text, in hexadecimal digits.
pub(crate) fn sha256(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The parts of the run header that need exact order or names.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct HeaderDocument<'a> {
    /// [`VERSION`] of the writer.
    pub version: u32,
    /// Name of the model.
    pub model_name: Cow<'a, str>,
    /// Calendar time of the start of the run, ns since 1970.
    pub start_unix_ns: i64,
    /// Settings in order.
    pub settings: Cow<'a, [(String, String)]>,
    /// Channels in order.
    pub channels: Cow<'a, [Channel]>,
}

/// Calendar time as Foxglove writes it.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Timestamp {
    /// Seconds since 1970.
    sec: i64,
    /// Nanoseconds of the second.
    nsec: u32,
}

/// An event in the form of `foxglove.Log`.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct LogMessage<'a> {
    timestamp: Timestamp,
    level: u8,
    #[serde(borrow)]
    message: Cow<'a, str>,
    #[serde(borrow)]
    name: Cow<'a, str>,
    #[serde(borrow)]
    file: Cow<'a, str>,
    line: u32,
    #[serde(borrow)]
    kind: Cow<'a, str>,
}

const LEVEL_INFO: u8 = 2;
const LEVEL_WARNING: u8 = 3;

impl<'a> LogMessage<'a> {
    /// The message of an event of a run that started at `start_unix_ns`.
    pub fn new(event: &'a Event, start_unix_ns: i64) -> Self {
        let ns = i128::from(start_unix_ns) + i128::from(event.time.0);
        let per_s = i128::from(NS_PER_S);
        Self {
            // The sum of two i64 divided by 1e9 fits in i64, the remainder in u32.
            timestamp: Timestamp {
                sec: ns.div_euclid(per_s) as i64,
                nsec: ns.rem_euclid(per_s) as u32,
            },
            level: match event.severity {
                Severity::Info => LEVEL_INFO,
                Severity::Warning => LEVEL_WARNING,
            },
            message: Cow::Borrowed(&event.message),
            name: Cow::Borrowed(&event.component),
            file: Cow::Borrowed(""),
            line: 0,
            kind: Cow::Borrowed(&event.kind),
        }
    }

    /// Back to the event; `None` when its time is out of range.
    pub fn into_event(self, start_unix_ns: i64) -> Option<Event> {
        let ns = i128::from(self.timestamp.sec) * i128::from(NS_PER_S)
            + i128::from(self.timestamp.nsec)
            - i128::from(start_unix_ns);
        Some(Event {
            time: Time(i64::try_from(ns).ok()?),
            severity: if self.level >= LEVEL_WARNING { Severity::Warning } else { Severity::Info },
            component: self.name.into_owned(),
            kind: self.kind.into_owned(),
            message: self.message.into_owned(),
        })
    }
}

/// Log time of a message, ns since 1970; times outside of what MCAP can say are clamped.
pub(crate) fn log_time(start_unix_ns: i64, time: Time) -> u64 {
    let ns = i128::from(start_unix_ns) + i128::from(time.0);
    u64::try_from(ns.max(0)).unwrap_or(u64::MAX)
}

/// JSON Schema of `foxglove.Log` with the additional field `kind`.
pub(crate) fn log_schema() -> Value {
    json!({
        "title": "foxglove.Log",
        "description": "An event of the run",
        "type": "object",
        "properties": {
            "timestamp": {
                "type": "object",
                "title": "time",
                "description": "Start of the run plus simulated time",
                "properties": {
                    "sec": {"type": "integer", "minimum": 0},
                    "nsec": {"type": "integer", "minimum": 0, "maximum": 999_999_999}
                }
            },
            "level": {
                "title": "foxglove.LogLevel",
                "description": "Importance",
                "oneOf": [
                    {"title": "UNKNOWN", "const": 0},
                    {"title": "DEBUG", "const": 1},
                    {"title": "INFO", "const": LEVEL_INFO},
                    {"title": "WARNING", "const": LEVEL_WARNING},
                    {"title": "ERROR", "const": 4},
                    {"title": "FATAL", "const": 5}
                ]
            },
            "message": {"type": "string", "description": "Sentence for the user"},
            "name": {"type": "string", "description": "Component concerned"},
            "file": {"type": "string", "description": "Unused"},
            "line": {"type": "integer", "minimum": 0, "description": "Unused"},
            "kind": {"type": "string", "description": "Machine-readable word, for example blocked"}
        }
    })
}
