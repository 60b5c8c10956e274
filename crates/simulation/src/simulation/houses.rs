//! Houses: units say what they want of their ports, circuits go round, units take what they got.

use super::Simulation;
use crate::automatic_step::Step;
use crate::error::RunError;
use crate::plan::{PlannedCircuit, PlannedDrive, PlannedUnit};
use anergy_core::clock::Time;
use anergy_core::recorder::{Event, Severity};
use anergy_core::signal::Signals;
use anergy_prosumer::circuit::Undefined;
use anergy_prosumer::coupling::{BranchFlows, MOST_BRANCHES};
use anergy_prosumer::thermal_unit::UnitPort;

impl Simulation {
    /// Units say what they want of their ports in a step of `dt_s`, or in a steady state (0); those that take the
    /// flow of a circuit and also ask for one hear it first.
    pub(super) fn request_units(&mut self, dt_s: f64) {
        let (plan, state) = (&self.plan, &mut self.state);
        for unit in &plan.units {
            unit.equipment.begin(dt_s, &mut state.unit_states[unit.state.clone()]);
        }
        for unit in 0..self.plan.units.len() {
            self.request_unit(unit);
        }
        for circuit in 0..self.plan.circuits.len() {
            let m_flow_kg_s = self.circuit_kg_s(circuit);
            let circuit = &self.plan.circuits[circuit].circuit;
            for slot in circuit.members.iter().filter(|slot| Some(**slot) != circuit.driver) {
                self.state.unit_ports[*slot].m_flow_kg_s = m_flow_kg_s;
            }
        }
        for coupling in 0..self.plan.couplings.len() {
            let (flows, _) = self.branch_flows(coupling);
            let planned = &self.plan.couplings[coupling];
            for ((circuit, branch), flow) in
                planned.circuits.iter().zip(&planned.coupling.branches).zip(flows)
            {
                let driver = circuit.circuit.driver;
                for slot in branch.members.iter().filter(|slot| Some(**slot) != driver) {
                    self.state.unit_ports[*slot].m_flow_kg_s = flow;
                }
            }
        }
        for unit in 0..self.plan.units.len() {
            if self.plan.units[unit].hears_flows() {
                self.request_unit(unit);
            }
        }
        let (plan, state) = (&self.plan, &mut self.state);
        for (port, place) in plan.grid_ports.iter().enumerate() {
            let mut wanted = self.wanted[place.slot];
            wanted.m_flow_kg_s *= place.direction;
            state.network.requests[port] = wanted;
            if let Some(command) = place.imposes_flow {
                state.signals[command.index()] = wanted.m_flow_kg_s;
            }
        }
    }

    /// The end of a step that begins now and is as long as the units follow, with the flows that they asked for; equal parts
    /// of the step.
    pub(super) fn followed_until(&self, now: Time, end: Time) -> Time {
        let (plan, state) = (&self.plan, &self.state);
        let longest = plan.units.iter().map(|unit| {
            let (ports, own) = (unit.slots.clone(), unit.state.clone());
            unit.equipment.longest_step_s(&state.unit_ports[ports], &state.unit_states[own])
        });
        let longest_s = longest.fold(f64::INFINITY, f64::min);
        let step = end - now;
        if step.as_s() <= longest_s {
            return end;
        }
        let parts = (step.as_s() / longest_s).ceil();
        now + Time((step.0 as f64 / parts) as i64)
    }

    fn request_unit(&mut self, unit: usize) {
        let (unit, state) = (&self.plan.units[unit], &mut self.state);
        unit.equipment.request(
            &Signals(&state.signals[unit.inputs.clone()]),
            &state.unit_ports[unit.slots.clone()],
            &mut state.unit_states[unit.state.clone()],
            &mut self.wanted[unit.slots.clone()],
        );
    }

    /// Flow of a circuit, kg/s.
    fn circuit_kg_s(&self, circuit: usize) -> f64 {
        self.pumped_kg_s(&self.plan.circuits[circuit])
    }

    /// Flows of the branches of a coupling, kg/s, and whether they settled.
    fn branch_flows(&self, coupling: usize) -> (BranchFlows, bool) {
        let planned = &self.plan.couplings[coupling];
        let mut wanted_kg_s = [0.0; MOST_BRANCHES];
        for (wanted, circuit) in wanted_kg_s.iter_mut().zip(&planned.circuits) {
            *wanted = self.pumped_kg_s(circuit);
        }
        planned.coupling.flows(&wanted_kg_s)
    }

    /// What the pump of a circuit is asked for, kg/s.
    fn pumped_kg_s(&self, planned: &PlannedCircuit) -> f64 {
        match planned.v_flow {
            Some(signal) => {
                self.state.signals[signal.index()] * self.plan.network.medium.density_kg_m3
            }
            None => planned.circuit.m_flow_kg_s(&self.wanted),
        }
    }

