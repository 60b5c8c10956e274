//! Recordings written and read back.

mod broken;

use crate::{McapRecorder, read, read_from_bytes};
use anergy_core::clock::Time;
use anergy_core::error::RecordError;
use anergy_core::recorder::{
    Channel, ChannelGroup, Event, MapEdge, MapNode, MemoryRecorder, NetworkMap, Recorder,
    Recording, RunHeader, Severity,
};
use std::io::{self, Write};
use std::path::Path;
use std::slice::from_ref;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// A file in memory; the disk is full after `space` bytes.
#[derive(Clone)]
struct Disk {
    bytes: Arc<Mutex<Vec<u8>>>,
    space: usize,
}

impl Disk {
    fn new(space: usize) -> Self {
        Self { bytes: Arc::default(), space }
    }

    fn content(&self) -> Vec<u8> {
        self.bytes.lock().unwrap().clone()
    }
}

impl Write for Disk {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        let mut bytes = self.bytes.lock().unwrap();
        let size = text.len().min(self.space - bytes.len());
        bytes.extend_from_slice(&text[..size]);
        if size == 0 && !text.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        Ok(size)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn channel(group: ChannelGroup, component: &str, quantity: &str) -> Channel {
    Channel {
        name: format!("{component}.{quantity}"),
        unit: "kg s-1".into(),
        group,
        component: component.into(),
        quantity: quantity.into(),
    }
}

fn channels() -> Vec<Channel> {
    vec![
        channel(ChannelGroup::Units, "sf1.station.x", "t_k"),
        channel(ChannelGroup::Nodes, "warm.17", "p_pa"),
        channel(ChannelGroup::Units, "sf1.station", "q_flow_w"),
        channel(ChannelGroup::Units, "sf1.station.x", "m_flow_kg_s"),
        channel(ChannelGroup::Nodes, "Küche \"№ 1\"\n\\", "</script>"),
        channel(ChannelGroup::Balances, "", "loss_w"),
        channel(ChannelGroup::Nodes, "warm", "17"),
        channel(ChannelGroup::Nodes, "warm.17", "p_pa"),
    ]
}

fn header() -> RunHeader {
    RunHeader {
        model_name: "Straße </script> \"1\"".into(),
        model_text: "# comment\r\n[network]\nname = \"ä\"\n".into(),
        start_unix_ns: 1_767_225_600_000_000_001,
        settings: [("step", "1s"), ("anergy", "0.1.0"), ("step", "2s"), ("model_name", "other")]
            .map(|(key, value)| (key.into(), value.into()))
            .to_vec(),
        map: NetworkMap {
            nodes: vec![MapNode {
                id: "a".into(),
                site: String::new(),
                x_m: Some(0.1 + 0.2),
                y_m: None,
            }],
            edges: vec![MapEdge {
                id: "e".into(),
                kind: "pipe".into(),
                from: "a".into(),
                to: "b".into(),
                length_m: 12.3,
                inner_diameter_m: 0.02,
                station: String::new(),
            }],
        },
    }
}

fn values(row: usize) -> Vec<f64> {
    let special = [-0.0, 1e-300, f64::NAN, f64::MAX, 5e-324, 0.1 + 0.2, f64::INFINITY, 1e16, -1e21];
    (0..channels().len())
        .map(|index| match (row, index) {
            (0, _) => special[index],
            _ => 300.0 + (row as f64 * 0.37 + index as f64).sin(),
        })
        .collect()
}

fn event(row: usize) -> Event {
    Event {
        time: Time(row as i64 * 100_000_001),
        severity: if row.is_multiple_of(2) { Severity::Info } else { Severity::Warning },
        component: "sf1.\"station\"".into(),
        kind: "blocked".into(),
        message: format!("dp rises to {row} kPa </script>\n"),
    }
}

fn summary() -> serde_json::Value {
    serde_json::json!({"heat_j": 0.1 + 0.2, "balances": [{"name": "energy", "error": 1e-12}]})
}

/// Feeds the same run to any recorder.
fn run(recorder: &mut dyn Recorder, rows: usize) -> Result<(), RecordError> {
    recorder.start(&header(), &channels())?;
    for row in 0..rows {
        recorder.row(Time(row as i64 * 100_000_000), &values(row))?;
        if row % 3 == 0 {
            recorder.event(&event(row))?;
        }
    }
    Ok(())
}

/// The run of [`run`] as [`read`] should give it back.
fn expected(rows: usize) -> Recording {
    let mut memory = MemoryRecorder::default();
    run(&mut memory, rows).unwrap();
    let mut recording = memory.recording;
    for value in recording.columns.iter_mut().flatten() {
        // JSON has no infinity.
        *value = if value.is_finite() { *value } else { f64::NAN };
    }
    recording.summary = summary();
    recording
}

fn bits(columns: &[Vec<f64>]) -> Vec<Vec<u64>> {
    columns.iter().map(|column| column.iter().map(|value| value.to_bits()).collect()).collect()
}

fn assert_same(found: &Recording, wanted: &Recording) {
    assert_eq!(found.header, wanted.header);
    assert_eq!(found.channels, wanted.channels);
    assert_eq!(bits(from_ref(&found.time_s)), bits(from_ref(&wanted.time_s)));
    assert_eq!(bits(&found.columns), bits(&wanted.columns));
    assert_eq!(found.events, wanted.events);
    assert_eq!(found.summary, wanted.summary);
}

/// Asserts that `found` is how `wanted` begins.
fn assert_prefix(found: &Recording, wanted: &Recording) {
    let mut begin = wanted.clone();
    begin.time_s.truncate(found.time_s.len());
    for column in &mut begin.columns {
        column.truncate(found.time_s.len());
    }
    begin.events.truncate(found.events.len());
    if found.summary.is_null() {
        begin.summary = found.summary.clone();
    }
    assert_same(found, &begin);
}

fn recorder(disk: &Disk) -> Box<McapRecorder> {
    Box::new(McapRecorder::new(Box::new(disk.clone()), "test.mcap".into()).unwrap())
}

/// A complete file of several small chunks.
fn small_file(rows: usize) -> Vec<u8> {
    let disk = Disk::new(usize::MAX);
    let mut recorder = recorder(&disk);
    recorder.chunk_bytes = 1500;
    run(&mut *recorder, rows).unwrap();
    recorder.finish(&summary()).unwrap();
    disk.content()
}

#[test]
fn round_trip_is_exact() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut recorder = Box::new(McapRecorder::create(&path).unwrap());
    run(&mut *recorder, 400).unwrap();
    recorder.finish(&summary()).unwrap();
    let back = read(&path).unwrap();
    assert!(back.is_complete());
    assert_same(&back.recording, &expected(400));
}

