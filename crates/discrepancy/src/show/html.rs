//! `report.html`: one file with figures.

use super::{expected, map, not_tried, shown_additions, times, upper, value};
use crate::experiment::Experiment;
use crate::explain::{Explanation, Finding};
use crate::split::Use;
use crate::uncertainty::pause_s;
use std::fmt::Write;

/// Points that a curve has at most.
const POINTS: usize = 1500;
const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 240.0;
const LEFT: f64 = 60.0;
const BOTTOM: f64 = 36.0;

/// `report.html`: one file, figures of every compared sensor and run.
pub fn html(title: &str, experiment: &Experiment, explanation: &Explanation) -> String {
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title><style>\n{STYLE}{}</style></head><body>\n<h1>{title}</h1>\n<p class=\"verdict\"><strong>{}</strong> {}.</p>\n",
        map::STYLE,
        explanation.verdict.sentence(),
        escape(&upper(&explanation.because)),
        title = escape(title),
    );
    if !explanation.problems.is_empty() {
        let items: String =
            explanation.problems.iter().map(|p| format!("<li>{}</li>", escape(p))).collect();
        let _ = writeln!(out, "<ul>{items}</ul>");
    }
    html_table(&mut out, "Added to the model", &explanation.effects);
    if explanation.class.len() > 1 {
        html_table(
            &mut out,
            "Not told apart by these data, most plausible first",
            &explanation.class,
        );
        let advice = |f: &Finding| format!("<li>{} ({}): {}</li>", f.id, f.words, f.separates);
        let items: String = explanation.class.iter().map(advice).collect();
        let _ = writeln!(out, "<p>What would tell them apart:</p><ul>{items}</ul>");
        next_measurements(&mut out, explanation);
    }
    map::map(&mut out, experiment, explanation);
    if !explanation.curves.before.is_empty() {
        out.push_str("<h2>Measured, before and after</h2>\n<p class=\"legend\"><span class=\"measured\">measured</span> <span class=\"before\">model as it is</span> <span class=\"after\">with the effects</span> <span class=\"shown\">shaded: neither fitted nor used to choose</span></p>\n");
        for (run, measured) in experiment.runs.iter().enumerate() {
            for (sensor, of) in experiment.sensors.sensor.iter().enumerate() {
                let samples: Vec<usize> = (0..experiment.samples.len())
                    .filter(|&i| {
                        (experiment.samples[i].run, experiment.samples[i].sensor) == (run, sensor)
                    })
                    .collect();
                if samples.is_empty() {
                    continue;
                }
                let name = if measured.name.is_empty() {
                    String::new()
                } else {
                    format!(", run {}", measured.name)
                };
                let _ = writeln!(out, "<h3>{}{}</h3>", escape(&of.column), escape(&name));
                let read = |si: f64| of.of_si(si);
                let pause_s = pause_s(&measured.tracks[sensor]);
                let (before, after) = (&explanation.curves.before, &explanation.curves.after);
                let changed = !explanation.effects.is_empty();
                let value = |i: usize| read(experiment.samples[i].value);
                let mut curves: Vec<(&str, Vec<f64>)> = vec![
                    ("measured", samples.iter().map(|&i| value(i)).collect()),
                    ("before", samples.iter().map(|&i| read(before[i])).collect()),
                ];
                let mut rest: Vec<(&str, Vec<f64>)> =
                    vec![("before", samples.iter().map(|&i| read(before[i]) - value(i)).collect())];
                if changed {
                    curves.push(("after", samples.iter().map(|&i| read(after[i])).collect()));
                    rest.push((
                        "after",
                        samples.iter().map(|&i| read(after[i]) - value(i)).collect(),
                    ));
                }
                let times: Vec<f64> =
                    samples.iter().map(|&i| experiment.samples[i].time_s).collect();
                let shown: Vec<bool> = samples
                    .iter()
                    .map(|&i| explanation.curves.uses[i] == Some(Use::Show))
                    .collect();
                let label = format!("{} in {}", of.column, of.unit);
                figure(&mut out, &times, &curves, &shown, pause_s, &label);
                figure(
                    &mut out,
                    &times,
                    &rest,
                    &shown,
                    pause_s,
                    &format!("simulated less measured, {}", of.unit),
                );
            }
        }
    }
    html_table(&mut out, "Tried, best first", &explanation.tried);
    for sentence in not_tried(explanation) {
        let _ = writeln!(out, "<p>{}</p>", escape(&sentence));
    }
    if !explanation.times.is_empty() {
        let _ = writeln!(out, "<p>Time: {}.</p>", times(explanation));
    }
    out.push_str("</body></html>\n");
    out
}

fn next_measurements(out: &mut String, explanation: &Explanation) {
    let Some(first) = explanation.additions.first() else { return };
    let cells = |kind: &str, cells: &mut dyn Iterator<Item = String>| -> String {
        cells.map(|cell| format!("<{kind}>{}</{kind}>", escape(&cell))).collect()
    };
    let names = ["measurement".to_owned(), "nats".to_owned()].into_iter();
    let head = cells("th", &mut names.chain(first.from.iter().map(|(n, _)| format!("from {n}"))));
    let expected = expected(first);
    let _ =
        writeln!(out, "<h3>The next measurement</h3>\n<p>{expected}</p>\n<table><tr>{head}</tr>");
    for addition in shown_additions(explanation) {
        let all = std::iter::once(addition.nats).chain(addition.from.iter().map(|(_, x)| *x));
        let numbers = all.map(|nats| format!("{nats:.1}"));
        let row = cells("td", &mut std::iter::once(addition.what.clone()).chain(numbers));
        let _ = writeln!(out, "<tr>{row}</tr>");
    }
    out.push_str("</table>\n");
}

