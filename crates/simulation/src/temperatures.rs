//! Temperatures that make sense: of water, and of what surrounds it.

use crate::diagnostic::Diagnostic;
use crate::model::Place;
use crate::wording::refused;
use anergy_core::medium::ZERO_CELSIUS_K;
use serde_json::Value;

/// A range of temperatures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Temperatures {
    /// Lowest, degC.
    low_degc: f64,
    /// Highest, degC.
    high_degc: f64,
    /// What lies in it.
    what: &'static str,
}

/// Liquid water under the atmosphere, the validity of the medium: a run refuses to leave it.
pub(crate) const WATER: Temperatures =
    Temperatures { low_degc: 0.0, high_degc: 100.0, what: "liquid water" };

/// Ground, air and whatever else a pipe lies in.
pub(crate) const SURROUNDINGS: Temperatures =
    Temperatures { low_degc: -60.0, high_degc: 200.0, what: "the surroundings" };

impl Temperatures {
    /// Smallest and largest value, K.
    pub(crate) fn range_k(&self) -> (f64, f64) {
        (self.low_degc + ZERO_CELSIUS_K, self.high_degc + ZERO_CELSIUS_K)
    }

    /// The problem of a temperature outside the range. `what` names an entry that is in no file.
    pub(crate) fn problem(
        &self,
        what: &str,
        field: &str,
        t_k: f64,
        place: &Place,
    ) -> Option<Diagnostic> {
        let (min_k, max_k) = self.range_k();
        if (min_k..=max_k).contains(&t_k) {
            return None;
        }
        let Self { low_degc, high_degc, what: meaning } = self;
        let message = format!(
            "{field} = {t_k} is no temperature of {meaning} ({low_degc} to {high_degc} degC)"
        );
        let problem = refused(what, place, Some(field), &message);
        let written = place.fields.iter().find(|written| written.si == field);
        let hint = written.and_then(|written| {
            let value = written.value.as_f64()?;
            let stem = field.trim_end_matches("_k");
            let celsius = written.name.ends_with("_degc");
            let other_k = if celsius { value } else { value + ZERO_CELSIUS_K };
            let (other, unit) = if celsius { ("k", "degC") } else { ("degc", "K") };
            (written.si_value == Value::from(t_k) && (min_k..=max_k).contains(&other_k)).then(
                || format!("{value} was read in {unit}; did you mean {stem}_{other} = {value}?"),
            )
        });
        Some(match hint {
            Some(hint) => problem.with_hint(hint),
            None => problem,
        })
    }
}
