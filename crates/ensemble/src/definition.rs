//! The file of variations: what is varied, how the members are chosen, how they run, what is kept of them.

mod entries;

pub use entries::*;

use crate::spread::{Spread, Wrong};
use anergy_recording::selection::glob;
use anergy_simulation::diagnostic::{Diagnostic, Diagnostics};
use anergy_simulation::document::{self, Span, Tree, TreeKind};
use anergy_simulation::fields::{Reader, SiTable};
use schemars::JsonSchema;
use serde_json::{Map, Value, json};

/// The JSON Schema of the file, for editors.
pub fn schema() -> Value {
    json!(schemars::schema_for!(VariationsFile))
}

/// A variation that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Variation {
    /// What its column is called.
    pub name: String,
    /// What is varied, as written.
    pub parameters: Vec<String>,
    /// Whether values are set, or multiply.
    pub how: How,
    /// Its values.
    pub spread: Spread,
    /// Where it stands.
    pub(crate) places: Places,
}

/// Where an entry and its fields stand.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Places {
    whole: Span,
    fields: Vec<(&'static str, Span)>,
}

impl Places {
    fn of(tree: &Tree, table: &SiTable) -> Self {
        let fields = table.fields.iter().map(|field| (field.si(), field.span)).collect();
        Self { whole: tree.span, fields }
    }

    /// The place of the first of these fields that was written.
    pub(crate) fn of_field(&self, names: &[&str]) -> Option<std::ops::Range<usize>> {
        let written = self.fields.iter().find(|(field, _)| names.contains(field));
        written.map_or(self.whole, |(_, span)| *span).range()
    }
}

/// A file of variations that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Definition {
    /// The text, for messages.
    pub text: String,
    /// How members are chosen.
    pub ensemble: EnsembleEntry,
    /// What replaces the `[run]` of the model.
    pub run: RunEntry,
    /// What is kept of each run.
    pub keep: KeepEntry,
    /// What is varied.
    pub variations: Vec<Variation>,
    pub(crate) keep_places: Places,
    /// The whole as one object, by which the ensemble of a folder is recognised.
    pub document: Value,
}

/// Names of columns that are not of variations; an empty one is no name.
const OF_RESULTS: [&str; 5] = ["member", "id", "time_s", "error", ""];
/// Members of an ensemble at most: all of their coordinates are in memory.
pub const MOST_MEMBERS: usize = 10_000_000;
const TOO_MANY: &str = "at most 10 000 000";

const SECTIONS: [&str; 5] = ["format", "ensemble", "run", "keep", "variation"];

impl Definition {
    /// Reads the text of a file.
    ///
    /// # Errors
    /// All problems with places and hints.
    pub fn from_toml(text: &str) -> Result<Self, Diagnostics> {
        let tree = document::parse_toml(text)?;
        let mut reader = Reader::default();
        check_sections(&tree, &mut reader);
        let (ensemble, ensemble_places) = section::<EnsembleEntry>(&tree, "ensemble", &mut reader);
        let (run, _) = section::<RunEntry>(&tree, "run", &mut reader);
        let (keep, keep_places) = section::<KeepEntry>(&tree, "keep", &mut reader);
        let variations = variations(&tree, &mut reader);
        let definition = Self {
            text: text.to_owned(),
            ensemble,
            run,
            keep,
            variations,
            keep_places,
            document: tree.to_json(),
        };
        if reader.problems.is_empty() {
            definition.check_design(&ensemble_places, &mut reader);
        }
        if reader.problems.is_empty() { Ok(definition) } else { Err(Diagnostics(reader.problems)) }
    }

    /// Reads an object with the grammar of the file; the version may be left out.
    ///
    /// # Errors
    /// As [`Self::from_toml`].
    pub fn from_json(object: &Map<String, Value>) -> Result<Self, Diagnostics> {
        let mut file = Map::new();
        file.insert("format".into(), json!(1));
        file.extend(object.iter().map(|(name, value)| (name.clone(), value.clone())));
        // Through the text, so that places are those of the file that the user could save.
        Self::from_toml(&document::to_toml(&file)?)
    }

    /// Which random numbers members draw.
    pub fn random(&self) -> Random {
        self.ensemble.random.unwrap_or(match self.ensemble.design {
            Design::MonteCarlo | Design::LatinHypercube => Random::Own,
            Design::Grid | Design::List | Design::Points => Random::Same,
        })
    }

