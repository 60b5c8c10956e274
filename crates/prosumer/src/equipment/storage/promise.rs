//! What a storage promises of the water that will leave it in the coming step.
//!
//! **Numerics** as in the coming step if it is like the last ([`Storage::expected`]); ports that had no flow
//! promise the water that is at their ends now.

use super::ports::{LayerFlows, MAX_PORTS};
use super::tank::{Conditions, Passed, Water};
use super::unit::{COILS, LAST_STEP_S, Storage};
use anergy_core::port::{Outlet, Port, PortFlow, PortRequest};
use anergy_core::signal::Signals;

impl Storage {
    /// The promises for the coming step.
    pub(super) fn promise<const N: usize>(
        &self,
        signals: &Signals<'_>,
        got: &[PortFlow],
        state: &[f64],
        wanted: &mut [PortRequest],
    ) {
        let tank = &self.tank;
        let coils = tank.coils.len();
        let mut coils_k = [0.0; MAX_PORTS];
        let water = self.water::<N>(state, &mut coils_k[..coils]);
        let positions = self.positions(signals);
        let dt_s = state[LAST_STEP_S];
        let with = Self::conditions(signals, dt_s, got, &positions, tank.rod.is_some());
        let expected = self.expected(&with, &water);
        for port in 0..tank.ports {
            let at = |end| {
                let mixed = tank.layers_are_cells();
                tank.openings.leaving_k(&water.cells, mixed, port, end, positions[port])
            };
            let (mut a_k, mut b_k) = (at(Port::A), at(Port::B));
            if let Some(passed) = expected.as_ref().filter(|_| got[port].m_flow_kg_s != 0.0) {
                let leaving = if got[port].m_flow_kg_s > 0.0 { &mut b_k } else { &mut a_k };
                *leaving = passed.outlets[port].constant_k;
            }
            wanted[port] = PortRequest { m_flow_kg_s: 0.0, outlet: Outlet::Ends { a_k, b_k } };
        }
        for (i, coil) in tank.coils.iter().enumerate() {
            let port = tank.ports + i;
            let line = match expected.as_ref().filter(|_| got[port].m_flow_kg_s != 0.0) {
                Some(passed) => passed.outlets[port],
                None => {
                    let stream = PortFlow { m_flow_kg_s: state[COILS + coils + i], ..got[port] };
                    let arriving = tank.coil_line(i, &water, &stream);
                    coil.flush(&mut { water.coils_k[i] }, arriving, &stream, dt_s)
                }
            };
            let outlet = Outlet::Linear { constant_k: line.constant_k, of_inlet: line.of_inlet };
            wanted[port] = PortRequest { m_flow_kg_s: 0.0, outlet };
        }
    }

    /// The coming step if it is like the last; `None` where what leaves has the temperature it has now.
    fn expected<const N: usize>(
        &self,
        with: &Conditions<'_>,
        water: &Water<'_, N>,
    ) -> Option<Passed> {
        let tank = &self.tank;
        let flows = |stream: &PortFlow| stream.m_flow_kg_s != 0.0;
        let (ports, coils) = with.streams.split_at(tank.ports);
        if with.dt_s <= 0.0 || !with.streams.iter().any(flows) {
            return None;
        }
        if tank.layers_are_cells() && !coils.iter().any(flows) {
            let layers =
                LayerFlows::<N>::new(&tank.openings, ports, with.positions, tank.layers.count);
            if tank.parts(with, &layers) == 1 {
                return None;
            }
        }
        let mut coils_k = [0.0; MAX_PORTS];
        let coils_k = &mut coils_k[..tank.coils.len()];
        coils_k.copy_from_slice(water.coils_k);
        let mut trial =
            Water { cells: water.cells.clone(), coils_k, rod_blocked: water.rod_blocked };
        Some(tank.pass(with, &mut trial))
    }
}
