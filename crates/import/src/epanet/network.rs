//! The network of an EPANET file in SI: nodes, links, patterns, curves.

mod links;

pub(super) use links::{Link, LinkKind, Setting, Status, ValveKind, setting};

use super::inp::{Row, Section, begins};
use super::units::Options;
use crate::model_text::ModelText;
use crate::{ImportError, NoteKind};
use std::collections::{BTreeMap, HashMap};

/// Water taken out at a junction, m3/s, times a pattern.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Demand {
    pub base_m3_s: f64,
    pub pattern: Option<String>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum NodeKind {
    Junction {
        demands: Vec<Demand>,
        /// As written: flow in flow units at a pressure of 1 psi or 1 m.
        emitter: f64,
    },
    Reservoir {
        pattern: Option<String>,
    },
    Tank {
        level_m: f64,
        min_m: f64,
        max_m: f64,
        overflows: bool,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    pub id: String,
    pub line: usize,
    /// Elevation; of a reservoir its head.
    pub elevation_m: f64,
    pub kind: NodeKind,
    pub place: Option<(f64, f64)>,
}

impl Node {
    /// Whether the head is given, at t = 0.
    pub fn head_m(&self) -> Option<f64> {
        match &self.kind {
            NodeKind::Junction { .. } => None,
            NodeKind::Reservoir { .. } => Some(self.elevation_m),
            NodeKind::Tank { level_m, .. } => Some(self.elevation_m + level_m),
        }
    }

    /// What a control compares at a node with given head: the water above its elevation.
    pub fn level_m(&self) -> Option<f64> {
        self.head_m().map(|head| head - self.elevation_m)
    }
}

/// Everything that the hydraulics need.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Network {
    pub nodes: Vec<Node>,
    pub links: Vec<Link>,
    pub patterns: BTreeMap<String, Vec<f64>>,
    /// Points as written.
    pub curves: BTreeMap<String, Vec<(f64, f64)>>,
    node_index: HashMap<String, usize>,
    link_index: HashMap<String, usize>,
}

impl Network {
    pub fn read(
        rows: &[Row<'_>],
        options: &Options,
        text: &mut ModelText,
        errors: &mut Vec<ImportError>,
    ) -> Self {
        let mut network = Self::default();
        let mut each = |sections: &[Section], read: &mut RowReader<'_>| {
            for row in rows.iter().filter(|row| sections.contains(&row.section)) {
                errors.extend(read(row).err());
            }
        };
        each(&[Section::Patterns], &mut |row| network.pattern(row));
        each(&[Section::Curves], &mut |row| network.curve(row));
        each(&[Section::Junctions, Section::Reservoirs, Section::Tanks], &mut |row| {
            network.node(row, options)
        });
        let mut replaced = vec![false; network.nodes.len()];
        each(&[Section::Demands], &mut |row| network.demand(row, options, &mut replaced));
        each(&[Section::Emitters], &mut |row| network.emitter(row));
        each(&[Section::Coordinates], &mut |row| network.place(row));
        each(&[Section::Pipes, Section::Pumps, Section::Valves], &mut |row| {
            network.link(row, options)
        });
        each(&[Section::Status], &mut |row| network.status(row, options, text));
        network.default_pattern(options);
        network
    }

    pub fn node_at(&self, id: &str) -> Option<usize> {
        self.node_index.get(id).copied()
    }

    pub fn link_at(&self, id: &str) -> Option<usize> {
        self.link_index.get(id).copied()
    }

    fn pattern(&mut self, row: &Row<'_>) -> Result<(), ImportError> {
        let factors: Result<Vec<f64>, ImportError> =
            (1..row.words.len()).map(|i| row.number(i, "factor")).collect();
        self.patterns.entry(row.words[0].into()).or_default().extend(factors?);
        Ok(())
    }

    fn curve(&mut self, row: &Row<'_>) -> Result<(), ImportError> {
        if row.words.len().is_multiple_of(2) {
            return Err(row.error("a point of a curve needs two numbers"));
        }
        let mut points = Vec::new();
        for i in (1..row.words.len()).step_by(2) {
            points.push((row.number(i, "x")?, row.number(i + 1, "y")?));
        }
        self.curves.entry(row.words[0].into()).or_default().extend(points);
        Ok(())
    }

    fn pattern_id(&self, row: &Row<'_>, i: usize) -> Result<Option<String>, ImportError> {
        match row.words.get(i) {
            None => Ok(None),
            Some(id) if self.patterns.contains_key(*id) => Ok(Some((*id).into())),
            Some(id) => Err(row.error(format!("there is no pattern \"{id}\""))),
        }
    }

