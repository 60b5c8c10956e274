//! Nodes, edges, ports and circuits of a model.

use super::Builder;
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::model::{EdgeSpec, Place};
use crate::model_file::NodeEntryKind;
use crate::plan::InitialWater;
use crate::temperatures::{SURROUNDINGS, Temperatures};
use crate::wording::refused;
use anergy_core::ids::{EdgeId, NodeId};
use anergy_network::elements::pipe::PipeParams;
use anergy_network::elements::{Element, ElementParams};
use anergy_network::graph::{Coupling, Edge, GraphProblem, Network, Node, NodeKind};
use anergy_network::soil::SoilRings;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// The lowest pressure above the atmosphere that a file can mean: an empty pipe, rounded.
const VACUUM_PA: f64 = -1e5;

/// The problems of the temperatures of a pipe. `what` names a pipe that is in no file.
pub(crate) fn pipe_temperatures(
    water: &Temperatures,
    what: &str,
    pipe: &PipeParams,
    place: &Place,
) -> Vec<Diagnostic> {
    let water = pipe.initial_k.and_then(|t_k| water.problem(what, "initial_k", t_k, place));
    let around = pipe
        .surroundings_k
        .and_then(|t_k| SURROUNDINGS.problem(what, "surroundings_k", t_k, place));
    water.into_iter().chain(around).collect()
}

/// The edges that are pipes.
pub(super) fn pipes(network: &Network) -> Vec<usize> {
    let edges = network.edges.iter().enumerate();
    edges.filter(|(_, edge)| matches!(edge.element, Element::Pipe(_))).map(|(i, _)| i).collect()
}

pub(super) fn below_vacuum(
    what: &str,
    field: &str,
    pressure_pa: f64,
    place: &Place,
) -> Option<Diagnostic> {
    (pressure_pa < VACUUM_PA).then(|| {
        let message = format!("{field} = {pressure_pa} is below a vacuum");
        refused(what, place, Some(field), &message)
            .with_hint("pressures are above the atmosphere: not below -1 bar")
    })
}

