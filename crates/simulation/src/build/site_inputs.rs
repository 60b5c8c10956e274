//! Inputs of units that follow the other units of their site, and outputs that are watched.

use super::Builder;
use super::signals::Writer;
use crate::diagnostic::did_you_mean;
use crate::plan::{OfSite, Plan, SiteInput, UnitFlag};
use crate::wording::refused;
use anergy_core::ids::SignalId;
use anergy_prosumer::equipment::Equipment;
use anergy_prosumer::equipment::grid_connection::PUMPS;
use anergy_prosumer::thermal_unit::{
    OF_SITE, SITE_COGENERATED, SITE_ELECTRICITY, SITE_GRID, SITE_REACTIVE,
};
use std::collections::HashMap;

/// The site in front of a name; empty where there is none.
fn site(name: &str) -> &str {
    name.split_once('.').map_or("", |(site, _)| site)
}

/// The name of a unit within its site.
fn name_at_site(name: &str) -> &str {
    name.split_once('.').map_or(name, |(_, name)| name)
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
                SITE_REACTIVE => (reactive(plan, unit), 3),
                SITE_COGENERATED => {
                    let others = others(plan, unit).map(|other| &plan.units[other]);
                    let burning = others.filter(|other| other.output("fuel_w").is_some());
                    let places = burning.filter_map(|other| other.output("generated_w"));
                    (OfSite::Outputs(places.collect()), 1)
                }
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
        for flag in planned.equipment.flags() {
            if let Some(output) = planned.output(flag.output) {
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

fn reactive(plan: &Plan, unit: usize) -> OfSite {
    let Equipment::GridConnection(connection) = &plan.units[unit].equipment else {
        return OfSite::Outputs(Vec::new());
    };
    let own = site(&plan.units[unit].name);
    let shares = others(plan, unit).filter_map(|other| {
        let share = connection.reactive_share(name_at_site(&plan.units[other].name))?;
        Some((other, share))
    });
    let at_site = plan.pumps.iter().filter(|pump| site(&plan.edge_names[**pump]) == own);
    let pumps = at_site.filter_map(|pump| Some((*pump, connection.reactive_share(PUMPS)?)));
    OfSite::Reactive { units: shares.collect(), pumps: pumps.collect() }
}

impl Builder<'_> {
    /// A power factor of a unit that is not there would be without effect.
    pub(super) fn check_power_factors(&mut self, plan: &Plan) {
        for (unit, spec) in self.model.units.iter().enumerate() {
            let Equipment::GridConnection(connection) = &plan.units[unit].equipment else {
                continue;
            };
            let known: Vec<&str> =
                others(plan, unit).map(|other| name_at_site(&plan.units[other].name)).collect();
            for name in connection.with_power_factor() {
                if name != PUMPS && !known.contains(&name) {
                    let what = format!("unit \"{}\"", plan.units[unit].name);
                    let message = format!("power_factor: its site has no unit \"{name}\"");
                    let problem = refused(&what, &spec.place, Some("power_factor"), &message);
                    let names = known.iter().copied().chain([PUMPS]);
                    let hint = did_you_mean(name, names)
                        .unwrap_or_else(|| format!("units of its site: {}", known.join(", ")));
                    self.problems.push(problem.with_hint(hint));
                }
            }
        }
    }
}

fn outputs(plan: &Plan, unit: usize, name: &str) -> Vec<usize> {
    others(plan, unit).filter_map(|other| plan.units[other].output(name)).collect()
}
