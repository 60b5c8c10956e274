//! Circuits: names of ports to slots.

use super::Builder;
use super::units::Houses;
use crate::diagnostic::did_you_mean;
use crate::model::{CircuitSpec, UnitSpec};
use crate::plan::PlannedCircuit;
use anergy_prosumer::circuit::{Circuit, MOST_MEMBERS};
use smol_str::SmolStr;

impl Houses {
    /// Unit and port of a member of a circuit.
    fn member(&self, name: &str) -> Option<(usize, usize)> {
        let alone = self.by_name.get(name).copied();
        if let Some(unit) = alone.filter(|unit| self.ports[*unit].len() == 1) {
            return Some((unit, 0));
        }
        let (unit, port) = name.rsplit_once('.')?;
        let unit = *self.by_name.get(unit)?;
        let port = self.ports[unit].iter().position(|own| own.name == port)?;
        Some((unit, port))
    }

    /// What members of circuits can be called.
    fn names(&self, units: &[UnitSpec]) -> Vec<String> {
        let names = units.iter().zip(&self.ports).flat_map(|(unit, ports)| {
            ports.iter().map(move |port| match ports.len() {
                1 => unit.id.to_string(),
                _ => format!("{}.{}", unit.id, port.name),
            })
        });
        names.collect()
    }
}

impl Builder<'_> {
    /// A circuit with its members; `None` after a report.
    pub(super) fn circuit<'m>(
        &mut self,
        spec: &'m CircuitSpec,
        houses: &Houses,
        circuit_of: &mut [Option<&'m str>],
    ) -> Option<PlannedCircuit> {
        let what = format!("circuit \"{}\"", spec.id);
        let through = spec.place.of("through");
        let mut members = Vec::new();
        for name in &spec.through {
            let Some((unit, port)) = houses.member(name) else {
                let of_wrong = |(unit, spec): (usize, &UnitSpec)| {
                    houses.equipment[unit].is_none() && name.starts_with(spec.id.as_str())
                };
                if !self.model.units.iter().enumerate().any(of_wrong) {
                    let names = houses.names(&self.model.units);
                    let hint = did_you_mean(name, names.iter().map(String::as_str))
                        .or_else(|| self.ports_hint(name, houses));
                    let message = format!("{what}: there is no port \"{name}\"");
                    self.report(message, through.clone(), hint);
                }
                return None;
            };
            let slot = houses.slots[unit].start + port;
            if let Some(before) = circuit_of[slot].replace(&spec.id) {
                let message = match before == spec.id {
                    true => format!("{what}: passes \"{name}\" twice"),
                    false => format!("{what}: \"{name}\" is in circuit \"{before}\" already"),
                };
                let hint = "each port is in one circuit: a storage takes several `ports`";
                self.report(message, through.clone(), Some(hint.into()));
                return None;
            }
            members.push((unit, port, slot));
        }
        let least = if spec.branch.is_some() { 1 } else { 2 };
        if !(least..=MOST_MEMBERS).contains(&members.len()) {
            let ports = if members.len() == 1 { "port" } else { "ports" };
            let message = format!("{what}: passes {} {ports}", members.len());
            let hint = format!("a circuit passes 2 to {MOST_MEMBERS}, and returns to the first");
            self.report(message, through, Some(hint));
            return None;
        }
        let port = |&(unit, port, _): &(usize, usize, usize)| &houses.ports[unit][port];
        let mut drivers = members.iter().filter(|member| port(member).sets_flow);
        let driver = drivers.next();
        let names: Vec<&str> = spec.through.iter().map(SmolStr::as_str).collect();
        let drivers = usize::from(driver.is_some()) + drivers.count();
        match (drivers, spec.v_flow_m3_s) {
            (1, None) | (0, Some(0.0..)) => {}
            // A branch without a pump takes what comes.
            (0, None) if spec.branch.is_some() => {}
            (0, None) => {
                let message = format!("{what}: nothing sets its flow");
                let hint = format!("none of {} has a pump: give v_flow_l_min", names.join(", "));
                self.report(message, through, Some(hint));
                return None;
            }
            (0, Some(v_flow)) => {
                let message = format!("{what}: v_flow_m3_s = {v_flow} must not be negative");
                self.report(message, spec.place.of("v_flow_m3_s"), None);
                return None;
            }
            _ => {
                let message = format!("{what}: its flow is set more than once");
                let setting =
                    members.iter().zip(&names).filter(|(member, _)| port(member).sets_flow);
                let mut setting: Vec<&str> = setting.map(|(_, name)| *name).collect();
                setting.extend(spec.v_flow_m3_s.map(|_| "v_flow_m3_s"));
                let hint = format!("by {}: one is enough", setting.join(" and "));
                self.report(message, through, Some(hint));
                return None;
            }
        }
        Some(PlannedCircuit {
            name: spec.id.clone(),
            circuit: Circuit {
                members: members.iter().map(|(_, _, slot)| *slot).collect(),
                driver: driver.map(|(_, _, slot)| *slot),
            },
            v_flow: None,
            leads: members
                .iter()
                .filter(|member| port(member).leads)
                .map(|(unit, port, _)| (*unit, *port))
                .collect(),
        })
    }

    /// The ports of the unit that a name begins with.
    fn ports_hint(&self, name: &str, houses: &Houses) -> Option<String> {
        let unit = self.model.units.iter().position(|unit| {
            name.strip_prefix(unit.id.as_str())
                .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        })?;
        let ports: Vec<&str> = houses.ports[unit].iter().map(|port| port.name.as_str()).collect();
        Some(format!("the ports of \"{}\" are {}", self.model.units[unit].id, ports.join(", ")))
    }
}
