//! `[[sensor]]`: what controllers see.

use super::*;
use anergy_control::sensor::SensorEntry;

impl ModelReader<'_> {
    pub(super) fn sensors(&mut self) -> Vec<SensorSpec> {
        let read = |reader: &mut Self, tree: Tree| {
            let what = format!("sensor \"{}\"", tree.text("id").unwrap_or("?"));
            let (entry, table) = reader.reader.read::<SensorEntry>(&what, &tree)?;
            let place = place(&what, &tree, &table);
            if entry.id.is_empty() {
                reader.reader.report(Diagnostic::new("sensor: id is empty", place.of("id")));
                return None;
            }
            Some(SensorSpec { entry, place })
        };
        self.items("sensor").into_iter().filter_map(|tree| read(self, tree)).collect()
    }
}
