//! Messages about SI fields in the words of the file: the name, the number and the unit that were written.
//!
//! Components and deserialisation know SI only. What they say is translated here, at one place.

use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::model::{Place, WrittenField};
use anergy_core::units::split_suffix;
use serde_json::Value;

/// A ratio above this was probably meant in percent.
const LEAST_PERCENT: f64 = 2.0;

/// A longer value is not repeated in a message.
const LONGEST_VALUE: usize = 40;

/// A parameter that a component refuses: its message begins with `field = value` or `field:` in SI.
/// `what` names an entry that does not come from a file, or that an overlay has changed.
pub(crate) fn refused(what: &str, place: &Place, field: Option<&str>, message: &str) -> Diagnostic {
    let what = if changed_since(message, place) { what } else { place.entry_or(what) };
    let span = field.map_or_else(|| place.span.range(), |field| place.of(field));
    let problem = Diagnostic::new(format!("{what}: {}", as_written(message, place)), span);
    match percent_hint(message) {
        Some(hint) => problem.with_hint(hint),
        None => problem,
    }
}

/// A message with the names, numbers and units of the file.
pub(crate) fn as_written(message: &str, place: &Place) -> String {
    if changed_since(message, place) {
        return message.to_owned();
    }
    let field = |word: &str| place.fields.iter().find(|written| written.si() == word);
    // Numbers are those of the field that the message begins with.
    let subject = message.split([' ', ':']).next().and_then(field);
    let mut words: Vec<String> = Vec::new();
    let mut unit: Option<(String, String)> = None;
    for word in message.split(' ') {
        let core = word.trim_matches(|c| matches!(c, ',' | ';' | ':' | '(' | ')'));
        let mut new = None;
        if let Some(written) = field(core) {
            new = Some(written.name().to_owned());
        } else if let Some((from, to)) = unit.take() {
            new = (core.to_lowercase() == from).then_some(to);
        } else if let Some(written) = subject
            && words.last().is_none_or(|last| last != "point")
            && let Some(value) = core.parse().ok().and_then(|number| number_of(written, number))
        {
            new = Some(value);
            let suffix = |name: &str| split_suffix(name).map(|(_, suffix)| suffix.to_owned());
            unit = suffix(written.si()).zip(suffix(written.name()).map(|unit| in_words(&unit)));
        }
        words.push(new.map_or_else(|| word.to_owned(), |new| word.replacen(core, &new, 1)));
    }
    words.join(" ")
}

/// Whether `field = value` is not what the file says: an overlay has changed it.
fn changed_since(message: &str, place: &Place) -> bool {
    let mut words = message.split(' ');
    let (Some(field), Some("="), Some(value)) = (words.next(), words.next(), words.next()) else {
        return false;
    };
    let written = place.fields.iter().find(|written| written.si() == field);
    let value = value.parse::<f64>().ok();
    written.is_some_and(|written| value.is_some() && written.si_value().as_f64() != value)
}

/// The number of the file that became `si`; `None` for fields that are written in SI.
fn number_of(written: &WrittenField, si: f64) -> Option<String> {
    if written.name() == written.si() {
        return None;
    }
    let one = |value: &Value, si_value: &Value| {
        (si_value.as_f64() == Some(si)).then(|| value.to_string())
    };
    match (&written.value(), &written.si_value()) {
        (Value::Array(values), Value::Array(si_values)) => {
            values.iter().zip(si_values).find_map(|(value, si_value)| one(value, si_value))
        }
        (value, si_value) => one(value, si_value),
    }
}

/// A suffix as people write the unit.
pub(crate) fn in_words(suffix: &str) -> String {
    match suffix {
        "degc" => "degC".into(),
        "hpa" | "kpa" | "mpa" => format!("{}Pa", suffix[..1].replace('m', "M")),
        "pa" => "Pa".into(),
        "k" => "K".into(),
        "w" => "W".into(),
        "kw" => "kW".into(),
        "mw" => "MW".into(),
        _ => suffix.replace('_', "/"),
    }
}

/// `85 percent is 0.85`, where a ratio is far above one.
pub(crate) fn percent_hint(message: &str) -> Option<String> {
    let (before, requirement) = message.split_once(" must ")?;
    let ratio = ["lie between 0 and 1", "lie between 0 and speed_max", "be below 1"];
    if !ratio.contains(&requirement) {
        return None;
    }
    in_percent(before.rsplit(' ').next()?.parse().ok()?)
}

/// The hint for a number that is a ratio in percent.
pub(crate) fn in_percent(value: f64) -> Option<String> {
    (LEAST_PERCENT < value && value <= 100.0)
        .then(|| format!("write a ratio: {value} percent is {}", value / 100.0))
}

/// `name = value`, or the name alone where the value is long.
pub(crate) fn named(name: &str, value: &Value) -> String {
    let value = value.to_string();
    if value.chars().count() > LONGEST_VALUE || value == "null" {
        name.to_owned()
    } else {
        format!("{name} = {value}")
    }
}

