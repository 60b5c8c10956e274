//! Reads a recording back, also when the run was killed while writing it.
//!
//! Records are taken in order and only once their checksum is verified. The first record that is
//! cut off or damaged ends the reading; everything before it is kept.

use crate::format::{self, HeaderDocument, LogMessage};
use crate::layout::Layout;
use anergy_core::error::RecordError;
use anergy_core::recorder::{ChannelGroup, NetworkMap, Recording, RunHeader};
use mcap::records::{MessageHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError};
use std::collections::HashMap;
use std::path::Path;

/// Largest uncompressed chunk that is accepted, bytes; guards against damaged sizes.
const CHUNK_LIMIT: usize = 1 << 28;
/// Where a chunk record holds its checksum, and the name of the compression after it.
const CHUNK_CRC: std::ops::Range<usize> = 24..28;
const CHUNK_COMPRESSION: &[u8] = b"\x04\0\0\0zstd";

/// What is said about MCAP files of other programs.
const FOREIGN: &str = "this MCAP file is not a recording of anergy: it has no `anergy` metadata";

/// A recording that was read, and whether it is all of it.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadBack {
    /// What could be read.
    pub recording: Recording,
    /// `None` when the file is complete; otherwise a sentence for the user that says why its end
    /// is missing. A complete file without summary is from a run that stopped with an error.
    pub damage: Option<String>,
}

impl ReadBack {
    /// Whether the file was read to its regular end.
    pub fn is_complete(&self) -> bool {
        self.damage.is_none()
    }
}

/// Reads the recording at `path`.
///
/// Files that end early, for example after a killed run, give the rows up to there and say so in
/// [`ReadBack::damage`].
///
/// # Errors
/// [`RecordError::File`] when the file cannot be opened; [`RecordError::Format`] when it is empty,
/// not an MCAP file, of another program or a newer version, or ends before the first row could
/// have been written.
pub fn read(path: &Path) -> Result<ReadBack, RecordError> {
    let name = path.display().to_string();
    match std::fs::read(path) {
        Ok(bytes) => read_from_bytes(&bytes, &name),
        Err(source) => Err(RecordError::File { action: "cannot read", path: name, source }),
    }
}

/// Reads a recording from the content of a file; `name` names it in messages.
///
/// # Errors
/// [`RecordError::Format`] as for [`read`].
pub fn read_from_bytes(bytes: &[u8], name: &str) -> Result<ReadBack, RecordError> {
    let head = &bytes[..bytes.len().min(MAGIC.len())];
    let result = if bytes.is_empty() {
        Err("the file is empty".into())
    } else if !MAGIC.starts_with(head) {
        Err("this is not an MCAP file".into())
    } else {
        let options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true)
            .with_record_length_limit(bytes.len());
        let mut content = Content::default();
        let stop = each_record(options, bytes, |opcode, body| content.record(opcode, body)).err();
        content.finish(stop)
    };
    result.map_err(|problem| RecordError::Format { path: name.into(), problem })
}

/// Why reading ended before the end of the file.
enum Stop {
    /// The file is cut off.
    Cut,
    /// The content is wrong.
    Damaged(String),
    /// Not a recording of this program, or of a version that is not understood.
    Refused(String),
}

impl From<McapError> for Stop {
    fn from(error: McapError) -> Self {
        match error {
            McapError::UnexpectedEof => Self::Cut,
            other => Self::Damaged(other.to_string()),
        }
    }
}

/// Calls `visit` with the opcode and the body of each record in `bytes`.
fn each_record(
    options: LinearReaderOptions,
    mut bytes: &[u8],
    mut visit: impl FnMut(u8, &[u8]) -> Result<(), Stop>,
) -> Result<(), Stop> {
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(size) => {
                let (next, rest) = bytes.split_at(size.min(bytes.len()));
                reader.insert(next.len()).copy_from_slice(next);
                reader.notify_read(next.len());
                bytes = rest;
            }
            LinearReadEvent::Record { data, opcode } => visit(opcode, data)?,
        }
    }
    Ok(())
}

/// The rows of one topic so far.
struct Table {
    group: ChannelGroup,
    layout: Layout,
    time_s: Vec<f64>,
}

/// What the messages of an MCAP channel are.
#[derive(Clone, Copy)]
enum Target {
    /// Rows of the table with this index.
    Rows(usize),
    Events,
}