    /// Patterns of `[keep]` that none of these indicators has the form of.
    pub fn unmatched(&self, indicators: &[String]) -> Vec<String> {
        let met = |pattern: &str| indicators.iter().any(|name| glob(pattern, name));
        self.keep.kpis.iter().filter(|pattern| !met(pattern)).cloned().collect()
    }

    /// Whether design and variations fit each other.
    fn check_design(&self, places: &Places, reader: &mut Reader) {
        let entry = &self.ensemble;
        let sampled = matches!(entry.design, Design::MonteCarlo | Design::LatinHypercube);
        let mut report = |fields: &[&str], message: String, hint: &str| {
            reader.report(Diagnostic::new(message, places.of_field(fields)).with_hint(hint));
        };
        match (sampled, entry.members) {
            (true, None) => report(
                &["design"],
                "ensemble: members is missing".into(),
                "how many samples are drawn",
            ),
            (true, Some(0)) => {
                report(&["members"], "ensemble: members = 0 is no ensemble".into(), "at least 1");
            }
            (true, Some(members)) if members > MOST_MEMBERS => {
                let message = format!("ensemble: members = {members} is too many");
                report(&["members"], message, TOO_MANY);
            }
            (false, Some(_)) => {
                let hint = "it is for monte_carlo and latin_hypercube; others have as many as their values make";
                report(&["members"], "ensemble: members belongs to samples".into(), hint);
            }
            _ => {}
        }
        if entry.points.is_empty() == (entry.design == Design::Points) {
            let message = "ensemble: points and design = \"points\" belong together".into();
            report(&["points", "design"], message, "a row per member, a number per variation");
        }
        for (i, row) in entry.points.iter().enumerate() {
            let count = self.variations.len();
            if row.len() != count {
                let message = format!(
                    "ensemble: points[{i}] has {} numbers for {count} variations",
                    row.len()
                );
                report(&["points"], message, "a number per variation");
            } else if let Some(u) = row.iter().find(|u| !(0.0..=1.0).contains(*u)) {
                let message =
                    format!("ensemble: points[{i}] has {u}, which is not between 0 and 1");
                report(
                    &["points"],
                    message,
                    "a point of the unit cube: it becomes a value by the distribution",
                );
            }
        }
        self.check_counts(reader);
    }

    /// Grids and lists need values that can be counted.
    fn check_counts(&self, reader: &mut Reader) {
        let design = self.ensemble.design;
        if !matches!(design, Design::Grid | Design::List) {
            return;
        }
        let mut first: Option<(usize, &str)> = None;
        let mut members = Some(1_usize);
        for variation in &self.variations {
            let name = &variation.name;
            let Some(count) = variation.spread.count() else {
                let place = variation.places.of_field(&["low", "mean"]);
                let message =
                    format!("variation \"{name}\": a distribution has no values to go through");
                let hint = "add count to low and high, list values, or choose design = \"latin_hypercube\"";
                reader.report(Diagnostic::new(message, place).with_hint(hint));
                continue;
            };
            // Once, at the one by which there are too many.
            let within = |members: &usize| *members <= MOST_MEMBERS;
            let next = members.and_then(|m| m.checked_mul(count)).filter(within);
            let next = if design == Design::List { Some(count).filter(within) } else { next };
            if members.is_some() && next.is_none() {
                let place = variation.places.of_field(&["count", "values"]);
                let message =
                    format!("variation \"{name}\": its {count} values make too many members");
                reader.report(Diagnostic::new(message, place).with_hint(TOO_MANY));
            }
            members = next;
            let (expected, other) = *first.get_or_insert((count, name));
            if design == Design::List && count != expected {
                let place = variation.places.of_field(&["values", "count"]);
                let message =
                    format!("variation \"{name}\" has {count} values, \"{other}\" has {expected}");
                let hint = "in a list all have as many as there are members";
                reader.report(Diagnostic::new(message, place).with_hint(hint));
            }
        }
    }
}

