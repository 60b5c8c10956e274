//! The program as a user meets it: files, exit codes, interruptions, full disks.
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

const MODEL: &str = include_str!("../../../examples/three-houses/model.toml");

fn anergy(arguments: &[&str], dir: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_anergy"))
        .args(arguments)
        .current_dir(dir)
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn with_model(model: &str) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("model.toml"), model).unwrap();
    dir
}

#[test]
fn demo_shows_the_blocking_and_leaves_three_files() {
    let dir = tempfile::tempdir().unwrap();
    let output = anergy(&["demo", "--out", "here"], dir.path());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let shown = text(&output.stdout);
    for expected in ["0.781", "7.920", "3.335", "4.322", "sf1.station is blocked", "is free again"]
    {
        assert!(shown.contains(expected), "{expected} is not in\n{shown}");
    }
    let file = |name: &str| std::fs::read(dir.path().join("here").join(name)).unwrap();
    assert!(text(&file("report.html")).contains("data-anergy-report"));
    let summary: serde_json::Value = serde_json::from_slice(&file("summary.json")).unwrap();
    assert_eq!(summary["interrupted"], false);
    assert!(!file("results.mcap").is_empty());
    let again = anergy(&["report", "here/results.mcap", "--out", "again.html"], dir.path());
    assert!(again.status.success(), "{}", text(&again.stderr));
    let report = std::fs::read(dir.path().join("again.html")).unwrap();
    assert_eq!(report, file("report.html"), "the report of the file is that of the run");
}

#[test]
fn solve_writes_the_tables_that_scripts_read() {
    let dir = with_model(MODEL);
    let output = anergy(&["solve", "model.toml", "--json", "steady.json"], dir.path());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let json = std::fs::read(dir.path().join("steady.json")).unwrap();
    let steady: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let edges = steady["edges"].as_array().unwrap();
    let pump = edges.iter().find(|edge| edge["id"] == "sf1.feed_in_pump").unwrap();
    assert_eq!(pump["kind"], "pump");
    assert!((pump["m_flow_kg_s"].as_f64().unwrap() * 60.0 - 0.781).abs() < 1e-3);
    for field in ["id", "p_pa", "t_k", "elevation_m"] {
        assert!(!steady["nodes"][0][field].is_null(), "{field}");
    }
    assert!(steady["iterations"].as_u64().unwrap() > 0 && steady["residual_pa"].is_number());
}

#[test]
fn exit_codes() {
    let dir = with_model(&MODEL.replace("length_m = 200", "lenght_m = 200"));
    std::fs::write(dir.path().join("good.toml"), MODEL).unwrap();
    let code = |arguments: &[&str]| anergy(arguments, dir.path()).status.code();
    assert_eq!(code(&["check", "good.toml"]), Some(0));
    assert_eq!(code(&["check", "model.toml"]), Some(1));
    assert_eq!(code(&["run", "nothing.toml"]), Some(1));
    assert_eq!(code(&["frobnicate"]), Some(2));
    assert_eq!(code(&["run", "good.toml", "--until", "soon"]), Some(2));
    let message = text(&anergy(&["check", "model.toml"], dir.path()).stderr);
    assert!(
        message.contains("model.toml:") && message.contains("did you mean `length_m`"),
        "{message}"
    );
}

/// 2 m of pipe at rest in air of 150 degC: 99 degC after 1229 s.
#[test]
fn water_that_boils_ends_a_run_that_can_be_reported() {
    let dir = with_model(
        "format = 1\n[run]\nuntil = \"1h\"\nstep = \"10s\"\nrecord = \"100s\"\n[[node]]\nid = \"a\"\n\
         [[node]]\nid = \"b\"\n[[edge]]\nid = \"oven\"\nkind = \"pipe\"\nfrom = \"a\"\nto = \"b\"\n\
         length_m = 2.0\ninner_diameter_mm = 20.0\ninsulation_resistance_k_m_w = 1.0\n\
         surroundings_degc = 150.0\n[pressure_reference]\nnode = \"a\"\n",
    );
    let run = anergy(&["run", "model.toml", "--out", "out"], dir.path());
    assert_eq!(run.status.code(), Some(1));
    let message = text(&run.stderr);
    assert!(message.contains("at 20m 30s: the water at \"oven\""), "{message}");
    assert!(message.contains("valid from 0.5 to 99 degC"), "{message}");
    assert_eq!(
        anergy(&["report", "out/results.mcap", "--out", "kept.html"], dir.path()).status.code(),
        Some(0)
    );
}

