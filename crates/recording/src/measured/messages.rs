//! JSON messages in MCAP files of other programs.

use super::csv_table::free;
use super::names::{self, Head};
use super::{MeasuredColumn, MeasuredError, MeasuredOptions, MeasuredTable, Remark};
use serde_json::Value;
use std::collections::BTreeMap;

/// The messages of one topic.
#[derive(Default)]
struct Topic {
    /// Units by path, from the schema.
    units: BTreeMap<String, String>,
    /// Time in ns and numbers by path.
    rows: Vec<(u64, BTreeMap<String, f64>)>,
}

pub(super) fn read(
    bytes: &[u8],
    options: &MeasuredOptions,
) -> Result<MeasuredTable, MeasuredError> {
    if !bytes.starts_with(mcap::MAGIC) {
        return Err(MeasuredError::new(None, "this is no MCAP file"));
    }
    let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
    let mut others: BTreeMap<String, String> = BTreeMap::new();
    let stream = mcap::MessageStream::new(bytes)
        .map_err(|error| MeasuredError::new(None, format!("this is no MCAP file: {error}")))?;
    let mut damage = None;
    for message in stream {
        let message = match message {
            Ok(message) => message,
            Err(error) => {
                damage = Some(format!(
                    "the file ends or is damaged ({error}): what comes before is read"
                ));
                break;
            }
        };
        let channel = &message.channel;
        if channel.message_encoding != "json" {
            others.insert(channel.topic.clone(), channel.message_encoding.clone());
            continue;
        }
        let topic = topics.entry(channel.topic.clone()).or_insert_with(|| {
            let schema = channel.schema.as_ref().map(|schema| schema.data.to_vec());
            let schema = schema.and_then(|text| serde_json::from_slice(&text).ok());
            let mut units = BTreeMap::new();
            units_of(&schema.unwrap_or(Value::Null), "", &mut units);
            Topic { units, rows: Vec::new() }
        });
        if let Ok(content) = serde_json::from_slice::<Value>(&message.data) {
            let mut row = BTreeMap::new();
            numbers_of(&content, String::new(), &mut row);
            topic.rows.push((message.log_time, row));
        }
    }
    topics.retain(|_, topic| topic.rows.iter().any(|(_, row)| !row.is_empty()));
    let names: Vec<String> = topics.keys().cloned().collect();
    let (name, mut topic) = match &options.topic {
        Some(name) => match topics.remove_entry(name) {
            Some(found) => found,
            None => {
                let problem = format!(
                    "there is no topic \"{name}\" with numbers; there are: {}",
                    names.join(", ")
                );
                return Err(MeasuredError::new(None, problem));
            }
        },
        None if topics.len() == 1 => topics.pop_first().unwrap_or_default(),
        None if topics.is_empty() => {
            let binary: Vec<String> =
                others.iter().map(|(topic, encoding)| format!("{topic} ({encoding})")).collect();
            let problem = match binary.is_empty() {
                true => "no topic has JSON messages with numbers".to_owned(),
                false => format!("only JSON messages are read; the file has {}", binary.join(", ")),
            };
            return Err(MeasuredError::new(None, problem));
        }
        None => {
            let problem =
                format!("the file has several topics with numbers, name one: {}", names.join(", "));
            return Err(MeasuredError::new(None, problem));
        }
    };
    topic.rows.sort_by_key(|(time, _)| *time);
    let all = topic.rows.len();
    topic.rows.dedup_by_key(|(time, _)| *time);
    let again = all - topic.rows.len();
    let mut table = table_of(&topic);
    table.remarks.push(Remark::of_file(format!("the messages of {name}")));
    if again > 0 {
        let text = format!("{again} messages at the time of another one: the first counts");
        table.remarks.push(Remark::of_file(text));
    }
    table.remarks.extend(damage.map(Remark::of_file));
    Ok(table)
}

fn table_of(topic: &Topic) -> MeasuredTable {
    let start = topic.rows.first().map_or(0, |(time, _)| *time);
    let mut paths: Vec<&String> = topic.rows.iter().flat_map(|(_, row)| row.keys()).collect();
    paths.sort_unstable();
    paths.dedup();
    let mut columns: Vec<MeasuredColumn> = Vec::new();
    for path in paths {
        let mut head = Head::of(path);
        if let Some(unit) = topic.units.get(path).and_then(|word| names::unit(word)) {
            // The name may end in the unit already.
            head.unit = Some(unit);
        }
        let value = |(_, row): &(u64, BTreeMap<String, f64>)| {
            let value = row.get(path).copied().unwrap_or(f64::NAN);
            head.unit.map_or(value, |unit| unit.to_si(value, head.is_difference()))
        };
        let values = topic.rows.iter().map(value).collect();
        let unit = head.unit.map_or("", |unit| unit.si).to_owned();
        columns.push(MeasuredColumn { name: free(&columns, head.name()), unit, values });
    }
    MeasuredTable {
        start_unix_ns: i64::try_from(start).ok().filter(|start| *start != 0),
        time_s: topic.rows.iter().map(|(time, _)| (time - start) as f64 / 1e9).collect(),
        columns,
        remarks: Vec::new(),
    }
}

fn joined(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// Numbers of a message by their paths.
fn numbers_of(value: &Value, path: String, row: &mut BTreeMap<String, f64>) {
    match value {
        Value::Number(number) => {
            if let Some(number) = number.as_f64() {
                row.insert(path, number);
            }
        }
        Value::Object(fields) => {
            for (key, value) in fields {
                numbers_of(value, joined(&path, key), row);
            }
        }
        _ => {}
    }
}

/// Units of a schema by the paths of their numbers.
fn units_of(schema: &Value, path: &str, units: &mut BTreeMap<String, String>) {
    if let Some(unit) = schema.get("x-unit").and_then(Value::as_str) {
        units.insert(path.to_owned(), unit.to_owned());
    }
    if let Some(properties) = schema.get("properties").and_then(Value::as_object) {
        for (key, inner) in properties {
            units_of(inner, &joined(path, key), units);
        }
    }
}
