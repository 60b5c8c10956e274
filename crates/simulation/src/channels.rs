//! What can be recorded and measured: every quantity of every component by name.

mod control;
mod moment;
mod units;

use crate::plan::Plan;
use crate::simulation::{Said, stored_j};
use crate::state::State;
use crate::weather;
use anergy_core::ids::SignalId;
use anergy_core::port::Port;
use anergy_core::recorder::{Channel, ChannelGroup};
use anergy_network::elements::Element;
use anergy_network::graph::Coupling;
pub(crate) use control::{add_controller, add_sensors};
pub use moment::Moment;
pub(crate) use moment::moment;

/// Where the value of a channel comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// Pressure of a node, Pa.
    NodePressure(usize),
    /// Temperature of a node, K.
    NodeTemperature(usize),
    /// Water that a boundary brings in, kg/s.
    NodeExchange(usize),
    /// Heat that a meter shows, W.
    MeterHeat(usize),
    /// Heat that a meter has counted, J.
    MeterEnergy(usize),
    /// Water that a meter has counted, m3.
    MeterVolume(usize),
    /// Gas in an expansion vessel, m3.
    VesselGas(usize),
    /// Flow of an edge, kg/s.
    EdgeFlow(usize),
    /// Pressure difference of an edge, Pa.
    EdgePressure(usize),
    /// Actuator position of an edge.
    EdgePosition(usize),
    /// Speed of a pump: commanded, or what holds its set value.
    PumpSpeed(usize),
    /// Electric power of an edge, W.
    EdgePower(usize),
    /// Temperature at an end of a pipe, K.
    PipeEnd(usize, Port),
    /// Heat lost by a pipe, W.
    EdgeLoss(usize),
    /// Heat that a pipe has lost, J.
    PipeLost(usize),
    /// Change of the heat that a pipe holds, J.
    PipeStored(usize),
    /// Innermost ring of the soil around a pipe, K.
    Soil(usize),
    /// Heat from the soil around a pipe to the ground, W.
    SoilLoss(usize),
    /// Heat taken up by an edge, W.
    EdgeHeat(usize),
    /// Temperature of the volume of an edge, K.
    EdgeVolume(usize),
    /// Flow of a station, kg/s.
    StationFlow(usize),
    /// Heat fed in by a station, W.
    StationHeat(usize),
    /// Cumulative heat fed in by a station, J.
    StationEnergy(usize),
    /// Flow that a station's pump means to deliver, kg/s.
    StationRequest(usize),
    /// Whether a station is blocked.
    StationBlocked(usize),
    /// Smallest pressure difference of a worst point, Pa.
    WorstPoint(usize),
    /// An output of a unit.
    UnitOutput(usize),
    /// Flow through a port of a unit, kg/s.
    UnitFlow(usize),
    /// Temperature of the water that arrives at a port, K.
    UnitInlet(usize),
    /// Temperature of the water that leaves a port, K.
    UnitOutlet(usize),
    /// Heat that the water takes up at a port, W.
    UnitHeat(usize),
    /// Whether a watched pump swings: 1 alone, 2 against another.
    PumpSwing(usize),
    /// Reading of a sensor.
    Sensor(usize),
    /// A part of the state of a controller, among those of all.
    ControllerState(usize),
    /// An input signal.
    Signal(SignalId),
    /// Electric power of all pumps, W.
    TotalElectric,
    /// Heat from all units, W.
    TotalUnits,
    /// Electricity that the units draw, W.
    UnitsElectric,
    /// Other heat that the units take up from outside, W.
    UnitsExternal,
    /// Heat from the losses of all pumps, W.
    TotalPumpHeat,
    /// Heat of friction in all edges, W.
    TotalFriction,
    /// Heat lost by all pipes and nodes, W.
    TotalLoss,
    /// Enthalpy flow through boundaries, W.
    TotalBoundary,
    /// Heat stored in all water, J.
    Stored,
    /// One of the cumulative sums, J.
    Cumulative(Cumulative),
}

/// Energies since the start of the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cumulative {
    /// Electricity of the pumps.
    Electric,
    /// Heat from the units.
    Units,
    /// Electricity of the units.
    UnitsElectric,
    /// Other heat into the units.
    UnitsExternal,
    /// Heat from the losses of the pumps.
    PumpHeat,
    /// Heat of friction.
    Friction,
    /// Heat lost.
    Loss,
    /// Enthalpy through boundaries.
    Boundary,
}

