//! The columns that a table of nodes or pipes can have, and what an unknown one was meant to be.

use super::{Content, example};
use crate::diagnostic::did_you_mean;
use crate::grammar::Grammar;
use crate::model_file::expand::{PARTS, part_kind};
use crate::model_file::{SiteEntry, StationEntry};
use anergy_network::elements::{ElementParams, pipe::PipeParams};
use anergy_prosumer::equipment::EquipmentParams;

/// Whether a column is a field of a site.
pub(super) fn is_site_field(field: &str) -> bool {
    field != "lines" && Grammar::of::<SiteEntry>().field(field).is_some()
}

/// Whether a table can have a column.
pub(super) fn known(content: Content, part: Option<&str>, field: &str) -> bool {
    match (content, part) {
        (Content::Pipes, None) => {
            ["id", "from", "to", "pipe"].contains(&field)
                || Grammar::of::<PipeParams>().field(field).is_some()
        }
        (Content::Pipes, Some(_)) => false,
        (Content::Nodes, None) => {
            field == "station" || is_site_field(field) || {
                let grammar = Grammar::of::<StationEntry>();
                grammar.field(field).is_some_and(|(si, _)| si == "requested_flow_m3_s")
            }
        }
        (Content::Nodes, Some("unit")) => {
            field == "kind"
                || EquipmentParams::KINDS.iter().any(|kind| {
                    let grammar = Grammar::of_kind::<EquipmentParams>(kind);
                    grammar.is_some_and(|grammar| grammar.field(field).is_some())
                })
        }
        (Content::Nodes, Some(part)) => part_kind(part).is_some_and(|kind| {
            (kind == "pipe" && field == "pipe")
                || Grammar::of_kind::<ElementParams>(kind)
                    .is_some_and(|grammar| grammar.field(field).is_some())
        }),
    }
}

/// What an unknown column was probably meant to be.
pub(super) fn guess(content: Content, name: &str) -> String {
    let mut candidates: Vec<String> = Vec::new();
    let mut add = |prefix: &str, grammar: &Grammar| {
        for field in &grammar.fields {
            let spelled = Grammar::spellings(field);
            candidates.extend(spelled.into_iter().map(|name| format!("{prefix}{name}")));
        }
    };
    match content {
        Content::Pipes => add("", &Grammar::of::<PipeParams>()),
        Content::Nodes => {
            add("", &Grammar::of::<SiteEntry>());
            for kind in EquipmentParams::KINDS {
                if let Some(grammar) = Grammar::of_kind::<EquipmentParams>(kind) {
                    add("unit.", &grammar);
                }
            }
            for (part, _) in PARTS {
                let grammar = part_kind(part).and_then(Grammar::of_kind::<ElementParams>);
                if let Some(grammar) = grammar {
                    add(&format!("{part}."), &grammar);
                }
            }
        }
    }
    candidates.retain(|name| name != "lines");
    let own: &[&str] = match content {
        Content::Nodes => &["station", "requested_flow_l_min"],
        Content::Pipes => &["id", "from", "to", "pipe"],
    };
    candidates.extend(own.iter().map(|name| (*name).to_owned()));
    // The field of a part or of the unit, without the way to it.
    let mut ways: Vec<&str> = Vec::new();
    let known = candidates
        .iter()
        .filter(|known| known.rsplit_once('.').is_some_and(|(_, field)| field == name))
        .map(String::as_str);
    for way in known {
        // Several kinds of units have the field.
        if !ways.contains(&way) {
            ways.push(way);
        }
    }
    if !ways.is_empty() {
        return format!("say of what: {}", ways.join(" or "));
    }
    let (part, field) = name.split_once('.').unwrap_or(("", name));
    let grammar = match (content, part) {
        (Content::Pipes, "") => Some(Grammar::of::<PipeParams>()),
        (Content::Nodes, "") => Some(Grammar::of::<SiteEntry>()),
        _ => part_kind(part).and_then(Grammar::of_kind::<ElementParams>),
    };
    if let Some(meant) = grammar.as_ref().and_then(|grammar| grammar.same_quantity(field)) {
        let start = if part.is_empty() { String::new() } else { format!("{part}.") };
        let possible = Grammar::spellings(meant).into_iter().map(|name| format!("{start}{name}"));
        return format!("possible are {}", possible.collect::<Vec<_>>().join(", "));
    }
    did_you_mean(name, candidates.iter().map(String::as_str)).unwrap_or_else(|| {
        format!("columns are named like fields with their unit: {}", example(content))
    })
}
