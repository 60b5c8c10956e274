//! Mixing by the momentum of water that enters: the jet of an inlet.
//!
//! **Equation** the layer of an inlet exchanges `m_e = a m/(1 + Ri/Ri_c)` with each of its neighbours, `Ri = g beta |T_in - T_l| d/v^2`,
//! `v = m/(rho pi d^2/4)`: a strong stream of the temperature of its layer mixes most, a weak hot one hardly. **Assumptions**
//! water of 50 degC (`beta`); the neighbours only. **Validity** mixed layers. **Numerics** a conductance `cp m_e` beside that of
//! conduction: implicit, conserves heat. **Sources** form of the law: effect T4 of the catalogue; `kleinbach1993`.

use super::layers::Cells;
use super::ports::{MAX_PORTS, Openings};
use anergy_core::port::PortFlow;
use std::f64::consts::PI;

const GRAVITY_M_S2: f64 = 9.81;
/// Thermal expansion of water of 50 degC, 1/K.
const EXPANSION_1_K: f64 = 4.6e-4;

/// The jets of a storage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Jet {
    pub(super) share: f64,
    pub(super) richardson: f64,
    pub(super) diameter_m: f64,
    pub(super) density_kg_m3: f64,
    pub(super) heat_capacity_j_kg_k: f64,
}

impl Jet {
    /// Flow that is exchanged with each neighbour, kg/s.
    fn exchanged_kg_s(&self, m_flow_kg_s: f64, difference_k: f64) -> f64 {
        let d = self.diameter_m;
        let v = m_flow_kg_s / (self.density_kg_m3 * 0.25 * PI * d * d);
        let ri = GRAVITY_M_S2 * EXPANSION_1_K * difference_k.abs() * d / (v * v);
        self.share * m_flow_kg_s / (1.0 + ri / self.richardson)
    }

    /// Conductance between each layer and the one above, W/K.
    pub(super) fn conductances_w_k<const N: usize>(
        &self,
        openings: &Openings,
        streams: &[PortFlow],
        positions: &[f64; MAX_PORTS],
        cells: &Cells<N>,
    ) -> [f64; N] {
        let mut conductances = [0.0; N];
        for opening in &openings.0 {
            let stream = &streams[opening.port];
            let flow = opening.entering_tank_kg_s(stream.m_flow_kg_s, positions[opening.port]);
            if flow <= 0.0 {
                continue;
            }
            let layer = opening.layer;
            let exchanged = self.exchanged_kg_s(flow, stream.t_in_k - cells.t_k[layer]);
            let w_k = self.heat_capacity_j_kg_k * exchanged;
            if layer + 1 < cells.count {
                conductances[layer] += w_k;
            }
            if layer > 0 {
                conductances[layer - 1] += w_k;
            }
        }
        conductances
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strong_jet_mixes_and_a_hot_weak_one_hardly() {
        // d = 25 mm, 0.2 kg/s: v = 0.2/(1000 4.909e-4) = 0.4074 m/s; 20 K: Ri = 9.81 4.6e-4 20 0.025/0.16600 = 0.013593.
        // 0.3 0.2/1.013593 = 0.059195 kg/s; at 0.02 kg/s Ri = 1.3593: 0.3 0.02/2.3593 = 0.0025431
        let jet = Jet {
            share: 0.3,
            richardson: 1.0,
            diameter_m: 0.025,
            density_kg_m3: 1000.0,
            heat_capacity_j_kg_k: 4180.0,
        };
        assert!((jet.exchanged_kg_s(0.2, 20.0) / 0.059_195 - 1.0).abs() < 1e-3);
        assert!((jet.exchanged_kg_s(0.02, 20.0) / 0.002_543_1 - 1.0).abs() < 1e-3);
        assert_eq!(jet.exchanged_kg_s(0.2, 0.0), 0.06);
    }
}
