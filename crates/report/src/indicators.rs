//! The indicators of a run (`kpis` of the summary) as tables of the grid, its sites, stations and units.

use crate::display;
use serde::Serialize;
use serde_json::{Map, Value};

/// Ends of names and how they are shown; longer ones first.
const UNITS: [(&str, &str); 12] = [
    ("_kwh_per_mwh_taken", "kWh/MWh taken"),
    ("_of_taken_percent", "% of the heat taken"),
    ("_k_h", "K h"),
    ("_kwh", "kWh"),
    ("_degc", "°C"),
    ("_percent", "%"),
    ("_bar", "bar"),
    ("_m3", "m³"),
    ("_kw", "kW"),
    ("_h", "h"),
    ("_s", "s"),
    ("_k", "K"),
];
const SECTIONS: [(&str, &str); 3] =
    [("stations", "Stations"), ("sites", "Sites"), ("units", "Units")];

/// A table for the script.
#[derive(Debug, Serialize)]
pub struct Indicators {
    id: &'static str,
    columns: Vec<Column>,
    rows: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Column {
    name: String,
    unit: &'static str,
}

/// Name, then one value for each column.
#[derive(Debug, Serialize)]
struct Row(String, Vec<Option<f64>>);

/// Tables with a row for each station, site and unit.
pub fn tables(summary: &Value) -> Vec<Indicators> {
    SECTIONS.iter().filter_map(|(id, _)| table(id, entries(summary, id)?)).collect()
}

fn entries<'a>(summary: &'a Value, section: &str) -> Option<&'a Map<String, Value>> {
    summary.get("kpis")?.get(section)?.as_object().filter(|entries| !entries.is_empty())
}

fn table(id: &'static str, entries: &Map<String, Value>) -> Option<Indicators> {
    let mut keys: Vec<&String> = Vec::new();
    for key in entries.values().filter_map(Value::as_object).flat_map(Map::keys) {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let row = |(name, values): (&String, &Value)| {
        let value = |key: &&String| values.get(key.as_str()).and_then(Value::as_f64).map(shortened);
        Row(name.clone(), keys.iter().map(value).collect())
    };
    let rows: Vec<Row> =
        entries.iter().map(row).filter(|row| row.1.iter().any(Option::is_some)).collect();
    let column = |key: &&String| {
        let (name, unit) = split(key);
        Column { name, unit }
    };
    (!rows.is_empty()).then(|| Indicators { id, columns: keys.iter().map(column).collect(), rows })
}

/// Name and unit of an indicator.
fn split(key: &str) -> (String, &'static str) {
    let found = UNITS.iter().find_map(|(end, unit)| Some((key.strip_suffix(end)?, *unit)));
    let (name, unit) = found.unwrap_or((key, ""));
    let words = name.split('_').map(|word| match word {
        "dp" => "pressure difference",
        "cop" => "COP",
        other => other,
    });
    (words.collect::<Vec<_>>().join(" "), unit)
}

/// Six significant digits: what a table shows, and less to embed.
fn shortened(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Indicators of the grid, and places for the tables.
pub fn section(summary: &Value) -> String {
    let mut out = String::new();
    if let Some(grid) = entries(summary, "network") {
        let node = |key: &str| grid.get(key).and_then(Value::as_str);
        let pair = |(key, value): (&String, &Value)| {
            let (name, unit) = split(key);
            let text = format!("{} {unit}", display::number(value.as_f64()?));
            let at = key.strip_suffix("_degc").and_then(node);
            Some((name, at.map_or(text.clone(), |node| format!("{text} at {node}"))))
        };
        let pairs: Vec<(String, String)> = grid.iter().filter_map(pair).collect();
        let pairs = pairs.iter().map(|(name, value)| (name.as_str(), value.trim_end().to_owned()));
        out += &crate::tables::pairs("grid", pairs);
    }
    for (id, title) in SECTIONS {
        if let Some(entries) = entries(summary, id) {
            out += &format!(
                r#"<details class="indicators" data-indicators="{id}" data-print="open"><summary>{title} ({})</summary></details>
"#,
                entries.len()
            );
        }
    }
    if out.is_empty() {
        return r#"<p class="none">No indicators were stored.</p>"#.to_owned();
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn names_and_units() {
        assert_eq!(split("heat_given_kwh"), ("heat given".to_owned(), "kWh"));
        assert_eq!(split("discomfort_heating_k_h"), ("discomfort heating".to_owned(), "K h"));
        assert_eq!(split("pump_kwh_per_mwh_taken"), ("pump".to_owned(), "kWh/MWh taken"));
        assert_eq!(split("seasonal_cop"), ("seasonal COP".to_owned(), ""));
    }

    #[test]
    fn columns_are_all_that_any_row_has() {
        let summary = json!({"kpis": {
            "network": {"coldest_node_degc": 7.044_742_589, "coldest_node": "<b>", "dp_min_bar": 0.5},
            "units": {"a": {"starts": 3.0}, "b": {"heat_kwh": 1.234_567_89, "starts": 4.0}, "c": {}},
        }});
        let tables = tables(&summary);
        assert_eq!(tables.len(), 1);
        let text = serde_json::to_string(&tables[0]).unwrap();
        assert_eq!(
            text,
            r#"{"id":"units","columns":[{"name":"starts","unit":""},{"name":"heat","unit":"kWh"}],"rows":[["a",[3.0,null]],["b",[4.0,1.23457]]]}"#
        );
        let section = section(&summary);
        assert!(
            section.contains("7.045 °C at &lt;b&gt;") && section.contains("Units (3)"),
            "{section}"
        );
    }
}
