//! From a document to a model: every entry is read alone, all problems are collected.

use super::expand::{self, Plain};
use super::*;
use crate::diagnostic::{Diagnostic, Diagnostics, did_you_mean};
use crate::document::{Tree, TreeKind};
use crate::fields::{Reader, SiTable};
use crate::model::*;
use anergy_control::controllers::ControllerParams;
use anergy_core::medium::Medium;
use anergy_network::elements::{ElementParams, pipe::PipeParams};
use anergy_prosumer::equipment::EquipmentParams;
use jiff::Timestamp;
use serde_json::Value;
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

    fn sites(&mut self, nodes: &mut Vec<Plain>) {
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
    fn site(&mut self, what: &str, tree: &Tree, field: &str) -> Option<SiteEntry> {
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

    fn trenches(&mut self, edges: &mut Vec<Plain>) {
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

    fn stations(
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

    fn pipe_types(&mut self) -> HashMap<String, Tree> {
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

    fn node(&mut self, plain: &Plain) -> Option<NodeSpec> {
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

    fn edge(&mut self, plain: Plain, types: &HashMap<String, Tree>) -> Option<EdgeSpec> {
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

    fn merge_pipe_type(
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

    fn units(&mut self, interfaces: &[(InterfaceEntry, Tree)]) -> Vec<UnitSpec> {
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

    fn controllers(&mut self) -> Vec<ControllerSpec> {
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

    fn kind(&mut self, what: &str, tree: &mut Tree, kinds: &[&str]) -> Option<String> {
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

    fn optional_text(&mut self, what: &str, tree: &mut Tree, field: &str) -> Option<String> {
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

    fn required_text(&mut self, what: &str, tree: &mut Tree, field: &str) -> Option<String> {
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

fn place(tree: &Tree, table: &SiTable) -> Place {
    let fields = table.places.iter().map(|(si, _, span)| (si.clone(), span.clone())).collect();
    Place { span: tree.span.clone(), fields }
}

fn fields_place(tree: &Tree) -> Place {
    let fields =
        tree.entries().iter().map(|(key, value)| (key.name.clone(), value.span.clone())).collect();
    Place { span: tree.span.clone(), fields }
}
