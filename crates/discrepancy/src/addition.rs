//! The effects as entries of the model file: appended at its end, so that every other byte stays; and taken out again.

use crate::error::ExplainError;
use crate::explain::Finding;
use std::fmt::Write;

/// The line before an entry that was added.
const MARK: &str = "# added by anergy explain";

/// The model file with the effects appended; those of sensors belong to the sensor file and are left out.
pub fn added(text: &str, effects: &[Finding], because: &str) -> String {
    appended(text, effects.iter().filter(|effect| !effect.of_sensor()), because)
}

/// The sensor file with the effects of sensors appended.
pub fn added_to_sensors(text: &str, effects: &[Finding], because: &str) -> String {
    appended(text, effects.iter().filter(|effect| effect.of_sensor()), because)
}

fn appended<'a>(text: &str, effects: impl Iterator<Item = &'a Finding>, because: &str) -> String {
    let mut text = text.to_owned();
    for effect in effects {
        let (id, component) = (effect.id, toml_string(&effect.component));
        let (field, because) = (effect.parameter, toml_string(because));
        let number = |x: f64| {
            let rounded = format!("{x:.4e}").parse::<f64>().unwrap_or(x);
            if rounded == rounded.trunc() && rounded.abs() < 1e15 {
                format!("{rounded:.1}")
            } else {
                rounded.to_string()
            }
        };
        let e = effect.estimate;
        let (value, lo, hi) = (number(e.value), number(e.lo), number(e.hi));
        let beside: String =
            effect.beside.iter().map(|(field, x)| format!("{field} = {}\n", number(*x))).collect();
        let _ = write!(
            text,
            "\n{MARK}\n[[effect]]\nid = \"{id}\"\ncomponent = {component}\n{field} = {value}\n{beside}ci95 = [{lo}, {hi}]\nbecause = {because}\n"
        );
    }
    text
}

/// The model file without an effect that was added: byte for byte what it was before.
///
/// # Errors
/// No such effect was added.
pub fn reverted(text: &str, id: &str) -> Result<String, ExplainError> {
    let mark = format!("\n{MARK}\n");
    let wanted = format!("[[effect]]\nid = \"{id}\"\n");
    let mut from = 0;
    while let Some(at) = text[from..].find(&mark).map(|at| from + at) {
        let body = at + mark.len();
        if text[body..].starts_with(&wanted) {
            let end = text[body..].find(&mark).map_or(text.len(), |next| body + next);
            return Ok(format!("{}{}", &text[..at], &text[end..]));
        }
        from = body;
    }
    Err(ExplainError::NoEffect { id: id.to_owned() })
}

/// A string as TOML writes it.
fn toml_string(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unknown::Estimate;

    fn finding(id: &'static str, component: &str) -> Finding {
        Finding {
            id,
            component: component.into(),
            words: "",
            parameter: "factor",
            unit: "1",
            estimate: Estimate { value: 1.234_567, lo: 1.0, hi: 1.5 },
            profile: None,
            beside: vec![("lag_s", 3.0)],
            probability: 1.0,
            evidence: 9.0,
            elpd: 9.0,
            elpd_error: 1.0,
            flags: Vec::new(),
            strain: 0.0,
            beyond: 0.0,
            takes_along: 0.0,
            tolerated: false,
            within: false,
            is_open: false,
            validation_z: 1.0,
            reduction: 0.9,
            separates: "",
        }
    }

    #[test]
    fn an_effect_of_a_sensor_goes_to_the_sensor_file() {
        let plain =
            "[[sensor]]\ncolumn = \"T\"\nsignal = \"b.t_k\"\nunit = \"degC\"\nrole = \"compare\"\n";
        let slow = Finding { parameter: "lag_s", beside: Vec::new(), ..finding("S4", "T") };
        assert_eq!(added(plain, std::slice::from_ref(&slow), ""), plain);
        let text = added_to_sensors(plain, &[slow], "why");
        let file = crate::sensors::SensorFile::from_toml(&text).unwrap();
        assert_eq!((file.effect[0].id.as_str(), file.effect[0].lag_s), ("S4", Some(1.2346)));
        assert_eq!(reverted(&text, "S4").unwrap(), plain);
        // A sensor that is not there.
        assert!(
            crate::sensors::SensorFile::from_toml(
                &text.replace("component = \"T\"", "component = \"X\"")
            )
            .is_err()
        );
    }

    #[test]
    fn added_and_taken_out_byte_for_byte() {
        for text in ["format = 1\n", "format = 1", "# \u{e9}\r\n\r\n"] {
            let both = added(text, &[finding("P2", "a\"b"), finding("P10", "c")], "it \"is\"");
            assert!(
                both.starts_with(text) && both.contains("factor = 1.2346\nlag_s = 3.0\n"),
                "{both}"
            );
            let one = reverted(&both, "P2").unwrap();
            assert!(!one.contains("P2") && one.contains("P10"));
            assert_eq!(reverted(&one, "P10").unwrap(), text);
            assert!(reverted(text, "P2").is_err());
        }
    }
}
