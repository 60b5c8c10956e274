//! What was found, for people and for programs: `report.json`, `report.md`, `report.html`.

mod html;
mod map;

pub use html::html;

use crate::explain::{Explanation, Finding, NotTried, Verdict};
use crate::find::Found;
use crate::gap::Gap;
use crate::next::{AGAIN, Addition};
use crate::search::TOGETHER;
use crate::significance::State;
use crate::split::Use;
use serde_json::{Map, Value, json};
use std::fmt::Write;

impl Verdict {
    /// The word of `report.json`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Named => "named",
            Self::Class => "class",
            Self::Unexplained => "unexplained",
            Self::Nothing => "nothing",
            Self::DataProblem => "data_problem",
        }
    }

    /// The conclusion as a sentence.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::Named => "The missing effect has a name.",
            Self::Class => "Several effects explain the data, which cannot tell them apart.",
            Self::Unexplained => "There is a discrepancy that no effect of the catalogue explains.",
            Self::Nothing => "Simulation and measurement agree within the accuracy of the sensors.",
            Self::DataProblem => "The data contradict themselves; nothing was fitted to them.",
        }
    }
}

/// `report.json`.
pub fn json(explanation: &Explanation) -> Value {
    let effect = |f: &Finding| {
        let e = f.estimate;
        json!({
            "id": f.id, "component": f.component, "what": f.words, "probability": f.probability,
            "evidence": f.evidence, "elpd": f.elpd, "elpd_error": f.elpd_error, "strain": f.strain,
            "validation_z": f.validation_z, "reduction": f.reduction, "profile": f.profile, "flags": f.flags, "separates": f.separates,
            "params": { f.parameter: { "value": e.value, "lo": e.lo, "hi": e.hi, "unit": f.unit } },
        })
    };
    let shown = |value: &dyn Fn(&Gap) -> f64| -> Map<String, Value> {
        let shown =
            explanation.gaps.iter().filter(|gap| gap.part == Use::Show && gap.regime == "all");
        shown.map(|gap| (gap.column.clone(), Value::from(value(gap)))).collect()
    };
    json!({
        "verdict": explanation.verdict.word(),
        "because": explanation.because,
        "problems": explanation.problems,
        "effects": explanation.effects.iter().map(effect).collect::<Vec<_>>(),
        "class": explanation.class.iter().map(|f| json!([f.id, f.component])).collect::<Vec<_>>(),
        "next_measurements": explanation.additions,
        "tried": explanation.tried.iter().map(effect).collect::<Vec<_>>(),
        "not_tried": explanation.not_tried,
        "found": explanation.found,
        "unknowns": explanation.strained.iter().map(|(name, value, far)| {
            json!({ "name": name, "value": value, "standard_deviations": far })
        }).collect::<Vec<_>>(),
        "times_s": explanation.times.iter().map(|(part, s)| ((*part).to_owned(), Value::from(*s))).collect::<Map<_, _>>(),
        "show_rmse_before": shown(&|gap| gap.rmse_before),
        "show_rmse_after": shown(&|gap| gap.rmse_after),
        "show_z_fitted": shown(&|gap| gap.z_fitted),
        "gaps": explanation.gaps,
    })
}

/// Sensors, regimes and parts.
fn where_and_when(out: &mut String, found: &Found) {
    out.push_str("\n## Where and when\n\nSensors, with the tolerances fitted:\n\n| sensor | says | residual, sigma (95 %) | mean | smallest mean that would be seen |\n|---|---|---|---|---|\n");
    for s in &found.sensors {
        let says = match s.state {
            State::Differs => "differs",
            State::Agrees => "agrees",
            State::CannotTell => "cannot tell",
        };
        let _ = writeln!(
            out,
            "| {} | {says} | {:.2} ({:.2} to {:.2}) | {:.3} {unit} | {:.3} {unit} |",
            s.column,
            s.z,
            s.z_lo,
            s.z_hi,
            s.mean,
            s.detectable,
            unit = s.unit
        );
    }
    let loud: Vec<_> = found.regimes.iter().filter(|r| r.significant).take(12).collect();
    if !loud.is_empty() {
        out.push_str("\nRegimes in which the model as it is differs by more than chance:\n\n| sensor | regime | samples | residual, sigma | share of all squares | over the share of samples |\n|---|---|---|---|---|---|\n");
        for r in loud {
            let _ = writeln!(
                out,
                "| {} | {} | {} | {:.1} | {:.0} % | {:.1} |",
                r.column,
                r.regime,
                r.samples,
                r.z,
                100.0 * r.share,
                r.concentration
            );
        }
    }
    if found.parts.is_empty() {
        return;
    }
    out.push_str("\nParts driven by their own measured boundaries: high when cut out, the cause lies inside; high only in the whole, it lies elsewhere.\n\n| part | sensors | cut out, sigma | in the whole, sigma | probability | heat missing at its outlet | goes with |\n|---|---|---|---|---|---|---|\n");
    for part in &found.parts {
        let flux = part.flux.as_ref();
        let missing = flux.map_or_else(String::new, |f| format!("{:.0} W", f.mean_w));
        let clue = flux.and_then(|f| f.clues.first());
        let clue = clue.map_or_else(String::new, |(what, r)| format!("{what} ({r:.2})"));
        let _ = writeln!(
            out,
            "| {} | {} | {:.2} | {:.2} | {:.2} | {missing} | {clue} |",
            part.components.join(", "),
            part.sensors.join(", "),
            part.isolated_z,
            part.whole_z,
            part.probability
        );
    }
}