/// The channels of a plan and where their values come from; `names` are those of the model.
pub(crate) fn channels(plan: &Plan) -> (Vec<Channel>, Vec<Source>) {
    let mut list = List { channels: Vec::new(), sources: Vec::new() };
    for (i, name) in plan.node_names.iter().enumerate() {
        list.add(ChannelGroup::Nodes, name, "p_pa", "Pa", Source::NodePressure(i));
        list.add(ChannelGroup::Nodes, name, "t_k", "K", Source::NodeTemperature(i));
        if plan.network.nodes[i].kind != anergy_network::graph::NodeKind::Junction {
            let exchange = Source::NodeExchange(i);
            list.add(ChannelGroup::Nodes, name, "exchange_kg_s", "kg s-1", exchange);
        }
    }
    for (i, vessel) in plan.vessels.iter().enumerate() {
        let name = &plan.node_names[vessel.node.index()];
        list.add(ChannelGroup::Nodes, name, "vessel_gas_m3", "m3", Source::VesselGas(i));
    }
    for (i, name) in plan.edge_names.iter().enumerate() {
        edge_channels(&mut list, plan, i, name);
    }
    for (i, soil) in plan.network.soil.iter().enumerate() {
        let name = &plan.edge_names[soil.edge.index()];
        list.add(ChannelGroup::Edges, name, "soil_k", "K", Source::Soil(i));
        list.add(ChannelGroup::Edges, name, "q_ground_w", "W", Source::SoilLoss(i));
    }
    for (i, meter) in plan.meters.iter().enumerate() {
        let name = &plan.edge_names[meter.edge];
        list.add(ChannelGroup::Edges, name, "q_flow_w", "W", Source::MeterHeat(i));
        list.add(ChannelGroup::Edges, name, "heat_j", "J", Source::MeterEnergy(i));
        list.add(ChannelGroup::Edges, name, "volume_m3", "m3", Source::MeterVolume(i));
    }
    for (i, station) in plan.stations.iter().enumerate() {
        let name = &plan.station_names[i];
        let group = ChannelGroup::Interfaces;
        list.add(group, name, "m_flow_kg_s", "kg s-1", Source::StationFlow(i));
        list.add(group, name, "q_flow_w", "W", Source::StationHeat(i));
        list.add(group, name, "heat_j", "J", Source::StationEnergy(i));
        if station.requested_m_flow_kg_s.is_some() || plan.drives.iter().any(|d| d.station == i) {
            let request = Source::StationRequest(i);
            list.add(group, name, "requested_m_flow_kg_s", "kg s-1", request);
            list.add(group, name, "blocked", "1", Source::StationBlocked(i));
        }
    }
    for (i, point) in plan.worst_points.iter().enumerate() {
        list.add(ChannelGroup::Interfaces, &point.name, "dp_pa", "Pa", Source::WorstPoint(i));
    }
    units::outputs(&mut list, plan);
    for (i, spec) in plan.signals.specs().iter().enumerate() {
        let (component, quantity) = spec.name.rsplit_once('.').unwrap_or(("", &spec.name));
        let unit = udunits(spec.unit);
        // What the weather is, is no command.
        let end = if weather::is_signal(&spec.name) { "" } else { "_command" };
        let quantity = format!("{quantity}{end}");
        let source = Source::Signal(SignalId::from_index(i));
        list.add(ChannelGroup::Control, component, &quantity, unit, source);
    }
    for (quantity, unit, source) in [
        ("electric_w", "W", Source::TotalElectric),
        ("units_w", "W", Source::TotalUnits),
        ("pump_heat_w", "W", Source::TotalPumpHeat),
        ("loss_w", "W", Source::TotalLoss),
        ("boundary_w", "W", Source::TotalBoundary),
        ("stored_j", "J", Source::Stored),
        ("electric_j", "J", Source::Cumulative(Cumulative::Electric)),
        ("units_j", "J", Source::Cumulative(Cumulative::Units)),
        ("pump_heat_j", "J", Source::Cumulative(Cumulative::PumpHeat)),
        ("loss_j", "J", Source::Cumulative(Cumulative::Loss)),
        ("boundary_j", "J", Source::Cumulative(Cumulative::Boundary)),
    ] {
        list.add(ChannelGroup::Balances, "network", quantity, unit, source);
    }
    if plan.initial_water.counts_friction {
        let joule = Source::Cumulative(Cumulative::Friction);
        list.add(ChannelGroup::Balances, "network", "friction_w", "W", Source::TotalFriction);
        list.add(ChannelGroup::Balances, "network", "friction_j", "J", joule);
    }
    units::balances(&mut list, plan);
    control::sensors(&mut list, plan);
    control::controllers(&mut list, plan);
    for (i, watch) in plan.swing_watches.iter().enumerate() {
        let name = &plan.edge_names[watch.edge];
        list.add(ChannelGroup::Control, name, "swings", "1", Source::PumpSwing(i));
    }
    (list.channels, list.sources)
}

