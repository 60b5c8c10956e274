use super::{Gap, MeasuredOptions, MeasuredTable};
use crate::McapRecorder;
use anergy_core::clock::Time;
use anergy_core::recorder::{Channel, ChannelGroup, Recorder, RunHeader};

fn read(text: &str) -> MeasuredTable {
    MeasuredTable::from_csv(text.as_bytes(), &MeasuredOptions::default()).unwrap()
}

fn problem(text: &str) -> String {
    MeasuredTable::from_csv(text.as_bytes(), &MeasuredOptions::default()).unwrap_err().to_string()
}

fn said(table: &MeasuredTable, text: &str) -> bool {
    table.remarks.iter().any(|remark| remark.to_string().contains(text))
}

#[test]
fn a_german_logger() {
    // Semicolons, decimal commas, day before month, units in the head, Latin-1 degrees.
    let text = "Zeit;Vorlauf Temp [\u{b0}C];Durchfluss (l/min);Druck_bar;Spreizung diff [\u{b0}C]\n\
                01.02.2024 12:00:00;65,5;3,6;1,5;20\n01.02.2024 12:01:00;66;0;2;21\n";
    let latin1: Vec<u8> = text.chars().map(|c| c as u8).collect();
    for bytes in [text.as_bytes(), &latin1] {
        let options = MeasuredOptions { utc_offset_s: 3600.0, ..MeasuredOptions::default() };
        let table = MeasuredTable::from_csv(bytes, &options).unwrap();
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["Vorlauf_Temp_k", "Durchfluss_m3_s", "Druck_pa", "Spreizung_diff_k"]);
        assert_eq!(table.columns[0].values, [338.65, 339.15]);
        assert_eq!(table.columns[1].values, [3.6 / 60_000.0, 0.0]);
        assert_eq!(table.columns[2].values, [150_000.0, 200_000.0]);
        assert_eq!(table.columns[3].values, [20.0, 21.0], "a difference has no offset");
        // 2024-02-01 11:00 UTC.
        assert_eq!(table.start_unix_ns, Some(1_706_785_200_000_000_000));
        assert_eq!(table.time_s, [0.0, 60.0]);
        assert!(table.remarks.is_empty(), "{:?}", table.remarks);
    }
}

#[test]
fn units_in_a_row_of_their_own_and_times_of_many_forms() {
    let table = read("t,supply,flow\nmin,K,m³/h\n0,300,3.6\n1,301,7.2\n");
    assert_eq!((table.time_s.as_slice(), table.start_unix_ns), (&[0.0, 60.0][..], None));
    assert_eq!(table.column("flow_m3_s").unwrap().values, [0.001, 0.002]);
    for (first, second) in [
        ("2024-02-01T12:00:00Z", "2024-02-01T13:01:00+01:00"),
        ("2024-02-01 12:00", "2024-02-01 12:01"),
        ("2024-02-01T12:00:00", "2024-02-01T12:01:00"),
        ("1.2.2024 12:00", "1.2.2024 12:01"),
        ("1706788800", "1706788860"),
        ("1706788800000", "1706788860000"),
        ("1706788800000000", "1706788860000000"),
        ("1706788800000000000", "1706788860000000000"),
    ] {
        let table = read(&format!("time,p_bar\n{first},1\n{second},2\n"));
        assert_eq!(table.start_unix_ns, Some(1_706_788_800_000_000_000), "{first}");
        assert_eq!(table.time_s, [0.0, 60.0], "{first}");
        assert_eq!(
            said(&table, "no time zone"),
            !first.contains('Z') && first.contains(':'),
            "{first}"
        );
    }
    assert!(said(&read("time,p_bar\n1/2/2024 12:00,1\n"), "day/month/year"));
    let table = read("p_bar,T [K],timestamp\n1,300,5\n");
    assert_eq!((table.time_s[0], table.columns.len()), (5.0, 2), "T is no time");
}

