//! Spans of time as people write them.

use anergy_core::clock::Time;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::borrow::Cow;

/// A span of time as people write it: "1h", "90 s", "1d 12h", or a number of seconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Duration(pub Time);

impl Duration {
    /// Parses "1h 30min"; a bare number is seconds.
    ///
    /// # Errors
    /// A sentence that says what is wrong.
    pub fn parse(text: &str) -> Result<Self, String> {
        let hint = "write for example \"10s\", \"15min\", \"1h\" or \"1d 12h\"";
        let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        if let Ok(seconds) = compact.parse::<f64>() {
            return Self::from_s(seconds);
        }
        let mut rest = compact.as_str();
        let mut total = 0.0;
        while !rest.is_empty() {
            let number_end = rest
                .find(|c: char| !c.is_ascii_digit() && c != '.')
                .ok_or_else(|| format!("\"{text}\" has a number without unit; {hint}"))?;
            let value: f64 = rest[..number_end]
                .parse()
                .map_err(|_| format!("\"{text}\" is not a duration; {hint}"))?;
            rest = &rest[number_end..];
            let unit_end =
                rest.find(|c: char| c.is_ascii_digit() || c == '.').unwrap_or(rest.len());
            total += value
                * match &rest[..unit_end] {
                    "ms" => 1e-3,
                    "s" => 1.0,
                    "m" | "min" => 60.0,
                    "h" => 3600.0,
                    "d" => 86_400.0,
                    "w" => 604_800.0,
                    "a" | "y" => 31_536_000.0,
                    other => {
                        return Err(format!("\"{text}\" has the unknown unit \"{other}\"; {hint}"));
                    }
                };
            rest = &rest[unit_end..];
        }
        Self::from_s(total)
    }

    fn from_s(seconds: f64) -> Result<Self, String> {
        match Time::from_s(seconds) {
            Some(time) if time > Time::ZERO => Ok(Self(time)),
            None if seconds > 0.0 => Err(format!(
                "{seconds:.4e} s is too long; time is counted up to 292 years (9.2e9 s)"
            )),
            _ => Err(format!("a duration must be positive, not {seconds} s")),
        }
    }
}

/// A step: a span of time, or "auto".
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepEntry {
    /// At most so long.
    Fixed(Duration),
    /// As long as flows, temperatures and controllers allow.
    Automatic,
}

impl StepEntry {
    /// Parses "auto" or a duration.
    ///
    /// # Errors
    /// A sentence that says what is wrong.
    pub fn parse(text: &str) -> Result<Self, String> {
        if text.trim() == AUTO {
            return Ok(Self::Automatic);
        }
        Duration::parse(text).map(Self::Fixed).map_err(|problem| format!("{problem}, or \"auto\""))
    }
}

const AUTO: &str = "auto";

impl Serialize for StepEntry {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Fixed(step) => step.serialize(serializer),
            Self::Automatic => serializer.serialize_str(AUTO),
        }
    }
}

impl<'de> Deserialize<'de> for StepEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = StepEntry;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("\"auto\", a duration such as \"10s\" or a number of seconds")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<StepEntry, E> {
                StepEntry::parse(text).map_err(E::custom)
            }
            fn visit_f64<E: de::Error>(self, seconds: f64) -> Result<StepEntry, E> {
                Duration::from_s(seconds).map(StepEntry::Fixed).map_err(E::custom)
            }
            fn visit_u64<E: de::Error>(self, seconds: u64) -> Result<StepEntry, E> {
                self.visit_f64(seconds as f64)
            }
            fn visit_i64<E: de::Error>(self, seconds: i64) -> Result<StepEntry, E> {
                self.visit_f64(seconds as f64)
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

impl JsonSchema for StepEntry {
    fn schema_name() -> Cow<'static, str> {
        "Step".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "type": ["string", "number"],
            "examples": ["auto", "1s", "15min", 60]
        })
    }
}

impl Serialize for Duration {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for Duration {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = Duration;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a duration such as \"10s\" or a number of seconds")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Duration, E> {
                Duration::parse(text).map_err(E::custom)
            }
            fn visit_f64<E: de::Error>(self, seconds: f64) -> Result<Duration, E> {
                Duration::from_s(seconds).map_err(E::custom)
            }
            fn visit_u64<E: de::Error>(self, seconds: u64) -> Result<Duration, E> {
                self.visit_f64(seconds as f64)
            }
            fn visit_i64<E: de::Error>(self, seconds: i64) -> Result<Duration, E> {
                self.visit_f64(seconds as f64)
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

impl JsonSchema for Duration {
    fn schema_name() -> Cow<'static, str> {
        "Duration".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "type": ["string", "number"],
            "examples": ["10s", "15min", "1h", "1d 12h", 3600]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations() {
        let s = |text: &str| Duration::parse(text).map(|duration| duration.0.as_s());
        assert_eq!(s("1h 30min"), Ok(5400.0));
        assert_eq!(s("250ms"), Ok(0.25));
        assert_eq!(s("1d"), Ok(86_400.0));
        assert_eq!(s("0.5"), Ok(0.5));
        assert!(s("400 y").unwrap_err().contains("too long"));
        assert!(s("0s").unwrap_err().contains("must be positive"));
        assert_eq!(StepEntry::parse(" auto"), Ok(StepEntry::Automatic));
        assert!(StepEntry::parse("soon").unwrap_err().contains("auto"));
        for wrong in ["", "abc", "1x", "-1s", "0s", "1h30", "auto", "1e400"] {
            assert!(s(wrong).is_err(), "{wrong}");
        }
    }
}
