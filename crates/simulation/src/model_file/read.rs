//! From a document to a model: every entry is read alone, all problems are collected.

mod components;
mod composites;
mod controllers;
mod drivers;
mod effects;
mod fluids;
mod ground;
mod heat_pump_maps;
mod house_types;
mod pipe_types;
mod plants;
mod sections;
mod sensors;
mod shared_commands;
mod station_types;
mod two_pipe;
mod units;
mod weather;

use self::pipe_types::PipeTypes;
use self::sections::LISTS;
pub(super) use self::sections::SECTIONS;
use super::expand::{self, Plain};
use super::tables::Rows;
use super::*;
use crate::diagnostic::{Diagnostic, Diagnostics, did_you_mean};
use crate::document::Span;
use crate::document::{Key, Tree, TreeKind};
use crate::fields::{Reader, SiTable};
use crate::model::*;
use crate::table::Tables;
use crate::temperatures::Temperatures;
use crate::wording::refused;
use anergy_core::medium::Medium;
use jiff::Timestamp;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Reads a whole document.
///
/// # Errors
/// All problems found.
pub fn model(mut tree: Tree, text: &str, dir: &Path) -> Result<Model, Diagnostics> {
    let rows = lists(&mut tree);
    let mut reader = ModelReader {
        reader: Reader::default(),
        tree: &tree,
        dir,
        rows,
        holding: Vec::new(),
        tables: Tables::default(),
        sites: HashMap::new(),
        wrong_sites: HashSet::new(),
        sites_unread: false,
        medium: Medium::default(),
        longest_step_s: 0.0,
        types: PipeTypes::new(),
        maps: HashMap::new(),
        nodes: Vec::new(),
        edges: Vec::new(),
        later: Later::default(),
    };
    let model = reader.model(text);
    let problems = reader.tables.located(reader.reader.problems);
    match model {
        Some(model) if problems.0.is_empty() => Ok(model),
        _ => Err(problems),
    }
}

/// The entries of the sections that can occur several times: taken out, so that each is gone when it is read.
fn lists(tree: &mut Tree) -> Rows {
    let TreeKind::Table(sections) = &mut tree.kind else { return Rows::new() };
    let mut rows = Rows::new();
    for section in LISTS {
        let list = |(key, tree): &(Key, Tree)| {
            key.name == section && matches!(tree.kind, TreeKind::Array(_))
        };
        let Some(at) = sections.iter().position(list) else { continue };
        if let TreeKind::Array(items) = sections.remove(at).1.kind {
            rows.insert(section, items);
        }
    }
    rows
}

struct ModelReader<'a> {
    reader: Reader,
    tree: &'a Tree,
    dir: &'a Path,
    /// Entries of the sections that can occur several times, also those that come from tables and types.
    rows: Rows,
    /// Their places.
    tables: Tables,
    /// Plants that hold a pressure difference, Pa, at the worst consumer.
    holding: Vec<(PlantEntry, f64, Tree, Place)>,
    sites: HashMap<String, SiteEntry>,
    /// Sites that are there, but wrong and reported.
    wrong_sites: HashSet<String>,
    /// A table of sites that could not be read whole, and is reported.
    sites_unread: bool,
    /// The water, as far as it is right.
    medium: Medium,
    /// The longest step of the run, s.
    longest_step_s: f64,
    types: PipeTypes,
    maps: heat_pump_maps::HeatPumpMaps,
    nodes: Vec<NodeSpec>,
    edges: Vec<EdgeSpec>,
    later: Later,
}

/// Problems of what is read as soon as it is known, so that a large model need not be held as plain
/// entries, but is told after the problems of the composites.
#[derive(Default)]
struct Later {
    types: Vec<Diagnostic>,
    nodes: Vec<Diagnostic>,
    edges: Vec<Diagnostic>,
}

const STEP_HINT: &str = "the automatic step lies between step_min = \"0.1s\" and step_max = \"15min\" where nothing is \
                         given, with tolerances of 0.5 K and 0.01";

/// The stations of a model file.
#[derive(Default)]
struct Stations {
    /// Edge of the interface, by `site.name`.
    edges: HashMap<String, String>,
    /// Hot and cold node of the sites of stations with parts, by `site.name`.
    lines: HashMap<String, (String, String)>,
    /// Hot and cold node of the sites of consumers, by `site.name`.
    consumers: Vec<(String, (String, String))>,
    /// Those that are there, but wrong and reported.
    wrong: HashSet<String>,
}