#[test]
fn the_unit_of_the_head_counts_and_large_times_are_since_1970() {
    let start = Some(1_706_788_800_000_000_000);
    for (head, first, second) in [
        ("time [s]", "1706788800", "1706788860"),
        ("timestamp_s", "1706788800", "1706788860"),
        ("time [ms]", "1706788800000", "1706788860000"),
        ("time_us", "1706788800000000", "1706788860000000"),
        ("time [ns]", "1706788800000000000", "1706788860000000000"),
    ] {
        let table = read(&format!("{head},p_bar\n{first},1\n{second},2\n"));
        assert_eq!(table.start_unix_ns, start, "{head}");
        assert_eq!(table.time_s, [0.0, 60.0], "{head}");
        assert!(table.remarks.is_empty(), "{head}: {:?}", table.remarks);
    }
    let table = read("time [s],p_bar\n1706788800000,1\n");
    assert_eq!(table.start_unix_ns, start);
    assert!(said(&table, "\"time\" counts in units of 0.001 s since 1970"));
    for (text, second_s) in [
        ("time_ms,p_bar\n0,1\n500,2\n", 0.5),
        ("time,p\nms,bar\n0,1\n500,2\n", 0.5),
        ("time [h],p_bar\n0,1\n30000,2\n", 1.08e8),
    ] {
        let table = read(text);
        assert_eq!((table.start_unix_ns, table.time_s[1]), (None, second_s), "{text}");
    }
    let table = read("time [h],p_bar\n30000,1\n30001,2\n");
    assert_eq!((table.start_unix_ns, table.time_s[0]), (None, 1.08e8), "hours of operation");
}

#[test]
fn the_head_says_separator_and_time() {
    let table = read("time,T supply [degC; top],flow [l/min],p_bar\n0,60,3,1\n");
    assert_eq!(table.columns.len(), 3);
    let table = read("time;\"T, top, left, 1 [degC]\";p_bar\n0;60,5;1\n");
    assert_eq!(table.columns[0].values, [333.65]);
    let table = read("Date/Time,T [degC],flow [l/min]\n2024-02-01T12:00:00Z,60,3\n");
    assert_eq!(table.start_unix_ns, Some(1_706_788_800_000_000_000));
    assert_eq!(table.column("T_k").unwrap().values, [333.15]);
    let table = read("T [degC],t,p_bar\n60,5,1\n");
    assert_eq!((table.time_s[0], table.columns[0].name.as_str()), (5.0, "T_k"));
}

#[test]
fn a_day_and_a_time_of_day_are_one_time() {
    for (head, first, second) in [
        ("Date,Time", "2024-02-01,12:00:00", "2024-02-01,12:01:00"),
        ("Uhrzeit,Datum", "12:00,01.02.2024", "12:01,01.02.2024"),
        ("date,time", "2024-02-01,2024-02-01 12:00:00", "2024-02-01,2024-02-01 12:01:00"),
    ] {
        let table = read(&format!("{head},p_bar\n{first},1\n{second},2\n"));
        assert_eq!(table.start_unix_ns, Some(1_706_788_800_000_000_000), "{head}");
        assert_eq!((table.time_s.as_slice(), table.columns.len()), (&[0.0, 60.0][..], 1));
        assert_eq!(said(&table, "is put together"), head != "date,time", "{head}");
    }
    let problem = problem("Date,Time,p_bar\n2024-02-01,43200,1\n");
    assert!(problem.contains("\"Date\" and a time of day in column \"Time\""), "{problem}");
}

#[test]
fn differences_are_told_by_whole_words() {
    let table = read("time,T_diffuser [degC],dT [degC],deltaT_degc,T-diff [degC]\n0,20,20,20,20\n");
    let values: Vec<f64> = table.columns.iter().map(|column| column.values[0]).collect();
    assert_eq!(values, [293.15, 20.0, 20.0, 20.0]);
}

