//! A plate exchanger between two streams of which each is known to the other only after a step.
//!
//! **Equation** counter-flow effectiveness, `Q = eps Cmin (T_a - T_b)`; the outlet of the first stream is
//! `T_a + eps Cmin/C_a (T_b - T_a)`. **Assumptions** constant UA, no heat to the surroundings, no content.
//! **Numerics** the first stream is cooled with its present inlet and the inlet of the other of the step before; what
//! it gave is what the other gets, so energy is exact. **Sources** `incropera2007`.

use crate::performance_map::Stream;
use anergy_core::effectiveness::counter_flow;
use anergy_core::port::Outlet;

/// Near equal capacities the limit form is used, relative.
const EQUAL_CAPACITY_BAND: f64 = 1e-6;
/// Halvings of the range of a flow that is sought: to rounding.
const HALVINGS: usize = 60;

/// Heat per difference of the inlet temperatures, W/K.
pub fn conductance_w_k(ua_w_k: f64, a_w_k: f64, b_w_k: f64) -> f64 {
    let (least, most) = (a_w_k.min(b_w_k), a_w_k.max(b_w_k));
    if least <= f64::MIN_POSITIVE {
        return 0.0;
    }
    counter_flow(ua_w_k / least, least / most, EQUAL_CAPACITY_BAND) * least
}

/// How the first stream leaves while the other arrives with a temperature.
pub fn outlet(ua_w_k: f64, a_w_k: f64, b_w_k: f64, b_in_k: f64) -> Outlet {
    if a_w_k <= 0.0 {
        return Outlet::HeatFlow(0.0);
    }
    Outlet::Exchange { w_k: conductance_w_k(ua_w_k, a_w_k, b_w_k), other_k: b_in_k }
}

/// Capacity flow of the first stream, W/K, where the other has `b_w_k` and the inlets differ by `inlets_k`.
///
/// With a temperature difference that is held, the flow at which the first stream changes by it: the change falls
/// with the flow, so the flow is found by halving.
pub fn flow_w_k(stream: &Stream, ua_w_k: f64, b_w_k: f64, inlets_k: f64) -> f64 {
    let Stream::Difference { difference_k, least_w_k, most_w_k } = *stream else {
        return stream.capacity_w_k(0.0);
    };
    let most_w_k = most_w_k.min(b_w_k * inlets_k / difference_k).max(least_w_k);
    let change_k = |a_w_k: f64| conductance_w_k(ua_w_k, a_w_k, b_w_k) / a_w_k * inlets_k;
    let (mut low, mut high) = (least_w_k, most_w_k);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if middle > 0.0 && change_k(middle) < difference_k {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_streams() {
        // NTU = 3000/1500 = 2: eps = 2/3; 20 K between the inlets: 20 kW
        assert!((conductance_w_k(3000.0, 1500.0, 1500.0) * 20.0 - 20_000.0).abs() < 1e-6);
        let Outlet::Exchange { w_k, other_k } = outlet(3000.0, 1500.0, 1500.0, 290.0) else {
            panic!()
        };
        let (constant_k, of_inlet) = Outlet::of_exchange(w_k, other_k, 1500.0);
        // 310 K leaves with 310 - 2/3 20 = 296.67
        assert!((constant_k + of_inlet * 310.0 - 296.666_667).abs() < 1e-6);
        assert_eq!(outlet(3000.0, 0.0, 1500.0, 290.0), Outlet::HeatFlow(0.0));
    }

    #[test]
    fn a_difference_is_held_by_the_flow() {
        let stream = Stream::Difference { difference_k: 5.0, least_w_k: 100.0, most_w_k: 5000.0 };
        let a = flow_w_k(&stream, 3000.0, 1500.0, 20.0);
        let change_k = conductance_w_k(3000.0, a, 1500.0) / a * 20.0;
        assert!((change_k - 5.0).abs() < 1e-9, "{a} {change_k}");
        // More than 10 K cannot be between streams 8 K apart: the least flow.
        let far = Stream::Difference { difference_k: 10.0, least_w_k: 100.0, most_w_k: 5000.0 };
        assert!((flow_w_k(&far, 3000.0, 1500.0, 8.0) - 100.0).abs() < 1e-6);
        assert_eq!(flow_w_k(&Stream::Flow(836.0), 3000.0, 1500.0, 8.0), 836.0);
    }
}
