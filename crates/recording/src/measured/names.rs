//! Names of columns with their units, as loggers write them: `T supply [°C]`, `flow (l/min)`, `p_bar`.

use anergy_core::units::{SI_SUFFIXES, Unit, is_difference, split_suffix};

/// A unit of a file: the SI suffix and the way there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FileUnit {
    pub si: &'static str,
    unit: Option<Unit>,
}

impl FileUnit {
    /// A value in SI; a difference of temperatures has no offset.
    pub fn to_si(self, value: f64, difference: bool) -> f64 {
        match self.unit {
            Some(unit) if difference && unit.suffix == "degc" => value,
            Some(unit) => unit.to_si(value),
            None => value,
        }
    }
}

/// Words whose letters do not give the suffix.
const ALIASES: [(&str, &str); 16] = [
    ("c", "degc"),
    ("degree celsius", "degc"),
    ("celsius", "degc"),
    ("kelvin", "k"),
    ("lpm", "l_min"),
    ("lph", "l_h"),
    ("cbm_h", "m3_h"),
    ("%", "percent"),
    ("sec", "s"),
    ("seconds", "s"),
    ("minutes", "min"),
    ("hours", "h"),
    ("days", "d"),
    ("-", ""),
    ("1", ""),
    ("--", ""),
];

/// The unit of a word such as `°C`, `m³/h`, `kg s-1`.
pub(super) fn unit(word: &str) -> Option<FileUnit> {
    let word = word.trim().to_lowercase();
    let plain: String = word
        .replace(" s-1", "_s")
        .replace(['/', '*', '·', '^'], "_")
        .replace('³', "3")
        .replace('²', "2")
        .replace('°', "deg")
        .replace('℃', "degc")
        .replace("_3", "3")
        .replace("_2", "2")
        .replace(' ', "");
    let alias = ALIASES.iter().find(|(alias, _)| *alias == word || *alias == plain);
    let suffix = alias.map_or(plain.as_str(), |(_, suffix)| suffix);
    if suffix.is_empty() {
        return Some(FileUnit { si: "", unit: None });
    }
    if let Some(si) = SI_SUFFIXES.iter().find(|si| **si == suffix) {
        return Some(FileUnit { si, unit: None });
    }
    Unit::find(suffix).map(|unit| FileUnit { si: unit.si, unit: Some(unit) })
}

/// Words in names of temperature differences, in lower case.
const DIFFERENCES: [&str; 8] =
    ["difference", "diff", "delta", "deltat", "\u{3b4}t", "dt", "spread", "spreizung"];

/// A column head: its name without unit, the unit, and a word that should be one but is not known.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Head {
    pub stem: String,
    pub unit: Option<FileUnit>,
    pub unknown: Option<String>,
}

impl Head {
    /// Reads `name [unit]`, `name (unit)`, `name_unit`.
    pub fn of(text: &str) -> Self {
        let text = text.trim();
        for (open, close) in [('[', ']'), ('(', ')')] {
            let Some((stem, rest)) = text.rsplit_once(open) else { continue };
            let Some(word) = rest.trim_end().strip_suffix(close) else { continue };
            let found = unit(word);
            let unknown = found.is_none().then(|| word.trim().to_owned());
            return Self { stem: cleaned(stem), unit: found, unknown };
        }
        match split_suffix(text).and_then(|(stem, suffix)| Some((stem, unit(suffix)?))) {
            Some((stem, unit)) => Self { stem: cleaned(stem), unit: Some(unit), unknown: None },
            None => Self { stem: cleaned(text), unit: None, unknown: None },
        }
    }

    /// Whether it is a difference of temperatures.
    pub fn is_difference(&self) -> bool {
        let stem = self.stem.to_lowercase();
        let mut words = stem.split(|c: char| !c.is_alphanumeric());
        is_difference(&stem) || words.any(|word| DIFFERENCES.contains(&word))
    }

    /// The name with its SI unit.
    pub fn name(&self) -> String {
        match self.unit {
            Some(unit) if !unit.si.is_empty() => format!("{}_{}", self.stem, unit.si),
            _ => self.stem.clone(),
        }
    }
}

/// Without spaces and what names of the model file cannot have.
fn cleaned(stem: &str) -> String {
    let words: Vec<&str> = stem
        .split(|c: char| c.is_whitespace() || c == ',')
        .filter(|word| !word.is_empty())
        .collect();
    words.join("_")
}
