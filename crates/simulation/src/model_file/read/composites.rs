//! Sites, trenches and stations.

use super::components::Words;
use super::{ModelReader, Stations, place};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::{Tree, TreeKind};
use crate::model::{InterfaceSpec, Place};
use crate::model_file::expand;
use crate::model_file::{
    BalancingUnitEntry, InterfaceEntry, ProsumerEntry, SiteEntry, StationEntry, StationKind,
};
use crate::wording::refused;
use std::collections::HashSet;

impl Stations {
    /// Notes a station; `None` when there is one of its name, which is reported.
    pub(super) fn add(
        &mut self,
        reader: &mut ModelReader<'_>,
        interface: &InterfaceEntry,
        what: &str,
        tree: &Tree,
    ) -> Option<()> {
        if self.edges.insert(interface.id.clone(), interface.edge.clone()).is_none() {
            return Some(());
        }
        let problem = Diagnostic::new(format!("{what} exists twice"), tree.span.range());
        reader.reader.report(problem.with_hint("give one of them a `name`"));
        None
    }
}

impl ModelReader<'_> {
    pub(super) fn read_sites(&mut self) {
        for tree in self.items("site") {
            let what = format!("site \"{}\"", tree.text("id").unwrap_or("?"));
            let site = self.reader.read::<SiteEntry>(&what, &tree);
            let Some((site, _)) = site else {
                self.wrong_sites.extend(tree.text("id").map(str::to_owned));
                continue;
            };
            let at = |field: &str| tree.get(field).and_then(|tree| tree.span.range());
            let mut wrong = |message: String, field: &str, hint: &str| {
                self.reader.report(Diagnostic::new(message, at(field)).with_hint(hint));
            };
            if site.id.is_empty() {
                wrong("site: id is empty".into(), "id", "give it a name");
                continue;
            }
            if site.lines.is_empty() {
                wrong(
                    format!("{what} has no lines"),
                    "lines",
                    "the default is [\"hot\", \"cold\"]",
                );
                self.wrong_sites.insert(site.id);
                continue;
            }
            if site.lines.iter().any(String::is_empty) {
                wrong(
                    format!("{what} has a line without name"),
                    "lines",
                    "a line is a node ID.LINE",
                );
                self.wrong_sites.insert(site.id);
                continue;
            }
            let mut seen = HashSet::new();
            if let Some(line) = site.lines.iter().find(|line| !seen.insert(line.as_str())) {
                let message = format!("{what} has the line \"{line}\" twice");
                wrong(message, "lines", "a line is a node of the site: each needs its own name");
                self.wrong_sites.insert(site.id);
                continue;
            }
            if self.sites.contains_key(&site.id) {
                wrong(format!("{what} exists twice"), "id", "give one of them another id");
                continue;
            }
            self.add_nodes(expand::site_nodes(&site, tree.span));
            self.sites.insert(site.id.clone(), site);
        }
    }

    /// The site that a field of an entry names.
    fn site(&mut self, what: &str, tree: &Tree, field: &str) -> Option<SiteEntry> {
        let name = tree.text(field)?;
        let found = self.sites.get(name).cloned();
        if found.is_none() && !self.wrong_sites.contains(name) && !self.sites_unread {
            let span = tree.get(field).and_then(|tree| tree.span.range());
            let problem = Diagnostic::new(format!("{what}: there is no site \"{name}\""), span);
            let hint = did_you_mean(name, self.sites.keys().map(String::as_str))
                .unwrap_or_else(|| format!("add a [[site]] with id = \"{name}\""));
            self.reader.report(problem.with_hint(hint));
        }
        found
    }

    pub(super) fn trenches(&mut self) {
        let mut known = HashSet::new();
        for tree in self.items("trench") {
            let mut words = Words::new("trench", tree.clone());
            let mut ends = [None, None];
            for (field, end) in ["from", "to"].into_iter().zip(&mut ends) {
                if tree.get(field).is_some() {
                    *end = self.optional_text(&mut words, field);
                } else {
                    self.reader.report(
                        Diagnostic::new(format!("trench: {field} is missing"), tree.span.range())
                            .with_hint("name the sites at its two ends"),
                    );
                }
            }
            let given = self.optional_text(&mut words, "id");
            let ([Some(from), Some(to)], mut fields) = (ends, words.tree) else { continue };
            let id = given.unwrap_or_else(|| format!("{from}-{to}"));
            let what = format!("trench \"{id}\"");
            let (from, to) = (self.site(&what, &tree, "from"), self.site(&what, &tree, "to"));
            let (Some(from), Some(to)) = (from, to) else { continue };
            let at = |field: &str| {
                let field = tree.get(field).and_then(|tree| tree.span.range());
                field.or_else(|| tree.span.range())
            };
            let mut wrong = |message: String, field: &str, hint: &str| {
                self.reader.report(Diagnostic::new(message, at(field)).with_hint(hint));
            };
            if from.id == to.id {
                let message = format!("{what} begins and ends at \"{}\"", from.id);
                wrong(message, "to", "a trench joins two sites");
                continue;
            }
            if !known.insert(id.clone()) {
                wrong(format!("{what} exists twice"), "id", "give one of them another id");
                continue;
            }
            let own = [
                ("kind", "a trench is always of pipes"),
                ("companion", "its two lines are companions where they have a spacing_m"),
                ("companion_reversed", "the two lines of a trench run alike"),
            ];
            let strange =
                own.into_iter().find_map(|(field, hint)| Some((fields.take(field)?.0, hint)));
            if let Some((key, hint)) = strange {
                let message = format!("{what}: unknown field `{}`", key.name);
                self.reader.report(Diagnostic::new(message, key.span.range()).with_hint(hint));
                continue;
            }
            let pipes = expand::trench_pipes(&id, (&from, &to), &fields);
            if pipes.is_empty() {
                let message =
                    format!("{what}: sites \"{}\" and \"{}\" share no line", from.id, to.id);
                let hint = format!(
                    "their lines are {} and {}",
                    from.lines.join(", "),
                    to.lines.join(", ")
                );
                wrong(message, "", &hint);
            }
            self.add_edges(pipes);
        }
    }

    pub(super) fn stations(&mut self, interfaces: &mut Vec<InterfaceSpec>) -> Stations {
        let mut stations = Stations::default();
        for tree in self.items("station") {
            let (site, name) = (tree.text("site"), tree.text("name").unwrap_or("station"));
            let id = format!("{}.{name}", site.unwrap_or("?"));
            let whole = self.typed_station(tree);
            let read = whole.and_then(|tree| self.station(&tree, &mut stations, interfaces));
            if read.is_none() {
                stations.wrong.insert(id);
            }
        }
        stations
    }

    /// Expands a station; `None` after a report.
    fn station(
        &mut self,
        tree: &Tree,
        stations: &mut Stations,
        interfaces: &mut Vec<InterfaceSpec>,
    ) -> Option<()> {
        let what = expand::station_in_words(tree);
        if tree.text("kind") == Some("plant") {
            return self.plant(tree, &what, stations, interfaces);
        }
        if let Some("prosumer" | "balancing_unit") = tree.text("kind") {
            return self.in_grid_water(tree, &what, stations, interfaces);
        }
        let (entry, table) = self.reader.read::<StationEntry>(&what, tree)?;
        let site = self.site_with_two_lines(&what, tree)?;
        self.check_parts(&what, entry.kind, tree)?;
        let place = place(&what, tree, &table);
        let (nodes, edges, interface) = expand::station(&entry, &site, tree);
        if stations.add(self, &interface, &what, tree).is_none() {
            return Some(());
        }
        let line = |i: usize| format!("{}.{}", site.id, site.lines[i]);
        let lines = (line(0), line(1));
        if matches!(entry.kind, StationKind::Consumer | StationKind::PrescribedFlow) {
            stations.consumers.push((interface.id.clone(), lines.clone()));
        }
        stations.lines.insert(interface.id.clone(), lines);
        self.add_nodes(nodes);
        self.add_edges(edges);
        interfaces.push(InterfaceSpec { entry: interface, place });
        Some(())
    }

    /// Expands a station in which the water of the grid passes the unit; `None` after a report.
    fn in_grid_water(
        &mut self,
        tree: &Tree,
        what: &str,
        stations: &mut Stations,
        interfaces: &mut Vec<InterfaceSpec>,
    ) -> Option<()> {
        let (expanded, kind, place) = if tree.text("kind") == Some("prosumer") {
            let (entry, table) = self.reader.read::<ProsumerEntry>(what, tree)?;
            let site = self.site_with_two_lines(what, tree)?;
            let place = place(what, tree, &table);
            self.report_all(what, &place, &entry.problems())?;
            (entry.expand(&site, tree, what, self.longest_step_s), StationKind::Prosumer, place)
        } else {
            let (entry, table) = self.reader.read::<BalancingUnitEntry>(what, tree)?;
            let site = self.site_with_two_lines(what, tree)?;
            let place = place(what, tree, &table);
            self.report_all(what, &place, &entry.problems(self.longest_step_s))?;
            (entry.expand(&site, tree, what), StationKind::BalancingUnit, place)
        };
        self.check_parts(what, kind, tree)?;
        stations.add(self, &expanded.interface, what, tree)?;
        self.add_nodes(expanded.nodes);
        self.add_edges(expanded.edges);
        self.rows.entry("controller").or_default().extend(expanded.controllers);
        self.rows.entry("sensor").or_default().extend(expanded.sensors);
        interfaces.push(InterfaceSpec { entry: expanded.interface, place });
        Some(())
    }

    /// Reports what cannot be of a station; `None` where there is something.
    fn report_all(
        &mut self,
        what: &str,
        place: &Place,
        problems: &[(&'static str, String, &'static str)],
    ) -> Option<()> {
        for (field, message, hint) in problems {
            let problem = refused(what, place, Some(field), message);
            self.reader.report(problem.with_hint(*hint));
        }
        problems.is_empty().then_some(())
    }

    /// The site of a station.
    pub(super) fn site_with_two_lines(&mut self, what: &str, tree: &Tree) -> Option<SiteEntry> {
        let site = self.site(what, tree, "site")?;
        if site.lines.len() < 2 {
            let message = format!("{what}: a station needs a site with two lines");
            let hint = format!("site \"{}\" has only {}", site.id, site.lines.join(", "));
            self.reader.report(Diagnostic::new(message, tree.span.range()).with_hint(hint));
            return None;
        }
        Some(site)
    }

    /// Every part is a table, and one that the kind of station has.
    pub(super) fn check_parts(&mut self, what: &str, kind: StationKind, tree: &Tree) -> Option<()> {
        let before = self.reader.problems.len();
        let (all, own) = (expand::PARTS, expand::parts_of(kind));
        for (part, example) in all {
            let Some((key, value)) = tree.entries().iter().find(|(key, _)| key.name == *part)
            else {
                continue;
            };
            let kind = tree.text("kind").unwrap_or_default();
            if !own.contains(part) {
                let hint = if own.is_empty() {
                    format!("a {kind} has no parts: its flow is what its unit asks for")
                } else {
                    format!("the parts of a {kind} are {}", own.join(", "))
                };
                let message = format!("{what}: a {kind} has no {part}");
                self.reader.report(Diagnostic::new(message, key.span.range()).with_hint(hint));
            } else if !matches!(value.kind, TreeKind::Table(_)) {
                let message = format!("{what}: {part} must be a table, not {}", value.type_name());
                let hint = match (*part, tree.text(part)) {
                    ("stub", Some(name)) => format!("write stub = {{ pipe = \"{name}\" }}"),
                    _ => format!("write for example {part} = {example}"),
                };
                self.reader.report(Diagnostic::new(message, value.span.range()).with_hint(hint));
            }
            for (key, _) in value.entries() {
                if ["id", "kind", "from", "to"].contains(&key.name.as_str()) {
                    let message = format!("{what}, {part}: unknown field `{}`", key.name);
                    let hint = "the station says what its parts are and what they join";
                    let problem = Diagnostic::new(message, key.span.range());
                    self.reader.report(problem.with_hint(hint));
                }
            }
        }
        (self.reader.problems.len() == before).then_some(())
    }
}
