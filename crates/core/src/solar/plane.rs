//! Irradiance on tilted planes.
//!
//! **Equation** with `c` the cosine of the angle of incidence, tilt `s`, albedo `r`:
//! ```text
//! beam = G_bn max(0, c)
//! ground = G_h r (1 - cos s)/2
//! sky, isotropic = G_d (1 + cos s)/2
//! sky, Perez = G_d ((1 - F1)(1 + cos s)/2 + F1 max(0, c)/max(cos 85 deg, cos z) + F2 sin s)
//! F1 = max(0, f11 + f12 D + f13 z),  F2 = f21 + f22 D + f23 z,  D = G_d m/E_0
//! clearness = ((G_d + G_bn)/G_d + 1.041 z^3)/(1 + 1.041 z^3)      chooses the row of f
//! m = 1/(cos z + 0.50572 (96.07995 - z_deg)^-1.6364)
//! ```
//! **Assumptions** a free horizon, a ground that reflects diffusely; the beam comes from the centre of the sun.
//! **Validity** Perez: the set of all sites of 1990; without sun (z from 90 deg) the sky is isotropic.
//! **Numerics** closed form. **Sources** `liu1963`, `perez1990`, `kasten1989`.

use super::{SOLAR_CONSTANT_W_M2, SunPosition};
use std::f64::consts::FRAC_PI_2;

/// A tilted plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    sin_tilt: f64,
    cos_tilt: f64,
    sin_azimuth: f64,
    cos_azimuth: f64,
    albedo: f64,
}

/// How the sky is thought to shine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sky {
    /// Alike from everywhere (Liu and Jordan).
    Isotropic,
    /// Brighter around the sun and along the horizon (Perez 1990).
    #[default]
    Perez,
}

/// What a plane gets, W/m2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlaneIrradiance {
    /// From the sun, W/m2.
    pub beam_w_m2: f64,
    /// From the sky, W/m2.
    pub sky_w_m2: f64,
    /// From the ground, W/m2.
    pub ground_w_m2: f64,
    /// Cosine of the angle of incidence of the beam; 0 where the sun is behind the plane or down.
    pub incidence_cosine: f64,
}

impl PlaneIrradiance {
    /// All of it, W/m2.
    pub fn total_w_m2(&self) -> f64 {
        self.beam_w_m2 + self.sky_w_m2 + self.ground_w_m2
    }
}

/// Irradiances of a horizontal place, W/m2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HorizontalIrradiance {
    /// From everywhere on the horizontal, W/m2.
    pub global_w_m2: f64,
    /// From the sun on a plane that faces it, W/m2.
    pub beam_normal_w_m2: f64,
    /// From the sky on the horizontal, W/m2.
    pub diffuse_w_m2: f64,
}

impl Plane {
    /// A plane: tilt from the horizontal and azimuth from south (west positive), rad; the albedo of the ground
    /// before it is usually 0.2.
    pub fn new(tilt_rad: f64, azimuth_rad: f64, albedo: f64) -> Self {
        let (sin_tilt, cos_tilt) = tilt_rad.sin_cos();
        let (sin_azimuth, cos_azimuth) = azimuth_rad.sin_cos();
        Self { sin_tilt, cos_tilt, sin_azimuth, cos_azimuth, albedo }
    }

    /// Cosine of the angle between the sun and the normal of the plane; negative from behind.
    pub fn incidence_cosine(&self, sun: SunPosition) -> f64 {
        let (sin_elevation, cos_elevation) = sun.elevation_rad.sin_cos();
        let (sin_sun, cos_sun) = sun.azimuth_rad.sin_cos();
        // cos(azimuth of the sun - azimuth of the plane)
        let beside = cos_sun * self.cos_azimuth + sin_sun * self.sin_azimuth;
        sin_elevation * self.cos_tilt + cos_elevation * self.sin_tilt * beside
    }

    /// What the plane gets.
    pub fn irradiance(
        &self,
        sky: Sky,
        sun: SunPosition,
        horizontal: HorizontalIrradiance,
    ) -> PlaneIrradiance {
        let HorizontalIrradiance { global_w_m2, beam_normal_w_m2, diffuse_w_m2 } = horizontal;
        let up = sun.elevation_rad > 0.0;
        let incidence = if up { self.incidence_cosine(sun).max(0.0) } else { 0.0 };
        let isotropic = 0.5 * (1.0 + self.cos_tilt);
        let share = match sky {
            Sky::Perez if up && diffuse_w_m2 > 0.0 => {
                let (around, along) =
                    perez(sun.elevation_rad, beam_normal_w_m2.max(0.0), diffuse_w_m2);
                // The plane sees the sun at this much of what the horizontal sees.
                let seen = incidence / sun.elevation_rad.sin().max(COS_85_DEG);
                ((1.0 - around) * isotropic + around * seen + along * self.sin_tilt).max(0.0)
            }
            _ => isotropic,
        };
        PlaneIrradiance {
            beam_w_m2: beam_normal_w_m2 * incidence,
            sky_w_m2: diffuse_w_m2 * share,
            ground_w_m2: global_w_m2 * self.albedo * 0.5 * (1.0 - self.cos_tilt),
            incidence_cosine: incidence,
        }
    }
}

const COS_85_DEG: f64 = 0.087_155_742_747_658_17;

/// Limits of the clearness between the rows below.
const CLEARNESS: [f64; 7] = [1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2];

/// f11, f12, f13, f21, f22, f23 of all sites, from overcast to clear.
const PEREZ: [[f64; 6]; 8] = [
    [-0.008, 0.588, -0.062, -0.060, 0.072, -0.022],
    [0.130, 0.683, -0.151, -0.019, 0.066, -0.029],
    [0.330, 0.487, -0.221, 0.055, -0.064, -0.026],
    [0.568, 0.187, -0.295, 0.109, -0.152, -0.014],
    [0.873, -0.392, -0.362, 0.226, -0.462, 0.001],
    [1.132, -1.237, -0.412, 0.288, -0.823, 0.056],
    [1.060, -1.600, -0.359, 0.264, -1.127, 0.131],
    [0.678, -0.327, -0.250, 0.156, -1.377, 0.251],
];

/// Brightness around the sun and along the horizon, F1 and F2.
fn perez(elevation_rad: f64, beam_normal_w_m2: f64, diffuse_w_m2: f64) -> (f64, f64) {
    let zenith = FRAC_PI_2 - elevation_rad;
    let air_mass =
        1.0 / (elevation_rad.sin() + 0.505_72 * (96.079_95 - zenith.to_degrees()).powf(-1.6364));
    let brightness = diffuse_w_m2 * air_mass / SOLAR_CONSTANT_W_M2;
    let cubed = 1.041 * zenith.powi(3);
    let clearness = ((diffuse_w_m2 + beam_normal_w_m2) / diffuse_w_m2 + cubed) / (1.0 + cubed);
    let row = CLEARNESS.iter().filter(|limit| **limit <= clearness).count();
    let [f11, f12, f13, f21, f22, f23] = PEREZ[row];
    ((f11 + f12 * brightness + f13 * zenith).max(0.0), f21 + f22 * brightness + f23 * zenith)
}
