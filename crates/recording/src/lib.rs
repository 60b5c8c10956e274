//! Recordings of runs as MCAP files: [`McapRecorder`] writes one while the run goes on,
//! [`read`] brings it back as columns, [`write_csv`] makes a table of text of it; measured series
//! of others in [`measured`].
//!
//! # The file
//!
//! An ordinary [MCAP](https://mcap.dev) file, for Foxglove, the `mcap` tool and the PyPI package
//! `mcap`. In this order:
//!
//! | Record | Content |
//! |---|---|
//! | metadata `anergy` | `model_name`, `model_sha256` of the model file, `start_unix_ns`, `format_version` and every setting of the run, with the seeds of random numbers |
//! | attachment `header.json` | version, name, start, settings in order, channels in order with unit and group |
//! | attachment `model.toml` | the model file as the user wrote it |
//! | attachment `network.json` | geometry of the network |
//! | chunks (zstd) | schemas, channels, then one JSON message per topic and recorded row |
//! | attachment `summary.json` | key results; absent when the run did not reach its end |
//!
//! A topic per [`ChannelGroup`](anergy_core::recorder::ChannelGroup) that has channels. Its
//! messages are nested by the dots of the component's name, all values in SI:
//!
//! ```json
//! {"time_s": 10.0, "sf1": {"feed_in_pump": {"m_flow_kg_s": 0.013, "dp_pa": 5400.0}}}
//! ```
//!
//! The JSON Schema of the topic names the unit of each field in `description` and `x-unit`. Numbers
//! are written in the shortest form that reads back to the same bits; NaN and infinities are
//! `null` and read back as NaN. Should two channels claim the same field, later ones get a `_`
//! appended there; `header.json` keeps their names.
//!
//! Events are messages of the topic `/events` in the form of `foxglove.Log`, with the additional
//! field `kind`.
//!
//! The network is one message of the topic `/network/map` in the form of `foxglove.GeoJSON`, where the model has
//! positions.
//!
//! Times of messages are `start_unix_ns` plus simulated time, never wall time. The same run gives
//! the same bytes, unless it is so slow that chunks are closed early (see below).
//!
//! # Killed runs
//!
//! The description of the run reaches the operating system before the first row, the first row at
//! once. Later rows follow when a chunk of 256 KiB is full, or with the first row or event written
//! five seconds or more of wall time after that. What comes after the last complete chunk is lost;
//! the rest stays readable. Checksums guard all of it: a damaged number is never returned.
//!
//! A recording without any channel keeps no rows.

mod csv_writer;
mod format;
mod layout;
mod map_message;
mod mcap_reader;
mod mcap_writer;
pub mod measured;
pub mod selection;
#[cfg(test)]
mod tests;

pub use csv_writer::{CsvSize, write_csv};
pub use mcap_reader::{ReadBack, read, read_from_bytes};
pub use mcap_writer::McapRecorder;
