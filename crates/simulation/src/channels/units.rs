//! Channels of units and of their ports.

use super::{Cumulative, List, Source};
use crate::plan::Plan;
use anergy_core::recorder::ChannelGroup;
use anergy_prosumer::thermal_unit::UnitPort;

/// What the units show, and what passes the ports of those with several.
pub(super) fn outputs(list: &mut List, plan: &Plan) {
    for unit in &plan.units {
        for (k, output) in unit.equipment.outputs().iter().enumerate() {
            let source = Source::UnitOutput(unit.outputs.start + k);
            list.add(ChannelGroup::Units, &unit.name, &output.name, output.unit, source);
        }
        for (port, slot) in unit.ports.iter().zip(unit.slots.clone()) {
            if port.name == UnitPort::ONLY.name {
                continue;
            }
            let name = format!("{}.{}", unit.name, port.name);
            let group = ChannelGroup::Units;
            list.add(group, &name, "m_flow_kg_s", "kg s-1", Source::UnitFlow(slot));
            list.add(group, &name, "t_in_k", "K", Source::UnitInlet(slot));
            list.add(group, &name, "t_out_k", "K", Source::UnitOutlet(slot));
            list.add(group, &name, "q_flow_w", "W", Source::UnitHeat(slot));
        }
    }
}

/// What units exchange with the world outside of the network.
pub(super) fn balances(list: &mut List, plan: &Plan) {
    if plan.has_houses() {
        for (quantity, unit, source) in [
            ("units_electric_w", "W", Source::UnitsElectric),
            ("units_external_w", "W", Source::UnitsExternal),
            ("units_electric_j", "J", Source::Cumulative(Cumulative::UnitsElectric)),
            ("units_external_j", "J", Source::Cumulative(Cumulative::UnitsExternal)),
        ] {
            list.add(ChannelGroup::Balances, "network", quantity, unit, source);
        }
    }
}
