//! From a document to a model: every entry is read alone, all problems are collected.

mod components;
mod composites;

use super::expand::Plain;
use super::*;
use crate::diagnostic::{Diagnostic, Diagnostics, did_you_mean};
use crate::document::{Tree, TreeKind};
use crate::fields::{Reader, SiTable};
use crate::model::*;
use anergy_core::medium::Medium;
use jiff::Timestamp;
use std::collections::HashMap;
use std::path::Path;

/// The sections of a model file.
pub(super) const SECTIONS: &[&str] = &[
    "format",
    "model",
    "run",
    "fluid",
    "ground",
    "pipe_type",
    "site",
    "trench",
    "station",
    "node",
    "edge",
    "interface",
    "unit",
    "controller",
    "schedule",
    "series",
    "pressure_reference",
];

/// Reads a whole document.
///
/// # Errors
/// All problems found.
pub fn model(tree: &Tree, text: &str, dir: &Path) -> Result<Model, Diagnostics> {
    let mut reader = ModelReader { reader: Reader::default(), tree, dir, sites: HashMap::new() };
    let model = reader.model(text);
    let mut problems = reader.reader.problems;
    // One place can be read twice (both pipes of a trench): the first report is enough.
    let mut seen = Vec::new();
    problems.retain(|problem| {
        let key = (problem.span.clone(), problem.hint.clone());
        let fresh = problem.span.is_none() || !seen.contains(&key);
        seen.push(key);
        fresh
    });
    match model {
        Some(model) if problems.is_empty() => Ok(model),
        _ => Err(Diagnostics(problems)),
    }
}

struct ModelReader<'a> {
    reader: Reader,
    tree: &'a Tree,
    dir: &'a Path,
    sites: HashMap<String, SiteEntry>,
}

