//! What cannot be of the station of a prosumer: what it says must fit together, and no part is left unused.

use super::prosumer_station::{Directions, Extraction, FlowControl, Hydraulics, ProsumerEntry};
use serde_json::Value;

impl ProsumerEntry {
    /// Fields that cannot be, with what is wrong and a hint.
    pub(super) fn problems(&self) -> Vec<(&'static str, String, &'static str)> {
        let mut problems = Vec::new();
        for (field, value) in [("gain", self.gain), ("integral_time_s", self.integral_time_s)] {
            if !(value.is_finite() && value > 0.0) {
                let message = format!("{field} = {value} must be positive");
                problems.push((field, message, "0.6 per kg/s and 8 s suit most pumps"));
            }
        }
        if !(self.dead_time_s.is_finite() && self.dead_time_s >= 0.0) {
            let message = format!("dead_time_s = {} must not be negative", self.dead_time_s);
            problems.push(("dead_time_s", message, "5 s suit most pumps"));
        }
        if self.directions == Directions::FeedIn && self.extraction == Extraction::Valve {
            let message = "a valve for extraction, but only feed-in".to_owned();
            problems.push(("extraction", message, "leave one of the two out"));
        }
        let one_pump = self.hydraulics == Hydraulics::OnePump;
        if one_pump && (self.directions != Directions::Both || self.extraction == Extraction::Valve)
        {
            let message = "one pump is for both directions, without an extraction valve".to_owned();
            problems.push(("hydraulics", message, "leave `directions` and `extraction` out"));
        }
        let ideal = self.flow_control == Some(FlowControl::Ideal);
        if ideal && (one_pump || self.extraction == Extraction::Valve) {
            let field = if one_pump { "hydraulics" } else { "extraction" };
            let message = "an ideal flow needs neither pumps nor valves".to_owned();
            problems.push((
                field,
                message,
                "take one of the two out: this, or flow_control = \"ideal\"",
            ));
        }
        if let Some(part) = self.strange_part() {
            let of_one_pump = ["pump", "check_valve", "way"].contains(&part);
            let (message, hint) = if ideal {
                (format!("with an ideal flow there is no {part}"), "its parts are stub, interface")
            } else if one_pump {
                (
                    format!("with one pump there is no {part}"),
                    "its parts are pump, check_valve, way",
                )
            } else if of_one_pump {
                (
                    format!("with a pump for each direction there is no {part}"),
                    "hydraulics = \"one_pump\" has it",
                )
            } else {
                (
                    format!("with these directions and this extraction there is no {part}"),
                    "see `directions` and `extraction`",
                )
            };
            problems.push((part, message, hint));
        }
        problems
    }

    /// A part that is given though the station does not have it.
    fn strange_part(&self) -> Option<&'static str> {
        let one_pump = self.hydraulics == Hydraulics::OnePump;
        let by_valve = self.extraction == Extraction::Valve;
        let feeds_in = !one_pump && self.directions != Directions::Extraction;
        let extracts = !one_pump && self.directions != Directions::FeedIn;
        let ideal = self.flow_control == Some(FlowControl::Ideal);
        let parts = [
            ("feed_in_pump", &self.feed_in_pump, feeds_in),
            ("feed_in_check_valve", &self.feed_in_check_valve, feeds_in),
            ("extraction_pump", &self.extraction_pump, extracts && !by_valve),
            ("extraction_check_valve", &self.extraction_check_valve, extracts && !by_valve),
            ("extraction_valve", &self.extraction_valve, extracts && by_valve),
            ("shut_off", &self.shut_off, !one_pump && !by_valve),
            ("pump", &self.pump, one_pump),
            ("check_valve", &self.check_valve, one_pump),
            ("way", &self.way, one_pump),
        ];
        let strange = |(_, given, has): &(&str, &Value, bool)| !given.is_null() && (ideal || !has);
        parts.into_iter().find(strange).map(|(part, ..)| part)
    }
}
