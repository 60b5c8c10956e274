//! `anergy schema`: the grammar of the model file.

mod reference;

use crate::failure::Failure;
use crate::output::{line, print};

/// Prints the JSON Schema, or a page about every field.
pub fn schema(markdown: bool) -> Result<(), Failure> {
    let schema = anergy_simulation::model_file::schema::schema();
    if markdown {
        print(&reference::page(&schema));
    } else {
        line!("{schema:#}");
    }
    Ok(())
}
