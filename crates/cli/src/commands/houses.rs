//! `anergy houses`: the houses of the library.

use crate::failure::Failure;
use crate::output::line;
use anergy_simulation::model_file::house_library::{HOUSES, text};

/// Lists the houses, or prints one as a model file has it.
pub fn houses(name: Option<&str>) -> Result<(), Failure> {
    let Some(name) = name else {
        for (name, text) in HOUSES {
            let what = text.lines().next().unwrap_or_default().trim_start_matches("# ");
            line!("{name}  {what}");
        }
        return Ok(());
    };
    match text(name) {
        Some(text) => line!("{}", text.trim_end()),
        None => {
            let known: Vec<&str> = HOUSES.iter().map(|(name, _)| *name).collect();
            return Err(Failure::Usage(format!(
                "there is no house \"{name}\" in the library: it has {}",
                known.join(", ")
            )));
        }
    }
    Ok(())
}