/// The records so far.
#[derive(Default)]
struct Content {
    /// Whether the metadata of this program were seen.
    recognised: bool,
    /// Whether the attachments were seen.
    has_header: bool,
    has_model: bool,
    has_map: bool,
    recording: Recording,
    tables: Vec<Table>,
    targets: HashMap<u16, Target>,
    /// Values of the message being read.
    row: Vec<f64>,
}

impl Content {
    /// A record outside of chunks.
    fn record(&mut self, opcode: u8, body: &[u8]) -> Result<(), Stop> {
        match opcode {
            op::METADATA => {
                self.recognised |=
                    string_at(body, 0).is_some_and(|(name, _)| name == format::METADATA.as_bytes());
                Ok(())
            }
            op::HEADER => Ok(()),
            // The metadata come first.
            _ if !self.recognised => Err(Stop::Refused(FOREIGN.into())),
            op::ATTACHMENT => self.attachment(body),
            op::CHUNK => self.chunk(body),
            _ => Ok(()),
        }
    }

    fn attachment(&mut self, body: &[u8]) -> Result<(), Stop> {
        // Checks the lengths, which parse_record relies on; two times of 8 bytes come first.
        let fits = string_at(body, 16)
            .and_then(|(_, media_type)| string_at(body, media_type))
            .is_some_and(|(_, size)| body.len() >= size + 12);
        if !fits {
            return Err(Stop::Damaged("an attachment is too short".into()));
        }
        let Record::Attachment { header, data, .. } = mcap::parse_record(op::ATTACHMENT, body)?
        else {
            return Ok(());
        };
        let unreadable = |error: serde_json::Error| {
            Stop::Damaged(format!("attachment {} is not as expected: {error}", header.name))
        };
        match header.name.as_str() {
            format::HEADER => {
                let document: serde_json::Value =
                    serde_json::from_slice(&data).map_err(unreadable)?;
                let version = document.get("version").and_then(serde_json::Value::as_u64);
                if version.is_some_and(|version| version > u64::from(format::VERSION)) {
                    return Err(Stop::Refused(
                        "the recording was written by a newer version of this program".into(),
                    ));
                }
                self.header(serde_json::from_value(document).map_err(unreadable)?);
            }
            format::MODEL => {
                self.recording.header.model_text = String::from_utf8_lossy(&data).into_owned();
                self.has_model = true;
            }
            format::NETWORK => {
                let map: NetworkMap = serde_json::from_slice(&data).map_err(unreadable)?;
                self.recording.header.map = map;
                self.has_map = true;
            }
            format::SUMMARY => {
                self.recording.summary = serde_json::from_slice(&data).map_err(unreadable)?;
            }
            _ => {}
        }
        Ok(())
    }

    fn header(&mut self, document: HeaderDocument<'_>) {
        let header = &mut self.recording.header;
        *header = RunHeader {
            model_name: document.model_name.into_owned(),
            start_unix_ns: document.start_unix_ns,
            settings: document.settings.into_owned(),
            ..std::mem::take(header)
        };
        self.recording.channels = document.channels.into_owned();
        let channels = &self.recording.channels;
        self.recording.columns = vec![Vec::new(); channels.len()];
        self.tables = ChannelGroup::ALL
            .into_iter()
            .filter_map(|group| {
                let layout = Layout::new(channels, group)?;
                Some(Table { group, layout, time_s: Vec::new() })
            })
            .collect();
        self.has_header = true;
    }

    /// A chunk; nothing of it is used before its checksum is verified.
    fn chunk(&mut self, body: &[u8]) -> Result<(), Stop> {
        if !self.has_header {
            return Err(Stop::Damaged("rows come before the description of the run".into()));
        }
        let end = CHUNK_CRC.end;
        let guarded = body.get(CHUNK_CRC).is_some_and(|crc| crc != [0; 4])
            && body.get(end..end + CHUNK_COMPRESSION.len()) == Some(CHUNK_COMPRESSION);
        if !guarded {
            return Err(Stop::Damaged("a chunk has no checksum or unknown compression".into()));
        }
        let mut record = Vec::with_capacity(body.len() + 9);
        record.push(op::CHUNK);
        record.extend_from_slice(&(body.len() as u64).to_le_bytes());
        record.extend_from_slice(body);
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(CHUNK_LIMIT.max(record.len()));
        each_record(options, &record, |opcode, body| match mcap::parse_record(opcode, body)? {
            Record::Channel(channel) => {
                self.channel(channel.id, &channel.topic);
                Ok(())
            }
            Record::Message { header, data } => self.message(header, &data),
            _ => Ok(()),
        })
        .map_err(|stop| match stop {
            // The chunk itself is all there.
            Stop::Cut => Stop::Damaged("a chunk ends in the middle of a record".into()),
            other => other,
        })
    }

