//! What the sun sends onto a house.
//!
//! **Equation** the mean irradiance of the four sides, vertical planes at right angles, with `l` the share of the
//! long ones (front and back), `g` the azimuth of the front and `h` the elevation:
//! ```text
//! beam = G_bn cos h (l/2 |cos(a - g)| + (1 - l)/2 |sin(a - g)|)     of two opposite sides one is in the sun
//! sky = G_d/2,  ground = 0.2 G_h/2
//! ```
//! The roof gets what the horizontal gets on the footprint. **Assumptions** a free horizon, isotropic sky, windows
//! evenly over the free sides. **Sources** `liu1963`; the same as [`anergy_core::solar::Plane`] four times (tested).

use crate::building::envelope::Areas;
use crate::building::house::OUTER_FILM_W_M2_K;
use anergy_core::solar::{HorizontalIrradiance, SunPosition};

/// Share of the sun that outer walls and roofs take up.
const ABSORBED: f64 = 0.5;
const ALBEDO: f64 = 0.2;

/// The sides of a house towards the sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sun {
    /// Where the front looks, rad.
    azimuth_rad: f64,
    /// Share of front and back.
    long_share: f64,
    /// Windows times what comes through, m2.
    window_m2: f64,
    /// Footprint per area of the roof.
    roof_share: f64,
}

/// What it does.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Sunshine {
    /// Through the windows, W.
    pub windows_w: f64,
    /// What it adds to the outdoor temperature at walls and roof, K.
    pub wall_k: f64,
    pub roof_k: f64,
}

impl Sun {
    pub fn new(areas: &Areas, azimuth_rad: f64, passed: f64) -> Self {
        Self {
            azimuth_rad,
            long_share: areas.long_share,
            window_m2: areas.window_m2 * passed,
            roof_share: areas.footprint_m2 / areas.roof_m2,
        }
    }

    pub fn shines(&self, horizontal: HorizontalIrradiance, position: SunPosition) -> Sunshine {
        let HorizontalIrradiance { global_w_m2, beam_normal_w_m2, diffuse_w_m2 } = horizontal;
        if global_w_m2 <= 0.0 && beam_normal_w_m2 <= 0.0 && diffuse_w_m2 <= 0.0 {
            return Sunshine::default();
        }
        let mut walls_w_m2 = 0.5 * diffuse_w_m2 + 0.5 * ALBEDO * global_w_m2;
        if position.elevation_rad > 0.0 {
            let (sin, cos) = (position.azimuth_rad - self.azimuth_rad).sin_cos();
            let seen = self.long_share * cos.abs() + (1.0 - self.long_share) * sin.abs();
            walls_w_m2 += 0.5 * beam_normal_w_m2 * position.elevation_rad.cos() * seen;
        }
        Sunshine {
            windows_w: walls_w_m2 * self.window_m2,
            wall_k: ABSORBED * walls_w_m2 / OUTER_FILM_W_M2_K,
            roof_k: ABSORBED * global_w_m2.max(0.0) * self.roof_share / OUTER_FILM_W_M2_K,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anergy_core::solar::{Plane, Sky};
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn by_hand() {
        let areas = Areas {
            footprint_m2: 150.0,
            wall_m2: 200.0,
            window_m2: 45.0,
            long_share: 0.6,
            roof_m2: 250.0,
            cellar_m2: 1.0,
            living_m3: 1.0,
            roof_m3: 1.0,
            cellar_m3: 1.0,
        };
        let sun = Sun::new(&areas, 0.0, 0.42);
        assert_eq!(
            sun.shines(HorizontalIrradiance::default(), SunPosition::default()),
            Sunshine::default()
        );
        // Sun in the south, 30 deg up: beam 500 W/m2 on the front is 433.01 W/m2, on the others nothing; horizontal
        // 250 + 100 diffuse. Each side 50 of the sky and 0.2 * 350/2 = 35 of the ground.
        // Mean 0.3 * 433.01 + 85 = 214.90 W/m2; windows 214.90 * 45 * 0.42 = 4061.7 W; walls 0.5 * 214.90/25 = 4.298 K;
        // roof 0.5 * 350 * 0.6/25 = 4.2 K.
        let horizontal = HorizontalIrradiance {
            global_w_m2: 350.0,
            beam_normal_w_m2: 500.0,
            diffuse_w_m2: 100.0,
        };
        let position = SunPosition { elevation_rad: 30.0_f64.to_radians(), azimuth_rad: 0.0 };
        let shine = sun.shines(horizontal, position);
        assert!((shine.windows_w - 4061.7).abs() < 0.1, "{shine:?}");
        assert!(
            (shine.wall_k - 4.298).abs() < 1e-3 && (shine.roof_k - 4.2).abs() < 1e-12,
            "{shine:?}"
        );
        // From the west the same sun meets a short side.
        let west = SunPosition { azimuth_rad: FRAC_PI_2, ..position };
        assert!(
            (sun.shines(horizontal, west).windows_w - (0.2 * 433.013 + 85.0) * 18.9).abs() < 0.1
        );
        // Any sun on a turned house: the four planes one by one.
        let turned = Sun::new(&areas, 0.4, 0.42);
        for (elevation_rad, azimuth_rad) in [(-0.1, 0.0), (0.2, 1.0), (0.9, -2.5), (1.3, 3.0)] {
            let position = SunPosition { elevation_rad, azimuth_rad };
            let mut mean = 0.0;
            for (turn, share) in [(0.0, 0.3), (PI, 0.3), (FRAC_PI_2, 0.2), (-FRAC_PI_2, 0.2)] {
                let plane = Plane::new(FRAC_PI_2, 0.4 + turn, ALBEDO);
                mean += share * plane.irradiance(Sky::Isotropic, position, horizontal).total_w_m2();
            }
            let windows_w = turned.shines(horizontal, position).windows_w;
            assert!((windows_w - 18.9 * mean).abs() < 1e-9, "{windows_w} {mean}");
        }
    }
}
