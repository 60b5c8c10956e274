//! Files that are cut off, damaged, or not recordings at all.

use super::values;
use super::{
    Disk, assert_prefix, assert_same, event, expected, recorder, run, small_file, summary,
};
use crate::{ReadBack, read_from_bytes};
use anergy_core::clock::Time;
use anergy_core::error::RecordError;
use anergy_core::recorder::Recorder;
use std::io;

fn problem(result: Result<ReadBack, RecordError>) -> String {
    result.unwrap_err().to_string()
}

#[test]
fn cut_at_every_byte() {
    let file = small_file(30);
    let wanted = expected(30);
    let (mut rows, mut steps, mut readable) = (0, 0, false);
    for size in 0..file.len() {
        match read_from_bytes(&file[..size], "cut") {
            Ok(back) => {
                readable = true;
                assert!(!back.is_complete());
                assert_prefix(&back.recording, &wanted);
                let now = back.recording.time_s.len();
                assert!(now >= rows);
                steps += usize::from(now > rows);
                rows = now;
            }
            Err(error) => {
                assert!(!readable, "{size}: {error}");
                assert!(matches!(error, RecordError::Format { .. }));
            }
        }
    }
    assert_eq!(rows, 30);
    assert!(steps > 5, "{steps} chunks");
    assert_same(&read_from_bytes(&file, "whole").unwrap().recording, &wanted);
}

#[test]
fn flipped_bits_never_give_wrong_numbers() {
    let file = small_file(30);
    let wanted = expected(30);
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for _ in 0..4000 {
        let mut broken = file.clone();
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let position = (state >> 16) as usize % broken.len();
        broken[position] ^= 1 << (state & 7);
        match read_from_bytes(&broken, "flip") {
            Ok(back) => {
                assert_prefix(&back.recording, &wanted);
                assert!(!back.is_complete(), "byte {position}");
            }
            Err(error) => assert!(matches!(error, RecordError::Format { .. })),
        }
    }
}

#[test]
fn full_disk_is_an_error_and_keeps_complete_chunks() {
    let size = small_file(30).len();
    let wanted = expected(30);
    for space in (0..size).step_by(7) {
        let disk = Disk::new(space);
        let mut recorder = recorder(&disk);
        recorder.chunk_bytes = 1500;
        let result = run(&mut *recorder, 30);
        let error = match result {
            Ok(()) => recorder.finish(&summary()).unwrap_err(),
            Err(error) => {
                // Further calls fail as well, and dropping does not panic.
                let _ = recorder.row(Time::ZERO, &values(0));
                let _ = recorder.event(&event(0));
                drop(recorder);
                error
            }
        };
        let RecordError::File { source, path, .. } = &error else { panic!("{error}") };
        assert_eq!(source.kind(), io::ErrorKind::StorageFull);
        assert_eq!(path, "test.mcap");
        if let Ok(back) = read_from_bytes(&disk.content(), "full") {
            assert!(!back.is_complete());
            assert_prefix(&back.recording, &wanted);
        }
    }
}

#[test]
fn files_of_others_are_named() {
    assert_eq!(problem(read_from_bytes(b"", "f")), "f: the file is empty");
    assert_eq!(problem(read_from_bytes(b"time,p\n", "f")), "f: this is not an MCAP file");
    assert!(problem(read_from_bytes(b"\x89MCAP", "f")).contains("it holds no results"));
    let mut other = io::Cursor::new(Vec::new());
    {
        let mut writer = mcap::Writer::new(&mut other).unwrap();
        let id = writer.add_channel(0, "/units", "json", &Default::default()).unwrap();
        let header = mcap::records::MessageHeader {
            channel_id: id,
            sequence: 0,
            log_time: 0,
            publish_time: 0,
        };
        writer.write_to_known_channel(&header, b"{}").unwrap();
        writer.finish().unwrap();
    }
    let other = other.into_inner();
    for size in [other.len(), other.len() - 9] {
        assert!(
            problem(read_from_bytes(&other[..size], "f")).contains("not a recording of anergy")
        );
    }
    let newer = small_file(1);
    let at = newer.windows(11).position(|w| w == b"\"version\":1").unwrap();
    let mut newer = newer;
    newer[at + 10] = b'2';
    // The checksum of the attachment follows its content; zero means that there is none.
    let end = newer.windows(10).position(|w| w == b"model.toml").unwrap() - 4 - 16 - 9;
    newer[end - 4..end].fill(0);
    assert!(problem(read_from_bytes(&newer, "f")).contains("newer version"));
}
