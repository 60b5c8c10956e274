//! Valves of a model that are open for a share of each period.

use super::Builder;
use crate::plan::Pulse;
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
use anergy_network::elements::ElementParams;

impl Builder<'_> {
    /// The pulsing valves in the order of their edges, and which of them each edge is.
    pub(super) fn pulses(
        &mut self,
        commands: &[Option<SignalId>],
    ) -> (Vec<Pulse>, Vec<Option<usize>>) {
        let (mut pulses, mut pulse_of) = (Vec::new(), vec![None; commands.len()]);
        for (edge, spec) in self.model.edges.iter().enumerate() {
            let ElementParams::Valve(valve) = &spec.params else { continue };
            let Some(period_s) = valve.pulse_period_s else { continue };
            // Free of its command by a prescription.
            let Some(command) = commands[edge] else {
                let message = format!("edge \"{}\": a pulsing valve cannot be left free", spec.id);
                self.report(message, spec.place.of("pulse_period_s"), None);
                continue;
            };
            match Time::from_s(period_s).filter(|period| *period > Time::ZERO) {
                Some(period) => {
                    pulse_of[edge] = Some(pulses.len());
                    pulses.push(Pulse { edge, command, period });
                }
                None => {
                    let message = format!(
                        "edge \"{}\": pulse_period_s = {period_s} is beyond what can be simulated",
                        spec.id
                    );
                    self.report(message, spec.place.of("pulse_period_s"), None);
                }
            }
        }
        (pulses, pulse_of)
    }
}
