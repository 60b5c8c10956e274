//! What the sun sends onto a house.
//!
//! **Equation** the mean irradiance of the outer walls and of the windows in them over the four sides, the free
//! ones by their length; the roof gets what the horizontal gets on the footprint, 1/1.3 of it per area of its
//! slopes. **Assumptions** a free horizon, isotropic sky, windows evenly over the free sides, an albedo of 0.2.
//! **Sources** [`anergy_core::solar`].

use crate::building::envelope::Areas;
use crate::building::house::OUTER_FILM_W_M2_K;
use anergy_core::solar::{HorizontalIrradiance, Plane, Sky, SunPosition};
use std::f64::consts::{FRAC_PI_2, PI};

/// Share of the sun that outer walls and roofs take up.
const ABSORBED: f64 = 0.5;
const ALBEDO: f64 = 0.2;

/// The sides of a house towards the sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sun {
    /// Walls in front, behind, to the left and the right, and their shares.
    sides: [(Plane, f64); 4],
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
        let side = |turn_rad: f64, share: f64| {
            (Plane::new(FRAC_PI_2, azimuth_rad + turn_rad, ALBEDO), 0.5 * share)
        };
        let (long, short) = (areas.long_share, 1.0 - areas.long_share);
        Self {
            sides: [
                side(0.0, long),
                side(PI, long),
                side(-FRAC_PI_2, short),
                side(FRAC_PI_2, short),
            ],
            window_m2: areas.window_m2 * passed,
            roof_share: areas.footprint_m2 / areas.roof_m2,
        }
    }

    pub fn shines(&self, horizontal: HorizontalIrradiance, position: SunPosition) -> Sunshine {
        let HorizontalIrradiance { global_w_m2, beam_normal_w_m2, diffuse_w_m2 } = horizontal;
        if global_w_m2 <= 0.0 && beam_normal_w_m2 <= 0.0 && diffuse_w_m2 <= 0.0 {
            return Sunshine::default();
        }
        let mut walls_w_m2 = 0.0;
        for (plane, share) in &self.sides {
            if *share > 0.0 {
                let irradiance = plane.irradiance(Sky::Isotropic, position, horizontal);
                walls_w_m2 += share * irradiance.total_w_m2();
            }
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
    }
}
