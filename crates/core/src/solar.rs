//! The sun: where it stands, and what it sends onto planes.
//!
//! **Equation** position: ecliptic longitude of the sun from its mean longitude and anomaly (Astronomical
//! Almanac, two terms of the equation of the centre), from it declination `d` and right ascension `a`;
//! hour angle `w = GMST + longitude - a`; then
//! ```text
//! sin h = sin(lat) sin d + cos(lat) cos d cos w                              elevation h
//! azimuth = atan2(cos d sin w, sin(lat) cos d cos w - cos(lat) sin d)        0 south, west positive
//! ```
//! Near a moment the declination is held and the hour angle runs with 2 pi in 24 h ([`SunPath`]), so that what
//! the sun sends onto the horizontal outside the atmosphere, `max(0, sin h)`, integrates in closed form:
//! `A w + B sin w` between sunrise and sunset, `A = sin(lat) sin d`, `B = cos(lat) cos d`.
//!
//! **Assumptions** geometric position, as seen from the centre of the earth: no refraction (0.5 deg at the horizon),
//! no parallax (0.002 deg). Leap seconds are ignored. **Validity** 1950 to 2050: within 0.02 deg of NREL's
//! algorithm there; a path held for half an hour is 0.01 deg off, for 12 h 0.2 deg.
//!
//! **Numerics** closed form. **Sources** `michalsky1988`, `reda2004` (the reference), `spencer1971`, `erbs1982`,
//! `haurwitz1945`, `holmgren2018` (numbers of the tests).

mod plane;

pub use plane::{HorizontalIrradiance, Plane, PlaneIrradiance, Sky};

use std::f64::consts::{PI, TAU};

/// Irradiance outside the atmosphere at the mean distance of the sun, on a plane that faces it, W/m2.
pub const SOLAR_CONSTANT_W_M2: f64 = 1361.0;

/// 2000-01-01 12:00 in seconds since 1970.
const J2000_UNIX_S: f64 = 946_728_000.0;
const DAY_S: f64 = 86_400.0;
/// How fast the hour angle grows, rad/s.
const TURN_RAD_S: f64 = TAU / DAY_S;

/// Where the sun stands.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SunPosition {
    /// Above the horizon, rad; negative at night.
    pub elevation_rad: f64,
    /// From south, rad: west positive, -pi to pi.
    pub azimuth_rad: f64,
}

/// A place on the earth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Location {
    /// North positive, rad.
    pub latitude_rad: f64,
    /// East positive, rad.
    pub longitude_rad: f64,
}

impl Location {
    /// The position of the sun at a time, s since 1970 (UTC).
    pub fn sun(&self, unix_s: f64) -> SunPosition {
        self.path(unix_s).position(0.0)
    }

    /// The course of the sun around a time, s since 1970 (UTC).
    pub fn path(&self, unix_s: f64) -> SunPath {
        let days = (unix_s - J2000_UNIX_S) / DAY_S;
        let degrees = |at_start: f64, per_day: f64| (at_start + per_day * days).to_radians();
        let anomaly = degrees(357.528, 0.985_600_3);
        let ecliptic = degrees(280.460, 0.985_647_4)
            + (1.915 * anomaly.sin() + 0.020 * (2.0 * anomaly).sin()).to_radians();
        let obliquity = degrees(23.439, -4e-7);
        let right_ascension = (obliquity.cos() * ecliptic.sin()).atan2(ecliptic.cos());
        let sidereal = degrees(280.460_618_37, 360.985_647_366_29);
        let hour_angle = sidereal + self.longitude_rad - right_ascension;
        let sin_declination = obliquity.sin() * ecliptic.sin();
        let cos_declination = (1.0 - sin_declination * sin_declination).sqrt();
        let (sin_latitude, cos_latitude) = self.latitude_rad.sin_cos();
        let (a, b) = (sin_latitude * sin_declination, cos_latitude * cos_declination);
        // At a pole b is nothing.
        let polar = if a > 0.0 { PI } else { 0.0 };
        SunPath {
            sin_latitude,
            cos_latitude,
            sin_declination,
            cos_declination,
            hour_angle_rad: (hour_angle + PI).rem_euclid(TAU) - PI,
            dawn_rad: if b <= a.abs() { polar } else { (-a / b).acos() },
        }
    }
}

/// The course of the sun around a moment: its declination is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunPath {
    sin_latitude: f64,
    cos_latitude: f64,
    sin_declination: f64,
    cos_declination: f64,
    /// At the moment; 0 is noon.
    hour_angle_rad: f64,
    /// Of sunset: 0 in the polar night, pi in the polar day.
    dawn_rad: f64,
}

