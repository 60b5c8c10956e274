//! What is wrong with a model: a sentence, its place in the file, a hint.

use std::fmt;
use std::ops::Range;

/// One problem of a model file or of the model it describes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// What is wrong, naming the culprit and the numbers.
    pub message: String,
    /// What the user can do.
    pub hint: Option<String>,
    /// Bytes of the model text concerned; `None` where the model did not come from a file.
    pub span: Option<Range<usize>>,
}

impl Diagnostic {
    /// A problem at a place.
    pub fn new(message: impl Into<String>, span: Option<Range<usize>>) -> Self {
        Self { message: message.into(), hint: None, span }
    }

    /// The same with a hint.
    #[must_use]
    pub fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Line and column (from 1) of the start of the place in the model text.
    pub fn line_and_column(&self, text: &str) -> Option<(usize, usize)> {
        let start = self.span.as_ref()?.start.min(text.len());
        let before = text.get(..start)?;
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |last| last.chars().count()) + 1;
        Some((line, column))
    }
}

/// All problems found; never empty.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl Diagnostics {
    /// What is found in both pipes of a trench is one mistake of the user.
    #[must_use]
    pub(crate) fn without_repetition(mut self) -> Self {
        let mut seen: Vec<Diagnostic> = Vec::new();
        self.0.retain(|problem| {
            let fresh = !seen.contains(problem);
            if fresh {
                seen.push(problem.clone());
            }
            fresh
        });
        self
    }

    /// One line per problem with line, column and hint.
    pub fn render(&self, text: &str) -> String {
        let mut out = String::new();
        for diagnostic in &self.0 {
            match diagnostic.line_and_column(text) {
                Some((line, column)) => out.push_str(&format!("{line}:{column}: ")),
                None => out.push_str("model: "),
            }
            out.push_str(&diagnostic.message);
            out.push('\n');
            if let Some(hint) = &diagnostic.hint {
                out.push_str(&format!("    hint: {hint}\n"));
            }
        }
        out
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let messages: Vec<&str> = self.0.iter().map(|d| d.message.as_str()).collect();
        f.write_str(&messages.join("\n"))
    }
}

impl std::error::Error for Diagnostics {}

/// `did you mean "x"?` for the most similar of the known words.
pub(crate) fn did_you_mean<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    known
        .map(|candidate| (strsim::damerau_levenshtein(word, candidate), candidate))
        .filter(|(distance, candidate)| *distance <= 1 + candidate.chars().count() / 4)
        // Two short words without a letter in common are not alike.
        .filter(|(distance, _)| *distance < word.chars().count())
        .min()
        .map(|(_, candidate)| format!("did you mean `{candidate}`?"))
}
