//! Temperatures that make sense: of water, and of what surrounds it.

use crate::diagnostic::Diagnostic;
use crate::model::Place;
use crate::wording::refused;
use anergy_core::medium::{Medium, ZERO_CELSIUS_K};
use anergy_core::units::is_difference;

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

/// Ground, air and whatever else a pipe lies in.
pub(crate) const SURROUNDINGS: Temperatures =
    Temperatures { low_degc: -60.0, high_degc: 200.0, what: "the surroundings" };

impl Temperatures {
    /// Where the medium of a model is liquid, its validity: a run refuses to leave it.
    pub(crate) fn of_liquid(medium: &Medium) -> Self {
        let (low_degc, high_degc) = medium.range_degc();
        Self { low_degc, high_degc, what: medium.name() }
    }

    /// Smallest and largest value, K.
    pub(crate) fn range_k(&self) -> (f64, f64) {
        // To hundredths, so that the limits are the numbers that people write.
        let k = |degc: f64| ((degc + ZERO_CELSIUS_K) * 100.0).round() / 100.0;
        (k(self.low_degc), k(self.high_degc))
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
        Some(match self.unit_hint(field, place) {
            Some(hint) => problem.with_hint(hint),
            None => problem,
        })
    }
}

impl Temperatures {
    /// The other unit, where a field lies outside the range as it is written and inside with that one.
    pub(crate) fn unit_hint(&self, field: &str, place: &Place) -> Option<String> {
        let (min_k, max_k) = self.range_k();
        let inside = |t_k: f64| (min_k..=max_k).contains(&t_k);
        let written = place.fields.iter().find(|written| written.si() == field)?;
        let value = written.value().as_f64()?;
        let stem = field.strip_suffix("_k").filter(|stem| !is_difference(stem))?;
        let celsius = written.name().ends_with("_degc");
        let (unit, other, other_k) =
            if celsius { ("degC", "k", value) } else { ("K", "degc", value + ZERO_CELSIUS_K) };
        let meant = written.si_value().as_f64().is_some_and(|t_k| !inside(t_k)) && inside(other_k);
        meant.then(|| format!("{value} was read in {unit}; did you mean {stem}_{other} = {value}?"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Span;
    use crate::grammar::Grammar;
    use crate::model::WrittenField;
    use anergy_network::elements::ElementParams;
    use serde_json::json;

    #[test]
    fn the_other_unit_is_suggested_where_it_fits() {
        let said = |name: &str, value: f64, si_value: f64| {
            let grammar = Grammar::of_kind::<ElementParams>("pipe").unwrap();
            let spelling = grammar.spelling(name).unwrap();
            let field = WrittenField::new(spelling, json!(value), Span::NONE);
            let place = Place { fields: [field].into(), ..Place::default() };
            SURROUNDINGS.problem("pipe", "surroundings_k", si_value, &place)
        };
        let kelvin = said("surroundings_k", 20.0, 20.0).unwrap();
        assert!(kelvin.hint.unwrap().contains("surroundings_degc = 20"));
        let celsius = said("surroundings_degc", 293.0, 566.15).unwrap();
        assert!(celsius.message.contains("surroundings_degc = 293"));
        assert!(celsius.hint.unwrap().contains("surroundings_k = 293"));
        assert_eq!(said("surroundings_k", 2000.0, 2000.0).unwrap().hint, None);
        assert_eq!(said("surroundings_degc", -60.0, 213.15), None);
    }
}
