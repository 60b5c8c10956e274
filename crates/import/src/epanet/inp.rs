//! The lines of an EPANET input file: sections of words, with the number of each line.

use crate::ImportError;

/// The sections of EPANET 2.3 by the letters that it looks at.
const SECTIONS: &[(&str, Section)] = &[
    ("TITL", Section::Title),
    ("JUNC", Section::Junctions),
    ("RESE", Section::Reservoirs),
    ("TANK", Section::Tanks),
    ("PIPE", Section::Pipes),
    ("PUMP", Section::Pumps),
    ("VALV", Section::Valves),
    ("DEMA", Section::Demands),
    ("EMIT", Section::Emitters),
    ("PATT", Section::Patterns),
    ("CURV", Section::Curves),
    ("STAT", Section::Status),
    ("CONT", Section::Controls),
    ("RULE", Section::Rules),
    ("OPTI", Section::Options),
    ("TIME", Section::Times),
    ("COOR", Section::Coordinates),
    ("LEAK", Section::Leakage),
    ("QUAL", Section::Other("QUALITY", "water quality")),
    ("SOUR", Section::Other("SOURCES", "water quality")),
    ("REAC", Section::Other("REACTIONS", "water quality")),
    ("MIXI", Section::Other("MIXING", "water quality")),
    ("ENER", Section::Other("ENERGY", "prices and efficiencies of pumps")),
    ("REPO", Section::Other("REPORT", "what EPANET prints")),
    ("VERT", Section::Other("VERTICES", "bends on the map; the lengths of the pipes are given")),
    ("LABE", Section::Other("LABELS", "words on the map")),
    ("BACK", Section::Other("BACKDROP", "the picture below the map")),
    ("TAGS", Section::Other("TAGS", "words at nodes and links")),
    ("ROUG", Section::Other("ROUGHNESS", "unused by EPANET")),
];

/// A section of an input file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Section {
    Title,
    Junctions,
    Reservoirs,
    Tanks,
    Pipes,
    Pumps,
    Valves,
    Demands,
    Emitters,
    Patterns,
    Curves,
    Status,
    Controls,
    Rules,
    Options,
    Times,
    Coordinates,
    Leakage,
    /// A section without hydraulics: its name and what it is about.
    Other(&'static str, &'static str),
}

/// A line that says something.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row<'a> {
    pub section: Section,
    /// Number of the line, from 1.
    pub line: usize,
    /// Its words without the comment.
    pub words: Vec<&'a str>,
    /// Its text without the comment.
    pub text: &'a str,
}

impl Row<'_> {
    /// A number in a word, or its default where the line is shorter.
    pub fn number(&self, i: usize, what: &str) -> Result<f64, ImportError> {
        let Some(word) = self.words.get(i) else {
            return Err(self.error(format!("{what} is missing")));
        };
        match word.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.error(format!("{what}: \"{word}\" is not a number"))),
        }
    }

    pub fn number_or(&self, i: usize, default: f64, what: &str) -> Result<f64, ImportError> {
        if i < self.words.len() { self.number(i, what) } else { Ok(default) }
    }

    /// A number above zero.
    pub fn positive(&self, i: usize, what: &str) -> Result<f64, ImportError> {
        match self.number(i, what)? {
            value if value > 0.0 => Ok(value),
            value => Err(self.error(format!("{what} = {value} must be positive"))),
        }
    }

    /// A number not below zero.
    pub fn not_negative(&self, i: usize, what: &str) -> Result<f64, ImportError> {
        match self.number(i, what)? {
            value if value >= 0.0 => Ok(value),
            value => Err(self.error(format!("{what} = {value} must not be negative"))),
        }
    }

    pub fn word(&self, i: usize, what: &str) -> Result<&str, ImportError> {
        self.words.get(i).copied().ok_or_else(|| self.error(format!("{what} is missing")))
    }

    pub fn error(&self, message: impl Into<String>) -> ImportError {
        ImportError::new(self.line, message)
    }
}

/// Whether a word begins with letters, in any case: how EPANET knows its words.
pub(super) fn begins(word: &str, letters: &str) -> bool {
    word.len() >= letters.len()
        && word.as_bytes()[..letters.len()].eq_ignore_ascii_case(letters.as_bytes())
}

/// The rows of a file.
pub(super) fn rows(text: &str) -> (Vec<Row<'_>>, Vec<ImportError>) {
    let (mut rows, mut errors) = (Vec::new(), Vec::new());
    let mut section = None;
    for (i, full) in text.lines().enumerate() {
        let line = i + 1;
        let text = full.split(';').next().unwrap_or_default().trim();
        if let Some(name) = text.strip_prefix('[') {
            if begins(name, "END") {
                break;
            }
            let known = SECTIONS.iter().find(|(letters, _)| begins(name, letters));
            section = known.map(|(_, section)| *section);
            if known.is_none() {
                errors.push(ImportError::new(line, format!("unknown section \"{text}\"")));
                // Its lines are not wrong as well.
                section = Some(Section::Other("", ""));
            }
            continue;
        }
        if text.is_empty() {
            continue;
        }
        match section {
            None => errors.push(ImportError::new(line, "text before the first [SECTION]")),
            Some(section) => rows.push(Row { section, line, words: words(text), text }),
        }
    }
    (rows, errors)
}

/// Words between spaces, tabs and commas; quotes keep them together.
fn words(text: &str) -> Vec<&str> {
    let separates = |c: char| c.is_whitespace() || c == ',';
    let mut words = Vec::new();
    let mut rest = text;
    loop {
        rest = rest.trim_start_matches(separates);
        if rest.is_empty() {
            return words;
        }
        let (word, end) = match rest.strip_prefix('"') {
            Some(inside) => match inside.find('"') {
                Some(end) => (&inside[..end], end + 2),
                None => (inside, rest.len()),
            },
            None => {
                let end = rest.find(separates).unwrap_or(rest.len());
                (&rest[..end], end)
            }
        };
        words.push(word);
        rest = &rest[end..];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_a_file() {
        let text = "[TITLE]\nA net ; comment\n\n[junctions] ;x\n a, 1.5\t\"b c\" ;\n[END]\nrest";
        let (rows, errors) = rows(text);
        assert_eq!(errors, []);
        assert_eq!(rows.len(), 2);
        assert_eq!((rows[0].section, rows[0].line, rows[0].text), (Section::Title, 2, "A net"));
        assert_eq!(rows[1].words, ["a", "1.5", "b c"]);
        assert_eq!(rows[1].line, 5);
        assert_eq!(rows[1].number(1, "elevation").unwrap(), 1.5);
        let error = rows[1].number(2, "demand").unwrap_err();
        assert_eq!(error, ImportError::new(5, "demand: \"b c\" is not a number"));
    }

    #[test]
    fn what_is_no_section() {
        let (_, errors) = rows("x\n[FOO]\ny\n[PIPES");
        let lines: Vec<Option<usize>> = errors.iter().map(|error| error.line).collect();
        assert_eq!(lines, [Some(1), Some(2)]);
    }
}