/// Unit of a difference of temperatures, which counts from nothing.
pub(crate) const DIFFERENCE_K: &str = "delta K";

struct List {
    channels: Vec<Channel>,
    sources: Vec<Source>,
}

impl List {
    fn add(
        &mut self,
        group: ChannelGroup,
        component: &str,
        quantity: &str,
        unit: &str,
        source: Source,
    ) {
        self.channels.push(Channel {
            name: format!("{component}.{quantity}"),
            unit: unit.to_owned(),
            group,
            component: component.to_owned(),
            quantity: quantity.to_owned(),
        });
        self.sources.push(source);
    }
}

fn edge_channels(list: &mut List, plan: &Plan, i: usize, name: &str) {
    let group = ChannelGroup::Edges;
    let element = &plan.network.edges[i].element;
    list.add(group, name, "m_flow_kg_s", "kg s-1", Source::EdgeFlow(i));
    list.add(group, name, "dp_pa", "Pa", Source::EdgePressure(i));
    match element {
        Element::Pump(pump) => {
            list.add(group, name, "speed", "1", Source::PumpSpeed(i));
            list.add(group, name, "power_w", "W", Source::EdgePower(i));
            if pump.warms_water() {
                list.add(group, name, "q_flow_w", "W", Source::EdgeHeat(i));
            }
        }
        Element::Valve(_)
        | Element::BallValve(_)
        | Element::DpController(_)
        | Element::PressureReducingValve(_)
        | Element::PressureSustainingValve(_) => {
            list.add(group, name, "opening", "1", Source::EdgePosition(i));
        }
        Element::FlowLimiter(_) => {
            list.add(group, name, "m_flow_set_kg_s", "kg s-1", Source::EdgePosition(i));
        }
        Element::Pipe(_) => {
            list.add(group, name, "t_a_k", "K", Source::PipeEnd(i, Port::A));
            list.add(group, name, "t_b_k", "K", Source::PipeEnd(i, Port::B));
            list.add(group, name, "q_loss_w", "W", Source::EdgeLoss(i));
            if let Ok(pipe) = plan.pipes.binary_search(&i) {
                list.add(group, name, "loss_j", "J", Source::PipeLost(pipe));
                list.add(group, name, "stored_j", "J", Source::PipeStored(pipe));
            }
            let beside = |coupling: &Coupling| coupling.edges.iter().any(|edge| edge.index() == i);
            if plan.network.couplings.iter().any(beside) {
                list.add(group, name, "q_flow_w", "W", Source::EdgeHeat(i));
            }
        }
        Element::HeatExchanger(_) => {
            list.add(group, name, "q_flow_w", "W", Source::EdgeHeat(i));
            list.add(group, name, "t_out_k", "K", Source::EdgeVolume(i));
        }
        _ => {}
    }
}

fn udunits(suffix: &str) -> &'static str {
    match suffix {
        "kg_s" => "kg s-1",
        "m3_s" => "m3 s-1",
        "pa" => "Pa",
        "k" => "K",
        "w" => "W",
        "w_m2" => "W m-2",
        "m_s" => "m s-1",
        "rad" => "rad",
        _ => "1",
    }
}