    /// Stations tell their pumps what the units want; a direction that is not there is not served.
    pub(super) fn drive_stations(&mut self) {
        for planned in &self.plan.drives {
            let state = &mut self.state;
            let wanted = state.network.requests[planned.port].m_flow_kg_s;
            let wanted = wanted * state.signals[planned.participation.index()];
            let memory = &mut state.stations[planned.station];
            memory.demand = planned.drive.demand(wanted, memory);
            // One pump for both directions gets what is asked for in either.
            let shared = planned.feed_in == planned.extraction;
            let delivered =
                |own_kg_s: f64| if shared { memory.demand.m_flow_kg_s().abs() } else { own_kg_s };
            let sets = [
                (planned.feed_in, delivered(memory.demand.feed_in_kg_s)),
                (planned.extraction, delivered(memory.demand.extraction_kg_s)),
                (planned.feed_in_open, f64::from(memory.demand.feed_in_kg_s > 0.0)),
                (planned.extraction_open, f64::from(memory.demand.extraction_kg_s > 0.0)),
            ];
            for (signal, value) in sets {
                if let Some(signal) = signal.filter(|signal| !state.taken_over[signal.index()]) {
                    state.signals[signal.index()] = value;
                }
            }
        }
    }

    /// Stations remember in which direction they delivered.
    pub(super) fn remember_directions(&mut self, dt_s: f64) {
        for planned in &self.plan.drives {
            let wanted = self.state.network.requests[planned.port].m_flow_kg_s;
            let wanted = wanted * self.state.signals[planned.participation.index()];
            planned.drive.remember(wanted, dt_s, &mut self.state.stations[planned.station]);
        }
    }

    /// Units hear what the network gave, circuits go round, and units advance.
    pub(super) fn advance_units(&mut self, dt_s: f64) -> Result<(), RunError> {
        for (port, place) in self.plan.grid_ports.iter().enumerate() {
            let mut got = self.state.network.port_flows[port];
            got.m_flow_kg_s *= place.direction;
            self.state.unit_ports[place.slot] = got;
        }
        for port in 0..self.plan.grid_ports.len() {
            let place = self.plan.grid_ports[port];
            let unit = &self.plan.units[place.unit];
            let port = place.slot - unit.slots.start;
            if unit.ports[port].leads {
                self.respond(place.unit, port);
            }
        }
        // What a port that leads got is known before the others of its unit are passed.
        let leading = self.plan.circuits.partition_point(|circuit| !circuit.leads.is_empty());
        (0..leading).try_for_each(|circuit| self.go_round(circuit))?;
        (0..self.plan.couplings.len()).try_for_each(|coupling| self.meet(coupling))?;
        (leading..self.plan.circuits.len()).try_for_each(|circuit| self.go_round(circuit))?;
        self.advance_in_turn(dt_s);
        Ok(())
    }

    /// Warnings of stations whose control cannot follow steps like these.
    pub fn coarse_steps(&self, step: Step) -> Vec<Event> {
        let longest = step.longest();
        let coarse =
            |planned: &&PlannedDrive| planned.longest_step.is_some_and(|step| longest > step);
        let warn = |planned: &PlannedDrive| {
            let component = self.plan.station_names[planned.station].clone();
            let follows = planned.longest_step.unwrap_or_default();
            Event {
                time: self.state.time,
                severity: Severity::Warning,
                kind: "coarse_step".into(),
                message: format!(
                    "{component}: the control of its flow follows steps up to {follows}, not {longest}: \
                     write flow_control = \"quasi_steady\", or a shorter step in [run]"
                ),
                component,
            }
        };
        self.plan.drives.iter().filter(coarse).map(warn).collect()
    }

    /// Units of houses show what they hold before the first step; nothing moves.
    pub(super) fn show_units(&mut self) {
        let (plan, state) = (&self.plan, &mut self.state);
        let of_house = |unit: &&PlannedUnit| {
            unit.ports.is_empty() || unit.ports.iter().any(|p| p.name != UnitPort::ONLY.name)
        };
        for unit in plan.units.iter().filter(of_house) {
            let mut held = state.unit_states[unit.state.clone()].to_vec();
            unit.equipment.advance(
                0.0,
                &Signals(&state.signals[unit.inputs.clone()]),
                &state.unit_ports[unit.slots.clone()],
                &mut held,
                &mut state.unit_outputs[unit.outputs.clone()],
            );
        }
    }

    /// Tells a unit what its leading port got.
    fn respond(&mut self, unit: usize, port: usize) {
        let (unit, state) = (&self.plan.units[unit], &mut self.state);
        unit.equipment.respond(
            port,
            &Signals(&state.signals[unit.inputs.clone()]),
            &state.unit_ports[unit.slots.clone()],
            &mut state.unit_states[unit.state.clone()],
            &mut self.wanted[unit.slots.clone()],
        );
    }

