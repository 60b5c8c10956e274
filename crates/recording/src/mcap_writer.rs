//! Writes a recording while the run goes on.

use crate::format::{self, HeaderDocument, LogMessage};
use crate::layout::{Layout, schema_name};
use crate::map_message;
use anergy_core::clock::Time;
use anergy_core::error::RecordError;
use anergy_core::recorder::{Channel, ChannelGroup, Event, Recorder, RunHeader};
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, Compression, McapError, WriteOptions};
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::time::{Duration, Instant};

/// Uncompressed size of a chunk, bytes.
const CHUNK_BYTES: usize = 256 * 1024;
/// Longest wall time that rows stay in memory.
const FLUSH_INTERVAL: Duration = Duration::from_secs(5);

type Output = NoSeek<BufWriter<Box<dyn Write + Send>>>;

/// Writes the rows of a run into an MCAP file; see the [crate documentation](crate) for its layout.
///
/// After an error the recorder can only be dropped; what was written until then stays readable.
/// Dropped without [`Recorder::finish`], the file is closed properly but has no summary.
pub struct McapRecorder {
    /// For messages only.
    path: String,
    writer: mcap::Writer<Output>,
    run: Option<Run>,
    /// Text of the message being written.
    buffer: Vec<u8>,
    pub(crate) chunk_bytes: usize,
    pub(crate) flush_interval: Duration,
}

/// What is known once the run has started.
struct Run {
    start_unix_ns: i64,
    channels: usize,
    /// MCAP channel and layout of each topic.
    topics: Vec<(u16, Layout)>,
    events_channel: u16,
    rows: u32,
    events: u32,
    /// Size of the current chunk, bytes.
    chunk: usize,
    last_flush: Instant,
}

impl McapRecorder {
    /// Creates the file at `path`; an existing one is replaced.
    ///
    /// # Errors
    /// [`RecordError::File`] when the file cannot be created.
    pub fn create(path: &Path) -> Result<Self, RecordError> {
        let name = path.display().to_string();
        match File::create(path) {
            Ok(file) => Self::new(Box::new(file), name),
            Err(source) => Err(RecordError::File { action: "cannot create", path: name, source }),
        }
    }

    /// Writes to any output; `path` names it in messages.
    pub(crate) fn new(output: Box<dyn Write + Send>, path: String) -> Result<Self, RecordError> {
        // Chunks are completed in memory and written in one go, after a whole row: what is on disk
        // is always a complete chunk. One compression thread, as the bytes depend on their number.
        let options = WriteOptions::new()
            .compression(Some(Compression::Zstd))
            .compression_threads(0)
            .chunk_size(None)
            .disable_seeking(true)
            .library(concat!("anergy/", env!("CARGO_PKG_VERSION")));
        match options.create(NoSeek::new(BufWriter::new(output))) {
            Ok(writer) => Ok(Self {
                path,
                writer,
                run: None,
                buffer: Vec::new(),
                chunk_bytes: CHUNK_BYTES,
                flush_interval: FLUSH_INTERVAL,
            }),
            Err(error) => Err(failure(&path, error)),
        }
    }

    /// Writes what describes the run.
    fn begin(&mut self, header: &RunHeader, channels: &[Channel]) -> Result<Run, McapError> {
        let mut metadata: BTreeMap<String, String> = header.settings.iter().cloned().collect();
        metadata.insert("format_version".into(), format::VERSION.to_string());
        metadata.insert("model_name".into(), header.model_name.clone());
        metadata.insert("start_unix_ns".into(), header.start_unix_ns.to_string());
        metadata.insert("model_sha256".into(), format::sha256(&header.model_text));
        self.writer.write_metadata(&Metadata { name: format::METADATA.into(), metadata })?;

        let start_unix_ns = header.start_unix_ns;
        let document = HeaderDocument {
            version: format::VERSION,
            model_name: Cow::Borrowed(&header.model_name),
            start_unix_ns,
            settings: Cow::Borrowed(&header.settings),
            channels: Cow::Borrowed(channels),
        };
        self.attach_json(format::HEADER, start_unix_ns, &document)?;
        let model = header.model_text.as_bytes();
        self.attach(format::MODEL, "application/toml", start_unix_ns, model)?;
        self.attach_json(format::NETWORK, start_unix_ns, &header.map)?;
        self.writer.flush()?;

        // Schemas and channels open the first chunk, which the first row closes. In a chunk of
        // their own they would make Foxglove start its time line in 1970.
        let mut topics = Vec::new();
        for group in ChannelGroup::ALL {
            if let Some(layout) = Layout::new(channels, group) {
                let schema = layout.schema().to_string();
                let id = self.add_channel(&schema_name(group), &schema, group.topic())?;
                topics.push((id, layout));
            }
        }
        let schema = format::log_schema().to_string();
        let events_channel = self.add_channel("foxglove.Log", &schema, format::EVENTS)?;
        if let Some(message) = map_message::message(header) {
            let schema = map_message::schema().to_string();
            let channel_id = self.add_channel(map_message::SCHEMA, &schema, map_message::TOPIC)?;
            let time = format::log_time(start_unix_ns, Time::ZERO);
            let header =
                MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
            let text = serde_json::to_vec(&message).map_err(io::Error::from)?;
            self.writer.write_to_known_channel(&header, &text)?;
        }
        Ok(Run {
            start_unix_ns,
            channels: channels.len(),
            topics,
            events_channel,
            rows: 0,
            events: 0,
            chunk: 0,
            last_flush: Instant::now(),
        })
    }

