//! The plan of a simulation: everything that does not change during a run, by id.

mod control;
mod houses;
mod water;

use crate::automatic_step::{AutomaticStep, Step};
use crate::channels::{self, Source};
use crate::drivers::Driver;
use crate::kpi;
use crate::model_file::StepEntry;
use crate::state::State;
use crate::weather::Weather;
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
use anergy_core::recorder::{Channel, MapEdge, MapNode, NetworkMap};
use anergy_core::signal::SignalTable;
use anergy_network::elements::Element;
use anergy_network::graph::Network;
use anergy_network::ground::Seasons;
use anergy_network::holding::Vessel;
use anergy_network::interface::Station;
use anergy_network::state::NetworkState;
pub(crate) use control::{PlannedController, PlannedSensor, SwingWatch};
pub(crate) use houses::{
    GridPort, OfSite, PlannedCircuit, PlannedCoupling, PlannedDrive, PlannedUnit, SiteInput,
    UnitFlag,
};
use smol_str::SmolStr;
use std::sync::{Arc, OnceLock};
pub(crate) use water::InitialWater;

/// Pairs of nodes of which the smallest pressure difference is of interest.
#[derive(Debug, Clone)]
pub(crate) struct WorstPoint {
    pub name: String,
    pub between: Vec<(usize, usize)>,
}

/// A prescription with the signal of its value; in the order of the network's.
#[derive(Debug, Clone)]
pub(crate) struct PlannedPrescription {
    pub name: String,
    pub signal: SignalId,
}

/// What a boundary value of the network is driven by.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NodeInputs {
    pub node: usize,
    pub p_pa: Option<SignalId>,
    pub m_flow_kg_s: Option<SignalId>,
    pub t_k: Option<SignalId>,
}

/// A heat meter: its edge and its second sensor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlannedMeter {
    pub edge: usize,
    pub other_node: usize,
    /// Whether the flow sensor is in the supply and the other one in the return.
    pub in_supply: bool,
}

/// What is to be held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Target {
    /// The set value of the pump on an edge.
    Pump(usize),
    /// The set point of a controller.
    Controller(usize),
}

/// A valve that is open for a share of each period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Pulse {
    pub edge: usize,
    /// The share.
    pub command: SignalId,
    pub period: Time,
}

/// A limit of the pressures of some nodes.
#[derive(Debug, Clone)]
pub(crate) struct PressureWatch {
    pub nodes: Vec<usize>,
    pub limit_pa: f64,
    pub limit: Limit,
}

/// What a limit means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Limit {
    Low,
    High,
    /// The precharge pressure of an expansion vessel.
    VesselEmpty,
}

/// Ground that follows the year: its signal at each depth.
#[derive(Debug, Clone)]
pub(crate) struct SeasonalGround {
    pub seasons: Seasons,
    /// Start of the run, s after New Year.
    pub start_s: f64,
    pub at_depths: Vec<(SignalId, f64)>,
}

/// What the balances of every step need of an edge: a twentieth of what the network knows of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ends {
    pub from: u32,
    pub to: u32,
    /// Whether it drives the flow, and does not take its work.
    pub drives: bool,
}

impl Ends {
    /// Those of all edges.
    pub(crate) fn of(network: &Network) -> Vec<Self> {
        let ends = network.edges.iter().map(|edge| Self {
            from: edge.from.index() as u32,
            to: edge.to.index() as u32,
            drives: matches!(
                edge.element,
                Element::Pump(_) | Element::FlowSource(_) | Element::PressureSource(_)
            ),
        });
        ends.collect()
    }
}

/// The edges that are pumps: what takes electricity.
pub(crate) fn pumps(network: &Network) -> Vec<usize> {
    let edges = network.edges.iter().enumerate();
    edges.filter(|(_, edge)| matches!(edge.element, Element::Pump(_))).map(|(i, _)| i).collect()
}

/// What only maps say of a node.
#[derive(Debug, Clone)]
pub(crate) struct NodeOnMap {
    pub site: SmolStr,
    pub x_m: Option<f64>,
    pub y_m: Option<f64>,
}

/// What only maps and tables say of an edge.
#[derive(Debug, Clone)]
pub(crate) struct EdgeOnMap {
    pub kind: &'static str,
    pub length_m: f64,
    pub inner_diameter_m: f64,
    pub station: SmolStr,
}

