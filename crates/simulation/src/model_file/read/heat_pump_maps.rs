//! Performance maps of heat pumps: sections `[heat_pump_map.NAME]`, CSV tables and the database hplib.
//!
//! A map that a unit names stands in the unit's entry afterwards, in SI and whole, so that units know no files.

use super::ModelReader;
use super::components::Words;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::{Scalar, Tree, TreeKind};
use crate::grammar::Grammar;
use crate::model_file::heat_pump_map::{Problem, from_file};
use anergy_prosumer::equipment::EquipmentParams;
use anergy_prosumer::performance_map::params::PerformanceMapParams;
use serde_json::Value;
use std::collections::HashMap;

/// The maps by name, in SI; `None` for those that are reported as wrong already.
pub(super) type HeatPumpMaps = HashMap<String, Option<Value>>;

/// The fields of units that choose a map.
const FIELDS: [&str; 2] = ["map", "cooling_map"];

impl ModelReader<'_> {
    /// The maps; what is wrong with one is reported here and not where it is used.
    pub(super) fn heat_pump_maps(&mut self) -> HeatPumpMaps {
        let Some(tree) = self.tree.get("heat_pump_map") else { return HeatPumpMaps::new() };
        if !matches!(tree.kind, TreeKind::Table(_)) {
            let message =
                format!("heat_pump_map must be a table of named maps, not {}", tree.type_name());
            let hint = "write [heat_pump_map.NAME] with its fields, and map = \"NAME\" to use it";
            self.reader.report(Diagnostic::new(message, tree.span.range()).with_hint(hint));
            return HeatPumpMaps::new();
        }
        let mut maps = HeatPumpMaps::new();
        for (key, fields) in tree.entries() {
            let map = self.heat_pump_map(&format!("heat_pump_map \"{}\"", key.name), fields);
            maps.insert(key.name.to_string(), map);
        }
        maps
    }

    /// A map in SI with what its file says; `None` after a report.
    fn heat_pump_map(&mut self, what: &str, fields: &Tree) -> Option<Value> {
        let (mut map, _) = self.reader.read::<PerformanceMapParams>(what, fields)?;
        let problem = match from_file(&mut map, self.dir) {
            Err(problem) => problem,
            Ok(()) => match map.build() {
                Ok(_) => return serde_json::to_value(map).ok(),
                Err(error) => Problem { field: "", message: error.to_string(), hint: None },
            },
        };
        let place = fields.get(problem.field).unwrap_or(fields).span.range();
        let diagnostic = Diagnostic::new(format!("{what}: {}", problem.message), place);
        self.reader.report(match problem.hint {
            Some(hint) => diagnostic.with_hint(hint),
            None => diagnostic,
        });
        None
    }

    /// Puts the maps that a unit names, or gives, into its entry; `None` after a report.
    pub(super) fn place_maps(&mut self, words: &mut Words, kind: &str) -> Option<()> {
        let grammar = Grammar::of_kind::<EquipmentParams>(kind)?;
        for field in FIELDS {
            if grammar.field(field).is_none() {
                continue;
            }
            let Some((key, chosen)) = words.tree.take(field) else { continue };
            let what = format!("{}: {field}", words.what);
            let map = match &chosen.kind {
                TreeKind::Scalar(Scalar::Text(name)) => match self.maps.get(name.as_str()) {
                    Some(map) => map.clone()?,
                    None => {
                        let message = format!("{what}: there is no heat_pump_map \"{name}\"");
                        let known = self.maps.keys().map(String::as_str);
                        let hint = did_you_mean(name, known)
                            .unwrap_or_else(|| format!("add a section [heat_pump_map.{name}]"));
                        let problem = Diagnostic::new(message, chosen.span.range());
                        self.reader.report(problem.with_hint(hint));
                        return None;
                    }
                },
                TreeKind::Table(_) => self.heat_pump_map(&what, &chosen)?,
                _ => {
                    let message = format!(
                        "{what} must be the name of a heat_pump_map, not {}",
                        chosen.type_name()
                    );
                    self.reader.report(Diagnostic::new(message, chosen.span.range()));
                    return None;
                }
            };
            let map = Tree::from_json(&map, chosen.span);
            if let TreeKind::Table(entries) = &mut words.tree.kind {
                entries.push((key, map));
            }
        }
        Some(())
    }
}
