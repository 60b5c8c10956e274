//! The tables of the report: key numbers, settings, balances, events, channels.

use crate::display;
use crate::escape::html;
use anergy_core::recorder::{ChannelGroup, Event, Recording, Severity};
use serde_json::Value;
use std::collections::BTreeMap;

/// Events that are listed at most.
const MAX_EVENTS: usize = 1000;

/// A table; `head` and `rows` are HTML.
fn table(name: &str, class: &str, head: &str, rows: &str) -> String {
    format!(
        r#"<div class="scroll"><table class="{class}" data-table="{name}"><thead><tr>{head}</tr></thead>
<tbody>
{rows}</tbody></table></div>"#
    )
}

/// Column heads; numbers are marked by a `#` in front.
fn head(columns: &[&str]) -> String {
    let cell = |column: &&str| match column.strip_prefix('#') {
        Some(column) => format!(r#"<th scope="col" class="num">{column}</th>"#),
        None => format!(r#"<th scope="col">{column}</th>"#),
    };
    columns.iter().map(cell).collect()
}

/// Key results of the summary; a sentence where there are none.
pub fn key_numbers(summary: &Value) -> String {
    let entries = entries(summary, "key_results");
    if entries.is_empty() {
        return r#"<p class="none">No key results were stored.</p>"#.to_owned();
    }
    let row = |entry: &Value| {
        format!(
            r#"<tr><th scope="row">{}</th><td class="id">{}</td><td class="num">{}</td><td>{}</td></tr>
"#,
            text(entry, "label"),
            text(entry, "component"),
            html(&display::json_value(entry.get("value"))),
            text(entry, "unit"),
        )
    };
    let rows: String = entries.iter().map(row).collect();
    let mut out =
        table("key-numbers", "numbers", &head(&["Quantity", "Component", "#Value", "Unit"]), &rows);
    if let Some(others @ 1..) = summary.get("stations_beyond_key_results").and_then(Value::as_u64) {
        out += &format!(
            "<p>The stations with the most heat; {others} others are in summary.json.</p>"
        );
    }
    out
}

/// Balances of the summary.
pub fn balances(summary: &Value) -> String {
    let entries = entries(summary, "balances");
    if entries.is_empty() {
        return r#"<p class="none">No balances were stored.</p>"#.to_owned();
    }
    let row = |entry: &Value| {
        format!(
            r#"<tr><th scope="row">{}</th><td class="num">{}</td><td>{}</td><td class="num">{}</td></tr>
"#,
            text(entry, "label"),
            html(&display::json_value(entry.get("value"))),
            text(entry, "unit"),
            text(entry, "relative_error"),
        )
    };
    let rows: String = entries.iter().map(row).collect();
    table("balances", "numbers", &head(&["Balance", "#Value", "Unit", "#Relative error"]), &rows)
}

/// The pipes with the largest losses; nothing where there are none.
pub fn pipes(summary: &Value) -> String {
    let entries = entries(summary, "pipes");
    if entries.is_empty() {
        return String::new();
    }
    let row = |entry: &Value| {
        let number = |name: &str| format!(r#"<td class="num">{}</td>"#, text(entry, name));
        let columns = ["lost_kwh", "mean_loss_w", "brought_kwh", "stored_kwh", "relative_error"];
        let numbers: String = columns.into_iter().map(number).collect();
        format!(r#"<tr><th scope="row">{}</th>{numbers}</tr>"#, text(entry, "component")) + "\n"
    };
    let rows: String = entries.iter().map(row).collect();
    let columns = [
        "Pipe",
        "#Lost in kWh",
        "#Mean loss in W",
        "#Brought in kWh",
        "#Stored in kWh",
        "#Relative error",
    ];
    table("pipes", "numbers", &head(&columns), &rows)
}

/// Name and value pairs.
pub fn pairs<'a>(name: &str, pairs: impl Iterator<Item = (&'a str, String)>) -> String {
    let pair = |(name, value): (&str, String)| {
        format!("<div><dt>{}</dt><dd>{}</dd></div>", html(name), html(&value))
    };
    format!(r#"<dl data-list="{name}">{}</dl>"#, pairs.map(pair).collect::<String>())
}

/// Statistics of the summary.
pub fn statistics(summary: &Value) -> String {
    let Some(entries) = summary.get("statistics").and_then(Value::as_object) else {
        return String::new();
    };
    let shown =
        entries.iter().map(|(name, value)| (name.as_str(), display::json_value(Some(value))));
    format!("<h3>Statistics</h3>{}", pairs("statistics", shown))
}

/// Events in the order they happened; the times move the slider.
pub fn events(recording: &Recording) -> String {
    let all = &recording.events;
    if all.is_empty() {
        return r#"<p class="none">No events.</p>"#.to_owned();
    }
    let row = |event: &Event| {
        let (class, word) = match event.severity {
            Severity::Info => ("info", "Info"),
            Severity::Warning => ("warning", "Warning"),
        };
        format!(
            r#"<tr><td><button type="button" class="at" data-time="{}" title="Show this moment">{}</button></td><td><span class="badge {class}">{word}</span></td><td class="id">{}</td><td>{}</td><td>{}</td></tr>
"#,
            event.time.as_s(),
            html(&display::time(event.time)),
            html(&event.component),
            html(&event.kind),
            html(&event.message),
        )
    };
    let rows: String = all.iter().take(MAX_EVENTS).map(row).collect();
    let severity = r#"<span class="hidden">Severity</span>"#;
    let head = head(&["Time", severity, "Component", "Event", "What happened"]);
    let more = match all.len().saturating_sub(MAX_EVENTS) {
        0 => String::new(),
        more => format!(
            r#"<p class="none">{more} later events are not listed; the recording has them.</p>"#
        ),
    };
    table("events", "events", &head, &rows) + &more
}

/// Recorded channels, one row for each quantity with the components that have it.
pub fn channels(recording: &Recording) -> String {
    let mut known: BTreeMap<(ChannelGroup, &str, &str), Vec<&str>> = BTreeMap::new();
    for channel in &recording.channels {
        let key = (channel.group, channel.quantity.as_str(), channel.unit.as_str());
        known.entry(key).or_default().push(&channel.component);
    }
    let row = |((group, quantity, unit), components): ((ChannelGroup, &str, &str), Vec<&str>)| {
        format!(
            r#"<tr><td class="id">{}</td><td class="id">{}</td><td class="id">{}</td><td class="num">{}</td><td class="id list">{}</td></tr>
"#,
            group.topic(),
            html(quantity),
            html(unit),
            components.len(),
            html(&components.join(", ")),
        )
    };
    let rows: String = known.into_iter().map(row).collect();
    let head = head(&["Topic", "Quantity", "Unit", "#Number", "Components"]);
    table("channels", "channels", &head, &rows)
}

fn entries<'a>(summary: &'a Value, name: &str) -> &'a [Value] {
    summary.get(name).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

fn text(row: &Value, name: &str) -> String {
    match row.get(name) {
        None | Some(Value::Null) => String::new(),
        value => html(&display::json_value(value)),
    }
}
