//! Which parameters of a model the variations mean, and what becomes of their values.

use crate::definition::{Definition, Design, How, Variation};
use crate::spread::Spread;
use anergy_core::units::{Unit, is_difference, split_suffix};
use anergy_recording::selection::glob;
use anergy_simulation::diagnostic::Diagnostic;
use anergy_simulation::fields::converted;
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use serde_json::Value;
use std::collections::HashMap;

/// From here on not every whole number is a number of 64 bits with a point.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// A parameter of the model, and the unit of the values it is given in.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Target {
    /// `component.field` in SI.
    pub parameter: String,
    unit: Option<Unit>,
    /// Whether it is a whole number.
    whole: bool,
}

impl Target {
    /// What a value of a variation makes of it.
    pub(crate) fn change(&self, how: How, value: &Value) -> Change {
        let parameter = self.parameter.clone();
        if how == How::Scale {
            return Change::Scale { parameter, factor: value.as_f64().unwrap_or(f64::NAN) };
        }
        let si = self.unit.and_then(|unit| converted(value, unit));
        let value = si.unwrap_or_else(|| value.clone());
        let number = if self.whole { value.as_f64().and_then(whole) } else { None };
        Change::Set { parameter, value: number.map_or(value, Value::from) }
    }
}

/// A number without a fraction as an integer.
fn whole(number: f64) -> Option<i64> {
    let exact = number.fract() == 0.0 && number.abs() < LARGEST_WHOLE;
    exact.then_some(number as i64)
}

/// The targets of all variations, and what is wrong with them.
pub(crate) fn find(definition: &Definition, model: &Model) -> (Vec<Vec<Target>>, Vec<Diagnostic>) {
    let parameters = model.parameters();
    let known: HashMap<&str, &Value> =
        parameters.iter().map(|(name, value)| (name.as_str(), value)).collect();
    let (mut found, mut problems) = (Vec::new(), Vec::new());
    let mut taken: HashMap<String, &str> = HashMap::new();
    for variation in &definition.variations {
        let targets = targets(variation, &parameters, &known, model).and_then(|targets| {
            check_taken(variation, &targets, &mut taken)?;
            check_values(variation, definition.ensemble.design, &targets)?;
            Ok(targets)
        });
        match targets {
            Ok(targets) => found.push(targets),
            Err(problem) => problems.push(problem),
        }
    }
    (found, problems)
}

/// A parameter has one value: two variations of it would overwrite each other.
fn check_taken<'a>(
    variation: &'a Variation,
    targets: &[Target],
    taken: &mut HashMap<String, &'a str>,
) -> Result<(), Diagnostic> {
    let name = &variation.name;
    for Target { parameter, .. } in targets {
        let Some(other) = taken.insert(parameter.clone(), name) else { continue };
        let message = match other == name {
            true => format!("variation \"{name}\" means \"{parameter}\" twice"),
            false => format!(
                "variation \"{name}\" means \"{parameter}\", which \"{other}\" varies already"
            ),
        };
        let place = variation.places.of_field(&["parameter", "parameters"]);
        let hint =
            "name every parameter once: list them instead of a pattern, or join the variations";
        return Err(Diagnostic::new(message, place).with_hint(hint));
    }
    Ok(())
}

/// Whether the parameters take values of this kind.
fn check_values(
    variation: &Variation,
    design: Design,
    targets: &[Target],
) -> Result<(), Diagnostic> {
    let sampled = !matches!(design, Design::Grid | Design::List);
    for target in targets {
        let refuse = |message: String, hint: &str| {
            let place = variation.places.of_field(&["values", "how", "low", "mean"]);
            let message = format!("variation \"{}\": {message}", variation.name);
            Err(Diagnostic::new(message, place).with_hint(hint))
        };
        let parameter = &target.parameter;
        if target.whole && variation.how == How::Scale {
            let message = format!("\"{parameter}\" is a whole number, which cannot be scaled");
            return refuse(message, "set values");
        }
        if target.whole && sampled && !matches!(variation.spread, Spread::Values(_)) {
            let message = format!("\"{parameter}\" is a whole number, a distribution gives others");
            return refuse(message, "list values: samples choose among them");
        }
        let values: Box<dyn Iterator<Item = Value>> = match &variation.spread {
            Spread::Values(values) => Box::new(values.iter().cloned()),
            spread if target.whole => {
                Box::new((0..spread.count().unwrap_or(0)).map(|n| spread.nth(n)))
            }
            spread => Box::new(spread.ends().into_iter().map(Value::from)),
        };
        for value in values {
            let Some(si) =
                target.unit.map_or_else(|| Some(value.clone()), |u| converted(&value, u))
            else {
                let message = format!("{value} is infinite in the unit of the model");
                return refuse(message, "give smaller numbers");
            };
            if target.whole && si.as_f64().is_some_and(|number| whole(number).is_none()) {
                let message = format!("\"{parameter}\" is a whole number, {value} is none");
                return refuse(message, "list whole values, or choose count so that all are whole");
            }
        }
    }
    Ok(())
}

