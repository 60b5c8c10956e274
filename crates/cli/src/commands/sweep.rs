//! `anergy sweep`: many variants of a model on all cores, into a folder that a killed sweep goes on from.

use super::run::{finished, print_files, read_model, run_into};
use crate::failure::Failure;
use crate::interrupt;
use crate::output::line;
use crate::progress::MemberProgress;
use anergy_ensemble::definition::Definition;
use anergy_ensemble::ensemble::{Ensemble, EnsembleError, all_threads};
use anergy_ensemble::store::{Store, StoreError, is_folder_of};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Failed members that are told.
const TOLD: usize = 5;

/// What is varied, and where the results go.
#[derive(Debug, clap::Args)]
pub struct SweepArguments {
    /// What varies, how members are chosen, what is kept
    #[arg(value_name = "VARIATIONS")]
    variations: PathBuf,
    /// Folder for members.csv and channels; a stopped sweep goes on from there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Threads (default: all cores)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Run only this member, with all its channels and a report, into DIR/member-N
    #[arg(long, value_name = "N")]
    member: Option<usize>,
}

/// Runs all members that have not finished.
pub fn sweep(path: &Path, wanted: &SweepArguments) -> Result<(), Failure> {
    let ensemble = read(path, &wanted.variations)?;
    if let Some(member) = wanted.member {
        return one(path, &ensemble, member, &wanted.out);
    }
    let mut store = Store::open(&wanted.out, &ensemble)?;
    let pending = store.pending(ensemble.len());
    if store.finished() > 0 && !pending.is_empty() {
        line!("{} of {} members are there; going on", store.finished(), ensemble.len());
    }
    interrupt::listen();
    let mut progress = MemberProgress::new(store.finished(), ensemble.len());
    let mut broken = None;
    let threads = wanted.threads.map_or_else(all_threads, usize::from);
    ensemble.run_all(&pending, threads, &mut |outcome| {
        if let Some(outcome) = outcome {
            broken = store.keep(&outcome).err();
            progress.update(store.finished(), store.failed());
        }
        broken.is_none() && !interrupt::requested()
    });
    progress.finish();
    let columns = store.write_table()?;
    if let Some(error) = broken {
        return Err(error.into());
    }
    tell(&store, &ensemble, &columns, &wanted.out)?;
    finished()
}

fn read(path: &Path, variations: &Path) -> Result<Ensemble, Failure> {
    let (text, model) = read_model(path)?;
    let file = variations.display().to_string();
    let written = std::fs::read_to_string(variations)
        .map_err(|error| Failure::file("cannot read", variations, &error))?;
    let definition = Definition::from_toml(&written).map_err(|problems| Failure::Model {
        problems,
        file: file.clone(),
        text: written.clone(),
    })?;
    Ensemble::new(Arc::new(model), definition).map_err(|error| match error {
        EnsembleError::Model(problems) => {
            Failure::Model { problems, file: path.display().to_string(), text }
        }
        EnsembleError::Variations(problems) => Failure::Model { problems, file, text: written },
    })
}

fn tell(store: &Store, ensemble: &Ensemble, columns: &[String], out: &Path) -> Result<(), Failure> {
    let (finished, failed) = (store.finished(), store.failed());
    line!("{finished} of {} members finished, {failed} of them failed", ensemble.len());
    for (member, message) in store.failures(TOLD)? {
        line!("  member {member}: {message}");
    }
    if failed > TOLD {
        line!("  ... {} more in members.csv", failed - TOLD);
    }
    if finished > failed {
        for pattern in ensemble.definition().unmatched(columns) {
            eprintln!("warning: keep: no indicator matches \"{pattern}\"");
        }
    }
    let channels = if ensemble.channels().is_empty() { "" } else { ", channels/" };
    line!("\nresults in {}: members.csv{channels}", out.display());
    Ok(())
}

/// One member with everything that `anergy run` leaves.
fn one(path: &Path, ensemble: &Ensemble, member: usize, out: &Path) -> Result<(), Failure> {
    if member >= ensemble.len() {
        let last = ensemble.len().saturating_sub(1);
        return Err(Failure::Usage(format!("--member {member}: members are 0 to {last}")));
    }
    // Beside the results of another ensemble nobody would know whose member it is.
    is_folder_of(out, ensemble)?;
    let names = ensemble.definition().variations.iter().map(|variation| &variation.name);
    for (name, value) in names.zip(ensemble.values(member)) {
        line!("{name} = {value}");
    }
    let model = ensemble.model().with(&ensemble.changes(member));
    let mut model = model.map_err(|error| Failure::File(error.to_string()))?;
    let file = path.display().to_string();
    let plain = model.to_plain_toml().map_err(|problems| Failure::Model {
        problems,
        file: file.clone(),
        text: String::new(),
    })?;
    model.text = plain.into();
    let folder = out.join(format!("member-{member}"));
    run_into(&model, &ensemble.model().text, &file, ensemble.options(), &folder)?;
    print_files(&folder);
    finished()
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        Self::File(error.to_string())
    }
}