#[test]
fn commas_that_could_stand_before_thousands_are_told_once() {
    let table = read("time_s;a_k;b_k\n0;1,234;2\n1;5,678;3\n");
    assert_eq!(table.columns[0].values, [1.234, 5.678]);
    let told = table.remarks.iter().filter(|remark| remark.text.contains("decimal commas")).count();
    assert_eq!(told, 1);
    assert!(said(&table, "line 2: decimal commas: \"1,234\" is 1.234"), "{:?}", table.remarks);
    let table = read("time_s;a_k\n0;1,234\n1;5,67\n");
    assert!(table.remarks.is_empty(), "5,67 has decimals: {:?}", table.remarks);
}

#[test]
fn what_is_torn_or_doubtful_is_left_out_and_told_with_its_line() {
    let table = read(
        "time_s,p_bar,state,empty\n0,1,on,\n10,n/a,on,\n20,x7,1,\n20,9,1,\n30,4\n40,5,1,\nlater,5,1,\n15,6,1,\n50,7",
    );
    assert_eq!(table.time_s, [0.0, 10.0, 15.0, 20.0, 40.0]);
    let values = &table.column("p_pa").unwrap().values;
    assert!(values[1].is_nan() && values[3].is_nan() && values[4] == 500_000.0);
    for text in [
        "line 6: 2 cells instead of 4: the row is left out (torn, or a separator in a number?) (and 1 more)",
        "line 8: \"later\" is no time as the others are",
        "line 4: \"x7\" in column \"p\" is no number: a gap",
        "line 2: \"on\" in column \"state\" is no number: a gap (and 1 more)",
        "line 9: time goes back: the rows are sorted",
        "line 5: the time of line 4 again, with other values: the first counts",
        "column \"empty\" has no numbers: left out",
        "column \"state\" has no unit: as it is, in SI?",
    ] {
        assert!(said(&table, text), "{text} is not among {:#?}", table.remarks);
    }
}

#[test]
fn files_without_a_table_are_refused() {
    assert!(problem("").contains("no head"));
    assert!(problem("time,p_bar\nyesterday,1\n").contains("31.01.2024"));
    assert!(problem("time,name\n1,a\n").contains("no column besides the time"));
    let options =
        MeasuredOptions { time_column: Some("tiem".into()), ..MeasuredOptions::default() };
    let error = MeasuredTable::from_csv(b"time,p\n1,2\n", &options).unwrap_err();
    assert!(error.to_string().contains("the nearest is \"time\""), "{error}");
    let error = MeasuredTable::from_mcap(b"no mcap", &MeasuredOptions::default()).unwrap_err();
    assert!(error.to_string().contains("no MCAP"), "{error}");
}

#[test]
fn gaps_are_found_and_filled_when_they_are_short() {
    let mut table = read("time_s,a_k\n0,\n10,1\n20,\n30,3\n40,4\n100,10\n110,\n120,\n");
    let gap = |from_s, to_s| Gap { from_s, to_s };
    let gaps = table.gaps(&table.columns[0]);
    assert_eq!(gaps, [gap(0.0, 10.0), gap(10.0, 30.0), gap(40.0, 100.0), gap(100.0, 120.0)]);
    assert_eq!(table.interval_s(), Some(10.0));
    assert_eq!(table.fill(20.0), 4);
    assert_eq!(table.columns[0].values, [1.0, 1.0, 2.0, 3.0, 4.0, 10.0, 10.0, 10.0]);
    let mut table = read("time_s,a_k\n0,1\n10,\n60,7\n");
    assert_eq!(table.fill(30.0), 0);
    assert_eq!(table.fill(60.0), 1);
    assert_eq!(table.columns[0].values[1], 2.0);
}

