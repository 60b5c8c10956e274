//! Over which values a quantity is spread, as a function of a number between 0 and 1.
//!
//! **Equation** the value at `u` is the quantile of the distribution at `u`:
//! uniform `low + u (high - low)`; normal `mean + s z(u)`, cut off at `low` and `high` where they are given (the
//! quantile of `F(low) + u (F(high) - F(low))`); triangular with the corners `low`, `mode`, `high`; values that are
//! listed: the one with the number `floor(u n)`.
//!
//! **Sources** quantile of the normal distribution: `statrs`.

use crate::definition::VariationEntry;
use serde_json::Value;
use statrs::distribution::{ContinuousCDF, Normal};

/// Of a normal distribution that is cut off at least this share is left: quantiles of less lose their digits.
const LEAST_INSIDE: f64 = 1e-6;

/// Values of a variation.
#[derive(Debug, Clone, PartialEq)]
pub enum Spread {
    /// Values that are listed.
    Values(Vec<Value>),
    /// The same density everywhere.
    Uniform {
        /// Smallest value.
        low: f64,
        /// Largest value.
        high: f64,
        /// How many values a grid has, ends included.
        count: Option<usize>,
    },
    /// Normal, perhaps cut off.
    Normal {
        /// Mean (of what is not cut off).
        mean: f64,
        /// Standard deviation (of what is not cut off).
        standard_deviation: f64,
        /// Smallest value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// Triangular.
    Triangular {
        /// Smallest value.
        low: f64,
        /// Most frequent value.
        mode: f64,
        /// Largest value.
        high: f64,
    },
}

impl Spread {
    /// From the fields of an entry.
    ///
    /// # Errors
    /// The field concerned, what is wrong, and what to do.
    pub fn of(entry: &VariationEntry) -> Result<Self, Wrong> {
        let VariationEntry { values, low, high, count, mode, mean, standard_deviation, .. } = entry;
        let refusal = |field: &'static str, message: String, hint: &'static str| Wrong {
            field,
            message,
            hint,
        };
        let wrong = |field, message, hint| Err(refusal(field, message, hint));
        let given = [
            ("low", low),
            ("high", high),
            ("mode", mode),
            ("mean", mean),
            ("standard_deviation", standard_deviation),
        ];
        for (field, value) in given {
            if let Some(value) = value.filter(|value| !value.is_finite()) {
                return wrong(field, format!("{field} = {value} is not finite"), "give a number");
            }
        }
        if let (Some(low), Some(high)) = (low, high)
            && !(high - low).is_finite()
        {
            let message = format!("from low = {low} to high = {high} is no finite distance");
            return wrong("low", message, "move the ends towards each other");
        }
        let ends = |low: f64, high: f64| {
            let message = || format!("low = {low} is not below high = {high}");
            if low < high { Ok(()) } else { Err(refusal("low", message(), "exchange them")) }
        };
        if let Some(values) = values {
            let other = [low, high, mode, mean, standard_deviation].iter().any(|f| f.is_some());
            if other || count.is_some() {
                let message = "values and a distribution are two ways to say the same".to_owned();
                return wrong("values", message, "give either values, or low and high, ...");
            }
            if values.is_empty() {
                return wrong("values", "values is empty".into(), "list at least one value");
            }
            return Ok(Self::Values(values.clone()));
        }
        if let Some(count) = count {
            if *count < 2 {
                let message = format!("count = {count} has not both ends");
                return wrong("count", message, "at least 2; for one value write values = [...]");
            }
            if mean.is_some() || mode.is_some() {
                let message =
                    "count belongs to values at equal distances from low to high".to_owned();
                return wrong("count", message, "leave it out");
            }
        }
        match (mean, standard_deviation, mode, low, high) {
            (Some(mean), Some(deviation), None, low, high) => {
                if *deviation <= 0.0 {
                    let message = format!("standard_deviation = {deviation} must be positive");
                    return wrong("standard_deviation", message, "leave out what does not vary");
                }
                let low = low.unwrap_or(f64::NEG_INFINITY);
                let high = high.unwrap_or(f64::INFINITY);
                ends(low, high)?;
                let Ok(normal) = Normal::new(*mean, *deviation) else {
                    let message = format!("mean = {mean} and standard_deviation = {deviation}");
                    return wrong("mean", message, "both must be finite");
                };
                let inside = normal.cdf(high) - normal.cdf(low);
                if inside < LEAST_INSIDE {
                    let message =
                        format!("only {inside:.0e} of the distribution is between low and high");
                    return wrong("low", message, "move the ends towards the mean");
                }
                Ok(Self::Normal { mean: *mean, standard_deviation: *deviation, low, high })
            }
            (Some(_), None, ..) => {
                let message = "standard_deviation is missing beside mean".to_owned();
                wrong("mean", message, "both belong to a normal distribution")
            }
            (None, Some(_), ..) => {
                let message = "mean is missing beside standard_deviation".to_owned();
                wrong("standard_deviation", message, "both belong to a normal distribution")
            }
            (Some(_), Some(_), Some(_), ..) => {
                let message = "mean and mode belong to different distributions".to_owned();
                wrong(
                    "mode",
                    message,
                    "normal: mean, standard_deviation; triangular: low, mode, high",
                )
            }
            (None, None, Some(mode), Some(low), Some(high)) => {
                ends(*low, *high)?;
                if !(low..=high).contains(&mode) {
                    let message =
                        format!("mode = {mode} is not between low = {low} and high = {high}");
                    return wrong("mode", message, "it is the most frequent value");
                }
                Ok(Self::Triangular { low: *low, mode: *mode, high: *high })
            }
            (None, None, None, Some(low), Some(high)) => {
                ends(*low, *high)?;
                Ok(Self::Uniform { low: *low, high: *high, count: *count })
            }
            _ => wrong(
                "",
                "there are no values".into(),
                "write values = [...], low and high, mean and standard_deviation, or low, mode and high",
            ),
        }
    }

