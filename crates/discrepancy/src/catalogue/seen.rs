//! What sensors could see of a pipe, from one simulation: effects of pipes that no sensor could notice are not tried.
//!
//! **Equation** with the mean flow `m` of a pipe while it flows, its content `M` and its heat loss `Q`, a delay that changes by `f M/m` moves a
//! reading by at most `f M/m |dT/dt|`, a loss that changes by the factor `f` by `f Q/(m c)`; `|dT/dt|` is the fastest change that any
//! sensor has read.
//!
//! **Assumptions** water that has left a pipe towards no compared sensor (in the directions in which it flows in the data) does not come
//! back; all of this only leaves out, so where it is not known (units with circuits, channels of the whole network) a pipe counts as seen.

use crate::data::Track;
use crate::experiment::Experiment;
use crate::sensors::Role;
use anergy_network::elements::ElementParams;
use anergy_simulation::model::Model;
use std::collections::{BTreeMap, BTreeSet};

/// Heat capacity of water, J/(kg K), and its density, kg/m3: of a size is enough.
const WATER: (f64, f64) = (4180.0, 1000.0);
/// A tolerance that moves no reading by this is none, K.
const TOLERANCE_K: f64 = 0.002;
/// An effect that moves no reading by this at the end of its range is not seen, K.
const EFFECT_K: f64 = 0.01;
/// Below this share of its largest flow the water rests.
const RESTS: f64 = 1e-3;
/// The loss for one K is at most its mean over this, K.
const LEAST_DIFFERENCE_K: f64 = 5.0;

/// What the water of a pipe does in the model as it is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Use {
    /// Mean flow while it flows, kg/s.
    pub m_flow_kg_s: f64,
    /// Mean heat loss, W.
    pub loss_w: f64,
    /// Whether it flows from a to b, and from b to a.
    pub directions: (bool, bool),
    /// Whether it rests at times.
    pub rests: bool,
}

impl Use {
    /// Of the flows of all steps and the sum of the losses.
    pub(crate) fn of(flows: &[f64], losses_w: f64) -> Self {
        let most = flows.iter().fold(0.0_f64, |most, m| most.max(m.abs()));
        let flowing = |m: &f64| m.abs() > RESTS * most;
        let (sum, count) = flows
            .iter()
            .filter(|m| flowing(m))
            .fold((0.0, 0.0), |(sum, n), m| (sum + m.abs(), n + 1.0));
        Self {
            m_flow_kg_s: if count > 0.0 { sum / count } else { 0.0 },
            loss_w: losses_w / flows.len().max(1) as f64,
            directions: (
                flows.iter().any(|m| *m > RESTS * most),
                flows.iter().any(|m| *m < -RESTS * most),
            ),
            rests: flows.iter().any(|m| !flowing(m)),
        }
    }
}

/// What can be seen of pipes.
pub(super) struct Seen<'a> {
    experiment: &'a Experiment,
    uses: &'a BTreeMap<String, Use>,
    /// Nodes whose water comes to a compared sensor; none where that is not known.
    nodes: Option<BTreeSet<&'a str>>,
    /// The fastest change that a sensor has read, K/s.
    rate_k_s: f64,
}

impl<'a> Seen<'a> {
    pub(super) fn new(experiment: &'a Experiment) -> Self {
        let sensors = experiment.sensors.sensor.iter().enumerate();
        let warm = sensors.filter(|(_, sensor)| sensor.si() == "k");
        let tracks = warm.flat_map(|(k, _)| experiment.runs.iter().map(move |run| &run.tracks[k]));
        let rate_k_s = tracks.map(fastest).fold(0.0, f64::max);
        let uses = experiment.uses();
        let nodes = nodes(experiment, uses);
        Self { experiment, uses, nodes, rate_k_s }
    }

    /// What is known of a pipe whose water comes to a sensor; none where it comes to none.
    fn of(&self, pipe: &str) -> Option<Option<&Use>> {
        let Some(known) = self.uses.get(pipe) else { return Some(None) };
        let Some(nodes) = &self.nodes else { return Some(Some(known)) };
        let edge = self.experiment.model.edge(pipe)?;
        let own = nodes.contains(edge.from.as_str()) || nodes.contains(edge.to.as_str());
        own.then_some(Some(known))
    }

