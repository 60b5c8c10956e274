//! Blocking margins in the names of the model; the equations are in [`anergy_network::blocking`].

use crate::error::RunError;
use crate::plan::Plan;
use crate::simulation::{Simulation, named};
use anergy_core::ids::EdgeId;
use anergy_network::blocking::{Blocking, Feeder, Influence, Limit};
use anergy_network::elements::Element;
use anergy_network::graph::Network;
use anergy_network::hydraulics::HydraulicError;
use anergy_network::interface::BLOCKED_BELOW;
use serde::Serialize;

/// How far a feeder is from being blocked. A feeder without a state in which it delivers nothing has no
/// threshold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeederMargin {
    /// The pump.
    pub id: String,
    /// The station that it feeds, if it belongs to one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub station: Option<String>,
    /// Whether the pump runs and the network holds its check valve shut: `margin_speed < 0`.
    pub blocked: bool,
    /// Whether it delivers less than half of what its station requests, blocked or not: after a minute the
    /// station raises its flag.
    pub held_back: bool,
    /// The other pump or source that holds it back most, where it is blocked or held back.
    pub blocked_by: Option<String>,
    /// Present speed above the threshold.
    pub margin_speed: Option<f64>,
    /// Relative speed below which the check valve is shut while all else stays.
    pub threshold_speed: Option<f64>,
    /// Present relative speed.
    pub speed: f64,
    /// Largest relative speed.
    pub speed_max: f64,
    /// Present flow, kg/s.
    pub m_flow_kg_s: f64,
    /// What the station requests, kg/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub requested_m_flow_kg_s: Option<f64>,
    /// Pressure difference that the rest of the network puts across the pump without its flow, Pa.
    pub opposing_dp_pa: Option<f64>,
    /// Head of the pump at its present speed without flow above that, Pa.
    pub margin_dp_pa: Option<f64>,
    /// What the other pumps and sources do to the opposing pressure difference, the worst first.
    pub opponents: Vec<Opponent>,
}

/// What another pump or source does to a feeder.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Opponent {
    /// The pump or source.
    pub id: String,
    /// Its position: `speed`, `m_flow_set_kg_s`, `head_pa`.
    pub quantity: String,
    /// Change of the opposing pressure difference of the feeder, Pa per unit of the position.
    pub opposing_dp_by_position_pa: f64,
    /// The same per relative change of the position, Pa: the largest is the culprit.
    pub weight_pa: f64,
}

/// Where others block a feeder, or free it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeederLimits {
    /// The pump.
    pub id: String,
    /// Of each other pump or source: where it would shut or open the check valve, if it can.
    pub opponents: Vec<OpponentLimit>,
    /// Common factor on the openings of the valves whose closing holds the feeder back at which the check
    /// valve shuts or opens, if there is one.
    pub valves_factor: Option<f64>,
}

/// Where another pump or source shuts or opens the check valve of a feeder.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OpponentLimit {
    /// The pump or source.
    pub id: String,
    /// Its position: `speed`, `m_flow_set_kg_s`, `head_pa`.
    pub quantity: String,
    /// The limit; none up to the largest position where it is absent.
    pub position: Option<f64>,
    /// Its flow there, kg/s.
    pub m_flow_kg_s: Option<f64>,
}

/// A point of the operating range of two pumps.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapPoint {
    /// Position of the first pump.
    pub first: f64,
    /// Position of the second pump.
    pub second: f64,
    /// Flow of each feeder, kg/s, in the order of [`FeederMargin`]s.
    pub m_flow_kg_s: Vec<f64>,
    /// The feeders whose pump runs and that deliver nothing.
    pub blocked: Vec<String>,
}

/// Blocking margins of all feeders at the present state of a simulation, which has to be solved.
///
/// # Errors
/// When the network without the flow of a feeder cannot be solved.
pub fn blocking(simulation: &Simulation) -> Result<Vec<FeederMargin>, RunError> {
    Analysis::new(simulation)?.margins()
}

/// Answers about blocking at the present state of a simulation.
pub struct Analysis<'a> {
    simulation: &'a Simulation,
    blocking: Blocking,
}

