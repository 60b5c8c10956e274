//! `anergy export`: results as a table of text, the network of a model as GeoJSON.

use super::run::read_model;
use crate::failure::Failure;
use crate::output::{self, line};
use anergy_import::geojson;
use anergy_recording::selection::choose;
use anergy_simulation::model_file::Duration;
use serde_json::{Map, Value};
use std::io::{BufWriter, ErrorKind, Write};
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

/// Writes what the ending of the file asks for.
pub fn export(
    input: &Path,
    out: &Path,
    table: &CsvOptions,
    origin: Option<&[f64]>,
) -> Result<(), Failure> {
    let ending = out.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    match ending.to_lowercase().as_str() {
        "geojson" | "json" => network(input, out, origin),
        _ if input.extension().is_some_and(|ending| ending == "toml") => {
            Err(Failure::Usage(format!(
                "{} is a model, which is exported as a network: --out FILE.geojson",
                input.display()
            )))
        }
        _ => csv(input, out, table),
    }
}

/// Writes nodes and edges of a model as GeoJSON.
fn network(input: &Path, out: &Path, origin: Option<&[f64]>) -> Result<(), Failure> {
    if input.extension().is_some_and(|ending| ending == "mcap") {
        let message =
            "results are exported as a table: --out FILE.csv; a network is that of a model file";
        return Err(Failure::Usage(message.into()));
    }
    let (text, model) = read_model(input)?;
    let plain = model.to_plain_toml().map_err(|problems| Failure::Model {
        problems,
        file: input.display().to_string(),
        text,
    })?;
    let plain: Map<String, Value> = toml::from_str(&plain)
        .map_err(|error| Failure::File(format!("{}: {error}", input.display())))?;
    let entries = |section: &str| -> Vec<Map<String, Value>> {
        let list = plain.get(section).and_then(Value::as_array);
        list.into_iter().flatten().filter_map(Value::as_object).cloned().collect()
    };
    let origin = match origin {
        Some([latitude, longitude]) => Some([*longitude, *latitude]),
        _ => {
            model.origin_rad.map(|[latitude, longitude]| [longitude, latitude].map(f64::to_degrees))
        }
    };
    let (nodes, edges) = (entries("node"), entries("edge"));
    let json = geojson::export(&model.name, &nodes, &edges, origin)
        .map_err(|problem| Failure::File(format!("{}: {problem}", input.display())))?;
    output::create(out)?
        .write_all(json.as_bytes())
        .map_err(|error| Failure::file("cannot write", out, &error))?;
    line!("{}: {} nodes, {} edges", out.display(), nodes.len(), edges.len());
    let unplaced = nodes.iter().filter(|node| !node.contains_key("x_m")).count();
    if unplaced > 0 {
        line!("{unplaced} nodes have no position: they and their edges are without geometry");
    }
    let rest: Vec<String> = plain
        .iter()
        .filter(|(name, _)| !["node", "edge"].contains(&name.as_str()))
        .filter_map(|(name, entries)| Some(format!("{} {name}", entries.as_array()?.len())))
        .collect();
    if !rest.is_empty() {
        line!("not written, as a network has no place for it: {}", rest.join(", "));
    }
    Ok(())
}

/// Writes recorded rows as CSV.
fn csv(results: &Path, out: &Path, options: &CsvOptions) -> Result<(), Failure> {
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
    let size = match anergy_recording::write_csv(recording, &chosen, every_s, file) {
        Ok(size) => size,
        // Nobody reads any more (`| head`).
        Err(error) if error.kind() == ErrorKind::BrokenPipe => return Ok(()),
        Err(error) => return Err(Failure::file("cannot write", out, &error)),
    };
    if out == Path::new("-") {
        return Ok(());
    }
    let until = recording.time_s.last().copied().unwrap_or(0.0);
    line!("{}: {} rows of {} channels, until {until} s", out.display(), size.rows, size.columns);
    Ok(())
}
