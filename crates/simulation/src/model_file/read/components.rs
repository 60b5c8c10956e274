//! Nodes, edges, units and controllers: dispatched on their `kind`.

use super::{ModelReader, place};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::{Tree, TreeKind};
use crate::model::{ControllerSpec, EdgeSpec, NodeSpec, UnitSpec};
use crate::model_file::expand::Plain;
use crate::model_file::{InterfaceEntry, NodeEntry, NodeEntryKind};
use anergy_control::controllers::ControllerParams;
use anergy_network::elements::{ElementParams, pipe::PipeParams};
use anergy_prosumer::equipment::EquipmentParams;
use serde_json::Value;
use std::collections::HashMap;

impl ModelReader<'_> {
    pub(super) fn node(&mut self, plain: &Plain) -> Option<NodeSpec> {
        let what = format!("node \"{}\"", plain.tree.text("id").unwrap_or("?"));
        let schema = schemars::schema_for!(NodeEntry);
        let (entry, table) =
            self.reader.read_with::<NodeEntry>(&what, &plain.tree, &schema, |value| {
                serde_path_to_error::deserialize(value)
            })?;
        let needs = match entry.kind {
            NodeEntryKind::Junction => None,
            NodeEntryKind::PressureBoundary => entry.pressure_pa.is_none().then_some("pressure_pa"),
            NodeEntryKind::Source => entry.m_flow_kg_s.is_none().then_some("m_flow_kg_s"),
        };
        if let Some(field) = needs {
            self.reader.report(Diagnostic::new(
                format!("{what}: {field} is missing"),
                plain.tree.span.clone(),
            ));
        }
        if entry.volume_m3 < 0.0 {
            self.reader.report(Diagnostic::new(
                format!("{what}: volume_m3 = {} must not be negative", entry.volume_m3),
                table.place("volume_m3"),
            ));
        }
        Some(NodeSpec { entry, site: plain.owner.clone(), place: place(&plain.tree, &table) })
    }

    pub(super) fn edge(&mut self, plain: Plain, types: &HashMap<String, Tree>) -> Option<EdgeSpec> {
        let mut tree = plain.tree;
        let id = self.required_text("edge", &mut tree, "id")?;
        let what = format!("edge \"{id}\"");
        let from = self.required_text(&what, &mut tree, "from");
        let to = self.required_text(&what, &mut tree, "to");
        let kind = self.kind(&what, &mut tree, ElementParams::KINDS)?;
        if kind == "pipe" {
            self.merge_pipe_type(&what, &mut tree, types)?;
        }
        let schema = ElementParams::schema(&kind)?;
        let (params, table) =
            self.reader.read_with(&format!("{what} ({kind})"), &tree, &schema, |value| {
                let mut track = serde_path_to_error::Track::new();
                let deserializer = serde_path_to_error::Deserializer::new(value, &mut track);
                let result = ElementParams::deserialize(&kind, deserializer);
                finish(result, track)
            })?;
        Some(EdgeSpec {
            id,
            from: from?,
            to: to?,
            params,
            loss_factor: 1.0,
            station: plain.owner,
            place: place(&tree, &table),
        })
    }

    pub(super) fn merge_pipe_type(
        &mut self,
        what: &str,
        tree: &mut Tree,
        types: &HashMap<String, Tree>,
    ) -> Option<()> {
        let Some((_, name)) = tree.take("pipe") else { return Some(()) };
        let TreeKind::Scalar(Value::String(type_name)) = &name.kind else {
            self.reader.report(Diagnostic::new(
                format!("{what}: pipe must be the name of a pipe_type"),
                name.span,
            ));
            return None;
        };
        let Some(defaults) = types.get(type_name) else {
            let mut problem = Diagnostic::new(
                format!("{what}: there is no pipe_type \"{type_name}\""),
                name.span,
            );
            if let Some(hint) = did_you_mean(type_name, types.keys().map(String::as_str)) {
                problem = problem.with_hint(hint);
            }
            self.reader.report(problem);
            return None;
        };
        // A quantity of the entry wins over the same quantity of the type, whatever its unit.
        let stem = |name: &str| {
            anergy_core::units::split_suffix(name).map_or(name.to_owned(), |(stem, _)| stem.into())
        };
        let own: Vec<String> = tree.entries().iter().map(|(key, _)| stem(&key.name)).collect();
        let mut rest = defaults.clone();
        if let TreeKind::Table(entries) = &mut rest.kind {
            entries.retain(|(key, _)| !own.contains(&stem(&key.name)));
        }
        tree.fill_from(&rest);
        Some(())
    }

    pub(super) fn pipe_types(&mut self) -> HashMap<String, Tree> {
        let Some(tree) = self.tree.get("pipe_type") else { return HashMap::new() };
        let mut types = HashMap::new();
        let mut schema = schemars::schema_for!(PipeParams);
        schema.remove("required");
        for (key, fields) in tree.entries() {
            let what = format!("pipe_type \"{}\"", key.name);
            // Only names and units: values are checked where the type is used.
            self.reader.read_with(&what, fields, &schema, |_| Ok(()));
            types.insert(key.name.clone(), fields.clone());
        }
        types
    }

    pub(super) fn units(&mut self, interfaces: &[(InterfaceEntry, Tree)]) -> Vec<UnitSpec> {
        let mut units = Vec::new();
        for mut tree in self.items("unit") {
            let span = tree.span.clone();
            let site = self.optional_text("unit", &mut tree, "site");
            let (id, port) = if let Some(site) = site {
                let name =
                    self.optional_text("unit", &mut tree, "name").unwrap_or_else(|| "unit".into());
                let station = self
                    .optional_text("unit", &mut tree, "station")
                    .unwrap_or_else(|| "station".into());
                let wanted = format!("{site}.{station}");
                let Some((interface, _)) =
                    interfaces.iter().find(|(interface, _)| interface.id == wanted)
                else {
                    self.reader.report(
                        Diagnostic::new(format!("unit: there is no station \"{wanted}\""), span)
                            .with_hint("add a [[station]] at that site, or name it with `station`"),
                    );
                    continue;
                };
                (format!("{site}.{name}"), interface.edge.clone())
            } else {
                let id = self.required_text("unit", &mut tree, "id");
                let port = self.required_text("unit", &mut tree, "port");
                let (Some(id), Some(port)) = (id, port) else { continue };
                (id, port)
            };
            let what = format!("unit \"{id}\"");
            let Some(kind) = self.kind(&what, &mut tree, EquipmentParams::KINDS) else { continue };
            let Some(schema) = EquipmentParams::schema(&kind) else { continue };
            let read =
                self.reader.read_with(&format!("{what} ({kind})"), &tree, &schema, |value| {
                    let mut track = serde_path_to_error::Track::new();
                    let deserializer = serde_path_to_error::Deserializer::new(value, &mut track);
                    let result = EquipmentParams::deserialize(&kind, deserializer);
                    finish(result, track)
                });
            if let Some((params, table)) = read {
                units.push(UnitSpec { id, port, params, place: place(&tree, &table) });
            }
        }
        units
    }

    pub(super) fn controllers(&mut self) -> Vec<ControllerSpec> {
        let mut controllers = Vec::new();
        for mut tree in self.items("controller") {
            let measures = self.required_text("controller", &mut tree, "measures");
            let acts_on = self.required_text("controller", &mut tree, "acts_on");
            let given = self.optional_text("controller", &mut tree, "id");
            let id = given
                .unwrap_or_else(|| format!("{}.controller", acts_on.as_deref().unwrap_or("?")));
            let what = format!("controller \"{id}\"");
            let Some(kind) = self.kind(&what, &mut tree, ControllerParams::KINDS) else { continue };
            let Some(schema) = ControllerParams::schema(&kind) else { continue };
            let read =
                self.reader.read_with(&format!("{what} ({kind})"), &tree, &schema, |value| {
                    let mut track = serde_path_to_error::Track::new();
                    let deserializer = serde_path_to_error::Deserializer::new(value, &mut track);
                    let result = ControllerParams::deserialize(&kind, deserializer);
                    finish(result, track)
                });
            if let (Some((params, table)), Some(measures), Some(acts_on)) =
                (read, measures, acts_on)
            {
                let place = place(&tree, &table);
                controllers.push(ControllerSpec { id, measures, acts_on, params, place });
            }
        }
        controllers
    }

    pub(super) fn kind(&mut self, what: &str, tree: &mut Tree, kinds: &[&str]) -> Option<String> {
        let span = tree.get("kind").and_then(|tree| tree.span.clone());
        let kind = self.required_text(what, tree, "kind")?;
        if kinds.contains(&kind.as_str()) {
            return Some(kind);
        }
        let hint = did_you_mean(&kind, kinds.iter().copied())
            .unwrap_or_else(|| format!("known kinds: {}", kinds.join(", ")));
        self.reader.report(
            Diagnostic::new(format!("{what}: unknown kind \"{kind}\""), span).with_hint(hint),
        );
        None
    }

    pub(super) fn optional_text(
        &mut self,
        what: &str,
        tree: &mut Tree,
        field: &str,
    ) -> Option<String> {
        let (_, value) = tree.take(field)?;
        match value.kind {
            TreeKind::Scalar(Value::String(text)) if !text.is_empty() => Some(text),
            _ => {
                let message = match value.kind {
                    TreeKind::Scalar(Value::String(_)) => format!("{what}: {field} is empty"),
                    _ => format!("{what}: {field} must be a string, not {}", value.type_name()),
                };
                self.reader.report(Diagnostic::new(message, value.span));
                None
            }
        }
    }

    pub(super) fn required_text(
        &mut self,
        what: &str,
        tree: &mut Tree,
        field: &str,
    ) -> Option<String> {
        if tree.get(field).is_none() {
            self.reader
                .report(Diagnostic::new(format!("{what}: {field} is missing"), tree.span.clone()));
            return None;
        }
        self.optional_text(what, tree, field)
    }
}

/// The result of a deserialisation with the path of the failing field.
fn finish<T>(
    result: Option<Result<T, serde_json::Error>>,
    track: serde_path_to_error::Track,
) -> Result<T, serde_path_to_error::Error<serde_json::Error>> {
    let result = result
        .unwrap_or_else(|| Err(<serde_json::Error as serde::de::Error>::custom("unknown kind")));
    result.map_err(|error| serde_path_to_error::Error::new(track.path(), error))
}
