//! Actuators follow their commands, and where it is so, the flow.

use super::Simulation;
use crate::error::RunError;

/// Rounds of set heads and flows at the start; what has not settled then does so in the run.
const MAX_HEAD_ROUNDS: usize = 100;

impl Simulation {
    /// Set heads that rise with the flow start where the flow has them.
    pub(super) fn settle_heads(&mut self) -> Result<(), RunError> {
        for _ in 0..MAX_HEAD_ROUNDS {
            let mut moved = false;
            for (edge, command) in self.plan.commands.iter().enumerate() {
                let follows = self.plan.network.edges[edge].element.follows_flow();
                if let Some(command) = command.filter(|_| follows) {
                    let network = &mut self.state.network;
                    let (before, command) =
                        (network.position[edge], self.state.signals[command.index()]);
                    network.advance_actuator(&self.plan.network, edge, command, f64::INFINITY);
                    moved |= network.position[edge] != before;
                }
            }
            if !moved {
                break;
            }
            self.solve_hydraulics()?;
        }
        Ok(())
    }

    /// Actuators have arrived where their commands lead.
    pub(crate) fn arrive(&mut self) {
        self.move_actuators(f64::INFINITY);
    }

    /// Actuators follow their commands; an infinite `dt_s` settles them. The extraction valve of a
    /// station waits for its pump.
    pub(super) fn move_actuators(&mut self, dt_s: f64) {
        for (edge, command) in self.plan.commands.iter().enumerate() {
            if let (Some(command), None) = (command, self.plan.station_of_valve[edge]) {
                // Settled, a pulsing valve has its mean opening.
                let pulse = self.plan.pulse_of[edge].filter(|_| dt_s.is_finite());
                let command = match pulse {
                    Some(pulse) => self.pulse_command(pulse),
                    None => self.state.signals[command.index()],
                };
                let network = &mut self.state.network;
                network.advance_actuator(&self.plan.network, edge, command, dt_s);
            }
        }
        let (plan, network) = (&self.plan, &mut self.state.network);
        for (edge, command) in plan.commands.iter().enumerate() {
            if let (Some(command), Some(station)) = (command, plan.station_of_valve[edge]) {
                let open = plan.stations[station].valve_may_open(network);
                let command = if open { self.state.signals[command.index()] } else { 0.0 };
                network.advance_actuator(&plan.network, edge, command, dt_s);
            }
        }
        network.advance_regulators(&plan.network, dt_s);
    }
}