impl<'a> Analysis<'a> {
    /// Prepares for a simulation whose present state is solved.
    ///
    /// # Errors
    /// When the network cannot be linearised there.
    pub fn new(simulation: &'a Simulation) -> Result<Self, RunError> {
        let (plan, state) = (simulation.plan(), simulation.state());
        let blocking = Blocking::new(plan.network(), &state.network)
            .map_err(|error| named(plan, state.time, &error))?;
        Ok(Self { simulation, blocking })
    }

    /// The margins of all feeders, in the order of their pumps.
    ///
    /// # Errors
    /// As [`blocking`].
    pub fn margins(&mut self) -> Result<Vec<FeederMargin>, RunError> {
        let feeders = self.blocking.feeders().to_vec();
        feeders.into_iter().map(|feeder| self.margin(feeder)).collect()
    }

    fn margin(&mut self, feeder: Feeder) -> Result<FeederMargin, RunError> {
        let plan = self.simulation.plan();
        let found = self.ask(|blocking, network| blocking.margin(network, feeder))?;
        let station = plan.stations.iter().position(|station| station.pump == Some(feeder.pump));
        let requested = station.and_then(|i| plan.stations[i].requested_m_flow_kg_s);
        let runs = found.speed > 0.0;
        let held_back =
            runs && requested.is_some_and(|wanted| found.m_flow_kg_s < BLOCKED_BELOW * wanted);
        let stuck = found.blocked() || held_back;
        let mut opponents: Vec<Opponent> =
            found.influences.iter().map(|influence| opponent(plan, influence)).collect();
        opponents.sort_by(|a, b| b.weight_pa.total_cmp(&a.weight_pa));
        Ok(FeederMargin {
            id: name(plan, feeder.pump),
            station: station.map(|i| plan.station_names[i].clone()),
            blocked: found.blocked(),
            held_back,
            blocked_by: found.culprit.filter(|_| stuck).map(|edge| name(plan, edge)),
            margin_speed: found.speed_margin(),
            threshold_speed: found.threshold_speed,
            speed: found.speed,
            speed_max: found.speed_max,
            m_flow_kg_s: found.m_flow_kg_s,
            requested_m_flow_kg_s: requested,
            opposing_dp_pa: found.opposing_dp_pa,
            margin_dp_pa: found.opposing_dp_pa.map(|dp| found.head_without_flow_pa - dp),
            opponents,
        })
    }

    /// Where each of the others blocks or frees each feeder: as many root searches as there are pairs.
    ///
    /// # Errors
    /// When the network cannot be solved within the range of an actuator.
    pub fn limits(&mut self) -> Result<Vec<FeederLimits>, RunError> {
        let feeders = self.blocking.feeders().to_vec();
        let plan = self.simulation.plan();
        let mut limits = Vec::with_capacity(feeders.len());
        for feeder in feeders {
            let margin = self.ask(|blocking, network| blocking.margin(network, feeder))?;
            let mut opponents = Vec::new();
            for influence in margin.influences.iter().filter(|i| !is_free(plan, i.edge)) {
                let limit = self.limit(feeder, &[influence.edge])?;
                let Opponent { id, quantity, .. } = opponent(plan, influence);
                opponents.push(OpponentLimit {
                    id,
                    quantity,
                    position: limit.map(|limit| limit.position),
                    m_flow_kg_s: limit.map(|limit| limit.m_flow_kg_s),
                });
            }
            let valves = self.valves_against(feeder)?;
            let factor = if valves.is_empty() { None } else { self.limit(feeder, &valves)? };
            limits.push(FeederLimits {
                id: name(plan, feeder.pump),
                opponents,
                valves_factor: factor.map(|limit| limit.factor),
            });
        }
        Ok(limits)
    }

    /// Threshold speed of a feeder at positions of another pump or source: `None` where it has none.
    ///
    /// # Errors
    /// When a name is unknown, or the network cannot be solved there.
    pub fn thresholds(
        &mut self,
        feeder: &str,
        other: &str,
        positions: &[f64],
    ) -> Result<Vec<Option<f64>>, RunError> {
        let (feeder, other) = (self.feeder(feeder)?, self.edge(other)?);
        self.ask(|blocking, network| blocking.thresholds(network, feeder, other, positions))
    }