/// What is wrong with a value of the wrong type, and a hint, from serde's words. `subject` is the field
/// with its value.
pub(crate) fn type_error(subject: &str, value: &Value, reason: &str) -> (String, Option<String>) {
    if let Some(rest) = reason.strip_prefix("unknown variant ") {
        let words: Vec<&str> = rest.split('`').skip(1).step_by(2).collect();
        if let [word, known @ ..] = words.as_slice() {
            let list = format!("possible words: {}", known.join(", "));
            let guess = did_you_mean(word, known.iter().copied());
            let hint = guess.map_or(list.clone(), |guess| format!("{guess} {list}"));
            return (format!("{subject} is not a known word"), Some(hint));
        }
    }
    let expected = reason.rsplit_once("expected ").map(|(_, expected)| expected);
    let Some(expected) = expected.filter(|_| reason.starts_with("invalid ")) else {
        // Our own sentences: what is wrong; what to write.
        return match reason.split_once("; ") {
            Some((wrong, hint)) => (sentence(subject, value, wrong), Some(hint.to_owned())),
            None => (sentence(subject, value, reason), None),
        };
    };
    let expected = match expected {
        "f64" | "f32" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number from 0",
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number",
        "a boolean" => "true or false",
        "a sequence" => "an array",
        "a map" => "a table",
        "a character" => "a single character",
        "string or map" => "one word",
        pair if pair.starts_with("a tuple of size 2") || pair.starts_with("fewer elements") => {
            "a pair of numbers"
        }
        other => other,
    };
    let message = match (value, expected) {
        (Value::String(_), "a single character") => format!("{subject} must be {expected}"),
        (Value::Array(items), "a pair of numbers") => {
            format!("{subject} must be {expected}, not {} values", items.len())
        }
        _ => format!("{subject} must be {expected}, not {}", type_name(value)),
    };
    let hint = match (value, expected) {
        (Value::String(_), "a number") => {
            Some("write a number without quotes and unit; the unit is the end of the field's name")
        }
        (_, "a pair of numbers") => Some("write pairs such as [[0, 1.0], [60, 0.5]]"),
        _ => None,
    };
    (message, hint.map(str::to_owned))
}

/// A sentence about a field; a value that it repeats is said once.
fn sentence(subject: &str, value: &Value, wrong: &str) -> String {
    let repeated = format!(" = {value}");
    let repeats = wrong.starts_with(&value.to_string());
    let subject = subject.strip_suffix(&repeated).filter(|_| repeats).unwrap_or(subject);
    format!("{subject}: {wrong}")
}

fn type_name(value: &Value) -> &'static str {
    match value {
        Value::Null => "nothing",
        Value::Bool(_) => "a boolean",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "a table",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grammar::Grammar;
    use anergy_network::elements::ElementParams;
    use serde_json::json;

    fn place(kind: &str, name: &str, value: Value) -> Place {
        let grammar = Grammar::of_kind::<ElementParams>(kind).unwrap();
        let field = WrittenField::new(grammar.spelling(name).unwrap(), value, (7..9).into());
        Place { entry: "".into(), span: (0..20).into(), fields: [field].into() }
    }

    #[test]
    fn numbers_are_those_of_the_file() {
        let place = place("pipe", "inner_diameter_mm", json!(-22));
        let said = refused(
            "pipe",
            &place,
            Some("inner_diameter_m"),
            "inner_diameter_m = -0.022 must be positive",
        );
        assert_eq!(said.message, "pipe: inner_diameter_mm = -22 must be positive");
        assert_eq!(said.span, Some(7..9));
        // An overlay has changed it: SI is all there is.
        let changed = "inner_diameter_m = -0.5 must be positive";
        assert_eq!(as_written(changed, &place), changed);
        let composite = Place { entry: "trench \"a-b\"".into(), ..place };
        let said = refused("edge \"a-b.hot\"", &composite, Some("inner_diameter_m"), changed);
        assert!(said.message.starts_with("edge \"a-b.hot\": inner_diameter_m = -0.5"));
    }

    #[test]
    fn tables_keep_their_points() {
        let place = place("pump", "curve_head_bar", json!([2, 0.42]));
        let said =
            "curve_head_pa: the head must fall: point 2 has 42000 Pa, the point before 200000 Pa";
        assert_eq!(
            as_written(said, &place),
            "curve_head_bar: the head must fall: point 2 has 0.42 bar, the point before 2 bar"
        );
    }

    #[test]
    fn percent() {
        let hint = percent_hint("efficiency_motor = 85 must lie between 0 and 1");
        assert_eq!(hint.unwrap(), "write a ratio: 85 percent is 0.85");
        assert_eq!(percent_hint("efficiency_motor = 1.2 must lie between 0 and 1"), None);
        assert_eq!(percent_hint("zeta = -85 must not be negative"), None);
    }

    #[test]
    fn no_jargon() {
        let said = |value, reason: &str| type_error(&named("x_m", &value), &value, reason).0;
        let number = "invalid type: sequence, expected f64";
        assert_eq!(said(json!([1, 2]), number), "x_m = [1,2] must be a number, not an array");
        let number = "invalid type: map, expected f64";
        assert_eq!(said(json!({"a": 1}), number), "x_m = {\"a\":1} must be a number, not a table");
        let number = "invalid type: boolean `true`, expected f64";
        assert_eq!(said(json!(true), number), "x_m = true must be a number, not a boolean");
        let text = "invalid type: integer `5`, expected a string";
        assert_eq!(said(json!(5), text), "x_m = 5 must be a string, not a number");
        let (message, hint) = type_error(
            "friction = \"colebrok\"",
            &json!("colebrok"),
            "unknown variant `colebrok`, expected one of `haaland`, `colebrook`",
        );
        assert_eq!(message, "friction = \"colebrok\" is not a known word");
        assert_eq!(hint.unwrap(), "did you mean `colebrook`? possible words: haaland, colebrook");
    }
}