#[test]
fn check_expands_explains_and_lists() {
    let dir = with_model(MODEL);
    let expanded = anergy(&["check", "model.toml", "--expand"], dir.path());
    std::fs::write(dir.path().join("plain.toml"), &expanded.stdout).unwrap();
    let of = |file: &str| text(&anergy(&["solve", file], dir.path()).stdout);
    assert_eq!(of("plain.toml"), of("model.toml"));
    let defaults = text(&anergy(&["check", "model.toml", "--explain-defaults"], dir.path()).stdout);
    assert!(defaults.contains("sf1.feed_in_pump.rise_time_s"), "{defaults}");
    let signals = text(&anergy(&["check", "model.toml", "--signals"], dir.path()).stdout);
    assert!(signals.contains("sf2.feed_in_pump.speed"), "{signals}");
}

#[test]
fn check_shows_the_weather() {
    let weather = MODEL.replacen(
        "[run]",
        "[weather]\nkind = \"synthetic\"\nnoise_difference_k = 0\n[run]\n\
         start = \"2024-01-01T00:00:00+01:00\"",
        1,
    );
    let dir = with_model(&weather);
    let shown = text(&anergy(&["check", "model.toml", "--weather"], dir.path()).stdout);
    let line = |name: &str| {
        let line = shown.lines().find(|line| line.contains(name));
        line.unwrap_or_else(|| panic!("{name}:\n{shown}")).to_owned()
    };
    // The year without noise has 9.5 degC; 365 days, of which 12 months and 12 types.
    assert!(line("all").contains("365") && line("all").contains("9.5"), "{shown}");
    assert!(line("2024-02").contains("29"), "{shown}");
    let count = |name: &str| {
        let words: Vec<String> = line(name).split_whitespace().map(str::to_owned).collect();
        words.iter().rev().nth(4).unwrap().parse::<u32>().unwrap()
    };
    let kinds = ["winter", "transition", "summer"].into_iter().flat_map(|season| {
        ["workday, sunny", "workday, cloudy", "Sunday, sunny", "Sunday, cloudy"]
            .map(|kind| count(&format!("{season}, {kind}")))
    });
    assert_eq!(kinds.sum::<u32>(), 365, "{shown}");
    let without = with_model(MODEL);
    let shown = text(&anergy(&["check", "model.toml", "--weather"], without.path()).stdout);
    assert!(shown.contains("no weather"), "{shown}");
}

#[test]
fn the_schema_is_json_and_knows_every_section() {
    let output = anergy(&["schema"], Path::new("."));
    let schema: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for section in
        ["run", "fluid", "site", "trench", "station", "edge", "unit", "schedule", "series"]
    {
        assert!(schema["properties"][section].is_object(), "{section}");
    }
}

#[test]
fn places_that_cannot_be_written_are_named() {
    let dir = with_model(MODEL);
    std::fs::write(dir.path().join("file"), "").unwrap();
    let output = anergy(&["run", "model.toml", "--out", "file/below"], dir.path());
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("file/below"), "{}", text(&output.stderr));
    if Path::new("/dev/full").exists() {
        std::fs::create_dir(dir.path().join("full")).unwrap();
        std::os::unix::fs::symlink("/dev/full", dir.path().join("full/results.mcap")).unwrap();
        let output = anergy(&["run", "model.toml", "--out", "full"], dir.path());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains("results.mcap") && !message.contains("panicked"), "{message}");
    }
}

/// Starts a run of a simulated year and waits until it has written something.
fn long_run(dir: &Path) -> std::process::Child {
    let child = Command::new(env!("CARGO_BIN_EXE_anergy"))
        .args(["run", "model.toml", "--until", "1a", "--record", "1s", "--out", "long"])
        .current_dir(dir)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let results = dir.join("long/results.mcap");
    let started = Instant::now();
    while std::fs::metadata(&results).map_or(0, |file| file.len()) < 600_000 {
        assert!(started.elapsed() < Duration::from_secs(60), "the run writes nothing");
        std::thread::sleep(Duration::from_millis(10));
    }
    child
}

#[test]
fn a_killed_run_can_still_be_reported() {
    let dir = with_model(MODEL);
    let mut child = long_run(dir.path());
    child.kill().unwrap();
    child.wait().unwrap();
    let output = anergy(&["report", "long/results.mcap", "--out", "killed.html"], dir.path());
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("warning"), "the user is told that the file is cut");
    assert!(!text(&output.stdout).starts_with("0 rows"), "{}", text(&output.stdout));
    let output = anergy(&["export", "long/results.mcap", "--out", "killed.csv"], dir.path());
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("cut off"), "{}", text(&output.stderr));
    let table = std::fs::read_to_string(dir.path().join("killed.csv")).unwrap();
    let columns = |line: &str| line.split(',').count();
    let head = columns(table.lines().next().unwrap());
    assert!(table.lines().count() > 2 && table.lines().all(|line| columns(line) == head));
}

