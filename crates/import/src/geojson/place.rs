//! Distances and positions on the ellipsoid WGS84.

use geographiclib_rs::{Geodesic, InverseGeodesic};

/// Longitude and latitude, deg.
pub(super) type LonLat = [f64; 2];

/// Equatorial radius, m, and flattening of WGS84.
const RADIUS_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// Geodesic distances.
pub(super) struct Earth(Geodesic);

impl Earth {
    pub fn new() -> Self {
        Self(Geodesic::wgs84())
    }

    /// Shortest way on the ellipsoid, m.
    pub fn distance_m(&self, a: LonLat, b: LonLat) -> f64 {
        self.0.inverse(a[1], a[0], b[1], b[0])
    }

    /// Length of a line, m.
    pub fn length_m(&self, path: &[LonLat]) -> f64 {
        path.windows(2).map(|ends| self.distance_m(ends[0], ends[1])).sum()
    }
}

/// The plane of the map: metres east and north of its origin,
///
/// x = N(phi0) cos(phi0) (lambda - lambda0), y = M(phi0) (phi - phi0),
///
/// with the radii of curvature N = a / w, M = a (1 - e2) / w^3, w^2 = 1 - e2 sin^2(phi0). It is linear, so that
/// there and back is exact to rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    pub origin: LonLat,
    east_m_deg: f64,
    north_m_deg: f64,
}

impl Plane {
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
    fn distances() {
        // One degree of the meridian at 45 deg is 111 131.8 m (between 44.5 and 45.5 deg), of the equator
        // pi a / 180 = 111 319.491 m.
        let earth = Earth::new();
        assert!((earth.distance_m([9.0, 44.5], [9.0, 45.5]) - 111_131.8).abs() < 0.1);
        assert!((earth.distance_m([0.0, 0.0], [1.0, 0.0]) - 111_319.491).abs() < 1e-3);
        let path = [[11.0, 48.0], [11.01, 48.0], [11.01, 48.01]];
        let sum = earth.distance_m(path[0], path[1]) + earth.distance_m(path[1], path[2]);
        assert_eq!(earth.length_m(&path), sum);
    }

    #[test]
    fn the_plane_is_that_of_the_geodesics_and_goes_back() {
        let (earth, origin) = (Earth::new(), [11.58, 48.14]);
        let plane = Plane::at(origin);
        for place in [[11.6, 48.14], [11.58, 48.17], [11.55, 48.12]] {
            let [x, y] = plane.metres(place);
            let (drawn, true_m) = (x.hypot(y), earth.distance_m(origin, place));
            assert!((drawn / true_m - 1.0).abs() < 1e-3, "{drawn} {true_m}");
            let back = plane.lon_lat([x, y]);
            assert!((back[0] - place[0]).abs() < 1e-9 && (back[1] - place[1]).abs() < 1e-9);
        }
        // Fiji: both sides of the date line are 2 km apart.
        let plane = Plane::around([[179.99, -17.0], [-179.99, -17.0]].into_iter()).unwrap();
        let (a, b) = (plane.metres([179.99, -17.0]), plane.metres([-179.99, -17.0]));
        assert!((b[0] - a[0] - 2129.0).abs() < 10.0, "{a:?} {b:?}");
        assert!(Plane::around(std::iter::empty()).is_none());
    }
}
