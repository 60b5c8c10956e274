//! `anergy export`: results as a table of text.

use crate::failure::Failure;
use crate::output::{self, line};
use anergy_recording::selection::choose;
use anergy_simulation::model_file::Duration;
use std::io::BufWriter;
use std::path::Path;

/// What is written of a recording.
#[derive(Debug, clap::Args)]
pub struct CsvOptions {
    /// Channels or components; "*" stands for any text, for example "*.t_k" (default: all)
    #[arg(long, value_name = "PATTERN", num_args = 1..)]
    channels: Vec<String>,
    /// Time between the rows: the first at or after each multiple, for example 60s (default: all)
    #[arg(long, value_name = "DURATION")]
    every: Option<String>,
    /// Units besides SI, for example degc bar l_h (default: SI)
    #[arg(long, value_name = "UNIT", num_args = 1..)]
    units: Vec<String>,
}

/// Writes recorded rows as CSV.
pub fn csv(results: &Path, out: &Path, options: &CsvOptions) -> Result<(), Failure> {
    let every_s = match &options.every {
        None => None,
        Some(text) => {
            let every = Duration::parse(text)
                .map_err(|problem| Failure::Usage(format!("--every: {problem}")))?;
            if every.0.as_s() <= 0.0 {
                return Err(Failure::Usage("--every: must be longer than 0 s".into()));
            }
            Some(every.0.as_s())
        }
    };
    let read = anergy_recording::read(results)?;
    if let Some(damage) = &read.damage {
        eprintln!("warning: {}: {damage}", results.display());
    } else if read.recording.summary.is_null() {
        eprintln!("warning: {}: the run did not reach its end", results.display());
    }
    let recording = &read.recording;
    let chosen = choose(&recording.channels, &options.channels, &options.units)
        .map_err(|problem| Failure::Usage(problem.to_string()))?;
    let file = BufWriter::new(output::create(out)?);
    let size = anergy_recording::write_csv(recording, &chosen, every_s, file)
        .map_err(|error| Failure::file("cannot write", out, &error))?;
    if out == Path::new("-") {
        return Ok(());
    }
    let until = recording.time_s.last().copied().unwrap_or(0.0);
    line!("{}: {} rows of {} channels, until {until} s", out.display(), size.rows, size.columns);
    Ok(())
}