impl ModelReader<'_> {
    fn model(&mut self, text: &str) -> Option<Model> {
        self.check_sections();
        let about: Option<ModelEntry> = self.single("model");
        let run: Option<RunEntry> = self.single("run");
        let fluid: Option<FluidEntry> = self.single("fluid");
        let ground: Option<GroundEntry> = self.single("ground");
        let start = run.as_ref().and_then(|run| self.start(run));
        self.check_run(run.as_ref(), ground.as_ref());
        let medium = fluid.as_ref().and_then(|fluid| self.medium(fluid));
        let (mut nodes, mut edges) = (Vec::new(), Vec::new());
        let mut interfaces = Vec::new();
        self.sites(&mut nodes);
        self.trenches(&mut edges);
        self.stations(&mut nodes, &mut edges, &mut interfaces);
        let plain = |tree: &Tree| Plain { tree: tree.clone(), owner: String::new() };
        nodes.extend(self.items("node").iter().map(plain));
        edges.extend(self.items("edge").iter().map(plain));
        let types = self.pipe_types();
        let nodes = nodes.iter().filter_map(|node| self.node(node)).collect();
        let edges = edges.into_iter().filter_map(|edge| self.edge(edge, &types)).collect();
        for tree in self.items("interface") {
            if let Some(entry) = self.reader.read::<InterfaceEntry>("interface", &tree) {
                interfaces.push((entry, tree));
            }
        }
        let model = Model {
            text: text.to_owned(),
            units: self.units(&interfaces),
            interfaces: interfaces
                .into_iter()
                .map(|(entry, tree)| InterfaceSpec {
                    id: entry.id,
                    edge: entry.edge,
                    pump: entry.pump,
                    valve: entry.valve,
                    requested_flow_m3_s: entry.requested_flow_m3_s,
                    place: Place { span: tree.span, fields: Vec::new() },
                })
                .collect(),
            controllers: self.controllers(),
            drivers: self.drivers(start),
            references: self.references(),
            name: about.as_ref()?.name.clone(),
            gravity_m_s2: about?.gravity,
            run: run?,
            medium: medium?,
            ground_k: ground?.temperature_k,
            nodes,
            edges,
        };
        Some(model)
    }

    fn check_sections(&mut self) {
        for (key, _) in self.tree.entries() {
            if !SECTIONS.contains(&key.name.as_str()) {
                let hint = did_you_mean(&key.name, SECTIONS.iter().copied())
                    .unwrap_or_else(|| format!("known sections: {}", SECTIONS.join(", ")));
                self.reader.report(
                    Diagnostic::new(format!("unknown section `{}`", key.name), key.span.clone())
                        .with_hint(hint),
                );
            }
        }
        match self.tree.get("format").map(|tree| (tree.to_json(), tree.span.clone())) {
            Some((value, _)) if value == 1 => {}
            Some((value, span)) => self.reader.report(
                Diagnostic::new(format!("format = {value} is not known"), span)
                    .with_hint("this program reads format = 1"),
            ),
            None => self.reader.report(
                Diagnostic::new("the model does not say its format", None)
                    .with_hint("write `format = 1` in the first line"),
            ),
        }
    }

    /// A section that occurs once; absent means all defaults.
    fn single<T: serde::de::DeserializeOwned + JsonSchema>(&mut self, section: &str) -> Option<T> {
        let empty = Tree { span: None, kind: TreeKind::Table(Vec::new()) };
        let tree = self.tree.get(section).unwrap_or(&empty);
        self.reader.read(&format!("[{section}]"), tree)
    }

    /// The entries of a section that can occur several times.
    fn items(&mut self, section: &str) -> Vec<Tree> {
        match self.tree.get(section) {
            None => Vec::new(),
            Some(tree) => match &tree.kind {
                TreeKind::Array(items) => items.clone(),
                _ => {
                    self.reader.report(
                        Diagnostic::new(
                            format!("`{section}` can occur several times"),
                            tree.span.clone(),
                        )
                        .with_hint(format!("write [[{section}]] with double brackets")),
                    );
                    Vec::new()
                }
            },
        }
    }

    fn place_of(&self, section: &str, field: &str) -> Option<std::ops::Range<usize>> {
        self.tree.get(section).and_then(|tree| tree.get(field)).and_then(|tree| tree.span.clone())
    }

    fn start(&mut self, run: &RunEntry) -> Option<Timestamp> {
        let text = run.start.as_ref()?;
        match text.parse::<Timestamp>() {
            Ok(start) => Some(start),
            Err(_) => {
                let span = self.place_of("run", "start");
                self.reader.report(
                    Diagnostic::new(
                        format!("[run]: start = \"{text}\" is not a point in time"),
                        span,
                    )
                    .with_hint("write for example \"2024-01-17T00:00:00+01:00\""),
                );
                None
            }
        }
    }

    fn check_run(&mut self, run: Option<&RunEntry>, ground: Option<&GroundEntry>) {
        if let Some(run) = run {
            self.check_liquid("run", "initial", run.initial_k);
        }
        if let Some(ground) = ground
            && !(223.15..=373.15).contains(&ground.temperature_k)
        {
            let span = self.place_of("ground", "temperature_degc");
            let message =
                format!("[ground]: temperature_k = {} K is no ground", ground.temperature_k);
            self.reader.report(Diagnostic::new(message, span));
        }
    }

    fn check_liquid(&mut self, section: &str, stem: &str, t_k: f64) {
        if !(273.15..=373.15).contains(&t_k) {
            let span = self
                .place_of(section, &format!("{stem}_degc"))
                .or_else(|| self.place_of(section, &format!("{stem}_k")));
            self.reader.report(Diagnostic::new(
                format!("[{section}]: water of {stem}_k = {t_k} K is not liquid (0 to 100 degC)"),
                span,
            ));
        }
    }

    fn medium(&mut self, fluid: &FluidEntry) -> Option<Medium> {
        let mut good = true;
        for (field, value) in [
            ("density_kg_m3", fluid.density_kg_m3),
            ("heat_capacity_j_kg_k", fluid.heat_capacity_j_kg_k),
            ("viscosity_pa_s", fluid.viscosity_pa_s),
            ("conductivity_w_m_k", fluid.conductivity_w_m_k),
        ] {
            if value <= 0.0 {
                good = false;
                let span = self.place_of("fluid", field);
                self.reader.report(Diagnostic::new(
                    format!("[fluid]: {field} = {value} must be positive"),
                    span,
                ));
            }
        }
        good.then_some(Medium {
            density_kg_m3: fluid.density_kg_m3,
            heat_capacity_j_kg_k: fluid.heat_capacity_j_kg_k,
            viscosity_pa_s: fluid.viscosity_pa_s,
            conductivity_w_m_k: fluid.conductivity_w_m_k,
        })
    }

    fn drivers(&mut self, start: Option<Timestamp>) -> Vec<DriverSpec> {
        let mut drivers = Vec::new();
        for tree in self.items("schedule") {
            let what = format!("schedule of \"{}\"", tree.text("signal").unwrap_or("?"));
            let Some(entry) = self.reader.read::<ScheduleEntry>(&what, &tree) else { continue };
            let (times_s, values): (Vec<f64>, Vec<f64>) = entry.points.iter().copied().unzip();
            let span = tree.get("points").and_then(|tree| tree.span.clone());
            if times_s.is_empty() {
                self.reader.report(Diagnostic::new(format!("{what} has no points"), span));
                continue;
            }
            if let Some(i) = (1..times_s.len()).find(|&i| times_s[i] <= times_s[i - 1]) {
                self.reader.report(
                    Diagnostic::new(
                        format!("{what}: time {} s is not after {} s", times_s[i], times_s[i - 1]),
                        span,
                    )
                    .with_hint("the times of a schedule must rise"),
                );
                continue;
            }
            drivers.push(DriverSpec {
                signal: entry.signal,
                unit: entry.unit,
                interpolation: entry.interpolation,
                times_s,
                values,
                source: what,
                place: fields_place(&tree),
            });
        }
        for tree in self.items("series") {
            let what = format!("series of \"{}\"", tree.text("signal").unwrap_or("?"));
            let Some(entry) = self.reader.read::<SeriesEntry>(&what, &tree) else { continue };
            match series::load(&entry, start, self.dir, &tree) {
                Err(problem) => self.reader.report(problem),
                Ok((times_s, values)) => drivers.push(DriverSpec {
                    signal: entry.signal,
                    unit: entry.unit,
                    interpolation: entry.interpolation,
                    times_s,
                    values,
                    source: format!("{what} ({}, column {})", entry.file, entry.column),
                    place: fields_place(&tree),
                }),
            }
        }
        drivers
    }

    fn references(&mut self) -> Vec<ReferenceSpec> {
        let items = match self.tree.get("pressure_reference") {
            Some(tree) if matches!(tree.kind, TreeKind::Table(_)) => vec![tree.clone()],
            _ => self.items("pressure_reference"),
        };
        items
            .iter()
            .filter_map(|tree| {
                let entry = self.reader.read("pressure_reference", tree)?;
                Some(ReferenceSpec { entry, place: fields_place(tree) })
            })
            .collect()
    }
}

fn place(tree: &Tree, table: &SiTable) -> Place {
    let fields = table.places.iter().map(|(si, _, span)| (si.clone(), span.clone())).collect();
    Place { span: tree.span.clone(), fields }
}

fn fields_place(tree: &Tree) -> Place {
    let fields =
        tree.entries().iter().map(|(key, value)| (key.name.clone(), value.span.clone())).collect();
    Place { span: tree.span.clone(), fields }
}