/// Everything that does not change during a run.
#[derive(Debug)]
pub struct Plan {
    pub(crate) network: Network,
    pub(crate) node_names: Vec<SmolStr>,
    pub(crate) edge_names: Vec<SmolStr>,
    pub(crate) station_names: Vec<String>,
    pub(crate) stations: Vec<Station>,
    /// Stations that are told what their unit wants.
    pub(crate) drives: Vec<PlannedDrive>,
    /// Station of each edge that is an extraction valve beside a feed-in pump.
    pub(crate) station_of_valve: Vec<Option<usize>>,
    pub(crate) units: Vec<PlannedUnit>,
    /// Ports of units in the order of the network's.
    pub(crate) grid_ports: Vec<GridPort>,
    /// Those with ports that lead first.
    pub(crate) circuits: Vec<PlannedCircuit>,
    pub(crate) couplings: Vec<PlannedCoupling>,
    /// Signals that follow another one: to, from.
    pub(crate) follows: Vec<(SignalId, SignalId)>,
    pub(crate) sensors: Vec<PlannedSensor>,
    pub(crate) controllers: Vec<PlannedController>,
    pub(crate) swing_watches: Vec<SwingWatch>,
    pub(crate) worst_points: Vec<WorstPoint>,
    pub(crate) prescriptions: Vec<PlannedPrescription>,
    /// Set value of each self-acting valve of the network.
    pub(crate) regulators: Vec<SignalId>,
    pub(crate) vessels: Vec<Vessel>,
    pub(crate) meters: Vec<PlannedMeter>,
    pub(crate) kpi_places: kpi::Places,
    /// Edges that are pipes.
    pub(crate) pipes: Vec<usize>,
    /// Edges that are pumps.
    pub(crate) pumps: Vec<usize>,
    pub(crate) ends: Vec<Ends>,
    pub(crate) pulses: Vec<Pulse>,
    /// Pulse of each edge that has one.
    pub(crate) pulse_of: Vec<Option<usize>>,
    pub(crate) pressure_watches: Vec<PressureWatch>,
    pub(crate) targets: Vec<Target>,
    pub(crate) drivers: Vec<Driver>,
    pub(crate) signals: SignalTable,
    /// Command signal of each edge.
    pub(crate) commands: Vec<Option<SignalId>>,
    pub(crate) node_inputs: Vec<NodeInputs>,
    pub(crate) ground: SignalId,
    pub(crate) seasonal_ground: Option<SeasonalGround>,
    /// What the signals of the weather are over time.
    pub(crate) weather: Option<Weather>,
    /// Signal with the temperature around each edge.
    pub(crate) surroundings: Vec<(SignalId, f64)>,
    /// The state at the start, but for the water.
    pub(crate) initial: State,
    pub(crate) initial_water: InitialWater,
    /// The channels while the plan is built, if something measures one; empty afterwards.
    pub(crate) channels: Vec<Channel>,
    pub(crate) sources: Vec<Source>,
    /// The channels once they are asked for: there are many, and a solve needs none.
    pub(crate) known_channels: OnceLock<(Vec<Channel>, Vec<Source>)>,
    pub(crate) nodes_on_map: Vec<NodeOnMap>,
    pub(crate) edges_on_map: Vec<EdgeOnMap>,
    pub(crate) model_name: String,
    pub(crate) model_text: Arc<str>,
    pub(crate) start_unix_ns: i64,
    /// Latitude and longitude of the origin of the map, rad.
    pub(crate) origin_rad: Option<[f64; 2]>,
    /// Starts of random numbers.
    pub(crate) seeds: Vec<(String, u64)>,
    /// Inputs of units that follow their site.
    pub(crate) site_inputs: Vec<SiteInput>,
    /// Outputs of units that are watched: an event when they rise from 0.
    pub(crate) flags: Vec<UnitFlag>,
    /// Largest fixed step, or shortest automatic one.
    pub(crate) step: Time,
    pub(crate) stepping: Step,
    /// What an automatic step keeps to.
    pub(crate) automatic: AutomaticStep,
    pub(crate) record: Time,
    pub(crate) until: Time,
    /// Whether a run starts from the steady state.
    pub(crate) starts_settled: bool,
    /// The longest step that the soil around the pipes takes.
    pub(crate) soil_step: Option<Time>,
}