impl ModelReader<'_> {
    fn model(&mut self, text: &str) -> Option<Model> {
        self.check_sections();
        let about = self.single::<ModelEntry>("model");
        let run = self.single::<RunEntry>("run");
        let fluid = self.single::<FluidEntry>("fluid");
        let ground = self.single::<GroundEntry>("ground");
        let start = run.as_ref().and_then(|(run, place)| self.start(run, place));
        let medium = fluid.as_ref().and_then(|(fluid, place)| self.medium(fluid, place));
        self.medium = medium.unwrap_or_default();
        if let Some((about, place)) = &about
            && about.gravity < 0.0
        {
            let message = format!("gravity = {} must not be negative", about.gravity);
            let problem = refused("[model]", place, Some("gravity"), &message);
            self.reader.report(problem.with_hint("9.81 pulls down: elevations count upwards"));
        }
        if let Some((about, place)) = &about
            && let Err((field, message)) = about.origin_rad()
        {
            let problem = refused("[model]", place, Some(field), &message);
            let hint = "together they say where x_m = 0, y_m = 0 lies, for example latitude_deg = 48.14 and \
                        longitude_deg = 11.58";
            self.reader.report(problem.with_hint(hint));
        }
        if let Some((run, place)) = &run {
            self.longest_step_s = run.longest_step_s();
            let water = self.water();
            self.check_temperature(&water, "initial_k", run.initial_k, place);
            for (field, message) in run.step_problems() {
                let problem = refused("[run]", place, Some(field), &message);
                self.reader.report(problem.with_hint(STEP_HINT));
            }
        }
        if let Some((ground, place)) = &ground {
            self.check_ground(ground, place, run.as_ref().map(|(run, _)| run));
        }
        let tolerance = self.single::<ToleranceEntry>("tolerance");
        if let Some((tolerance, place)) = &tolerance {
            for (field, message) in tolerance.problems() {
                self.reader.report(refused("[tolerance]", place, Some(field), &message));
            }
        }
        let weather = self.weather(run.as_ref().map(|(run, _)| run), start);
        let mut interfaces = Vec::new();
        self.network(text);
        self.station_types();
        self.furnish_houses();
        let so_far = std::mem::take(&mut self.reader.problems);
        self.types = self.pipe_types();
        self.later.types = std::mem::replace(&mut self.reader.problems, so_far);
        self.read_sites();
        self.trenches();
        let mut stations = self.stations(&mut interfaces);
        self.sites = HashMap::new();
        self.hold_worst_consumers(&stations);
        self.three_way_valves();
        self.four_way_mixers();
        let plain = |tree: Tree| Plain { tree, owner: "".into(), entry: "".into() };
        for tree in self.items("node") {
            self.add_nodes([plain(tree)]);
        }
        for tree in self.items("edge") {
            self.add_edges([plain(tree)]);
        }
        let Later { types, nodes, edges } = std::mem::take(&mut self.later);
        self.reader.problems.extend(types.into_iter().chain(nodes).chain(edges));
        let (mut nodes, mut edges) =
            (std::mem::take(&mut self.nodes), std::mem::take(&mut self.edges));
        nodes.shrink_to_fit();
        edges.shrink_to_fit();
        for tree in self.items("interface") {
            let what = format!("interface \"{}\"", tree.text("id").unwrap_or("?"));
            if let Some((entry, table)) = self.reader.read::<InterfaceEntry>(&what, &tree) {
                if entry.id.is_empty() {
                    let span = place(&what, &tree, &table).of("id");
                    self.reader.report(Diagnostic::new("interface: id is empty", span));
                }
                stations.edges.insert(entry.id.clone(), entry.edge.clone());
                interfaces.push(InterfaceSpec { entry, place: place(&what, &tree, &table) });
            }
        }
        let circuits = self.circuits();
        let units = self.units(&stations, &circuits);
        let controllers = self.controllers(&stations, &units);
        let model = Model {
            text: text.into(),
            tables: self.tables.clone(),
            units,
            circuits,
            interfaces,
            sensors: self.sensors(),
            controllers,
            worst_points: self.worst_points(),
            prescriptions: self.prescriptions(),
            drivers: self.drivers(start),
            references: self.references(),
            effects: self.effects(),
            name: about.as_ref()?.0.name.clone(),
            gravity_m_s2: about.as_ref()?.0.gravity,
            dissipation: about.as_ref()?.0.dissipation,
            fluid_inertia: about.as_ref()?.0.fluid_inertia,
            thermosiphon: about.as_ref()?.0.thermosiphon,
            origin_rad: about?.0.origin_rad().ok().flatten(),
            run: run?.0,
            medium: medium?,
            follow_temperature: fluid?.0.follow_temperature,
            ground: ground.as_ref()?.0.clone(),
            ground_place: ground?.1,
            weather,
            tolerance: tolerance?.0,
            nodes,
            edges,
        };
        Some(model)
    }

    /// Types plain nodes.
    fn add_nodes(&mut self, plain: impl IntoIterator<Item = Plain>) {
        std::mem::swap(&mut self.reader.problems, &mut self.later.nodes);
        for plain in plain {
            let node = self.node(&plain);
            self.nodes.extend(node);
        }
        std::mem::swap(&mut self.reader.problems, &mut self.later.nodes);
    }

    /// Types plain edges.
    fn add_edges(&mut self, plain: impl IntoIterator<Item = Plain>) {
        std::mem::swap(&mut self.reader.problems, &mut self.later.edges);
        for plain in plain {
            let edge = self.edge(plain);
            self.edges.extend(edge);
        }
        std::mem::swap(&mut self.reader.problems, &mut self.later.edges);
    }

    fn check_sections(&mut self) {
        for (key, _) in self.tree.entries() {
            if !SECTIONS.contains(&key.name.as_str()) {
                let hint = did_you_mean(&key.name, SECTIONS.iter().copied())
                    .unwrap_or_else(|| format!("known sections: {}", SECTIONS.join(", ")));
                self.reader.report(
                    Diagnostic::new(format!("unknown section `{}`", key.name), key.span.range())
                        .with_hint(hint),
                );
            }
        }
        match self.tree.get("format").map(|tree| (tree.to_json(), tree.span.range())) {
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

    /// A section that occurs once, and its place; absent means all defaults.
    fn single<T>(&mut self, section: &str) -> Option<(T, Place)>
    where
        T: serde::de::DeserializeOwned + JsonSchema + 'static,
    {
        let empty = Tree { span: Span::NONE, kind: TreeKind::Table(Vec::new()) };
        let tree = self.tree.get(section).unwrap_or(&empty);
        let what = format!("[{section}]");
        let (entry, table) = self.reader.read(&what, tree)?;
        Some((entry, place(&what, tree, &table)))
    }

    /// The entries of a section that can occur several times, and those of the tables.
    fn items(&mut self, section: &str) -> Vec<Tree> {
        if let Some(tree) = self.tree.get(section) {
            let message = format!("`{section}` can occur several times");
            let problem = Diagnostic::new(message, tree.span.range());
            let hint = format!("write [[{section}]] with double brackets");
            self.reader.report(problem.with_hint(hint));
        }
        self.rows.remove(section).unwrap_or_default()
    }

    fn start(&mut self, run: &RunEntry, place: &Place) -> Option<Timestamp> {
        let text = run.start.as_ref()?;
        match text.parse::<Timestamp>() {
            Ok(start) => Some(start),
            Err(_) => {
                let message = format!("start = \"{text}\" is not a point in time");
                let problem = refused("[run]", place, Some("start"), &message);
                let hint = "write for example \"2024-01-17T00:00:00+01:00\"";
                self.reader.report(problem.with_hint(hint));
                None
            }
        }
    }

    fn check_temperature(&mut self, range: &Temperatures, field: &str, t_k: f64, place: &Place) {
        self.reader.problems.extend(range.problem("", field, t_k, place));
    }

    fn prescriptions(&mut self) -> Vec<PrescriptionSpec> {
        let items = self.items("prescribed");
        items
            .iter()
            .filter_map(|tree| {
                let what = format!("prescribed {}", tree.text("quantity").unwrap_or("?"));
                let (entry, table) = self.reader.read::<PrescribedEntry>(&what, tree)?;
                let id = entry.id.clone().unwrap_or_else(|| format!("{}.prescribed", entry.free));
                Some(PrescriptionSpec { id, entry, place: place(&what, tree, &table) })
            })
            .collect()
    }

    fn references(&mut self) -> Vec<ReferenceSpec> {
        let items = match self.tree.get("pressure_reference") {
            Some(tree) if matches!(tree.kind, TreeKind::Table(_)) => {
                let of_plants = self.rows.remove("pressure_reference").unwrap_or_default();
                std::iter::once(tree.clone()).chain(of_plants).collect()
            }
            _ => self.items("pressure_reference"),
        };
        items
            .iter()
            .filter_map(|tree| {
                let what = "pressure_reference";
                let (entry, table) = self.reader.read(what, tree)?;
                Some(ReferenceSpec { entry, place: place(what, tree, &table) })
            })
            .collect()
    }
}

fn place(what: &str, tree: &Tree, table: &SiTable) -> Place {
    Place { entry: what.into(), span: tree.span, fields: table.fields.as_slice().into() }
}