    /// How many values a grid takes; `None` where only samples can be drawn.
    pub fn count(&self) -> Option<usize> {
        match self {
            Self::Values(values) => Some(values.len()),
            Self::Uniform { count, .. } => *count,
            Self::Normal { .. } | Self::Triangular { .. } => None,
        }
    }

    /// Smallest and largest value of a distribution, as far as it has some.
    pub(crate) fn ends(&self) -> Vec<f64> {
        let ends = match *self {
            Self::Values(_) => return Vec::new(),
            Self::Uniform { low, high, .. }
            | Self::Normal { low, high, .. }
            | Self::Triangular { low, high, .. } => [low, high],
        };
        ends.into_iter().filter(|end| end.is_finite()).collect()
    }

    /// Whether all values are numbers.
    pub fn is_numeric(&self) -> bool {
        match self {
            Self::Values(values) => values.iter().all(Value::is_number),
            _ => true,
        }
    }

    /// One of the values of a grid.
    pub fn nth(&self, n: usize) -> Value {
        match self {
            Self::Values(values) => values.get(n).cloned().unwrap_or(Value::Null),
            Self::Uniform { low, high, count } => {
                let last = count.unwrap_or(2) - 1;
                // The ends are what was written.
                let value =
                    if n >= last { *high } else { low + (high - low) * n as f64 / last as f64 };
                Value::from(value)
            }
            Self::Normal { .. } | Self::Triangular { .. } => Value::Null,
        }
    }

    /// The quantile at `u` between 0 and 1.
    pub fn at(&self, u: f64) -> Value {
        let value = match *self {
            Self::Values(ref values) => {
                let n = ((u * values.len() as f64) as usize).min(values.len() - 1);
                return values[n].clone();
            }
            Self::Uniform { low, high, .. } => (low + u * (high - low)).clamp(low, high),
            Self::Normal { mean, standard_deviation, low, high } => {
                let Ok(normal) = Normal::new(mean, standard_deviation) else { return Value::Null };
                let (from, to) = (normal.cdf(low), normal.cdf(high));
                // A quantile of exactly 0 or 1 would be infinite.
                let tiny = f64::EPSILON / 2.0;
                let u = (from + u * (to - from)).clamp(tiny, 1.0 - tiny);
                normal.inverse_cdf(u).clamp(low, high)
            }
            Self::Triangular { low, mode, high } => {
                let span = high - low;
                let left = (mode - low) / span;
                if u < left {
                    low + (u * span * (mode - low)).sqrt()
                } else {
                    high - ((1.0 - u) * span * (high - mode)).sqrt()
                }
            }
        };
        Value::from(value)
    }
}

/// What is wrong with an entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wrong {
    /// The field; empty where it is the whole.
    pub field: &'static str,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub hint: &'static str,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(entry: Value) -> Result<Spread, Wrong> {
        Spread::of(&serde_json::from_value(entry).unwrap())
    }

