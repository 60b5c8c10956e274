//! Sites, trenches and stations.

use super::ModelReader;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::Tree;
use crate::model_file::expand::{self, Plain};
use crate::model_file::{InterfaceEntry, SiteEntry, StationEntry};

impl ModelReader<'_> {
    pub(super) fn sites(&mut self, nodes: &mut Vec<Plain>) {
        for tree in self.items("site") {
            let Some(site) = self.reader.read::<SiteEntry>("site", &tree) else { continue };
            if site.lines.is_empty() {
                let span = tree.get("lines").and_then(|tree| tree.span.clone());
                self.reader
                    .report(Diagnostic::new(format!("site \"{}\" has no lines", site.id), span));
                continue;
            }
            if self.sites.contains_key(&site.id) {
                let span = tree.get("id").and_then(|tree| tree.span.clone());
                self.reader
                    .report(Diagnostic::new(format!("site \"{}\" exists twice", site.id), span));
                continue;
            }
            nodes.extend(expand::site_nodes(&site, tree.span.as_ref()));
            self.sites.insert(site.id.clone(), site);
        }
    }

    /// The site that a field of an entry names.
    pub(super) fn site(&mut self, what: &str, tree: &Tree, field: &str) -> Option<SiteEntry> {
        let name = tree.text(field)?;
        let found = self.sites.get(name).cloned();
        if found.is_none() {
            let span = tree.get(field).and_then(|tree| tree.span.clone());
            let mut problem = Diagnostic::new(format!("{what}: there is no site \"{name}\""), span);
            if let Some(hint) = did_you_mean(name, self.sites.keys().map(String::as_str)) {
                problem = problem.with_hint(hint);
            }
            self.reader.report(problem);
        }
        found
    }

    pub(super) fn trenches(&mut self, edges: &mut Vec<Plain>) {
        for tree in self.items("trench") {
            let mut fields = tree.clone();
            let id = self.optional_text("trench", &mut fields, "id");
            let ends = (tree.text("from").is_some(), tree.text("to").is_some());
            for (field, given) in [("from", ends.0), ("to", ends.1)] {
                if !given {
                    self.reader.report(
                        Diagnostic::new(format!("trench: {field} is missing"), tree.span.clone())
                            .with_hint("name the sites at its two ends"),
                    );
                }
            }
            let (from, to) = (self.site("trench", &tree, "from"), self.site("trench", &tree, "to"));
            let (Some(from), Some(to)) = (from, to) else { continue };
            fields.take("from");
            fields.take("to");
            let id = id.unwrap_or_else(|| format!("{}-{}", from.id, to.id));
            let pipes = expand::trench_pipes(&id, (&from, &to), &fields);
            if pipes.is_empty() {
                self.reader.report(Diagnostic::new(
                    format!(
                        "trench \"{id}\": sites \"{}\" and \"{}\" share no line",
                        from.id, to.id
                    ),
                    tree.span.clone(),
                ));
            }
            edges.extend(pipes);
        }
    }

    pub(super) fn stations(
        &mut self,
        nodes: &mut Vec<Plain>,
        edges: &mut Vec<Plain>,
        interfaces: &mut Vec<(InterfaceEntry, Tree)>,
    ) {
        for tree in self.items("station") {
            let what = format!("station at \"{}\"", tree.text("site").unwrap_or("?"));
            let Some(entry) = self.reader.read::<StationEntry>(&what, &tree) else { continue };
            let Some(site) = self.site(&what, &tree, "site") else { continue };
            if site.lines.len() < 2 {
                self.reader.report(Diagnostic::new(
                    format!("{what}: a station needs a site with two lines"),
                    tree.span.clone(),
                ));
                continue;
            }
            let (more_nodes, more_edges, interface) = expand::station(&entry, &site, &tree);
            nodes.extend(more_nodes);
            edges.extend(more_edges);
            interfaces.push((interface, tree));
        }
    }
}