    fn node(&mut self, row: &Row<'_>, options: &Options) -> Result<(), ImportError> {
        let length = options.length_m();
        let head = |what| Ok(row.number_or(1, 0.0, what)? * length);
        let (elevation_m, kind) = match row.section {
            Section::Junctions => {
                let base = row.number_or(2, 0.0, "demand")? * options.flow_m3_s;
                let pattern = self.pattern_id(row, 3)?;
                let demands = vec![Demand { base_m3_s: base, pattern }];
                (head("elevation")?, NodeKind::Junction { demands, emitter: 0.0 })
            }
            // EPANET takes a tank without a diameter for a reservoir.
            _ if row.words.len() <= 3 => {
                (head("head")?, NodeKind::Reservoir { pattern: self.pattern_id(row, 2)? })
            }
            _ => {
                let level = |i, what| Ok(row.number_or(i, 0.0, what)? * length);
                let kind = NodeKind::Tank {
                    level_m: level(2, "level")?,
                    min_m: level(3, "lowest level")?,
                    max_m: level(4, "highest level")?,
                    overflows: row.words.get(8).is_some_and(|word| begins(word, "YES")),
                };
                (head("elevation")?, kind)
            }
        };
        let id = row.words[0].to_owned();
        if self.node_index.insert(id.clone(), self.nodes.len()).is_some() {
            return Err(row.error(format!("node \"{id}\" exists twice")));
        }
        self.nodes.push(Node { id, line: row.line, elevation_m, kind, place: None });
        Ok(())
    }

    fn known_node(&self, row: &Row<'_>, i: usize) -> Result<usize, ImportError> {
        let id = row.word(i, "node")?;
        self.node_at(id).ok_or_else(|| row.error(format!("there is no node \"{id}\"")))
    }

    /// Demands of their section replace the one in the line of the junction.
    fn demand(
        &mut self,
        row: &Row<'_>,
        options: &Options,
        replaced: &mut [bool],
    ) -> Result<(), ImportError> {
        if begins(row.words[0], "MULTIPLY") {
            return Ok(());
        }
        let node = self.known_node(row, 0)?;
        let base_m3_s = row.number(1, "demand")? * options.flow_m3_s;
        let demand = Demand { base_m3_s, pattern: self.pattern_id(row, 2)? };
        let NodeKind::Junction { demands, .. } = &mut self.nodes[node].kind else {
            return Ok(());
        };
        if !std::mem::replace(&mut replaced[node], true) {
            demands.clear();
        }
        demands.push(demand);
        Ok(())
    }

    fn emitter(&mut self, row: &Row<'_>) -> Result<(), ImportError> {
        let node = self.known_node(row, 0)?;
        let coefficient = row.not_negative(1, "emitter coefficient")?;
        match &mut self.nodes[node].kind {
            NodeKind::Junction { emitter, .. } => *emitter = coefficient,
            _ => return Err(row.error(format!("node \"{}\" is no junction", row.words[0]))),
        }
        Ok(())
    }

    fn place(&mut self, row: &Row<'_>) -> Result<(), ImportError> {
        // A place of a node that is not there harms nobody.
        if let Some(node) = self.node_at(row.words[0]) {
            self.nodes[node].place = Some((row.number(1, "x")?, row.number(2, "y")?));
        }
        Ok(())
    }

    /// Demands without a pattern follow the one named in the options, where it exists.
    fn default_pattern(&mut self, options: &Options) {
        if !self.patterns.contains_key(&options.default_pattern) {
            return;
        }
        for node in &mut self.nodes {
            if let NodeKind::Junction { demands, .. } = &mut node.kind {
                for demand in demands {
                    demand.pattern.get_or_insert_with(|| options.default_pattern.clone());
                }
            }
        }
    }

    /// Value of a pattern in one of its periods, counted from the start of the simulation.
    pub fn factor(&self, pattern: Option<&String>, options: &Options, period: usize) -> f64 {
        let Some(factors) = pattern.and_then(|id| self.patterns.get(id)) else { return 1.0 };
        let offset = (options.pattern_start_s / options.pattern_step_s).floor() as usize;
        match factors.len() {
            0 => 1.0,
            length => factors[(period + offset) % length],
        }
    }

    /// A pump with a pattern runs at the speed of its first period.
    pub fn pump_pattern(&mut self, link: usize, options: &Options) {
        if let LinkKind::Pump { pattern: pattern @ Some(_), .. } = &self.links[link].kind {
            let speed = self.factor(pattern.as_ref(), options, 0);
            self.set(link, Setting::Value(speed.max(0.0)));
        }
    }

    /// What a junction takes out in a period, m3/s.
    pub fn demand_m3_s(&self, demands: &[Demand], options: &Options, period: usize) -> f64 {
        let each = demands
            .iter()
            .map(|demand| demand.base_m3_s * self.factor(demand.pattern.as_ref(), options, period));
        options.demand_multiplier * each.sum::<f64>()
    }
}

type RowReader<'a> = dyn FnMut(&Row<'_>) -> Result<(), ImportError> + 'a;

/// A note on a row.
pub(super) fn untranslated(text: &mut ModelText, row: &Row<'_>, why: &str) {
    let section = format!("{:?}", row.section).to_uppercase();
    text.note(NoteKind::NotTranslated, row.line, format!("[{section}] {}: {why}", row.text));
}
