//! Whether the water is still liquid: the validity of a run.
//!
//! **Validity** the range of the medium, 0.5 to 99 degC for water. Water can leave it at a node, in
//! the water behind an exchanger, and in a pipe whose surroundings lie outside; the water of an exchanger
//! lies between those that enter it.

use super::Simulation;
use crate::error::RunError;
use std::fmt::Display;

impl Simulation {
    /// Refuses water that would freeze or boil, or that has no temperature; `time` is for the message.
    pub(crate) fn check_temperatures(&self, time: &dyn Display) -> Result<(), RunError> {
        let (plan, state) = (&self.plan, &self.state.network);
        let (min_k, max_k) = plan.network.medium.range_k();
        let liquid = |t_k: &f64| (min_k..=max_k).contains(t_k);
        if let Some(i) = state.t_node_k.iter().position(|t_k| !liquid(t_k)) {
            return Err(self.left(time, &plan.node_names[i], state.t_node_k[i]));
        }
        if let Some(port) = state.t_secondary_k.iter().position(|t_k| !liquid(t_k)) {
            return Err(self.left(time, plan.unit_at(port), state.t_secondary_k[port]));
        }
        if !plan.circuits.is_empty() || !plan.couplings.is_empty() {
            for unit in &plan.units {
                let ports = &self.state.unit_ports[unit.slots.clone()];
                let ends = ports.iter().flat_map(|port| [port.t_in_k, port.t_out_k]);
                if let Some(t_k) = ends.into_iter().find(|t_k| !liquid(t_k)) {
                    return Err(self.left(time, &unit.name, t_k));
                }
            }
        }
        for (i, _) in state.surroundings_k.iter().enumerate().filter(|(_, t_k)| !liquid(t_k)) {
            let ends = state.parcels.iter(i).flat_map(|parcel| [parcel.t_a_k, parcel.t_b_k]);
            let cells = state.cells.water(i).into_iter().flatten().map(|(_, t_k)| t_k);
            let mut ends = ends.chain(cells);
            if let Some(t_k) = ends.find(|t_k| !liquid(t_k)) {
                return Err(self.left(time, &plan.edge_names[i], t_k));
            }
        }
        Ok(())
    }

    fn left(&self, time: &dyn Display, component: &str, t_k: f64) -> RunError {
        let (time, component) = (time.to_string(), component.to_owned());
        if !t_k.is_finite() {
            return RunError::NotFinite { time, component };
        }
        let medium = &self.plan.network.medium;
        let (min_degc, max_degc) = medium.range_degc();
        let t_degc = t_k - anergy_core::medium::ZERO_CELSIUS_K;
        RunError::Temperature { time, component, t_degc, what: medium.name(), min_degc, max_degc }
    }
}
