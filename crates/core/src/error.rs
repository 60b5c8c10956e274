//! Errors of the core; each names what is wrong and where.

use thiserror::Error;

/// A recorder could not keep the results.
#[derive(Debug, Error)]
pub enum RecordError {
    /// A file could not be created, written or read.
    #[error("{action} {path}: {source}")]
    File {
        /// What was tried, for example `cannot write`.
        action: &'static str,
        /// The file.
        path: String,
        /// The reason given by the system.
        #[source]
        source: std::io::Error,
    },
    /// A recorded file has an unexpected content.
    #[error("{path}: {problem}")]
    Format {
        /// The file.
        path: String,
        /// What is wrong with it.
        problem: String,
    },
}

/// A sparse system could not be factorised.
#[derive(Debug, Error, Clone, Copy, PartialEq, Eq)]
pub enum FactorError {
    /// The symbolic analysis failed.
    #[error("the sparsity pattern of {unknowns} unknowns could not be analysed")]
    Symbolic {
        /// Number of unknowns.
        unknowns: usize,
    },
    /// A pivot was not positive or the result is not finite.
    #[error("the matrix of {unknowns} unknowns is singular")]
    Singular {
        /// Number of unknowns.
        unknowns: usize,
    },
}