    fn add_channel(&mut self, name: &str, schema: &str, topic: &str) -> Result<u16, McapError> {
        let schema = self.writer.add_schema(name, "jsonschema", schema.as_bytes())?;
        self.writer.add_channel(schema, topic, "json", &BTreeMap::new())
    }

    fn attach(
        &mut self,
        name: &str,
        media_type: &str,
        start_unix_ns: i64,
        data: &[u8],
    ) -> Result<(), McapError> {
        let time = format::log_time(start_unix_ns, Time::ZERO);
        self.writer.attach(&Attachment {
            log_time: time,
            create_time: time,
            name: name.into(),
            media_type: media_type.into(),
            data: Cow::Borrowed(data),
        })
    }

    fn attach_json(
        &mut self,
        name: &str,
        start_unix_ns: i64,
        content: &impl Serialize,
    ) -> Result<(), McapError> {
        let text = serde_json::to_vec(content).map_err(io::Error::from)?;
        self.attach(name, "application/json", start_unix_ns, &text)
    }

    fn not_started(&self) -> RecordError {
        RecordError::Format {
            path: self.path.clone(),
            problem: "the recording has not been started".into(),
        }
    }
}

impl Run {
    fn write_row(
        &mut self,
        writer: &mut mcap::Writer<Output>,
        buffer: &mut Vec<u8>,
        time: Time,
        values: &[f64],
    ) -> Result<(), McapError> {
        let log_time = format::log_time(self.start_unix_ns, time);
        for (channel_id, layout) in &self.topics {
            layout.encode(time.as_s(), values, buffer)?;
            let header = MessageHeader {
                channel_id: *channel_id,
                sequence: self.rows,
                log_time,
                publish_time: log_time,
            };
            writer.write_to_known_channel(&header, buffer)?;
            self.chunk += buffer.len();
        }
        self.rows = self.rows.wrapping_add(1);
        Ok(())
    }

    fn write_event(
        &mut self,
        writer: &mut mcap::Writer<Output>,
        buffer: &mut Vec<u8>,
        event: &Event,
    ) -> Result<(), McapError> {
        buffer.clear();
        serde_json::to_writer(&mut *buffer, &LogMessage::new(event, self.start_unix_ns))
            .map_err(io::Error::from)?;
        let log_time = format::log_time(self.start_unix_ns, event.time);
        let header = MessageHeader {
            channel_id: self.events_channel,
            sequence: self.events,
            log_time,
            publish_time: log_time,
        };
        writer.write_to_known_channel(&header, buffer)?;
        self.chunk += buffer.len();
        self.events = self.events.wrapping_add(1);
        Ok(())
    }

    /// Closes the chunk and hands it to the operating system.
    fn flush(&mut self, writer: &mut mcap::Writer<Output>) -> Result<(), McapError> {
        writer.flush()?;
        self.chunk = 0;
        self.last_flush = Instant::now();
        Ok(())
    }
}

impl Recorder for McapRecorder {
    fn start(&mut self, header: &RunHeader, channels: &[Channel]) -> Result<(), RecordError> {
        if self.run.is_some() {
            let problem = "the recording has been started twice".into();
            return Err(RecordError::Format { path: self.path.clone(), problem });
        }
        match self.begin(header, channels) {
            Ok(run) => {
                self.run = Some(run);
                Ok(())
            }
            Err(error) => Err(failure(&self.path, error)),
        }
    }

    fn row(&mut self, time: Time, values: &[f64]) -> Result<(), RecordError> {
        let Some(run) = &mut self.run else { return Err(self.not_started()) };
        if values.len() != run.channels {
            let problem =
                format!("a row has {} values for {} channels", values.len(), run.channels);
            return Err(RecordError::Format { path: self.path.clone(), problem });
        }
        run.write_row(&mut self.writer, &mut self.buffer, time, values)
            .and_then(|()| {
                let due = run.rows == 1
                    || run.chunk >= self.chunk_bytes
                    || run.last_flush.elapsed() >= self.flush_interval;
                if due { run.flush(&mut self.writer) } else { Ok(()) }
            })
            .map_err(|error| failure(&self.path, error))
    }

    fn event(&mut self, event: &Event) -> Result<(), RecordError> {
        let Some(run) = &mut self.run else { return Err(self.not_started()) };
        run.write_event(&mut self.writer, &mut self.buffer, event)
            .and_then(|()| {
                let due = run.chunk >= self.chunk_bytes
                    || run.last_flush.elapsed() >= self.flush_interval;
                if due { run.flush(&mut self.writer) } else { Ok(()) }
            })
            .map_err(|error| failure(&self.path, error))
    }

    fn finish(mut self: Box<Self>, summary: &serde_json::Value) -> Result<(), RecordError> {
        let Some(run) = &self.run else { return Err(self.not_started()) };
        let start_unix_ns = run.start_unix_ns;
        self.attach_json(format::SUMMARY, start_unix_ns, summary)
            .and_then(|()| self.writer.finish())
            .map(|_| ())
            .map_err(|error| failure(&self.path, error))
    }
}

/// Names the file in an error of the MCAP library.
fn failure(path: &str, error: McapError) -> RecordError {
    let source = match error {
        McapError::Io(source) => source,
        McapError::AttemptedWriteAfterFailure => io::Error::other("an earlier write failed"),
        other => io::Error::other(other.to_string()),
    };
    RecordError::File { action: "cannot write", path: path.into(), source }
}