impl Builder<'_> {
    /// Temperatures of the water.
    pub(super) fn liquid(&self) -> Temperatures {
        Temperatures::of_liquid(&self.model.medium)
    }

    pub(super) fn nodes(&mut self) -> Vec<Node> {
        for spec in &self.model.nodes {
            let what = format!("node \"{}\"", spec.entry.id);
            if let Some(t_k) = spec.entry.temperature_k {
                self.problems.extend(self.liquid().problem(
                    &what,
                    "temperature_k",
                    t_k,
                    &spec.place,
                ));
            }
            if let Some(pressure_pa) = spec.entry.pressure_pa {
                self.problems.extend(below_vacuum(&what, "pressure_pa", pressure_pa, &spec.place));
            }
        }
        self.model
            .nodes
            .iter()
            .map(|spec| Node {
                kind: match spec.entry.kind {
                    NodeEntryKind::Junction => NodeKind::Junction,
                    NodeEntryKind::PressureBoundary => NodeKind::PressureBoundary,
                    NodeEntryKind::Source => NodeKind::Source,
                },
                elevation_m: spec.entry.elevation_m,
                volume_m3: spec.entry.volume_m3,
                ua_w_k: spec.entry.ua_w_k,
            })
            .collect()
    }

    /// The water at the start.
    pub(super) fn initial_water(&self) -> InitialWater {
        let model = self.model;
        let edges = model.edges.iter().enumerate();
        let pipes = edges.filter_map(|(i, spec)| match &spec.params {
            ElementParams::Pipe(pipe) => pipe.initial_k.map(|t_k| (i, t_k)),
            _ => None,
        });
        InitialWater {
            t_k: model.run.initial_k,
            pipes: pipes.collect(),
            // A cold solve starts from the pressure level of the model.
            level_pa: model.references.first().map_or(0.0, |r| r.entry.pressure_pa),
            follows_densities: model.thermosiphon,
            counts_friction: model.dissipation,
            counts_inertia: model.fluid_inertia,
            follows_temperatures: model.follow_temperature,
        }
    }

    pub(super) fn references(&mut self, nodes: &mut [Node], node_ids: &HashMap<&str, usize>) {
        for spec in &self.model.references {
            let pressure_pa = spec.entry.pressure_pa;
            let what = "pressure_reference";
            self.problems.extend(below_vacuum(what, "pressure_pa", pressure_pa, &spec.place));
            let name = spec.entry.node.as_str();
            let Some(&node) = node_ids.get(name) else {
                let hint = did_you_mean(name, node_ids.keys().copied());
                let message = format!("pressure_reference: there is no node \"{name}\"");
                self.report(message, spec.place.of("node"), hint);
                continue;
            };
            if nodes[node].kind == NodeKind::Junction {
                nodes[node].kind = match spec.entry.vessel_volume_m3 {
                    Some(_) => NodeKind::ExpansionVessel,
                    None => NodeKind::PressureReference,
                };
            } else {
                let message = format!(
                    "pressure_reference: node \"{name}\" is a boundary or source, or a reference already"
                );
                self.report(message, spec.place.of("node"), None);
            }
        }
    }

    pub(super) fn edges(
        &mut self,
        node_ids: &HashMap<&str, usize>,
        edge_ids: &HashMap<&str, usize>,
    ) -> (Vec<Edge>, Vec<Coupling>, Vec<SoilRings>) {
        let mut edges = Vec::with_capacity(self.model.edges.len());
        let (mut resistances, couplings) = self.resistances(edge_ids);
        let soil = self.soil(&mut resistances);
        for (spec, resistance_k_m_w) in self.model.edges.iter().zip(resistances) {
            let ends = [("from", &spec.from), ("to", &spec.to)].map(|(field, name)| {
                let found = node_ids.get(name.as_str()).copied();
                if found.is_none() {
                    let hint = did_you_mean(name, node_ids.keys().copied());
                    let message =
                        format!("edge \"{}\": {field} names no node: \"{name}\"", spec.id);
                    self.report(message, spec.place.of(field), hint);
                }
                found
            });
            if spec.from == spec.to && ends[0].is_some() {
                let message = format!("edge \"{}\" begins and ends at \"{}\"", spec.id, spec.to);
                let hint = "an edge joins two nodes".to_owned();
                self.report(message, spec.place.of("to"), Some(hint));
            }
            let partner = self.partner(spec, edge_ids);
            if let ElementParams::Pipe(pipe) = &spec.params {
                let what = format!("edge \"{}\" (pipe)", spec.id);
                self.problems.extend(pipe_temperatures(&self.liquid(), &what, pipe, &spec.place));
            }
            let built = match &spec.params {
                ElementParams::Pipe(pipe) => {
                    pipe.build_with(&self.model.medium, resistance_k_m_w).map(Element::Pipe)
                }
                params => params.build(&self.model.medium),
            };
            match built {
                Err(error) => {
                    let what = format!("edge \"{}\" ({})", spec.id, spec.params.kind());
                    let problem = refused(&what, &spec.place, error.field(), &error.to_string());
                    self.problems.push(problem);
                }
                Ok(element) => {
                    if let [Some(from), Some(to)] = ends {
                        edges.push(Edge {
                            from: NodeId::from_index(from),
                            to: NodeId::from_index(to),
                            element,
                            loss_factor: spec.loss_factor,
                            partner: partner.map(|(edge, _)| EdgeId::from_index(edge)),
                            leads_partner: partner.is_some_and(|(_, leads)| leads),
                        });
                    }
                }
            }
        }
        (edges, couplings, soil)
    }

    /// The other side of a heat exchanger, and whether this side's UA counts.
    pub(super) fn partner(
        &mut self,
        spec: &EdgeSpec,
        edge_ids: &HashMap<&str, usize>,
    ) -> Option<(usize, bool)> {
        let ElementParams::HeatExchanger(exchanger) = &spec.params else { return None };
        if let Some(name) = &exchanger.partner {
            let Some(&other) = edge_ids.get(name.as_str()) else {
                let hint = did_you_mean(name, edge_ids.keys().copied());
                let message = format!("edge \"{}\": partner names no edge: \"{name}\"", spec.id);
                self.report(message, spec.place.of("partner"), hint);
                return None;
            };
            let other_params = &self.model.edges[other].params;
            let mutual = match other_params {
                ElementParams::HeatExchanger(other) => other.partner.is_some(),
                _ => true,
            };
            if mutual || *name == spec.id {
                let message = format!(
                    "edge \"{}\": partner \"{name}\" must be another heat_exchanger without a partner \
                     of its own",
                    spec.id
                );
                self.report(message, spec.place.of("partner"), None);
                return None;
            }
            return Some((other, true));
        }
        let lead = self.model.edges.iter().position(|edge| {
            matches!(&edge.params, ElementParams::HeatExchanger(x)
                if x.partner.as_deref() == Some(spec.id.as_str()))
        });
        lead.map(|lead| (lead, false))
    }

    pub(super) fn check_graph(&mut self, network: &Network) {
        let name = |id: &NodeId| self.model.nodes[id.index()].entry.id.to_string();
        let mut joined = vec![false; network.nodes.len()];
        for edge in &network.edges {
            joined[edge.from.index()] = true;
            joined[edge.to.index()] = true;
        }
        let mut found = Vec::new();
        let with_edge: HashSet<&str> = self
            .model
            .nodes
            .iter()
            .zip(&joined)
            .filter(|(_, joined)| **joined)
            .map(|(spec, _)| spec.site.as_str())
            .collect();
        for (spec, _) in self.model.nodes.iter().zip(&joined).filter(|(_, joined)| !**joined) {
            let whole_site = !spec.site.is_empty() && !with_edge.contains(spec.site.as_str());
            let what = if whole_site {
                format!("site \"{}\"", spec.site)
            } else {
                format!("node \"{}\"", spec.entry.id)
            };
            let hint = "join it with a [[trench]] or an [[edge]], or take it out";
            let problem = Diagnostic::new(format!("{what} has no edge"), spec.place.span.range());
            found.push(problem.with_hint(hint));
        }
        for problem in network.problems() {
            found.push(match problem {
                // Said above.
                GraphProblem::NoPressureReference { circuit }
                    if circuit.iter().all(|node| !joined[node.index()]) =>
                {
                    continue;
                }
                GraphProblem::NoPressureReference { circuit } => {
                    let names: Vec<String> = circuit.iter().take(4).map(name).collect();
                    let more = circuit.len().saturating_sub(4);
                    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                    Diagnostic::new(
                        format!(
                            "the circuit of {}{more} has no pressure reference",
                            names.join(", ")
                        ),
                        self.model.nodes[circuit[0].index()].place.span.range(),
                    )
                    .with_hint(format!("add [[pressure_reference]] with node = \"{}\"", names[0]))
                }
                GraphProblem::SeveralReferences { references } => {
                    let names: Vec<String> = references.iter().map(name).collect();
                    Diagnostic::new(
                        format!(
                            "one circuit has {} pressure references: {}",
                            names.len(),
                            names.join(", ")
                        ),
                        self.reference_place(&names[1]),
                    )
                    .with_hint(
                        "keep one, or make open ends nodes with kind = \"pressure_boundary\"",
                    )
                }
                GraphProblem::ReferenceAndBoundary { reference, boundary } => Diagnostic::new(
                    format!(
                        "one circuit has the pressure reference \"{}\", which exchanges no water, and \
                         the pressure boundary \"{}\", which does",
                        name(&reference),
                        name(&boundary)
                    ),
                    self.reference_place(&name(&reference)),
                )
                .with_hint("keep one of them"),
                GraphProblem::IdealLoop { edge } => Diagnostic::new(
                    format!(
                        "edge \"{}\" closes a loop of pressure sources and fixed pressures alone",
                        self.model.edges[edge.index()].id
                    ),
                    self.model.edges[edge.index()].place.span.range(),
                )
                .with_hint("put a resistance into the loop"),
                GraphProblem::OverDetermined { equations } => self.over_determined(&equations),
                GraphProblem::UnderDetermined { unknowns } => self.under_determined(&unknowns),
            });
        }
        self.problems.extend(found);
    }

    pub(super) fn reference_place(&self, node: &str) -> Option<Range<usize>> {
        let spec = self.model.references.iter().find(|spec| spec.entry.node == node)?;
        spec.place.of("node")
    }
}
