//! Inputs of units that follow the other units of their site, and outputs that are watched.

use super::signals::Writer;
use crate::plan::{OfSite, Plan, SiteInput, UnitFlag};
use anergy_core::ids::SignalId;
use anergy_prosumer::thermal_unit::{OF_SITE, SITE_ELECTRICITY, SITE_GRID};
use std::collections::HashMap;

/// The site in front of a name; empty where there is none.
fn site(name: &str) -> &str {
    name.split_once('.').map_or("", |(site, _)| site)
}

/// Finds both, and the turns in which units advance: those that sum up others after them, batteries behind those,
/// connections to the grid last.
pub(super) fn find(plan: &mut Plan, writers: &HashMap<SignalId, Writer>) {
    let mut turns = vec![0; plan.units.len()];
    let mut found = Vec::new();
    for (unit, planned) in plan.units.iter().enumerate() {
        let ids = planned.inputs.clone().map(SignalId::from_index);
        for (signal, input) in ids.zip(planned.equipment.inputs()) {
            let Some(follows) = input.follows.filter(|_| !writers.contains_key(&signal)) else {
                continue;
            };
            let (of, turn) = match follows {
                SITE_ELECTRICITY => (electricity(plan, unit), 2),
                SITE_GRID => (electricity(plan, unit), 3),
                _ => match follows.strip_prefix(OF_SITE) {
                    // Of several households the share of all people, but the heat of all their machines.
                    Some(output) if input.max == 1.0 => {
                        (OfSite::Mean(outputs(plan, unit, output)), 1)
                    }
                    Some(output) => (OfSite::Outputs(outputs(plan, unit, output)), 1),
                    None => continue,
                },
            };
            if matches!(&of, OfSite::Outputs(places) | OfSite::Mean(places) if places.is_empty()) {
                continue;
            }
            found.push(SiteInput { unit, signal, of });
            turns[unit] = turn.max(turns[unit]);
        }
    }
    for (unit, turn) in plan.units.iter_mut().zip(turns) {
        unit.turn = turn;
    }
    plan.site_inputs = found;
    for (unit, planned) in plan.units.iter().enumerate() {
        let outputs = planned.equipment.outputs();
        for flag in planned.equipment.flags() {
            if let Some(place) = outputs.iter().position(|output| output.name == flag.output) {
                let output = planned.outputs.start + place;
                plan.flags.push(UnitFlag { unit, output, flag: *flag });
            }
        }
    }
    plan.initial.unit_flags = vec![false; plan.flags.len()];
}

/// The other units of a site.
fn others(plan: &Plan, unit: usize) -> impl Iterator<Item = usize> + '_ {
    let own = site(&plan.units[unit].name);
    let at_site = move |other: &usize| *other != unit && site(&plan.units[*other].name) == own;
    (0..plan.units.len()).filter(at_site)
}

fn electricity(plan: &Plan, unit: usize) -> OfSite {
    let own = site(&plan.units[unit].name);
    let at_site = |pump: &usize| site(&plan.edge_names[*pump]) == own;
    OfSite::Electricity {
        units: others(plan, unit).collect(),
        pumps: plan.pumps.iter().copied().filter(at_site).collect(),
    }
}

fn outputs(plan: &Plan, unit: usize, name: &str) -> Vec<usize> {
    let places = others(plan, unit).filter_map(|other| {
        let planned = &plan.units[other];
        let outputs = planned.equipment.outputs();
        let place = outputs.iter().position(|output| output.name == name)?;
        Some(planned.outputs.start + place)
    });
    places.collect()
}