impl Plan {
    /// The state at the start of a run.
    pub(crate) fn initial_state(&self) -> State {
        State { network: self.initial_water.state(&self.network), ..self.initial.clone() }
    }

    pub(crate) fn electric_w(&self, state: &NetworkState, edge: usize) -> f64 {
        let edge_state = state.edge_state(&self.network, edge);
        self.network.edges[edge]
            .element
            .electric_power_w(state.m_flow_kg_s[edge], &edge_state)
            .unwrap_or(0.0)
    }

    pub(crate) fn total_electric_w(&self, state: &NetworkState) -> f64 {
        self.pumps.iter().fold(0.0, |sum, pump| sum + self.electric_w(state, *pump))
    }

    pub(crate) fn total_units_w(&self, state: &NetworkState) -> f64 {
        let cp = self.network.medium.heat_capacity_j_kg_k;
        state.port_flows.iter().map(|f| f.m_flow_kg_s.abs() * cp * (f.t_out_k - f.t_in_k)).sum()
    }

    /// Heat from the losses of pumps, W: a unit never stands on a pump.
    pub(crate) fn total_pump_heat_w(&self, state: &NetworkState) -> f64 {
        self.pumps.iter().map(|pump| state.q_flow_w[*pump]).sum()
    }

    pub(crate) fn total_loss_w(&self, state: &NetworkState) -> f64 {
        state.q_loss_w.iter().sum::<f64>() + state.q_loss_nodes_w
    }

    /// Largest fixed step, or shortest automatic one.
    pub fn step(&self) -> Time {
        self.step
    }

    /// How steps are chosen.
    pub fn stepping(&self) -> Step {
        self.stepping
    }

    /// How steps are chosen where a run may be told something else.
    pub fn step_of(&self, told: Option<StepEntry>) -> Step {
        match told {
            None => self.stepping,
            Some(StepEntry::Fixed(step)) => Step::Fixed(step.0),
            Some(StepEntry::Automatic) => Step::Automatic(self.automatic),
        }
    }

    /// Limits and tolerances of automatic steps.
    pub fn automatic_step(&self) -> AutomaticStep {
        self.automatic
    }

    /// Time between recorded rows.
    pub fn record_interval(&self) -> Time {
        self.record
    }

    /// Calendar time of the start, ns since 1970; 0 without one.
    pub fn start_unix_ns(&self) -> i64 {
        self.start_unix_ns
    }

    /// End of the run.
    pub fn until(&self) -> Time {
        self.until
    }

    /// The recorded channels.
    pub fn channels(&self) -> &[Channel] {
        &self.known_channels().0
    }

    /// Where the values of the channels come from.
    pub(crate) fn sources(&self) -> &[Source] {
        &self.known_channels().1
    }

    fn known_channels(&self) -> &(Vec<Channel>, Vec<Source>) {
        self.known_channels.get_or_init(|| channels::channels(self))
    }

    /// Geometry for maps.
    pub(crate) fn map(&self) -> NetworkMap {
        let nodes = self.node_names.iter().zip(&self.nodes_on_map).map(|(id, node)| MapNode {
            id: id.to_string(),
            site: node.site.to_string(),
            x_m: node.x_m,
            y_m: node.y_m,
        });
        let edges = self.edges_on_map.iter().enumerate().map(|(i, edge)| {
            let ends = &self.network.edges[i];
            MapEdge {
                id: self.edge_names[i].to_string(),
                kind: edge.kind.to_owned(),
                from: self.node_names[ends.from.index()].to_string(),
                to: self.node_names[ends.to.index()].to_string(),
                length_m: edge.length_m,
                inner_diameter_m: edge.inner_diameter_m,
                station: edge.station.to_string(),
            }
        });
        NetworkMap { nodes: nodes.collect(), edges: edges.collect() }
    }

    /// The input signals.
    pub fn signals(&self) -> &SignalTable {
        &self.signals
    }

    /// The network.
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// Names of the nodes, in the order of their ids.
    pub fn node_names(&self) -> &[SmolStr] {
        &self.node_names
    }

    /// Names of the edges, in the order of their ids.
    pub fn edge_names(&self) -> &[SmolStr] {
        &self.edge_names
    }
}