fn html_table(out: &mut String, title: &str, findings: &[Finding]) {
    if findings.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "<h2>{title}</h2>\n<table><tr><th>effect</th><th>where</th><th>what</th><th>value (95 %)</th><th>probability</th><th>nats more than without</th><th>sigma from plausible</th></tr>"
    );
    for f in findings {
        let _ = writeln!(
            out,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.2}</td><td>{:.1}</td><td>{:.1}</td></tr>",
            f.id,
            escape(&f.component),
            f.words,
            value(f),
            f.probability,
            f.evidence,
            f.strain
        );
    }
    out.push_str("</table>\n");
}

/// Curves over time.
fn figure(
    out: &mut String,
    times: &[f64],
    curves: &[(&str, Vec<f64>)],
    shown: &[bool],
    pause_s: f64,
    label: &str,
) {
    let (first, last) = (times[0], times[times.len() - 1].max(times[0] + 1.0));
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for y in curves.iter().flat_map(|(_, values)| values) {
        (low, high) = (low.min(*y), high.max(*y));
    }
    let step = nice((high - low).max(1e-9) / 4.0);
    (low, high) = ((low / step).floor() * step, (high / step).ceil() * step);
    let x = |t: f64| LEFT + (WIDTH - LEFT - 8.0) * (t - first) / (last - first);
    let y = |v: f64| 8.0 + (HEIGHT - BOTTOM - 8.0) * (high - v) / (high - low).max(1e-12);
    let _ = writeln!(
        out,
        "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">",
        escape(label)
    );
    let mut i = 0;
    while i < shown.len() {
        let end = (i..shown.len()).find(|&j| shown[j] != shown[i]).unwrap_or(shown.len());
        if shown[i] {
            let (a, b) = (x(times[i]), x(times[end - 1]));
            let _ = writeln!(
                out,
                "<rect class=\"shown\" x=\"{a:.1}\" y=\"8\" width=\"{:.1}\" height=\"{:.1}\"/>",
                b - a,
                HEIGHT - BOTTOM - 8.0
            );
        }
        i = end;
    }
    let rows = ((high - low) / step).round() as i32;
    let places = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
    for k in 0..=rows {
        let v = low + f64::from(k) * step;
        let _ = writeln!(
            out,
            "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{}\" y1=\"{h:.1}\" y2=\"{h:.1}\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{v:.places$}</text>",
            WIDTH - 8.0,
            LEFT - 6.0,
            y(v) + 4.0,
            h = y(v)
        );
    }
    let step = nice((last - first) / 6.0);
    let mut t = (first / step).ceil() * step;
    while t <= last {
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{t:.0} s</text>",
            x(t),
            HEIGHT - BOTTOM + 16.0
        );
        t += step;
    }
    let _ = writeln!(out, "<text x=\"{LEFT}\" y=\"{}\">{}</text>", HEIGHT - 4.0, escape(label));
    let every = times.len().div_ceil(POINTS);
    let all: Vec<usize> = (0..times.len()).collect();
    for (class, values) in curves {
        // What was read in a pause nobody knows.
        for part in all.chunk_by(|&i, &j| times[j] - times[i] < pause_s) {
            let points: String = part
                .iter()
                .filter(|&&i| i % every == 0 || i == part[0] || i + 1 == part[0] + part.len())
                .map(|&i| format!("{:.1},{:.1} ", x(times[i]), y(values[i])))
                .collect();
            let points = points.trim_end();
            let _ = writeln!(out, "<polyline class=\"{class}\" points=\"{points}\"/>");
        }
    }
    out.push_str("</svg>\n");
}

/// The next of 1, 2, 5 times a power of ten.
fn nice(step: f64) -> f64 {
    let power = 10.0_f64.powf(step.log10().floor());
    let share = step / power;
    power
        * if share <= 1.0 {
            1.0
        } else if share <= 2.0 {
            2.0
        } else if share <= 5.0 {
            5.0
        } else {
            10.0
        }
}

pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

const STYLE: &str = ":root{color-scheme:light dark;--ink:#1d2433;--paper:#fff;--line:#d8dde6;--a:#1d2433;--b:#d1495b;--c:#0a7e8c;--s:#8883}
@media(prefers-color-scheme:dark){:root{--ink:#e6e9ef;--paper:#14181f;--line:#39414f;--a:#e6e9ef;--b:#ff7a8a;--c:#4fd0df}}
body{font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:var(--ink);background:var(--paper)}
table{border-collapse:collapse;font-size:14px}td,th{padding:.25rem .6rem;border-bottom:1px solid var(--line);text-align:left}
.verdict{font-size:1.1rem}svg{width:100%;height:auto}svg text{font-size:12px;fill:var(--ink)}
.grid{stroke:var(--line);stroke-width:1}polyline{fill:none;stroke-width:1.6}rect.shown{fill:var(--s)}
polyline.measured{stroke:var(--a)}polyline.before{stroke:var(--b)}polyline.after{stroke:var(--c)}
.legend span{padding:0 .5rem;border-left:.6rem solid}.legend .measured{border-color:var(--a)}.legend .before{border-color:var(--b)}.legend .after{border-color:var(--c)}.legend .shown{border-color:var(--s)}
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!(nice(0.3), 0.5);
        assert_eq!(escape("</script>"), "&lt;/script&gt;");
    }
}