    /// Who is blocked and what flows over the positions of two pumps, row by row of the first.
    ///
    /// # Errors
    /// When a name is unknown, or the network cannot be solved there.
    pub fn map(
        &mut self,
        first: &str,
        second: &str,
        positions: &[f64],
    ) -> Result<Vec<MapPoint>, RunError> {
        let (a, b) = (self.edge(first)?, self.edge(second)?);
        let plan = self.simulation.plan();
        let feeders = self.blocking.feeders().to_vec();
        let here = &self.simulation.state().network.position;
        let mut points = Vec::with_capacity(positions.len() * positions.len());
        for &first in positions {
            for &second in positions {
                let mut m_flow_kg_s = Vec::with_capacity(feeders.len());
                self.ask(|blocking, network| {
                    blocking.flows(network, &[(a, first), (b, second)], &mut m_flow_kg_s)
                })?;
                let position = |pump: EdgeId| match pump {
                    pump if pump == a => first,
                    pump if pump == b => second,
                    pump => here[pump.index()],
                };
                let blocked = feeders
                    .iter()
                    .zip(&m_flow_kg_s)
                    .filter(|(feeder, m)| **m <= 0.0 && position(feeder.pump) > 0.0);
                let blocked = blocked.map(|(feeder, _)| name(plan, feeder.pump)).collect();
                points.push(MapPoint { first, second, m_flow_kg_s, blocked });
            }
        }
        Ok(points)
    }

    fn limit(&mut self, feeder: Feeder, edges: &[EdgeId]) -> Result<Option<Limit>, RunError> {
        self.ask(|blocking, network| blocking.limit(network, feeder, edges))
    }

    /// Valves that are open and whose closing holds a feeder back.
    fn valves_against(&mut self, feeder: Feeder) -> Result<Vec<EdgeId>, RunError> {
        let plan = self.simulation.plan();
        let here = &self.simulation.state().network.position;
        let valves: Vec<EdgeId> = (0..plan.network().edges.len())
            .filter(|&i| matches!(plan.network().edges[i].element, Element::Valve(_)))
            .filter(|&i| here[i] > 0.0)
            .map(EdgeId::from_index)
            .filter(|valve| !is_free(plan, *valve))
            .collect();
        let (_, influences) =
            self.ask(|blocking, network| blocking.influences(network, feeder, &valves))?;
        let against = influences.iter().filter(|i| i.opposing_dp_by_position_pa < 0.0);
        Ok(against.map(|influence| influence.edge).collect())
    }

    fn ask<T>(
        &mut self,
        question: impl FnOnce(&mut Blocking, &Network) -> Result<T, HydraulicError>,
    ) -> Result<T, RunError> {
        let plan = self.simulation.plan();
        question(&mut self.blocking, plan.network())
            .map_err(|error| named(plan, self.simulation.state().time, &error))
    }

    fn edge(&self, id: &str) -> Result<EdgeId, RunError> {
        let names = &self.simulation.plan().edge_names;
        names.iter().position(|name| name == id).map(EdgeId::from_index).ok_or_else(|| {
            RunError::UnknownName { what: "edge", name: id.to_owned(), hint: String::new() }
        })
    }

    fn feeder(&self, id: &str) -> Result<Feeder, RunError> {
        let pump = self.edge(id)?;
        let feeder = self.blocking.feeders().iter().find(|feeder| feeder.pump == pump);
        feeder.copied().ok_or_else(|| RunError::UnknownName {
            what: "feeder",
            name: id.to_owned(),
            hint: "; a feeder is a pump in series with a check valve".into(),
        })
    }
}

fn name(plan: &Plan, edge: EdgeId) -> String {
    plan.edge_names[edge.index()].to_string()
}

/// Whether the position of an edge is what a prescription needs.
fn is_free(plan: &Plan, edge: EdgeId) -> bool {
    plan.network.prescriptions.iter().any(|prescription| prescription.free == edge)
}

fn opponent(plan: &Plan, influence: &Influence) -> Opponent {
    let Influence { edge, opposing_dp_by_position_pa, weight_pa } = *influence;
    let actuator = plan.network.edges[edge.index()].element.actuator();
    Opponent {
        id: name(plan, edge),
        quantity: actuator.map_or("position", |actuator| actuator.position).into(),
        opposing_dp_by_position_pa,
        weight_pa,
    }
}
