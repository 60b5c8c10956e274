//! Nodes and edges: dispatched on their `kind`.

use super::pipe_types;
use super::{ModelReader, place};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::{Key, Scalar, Tree, TreeKind};
use crate::grammar::{Registered, Spelling};
use crate::model::{EdgeSpec, NodeSpec, Place, WrittenField};
use crate::model_file::expand::Plain;
use crate::model_file::{NodeEntry, NodeEntryKind};
use crate::wording::refused;
use anergy_network::elements::ElementParams;
use serde_json::Value;

/// An entry whose kind is not known yet: its words are taken out one by one.
pub(super) struct Words {
    /// The entry in messages.
    pub what: String,
    /// What is left of it.
    pub tree: Tree,
    /// What was taken out.
    pub taken: Vec<WrittenField>,
    /// What it was asked for.
    pub asked: Vec<&'static str>,
}

impl Words {
    pub(super) fn new(what: impl Into<String>, tree: Tree) -> Self {
        Self { what: what.into(), tree, taken: Vec::new(), asked: Vec::new() }
    }
}

impl ModelReader<'_> {
    pub(super) fn node(&mut self, plain: &Plain) -> Option<NodeSpec> {
        let what = format!("node \"{}\"", plain.tree.text("id").unwrap_or("?"));
        let (entry, mut table) = self.reader.read::<NodeEntry>(&what, &plain.tree)?;
        // What a composite says stands where it does, so nothing need be kept of it.
        table.fields.retain(|field| field.span != plain.tree.span);
        let place = place(plain.entry_or(&what), &plain.tree, &table);
        if entry.id.is_empty() {
            self.reader.report(Diagnostic::new("node: id is empty", place.of("id")));
            return None;
        }
        let word = match entry.kind {
            NodeEntryKind::Junction => "junction",
            NodeEntryKind::PressureBoundary => "pressure_boundary",
            NodeEntryKind::Source => "source",
        };
        // Field, whether it is given, the kinds that have it, whether those need it.
        let fields = [
            ("pressure_pa", entry.pressure_pa.is_some(), &["pressure_boundary"][..], true),
            ("m_flow_kg_s", entry.m_flow_kg_s.is_some(), &["source"][..], true),
            (
                "temperature_k",
                entry.temperature_k.is_some(),
                &["pressure_boundary", "source"][..],
                false,
            ),
        ];
        for (field, given, kinds, needed) in fields {
            let has = kinds.contains(&word);
            if has && needed && !given {
                self.reader.report_missing(&what, field, plain.tree.span.range());
            } else if given && !has {
                let mut hint = format!("it belongs to kind = \"{}\"", kinds.join("\" or \""));
                if field == "pressure_pa" && word == "junction" {
                    hint.push_str(", or to a [[pressure_reference]] that names the node");
                }
                let message = format!("{field} has no effect at a {word}");
                let problem = refused(&what, &place, Some(field), &message);
                self.reader.report(problem.with_hint(hint));
            }
        }
        if entry.ua_w_k < 0.0 {
            let message = format!("ua_w_k = {} must not be negative", entry.ua_w_k);
            self.reader.report(refused(&what, &place, Some("ua_w_k"), &message));
        } else if entry.ua_w_k > 0.0 && entry.volume_m3 <= 0.0 {
            let message = format!("ua_w_k = {} needs a volume that cools", entry.ua_w_k);
            let hint = "add volume_l, the water of the node";
            let problem = refused(&what, &place, Some("ua_w_k"), &message);
            self.reader.report(problem.with_hint(hint));
        }
        if entry.volume_m3 < 0.0 {
            let message = format!("volume_m3 = {} must not be negative", entry.volume_m3);
            self.reader.report(refused(&what, &place, Some("volume_m3"), &message));
        }
        Some(NodeSpec { entry, site: plain.owner.clone(), place })
    }

    pub(super) fn edge(&mut self, plain: Plain) -> Option<EdgeSpec> {
        let mut words = Words::new(plain.entry_or("edge").to_owned(), plain.tree);
        let id = self.required_text(&mut words, "id")?;
        let composite = !plain.entry.is_empty();
        if !composite {
            words.what = format!("edge \"{id}\"");
        }
        let from = self.required_text(&mut words, "from");
        let to = self.required_text(&mut words, "to");
        let kind = self.kind::<ElementParams>(&mut words)?;
        if kind == "pipe" {
            self.merge_pipe_type(&mut words)?;
        }
        if composite {
            // The program has written these words, so the user need not know them.
            words.asked.clear();
            // A composite's companions are only beside each other where it says how far apart.
            let spaced = |(key, _): &(Key, Tree)| key.name.starts_with("spacing_");
            if !words.tree.entries().iter().any(spaced) {
                words.tree.take("companion");
            }
        } else {
            words.what = format!("edge \"{id}\" ({kind})");
        }
        let (params, place) = self.parameters(words, &kind)?;
        let (from, to) = (from?, to?);
        Some(EdgeSpec {
            id: id.into(),
            from: from.into(),
            to: to.into(),
            params,
            loss_factor: 1.0,
            station: plain.owner,
            place,
        })
    }

    fn merge_pipe_type(&mut self, words: &mut Words) -> Option<()> {
        words.asked.push("pipe");
        let Some((_, name)) = words.tree.take("pipe") else { return Some(()) };
        let what = &words.what;
        let TreeKind::Scalar(Scalar::Text(type_name)) = &name.kind else {
            self.reader.report(
                Diagnostic::new(
                    format!(
                        "{what}: pipe must be the name of a pipe_type, not {}",
                        name.type_name()
                    ),
                    name.span.range(),
                )
                .with_hint("write for example pipe = \"dn20\", with a section [pipe_type.dn20]"),
            );
            return None;
        };
        let own = self.types.get(type_name.as_str()).cloned();
        let bought = || pipe_types::bought(type_name, name.span).map(Some);
        let Some(defaults) = own.or_else(bought) else {
            let hint = pipe_types::hint(type_name, &self.types);
            self.reader.report(
                Diagnostic::new(
                    format!("{what}: there is no pipe_type \"{type_name}\""),
                    name.span.range(),
                )
                .with_hint(hint),
            );
            return None;
        };
        pipe_types::fill(&mut words.tree, &defaults?);
        Some(())
    }

    /// What remains of an entry, as the parameters of its kind.
    pub(super) fn parameters<P: Registered>(
        &mut self,
        words: Words,
        kind: &str,
    ) -> Option<(P, Place)> {
        let Words { what, tree, taken, asked } = words;
        let (params, mut table) = self.reader.read_kind::<P>(&what, &tree, kind, &asked)?;
        // The words of composites stand where the entry does, so nothing need be kept of them.
        table.fields.extend(taken.into_iter().filter(|word| word.span != tree.span));
        Some((params, place(&what, &tree, &table)))
    }

    pub(super) fn kind<P: Registered>(&mut self, words: &mut Words) -> Option<String> {
        self.word_of::<P>(words, "kind")
    }

    /// The word of a registry that an entry names in a field.
    pub(super) fn word_of<P: Registered>(
        &mut self,
        words: &mut Words,
        field: &'static str,
    ) -> Option<String> {
        let span = words.tree.get(field).and_then(|tree| tree.span.range());
        let possible = format!("possible {field}s: {}", P::KINDS.join(", "));
        if words.tree.get(field).is_none() {
            let message = format!("{}: {field} is missing", words.what);
            let problem = Diagnostic::new(message, words.tree.span.range());
            self.reader.report(problem.with_hint(possible));
            return None;
        }
        let kind = self.required_text(words, field)?;
        if P::KINDS.contains(&kind.as_str()) {
            return Some(kind);
        }
        let guess = did_you_mean(&kind, P::KINDS.iter().copied());
        let hint = guess.map_or(possible.clone(), |guess| format!("{guess} {possible}"));
        let message = format!("{}: unknown {field} \"{kind}\"", words.what);
        self.reader.report(Diagnostic::new(message, span).with_hint(hint));
        None
    }

    pub(super) fn optional_text(
        &mut self,
        words: &mut Words,
        field: &'static str,
    ) -> Option<String> {
        words.asked.push(field);
        let (_, value) = words.tree.take(field)?;
        let word = WrittenField::new(Spelling::word(field), Value::Null, value.span);
        words.taken.push(word);
        let what = &words.what;
        match value.kind {
            TreeKind::Scalar(Scalar::Text(text)) if !text.is_empty() => Some(text.into()),
            _ => {
                let message = match value.kind {
                    TreeKind::Scalar(Scalar::Text(_)) => format!("{what}: {field} is empty"),
                    _ => format!("{what}: {field} must be a string, not {}", value.type_name()),
                };
                self.reader.report(Diagnostic::new(message, value.span.range()));
                None
            }
        }
    }

    pub(super) fn text_or(
        &mut self,
        words: &mut Words,
        field: &'static str,
        otherwise: &str,
    ) -> String {
        self.optional_text(words, field).unwrap_or_else(|| otherwise.to_owned())
    }

    pub(super) fn required_text(
        &mut self,
        words: &mut Words,
        field: &'static str,
    ) -> Option<String> {
        if words.tree.get(field).is_none() {
            words.asked.push(field);
            let message = format!("{}: {field} is missing", words.what);
            self.reader.report(Diagnostic::new(message, words.tree.span.range()));
            return None;
        }
        self.optional_text(words, field)
    }
}
