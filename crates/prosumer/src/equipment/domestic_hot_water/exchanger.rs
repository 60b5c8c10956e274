//! The plate exchanger of a fresh-water station and the flow that its pump needs.
//!
//! **Equation** counter flow, `Q = UA (d_1 - d_2)/ln(d_1/d_2)`, `d_1 = T_in - T_set` at the hot end, `d_2 = T_out - T_cold`
//! at the cold end: with `y = d_2/d_1` it is `(y - 1)/ln y = Q/(UA d_1)`, whose left side rises with `y`; then
//! `C = Q/(T_in - T_out)`. **Numerics** Newton in `ln y`, where the left side is convex: from above, to rounding in a
//! few rounds; far below 1 from the left, where the first step leads above. Where that takes more than the largest flow, or the water is
//! too cold, the largest flow gives what it can. A large exchanger needs little flow as long as the water is a little warmer
//! than set: below, the pump goes from that to its largest flow within [`BAND_K`] (the band of the controller of the tap),
//! otherwise the pump at the end of a long pipe would have no flow at which it stays. **Sources** `incropera2007`.

use crate::direct_exchange::conductance_w_k;

/// Less than this at the hot end is none, K.
const LEAST_K: f64 = 1e-3;
/// Below the set temperature the pump reaches its largest flow within this, K.
const BAND_K: f64 = 1.0;
const MOST_ROUNDS: usize = 30;

/// Exchanger and pump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Exchanger {
    pub ua_w_k: f64,
    /// Largest capacity flow of the pump, W/K.
    pub most_w_k: f64,
}

impl Exchanger {
    /// Capacity flow of the pump, W/K, and heat, W, for water of `flow_w_k` from `inlet_k` to `set_k`.
    pub fn serve(&self, flow_w_k: f64, inlet_k: f64, set_k: f64, arrives_k: f64) -> (f64, f64) {
        let wanted_w = flow_w_k * (set_k - inlet_k);
        if wanted_w <= 0.0 {
            return (0.0, 0.0);
        }
        if arrives_k <= inlet_k {
            // The pump draws until warm water comes; a supply that has cooled down would never be flushed otherwise.
            return (self.most_w_k, 0.0);
        }
        let hot_end_k = arrives_k - set_k;
        let pump_w_k = match self.needed_w_k(wanted_w, inlet_k, set_k, hot_end_k.max(LEAST_K)) {
            Some(pump_w_k) if hot_end_k >= LEAST_K => return (pump_w_k, wanted_w),
            Some(pump_w_k) => {
                let more = ((LEAST_K - hot_end_k) / BAND_K).min(1.0);
                pump_w_k + more * (self.most_w_k - pump_w_k)
            }
            None => self.most_w_k,
        };
        let heat_w = conductance_w_k(self.ua_w_k, pump_w_k, flow_w_k) * (arrives_k - inlet_k);
        (pump_w_k, heat_w.min(wanted_w))
    }

    /// Capacity flow of the pump for all of the heat, W/K, with water warmer than set by `hot_end_k`; `None` beyond what it
    /// can.
    fn needed_w_k(&self, wanted_w: f64, inlet_k: f64, set_k: f64, hot_end_k: f64) -> Option<f64> {
        let cold_end_k = hot_end_k * ratio(wanted_w / (self.ua_w_k * hot_end_k));
        let cooled_k = set_k + hot_end_k - (inlet_k + cold_end_k);
        let pump_w_k = wanted_w / cooled_k;
        (cooled_k > 0.0 && pump_w_k <= self.most_w_k).then_some(pump_w_k)
    }
}