    /// Whether a change of the delay by a share, or of the loss by a factor, moves any reading by so much.
    fn moves(&self, pipe: &str, content_m3: f64, delay: f64, loss: f64, least_k: f64) -> bool {
        match self.of(pipe) {
            None => false,
            Some(None) => true,
            // What never flows may be read where it stands.
            Some(Some(u)) if u.m_flow_kg_s == 0.0 => true,
            Some(Some(u)) => {
                let delay_k = delay * content_m3 * WATER.1 / u.m_flow_kg_s * self.rate_k_s;
                let loss_k = loss * u.loss_w.abs() / (u.m_flow_kg_s * WATER.0);
                delay_k + loss_k > least_k
            }
        }
    }

    /// Whether a tolerance of the delay (share) or the loss (factor) could be seen.
    pub(super) fn tolerance(&self, pipe: &str, content_m3: f64, delay: f64, loss: f64) -> bool {
        self.moves(pipe, content_m3, delay, loss, TOLERANCE_K)
    }

    /// Whether an effect on the delay (share) or the loss (factor) could be seen.
    pub(super) fn effect(&self, pipe: &str, content_m3: f64, delay: f64, loss: f64) -> bool {
        self.moves(pipe, content_m3, delay, loss, EFFECT_K)
    }

    /// Factor on the loss that a difference of the surroundings makes at most.
    pub(super) fn surroundings(difference_k: f64) -> f64 {
        difference_k / LEAST_DIFFERENCE_K
    }

    /// Whether the pipe rests at times.
    pub(super) fn rests(&self, pipe: &str) -> bool {
        self.uses.get(pipe).is_none_or(|known| known.rests)
    }
}

/// The fastest change between two readings, K/s.
fn fastest(track: &Track) -> f64 {
    let rate = |i: usize| {
        let dt_s = (track.time_s[i] - track.time_s[i - 1]).max(1e-9);
        (track.value[i] - track.value[i - 1]).abs() / dt_s
    };
    (1..track.value.len()).map(rate).fold(0.0, f64::max)
}

/// Nodes from which water comes to a compared sensor of temperature or heat.
fn nodes<'a>(
    experiment: &'a Experiment,
    uses: &BTreeMap<String, Use>,
) -> Option<BTreeSet<&'a str>> {
    let model: &Model = &experiment.model;
    if !model.circuits.is_empty() {
        return None;
    }
    let mut seen = BTreeSet::new();
    for sensor in &experiment.sensors.sensor {
        if sensor.role != Role::Compare || !["k", "w", "j"].contains(&sensor.si().as_str()) {
            continue;
        }
        let (of, _) = sensor.signal.rsplit_once('.')?;
        let unit = model.units.iter().find(|unit| unit.id == of);
        let edge = model.edge(unit.map_or(of, |unit| unit.port.as_str()));
        if let Some(node) = model.nodes.iter().find(|node| node.entry.id == of) {
            seen.insert(node.entry.id.as_str());
        } else {
            let edge = edge?;
            seen.extend([edge.from.as_str(), edge.to.as_str()]);
        }
    }
    loop {
        let before = seen.len();
        for edge in &model.edges {
            let (forth, back) = uses.get(edge.id.as_str()).map_or((true, true), |u| u.directions);
            let (a, b) = (edge.from.as_str(), edge.to.as_str());
            if forth && seen.contains(b) {
                seen.insert(a);
            }
            if back && seen.contains(a) {
                seen.insert(b);
            }
            // An exchanger passes heat on to its other side.
            if let ElementParams::HeatExchanger(side) = &edge.params
                && let Some(other) = side.partner.as_deref().and_then(|name| model.edge(name))
            {
                let (one, two) = ([a, b], [other.from.as_str(), other.to.as_str()]);
                for (from, to) in [(one, two), (two, one)] {
                    if from.iter().any(|node| seen.contains(node)) {
                        seen.extend(to);
                    }
                }
            }
        }
        if seen.len() == before {
            break;
        }
    }
    Some(seen)
}
