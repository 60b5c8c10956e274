//! Heat exchange of two streams: effectiveness and number of transfer units.
//!
//! **Equation** `Q = eps Cmin (T1 - T2)`, `NTU = UA/Cmin`, `Z = Cmin/Cmax`; counter-flow
//! `eps = (1 - e^(-NTU(1-Z)))/(1 - Z e^(-NTU(1-Z)))`, `NTU/(1+NTU)` for `|1-Z|` inside the band;
//! parallel flow `eps = (1 - e^(-NTU(1+Z)))/(1+Z)`. Films:
//! `1/UA = 1/hA1 + 1/hA2`, `hA_i = hA_i,nom (|m_i|/m_i,nom)^n`, `hA1_nom/hA2_nom = (m1nom/m2nom)^n`.
//!
//! **Assumptions** steady effectiveness, no heat to the surroundings. **Numerics** heat vanishes
//! linearly with the smaller flow, in both arrangements with the same slope, so that a stream that turns round
//! needs no blend; no division by a flow. **Sources** `incropera2007`, `wetter2014`.

use crate::two_port::Exchanger;
use anergy_core::effectiveness::counter_flow;

/// Heat conductance between the inlet temperatures, W/K: `Q = conductance (T1 - T2)`.
///
/// `sense_as_nominal` is false when exactly one of the two streams runs against its nominal direction.
pub fn inlet_conductance_w_k(
    exchanger: &Exchanger,
    m1_kg_s: f64,
    m2_kg_s: f64,
    heat_capacity_j_kg_k: f64,
    sense_as_nominal: bool,
) -> f64 {
    let (m1, m2) = (m1_kg_s.abs(), m2_kg_s.abs());
    let (c_min, c_max) = (m1.min(m2) * heat_capacity_j_kg_k, m1.max(m2) * heat_capacity_j_kg_k);
    if c_min <= f64::MIN_POSITIVE {
        return 0.0;
    }
    let ntu = ua_w_k(exchanger, m1, m2) / c_min;
    let z = c_min / c_max;
    let eps = if exchanger.counter_flow == sense_as_nominal {
        counter_flow(ntu, z, exchanger.equal_capacity_band)
    } else {
        // 1 - e^(-x) without cancellation
        -(-ntu * (1.0 + z)).exp_m1() / (1.0 + z)
    };
    eps * c_min
}

fn ua_w_k(exchanger: &Exchanger, m1: f64, m2: f64) -> f64 {
    let n = exchanger.flow_exponent;
    if n == 0.0 {
        return exchanger.ua_nominal_w_k;
    }
    let (m1_nominal, m2_nominal) =
        (exchanger.m_flow_nominal_kg_s, exchanger.m_flow_nominal_secondary_kg_s);
    let ratio = (m1_nominal / m2_nominal).powf(n);
    let h1 = exchanger.ua_nominal_w_k * (1.0 + ratio) * (m1 / m1_nominal).powf(n);
    let h2 = exchanger.ua_nominal_w_k * (1.0 + ratio) / ratio * (m2 / m2_nominal).powf(n);
    h1 * h2 / (h1 + h2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exchanger(band: f64, exponent: f64) -> Exchanger {
        Exchanger {
            ua_nominal_w_k: 5955.0,
            flow_exponent: exponent,
            m_flow_nominal_kg_s: 0.358,
            m_flow_nominal_secondary_kg_s: 0.358,
            counter_flow: true,
            equal_capacity_band: band,
            volume_kg: 1.0,
            wall_kg: 0.0,
        }
    }

    #[test]
    fn nominal_substation() {
        // NTU = 5955/(0.358 * 4180) = 3.980, eps = 3.980/4.980 = 0.7992, 70/45 degC: 29.9 kW
        for exponent in [0.0, 0.7] {
            let g = inlet_conductance_w_k(&exchanger(1e-6, exponent), 0.358, 0.358, 4180.0, true);
            assert!((g * 25.0 - 29_900.0).abs() < 20.0, "{g}");
        }
    }

    #[test]
    fn equal_capacity_limit_is_continuous() {
        let at = |m2: f64| inlet_conductance_w_k(&exchanger(1e-6, 0.0), 0.358, m2, 4180.0, true);
        assert!((at(0.358 * (1.0 + 2e-6)) / at(0.358) - 1.0).abs() < 1e-5);
        assert!((at(0.358 * (1.0 + 0.5e-6)) / at(0.358) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_stream_that_turns_round_makes_no_jump() {
        for exponent in [0.0, 0.7] {
            let x = exchanger(1e-6, exponent);
            let small = 1e-4 * 0.358;
            let [forward, back] =
                [true, false].map(|sense| inlet_conductance_w_k(&x, small, 0.3, 4180.0, sense));
            assert!((forward / (small * 4180.0) - 1.0).abs() < 1e-3, "{forward}");
            assert!((back / forward - 1.0).abs() < 1e-3, "{back} {forward}");
        }
    }

    #[test]
    fn vanishes_linearly_and_parallel_is_weaker() {
        let x = exchanger(1e-6, 0.7);
        assert_eq!(inlet_conductance_w_k(&x, 0.0, 0.3, 4180.0, true), 0.0);
        assert!((inlet_conductance_w_k(&x, 1e-9, 0.3, 4180.0, true) / 4.18e-6 - 1.0).abs() < 1e-9);
        let counter = inlet_conductance_w_k(&x, 0.3, 0.3, 4180.0, true);
        let parallel = inlet_conductance_w_k(&x, 0.3, 0.3, 4180.0, false);
        assert!(parallel < counter && parallel < 0.5 * 0.3 * 4180.0 + 1e-9);
    }
}
