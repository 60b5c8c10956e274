//! `anergy report`: recorded results as one HTML file.

use crate::failure::Failure;
use crate::output::{self, line};
use std::io::Write;
use std::path::Path;

/// Makes the report of a results file.
pub fn report(results: &Path, out: &Path) -> Result<(), Failure> {
    let read = anergy_recording::read(results)?;
    if let Some(damage) = &read.damage {
        eprintln!("warning: {damage}");
    }
    let html = anergy_report::html(&read.recording);
    output::create(out)?
        .write_all(html.as_bytes())
        .map_err(|error| Failure::file("cannot write", out, &error))?;
    if out == Path::new("-") {
        return Ok(());
    }
    line!("{} rows reported in {}", read.recording.time_s.len(), out.display());
    Ok(())
}
