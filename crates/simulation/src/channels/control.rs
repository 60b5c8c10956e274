//! Channels of sensors and controllers, which are known after the others: they measure them.

use super::{List, Source};
use crate::plan::Plan;
use anergy_control::controller::StateChannel;
use anergy_core::recorder::ChannelGroup;

/// Adds to the channels of a plan.
fn add(plan: &mut Plan, more: impl FnOnce(&mut List, &Plan)) {
    let channels = std::mem::take(&mut plan.channels);
    let mut list = List { channels, sources: std::mem::take(&mut plan.sources) };
    more(&mut list, plan);
    (plan.channels, plan.sources) = (list.channels, list.sources);
}

/// Adds the readings of the sensors.
pub(crate) fn add_sensors(plan: &mut Plan) {
    add(plan, sensors);
}

pub(super) fn sensors(list: &mut List, plan: &Plan) {
    for (i, sensor) in plan.sensors.iter().enumerate() {
        list.add(ChannelGroup::Control, &sensor.name, "value", &sensor.unit, Source::Sensor(i));
    }
}

/// Adds what a controller shows, whose state begins at a place among those of all.
pub(crate) fn add_controller(plan: &mut Plan, name: &str, shown: &[StateChannel], first: usize) {
    add(plan, |list, _| controller(list, name, shown, first));
}

/// What the controllers of a plan show.
pub(super) fn controllers(list: &mut List, plan: &Plan) {
    for planned in &plan.controllers {
        controller(list, &planned.name, planned.controller.channels(), planned.state.start);
    }
}

fn controller(list: &mut List, name: &str, shown: &[StateChannel], first: usize) {
    for channel in shown {
        let source = Source::ControllerState(first + channel.place);
        list.add(ChannelGroup::Control, name, channel.name, channel.unit, source);
    }
}
