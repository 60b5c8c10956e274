//! `anergy import`: networks of other programs as model files.

use crate::failure::Failure;
use crate::output::{self, line};
use anergy_import::epanet::{self, EpanetOptions};
use anergy_import::geojson::{self, GeojsonOptions};
use anergy_import::pandapipes::{self, Friction};
use anergy_import::{Import, ImportError, NoteKind};
use std::io::Write;
use std::path::Path;

/// Notes of one kind that are printed; the model file has all.
const PRINTED: usize = 20;

/// Imports an EPANET input file.
pub fn epanet(file: &Path, out: &Path, wanted: EpanetOptions) -> Result<(), Failure> {
    write(file, out, epanet::import(&read(file)?, wanted))
}

/// How a GeoJSON network is read.
#[derive(Debug, clap::Args)]
pub struct GeojsonArguments {
    /// Ends of lines and points closer than this are one node, m
    #[arg(long, value_name = "METRES", default_value_t = 0.5)]
    snap: f64,
    /// Leave out the nodes that only join two equal pipes; the lengths add up
    #[arg(long)]
    simplify: bool,
    /// Type of the pipes that say neither type nor diameter, for example "steel DN50", or "steel DN{DN}" by their property DN
    #[arg(long, value_name = "TYPE")]
    pipe: Option<String>,
    /// Lines are trenches with supply and return, points are sites
    #[arg(long)]
    trenches: bool,
}

/// Imports a GeoJSON network.
pub fn geojson(file: &Path, out: &Path, wanted: GeojsonArguments) -> Result<(), Failure> {
    let GeojsonArguments { snap, simplify, pipe, trenches } = wanted;
    if !(0.0..=1e5).contains(&snap) {
        return Err(Failure::Usage(format!("--snap: {snap} m is no tolerance")));
    }
    let options = GeojsonOptions { snap_m: snap, simplify, pipe, trenches };
    write(file, out, geojson::import(&read(file)?, &options))
}

/// Friction laws of pandapipes.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub enum FrictionLaw {
    /// friction_model="colebrook"
    Colebrook,
    /// friction_model="swamee-jain"
    SwameeJain,
}

/// Imports a net of pandapipes.
pub fn pandapipes(file: &Path, out: &Path, friction: FrictionLaw) -> Result<(), Failure> {
    let friction = match friction {
        FrictionLaw::Colebrook => Friction::Colebrook,
        FrictionLaw::SwameeJain => Friction::SwameeJain,
    };
    write(file, out, pandapipes::import(&read(file)?, friction))
}

fn read(file: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(file).map_err(|error| Failure::file("cannot read", file, &error))
}

/// Writes the model file and says what it leaves out.
fn write(file: &Path, out: &Path, result: Result<Import, Vec<ImportError>>) -> Result<(), Failure> {
    let import = result.map_err(|errors| Failure::Import { file: file.to_owned(), errors })?;
    output::create(out)?
        .write_all(import.model.as_bytes())
        .map_err(|error| Failure::file("cannot write", out, &error))?;
    line!(
        "{}: {} nodes, {} edges, {} schedules from {}",
        out.display(),
        import.nodes,
        import.edges,
        import.schedules,
        file.display()
    );
    for (kind, title) in [
        (NoteKind::Problem, "wrong in the model"),
        (NoteKind::NotTranslated, "not translated"),
        (NoteKind::Changed, "said otherwise"),
    ] {
        let mut notes = import.notes.iter().filter(|note| note.kind == kind);
        let count = notes.clone().count();
        if count > 0 {
            line!("\n{title}: {count}");
        }
        for note in notes.by_ref().take(PRINTED) {
            match note.line {
                Some(number) => line!("  {}:{number}: {}", file.display(), note.text),
                None => line!("  {}", note.text),
            }
        }
        let more = notes.count();
        if more > 0 {
            line!("  and {more} more, listed at the head of {}", out.display());
        }
    }
    Ok(())
}