    /// The temperatures around a circuit.
    fn go_round(&mut self, i: usize) -> Result<(), RunError> {
        let planned = &self.plan.circuits[i];
        let medium = &self.plan.network.medium;
        let m_flow_kg_s = self.circuit_kg_s(i);
        let solved = planned.circuit.solve(
            m_flow_kg_s,
            medium.heat_capacity_j_kg_k,
            &self.wanted,
            &mut self.state.unit_ports,
        );
        let settled = solved.map_err(|Undefined| RunError::UndefinedCircuit {
            time: self.state.time.to_string(),
            circuit: planned.name.to_string(),
        })?;
        self.note_settling(i, settled);
        for lead in 0..self.plan.circuits[i].leads.len() {
            let (unit, port) = self.plan.circuits[i].leads[lead];
            self.respond(unit, port);
        }
        Ok(())
    }

    /// The temperatures of the points of a coupling, and along its branches.
    fn meet(&mut self, i: usize) -> Result<(), RunError> {
        let (flows, balanced) = self.branch_flows(i);
        let planned = &self.plan.couplings[i];
        let heat_capacity_j_kg_k = self.plan.network.medium.heat_capacity_j_kg_k;
        let ports = &mut self.state.unit_ports;
        let solved = planned.coupling.solve(&flows, heat_capacity_j_kg_k, &self.wanted, ports);
        let settled = solved.map_err(|Undefined| RunError::UndefinedCircuit {
            time: self.state.time.to_string(),
            circuit: planned.circuits[0].name.to_string(),
        })?;
        self.note_settling(self.plan.circuits.len() + i, balanced && settled);
        for circuit in 0..self.plan.couplings[i].circuits.len() {
            for lead in 0..self.plan.couplings[i].circuits[circuit].leads.len() {
                let (unit, port) = self.plan.couplings[i].circuits[circuit].leads[lead];
                self.respond(unit, port);
            }
        }
        Ok(())
    }

    /// Counts a step in which a circuit, or behind them a coupling, did not settle; the first one is an event.
    fn note_settling(&mut self, place: usize, settled: bool) {
        if settled {
            return;
        }
        let before = self.state.unsettled[place];
        self.state.unsettled[place] += 1;
        if before > 0 {
            return;
        }
        let names = self.plan.circuits_at(place);
        let (component, s) = (names[0].to_owned(), if names.len() > 1 { "s" } else { "" });
        self.events.push(Event {
            time: self.state.time,
            severity: Severity::Warning,
            kind: "unsettled".into(),
            message: format!(
                "{component}: flows and temperatures of the circuit{s} {} did not settle: valves and limits of its \
                 units change each other; mass and heat still close. More such steps are counted in the summary",
                names.join(", ")
            ),
            component,
        });
    }

    /// Heat that the units hold, J above 0 degC.
    pub(crate) fn units_stored_j(&self) -> f64 {
        let units = self.plan.units.iter();
        units.map(|unit| unit.equipment.stored_j(&self.state.unit_states[unit.state.clone()])).sum()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::balance::summary;
    use crate::build::build;
    use crate::model::Model;
    use std::path::Path;

    #[test]
    fn what_does_not_settle_is_said_once_and_counted() {
        let text = "format = 1\n[run]\nstart = \"2023-02-13T00:00:00Z\"\n[weather]\nkind = \"synthetic\"\n\
                    latitude_deg = 48.1\nlongitude_deg = 11.6\n[[house]]\nsite = \"h\"\ntype = \"SF4\"\n\
                    connection = \"two_pipe\"\n";
        let model = Model::from_toml(text, Path::new(".")).unwrap();
        let mut simulation = Simulation::new(build(&model).unwrap()).unwrap();
        simulation.advance_to(Time::from_s(60.0).unwrap(), Time::from_s(60.0).unwrap()).unwrap();
        assert!(summary(&simulation, false).get("unsettled").is_none());
        let coupling = simulation.plan.circuits.len();
        for settled in [true, false, true, false] {
            simulation.note_settling(coupling, settled);
        }
        let said: Vec<Event> =
            simulation.take_events().filter(|event| event.kind == "unsettled").collect();
        let [event] = said.as_slice() else { panic!("{said:?}") };
        assert!(event.message.contains("h.charging, h.mixing, h.storage_pipes"), "{event:?}");
        assert_eq!(event.time, Time::from_s(60.0).unwrap());
        let counted = &summary(&simulation, false)["unsettled"][0];
        assert_eq!(
            (counted["steps"].as_u64(), counted["circuits"].as_array().map(Vec::len)),
            (Some(2), Some(3))
        );
    }
}