/// `y` of `(y - 1)/ln y = k`.
fn ratio(k: f64) -> f64 {
    // With x = ln y: (e^x - 1)/x = k, which rises and is convex in x. Its value and its slope share the exponential.
    let law = |x: f64| {
        if x.abs() < 1e-3 {
            (1.0 + x * (0.5 + x / 6.0), 0.5 + x / 3.0)
        } else {
            let less = x.exp_m1();
            (less / x, (less * (x - 1.0) + x) / (x * x))
        }
    };
    // Above the root from 1 on: e^(x/2) is below the left side. Far below the left side is -1/x.
    let mut x = match k {
        1.0.. => 2.0 * k.ln(),
        0.3.. => 0.0,
        _ => -1.0 / k,
    };
    for _ in 0..MOST_ROUNDS {
        let (mean, slope) = law(x);
        let step = (mean - k) / slope;
        // Steps are kept within the range of doubles.
        x = (x - step).max(-700.0);
        if step.abs() < 1e-12 * (1.0 + x.abs()) {
            break;
        }
    }
    x.exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ratio_of_a_logarithmic_mean() {
        for y in [1e-200, 1e-6, 0.01, 0.05, 0.5, 0.999_999, 1.0, 1.5, 20.0, 1e4] {
            let k: f64 = if y == 1.0 { 1.0 } else { (y - 1.0) / f64::ln(y) };
            assert!((ratio(k) / y - 1.0).abs() < 1e-6, "{y}: {}", ratio(k));
        }
    }

    #[test]
    fn by_hand_and_by_effectiveness() {
        let exchanger = Exchanger { ua_w_k: 6000.0, most_w_k: 40.0 / 60.0 * 4180.0 };
        // 20 l/min from 10 to 45 degC: 1393.3 W/K, 48 767 W, from water of 65 degC: d_1 = 20 K, LMTD 8.128 K.
        let (flow_w_k, heat_w) = exchanger.serve(4180.0 / 3.0, 283.15, 318.15, 338.15);
        assert!((heat_w - 48_766.7).abs() < 0.1);
        let out_k = 338.15 - heat_w / flow_w_k;
        let (d_1, d_2) = (20.0, out_k - 283.15);
        assert!(((d_1 - d_2) / f64::ln(d_1 / d_2) - heat_w / 6000.0).abs() < 1e-6, "{out_k}");
        let by_effectiveness = conductance_w_k(6000.0, flow_w_k, 4180.0 / 3.0) * 55.0;
        assert!((by_effectiveness - heat_w).abs() < 1e-3);
        // Water of 46 degC needs more than the pump has; of 40 degC it never gets warm.
        for arrives_k in [319.15, 313.15] {
            let (flow_w_k, heat_w) = exchanger.serve(4180.0 / 3.0, 283.15, 318.15, arrives_k);
            assert!(flow_w_k == exchanger.most_w_k && heat_w < 48_766.0);
            assert!(283.15 + heat_w / (4180.0 / 3.0) < arrives_k);
        }
        // A circulation of 30 W/K that comes back with 40 degC: 1 mK above 45 degC k = 150/(6000 * 0.001) = 25 of y = 113.9 (112.9/
        // 4.735 = 23.8; y = 120.6: 119.6/4.793 = 24.95), out 40.121 degC, 150/4.880 = 30.74 W/K; half of the band below the pump is half
        // way to its largest flow, and nothing jumps.
        let (flow_w_k, heat_w) = exchanger.serve(30.0, 313.15, 318.15, 318.151);
        assert!((flow_w_k - 30.74).abs() < 0.01 && (heat_w - 150.0).abs() < 1e-9, "{flow_w_k}");
        let half_w_k = exchanger.serve(30.0, 313.15, 318.15, 317.651).0;
        assert!((half_w_k - 0.5 * (flow_w_k + exchanger.most_w_k)).abs() < 1e-6, "{half_w_k}");
        let (below, above) = (318.151 - 1e-9, 318.151 + 1e-9);
        let at = |arrives_k: f64| exchanger.serve(30.0, 313.15, 318.15, arrives_k);
        assert!(
            (at(below).0 - at(above).0).abs() < 1e-4 && (at(below).1 - at(above).1).abs() < 1e-4
        );
        assert_eq!(at(316.0).0, exchanger.most_w_k);
        // Water that is colder than that of the taps gives nothing, and is drawn until warm water comes.
        assert_eq!(exchanger.serve(1000.0, 283.15, 318.15, 280.0), (exchanger.most_w_k, 0.0));
        assert_eq!(exchanger.serve(0.0, 283.15, 318.15, 280.0), (0.0, 0.0));
    }
}
