//! What keeps a comparison from being made.

use anergy_simulation::diagnostic::Diagnostics;
use anergy_simulation::error::RunError;
use thiserror::Error;

/// Why `explain` cannot work.
#[derive(Debug, Error)]
pub enum ExplainError {
    /// The sensor file is wrong.
    #[error("sensor file: {problem}")]
    Sensors {
        /// What is wrong, and where.
        problem: String,
    },
    /// The table of measurements is wrong.
    #[error("data: {problem}")]
    Data {
        /// What is wrong, and where.
        problem: String,
    },
    /// The split file is wrong.
    #[error("split file: {problem}")]
    Split {
        /// What is wrong, and where.
        problem: String,
    },
    /// A sensor does not fit the model.
    #[error("sensor \"{column}\": {problem}")]
    Sensor {
        /// Its column.
        column: String,
        /// What does not fit.
        problem: String,
    },
    /// The model is wrong.
    #[error("the model: {0}")]
    Model(Diagnostics),
    /// The model does not run with the measured inputs.
    #[error("the model with the measured inputs: {0}")]
    Run(#[from] RunError),
    /// No such effect in the file.
    #[error("there is no [[effect]] {id} of explain in the file")]
    NoEffect {
        /// What was named.
        id: String,
    },
}
