//! `anergy import measured`: tables of loggers as files of series.

use crate::failure::Failure;
use crate::output::{self, line};
use crate::tables::print_table;
use anergy_core::clock::Time;
use anergy_recording::measured::{MeasuredColumn, MeasuredOptions, MeasuredTable};
use anergy_simulation::model_file::Duration;
use std::io::BufWriter;
use std::path::Path;

/// How the table is read.
#[derive(Debug, clap::Args)]
pub struct MeasuredArguments {
    /// Column with the time (default: found by its name, else the first)
    #[arg(long, value_name = "NAME")]
    time_column: Option<String>,
    /// Between the cells (default: found out)
    #[arg(long, value_name = "CHARACTER")]
    separator: Option<char>,
    /// What the clock of times without time zone is ahead of UTC, for example 1h
    #[arg(long, value_name = "DURATION", allow_hyphen_values = true)]
    utc_offset: Option<String>,
    /// Topic of a recording of another program (default: the only one)
    #[arg(long, value_name = "TOPIC")]
    topic: Option<String>,
    /// Fill empty cells where the neighbours are not farther apart, for example 10min (default: leave them)
    #[arg(long, value_name = "DURATION")]
    fill: Option<String>,
}

/// Reads measured series and says what they are.
pub fn measured(file: &Path, out: &Path, wanted: MeasuredArguments) -> Result<(), Failure> {
    let seconds = |name: &str, text: Option<&str>| -> Result<Option<f64>, Failure> {
        let parsed = text.map(Duration::parse).transpose();
        let parsed = parsed.map_err(|problem| Failure::Usage(format!("--{name}: {problem}")))?;
        Ok(parsed.map(|duration| duration.0.as_s()))
    };
    let offset = wanted.utc_offset.as_deref();
    let west = offset.is_some_and(|offset| offset.starts_with('-'));
    let offset_s = seconds("utc-offset", offset.map(|text| text.trim_start_matches(['-', '+'])))?;
    let offset_s = offset_s.unwrap_or(0.0) * if west { -1.0 } else { 1.0 };
    let fill_s = seconds("fill", wanted.fill.as_deref())?;
    let options = MeasuredOptions {
        separator: wanted.separator,
        time_column: wanted.time_column,
        utc_offset_s: offset_s,
        topic: wanted.topic,
    };
    let bytes = std::fs::read(file).map_err(|error| Failure::file("cannot read", file, &error))?;
    let table = if bytes.starts_with(b"\x89MCAP0") {
        MeasuredTable::from_mcap(&bytes, &options)
    } else {
        MeasuredTable::from_csv(&bytes, &options)
    };
    let mut table = table.map_err(|error| Failure::File(format!("{}: {error}", file.display())))?;
    let filled = fill_s.map_or(0, |longest_s| table.fill(longest_s));
    table
        .write_csv(BufWriter::new(output::create(out)?))
        .map_err(|error| Failure::file("cannot write", out, &error))?;
    if out == Path::new("-") {
        table.remarks.iter().for_each(|remark| eprintln!("{}: {remark}", file.display()));
        return Ok(());
    }
    tell(&table, out, filled);
    table.remarks.iter().for_each(|remark| line!("  {}: {remark}", file.display()));
    Ok(())
}

fn duration(seconds: f64) -> String {
    Time::from_s(seconds).map_or_else(|| format!("{seconds} s"), |time| time.to_string())
}

fn tell(table: &MeasuredTable, out: &Path, filled: usize) {
    let span_s = table.time_s.last().unwrap_or(&0.0) - table.time_s.first().unwrap_or(&0.0);
    let every = table.interval_s().map_or(String::new(), |s| format!(", every {}", duration(s)));
    line!("{}: {} rows over {}{every}", out.display(), table.time_s.len(), duration(span_s));
    let row = |column: &MeasuredColumn| {
        let known = column.values.iter().filter(|value| !value.is_nan());
        let least = known.clone().copied().fold(f64::INFINITY, f64::min);
        let greatest = known.copied().fold(f64::NEG_INFINITY, f64::max);
        let gaps = table.gaps(column);
        let longest =
            gaps.iter().max_by(|a, b| (a.to_s - a.from_s).total_cmp(&(b.to_s - b.from_s)));
        let longest = longest.map_or("-".into(), |gap| {
            format!("{} from {}", duration(gap.to_s - gap.from_s), duration(gap.from_s))
        });
        let unit = if column.unit.is_empty() { "-" } else { &column.unit };
        let number = |value: f64| format!("{value:.6}");
        vec![
            column.name.clone(),
            unit.into(),
            number(least),
            number(greatest),
            gaps.len().to_string(),
            longest,
        ]
    };
    let rows: Vec<Vec<String>> = table.columns.iter().map(row).collect();
    print_table(&["column", "unit", "least", "greatest", "gaps", "longest gap"], &rows);
    if filled > 0 {
        line!("{filled} empty cells filled");
    }
    let empty =
        table.columns.iter().flat_map(|column| &column.values).filter(|v| v.is_nan()).count();
    if empty > 0 {
        line!(
            "{empty} empty cells: the [[series]] of a model needs numbers: --fill 10min fills shorter gaps"
        );
    }
    if let Some(start) = table.start_unix_ns {
        let mut text = Vec::new();
        let first = MeasuredTable {
            start_unix_ns: Some(start),
            time_s: vec![0.0],
            ..MeasuredTable::default()
        };
        if first.write_csv(&mut text).is_ok() {
            let text = String::from_utf8_lossy(&text).into_owned();
            let time = text.lines().nth(1).unwrap_or_default();
            line!("the times are of the calendar: [run] start = \"{time}\" begins with them");
        }
    }
}