#[test]
fn chunks_of_many_sizes_and_no_rows() {
    for rows in [0, 1, 2, 3000] {
        for chunk_bytes in [1, 10_000, 256 * 1024] {
            let disk = Disk::new(usize::MAX);
            let mut recorder = recorder(&disk);
            recorder.chunk_bytes = chunk_bytes;
            run(&mut *recorder, rows).unwrap();
            recorder.finish(&summary()).unwrap();
            let back = read_from_bytes(&disk.content(), "x").unwrap();
            assert_eq!(back.damage, None);
            assert_same(&back.recording, &expected(rows));
        }
    }
}

#[test]
fn no_channels_and_extreme_times() {
    let disk = Disk::new(usize::MAX);
    let mut recorder = recorder(&disk);
    let header = RunHeader { start_unix_ns: -5, ..RunHeader::default() };
    recorder.start(&header, &[]).unwrap();
    recorder.row(Time::ZERO, &[]).unwrap();
    let events =
        [-7, 0, 4, 999_999_999, i64::MAX, i64::MIN].map(|ns| Event { time: Time(ns), ..event(0) });
    for event in &events {
        recorder.event(event).unwrap();
    }
    recorder.finish(&serde_json::Value::Null).unwrap();
    let back = read_from_bytes(&disk.content(), "x").unwrap();
    assert!(back.is_complete());
    assert_eq!(back.recording.header, header);
    assert_eq!(back.recording.events, events);
    assert!(back.recording.channels.is_empty() && back.recording.time_s.is_empty());
}

#[test]
fn same_run_gives_same_bytes() {
    fn is_send<T: Send>() {}
    is_send::<McapRecorder>();
    assert_eq!(small_file(300), small_file(300));
}

#[cfg(target_os = "linux")]
#[test]
fn device_without_space() {
    let mut recorder = McapRecorder::create(Path::new("/dev/full")).unwrap();
    let error = recorder.start(&header(), &channels()).unwrap_err();
    let RecordError::File { source, path, .. } = error else { panic!("{error}") };
    assert_eq!(source.kind(), io::ErrorKind::StorageFull);
    assert_eq!(path, "/dev/full");
    assert!(matches!(recorder.row(Time::ZERO, &[]), Err(RecordError::Format { .. })));
}

#[test]
fn rows_reach_the_disk_while_running() {
    let disk = Disk::new(usize::MAX);
    let mut recorder = recorder(&disk);
    recorder.start(&header(), &channels()).unwrap();
    let rows = |disk: &Disk| read_from_bytes(&disk.content(), "x").unwrap().recording.time_s.len();
    assert_eq!(rows(&disk), 0);
    recorder.row(Time(0), &values(0)).unwrap();
    assert_eq!(rows(&disk), 1);
    recorder.row(Time(1), &values(1)).unwrap();
    assert_eq!(rows(&disk), 1);
    recorder.flush_interval = Duration::ZERO;
    recorder.row(Time(2), &values(2)).unwrap();
    assert_eq!(rows(&disk), 3);
    recorder.flush_interval = Duration::MAX;
    recorder.row(Time(3), &values(3)).unwrap();
    assert_eq!(rows(&disk), 3);
    // Dropped without finish: closed properly, no summary.
    drop(recorder);
    let back = read_from_bytes(&disk.content(), "x").unwrap();
    assert!(back.is_complete() && back.recording.summary.is_null());
    assert_eq!(back.recording.time_s.len(), 4);
}

#[test]
fn misuse_is_an_error() {
    let disk = Disk::new(usize::MAX);
    let mut recorder = recorder(&disk);
    assert!(recorder.row(Time::ZERO, &[]).is_err());
    assert!(recorder.event(&event(0)).is_err());
    recorder.start(&header(), &channels()).unwrap();
    assert!(recorder.start(&header(), &channels()).is_err());
    let error = recorder.row(Time::ZERO, &[1.0]).unwrap_err();
    assert_eq!(error.to_string(), "test.mcap: a row has 1 values for 8 channels");
}

#[test]
fn paths_that_cannot_be_used() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing").join("run.mcap");
    let Err(RecordError::File { action, path, source }) = McapRecorder::create(&missing) else {
        panic!("created")
    };
    assert_eq!(action, "cannot create");
    assert_eq!(path, missing.display().to_string());
    assert_eq!(source.kind(), io::ErrorKind::NotFound);
    assert!(McapRecorder::create(folder.path()).is_err());
    assert!(matches!(read(&missing), Err(RecordError::File { .. })));
}
