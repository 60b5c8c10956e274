//! The ground: what its kind needs, and numbers it can have.

use super::ModelReader;
use crate::model::Place;
use crate::model_file::{GroundEntry, GroundKind, RunEntry};
use crate::temperatures::SURROUNDINGS;
use crate::wording::refused;

impl ModelReader<'_> {
    pub(super) fn check_ground(
        &mut self,
        ground: &GroundEntry,
        place: &Place,
        run: Option<&RunEntry>,
    ) {
        for (field, t_k) in [("temperature_k", ground.temperature_k), ("mean_k", ground.mean_k)] {
            self.check_temperature(&SURROUNDINGS, field, t_k, place);
        }
        for (field, message) in ground.problems() {
            self.reader.report(refused("[ground]", place, Some(field), &message));
        }
        for (field, kind) in GroundEntry::OF_KIND {
            if place.has(field) && *kind != ground.kind {
                let word = if *kind == GroundKind::Kusuda { "kusuda" } else { "constant" };
                let message = format!("{field} has no effect for this kind of ground");
                let problem = refused("[ground]", place, Some(field), &message);
                self.reader.report(problem.with_hint(format!("it belongs to kind = \"{word}\"")));
            }
        }
        if ground.kind == GroundKind::Kusuda && run.is_some_and(|run| run.start.is_none()) {
            let message = "ground that follows the year needs the day of the year";
            let problem = refused("[ground]", place, Some("kind"), message);
            let hint = "write for example start = \"2024-01-17T00:00:00+01:00\" in [run]";
            self.reader.report(problem.with_hint(hint));
        }
    }
}
