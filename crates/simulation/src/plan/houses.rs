//! Units, their ports and the circuits through them.

use super::Plan;
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
use anergy_network::interface::Drive;
use anergy_prosumer::circuit::Circuit;
use anergy_prosumer::coupling::Coupling;
use anergy_prosumer::equipment::Equipment;
use anergy_prosumer::thermal_unit::{Flag, UnitPort};
use smol_str::SmolStr;
use std::ops::Range;

/// A unit with its places in the flat state.
#[derive(Debug, Clone)]
pub(crate) struct PlannedUnit {
    pub name: SmolStr,
    pub equipment: Equipment,
    /// What is known of its ports, in their order.
    pub ports: Vec<UnitPort>,
    /// Slots of its ports.
    pub slots: Range<usize>,
    pub inputs: Range<usize>,
    pub state: Range<usize>,
    pub outputs: Range<usize>,
    /// Its turn among the units of a step: 0 unless an input follows its site.
    pub turn: usize,
}

impl PlannedUnit {
    /// Whether what it asks for at one port depends on the flow that it takes at another one.
    pub(crate) fn hears_flows(&self) -> bool {
        self.ports.iter().any(|port| port.sets_flow)
            && self.ports.iter().any(|port| !port.sets_flow)
    }

    /// The place of one of its outputs among the outputs of all units, if it has it.
    pub(crate) fn output(&self, name: &str) -> Option<usize> {
        let place = self.equipment.outputs().iter().position(|output| output.name == name)?;
        Some(self.outputs.start + place)
    }
}

/// A port of a unit that stands on an edge of the network.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GridPort {
    pub unit: usize,
    pub slot: usize,
    /// 1, or -1 where a positive flow of the unit goes against the direction of the edge.
    pub direction: f64,
    /// The command of its edge, where its request is that edge's flow (and not its own circulation).
    pub imposes_flow: Option<SignalId>,
}

/// A station that is told what its unit wants.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlannedDrive {
    pub station: usize,
    /// Port of the network with the unit.
    pub port: usize,
    /// Signal that gets the flow of feed-in, kg/s.
    pub feed_in: Option<SignalId>,
    /// Signal that gets the flow of extraction, kg/s.
    pub extraction: Option<SignalId>,
    /// Signals that are 1 while feed-in and extraction are asked for.
    pub feed_in_open: Option<SignalId>,
    pub extraction_open: Option<SignalId>,
    /// Share of what the unit wants that is asked for.
    pub participation: SignalId,
    pub drive: Drive,
    /// The longest step that its controllers follow.
    pub longest_step: Option<Time>,
}

/// An output of a unit that says that something is wrong while it is not 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct UnitFlag {
    pub unit: usize,
    /// Its place among the outputs of all units.
    pub output: usize,
    pub flag: Flag,
}

/// What an input of a unit sums up of the other units of its site.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum OfSite {
    /// One of their outputs, at these places.
    Outputs(Vec<usize>),
    /// The mean of one of their outputs, at these places.
    Mean(Vec<usize>),
    /// The electricity of these units and pumps.
    Electricity { units: Vec<usize>, pumps: Vec<usize> },
    /// The electricity of units and pumps, each times what it draws of reactive over real power.
    Reactive { units: Vec<(usize, f64)>, pumps: Vec<(usize, f64)> },
}

/// An input of a unit that follows what the other units of its site did in the same step.
#[derive(Debug, Clone)]
pub(crate) struct SiteInput {
    pub unit: usize,
    pub signal: SignalId,
    pub of: OfSite,
}

/// A circuit of a house.
#[derive(Debug, Clone)]
pub(crate) struct PlannedCircuit {
    pub name: SmolStr,
    pub circuit: Circuit,
    /// Flow of its own pump, m3/s.
    pub v_flow: Option<SignalId>,
    /// Units with ports in it that lead, and those ports.
    pub leads: Vec<(usize, usize)>,
}

/// Circuits of a house that meet in points.
#[derive(Debug, Clone)]
pub(crate) struct PlannedCoupling {
    /// The branches, in the order of the coupling's.
    pub circuits: Vec<PlannedCircuit>,
    pub coupling: Coupling,
}

impl Plan {
    /// Name of the unit at a port of the network.
    pub(crate) fn unit_at(&self, port: usize) -> &str {
        self.grid_ports.get(port).map_or("", |place| self.units[place.unit].name.as_str())
    }

    /// Names of the circuit, or of those of the coupling behind them, at a place of `State::unsettled`.
    pub(crate) fn circuits_at(&self, place: usize) -> Vec<&str> {
        let circuits = match place.checked_sub(self.circuits.len()) {
            Some(coupling) => &self.couplings[coupling].circuits[..],
            None => &self.circuits[place..=place],
        };
        circuits.iter().map(|circuit| circuit.name.as_str()).collect()
    }

    /// Whether there are units that store heat or draw electricity: more than what loads and sources do.
    pub(crate) fn has_houses(&self) -> bool {
        self.units.iter().any(|unit| {
            unit.ports.as_slice() != [UnitPort::ONLY]
                && unit.ports.as_slice() != [UnitPort { sets_flow: false, ..UnitPort::ONLY }]
        })
    }
}
