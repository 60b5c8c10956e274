//! The ground around buried pipes: its properties, and its undisturbed temperature over the year.
//!
//! **Equation** a half space whose surface follows the year (Kusuda and Achenbach):
//! ```text
//! T(z, t) = T_mean - A exp(-z/d) cos(2 pi (t - t_0)/P - z/d),   d = sqrt(P a/pi)
//! ```
//! z depth, t time since New Year, t_0 the coldest moment of the surface, P = 365 d, a thermal
//! diffusivity, A amplitude of the surface. Depth d damps the swing to 1/e and delays it by P/(2 pi).
//!
//! **Assumptions** homogeneous ground, conduction only (no freezing, no ground water), a surface that
//! swings like a sine: neither days nor snow. **Validity** below some 0.2 m, where days have died out.
//!
//! **Numerics** closed form. **Sources** `kusuda1965`.

use crate::buried_pipe::Soil;
use std::f64::consts::TAU;

/// The year of the ground, s: 365 days.
pub const YEAR_S: f64 = 365.0 * DAY_S;
const DAY_S: f64 = 86_400.0;

/// What pipes lie in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Conductivity and surface.
    pub soil: Soil,
    /// Thermal diffusivity, m2/s.
    pub diffusivity_m2_s: f64,
    /// Depth of the axes of pipes that do not say theirs, m.
    pub depth_m: f64,
}

impl Default for Ground {
    fn default() -> Self {
        Self { soil: Soil::default(), diffusivity_m2_s: 6.2e-7, depth_m: 1.0 }
    }
}

impl Ground {
    /// Heat capacity per volume, J/(m3 K): conductivity over diffusivity.
    pub fn capacity_j_m3_k(&self) -> f64 {
        self.soil.conductivity_w_m_k / self.diffusivity_m2_s
    }
}

/// The temperature of undisturbed ground over the year.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seasons {
    /// Mean over the year, the same at every depth, K.
    pub mean_k: f64,
    /// Amplitude at the surface, K.
    pub amplitude_k: f64,
    /// The coldest moment of the surface, s after New Year.
    pub coldest_s: f64,
    /// Thermal diffusivity, m2/s.
    pub diffusivity_m2_s: f64,
}

impl Seasons {
    /// Temperature at a depth, K; `new_year_s` is the time since New Year.
    pub fn temperature_k(&self, depth_m: f64, new_year_s: f64) -> f64 {
        let lag = depth_m * (0.5 * TAU / (YEAR_S * self.diffusivity_m2_s)).sqrt();
        let angle = TAU * (new_year_s - self.coldest_s) / YEAR_S - lag;
        self.mean_k - self.amplitude_k * (-lag).exp() * angle.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn munich() -> Seasons {
        Seasons {
            mean_k: 282.65,
            amplitude_k: 10.0,
            coldest_s: 35.0 * DAY_S,
            diffusivity_m2_s: 6.2e-7,
        }
    }

    #[test]
    fn amplitude_and_delay_at_depth() {
        // lag at 1 m: sqrt(pi/(31536000 * 6.2e-7)) = 0.400844: factor e^-0.400844 = 0.6698,
        // delay 0.400844 * 365/(2 pi) = 23.286 d; at 2 m 0.4486 and 46.571 d
        for (depth_m, factor, delay_d) in [(1.0, 0.669_754, 23.2857), (2.0, 0.448_571, 46.5713)] {
            let coldest_s = (35.0 + delay_d) * DAY_S;
            let lowest_k = munich().temperature_k(depth_m, coldest_s);
            assert!((lowest_k - (282.65 - 10.0 * factor)).abs() < 1e-5, "{lowest_k}");
            let highest_k = munich().temperature_k(depth_m, coldest_s + 0.5 * YEAR_S);
            assert!((highest_k - (282.65 + 10.0 * factor)).abs() < 1e-5, "{highest_k}");
            // Coldest there and then: both sides are warmer, alike.
            let side = |days: f64| munich().temperature_k(depth_m, coldest_s + days * DAY_S);
            assert!(side(-1.0) > lowest_k && side(1.0) > lowest_k);
            assert!((side(-10.0) - side(10.0)).abs() < 1e-4);
        }
    }

    #[test]
    fn the_mean_of_the_year_is_exact_at_every_depth() {
        for depth_m in [0.0, 0.6, 1.0, 3.0] {
            let days = (0..365).map(|day| munich().temperature_k(depth_m, f64::from(day) * DAY_S));
            assert!((days.sum::<f64>() / 365.0 - 282.65).abs() < 1e-10);
        }
        // The next year is the same.
        let (now, then) = (1e6, 1e6 + YEAR_S);
        assert!(
            (munich().temperature_k(1.0, now) - munich().temperature_k(1.0, then)).abs() < 1e-9
        );
    }

    #[test]
    fn heat_capacity_follows_from_the_diffusivity() {
        // 1.6/6.2e-7 = 2.58 MJ/(m3 K): moist loam
        assert!((Ground::default().capacity_j_m3_k() / 2.580_645e6 - 1.0).abs() < 1e-6);
    }
}
