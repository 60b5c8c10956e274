//! `anergy schema`: the grammar of the model file, or of the variations of a sweep.

mod reference;

use crate::failure::Failure;
use crate::output::{line, print};

/// Prints the JSON Schema, or a page about every field.
pub fn schema(markdown: bool, variations: bool) -> Result<(), Failure> {
    let schema = match variations {
        true => anergy_ensemble::definition::schema(),
        false => anergy_simulation::model_file::schema::schema(),
    };
    if markdown {
        print(&reference::page(&schema));
    } else {
        line!("{schema:#}");
    }
    Ok(())
}