/// The parameters that a variation means.
fn targets(
    variation: &Variation,
    parameters: &[(String, Value)],
    known: &HashMap<&str, &Value>,
    model: &Model,
) -> Result<Vec<Target>, Diagnostic> {
    let place = variation.places.of_field(&["parameter", "parameters"]);
    let problem = |message: String, hint: String| {
        let message = format!("variation \"{}\": {message}", variation.name);
        Diagnostic::new(message, place.clone()).with_hint(hint)
    };
    let mut found: Vec<Target> = Vec::new();
    for written in &variation.parameters {
        let before = found.len();
        let (pattern, unit) = in_si(written);
        for (form, unit) in [(written.as_str(), None), (pattern.as_str(), unit)] {
            if found.len() > before {
                break;
            }
            let matching: Vec<&str> = match form.contains(['*', '?']) {
                false => known.get_key_value(form).into_iter().map(|(name, _)| *name).collect(),
                // A pattern means the numbers.
                true => parameters
                    .iter()
                    .filter(|(name, value)| value.is_number() && glob(form, name))
                    .map(|(name, _)| name.as_str())
                    .collect(),
            };
            found.extend(matching.iter().map(|name| Target {
                parameter: (*name).to_owned(),
                unit,
                whole: known.get(name).is_some_and(|value| value.is_i64() || value.is_u64()),
            }));
        }
        if found.len() == before {
            return Err(problem(
                format!("there is no parameter \"{written}\""),
                nearest(written, known),
            ));
        }
        if variation.how == How::Scale && unit.is_some_and(|unit| unit.suffix == "degc") {
            let hint = "scale it in K, or set values".to_owned();
            return Err(problem(format!("\"{written}\" in degC cannot be scaled"), hint));
        }
    }
    for target in &found {
        if model.drivers.iter().any(|driver| driver.signal == target.parameter) {
            let message = format!(
                "\"{}\" follows a schedule or a series: its own value is never used",
                target.parameter
            );
            return Err(problem(
                message,
                "take the schedule out of the model, or vary something else".into(),
            ));
        }
    }
    Ok(found)
}

/// A name in the SI unit of its field, and the unit it was written in.
fn in_si(written: &str) -> (String, Option<Unit>) {
    let (component, field) = written.rsplit_once('.').unwrap_or(("", written));
    let other = split_suffix(field).and_then(|(stem, suffix)| {
        let unit =
            Unit::find(suffix).filter(|unit| unit.suffix != "degc" || !is_difference(stem))?;
        Some((stem, unit))
    });
    match other {
        Some((stem, unit)) => {
            let field =
                if unit.si.is_empty() { stem.to_owned() } else { format!("{stem}_{}", unit.si) };
            (format!("{component}.{field}"), Some(unit))
        }
        None => (written.to_owned(), None),
    }
}

/// A hint for a parameter that does not exist.
fn nearest(written: &str, known: &HashMap<&str, &Value>) -> String {
    let best = known
        .keys()
        .map(|name| (strsim::damerau_levenshtein(written, name), *name))
        .filter(|(distance, name)| *distance <= 1 + name.len() / 4)
        .min();
    if let Some((_, name)) = best {
        return format!("did you mean `{name}`?");
    }
    let component = written.rsplit_once('.').map_or(written, |(component, _)| component);
    let mut fields: Vec<&str> = known
        .keys()
        .filter_map(|name| name.strip_prefix(component)?.strip_prefix('.'))
        .filter(|field| !field.contains('.'))
        .collect();
    fields.sort_unstable();
    if fields.is_empty() {
        return "names are those of `anergy check --expand`: component.field".into();
    }
    format!("\"{component}\" has {}", fields.join(", "))
}
