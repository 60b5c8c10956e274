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

/// A number as a message shows it: six decimals, but with an exponent where it has more than six digits before them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Legible(pub f64);

impl std::fmt::Display for Legible {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.abs() < 1e6 { write!(f, "{:.6}", self.0) } else { write!(f, "{:.3e}", self.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::Legible;

    #[test]
    fn numbers_that_can_be_read() {
        for (value, text) in [
            (-37.854_118_4, "-37.854118"),
            (999_999.5, "999999.500000"),
            (1e6, "1.000e6"),
            (-3.959_765e109, "-3.960e109"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(Legible(value).to_string(), text);
        }
    }
}
