//! EPANET input files (`.inp`) as models.
//!
//! **Laws** Head losses are those of EPANET 2.2: Swamee-Jain with Dunlop's transition (gravity 32.2 ft/s2),
//! Hazen-Williams and Chezy-Manning with its constants. Tanks and reservoirs are heads that hold their
//! value of t = 0; patterns become schedules; controls that act at t = 0 are taken, the others listed.
//!
//! **Sources** `rossman2020` (EPANET 2.2: laws, constants, meaning of the sections).

mod controls;
mod inp;
mod network;
mod pumps;
mod reach;
mod schedules;
mod translate;
mod units;
mod valves;

use crate::model_text::ModelText;
use crate::{Import, ImportError, NoteKind, text_of};
use inp::{Row, Section};
use network::Network;
use units::Options;

/// How an EPANET file is imported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EpanetOptions {
    /// Only the state at t = 0: no schedules.
    pub steady: bool,
    /// Pressure-reducing and -sustaining valves are self-acting, with a narrow band, instead of ideal.
    pub self_acting: bool,
}

/// The model file of an EPANET input file.
///
/// # Errors
/// All lines that EPANET would not read either.
pub fn import(bytes: &[u8], wanted: EpanetOptions) -> Result<Import, Vec<ImportError>> {
    let content = text_of(bytes);
    let (rows, mut errors) = inp::rows(&content);
    let mut text = ModelText::default();
    let options = Options::read(&rows, &mut text, &mut errors);
    let mut network = Network::read(&rows, &options, &mut text, &mut errors);
    controls::apply(&mut network, &rows, &options, &mut text, &mut errors);
    other_sections(&rows, &mut text);
    if errors.is_empty() && network.nodes.is_empty() {
        errors.push(ImportError::new(None, "the file has no nodes: is it an EPANET input file?"));
    }
    if !errors.is_empty() {
        errors.sort_by_key(|error| error.line);
        return Err(errors);
    }
    let title: Vec<&str> =
        rows.iter().filter(|row| row.section == Section::Title).map(|row| row.text).collect();
    translate::translate(&network, &options, wanted, &title, &mut text);
    Ok(text.finish("Imported from an EPANET input file. What it says otherwise or not at all:"))
}

/// One note for each section without hydraulics.
fn other_sections(rows: &[Row<'_>], text: &mut ModelText) {
    let mut sections: Vec<(Section, usize, usize)> = Vec::new();
    for row in rows {
        if !matches!(row.section, Section::Other(..) | Section::Leakage) {
            continue;
        }
        match sections.iter_mut().find(|(section, ..)| *section == row.section) {
            Some((_, _, count)) => *count += 1,
            None => sections.push((row.section, row.line, 1)),
        }
    }
    for (section, line, count) in sections {
        let s = if count == 1 { "" } else { "s" };
        match section {
            Section::Other(name, about) => {
                let what = format!("[{name}], {count} line{s}: {about}");
                text.note(NoteKind::NotTranslated, line, what);
            }
            _ => {
                let what = format!("[LEAKAGE], {count} line{s}: the pipes of the model are tight");
                text.note(NoteKind::Problem, line, what);
            }
        }
    }
}

#[cfg(test)]
mod tests;
