//! Controllers: dispatched on their kind; one that names its `station` finds its channels and signals there.

use super::components::Words;
use super::{ModelReader, Stations};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::{Key, Scalar, Tree, TreeKind};
use crate::model::{ControllerSpec, UnitSpec};
use anergy_control::controllers::{ControllerParams, ports};

/// A station as a controller sees it.
struct Seen<'a> {
    /// `site.name`.
    station: &'a str,
    /// What the names of its parts begin with.
    prefix: &'a str,
    /// Hot and cold node of its site.
    lines: &'a (String, String),
    /// The unit behind it.
    unit: Option<&'a str>,
}

impl Seen<'_> {
    /// The channel or signal that a field means.
    fn meant(&self, field: &str) -> Option<String> {
        let part = |name: &str| Some(format!("{}.{name}", self.prefix));
        let unit = |name: &str| self.unit.map(|unit| format!("{unit}.{name}"));
        match field {
            "measures_heat" => Some(format!("{}.q_flow_w", self.station)),
            "measures_primary_hot" => part("exchanger_hot.t_k"),
            "measures_primary_cold" => part("branch_cold.t_k"),
            "measures_secondary_hot" => unit("t_hot_k"),
            "measures_secondary_cold" => unit("t_cold_k"),
            "measures_hot_pressure" => Some(format!("{}.p_pa", self.lines.0)),
            "measures_cold_pressure" => Some(format!("{}.p_pa", self.lines.1)),
            "acts_on_pump" => part("feed_in_pump.speed"),
            "acts_on_valve" => part("extraction_valve.kappa"),
            "acts_on_secondary" => unit("v_flow_m3_s"),
            _ => None,
        }
    }
}

impl ModelReader<'_> {
    pub(super) fn controllers(
        &mut self,
        stations: &Stations,
        units: &[UnitSpec],
    ) -> Vec<ControllerSpec> {
        let items = self.items("controller");
        items.into_iter().filter_map(|tree| self.controller(tree, stations, units)).collect()
    }

    fn controller(
        &mut self,
        tree: Tree,
        stations: &Stations,
        units: &[UnitSpec],
    ) -> Option<ControllerSpec> {
        let mut words = Words::new("controller", tree);
        let driven = ["acts_on", "id", "station"].iter().find_map(|field| words.tree.text(field));
        words.what = format!("controller \"{}\"", driven.unwrap_or("?"));
        let kind = self.kind::<ControllerParams>(&mut words)?;
        let ports = ports(&kind);
        let mut own_id = None;
        if ports.measures.iter().any(|field| field.starts_with("measures_")) {
            own_id = self.ports_of_station(&mut words, &kind, stations, units)?;
            let fields = ports.measures.iter().chain(ports.acts_on);
            if own_id.is_none() && !fields.into_iter().any(|field| words.tree.get(field).is_some())
            {
                let message = format!("{}: station is missing", words.what);
                let hint = "write station = \"SITE.station\", or name its channels and signals one by one: \
                            measures_... and acts_on_...";
                let problem = Diagnostic::new(message, words.tree.span.range());
                self.reader.report(problem.with_hint(hint));
                return None;
            }
        }
        if kind == "rule" {
            words.asked.push("acts_on");
        }
        // A rule need not act on anything: others can go by it.
        let silent = kind == "rule" && words.tree.get("acts_on").is_none();
        let mut names = |fields: &[&'static str]| -> Vec<Option<String>> {
            fields.iter().map(|field| self.required_text(&mut words, field)).collect()
        };
        let acts_on = if silent { Vec::new() } else { names(ports.acts_on) };
        let measures = names(ports.measures);
        let id = self.optional_text(&mut words, "id").or(own_id);
        let first = acts_on.iter().flatten().next().map_or("?", String::as_str);
        let id = id.unwrap_or_else(|| format!("{first}.controller"));
        words.what = format!("controller \"{id}\" ({kind})");
        if silent && id == "?.controller" {
            let problem =
                Diagnostic::new("rule: it acts on nothing and has no id", words.tree.span.range());
            let hint =
                "write acts_on = \"UNIT.modulation\", or an id by which other rules can name it";
            self.reader.report(problem.with_hint(hint));
            return None;
        }
        let (params, place) = self.parameters(words, &kind)?;
        let all = |names: Vec<Option<String>>| names.into_iter().collect::<Option<Vec<String>>>();
        let measures = match &params {
            ControllerParams::Rule(rule) => {
                rule.measures().into_iter().map(|(_, channel)| channel).collect()
            }
            _ => all(measures)?,
        };
        Some(ControllerSpec { id, measures, acts_on: all(acts_on)?, params, place })
    }

    /// Fills in the channels and signals of the station that an entry names, where it does not give them
    /// itself; its name by default. The outer `None` after a report.
    #[allow(clippy::option_option)]
    fn ports_of_station(
        &mut self,
        words: &mut Words,
        kind: &str,
        stations: &Stations,
        units: &[UnitSpec],
    ) -> Option<Option<String>> {
        let span = words.tree.get("station").map_or(words.tree.span, |tree| tree.span);
        let Some(station) = self.optional_text(words, "station") else { return Some(None) };
        let what = words.what.clone();
        let Some(edge) = stations.edges.get(&station) else {
            if !stations.wrong.contains(&station) {
                let message = format!("{what}: there is no station \"{station}\"");
                let known = stations.edges.keys().map(String::as_str);
                let hint = did_you_mean(&station, known).unwrap_or_else(|| {
                    "a station is named as \"SITE.station\", or \"SITE.NAME\" if it has a name"
                        .into()
                });
                self.reader.report(Diagnostic::new(message, span.range()).with_hint(hint));
            }
            return None;
        };
        let parts = (edge.strip_suffix(".heat_exchanger"), stations.lines.get(&station));
        let (Some(prefix), Some(lines)) = parts else {
            let message = format!("{what}: station \"{station}\" has no parts to be controlled");
            let hint = "a bidirectional station, a producer or a consumer has; otherwise name the \
                        channels and signals one by one";
            self.reader.report(Diagnostic::new(message, span.range()).with_hint(hint));
            return None;
        };
        let unit = units.iter().find(|unit| unit.port == *edge).map(|unit| unit.id.as_str());
        let seen = Seen { station: &station, prefix, lines, unit };
        let ports = ports(kind);
        for field in ports.measures.iter().chain(ports.acts_on) {
            if words.tree.get(field).is_none()
                && let Some(name) = seen.meant(field)
                && let TreeKind::Table(entries) = &mut words.tree.kind
            {
                let value = Tree { span, kind: TreeKind::Scalar(Scalar::Text(name.into())) };
                let key = Key { name: (*field).into(), span };
                entries.push((key, value));
            }
        }
        Some(Some(format!("{prefix}.controller")))
    }
}
