//! The weather: what its kind needs, and the file it comes from.

use super::{ModelReader, place};
use crate::model::WeatherSpec;
use crate::model_file::tables::separator_byte;
use crate::model_file::{Means, RunEntry, WeatherEntry, WeatherKind};
use crate::temperatures::SURROUNDINGS;
use crate::weather::{PointAt, Problem, Records, TableReading, read_epw};
use crate::wording::refused;
use anergy_core::clock::Time;
use jiff::{SignedDuration, Timestamp};
use std::sync::Arc;

impl ModelReader<'_> {
    /// The weather, where the model has one.
    pub(super) fn weather(
        &mut self,
        run: Option<&RunEntry>,
        start: Option<Timestamp>,
    ) -> Option<WeatherSpec> {
        let tree = self.tree.get("weather")?;
        let what = "[weather]";
        let (entry, table) = self.reader.read::<WeatherEntry>(what, tree)?;
        let place = place(what, tree, &table);
        let before = self.reader.problems.len();
        for (field, t_k) in [("mean_k", entry.mean_k), ("t_outdoor_k", entry.t_outdoor_k)] {
            self.check_temperature(&SURROUNDINGS, field, t_k, &place);
        }
        for (field, message) in entry.problems() {
            self.reader.report(refused(what, &place, Some(field), &message));
        }
        for (field, _) in WeatherEntry::OF_KIND {
            if place.has(field) && !entry.has(field) {
                let message = format!("{field} has no effect for this kind of weather");
                let problem = refused(what, &place, Some(field), &message);
                let hint = match (entry.kind, entry.is_epw()) {
                    (WeatherKind::File, true) => "an EPW file has its own place and time zone",
                    (WeatherKind::File, false) => {
                        "a file says what the weather is; else choose kind = \"synthetic\" or \"constant\""
                    }
                    (WeatherKind::Synthetic, _) => "it belongs to another kind than \"synthetic\"",
                    (WeatherKind::Constant, _) => "it belongs to another kind than \"constant\"",
                };
                self.reader.report(problem.with_hint(hint));
            }
        }
        if self.reader.problems.len() > before {
            return None;
        }
        if entry.kind == WeatherKind::Constant {
            return Some(WeatherSpec { entry, records: None, place });
        }
        let run = run?;
        let Some(start) = start else {
            if run.start.is_none() {
                let message = "weather needs the date on which the run begins";
                let problem = refused(what, &place, None, message);
                let hint = "write for example start = \"2024-01-17T00:00:00+01:00\" in [run]";
                self.reader.report(problem.with_hint(hint));
            }
            return None;
        };
        let records = self.records(&entry, start).and_then(|records| {
            covers(&records, &entry, start, run.until.0)?;
            Ok(records)
        });
        match records {
            Ok(records) => Some(WeatherSpec { entry, records: Some(Arc::new(records)), place }),
            Err(problem) => {
                let told = refused(what, &place, Some(problem.field), &problem.message);
                self.reader.report(match problem.hint {
                    Some(hint) => told.with_hint(hint),
                    None => told,
                });
                None
            }
        }
    }

    fn records(&self, entry: &WeatherEntry, start: Timestamp) -> Result<Records, Problem> {
        if entry.kind == WeatherKind::Synthetic {
            let year = entry.synthetic().records();
            return year.map_err(|problem| Problem::new("kind", problem.to_owned()));
        }
        let Some(name) = &entry.file else {
            let hint = "write file = \"NAME.epw\" or \"NAME.csv\", or kind = \"synthetic\"";
            return Err(Problem::new("file", "file is missing".into()).with_hint(hint));
        };
        let file = std::fs::File::open(self.dir.join(name)).map_err(|error| {
            Problem::new("file", format!("cannot read {name}: {error}"))
                .with_hint("the path is relative to the folder of the model file")
        })?;
        if entry.is_epw() {
            return read_epw(name, file);
        }
        let separator = separator_byte(entry.separator).ok_or_else(|| {
            let message = format!("separator = {:?} cannot separate numbers", entry.separator);
            Problem::new("separator", message).with_hint("usual are \",\", \";\" and \"\\t\"")
        })?;
        let reading = TableReading {
            name,
            separator,
            time_column: entry.time_column.as_deref(),
            start,
            ahead: entry.utc_offset_s.map(SignedDuration::from_secs_f64),
            point_at: match entry.means {
                Means::Before => PointAt::End,
                Means::After => PointAt::Begin,
            },
            location: entry.location(),
        };
        reading.read(file)
    }
}

/// Whether the weather lasts as long as the run.
fn covers(
    records: &Records,
    entry: &WeatherEntry,
    start: Timestamp,
    until: Time,
) -> Result<(), Problem> {
    let start_ns = i64::try_from(start.as_nanosecond()).unwrap_or(i64::MAX);
    let Some(gap_ns) = records.first_gap_ns(start_ns, start_ns.saturating_add(until.0)) else {
        return Ok(());
    };
    let words = |ns: i64| {
        Timestamp::from_nanosecond(i128::from(ns))
            .map_or_else(|_| ns.to_string(), |t| t.to_string())
    };
    let end = words(start_ns.saturating_add(until.0));
    let message = format!(
        "{} has no weather at {}; the run goes from {start} to {end}",
        entry.file.as_deref().unwrap_or("it"),
        words(gap_ns)
    );
    let hint = match records.span_ns() {
        Some((begin, end)) => format!("the file goes from {} to {}", words(begin), words(end)),
        None => "the file has only a part of the year".to_owned(),
    };
    Err(Problem::new("file", message).with_hint(hint))
}