fn check_sections(tree: &Tree, reader: &mut Reader) {
    for (key, _) in tree.entries() {
        if SECTIONS.contains(&key.name.as_str()) {
            continue;
        }
        let near = SECTIONS
            .iter()
            .map(|known| (strsim::damerau_levenshtein(&key.name, known), known))
            .filter(|(distance, _)| *distance <= 3)
            .min();
        let hint = match near {
            Some((_, known)) => format!("did you mean `{known}`?"),
            None => format!("known are {}", SECTIONS.join(", ")),
        };
        let message = format!("unknown section `{}`", key.name);
        reader.report(Diagnostic::new(message, key.span.range()).with_hint(hint));
    }
    match tree.get("format").map(|format| (format.to_json(), format.span)) {
        None => {
            let problem = Diagnostic::new("format is missing", Some(0..0));
            reader.report(problem.with_hint("write format = 1 on top of the file"));
        }
        Some((format, span)) if format != json!(1) => {
            let problem = Diagnostic::new(format!("format = {format} is unknown"), span.range());
            reader.report(problem.with_hint("this version reads format = 1"));
        }
        Some(_) => {}
    }
}

fn section<T>(tree: &Tree, name: &'static str, reader: &mut Reader) -> (T, Places)
where
    T: serde::de::DeserializeOwned + JsonSchema + Default + 'static,
{
    let read = tree.get(name).and_then(|section| {
        let (entry, table) = reader.read::<T>(name, section)?;
        Some((entry, Places::of(section, &table)))
    });
    read.unwrap_or_default()
}

fn variations(tree: &Tree, reader: &mut Reader) -> Vec<Variation> {
    let entries: &[Tree] = match tree.get("variation") {
        Some(Tree { kind: TreeKind::Array(entries), .. }) => entries,
        Some(other) => {
            let problem = Diagnostic::new("variation must be a list", other.span.range());
            reader.report(problem.with_hint("write [[variation]] in double brackets"));
            return Vec::new();
        }
        None => &[],
    };
    if entries.is_empty() {
        let problem = Diagnostic::new("there is no [[variation]]", Some(0..0));
        reader
            .report(problem.with_hint("add one: parameter = \"component.field\", values = [...]"));
    }
    let mut read: Vec<Variation> = Vec::new();
    for (i, tree) in entries.iter().enumerate() {
        let what = tree.text("name").or(tree.text("parameter"));
        let what = what
            .map_or_else(|| format!("variation {}", i + 1), |name| format!("variation \"{name}\""));
        let Some((entry, table)) = reader.read::<VariationEntry>(&what, tree) else { continue };
        let places = Places::of(tree, &table);
        match variation(entry, places.clone(), &read) {
            Ok(variation) => read.push(variation),
            Err(Wrong { field, message, hint }) => {
                let problem =
                    Diagnostic::new(format!("{what}: {message}"), places.of_field(&[field]));
                reader.report(problem.with_hint(hint));
            }
        }
    }
    read
}

fn variation(
    entry: VariationEntry,
    places: Places,
    others: &[Variation],
) -> Result<Variation, Wrong> {
    let wrong = |field: &'static str, message: &str, hint: &'static str| {
        Err(Wrong { field, message: message.to_owned(), hint })
    };
    let spread = Spread::of(&entry)?;
    let parameters = match (entry.parameter, entry.parameters) {
        (Some(one), several) if several.is_empty() => vec![one],
        (None, several) if !several.is_empty() => several,
        (Some(_), _) => {
            return wrong("parameters", "parameter and parameters are both there", "give only one");
        }
        (None, _) => {
            return wrong("", "parameter is missing", "write parameter = \"component.field\"");
        }
    };
    let numbers = |values: &[Value]| values.iter().all(Value::is_number);
    if let (How::Scale, Spread::Values(values)) = (entry.how, &spread)
        && !numbers(values)
    {
        return wrong("values", "a factor is not a number", "how = \"scale\" multiplies");
    }
    let name = entry.name.unwrap_or_else(|| parameters[0].clone());
    if others.iter().any(|other| other.name == name) {
        return wrong(
            "name",
            "there is another variation of that name",
            "give it a name of its own",
        );
    }
    if OF_RESULTS.contains(&name.as_str()) {
        return wrong("name", "the name is one of a column of the results", "choose another one");
    }
    let like_indicator = name.contains('.') && !name.contains(char::is_whitespace);
    if like_indicator && !parameters.contains(&name) {
        let message = "the name looks like that of an indicator, component.quantity";
        return wrong("name", message, "write it without a point, or leave it out");
    }
    Ok(Variation { name, parameters, how: entry.how, spread, places })
}
