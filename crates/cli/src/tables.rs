//! Results as text, in the units of the trade: l/min, bar, degC, kW.

use crate::output::line;
use anergy_core::recorder::{Event, Recording};
use anergy_core::units::l_min;
use anergy_simulation::steady::Steady;
use serde_json::Value;

/// Rows of equal width: numbers to the right, words to the left.
pub fn print_table(header: &[&str], rows: &[Vec<String>]) {
    let widths: Vec<usize> = (0..header.len())
        .map(|column| {
            let cells = rows.iter().map(|row| row[column].chars().count());
            cells.chain([header[column].chars().count()]).max().unwrap_or(0)
        })
        .collect();
    let numeric: Vec<bool> = (0..header.len())
        .map(|column| {
            rows.iter().all(|row| row[column] == "-" || row[column].parse::<f64>().is_ok())
        })
        .collect();
    let print = |cells: Vec<&str>| {
        let padded: Vec<String> = cells
            .iter()
            .zip(widths.iter().zip(&numeric))
            .map(
                |(cell, (&width, &numeric))| {
                    if numeric { format!("{cell:>width$}") } else { format!("{cell:<width$}") }
                },
            )
            .collect();
        line!("{}", padded.join("  ").trim_end());
    };
    print(header.to_vec());
    for row in rows {
        print(row.iter().map(String::as_str).collect());
    }
}

/// Nodes and edges of a steady state.
pub fn print_steady(density_kg_m3: f64, steady: &Steady) {
    let nodes: Vec<Vec<String>> = steady
        .nodes
        .iter()
        .map(|node| {
            vec![
                node.id.to_string(),
                format!("{:.4}", node.p_pa / 1e5),
                format!("{:.2}", node.t_k - 273.15),
            ]
        })
        .collect();
    print_table(&["node", "p bar", "T degC"], &nodes);
    drop(nodes);
    line!("");
    let edges: Vec<Vec<String>> = steady
        .edges
        .iter()
        .map(|edge| {
            vec![
                edge.id.to_string(),
                edge.kind.to_string(),
                format!("{:.3}", l_min(edge.m_flow_kg_s, density_kg_m3)),
                format!("{:.4}", edge.dp_pa / 1e5),
            ]
        })
        .collect();
    print_table(&["edge", "kind", "flow l/min", "dp bar"], &edges);
    for unreached in &steady.unreached {
        line!("\nwarning: {unreached}");
    }
    for crossing in &steady.crossed {
        line!("\nwarning: {crossing}");
    }
    line!(
        "\n{} Newton iterations, largest residual {:.1e} Pa",
        steady.iterations,
        steady.residual_pa
    );
}

/// Key results of a run, one row per component and column per quantity.
pub fn print_key_results(summary: &Value) {
    let empty = Vec::new();
    let results = summary["key_results"].as_array().unwrap_or(&empty);
    let rows: Vec<Vec<String>> = results
        .iter()
        .map(|result| {
            let text = |key: &str| result[key].as_str().unwrap_or_default().to_owned();
            // What rounds to nothing has no sign.
            let shown = |value: f64| if value.abs() < 5e-4 { 0.0 } else { value };
            let value = result["value"].as_f64().map(shown);
            let value = value.map_or("-".into(), |value| format!("{value:.3}"));
            vec![text("component"), text("label"), value, text("unit")]
        })
        .collect();
    print_table(&["component", "result", "value", "unit"], &rows);
    if let Some(others @ 1..) = summary["stations_beyond_key_results"].as_u64() {
        line!("the stations with the most heat; {others} others are in summary.json");
    }
    for balance in summary["balances"].as_array().unwrap_or(&empty) {
        if let (Some("heat from units" | "pump work"), Some(error)) =
            (balance["label"].as_str(), balance["relative_error"].as_f64())
        {
            let what = if balance["unit"] == "kWh" { "heat" } else { "hydraulic work" };
            line!("balance of {what} closes to {error:.1e}");
        }
    }
    let steps = &summary["automatic_step"];
    if let (Some(count), Some(limit)) =
        (steps["steps"].as_u64(), steps["limited_most_often_by"].as_str())
    {
        let length = |key: &str| steps[key].as_f64().unwrap_or(f64::NAN);
        line!(
            "{count} automatic steps of {:.3} to {:.3} s, {:.3} s on average, limited most often by: {limit}",
            length("smallest_s"),
            length("largest_s"),
            length("mean_s")
        );
    }
}

/// What happened, one line each.
pub fn print_events(events: &[Event]) {
    for event in events {
        line!("{:>10}  {}", event.time.to_string(), event.message);
    }
}

/// Flow, share and flag of all stations at some times of a recording.
pub fn print_stations_at(recording: &Recording, times_s: &[f64], density_kg_m3: f64) {
    let flows: Vec<(&str, &[f64])> = recording
        .channels
        .iter()
        .zip(&recording.columns)
        .filter(|(channel, _)| {
            channel.group == anergy_core::recorder::ChannelGroup::Interfaces
                && channel.quantity == "m_flow_kg_s"
        })
        .map(|(channel, column)| (channel.component.as_str(), column.as_slice()))
        .collect();
    let mut rows = Vec::new();
    for &time_s in times_s {
        let row = recording.time_s.partition_point(|time| *time < time_s);
        if row >= recording.time_s.len() {
            continue;
        }
        let total: f64 = flows.iter().map(|(_, flow)| flow[row].max(0.0)).sum();
        for (name, flow) in &flows {
            let m = flow[row];
            let blocked = recording
                .column(&format!("{name}.blocked"))
                .is_some_and(|blocked| blocked[row] > 0.5);
            let share = if m > 0.0 { format!("{:.0} %", 100.0 * m / total) } else { "-".into() };
            rows.push(vec![
                format!("{time_s:.0} s"),
                (*name).to_owned(),
                format!("{:.3}", l_min(m, density_kg_m3)),
                share,
                if blocked { "blocked".into() } else { String::new() },
            ]);
        }
    }
    print_table(&["time", "station", "flow l/min", "share of feed-in", ""], &rows);
}
