//! What ends the program early: message, place, exit code.

use anergy_core::error::RecordError;
use anergy_import::ImportError;
use anergy_simulation::diagnostic::{Diagnostic, Diagnostics};
use anergy_simulation::error::RunError;
use miette::{LabeledSpan, NamedSource, miette};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use thiserror::Error;

/// Why a command failed.
#[derive(Debug, Error)]
pub enum Failure {
    /// The model is wrong.
    #[error("{} problem(s) in {file}", .problems.0.len())]
    Model {
        /// Its problems.
        problems: Diagnostics,
        /// Name of the model file.
        file: String,
        /// Its text.
        text: String,
    },
    /// A run or a solve failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A file of another program is wrong.
    #[error("{} problem(s) in {}", .errors.len(), .file.display())]
    Import {
        /// The file.
        file: PathBuf,
        /// What is wrong in it.
        errors: Vec<ImportError>,
    },
    /// A file could not be read or written.
    #[error("{0}")]
    File(String),
    /// A result could not be kept or read.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The command line is wrong.
    #[error("{0}")]
    Usage(String),
    /// Ctrl-C.
    #[error("interrupted; the results until then are kept")]
    Interrupted,
}

impl Failure {
    /// A file operation that failed.
    pub fn file(action: &str, path: &Path, error: &std::io::Error) -> Self {
        Self::File(format!("{action} {}: {error}", path.display()))
    }

    /// Prints the failure and gives its exit code.
    pub fn report(self) -> ExitCode {
        let code = match &self {
            Self::Run(error) if error.is_numerical() => 3,
            Self::Usage(_) => 2,
            Self::Interrupted => 130,
            _ => 1,
        };
        match self {
            Self::Model { problems, file, text } => {
                for problem in &problems.0 {
                    print_problem(problem, &file, &text);
                }
                let count = problems.0.len();
                let s = if count == 1 { "" } else { "s" };
                eprintln!("{count} problem{s} in {file}");
            }
            Self::Import { file, errors } => {
                for error in &errors {
                    match error.line {
                        Some(line) => eprintln!("{}:{line}: {error}", file.display()),
                        None => eprintln!("{}: {error}", file.display()),
                    }
                }
                let s = if errors.len() == 1 { "" } else { "s" };
                eprintln!("{} problem{s} in {}", errors.len(), file.display());
            }
            other => eprintln!("error: {other}"),
        }
        ExitCode::from(code)
    }
}

fn print_problem(problem: &Diagnostic, file: &str, text: &str) {
    let labels: Vec<LabeledSpan> =
        problem.span.iter().map(|span| LabeledSpan::underline(span.clone())).collect();
    let report = match &problem.hint {
        Some(hint) => miette!(labels = labels, help = hint.clone(), "{}", problem.message),
        None => miette!(labels = labels, "{}", problem.message),
    };
    let place = problem.line_and_column(text);
    let name = place.map_or(file.to_owned(), |(line, column)| format!("{file}:{line}:{column}"));
    if problem.span.is_some() {
        // miette prints file, line and column in the frame of the source.
        eprintln!("{:?}", report.with_source_code(NamedSource::new(file, text.to_owned())));
    } else {
        eprintln!("{name}: {report:?}");
    }
}
