//! The JSON messages of one topic: nested objects by component, their schema, and fast conversion
//! between a row of values and the text.
//!
//! All text between the numbers is the same in every message of a topic. It is laid out once;
//! writing a row appends text and number in turn, reading compares text and parses number in turn.

use anergy_core::recorder::{Channel, ChannelGroup};
use serde_json::{Map, Value, json};
use std::io::Write;

/// Name of the field that holds the simulated time, s.
const TIME: &str = "time_s";

/// One number of a message.
#[derive(Debug)]
struct Slot {
    /// Constant text since the previous number.
    before: String,
    /// Keys that lead to the number.
    path: Vec<String>,
    /// Index of the channel; `None` for the time.
    channel: Option<usize>,
}

/// The messages of one topic.
#[derive(Debug)]
pub(crate) struct Layout {
    slots: Vec<Slot>,
    /// Constant text after the last number.
    tail: String,
    schema: Value,
}

impl Layout {
    /// Lays out the channels of `group`; `None` when it has none.
    pub fn new(channels: &[Channel], group: ChannelGroup) -> Option<Self> {
        let members = || channels.iter().enumerate().filter(|(_, channel)| channel.group == group);
        members().next()?;

        // The message with the index of the channel in place of each number and null for the time.
        // All objects come first, so that a quantity never takes the key of a component.
        let mut skeleton = Map::new();
        skeleton.insert(TIME.into(), Value::Null);
        for (_, channel) in members() {
            object_of(&mut skeleton, &channel.component);
        }
        for (index, channel) in members() {
            if let Some(object) = object_of(&mut skeleton, &channel.component) {
                let mut key = channel.quantity.clone();
                while object.contains_key(&key) {
                    key.push('_');
                }
                object.insert(key, Value::from(index));
            }
        }

        let mut slots = Vec::new();
        let mut tail = String::new();
        flatten(&skeleton, &mut Vec::new(), &mut tail, &mut slots);
        let mut schema = schema_of(&skeleton, channels);
        if let Value::Object(root) = &mut schema {
            root.insert("title".into(), Value::from(schema_name(group)));
        }
        Some(Self { slots, tail, schema })
    }

    /// JSON Schema of the messages.
    pub fn schema(&self) -> &Value {
        &self.schema
    }

    /// Indices of the channels in the order of [`Layout::decode`].
    pub fn channels(&self) -> impl Iterator<Item = usize> {
        self.slots.iter().filter_map(|slot| slot.channel)
    }

    /// Replaces `out` by the message of a row; `values` has one value for each channel of the run.
    pub fn encode(&self, time_s: f64, values: &[f64], out: &mut Vec<u8>) -> std::io::Result<()> {
        out.clear();
        for slot in &self.slots {
            let value = slot.channel.map_or(time_s, |channel| values[channel]);
            out.write_all(slot.before.as_bytes())?;
            // Shortest text that reads back to the same bits; null when not finite.
            serde_json::to_writer(&mut *out, &value)?;
        }
        out.write_all(self.tail.as_bytes())
    }

    /// Replaces `row` by the values of a message in the order of [`Layout::channels`] and returns
    /// the time; `None` when the message is not JSON or has no time.
    pub fn decode(&self, message: &[u8], row: &mut Vec<f64>) -> Option<f64> {
        row.clear();
        self.decode_exact(message, row).or_else(|| {
            row.clear();
            self.decode_any(message, row)
        })
    }

    /// Messages with exactly the text of [`Layout::encode`].
    fn decode_exact(&self, message: &[u8], row: &mut Vec<f64>) -> Option<f64> {
        let mut rest = message;
        let mut time_s = None;
        for slot in &self.slots {
            rest = rest.strip_prefix(slot.before.as_bytes())?;
            let (number, after) =
                rest.split_at(rest.iter().position(|byte| matches!(byte, b',' | b'}'))?);
            rest = after;
            let value = match number {
                b"null" => f64::NAN,
                digits => std::str::from_utf8(digits).ok()?.parse().ok()?,
            };
            match slot.channel {
                Some(_) => row.push(value),
                None => time_s = Some(value),
            }
        }
        if rest == self.tail.as_bytes() { time_s } else { None }
    }

    /// The same content in any JSON text; missing values are NaN.
    fn decode_any(&self, message: &[u8], row: &mut Vec<f64>) -> Option<f64> {
        let message: Value = serde_json::from_slice(message).ok()?;
        let mut time_s = None;
        for slot in &self.slots {
            let value = slot.path.iter().try_fold(&message, |object, key| object.get(key));
            let value = value.and_then(Value::as_f64);
            match slot.channel {
                Some(_) => row.push(value.unwrap_or(f64::NAN)),
                None => time_s = value,
            }
        }
        time_s
    }
}

/// Name of the schema of a group, for example `anergy.network.nodes`.
pub(crate) fn schema_name(group: ChannelGroup) -> String {
    format!("anergy{}", group.topic().replace('/', "."))
}

/// The object of a component, created when missing. The key of a value is never reused: `_` is
/// appended to the component's part instead.
fn object_of<'a>(
    root: &'a mut Map<String, Value>,
    component: &str,
) -> Option<&'a mut Map<String, Value>> {
    let mut object = root;
    for part in component.split('.').filter(|_| !component.is_empty()) {
        let mut key = part.to_string();
        while object.get(&key).is_some_and(|value| !value.is_object()) {
            key.push('_');
        }
        object = object.entry(key).or_insert_with(|| json!({})).as_object_mut()?;
    }
    Some(object)
}

