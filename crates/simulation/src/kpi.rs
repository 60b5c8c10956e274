//! Key performance indicators of a run: per unit, station, site and of the grid, summed up in every step, so that
//! they do not depend on what is recorded.
//!
//! **Equation** with the means of each step of length `dt`:
//! heat given `sum max(Q, 0) dt` and taken `sum max(-Q, 0) dt` of a station;
//! mean temperature of what a station sends in one direction, by flow `sum m T dt/sum m dt` and, while at least
//! `FLOWING_KG_S` pass, by time `sum T dt/sum dt`, with `T = T_in + Q/(|m| cp)`;
//! specific pumping energy `E_pumps/Q_taken`; losses over `Q_taken`; seasonal COP `(Q_heat + Q_cold)/E`;
//! demand overlap coefficient `2 sum min(Q_h, Q_c) dt/sum (Q_h + Q_c) dt` of the heat `Q_h` that stations take in a
//! step and the heat `Q_c` that they give (F-062), without those that balance;
//! exergy lost by mixing `sum T_0 S dt`, `S = cp sum m (ln T_mixed - ln T)` over the streams that meet in a node, `T_0`
//! the temperature of the ground; efficiency of a site `(Q_demand + Q_given)/(E_fuel + E_generators + Q_taken)`:
//! `E_demand/E_fuel` without a grid, `E_demand/(E_ext + E_fuel)` of who extracts.
//!
//! **Assumptions** a station balances when the unit behind it takes what comes (does not set its flow). The water that
//! leaves an exchanger passes its volume: its temperature here is that before it, which is the same on average over
//! a run but for what the volume holds. What storages hold is not in the efficiency of a site. Heat of water at a station is told from its flow, in either direction.
//!
//! **Numerics** sums of step means are those of the balances (`balance.rs`); pressures and temperatures of nodes
//! are those at the end of each step. Nothing feeds back into a step, nothing is allocated in it.
//!
//! **Sources** specification 11; overlap coefficient: `wirtz2020`.

mod book;
mod tell;

use crate::plan::Plan;
use anergy_core::medium::Medium;
use anergy_network::graph::Network;
pub(crate) use book::{book, book_pumps};
use serde::{Deserialize, Serialize};
pub(crate) use tell::kpis;

/// What leaks through closed valves is less than this, kg/s: it takes no part in means over time and in the range of
/// what arrives.
const FLOWING_KG_S: f64 = 1e-3;

/// Smallest and largest value so far.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Range {
    pub min: f64,
    pub max: f64,
}

impl Default for Range {
    fn default() -> Self {
        Self { min: f64::INFINITY, max: f64::NEG_INFINITY }
    }
}

impl Range {
    fn see(&mut self, value: f64) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
    }

    /// Both, once something was seen.
    fn seen(&self) -> Option<(f64, f64)> {
        (self.min <= self.max).then_some((self.min, self.max))
    }
}

/// The water that passed a station in one direction.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Passed {
    /// Water, kg.
    kg: f64,
    /// Its temperature where it leaves, times its mass, kg K.
    kg_k: f64,
    /// Time with flow, s.
    flowing_s: f64,
    /// Temperature where it leaves, times that time, K s.
    k_s: f64,
    /// Temperature of what arrived, K.
    arriving_k: Range,
}

/// Sums of a station.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct StationSums {
    given_j: f64,
    taken_j: f64,
    fed_in: Passed,
    extracted: Passed,
    /// Water that was asked for, kg.
    requested_kg: f64,
    /// Water that came in the direction asked for, while it was, kg.
    delivered_kg: f64,
    /// Pressure of its hot node over its cold one, Pa.
    dp_pa: Range,
}

/// Sums of a unit, besides those that it keeps itself.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct UnitSums {
    electric_j: f64,
    /// Heat that its water took up, where it has one port or serves people.
    given_j: f64,
    taken_j: f64,
    unmet_j: f64,
}

/// The coldest or hottest node of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Extreme {
    node: usize,
    t_k: f64,
}

/// Temperature, K, and pressure above the atmosphere, Pa, of a node at the ends of the steps.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct NodeRanges {
    t_k: Range,
    p_pa: Range,
}

/// What the indicators sum up: part of the state.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Sums {
    pub stations: Vec<StationSums>,
    units: Vec<UnitSums>,
    /// Of the nodes of the grid: `Places::ranged`.
    nodes: Vec<NodeRanges>,
    /// Electricity of each pump, J.
    pumps_j: Vec<f64>,
    coldest: Option<Extreme>,
    hottest: Option<Extreme>,
    /// Heat taken and given by stations that do not balance, and what of it coincided, J.
    demand_heat_j: f64,
    demand_cold_j: f64,
    coincident_j: f64,
    /// Exergy lost by mixing, J.
    mixing_j: f64,
}

