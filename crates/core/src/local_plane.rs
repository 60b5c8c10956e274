//! Metres about a place on the earth, for maps.
//!
//! **Equation** x = N(phi0) cos(phi0) (lambda - lambda0), y = M(phi0) (phi - phi0) with the radii of curvature
//! N = a / w, M = a (1 - e2) / w^3, w^2 = 1 - e2 sin^2(phi0) of the ellipsoid WGS84.
//!
//! **Validity** True to 1e-3 within 10 km of the place at middle latitudes; no lengths are taken from it.
//!
//! **Numerics** Linear: there and back is exact to rounding.

/// Longitude and latitude, deg.
pub type LonLat = [f64; 2];

/// Equatorial radius, m, and flattening of WGS84.
const RADIUS_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// Metres east and north of an origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalPlane {
    /// Longitude and latitude of x = 0, y = 0.
    pub origin: LonLat,
    east_m_deg: f64,
    north_m_deg: f64,
}

impl LocalPlane {
    /// The plane about a place.
    pub fn at(origin: LonLat) -> Self {
        let e2 = FLATTENING * (2.0 - FLATTENING);
        let latitude = origin[1].to_radians();
        let w2 = 1.0 - e2 * latitude.sin().powi(2);
        let across = RADIUS_M / w2.sqrt();
        let along = across * (1.0 - e2) / w2;
        let deg = 1.0_f64.to_radians();
        Self { origin, east_m_deg: deg * across * latitude.cos(), north_m_deg: deg * along }
    }

    /// The plane of some places: its origin is their middle, rounded to 1e-4 deg. Across the date line the
    /// longitudes go on beyond 180 deg.
    pub fn around(places: impl Iterator<Item = LonLat>) -> Option<Self> {
        let mut first = None;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in places {
            let first = *first.get_or_insert(place[0]);
            for (axis, value) in [near(place[0], first), place[1]].into_iter().enumerate() {
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value);
            }
        }
        first?;
        let middle = |axis: usize| (1e4 * f64::midpoint(low[axis], high[axis])).round() / 1e4;
        Some(Self::at([near(middle(0), 0.0), middle(1)]))
    }

    /// Metres east and north.
    pub fn metres(&self, place: LonLat) -> [f64; 2] {
        [
            self.east_m_deg * (near(place[0], self.origin[0]) - self.origin[0]),
            self.north_m_deg * (place[1] - self.origin[1]),
        ]
    }

    /// Longitude and latitude of a place in metres, deg to 1e-9 (0.1 mm).
    pub fn lon_lat(&self, [x_m, y_m]: [f64; 2]) -> LonLat {
        let round = |deg: f64| (1e9 * deg).round() / 1e9;
        [
            round(near(self.origin[0] + x_m / self.east_m_deg, 0.0)),
            round(self.origin[1] + y_m / self.north_m_deg),
        ]
    }
}

/// The same meridian within half a turn of another one.
fn near(longitude: f64, other: f64) -> f64 {
    let turns = ((longitude - other) / 360.0).round();
    longitude - 360.0 * turns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_in_metres() {
        // At 48 deg: w2 = 1 - 0.00669438 sin2(48 deg) = 0.996303, N = 6 389 959 m, M = 6 370 804 m; a degree is
        // N cos(48 deg) pi / 180 = 74 625 m east, M pi / 180 = 111 192 m north.
        let plane = LocalPlane::at([11.0, 48.0]);
        let [x_m, y_m] = plane.metres([12.0, 49.0]);
        assert!((x_m - 74_625.0).abs() < 5.0 && (y_m - 111_192.0).abs() < 5.0, "{x_m} {y_m}");
        assert_eq!(plane.lon_lat([x_m, y_m]), [12.0, 49.0]);
    }
}