/// Splits the text of a skeleton at its values.
fn flatten(
    object: &Map<String, Value>,
    path: &mut Vec<String>,
    text: &mut String,
    slots: &mut Vec<Slot>,
) {
    text.push('{');
    for (position, (key, value)) in object.iter().enumerate() {
        if position > 0 {
            text.push(',');
        }
        text.push_str(&Value::from(key.as_str()).to_string());
        text.push(':');
        path.push(key.clone());
        match value {
            Value::Object(inner) => flatten(inner, path, text, slots),
            leaf => slots.push(Slot {
                before: std::mem::take(text),
                path: path.clone(),
                channel: channel_of(leaf),
            }),
        }
        path.pop();
    }
    text.push('}');
}

/// Schema of an object of the skeleton.
fn schema_of(object: &Map<String, Value>, channels: &[Channel]) -> Value {
    let properties: Map<String, Value> = object
        .iter()
        .map(|(key, value)| {
            let schema = match value {
                Value::Object(inner) => schema_of(inner, channels),
                leaf => match channel_of(leaf).and_then(|index| channels.get(index)) {
                    Some(channel) => json!({
                        "type": "number",
                        "description": format!("{} in {}", channel.name, channel.unit),
                        "x-unit": channel.unit,
                    }),
                    None => json!({
                        "type": "number",
                        "description": "simulated time since the start of the run in s",
                        "x-unit": "s",
                    }),
                },
            };
            (key.clone(), schema)
        })
        .collect();
    json!({"type": "object", "properties": properties})
}

/// The channel at a leaf of the skeleton; `None` for the time.
fn channel_of(leaf: &Value) -> Option<usize> {
    leaf.as_u64().and_then(|index| usize::try_from(index).ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(component: &str, quantity: &str) -> Channel {
        Channel {
            name: format!("{component}.{quantity}"),
            unit: "kg s-1".into(),
            group: ChannelGroup::Edges,
            component: component.into(),
            quantity: quantity.into(),
        }
    }

    fn message(channels: &[Channel]) -> String {
        let layout = Layout::new(channels, ChannelGroup::Edges).unwrap();
        let values: Vec<f64> = (0..channels.len()).map(|index| index as f64).collect();
        let mut text = Vec::new();
        layout.encode(0.5, &values, &mut text).unwrap();
        // Both ways of reading find what was written.
        for decode in [Layout::decode_exact, Layout::decode_any] {
            let mut row = Vec::new();
            assert_eq!(decode(&layout, &text, &mut row), Some(0.5));
            assert!(layout.channels().zip(&row).all(|(index, value)| index as f64 == *value));
            assert_eq!(row.len(), channels.len());
        }
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn components_merge_whatever_the_order() {
        let mut channels = [
            channel("sf1.station.pump", "m_flow"),
            channel("sf2", "p"),
            channel("sf1.station", "q"),
            channel("sf1", "t"),
            channel("sf1.station.pump", "dp"),
        ];
        assert_eq!(
            message(&channels),
            r#"{"time_s":0.5,"sf1":{"station":{"pump":{"m_flow":0.0,"dp":4.0},"q":2.0},"t":3.0},"sf2":{"p":1.0}}"#
        );
        channels.reverse();
        assert_eq!(
            message(&channels),
            r#"{"time_s":0.5,"sf1":{"station":{"pump":{"dp":0.0,"m_flow":4.0},"q":2.0},"t":1.0},"sf2":{"p":3.0}}"#
        );
    }

    #[test]
    fn clashes_keep_every_value() {
        let channels = [
            channel("a", "b"),
            channel("a.b", "c"),
            channel("a.b", "c"),
            channel("time_s", "x"),
            channel("", "time_s"),
            channel("q\"\n", "</script>"),
        ];
        assert_eq!(
            message(&channels),
            r#"{"time_s":0.5,"a":{"b":{"c":1.0,"c_":2.0},"b_":0.0},"time_s_":{"x":3.0},"q\"\n":{"</script>":5.0},"time_s__":4.0}"#
        );
    }

    #[test]
    fn other_json_text_is_read_too() {
        let layout =
            Layout::new(&[channel("a", "b"), channel("a", "c")], ChannelGroup::Edges).unwrap();
        let mut row = Vec::new();
        let time = layout.decode(b"{\"a\": {\"c\": 1e-300}, \"time_s\": 2}", &mut row);
        assert_eq!(time, Some(2.0));
        assert!(row[0].is_nan() && row[1] == 1e-300);
        assert_eq!(layout.decode(b"{\"a\": {\"c\": 1}}", &mut row), None);
        assert_eq!(layout.decode(b"{\"time_s\":", &mut row), None);
        assert!(Layout::new(&[], ChannelGroup::Edges).is_none());
    }

    #[test]
    fn schema_has_units() {
        let layout = Layout::new(&[channel("a.b", "c")], ChannelGroup::Edges).unwrap();
        assert_eq!(layout.schema()["type"], "object");
        assert_eq!(layout.schema()["title"], "anergy.network.edges");
        let leaf = &layout.schema()["properties"]["a"]["properties"]["b"]["properties"]["c"];
        assert_eq!(leaf["type"], "number");
        assert_eq!(leaf["x-unit"], "kg s-1");
        assert_eq!(leaf["description"], "a.b.c in kg s-1");
    }
}