impl Sums {
    /// Nothing summed up yet.
    pub(crate) fn of(plan: &Plan) -> Self {
        Self {
            stations: vec![StationSums::default(); plan.stations.len()],
            units: vec![UnitSums::default(); plan.units.len()],
            nodes: vec![NodeRanges::default(); plan.kpi_places.ranged.len()],
            pumps_j: vec![0.0; plan.pumps.len()],
            ..Self::default()
        }
    }

    /// Memory on the heap, in bytes.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.stations.capacity() * size_of::<StationSums>()
            + self.units.capacity() * size_of::<UnitSums>()
            + self.nodes.capacity() * size_of::<NodeRanges>()
            + self.pumps_j.capacity() * size_of::<f64>()
    }

    /// Whether they can be of the same plan.
    pub(crate) fn fits(&self, other: &Self) -> bool {
        self.stations.len() == other.stations.len()
            && self.units.len() == other.units.len()
            && self.nodes.len() == other.nodes.len()
            && self.pumps_j.len() == other.pumps_j.len()
    }
}

/// What the sums need to know of the plan.
#[derive(Debug, Clone, Default)]
pub(crate) struct Places {
    /// Hot and cold node of each station, where it stands between two.
    between: Vec<Option<(usize, usize)>>,
    /// Whether the unit behind each station takes what comes.
    balances: Vec<bool>,
    /// Whether the heat through the ports of each unit is summed up.
    booked: Vec<bool>,
    /// The output of each unit that says what it could not meet.
    unmet: Vec<Option<usize>>,
    /// Nodes of the grid: those that are not within a station.
    ranged: Vec<usize>,
}

impl Places {
    /// Those of a plan.
    pub(crate) fn of(plan: &Plan) -> Self {
        let mut parts: std::collections::HashMap<&str, Vec<usize>> =
            std::collections::HashMap::new();
        for (i, edge) in plan.edges_on_map.iter().enumerate() {
            if !edge.station.is_empty() {
                parts.entry(edge.station.as_str()).or_default().push(i);
            }
        }
        let mut degree = vec![0; plan.network.nodes.len()];
        for edge in &plan.network.edges {
            degree[edge.from.index()] += 1;
            degree[edge.to.index()] += 1;
        }
        let balances = |station: &anergy_network::interface::Station| {
            let port = plan.network.ports.iter().position(|port| *port == station.edge);
            port.and_then(|port| plan.grid_ports.get(port)).is_some_and(|place| {
                let unit = &plan.units[place.unit];
                !unit.ports[place.slot - unit.slots.start].sets_flow
            })
        };
        let between = plan.stations.iter().zip(&plan.station_names).map(|(station, name)| {
            let parts = parts.get(name.as_str())?;
            let edge = &plan.network.edges[station.edge.index()];
            let end = |from| outer(&plan.network, &degree, parts, station.edge.index(), from);
            Some((end(edge.to.index())?, end(edge.from.index())?))
        });
        let booked = plan.units.iter().map(|unit| unit.slots.len() == 1 || unit.equipment.serves());
        let mut grid = vec![false; plan.network.nodes.len()];
        for (edge, place) in plan.network.edges.iter().zip(&plan.edges_on_map) {
            if place.station.is_empty() {
                grid[edge.from.index()] = true;
                grid[edge.to.index()] = true;
            }
        }
        let ranged = (0..grid.len()).filter(|node| grid[*node]);
        let unmet = plan.units.iter().map(|unit| unit.output("unmet_w"));
        Self {
            between: between.collect(),
            balances: plan.stations.iter().map(balances).collect(),
            booked: booked.collect(),
            unmet: unmet.collect(),
            ranged: ranged.collect(),
        }
    }
}

/// Where a station meets the grid on one side of its interface: the one node that is reached through its parts and
/// also has other edges.
fn outer(
    network: &Network,
    degree: &[usize],
    parts: &[usize],
    interface: usize,
    from: usize,
) -> Option<usize> {
    let mut reached = vec![from];
    let mut next = 0;
    let mut found = None;
    while let Some(&node) = reached.get(next) {
        next += 1;
        let ends = |part: usize| {
            let edge = &network.edges[part];
            (edge.from.index(), edge.to.index())
        };
        let touches = |part: &usize| {
            let (a, b) = ends(*part);
            a == node || b == node
        };
        let own = parts.iter().filter(|part| touches(part)).count();
        if degree[node] > own {
            if found.replace(node).is_some() {
                return None;
            }
            continue;
        }
        for &part in parts.iter().filter(|part| **part != interface && touches(part)) {
            let (a, b) = ends(part);
            let other = if a == node { b } else { a };
            if !reached.contains(&other) {
                reached.push(other);
            }
        }
    }
    found
}

/// Water of a mass, m3.
fn m3(medium: &Medium, kg: f64) -> f64 {
    kg / medium.density_kg_m3
}