    fn channel(&mut self, id: u16, topic: &str) {
        if topic == format::EVENTS {
            self.targets.insert(id, Target::Events);
        } else if let Some(table) = self.tables.iter().position(|t| t.group.topic() == topic) {
            self.targets.insert(id, Target::Rows(table));
        }
    }

    fn message(&mut self, header: MessageHeader, data: &[u8]) -> Result<(), Stop> {
        match self.targets.get(&header.channel_id) {
            Some(Target::Rows(index)) => {
                let Some(table) = self.tables.get_mut(*index) else { return Ok(()) };
                let topic = table.group.topic();
                in_sequence(topic, header.sequence, table.time_s.len())?;
                let time_s = table.layout.decode(data, &mut self.row);
                table.time_s.push(time_s.ok_or_else(|| unreadable_message(topic))?);
                for (channel, value) in table.layout.channels().zip(&self.row) {
                    self.recording.columns[channel].push(*value);
                }
            }
            Some(Target::Events) => {
                in_sequence(format::EVENTS, header.sequence, self.recording.events.len())?;
                let event = serde_json::from_slice::<LogMessage<'_>>(data)
                    .ok()
                    .and_then(|message| message.into_event(self.recording.header.start_unix_ns));
                let event = event.ok_or_else(|| unreadable_message(format::EVENTS))?;
                self.recording.events.push(event);
            }
            None => {}
        }
        Ok(())
    }

    /// The result, or a sentence on why there is none.
    fn finish(mut self, stop: Option<Stop>) -> Result<ReadBack, String> {
        let mut damage = match stop {
            None => None,
            Some(Stop::Refused(problem)) => return Err(problem),
            Some(Stop::Cut) => Some(
                "the file is cut off, as after a killed run or on a full disk; what was written \
                 completely before has been read"
                    .to_string(),
            ),
            Some(Stop::Damaged(problem)) => Some(format!(
                "the file is damaged ({problem}); what comes before the damage has been read"
            )),
        };
        if !self.recognised && damage.is_none() {
            return Err(FOREIGN.into());
        }
        if !(self.recognised && self.has_header && self.has_model && self.has_map) {
            return Err("the file ends or is damaged before the description of the run is \
                        complete; it holds no results"
                .into());
        }
        // A row counts when all its topics are there.
        let rows = self.tables.iter().map(|table| table.time_s.len()).min().unwrap_or(0);
        if damage.is_none() && self.tables.iter().any(|table| table.time_s.len() > rows) {
            damage = Some("some topics have fewer rows than others; common rows were read".into());
        }
        if let Some(table) = self.tables.first_mut() {
            self.recording.time_s = std::mem::take(&mut table.time_s);
            self.recording.time_s.truncate(rows);
        }
        for column in &mut self.recording.columns {
            column.truncate(rows);
        }
        Ok(ReadBack { recording: self.recording, damage })
    }
}

fn unreadable_message(topic: &str) -> Stop {
    Stop::Damaged(format!("a message of {topic} is not as expected"))
}

/// Messages are numbered; a gap means that a chunk was lost.
fn in_sequence(topic: &str, sequence: u32, expected: usize) -> Result<(), Stop> {
    if sequence == expected as u32 {
        Ok(())
    } else {
        Err(Stop::Damaged(format!("messages of {topic} are missing")))
    }
}

/// The string at `start` (its length as u32, then its bytes) and the position after it.
fn string_at(body: &[u8], start: usize) -> Option<(&[u8], usize)> {
    let text = start.checked_add(4)?;
    let length: [u8; 4] = body.get(start..text)?.try_into().ok()?;
    let end = text.checked_add(usize::try_from(u32::from_le_bytes(length)).ok()?)?;
    Some((body.get(text..end)?, end))
}