#[test]
fn ctrl_c_leaves_a_complete_file() {
    let dir = with_model(MODEL);
    let mut child = long_run(dir.path());
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let summary = std::fs::read(dir.path().join("long/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
    assert_eq!(summary["interrupted"], true);
    let output = anergy(&["report", "long/results.mcap", "--out", "interrupted.html"], dir.path());
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
}

#[test]
fn exported_tables_have_units_in_their_columns() {
    let dir = with_model(MODEL);
    let run = ["run", "model.toml", "--until", "10min", "--record", "10s", "--out", "here"];
    assert!(anergy(&run, dir.path()).status.success());
    let export =
        |more: &[&str]| anergy(&[&["export", "here/results.mcap"], more].concat(), dir.path());
    let output = export(&["--out", "all.csv"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let all = text(&std::fs::read(dir.path().join("all.csv")).unwrap());
    assert!(all.starts_with("time_s,") && all.contains("sf1.feed_in_pump.m_flow_kg_s"));
    assert_eq!(all.lines().count(), 62);

    let chosen = [
        "--every",
        "1min",
        "--channels",
        "sf1.hot.t_k",
        "sf?.station.m_flow_kg_s",
        "--units",
        "degC",
        "kg_h",
    ];
    let output = export(&[&["--out", "-"], &chosen[..]].concat());
    let table = text(&output.stdout);
    let mut lines = table.lines();
    let head = lines.next().unwrap();
    assert_eq!(
        head,
        "time_s,sf1.hot.t_degc,sf1.station.m_flow_kg_h,sf2.station.m_flow_kg_h,sf4.station.m_flow_kg_h"
    );
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 11);
    // 0.781 l/min of water of 1000 kg/m3.
    assert!((rows[1][2] / 60.0 - 0.781).abs() < 2e-3, "{rows:?}");
    assert!(rows.iter().all(|row| row[1] > 0.0 && row[1] < 100.0));

    let wrong = export(&["--out", "x.csv", "--channels", "sf1.hot.tk"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(
        text(&wrong.stderr).contains("did you mean \"sf1.hot.t_k\""),
        "{}",
        text(&wrong.stderr)
    );
    let wrong = export(&["--out", "no/such/x.csv"]);
    assert_eq!(wrong.status.code(), Some(1));
    assert!(text(&wrong.stderr).contains("there is no folder no/such"), "{}", text(&wrong.stderr));
    let wrong = export(&["--out", "x.csv", "--every", "0s"]);
    assert_eq!(wrong.status.code(), Some(2));
    if Path::new("/dev/full").exists() {
        let full = export(&["--out", "/dev/full"]);
        assert_eq!(full.status.code(), Some(1));
        assert!(text(&full.stderr).contains("/dev/full"), "{}", text(&full.stderr));
    }
}

#[test]
fn measured_series_drive_a_model() {
    let dir = with_model(MODEL);
    let table = "time;T feeder [degC];flow [l/min]\n31.01.2024 12:00;60,5;3\n31.01.2024 12:10;;4\n\
                 31.01.2024 12:20;61,5\n31.01.2024 12:20;61,5;5\n";
    std::fs::write(dir.path().join("logger.csv"), table).unwrap();
    let import = |more: &[&str]| {
        anergy(
            &[&["import", "measured", "logger.csv", "--out", "series.csv"], more].concat(),
            dir.path(),
        )
    };
    let output = import(&["--utc-offset", "1h"]);
    let shown = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for expected in [
        "3 rows over 20m, every 10m",
        "T_feeder_k",
        "1 empty cells: the [[series]]",
        "start = \"2024-01-31T11:00:00Z\"",
        "logger.csv: line 4: 2 cells instead of 3",
    ] {
        assert!(shown.contains(expected), "{expected} is not in\n{shown}");
    }
    assert!(text(&import(&["--fill", "20min"]).stdout).contains("1 empty cells filled"));
    let series = std::fs::read_to_string(dir.path().join("series.csv")).unwrap();
    assert_eq!(
        series,
        "time,T_feeder_k,flow_m3_s\n2024-01-31T12:00:00Z,333.65,5e-5\n\
         2024-01-31T12:10:00Z,334.15,6.666666666666667e-5\n2024-01-31T12:20:00Z,334.65,8.333333333333333e-5\n"
    );
    let model = MODEL.replace("[run]", "[run]\nstart = \"2024-01-31T12:00:00Z\"")
        + "\n[[series]]\nfile = \"series.csv\"\ncolumn = \"flow_m3_s\"\nsignal = \"sf1.unit.v_flow_m3_s\"\n";
    std::fs::write(dir.path().join("driven.toml"), model).unwrap();
    let output = anergy(&["check", "driven.toml", "--signals"], dir.path());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let wrong = import(&["--time-column", "tiem"]);
    assert_eq!(wrong.status.code(), Some(1));
    assert!(
        text(&wrong.stderr).contains("logger.csv: line 1: there is no column \"tiem\""),
        "{}",
        text(&wrong.stderr)
    );
}

const VARIATIONS: &str = "format = 1\n[run]\nuntil = \"2min\"\n[keep]\nkpis = [\"network.*\"]\n\
    [[variation]]\nparameter = \"sf1.feed_in_pump.speed\"\nvalues = [0.9, 0.95, 1.0]\n\
    [[variation]]\nname = \"ground\"\nparameter = \"ground.temperature_degc\"\nlow = 5\nhigh = 15\ncount = 2\n";

#[test]
fn a_sweep_leaves_a_table_goes_on_and_runs_one_member_in_full() {
    let dir = with_model(MODEL);
    std::fs::write(dir.path().join("variations.toml"), VARIATIONS).unwrap();
    let sweep = ["sweep", "model.toml", "variations.toml", "--out", "swept"];
    let output = anergy(&sweep, dir.path());
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("6 of 6 members finished, 0 of them failed"));
    let table = std::fs::read_to_string(dir.path().join("swept/members.csv")).unwrap();
    assert!(table.starts_with("member,sf1.feed_in_pump.speed,ground,error,network."), "{table}");
    assert_eq!(table.lines().count(), 7);
    // Killed after two lines: the other members run, and the table is the same.
    let journal = dir.path().join("swept/journal.jsonl");
    let lines = std::fs::read_to_string(&journal).unwrap();
    let two: String = lines.split_inclusive('\n').take(2).collect();
    std::fs::write(&journal, two).unwrap();
    let output = anergy(&sweep, dir.path());
    assert!(text(&output.stdout).contains("2 of 6 members are there; going on"));
    assert_eq!(table, std::fs::read_to_string(dir.path().join("swept/members.csv")).unwrap());
    let output = anergy(&[&sweep[..], &["--member", "3"]].concat(), dir.path());
    assert!(text(&output.stdout).contains("sf1.feed_in_pump.speed = 0.95\nground = 15"));
    let summary = std::fs::read(dir.path().join("swept/member-3/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
    let lost = summary["kpis"]["network"]["heat_lost_kwh"].as_f64().unwrap();
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let column = rows.next().unwrap().iter().position(|n| *n == "network.heat_lost_kwh").unwrap();
    let told: f64 = rows.nth(3).unwrap()[column].parse().unwrap();
    assert_eq!(told.to_bits(), lost.to_bits());
    // Beside the results of another ensemble it would be nobody's member.
    std::fs::write(dir.path().join("variations.toml"), VARIATIONS.replace("2min", "3min")).unwrap();
    let output = anergy(&[&sweep[..], &["--member", "3"]].concat(), dir.path());
    assert!(text(&output.stderr).contains("other variations"), "{}", text(&output.stderr));
}

#[test]
fn sweeps_that_cannot_be_are_refused() {
    let dir = with_model(MODEL);
    let wrong = VARIATIONS.replace("sf1.feed_in_pump.speed", "sf1.feed_in_pump.sped");
    std::fs::write(dir.path().join("wrong.toml"), wrong).unwrap();
    std::fs::write(dir.path().join("variations.toml"), VARIATIONS).unwrap();
    let sweep = |more: &[&str]| anergy(&[&["sweep", "model.toml"], more].concat(), dir.path());
    let output = sweep(&["wrong.toml", "--out", "swept"]);
    assert_eq!(output.status.code(), Some(1));
    let told = text(&output.stderr);
    assert!(
        told.contains("wrong.toml:7:13") && told.contains("sf1.feed_in_pump.speed`?"),
        "{told}"
    );
    assert_eq!(sweep(&["variations.toml"]).status.code(), Some(2));
    let output = sweep(&["variations.toml", "--out", "swept", "--member", "6"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("members are 0 to 5"));
    let schema = anergy(&["schema", "--variations"], dir.path());
    assert!(text(&schema.stdout).contains("standard_deviation"));
}
