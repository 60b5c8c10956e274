//! Distances on the ellipsoid WGS84.

pub(super) use anergy_core::local_plane::{LocalPlane as Plane, LonLat};
use geographiclib_rs::{Geodesic, InverseGeodesic};

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
