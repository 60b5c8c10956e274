//! Rules: what they show to each other, and whether their conditions compare like with like.

use super::Builder;
use crate::channels;
use crate::model::ControllerSpec;
use crate::plan::Plan;
use crate::wording::refused;
use anergy_control::condition::Comparison;
use anergy_control::controllers::rule::Rule;

impl Builder<'_> {
    /// Adds the channels of controllers, so that controllers can measure each other.
    pub(super) fn show_controllers(&mut self, plan: &mut Plan) {
        let mut first = 0;
        for spec in &self.model.controllers {
            // One that cannot be built is reported with the controllers, and stops the model.
            let Ok(controller) = spec.params.build(&()) else { continue };
            channels::add_controller(plan, &spec.id, controller.channels(), first);
            first += controller.initial_state().len();
        }
    }

    /// Comparisons are of one unit.
    pub(super) fn check_conditions(
        &mut self,
        plan: &Plan,
        spec: &ControllerSpec,
        rule: &Rule,
        measured: &[usize],
    ) {
        for (field, condition) in rule.conditions() {
            for comparison in condition.comparisons() {
                let Err((message, hint)) = comparable(plan, comparison, measured) else { continue };
                let what = format!("controller \"{}\"", spec.id);
                let problem =
                    refused(&what, &spec.place, Some(field), &format!("{field}: {message}"));
                self.problems.push(problem.with_hint(hint));
                return;
            }
        }
    }
}

/// The unit of a channel for a suffix of a number.
fn written(suffix: &str) -> String {
    let si = [
        ("k", "K"),
        ("w", "W"),
        ("j", "J"),
        ("pa", "Pa"),
        ("kg_s", "kg s-1"),
        ("m3_s", "m3 s-1"),
        ("w_m2", "W m-2"),
        ("m_s", "m s-1"),
        ("", "1"),
    ];
    let known = si.iter().find(|(known, _)| *known == suffix);
    known.map_or(suffix.to_owned(), |(_, unit)| (*unit).to_owned())
}

/// Whether all parts of a comparison have one unit, and temperatures are compared with temperatures.
fn comparable(
    plan: &Plan,
    comparison: &Comparison,
    measured: &[usize],
) -> Result<(), (String, String)> {
    let channel = |i: usize| &plan.channels[measured[i]];
    let kind = |unit: &str| unit.trim_start_matches("delta ").to_owned();
    let Some(first) = comparison.channels().first().map(|(i, _)| channel(*i)) else {
        return Ok(());
    };
    let mut absolute = 0.0;
    for (i, sign) in comparison.channels() {
        let other = channel(*i);
        if kind(&other.unit) != kind(&first.unit) {
            return Err((
                format!(
                    "\"{}\" in {} is compared with \"{}\" in {}",
                    first.name, first.unit, other.name, other.unit
                ),
                "compare quantities of one unit".into(),
            ));
        }
        absolute += sign * f64::from(u8::from(other.unit == "K"));
    }
    for (constant, sign) in comparison.constants() {
        let unit = written(constant.unit);
        // Nothing is nothing in every unit; for temperatures that is told below.
        if !constant.is_nothing() && unit != kind(&first.unit) {
            let said = if unit == "1" { "no unit".to_owned() } else { format!("the unit {unit}") };
            return Err((
                format!("\"{}\" in {} is compared with a number of {said}", first.name, first.unit),
                if kind(&first.unit) == "K" {
                    "write the unit behind the number: 65 degC, or 3 K for a difference".into()
                } else {
                    format!(
                        "write the unit behind the number: that of the channel is {}",
                        first.unit
                    )
                },
            ));
        }
        absolute += sign * f64::from(u8::from(constant.from_zero_celsius));
    }
    // A temperature less a temperature is a difference, which counts from nothing.
    if absolute != 0.0 {
        return Err((
            format!("the temperature \"{}\" is compared with a difference", first.name),
            "temperatures are written in degC (65 degC), differences in K (a - b > 3 K)".into(),
        ));
    }
    Ok(())
}