impl SunPath {
    /// The position some time after the moment, s.
    pub fn position(&self, after_s: f64) -> SunPosition {
        let (sin, cos) = (self.hour_angle_rad + TURN_RAD_S * after_s).sin_cos();
        let south = self.sin_latitude * self.cos_declination * cos
            - self.cos_latitude * self.sin_declination;
        let west = self.cos_declination * sin;
        let up = self.sin_latitude * self.sin_declination
            + self.cos_latitude * self.cos_declination * cos;
        SunPosition {
            // Exact also near the zenith, where asin is not.
            elevation_rad: up.atan2(south.hypot(west)),
            azimuth_rad: west.atan2(south),
        }
    }

    /// Integral of `max(0, sin h)` over a span, s: what a horizontal plane outside the atmosphere gets.
    pub fn sine_s(&self, from_s: f64, to_s: f64) -> f64 {
        let (a, b) =
            (self.sin_latitude * self.sin_declination, self.cos_latitude * self.cos_declination);
        let dawn = self.dawn_rad;
        let until = |after_s: f64| {
            let (turns, within) = self.within_day(after_s);
            let day = |angle: f64| a * angle + b * angle.sin();
            2.0 * turns * day(dawn) + day(within)
        };
        ((until(to_s) - until(from_s)) / TURN_RAD_S).max(0.0)
    }

    /// How long the sun is up within a span, s.
    pub fn sunshine_s(&self, from_s: f64, to_s: f64) -> f64 {
        let dawn = self.dawn_rad;
        let until = |after_s: f64| {
            let (turns, within) = self.within_day(after_s);
            2.0 * turns * dawn + within
        };
        ((until(to_s) - until(from_s)) / TURN_RAD_S).max(0.0)
    }

    /// The middle of the part of a span in which the sun is up, or of the whole span where it is not; for spans
    /// of less than the night.
    pub fn middle_s(&self, from_s: f64, to_s: f64) -> f64 {
        let (dawn, middle_s) = (self.dawn_rad, 0.5 * (from_s + to_s));
        let angle = |after_s: f64| self.hour_angle_rad + TURN_RAD_S * after_s;
        // The noon that is nearest.
        let noon = (angle(middle_s) / TAU).round() * TAU;
        let (rises, sets) = (noon - dawn, noon + dawn);
        let (from, to) = (angle(from_s).max(rises), angle(to_s).min(sets));
        if from < to { (0.5 * (from + to) - self.hour_angle_rad) / TURN_RAD_S } else { middle_s }
    }

    /// Whole turns since noon, and the hour angle within the day, kept between sunrise and sunset.
    fn within_day(&self, after_s: f64) -> (f64, f64) {
        let angle = self.hour_angle_rad + TURN_RAD_S * after_s;
        let turns = (angle / TAU).round();
        (turns, (angle - turns * TAU).clamp(-self.dawn_rad, self.dawn_rad))
    }
}

/// Irradiance outside the atmosphere on a plane that faces the sun, W/m2, with the distance of the sun; `day` of
/// the year from 0.
pub fn extraterrestrial_w_m2(day: f64) -> f64 {
    let angle = TAU * day / 365.0;
    let (sin, cos) = angle.sin_cos();
    let (sin_2, cos_2) = (2.0 * angle).sin_cos();
    let distance =
        1.000_11 + 0.034_221 * cos + 0.001_28 * sin + 0.000_719 * cos_2 + 0.000_077 * sin_2;
    SOLAR_CONSTANT_W_M2 * distance
}

/// The diffuse share of the irradiance of an hour on the horizontal, from its clearness (Erbs, Klein, Duffie):
/// its ratio to what arrives outside the atmosphere.
pub fn diffuse_share(clearness: f64) -> f64 {
    let k = clearness;
    if k <= 0.22 {
        1.0 - 0.09 * k
    } else if k <= 0.8 {
        0.9511 + k * (-0.1604 + k * (4.388 + k * (-16.638 + k * 12.336)))
    } else {
        0.165
    }
}

/// Global irradiance of a clear sky on the horizontal, W/m2 (Haurwitz), from the sine of the elevation.
pub fn clear_sky_w_m2(sine: f64) -> f64 {
    if sine > 0.0 { 1098.0 * sine * (-0.057 / sine).exp() } else { 0.0 }
}

#[cfg(test)]
mod tests;