    fn at(entry: Value, u: f64) -> f64 {
        spread(entry).unwrap().at(u).as_f64().unwrap()
    }

    use serde_json::json;

    #[test]
    fn quantiles_by_hand() {
        assert_eq!(at(json!({ "low": 2.0, "high": 4.0 }), 0.25), 2.5);
        // z(0.975) = 1.959964
        let normal = json!({ "mean": 10.0, "standard_deviation": 2.0 });
        assert!((at(normal.clone(), 0.975) - 13.919_928).abs() < 1e-6);
        assert!((at(normal.clone(), 0.5) - 10.0).abs() < 1e-12);
        assert!(at(normal.clone(), 0.0).is_finite() && at(normal, 1.0).is_finite());
        // Cut off at one standard deviation on either side: F runs from 0.1587 to 0.8413; at u = 0.25 it is 0.32933,
        // of which the quantile is z = -0.44177.
        let cut = json!({ "mean": 0.0, "standard_deviation": 1.0, "low": -1.0, "high": 1.0 });
        assert!((at(cut.clone(), 0.25) + 0.441_77).abs() < 1e-5, "{}", at(cut.clone(), 0.25));
        assert!((at(cut.clone(), 0.0) + 1.0).abs() < 1e-9 && (at(cut, 1.0) - 1.0).abs() < 1e-9);
        // F(mode) = 1/4: below, 0 + sqrt(u 4 1) = 0.5 at u = 1/16; above, 4 - sqrt((1 - u) 4 3) = 4 - sqrt(3) at 3/4.
        let triangle = json!({ "low": 0.0, "mode": 1.0, "high": 4.0 });
        assert!((at(triangle.clone(), 0.0625) - 0.5).abs() < 1e-12);
        assert!((at(triangle.clone(), 0.25) - 1.0).abs() < 1e-12);
        assert!((at(triangle, 0.75) - (4.0 - 3.0_f64.sqrt())).abs() < 1e-12);
        let listed = spread(json!({ "values": ["a", "b", "c"] })).unwrap();
        assert_eq!(
            [0.0, 0.34, 0.999, 1.0].map(|u| listed.at(u)),
            ["a", "b", "c", "c"].map(Value::from)
        );
    }

    #[test]
    fn grids_have_both_ends() {
        let grid = spread(json!({ "low": 0.1, "high": 0.3, "count": 3 })).unwrap();
        let values: Vec<f64> = (0..3).filter_map(|n| grid.nth(n).as_f64()).collect();
        assert_eq!(values, [0.1, 0.2, 0.3]);
    }

    #[test]
    fn what_makes_no_distribution_is_refused() {
        for (entry, field) in [
            (json!({}), ""),
            (json!({ "low": 1.0 }), ""),
            (json!({ "low": 2.0, "high": 1.0 }), "low"),
            (json!({ "values": [] }), "values"),
            (json!({ "values": [1.0], "low": 0.0 }), "values"),
            (json!({ "mean": 1.0 }), "mean"),
            (json!({ "mean": 1.0, "standard_deviation": 0.0 }), "standard_deviation"),
            (json!({ "mean": 0.0, "standard_deviation": 1.0, "low": 50.0 }), "low"),
            (json!({ "low": 0.0, "mode": 2.0, "high": 1.0 }), "mode"),
            (json!({ "low": 0.0, "high": 1.0, "count": 1 }), "count"),
            (json!({ "low": -1e308, "high": 1e308 }), "low"),
        ] {
            assert_eq!(spread(entry.clone()).unwrap_err().field, field, "{entry}");
        }
        // What no file can say, but a program.
        let infinite = VariationEntry { high: Some(f64::INFINITY), ..VariationEntry::default() };
        let infinite =
            VariationEntry { mean: Some(0.0), standard_deviation: Some(1.0), ..infinite };
        assert_eq!(Spread::of(&infinite).unwrap_err().field, "high");
        let none =
            VariationEntry { low: Some(0.0), mode: Some(f64::NAN), ..VariationEntry::default() };
        assert_eq!(Spread::of(&none).unwrap_err().field, "mode");
    }
}