/// What is expected of additions to the measurement, of which this is the most telling one.
pub(crate) fn expected(best: &Addition) -> String {
    let none = if best.nats < TOGETHER { ", which is expected of none of these" } else { "" };
    format!(
        "Simulated with every member at its fitted values: evidence by which the first one is expected to be told from the others if it is true, or they from it if they are, nats. From {TOGETHER:.0} on they are told apart{none}."
    )
}
/// Additions that are shown.
const SHOWN: usize = 8;

/// The most telling additions to the measurement, and the first run once more.
fn shown_additions(explanation: &Explanation) -> impl Iterator<Item = &Addition> {
    let all = explanation.additions.iter().enumerate();
    all.filter(|(k, a)| *k < SHOWN || a.what == AGAIN).map(|(_, a)| a)
}

fn next_measurements(out: &mut String, explanation: &Explanation) {
    let Some(first) = explanation.additions.first() else { return };
    let expected = expected(first);
    let _ = write!(out, "\n### The next measurement\n\n{expected}\n\n| measurement | nats |");
    let rivals = &first.from;
    for (name, _) in rivals {
        let _ = write!(out, " from {name} |");
    }
    let _ = writeln!(out, "\n|---|---|{}", "---|".repeat(rivals.len()));
    for addition in shown_additions(explanation) {
        let _ = write!(out, "| {} | {:.1} |", addition.what, addition.nats);
        for (_, nats) in &addition.from {
            let _ = write!(out, " {nats:.1} |");
        }
        out.push('\n');
    }
}

/// What could not be tried, a sentence each.
fn not_tried(explanation: &Explanation) -> impl Iterator<Item = String> {
    explanation.not_tried.iter().map(|NotTried { id, component, because }| {
        format!("{id} at {component} could not be tried, the model does not run with it: {because}")
    })
}

/// How long it took.
fn times(explanation: &Explanation) -> String {
    let each = explanation.times.iter().map(|(part, s)| format!("{part} {s:.1} s"));
    each.collect::<Vec<_>>().join(", ")
}

/// `report.md`.
pub fn markdown(title: &str, explanation: &Explanation) -> String {
    let mut out = format!(
        "# {title}\n\n**{}** {}.\n",
        explanation.verdict.sentence(),
        upper(&explanation.because)
    );
    for problem in &explanation.problems {
        let _ = write!(out, "\n- {problem}");
    }
    if !explanation.problems.is_empty() {
        out.push('\n');
    }
    let table = |out: &mut String, title: &str, findings: &[Finding]| {
        if findings.is_empty() {
            return;
        }
        let _ = write!(
            out,
            "\n## {title}\n\n| effect | where | what | value (95 %) | probability | nats more than without | sigma from plausible | residual, sigma |\n|---|---|---|---|---|---|---|---|\n"
        );
        for f in findings {
            let _ = writeln!(
                out,
                "| {} | {} | {} | {} | {:.2} | {:.1} | {:.1} | {:.2} |",
                f.id,
                f.component,
                f.words,
                value(f),
                f.probability,
                f.evidence,
                f.strain,
                f.validation_z
            );
        }
    };
    table(&mut out, "Added", &explanation.effects);
    if explanation.class.len() > 1 {
        table(&mut out, "Not told apart by these data, most plausible first", &explanation.class);
        out.push_str("\nWhat would tell them apart:\n\n");
        for f in &explanation.class {
            let _ = writeln!(out, "- {} ({}): {}", f.id, f.words, f.separates);
        }
        next_measurements(&mut out, explanation);
    }
    for f in explanation.effects.iter().filter(|f| !f.flags.is_empty()) {
        let _ = writeln!(out, "\n{} at {}: {}.", f.id, f.component, f.flags.join("; "));
    }
    table(&mut out, "Tried, best first", &explanation.tried);
    for sentence in not_tried(explanation) {
        let _ = writeln!(out, "\n{sentence}");
    }
    if let Some(found) = &explanation.found {
        where_and_when(&mut out, found);
    }
    if !explanation.gaps.is_empty() {
        out.push_str("\n## The gap before and after\n\nRoot mean square of simulation less measurement, with the effects and every tolerance at its middle. The samples of `show` were neither fitted nor used to choose.\n\n| sensor | samples | regime | number | before | after | before, sigma | after, sigma |\n|---|---|---|---|---|---|---|---|\n");
        for gap in &explanation.gaps {
            let part = part(gap.part);
            let _ = writeln!(
                out,
                "| {} | {part} | {} | {} | {:.3} {unit} | {:.3} {unit} | {:.1} | {:.1} |",
                gap.column,
                gap.regime,
                gap.samples,
                gap.rmse_before,
                gap.rmse_after,
                gap.z_before,
                gap.z_after,
                unit = gap.unit
            );
        }
    }
    if !explanation.times.is_empty() {
        let _ = write!(out, "\nTime: {}.\n", times(explanation));
    }
    out
}

fn part(part: Use) -> &'static str {
    match part {
        Use::Identify => "identify",
        Use::Validate => "validate",
        Use::Show => "show",
    }
}

/// Value with interval and unit.
pub fn value(f: &Finding) -> String {
    let e = f.estimate;
    let unit = if f.unit == "1" { String::new() } else { format!(" {}", f.unit) };
    format!("{} ({} to {}){unit}", digits(e.value), digits(e.lo), digits(e.hi))
}

/// Four significant digits.
fn digits(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let places = (3 - x.abs().log10().floor() as i32).clamp(0, 9) as usize;
    format!("{x:.places$}")
}

/// With a capital letter.
pub fn upper(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!(digits(2689.66), "2690");
        assert_eq!(digits(0.012_345), "0.01235");
    }

    #[test]
    fn what_is_not_enough_is_said() {
        let of = |nats| expected(&Addition { what: AGAIN.into(), nats, from: Vec::new() });
        assert!(of(3.1).ends_with("From 3 on they are told apart."));
        assert!(of(2.9).ends_with("told apart, which is expected of none of these."));
    }
}
