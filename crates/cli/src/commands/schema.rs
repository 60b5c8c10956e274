//! `anergy schema`: the grammar of the model file.

use crate::failure::Failure;
use crate::output::line;

/// Prints the JSON Schema.
pub fn schema() -> Result<(), Failure> {
    line!("{:#}", anergy_simulation::model_file::schema::schema());
    Ok(())
}
