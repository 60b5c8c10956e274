//! When within a step a channel has its value.

use super::Source;
use crate::plan::Plan;
use anergy_network::two_port::EdgeThermal;

/// When within a step a channel has its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moment {
    /// It is the mean over the step, or follows from what enters as the mean over it: that of its middle.
    Middle,
    /// It is a state, or a sum, at the end of the step.
    End,
}

/// The moment of a channel.
pub(crate) fn moment(plan: &Plan, source: Source) -> Moment {
    let stored = match source {
        // What a volume holds; without one the water of the step passes.
        Source::NodeTemperature(i) => plan.network.nodes[i].volume_m3 > 0.0,
        Source::EdgeVolume(i) => match plan.network.edges[i].element.thermal() {
            EdgeThermal::Exchanger(exchanger) => exchanger.volume_kg > 0.0,
            _ => true,
        },
        Source::EdgePosition(i) => plan.network.edges[i].element.actuator().is_some(),
        Source::UnitOutput(i) => {
            let unit = plan.units.iter().find(|unit| unit.outputs.contains(&i));
            unit.is_some_and(|unit| {
                let output = &unit.equipment.outputs()[i - unit.outputs.start];
                output.is_state || ["J", "m3"].contains(&output.unit)
            })
        }
        Source::PipeEnd(..)
        | Source::PipeLost(_)
        | Source::PipeStored(_)
        | Source::Soil(_)
        | Source::MeterEnergy(_)
        | Source::MeterVolume(_)
        | Source::VesselGas(_)
        | Source::StationEnergy(_)
        | Source::Sensor(_)
        | Source::ControllerState(_)
        | Source::Signal(_)
        | Source::Stored
        | Source::Cumulative(_) => true,
        _ => false,
    };
    if stored { Moment::End } else { Moment::Middle }
}
