//! Schedules and series.

use super::{ModelReader, place};
use crate::diagnostic::Diagnostic;
use crate::model::DriverSpec;
use crate::model_file::{ScheduleEntry, SeriesEntry, series};
use jiff::Timestamp;
use smol_str::{SmolStr, format_smolstr};

impl ModelReader<'_> {
    pub(super) fn drivers(&mut self, start: Option<Timestamp>) -> Vec<DriverSpec> {
        let mut drivers = Vec::new();
        for tree in self.items("schedule") {
            let what = format!("schedule of \"{}\"", tree.text("signal").unwrap_or("?"));
            let read = self.reader.read::<ScheduleEntry>(&what, &tree);
            let Some((entry, table)) = read else { continue };
            let (times_s, values): (Vec<f64>, Vec<f64>) = entry.points.iter().copied().unzip();
            let span = tree.get("points").and_then(|tree| tree.span.range());
            if times_s.is_empty() {
                self.reader.report(Diagnostic::new(format!("{what} has no points"), span));
                continue;
            }
            if let Some(i) = (1..times_s.len()).find(|&i| times_s[i] <= times_s[i - 1]) {
                self.reader.report(
                    Diagnostic::new(
                        format!("{what}: time {} s is not after {} s", times_s[i], times_s[i - 1]),
                        span,
                    )
                    .with_hint("the times of a schedule must rise"),
                );
                continue;
            }
            drivers.push(DriverSpec {
                signal: entry.signal.into(),
                unit: entry.unit.map(SmolStr::from),
                interpolation: entry.interpolation,
                times_s: times_s.into(),
                values: values.into(),
                place: place(&what, &tree, &table),
                source: what.into(),
            });
        }
        let mut entries = Vec::new();
        for tree in self.items("series") {
            let what = format!("series of \"{}\"", tree.text("signal").unwrap_or("?"));
            if let Some((entry, table)) = self.reader.read::<SeriesEntry>(&what, &tree) {
                entries.push((place(&what, &tree, &table), entry, tree));
            }
        }
        let mut files = series::Files::new(self.dir, start, entries.iter().map(|entry| &entry.1));
        for (place, entry, tree) in &entries {
            match files.load(entry, tree) {
                Err(problem) => self.reader.report(problem),
                Ok((times_s, values)) => drivers.push(DriverSpec {
                    signal: entry.signal.as_str().into(),
                    unit: entry.unit.as_deref().map(SmolStr::new),
                    interpolation: entry.interpolation,
                    times_s,
                    values,
                    source: format_smolstr!(
                        "{} ({}, column {})",
                        place.entry,
                        entry.file,
                        entry.column
                    ),
                    place: place.clone(),
                }),
            }
        }
        drivers
    }
}