/// The value of a channel now.
pub(crate) fn value(plan: &Plan, state: &State, source: Source) -> f64 {
    let network = &state.network;
    let heat = |edge: usize| network.q_flow_w[edge];
    match source {
        Source::NodePressure(i) => network.p_pa[i],
        Source::NodeTemperature(i) => network.t_node_k[i],
        Source::NodeExchange(i) => network.exchange_kg_s[i],
        Source::MeterHeat(i) => state.meters[i].q_flow_w,
        Source::MeterEnergy(i) => state.meters[i].heat_j,
        Source::MeterVolume(i) => state.meters[i].volume_m3,
        Source::VesselGas(i) => state.vessels[i].gas_m3,
        Source::EdgeFlow(i) => network.m_flow_kg_s[i],
        Source::EdgePressure(i) => network.dp_pa(&plan.network, i),
        Source::EdgePosition(i) => network.position[i],
        Source::PumpSpeed(i) => match &plan.network.edges[i].element {
            Element::Pump(pump) => {
                pump.speed(network.m_flow_kg_s[i], &network.edge_state(&plan.network, i))
            }
            _ => network.position[i],
        },
        Source::EdgePower(i) => plan.electric_w(network, i),
        Source::PipeEnd(i, port) => network.pipe_end_k(&plan.network, i, port).unwrap_or(f64::NAN),
        Source::EdgeLoss(i) => network.q_loss_w[i],
        Source::PipeLost(pipe) => state.pipes.get(pipe).map_or(0.0, |pipe| pipe.lost_j),
        Source::PipeStored(pipe) => stored_j(plan, state, pipe),
        Source::Soil(i) => network.ring_k(&plan.network.soil[i]),
        Source::SoilLoss(i) => network.q_ground_w[i],
        Source::EdgeHeat(i) => heat(i),
        Source::EdgeVolume(i) => network.t_edge_k[i],
        Source::StationFlow(i) => plan.stations[i].m_flow_kg_s(network),
        Source::StationHeat(i) => heat(plan.stations[i].edge.index()),
        Source::StationEnergy(i) => state.station_heat_j[i],
        Source::StationRequest(i) => plan.stations[i]
            .requested_m_flow_kg_s
            .unwrap_or_else(|| state.stations[i].demand.m_flow_kg_s()),
        Source::StationBlocked(i) => f64::from(u8::from(state.stations[i].blocked)),
        Source::WorstPoint(i) => {
            let pairs = plan.worst_points[i].between.iter();
            pairs.map(|&(a, b)| network.p_pa[a] - network.p_pa[b]).fold(f64::INFINITY, f64::min)
        }
        Source::UnitOutput(i) => state.unit_outputs[i],
        Source::UnitFlow(slot) => state.unit_ports[slot].m_flow_kg_s,
        Source::UnitInlet(slot) => state.unit_ports[slot].t_in_k,
        Source::UnitOutlet(slot) => state.unit_ports[slot].t_out_k,
        Source::UnitHeat(slot) => {
            let port = &state.unit_ports[slot];
            let capacity_w_k = port.m_flow_kg_s.abs() * plan.network.medium.heat_capacity_j_kg_k;
            capacity_w_k * (port.t_out_k - port.t_in_k)
        }
        Source::PumpSwing(i) => match state.swings[i].said {
            Said::Quiet => 0.0,
            Said::Oscillating => 1.0,
            Said::Hunting => 2.0,
        },
        Source::Sensor(i) => state.sensors[i].value(),
        Source::ControllerState(i) => state.controller_states[i],
        Source::Signal(id) => state.signals[id.index()],
        Source::TotalElectric => plan.total_electric_w(network),
        Source::TotalUnits => plan.total_units_w(network),
        Source::UnitsElectric => state.unit_exchange.iter().map(|e| e.electric_w).sum(),
        Source::UnitsExternal => state.unit_exchange.iter().map(|e| e.external_w).sum(),
        Source::TotalPumpHeat => plan.total_pump_heat_w(network),
        Source::TotalFriction => network.q_friction_w,
        Source::TotalLoss => plan.total_loss_w(network),
        Source::TotalBoundary => network.boundary_w,
        Source::Stored => network.stored_j(&plan.network),
        Source::Cumulative(Cumulative::Electric) => state.electric_j,
        Source::Cumulative(Cumulative::Units) => state.units_j,
        Source::Cumulative(Cumulative::UnitsElectric) => state.units_electric_j,
        Source::Cumulative(Cumulative::UnitsExternal) => state.units_external_j,
        Source::Cumulative(Cumulative::PumpHeat) => state.pump_heat_j,
        Source::Cumulative(Cumulative::Friction) => state.friction_j,
        Source::Cumulative(Cumulative::Loss) => state.loss_j,
        Source::Cumulative(Cumulative::Boundary) => state.boundary_j,
    }
}