#[test]
fn what_is_written_reads_back() {
    let table =
        read("time,a [°C],b_percent\n2024-02-01T12:00:00Z,20,5\n2024-02-01T12:00:10.5Z,,7\n");
    let mut text = Vec::new();
    table.write_csv(&mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    assert_eq!(
        text,
        "time,a_k,b\n2024-02-01T12:00:00Z,293.15,0.05\n2024-02-01T12:00:10.5Z,,0.07\n"
    );
    let again = read(&text);
    assert_eq!((&again.time_s, again.start_unix_ns), (&table.time_s, table.start_unix_ns));
    assert_eq!(again.columns[0].values[0], 293.15);
}

#[test]
fn recordings_are_measured_tables() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("own.mcap");
    let mut recorder = Box::new(McapRecorder::create(&path).unwrap());
    let channel = Channel {
        name: "a.hot.t_k".into(),
        unit: "K".into(),
        group: ChannelGroup::Nodes,
        component: "a.hot".into(),
        quantity: "t_k".into(),
    };
    let header = RunHeader { start_unix_ns: 1_000_000_000_000, ..RunHeader::default() };
    recorder.start(&header, &[channel]).unwrap();
    recorder.row(Time::from_s(0.0).unwrap(), &[300.0]).unwrap();
    recorder.row(Time::from_s(5.0).unwrap(), &[301.0]).unwrap();
    recorder.finish(&serde_json::Value::Null).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let table = MeasuredTable::from_mcap(&bytes, &MeasuredOptions::default()).unwrap();
    assert_eq!(
        (table.columns[0].name.as_str(), table.columns[0].unit.as_str()),
        ("a.hot.t_k", "k")
    );
    assert_eq!(
        (&table.time_s[..], &table.columns[0].values[..]),
        (&[0.0, 5.0][..], &[300.0, 301.0][..])
    );
    assert_eq!(table.start_unix_ns, Some(1_000_000_000_000));
    let cut =
        MeasuredTable::from_mcap(&bytes[..bytes.len() - 40], &MeasuredOptions::default()).unwrap();
    assert!(said(&cut, "cut off"), "{:?}", cut.remarks);
}

#[test]
fn messages_of_other_programs() {
    let schema = br#"{"type":"object","properties":{"supply":{"type":"number","x-unit":"degC"}}}"#;
    let mut file = Vec::new();
    let mut writer = mcap::Writer::new(std::io::Cursor::new(&mut file)).unwrap();
    let schema = writer.add_schema("logger", "jsonschema", schema).unwrap();
    let plain = writer.add_channel(schema, "/plc", "json", &Default::default()).unwrap();
    let other = writer.add_channel(0, "/status", "json", &Default::default()).unwrap();
    for (channel_id, second, text) in [
        (plain, 10, r#"{"supply": 60, "pump": {"p_bar": 1.5}, "name": "x"}"#),
        (other, 11, r#"{"ok": 1}"#),
        (plain, 20, r#"{"supply": 61}"#),
        (plain, 20, r#"{"supply": 99, "pump": {"p_pa": 5}}"#),
        (plain, 30, r#"{"supply": 62, "pump": {"p_pa": 7}}"#),
    ] {
        let time = second * 1_000_000_000;
        let header = mcap::records::MessageHeader {
            channel_id,
            sequence: 0,
            log_time: time,
            publish_time: time,
        };
        writer.write_to_known_channel(&header, text.as_bytes()).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let error = MeasuredTable::from_mcap(&file, &MeasuredOptions::default()).unwrap_err();
    assert!(error.to_string().contains("/plc, /status"), "{error}");
    let options = MeasuredOptions { topic: Some("/plc".into()), ..MeasuredOptions::default() };
    let table = MeasuredTable::from_mcap(&file, &options).unwrap();
    let pressure = &table.column("pump.p_pa").unwrap().values;
    assert!(pressure[0] == 150_000.0 && pressure[1].is_nan());
    assert_eq!(table.column("supply_k").unwrap().values, [333.15, 334.15, 335.15]);
    assert_eq!(table.time_s, [0.0, 10.0, 20.0]);
    assert!(said(&table, "1 messages at the time of another one: the first counts"));
    assert_eq!(table.column("pump.p_2_pa").unwrap().values[2], 7.0, "p_bar and p_pa");
}
