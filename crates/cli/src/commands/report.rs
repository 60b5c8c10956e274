//! `anergy report`: recorded results as one HTML file.

use crate::failure::Failure;
use crate::output::line;
use std::path::Path;

/// Makes the report of a results file.
pub fn report(results: &Path, out: &Path) -> Result<(), Failure> {
    let read = anergy_recording::read(results)?;
    if let Some(damage) = &read.damage {
        eprintln!("warning: {damage}");
    }
    std::fs::write(out, anergy_report::html(&read.recording))
        .map_err(|error| Failure::file("cannot write", out, &error))?;
    line!("{} rows reported in {}", read.recording.time_s.len(), out.display());
    Ok(())
}
